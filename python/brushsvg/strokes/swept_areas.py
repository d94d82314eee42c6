"""Shapes as shapely geometry, and the areas that lines and strokes paint."""

from __future__ import annotations

import itertools

import numpy as np
import shapely

from .. import _core
from ..geometry.rings import with_holes

GRID_MM = 1e-4  # grid of differences: without one they may fail on edges that all but touch
QUARTER_EDGES = 24  # edges of a quarter of a circle, which are off by 1e-3 of its radius


def region(rings: list[np.ndarray]):
    """Return rings, as _core.unite returns them, as shapely geometry."""
    parts = [shapely.make_valid(shapely.Polygon(outer, holes)) for outer, *holes in with_holes(rings)]
    return shapely.union_all(parts)


def rings_of(shape) -> list[np.ndarray]:
    """Return the rings of shapely geometry, as _core.unite returns them."""
    polygons = [one for one in shapely.get_parts(shapely.orient_polygons(shape)) if one.geom_type == "Polygon"]
    return _core.unite([np.array(ring.coords)[:-1] for one in polygons for ring in (one.exterior, *one.interiors)])


def painted_area(strokes: list):
    """Return the area that discs of their widths paint along lines or strokes."""
    return shapely.union_all([part for each in strokes for part in sweep_disc(each)])


def sweep_disc(stroke) -> list:
    """Return the areas that a disc of its width sweeps along a stroke, part by part."""
    bare = _core.Stroke(middle_mm=stroke.middle_mm, half_width=stroke.half_width, closed=stroke.closed)
    line = _core.flatten(bare, 0.01)
    knots = np.array(stroke.half_width)
    if len(line) > 1 and np.ptp(knots[:, 1]) == 0:
        return [shapely.buffer(shapely.LineString(line[:, :2]), knots[0, 1], quad_segs=QUARTER_EDGES)]
    at_mm = np.union1d(line[:, 2], knots[:, 0] * line[-1, 2])
    places = np.column_stack([np.interp(at_mm, line[:, 2], line[:, k]) for k in (0, 1)])
    halves = np.interp(at_mm / max(line[-1, 2], 1e-9), *knots.T)
    discs = shapely.buffer(shapely.points(places), halves, quad_segs=QUARTER_EDGES)
    return [shapely.convex_hull(shapely.union(a, b)) for a, b in itertools.pairwise(discs)] or [discs[0]]


def unpainted_area(shape, strokes: list):
    """Return the polygons that discs of their widths leave of a shape."""
    return keep_polygons(shapely.difference(shape, painted_area(strokes), grid_size=GRID_MM))


def keep_polygons(left):
    """Return only the polygons: edges that touch leave points and lines."""
    return shapely.MultiPolygon([part for part in shapely.get_parts(left) if part.geom_type == "Polygon"])
