"""Medial axis to pieces: branches joined by their straightest continuation where they meet.

A piece is a line that a brush could follow: (k, 3) rows of x, y, half width [mm]. It ends where the outline ends, where
it meets another line, or at a corner.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .bridges import bridge, find_bars, find_bridges, find_corners, find_ends, find_forks, stub
from .junctions import Arm, Crossing, crossings_of

BARE = 0.2  # of the places along a branch inside of a crossing: with less the lines that cross there paint it


@dataclass
class Piece:
    """line: see above; ends: the crossing at either end, None at a free one; branches: what it is made of, those inside
    crossings too; inside: stretches of the line in crossings; through: crossings on its way; closed: the last
    point is the first again."""

    line: np.ndarray
    ends: tuple[int | None, int | None]
    branches: list[int]
    inside: list[np.ndarray] = field(default_factory=list)
    through: list[int] = field(default_factory=list)
    closed: bool = False


@dataclass
class Skeleton:
    pieces: list[Piece]
    crossings: list[Crossing]
    dabs: np.ndarray  # (k, 3)
    parts: list[list[np.ndarray]]  # of the shape, per branch


def skeleton(rings: list[np.ndarray], nodes: np.ndarray, branches: list) -> Skeleton:
    """Pieces of a shape; nodes and branches as _core.medial_axis(rings, ...) returns them."""
    lines = [branch.line for branch in branches]
    ends = [(branch.start, branch.end) for branch in branches]
    degree = np.bincount(np.array(ends, int).ravel(), minlength=len(nodes))
    crossings, arms = crossings_of(nodes, lines, ends, degree)
    find_corners(crossings, rings)
    find_forks(crossings, rings)
    find_bars(crossings, rings)
    find_bridges(crossings, rings)
    find_ends(crossings, rings)
    used: set[int] = {b for crossing in crossings for b in crossing.inner}
    pieces = []
    for arm in arms:  # first those that begin somewhere, then rings
        if arm.branch not in used and arm.mate is None:
            pieces.append(_follow(arm, used, crossings))
    meets = {arm.branch for arm in arms}
    for number, line in enumerate(lines):
        if number not in used and number not in meets:
            used.add(number)
            is_ring = ends[number][0] == ends[number][1]
            pieces.append(Piece(line, (None, None), [number], closed=is_ring))
    for arm in arms:
        if arm.branch not in used and arm.other is None:
            pieces.append(_follow(arm, used, crossings, from_free_end=True))
    for arm in arms:
        if arm.branch not in used:
            pieces.append(_ring(arm, used, crossings))
    _give_away(crossings, pieces, lines)
    _paint_inside(crossings, pieces, lines)
    return Skeleton(pieces, crossings, nodes[degree == 0, :3], [branch.part for branch in branches])


def _give_away(crossings: list[Crossing], pieces: list[Piece], lines: list[np.ndarray]) -> None:
    """The inside of a crossing through which no line runs goes to a line that ends there; if there is none, the
    longest branch inside is one."""
    passed = {number for piece in pieces for number in piece.through}
    ending = {number: piece for piece in reversed(pieces) for number in piece.ends if number is not None}
    for number, crossing in enumerate(crossings):
        if not crossing.inner or number in passed:
            continue
        found = ending.get(number)
        if found is None:
            longest = max(crossing.inner, key=lambda branch: len(lines[branch]))
            found = Piece(lines[longest], (None, None), [])
            pieces.append(found)
        found.branches.extend(crossing.inner)


def _paint_inside(crossings: list[Crossing], pieces: list[Piece], lines: list[np.ndarray]) -> None:
    """Branches inside of crossings whose middle no line paints become lines: the stem of a k between its arms and its
    foot."""
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
                off = np.hypot(*(middle[:, None] - piece.line[None, :, :2]).transpose(2, 0, 1))
                bare &= (off > piece.line[:, 2]).all(axis=1)
            if bare.mean() > BARE:
                for piece in near:
                    piece.branches = [each for each in piece.branches if each != branch]
                pieces.append(Piece(lines[branch], (None, None), [branch]))


def _follow(arm: Arm, used: set[int], crossings, from_free_end: bool = False) -> Piece:
    """From an unmated arm, or from the free end of a branch, through crossings to the other end."""
    used.add(arm.branch)
    if from_free_end:
        first, here, inside = None, arm, []
        rows = [arm.line[arm.out :][::-1]]
    else:
        first, here, inside = arm.crossing, arm.other, [stub(arm, crossings[arm.crossing])]
        rows = [inside[0], _along(arm)]
    branches, through = [arm.branch], []
    while here is not None:
        if here.mate is None:
            inside.append(stub(here, crossings[here.crossing])[::-1])
            return Piece(np.vstack([*rows, inside[-1]]), (first, here.crossing), branches, inside, through)
        inside.append(bridge(here, here.mate, crossings[here.crossing]))
        through.append(here.crossing)
        branches += [*crossings[here.crossing].inner, here.mate.branch]
        here = here.mate
        used.add(here.branch)
        rows += [inside[-1], _along(here)]
        here = here.other
    return Piece(np.vstack(rows), (first, None), branches, inside, through)


def _ring(arm: Arm, used: set[int], crossings: list[Crossing]) -> Piece:
    rows, branches, inside, through, here = [], [], [], [], arm
    while True:
        used.add(here.branch)
        end = here.other
        inside.append(bridge(end, end.mate, crossings[end.crossing]))
        through.append(end.crossing)
        branches += [here.branch, *crossings[end.crossing].inner]
        rows += [_along(here), inside[-1]]
        here = end.mate
        if here is arm:
            return Piece(np.vstack([*rows, rows[0][:1]]), (None, None), branches, inside, through, True)


def _along(arm: Arm) -> np.ndarray:
    """The arm's line outside of the crossings at its ends; where they leave nothing of it, a point."""
    last = len(arm.line) - (arm.other.out if arm.other else 0)
    if last > arm.out:
        return arm.line[arm.out : last]
    return arm.line[min((arm.out + last) // 2, len(arm.line) - 1)][None]
