"""Corrections that a painted job teaches for the next one: by how much each stroke is moved."""

from __future__ import annotations

import hashlib
import json
import math
import os
from dataclasses import asdict, dataclass, field, replace

import numpy as np

from .. import _core, json_fields
from ..errors import Error
from ..files import read_bytes
from ..geometry.polylines import evenly
from ..geometry.rotation import rotation
from ..machine.cells.cell import Machine
from ..machine.realised.retimed import on_way
from .offset_width import wider

FORMAT = "brushsvg/comparison"
RESIDUAL = "beside_machine"  # of the file: what is left of each stroke once the cell is corrected
LEAST_MARKS = 3  # fewer do not separate a sheet's place from their own
MARK = "corrections"  # key of a corrected plan: the corrections and the plan before
KEYS = ("start_mm", "middle_mm", "shift_mm", "turn_deg", "wider_mm", "way_mm")
MOST_WIDER_MM = 1.0  # of each edge: a mark that is off by more is another brush's
MOST_MM, MOST_DEG = 3.0, 3.0  # a mark that is further off has a cause to be found
SAME_MM = 0.1  # where the same stroke begins, and where its way leads, in depth as well: less is within a correction
PLACES = 9  # of a way, equal lengths apart
OTHER_LAG_MM = (
    5.0  # the same where it was planned for another brush, or twice this brush's lag where that is longer
)


@dataclass(frozen=True)
class Correction:
    """A stroke, whose way begins at start_mm of the sheet, is turned counter-clockwise by turn_deg about middle_mm and
    shifted by shift_mm, its edges moved out by wider_mm: what is left once the brush of brush_sha256 and the machine
    of machine_sha256 ("" where that is not known) are known. replanned: the sheet was painted by a plan for another
    brush, so that strokes began elsewhere. way_mm: places of the TCP as it was planned, see `way_of`, () where that is
    not known."""

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
    """The contents of a file that `compare` wrote of a sheet. displacement_mm: by stroke its displacement there,
    without those that the file does not have."""

    corrections: tuple[Correction, ...] = ()
    displacement_mm: dict[str, float] = field(default_factory=dict)


def way_of(a_pass) -> tuple[tuple[float, ...], ...]:
    """Nine places (x, y, z) [mm] of its TCP, equal lengths apart, the first and the last pose among them."""
    places = evenly(np.array(a_pass.poses_mm, dtype=float), PLACES)
    return tuple(tuple(place) for place in places.tolist())


def machine_sha256(machine: Machine | None) -> str:
    """Of what a cell undoes of its machine; None undoes nothing."""
    table = asdict(machine or Machine())
    known = {key: value for key, value in table.items() if value or not key.startswith("field")}
    return hashlib.sha256(json.dumps(known).encode()).hexdigest()


def select_for_machine(
    corrections: tuple[Correction, ...], machine: Machine | None
) -> tuple[Correction, ...]:
    """Return the corrections that belong to this machine.

    Error if they belong to other cells: they would correct again what a corrected cell already undoes.
    """
    sha256 = machine_sha256(machine)
    found = tuple(each for each in corrections if each.machine_sha256 in ("", sha256))
    if corrections and not found:
        raise Error(
            "the corrections were made for another table [machine] than this cell's: use the cell that painted or the "
            "corrected one, or compare the photograph again with the cell that painted",
            "machine_sha256",
            code="corrections-of-another-cell",
        )
    return found


def corrected(plan, corrections: tuple[Correction, ...], brush):
    """The plan, made for this brush, with its strokes moved, and a note of that. Corrections that it has already are
    replaced. Error for corrections of another job, or of another brush: what a brush has learnt from a sheet,
    corrections of that sheet would undo again."""
    if not corrections:
        return plan
    plan, _ = uncorrected(plan)
    _core.refuse_tilted(plan.passes, "strokes are corrected for a brush held upright")
    of_brush_sha256 = corrections[0].brush_sha256
    if of_brush_sha256 and brush.sha256 and of_brush_sha256 != brush.sha256:
        raise Error(
            f"the corrections are residuals of another brush (sha256 {of_brush_sha256[:12]}), not of "
            f"{brush.name} ({brush.sha256[:12]}), which may know part of it: compare the photograph again with this "
            "brush, and with the plan.json that was painted",
            "brush_sha256",
            code="corrections-of-another-brush",
        )
    left = {each.stroke: each for each in corrections}
    passes = []
    for a_pass in plan.passes:
        correction = left.pop(a_pass.stroke, None)
        passes.append(_corrected(a_pass, correction, brush) if correction else a_pass)
    if left:
        raise _of_another_job(next(iter(left)), "there is no such stroke")
    said = {
        "machine_sha256": corrections[0].machine_sha256,
        "strokes": [{"stroke": each.stroke, "correction": as_json(each)} for each in corrections],
        "plan": json.loads(_core.write_plan(plan)),
    }
    extra = json.dumps(json.loads(plan.extra or "{}") | {MARK: said})
    return _core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, passes, extra)


def as_json(correction: Correction | None) -> dict | None:
    """A correction as the files of `compare` and corrected plans hold it."""
    return {key: getattr(correction, key) for key in KEYS} if correction else None


def is_corrected(plan) -> bool:
    return MARK in json.loads(plan.extra or "{}")


def uncorrected(plan) -> tuple[_core.Plan, tuple[Correction, ...]]:
    """Return the plan without its corrections, and the corrections.

    Error for a plan of an earlier version, which says only how many strokes were corrected.
    """
    if not is_corrected(plan):
        return plan, ()
    said = json.loads(plan.extra)[MARK]
    if isinstance(said, int):
        sentence = "its strokes were corrected by a version of brushsvg that did not keep the corrections"
        raise Error(
            sentence, MARK, code="corrections-twice", advice="give the drawing or the plan without them"
        )
    (said, before) = json_fields.objects([said, said.get("plan") if isinstance(said, dict) else None], MARK)
    before = _core.read_plan(json.dumps(before))
    if sorted(each.stroke for each in before.passes) != sorted(each.stroke for each in plan.passes):
        raise Error("these must be the strokes of the plan", f"{MARK}.plan", code="wrong-type")
    return before, _strokes(said, f"{MARK}.", {})


def _corrected(a_pass, correction: Correction, brush):
    poses = np.array(a_pass.poses_mm, dtype=float)
    away_mm = math.dist(poses[0, :2], correction.start_mm)
    # a plan for a brush that trails by nothing, or three times as far, begins up to two lags elsewhere
    deepest_mm = min(max(-poses[:, 2].min(), brush.depth_range_mm[0]), brush.depth_range_mm[1])
    if away_mm > (max(OTHER_LAG_MM, 2 * brush.lag(deepest_mm)) if correction.replanned else SAME_MM):
        raise _of_another_job(a_pass.stroke, f"it begins {away_mm:.2f} mm from where they say")
    if correction.way_mm and not correction.replanned:
        _refuse_other_way(a_pass, np.array(correction.way_mm))
    if correction.wider_mm:
        a_pass = wider(a_pass, correction.wider_mm, brush)
        poses = np.array(a_pass.poses_mm, dtype=float)
    poses[:, :2] = correction.moved(poses[:, :2])
    arcs = [
        _core.Arc(arc.first, arc.last, tuple(correction.moved(np.array([arc.centre_mm]))[0]), arc.direction)
        for arc in a_pass.arcs
    ]
    return on_way(a_pass, poses, arcs)


def _refuse_other_way(a_pass, known_mm: np.ndarray) -> None:
    """Warn where the brush is moved, or deeper or less deep than when the sheet was painted."""
    off = np.array(way_of(a_pass)) - known_mm
    displacement_mm, deeper_mm = np.hypot(*off.T[:2]).max(), np.abs(off[:, 2]).max()
    if max(displacement_mm, deeper_mm) > SAME_MM:
        how = (
            f"{displacement_mm:.2f} mm to the side"
            if displacement_mm > deeper_mm
            else f"{deeper_mm:.2f} mm higher or lower"
        )
        raise _of_another_job(
            a_pass.stroke,
            f"the brush is up to {how} of where it was, for example by another width or tolerance",
        )


def _of_another_job(stroke: str, why: str) -> Error:
    return Error(
        f"the corrections are of another job, or of other flags: {why}",
        stroke,
        code="corrections-of-another-job",
    )


def read_sheet_before(path: str | os.PathLike[str]) -> SheetBefore:
    """What `compare -o FILE.json` wrote. Error, with the path in `file` and the key in `where`, when a value is
    damaged, or when it holds no corrections."""
    try:
        content = json_fields.document(read_bytes(path), FORMAT)
        sha256, planned = (_sha256(content, key) for key in ("brush_sha256", "plan_brush_sha256"))
        of_brush = {"brush_sha256": sha256, "replanned": bool(planned) and planned != sha256}
        found = _strokes(content, "", of_brush)
        if content.get(RESIDUAL) is not None:
            (corrected,) = json_fields.objects([content[RESIDUAL]], RESIDUAL)
            found += _strokes(corrected, f"{RESIDUAL}.", of_brush)
        if not found:
            raise Error(_why_none(content["strokes"]), "strokes", code="corrections-missing")
    except Error as refusal:
        refusal.file = os.fspath(path)
        raise
    return SheetBefore(found, _displacement_mm(content["strokes"]))


def _why_none(rows: list[dict]) -> str:
    seen = sum(row.get("found") is True for row in rows)
    if 0 < seen < LEAST_MARKS:
        return (
            f"it corrects no stroke: {seen} of its marks {'was' if seen == 1 else 'were'} found, and at least "
            f"{LEAST_MARKS} are needed to separate a stroke's own place from the sheet's"
        )
    if seen:
        return f"it corrects no stroke: of {seen} marks none is seen well enough, and near enough to its prediction"
    return "it corrects no stroke: the photograph did not show the places of marks"


def _strokes(content: dict, at: str, of_brush: dict) -> tuple[Correction, ...]:
    rows = json_fields.objects(content.get("strokes"), f"{at}strokes")
    machine = _sha256(content, "machine_sha256", at)
    found = tuple(
        replace(_read(row, f"{at}strokes[{k}]"), **of_brush, machine_sha256=machine)
        for k, row in enumerate(rows)
        if row.get("correction") is not None
    )
    names = [each.stroke for each in found]
    if twice := [name for name in names if names.count(name) > 1]:
        raise Error(f"stroke {twice[0][:40]!r} stands twice", f"{at}strokes", code="stroke-twice")
    return found


def _sha256(content: dict, key: str, at: str = "") -> str:
    said = content.get(key, "")
    if not isinstance(said, str):
        raise Error("this must be a text", f"{at}{key}", code="wrong-type")
    return said


def _displacement_mm(rows: list[dict]) -> dict[str, float]:
    said = [(row.get("stroke"), row.get("aside_mm")) for row in rows]
    return {
        name: float(mm)
        for name, mm in said
        if isinstance(name, str) and isinstance(mm, int | float) and not isinstance(mm, bool)
    }


def _read(row: dict, where: str) -> Correction:
    (said,) = json_fields.objects([row["correction"]], f"{where}.correction")
    stroke, at = row.get("stroke"), f"{where}.correction"
    if not isinstance(stroke, str):
        raise Error("this must be the name of a stroke", f"{where}.stroke", code="wrong-type")
    places = (json_fields.numbers(said.get(key), f"{at}.{key}", 2) for key in ("start_mm", "middle_mm"))
    shift_mm = json_fields.numbers(said.get("shift_mm"), f"{at}.shift_mm", 2)
    json_fields.number(math.hypot(*shift_mm), f"{at}.shift_mm", 0.0, MOST_MM)
    turn_deg = json_fields.number(said.get("turn_deg"), f"{at}.turn_deg", -MOST_DEG, MOST_DEG)
    wider_mm = json_fields.number(said.get("wider_mm", 0.0), f"{at}.wider_mm", -MOST_WIDER_MM, MOST_WIDER_MM)
    return Correction(
        stroke,
        *places,
        shift_mm,
        turn_deg,
        wider_mm=wider_mm,
        way_mm=_way(said.get("way_mm"), f"{at}.way_mm"),
    )


def _way(said, at: str) -> tuple[tuple[float, ...], ...]:
    if said is None:  # of a file from before it was written
        return ()
    if not isinstance(said, list) or len(said) != PLACES:
        raise Error(f"this must be a list of {PLACES} places", at, code="wrong-type")
    return tuple(json_fields.numbers(place, f"{at}[{k}]", 3) for k, place in enumerate(said))
