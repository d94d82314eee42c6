"""Writing order of strokes, from geometric features with fitted weights.

Two numbers are computed for each pair of strokes by one small network (`stroke_order.json`). Its weights were
fitted to stroke-order data.

    m(a, b) = f(a, b) - f(b, a)   log odds that a is written before b
    h(a, b)                       how well b follows immediately after a

The score of writing b after a, with the strokes R still to write, is

    h(a, b) + sum over r in R of log sigmoid(m(b, r))

The softmax over R of this score is the probability of the next stroke. A beam search finds the most probable order.
`benchmarks/fit_stroke_order.py` describes how the weights were fitted, and names the data.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files

import numpy as np

POINTS_PER_STROKE = 24
# Strokes ordered at once; longer groups are parted, since the work grows with the square.
MAX_STROKES_AT_ONCE = 48
BEAM_WIDTH = 8
# Distances at which strokes touch, and are near, as shares of the size of the group.
TOUCH_SHARE, NEAR_SHARE = (0.04, 0.1)
SOFT_CUT, SOFT_CUT_WIDTH = 0.12, 0.05  # overlap of two halves at which a cut counts half, and its scale
SCRIPT_FLAGS = {"latin": -1.0, "devanagari": -1.0, "cjk": 1.0}  # 0.0: unknown


def find_writing_order(lines: list[np.ndarray], script: str = "auto") -> list[int]:
    """Return the order in which the strokes of one letter or word are written.

    lines: (k, 2) or wider, x and y up, each in the direction of writing.
    """
    if script == "arabic":  # no data were fitted: the stroke that reaches farthest to the right comes first
        return sorted(range(len(lines)), key=lambda k: -lines[k][:, 0].max())
    if len(lines) < 2:
        return list(range(len(lines)))
    if len(lines) > MAX_STROKES_AT_ONCE:
        middles = [line[:, 0].min() + line[:, 0].max() for line in lines]
        parts = np.array_split(np.argsort(middles, kind="stable"), -(-len(lines) // MAX_STROKES_AT_ONCE))
        return [int(part[k]) for part in parts for k in find_writing_order([lines[j] for j in part], script)]
    features = pair_features([line[:, :2] for line in lines], SCRIPT_FLAGS.get(script, 0.0))
    hidden, bias, output = _read_weights()
    before, follows = np.moveaxis(np.tanh(features @ hidden + bias) @ output, 2, 0)
    margin = before - before.T
    precedence = -np.logaddexp(0.0, -margin)
    np.fill_diagonal(precedence, 0.0)
    return search_order(precedence, follows)


def search_order(precedence: np.ndarray, follows: np.ndarray) -> list[int]:
    """Find the most probable order by beam search.

    precedence, follows: (n, n), see the module's docstring.
    """
    count = len(precedence)
    states = [(0.0, [], np.ones(count, bool), precedence.sum(axis=1))]
    for _ in range(count):
        extended = []
        for total, done, left, row in states:
            rest = np.flatnonzero(left)
            score = row[rest] + (follows[done[-1], rest] if done else 0.0)
            score = score - np.logaddexp.reduce(score)
            best = np.argsort(-score, kind="stable")[:BEAM_WIDTH]
            extended += [(total + score[k], done, left, row, int(rest[k])) for k in best]
        states = []
        known = set()
        for total, done, left, row, chosen in sorted(extended, key=lambda each: -each[0]):
            still = left.copy()
            still[chosen] = False
            if (still.tobytes(), chosen) not in known and len(states) < BEAM_WIDTH:
                known.add((still.tobytes(), chosen))
                states.append((total, [*done, chosen], still, row - precedence[:, chosen]))
    return states[0][1]


def pair_features(lines: list[np.ndarray], script_flag: float) -> np.ndarray:
    """Return the features (n, n, f) of each pair of strokes.

    They describe positions, contacts, layout and the gap between the strokes.
    """
    places = np.array([_resample(line) for line in lines])
    low, high = places.min(axis=(0, 1)), places.max(axis=(0, 1))
    places = (places - (low + high) / 2) / max((high - low).max(), 1e-9)
    low, high, middle = places.min(axis=1), places.max(axis=1), places.mean(axis=1)
    start, end = places[:, 0], places[:, -1]
    contact, component = _find_contacts(places)
    chord, length = end - start, np.hypot(*np.moveaxis(np.diff(places, axis=1), 2, 0)).sum(axis=1)
    span = np.hypot(*chord.T)
    heading = chord / np.maximum(span, 1e-9)[:, None]
    stroke_features = np.column_stack([heading, length, span / np.maximum(length, 1e-9)])
    where = np.column_stack([start, end, middle])
    gap = start[None] - end[:, None]
    shape = (len(lines), len(lines))
    return np.concatenate(
        [
            where[None] - where[:, None],
            np.broadcast_to(stroke_features[:, None], (*shape, stroke_features.shape[1])),
            np.broadcast_to(stroke_features[None], (*shape, stroke_features.shape[1])),
            contact,
            component[..., None],
            _find_layout_cuts(low, high, middle),
            np.hypot(*np.moveaxis(gap, 2, 0))[..., None],
            np.full((*shape, 1), script_flag),
        ],
        axis=2,
    )


def _find_contacts(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where strokes touch, (n, n, 4), and which are connected by a chain of touches, (n, n)."""
    count = len(places)
    distances = np.hypot(*np.moveaxis(places[:, None, :, None] - places[None, :, None], 4, 0))
    distances = distances.reshape(count, count, -1)
    nearest, distance = distances.argmin(axis=2), distances.min(axis=2)
    touch = np.exp(-((distance / TOUCH_SHARE) ** 2))
    along_a = nearest // POINTS_PER_STROKE / (POINTS_PER_STROKE - 1)
    along_b = nearest % POINTS_PER_STROKE / (POINTS_PER_STROKE - 1)
    relations = [touch, touch * along_a, touch * along_b, np.exp(-distance / NEAR_SHARE)]
    connected = distance < 1.125 * TOUCH_SHARE
    for _ in range(int(np.ceil(np.log2(count)))):  # paths of twice the length each time
        connected = connected.astype(np.int32) @ connected > 0
    return np.stack(relations, axis=2), connected


def _find_layout_cuts(low: np.ndarray, high: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Return how the cut that parts two strokes runs, (n, n, 4).

    Strokes are cut in left and right, or upper and lower halves, and each half again, where the halves overlap
    least. The values are signed cuts in x and y, the share of strokes, and the overlap.
    """
    count = len(low)
    cuts = np.zeros((count, count, 4))
    waiting = [np.arange(count)]
    while waiting:
        strokes = waiting.pop()
        if len(strokes) < 2:
            continue
        size = max((high[strokes].max(axis=0) - low[strokes].min(axis=0)).max(), 1e-6)
        candidates = []
        for axis, sign in ((0, 1), (1, -1)):
            order = strokes[np.argsort(sign * middle[strokes, axis], kind="stable")]
            begin, end = np.sort(sign * np.array([low[order, axis], high[order, axis]]), axis=0)
            overlap = np.maximum.accumulate(end)[:-1] - np.minimum.accumulate(begin[::-1])[::-1][1:]
            candidates.append((overlap.min() / size, axis, order, int(overlap.argmin()) + 1))
        overlap, axis, order, at = min(candidates, key=lambda each: each[0])
        first, second = order[:at], order[at:]
        sure = 1 / (1 + np.exp((overlap - SOFT_CUT) / SOFT_CUT_WIDTH))
        for part, other_part, signed in ((first, second, sure), (second, first, -sure)):
            cuts[np.ix_(part, other_part, [axis])] = signed
            cuts[np.ix_(part, other_part, [2])] = len(strokes) / count
            cuts[np.ix_(part, other_part, [3])] = np.clip(overlap, -1, 1)
        waiting += [first, second]
    return cuts


def _resample(line: np.ndarray) -> np.ndarray:
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.linspace(0, along[-1], POINTS_PER_STROKE)
    return np.column_stack([np.interp(at, along, line[:, k]) for k in (0, 1)])


@cache
def _read_weights() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    table = json.loads(files(__package__).joinpath("stroke_order.json").read_text(encoding="utf-8"))
    return tuple(np.array(table[name]) for name in ("hidden", "bias", "output"))
