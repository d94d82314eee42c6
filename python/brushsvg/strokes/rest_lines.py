"""Lines into what rings leave of a shape: stretches of its strokes and of its medial axis, as wide as the shape is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from .. import _core
from ..geometry.polylines import length, lengths
from .offset_passes import FITTED, Line
from .swept_areas import GRID_MM, painted, swept, unpainted

# Worth a line of its own, in squares of the half width; a corner of 90 degrees has 0.21, of 60 degrees 0.69.
_WORTH = 0.1
_DEAR = 10  # gaps amid paint and tips count so many times: one of 0.01 squares is worth a line
_SEEN = 0.02  # what a line's disc must show of the unpainted to be a part of it
_EVEN = 0.25  # between places on a line, in half widths
# What a line is longer than what it has to paint at either end, in half widths: a mark begins pointed, and one shorter
# than a footprint lies behind its line.
_LANDING = 1.5
# Half width won per length, 0.71 in a right-angled corner: beyond, a longer line would press the brush so fast that its
# tip runs back out of the corner.
_BLUNT = 0.6
_WIDE_END = 0.5  # in half widths; narrower ends lie in corners
SQUARED = 0.4  # of the greatest width, the least of a brush whose marks can begin and end square
# A shape ends where, so far ahead, it has little more than a square, in half widths.
_PAST, _BLUNT_END = 1.5, 1.2
_MOST_LINES = 2_000  # of a shape with more branches, rings and strokes have to do


def rows_along(stroke, edge, half: float) -> np.ndarray:
    """Places along a stroke: x, y, half width that fits between the edges."""
    line = _evenly(_core.flatten(stroke, 0.02)[:, [0, 1, 3]], half)
    return np.column_stack(
        [line[:, :2], np.minimum(line[:, 2], shapely.distance(shapely.points(line[:, :2]), edge))]
    )


def lengthened(rows: np.ndarray, shape, edge, half: float) -> np.ndarray:
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


def axis_rows(shape, half: float) -> list[np.ndarray]:
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


def fill(
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
        if shapely.difference(painted([line]), shape, grid_size=GRID_MM).area > _WORTH * half**2:
            continue  # few places may be fitted by a curve that leaves the shape
        without = unpainted(left, [line])
        if _weight(left, dear) - _weight(without, dear) >= _WORTH * half**2:
            left = without
            made.append(_ending_as(line, rows, shape, half) if least < SQUARED * half else line)
    return made, left


def _ending_as(line: Line, rows: np.ndarray, shape, half: float) -> Line:
    """The line, meant to paint into the blunt ends of a shape where it ends there."""
    caps = []
    for end, inner in ((rows[0], rows[min(3, len(rows) - 1)]), (rows[-1], rows[max(-4, -len(rows))])):
        along = end[:2] - inner[:2]
        if end[2] < _WIDE_END * half or not (far := np.hypot(*along)):
            continue
        reach = shapely.LineString([end[:2], end[:2] + _PAST * end[2] * along / far])
        cap = shapely.intersection(reach.buffer(end[2], cap_style="flat"), shape, grid_size=GRID_MM)
        if cap.area < _BLUNT_END * 2 * end[2] ** 2:
            caps.append(cap)
    if not caps:
        return line
    whole = shapely.intersection(shapely.union_all([*swept(line), *caps]), shape, grid_size=GRID_MM)
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
