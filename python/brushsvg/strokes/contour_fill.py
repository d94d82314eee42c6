"""A shape wider than the brush, filled along its outline.

Discs of the brush's greatest half width h fit into the shape where it is wider, with their centres in the shape moved
inward by h. The first passes run along that line's rings, so their edge is the outline; further ones further inside.
Corners, necks and narrow parts are left to the search.
"""

from __future__ import annotations

import numpy as np
import shapely

from .. import _core
from .contour_rings import Line, cut, ring_along, rings_inward
from .swept_areas import GRID_MM, QUARTER, unpainted

# Half widths of a disc in the shape: in a narrower one opposite sides of a ring paint the same place.
_WIDE = 1.5
_TURNED_IN = 2.0  # half widths round a ring that is all of a filling: in a smaller one the brush would turn on the spot
_AS_WIDE = 0.98  # a place that is narrower than a pen by less takes it
_AMID = 0.05  # squares of the half width that a dot and a ring round it may leave between them
# A ring round a dot, in half widths of the brush: its overlap with the dot, its least and its greatest width.
_ON_DOT, _NARROWEST_RING, _WIDEST_RING = 0.2, 0.36, 0.8
_SIMPLER_MM = 0.02  # an edge of the outline costs as much as all the rest
_MOST_PAIRS = 10_000  # beyond, a shape is no lettering, and the middle lines have to do


def contour_passes(shape, least: float, half: float) -> list[list[Line]]:
    """Ways to fill a shape, each as lines, outermost ring first: rings, and a dot with a ring round it; none for a
    shape that no lettering has.

    shape: a polygon of shapely; least, half: the brush's half widths [mm].
    """
    least = min(least, _AS_WIDE * half)  # of a pen, whose least width is its greatest
    shape = shape.simplify(_SIMPLER_MM)
    if _close_pairs(shape, half) > _MOST_PAIRS:
        return []
    ways = [_dot_and_ring(shape, least, half)]
    radius = shapely.maximum_inscribed_circle(shape, 0.01 * half).length
    is_pen = least == _AS_WIDE * half
    rings = rings_inward(shape, half) if is_pen or radius > _WIDE * half else None
    if rings is not None:
        ways.insert(0, cut(rings, half))
    return [lines for lines in ways if lines and not _turns_on_the_spot(lines, half)]


def _dot_and_ring(shape, least: float, half: float) -> list[Line]:
    """Return a dot and a ring round it for a round shape hardly wider than the brush, in which a contour would turn too
    sharply: the place where the brush turns on the spot, and the ring that overlaps its mark; none for another
    shape."""
    circle = shapely.maximum_inscribed_circle(shape, 0.01 * half)
    width = max((circle.length - half + _ON_DOT * half) / 2, _NARROWEST_RING * half)
    if not least <= width <= _WIDEST_RING * half:
        return []
    rings = ring_along(shape, width)
    if len(rings) != 1:
        return []
    centre = np.array(circle.coords[0])
    lines = [Line(np.tile(centre, 4).reshape(1, 8), [(0.0, half)]), *cut([rings], width)]
    dot = shapely.Point(centre).buffer((1 - _ON_DOT / 2) * half, quad_segs=QUARTER)
    amid = shapely.difference(unpainted(shape.buffer(-width), lines[1:]), dot, grid_size=GRID_MM)
    return lines if amid.area < _AMID * half**2 else []


def _turns_on_the_spot(lines: list[Line], half: float) -> bool:
    return len(lines) == 1 and lines[0].closed and _length_mm(lines[0]) < _TURNED_IN * half


def _length_mm(line: Line) -> float:
    return _core.flatten(_core.Stroke(middle_mm=line.middle_mm, half_width=line.half_width), 0.02)[-1, 2]


def _close_pairs(shape, half: float) -> float:
    """About how many points of an outline are within a half width of each other: GEOS needs that for an inner
    offset."""
    points = shapely.get_coordinates(shape)
    some = points[:: max(len(points) // 200, 1)]
    near = [np.count_nonzero(np.hypot(*(points - point).T) < half) for point in some]
    return float(np.mean(near)) * len(points)
