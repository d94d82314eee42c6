"""Writing direction: which way a line runs, and which lines that meet at a corner are one stroke."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

import numpy as np

from ...geometry.polylines import length
from ...geometry.rings import signed_area
from .bridges import STEPS, straight
from .graph import Piece, Skeleton
from .junctions import Crossing

# Weights of the direction of writing: of the unit vector from start to end, x to the right and y up, and of the taper,
# (first third - last third) / wider of the two. A line is written the way that makes their sum positive. Those of cjk
# are fitted to hanzi-writer-data, those of auto to that and letters of ours. Those of the others are not fitted: a fit
# to letters was no better than these.
DIRECTION_WEIGHTS = {
    "latin": np.array([0.5, -0.866, 0.27]),
    "devanagari": np.array([0.5, -0.866, 0.27]),
    "arabic": np.array([-0.5, -0.866, 0.27]),
    "cjk": np.array([0.67, -0.71, 0.88]),
    "auto": np.array([0.62, -0.78, 0.63]),
}
# So far an arm bends that is written from its stem on; straight ones, as in a K, are written towards it.
ARCH_RAD = np.radians(15)
# A piece shorter than this many of its half widths, and than this share of what it meets at a corner, has no direction
# of its own: a flick.
FLICK, FLICK_SHARE = 7.0, 0.6
FLICK_WIDER = 1.15  # nor is what is so much wider than that: the stem of a bold 4

RIGHT = 0.3  # of what it rises, how far a hairline leads to the right at least
# A line is steep whose sine is more than this: one that falls to the left is written after its roof.
STEEP = 0.87
STRAIGHT = 0.8  # of its length, the chord of a line of an x


def directed(piece: Piece, script: str = "auto") -> Piece:
    """Return the piece in the direction of writing."""
    if piece.closed:
        return _ring(piece)
    return piece if direction_score(piece.line, script) >= 0 else reversed_(piece)


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


def direction_score(line: np.ndarray, script: str = "auto") -> float:
    """Return how well a line runs in the direction of writing; negative: it is written the other way."""
    chord = line[-1, :2] - line[0, :2]
    n = max(len(line) // 3, 1)
    head, tail = line[:n, 2].mean(), line[-n:, 2].mean()
    along = chord / max(np.hypot(*chord), 1e-9)
    return float(DIRECTION_WEIGHTS[script] @ [*along, (head - tail) / max(head, tail, 1e-9)])


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


def joined(pieces: list[Piece], skeleton: Skeleton, script: str = "auto") -> list[list[Piece]]:
    """Pieces in their directions, those that a corner joins in one list: where one ends and the next begins there, or
    where one is but a flick."""
    chains = {k: [piece] for k, piece in enumerate(_upwards([directed(piece, script) for piece in pieces]))}
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


def _is_straight(line: np.ndarray) -> bool:
    return bool(np.hypot(*(line[-1] - line[0])) > STRAIGHT * length(line))
