"""A shape wider than the brush, filled: passes along its outline and inside of them, then lines into what is left.

Discs of the brush's greatest half width h fit into the shape where it is wider, with their centres in the shape moved
inward by h. The first passes run along that line's rings, so their edge is the outline; further ones farther inside.
Corners, necks and narrow parts are left: there the strokes found for the shape, and where those leave something, its
medial axis, are painted at the width that the shape has there.
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import shapely

from .. import _core
from ..geometry.polylines import length, lengths
from ..geometry.rings import with_holes
from .offset_passes import FITTED, Line

# From ring to ring at most, in half widths: at corners of 90 degrees a step of 1.7 leaves a gap, of 60 one of 1.5.
_STEP = 1.5
_INNERMOST = 0.9  # in half widths, from the innermost ring to the shape's middle: it covers that
_HAIR = 0.05  # in half widths: no ring round a place narrower than that, a line along its middle covers it
_UPPER_LEFT = (-0.3, 1.0)
_CORNER_RAD, _SQUARE_RAD, _SHARP_RAD = np.radians(30), np.radians(80), np.radians(100)
# Worth a line of its own, in squares of the half width; a corner of 90 degrees has 0.21, of 60 degrees 0.69.
_WORTH = 0.1
# Gaps amid paint, so many half widths from the edge, and tips count so many times: a gap of 0.01 squares is worth a
# line. Tips are what a mark so narrow, in half widths, leaves at square ends, if more than so many squares of them.
_DEAR, _INSIDE, _NARROW, _TIP = 10, 0.05, 0.27, 0.02
_SEEN = 0.02  # what a line's disc must show of the unpainted to be a part of it
_EVEN = 0.25  # between places on a line, in half widths
# What a line is longer than what it has to paint at either end, in half widths: a mark begins pointed, and one shorter
# than a footprint lies behind its line.
_LANDING = 1.5
_TURNED_IN = 2.0  # half widths round a ring that is all of a filling: in a smaller one the brush would turn on the spot
# Half width won per length, 0.71 in a right-angled corner: beyond, a longer line would press the brush so fast that its
# tip runs back out of the corner.
_BLUNT = 0.6
_WIDE_END = 0.5  # in half widths; narrower ends lie in corners
# Corners that turn by more than the first and less than the second end square in a slanted cut: in sharper ones the
# mark that goes there swings out of the other edge, by 0.5 to 1.2 mm. Farthest ahead of a line's end, in half widths,
# lies such a corner.
_SLANTED_RAD, _POINTED_RAD, _REACH = np.radians(42), np.radians(122), 2.0
_SET_DOWN = 3.6  # in half widths: on shorter lines is no room to be set down for a square beginning
_SQUARED = 0.4  # of the greatest width, the least of a brush whose marks can begin and end square
_AS_WIDE = 0.98  # a place that is narrower than a pen by less takes it
_AT_TIP = 0.2  # in half widths: so near to a corner of the shape a corner of 80 to 100 degrees points
_OFF_CUSP = 0.4  # in half widths
_PAST, _BLUNT_END = (
    1.5,
    1.2,
)  # a shape ends where, so far ahead, it has little more than a square, in half widths
_GRID_MM = 1e-4  # of differences: without one they may fail on edges that all but touch
_QUARTER, _ROUND = 24, 8  # edges of a quarter of a circle, off by 1e-3 and by 5e-3 of its radius
_SIMPLER_MM = 0.02  # an edge of the outline costs as much as all the rest
# Beyond, a shape is no lettering; there, and with more rings, the middle lines have to do.
_MOST_PAIRS, _MOST_RINGS, _MOST_LINES = 10_000, 400, 2_000


def region(rings: list[np.ndarray]):
    """Rings as _core.unite returns them, as shapely sees them."""
    parts = [shapely.make_valid(shapely.Polygon(outer, holes)) for outer, *holes in with_holes(rings)]
    return shapely.union_all(parts)


def painted(strokes: list):
    """What discs of their widths paint along lines or strokes; what lines with square ends are meant to."""
    return shapely.union_all([part for each in strokes for part in _swept(each)])


def _swept(stroke) -> list:
    if isinstance(stroke, Line) and stroke.wanted_mm:
        return [region(list(stroke.wanted_mm))]
    bare = _core.Stroke(middle_mm=stroke.middle_mm, half_width=stroke.half_width, closed=stroke.closed)
    line = _core.flatten(bare, 0.01)
    knots = np.array(stroke.half_width)
    if len(line) > 1 and np.ptp(knots[:, 1]) == 0:
        return [shapely.buffer(shapely.LineString(line[:, :2]), knots[0, 1], quad_segs=_QUARTER)]
    at_mm = np.union1d(line[:, 2], knots[:, 0] * line[-1, 2])
    places = np.column_stack([np.interp(at_mm, line[:, 2], line[:, k]) for k in (0, 1)])
    halves = np.interp(at_mm / max(line[-1, 2], 1e-9), *knots.T)
    discs = shapely.buffer(shapely.points(places), halves, quad_segs=_QUARTER)
    return [shapely.convex_hull(shapely.union(a, b)) for a, b in itertools.pairwise(discs)] or [discs[0]]


def unpainted(shape, strokes: list):
    """What discs of their widths leave of a shape, as polygons."""
    return _areas(shapely.difference(shape, painted(strokes), grid_size=_GRID_MM))


def _areas(left):
    """Polygons alone: points and lines are left of edges that touch."""
    return shapely.MultiPolygon([part for part in shapely.get_parts(left) if part.geom_type == "Polygon"])


def contour_passes(shape, wide: list, narrow: list, least: float, half: float) -> list[list[Line]]:
    """Ways to fill a shape, each as lines, outermost ring first: with sides that end square in right-angled corners,
    where the brush can and the shape has some, and with rings that turn there; none for a shape that no lettering has.

    shape: a polygon of shapely; wide, narrow: strokes found for it, those that the brush cannot
    paint and those that are painted anyway; least, half: the brush's half widths [mm].
    """
    least = min(least, _AS_WIDE * half)  # of a pen, whose least width is its greatest
    shape = shape.simplify(_SIMPLER_MM)
    if _close_pairs(shape, half) > _MOST_PAIRS:
        return []
    rings = _rings(shape, half)
    if rings is None:
        return []
    kinds = (
        (_slanted_corners, _right_corners, _steep_corners, _no_corners)
        if least < _SQUARED * half
        else (_no_corners,)
    )
    ways = [_cut(rings, half, shape, squared_at) for squared_at in kinds]
    counts = [sum(bool(line.wanted_mm) for line in lines) for lines in ways]
    ways = [lines for k, lines in enumerate(ways) if counts[k] not in counts[k + 1 :]]
    filled = (_rest_filled(lines, shape, wide, narrow, least, half) for lines in ways)
    return [lines for lines in filled if lines]


def _rest_filled(lines: list[Line], shape, wide: list, narrow: list, least: float, half: float) -> list[Line]:
    """Rings, and lines into what they leave of a shape."""
    left = unpainted(shape, [*narrow, *lines])
    edge = shape.boundary
    tips = _tips(shape, lines, half)
    inside = [part for part in shapely.get_parts(left) if shapely.distance(part, edge) > _INSIDE * half]
    dear = _areas(shapely.union_all([*tips, *inside], grid_size=_GRID_MM))
    left = _areas(shapely.union(left, dear, grid_size=_GRID_MM))
    shapely.prepare(edge)
    for candidates in ([_rows(stroke, edge, half) for stroke in wide], _axis(shape, half)):
        lengthened = [_lengthened(rows, shape, edge, half) for rows in candidates]
        found, left = _fill(left, dear, lengthened, least, half, shape)
        lines += found
    alone = len(lines) == 1 and lines[0].closed
    return [] if alone and _length_mm(lines[0]) < _TURNED_IN * half else lines


def _tips(shape, lines: list[Line], half: float) -> list:
    """What the narrow mark that runs into the shape's corners at square ends of lines leaves of the sharpest."""
    squared = [region(list(line.wanted_mm)) for line in lines if line.wanted_mm]
    if not squared:
        return []
    narrow = _NARROW * half
    bare = shapely.difference(
        shape, shape.buffer(-narrow).buffer(narrow, quad_segs=_QUARTER), grid_size=_GRID_MM
    )
    left = shapely.intersection(bare, shapely.union_all(squared), grid_size=_GRID_MM)
    return [part for part in _areas(left).geoms if part.area > _TIP * half**2]


def _length_mm(line: Line) -> float:
    return _core.flatten(_core.Stroke(middle_mm=line.middle_mm, half_width=line.half_width), 0.02)[-1, 2]


def _close_pairs(shape, half: float) -> float:
    """About how many points of an outline lie within a half width of each other: what GEOS takes to move it inward."""
    points = shapely.get_coordinates(shape)
    some = points[:: max(len(points) // 200, 1)]
    near = [np.count_nonzero(np.hypot(*(points - point).T) < half) for point in some]
    return float(np.mean(near)) * len(points)


def _rings(shape, half: float) -> list[list[np.ndarray]] | None:
    """Rings along the outline, then those farther inside."""
    radius = shapely.maximum_inscribed_circle(shape, 0.01 * half).length
    across = radius - half - _INNERMOST * half
    steps = max(int(np.ceil(across / (_STEP * half) - 0.4)), 0)
    if steps > _MOST_RINGS:
        return None
    step = min(across / max(steps, 1), _STEP * half)
    return [_inward(shape, half + k * step, _HAIR * half) for k in range(steps + 1)]


def _cut(rings: list[list[np.ndarray]], half: float, shape, squared_at) -> list[Line]:
    return [
        line
        for k, of_depth in enumerate(rings)
        for points in of_depth
        for line in _passes(points, half, shape if k == 0 else None, squared_at)
    ]


def _inward(shape, by_mm: float, hair_mm: float) -> list[np.ndarray]:
    """Rings of the shape moved inward, its hairs left out; outer ones counter-clockwise, from the upper left."""
    without_hairs = shape.buffer(-by_mm - hair_mm, quad_segs=_ROUND).buffer(
        1.01 * hair_mm, join_style="mitre", mitre_limit=10
    )
    moved = shape.buffer(-by_mm, quad_segs=_ROUND).intersection(without_hairs).simplify(0.003)
    return [
        np.array(ring.coords)
        for polygon in shapely.get_parts(shapely.orient_polygons(moved))
        if polygon.area > hair_mm**2
        for ring in (polygon.exterior, *polygon.interiors)
        if len(ring.coords) > 3
    ]


def _passes(points: np.ndarray, half: float, shape, squared_at) -> list[Line]:
    """A ring as lines: closed, from amid its longest stretch on, as the tip of a brush set down there lies on the ring;
    the outermost, whose edge shows, given the shape, cut where it turns too sharply for a brush that turns in place, or
    where marks with square ends meet in a corner."""
    ring = _with_sharp_tips(points[:-1], 3 * _HAIR * half)
    corners = _corners(ring, _CORNER_RAD)
    sharp = _corners(ring, _SHARP_RAD)
    squared = _no_corners() if shape is None else squared_at(ring, half, shape)
    sharp = np.union1d(sharp, squared)
    if not len(corners):
        return [_line(np.roll(ring, -int((ring @ _UPPER_LEFT).argmax()), axis=0), [], half, True)]
    if shape is None or not len(sharp):
        ring, corners = _amid_longest(ring, corners)
        return [_line(np.vstack([ring, ring[:1]]), corners, half, True)]
    first = sharp[(ring[sharp] @ _UPPER_LEFT).argmax()]
    sharp, corners, squared = (np.sort((which - first) % len(ring)) for which in (sharp, corners, squared))
    ring = np.roll(ring, -first, axis=0)
    ring = np.vstack([ring, ring[:1]])
    lines = []
    for a, b in itertools.pairwise([*sharp, len(ring) - 1]):
        square = [k % (len(ring) - 1) in squared for k in (a, b)]
        square[0] = square[0] and length(ring[a : b + 1]) > _SET_DOWN * half
        part, turns = _clear_of_cusps(
            ring[a : b + 1], [int(k - a) for k in corners if a < k < b], half, square
        )
        line = _line(part, turns, half, False)
        lines.append(_squared(line, half, shape, square) if any(square) else line)
    return lines


def _clear_of_cusps(
    points: np.ndarray, corners: list[int], half: float, square: list[bool]
) -> tuple[np.ndarray, list[int]]:
    """A line of a ring and its corners, shorter at ends that are not square: there the shape is hardly wider than the
    brush, and a mark that begins or ends beside one edge sticks out of the other."""
    at = lengths(points)
    first, last = (0.0 if is_square else _OFF_CUSP * half for is_square in square)
    if at[-1] < first + last + 2 * half:
        return points, corners
    ends = [first, at[-1] - last]
    inner = np.flatnonzero((at > ends[0]) & (at < ends[1]))
    places = [[np.interp(end, at, points[:, k]) for k in (0, 1)] for end in ends]
    return np.vstack([places[0], points[inner], places[1]]), [
        int(k - inner[0]) + 1 for k in corners if ends[0] < at[k] < ends[1]
    ]


def _no_corners(*_) -> np.ndarray:
    return np.zeros(0, int)


def _steep_corners(ring: np.ndarray, *_) -> np.ndarray:
    """Corners of about 90 degrees: cusps of the ring as well, where the shape becomes as narrow as the brush."""
    return np.setdiff1d(_corners(ring, _SQUARE_RAD), _corners(ring, _SHARP_RAD))


def _right_corners(ring: np.ndarray, half: float, shape) -> np.ndarray:
    """Corners of a ring where its shape has one of about 90 degrees."""
    return _of_shape(_steep_corners(ring), ring, half, shape)


def _slanted_corners(ring: np.ndarray, half: float, shape) -> np.ndarray:
    """Corners of a ring where its shape has one that a square end, cut slantwise, reaches into."""
    some = np.setdiff1d(_corners(ring, _SLANTED_RAD), _corners(ring, _POINTED_RAD))
    return _of_shape(some, ring, half, shape)


def _of_shape(corners: np.ndarray, ring: np.ndarray, half: float, shape) -> np.ndarray:
    """Those of the corners of a ring that lie half a width inside of a corner of the shape."""
    here = ring[corners]
    out = [here - ring[corners - 1], here - ring[(corners + 1) % len(ring)]]
    u, v = (each / np.hypot(*each.T)[:, None] for each in out)
    tips = here + half * (u + v) / np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])[:, None]
    near = (
        shapely.distance(shapely.points(tips), shapely.multipoints(shapely.get_coordinates(shape)))
        < _AT_TIP * half
    )
    return corners[near]


def _squared(line: Line, half: float, shape, ends: list[bool]) -> Line:
    """The line, meant to paint into the corners of the shape at these of its ends as well, the first, the last."""
    way = _core.flatten(_core.Stroke(middle_mm=line.middle_mm, half_width=line.half_width), 0.01)[:, :2]
    whole = shapely.buffer(shapely.LineString(way), half, quad_segs=_QUARTER)
    for is_square, (end, inner) in zip(ends, (way[:2], way[:-3:-1]), strict=True):
        if is_square:
            along = _REACH * half * (end - inner) / np.hypot(*(end - inner))
            cap = shapely.LineString([end, end + along]).buffer(half, cap_style="flat")
            cap = _beside(shapely.intersection(cap, shape, grid_size=_GRID_MM), end)
            whole = shapely.union(whole, cap)
    parts = shapely.get_parts(shapely.intersection(whole, shape, grid_size=_GRID_MM))
    part = shapely.orient_polygons(max(parts, key=shapely.area))
    rings = [np.array(ring.coords)[:-1] for ring in (part.exterior, *part.interiors)]
    return replace(line, wanted_mm=tuple(_core.unite(rings)))


def _beside(parts, place: np.ndarray):
    """The part that a place lies in."""
    return min(shapely.get_parts(parts), key=lambda part: shapely.distance(part, shapely.Point(place)))


def _corners(ring: np.ndarray, least_rad: float) -> np.ndarray:
    edges = np.roll(ring, -1, axis=0) - ring
    before = np.roll(edges, 1, axis=0)
    cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
    return np.flatnonzero(np.abs(np.arctan2(cross, (before * edges).sum(axis=1))) > least_rad)


def _with_sharp_tips(ring: np.ndarray, wide_mm: float) -> np.ndarray:
    """Where a corner follows another so closely that both are one tip, the first alone."""
    corners = _corners(ring, _CORNER_RAD)
    following = np.roll(corners, -1)
    steps = (following - corners) % len(ring)
    near = (np.hypot(*(ring[following] - ring[corners]).T) < wide_mm) & (steps <= 3)
    kept = np.ones(len(ring), bool)
    for corner, count in zip(corners[near], steps[near], strict=True):
        kept[(corner + 1 + np.arange(count)) % len(ring)] = False
    return ring[kept] if kept.sum() >= 3 else ring


def _amid_longest(ring: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, list[int]]:
    """The ring from the middle of its longest stretch between corners on, and its corners then."""
    ring, corners = np.roll(ring, -corners[0], axis=0), corners - corners[0]
    at = lengths(np.vstack([ring, ring[:1]]))
    ends = np.append(at[corners], at[-1])
    longest = int(np.diff(ends).round(3).argmax())
    middle = (ends[longest] + ends[longest + 1]) / 2
    place = [np.interp(middle, at, np.append(ring[:, k], ring[0, k])) for k in (0, 1)]
    after = int(np.searchsorted(at[:-1], middle))
    return np.vstack([place, ring[after:], ring[:after]]), sorted(
        int((k - after) % len(ring)) + 1 for k in corners
    )


def _line(points: np.ndarray, corners: list[int], half: float, closed: bool) -> Line:
    if closed and not len(corners):
        points = np.vstack([points, points[:1]])
    rows = np.column_stack([points, np.full(len(points), half)])
    middles = [
        _core.fit_curve(rows[a : b + 1], FITTED * half, closed and not corners)[0]
        for a, b in itertools.pairwise([0, *corners, len(rows) - 1])
    ]
    return Line(np.vstack(middles), [(0.0, half)], closed)


def _rows(stroke, edge, half: float) -> np.ndarray:
    """Places along a stroke: x, y, half width that fits between the edges."""
    line = _evenly(_core.flatten(stroke, 0.02)[:, [0, 1, 3]], half)
    return np.column_stack(
        [line[:, :2], np.minimum(line[:, 2], shapely.distance(shapely.points(line[:, :2]), edge))]
    )


def _lengthened(rows: np.ndarray, shape, edge, half: float) -> np.ndarray:
    """Places along a line, and straight on behind its wide ends: a mark begins and ends inside of the shape."""
    for _ in range(2):
        rows = rows[::-1]
        behind = rows[-1, :2] - rows[max(len(rows) - 4, 0), :2]
        length = np.hypot(*behind)
        if length < 1e-9 or rows[-1, 2] < _WIDE_END * half:
            continue
        steps = np.arange(_EVEN, _LANDING + _EVEN, _EVEN)[:, None] * half
        places = rows[-1, :2] + steps * behind / length
        points = shapely.points(places)
        room = np.where(shapely.contains(shape, points), shapely.distance(points, edge), 0.0)
        widths = np.minimum.accumulate(np.minimum(room, rows[-1, 2]))
        fits = widths >= _WIDE_END * half
        rows = np.vstack([rows, np.column_stack([places, widths])[fits]])
    return rows


def _axis(shape, half: float) -> list[np.ndarray]:
    """Branches of the medial axis, from where the shape is narrow to where it is wide: out of its corners."""
    radius = shapely.maximum_inscribed_circle(shape, 0.01 * half).length
    polygon = shapely.orient_polygons(shape)
    rings = _core.unite([np.array(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)])
    _, branches = _core.medial_axis(rings, _WORTH * min(half / radius, 1.0) ** 2)
    if len(branches) > _MOST_LINES:
        return []
    lines = (branch.line for branch in branches)
    return [_evenly(line if line[0, 2] <= line[-1, 2] else line[::-1], half) for line in lines]


def _evenly(line: np.ndarray, half: float) -> np.ndarray:
    at = lengths(line[:, :2])
    count = min(int(at[-1] / (_EVEN * half)) + 2, 5000)
    return np.column_stack([np.interp(np.linspace(0, at[-1], count), at, line[:, k]) for k in range(3)])


def _fill(
    left, dear, candidates: list[np.ndarray], least: float, half: float, shape
) -> tuple[list[Line], shapely.Geometry]:
    """Stretches of the lines that paint what is left, those that paint most of it first, and what they leave. dear:
    what of it shows more than an edge that is a little off: gaps amid paint, tips."""
    stretches = []
    for rows in candidates:
        rows = np.column_stack([rows[:, :2], np.clip(rows[:, 2], None, half)])
        shown = _shown(rows, left, dear) > _SEEN * half**2
        more = int(_LANDING / _EVEN)
        for first, last in _runs(shown & (rows[:, 2] >= least), more):
            stretch = rows[first : last + 1]
            if _slope(stretch) < _BLUNT:
                behind, ahead = rows[last + 1 : last + 1 + more], rows[max(first - more, 0) : first][::-1]
                room = max(_WIDE_END * half, least)
                stretch = np.vstack([_wide(ahead, room)[::-1], stretch, _wide(behind, room)])
            stretches.append(stretch)
    made = []
    for rows in sorted(stretches, key=lambda rows: -_shown(rows, left, dear).sum()):
        line = _fitted(rows, least)
        if shapely.difference(painted([line]), shape, grid_size=_GRID_MM).area > _WORTH * half**2:
            continue  # few places may be fitted by a curve that leaves the shape
        without = unpainted(left, [line])
        if _weight(left, dear) - _weight(without, dear) >= _WORTH * half**2:
            left = without
            made.append(_ending_as(line, rows, shape, half) if least < _SQUARED * half else line)
    return made, left


def _ending_as(line: Line, rows: np.ndarray, shape, half: float) -> Line:
    """The line, meant to paint into the blunt ends of a shape where it ends there."""
    caps = []
    for end, inner in ((rows[0], rows[min(3, len(rows) - 1)]), (rows[-1], rows[max(-4, -len(rows))])):
        along = end[:2] - inner[:2]
        if end[2] < _WIDE_END * half or not (far := np.hypot(*along)):
            continue
        reach = shapely.LineString([end[:2], end[:2] + _PAST * end[2] * along / far])
        cap = shapely.intersection(reach.buffer(end[2], cap_style="flat"), shape, grid_size=_GRID_MM)
        if cap.area < _BLUNT_END * 2 * end[2] ** 2:
            caps.append(cap)
    if not caps:
        return line
    whole = shapely.intersection(shapely.union_all([*_swept(line), *caps]), shape, grid_size=_GRID_MM)
    part = shapely.orient_polygons(max(shapely.get_parts(whole), key=shapely.area))
    rings = [np.array(ring.coords)[:-1] for ring in (part.exterior, *part.interiors)]
    return replace(line, wanted_mm=tuple(_core.unite(rings)))


def _slope(rows: np.ndarray) -> float:
    return abs(float(rows[-1, 2] - rows[0, 2])) / max(length(rows[:, :2]), 1e-9)


def _wide(rows: np.ndarray, room: float) -> np.ndarray:
    """Places up to the first that is narrower: farther on a line leads into a corner, where its tip would stick out."""
    narrow = np.flatnonzero(rows[:, 2] < room)
    return rows[: narrow[0]] if len(narrow) else rows


def _shown(rows: np.ndarray, left, dear) -> np.ndarray:
    discs = shapely.buffer(shapely.points(rows[:, :2]), rows[:, 2])
    return _weight(shapely.intersection(discs, left), dear)


def _weight(left, dear):
    if dear.is_empty:
        return shapely.area(left)
    return shapely.area(left) + (_DEAR - 1) * shapely.area(shapely.intersection(left, dear))


def _runs(wanted: np.ndarray, gap: int) -> list[tuple[int, int]]:
    """First and last place of each run, gaps up to so many places closed."""
    places = np.flatnonzero(wanted)
    if not len(places):
        return []
    cuts = np.flatnonzero(np.diff(places) > gap)
    return list(
        zip(places[[0, *(cuts + 1)]].tolist(), places[[*cuts, len(places) - 1]].tolist(), strict=True)
    )


def _fitted(rows: np.ndarray, least: float) -> Line:
    middle, knots = _core.fit_curve(rows, max(0.5 * FITTED * float(rows[:, 2].mean()), 1e-3))
    hair = max(least, 0.01 * max(h for _, h in knots))
    return Line(middle, [(at, max(h, hair)) for at, h in knots])
