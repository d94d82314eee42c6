"""Where branches of a medial axis meet: which of its nodes are one crossing, which two arms of it are one line."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np

from ...geometry.polylines import length

# Nodes whose discs overlap by more are one crossing.
CROSSING_REACH = 0.9
# Lines that turn by less, in all, where they cross others are one line.
STRAIGHTEST_RAD = np.radians(60)
# A neck is where an arm leaves narrower than so much of the widest disc and is wider further on. Two arms between which
# all others have one are one line up to a greater turn: the stem of an a and its foot, next to which the bowl joins.
NECK, STRAIGHTEST_THICK_RAD = 0.6, np.radians(120)
# What a dropped branch adds, in squares of the radius: the outer corner of a line that turns by less has 0.05, one of
# 90 degrees 0.21. More is the end of a stem, which a line that cuts the corner would leave bare.
STEM_END = 0.3
# Of the turns of two legs towards their tip the less is at least so much of the other: else one of them is a stem that
# goes on, as in a b below its bowl.
SIDED = 0.4
ACUTE = 0.5  # cosine of the angle between legs, at most: wider apart they are a bend
# Nodes of one crossing, and its arms of which pairs are tried: more is an asterisk of hairs, no writing, and would take
# the square of it.
MOST_NODES, MOST_ARMS = 64, 64


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
    corner: tuple[np.ndarray, float] | None = None  # where it begins at a corner, and the half width there
    beyond_mm: float | None = None  # how far beyond the middle of its crossing it runs; see find_bars
    lead: np.ndarray | None = None  # rows of its way out of the crossing; see find_ends
    bridge: np.ndarray | None = None  # rows through the crossing to its mate; see find_bridges

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
class Crossing:
    discs: np.ndarray  # (k, 3), of its nodes
    dropped: float = 0.0  # the largest that a branch dropped there would add, in squares of the radius
    inner: list[int] = field(default_factory=list)  # branches between its nodes
    arms: list[Arm] = field(default_factory=list)
    neighbours: list[Arm] = field(default_factory=list)  # at corners in its disc; see _leave_out_stem_end
    has_tip: bool = False  # of legs that meet, which are strokes of their own
    corner: tuple[np.ndarray, float] | None = (
        None  # where both arms begin, and the half width there; see joints
    )
    is_on_lead: bool = False  # whether that is on the ways of arms along edges

    @property
    def is_corner(self) -> bool:
        return len(self.arms) == 2

    @property
    def has_hump(self) -> bool:
        """Return whether the end of a stem sticks out next to the neck of an arm, as an n's next to its arch; not that
        of two legs, as in an A, nor next to a flag."""
        if not self.is_corner or self.dropped <= STEM_END or _are_legs(*self.arms):
            return False
        thin, wide = sorted(self.arms, key=lambda arm: arm.line[arm.out, 2])
        is_neck = thin.line[thin.out, 2] < NECK * wide.line[wide.out, 2]
        return bool(is_neck and length(thin.line[:, :2]) > length(wide.line[:, :2]))


def crossings_of(nodes, lines, ends, degree) -> tuple[list[Crossing], list[Arm]]:
    """All crossings and their arms, those that are one line mated. nodes (n, 4), lines and ends (two nodes) per branch,
    degree: how many branches a node has."""
    home, inner = _merged(nodes, lines, ends, degree)
    crossings: list[Crossing] = []
    number_of: dict[int, int] = {}
    for k, members in home.items():
        if k == members[0]:
            number_of |= dict.fromkeys(members, len(crossings))
            crossings.append(Crossing(nodes[members, :3], float(nodes[members, 3].max())))
    arms = []
    for number, pair in enumerate(ends):
        if number in inner:
            crossings[number_of[pair[0]]].inner.append(number)
            continue
        if pair[0] == pair[1] and degree[pair[0]] == 2:
            continue  # a ring that meets nothing
        both = [
            _arm(number, side, number_of[node], lines[number], crossings)
            for side, node in enumerate(pair)
            if node in number_of
        ]
        if len(both) == 2:
            both[0].other, both[1].other = both[1], both[0]
            _share(*both)
        arms += both
    for crossing in crossings:
        _leave_out_tip(crossing)
        _join(crossing)
    for crossing in crossings:
        _leave_out_stem_end(crossing, crossings)
    return crossings, [arm for arm in arms if arm.branch not in crossings[arm.crossing].inner]


def _leave_out_tip(crossing: Crossing) -> None:
    """The blunt tip in which two legs meet, as in an A, is not a line: both legs run on into it."""
    if len(crossing.arms) != 3 or len(crossing.discs) > 1:
        return
    x, y, radius = crossing.discs[0]
    for tip in crossing.arms:
        one, two = (arm for arm in crossing.arms if arm is not tip)
        least, most = sorted(_turn(-leg.direction, tip.direction) for leg in (one, two))
        is_amid = _are_legs(one, two) and SIDED * most < least < np.pi / 2
        if tip.other is None and is_amid and np.hypot(*tip.line[-1, :2] - (x, y)) < radius:
            crossing.arms = [one, two]
            crossing.inner.append(tip.branch)
            crossing.has_tip = True
            return


def _leave_out_stem_end(crossing: Crossing, crossings: list[Crossing]) -> None:
    """The part between a crossing and a corner in its disc is no line if it continues as a thin one: the top of a stem,
    next to which the leg of an M or N begins and out of which a serif leads."""
    if crossing.is_corner:
        return
    for arm in crossing.arms:
        if arm.mate is None or arm.other is None or arm.other.mate is not None:
            continue
        corner = crossings[arm.other.crossing]
        if not corner.is_corner:
            continue
        reach = CROSSING_REACH * (crossing.discs[:, 2].max() + corner.discs[:, 2].max())
        thin = arm.mate.line[arm.mate.out, 2]
        if length(arm.line[:, :2]) < reach and thin < NECK * arm.line[arm.out, 2]:
            arm.mate.mate = arm.mate = None
            crossing.inner.append(arm.branch)
            crossing.neighbours += [leg for leg in corner.arms if leg is not arm.other]


def _are_legs(one: Arm, two: Arm) -> bool:
    return bool(one.direction @ two.direction > ACUTE)


def _merged(nodes, lines, ends, degree) -> tuple[dict[int, list[int]], set[int]]:
    """The nodes that are one crossing, for each node, and the branches inside of crossings: those shorter than the
    discs at their ends. A corner stays apart from crossings: the stem of an r runs on up to its serif, also where the
    bowl leaves it right below."""
    home = {k: [k] for k in range(len(nodes)) if degree[k] >= 2}
    inner = set()
    lengths = [length(line[:, :2]) for line in lines]
    for number in np.argsort(lengths, kind="stable").tolist():
        a, b = ends[number]
        if a not in home or b not in home or (degree[a] == 2) != (degree[b] == 2):
            continue
        reach = CROSSING_REACH * (nodes[a, 2] + nodes[b, 2])
        if lengths[number] >= reach:
            continue
        if home[a] is not home[b]:
            both = [*home[a], *home[b]]
            if len(both) > MOST_NODES:
                continue
            if len(both) > 2 and np.hypot(*np.ptp(nodes[both, :2], axis=0)) > reach:
                continue  # or a thick line with many hairs would be but one crossing
            home |= dict.fromkeys(both, both)
        inner.add(number)
    return home, inner


def _arm(branch: int, side: int, crossing: int, line: np.ndarray, crossings: list[Crossing]) -> Arm:
    line = line if side == 0 else line[::-1]
    discs = crossings[crossing].discs
    off = np.hypot(line[:, None, 0] - discs[None, :, 0], line[:, None, 1] - discs[None, :, 1])
    beyond = (off > discs[None, :, 2]).all(axis=1)
    arm = Arm(branch, side == 0, crossing, line, int(np.argmax(beyond)) if beyond.any() else len(line) - 1)
    crossings[crossing].arms.append(arm)
    return arm


def _share(a: Arm, b: Arm) -> None:
    """Arms of one branch, whose crossings reach into each other, leave them where they meet."""
    last = len(a.line) - 1
    if a.out + b.out > last:
        a.out = round(last * a.out / (a.out + b.out))
        b.out = last - a.out


def _join(crossing: Crossing) -> None:
    """Pairs of arms, the straightest first; none at the end of a stem."""
    if crossing.is_corner and crossing.dropped > STEM_END:
        return
    narrow = NECK * crossing.discs[:, 2].max()
    thick = [arm for arm in crossing.arms if arm.line[arm.out, 2] >= narrow]
    necks = [arm for arm in crossing.arms if arm.line[arm.out, 2] < narrow <= arm.line[arm.out :, 2].max()]
    is_neighbour = len(thick) == 2 and necks and len(necks) + 2 == len(crossing.arms)
    if is_neighbour and turn_across(*thick) < STRAIGHTEST_THICK_RAD:
        thick[0].mate, thick[1].mate = thick[1], thick[0]
    turns = []
    for a, b in combinations(crossing.arms[:MOST_ARMS], 2):
        turns.append((turn_across(a, b), len(turns), a, b))
    for turn, _, a, b in sorted(turns, key=lambda each: each[:2]):
        if turn < STRAIGHTEST_RAD and a.mate is None and b.mate is None:
            a.mate, b.mate = b, a
    left = [arm for arm in crossing.arms if arm.mate is None]
    if len(crossing.arms) == 4 and len(left) == 2:
        _join_thick(crossing, *left)


def _join_thick(crossing: Crossing, a: Arm, b: Arm) -> None:
    """Join the arms next to a line that runs through: they are one line that bends there, as an x has it, if that
    line parts them and is no wider than either. Joined, thin ones would cut their corners across a thick line."""
    one, two = (arm.line[arm.out] for arm in crossing.arms if arm.mate is not None)
    along = two[:2] - one[:2]
    first, second = (arm.line[arm.out] for arm in (a, b))
    sides = [along[0] * (y - one[1]) - along[1] * (x - one[0]) for x, y, _ in (first, second)]
    is_thick = min(first[2], second[2]) >= max(one[2], two[2])
    if is_thick and sides[0] * sides[1] < 0 and turn_across(a, b) < STRAIGHTEST_THICK_RAD:
        a.mate, b.mate = b, a


def turn_across(a: Arm, b: Arm) -> float:
    across = b.line[b.out, :2] - a.line[a.out, :2]
    return _turn(-a.direction, across) + _turn(across, b.direction)


def _turn(u, v) -> float:
    return abs(float(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v)))
