"""Elements to the rings of what they fill."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...errors import Error
from ...geometry.cubics import flattened
from ...read.design import Element

# Off the curves: an edge costs as much as all the rest, and middle lines are smoothed by more than half of this.
FLATTENED_MM = 0.02
# An alphabet has some thousands of edges and hardly a crossing; ten seconds' work is all that a shape may ask for.
_MOST_EDGES, _MOST_CROSSINGS, _MOST_PAIRS = 200_000, 10_000, 30_000_000
_PASSED = 0.04  # Cost of a pair that is skipped, relative to one that is examined.


def filled(element: Element) -> list[np.ndarray]:
    """Rings of the shape that an element fills, [mm]: outer ones counter-clockwise, holes clockwise. Open sub-paths
    are closed by a straight line. Error if it has more edges, or crosses itself more often, than any lettering."""
    outlines = [flattened(subpath.cubics, FLATTENED_MM) for subpath in element.subpaths]
    edges = sum(map(len, outlines))
    if edges > _MOST_EDGES:
        raise Error(f"its outline has {edges} edges, more than {_MOST_EDGES}", code="outline-too-complex")
    tails = np.vstack(outlines)
    heads = np.vstack([np.roll(ring, -1, axis=0) for ring in outlines])
    if (crossings := _crossings(tails, heads)) > _MOST_CROSSINGS:
        raise Error(
            f"its outline crosses itself about {crossings:.2g} times, more than {_MOST_CROSSINGS}",
            code="outline-too-complex",
        )
    low, high = np.minimum(tails, heads), np.maximum(tails, heads)
    from_left = np.argsort(low[:, 0])
    if (pairs := _side_by_side(low[from_left], high[from_left])) > _MOST_PAIRS:
        raise Error(
            f"its outline is too dense: {pairs:.2g} pairs of edges side by side, more than {_MOST_PAIRS:.2g}",
            code="outline-too-complex",
        )
    return _core.fill([ring for ring in outlines if len(ring) >= 3], element.fill_rule or "evenodd")


def _crossings(tails: np.ndarray, heads: np.ndarray, pairs: int = 100_000) -> float:
    """About how often edges cross: of pairs of them drawn at random, always the same."""
    count = len(tails)
    if count < 200:
        return 0.0
    one, two = np.random.default_rng(0).integers(0, count, (2, pairs))

    def side(a, b, p):  # which side of a line from a to b
        return np.sign((b[:, 0] - a[:, 0]) * (p[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (p[:, 0] - a[:, 0]))

    a, b, c, d = tails[one], heads[one], tails[two], heads[two]
    cross = (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)
    return float(cross.mean()) * count * (count - 1) / 2


def _side_by_side(
    low: np.ndarray, high: np.ndarray, floor: float = -np.inf, ceiling: float = np.inf
) -> float:
    """How many pairs of edges, given by the corners of their boxes (n, 2) in the order of their left ones, _core.fill
    holds against each other: all that share an x, in bands of y where few edges lead from one band to the next."""
    count = len(low)
    if count < 300:
        return count * count / 2
    ys = np.unique([low[:, 1], high[:, 1]])
    ys = ys[(ys >= floor) & (ys < ceiling)]
    ys = ys[max(len(ys) // 3, 1) : len(ys) - len(ys) // 3 + 1]
    across = np.searchsorted(np.sort(low[:, 1]), ys, "right") - np.searchsorted(
        np.sort(high[:, 1]), ys, "right"
    )
    if len(ys) and across.min() <= count / 9:
        cut = ys[np.argmin(across)]
        below, above = low[:, 1] < cut, high[:, 1] >= cut
        return _side_by_side(low[below], high[below], floor, cut) + _side_by_side(
            low[above], high[above], cut, ceiling
        )
    behind = np.searchsorted(low[:, 0], high[:, 0]) - np.arange(1, count + 1)
    # those that reach up into the band are skipped one by one, until one is in it
    inside = low[:, 1] >= floor
    ends = np.append(np.flatnonzero(inside), count)
    follows = ends[np.searchsorted(low[inside, 0], high[~inside, 0])]
    return float(np.maximum(behind, 0).sum() + _PASSED * (follows - np.flatnonzero(~inside)).sum())
