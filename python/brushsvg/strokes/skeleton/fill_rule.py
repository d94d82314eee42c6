"""Rings of the shapes that elements fill."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...errors import Error
from ...geometry.cubics import flattened
from ...read.design import Element

# Greatest distance from the curves. An edge costs as much as all the rest, and middle lines are smoothed by more
# than half of this.
FLATTENED_MM = 0.02
# Limits of a shape. An alphabet has some thousands of edges and hardly a crossing. These limits allow work of ten
# seconds.
_MAX_EDGES, _MAX_CROSSINGS, _MAX_PAIRS = 200_000, 10_000, 30_000_000
_SKIPPED_PAIR_COST = 0.04  # cost of a pair that is skipped, relative to one that is examined


def filled_rings(element: Element) -> list[np.ndarray]:
    """Return the rings [mm] of the shape that an element fills.

    Outer rings are counter-clockwise, holes clockwise. Open sub-paths are closed by a straight line. Raises Error
    if the shape has more edges, or crosses itself more often, than any lettering.
    """
    outlines = [flattened(subpath.cubics, FLATTENED_MM) for subpath in element.subpaths]
    edges = sum(map(len, outlines))
    if edges > _MAX_EDGES:
        raise Error(f"its outline has {edges} edges, more than {_MAX_EDGES}", code="outline-too-complex")
    tails = np.vstack(outlines)
    heads = np.vstack([np.roll(ring, -1, axis=0) for ring in outlines])
    if (crossings := _estimate_crossings(tails, heads)) > _MAX_CROSSINGS:
        sentence = f"its outline crosses itself about {crossings:.2g} times, more than {_MAX_CROSSINGS}"
        raise Error(sentence, code="outline-too-complex")
    low, high = np.minimum(tails, heads), np.maximum(tails, heads)
    from_left = np.argsort(low[:, 0])
    if (pairs := _count_compared_pairs(low[from_left], high[from_left])) > _MAX_PAIRS:
        sentence = f"its outline is too dense: {pairs:.2g} pairs of edges side by side, more than {_MAX_PAIRS:.2g}"
        raise Error(sentence, code="outline-too-complex")
    return _core.fill([ring for ring in outlines if len(ring) >= 3], element.fill_rule or "evenodd")


def _estimate_crossings(tails: np.ndarray, heads: np.ndarray) -> float:
    """Estimate how often edges cross, from random pairs; the result is reproducible."""
    count = len(tails)
    if count < 200:
        return 0.0
    firsts, seconds = np.random.default_rng(0).integers(0, count, (2, 100_000))

    def side(a, b, p):  # the side of the line from a to b on which p is
        return np.sign((b[:, 0] - a[:, 0]) * (p[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (p[:, 0] - a[:, 0]))

    a, b, c, d = tails[firsts], heads[firsts], tails[seconds], heads[seconds]
    cross = (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)
    return float(cross.mean()) * count * (count - 1) / 2


def _count_compared_pairs(low: np.ndarray, high: np.ndarray, floor: float = -np.inf, ceiling: float = np.inf) -> float:
    """Count the pairs of edges that _core.fill compares.

    low, high: (n, 2), corners of the edges' boxes, in the order of their left sides. Compared are all pairs that
    share an x, in bands of y between which few edges run.
    """
    count = len(low)
    if count < 300:
        return count * count / 2
    ys = np.unique([low[:, 1], high[:, 1]])
    ys = ys[(ys >= floor) & (ys < ceiling)]
    ys = ys[max(len(ys) // 3, 1) : len(ys) - len(ys) // 3 + 1]
    across = np.searchsorted(np.sort(low[:, 1]), ys, "right") - np.searchsorted(np.sort(high[:, 1]), ys, "right")
    if len(ys) and across.min() <= count / 9:
        cut = ys[np.argmin(across)]
        below, above = low[:, 1] < cut, high[:, 1] >= cut
        return _count_compared_pairs(low[below], high[below], floor, cut) + _count_compared_pairs(
            low[above], high[above], cut, ceiling
        )
    behind = np.searchsorted(low[:, 0], high[:, 0]) - np.arange(1, count + 1)
    # Edges that reach up into the band are skipped one by one, until one is in it.
    inside = low[:, 1] >= floor
    ends = np.append(np.flatnonzero(inside), count)
    follows = ends[np.searchsorted(low[inside, 0], high[~inside, 0])]
    return float(np.maximum(behind, 0).sum() + _SKIPPED_PAIR_COST * (follows - np.flatnonzero(~inside)).sum())
