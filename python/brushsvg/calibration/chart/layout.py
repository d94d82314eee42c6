"""The calibration chart: strokes from which a brush can be measured, laid out on a sheet as a plan.

Each set of strokes is painted at one depth: a straight one with a slow landing (b), an angular one with an auxiliary
stroke parallel to its second line (r), an arc and a reversal (r where it turns; when the bristles go loose). Reference
strokes, painted there and back on parallel lines, separate a moved sheet from a lag: the one moves both of a pair
the same way, the other apart. The TCP's path is known and not compensated.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ... import _core
from ...errors import Error, as_listed, need, need_number, need_one_of
from ...model.perturbed import with_lag
from .dabs import HEADINGS_DEG, KIND, dab_depths, dab_poses
from .painting_order import early_and_late, shallow_to_deep

SETS = {"few": 4, "normal": 6, "many": 9}  # depths
MOST_SETS = 12  # depths; beyond, a larger sheet repeats them
MOST_REPEATS = 4
SHALLOWEST = 0.1  # of the greatest depth: shallower, the paper's height rules the mark
RAMP = 0.25  # of straight strokes: (17) holds for landings that are not steeper than 0.3
LIFT_STEP = 1.0  # mm down, or up, per mm along at the other landings and at all ends
# What is painted is not known yet: room is left for a brush that trails and spreads by so much more or less.
LAG_SHARES, WIDER = (0.7, 1.0, 1.3), 1.2
EDGE_MM, GAP_MM, LABEL_MM, BAR_MM = 5.0, 2.0, 3.5, 6.0
ATTEMPTS = 80  # of packing: fewer, and sheets are refused that have room; more, and little is won
# Of dabs the lag is known and the footprint is not
DAB_LAG_SHARES, DAB_WIDER, DAB_BEYOND_MM = (0.9, 1.0, 1.1), 1.5, 0.3
MOST_DAB_SETS = 8  # depths; beyond, a larger sheet repeats them once
CODES = {"straight": "S", "angular": "A", "arc": "C", "reversal": "V", "reference": "R", KIND: "D"}
LETTER_MM = 1.4  # of a label, on average
QUIET = 1 / 6  # of a marker's side, white around it: more than a module
MARKERS = (8.0, 20.0)  # mm, the least and the greatest side
MARKER_HEIGHTS = (
    0.5,
    0.45,
    0.55,
    0.4,
    0.6,
    0.35,
    0.65,
)  # of the sheet's height, where markers at its sides are tried
BETWEEN = 5.0  # sides that an edge has at least where a marker stands in its middle too
TICK_MM = 2.2  # height of the bar's ends
# Eight markers of a thousand: which eight is the chart's, so that no other chart is taken for it
DICTIONARY, GROUP, GROUPS = "DICT_5X5_1000", 8, 125
PAINT_MM_S = 20.0
LARGEST_SHEET_MM = 10_000.0


@dataclass(frozen=True)
class Stroke:
    """One stroke of a chart. box_mm: left, bottom, right, top of the room that its mark is given."""

    id: str
    kind: str
    depth_mm: float
    box_mm: tuple[float, float, float, float]


@dataclass(frozen=True)
class Marker:
    """An ArUco marker; corners in mm on the sheet, upper left first, clockwise as one looks at it."""

    id: int
    corners_mm: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Label:
    """Text that starts at x, y (its baseline) and is no wider than width_mm."""

    text: str
    at_mm: tuple[float, float]
    width_mm: float


@dataclass(frozen=True)
class Bar:
    """A line to be measured with a ruler: where it begins, and how long it is where the page has its true size."""

    at_mm: tuple[float, float]
    length_mm: float


@dataclass(frozen=True, repr=False)
class Chart:
    """id, bar: none of charts as they were before there were any. dictionary: of the markers, as OpenCV names it."""

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
    """Short, of all that is painted."""
    return hashlib.sha256(_core.write_plan(plan).encode()).hexdigest()[:8]


@dataclass(frozen=True)
class Drawn:
    """A stroke before it has its place."""

    kind: str
    depth_mm: float
    poses_mm: np.ndarray
    arcs: tuple = ()


@dataclass(frozen=True)
class _Unit:
    """Strokes that keep together, boxes as they were drawn."""

    strokes: tuple[Drawn, ...]
    boxes_mm: tuple[tuple[float, float, float, float], ...]

    @cached_property
    def box_mm(self) -> tuple[float, float, float, float]:
        boxes = np.array(self.boxes_mm)
        return (*boxes[:, :2].min(axis=0).tolist(), *boxes[:, 2:].max(axis=0).tolist())

    @cached_property
    def size_mm(self) -> tuple[float, float]:
        x0, y0, x1, y1 = self.box_mm
        return max(x1 - x0, 3 * LETTER_MM) + GAP_MM, y1 - y0 + GAP_MM + LABEL_MM


def chart(
    brush: _core.Brush,
    sheet_mm: tuple[float, float],
    strokes: str | None = None,
    deepest_mm: float = math.inf,
    dabs: bool = False,
    one_load: bool = False,
) -> Chart:
    """The chart of a brush that is known roughly: its depth range, its lag, its width.

    strokes: few, normal, many; None for as many as the sheet has room for; deepest_mm: what the machine can reach, if
    less than the brush; dabs: of a brush whose lag is known, for its outlines; one_load: in an order that separates how
    marks narrow from depth, with paint fetched before the first stroke only. Error for a pen, and where the sheet is
    too small, with the size that would do.
    """
    need(brush, _core.Brush, "a brush")
    _core.check(brush)
    if dabs and one_load:
        raise Error("dabs do not show how marks narrow: one load is for strokes", code="options-contradict")
    sheet_mm = as_listed(sheet_mm)
    if not isinstance(sheet_mm, (list, tuple)) or len(sheet_mm) != 2:
        raise Error("a sheet is (width, height) in mm", "sheet", code="wrong-type")
    sheet_mm = tuple(
        need_number(side, "a side of the sheet [mm]", 0.0, LARGEST_SHEET_MM) for side in sheet_mm
    )
    need_one_of(strokes, (None, *SETS), "how many strokes")
    deepest_mm = need_number(deepest_mm, "how deep the machine reaches [mm]", 0.0, math.inf)
    if brush.is_rigid():
        raise Error(
            f"brush {brush.name} is a pen: it has no lag that could be calibrated",
            "brush",
            code="lag-not-calibrated",
        )
    side = _side(sheet_mm)
    below = side + QUIET * side + 2 * EDGE_MM  # edges and the lower markers
    room = sheet_mm[0] - 2 * EDGE_MM, sheet_mm[1] - below
    if min(room) <= 2 * (side + QUIET * side):
        raise Error(
            f"the sheet of {sheet_mm[0]:g} x {sheet_mm[1]:g} mm is too small for the markers in its corners",
            "sheet",
            code="sheet-too-small",
        )
    best, marker_gap = None, None
    for depths, repeats in [(SETS[strokes], 1)] if strokes else _dab_choices() if dabs else _choices():
        if dabs:
            units = _dab_units(brush, dab_depths(brush, depths, deepest_mm), repeats)
        else:
            units = _units(brush, chart_depths(brush, depths, deepest_mm), repeats)
        # the first choice settles where markers stand at the sides; strokes matter more than these two
        for tried in (marker_gap,) if best is not None else (*_marker_gaps(sheet_mm, side), None):
            placed, used = _packed(units, room[0], side, room[1], tried)
            if used <= room[1]:
                marker_gap = tried
                break
        if used > room[1]:
            break
        best = placed
    if best is None:
        widest = max(math.ceil(max(unit.size_mm[0] for unit in units)), room[0])
        _, used = _packed(units, widest, side)
        raise Error(
            f"the sheet of {sheet_mm[0]:g} x {sheet_mm[1]:g} mm is too small for a chart of brush {brush.name} at "
            f"{depths} depths, which needs {math.ceil(widest + 2 * EDGE_MM)} x {math.ceil(used + below)} mm",
            "sheet",
            code="sheet-too-small",
            advice="--strokes few needs less" if strokes in ("normal", "many") else "",
        )
    return _laid_out(brush, sheet_mm, best, side, marker_gap, one_load)


def _side(sheet_mm: tuple[float, float]) -> float:
    return min(max(min(sheet_mm) / 14, MARKERS[0]), MARKERS[1])


def _marker_gaps(sheet_mm: tuple[float, float], side: float) -> Iterator[tuple[float, float]]:
    """From where to where, down from the sheet's inner edge, markers may stand near the middle of its left and right
    side."""
    if sheet_mm[1] >= BETWEEN * side:
        for share in MARKER_HEIGHTS:
            middle = share * sheet_mm[1] - EDGE_MM
            yield middle - (0.5 + QUIET) * side, middle + (0.5 + QUIET) * side


def _choices() -> Iterator[tuple[int, int]]:
    """Depths and repeats, the fewest first: those that the four numbers of a law need."""
    yield from ((depths, 1) for depths in range(SETS["few"], MOST_SETS + 1))
    yield from ((MOST_SETS, repeats) for repeats in range(2, MOST_REPEATS + 1))


def _dab_choices() -> Iterator[tuple[int, int]]:
    yield from ((depths, 1) for depths in range(SETS["few"], MOST_DAB_SETS + 1))
    yield MOST_DAB_SETS, 2


def chart_depths(brush, count: int, deepest_mm: float) -> list[float]:
    least, deepest = brush.depth_range_mm[0], min(brush.depth_range_mm[1], deepest_mm)
    depths = np.linspace(max(least, SHALLOWEST * deepest), deepest, count).round(2)
    return np.clip(depths, least, deepest).tolist()


def _units(brush, depths: list[float], repeats: int) -> list[_Unit]:
    least, deepest = depths[0], depths[-1]
    shallow = least + 0.3 * (deepest - least)
    groups: list[tuple[Drawn, ...]] = list(_references(brush, least + 0.4 * (deepest - least)))
    for _ in range(repeats):
        for number, depth in enumerate(depths):
            groups.append((straight(brush, depth),))
            groups.append((angular(brush, depth), _auxiliary(brush, depth, shallow)))
            groups.append((_arc(brush, depth, 1 if number % 2 else -1),))
            groups.append((_reversal(brush, depth),))
    boxes = room_for(brush, [stroke for group in groups for stroke in group])
    return [_Unit(group, tuple(next(boxes) for _ in group)) for group in groups]


def _dab_units(brush, depths: list[float], repeats: int) -> list[_Unit]:
    dabs = [
        Drawn(KIND, depth, dab_poses(brush, depth, heading))
        for depth in depths
        for heading in HEADINGS_DEG * repeats
    ]
    boxes = room_for(brush, dabs, DAB_LAG_SHARES, DAB_WIDER, DAB_BEYOND_MM)
    return [_Unit((dab,), (next(boxes),)) for dab in dabs]


def _path(depth: float, points, ramp: float = LIFT_STEP) -> np.ndarray:
    """Poses along points (n, 2) at one depth, landing along the first line and lifting along the last."""
    points = np.array(points, float)
    first, last = _unit(points[1] - points[0]), _unit(points[-1] - points[-2])
    down, up = points[0] + depth / ramp * first, points[-1] - depth / LIFT_STEP * last
    flat = np.vstack([points[:1], down[None], points[1:-1], up[None], points[-1:]])
    z = np.array([0.0, *[-depth] * (len(flat) - 2), 0.0])
    return np.column_stack([flat, z])


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.hypot(*vector)


def straight(brush, depth: float) -> Drawn:
    length = depth / RAMP + brush.lag(depth) + 15.0 + depth / LIFT_STEP
    return Drawn("straight", depth, _path(depth, [(0, 0), (length, 0)], RAMP))


def _before_corner(brush, depth: float) -> float:
    """From touch-down: taut, though the lag is longer than thought, and some of its mark straight."""
    return depth / LIFT_STEP + 1.5 * brush.lag(depth) + 5.0


def angular(brush, depth: float) -> Drawn:
    first = _before_corner(brush, depth)
    second = 2.0 * brush.lag(depth) + 3.0 + depth / LIFT_STEP
    return Drawn("angular", depth, _path(depth, [(0, 0), (first, 0), (first, -second)]))


def _auxiliary(brush, depth: float, shallow: float) -> Drawn:
    """Draw a line beyond the second line, parallel to it: its place on the paper gives the place of that line."""
    x = _before_corner(brush, depth) + WIDER * (brush.half_width(depth) + brush.half_width(shallow)) + GAP_MM
    length = 2 * shallow / LIFT_STEP + brush.lag(shallow) + 5.0
    return Drawn("auxiliary", shallow, _path(shallow, [(x, 0), (x, -length)]))


def _arc(brush, depth: float, direction: int) -> Drawn:
    """A third of a circle whose radius leaves the brush taut, entered straight."""
    radius = 1.6 * max(brush.lag(depth), 2.0)
    start = depth / LIFT_STEP + 0.7 * brush.lag(depth) + 2.0
    count = 49  # chords stay within 0.01 mm of the arc: who ignores it loses nothing
    turn = np.linspace(0, 2 * math.pi / 3, count)
    xy = np.column_stack([start + radius * np.sin(turn), direction * radius * (1 - np.cos(turn))])
    along = np.array([math.cos(turn[-1]), direction * math.sin(turn[-1])])
    end = xy[-1] + (depth / LIFT_STEP + 2.0) * along
    poses = _path(depth, [(0, 0), *xy.tolist(), end])
    return Drawn("arc", depth, poses, (_core.Arc(2, 1 + count, (start, direction * radius), direction),))


def _reversal(brush, depth: float) -> Drawn:
    """Nearly back: the patch rests for almost two lags, then turns."""
    back = math.radians(155.0)
    first = _before_corner(brush, depth)
    second = 3.5 * brush.lag(depth) + 3.0 + depth / LIFT_STEP
    end = (first + second * math.cos(back), second * math.sin(back))
    return Drawn("reversal", depth, _path(depth, [(0, 0), (first, 0), end]))


def _references(brush, depth: float) -> Iterator[tuple[Drawn, ...]]:
    """Two pairs there and back, along x and along y."""
    length = 2 * depth / LIFT_STEP + brush.lag(depth) + 8.0
    apart = 2 * WIDER * brush.half_width(depth) + GAP_MM
    for turn in (lambda x, y: (x, y), lambda x, y: (y, x)):
        there, back = [turn(0, 0), turn(length, 0)], [turn(length, apart), turn(0, apart)]
        yield tuple(Drawn("reference", depth, _path(depth, points)) for points in (there, back))


def room_for(
    brush, strokes: list[Drawn], lag_shares=LAG_SHARES, wider: float = WIDER, beyond_mm: float = 0.0
) -> Iterator[tuple[float, float, float, float]]:
    """Of what brushes that trail a little less and more than this one paint, and a little wider."""
    plan = _plan(brush, (1e4, 1e4), [(f"{k}", stroke, (0.0, 0.0)) for k, stroke in enumerate(strokes)])
    law = np.array(brush.lag.coefficients)
    bounds = []
    for share in lag_shares:
        other = with_lag(brush, (share - 1) * law)
        marks = _core.simulate(plan, other, for_outlines=False)
        bounds.append([_core.painted_bounds(trace, other) for trace in marks.passes])
    bounds = np.array(bounds)
    low, high = bounds[..., :2].min(axis=0), bounds[..., 2:].max(axis=0)
    grown = np.array([(wider - 1) * brush.half_width(each.depth_mm) + beyond_mm for each in strokes])[:, None]
    yield from (tuple(box) for box in np.hstack([low - grown, high + grown]).tolist())


def _packed(
    units: list[_Unit],
    width: float,
    side: float,
    enough: float = 0.0,
    marker_gap: tuple[float, float] | None = None,
) -> tuple[list[tuple[_Unit, float, float]], float]:
    """Units one after the other, each as near to the top as it finds room: (unit, left, down from the sheet's inner
    edge), and how tall all are; infinite where one unit is wider. The best of some orders, the large ones early, and
    of upright and turned units, or the first that is no taller than enough; in steps of 1 mm. marker_gap: between which
    heights the markers on the left and right stand."""
    random = np.random.default_rng(0)  # the same chart each time
    size = np.array([max(unit.size_mm) for unit in units])
    turned = [_turned(unit) for unit in units]
    best = ([], math.inf)
    for attempt in range(ATTEMPTS):
        order = np.argsort(-size * random.uniform(1.0, 1.0 + attempt / ATTEMPTS, len(units)))
        turn = random.random(len(units)) < (attempt % 4) / 4
        now = [turned[k] if turn[k] else units[k] for k in order]
        best = min(best, _packed_so(now, width, side, marker_gap), key=lambda each: each[1])
        if best[1] <= enough:
            break
    return best


def _packed_so(units: list[_Unit], width: float, side: float, marker_gap: tuple[float, float] | None):
    taken = np.full(int(width), BAR_MM)
    corner = side + QUIET * side
    columns = math.ceil(corner)
    taken[:columns] = taken[-columns:] = corner  # the upper markers
    if width + 2 * EDGE_MM >= BETWEEN * side:
        middle = len(taken) / 2
        taken[math.floor(middle - side / 2 - QUIET * side) : math.ceil(middle + side / 2 + QUIET * side)] = (
            _top_middle(side) + corner
        )
    placed = []
    for unit in units:
        wide, tall = math.ceil(unit.size_mm[0]), unit.size_mm[1]
        if wide > len(taken):
            return [], math.inf
        tops = _highest(taken, wide)
        if marker_gap:
            lefts = np.arange(len(tops))
            at_edge = (lefts < columns) | (lefts + wide > len(taken) - columns)
            tops = np.where(
                at_edge & (tops < marker_gap[1]) & (tops + tall > marker_gap[0]), marker_gap[1], tops
            )
        left = int(tops.argmin())
        placed.append((unit, float(left), float(tops[left])))
        taken[left : left + wide] = tops[left] + tall
    return placed, float(taken.max())


def _highest(taken: np.ndarray, wide: int) -> np.ndarray:
    """The greatest of each so many values in a row."""
    tops, reached = taken, 1
    while 2 * reached <= wide:
        tops, reached = np.maximum(tops[:-reached], tops[reached:]), 2 * reached
    rest = wide - reached
    return np.maximum(tops[: len(tops) - rest], tops[rest:])


def _top_middle(side: float) -> float:
    """Of the marker below the bar, down from the sheet's inner edge."""
    return TICK_MM + QUIET * side


def _turned(unit: _Unit) -> _Unit:
    """By a quarter, counter-clockwise; reference strokes and dabs, which come in directions, stay as they are."""
    if unit.strokes[0].kind in ("reference", KIND):
        return unit
    strokes = []
    for stroke in unit.strokes:
        x, y, z = stroke.poses_mm.T
        arcs = tuple(
            _core.Arc(arc.first, arc.last, (-arc.centre_mm[1], arc.centre_mm[0]), arc.direction)
            for arc in stroke.arcs
        )
        strokes.append(replace(stroke, poses_mm=np.column_stack([-y, x, z]), arcs=arcs))
    return _Unit(tuple(strokes), tuple((-y1, x0, -y0, x1) for x0, y0, x1, y1 in unit.boxes_mm))


def _laid_out(
    brush, sheet_mm, placed, side: float, marker_gap: tuple[float, float] | None, one_load: bool
) -> Chart:
    height = sheet_mm[1]
    what = [(unit.strokes[0].kind, unit.strokes[0].depth_mm) for unit, _, _ in placed]
    units, labels = {}, []
    counts: dict[str, int] = {}
    for k in shallow_to_deep(what):
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
        labels.append(_label(units[k][0][1], numbers[0], at_mm, unit.size_mm[0] - GAP_MM))
    order = early_and_late(what) if one_load else list(units)
    named, strokes = zip(*(pair for k in order for pair in units[k]), strict=True)
    plan = _plan(brush, sheet_mm, named, False if one_load else None)
    mark = chart_id(plan)
    bar = _bar(sheet_mm, side)
    labels += _titles(brush, sheet_mm, side, mark, bar)
    base = GROUP * (int(mark, 16) % GROUPS)
    markers = tuple(
        Marker(base + k, ((x, y), (x + side, y), (x + side, y - side), (x, y - side)))
        for k, (x, y) in _marker_places(sheet_mm, side, marker_gap)
    )
    return Chart(plan, strokes, markers, tuple(labels), mark, bar)


def _marker_places(
    sheet_mm, side: float, marker_gap: tuple[float, float] | None
) -> list[tuple[int, tuple[float, float]]]:
    """Numbers and upper left corners: those in the corners, clockwise, then those in the middle of the edges."""
    width, height = sheet_mm
    left, right, top, bottom = EDGE_MM, width - EDGE_MM - side, height - EDGE_MM, EDGE_MM + side
    across = (width - side) / 2
    places = [(0, (left, top)), (1, (right, top)), (2, (right, bottom)), (3, (left, bottom))]
    if width >= BETWEEN * side:
        places += [(4, (across, top - _top_middle(side))), (6, (across, bottom))]
    if marker_gap:
        up = height - EDGE_MM - marker_gap[0] - QUIET * side
        places += [(5, (right, up)), (7, (left, up))]
    return sorted(places)


def _bar(sheet_mm, side: float) -> Bar:
    """As long as there is room between the upper markers, in whole centimetres where it is longer than one."""
    room = sheet_mm[0] - 2 * (EDGE_MM + side + QUIET * side)
    length = 10.0 * math.floor(room / 10) if room >= 10 else math.floor(room)
    return Bar(((sheet_mm[0] - length) / 2, sheet_mm[1] - EDGE_MM - TICK_MM / 2), length)


def _titles(brush, sheet_mm, side: float, mark: str, bar: Bar) -> list[Label]:
    """Write the chart's name next to the lower markers, and what to measure below the bar."""
    width, height = sheet_mm
    left = EDGE_MM + side + 3
    parts = 2 if width >= BETWEEN * side else 1  # a marker stands in between
    room = width / 2 - side / 2 - left - 3 if parts == 2 else width - 2 * left
    below = width / 2 - (0.5 + QUIET) * side - bar.at_mm[0] if parts == 2 else bar.length_mm
    what = Label(f"brushsvg chart {mark}, brush {brush.name}", (left, EDGE_MM + LABEL_MM), room)
    size = Label(f"{width:g} x {height:g} mm: print at 100 %", (left, EDGE_MM), room)
    measure = f"bar: {bar.length_mm:g} mm"
    return [Label(measure, (bar.at_mm[0], height - EDGE_MM - BAR_MM + 0.8), below), size, what]


def _label(stroke: Stroke, number: int, at_mm: tuple[float, float], width_mm: float) -> Label:
    """Its id and depth where there is room, else a letter and its number."""
    texts = (f"{stroke.id}: {stroke.depth_mm:g} mm", stroke.id, f"{CODES[stroke.kind]}{number}")
    fitting = (text for text in texts if len(text) * LETTER_MM <= width_mm)
    return Label(next(fitting, texts[-1]), at_mm, width_mm)


def _plan(brush, sheet_mm, named, reload: bool | None = None):
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
