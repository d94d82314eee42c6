"""Rings: points (n, 2) of which the last is joined to the first."""

from __future__ import annotations

import numpy as np


def signed_area(ring: np.ndarray) -> float:
    """Above 0 for a ring that runs counter-clockwise."""
    x, y = ring.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def centroid(rings: list[np.ndarray]) -> np.ndarray:
    """(2,) of the area within, holes clockwise; of rings without area, the mean of their points."""
    area, moment = 0.0, np.zeros(2)
    for ring in rings:
        after = np.roll(ring, -1, axis=0)
        cross = ring[:, 0] * after[:, 1] - after[:, 0] * ring[:, 1]
        area += 0.5 * float(cross.sum())
        moment += cross @ (ring + after) / 6.0
    return moment / area if area > 1e-9 else np.vstack(rings).mean(axis=0)


def with_holes(rings: list[np.ndarray]) -> list[list[np.ndarray]]:
    """Each outer ring with its holes, which follow it."""
    areas: list[list[np.ndarray]] = []
    for ring in rings:
        if signed_area(ring) > 0:
            areas.append([])
        areas[-1].append(ring)
    return areas
