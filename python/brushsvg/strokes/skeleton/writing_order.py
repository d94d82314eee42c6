"""How one writes: which way a line runs, which lines are one stroke, what comes first."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from heapq import heappop, heappush
from itertools import combinations, pairwise, permutations, product

import numpy as np

from ...geometry.polylines import length, lengths, steps
from ...geometry.rings import signed_area
from .bridges import STEPS, straight
from .graph import Piece, Skeleton
from .junctions import Crossing

# Lines run towards this direction: down, and to the right where they lie flatter than 30 degrees.
TOWARDS = np.array([np.cos(np.radians(-60)), np.sin(np.radians(-60))])
# Strokes are set down wide and lifted thin: what a taper counts for beside the direction.
TAPER = 0.27
# So far an arm bends that is written from its stem on; straight ones, as of a K, are written towards it.
ARCH_RAD = np.radians(15)
# A piece shorter than this many of its half widths, and than this share of what it meets at a corner, has no direction
# of its own: a flick.
FLICK, FLICK_SHARE = 7.0, 0.6
FLICK_WIDER = 1.15  # nor is what is so much wider than that: the stem of a bold 4

# Which comes first.
UPPER_LEFT_FIRST = np.array([1.0, -1.0])
# Of parts in a line of writing: with more a dot would come before the letter left of it, with less the roof of a
# Chinese character after what stands below.
HIGHER = 0.5
# A dot is hardly longer than wide, hardly farther above its stem than it is high, and so many times lower than that at
# least, and narrower at most.
DOT, STEM = 1.3, 2.5
ACCENT = 0.4  # of its letter's size
LONG_DOT = 1.8  # where there are but a dot and a stem
SLENDER = 1.5  # or so many times as high as wide: a j
RIGHT = 0.3  # of what it rises, how far a hairline leads to the right at least
# Lines of which one is so much flatter are a bar and what crosses it.
FLATTER_RAD = np.radians(30)
# A serif is so much shorter than its stem, and than so many of its half widths.
SERIF, SERIF_HALVES = 0.7, 7.0
# A bar is an arm of a stem below it if it sticks out to its left by so little of its length, and of half widths. The
# stem is as steep as this sine: one that falls to the left is written after its roof.
STUB, STUB_HALVES, STEEP = 0.3, 4.0, 0.87
MOST_LINES = 4  # of a letter, serifs aside: of an E, an M
SHORT_BAR = 0.8  # of its stem: a t's; a cross has two lines of like length
PLACES = 60  # along a line, to find where it crosses another
STRAIGHT = 0.8  # of its length, the chord of a line of an x


def directed(piece: Piece) -> Piece:
    """The piece as one would paint it."""
    if piece.closed:
        return _ring(piece)
    return piece if willing(piece.line) >= 0 else reversed_(piece)


def _outwards(chain: list[Piece]) -> list[Piece]:
    """An arm that leaves its stem in an arch, from there on; others as they are."""
    if chain[0].ends[0] is not None or chain[-1].ends[1] is None:
        return chain
    turned = [reversed_(piece) for piece in reversed(chain)]
    return turned if _is_arch(np.vstack([piece.line for piece in turned])) else chain


def _is_arch(line: np.ndarray) -> bool:
    """Whether a line rises to the right and bends down all along: so an arm leaves its stem, as that of an r."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line[:, :2], axis=0).T))])
    # the last of an axis may hook into a corner of its end
    at = np.array([np.interp([0.0, 0.3, 0.5, 0.8], along / along[-1], column) for column in line[:, :2].T]).T
    first, last = at[1] - at[0], at[3] - at[2]
    right, up = line[-1, :2] - line[0, :2]
    bends = np.arctan2(first[1] * last[0] - first[0] * last[1], first @ last)
    return bool(right > up > 0 and bends > ARCH_RAD)


def willing(line: np.ndarray) -> float:
    """How gladly one paints it this way, in [-1, 1]; negative: the other way round."""
    chord = line[-1, :2] - line[0, :2]
    length = max(np.hypot(*chord), 1e-9)
    n = max(len(line) // 3, 1)
    head, tail = line[:n, 2].mean(), line[-n:, 2].mean()
    return float(chord @ TOWARDS / length + TAPER * (head - tail) / max(head, tail, 1e-9))


def reversed_(piece: Piece) -> Piece:
    return replace(piece, line=piece.line[::-1], ends=piece.ends[::-1])


def _ring(piece: Piece) -> Piece:
    """Counter-clockwise, from the top, a little to the right."""
    line = piece.line[:-1]
    if signed_area(line[:, :2]) < 0:
        line = line[::-1]
    first = int(np.argmax(line[:, :2] @ (0.3, 1.0)))
    line = np.roll(line, -first, axis=0)
    return replace(piece, line=np.vstack([line, line[:1]]))


def joined(pieces: list[Piece], skeleton: Skeleton) -> list[list[Piece]]:
    """Pieces in their directions, those that a corner joins in one list: where one ends and the next begins there, or
    where one is but a flick."""
    chains = {k: [piece] for k, piece in enumerate(_upwards([directed(piece) for piece in pieces]))}
    long = [_length(piece, skeleton) for piece in pieces]
    at_crossing: dict[int | None, set[int]] = {}
    for k, piece in enumerate(pieces):
        for crossing in piece.ends:
            at_crossing.setdefault(crossing, set()).add(k)
    for number, crossing in enumerate(skeleton.crossings):
        if not crossing.is_corner or crossing.has_tip:
            continue
        near = sorted(at_crossing.get(number, ()))
        here = [(k, side) for k in near for side in (0, 1) if _end(chains[k], side) == number]
        if len(here) != 2 or here[0][0] == here[1][0]:
            continue
        (i, side_i), (j, side_j) = here
        if side_i == side_j:  # both begin or both end here
            turned = _flick(chains, long, i, j)
            if turned is None or (crossing.has_hump and _is_steep(chains[turned][0].line)):
                continue
            chains[turned] = [reversed_(piece) for piece in reversed(chains[turned])]
            side_i = side_i if turned == j else 1 - side_i
        first, second = (i, j) if side_i == 1 else (j, i)
        at_crossing[_end(chains[second], 1)].add(first)
        at_crossing[_end(chains[second], 1)].discard(second)
        chains[first][-1] = to_corner(chains[first][-1], 1, crossing)
        chains[second][0] = to_corner(chains[second][0], 0, crossing)
        chains[first] += chains.pop(second)
        long[first] += long[second]
    return [_outwards(chain) for chain in chains.values()]


def _length(piece: Piece, skeleton: Skeleton) -> float:
    """Of a line, if it ran straight to its corners: how far it runs along an edge into another says nothing of it."""
    length_mm = length(piece.line[:, :2])
    for number, row in zip(piece.ends, (piece.line[0], piece.line[-1]), strict=True):
        for arm in skeleton.crossings[number].arms if number is not None else ():
            if arm.corner is not None and arm.lead is not None and np.array_equal(arm.lead[0], row):
                start = arm.line[arm.out, :2]
                length_mm += np.hypot(*(arm.corner[0] - start)) - length(np.vstack([arm.lead[:, :2], start]))
    return length_mm


def to_corner(piece: Piece, side: int, crossing: Crossing) -> Piece:
    """A piece that begins (side 0) or ends at a corner as the other line does that it goes on with."""
    line = piece.line if side == 0 else piece.line[::-1]
    place, half = crossing.corner
    leads = [
        arm.lead for arm in crossing.arms if arm.lead is not None and np.array_equal(arm.lead[0], line[0])
    ]
    steps = len(leads[0]) if leads else STEPS
    if leads and crossing.is_on_lead:
        nearest = int(np.hypot(*(line[:steps, :2] - place).T).argmin())
        line = np.vstack([[*place, half], line[nearest + 1 :]])
    else:
        line = np.vstack([straight(place, half, line[steps]), line[steps:]])
    return replace(piece, line=line if side == 0 else line[::-1])


def _end(chain: list[Piece], side: int) -> int | None:
    return chain[0].ends[0] if side == 0 else chain[-1].ends[1]


def _flick(chains: dict[int, list[Piece]], long: list[float], i: int, j: int) -> int | None:
    """Which of two that meet at a corner is but the flick of the other: short, with a free end."""
    short, other = sorted((i, j), key=lambda k: (long[k], k))
    if len(chains[short]) > 1 or None not in chains[short][0].ends:
        return None
    widest = chains[short][0].line[:, 2].max()
    if widest > FLICK_WIDER * max(piece.line[:, 2].max() for piece in chains[other]):
        return None
    return short if long[short] < min(FLICK * widest, FLICK_SHARE * long[other]) else None


def _upwards(pieces: list[Piece]) -> list[Piece]:
    """The pieces, those that lead from a stem up to the right to a second one turned round: hairlines of an n, an u."""
    steep = [piece for piece in pieces if _is_steep(piece.line)]
    passing, beginning, ending = defaultdict(list), defaultdict(list), defaultdict(list)
    for piece in steep:
        beginning[piece.ends[0]].append(piece)
        ending[piece.ends[1]].append(piece)
        if piece.line[-1, 0] - piece.line[0, 0] < RIGHT * (
            piece.line[0, 1] - piece.line[-1, 1]
        ):  # no \\ of an M
            for crossing in piece.through:
                passing[crossing].append(piece)

    def is_up(piece: Piece) -> bool:
        right, rise = piece.line[0, :2] - piece.line[-1, :2]
        if None in piece.ends or not right > RIGHT * rise > 0 or not _is_straight(piece.line[:, :2]):
            return False
        begins, ends = piece.ends
        tops = any(other is not piece for other in beginning[begins])
        bottoms = any(other is not piece for other in ending[ends])
        return bool((passing[ends] and (tops or passing[begins])) or (passing[begins] and bottoms))

    return [reversed_(piece) if is_up(piece) else piece for piece in pieces]


def _is_steep(line: np.ndarray) -> bool:
    down = line[0, :2] - line[-1, :2]
    return bool(abs(down[1]) > STEEP * np.hypot(*down))


def ordered(chains: list[list[Piece]], may_be_letter: bool = True) -> list[list[Piece]]:
    """From the upper left to the lower right by their centres; but see _earlier. may_be_letter: see side_by_side."""
    lines = [np.vstack([piece.line[:, :2] for piece in chain]) for chain in chains]
    centres = np.array([_centre(line) for line in lines])
    by_centre = (centres @ UPPER_LEFT_FIRST).argsort(kind="stable").tolist()
    place = {k: place for place, k in enumerate(by_centre)}
    earlier = _earlier(chains, lines, centres, may_be_letter)
    later: dict[int, list[int]] = {}
    for k, before in enumerate(earlier):
        for other in before:
            later.setdefault(other, []).append(k)
    ready = [place[k] for k in by_centre if not earlier[k]]
    painted: dict[int, None] = {}
    rest = iter(by_centre)
    while len(painted) < len(chains):
        # where each waits for another, the first of them
        k = by_centre[heappop(ready)] if ready else next(k for k in rest if k not in painted)
        if k in painted:
            continue
        painted[k] = None
        for other in later.get(k, ()):
            earlier[other].discard(k)
            if not earlier[other]:
                heappush(ready, place[other])
    return [chains[k] for k in painted]


def _earlier(
    chains: list[list[Piece]], lines: list[np.ndarray], centres: np.ndarray, may_be_letter: bool
) -> list[set[int]]:
    """For each chain those that are painted before it: of two that begin at one place the one that leads farther to the
    left, a stem before its bowl; of two that cross as _which_first says; and what it begins on, unless that lies to its
    right, a bowl before the stem behind it, or hardly sticks out to its left, a stem before its arms; a bar from one
    line to another after both; serifs after their stems."""
    begin, pass_ = defaultdict(list), defaultdict(list)
    for k, chain in enumerate(chains):
        begin[chain[0].ends[0]].append(k)
        for crossing in _through(chain):
            pass_[crossing].append(k)
    begin.pop(None, None)
    end = [chain[-1].ends[1] for chain in chains]
    steep = [float(np.arctan2(*np.abs(line[-1] - line[0])[::-1])) for line in lines]
    to_right = [
        float(np.arctan2(c[0] - line[0, 0], line[0, 1] - c[1]))
        for c, line in zip(centres, lines, strict=True)
    ]
    ending = defaultdict(list)
    for k, crossing in enumerate(end):
        ending[crossing].append(k)
    serifs = {
        host: guest
        for crossing, hosts in pass_.items()
        for host, guest in product(hosts, [*begin[crossing], *ending[crossing]])
        if _is_serif(chains[host], chains[guest]) and not _ends(chains[host]) & _through(chains[guest])
    }
    serifs |= {
        host: guest
        for crossing in begin.keys() | ending.keys()
        if crossing is not None and not pass_[crossing]
        for host, guest in permutations([*begin[crossing], *ending[crossing]], 2)
        if None in _ends(chains[host])
        and _is_serif(chains[host], chains[guest])
        and steep[host] < FLATTER_RAD
        and _is_steep(lines[guest])
    }
    met = [sum(len(pass_[crossing]) > 1 for crossing in _through(chain)) for chain in chains]
    is_letter = may_be_letter and len(chains) - len(serifs) <= MOST_LINES
    earlier: list[set[int]] = [set() for _ in chains]
    if not is_letter:
        serifs = {}
    for serif, stem in serifs.items():
        earlier[serif].add(stem)
    for crossing in sorted(begin.keys() | pass_.keys()):
        fanned = sorted(begin[crossing], key=to_right.__getitem__)
        for one, two in pairwise(fanned):
            earlier[two].add(one)
        for one, two in combinations(pass_[crossing], 2):
            bar, stem = sorted((one, two), key=steep.__getitem__)
            is_bar = steep[bar] < steep[stem] - FLATTER_RAD
            across = set(pass_.get(end[bar], ())) - {bar, stem}  # as that of a script's A
            is_alone = met[bar] == met[stem] == 1
            if is_bar and is_letter and (across or (is_alone and _is_short(lines[bar], lines[stem]))):
                earlier[bar] |= {stem, *across}
            elif is_bar:
                earlier[stem].add(bar)
            elif len(chains) - len(serifs) == 2 and all(_is_straight(lines[k]) for k in (one, two)):
                left, right = sorted((one, two), key=lambda k: lines[k][0, 0])  # an x
                earlier[right].add(left)
        for host, guest in product(pass_[crossing], begin[crossing]):
            if host == guest or serifs.get(host) == guest:
                continue
            if end[guest] is not None and end[guest] == chains[host][0].ends[0]:
                earlier[host].add(guest)  # the bar of an e that leads to where its bowl begins
            elif is_letter and _is_arm(lines[host], chains[guest], lines[guest]):
                earlier[host].add(guest)
            elif centres[host, 0] <= centres[guest, 0]:
                earlier[guest].add(host)
            for other in pass_.get(end[guest], ()):
                bar = steep[guest] < min(FLATTER_RAD, steep[host] - FLATTER_RAD, steep[other] - FLATTER_RAD)
                if bar and other not in (host, guest):
                    earlier[guest] |= {host, other}
    return earlier


def _through(chain: list[Piece]) -> set[int]:
    return {crossing for piece in chain for crossing in piece.through}


def _ends(chain: list[Piece]) -> set[int | None]:
    return {chain[0].ends[0], chain[-1].ends[1]}


def _is_serif(chain: list[Piece], stem: list[Piece]) -> bool:
    """Whether a line across the end of another is its serif: short beside it, and beside its width."""
    long, stem_long = (sum(length(piece.line[:, :2]) for piece in each) for each in (chain, stem))
    half = max(piece.line[:, 2].max() for piece in stem)
    return bool(long < min(SERIF * stem_long, SERIF_HALVES * half))


def _is_arm(bar: np.ndarray, chain: list[Piece], stem: np.ndarray) -> bool:
    """Whether a line from the left is the arm of a stem that begins on it, as of an E, and no bar on top of it, as of a
    T: it hardly sticks out beyond the stem."""
    places = _places(bar)
    at = int(np.hypot(*(places - stem[0]).T).argmin())
    way = places[min(2 * at + 3, PLACES - 1)] - bar[0]
    if not _is_steep(stem) or abs(way[1]) > way[0]:
        return False
    half = np.median(np.concatenate([piece.line[:, 2] for piece in chain]))
    return bool(at / PLACES * length(bar) < min(STUB * length(bar), STUB_HALVES * half))


def _is_short(bar: np.ndarray, stem: np.ndarray) -> bool:
    """Whether a bar is that of a t or f, and not the longer one of a cross or one farther down its stem."""
    middle = (stem[:, 1].min() + stem[:, 1].max()) / 2
    return bool(bar[:, 1].mean() > middle and length(bar) < SHORT_BAR * length(stem))


def _places(line: np.ndarray) -> np.ndarray:
    """Evenly along a line."""
    at = np.linspace(0, length(line), PLACES)
    return np.column_stack([np.interp(at, lengths(line), line[:, k]) for k in (0, 1)])


def _is_straight(line: np.ndarray) -> bool:
    return bool(np.hypot(*(line[-1] - line[0])) > STRAIGHT * length(line))


def _centre(line: np.ndarray) -> np.ndarray:
    weights = steps(line)
    return np.average((line[1:] + line[:-1]) / 2, axis=0, weights=weights) if weights.sum() > 0 else line[0]


def side_by_side(boxes: np.ndarray) -> list[bool]:
    """Of things with bounds (n, 4) x0, y0, x1, y1 which stand in a line of writing: nothing but dots and accents above
    or below them. Letters do, parts of Chinese characters rarely."""
    low, high = boxes[:, :2], boxes[:, 2:]
    sizes = (high - low).max(axis=1)

    def is_alone(k: int) -> bool:
        shared = np.minimum(high[:, 0], high[k, 0]) - np.maximum(low[:, 0], low[k, 0])
        stacked = shared > 0.5 * np.minimum(high[:, 0] - low[:, 0], high[k, 0] - low[k, 0])
        stacked[k] = False
        return not (stacked & (sizes > ACCENT * sizes[k])).any()

    return [is_alone(k) for k in range(len(boxes))]


def in_rows(boxes: np.ndarray) -> list[int]:
    """Order of things with bounds (n, 4) x0, y0, x1, y1: as lines of text are read, in a line from the left, what lies
    higher rather first."""
    rows: list[list[int]] = []
    floor = np.inf
    for k in (-boxes[:, 3]).argsort(kind="stable").tolist():
        if boxes[k, 3] <= floor:
            rows.append([])
            floor = boxes[k, 1]
        rows[-1].append(k)
        floor = min(floor, boxes[k, 1])
    across = (boxes[:, 0] + boxes[:, 2]) - HIGHER * (boxes[:, 1] + boxes[:, 3])
    return _dots_last([k for row in rows for k in sorted(row, key=lambda k: across[k])], boxes)


def _dots_last(order: list[int], boxes: np.ndarray) -> list[int]:
    """The dots of i and j after their stems. Those of Chinese characters, over what is wider, stay before it."""
    sizes = boxes[:, 2:] - boxes[:, :2]
    most = DOT if len(order) > 2 else LONG_DOT
    for dot in [k for k in order if sizes[k].max() < most * sizes[k].min()]:
        stems = [
            k
            for k in order
            if 0 <= boxes[dot, 1] - boxes[k, 3] < DOT * sizes[dot, 1]
            and min(boxes[k, 2], boxes[dot, 2]) > max(boxes[k, 0], boxes[dot, 0])
            and (sizes[k, 0] < STEM * sizes[dot, 0] or sizes[k, 1] > SLENDER * sizes[k, 0])
            and sizes[k, 1] > STEM * sizes[dot, 1]
        ]
        if stems:
            order.remove(dot)
            order.insert(order.index(max(stems, key=lambda k: boxes[k, 3])) + 1, dot)
    return order
