"""Elements to the rings of what they fill."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..design import Element

# Off the curves: an edge costs as much as all the rest, and middle lines are smoothed by more than half of this.
FLATTENED_MM = 0.02


def filled(element: Element) -> list[np.ndarray]:
    """Rings of the shape that an element fills, [mm]: outer ones counter-clockwise, holes clockwise. Open sub-paths
    are closed by a straight line."""
    outlines = [flattened(subpath.cubics) for subpath in element.subpaths]
    return _core.fill([ring for ring in outlines if len(ring) >= 3], element.fill_rule or "evenodd")


def flattened(cubics: np.ndarray, tolerance_mm: float = FLATTENED_MM) -> np.ndarray:
    """Points (k, 2) of cubics (n, 4, 2), nowhere farther from them than the tolerance: the chord of 1/n of a cubic
    is off by |B''| / 8 n^2 at most."""
    second = 6 * np.abs(np.diff(cubics, n=2, axis=1)).max(axis=1)
    bend = np.hypot(second[:, 0], second[:, 1])
    counts = np.clip(np.ceil(np.sqrt(bend / (8 * tolerance_mm))), 1, 1000).astype(int)
    which = np.repeat(np.arange(len(cubics)), counts)
    first = np.cumsum(counts) - counts
    t = ((np.arange(len(which)) - first[which] + 1) / counts[which])[:, None]
    p0, p1, p2, p3 = (cubics[which, k] for k in range(4))
    u = 1 - t
    points = u**3 * p0 + 3 * t * u**2 * p1 + 3 * t**2 * u * p2 + t**3 * p3
    return np.vstack([cubics[:1, 0], points])
