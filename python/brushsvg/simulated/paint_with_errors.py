"""Simulate the marks that a studio paints for a plan, with the same model that predicts them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..errors import Error
from ..geometry.rotation import rotation
from ..machine.cells.cell import Machine
from ..machine.paint_reload import dips_without_cell
from ..machine.realised.arc_chords import with_chords
from ..machine.realised.backlash import from_air_mm
from ..machine.realised.distortion import commanded_mm, in_lines_mm
from ..machine.realised.pass_on_path import move_pass_to_path
from ..machine.realised.passes import as_run
from ..model.perturbed import with_factors
from .studio_errors import Studio

HEIGHT_MARGIN_MM = 0.02  # more than tilt and scale add to a change of height


@dataclass(frozen=True)
class PaintedStroke:
    """The paint of one stroke.

    rings: outlines on the sheet [mm]; way: (n, 3) x and y of the brush's contact and the distance travelled [mm].
    """

    stroke: str
    rings: list[np.ndarray]
    way: np.ndarray


def simulate_painted_strokes(
    plan, brush, studio: Studio, undone: Machine | None, seed: int, dips_mm=None
) -> list[PaintedStroke]:
    """Simulate the strokes that the studio paints for a plan.

    undone: the part of the machine's errors that the cell corrects; dips_mm: positions along each stroke where paint
    is reloaded, for a brush whose marks narrow as its paint runs out (default: only the beginning). Raises Error where
    the brush would be pressed beyond its depth range.
    """
    machine_errors = studio.machine
    middle = 0.5 * np.array(plan.sheet_mm)
    brush = with_factors(brush, {"lag": (studio.brush.lag,), "half_width": (studio.brush.half_width,)})
    run = _realised_passes(plan, studio, undone)
    try:
        marks = _core.simulate(_core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, run), brush, may_rise=True)
    except Error as refusal:
        if refusal.code == "depth-out-of-range" and _deepest_mm(plan.passes) <= brush.depth_range_mm[1]:
            refusal = Error(
                f"{refusal.sentence}, because the paper of the studio is too high there",
                refusal.where,
                refusal.value,
                refusal.range,
                code=refusal.code,
                advice="lower machine.height_mm in the studio file",
            )
        raise refusal from None
    if brush.paint:
        _core.narrow(marks, brush.paint, dips_mm or dips_without_cell(plan.passes))
    _core.trace_outlines(marks, brush)
    repeatable_rng = np.random.default_rng(0)  # the displacement of each stroke that repeats on this machine
    stroke_shifts = {a_pass.stroke: repeatable_rng.normal(0, 1, 2) * machine_errors.own_mm for a_pass in plan.passes}
    rng = np.random.default_rng(seed + 1)
    turn = rotation(np.radians(studio.sheet.turn_deg))
    out = []
    for mark in marks.passes:
        shift = stroke_shifts[mark.stroke] + rng.normal(0, 1, 2) * machine_errors.random_mm

        def on_sheet(points, shift=shift):
            return (np.asarray(points)[:, :2] + shift - middle) @ turn + middle + studio.sheet.shift_mm

        contact = np.asarray(mark.contact_mm, dtype=float).reshape(-1, 2)
        travelled_mm = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(contact, axis=0).T))])
        out.append(
            PaintedStroke(
                mark.stroke,
                [on_sheet(r) for r in mark.outline_mm],
                np.column_stack([on_sheet(contact), travelled_mm]),
            )
        )
    return out


def lower_paper(studio: Studio, plan, brush, undone: Machine | None) -> Studio:
    """Lower the studio's paper until no stroke is pressed beyond the depth range.

    A plan that exceeds the range itself leaves the studio unchanged.
    """
    most_mm = brush.depth_range_mm[1]
    beyond = _deepest_mm(_realised_passes(plan, studio, undone)) - most_mm
    if beyond <= 0 or _deepest_mm(plan.passes) > most_mm:
        return studio
    height_mm = round(studio.machine.height_mm - beyond - HEIGHT_MARGIN_MM, 4)
    return replace(studio, machine=replace(studio.machine, height_mm=height_mm))


def _deepest_mm(passes) -> float:
    return max((-float(np.min(np.asarray(a_pass.poses_mm)[:, 2])) for a_pass in passes), default=0.0)


def _realised_passes(plan, studio: Studio, undone: Machine | None) -> list:
    """Return the passes as the studio's machine executes them."""
    machine_errors = studio.machine
    middle = 0.5 * np.array(plan.sheet_mm)
    sheet_field = {
        "field_mm": (machine_errors.field_x_mm, machine_errors.field_y_mm),
        "field_middle_mm": tuple(middle),
        "field_reach_mm": tuple(middle),
    }
    field = sheet_field if np.any(sheet_field["field_mm"]) else {}
    machine = Machine(
        machine_errors.lean_mm_per_mm,
        machine_errors.scale,
        machine_errors.skew,
        machine_errors.height_mm,
        machine_errors.tilt_mm_per_mm,
        **field,
    )
    return as_run([_commanded_pass(a_pass, undone) for a_pass in plan.passes], machine, machine_errors.backlash_mm)


def _commanded_pass(a_pass, undone: Machine | None):
    poses = np.asarray(with_chords(a_pass).poses_mm, dtype=float).reshape(-1, 3)
    commanded = commanded_mm(in_lines_mm(poses, undone), undone)
    if undone and any(undone.backlash_mm):
        commanded = from_air_mm(commanded, undone.backlash_mm)
    return move_pass_to_path(a_pass, commanded, [])
