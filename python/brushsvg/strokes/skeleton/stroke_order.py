"""Writing order of strokes, from geometric features whose weights were fitted to stroke-order data.

Two numbers are computed for each pair of strokes by one small network (`stroke_order.json`):

    m(a, b) = f(a, b) - f(b, a)   log odds that a is written before b
    h(a, b)                       how well b follows immediately after a

The score of writing b after a, with the strokes R still to write, is h(a, b) + sum over r in R of log sigmoid(m(b, r)).
The softmax over R of this score is the probability of the next stroke. A beam search finds the most probable order.
`benchmarks/fit_stroke_order.py` describes how the weights were fitted, and names the data.

One rule is explicit: the stem of a t or f is written before its crossbar (`find_crossbars`). The fitted weights cannot
be trusted with it, because a straight t differs from a cross or a 十, whose bar comes first, by proportion alone.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files

import numpy as np

PLACES = 24  # points on each stroke
MAX_TOGETHER = 48  # strokes ordered at once; longer groups are cut, since the work grows with the square
BEAM_WIDTH = 8
TOUCH_SHARE, NEAR_SHARE = (
    0.04,
    0.1,
)  # of the size of the group: distances at which strokes touch, and are near
SOFT_CUT, SOFT_CUT_WIDTH = 0.12, 0.05  # overlap of two halves at which a cut counts half, and its scale
# The crossbar of a t or f: slope of the bar at most, and of the stem at least; height of the crossing as a share of the
# stem, above which the bar is that of a T and below which that of a plus sign; reach on both sides of the stem, as a
# share of its height, below which the bar is a serif or an arm.
MAX_BAR_SLOPE, MIN_STEM_SLOPE = 0.35, 1.7
MIN_BAR_HEIGHT, MAX_BAR_HEIGHT = 0.53, 0.94
MIN_BAR_REACH = 0.05
CROSSBAR_LOG_ODDS = 6.0  # that the stem is written before its crossbar
# Length of the bar as a share of the stem's height. In an unknown script a cross with a longer bar may be a character,
# such as 十, and the letter has few strokes: all but the stem and the bar are serifs, shorter than a share of the stem.
MAX_BAR_LENGTH = {"latin": 1.1, "auto": 0.75}
MAX_LETTER_STROKES, MAX_SERIF_LENGTH = 3, 0.45
SCRIPT_FLAGS = {"latin": -1.0, "devanagari": -1.0, "cjk": 1.0}  # 0.0: unknown


def find_writing_order(lines: list[np.ndarray], script: str = "auto") -> list[int]:
    """Return the order in which the strokes of one letter or word are written.

    lines: (k, 2) or wider, x and y up, each in the direction of writing.
    """
    if script == "arabic":  # no data were fitted: the stroke that reaches farthest to the right comes first
        return sorted(range(len(lines)), key=lambda k: -lines[k][:, 0].max())
    if len(lines) < 2:
        return list(range(len(lines)))
    if len(lines) > MAX_TOGETHER:
        middles = [line[:, 0].min() + line[:, 0].max() for line in lines]
        parts = np.array_split(np.argsort(middles, kind="stable"), -(-len(lines) // MAX_TOGETHER))
        return [int(part[k]) for part in parts for k in find_writing_order([lines[j] for j in part], script)]
    features = pair_features([line[:, :2] for line in lines], SCRIPT_FLAGS.get(script, 0.0))
    hidden, bias, output = _weights()
    before, follows = np.moveaxis(np.tanh(features @ hidden + bias) @ output, 2, 0)
    margin = before - before.T
    if script in MAX_BAR_LENGTH:
        is_crossbar = find_crossbars([line[:, :2] for line in lines], script)
        margin[is_crossbar] = np.maximum(margin[is_crossbar], CROSSBAR_LOG_ODDS)
        margin[is_crossbar.T] = -margin.T[is_crossbar.T]
    precedence = -np.logaddexp(0.0, -margin)
    np.fill_diagonal(precedence, 0.0)
    return search_order(precedence, follows)


def find_crossbars(lines: list[np.ndarray], script: str) -> np.ndarray:
    """Return, (n, n), whether stroke b is the crossbar of stem a, as in a t or f. script: "latin" or "auto"."""
    places = np.array([_resample(line) for line in lines])
    x, y = np.moveaxis(places, 2, 0)
    width, height = np.ptp(places, axis=1).T
    level = y.mean(axis=1)  # of each stroke, if it is a bar
    nearest = np.abs(y[:, None] - level[None, :, None]).argmin(axis=2)
    crossing = np.take_along_axis(x, nearest, axis=1)  # x of each stem at the level of each bar
    stem_height = np.maximum(height, 1e-9)[:, None]
    crossing_height = (level - y.min(axis=1)[:, None]) / stem_height
    reach = np.minimum(crossing - x.min(axis=1), x.max(axis=1) - crossing) / stem_height
    is_crossbar = (height > MIN_STEM_SLOPE * width)[:, None] & (height < MAX_BAR_SLOPE * width)
    is_crossbar &= (crossing_height > MIN_BAR_HEIGHT) & (crossing_height < MAX_BAR_HEIGHT)
    is_crossbar &= (reach > MIN_BAR_REACH) & (width / stem_height < MAX_BAR_LENGTH[script])
    if script == "auto":
        is_long = np.maximum(width, height) > MAX_SERIF_LENGTH * stem_height
        is_crossbar &= is_long.sum(axis=1)[:, None] - is_long <= 1  # the stem alone, not counting the bar
        is_crossbar &= len(lines) <= MAX_LETTER_STROKES
    return is_crossbar


def search_order(precedence: np.ndarray, follows: np.ndarray) -> list[int]:
    """Return the most probable order, by beam search. Both (n, n): see the module's docstring."""
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
    """Return the features (n, n, f) of each pair of strokes: positions, contacts, layout and gap."""
    places = np.array([_resample(line) for line in lines])
    low, high = places.min(axis=(0, 1)), places.max(axis=(0, 1))
    places = (places - (low + high) / 2) / max((high - low).max(), 1e-9)
    low, high, middle = places.min(axis=1), places.max(axis=1), places.mean(axis=1)
    start, end = places[:, 0], places[:, -1]
    contact, component = _contacts(places)
    first = np.where(component[..., None], low[None], np.inf).min(axis=1)
    last = np.where(component[..., None], high[None], -np.inf).max(axis=1)
    chord, length = end - start, np.hypot(*np.moveaxis(np.diff(places, axis=1), 2, 0)).sum(axis=1)
    span = np.hypot(*chord.T)
    heading = chord / np.maximum(span, 1e-9)[:, None]
    own = np.column_stack([heading, length, span / np.maximum(length, 1e-9), middle])
    where = np.column_stack([start, end, middle, low, high, first, last])
    gap = start[None] - end[:, None]
    shape = (len(lines), len(lines))
    return np.concatenate(
        [
            where[None] - where[:, None],
            np.broadcast_to(own[:, None], (*shape, own.shape[1])),
            np.broadcast_to(own[None], (*shape, own.shape[1])),
            contact,
            component[..., None],
            _layout_cuts(low, high, middle),
            gap,
            np.hypot(*np.moveaxis(gap, 2, 0))[..., None],
            np.full((*shape, 1), script_flag),
        ],
        axis=2,
    )


def _contacts(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where strokes touch, (n, n, 6), and which are connected by touching strokes, (n, n)."""
    count = len(places)
    off = np.hypot(*np.moveaxis(places[:, None, :, None] - places[None, :, None], 4, 0))
    off = off.reshape(count, count, -1)
    nearest, distance = off.argmin(axis=2), off.min(axis=2)
    touch = np.exp(-((distance / TOUCH_SHARE) ** 2))
    along_a, along_b = nearest // PLACES / (PLACES - 1), nearest % PLACES / (PLACES - 1)
    inside_a, inside_b = (1 - (2 * along - 1) ** 4 for along in (along_a, along_b))
    relations = [touch, touch * along_a, touch * along_b, touch * inside_a, touch * inside_b]
    connected = distance < 1.125 * TOUCH_SHARE
    for _ in range(int(np.ceil(np.log2(count)))):  # paths of twice the length each time
        connected = connected.astype(np.int32) @ connected > 0
    return np.stack([*relations, np.exp(-distance / NEAR_SHARE)], axis=2), connected


def _layout_cuts(low: np.ndarray, high: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Return, (n, n, 4), how the cut that parts two strokes runs: strokes are cut in left and right, or upper and lower
    halves, each half again, where the halves overlap least. Signed cuts in x and y, share of strokes, overlap."""
    count = len(low)
    cuts = np.zeros((count, count, 4))
    waiting = [np.arange(count)]
    while waiting:
        strokes = waiting.pop()
        if len(strokes) < 2:
            continue
        size = max((high[strokes].max(axis=0) - low[strokes].min(axis=0)).max(), 1e-6)
        found = []
        for axis, sign in ((0, 1), (1, -1)):
            order = strokes[np.argsort(sign * middle[strokes, axis], kind="stable")]
            begin, end = np.sort(sign * np.array([low[order, axis], high[order, axis]]), axis=0)
            overlap = np.maximum.accumulate(end)[:-1] - np.minimum.accumulate(begin[::-1])[::-1][1:]
            found.append((overlap.min() / size, axis, order, int(overlap.argmin()) + 1))
        overlap, axis, order, at = min(found, key=lambda each: each[0])
        first, second = order[:at], order[at:]
        sure = 1 / (1 + np.exp((overlap - SOFT_CUT) / SOFT_CUT_WIDTH))
        for one, two, signed in ((first, second, sure), (second, first, -sure)):
            cuts[np.ix_(one, two, [axis])] = signed
            cuts[np.ix_(one, two, [2])] = len(strokes) / count
            cuts[np.ix_(one, two, [3])] = np.clip(overlap, -1, 1)
        waiting += [first, second]
    return cuts


def _resample(line: np.ndarray) -> np.ndarray:
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.linspace(0, along[-1], PLACES)
    return np.column_stack([np.interp(at, along, line[:, k]) for k in (0, 1)])


@cache
def _weights() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    table = json.loads(files(__package__).joinpath("stroke_order.json").read_text(encoding="utf-8"))
    return tuple(np.array(table[name]) for name in ("hidden", "bias", "output"))
