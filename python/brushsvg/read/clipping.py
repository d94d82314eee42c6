"""Lines and shapes cut by a region: what a clip path or the edge of a viewport leaves of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import shapely

from ..geometry.arc_length import knots
from ..geometry.cubics import at, between, flattened
from .design import Element, SubPath
from .layout import half_width_mm

FLAT_MM = 0.005  # off the curves: a tenth of what a brush shows
_PARTS = 64  # of each cubic, to find where it crosses an edge


def region_of(rings: Sequence[np.ndarray], fill_rule: str) -> shapely.Geometry:
    """The region that closed rings (n, 2) fill by "nonzero" or "evenodd". They may cross themselves."""
    closed = [np.vstack([ring, ring[:1]]) for ring in rings if len(ring) >= 3]
    if not closed:
        return shapely.Polygon()
    # every face between the lines is inside or outside as a whole: its winding number says which
    faces = shapely.polygonize([shapely.node(shapely.multilinestrings([*map(shapely.linestrings, closed)]))])
    inside = []
    for face in shapely.get_parts(faces):
        turns = _winding(np.array(face.representative_point().coords[0]), closed)
        if turns % 2 if fill_rule == "evenodd" else turns:
            inside.append(face)
    return shapely.union_all(inside)


def _winding(point: np.ndarray, rings: Iterable[np.ndarray]) -> int:
    turns = 0
    for ring in rings:
        (x0, y0), (x1, y1) = ring[:-1].T, ring[1:].T
        up, down = (y0 <= point[1]) & (y1 > point[1]), (y1 <= point[1]) & (y0 > point[1])
        left = (x1 - x0) * (point[1] - y0) - (point[0] - x0) * (y1 - y0)
        turns += int((up & (left > 0)).sum()) - int((down & (left < 0)).sum())
    return turns


def outlines_of(subpaths: Iterable[SubPath]) -> list[np.ndarray]:
    return [flattened(subpath.cubics, FLAT_MM) for subpath in subpaths]


def clipped(element: Element, region: shapely.Geometry) -> list[Element]:
    """What is inside the region: the element itself where nothing is cut, none where nothing is left. A filled shape
    with a stroke becomes two elements, for the clip path cuts through both and is no edge that was drawn."""
    half = max((half_width_mm(element, subpath) for subpath in element.subpaths), default=0.0)
    points = np.concatenate([subpath.cubics.reshape(-1, 2) for subpath in element.subpaths])
    low, high = points.min(axis=0) - half, points.max(axis=0) + half
    if region.contains(shapely.box(*low, *high)):
        return [element]
    if element.fill_colour:
        return [piece for part in element.by_colour() for piece in clipped(part, region)]
    out = []
    if element.fill_rule:
        shape = region_of(outlines_of(element.subpaths), element.fill_rule)
        if not element.is_stroked and region.contains(shape):
            return [element]
        if rings := _rings(shape.intersection(region)):
            out.append(replace(element, subpaths=rings, stroke_width_mm=0.0, fill_rule="evenodd"))
    if element.is_stroked:
        lines = tuple(piece for subpath in element.subpaths for piece in _inside(subpath, region))
        if lines:
            name = f"{element.id}-stroke" if out else element.id
            out.append(replace(element, id=name, subpaths=lines, fill_rule=""))
    return out


def _rings(region: shapely.Geometry) -> tuple[SubPath, ...]:
    rings = []
    for part in shapely.get_parts(region):
        if part.geom_type == "Polygon" and part.area > FLAT_MM**2:
            rings += [part.exterior, *part.interiors]
    return tuple(_polygon(np.array(ring.coords)) for ring in rings)


def _polygon(points: np.ndarray) -> SubPath:
    begin, end = points[:-1], points[1:]
    return SubPath(np.stack([begin, begin + (end - begin) / 3, end - (end - begin) / 3, end], axis=1), True)


def _inside(subpath: SubPath, region: shapely.Geometry) -> list[SubPath]:
    """The parts of a line inside the region. Two of one width that meet where a closed line begins are one."""
    cubics = subpath.cubics
    t = np.linspace(0.0, 1.0, _PARTS + 1)
    points = at(t[:, None], *cubics.transpose(1, 0, 2)[:, :, None])
    if not np.ptp(points.reshape(-1, 2), axis=0).any():
        return [subpath] if region.covers(shapely.Point(points[0, 0])) else []
    chords = shapely.linestrings(np.stack([points[:, :-1], points[:, 1:]], axis=2).reshape(-1, 2, 2))
    places = [0.0, float(len(cubics))]
    shapely.prepare(region)
    for k in np.flatnonzero(shapely.intersects(chords, region.boundary)):
        crossings = shapely.get_coordinates(chords[k].intersection(region.boundary))
        places += [
            (k + chords[k].project(shapely.Point(place), normalized=True)) / _PARTS for place in crossings
        ]
    places = np.unique(places)
    middle = (places[1:] + places[:-1]) / 2
    number = np.minimum(middle.astype(int), len(cubics) - 1)
    middles = at((middle - number)[:, None], *cubics[number].transpose(1, 0, 2))
    is_in = shapely.intersects_xy(region, *middles.T)  # half of a line along the edge shows, too
    spans: list[list[float]] = []
    for begin, end in np.column_stack([places[:-1], places[1:]])[is_in].tolist():
        if spans and spans[-1][1] == begin:
            spans[-1][1] = end
        else:
            spans.append([begin, end])
    if spans == [[0.0, float(len(cubics))]]:
        return [subpath]
    pieces = [_piece(subpath, *span) for span in spans]
    is_through_start = (
        subpath.closed and len(spans) > 1 and spans[0][0] == 0.0 and spans[-1][1] == len(cubics)
    )
    if is_through_start and subpath.widths is None:  # else each part has its own widths
        last = pieces.pop()
        pieces[0] = SubPath(np.concatenate([last.cubics, pieces[0].cubics]))
    return pieces


def _piece(subpath: SubPath, begin: float, end: float) -> SubPath:
    """The part between two places that count cubics, with its share of the widths."""
    count = len(subpath.cubics)
    ends = [(min(int(place), count - 1), place - min(int(place), count - 1)) for place in (begin, end)]
    cubics = between(subpath.cubics, *ends)
    if subpath.widths is None:
        return SubPath(cubics)
    total = knots(subpath.cubics)[:, -1]
    upto = [
        (
            float(total[:k].sum())
            + (float(knots(between(subpath.cubics, (k, 0.0), (k, t)))[:, -1].sum()) if t else 0.0)
        )
        / float(total.sum())
        for k, t in ends
    ]
    shares, widths = subpath.widths.T
    inner = subpath.widths[(shares > upto[0]) & (shares < upto[1])]
    first, last = ((share, np.interp(share, shares, widths)) for share in upto)
    rows = np.vstack([first, inner, last])
    rows[:, 0] = (rows[:, 0] - upto[0]) / max(upto[1] - upto[0], 1e-12)
    return SubPath(cubics, widths=rows)
