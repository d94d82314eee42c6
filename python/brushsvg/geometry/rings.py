"""Rings: points (n, 2) of which the last is joined to the first."""

from __future__ import annotations

import numpy as np


def signed_area(ring: np.ndarray) -> float:
    """Above 0 for a ring that runs counter-clockwise."""
    x, y = ring.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def with_holes(rings: list[np.ndarray]) -> list[list[np.ndarray]]:
    """Each outer ring with its holes, which follow it."""
    areas: list[list[np.ndarray]] = []
    for ring in rings:
        if signed_area(ring) > 0:
            areas.append([])
        areas[-1].append(ring)
    return areas
