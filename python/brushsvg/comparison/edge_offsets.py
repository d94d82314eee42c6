"""Measure the offset of the edges of paint from a model, along the model's outlines."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.ops import unary_union

from ..geometry.rings import signed_area
from .placing import Canvas

EVERY_MM = 0.8
# A place where the outline turns by more has no side to be measured on: beyond a corner the nearest edge is not the one
# straight across, and what a number does to it is no straight line. Such places made numbers surer than they are.
SHARP_DEG, SHARP_MM = 40.0, (0.3, 0.9)  # between the directions so far before and behind
ALONG_MM = 0.05  # between samples of a profile across an edge
APART_MM = 0.6  # from other marks: nearer, their blurred edges show
LEVEL = 0.5
INSIDE_MM, WHOLE = (0.3, 0.9), 0.6  # within an edge; the paint there, below which bristles run dry


@dataclass(frozen=True)
class Outline:
    """Places (n, 2) along the outlines of strokes, their normals outward, which stroke each is of, the length that each
    stands for, mm, and whether the outline turns sharply there."""

    at: np.ndarray
    normal: np.ndarray
    stroke: np.ndarray
    length: np.ndarray
    sharp: np.ndarray


def area(rings: list[np.ndarray]):
    """Outer rings counter-clockwise, holes clockwise."""
    outer = [Polygon(ring).buffer(0) for ring in rings if signed_area(ring) > 0]
    holes = [Polygon(ring).buffer(0) for ring in rings if signed_area(ring) <= 0]
    return unary_union(outer).difference(unary_union(holes))


def along(rings_of: list[list[np.ndarray]]) -> Outline:
    """rings_of: of each stroke its rings."""
    parts = [(k, *_sampled(ring)) for k, rings in enumerate(rings_of) for ring in rings if len(ring) > 3]
    return Outline(
        np.vstack([part[1] for part in parts]),
        np.vstack([part[2] for part in parts]),
        np.concatenate([np.full(len(part[1]), part[0]) for part in parts]),
        np.concatenate([np.full(len(part[1]), part[3]) for part in parts]),
        np.concatenate([part[4] for part in parts]),
    )


def _sampled(ring: np.ndarray):
    closed = np.vstack([ring, ring[:1]])
    come = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    count = max(8, round(come[-1] / EVERY_MM))
    step = come[-1] / count

    def point(way):
        return np.column_stack([np.interp(way % come[-1], come, closed[:, i]) for i in (0, 1)])

    way = (np.arange(count) + 0.5) * step
    ahead = point(way + 0.4 * step) - point(way - 0.4 * step)
    ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    near, far = SHARP_MM
    before, behind = (point(way + side * far) - point(way + side * near) for side in (-1, 1))
    turn = np.angle((behind @ [1, 1j]) * np.conj(-before @ [1, 1j]))
    return (
        point(way),
        np.column_stack([ahead[:, 1], -ahead[:, 0]]),
        step,
        np.abs(turn) > np.radians(SHARP_DEG),
    )


def offsets_of(outline: Outline, rings_of: list[list[np.ndarray]]) -> np.ndarray:
    """Return (n,) how far outside of each place the outlines of other rings of the same stroke are."""
    out = np.zeros(len(outline.at))
    for k, rings in enumerate(rings_of):
        here = outline.stroke == k
        if rings and here.any():
            shape, points = area(rings), shapely.points(outline.at[here])
            shapely.prepare(shape)
            away = shapely.distance(points, shape.boundary)
            out[here] = np.where(shapely.contains(shape, points), away, -away)
    return out


def seen(
    outline: Outline,
    rings_of: list[list[np.ndarray]],
    neighbours: list[list[np.ndarray]],
    paint: np.ndarray,
    canvas: Canvas,
    reach_mm: float,
) -> np.ndarray:
    """neighbours: rings of strokes that have no outline here.

    (n,) how far outside of each place the paint ends, by its profile across; nan where it does not within reach, where
    the outline turns sharply, or where that may be another stroke's paint."""
    t = np.arange(-reach_mm - INSIDE_MM[1], reach_mm + 1e-9, ALONG_MM)
    left, _, _, top = canvas.window_mm
    places = outline.at[:, None] + t[None, :, None] * outline.normal[:, None]
    column = ((places[..., 0] - left) * canvas.px_per_mm - 0.5).astype(np.float32)
    row = ((top - places[..., 1]) * canvas.px_per_mm - 0.5).astype(np.float32)
    profile = cv2.remap(paint, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    falls = (profile[:, :-1] >= LEVEL) & (profile[:, 1:] < LEVEL)
    share = (profile[:, :-1] - LEVEL) / np.maximum(profile[:, :-1] - profile[:, 1:], 1e-6)
    crossing = t[:-1] + np.clip(share, 0, 1) * ALONG_MM
    far = np.where(falls, np.abs(crossing), np.inf)
    nearest = far.argmin(axis=1)
    rows = np.arange(len(far))
    found = np.where(far[rows, nearest] <= reach_mm, crossing[rows, nearest], np.nan)
    inside = [
        profile[rows, np.clip(nearest - round(depth / ALONG_MM), 0, len(t) - 1)]
        for depth in np.arange(INSIDE_MM[0], INSIDE_MM[1], 0.1)
    ]
    found[(np.mean(inside, axis=0) < WHOLE) | outline.sharp] = np.nan
    edge = outline.at + np.nan_to_num(found)[:, None] * outline.normal
    shapes = [area(rings) if rings else Polygon() for rings in (*rings_of, *neighbours)]
    for k in range(len(rings_of)):
        here = np.flatnonzero((outline.stroke == k) & ~np.isnan(found))
        others = unary_union([shape for other, shape in enumerate(shapes) if other != k])
        if len(here) and not others.is_empty:
            near = APART_MM + 0.5 * reach_mm
            for points in (outline.at[here], edge[here]):
                found[here[shapely.distance(shapely.points(points), others) < near]] = np.nan
    return found
