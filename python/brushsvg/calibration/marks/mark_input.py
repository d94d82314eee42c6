"""Read painted marks and their TCP paths from a measurement file.

Nonsense is refused.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ... import _core, json_fields
from ...errors import Error, list_first
from ...geometry import polylines

# Greatest distance of a mark from its stroke. Lag, shift of the sheet and displacement together are shorter.
MAX_MARK_DISTANCE_MM = 60.0
MAX_EXTRA_WIDTH_MM = 60.0  # no brush paints a mark that is this much wider than its stroke
MIN_AREA_MM2 = 0.1  # least area of a mark
MAX_COORDINATE_MM = 1e6  # greatest coordinate
MIN_TURNING_RAD = 0.35  # if all strokes turn less than this in total, lag looks like a displacement
UPRIGHT = "brushes are calibrated with marks of an upright brush"
MIN_PAINTED_MM = 5.0  # a depth counts if at least this length was painted at it
DEPTH_BINS = 20  # bins from 0 to the greatest depth
DAB = "dab"  # kind of stroke in the settings of a plan: set down and lifted without moving along the paper
UNIT_FACTORS = ((1 / 1000, "metres"), (1 / 25.4, "inches"), (0.1, "centimetres"), (25.4, "points or pixels"))
# Possible confusions of the sides of a sheet: matrix from plan to sheet, and its description
SHEET_ORIENTATIONS = (
    (((-1, 0), (0, -1)), "turned by 180 degrees"),
    (((0, -1), (1, 0)), "turned by 90 degrees, counter-clockwise"),
    (((0, 1), (-1, 0)), "turned by 90 degrees, clockwise"),
    (((-1, 0), (0, 1)), "mirrored (x must go right)"),
    (((1, 0), (0, -1)), "upside down (y must go up)"),
    (((0, 1), (1, 0)), "with x and y exchanged"),
    (((0, -1), (-1, 0)), "with x and y exchanged and both reversed"),
)


@dataclass(frozen=True)
class Painted:
    """The marks of one sheet.

    depths: number of different painted depths. before_mm: for each stroke, the path length of the TCP on the paper
    along all earlier strokes of the plan, if known. way_mm: path length along all strokes.
    """

    marks: list
    deepest_mm: float
    depths: int
    before_mm: dict[str, float] = field(default_factory=dict)
    way_mm: float = 0.0

    def without(self, strokes: set[str]) -> Painted:
        """Return the marks without some strokes. Raises Error if the remaining marks are not informative."""
        remaining = to_painted([mark for mark in self.marks if mark.stroke not in strokes])
        return replace(remaining, before_mm=self.before_mm, way_mm=self.way_mm)


def read_painted(plan: str | dict, marks: str | list, read: Callable[[str], bytes]) -> Painted:
    """Read the painted marks of a plan.

    plan: a path, or the contents of a plan.json. marks: the path of a marks.json, or a list of
    {"stroke", "outline_mm"}. read: returns the bytes of the file at a path. Raises Error, which names the mark or the
    key.
    """
    passes = _read_passes(plan, read)
    rows = _read_outlines(marks, read)
    found, used_strokes = [], set()
    for i, (stroke, outline) in enumerate(rows):
        where = f"marks[{i}]"
        if stroke not in passes:
            listed = list_first([name[:60] for name in passes], 5)
            sentence = f"there is no stroke {stroke[:60]!r} in the plan; it has {listed}"
            raise Error(sentence, where, code="stroke-unknown")
        if stroke in used_strokes:
            sentence = f"stroke {stroke[:60]!r} has two marks: join their outlines to one"
            raise Error(sentence, where, code="stroke-twice")
        used_strokes.add(stroke)
        rings = [_read_ring(ring, f"{where}.outline_mm[{k}]") for k, ring in enumerate(outline)]
        if not rings:
            raise Error("the mark has no outline: leave out marks that were not painted", where, code="mark-empty")
        found.append((stroke, np.array(passes[stroke].poses_mm), rings))
    if not found:
        raise Error("there are no marks", "marks", code="measurement-missing")
    _refuse_other_frames(found)
    _refuse_foreign_outlines(found)
    painted_as = {stroke: number for number, stroke in enumerate(passes)}
    whole = to_painted(
        [
            _core.PaintedMark(stroke, poses, _orient_rings(rings), passes[stroke].arcs)
            for stroke, poses, rings in sorted(found, key=lambda mark: painted_as[mark[0]])
        ]
    )
    before_mm, way_mm = measure_paths_before_mm(passes)
    return replace(whole, before_mm=before_mm, way_mm=way_mm)


def measure_paths_before_mm(passes: dict[str, _core.Pass]) -> tuple[dict[str, float], float]:
    """Return the TCP path length on the paper before each stroke, and in total."""
    ways = [polylines.length(np.array(plan_pass.poses_mm)[:, :2]) for plan_pass in passes.values()]
    *before, way_mm = np.cumsum([0.0, *ways]).tolist()
    return dict(zip(passes, before, strict=True)), way_mm


def to_painted(marks: list) -> Painted:
    """Return the marks as Painted. Raises Error if they are not informative about a brush."""
    ways = [np.array(mark.poses_mm) for mark in marks]
    _refuse_uninformative(ways)
    return Painted(marks, max(float(-poses[:, 2].min()) for poses in ways), count_painted_depths(ways))


def _read_passes(plan, read) -> dict[str, _core.Pass]:
    if isinstance(plan, str):
        try:
            parsed = _core.read_plan(read(plan).decode("utf-8", "replace"))
        except Error as refusal:
            raise Error(f"{plan[:200]}: {refusal}", "plan", refusal.value, code=refusal.code) from None
    elif isinstance(plan, dict):
        whole = {"format": "brushsvg/plan", "version": 1, "brush": "", "brush_sha256": "", "sheet_mm": [1, 1]}
        try:
            parsed = _core.read_plan(json.dumps(whole | plan))
        except Error as refusal:
            raise Error(str(refusal), f"plan.{refusal.where}", refusal.value, code=refusal.code) from None
    else:
        raise Error('marks need "plan": the path of the plan.json that was painted', "plan", code="key-missing")
    _core.refuse_tilted(parsed.passes, UPRIGHT)
    passes: dict[str, _core.Pass] = {}
    for number, plan_pass in enumerate(parsed.passes, 1):
        name = plan_pass.stroke or f"stroke{number}"
        if name in passes:
            raise Error(f"two passes paint stroke {name[:60]!r}: give each its own name", "plan", code="stroke-twice")
        if plan_pass.settings.kind == DAB:
            raise Error(
                f"{name[:60]!r} is a dab: dabs show the outline of the brush, but not its lag",
                "plan",
                code="dabs-tell-no-lag",
                advice="brushsvg calibrate PHOTO --chart CHART.json --brush BRUSH",
            )
        passes[name] = plan_pass
    return passes


def _read_outlines(marks, read) -> list[tuple[str, list]]:
    if isinstance(marks, str):
        try:
            read_marks = _core.read_marks(read(marks).decode("utf-8", "replace"))
        except Error as refusal:
            raise Error(f"{marks[:200]}: {refusal}", "marks", refusal.value, code=refusal.code) from None
        return [(mark.stroke, [np.array(ring) for ring in mark.outline_mm]) for mark in read_marks.passes]
    out = []
    for i, row in enumerate(json_fields.objects(marks, "marks", ", or the path of a marks.json")):
        json_fields.refuse_unknown(row, ("stroke", "outline_mm", "note"), f"marks[{i}]")
        for key, kind, what in (("stroke", str, "a stroke's id"), ("outline_mm", list, "a list of rings")):
            if not isinstance(row.get(key), kind):
                raise Error(f"{key} must be {what}", f"marks[{i}]", code="wrong-type")
        out.append((row["stroke"], row["outline_mm"]))
    return out


def _read_ring(points, where: str) -> np.ndarray:
    try:
        ring = np.array(points)
        has_truths = isinstance(points, list) and any(isinstance(v, bool) for point in points for v in point)
        ring = ring.astype(float) if ring.dtype.kind in "iuf" and not has_truths else np.zeros(0)
    except (TypeError, ValueError):
        ring = np.zeros(0)
    if ring.ndim != 2 or ring.shape[0] < 3 or ring.shape[1] != 2:
        raise Error("a ring is a list of three or more points [x, y]", where, code="wrong-type")
    if not np.isfinite(ring).all():
        raise Error("a coordinate is not a finite number", where, code="not-finite")
    if (farthest := float(np.abs(ring).max())) > MAX_COORDINATE_MM:
        sentence = (
            f"a coordinate of {farthest:.4g} mm is outside the range [-{MAX_COORDINATE_MM:g}, {MAX_COORDINATE_MM:g}] mm"
        )
        raise Error(sentence, where, farthest, code="out-of-range")
    return ring


def _orient_rings(rings: list[np.ndarray]) -> list[np.ndarray]:
    """Return the shape that the rings fill. Outer rings are counter-clockwise, holes clockwise."""
    return [np.array(ring) for ring in _core.fill(rings, "evenodd")] or rings


def find_box_middle(points: np.ndarray) -> np.ndarray:
    """Return the middle of the bounding box of points (n, 2)."""
    return 0.5 * (points.min(axis=0) + points.max(axis=0))


def _refuse_other_frames(found: list) -> None:
    """Raise Error for wrong units, a wrong direction of y, and exchanged marks.

    They show in the positions of marks relative to their strokes. found: (stroke, poses, rings) of each mark.
    """
    planned = np.array([find_box_middle(poses[:, :2]) for _, poses, _ in found])
    marked = np.array([find_box_middle(np.vstack(rings)) for _, _, rings in found])
    spread = lambda points: float(np.hypot(*np.std(points, axis=0)))  # noqa: E731
    sizes = lambda points: float(np.hypot(*np.ptp(points, axis=0)))  # noqa: E731
    lengths = [sizes(poses[:, :2]) for _, poses, _ in found]
    spans = [sizes(np.vstack(rings)) for _, _, rings in found]
    scale = float(np.median(np.array(spans) / np.maximum(lengths, 1.0)))
    for factor, name in UNIT_FACTORS:
        if abs(math.log(max(scale, 1e-12) / factor)) < 0.5 and max(lengths) > 5.0:
            raise Error(
                f"the marks are {scale:.3g} times as long as their strokes: check whether the outlines are in {name}, "
                "and write them in mm",
                "marks",
                code="marks-scaled",
            )
    own_distances = np.hypot(*(marked - planned).T)
    if len(found) > 2 and spread(planned) > 10.0:
        flipped = marked * [1, -1]
        rigid = lambda points: np.median(  # noqa: E731
            np.hypot(*(points - planned - np.median(points - planned, axis=0)).T)
        )
        if rigid(flipped) < 0.3 * rigid(marked) and rigid(marked) > 10.0:
            sentence = "the sheet of the marks is upside down: y must go up, from the lower left corner"
            raise Error(sentence, "marks", code="marks-displaced")
    if own_distances.max() <= MAX_MARK_DISTANCE_MM and len(found) < 2:
        return
    _refuse_moved_sheet(planned, marked)
    distances = np.hypot(*np.moveaxis(marked[:, None] - planned[None], 2, 0))
    nearest = distances.argmin(axis=1)
    wrong = [
        i
        for i, j in enumerate(nearest)
        if j != i and distances[i, j] < 0.5 * own_distances[i] and own_distances[i] > 15.0
    ]
    for i in wrong:
        if nearest[i] in wrong or own_distances[i] > MAX_MARK_DISTANCE_MM:
            raise Error(
                f"the mark of stroke {found[i][0]!r} is {own_distances[i]:.0f} mm away from that stroke, where stroke "
                f"{found[nearest[i]][0]!r} was painted: give each mark the id of its stroke",
                f"marks[{i}]",
                code="mark-off-stroke",
            )
    worst = int(own_distances.argmax())
    if own_distances[worst] > MAX_MARK_DISTANCE_MM:
        raise Error(
            f"the mark of stroke {found[worst][0]!r} is {own_distances[worst]:.0f} mm away from that stroke, more than "
            f"{MAX_MARK_DISTANCE_MM:g} mm: check that plan and marks belong to one sheet, and that both are in mm from "
            "its lower left corner",
            f"marks[{worst}]",
            code="mark-off-stroke",
        )


def _refuse_moved_sheet(planned: np.ndarray, seen: np.ndarray) -> None:
    """Raise Error for a sheet that is turned, mirrored, scaled or shifted as a whole.

    planned, seen: middles (n, 2) of strokes and marks.
    """
    centred_plan = planned - planned.mean(axis=0)
    if len(centred_plan) < 5 or np.linalg.matrix_rank(centred_plan, tol=10.0) < 2:
        return
    centred_marks = seen - seen.mean(axis=0)
    slopes = np.linalg.lstsq(centred_plan, centred_marks, rcond=None)[0].T
    size = math.sqrt(abs(np.linalg.det(slopes)))
    if not size > 0 or np.linalg.norm(centred_marks - centred_plan @ slopes.T) > 0.2 * np.linalg.norm(centred_marks):
        return  # not a single movement of the sheet
    for matrix, words in SHEET_ORIENTATIONS:
        if np.linalg.norm(slopes / size - matrix) < 0.5:
            raise Error(
                f"the sheet of the marks is {words}: measure outlines from the lower left corner of the plan's sheet",
                "marks",
                code="marks-displaced",
            )
    if abs(size - 1) > 0.2:
        raise Error(
            f"the marks are {size:.3g} times as far apart as their strokes: check whether the outlines are in pixels "
            "or were scanned at another scale, and write them in mm",
            "marks",
            code="marks-scaled",
        )
    if (shift := float(np.hypot(*(seen - planned).mean(axis=0)))) > 0.5 * MAX_MARK_DISTANCE_MM:
        raise Error(
            f"all marks are {shift:.0f} mm away from their strokes, in one direction: measure outlines from the lower "
            "left corner of the plan's sheet",
            "marks",
            code="marks-displaced",
        )


def _refuse_foreign_outlines(found: list) -> None:
    """Raise Error for outlines that are no paint, such as the page's border; the fit would need minutes for it."""
    for i, (stroke, poses, rings) in enumerate(found):
        if (area := _core.area(_orient_rings(rings))) < MIN_AREA_MM2:
            raise Error(
                f"the mark of stroke {stroke!r} has an area of {area:.2g} mm^2, less than {MIN_AREA_MM2:g}: leave out "
                "marks that were not painted",
                f"marks[{i}]",
                code="mark-empty",
            )
        way = np.ptp(poses[:, :2], axis=0)
        for k, ring in enumerate(rings):
            excess = float(np.max(np.ptp(ring, axis=0) - way))
            if excess > MAX_EXTRA_WIDTH_MM:
                raise Error(
                    f"a ring of the mark of stroke {stroke!r} is {excess:.0f} mm wider than its stroke, more than "
                    f"{MAX_EXTRA_WIDTH_MM:g} mm: leave out outlines that are not paint, such as the border of the page",
                    f"marks[{i}].outline_mm[{k}]",
                    code="mark-too-large",
                )


def count_painted_depths(ways: list[np.ndarray]) -> int:
    """Count the depths at which MIN_PAINTED_MM or more was painted.

    Depths are in bins of a twentieth of the deepest.
    """
    deepest = max(float(-poses[:, 2].min()) for poses in ways)
    if not deepest > 0:
        return 0
    painted = np.zeros(DEPTH_BINS)
    for poses in ways:
        length = polylines.steps(poses[:, :2])
        for (a, b), along in zip(np.column_stack([poses[:-1, 2], poses[1:, 2]]), length, strict=True):
            # A ramp paints a little at each of its depths.
            at = np.linspace(-a, -b, 10) / deepest * DEPTH_BINS
            np.add.at(painted, np.clip(np.ceil(at).astype(int) - 1, 0, DEPTH_BINS - 1), along / 10)
    runs = painted >= MIN_PAINTED_MM
    # Neighbouring bins count as one depth, because rounding may have split one depth between two bins.
    return int(np.sum(runs & ~np.concatenate([[False], runs[:-1]]))) if runs.sum() < 4 else int(runs.sum())


def _refuse_uninformative(ways: list[np.ndarray]) -> None:
    count = count_painted_depths(ways)
    if count == 0:
        sentence = f"no stroke is painted for more than {MIN_PAINTED_MM:g} mm at any depth: paint longer ones"
        raise Error(sentence, "plan", code="depths-too-few")
    if count == 1:
        raise Error(
            "all strokes were painted at one depth, which does not show how lag and width change with depth: paint "
            "strokes at two depths or more, better five",
            "plan",
            code="depths-too-few",
        )
    if all(_total_turning(poses) < MIN_TURNING_RAD for poses in ways):
        raise Error(
            "all strokes are straight, so lag and displacement of the marks cannot be separated: add corners, arcs and "
            "reversals at each depth",
            "plan",
            code="law-undetermined",
        )


def _total_turning(poses: np.ndarray) -> float:
    """Return the total turning of the TCP [rad], ignoring tremor."""
    at = polylines.lengths(poses[:, :2])
    if at[-1] < 1.0:
        return 0.0
    places = np.linspace(0, at[-1], max(3, min(200, int(at[-1]))))
    points = np.column_stack([np.interp(places, at, poses[:, i]) for i in range(2)])
    step = np.diff(points, axis=0) @ [1, 1j]
    return float(np.abs(np.angle(step[1:] * np.conj(step[:-1]))).sum())
