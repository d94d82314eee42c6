"""What a studio paints of a plan, by the same model that predicts it."""

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
from ..machine.realised.passes import as_run
from ..machine.realised.retimed import on_way
from ..model.perturbed import with_factors
from .studio import Studio

LOWER_MM = 0.02  # more than the tilt's and scale's part in a change of height


@dataclass(frozen=True)
class PaintedStroke:
    """rings: on the sheet; way: (n, 3) x, y of the brush's contact and its distance so far, mm."""

    stroke: str
    rings: list[np.ndarray]
    way: np.ndarray


def painted(
    plan, brush, studio: Studio, undone: Machine | None, seed: int, dips_mm=None
) -> list[PaintedStroke]:
    """undone: what the cell undoes of the machine's errors; dips_mm: where along each stroke paint was fetched, of a
    brush whose marks narrow until then, by default at its beginning. Error where the brush would be pressed beyond its
    range."""
    off = studio.machine
    middle = 0.5 * np.array(plan.sheet_mm)
    brush = with_factors(brush, {"lag": (studio.brush.lag,), "half_width": (studio.brush.half_width,)})
    run = _as_run(plan, studio, undone)
    try:
        marks = _core.simulate(
            _core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, run), brush, may_rise=True
        )
    except Error as refusal:
        if refusal.code == "depth-out-of-range" and _deepest_mm(plan.passes) <= brush.depth_range_mm[1]:
            refusal = Error(
                f"{refusal.sentence}, at the height of the studio's paper there",
                refusal.where,
                refusal.value,
                refusal.range,
                code=refusal.code,
                advice="give machine.height_mm a lower value",
            )
        raise refusal from None
    if brush.paint:
        _core.narrow(marks, brush.paint, dips_mm or dips_without_cell(plan.passes))
    _core.trace_outlines(marks, brush)
    always = np.random.default_rng(0)  # of this machine: the part that repeats
    own = {one.stroke: always.normal(0, 1, 2) * off.own_mm for one in plan.passes}
    random = np.random.default_rng(seed + 1)
    turn = rotation(np.radians(studio.sheet.turn_deg))
    out = []
    for mark in marks.passes:
        shift = own[mark.stroke] + random.normal(0, 1, 2) * off.random_mm

        def laid(points, shift=shift):
            return (np.asarray(points)[:, :2] + shift - middle) @ turn + middle + studio.sheet.shift_mm

        contact = np.asarray(mark.contact_mm, dtype=float).reshape(-1, 2)
        come = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(contact, axis=0).T))])
        out.append(
            PaintedStroke(
                mark.stroke, [laid(r) for r in mark.outline_mm], np.column_stack([laid(contact), come])
            )
        )
    return out


def low_enough(studio: Studio, plan, brush, undone: Machine | None) -> Studio:
    """Return the studio, its paper so low that no stroke is pressed beyond the brush's range, unless the plan asks for
    it."""
    most_mm = brush.depth_range_mm[1]
    beyond = _deepest_mm(_as_run(plan, studio, undone)) - most_mm
    if beyond <= 0 or _deepest_mm(plan.passes) > most_mm:
        return studio
    height_mm = round(studio.machine.height_mm - beyond - LOWER_MM, 4)
    return replace(studio, machine=replace(studio.machine, height_mm=height_mm))


def _deepest_mm(passes) -> float:
    return max((-float(np.min(np.asarray(one.poses_mm)[:, 2])) for one in passes), default=0.0)


def _as_run(plan, studio: Studio, undone: Machine | None) -> list:
    """The passes as the studio's machine runs them."""
    off = studio.machine
    middle = 0.5 * np.array(plan.sheet_mm)
    over_sheet = {
        "field_mm": (off.field_x_mm, off.field_y_mm),
        "field_middle_mm": tuple(middle),
        "field_reach_mm": tuple(middle),
    }
    bent = over_sheet if np.any(over_sheet["field_mm"]) else {}
    machine = Machine(off.lean_mm_per_mm, off.scale, off.skew, off.height_mm, off.tilt_mm_per_mm, **bent)
    return as_run([_commanded(one, undone) for one in plan.passes], machine, off.backlash_mm)


def _commanded(a_pass, undone: Machine | None):
    poses = np.asarray(with_chords(a_pass).poses_mm, dtype=float).reshape(-1, 3)
    commanded = commanded_mm(in_lines_mm(poses, undone), undone)
    if undone and any(undone.backlash_mm):
        commanded = from_air_mm(commanded, undone.backlash_mm)
    return on_way(a_pass, commanded, [])
