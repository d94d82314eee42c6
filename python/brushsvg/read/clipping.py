"""Cut lines and shapes by a region: a clip path or the edge of a viewport."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import shapely

from ..geometry.arc_length import knots
from ..geometry.cubics import at, between, flattened
from .design import Element, SubPath
from .layout import half_width_mm

FLATTENING_TOLERANCE_MM = 0.005  # largest distance of a polyline from its curve: a tenth of what a brush can show
_CHORDS_PER_CUBIC = 64  # chords per cubic on which its crossings with an edge are found


def fill_region(rings: Sequence[np.ndarray], fill_rule: str) -> shapely.Geometry:
    """Return the region that closed rings fill.

    rings: arrays (n, 2), which may cross themselves and each other; fill_rule: "nonzero" or "evenodd".
    """
    closed = [np.vstack([ring, ring[:1]]) for ring in rings if len(ring) >= 3]
    if not closed:
        return shapely.Polygon()
    # A face between the lines is inside or outside as a whole, so the winding number of one point decides.
    faces = shapely.polygonize([shapely.node(shapely.multilinestrings([*map(shapely.linestrings, closed)]))])
    inside = []
    for face in shapely.get_parts(faces):
        turns = _winding_number(np.array(face.representative_point().coords[0]), closed)
        if turns % 2 if fill_rule == "evenodd" else turns:
            inside.append(face)
    return shapely.union_all(inside)


def _winding_number(point: np.ndarray, rings: Iterable[np.ndarray]) -> int:
    turns = 0
    for ring in rings:
        (x0, y0), (x1, y1) = ring[:-1].T, ring[1:].T
        up, down = (y0 <= point[1]) & (y1 > point[1]), (y1 <= point[1]) & (y0 > point[1])
        left = (x1 - x0) * (point[1] - y0) - (point[0] - x0) * (y1 - y0)
        turns += int((up & (left > 0)).sum()) - int((down & (left < 0)).sum())
    return turns


def flatten_subpaths(subpaths: Iterable[SubPath]) -> list[np.ndarray]:
    return [flattened(subpath.cubics, FLATTENING_TOLERANCE_MM) for subpath in subpaths]


def clip_element(element: Element, region: shapely.Geometry) -> list[Element]:
    """Return the part of an element inside a region, as zero or more elements.

    The result is the element itself if nothing is cut, and empty if nothing is left. A filled shape with a stroke
    becomes two elements: the clip path cuts through both, and its edge gets no stroke.
    """
    half = max((half_width_mm(element, subpath) for subpath in element.subpaths), default=0.0)
    points = np.concatenate([subpath.cubics.reshape(-1, 2) for subpath in element.subpaths])
    low, high = points.min(axis=0) - half, points.max(axis=0) + half
    if region.contains(shapely.box(*low, *high)):
        return [element]
    if element.fill_colour:
        return [piece for part in element.by_colour() for piece in clip_element(part, region)]
    out = []
    if element.fill_rule:
        shape = fill_region(flatten_subpaths(element.subpaths), element.fill_rule)
        if not element.is_stroked and region.contains(shape):
            return [element]
        if rings := _region_to_subpaths(shape.intersection(region)):
            out.append(replace(element, subpaths=rings, stroke_width_mm=0.0, fill_rule="evenodd"))
    if element.is_stroked:
        lines = tuple(piece for subpath in element.subpaths for piece in _clip_line(subpath, region))
        if lines:
            name = f"{element.id}-stroke" if out else element.id
            out.append(replace(element, id=name, subpaths=lines, fill_rule=""))
    return out


def reach_beyond_edge_mm(element: Element, region: shapely.Geometry) -> float:
    """Return how far the mark of a clipped line reaches beyond an edge that cuts it lengthwise, 0 without such an edge.

    element: a part that clip_element returned. Its mark has one width, so it cannot follow an edge along its side.
    """
    half = element.stroke_width_mm / 2
    if not half > 0 or element.fill_rule:
        return 0.0
    reach_mm = 0.0
    for subpath in element.subpaths:
        points = flattened(subpath.cubics, FLATTENING_TOLERANCE_MM)
        mark = shapely.LineString(points).buffer(half, cap_style="flat")
        outside = mark.difference(region)
        if not subpath.closed:  # an edge across the line cuts off its ends only, at angles of 30 degrees or more
            outside = outside.difference(shapely.union_all(shapely.buffer(shapely.points(points[[0, -1]]), 2 * half)))
        if outside.area > half**2:
            reach_mm = max(reach_mm, *shapely.distance(region, shapely.points(shapely.get_coordinates(outside))))
    return reach_mm


def _region_to_subpaths(region: shapely.Geometry) -> tuple[SubPath, ...]:
    rings = []
    for part in shapely.get_parts(region):
        if part.geom_type == "Polygon" and part.area > FLATTENING_TOLERANCE_MM**2:
            rings += [part.exterior, *part.interiors]
    return tuple(_ring_to_subpath(np.array(ring.coords)) for ring in rings)


def _ring_to_subpath(points: np.ndarray) -> SubPath:
    begin, end = points[:-1], points[1:]
    return SubPath(np.stack([begin, begin + (end - begin) / 3, end - (end - begin) / 3, end], axis=1), True)


def _clip_line(subpath: SubPath, region: shapely.Geometry) -> list[SubPath]:
    """Return the parts of a line inside the region.

    Two parts that meet at the start of a closed line are joined if the line has one width.
    """
    cubics = subpath.cubics
    t = np.linspace(0.0, 1.0, _CHORDS_PER_CUBIC + 1)
    points = at(t[:, None], *cubics.transpose(1, 0, 2)[:, :, None])
    if not np.ptp(points.reshape(-1, 2), axis=0).any():
        return [subpath] if region.covers(shapely.Point(points[0, 0])) else []
    chords = shapely.linestrings(np.stack([points[:, :-1], points[:, 1:]], axis=2).reshape(-1, 2, 2))
    places = [0.0, float(len(cubics))]
    shapely.prepare(region)
    for k in np.flatnonzero(shapely.intersects(chords, region.boundary)):
        crossings = shapely.get_coordinates(chords[k].intersection(region.boundary))
        places += [
            (k + chords[k].project(shapely.Point(place), normalized=True)) / _CHORDS_PER_CUBIC for place in crossings
        ]
    places = np.unique(places)
    middle = (places[1:] + places[:-1]) / 2
    number = np.minimum(middle.astype(int), len(cubics) - 1)
    middles = at((middle - number)[:, None], *cubics[number].transpose(1, 0, 2))
    # intersects, not contains: of a line that runs along the edge, one half of its width is visible.
    is_inside = shapely.intersects_xy(region, *middles.T)
    spans: list[list[float]] = []
    for begin, end in np.column_stack([places[:-1], places[1:]])[is_inside].tolist():
        if spans and spans[-1][1] == begin:
            spans[-1][1] = end
        else:
            spans.append([begin, end])
    if spans == [[0.0, float(len(cubics))]]:
        return [subpath]
    pieces = [_cut_subpath(subpath, *span) for span in spans]
    is_through_start = subpath.closed and len(spans) > 1 and spans[0][0] == 0.0 and spans[-1][1] == len(cubics)
    if is_through_start and subpath.widths is None:  # otherwise each part has its own widths
        last = pieces.pop()
        pieces[0] = SubPath(np.concatenate([last.cubics, pieces[0].cubics]))
    return pieces


def _cut_subpath(subpath: SubPath, begin: float, end: float) -> SubPath:
    """Return the part between two places (cubic's number plus parameter), with its share of the widths."""
    count = len(subpath.cubics)
    ends = [(min(int(place), count - 1), place - min(int(place), count - 1)) for place in (begin, end)]
    cubics = between(subpath.cubics, *ends)
    if subpath.widths is None:
        return SubPath(cubics)
    total = knots(subpath.cubics)[:, -1]
    fractions = [
        (float(total[:k].sum()) + (float(knots(between(subpath.cubics, (k, 0.0), (k, t)))[:, -1].sum()) if t else 0.0))
        / float(total.sum())
        for k, t in ends
    ]
    shares, widths = subpath.widths.T
    inner = subpath.widths[(shares > fractions[0]) & (shares < fractions[1])]
    first, last = ((share, np.interp(share, shares, widths)) for share in fractions)
    rows = np.vstack([first, inner, last])
    rows[:, 0] = (rows[:, 0] - fractions[0]) / max(fractions[1] - fractions[0], 1e-12)
    return SubPath(cubics, widths=rows)
