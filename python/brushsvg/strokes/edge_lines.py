"""Narrow lines along the edge of a filled shape, beside what the marks of its passes leave bare there."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

import numpy as np
import shapely

from .. import _core
from .along_edges import EVEN_MM, LANDING, Corner, Run, both_ways, lines_along, runs_of, sides_of
from .bulges import faults_mm2, painted_by
from .offset_passes import FITTED, Line
from .swept_areas import region
from .trial_mark import SEEN_MM, Wanted

# Half widths of the lines, in those of the brush: as narrow as at square ends, and wider beside deeper notches.
_WIDTHS = (0.27, 0.45, 0.7)
_AMID = 0.2  # of the brush's half width: a bare piece so far from the edge lies amid paint
_ON_PAINT = 0.5  # of a line's width lies on paint at least
_BESIDE = 4.0  # a line, in half widths: it paints no farther out
_AT_TIP = 0.4  # so near to a corner, in half widths, a bare piece lies in it
_TIPS = (0.03, 0.1)  # half width of a line where it begins in a corner, in those of the brush
_OVER = 1.3  # times as wide as a piece amid paint is the line across it
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
    runs, corners = runs_of(shape)
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


def _beside(places: np.ndarray, runs: list[Run], corners: list[Corner], shape, brush) -> Iterator[list[Line]]:
    """For each corner that a bare piece lies in, and each edge that it lies beside, ways to lead a line there."""
    edge = shape.boundary
    least, half = brush.half_width_range_mm()
    if shapely.distance(edge, shapely.points(places)).min() > _AMID * half:
        yield _across(places, half, edge)
        return
    for corner in corners:
        if np.hypot(*(places - corner.at_mm).T).min() < _AT_TIP * half:
            yield _from_tip(corner, shape, half)
    for side in sides_of(places, runs):
        deep = side.deep_mm + SEEN_MM
        lines = []
        for width in (share * half for share in _WIDTHS):
            if width < least or deep > 2 * (1 - _ON_PAINT) * width:
                continue
            lines += lines_along(side, width, edge)
        if lines:
            yield lines


def _from_tip(corner: Corner, shape, half: float) -> list[Line]:
    """Lines from a corner inwards, as wide as the shape has room there up to each width, then on; a mark begins
    pointed."""
    at = np.arange(EVEN_MM, 4 * half, EVEN_MM)
    places = corner.at_mm + at[:, None] * corner.inwards
    points = shapely.points(places)
    room = np.where(shapely.intersects(shape, points), shapely.distance(shape.boundary, points), 0.0)
    lines = []
    for share, first in itertools.product(_WIDTHS[:2], _TIPS):
        width = share * half
        enters, is_wide = room >= first * half, room >= width
        if is_wide.any():
            some = slice(int(enters.argmax()), int(is_wide.argmax() + LANDING * width / EVEN_MM))
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
        reach = long / 2 + LANDING * width
        middle = centre + np.linspace(-reach, reach, max(int(2 * reach / EVEN_MM), 4))[:, None] * along
        if (shapely.distance(edge, shapely.points(middle)) > width).all():
            lines += both_ways(middle, width)
    return lines


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
