"""What a line does where it meets others: it runs straight on."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...geometry.cubics import at
from ...geometry.rings import is_within
from .edges import amid, can_follow, find_bent_ends, find_ways_in, follow_edges
from .junctions import STEM_END, STRAIGHTEST_RAD, Arm, Crossing, turn_across

# Of the shape around a corner, area that lines ending next to each other may leave bare, more than lines that meet: a
# u's bend is one stroke's.
NOTCH = 0.01
# Area that one line of two limbs must leave bare next to a third, more than two lines do, of the shape around.
FORK = 0.04
# Of a line's width, the space that the shape needs where it begins: at the end of a stem that sticks out at a corner
# less, as in an n with a hump, which narrows towards its top. Above, a straight stem would have to be a wedge.
WHOLE, IN_HUMP = 0.95, 0.5
# Offsets from the middle of a bar, in its half widths, where the extent of the shape is measured: the outer two in the
# stem that it meets, so far from its sides and with its far side no more slanted than that. And how much further the
# shape has to go on amid the bar, how much at most, and on all of its width. FLAT: cosine of the angle with the stem,
# at most.
_ACROSS = np.array([-1.6, -0.7, 0.0, 0.7, 1.6])
IN_STEM, SLANTED, STUB, LIMB, SHOULDER, FLAT = 0.3, 0.6, 0.35, 1.8, 0.1, 0.5
ELBOW = 0.3  # of a turn by 17 degrees
TOUCHING_RAD = np.radians(25)  # lines that cross turn by less
NEAR_EACH_OTHER = 0.7  # half widths of the wider of two lines that meet where they pass each other by less
# Of what was dropped at a corner, in squares of the radius: the end of a stem that a stroke of both arms would leave.
WHOLE_STEM = 0.5
UNLIKE = 0.6  # of the wider: a bowl that widens towards a bar so thin would leave a wedge in the counter
AS_WIDE = 0.9  # of the wider of two lines: where a thinner one ends, that would have to be a wedge
_PLACES = 25  # looked at on the way from a corner's disc to where the lines of its arms meet


def _grid(count: int) -> np.ndarray:
    """In radii of a disc: where lines that meet there may leave a notch."""
    places = np.stack(np.meshgrid(*2 * [np.linspace(-1.6, 1.6, count)]), axis=-1).reshape(-1, 2)
    return places[np.hypot(*places.T) <= 1.6]


_AROUND, _FINELY_AROUND = _grid(17), _grid(41)
# Places times points of the outline, at most, that are tested for being in the shape: a second.
_MOST_QUERIES = 200_000_000


# A belly: a disc so much wider than both arms where they leave it, whose middle is no further from the straight
# way between them than so much of its radius. No bend of a line has such a disc, and a knob at one side is further off.
BELLY, AMID = 1.25, 0.25


def bridge(a: Arm, b: Arm, crossing: Crossing) -> np.ndarray:
    """From one arm to the other through a crossing: a cubic along their directions; the width changes evenly. Where it
    is the belly of one line, the line continues unchanged."""
    if a.bridge is not None:
        return a.bridge
    p, q = a.line[a.out], b.line[b.out]
    if crossing.is_corner and _is_belly(crossing.discs[0], p, q):
        return np.vstack([a.line[: a.out][::-1], b.line[1 : b.out]])
    length = np.hypot(*(q - p)[:2])
    t = np.linspace(0, 1, 10)[1:-1, None]
    c1, c2 = p[:2] - a.direction * length / 3, q[:2] - b.direction * length / 3
    return np.column_stack([at(t, p[:2], c1, c2, q[:2]), (1 - t) * p[2] + t * q[2]])


def _is_belly(disc: np.ndarray, p: np.ndarray, q: np.ndarray) -> bool:
    way, to_middle = (q - p)[:2], (disc - p)[:2]
    distance_mm = abs(way[0] * to_middle[1] - way[1] * to_middle[0]) / max(np.hypot(*way), 1e-12)
    return bool(disc[2] > BELLY * max(p[2], q[2]) and distance_mm < AMID * disc[2])


def stub(arm: Arm, crossing: Crossing) -> np.ndarray:
    """From the crossing to where the arm leaves it: straight on, at the width it has there."""
    start = arm.line[arm.out]
    if arm.lead is not None:
        return arm.lead
    if crossing.is_corner:
        return straight(*arm.corner, start)
    end = amid(arm, crossing)
    if arm.beyond_mm is not None:
        return straight(end - arm.beyond_mm * arm.direction, start[2], start)
    room = (crossing.discs[:, 2] - np.hypot(*(crossing.discs[:, :2] - end).T)).max()
    return straight(end, min(start[2], max(room, 0.3 * start[2])), start)


def find_bridges(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Return the lines through crossings along one edge of the shape, which they keep; those through corners cut
    them."""
    inner = [crossing for crossing in crossings if not crossing.is_corner]
    if not can_follow(sum(len(crossing.arms) for crossing in inner), rings):
        return
    for crossing in inner:
        _join_along_edges(crossing, rings)
    through = [
        (arm, crossing)
        for crossing in inner
        for k, arm in enumerate(crossing.arms)
        if any(arm.mate is other for other in crossing.arms[k + 1 :])
    ]
    if not through:
        return
    found, _ = follow_edges([bridge(a, a.mate, c) for a, c in through], rings)
    for (a, _), line in zip(through, found, strict=True):
        a.bridge, a.mate.bridge = line, line[::-1]


def _join_along_edges(crossing: Crossing, rings: list[np.ndarray]) -> None:
    """Four arms of two lines that touch, as the ring of a Q and its tail do, are joined along the edges of both:
    straight on, either would turn into the other."""
    if len(crossing.arms) != 4 or any(arm.mate is None for arm in crossing.arms):
        return
    first, mate = crossing.arms[0], crossing.arms[0].mate
    one, two = (arm for arm in crossing.arms if arm is not first and arm is not mate)
    if min(turn_across(first, mate), turn_across(one, two)) < TOUCHING_RAD:
        return
    for pairs in (((first, one), (mate, two)), ((first, two), (mate, one))):
        if all(a.other is b for a, b in pairs):
            continue  # both rings of an 8, which is one line
        if max(turn_across(*pair) for pair in pairs) < STRAIGHTEST_RAD:
            _, have_edges = follow_edges([bridge(a, b, crossing) for a, b in pairs], rings)
            if all(have_edges):
                for a, b in pairs:
                    a.mate, b.mate = b, a
                return


def find_forks(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Two limbs that turn sharply next to a third, as the arm and the leg of a k before their short bar, are no one
    line where that leaves more of the shape bare than either that runs straight on."""
    forks = []
    for crossing in crossings:
        limbs = [arm for arm in crossing.arms if arm.mate is not None]
        if len(crossing.arms) == 3 and limbs and turn_across(*limbs) > STRAIGHTEST_RAD:
            forks.append((crossing, limbs))
    if not _can_ask(len(forks), rings):
        return
    for crossing, limbs in forks:
        around = _inside(crossing, rings)
        find_ends([crossing], rings)
        together = _bare(crossing, _inwards(crossing), around)
        for arm in limbs:
            arm.mate = None
        find_ends([crossing], rings)
        if together < _bare(crossing, _inwards(crossing), around) + FORK:
            limbs[0].mate, limbs[1].mate = limbs[1], limbs[0]
        for arm in crossing.arms:
            arm.lead = None


def find_ends(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Decide how the arms that end at crossings continue into them. Without space for their width up to the middle, as
    two limbs that meet next to a stem, they end before it, if that leaves less bare than to narrow up to there."""
    shorter = find_ways_in(crossings, rings)
    if not _can_ask(sum(len(crossing.discs) for _, crossing, _ in shorter), rings):
        return
    for arm, crossing, lead in shorter:
        around = _inside(crossing, rings)
        narrowed = _bare(crossing, _inwards(crossing), around)
        arm.lead = lead
        if _bare(crossing, _inwards(crossing), around) + NOTCH > narrowed:
            arm.lead = None


def _can_ask(discs: int, rings: list[np.ndarray]) -> bool:
    return discs * len(_FINELY_AROUND) * sum(map(len, rings)) < _MOST_QUERIES


def _inside(crossing: Crossing, rings: list[np.ndarray]) -> np.ndarray:
    """Places of the shape around a crossing."""
    around = np.vstack([(x, y) + radius * _FINELY_AROUND for x, y, radius in crossing.discs])
    return around[is_within(around, rings)]


def _inwards(crossing: Crossing) -> list[np.ndarray]:
    """What the lines of a crossing are in it."""
    return [
        stub(arm, crossing) if arm.mate is None else bridge(arm, arm.mate, crossing) for arm in crossing.arms
    ]


def find_bars(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Lines that end at a stem, beyond which the shape goes on a little, too little for a branch of its own, as the
    bars of t and f do: how far beyond the middle of the stem they run."""
    ending = [
        (a, c) for c in crossings if not c.is_corner for a in c.arms if a.mate is None and _crosses(a, c)
    ]
    if not ending:
        return
    halves = np.array([arm.line[arm.out, 2] for arm, _ in ending])
    backs = np.array([-arm.direction for arm, _ in ending])
    lefts = np.column_stack([-backs[:, 1], backs[:, 0]])
    middles = np.array([amid(arm, crossing) for arm, crossing in ending])
    at = middles[:, None] + (halves[:, None] * _ACROSS)[..., None] * lefts[:, None]
    ways = np.repeat(backs, len(_ACROSS), axis=0)
    reached = np.array(_core.first_crossings(rings, at.reshape(-1, 2), ways)).reshape(len(ending), -1)
    stem = reached[:, [0, -1]].max(axis=1)  # its far side, next to the bar
    sticks_out = (reached[:, 1:-1] > (stem + SHOULDER * halves)[:, None]).all(axis=1)
    sticks_out &= (reached[:, 2] > stem + STUB * halves) & (reached[:, 2] < stem + LIMB * halves)
    rooms = np.array(_core.clearance(rings, at[:, [0, -1]].reshape(-1, 2))).reshape(-1, 2)
    sticks_out &= (rooms > IN_STEM * halves[:, None]).all(axis=1)
    sticks_out &= (
        np.ptp(np.nan_to_num(reached[:, [0, -1]], posinf=np.finfo(float).max), axis=1) < SLANTED * halves
    )
    for k in np.flatnonzero(sticks_out).tolist():
        ending[k][0].beyond_mm = max(float(reached[k, 2] - halves[k]), 0.0)


def _crosses(bar: Arm, crossing: Crossing) -> bool:
    """Whether a line runs through a crossing, and across the way of an arm that ends there. Where that arm meets
    the outside of a line's elbow, as at the fork of a Y, what the shape has beyond is the line's own legs."""
    for arm in crossing.arms:
        if arm.mate is not None:
            along = arm.mate.line[arm.mate.out, :2] - arm.line[arm.out, :2]
            is_across = abs(along @ bar.direction) < FLAT * np.hypot(*along)
            if is_across and (arm.direction + arm.mate.direction) @ bar.direction > -ELBOW:
                return True
    return False


STEPS = 5  # of a straight way to where a line begins


def straight(end_mm: np.ndarray, half_mm: float, start: np.ndarray) -> np.ndarray:
    """Rows from a place with its half width up to a row of a line, which is left out."""
    t = np.linspace(0, 1, STEPS + 1)[:-1, None]
    return np.column_stack([end_mm + t * (start[:2] - end_mm), half_mm + t[:, 0] * (start[2] - half_mm)])


def find_corners(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Where the arms of each corner begin: straight on, each on its own line, as far as the shape has room for the
    brush. Or, where that leaves a notch between them and as one stroke: where their lines meet, or as near to that as
    there is room."""
    corners = [crossing for crossing in crossings if crossing.is_corner]
    ways = [way for crossing in corners for way in _ways(crossing)]
    places = np.array([tail + np.linspace(0, 1, _PLACES)[:, None] * by for tail, by in ways])
    around = np.array([disc[:2] + disc[2] * _AROUND for disc in (crossing.discs[0] for crossing in corners)])
    rooms = np.reshape(_core.clearance(rings, np.reshape(places, (-1, 2))), (-1, 3, _PLACES))
    reach_mm = np.reshape([np.hypot(*by) for _, by in ways], (-1, 3))[:, 1:].ravel()
    find_bent_ends(corners, reach_mm, rings)
    for k, (crossing, along) in enumerate(zip(corners, np.reshape(places, (-1, 3, _PLACES, 2)), strict=True)):
        disc = crossing.discs[0, 2]
        widths = [arm.line[arm.out, 2] for arm in crossing.arms]
        meet = _farthest(along[0], rooms[k, 0], max(widths), disc) or (crossing.discs[0, :2], disc)
        own = [
            _farthest(
                along[n],
                rooms[k, n],
                widths[n - 1],
                disc,
                IN_HUMP if crossing.has_hump and widths[n - 1] == max(widths) else WHOLE,
            )
            or meet
            for n in (1, 2)
        ]
        bare = [
            _bare(
                crossing,
                [straight(*end, arm.line[arm.out]) for arm, end in zip(crossing.arms, ends, strict=True)],
                around[k],
            )
            for ends in (own, [meet, meet])
        ]
        crossing.corner = meet
        for arm, end in zip(crossing.arms, own if bare[0] < bare[1] + NOTCH else [meet, meet], strict=True):
            arm.corner = end
        onward = [
            arm.lead if arm.lead is not None else straight(*end, arm.line[arm.out])
            for arm, end in zip(crossing.arms, own, strict=True)
        ]
        _keep_bent(crossing, around[k], min(bare))
        if _can_ask(len(corners), rings):
            _keep_disc(crossing, onward, around[k], rings)


def _keep_disc(
    crossing: Crossing, ways: list[np.ndarray], around: np.ndarray, rings: list[np.ndarray]
) -> None:
    """The wide one of two lines begins in the disc of a corner, as wide as that, and the thin one runs on, two
    strokes, if that leaves less bare: a bowl that widens towards a thin bar, as in a bold serif's e."""
    thin, wide = sorted((0, 1), key=lambda n: float(crossing.arms[n].line[crossing.arms[n].out, 2]))
    one, other = crossing.arms[thin], crossing.arms[wide]
    is_unlike = one.line[one.out, 2] < UNLIKE * other.line[other.out, 2]
    if (
        not is_unlike
        or crossing.dropped < STEM_END
        or crossing.discs[0, 2] < BELLY * other.line[other.out, 2]
    ):
        return
    around = around[is_within(around, rings)]
    into = straight(crossing.discs[0, :2], float(crossing.discs[0, 2]), other.line[other.out])
    chosen = [stub(arm, crossing) for arm in crossing.arms]
    if _bare(crossing, [ways[thin], into], around) + NOTCH < _bare(crossing, chosen, around):
        one.lead, other.lead, crossing.has_tip = ways[thin], into, True


def _keep_bent(crossing: Crossing, around: np.ndarray, most_bare: float) -> None:
    """The ways of arms along bent edges stay if they leave less bare. A stroke of both arms turns at the end of the
    one that bends, or where both meet."""
    with_lead = [arm for arm in crossing.arms if arm.lead is not None]
    thin, wide = sorted(arm.line[arm.out, 2] for arm in crossing.arms)
    stubs = [stub(arm, crossing) for arm in crossing.arms]
    if with_lead and (thin < UNLIKE * wide or _bare(crossing, stubs, around) >= most_bare):
        for arm in with_lead:
            arm.lead = None
    elif len(with_lead) == 1:
        if with_lead[0].line[with_lead[0].out, 2] > AS_WIDE * max(
            arm.line[arm.out, 2] for arm in crossing.arms
        ):
            crossing.corner = with_lead[0].lead[0, :2], float(with_lead[0].lead[0, 2])
            crossing.is_on_lead = True
        else:
            with_lead[0].lead = None
    elif len(with_lead) == 2 and crossing.dropped < WHOLE_STEM:
        thin, wide = (arm.lead for arm in sorted(with_lead, key=lambda arm: arm.line[arm.out, 2]))
        off = np.hypot(*(thin[:, None, :2] - wide[None, :, :2]).transpose(2, 0, 1))
        i, j = np.unravel_index(off.argmin(), off.shape)
        if off[i, j] < NEAR_EACH_OTHER * wide[j, 2]:
            crossing.corner = thin[i, :2], float(min(thin[i, 2], wide[j, 2]))
            crossing.is_on_lead = True


def _bare(crossing: Crossing, stubs: list[np.ndarray], around: np.ndarray) -> float:
    """Share of the places around a corner that its arms leave bare when they begin there."""
    discs = np.vstack([*stubs, *(arm.line[arm.out :][:STEPS] for arm in crossing.arms)])
    off = np.hypot(*(around[:, None] - discs[None, :, :2]).transpose(2, 0, 1))
    return float((off > discs[:, 2]).all(axis=1).mean()) if len(around) else 0.0


def _farthest(
    along: np.ndarray, room: np.ndarray, wide: float, disc: float, least: float = WHOLE
) -> tuple[np.ndarray, float] | None:
    """The last place up to which there is room for so much of the brush, and the half width there."""
    last = int(np.logical_and.accumulate(room >= least * min(wide, disc)).sum()) - 1
    return (along[last], min(float(room[last]), 1.2 * wide)) if last >= 0 else None


def _ways(crossing: Crossing) -> list[tuple[np.ndarray, np.ndarray]]:
    """From a corner's disc to where the lines of its arms meet, and from where either arm begins beyond that."""
    (p, back), (q, d) = ((arm.line[arm.out, :2], -arm.direction) for arm in crossing.arms)
    centre, radius = crossing.discs[0, :2], crossing.discs[0, 2]
    cross = back[0] * d[1] - back[1] * d[0]
    meet = centre  # of one line, or there and back
    if abs(cross) >= 0.2:
        meet = p + ((q - p)[0] * d[1] - (q - p)[1] * d[0]) / cross * back
    ray = meet - centre
    return [
        (centre, ray * min(1.0, 1.5 * radius / max(np.hypot(*ray), 1e-9))),
        *((at, np.clip((meet - at) @ way + radius, 0, 3 * radius) * way) for at, way in ((p, back), (q, d))),
    ]
