"""How one writes: which way a line runs, which lines are one stroke, what comes first."""

from __future__ import annotations

from dataclasses import replace
from heapq import heappop, heappush

import numpy as np

from .skeleton import Piece, Skeleton

# Lines run towards this direction: down, and to the right where they lie flatter than 30 degrees.
TOWARDS = np.array([np.cos(np.radians(-60)), np.sin(np.radians(-60))])
# Strokes are set down wide and lifted thin: what a taper counts for beside the direction.
TAPER = 0.27
# A piece shorter than this many of its half widths, and than this share of what it meets at a corner, has no direction
# of its own: a flick.
FLICK, FLICK_SHARE = 7.0, 0.6


def directed(piece: Piece) -> Piece:
    """The piece as one would paint it."""
    if piece.closed:
        return _ring(piece)
    return piece if willing(piece.line) >= 0 else reversed_(piece)


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
    x, y = line[:, 0], line[:, 1]
    if (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() < 0:
        line = line[::-1]
    first = int(np.argmax(line[:, :2] @ (0.3, 1.0)))
    line = np.roll(line, -first, axis=0)
    return replace(piece, line=np.vstack([line, line[:1]]))


def length_mm(line: np.ndarray) -> float:
    return float(np.hypot(*np.diff(line[:, :2], axis=0).T).sum())


def joined(pieces: list[Piece], skeleton: Skeleton) -> list[list[Piece]]:
    """Pieces in their directions, those that a corner joins in one list: where one ends and the next begins there, or
    where one is but a flick."""
    chains = {k: [directed(piece)] for k, piece in enumerate(pieces)}
    lengths = [length_mm(piece.line) for piece in pieces]
    at_crossing: dict[int | None, set[int]] = {}
    for k, piece in enumerate(pieces):
        for crossing in piece.ends:
            at_crossing.setdefault(crossing, set()).add(k)
    for number, crossing in enumerate(skeleton.crossings):
        if not crossing.is_corner:
            continue
        near = sorted(at_crossing.get(number, ()))
        here = [(k, side) for k in near for side in (0, 1) if _end(chains[k], side) == number]
        if len(here) != 2 or here[0][0] == here[1][0]:
            continue
        (i, side_i), (j, side_j) = here
        if side_i == side_j:  # both begin or both end here
            turned = _flick(chains, lengths, i, j)
            if turned is None:
                continue
            chains[turned] = [reversed_(piece) for piece in reversed(chains[turned])]
            side_i = side_i if turned == j else 1 - side_i
        first, second = (i, j) if side_i == 1 else (j, i)
        at_crossing[_end(chains[second], 1)].add(first)
        at_crossing[_end(chains[second], 1)].discard(second)
        chains[first] += chains.pop(second)
        lengths[first] += lengths[second]
    return list(chains.values())


def _end(chain: list[Piece], side: int) -> int | None:
    return chain[0].ends[0] if side == 0 else chain[-1].ends[1]


def _flick(chains: dict[int, list[Piece]], lengths: list[float], i: int, j: int) -> int | None:
    """Which of two that meet at a corner is but the flick of the other: short, with a free end."""
    short, long = sorted((i, j), key=lambda k: (lengths[k], k))
    if len(chains[short]) > 1 or None not in chains[short][0].ends:
        return None
    widest = chains[short][0].line[:, 2].max()
    return short if lengths[short] < min(FLICK * widest, FLICK_SHARE * lengths[long]) else None


def ordered(chains: list[list[Piece]]) -> list[list[Piece]]:
    """From the upper left to the lower right; before what begins on it, what it begins on."""
    starts = np.array([chain[0].line[0, :2] for chain in chains])
    left_first = (starts @ (1.0, -1.0)).argsort(kind="stable").tolist()
    begins_on = [chain[0].ends[0] for chain in chains]
    unpainted: dict[int | None, set[int]] = {}  # of each crossing: what runs through it
    for k, chain in enumerate(chains):
        for crossing in _passed(chain):
            unpainted.setdefault(crossing, set()).add(k)

    def waits(k: int) -> bool:
        runs_through = unpainted.get(begins_on[k], set())
        return len(runs_through) > (k in runs_through)

    place = {k: place for place, k in enumerate(left_first)}
    ready = [place[k] for k in left_first if not waits(k)]
    waiting: dict[int | None, list[int]] = {}
    for k in left_first:
        if waits(k):
            waiting.setdefault(begins_on[k], []).append(k)
    painted: dict[int, None] = {}
    rest = iter(left_first)
    while len(painted) < len(chains):
        k = left_first[heappop(ready)] if ready else next(k for k in rest if k not in painted)
        painted[k] = None
        for crossing in _passed(chains[k]):
            unpainted[crossing].discard(k)
            held = waiting.pop(crossing, [])
            waiting[crossing] = [other for other in held if waits(other)]
            for other in held:
                if other not in painted and not waits(other):
                    heappush(ready, place[other])
    return [chains[k] for k in painted]


def _passed(chain: list[Piece]) -> set[int]:
    """Crossings that a chain runs through: what begins there hangs on it."""
    return {crossing for piece in chain for crossing in piece.through}


def in_rows(boxes: np.ndarray) -> list[int]:
    """Order of things with bounds (n, 4) x0, y0, x1, y1: as lines of text are read."""
    rows: list[list[int]] = []
    floor = np.inf
    for k in (-boxes[:, 3]).argsort(kind="stable").tolist():
        if boxes[k, 3] <= floor:
            rows.append([])
            floor = boxes[k, 1]
        rows[-1].append(k)
        floor = min(floor, boxes[k, 1])
    return [k for row in rows for k in sorted(row, key=lambda k: (boxes[k, 0], -boxes[k, 3]))]
