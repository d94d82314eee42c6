"""Writing direction of lines, and lines that are one stroke at a corner."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

import numpy as np

from ...geometry.polylines import length
from ...geometry.rings import signed_area
from .graph import Piece, Skeleton, reverse_piece
from .junctions import Crossing
from .lines_at_crossings import STRAIGHT_ROWS, trace_straight

# Weights of the direction of writing. The first two multiply the unit vector from start to end, x to the right and
# y up. The third multiplies the taper, (first third - last third) / wider of the two. A line is written in the
# direction that makes their sum positive. The weights of cjk are fitted to hanzi-writer-data, those of auto to that
# and our own letters. The others are not fitted: a fit to letters was no better.
DIRECTION_WEIGHTS = {
    "latin": np.array([0.5, -0.866, 0.27]),
    "devanagari": np.array([0.5, -0.866, 0.27]),
    "arabic": np.array([-0.5, -0.866, 0.27]),
    "cjk": np.array([0.67, -0.71, 0.88]),
    "auto": np.array([0.62, -0.78, 0.63]),
}
# An arm that bends by more is written from its stem on. Straight arms, as in a K, are written towards the stem.
MIN_ARCH_RAD = np.radians(15)
# A flick is a short piece without a direction of its own. It is shorter than this many of its half widths, and than
# this share of the piece that it meets at a corner.
MAX_FLICK_HALF_WIDTHS, MAX_FLICK_SHARE = 7.0, 0.6
# A piece that is wider than the other one by this factor is no flick: the stem of a bold 4.
MAX_FLICK_WIDTH_RATIO = 1.15

MIN_RIGHT_PER_RISE = 0.3  # how far a hairline goes to the right, at least, as a share of its rise
# Sine above which a line is steep. A line that falls to the left is written after its roof.
MIN_STEEP_SINE = 0.87
# Chord of a straight line, at least, as a share of its length: lines of an x.
MIN_STRAIGHT_CHORD = 0.8


def direct_piece(piece: Piece, script: str = "auto") -> Piece:
    """Return the piece in the direction of writing."""
    if piece.closed:
        return _direct_ring(piece)
    return piece if direction_score(piece.line, script) >= 0 else reverse_piece(piece)


def _direct_arch_outwards(chain: list[Piece]) -> list[Piece]:
    """Return an arm's pieces from the stem on if they leave it in an arch; other chains stay."""
    if chain[0].ends[0] is not None or chain[-1].ends[1] is None:
        return chain
    turned = [reverse_piece(piece) for piece in reversed(chain)]
    return turned if _is_arch(np.vstack([piece.line for piece in turned])) else chain


def _is_arch(line: np.ndarray) -> bool:
    """Return whether a line rises to the right and bends down all along, as an r's arm leaves its stem."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line[:, :2], axis=0).T))])
    # The end of an axis may hook into a corner of the shape.
    at = np.array([np.interp([0.0, 0.3, 0.5, 0.8], along / along[-1], column) for column in line[:, :2].T]).T
    first, last = at[1] - at[0], at[3] - at[2]
    right, up = line[-1, :2] - line[0, :2]
    bends = np.arctan2(first[1] * last[0] - first[0] * last[1], first @ last)
    return bool(right > up > 0 and bends > MIN_ARCH_RAD)


def direction_score(line: np.ndarray, script: str = "auto") -> float:
    """Return how well a line runs in the direction of writing.

    line: (k, 3). A line with a negative score is written in the other direction.
    """
    chord = line[-1, :2] - line[0, :2]
    n = max(len(line) // 3, 1)
    head, tail = line[:n, 2].mean(), line[-n:, 2].mean()
    along = chord / max(np.hypot(*chord), 1e-9)
    return float(DIRECTION_WEIGHTS[script] @ [*along, (head - tail) / max(head, tail, 1e-9)])


def _direct_ring(piece: Piece) -> Piece:
    """Turn a ring counter-clockwise and begin it at the top, a little to the right."""
    line = piece.line[:-1]
    if signed_area(line[:, :2]) < 0:
        line = line[::-1]
    first = int(np.argmax(line[:, :2] @ (0.3, 1.0)))
    line = np.roll(line, -first, axis=0)
    return replace(piece, line=np.vstack([line, line[:1]]))


def join_pieces(pieces: list[Piece], skeleton: Skeleton, script: str = "auto") -> list[list[Piece]]:
    """Join pieces in their writing directions at corners.

    Two pieces are joined where one ends and the next begins at a corner, or where one of them is only a flick.
    Returns the pieces of each stroke in one list.
    """
    chains = {
        k: [piece] for k, piece in enumerate(_reverse_hairlines([direct_piece(piece, script) for piece in pieces]))
    }
    lengths = [_measure_length(piece, skeleton) for piece in pieces]
    at_crossing: dict[int | None, set[int]] = {}
    for k, piece in enumerate(pieces):
        for crossing in piece.ends:
            at_crossing.setdefault(crossing, set()).add(k)
    for number, crossing in enumerate(skeleton.crossings):
        if not crossing.is_corner or crossing.has_tip:
            continue
        near = sorted(at_crossing.get(number, ()))
        here = [(k, side) for k in near for side in (0, 1) if _find_end_crossing(chains[k], side) == number]
        if len(here) != 2 or here[0][0] == here[1][0]:
            continue
        (i, side_i), (j, side_j) = here
        if side_i == side_j:  # both pieces begin or both end here
            turned = _find_flick(chains, lengths, i, j)
            if turned is None or (crossing.has_hump and _is_steep(chains[turned][0].line)):
                continue
            chains[turned] = [reverse_piece(piece) for piece in reversed(chains[turned])]
            side_i = side_i if turned == j else 1 - side_i
        first, second = (i, j) if side_i == 1 else (j, i)
        at_crossing[_find_end_crossing(chains[second], 1)].add(first)
        at_crossing[_find_end_crossing(chains[second], 1)].discard(second)
        chains[first][-1] = move_to_corner(chains[first][-1], 1, crossing)
        chains[second][0] = move_to_corner(chains[second][0], 0, crossing)
        chains[first] += chains.pop(second)
        lengths[first] += lengths[second]
    return [_direct_arch_outwards(chain) for chain in chains.values()]


def _measure_length(piece: Piece, skeleton: Skeleton) -> float:
    """Return a piece's length [mm] to its corners, without its run along an edge into another line."""
    length_mm = length(piece.line[:, :2])
    for number, row in zip(piece.ends, (piece.line[0], piece.line[-1]), strict=True):
        for arm in skeleton.crossings[number].arms if number is not None else ():
            if arm.corner is not None and arm.lead is not None and np.array_equal(arm.lead[0], row):
                start = arm.line[arm.out, :2]
                length_mm += np.hypot(*(arm.corner[0] - start)) - length(np.vstack([arm.lead[:, :2], start]))
    return length_mm


def move_to_corner(piece: Piece, side: int, crossing: Crossing) -> Piece:
    """Move the end of a piece to the corner where the stroke continues.

    side: 0 for a piece that begins at the corner, 1 for one that ends there. The other piece of the stroke ends at
    the same place.
    """
    line = piece.line if side == 0 else piece.line[::-1]
    place, half = crossing.corner
    leads = [arm.lead for arm in crossing.arms if arm.lead is not None and np.array_equal(arm.lead[0], line[0])]
    steps = len(leads[0]) if leads else STRAIGHT_ROWS
    if leads and crossing.is_on_lead:
        nearest = int(np.hypot(*(line[:steps, :2] - place).T).argmin())
        line = np.vstack([[*place, half], line[nearest + 1 :]])
    else:
        line = np.vstack([trace_straight(place, half, line[steps]), line[steps:]])
    return replace(piece, line=line if side == 0 else line[::-1])


def _find_end_crossing(chain: list[Piece], side: int) -> int | None:
    return chain[0].ends[0] if side == 0 else chain[-1].ends[1]


def _find_flick(chains: dict[int, list[Piece]], lengths: list[float], i: int, j: int) -> int | None:
    """Return which of pieces i, j at a corner is the other's flick (short, with a free end), or None."""
    short, other = sorted((i, j), key=lambda k: (lengths[k], k))
    if len(chains[short]) > 1 or None not in chains[short][0].ends:
        return None
    widest = chains[short][0].line[:, 2].max()
    if widest > MAX_FLICK_WIDTH_RATIO * max(piece.line[:, 2].max() for piece in chains[other]):
        return None
    return short if lengths[short] < min(MAX_FLICK_HALF_WIDTHS * widest, MAX_FLICK_SHARE * lengths[other]) else None


def _reverse_hairlines(pieces: list[Piece]) -> list[Piece]:
    """Return pieces with hairlines that rise to the right between two stems, as in an n or a u."""
    steep = [piece for piece in pieces if _is_steep(piece.line)]
    passing, beginning, ending = defaultdict(list), defaultdict(list), defaultdict(list)
    for piece in steep:
        beginning[piece.ends[0]].append(piece)
        ending[piece.ends[1]].append(piece)
        # Not the falling line of an M.
        if piece.line[-1, 0] - piece.line[0, 0] < MIN_RIGHT_PER_RISE * (piece.line[0, 1] - piece.line[-1, 1]):
            for crossing in piece.through:
                passing[crossing].append(piece)

    def is_up(piece: Piece) -> bool:
        right, rise = piece.line[0, :2] - piece.line[-1, :2]
        if None in piece.ends or not right > MIN_RIGHT_PER_RISE * rise > 0 or not _is_straight(piece.line[:, :2]):
            return False
        begins, ends = piece.ends
        tops = any(other is not piece for other in beginning[begins])
        bottoms = any(other is not piece for other in ending[ends])
        return bool((passing[ends] and (tops or passing[begins])) or (passing[begins] and bottoms))

    return [reverse_piece(piece) if is_up(piece) else piece for piece in pieces]


def _is_steep(line: np.ndarray) -> bool:
    down = line[0, :2] - line[-1, :2]
    return bool(abs(down[1]) > MIN_STEEP_SINE * np.hypot(*down))


def _is_straight(line: np.ndarray) -> bool:
    return bool(np.hypot(*(line[-1] - line[0])) > MIN_STRAIGHT_CHORD * length(line))
