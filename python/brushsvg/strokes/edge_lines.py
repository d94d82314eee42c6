"""Narrow lines along the edge of a filled shape, beside what the marks of its passes leave bare there."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import shapely

from .. import _core
from .bulges import faults_mm2, painted_by
from .offset_passes import FITTED, Line
from .swept_areas import region
from .trial_mark import SEEN_MM, Wanted

_CORNER_RAD = np.radians(30)  # there one line ends, and another one begins
_FLAT_MM = 0.02
# Half widths of the lines, in those of the brush: as narrow as at square ends, and wider beside deeper notches.
_WIDTHS = (0.27, 0.45, 0.7)
_AMID = 0.2  # of the brush's half width: a bare piece so far from the edge lies amid paint
_ON_PAINT = 0.5  # of a line's width lies on paint at least
_LANDING = 2.5  # in half widths of a line, before a bare place and behind it
_BESIDE = 4.0  # a line, in half widths: it paints no farther out
_AT_TIP = 0.4  # so near to a corner, in half widths, a bare piece lies in it
_TIPS = (0.03, 0.1)  # half width of a line where it begins in a corner, in those of the brush
_OVER = 1.3  # times as wide as a piece amid paint is the line across it
_EVEN_MM = 0.2
_ROOM = 0.9  # of a line's half width, that the shape has beside it
_BARE, _LEAST_MM2 = 0.25, 0.05  # of a pixel that is counted, of a bare place
_TOUCH = 0.51  # of a pixel's side: one that touches another one's corner is of one piece with it
_MOST = 40  # bare places of one shape
_BULGE_MM2 = 0.003  # that a line may stick out of the shape
_WORTH_MM2 = 0.5  # of faults, counted as for passes led otherwise


def edge_lines(paint: np.ndarray, wanted: Wanted, brush, as_stroke: Callable[[Line], object]) -> list[Line]:
    """Lines along a shape's edge, each where marks and shape differ by less for it.

    paint: how much of each of wanted's pixels is painted; as_stroke: a line as a stroke.
    """
    shape = region(wanted.rings)
    runs, corners = _runs(shape)
    made: list[Line] = []
    for places in _bare(paint, wanted)[:_MOST]:
        for ways in _beside(places, runs, corners, shape, brush):
            best = _best(ways, paint, wanted, brush, as_stroke) if ways else None
            if best is not None:
                line, painted, where = best
                made.append(line)
                np.maximum(paint[where], painted, out=paint[where])
    return made


def _bare(paint: np.ndarray, wanted: Wanted) -> list[np.ndarray]:
    """Places of each bare piece farther inside of a shape than is seen, the largest first [mm]."""
    pixels = np.argwhere(wanted.nearer - paint > _BARE)
    if len(pixels) == 0:
        return []
    low, high = (pixels - _TOUCH).T, (pixels + _TOUCH).T
    pieces = shapely.get_parts(shapely.union_all(shapely.box(*low, *high)))
    homes, which = shapely.STRtree(shapely.points(pixels)).query(pieces, "intersects")
    found = [wanted.places(pixels[which[homes == k]]) for k in range(len(pieces))]
    least = _LEAST_MM2 * wanted.px_per_mm**2
    return sorted((each for each in found if len(each) >= least), key=len, reverse=True)


class _Run(NamedTuple):
    """A stretch of an outline between corners, counter-clockwise round the shape; by how much its outline turns to the
    left where it begins and ends, None where it is a ring without a corner."""

    line: shapely.LineString
    turns_rad: tuple[float, float] | None

    def at(self, at_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places and directions there, straight on beyond its ends."""
        whole = self.line.length
        if self.turns_rad is None:
            at_mm = at_mm % whole
        near = np.clip(at_mm, 0.5 * _EVEN_MM, whole - 0.5 * _EVEN_MM)
        a, b = (
            shapely.get_coordinates(shapely.line_interpolate_point(self.line, near + by))
            for by in (-0.5 * _EVEN_MM, 0.5 * _EVEN_MM)
        )
        along = (b - a) / np.maximum(np.hypot(*(b - a).T), 1e-9)[:, None]
        return (a + b) / 2 + (at_mm - near)[:, None] * along, along


class _Corner(NamedTuple):
    """A corner of an outline that points outwards, and the direction from it that bisects the shape there."""

    at_mm: np.ndarray
    inwards: np.ndarray


def _runs(shape) -> tuple[list[_Run], list[_Corner]]:
    """An outline between its corners, and those that point outwards."""
    made, tips = [], []
    for polygon in shapely.get_parts(shapely.orient_polygons(shape.simplify(_FLAT_MM))):
        for ring in (polygon.exterior, *polygon.interiors):
            points = np.array(ring.coords)[:-1]
            before, edges = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
            cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
            turns = np.arctan2(cross, (before * edges).sum(axis=1))
            corners = np.flatnonzero(np.abs(turns) > _CORNER_RAD)
            for k in corners[turns[corners] > 0]:
                inwards = edges[k] / np.hypot(*edges[k]) - before[k] / np.hypot(*before[k])
                tips.append(_Corner(points[k], inwards / np.hypot(*inwards)))
            if not len(corners):
                made.append(_Run(shapely.LineString(np.vstack([points, points[:1]])), None))
                continue
            for a, b in zip(corners, [*corners[1:], corners[0] + len(points)], strict=True):
                some = points[np.arange(a, b + 1) % len(points)]
                made.append(_Run(shapely.LineString(some), (turns[a], turns[b % len(points)])))
    return made, tips


def _beside(
    places: np.ndarray, runs: list[_Run], corners: list[_Corner], shape, brush
) -> Iterator[list[Line]]:
    """For each corner that a bare piece lies in, and each edge that it lies beside, ways to lead a line there."""
    points, edge = shapely.points(places), shape.boundary
    off = np.array([shapely.distance(run.line, points) for run in runs])
    nearest = off.argmin(axis=0)
    least, half = brush.half_width_range_mm()
    if off.min() > _AMID * half:
        yield _across(places, half, edge)
        return
    for corner in corners:
        if np.hypot(*(places - corner.at_mm).T).min() < _AT_TIP * half:
            yield _from_tip(corner, shape, half)
    for k in np.unique(nearest).tolist():
        run, own = runs[k], nearest == k
        deep = float(off[k, own].max()) + SEEN_MM
        at = shapely.line_locate_point(run.line, points[own])
        ends = float(at.min()), float(at.max())
        if run.turns_rad is None and ends[1] - ends[0] > run.line.length / 2:  # across where the ring begins
            behind = at > run.line.length / 2
            ends = float(at[behind].min()), float(at[~behind].max()) + run.line.length
        lines = []
        for width in (share * half for share in _WIDTHS):
            if width < least or deep > 2 * (1 - _ON_PAINT) * width:
                continue
            lines += _along(run, ends, width, edge)
        if lines:
            yield lines


def _along(run: _Run, ends: tuple[float, float], width: float, edge) -> list[Line]:
    """A line so wide along an edge, between two places and as far beyond as it needs, and the same back."""
    first, last = ends[0] - _LANDING * width, ends[1] + _LANDING * width
    if run.turns_rad is not None:
        low, high = (_short_of(turn, width) for turn in run.turns_rad)
        first, last = max(first, low), min(last, run.line.length - high)
    if last - first < width:
        return []
    at = np.linspace(first, last, max(int((last - first) / _EVEN_MM), 4))
    places, along = run.at(at)
    middle = places + width * along[:, ::-1] * (-1, 1)
    fits = shapely.distance(edge, shapely.points(middle)) > _ROOM * width
    before, behind = np.flatnonzero(~fits & (at < ends[0])), np.flatnonzero(~fits & (at > ends[1]))
    some = slice(before[-1] + 1 if len(before) else 0, behind[0] if len(behind) else len(at))
    if not fits[some].all() or len(at[some]) < 4:
        return []
    return _both_ways(middle[some], width)


def _from_tip(corner: _Corner, shape, half: float) -> list[Line]:
    """Lines from a corner inwards, as wide as the shape has room there up to each width, then on; a mark begins
    pointed."""
    at = np.arange(_EVEN_MM, 4 * half, _EVEN_MM)
    places = corner.at_mm + at[:, None] * corner.inwards
    points = shapely.points(places)
    room = np.where(shapely.intersects(shape, points), shapely.distance(shape.boundary, points), 0.0)
    lines = []
    for share, first in itertools.product(_WIDTHS[:2], _TIPS):
        width = share * half
        enters, is_wide = room >= first * half, room >= width
        if is_wide.any():
            some = slice(int(enters.argmax()), int(is_wide.argmax() + _LANDING * width / _EVEN_MM))
            rows = np.column_stack([places, np.minimum(room, width)])[some]
            if len(rows) > 3 and rows[:, 2].min() > 0:
                lines.append(Line(*_core.fit_curve(rows, FITTED * width), start="exposed"))
    return lines


def _across(places: np.ndarray, half: float, edge) -> list[Line]:
    """Lines through a bare piece amid paint, along and across it."""
    centre = (places.min(axis=0) + places.max(axis=0)) / 2
    axes = (
        np.linalg.svd(places - places.mean(axis=0), full_matrices=False)[2] if len(places) > 1 else np.eye(2)
    )
    lines = []
    for along, aside in (axes, axes[::-1]):
        long, wide = np.ptp(places @ along), np.ptp(places @ aside)
        width = float(np.clip(_OVER * wide / 2, _WIDTHS[0] * half, half))
        reach = long / 2 + _LANDING * width
        middle = centre + np.linspace(-reach, reach, max(int(2 * reach / _EVEN_MM), 4))[:, None] * along
        if (shapely.distance(edge, shapely.points(middle)) > width).all():
            lines += _both_ways(middle, width)
    return lines


def _both_ways(middle: np.ndarray, width: float) -> list[Line]:
    rows = np.column_stack([middle, np.full(len(middle), width)])
    return [Line(*_core.fit_curve(way, FITTED * width), start="exposed") for way in (rows, rows[::-1])]


def _short_of(turn_rad: float, width: float) -> float:
    """How far before a corner a line beside the edge ends, so that its mark stays in the shape; negative where it runs
    on past an inner corner."""
    if turn_rad < 0:
        return -_LANDING * width
    return width * float(np.tan(turn_rad / 2))


def _best(lines: list[Line], paint: np.ndarray, wanted: Wanted, brush, as_stroke) -> tuple | None:
    """The line by which faults are fewest, what it paints and in which pixels; None where none is worth it."""
    points = np.vstack([line.middle_mm.reshape(-1, 2) for line in lines])
    where = wanted.pixels_about(points, _BESIDE * max(line.half_width[0][1] for line in lines))
    here, before = wanted.only(where), paint[where]
    found, most = None, faults_mm2(here, before) - _WORTH_MM2
    sticks_out = here.bulge_mm2(before) + _BULGE_MM2
    for line in lines:
        painted = painted_by(as_stroke(line), here, brush)
        if painted is None:
            continue
        both = np.maximum(before, painted)
        if here.bulge_mm2(both) < sticks_out and (left := faults_mm2(here, both)) < most:
            found, most = (line, painted, where), left
    return found
