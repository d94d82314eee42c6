"""Rings: points (n, 2), the last of which is joined to the first."""

from __future__ import annotations

import numpy as np


def signed_area(ring: np.ndarray) -> float:
    """Return the area of a ring, positive if it runs counter-clockwise."""
    x, y = ring.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def centroid(rings: list[np.ndarray]) -> np.ndarray:
    """Return the centroid, (2,), of the area within rings, holes clockwise.

    For rings without area, return the mean of their points.
    """
    area, moment = 0.0, np.zeros(2)
    for ring in rings:
        after = np.roll(ring, -1, axis=0)
        cross = ring[:, 0] * after[:, 1] - after[:, 0] * ring[:, 1]
        area += 0.5 * float(cross.sum())
        moment += cross @ (ring + after) / 6.0
    return moment / area if area > 1e-9 else np.vstack(rings).mean(axis=0)


def is_within(places: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """Return which places (n, 2) are in an odd number of rings."""
    x, y = places.T
    is_odd = np.zeros(len(places), bool)
    for ring in rings:
        low, high = ring.min(axis=0), ring.max(axis=0)
        near = np.flatnonzero((x < high[0]) & (y > low[1]) & (y < high[1]))
        a, b = ring, np.roll(ring, -1, axis=0)
        is_across = (a[:, 1] > y[near, None]) != (b[:, 1] > y[near, None])
        k, edge = np.nonzero(is_across)
        share = (y[near[k]] - a[edge, 1]) / (b[edge, 1] - a[edge, 1])
        is_ahead = a[edge, 0] + share * (b[edge, 0] - a[edge, 0]) > x[near[k]]
        is_odd[near] ^= np.bincount(k[is_ahead], minlength=len(near)) % 2 == 1
    return is_odd


def with_holes(rings: list[np.ndarray]) -> list[list[np.ndarray]]:
    """Return each outer ring together with its holes, which follow it."""
    areas: list[list[np.ndarray]] = []
    for ring in rings:
        if signed_area(ring) > 0:
            areas.append([])
        areas[-1].append(ring)
    return areas


def without_slivers(ring: np.ndarray, width_mm: float) -> np.ndarray:
    """Remove thin loops of a ring that touches itself.

    A loop runs between two touches. It is removed if its mean width is at most width_mm.
    """
    places = list(map(tuple, ring.tolist()))
    kept = np.ones(len(ring), bool)

    def leave_out_thin(loop: list[int]) -> None:
        round_mm = np.hypot(*(np.roll(ring[loop], -1, axis=0) - ring[loop]).T).sum()
        if 2 * abs(signed_area(ring[loop])) <= width_mm * round_mm:
            kept[loop] = False

    way: list[int] = []
    seen: dict[tuple, int] = {}
    for k, place in enumerate(places):
        if (first := seen.get(place)) is not None:
            loop = way[first:]
            del way[first:]
            for number in loop:
                del seen[places[number]]
            leave_out_thin(loop)
        seen[place] = len(way)
        way.append(k)
    if kept.sum() > len(way):
        leave_out_thin(way)
    return ring[kept]
