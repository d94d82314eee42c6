"""Corrections of the strokes of a plan, from the photograph of a painted job."""

from __future__ import annotations

import hashlib
import json
import math
import os
from dataclasses import asdict, dataclass, field, replace

import numpy as np

from .. import _core, json_fields
from ..errors import Error, name_file_in_errors
from ..files import read_bytes
from ..geometry.polylines import evenly
from ..geometry.rotation import rotation
from ..machine.cells.cell import Machine
from ..machine.realised.pass_on_path import move_pass_to_path
from .offset_width import offset_edges

FORMAT = "brushsvg/comparison"
RESIDUAL_KEY = "beside_machine"  # key of the file: the corrections that remain once the cell is corrected
MIN_MARKS = 3  # fewer marks do not separate the sheet's place from the places of its strokes
CORRECTIONS_KEY = "corrections"  # key of a corrected plan, for its corrections and the uncorrected plan
CORRECTION_KEYS = ("start_mm", "middle_mm", "shift_mm", "turn_deg", "wider_mm", "way_mm")
MAX_WIDER_MM = 1.0  # displacement of each edge: a mark that is wider by more is another brush's
# A larger displacement or turn of a mark has another cause, which must be found.
MAX_SHIFT_MM, MAX_TURN_DEG = 3.0, 3.0
# Deviation of a stroke's beginning and path, also in depth, within which it is the same stroke.
SAME_PATH_MM = 0.1
PATH_PLACES = 9  # number of places along a path, at equal lengths
# Replaces SAME_PATH_MM for a plan for another brush. Twice this brush's lag applies where that is longer.
OTHER_BRUSH_MM = 5.0


@dataclass(frozen=True)
class Correction:
    """The correction of one stroke.

    The stroke, whose path begins at start_mm of the sheet, is turned counter-clockwise by turn_deg about middle_mm and
    shifted by shift_mm. Its edges are moved outward by wider_mm. The correction is the residual for the brush of
    brush_sha256 and the machine of machine_sha256 ("" where it is unknown). replanned: the sheet was painted with a
    plan for another brush, so that strokes began elsewhere. way_mm: planned places of the TCP, see `way_of`; () where
    they are unknown.
    """

    stroke: str
    start_mm: tuple[float, float]
    middle_mm: tuple[float, float]
    shift_mm: tuple[float, float]
    turn_deg: float
    brush_sha256: str = ""
    replanned: bool = False
    machine_sha256: str = ""
    wider_mm: float = 0.0
    way_mm: tuple[tuple[float, ...], ...] = ()

    def moved(self, points_mm: np.ndarray) -> np.ndarray:
        """Return (n, 2) places on the sheet, corrected."""
        turned = (points_mm - self.middle_mm) @ rotation(math.radians(self.turn_deg))
        return turned + self.middle_mm + self.shift_mm


@dataclass(frozen=True)
class SheetBefore:
    """The contents of a file that `compare` wrote about a sheet.

    displacement_mm: displacement of each stroke that the file lists.
    """

    corrections: tuple[Correction, ...] = ()
    displacement_mm: dict[str, float] = field(default_factory=dict)


def way_of(a_pass) -> tuple[tuple[float, ...], ...]:
    """Return nine places (x, y, z) [mm] of the TCP along a pass.

    The places are at equal lengths, from the first to the last pose.
    """
    places = evenly(np.array(a_pass.poses_mm, dtype=float), PATH_PLACES)
    return tuple(tuple(place) for place in places.tolist())


def machine_sha256(machine: Machine | None) -> str:
    """Return a fingerprint of the machine errors that a cell compensates. A machine of None has no errors."""
    table = asdict(machine or Machine())
    known = {key: value for key, value in table.items() if value or not key.startswith("field")}
    return hashlib.sha256(json.dumps(known).encode()).hexdigest()


def select_for_machine(corrections: tuple[Correction, ...], machine: Machine | None) -> tuple[Correction, ...]:
    """Return the corrections that belong to this machine.

    Raises Error if all belong to other cells: they would correct again what a corrected cell already compensates.
    """
    sha256 = machine_sha256(machine)
    found = tuple(each for each in corrections if each.machine_sha256 in ("", sha256))
    if corrections and not found:
        raise Error(
            "the corrections were made for a cell with another table [machine]: use the cell that painted the sheet or "
            "the corrected cell, or compare the photograph again with the cell that painted the sheet",
            "machine_sha256",
            code="corrections-of-another-cell",
        )
    return found


def apply_corrections(plan, corrections: tuple[Correction, ...], brush):
    """Return the plan with its strokes corrected, for this brush.

    The plan must be made for this brush. The corrections are recorded in it. Corrections that the plan already has are
    replaced. Raises Error for corrections of another job or another brush. Corrections of a sheet must not repeat what
    the brush has already learnt from that sheet.
    """
    if not corrections:
        return plan
    plan, _ = remove_corrections(plan)
    _core.refuse_tilted(plan.passes, "corrections of strokes need an upright brush")
    of_brush_sha256 = corrections[0].brush_sha256
    if of_brush_sha256 and brush.sha256 and of_brush_sha256 != brush.sha256:
        raise Error(
            f"the corrections are for another brush (sha256 {of_brush_sha256[:12]}), not for {brush.name} "
            f"({brush.sha256[:12]}), which may already include part of them: compare the photograph again with this "
            "brush and the plan.json that was painted",
            "brush_sha256",
            code="corrections-of-another-brush",
        )
    remaining = {each.stroke: each for each in corrections}
    passes = []
    for a_pass in plan.passes:
        correction = remaining.pop(a_pass.stroke, None)
        passes.append(_correct_pass(a_pass, correction, brush) if correction else a_pass)
    if remaining:
        raise _other_job_error(next(iter(remaining)), "there is no such stroke")
    record = {
        "machine_sha256": corrections[0].machine_sha256,
        "strokes": [{"stroke": each.stroke, "correction": as_json(each)} for each in corrections],
        "plan": json.loads(_core.write_plan(plan)),
    }
    extra = json.dumps(json.loads(plan.extra or "{}") | {CORRECTIONS_KEY: record})
    return _core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, passes, extra)


def as_json(correction: Correction | None) -> dict | None:
    """Return a correction as files of `compare` and corrected plans contain it."""
    return {key: getattr(correction, key) for key in CORRECTION_KEYS} if correction else None


def is_corrected(plan) -> bool:
    return CORRECTIONS_KEY in json.loads(plan.extra or "{}")


def remove_corrections(plan) -> tuple[_core.Plan, tuple[Correction, ...]]:
    """Return the plan without its corrections, and the corrections.

    Raises Error for a plan of an earlier version, which states only how many strokes were corrected.
    """
    if not is_corrected(plan):
        return plan, ()
    record = json.loads(plan.extra)[CORRECTIONS_KEY]
    if isinstance(record, int):
        sentence = "the strokes were corrected by an earlier version of brushsvg, which did not keep the corrections"
        raise Error(
            sentence,
            CORRECTIONS_KEY,
            code="corrections-twice",
            advice="give the drawing, or the plan without corrections",
        )
    (record, before) = json_fields.objects(
        [record, record.get("plan") if isinstance(record, dict) else None], CORRECTIONS_KEY
    )
    before = _core.read_plan(json.dumps(before))
    if sorted(each.stroke for each in before.passes) != sorted(each.stroke for each in plan.passes):
        raise Error("these must be the strokes of the plan", f"{CORRECTIONS_KEY}.plan", code="wrong-type")
    corrections = _read_corrections(record, f"{CORRECTIONS_KEY}.", {})
    if unknown := {each.stroke for each in corrections} - {each.stroke for each in before.passes}:
        raise _other_job_error(min(unknown), "there is no such stroke")
    return before, corrections


def _correct_pass(a_pass, correction: Correction, brush):
    poses = np.array(a_pass.poses_mm, dtype=float)
    away_mm = math.dist(poses[0, :2], correction.start_mm)
    # A plan for a brush with no lag, or with three times the lag, begins up to two lags elsewhere.
    deepest_mm = min(max(-poses[:, 2].min(), brush.depth_range_mm[0]), brush.depth_range_mm[1])
    if away_mm > (max(OTHER_BRUSH_MM, 2 * brush.lag(deepest_mm)) if correction.replanned else SAME_PATH_MM):
        raise _other_job_error(
            a_pass.stroke, f"the stroke begins {away_mm:.2f} mm away from its place in the corrections"
        )
    if correction.way_mm and not correction.replanned:
        _refuse_other_way(a_pass, np.array(correction.way_mm))
    if correction.wider_mm:
        a_pass = offset_edges(a_pass, correction.wider_mm, brush)
        poses = np.array(a_pass.poses_mm, dtype=float)
    poses[:, :2] = correction.moved(poses[:, :2])
    arcs = [
        _core.Arc(arc.first, arc.last, tuple(correction.moved(np.array([arc.centre_mm]))[0]), arc.direction)
        for arc in a_pass.arcs
    ]
    return move_pass_to_path(a_pass, poses, arcs)


def _refuse_other_way(a_pass, known_mm: np.ndarray) -> None:
    """Raise Error where the brush moves further to the side, higher or lower than on the painted sheet."""
    difference_mm = np.array(way_of(a_pass)) - known_mm
    displacement_mm, deeper_mm = np.hypot(*difference_mm.T[:2]).max(), np.abs(difference_mm[:, 2]).max()
    if max(displacement_mm, deeper_mm) > SAME_PATH_MM:
        how = (
            f"{displacement_mm:.2f} mm further to the side"
            if displacement_mm > deeper_mm
            else f"{deeper_mm:.2f} mm higher or lower"
        )
        raise _other_job_error(
            a_pass.stroke,
            f"the path of the brush is up to {how} than on the painted sheet, for example because of another width or "
            "tolerance",
        )


def _other_job_error(stroke: str, why: str) -> Error:
    return Error(
        f"the corrections are for another job, or for other flags: {why}",
        stroke,
        code="corrections-of-another-job",
    )


def read_sheet_before(path: str | os.PathLike[str]) -> SheetBefore:
    """Read a file that `compare -o FILE.json` wrote.

    Raises Error, with the path in `file` and the key in `where`, when a value is damaged or when the file has no
    corrections.
    """
    with name_file_in_errors(path):
        content = json_fields.document(read_bytes(path), FORMAT)
        sha256, planned = (_read_sha256(content, key) for key in ("brush_sha256", "plan_brush_sha256"))
        of_brush = {"brush_sha256": sha256, "replanned": bool(planned) and planned != sha256}
        found = _read_corrections(content, "", of_brush)
        if content.get(RESIDUAL_KEY) is not None:
            (after_cell,) = json_fields.objects([content[RESIDUAL_KEY]], RESIDUAL_KEY)
            found += _read_corrections(after_cell, f"{RESIDUAL_KEY}.", of_brush)
        if not found:
            raise Error(_explain_no_corrections(content["strokes"]), "strokes", code="corrections-missing")
    return SheetBefore(found, _read_displacements_mm(content["strokes"]))


def _explain_no_corrections(rows: list[dict]) -> str:
    found_count = sum(row.get("found") is True for row in rows)
    if 0 < found_count < MIN_MARKS:
        return (
            f"the file has no corrections: {found_count} {'mark was' if found_count == 1 else 'marks were'} found, "
            f"but at least {MIN_MARKS} are needed to separate displaced strokes from a displaced sheet"
        )
    if found_count:
        return f"the file has no corrections: none of {found_count} marks was seen well enough and near its prediction"
    return "the file has no corrections: the photograph did not show the places of marks"


def _read_corrections(content: dict, at: str, of_brush: dict) -> tuple[Correction, ...]:
    rows = json_fields.objects(content.get("strokes"), f"{at}strokes")
    machine = _read_sha256(content, "machine_sha256", at)
    found = tuple(
        replace(_read_correction(row, f"{at}strokes[{k}]"), **of_brush, machine_sha256=machine)
        for k, row in enumerate(rows)
        if row.get("correction") is not None
    )
    names = [each.stroke for each in found]
    if twice := [name for name in names if names.count(name) > 1]:
        raise Error(f"stroke {twice[0][:40]!r} is listed twice", f"{at}strokes", code="stroke-twice")
    return found


def _read_sha256(content: dict, key: str, at: str = "") -> str:
    value = content.get(key, "")
    if not isinstance(value, str):
        raise Error("this must be a text", f"{at}{key}", code="wrong-type")
    return value


def _read_displacements_mm(rows: list[dict]) -> dict[str, float]:
    pairs = [(row.get("stroke"), row.get("aside_mm")) for row in rows]
    return {
        name: float(mm)
        for name, mm in pairs
        if isinstance(name, str) and isinstance(mm, int | float) and not isinstance(mm, bool)
    }


def _read_correction(row: dict, where: str) -> Correction:
    (values,) = json_fields.objects([row["correction"]], f"{where}.correction")
    stroke, at = row.get("stroke"), f"{where}.correction"
    if not isinstance(stroke, str):
        raise Error("this must be the name of a stroke", f"{where}.stroke", code="wrong-type")
    places = (json_fields.numbers(values.get(key), f"{at}.{key}", 2) for key in ("start_mm", "middle_mm"))
    shift_mm = json_fields.numbers(values.get("shift_mm"), f"{at}.shift_mm", 2)
    json_fields.number(math.hypot(*shift_mm), f"{at}.shift_mm", 0.0, MAX_SHIFT_MM)
    turn_deg = json_fields.number(values.get("turn_deg"), f"{at}.turn_deg", -MAX_TURN_DEG, MAX_TURN_DEG)
    wider_mm = json_fields.number(values.get("wider_mm", 0.0), f"{at}.wider_mm", -MAX_WIDER_MM, MAX_WIDER_MM)
    return Correction(
        stroke,
        *places,
        shift_mm,
        turn_deg,
        wider_mm=wider_mm,
        way_mm=_read_path(values.get("way_mm"), f"{at}.way_mm"),
    )


def _read_path(places, at: str) -> tuple[tuple[float, ...], ...]:
    if places is None:  # files of earlier versions have no path
        return ()
    if not isinstance(places, list) or len(places) != PATH_PLACES:
        raise Error(f"this must be a list of {PATH_PLACES} places", at, code="wrong-type")
    return tuple(json_fields.numbers(place, f"{at}[{k}]", 3) for k, place in enumerate(places))
