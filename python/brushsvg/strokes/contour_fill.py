"""A shape wider than the brush, filled along its outline.

Discs of the brush's greatest half width h fit into the shape where it is wider, with their centres in the shape moved
inward by h. The first passes run along that line's rings, so their edge is the outline; further ones further inside.
Corners, necks and narrow parts are left to the search.
"""

from __future__ import annotations

import numpy as np
import shapely

from .. import _core
from .contour_rings import Line, cut_rings, offset_along, offset_inward
from .swept_areas import GRID_MM, QUARTER_EDGES, unpainted_area

# Radius of a disc in the shape, in half widths of the brush. In a narrower shape, opposite sides of a ring paint
# the same place.
_MIN_DISC_RADIUS = 1.5
# Least length of a ring that is a whole filling, in half widths: on a shorter one the brush would turn on the spot.
_MIN_RING_LENGTH = 2.0
# A pen paints places that are narrower than its line by less than this factor.
_MIN_PEN_SHARE = 0.98
# Area that a dot and a ring round it may leave between them, in squares of the half width.
_MAX_GAP_AREA = 0.05
# A ring round a dot, in half widths of the brush: its overlap with the dot, its least and its greatest width.
_DOT_OVERLAP, _MIN_RING_WIDTH, _MAX_RING_WIDTH = 0.2, 0.36, 0.8
# Tolerance of a simpler outline: each of its edges costs as much as all the rest.
_SIMPLIFICATION_MM = 0.02
_MAX_CLOSE_PAIRS = 10_000  # with more, a shape is no lettering, and the middle lines are used


def find_contour_passes(shape, least: float, half: float) -> list[list[Line]]:
    """Return ways to fill a shape, each as lines, outermost ring first.

    The ways are rings, and a dot with a ring round it. There are none for a shape that no lettering has. shape: a
    polygon of shapely; least, half: the brush's half widths [mm].
    """
    least = min(least, _MIN_PEN_SHARE * half)  # for a pen, whose least width is its greatest
    shape = shape.simplify(_SIMPLIFICATION_MM)
    if _estimate_close_pairs(shape, half) > _MAX_CLOSE_PAIRS:
        return []
    ways = [_fill_with_dot_and_ring(shape, least, half)]
    radius = shapely.maximum_inscribed_circle(shape, 0.01 * half).length
    is_pen = least == _MIN_PEN_SHARE * half
    rings = offset_inward(shape, half) if is_pen or radius > _MIN_DISC_RADIUS * half else None
    if rings is not None:
        ways.insert(0, cut_rings(rings, half))
    return [lines for lines in ways if lines and not _turns_on_the_spot(lines, half)]


def _fill_with_dot_and_ring(shape, least: float, half: float) -> list[Line]:
    """Return a dot and a ring round it for a round shape.

    The shape is hardly wider than the brush, and a contour would turn too sharply in it. The dot is the place where
    the brush turns on the spot, and the ring overlaps its mark. Returns no lines for another shape.
    """
    circle = shapely.maximum_inscribed_circle(shape, 0.01 * half)
    width = max((circle.length - half + _DOT_OVERLAP * half) / 2, _MIN_RING_WIDTH * half)
    if not least <= width <= _MAX_RING_WIDTH * half:
        return []
    rings = offset_along(shape, width)
    if len(rings) != 1:
        return []
    centre = np.array(circle.coords[0])
    lines = [Line(np.tile(centre, 4).reshape(1, 8), [(0.0, half)]), *cut_rings([rings], width)]
    dot = shapely.Point(centre).buffer((1 - _DOT_OVERLAP / 2) * half, quad_segs=QUARTER_EDGES)
    gap = shapely.difference(unpainted_area(shape.buffer(-width), lines[1:]), dot, grid_size=GRID_MM)
    return lines if gap.area < _MAX_GAP_AREA * half**2 else []


def _turns_on_the_spot(lines: list[Line], half: float) -> bool:
    return len(lines) == 1 and lines[0].closed and _length_mm(lines[0]) < _MIN_RING_LENGTH * half


def _length_mm(line: Line) -> float:
    return _core.flatten(_core.Stroke(middle_mm=line.middle_mm, half_width=line.half_width), 0.02)[-1, 2]


def _estimate_close_pairs(shape, half: float) -> float:
    """Estimate how many pairs of outline points are closer than a half width.

    GEOS needs time for each of them when it offsets the shape inward.
    """
    points = shapely.get_coordinates(shape)
    sample = points[:: max(len(points) // 200, 1)]
    near = [np.count_nonzero(np.hypot(*(points - point).T) < half) for point in sample]
    return float(np.mean(near)) * len(points)
