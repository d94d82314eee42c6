"""Rings along the outline of a shape and further inside, cut into lines.

A ring is cut where the brush would turn too sharply.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import shapely

from .. import _core
from ..geometry.polylines import lengths

# Tolerance of a fitted curve, in half widths of the pass: as much is outside of the shape.
FIT_TOLERANCE = 0.03
# Greatest step from ring to ring, in half widths. At corners of 90 degrees a step of 1.7 leaves a gap, at corners
# of 60 degrees one of 1.5.
_MAX_RING_STEP = 1.5
# Greatest distance in half widths from the innermost ring to the shape's middle, which that ring covers.
_MAX_TO_MIDDLE = 0.9
# In half widths: a narrower place gets no ring, a line along its middle covers it.
_MIN_RING_PLACE = 0.05
_UPPER_LEFT = (-0.3, 1.0)
_MIN_CORNER_RAD, _MIN_SHARP_RAD = np.radians(30), np.radians(100)
_CUSP_DISTANCE = 0.4  # how much of a line is cut off at a cusp, in half widths
# How far a footprint reaches before and behind the place where a ring begins, in half widths. Chords of this length
# that differ by less than the second value have similar bends.
_FOOTPRINT_REACH, _MAX_CHORD_DIFFERENCE = 1.5, 0.02
_QUARTER_EDGES = 8  # edges of a quarter of a circle, which are off by 5e-3 of its radius
_MAX_RINGS = 400  # with more, the middle lines are used


@dataclass(frozen=True)
class Line:
    """A line of cubics with half widths.

    middle_mm: cubics (n, 8); half_width: [(fraction of arc length, mm)].
    """

    middle_mm: np.ndarray
    half_width: list[tuple[float, float]]
    closed: bool = False


def offset_along(shape, half: float) -> list[np.ndarray]:
    """Return rings along the outline, half a line's width inside of it."""
    return _offset_shape(shape, half, _MIN_RING_PLACE * half)


def offset_inward(shape, half: float) -> list[list[np.ndarray]] | None:
    """Return rings along the outline, and then rings further inside. Returns None if there are too many rings."""
    radius = shapely.maximum_inscribed_circle(shape, 0.01 * half).length
    across = radius - half - _MAX_TO_MIDDLE * half
    steps = max(int(np.ceil(across / (_MAX_RING_STEP * half) - 0.4)), 0)
    if steps > _MAX_RINGS:
        return None
    step = min(across / max(steps, 1), _MAX_RING_STEP * half)
    return [_offset_shape(shape, half + k * step, _MIN_RING_PLACE * half) for k in range(steps + 1)]


def cut_rings(rings: list[list[np.ndarray]], half: float) -> list[Line]:
    """Return rings as lines, the outermost ones cut. They are cut where a brush would turn too sharply."""
    return [
        line
        for k, of_depth in enumerate(rings)
        for points in of_depth
        for line in _cut_ring(points, half, is_outermost=k == 0)
    ]


def _offset_shape(shape, by_mm: float, hair_mm: float) -> list[np.ndarray]:
    """Return a shape's rings moved inward, without hairs; outer ones counter-clockwise from the upper left."""
    core = shape.buffer(-by_mm - hair_mm, quad_segs=_QUARTER_EDGES)
    # The edges of a mitre may cross where two edges all but touch.
    without_hairs = shapely.make_valid(core.buffer(1.01 * hair_mm, join_style="mitre", mitre_limit=10))
    moved = shape.buffer(-by_mm, quad_segs=_QUARTER_EDGES).intersection(without_hairs).simplify(0.003)
    return [
        np.array(ring.coords)
        for polygon in shapely.get_parts(shapely.orient_polygons(moved))
        if polygon.area > hair_mm**2
        for ring in (polygon.exterior, *polygon.interiors)
        if len(ring.coords) > 3
    ]


def _cut_ring(points: np.ndarray, half: float, is_outermost: bool) -> list[Line]:
    """Return a ring as lines.

    A ring that stays closed begins in the middle of its longest stretch: the tip of a brush that is set down there
    is on the ring. The outermost ring, whose edge shows, is cut where it turns too sharply for a brush that turns
    in place.
    """
    ring = _merge_tips(points[:-1], 3 * _MIN_RING_PLACE * half)
    corners = _find_corners(ring, _MIN_CORNER_RAD)
    sharp = _find_corners(ring, _MIN_SHARP_RAD)
    if not len(corners):
        return [_fit_line(np.roll(ring, -_find_straightest(ring, half), axis=0), [], half, True)]
    if not is_outermost or not len(sharp):
        ring, corners = _begin_amid_longest(ring, corners)
        return [_fit_line(np.vstack([ring, ring[:1]]), corners, half, True)]
    first = sharp[(ring[sharp] @ _UPPER_LEFT).argmax()]
    sharp, corners = (np.sort((numbers - first) % len(ring)) for numbers in (sharp, corners))
    ring = np.roll(ring, -first, axis=0)
    ring = np.vstack([ring, ring[:1]])
    return [
        _fit_line(*_shorten_at_cusps(ring[a : b + 1], [int(k - a) for k in corners if a < k < b], half), half, False)
        for a, b in itertools.pairwise([*sharp, len(ring) - 1])
    ]


def _shorten_at_cusps(points: np.ndarray, corners: list[int], half: float) -> tuple[np.ndarray, list[int]]:
    """Return a line of a ring and its corners, shortened at both ends.

    There the shape is hardly wider than the brush, and a mark that begins or ends next to one edge sticks out of
    the other.
    """
    at = lengths(points)
    ends = [_CUSP_DISTANCE * half, at[-1] - _CUSP_DISTANCE * half]
    if ends[1] < ends[0] + 2 * half:
        return points, corners
    inner = np.flatnonzero((at > ends[0]) & (at < ends[1]))
    places = [[np.interp(end, at, points[:, k]) for k in (0, 1)] for end in ends]
    return np.vstack([places[0], points[inner], places[1]]), [
        int(k - inner[0]) + 1 for k in corners if ends[0] < at[k] < ends[1]
    ]


def _find_corners(ring: np.ndarray, least_rad: float) -> np.ndarray:
    edges = np.roll(ring, -1, axis=0) - ring
    before = np.roll(edges, 1, axis=0)
    cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
    return np.flatnonzero(np.abs(np.arctan2(cross, (before * edges).sum(axis=1))) > least_rad)


def _merge_tips(ring: np.ndarray, wide_mm: float) -> np.ndarray:
    """Merge corners that follow each other so closely that they are one tip. Only the first corner of a tip is kept."""
    corners = _find_corners(ring, _MIN_CORNER_RAD)
    following = np.roll(corners, -1)
    steps = (following - corners) % len(ring)
    near = (np.hypot(*(ring[following] - ring[corners]).T) < wide_mm) & (steps <= 3)
    kept = np.ones(len(ring), bool)
    for corner, count in zip(corners[near], steps[near], strict=True):
        kept[(corner + 1 + np.arange(count)) % len(ring)] = False
    return ring[kept] if kept.sum() >= 3 else ring


def _find_straightest(ring: np.ndarray, half: float) -> int:
    """Return where a ring without corners bends least.

    Of similar places, it is the one that is furthest to the upper left.
    """
    at = lengths(np.vstack([ring, ring[:1]]))
    reach = min(_FOOTPRINT_REACH * half, at[-1] / 4)
    before, behind = (
        np.column_stack([np.interp(at[:-1] + by, at, np.append(xy, xy[0]), period=at[-1]) for xy in ring.T])
        for by in (-reach, reach)
    )
    chords = np.hypot(*(behind - before).T)
    straight = np.flatnonzero(chords > chords.max() - _MAX_CHORD_DIFFERENCE * reach)
    return int(straight[(ring[straight] @ _UPPER_LEFT).argmax()])


def _begin_amid_longest(ring: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, list[int]]:
    """Begin a ring in the middle of its longest stretch between corners. Returns the ring and its corners."""
    ring, corners = np.roll(ring, -corners[0], axis=0), corners - corners[0]
    at = lengths(np.vstack([ring, ring[:1]]))
    ends = np.append(at[corners], at[-1])
    longest = int(np.diff(ends).round(3).argmax())
    middle = (ends[longest] + ends[longest + 1]) / 2
    place = [np.interp(middle, at, np.append(ring[:, k], ring[0, k])) for k in (0, 1)]
    after = int(np.searchsorted(at[:-1], middle))
    return np.vstack([place, ring[after:], ring[:after]]), sorted(int((k - after) % len(ring)) + 1 for k in corners)


def _fit_line(points: np.ndarray, corners: list[int], half: float, closed: bool) -> Line:
    if closed and not len(corners):
        points = np.vstack([points, points[:1]])
    rows = np.column_stack([points, np.full(len(points), half)])
    middles = [
        _core.fit_cubics(rows[a : b + 1], FIT_TOLERANCE * half, closed and not corners)[0]
        for a, b in itertools.pairwise([0, *corners, len(rows) - 1])
    ]
    return Line(np.vstack(middles), [(0.0, half)], closed)
