"""Medial axis to pieces: branches joined by their straightest continuation where they meet.

A piece is a line that a brush could follow: (k, 3) rows of x, y, half width [mm]. It ends where the outline ends, where
it meets another line, or at a corner.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np

from .. import _core

# What a branch must add to be painted, in squares of the half width where it leaves. A corner of 90 degrees adds 0.21,
# of 60 degrees 0.69, of 45 degrees 1.24: those are ends of strokes, not strokes.
LEAST_SHARE = 0.8
# Nodes whose discs overlap by more are one crossing.
CROSSING_REACH = 0.9
# Lines that turn by less, in all, where they cross others are one line.
STRAIGHTEST_RAD = np.radians(60)


@dataclass
class Arm:
    """A branch as seen from one of its ends at a crossing."""

    branch: int
    forward: bool
    crossing: int
    line: np.ndarray  # from the crossing on
    out: int = 0  # first row outside of the crossing's discs
    mate: Arm | None = None
    other: Arm | None = None  # the same branch from its other end, None where that is free

    @cached_property
    def direction(self) -> np.ndarray:
        """Unit vector away from the crossing, where the arm leaves it."""
        start = self.line[self.out]
        reach = max(start[2], 1e-6)
        ahead = self.line[self.out :]
        along = np.hypot(*(ahead[:, :2] - start[:2]).T)
        far = int(np.argmax(along >= reach)) if (along >= reach).any() else len(ahead) - 1
        step = ahead[far, :2] - start[:2]
        if np.hypot(*step) < 1e-3 * reach:
            step = start[:2] - self.line[0, :2]
        return step / max(np.hypot(*step), 1e-12)


@dataclass
class Piece:
    """line: see above; ends: the crossing at either end, None at a free one; branches: what it is made of, those inside
    crossings too; inside: stretches of the line that lie in crossings; through: crossings on its way; closed: the last
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


@dataclass
class Crossing:
    discs: np.ndarray  # (k, 3), of its nodes
    inner: list[int] = field(default_factory=list)  # branches between its nodes
    arms: list[Arm] = field(default_factory=list)

    @property
    def is_corner(self) -> bool:
        return len(self.arms) == 2


def skeleton(rings: list[np.ndarray]) -> Skeleton:
    nodes, branches = _core.medial_axis(rings, LEAST_SHARE)
    lines = [branch.line for branch in branches]
    ends = [(branch.start, branch.end) for branch in branches]
    degree = np.zeros(len(nodes), int)
    for pair in ends:
        np.add.at(degree, list(pair), 1)
    crossings, arms = _crossings(nodes, lines, ends, degree)
    for crossing in crossings:
        _join_arms(crossing)
    used: set[int] = {b for crossing in crossings for b in crossing.inner}
    pieces = []
    for arm in arms:  # first those that begin somewhere, then rings
        if arm.branch not in used and arm.mate is None:
            pieces.append(_follow(arm, used, crossings, rings))
    for number, line in enumerate(lines):
        if number not in used and not any(arm.branch == number for arm in arms):
            used.add(number)
            is_ring = ends[number][0] == ends[number][1]
            pieces.append(Piece(line, (None, None), [number], closed=is_ring))
    for arm in arms:
        if arm.branch not in used and arm.other is None:
            pieces.append(_follow(arm, used, crossings, rings, from_free_end=True))
    for arm in arms:
        if arm.branch not in used:
            pieces.append(_ring(arm, used, crossings))
    for number, crossing in enumerate(crossings):
        _give_away(number, crossing, pieces, lines)
    return Skeleton(pieces, crossings, nodes[degree == 0, :3], [branch.part for branch in branches])


def _give_away(number: int, crossing: Crossing, pieces: list[Piece], lines: list[np.ndarray]) -> None:
    """What lies inside of a crossing through which nothing runs goes to a line that ends there; if there is none, the
    longest branch inside is one."""
    if not crossing.inner or any(number in piece.through for piece in pieces):
        return
    found = next((piece for piece in pieces if number in piece.ends), None)
    if found is None:
        longest = max(crossing.inner, key=lambda branch: len(lines[branch]))
        found = Piece(lines[longest], (None, None), [])
        pieces.append(found)
    found.branches.extend(crossing.inner)


def _crossings(nodes, lines, ends, degree):
    """Nodes that lie within each other's discs, as one crossing; and all arms of all crossings."""
    home = {k: [k] for k in range(len(nodes)) if degree[k] >= 2}
    inner = []
    lengths = [float(np.hypot(*np.diff(line[:, :2], axis=0).T).sum()) for line in lines]
    for number in np.argsort(lengths, kind="stable").tolist():
        a, b = ends[number]
        if a not in home or b not in home:
            continue
        reach = CROSSING_REACH * (nodes[a, 2] + nodes[b, 2])
        if lengths[number] >= reach:
            continue
        if home[a] is not home[b]:
            both = [*home[a], *home[b]]
            if len(both) > 2 and np.hypot(*np.ptp(nodes[both, :2], axis=0)) > reach:
                continue  # or a thick line with many hairs would be but one crossing
            home |= dict.fromkeys(both, both)
        inner.append(number)
    crossings: list[Crossing] = []
    number_of: dict[int, int] = {}
    for k, members in home.items():
        if k == members[0]:
            number_of |= dict.fromkeys(members, len(crossings))
            crossings.append(Crossing(nodes[members, :3]))
    arms = []
    for number, (a, b) in enumerate(ends):
        if number in inner:
            crossings[number_of[a]].inner.append(number)
            continue
        if a == b and degree[a] == 2:
            continue  # a ring that meets nothing
        pair = [None, None]
        for side, node in enumerate((a, b)):
            if degree[node] < 2:
                continue
            c = number_of[node]
            line = lines[number] if side == 0 else lines[number][::-1]
            discs = crossings[c].discs
            off = np.hypot(line[:, None, 0] - discs[None, :, 0], line[:, None, 1] - discs[None, :, 1])
            beyond = (off > discs[None, :, 2]).all(axis=1)
            arm = Arm(number, side == 0, c, line, int(np.argmax(beyond)) if beyond.any() else len(line) - 1)
            pair[side] = arm
            crossings[c].arms.append(arm)
            arms.append(arm)
        if None not in pair:
            pair[0].other, pair[1].other = pair[1], pair[0]
    return crossings, arms


def _join_arms(crossing: Crossing) -> None:
    """Pairs of arms, the straightest first."""
    turns = []
    for a, b in combinations(crossing.arms, 2):
        across = b.line[b.out, :2] - a.line[a.out, :2]
        turns.append((_turn(-a.direction, across) + _turn(across, b.direction), len(turns), a, b))
    for turn, _, a, b in sorted(turns, key=lambda each: each[:2]):
        if turn < STRAIGHTEST_RAD and a.mate is None and b.mate is None:
            a.mate, b.mate = b, a


def _turn(u, v) -> float:
    return abs(float(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)))


def _follow(arm: Arm, used: set[int], crossings, rings, from_free_end: bool = False) -> Piece:
    """From an unmated arm, or from the free end of a branch, through crossings to the other end."""
    used.add(arm.branch)
    if from_free_end:
        first, here, inside = None, arm, []
        rows = [arm.line[arm.out :][::-1]]
    else:
        first, here, inside = arm.crossing, arm.other, [_stub(arm, crossings[arm.crossing], rings)]
        rows = [inside[0], _along(arm)]
    branches, through = [arm.branch], []
    while here is not None:
        if here.mate is None:
            inside.append(_stub(here, crossings[here.crossing], rings)[::-1])
            return Piece(np.vstack([*rows, inside[-1]]), (first, here.crossing), branches, inside, through)
        inside.append(_bridge(here, here.mate))
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
        inside.append(_bridge(end, end.mate))
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


def _bridge(a: Arm, b: Arm) -> np.ndarray:
    """From one arm to the other through a crossing: a cubic along their directions; the width changes evenly."""
    p, q = a.line[a.out], b.line[b.out]
    length = np.hypot(*(q - p)[:2])
    t = np.linspace(0, 1, 10)[1:-1, None]
    u = 1 - t
    c1, c2 = p[:2] - a.direction * length / 3, q[:2] - b.direction * length / 3
    xy = u**3 * p[:2] + 3 * t * u**2 * c1 + 3 * t**2 * u * c2 + t**3 * q[:2]
    return np.column_stack([xy, u * p[2] + t * q[2]])


def _stub(arm: Arm, crossing: Crossing, rings: list[np.ndarray]) -> np.ndarray:
    """From the crossing to where the arm leaves it: straight on, at the width it has there; at a corner from where the
    lines of both arms meet."""
    start = arm.line[arm.out]
    if crossing.is_corner:
        end, half = _corner(crossing, rings)
    else:
        back = -arm.direction
        centre = crossing.discs[:, :2].mean(axis=0)
        end = start[:2] + max(float((centre - start[:2]) @ back), 0.0) * back
        room = (crossing.discs[:, 2] - np.hypot(*(crossing.discs[:, :2] - end).T)).max()
        half = min(start[2], max(room, 0.3 * start[2]))
    t = np.linspace(0, 1, 6)[:-1, None]
    return np.column_stack([end + t * (start[:2] - end), half + t[:, 0] * (start[2] - half)])


def _corner(crossing: Crossing, rings: list[np.ndarray]) -> tuple[np.ndarray, float]:
    """Where the lines of both arms of a corner meet, or as near to that as the shape has room for the brush, and the
    half width there."""
    one, two = crossing.arms
    p, q = one.line[one.out], two.line[two.out]
    back, d = -one.direction, -two.direction
    centre, room = crossing.discs[0, :2], crossing.discs[0, 2]
    cross = back[0] * d[1] - back[1] * d[0]
    if abs(cross) < 0.2:
        return centre, max(p[2], q[2])
    off = q[:2] - p[:2]
    meet = p[:2] + (off[0] * d[1] - off[1] * d[0]) / cross * back
    ray = meet - centre
    ray *= min(1.0, 1.5 * room / max(np.hypot(*ray), 1e-9))
    places = centre + np.linspace(0, 1, 9)[:, None] * ray
    rooms = _clearance(places, rings)
    wide = max(p[2], q[2])
    fits = np.flatnonzero(rooms >= 0.9 * min(wide, room))
    last = fits[-1] if len(fits) else 0
    return places[last], min(float(rooms[last]), 1.2 * wide)


def _clearance(points: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """Distance [mm] of points (n, 2) from the outline; it does not say on which side."""
    tails = np.vstack(rings)
    along = np.vstack([np.roll(ring, -1, axis=0) for ring in rings]) - tails
    off = points[:, None] - tails
    t = np.clip((off * along).sum(axis=2) / np.maximum((along * along).sum(axis=1), 1e-18), 0.0, 1.0)
    return np.hypot(*np.moveaxis(off - t[..., None] * along, 2, 0)).min(axis=1)
