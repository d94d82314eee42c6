"""How one writes: which way a line runs, which lines are one stroke, what comes first."""

from __future__ import annotations

from dataclasses import replace

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
    chains = [[directed(piece)] for piece in pieces]
    for number, crossing in enumerate(skeleton.crossings):
        if not crossing.is_corner:
            continue
        here = [(k, side) for k, chain in enumerate(chains) for side in (0, 1) if _end(chain, side) == number]
        if len(here) != 2 or here[0][0] == here[1][0]:
            continue
        (i, side_i), (j, side_j) = here
        if side_i == side_j:  # both begin or both end here
            turned = _flick(chains, i, j)
            if turned is None:
                continue
            chains[turned] = [reversed_(piece) for piece in reversed(chains[turned])]
            side_i = side_i if turned == j else 1 - side_i
        first, second = (i, j) if side_i == 1 else (j, i)
        chains[first] = [*chains[first], *chains[second]]
        chains[second] = []
        chains = [chain for chain in chains if chain]
    return chains


def _end(chain: list[Piece], side: int) -> int | None:
    return chain[0].ends[0] if side == 0 else chain[-1].ends[1]


def _flick(chains: list[list[Piece]], i: int, j: int) -> int | None:
    """Which of two that meet at a corner is but the flick of the other: short, with a free end."""
    lengths = {k: sum(length_mm(piece.line) for piece in chains[k]) for k in (i, j)}
    short, long = sorted((i, j), key=lambda k: (lengths[k], k))
    if len(chains[short]) > 1 or None not in chains[short][0].ends:
        return None
    widest = chains[short][0].line[:, 2].max()
    return short if lengths[short] < min(FLICK * widest, FLICK_SHARE * lengths[long]) else None


def ordered(chains: list[list[Piece]]) -> list[list[Piece]]:
    """From the upper left to the lower right; before what begins on it, what it begins on."""
    starts = np.array([chain[0].line[0, :2] for chain in chains])
    left_first = (starts @ (1.0, -1.0)).argsort(kind="stable").tolist()
    passed = [_passed(chain) for chain in chains]
    result: list[int] = []
    while left_first:
        for k in left_first:
            begins_on = chains[k][0].ends[0]
            waits = begins_on is not None and any(j != k and begins_on in passed[j] for j in left_first)
            if not waits:
                break
        else:
            k = left_first[0]
        left_first.remove(k)
        result.append(k)
    return [chains[k] for k in result]


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
