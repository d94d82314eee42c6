"""Crossings of a medial axis: which nodes form one, which arms are one line."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np

from ...geometry.polylines import length
from ...geometry.rotation import angle_between

# Two nodes are one crossing if the branch between them is shorter than this share of the sum of their radii.
CROSSING_REACH = 0.9
# Two arms of a crossing are one line if the line turns by less than this there, in all.
MAX_JOIN_TURN_RAD = np.radians(60)
# An arm has a neck if it leaves narrower than this share of the widest disc and is wider further on. Two thick arms
# are one line up to a greater turn if all other arms have a neck. An example is the stem of an a and its foot, next
# to which the bowl joins.
MAX_NECK_RATIO, MAX_THICK_JOIN_TURN_RAD = 0.6, np.radians(120)
# Area that a dropped branch adds at a corner, in squares of the radius. The outer corner of a line that turns by up
# to 60 degrees adds at most 0.05, one of 90 degrees 0.21. More is the end of a stem, which a line that cuts the
# corner would leave bare.
MIN_STEM_END = 0.3
# Least ratio of the turns of two legs towards their tip. Below it, one of the legs is a stem that continues, as in
# a b below its bowl.
MIN_LEG_TURN_RATIO = 0.4
MIN_LEG_COS = 0.5  # cosine of the angle between two legs; arms that are wider apart are a bend
# Nodes of one crossing, and arms of which pairs are tried. More is an asterisk of hairs, which is no writing, and
# the time grows with the square of it.
MAX_NODES, MAX_ARMS = 64, 64


@dataclass
class Arm:
    """A branch as seen from one of its ends at a crossing."""

    branch: int
    forward: bool
    crossing: int
    line: np.ndarray  # rows (k, 3), from the crossing on
    out: int = 0  # first row outside of the crossing's discs
    mate: Arm | None = None
    # the arm at the other end of the branch, None where that end is free
    other: Arm | None = None
    # where the arm begins at a corner, and the half width there
    corner: tuple[np.ndarray, float] | None = None
    # how far the arm runs beyond the middle of its crossing; see find_bars
    beyond_mm: float | None = None
    # rows of the arm's way out of the crossing; see find_ends
    lead: np.ndarray | None = None
    bridge: np.ndarray | None = None  # rows through the crossing to its mate; see find_bridges

    @cached_property
    def direction(self) -> np.ndarray:
        """The unit vector away from the crossing, where the arm leaves it."""
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
    """A place where lines meet: one node of the medial axis, or several close ones.

    A crossing of two arms is a corner.
    """

    discs: np.ndarray  # (k, 3), the discs of its nodes
    # area [squared radii] of the largest branch that was dropped there
    dropped: float = 0.0
    # numbers of the branches between its nodes
    inner: list[int] = field(default_factory=list)
    arms: list[Arm] = field(default_factory=list)
    # arms at corners in its disc; see _drop_thin_stem_end
    neighbours: list[Arm] = field(default_factory=list)
    has_tip: bool = False  # whether legs that are strokes of their own meet in a tip
    # where both arms begin, and the half width there; see find_corners
    corner: tuple[np.ndarray, float] | None = None
    is_on_lead: bool = False  # whether `corner` is on the lead of an arm

    @property
    def is_corner(self) -> bool:
        return len(self.arms) == 2

    @property
    def has_hump(self) -> bool:
        """Whether the end of a stem sticks out next to the neck of an arm.

        An n has such a hump next to its arch. The tip of two legs, as in an A, and the end next to a flag are no
        humps.
        """
        if not self.is_corner or self.dropped <= MIN_STEM_END or _are_legs(*self.arms):
            return False
        thin, wide = sorted(self.arms, key=lambda arm: arm.line[arm.out, 2])
        is_neck = thin.line[thin.out, 2] < MAX_NECK_RATIO * wide.line[wide.out, 2]
        return bool(is_neck and length(thin.line[:, :2]) > length(wide.line[:, :2]))


def find_crossings(nodes, lines, ends, degree) -> tuple[list[Crossing], list[Arm]]:
    """Return all crossings and their arms; arms that are one line are mated.

    nodes: (n, 4); lines: rows (k, 3) of each branch; ends: the two nodes of each branch; degree: (n,), how many
    branches each node has.
    """
    home, inner = _merge_nodes(nodes, lines, ends, degree)
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
            _add_arm(number, side, number_of[node], lines[number], crossings)
            for side, node in enumerate(pair)
            if node in number_of
        ]
        if len(both) == 2:
            both[0].other, both[1].other = both[1], both[0]
            _share_branch(*both)
        arms += both
    for crossing in crossings:
        _drop_tip(crossing)
        _mate_arms(crossing)
    for crossing in crossings:
        _drop_thin_stem_end(crossing, crossings)
    return crossings, [arm for arm in arms if arm.branch not in crossings[arm.crossing].inner]


def _drop_tip(crossing: Crossing) -> None:
    """Drop the blunt tip in which two legs meet, as in an A. The tip is not a line: both legs run on into it."""
    if len(crossing.arms) != 3 or len(crossing.discs) > 1:
        return
    x, y, radius = crossing.discs[0]
    for tip in crossing.arms:
        first_leg, second_leg = (arm for arm in crossing.arms if arm is not tip)
        least, most = sorted(angle_between(-leg.direction, tip.direction) for leg in (first_leg, second_leg))
        is_amid = _are_legs(first_leg, second_leg) and MIN_LEG_TURN_RATIO * most < least < np.pi / 2
        if tip.other is None and is_amid and np.hypot(*tip.line[-1, :2] - (x, y)) < radius:
            crossing.arms = [first_leg, second_leg]
            crossing.inner.append(tip.branch)
            crossing.has_tip = True
            return


def _drop_thin_stem_end(crossing: Crossing, crossings: list[Crossing]) -> None:
    """Drop the branch from a crossing to a close corner if a thin line continues it.

    This is the top of a stem, next to which the leg of an M or N begins and out of which a serif grows.
    """
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
        if length(arm.line[:, :2]) < reach and thin < MAX_NECK_RATIO * arm.line[arm.out, 2]:
            arm.mate.mate = arm.mate = None
            crossing.inner.append(arm.branch)
            crossing.neighbours += [leg for leg in corner.arms if leg is not arm.other]


def _are_legs(one: Arm, two: Arm) -> bool:
    return bool(one.direction @ two.direction > MIN_LEG_COS)


def _merge_nodes(nodes, lines, ends, degree) -> tuple[dict[int, list[int]], set[int]]:
    """Merge nodes that are one crossing, and find the branches inside of crossings.

    Branches inside are those shorter than the discs at their ends. Returns the nodes of each node's crossing, and
    the numbers of the branches. A corner stays apart from crossings. The stem of an r runs on up to its serif even
    where the bowl leaves it right below.
    """
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
            if len(both) > MAX_NODES:
                continue
            if len(both) > 2 and np.hypot(*np.ptp(nodes[both, :2], axis=0)) > reach:
                # otherwise a thick line with many hairs would be a single crossing
                continue
            home |= dict.fromkeys(both, both)
        inner.add(number)
    return home, inner


def _add_arm(branch: int, side: int, crossing: int, line: np.ndarray, crossings: list[Crossing]) -> Arm:
    line = line if side == 0 else line[::-1]
    discs = crossings[crossing].discs
    distances = np.hypot(line[:, None, 0] - discs[None, :, 0], line[:, None, 1] - discs[None, :, 1])
    beyond = (distances > discs[None, :, 2]).all(axis=1)
    arm = Arm(branch, side == 0, crossing, line, int(np.argmax(beyond)) if beyond.any() else len(line) - 1)
    crossings[crossing].arms.append(arm)
    return arm


def _share_branch(a: Arm, b: Arm) -> None:
    """Part a branch between its two arms where the discs of its crossings overlap."""
    last = len(a.line) - 1
    if a.out + b.out > last:
        a.out = round(last * a.out / (a.out + b.out))
        b.out = last - a.out


def _mate_arms(crossing: Crossing) -> None:
    """Mate pairs of arms, the straightest first. No arms are mated at a corner that is the end of a stem."""
    if crossing.is_corner and crossing.dropped > MIN_STEM_END:
        return
    narrow = MAX_NECK_RATIO * crossing.discs[:, 2].max()
    thick = [arm for arm in crossing.arms if arm.line[arm.out, 2] >= narrow]
    necks = [arm for arm in crossing.arms if arm.line[arm.out, 2] < narrow <= arm.line[arm.out :, 2].max()]
    is_neighbour = len(thick) == 2 and necks and len(necks) + 2 == len(crossing.arms)
    if is_neighbour and measure_turn(*thick) < MAX_THICK_JOIN_TURN_RAD:
        thick[0].mate, thick[1].mate = thick[1], thick[0]
    turns = []
    for a, b in combinations(crossing.arms[:MAX_ARMS], 2):
        turns.append((measure_turn(a, b), len(turns), a, b))
    for turn, _, a, b in sorted(turns, key=lambda each: each[:2]):
        if turn < MAX_JOIN_TURN_RAD and a.mate is None and b.mate is None:
            a.mate, b.mate = b, a
    unmated = [arm for arm in crossing.arms if arm.mate is None]
    if len(crossing.arms) == 4 and len(unmated) == 2:
        _mate_thick_arms(crossing, *unmated)


def _mate_thick_arms(crossing: Crossing, a: Arm, b: Arm) -> None:
    """Mate the arms on both sides of a line that runs through, if both are thick.

    They are one line that bends there, as in an x, if the other line parts them and is no wider than either. Thin
    arms would cut their corners across a thick line.
    """
    through_start, through_end = (arm.line[arm.out] for arm in crossing.arms if arm.mate is not None)
    along = through_end[:2] - through_start[:2]
    first, second = (arm.line[arm.out] for arm in (a, b))
    sides = [along[0] * (y - through_start[1]) - along[1] * (x - through_start[0]) for x, y, _ in (first, second)]
    is_thick = min(first[2], second[2]) >= max(through_start[2], through_end[2])
    if is_thick and sides[0] * sides[1] < 0 and measure_turn(a, b) < MAX_THICK_JOIN_TURN_RAD:
        a.mate, b.mate = b, a


def measure_turn(a: Arm, b: Arm) -> float:
    """Return how far a line turns [rad] from one arm through the crossing to another."""
    across = b.line[b.out, :2] - a.line[a.out, :2]
    return angle_between(-a.direction, across) + angle_between(across, b.direction)
