"""Rings along the outline of a shape and further inside, and the lines that they are cut into: where the brush would
turn too sharply."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import shapely

from .. import _core
from ..geometry.polylines import lengths

FITTED = 0.03  # of a pass's half width, off its curve at most: as much is outside of the shape
# From ring to ring at most, in half widths: at corners of 90 degrees a step of 1.7 leaves a gap, of 60 one of 1.5.
_STEP = 1.5
_INNERMOST = 0.9  # in half widths, from the innermost ring to the shape's middle: it covers that
_HAIR = 0.05  # in half widths: no ring round a place narrower than that, a line along its middle covers it
_UPPER_LEFT = (-0.3, 1.0)
_CORNER_RAD, _SHARP_RAD = np.radians(30), np.radians(100)
_OFF_CUSP = 0.4  # in half widths
# How far a footprint reaches before and behind the place where a ring begins, in half widths; chords of that length
# that differ by less are of bends alike.
_FOOTPRINT, _AS_STRAIGHT = 1.5, 0.02
_ROUND = 8  # edges of a quarter of a circle, off by 5e-3 of its radius
_MOST_RINGS = 400  # with more, the middle lines have to do


@dataclass(frozen=True)
class Line:
    """middle_mm: cubics (n, 8); half_width: [(fraction of arc length, mm)]."""

    middle_mm: np.ndarray
    half_width: list[tuple[float, float]]
    closed: bool = False


def ring_along(shape, half: float) -> list[np.ndarray]:
    """Rings along the outline, half a line's width inside of it."""
    return _inward(shape, half, _HAIR * half)


def rings_inward(shape, half: float) -> list[list[np.ndarray]] | None:
    """The same, then those further inside."""
    radius = shapely.maximum_inscribed_circle(shape, 0.01 * half).length
    across = radius - half - _INNERMOST * half
    steps = max(int(np.ceil(across / (_STEP * half) - 0.4)), 0)
    if steps > _MOST_RINGS:
        return None
    step = min(across / max(steps, 1), _STEP * half)
    return [_inward(shape, half + k * step, _HAIR * half) for k in range(steps + 1)]


def cut(rings: list[list[np.ndarray]], half: float) -> list[Line]:
    """Rings as lines, the outermost ones cut where a brush would turn too sharply."""
    return [
        line
        for k, of_depth in enumerate(rings)
        for points in of_depth
        for line in _passes(points, half, is_outermost=k == 0)
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


def _passes(points: np.ndarray, half: float, is_outermost: bool) -> list[Line]:
    """A ring as lines: closed, from amid its longest stretch on, as the tip of a brush set down there is on the ring.
    The outermost, whose edge shows, is cut where it turns too sharply for a brush that turns in place."""
    ring = _with_sharp_tips(points[:-1], 3 * _HAIR * half)
    corners = _corners(ring, _CORNER_RAD)
    sharp = _corners(ring, _SHARP_RAD)
    if not len(corners):
        return [_line(np.roll(ring, -_straightest(ring, half), axis=0), [], half, True)]
    if not is_outermost or not len(sharp):
        ring, corners = _amid_longest(ring, corners)
        return [_line(np.vstack([ring, ring[:1]]), corners, half, True)]
    first = sharp[(ring[sharp] @ _UPPER_LEFT).argmax()]
    sharp, corners = (np.sort((which - first) % len(ring)) for which in (sharp, corners))
    ring = np.roll(ring, -first, axis=0)
    ring = np.vstack([ring, ring[:1]])
    return [
        _line(
            *_clear_of_cusps(ring[a : b + 1], [int(k - a) for k in corners if a < k < b], half), half, False
        )
        for a, b in itertools.pairwise([*sharp, len(ring) - 1])
    ]


def _clear_of_cusps(points: np.ndarray, corners: list[int], half: float) -> tuple[np.ndarray, list[int]]:
    """A line of a ring and its corners, shorter at both ends: there the shape is hardly wider than the brush, and a
    mark that begins or ends next to one edge sticks out of the other."""
    at = lengths(points)
    ends = [_OFF_CUSP * half, at[-1] - _OFF_CUSP * half]
    if ends[1] < ends[0] + 2 * half:
        return points, corners
    inner = np.flatnonzero((at > ends[0]) & (at < ends[1]))
    places = [[np.interp(end, at, points[:, k]) for k in (0, 1)] for end in ends]
    return np.vstack([places[0], points[inner], places[1]]), [
        int(k - inner[0]) + 1 for k in corners if ends[0] < at[k] < ends[1]
    ]


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


def _straightest(ring: np.ndarray, half: float) -> int:
    """Where a ring without corners bends least, the farthest to the upper left of such places."""
    at = lengths(np.vstack([ring, ring[:1]]))
    reach = min(_FOOTPRINT * half, at[-1] / 4)
    before, behind = (
        np.column_stack([np.interp(at[:-1] + by, at, np.append(xy, xy[0]), period=at[-1]) for xy in ring.T])
        for by in (-reach, reach)
    )
    chords = np.hypot(*(behind - before).T)
    straight = np.flatnonzero(chords > chords.max() - _AS_STRAIGHT * reach)
    return int(straight[(ring[straight] @ _UPPER_LEFT).argmax()])


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
