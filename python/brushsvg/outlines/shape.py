"""Elements to the rings of what they fill."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..design import Element
from ..errors import Error

# Off the curves: an edge costs as much as all the rest, and middle lines are smoothed by more than half of this.
FLATTENED_MM = 0.02
# An alphabet has some thousands of edges and hardly a crossing; ten seconds' work is all that a shape may ask for.
_MOST_EDGES, _MOST_CROSSINGS = 200_000, 10_000


def filled(element: Element) -> list[np.ndarray]:
    """Rings of the shape that an element fills, [mm]: outer ones counter-clockwise, holes clockwise. Open sub-paths
    are closed by a straight line. Error if it has more edges, or crosses itself more often, than any lettering."""
    outlines = [flattened(subpath.cubics) for subpath in element.subpaths]
    edges = sum(map(len, outlines))
    if edges > _MOST_EDGES:
        raise Error(f"its outline has {edges} edges, more than {_MOST_EDGES}")
    if (crossings := _crossings(outlines)) > _MOST_CROSSINGS:
        raise Error(f"its outline crosses itself about {crossings:.2g} times, more than {_MOST_CROSSINGS}")
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


def _crossings(outlines: list[np.ndarray], pairs: int = 100_000) -> float:
    """About how often the outlines cross: of pairs of edges drawn at random, always the same."""
    tails = np.vstack(outlines)
    count = len(tails)
    if count < 200:
        return 0.0
    heads = np.vstack([np.roll(ring, -1, axis=0) for ring in outlines])
    one, two = np.random.default_rng(0).integers(0, count, (2, pairs))

    def side(a, b, p):  # which side of a line from a to b
        return np.sign((b[:, 0] - a[:, 0]) * (p[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (p[:, 0] - a[:, 0]))

    a, b, c, d = tails[one], heads[one], tails[two], heads[two]
    cross = (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)
    return float(cross.mean()) * count * (count - 1) / 2
