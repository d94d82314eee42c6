"""Arrange the strokes of a calibration chart on a sheet, as a plan.

Each set of strokes is painted at one depth. The straight stroke has a slow landing (b). The angular stroke has an
auxiliary stroke parallel to its second line (r). The arc and the reversal show r while the brush turns, and when the
bristles go loose. Reference strokes are painted there and back on parallel lines. They separate a moved sheet from a
lag: a moved sheet shifts both strokes of a pair in the same direction, a lag shifts them apart. The path of the TCP is
known and not compensated.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ... import _core
from ...errors import Error, as_listed, need_number, need_one_of, need_truth, require_type
from ...model.perturbed import with_lag
from .dabs import HEADINGS_DEG, KIND, dab_depths, dab_poses
from .stroke_sequence import early_and_late, shallow_to_deep

DEPTH_COUNTS = {"few": 4, "normal": 6, "many": 9}  # number of depths
MAX_DEPTHS = 12  # number of depths; a larger sheet repeats them
MAX_REPEATS = 4
MIN_DEPTH_SHARE = 0.1  # least depth as a share of the greatest; the paper height dominates shallower marks
LANDING_SLOPE = 0.25  # slope of the landing of straight strokes; (17) holds for slopes up to 0.3
LIFT_SLOPE = 1.0  # mm down or up per mm along, at other landings and at all ends
# The mark of the brush is unknown, so each box has space for lags of these shares and for a mark that is this much
# wider.
LAG_SHARES, WIDTH_FACTOR = (0.7, 1.0, 1.3), 1.2
EDGE_MM, GAP_MM, LABEL_MM, BAR_MM = 5.0, 2.0, 3.5, 6.0
# Attempts of packing. With fewer, sheets with enough space are refused; more gain little.
MAX_PACKING_ATTEMPTS = 80
# Space for dabs, for which the lag is known and the footprint is not.
DAB_LAG_SHARES, DAB_WIDTH_FACTOR, DAB_MARGIN_MM = (0.9, 1.0, 1.1), 1.5, 0.3
MAX_DAB_DEPTHS = 8  # number of depths; a larger sheet repeats them once
KIND_LETTERS = {"straight": "S", "angular": "A", "arc": "C", "reversal": "V", "reference": "R", KIND: "D"}
LETTER_WIDTH_MM = 1.4  # mean width of a letter of a label
QUIET_ZONE_SHARE = 1 / 6  # width of the white zone around a marker, as a share of its side: more than a module
MARKER_SIDE_RANGE_MM = (8.0, 20.0)
# Positions that are tried for the markers at the left and right, as shares of the sheet height.
MARKER_HEIGHT_SHARES = (0.5, 0.45, 0.55, 0.4, 0.6, 0.35, 0.65)
MIN_SIDES_FOR_MIDDLE_MARKER = 5.0  # an edge gets a marker in its middle if it is at least this many marker sides long
TICK_MM = 2.2  # height of the ends of the bar
# A chart uses eight of a thousand markers. The group of eight depends on the chart, so that charts are not confused.
DICTIONARY, MARKERS_PER_CHART, GROUP_COUNT = "DICT_5X5_1000", 8, 125
PAINT_MM_S = 20.0
MAX_SHEET_SIDE_MM = 10_000.0


@dataclass(frozen=True)
class Stroke:
    """One stroke of a chart.

    box_mm: left, bottom, right and top of the space for its mark.
    """

    id: str
    kind: str
    depth_mm: float
    box_mm: tuple[float, float, float, float]


@dataclass(frozen=True)
class Marker:
    """An ArUco marker.

    corners_mm: on the sheet, upper left first, clockwise as seen from above.
    """

    id: int
    corners_mm: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Label:
    """A text that starts at x, y on its baseline and is at most width_mm wide."""

    text: str
    at_mm: tuple[float, float]
    width_mm: float


@dataclass(frozen=True)
class Bar:
    """A line to measure with a ruler.

    at_mm: its start. length_mm: its length if the page has its true size.
    """

    at_mm: tuple[float, float]
    length_mm: float


@dataclass(frozen=True, repr=False)
class Chart:
    """A calibration chart.

    id, bar: empty for charts of versions that had neither. dictionary: the dictionary of the markers, with its name in
    OpenCV.
    """

    plan: _core.Plan
    strokes: tuple[Stroke, ...]
    markers: tuple[Marker, ...]
    labels: tuple[Label, ...]
    id: str = ""
    bar: Bar | None = None
    dictionary: str = DICTIONARY

    def __repr__(self) -> str:
        width, height = self.plan.sheet_mm
        counts = f"{len(self.strokes)} strokes, {len(self.markers)} markers"
        return f"<Chart {self.id!r} for brush {self.plan.brush!r}: {counts}, sheet {width:g} x {height:g} mm>"


def chart_id(plan: _core.Plan) -> str:
    """Return a short identifier of everything that is painted."""
    return hashlib.sha256(_core.write_plan(plan).encode()).hexdigest()[:8]


@dataclass(frozen=True)
class UnplacedStroke:
    """A stroke without its place on the sheet."""

    kind: str
    depth_mm: float
    poses_mm: np.ndarray
    arcs: tuple = ()


@dataclass(frozen=True)
class _StrokeUnit:
    """Strokes that are placed together, with the boxes of their marks before placing."""

    strokes: tuple[UnplacedStroke, ...]
    boxes_mm: tuple[tuple[float, float, float, float], ...]

    @cached_property
    def box_mm(self) -> tuple[float, float, float, float]:
        boxes = np.array(self.boxes_mm)
        return (*boxes[:, :2].min(axis=0).tolist(), *boxes[:, 2:].max(axis=0).tolist())

    @cached_property
    def size_mm(self) -> tuple[float, float]:
        x0, y0, x1, y1 = self.box_mm
        return max(x1 - x0, 3 * LETTER_WIDTH_MM) + GAP_MM, y1 - y0 + GAP_MM + LABEL_MM


def chart(
    brush: _core.Brush,
    sheet_mm: tuple[float, float],
    strokes: str | None = None,
    deepest_mm: float = math.inf,
    dabs: bool = False,
    one_load: bool = False,
) -> Chart:
    """Make a calibration chart for a brush that is roughly known.

    The depth range, the lag and the width of the brush must be roughly right.

    strokes: "few", "normal" or "many"; None for as many as fit on the sheet. deepest_mm: the greatest depth that the
    machine can reach, if less than the brush allows. dabs: make a chart of dabs, which shows the outlines of a brush
    whose lag is known. one_load: paint with one load of paint, in an order that separates the narrowing of marks from
    depth.

    Raises Error for a pen, for a machine that does not reach the depths of the brush, and for a sheet that is too
    small. The message then names a sufficient size.
    """
    require_type(brush, _core.Brush, "a brush")
    _core.check(brush)
    need_truth(dabs, "dabs")
    need_truth(one_load, "one_load")
    if dabs and one_load:
        raise Error("dabs do not show how marks narrow: use one load only with strokes", code="options-contradict")
    sheet_mm = as_listed(sheet_mm)
    if not isinstance(sheet_mm, (list, tuple)) or len(sheet_mm) != 2:
        raise Error("a sheet is (width, height) in mm", "sheet", code="wrong-type")
    sheet_mm = tuple(need_number(side, "a side of the sheet [mm]", 0.0, MAX_SHEET_SIDE_MM) for side in sheet_mm)
    need_one_of(strokes, (None, *DEPTH_COUNTS), "how many strokes")
    deepest_mm = need_number(deepest_mm, "how deep the machine reaches [mm]", 0.0, math.inf)
    if brush.is_rigid():
        sentence = f"brush {brush.name} is a pen: it has no lag that could be calibrated"
        raise Error(sentence, "brush", code="lag-not-calibrated")
    least, most = brush.depth_range_mm
    if deepest_mm <= least:
        sentence = (
            f"the machine reaches a depth of {deepest_mm:g} mm, but brush {brush.name} is used between {least:g} and "
            f"{most:g} mm"
        )
        raise Error(
            sentence,
            "brush",
            deepest_mm,
            (least, most),
            code="depth-out-of-range",
            advice="lower heights.lowest_mm of the cell if the brush may go deeper",
        )
    side = _marker_side(sheet_mm)
    margins = side + QUIET_ZONE_SHARE * side + 2 * EDGE_MM  # space of the edges and the lower markers
    room = sheet_mm[0] - 2 * EDGE_MM, sheet_mm[1] - margins
    if min(room) <= 2 * (side + QUIET_ZONE_SHARE * side):
        sentence = f"the sheet of {sheet_mm[0]:g} x {sheet_mm[1]:g} mm is too small for the markers in its corners"
        raise Error(sentence, "sheet", code="sheet-too-small")
    best, marker_gap = None, None
    for depths, repeats in [(DEPTH_COUNTS[strokes], 1)] if strokes else _dab_choices() if dabs else _depth_choices():
        if dabs:
            units = _dab_units(brush, dab_depths(brush, depths, deepest_mm), repeats)
        else:
            units = _stroke_units(brush, chart_depths(brush, depths, deepest_mm), repeats)
        # The first choice fixes the markers at the left and right. Strokes matter more than these two markers.
        for gap in (marker_gap,) if best is not None else (*_marker_gaps(sheet_mm, side), None):
            placed, used = _pack_units(units, room[0], side, room[1], gap)
            if used <= room[1]:
                marker_gap = gap
                break
        if used > room[1]:
            break
        best = placed
    if best is None:
        widest = max(math.ceil(max(unit.size_mm[0] for unit in units)), room[0])
        _, used = _pack_units(units, widest, side)
        raise Error(
            f"the sheet of {sheet_mm[0]:g} x {sheet_mm[1]:g} mm is too small for a chart of brush {brush.name} at "
            f"{depths} depths, which needs {math.ceil(widest + 2 * EDGE_MM)} x {math.ceil(used + margins)} mm",
            "sheet",
            code="sheet-too-small",
            advice="--strokes few needs less" if strokes in ("normal", "many") else "",
        )
    return _place_strokes(brush, sheet_mm, best, side, marker_gap, one_load)


def _marker_side(sheet_mm: tuple[float, float]) -> float:
    return min(max(min(sheet_mm) / 14, MARKER_SIDE_RANGE_MM[0]), MARKER_SIDE_RANGE_MM[1])


def _marker_gaps(sheet_mm: tuple[float, float], side: float) -> Iterator[tuple[float, float]]:
    """Yield ranges for the middle markers on the left and right, down from the sheet's inner edge."""
    if sheet_mm[1] >= MIN_SIDES_FOR_MIDDLE_MARKER * side:
        for share in MARKER_HEIGHT_SHARES:
            middle = share * sheet_mm[1] - EDGE_MM
            yield middle - (0.5 + QUIET_ZONE_SHARE) * side, middle + (0.5 + QUIET_ZONE_SHARE) * side


def _depth_choices() -> Iterator[tuple[int, int]]:
    """Yield numbers of depths and repeats, the fewest first. The four coefficients of a law need four depths."""
    yield from ((depths, 1) for depths in range(DEPTH_COUNTS["few"], MAX_DEPTHS + 1))
    yield from ((MAX_DEPTHS, repeats) for repeats in range(2, MAX_REPEATS + 1))


def _dab_choices() -> Iterator[tuple[int, int]]:
    yield from ((depths, 1) for depths in range(DEPTH_COUNTS["few"], MAX_DAB_DEPTHS + 1))
    yield MAX_DAB_DEPTHS, 2


def chart_depths(brush, count: int, deepest_mm: float) -> list[float]:
    least, deepest = brush.depth_range_mm[0], min(brush.depth_range_mm[1], deepest_mm)
    depths = np.linspace(max(least, MIN_DEPTH_SHARE * deepest), deepest, count).round(2)
    return np.clip(depths, least, deepest).tolist()


def _stroke_units(brush, depths: list[float], repeats: int) -> list[_StrokeUnit]:
    least, deepest = depths[0], depths[-1]
    shallow = least + 0.3 * (deepest - least)
    groups: list[tuple[UnplacedStroke, ...]] = list(_references(brush, least + 0.4 * (deepest - least)))
    for _ in range(repeats):
        for number, depth in enumerate(depths):
            groups.append((make_straight_stroke(brush, depth),))
            groups.append((make_angular_stroke(brush, depth), _auxiliary(brush, depth, shallow)))
            groups.append((_arc(brush, depth, 1 if number % 2 else -1),))
            groups.append((_reversal(brush, depth),))
    boxes = find_mark_boxes(brush, [stroke for group in groups for stroke in group])
    return [_StrokeUnit(group, tuple(next(boxes) for _ in group)) for group in groups]


def _dab_units(brush, depths: list[float], repeats: int) -> list[_StrokeUnit]:
    dabs = [
        UnplacedStroke(KIND, depth, dab_poses(brush, depth, heading))
        for depth in depths
        for heading in HEADINGS_DEG * repeats
    ]
    boxes = find_mark_boxes(brush, dabs, DAB_LAG_SHARES, DAB_WIDTH_FACTOR, DAB_MARGIN_MM)
    return [_StrokeUnit((dab,), (next(boxes),)) for dab in dabs]


def _poses_along(depth: float, points, ramp: float = LIFT_SLOPE) -> np.ndarray:
    """Return poses along points (n, 2) at one depth, with a landing and a lift along the ends."""
    points = np.array(points, float)
    first, last = _unit_vector(points[1] - points[0]), _unit_vector(points[-1] - points[-2])
    down, up = points[0] + depth / ramp * first, points[-1] - depth / LIFT_SLOPE * last
    flat = np.vstack([points[:1], down[None], points[1:-1], up[None], points[-1:]])
    z = np.array([0.0, *[-depth] * (len(flat) - 2), 0.0])
    return np.column_stack([flat, z])


def _unit_vector(vector: np.ndarray) -> np.ndarray:
    return vector / np.hypot(*vector)


def make_straight_stroke(brush, depth: float) -> UnplacedStroke:
    length = depth / LANDING_SLOPE + brush.lag(depth) + 15.0 + depth / LIFT_SLOPE
    return UnplacedStroke("straight", depth, _poses_along(depth, [(0, 0), (length, 0)], LANDING_SLOPE))


def _length_before_corner(brush, depth: float) -> float:
    """Return the length [mm] from touch-down to the corner; the brush is taut there even if its lag is longer."""
    return depth / LIFT_SLOPE + 1.5 * brush.lag(depth) + 5.0


def make_angular_stroke(brush, depth: float) -> UnplacedStroke:
    first = _length_before_corner(brush, depth)
    second = 2.0 * brush.lag(depth) + 3.0 + depth / LIFT_SLOPE
    return UnplacedStroke("angular", depth, _poses_along(depth, [(0, 0), (first, 0), (first, -second)]))


def _auxiliary(brush, depth: float, shallow: float) -> UnplacedStroke:
    """Draw a line beyond the second line and parallel to it, which shows that line's position on the paper."""
    x = (
        _length_before_corner(brush, depth)
        + WIDTH_FACTOR * (brush.half_width(depth) + brush.half_width(shallow))
        + GAP_MM
    )
    length = 2 * shallow / LIFT_SLOPE + brush.lag(shallow) + 5.0
    return UnplacedStroke("auxiliary", shallow, _poses_along(shallow, [(x, 0), (x, -length)]))


def _arc(brush, depth: float, direction: int) -> UnplacedStroke:
    """Draw a third of a circle after a straight line. The radius keeps the brush taut."""
    radius = 1.6 * max(brush.lag(depth), 2.0)
    start = depth / LIFT_SLOPE + 0.7 * brush.lag(depth) + 2.0
    count = 49  # chords stay within 0.01 mm of the arc, so programs may ignore the arc
    turn = np.linspace(0, 2 * math.pi / 3, count)
    xy = np.column_stack([start + radius * np.sin(turn), direction * radius * (1 - np.cos(turn))])
    along = np.array([math.cos(turn[-1]), direction * math.sin(turn[-1])])
    end = xy[-1] + (depth / LIFT_SLOPE + 2.0) * along
    poses = _poses_along(depth, [(0, 0), *xy.tolist(), end])
    return UnplacedStroke("arc", depth, poses, (_core.Arc(2, 1 + count, (start, direction * radius), direction),))


def _reversal(brush, depth: float) -> UnplacedStroke:
    """Draw a line nearly back along the first one: the patch rests for almost two lags, then turns."""
    back = math.radians(155.0)
    first = _length_before_corner(brush, depth)
    second = 3.5 * brush.lag(depth) + 3.0 + depth / LIFT_SLOPE
    end = (first + second * math.cos(back), second * math.sin(back))
    return UnplacedStroke("reversal", depth, _poses_along(depth, [(0, 0), (first, 0), end]))


def _references(brush, depth: float) -> Iterator[tuple[UnplacedStroke, ...]]:
    """Draw two pairs of lines there and back, along x and along y."""
    length = 2 * depth / LIFT_SLOPE + brush.lag(depth) + 8.0
    apart = 2 * WIDTH_FACTOR * brush.half_width(depth) + GAP_MM
    for turn in (lambda x, y: (x, y), lambda x, y: (y, x)):
        there, back = [turn(0, 0), turn(length, 0)], [turn(length, apart), turn(0, apart)]
        yield tuple(UnplacedStroke("reference", depth, _poses_along(depth, points)) for points in (there, back))


def find_mark_boxes(
    brush, strokes: list[UnplacedStroke], lag_shares=LAG_SHARES, wider: float = WIDTH_FACTOR, beyond_mm: float = 0.0
) -> Iterator[tuple[float, float, float, float]]:
    """Yield the box of the mark of each stroke.

    The box has space for brushes that trail a little less and more, and paint a little wider.
    """
    plan = _make_plan(brush, (1e4, 1e4), [(f"{k}", stroke, (0.0, 0.0)) for k, stroke in enumerate(strokes)])
    law = np.array(brush.lag.coefficients)
    bounds = []
    for share in lag_shares:
        other_brush = with_lag(brush, (share - 1) * law)
        marks = _core.simulate(plan, other_brush, for_outlines=False)
        bounds.append([_core.painted_bounds(trace, other_brush) for trace in marks.passes])
    bounds = np.array(bounds)
    low, high = bounds[..., :2].min(axis=0), bounds[..., 2:].max(axis=0)
    grown = np.array([(wider - 1) * brush.half_width(stroke.depth_mm) + beyond_mm for stroke in strokes])[:, None]
    yield from (tuple(box) for box in np.hstack([low - grown, high + grown]).tolist())


def _pack_units(
    units: list[_StrokeUnit],
    width: float,
    side: float,
    enough: float = 0.0,
    marker_gap: tuple[float, float] | None = None,
) -> tuple[list[tuple[_StrokeUnit, float, float]], float]:
    """Pack units on a strip of the given width.

    Each unit is placed as near to the top as it fits, in steps of 1 mm.

    Several orders with large units early, and upright and turned units, are tried. The best packing wins, or the first
    that is at most `enough` tall. marker_gap: range of heights of the markers on the left and right.

    Return the units as (unit, left, down from the inner edge of the sheet) and their total height. The height is
    infinite if a unit is wider than the strip.
    """
    random = np.random.default_rng(0)  # a fixed seed gives the same chart each time
    size = np.array([max(unit.size_mm) for unit in units])
    turned = [_turn_unit(unit) for unit in units]
    best = ([], math.inf)
    for attempt in range(MAX_PACKING_ATTEMPTS):
        order = np.argsort(-size * random.uniform(1.0, 1.0 + attempt / MAX_PACKING_ATTEMPTS, len(units)))
        turn = random.random(len(units)) < (attempt % 4) / 4
        ordered = [turned[k] if turn[k] else units[k] for k in order]
        best = min(best, _pack_in_order(ordered, width, side, marker_gap), key=lambda packing: packing[1])
        if best[1] <= enough:
            break
    return best


def _pack_in_order(units: list[_StrokeUnit], width: float, side: float, marker_gap: tuple[float, float] | None):
    heights = np.full(int(width), BAR_MM)
    corner = side + QUIET_ZONE_SHARE * side
    columns = math.ceil(corner)
    heights[:columns] = heights[-columns:] = corner  # space of the upper markers
    if width + 2 * EDGE_MM >= MIN_SIDES_FOR_MIDDLE_MARKER * side:
        middle = len(heights) / 2
        heights[
            math.floor(middle - side / 2 - QUIET_ZONE_SHARE * side) : math.ceil(
                middle + side / 2 + QUIET_ZONE_SHARE * side
            )
        ] = _top_of_middle_marker(side) + corner
    placed = []
    for unit in units:
        wide, tall = math.ceil(unit.size_mm[0]), unit.size_mm[1]
        if wide > len(heights):
            return [], math.inf
        tops = _running_maximum(heights, wide)
        if marker_gap:
            lefts = np.arange(len(tops))
            at_edge = (lefts < columns) | (lefts + wide > len(heights) - columns)
            tops = np.where(at_edge & (tops < marker_gap[1]) & (tops + tall > marker_gap[0]), marker_gap[1], tops)
        left = int(tops.argmin())
        placed.append((unit, float(left), float(tops[left])))
        heights[left : left + wide] = tops[left] + tall
    return placed, float(heights.max())


def _running_maximum(taken: np.ndarray, wide: int) -> np.ndarray:
    """Return the maximum of every `wide` consecutive values."""
    tops, reached = taken, 1
    while 2 * reached <= wide:
        tops, reached = np.maximum(tops[:-reached], tops[reached:]), 2 * reached
    rest = wide - reached
    return np.maximum(tops[: len(tops) - rest], tops[rest:])


def _top_of_middle_marker(side: float) -> float:
    """Return the top of the marker below the bar. It counts down from the inner edge of the sheet."""
    return TICK_MM + QUIET_ZONE_SHARE * side


def _turn_unit(unit: _StrokeUnit) -> _StrokeUnit:
    """Turn a unit by 90 degrees counter-clockwise; reference strokes and dabs keep their directions."""
    if unit.strokes[0].kind in ("reference", KIND):
        return unit
    strokes = []
    for stroke in unit.strokes:
        x, y, z = stroke.poses_mm.T
        arcs = tuple(
            _core.Arc(arc.first, arc.last, (-arc.centre_mm[1], arc.centre_mm[0]), arc.direction) for arc in stroke.arcs
        )
        strokes.append(replace(stroke, poses_mm=np.column_stack([-y, x, z]), arcs=arcs))
    return _StrokeUnit(tuple(strokes), tuple((-y1, x0, -y0, x1) for x0, y0, x1, y1 in unit.boxes_mm))


def _place_strokes(
    brush, sheet_mm, placed, side: float, marker_gap: tuple[float, float] | None, one_load: bool
) -> Chart:
    height = sheet_mm[1]
    kinds_and_depths = [(unit.strokes[0].kind, unit.strokes[0].depth_mm) for unit, _, _ in placed]
    units, labels = {}, []
    counts: dict[str, int] = {}
    for k in shallow_to_deep(kinds_and_depths):
        unit, left, down = placed[k]
        x0, _, _, y1 = unit.box_mm
        shift = EDGE_MM + left + GAP_MM / 2 - x0, height - EDGE_MM - down - GAP_MM / 2 - y1
        units[k], numbers = [], []
        for stroke, box in zip(unit.strokes, unit.boxes_mm, strict=True):
            number = counts[stroke.kind] = counts.get(stroke.kind, 0) + 1
            name = f"{stroke.kind}-{number}"
            numbers.append(number)
            moved = tuple(float(v + shift[i % 2]) for i, v in enumerate(box))
            units[k].append(((name, stroke, shift), Stroke(name, stroke.kind, stroke.depth_mm, moved)))
        x, bottom = unit.box_mm[0] + shift[0], unit.box_mm[1] + shift[1]
        at_mm = x, bottom - 0.8 * LABEL_MM
        labels.append(_make_label(units[k][0][1], numbers[0], at_mm, unit.size_mm[0] - GAP_MM))
    order = early_and_late(kinds_and_depths) if one_load else list(units)
    named, strokes = zip(*(pair for k in order for pair in units[k]), strict=True)
    plan = _make_plan(brush, sheet_mm, named, False if one_load else None)
    mark = chart_id(plan)
    bar = _place_bar(sheet_mm, side)
    labels += _make_titles(brush, sheet_mm, side, mark, bar)
    base = MARKERS_PER_CHART * (int(mark, 16) % GROUP_COUNT)
    markers = tuple(
        Marker(base + k, ((x, y), (x + side, y), (x + side, y - side), (x, y - side)))
        for k, (x, y) in _marker_places(sheet_mm, side, marker_gap)
    )
    return Chart(plan, strokes, markers, tuple(labels), mark, bar)


def _marker_places(
    sheet_mm, side: float, marker_gap: tuple[float, float] | None
) -> list[tuple[int, tuple[float, float]]]:
    """Return numbers and upper left corners of the markers: 0 to 3 in the corners, clockwise, 4 to 7 on the edges."""
    width, height = sheet_mm
    left, right, top, bottom = EDGE_MM, width - EDGE_MM - side, height - EDGE_MM, EDGE_MM + side
    across = (width - side) / 2
    places = [(0, (left, top)), (1, (right, top)), (2, (right, bottom)), (3, (left, bottom))]
    if width >= MIN_SIDES_FOR_MIDDLE_MARKER * side:
        places += [(4, (across, top - _top_of_middle_marker(side))), (6, (across, bottom))]
    if marker_gap:
        up = height - EDGE_MM - marker_gap[0] - QUIET_ZONE_SHARE * side
        places += [(5, (right, up)), (7, (left, up))]
    return sorted(places)


def _place_bar(sheet_mm, side: float) -> Bar:
    """Place a bar between the upper markers, in whole centimetres if it is longer than one."""
    room = sheet_mm[0] - 2 * (EDGE_MM + side + QUIET_ZONE_SHARE * side)
    length = 10.0 * math.floor(room / 10) if room >= 10 else math.floor(room)
    return Bar(((sheet_mm[0] - length) / 2, sheet_mm[1] - EDGE_MM - TICK_MM / 2), length)


def _make_titles(brush, sheet_mm, side: float, mark: str, bar: Bar) -> list[Label]:
    """Write the chart's name next to the lower markers, and the length of the bar below the bar."""
    width, height = sheet_mm
    left = EDGE_MM + side + 3
    parts = 2 if width >= MIN_SIDES_FOR_MIDDLE_MARKER * side else 1  # a marker is in between
    room = width / 2 - side / 2 - left - 3 if parts == 2 else width - 2 * left
    below = width / 2 - (0.5 + QUIET_ZONE_SHARE) * side - bar.at_mm[0] if parts == 2 else bar.length_mm
    title = Label(f"brushsvg chart {mark}, brush {brush.name}", (left, EDGE_MM + LABEL_MM), room)
    size = Label(f"{width:g} x {height:g} mm: print at 100 %", (left, EDGE_MM), room)
    measure = f"bar: {bar.length_mm:g} mm"
    return [Label(measure, (bar.at_mm[0], height - EDGE_MM - BAR_MM + 0.8), below), size, title]


def _make_label(stroke: Stroke, number: int, at_mm: tuple[float, float], width_mm: float) -> Label:
    """Label a stroke with the longest text that fits: its id and depth, its id, or a letter and its number."""
    texts = (f"{stroke.id}: {stroke.depth_mm:g} mm", stroke.id, f"{KIND_LETTERS[stroke.kind]}{number}")
    fitting = (text for text in texts if len(text) * LETTER_WIDTH_MM <= width_mm)
    return Label(next(fitting, texts[-1]), at_mm, width_mm)


def _make_plan(brush, sheet_mm, named, reload: bool | None = None):
    plan = _core.Plan(brush=brush.name, brush_sha256=brush.sha256, sheet_mm=sheet_mm)
    passes = []
    for name, stroke, (dx, dy) in named:
        arcs = [
            _core.Arc(arc.first, arc.last, (arc.centre_mm[0] + dx, arc.centre_mm[1] + dy), arc.direction)
            for arc in stroke.arcs
        ]
        poses = stroke.poses_mm + np.array([dx, dy, 0.0])
        speed = min(PAINT_MM_S, brush.max_speed_mm_s)
        settings = _core.Settings(kind=stroke.kind, reload=reload)
        passes.append(_core.Pass(name, poses, speed, settings=settings, arcs=arcs))
    plan.passes = passes
    return plan
