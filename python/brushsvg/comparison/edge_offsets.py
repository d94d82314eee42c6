"""Measure the offset of the edges of paint from a model's outlines."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.ops import unary_union

from ..geometry.rings import signed_area
from .placing import Canvas

SAMPLE_STEP_MM = 0.8
# A place where the outline turns by more than MAX_OUTLINE_TURN_DEG cannot be measured. Beyond a corner, the nearest
# edge is not the one straight across, and it does not move linearly with a fault. Corners made the estimated faults
# seem more certain than they are. The turn is between the directions at TURN_DISTANCES_MM before and behind the place.
MAX_OUTLINE_TURN_DEG, TURN_DISTANCES_MM = 40.0, (0.3, 0.9)
PROFILE_STEP_MM = 0.05  # distance between samples of a profile across an edge
MIN_NEIGHBOUR_DISTANCE_MM = 0.6  # smallest distance from other marks: nearer, their blurred edges show
EDGE_LEVEL = 0.5
# Range of depths inside an edge, and the share of paint there below which bristles run dry.
INSIDE_DEPTHS_MM, MIN_PAINT_INSIDE = (0.3, 0.9), 0.6


@dataclass(frozen=True)
class Outline:
    """Places along the outlines of strokes.

    at: (n, 2) places [mm]; normal: (n, 2) outward unit normals; stroke: (n,) number of the stroke; length: (n,) length
    of outline that a place represents [mm]; sharp: (n,) whether the outline turns sharply there.
    """

    at: np.ndarray
    normal: np.ndarray
    stroke: np.ndarray
    length: np.ndarray
    sharp: np.ndarray


def polygon_of(rings: list[np.ndarray]):
    """Return the polygon of rings. Outer rings are counter-clockwise, holes clockwise."""
    outer = [Polygon(ring).buffer(0) for ring in rings if signed_area(ring) > 0]
    holes = [Polygon(ring).buffer(0) for ring in rings if signed_area(ring) <= 0]
    return unary_union(outer).difference(unary_union(holes))


def sample_outlines(rings_of: list[list[np.ndarray]]) -> Outline:
    """Sample the outlines of strokes. rings_of: the rings of each stroke."""
    parts = [(k, *_sample_ring(ring)) for k, rings in enumerate(rings_of) for ring in rings if len(ring) > 3]
    return Outline(
        np.vstack([part[1] for part in parts]),
        np.vstack([part[2] for part in parts]),
        np.concatenate([np.full(len(part[1]), part[0]) for part in parts]),
        np.concatenate([np.full(len(part[1]), part[3]) for part in parts]),
        np.concatenate([part[4] for part in parts]),
    )


def _sample_ring(ring: np.ndarray):
    closed = np.vstack([ring, ring[:1]])
    travelled_mm = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    count = max(8, round(travelled_mm[-1] / SAMPLE_STEP_MM))
    step = travelled_mm[-1] / count

    def point(way):
        return np.column_stack([np.interp(way % travelled_mm[-1], travelled_mm, closed[:, i]) for i in (0, 1)])

    way = (np.arange(count) + 0.5) * step
    ahead = point(way + 0.4 * step) - point(way - 0.4 * step)
    ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    near, far = TURN_DISTANCES_MM
    before, behind = (point(way + side * far) - point(way + side * near) for side in (-1, 1))
    turn = np.angle((behind @ [1, 1j]) * np.conj(-before @ [1, 1j]))
    return (
        point(way),
        np.column_stack([ahead[:, 1], -ahead[:, 0]]),
        step,
        np.abs(turn) > np.radians(MAX_OUTLINE_TURN_DEG),
    )


def signed_offsets_mm(outline: Outline, rings_of: list[list[np.ndarray]]) -> np.ndarray:
    """Return (n,) the distance [mm] of other outlines from each place.

    The other outlines are of the same strokes. The distance is positive outward.
    """
    out = np.zeros(len(outline.at))
    for k, rings in enumerate(rings_of):
        here = outline.stroke == k
        if rings and here.any():
            shape, points = polygon_of(rings), shapely.points(outline.at[here])
            shapely.prepare(shape)
            away = shapely.distance(points, shape.boundary)
            out[here] = np.where(shapely.contains(shape, points), away, -away)
    return out


def measure_paint_edges(
    outline: Outline,
    rings_of: list[list[np.ndarray]],
    neighbours: list[list[np.ndarray]],
    paint: np.ndarray,
    canvas: Canvas,
    reach_mm: float,
) -> np.ndarray:
    """Measure where the paint ends relative to each place of an outline.

    The edge is found in a profile across the outline. Returns (n,) the distance [mm] from place to edge of paint,
    positive outward. The distance is nan where there is no edge within reach, where the paint inside is dry, where the
    outline turns sharply, or where the paint may be of another stroke. neighbours: rings of strokes that have no
    outline here.
    """
    t = np.arange(-reach_mm - INSIDE_DEPTHS_MM[1], reach_mm + 1e-9, PROFILE_STEP_MM)
    left, _, _, top = canvas.window_mm
    places = outline.at[:, None] + t[None, :, None] * outline.normal[:, None]
    column = ((places[..., 0] - left) * canvas.px_per_mm - 0.5).astype(np.float32)
    row = ((top - places[..., 1]) * canvas.px_per_mm - 0.5).astype(np.float32)
    profile = cv2.remap(paint, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    falls = (profile[:, :-1] >= EDGE_LEVEL) & (profile[:, 1:] < EDGE_LEVEL)
    share = (profile[:, :-1] - EDGE_LEVEL) / np.maximum(profile[:, :-1] - profile[:, 1:], 1e-6)
    crossing = t[:-1] + np.clip(share, 0, 1) * PROFILE_STEP_MM
    far = np.where(falls, np.abs(crossing), np.inf)
    nearest = far.argmin(axis=1)
    rows = np.arange(len(far))
    edge_offset = np.where(far[rows, nearest] <= reach_mm, crossing[rows, nearest], np.nan)
    inside = [
        profile[rows, np.clip(nearest - round(depth / PROFILE_STEP_MM), 0, len(t) - 1)]
        for depth in np.arange(INSIDE_DEPTHS_MM[0], INSIDE_DEPTHS_MM[1], 0.1)
    ]
    edge_offset[(np.mean(inside, axis=0) < MIN_PAINT_INSIDE) | outline.sharp] = np.nan
    edge = outline.at + np.nan_to_num(edge_offset)[:, None] * outline.normal
    shapes = [polygon_of(rings) if rings else Polygon() for rings in (*rings_of, *neighbours)]
    for k in range(len(rings_of)):
        here = np.flatnonzero((outline.stroke == k) & ~np.isnan(edge_offset))
        others = unary_union([shape for other, shape in enumerate(shapes) if other != k])
        if len(here) and not others.is_empty:
            near = MIN_NEIGHBOUR_DISTANCE_MM + 0.5 * reach_mm
            for points in (outline.at[here], edge[here]):
                edge_offset[here[shapely.distance(shapely.points(points), others) < near]] = np.nan
    return edge_offset
