"""Pieces of a medial axis: branches joined to lines where they meet.

Branches are joined by their straightest continuation. A piece is a line that a brush could follow: (k, 3) rows of
x, y, half width [mm]. It ends where the outline ends, where it meets another line, or at a corner.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from .junctions import Arm, Crossing, find_crossings
from .lines_at_crossings import find_bars, find_bridges, find_corners, find_ends, find_forks, trace_bridge, trace_stub

# Least share of the places along a branch inside of a crossing that no line paints; with less, the lines that cross
# there paint the branch.
MIN_BARE_SHARE = 0.2


@dataclass
class Piece:
    """A line that a brush could follow.

    line: (k, 3) rows of x, y, half width [mm]; ends: the numbers of the crossings at its ends, None at a free end;
    branches: the branches that it consists of, including those inside crossings; inside: stretches of the line in
    crossings; through: crossings on its way; closed: whether the last point is the first again.
    """

    line: np.ndarray
    ends: tuple[int | None, int | None]
    branches: list[int]
    inside: list[np.ndarray] = field(default_factory=list)
    through: list[int] = field(default_factory=list)
    closed: bool = False


def reverse_piece(piece: Piece) -> Piece:
    return replace(piece, line=piece.line[::-1], ends=piece.ends[::-1])


@dataclass
class Skeleton:
    """The lines of a shape and the crossings at which they meet."""

    pieces: list[Piece]
    crossings: list[Crossing]
    dabs: np.ndarray  # (k, 3), discs of shapes without a branch
    parts: list[list[np.ndarray]]  # for each branch, the rings of its part of the shape


def build_skeleton(rings: list[np.ndarray], nodes: np.ndarray, branches: list) -> Skeleton:
    """Build the pieces of a shape from its medial axis.

    rings: of the shape; nodes, branches: as _core.medial_axis(rings, ...) returns them.
    """
    lines = [branch.line for branch in branches]
    ends = [(branch.start, branch.end) for branch in branches]
    degree = np.bincount(np.array(ends, int).ravel(), minlength=len(nodes))
    crossings, arms = find_crossings(nodes, lines, ends, degree)
    find_corners(crossings, rings)
    find_forks(crossings, rings)
    find_bars(crossings, rings)
    find_bridges(crossings, rings)
    find_ends(crossings, rings)
    used: set[int] = {b for crossing in crossings for b in crossing.inner}
    pieces = []
    for arm in arms:  # lines that begin at a crossing come first, rings last
        if arm.branch not in used and arm.mate is None:
            pieces.append(_follow_line(arm, used, crossings))
    meets = {arm.branch for arm in arms}
    for number, line in enumerate(lines):
        if number not in used and number not in meets:
            used.add(number)
            is_ring = ends[number][0] == ends[number][1]
            pieces.append(Piece(line, (None, None), [number], closed=is_ring))
    for arm in arms:
        if arm.branch not in used and arm.other is None:
            pieces.append(_follow_line(arm, used, crossings, from_free_end=True))
    for arm in arms:
        if arm.branch not in used:
            pieces.append(_follow_ring(arm, used, crossings))
    _assign_inner_branches(crossings, pieces, lines)
    _add_bare_branches(crossings, pieces, lines)
    return Skeleton(pieces, crossings, nodes[degree == 0, :3], [branch.part for branch in branches])


def _assign_inner_branches(crossings: list[Crossing], pieces: list[Piece], lines: list[np.ndarray]) -> None:
    """Assign branches inside crossings without a line to one that ends there, or make the longest a line."""
    passed = {number for piece in pieces for number in piece.through}
    ending = {number: piece for piece in reversed(pieces) for number in piece.ends if number is not None}
    for number, crossing in enumerate(crossings):
        if not crossing.inner or number in passed:
            continue
        owner = ending.get(number)
        if owner is None:
            longest = max(crossing.inner, key=lambda branch: len(lines[branch]))
            owner = Piece(lines[longest], (None, None), [])
            pieces.append(owner)
        owner.branches.extend(crossing.inner)


def _add_bare_branches(crossings: list[Crossing], pieces: list[Piece], lines: list[np.ndarray]) -> None:
    """Make lines of inner branches whose middle no line paints, as a k's stem between arms and foot."""
    at_crossing: dict[int | None, list[Piece]] = {}
    for piece in pieces:
        for number in {*piece.ends, *piece.through}:
            at_crossing.setdefault(number, []).append(piece)
    for number, crossing in enumerate(crossings):
        near = at_crossing.get(number, [])
        if not near:
            continue
        near = [*near, *(piece for leg in crossing.neighbours for piece in at_crossing.get(leg.crossing, ()))]
        for branch in crossing.inner:
            middle = lines[branch][:, :2]
            bare = np.ones(len(middle), bool)
            for piece in near:
                distances = np.hypot(*(middle[:, None] - piece.line[None, :, :2]).transpose(2, 0, 1))
                bare &= (distances > piece.line[:, 2]).all(axis=1)
            if bare.mean() > MIN_BARE_SHARE:
                for piece in near:
                    piece.branches = [each for each in piece.branches if each != branch]
                pieces.append(Piece(lines[branch], (None, None), [branch]))


def _follow_line(arm: Arm, used: set[int], crossings, from_free_end: bool = False) -> Piece:
    """Follow a line through crossings, from an unmated arm or a branch's free end to its other end."""
    used.add(arm.branch)
    if from_free_end:
        first, here, inside = None, arm, []
        rows = [arm.line[arm.out :][::-1]]
    else:
        first, here, inside = arm.crossing, arm.other, [trace_stub(arm, crossings[arm.crossing])]
        rows = [inside[0], _trim_to_crossings(arm)]
    branches, through = [arm.branch], []
    while here is not None:
        if here.mate is None:
            inside.append(trace_stub(here, crossings[here.crossing])[::-1])
            return Piece(np.vstack([*rows, inside[-1]]), (first, here.crossing), branches, inside, through)
        inside.append(trace_bridge(here, here.mate, crossings[here.crossing]))
        through.append(here.crossing)
        branches += [*crossings[here.crossing].inner, here.mate.branch]
        here = here.mate
        used.add(here.branch)
        rows += [inside[-1], _trim_to_crossings(here)]
        here = here.other
    return Piece(np.vstack(rows), (first, None), branches, inside, through)


def _follow_ring(arm: Arm, used: set[int], crossings: list[Crossing]) -> Piece:
    rows, branches, inside, through, here = [], [], [], [], arm
    while True:
        used.add(here.branch)
        end = here.other
        inside.append(trace_bridge(end, end.mate, crossings[end.crossing]))
        through.append(end.crossing)
        branches += [here.branch, *crossings[end.crossing].inner]
        rows += [_trim_to_crossings(here), inside[-1]]
        here = end.mate
        if here is arm:
            return Piece(np.vstack([*rows, rows[0][:1]]), (None, None), branches, inside, through, True)


def _trim_to_crossings(arm: Arm) -> np.ndarray:
    """Return an arm's line outside of the crossings at its ends; where nothing is left, return a point."""
    last = len(arm.line) - (arm.other.out if arm.other else 0)
    if last > arm.out:
        return arm.line[arm.out : last]
    return arm.line[min((arm.out + last) // 2, len(arm.line) - 1)][None]
