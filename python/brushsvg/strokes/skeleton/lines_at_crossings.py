"""Lines inside crossings and corners: where they begin, end and continue."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...geometry.cubics import at
from ...geometry.rings import is_within
from .edges import can_follow, extend_to_middle, find_bent_ends, find_leads, follow_edges
from .junctions import MAX_JOIN_TURN_RAD, MIN_STEM_END, Arm, Crossing, measure_turn

# The shares below are parts of the shape's area around a crossing, and "bare" is the area that no line paints.
# Another arrangement of the arms replaces the simplest one only if it leaves bare at least this share less. With
# more, notches stay between arms that begin apart, as in the bend of a u, which is one stroke.
MIN_BARE_GAIN = 0.01
# The same for parting one line of two limbs that turns sharply next to a third limb.
MIN_FORK_BARE_GAIN = 0.04
# Clearance in the shape that a line needs where it begins, in shares of its half width. The second value holds at
# the end of a stem that sticks out at a corner, as in an n with a hump: the stem narrows towards its top. With
# more, a straight stem would have to become a wedge.
MIN_CLEARANCE, MIN_CLEARANCE_IN_HUMP = 0.95, 0.5
# Offsets from the middle of a bar, in its half widths, at which the extent of the shape is measured. The outer two
# are in the stem that the bar meets.
BAR_PROBE_OFFSETS = np.array([-1.6, -0.7, 0.0, 0.7, 1.6])
# Limits for a line that ends at a stem beyond which the shape continues, in half widths of the line except for the
# last. The outer probes have at least MIN_IN_STEM of clearance inside of the stem, whose far side is slanted by at
# most MAX_SLANT. Amid the bar, the shape extends MIN_BEYOND to MAX_BEYOND past the stem. Over the whole width of
# the bar it extends at least MIN_BEYOND_SIDES past it. MAX_BAR_COS is the greatest cosine of the angle between bar
# and stem.
MIN_IN_STEM, MAX_SLANT, MIN_BEYOND, MAX_BEYOND, MIN_BEYOND_SIDES, MAX_BAR_COS = 0.3, 0.6, 0.35, 1.8, 0.1, 0.5
# Length of the sum of two unit vectors of a line that turns by 17 degrees. A line that turns by more has an elbow.
MIN_ELBOW_SUM = 0.3
# Two lines of which one turns by less cross each other and do not merely touch.
MIN_TOUCHING_TURN_RAD = np.radians(25)
# In half widths of the wider line: two lines that pass each other at a smaller distance meet there.
MAX_MEETING_DISTANCE = 0.7
# Area that a dropped branch may add at a corner, in squares of the radius. More is the end of a stem, which one
# stroke of both arms would leave bare.
MAX_DROPPED_STEM_END = 0.5
# Width ratio of two lines. A bowl that widens towards a thinner bar would leave a wedge in the counter.
UNLIKE_WIDTH_RATIO = 0.6
# Share of the wider line's half width. A thinner line that ends at the corner would turn the stroke into a wedge.
MIN_BENT_WIDTH_RATIO = 0.9
_PROBE_COUNT = 25  # places along each way that is probed for room at a corner


def _make_disc_grid(count: int) -> np.ndarray:
    """Return places in a disc, in its radii, where lines may leave a notch."""
    places = np.stack(np.meshgrid(*2 * [np.linspace(-1.6, 1.6, count)]), axis=-1).reshape(-1, 2)
    return places[np.hypot(*places.T) <= 1.6]


_COARSE_GRID, _FINE_GRID = _make_disc_grid(17), _make_disc_grid(41)
# At most so many places times points of the outline are tested for being in the shape, which takes a second.
_MAX_QUERIES = 200_000_000


# A belly is a disc that is wider than both arms where they leave it by at least this factor. Its middle is at most
# so many of its radii from the straight way between the arms. No bend of a line has such a disc, and a knob at one
# side is further from that way.
MIN_BELLY_RATIO, MAX_BELLY_OFFSET = 1.25, 0.25


def trace_bridge(a: Arm, b: Arm, crossing: Crossing) -> np.ndarray:
    """Trace the line from one arm to another through their crossing.

    The line is a cubic along the directions of both arms, and its width changes evenly. Where the crossing is the
    belly of a single line, the line continues unchanged. Returns rows (k, 3).
    """
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
    return bool(disc[2] > MIN_BELLY_RATIO * max(p[2], q[2]) and distance_mm < MAX_BELLY_OFFSET * disc[2])


def trace_stub(arm: Arm, crossing: Crossing) -> np.ndarray:
    """Trace the line from the crossing to where the arm leaves it.

    The line runs straight on, with the half width that the arm has there. Returns rows (k, 3).
    """
    start = arm.line[arm.out]
    if arm.lead is not None:
        return arm.lead
    if crossing.is_corner:
        return trace_straight(*arm.corner, start)
    end = extend_to_middle(arm, crossing)
    if arm.beyond_mm is not None:
        return trace_straight(end - arm.beyond_mm * arm.direction, start[2], start)
    room = (crossing.discs[:, 2] - np.hypot(*(crossing.discs[:, :2] - end).T)).max()
    return trace_straight(end, min(start[2], max(room, 0.3 * start[2])), start)


def find_bridges(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Find the lines that run through crossings along one edge of the shape.

    Such a line keeps its distance from the edge, and both of its arms get it as their `bridge`. Lines through
    corners are left out, because they cut the corner.
    """
    inner = [crossing for crossing in crossings if not crossing.is_corner]
    if not can_follow(sum(len(crossing.arms) for crossing in inner), rings):
        return
    for crossing in inner:
        _join_touching_lines(crossing, rings)
    through = [
        (arm, crossing)
        for crossing in inner
        for k, arm in enumerate(crossing.arms)
        if any(arm.mate is other for other in crossing.arms[k + 1 :])
    ]
    if not through:
        return
    moved, _ = follow_edges([trace_bridge(a, a.mate, c) for a, c in through], rings)
    for (a, _), line in zip(through, moved, strict=True):
        a.bridge, a.mate.bridge = line, line[::-1]


def _join_touching_lines(crossing: Crossing, rings: list[np.ndarray]) -> None:
    """Join four arms of touching lines along both edges, not straight on; as in a Q's ring and tail."""
    if len(crossing.arms) != 4 or any(arm.mate is None for arm in crossing.arms):
        return
    first, mate = crossing.arms[0], crossing.arms[0].mate
    third, fourth = (arm for arm in crossing.arms if arm is not first and arm is not mate)
    if min(measure_turn(first, mate), measure_turn(third, fourth)) < MIN_TOUCHING_TURN_RAD:
        return
    for pairs in (((first, third), (mate, fourth)), ((first, fourth), (mate, third))):
        if all(a.other is b for a, b in pairs):
            continue  # both rings of an 8, which is one line
        if max(measure_turn(*pair) for pair in pairs) < MAX_JOIN_TURN_RAD:
            _, have_edges = follow_edges([trace_bridge(a, b, crossing) for a, b in pairs], rings)
            if all(have_edges):
                for a, b in pairs:
                    a.mate, b.mate = b, a
                return


def find_forks(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Part lines of two limbs that turn sharply next to a third limb.

    The arm and the leg of a k before their short bar are an example. The line is parted where it leaves more of the
    shape bare than two limbs that run straight on.
    """
    forks = []
    for crossing in crossings:
        limbs = [arm for arm in crossing.arms if arm.mate is not None]
        if len(crossing.arms) == 3 and limbs and measure_turn(*limbs) > MAX_JOIN_TURN_RAD:
            forks.append((crossing, limbs))
    if not _is_affordable(len(forks), rings):
        return
    for crossing, limbs in forks:
        around = _find_places_in_shape(crossing, rings)
        find_ends([crossing], rings)
        bare_joined = _measure_bare_share(crossing, _trace_inner_lines(crossing), around)
        for arm in limbs:
            arm.mate = None
        find_ends([crossing], rings)
        if bare_joined < _measure_bare_share(crossing, _trace_inner_lines(crossing), around) + MIN_FORK_BARE_GAIN:
            limbs[0].mate, limbs[1].mate = limbs[1], limbs[0]
        for arm in crossing.arms:
            arm.lead = None


def find_ends(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Decide how the arms that end at crossings continue into them.

    Some arms have no space for their width up to the middle of the crossing, such as two limbs that meet next to a
    stem. They end before it if that leaves less of the shape bare than a line that narrows up to the middle.
    """
    short_leads = find_leads(crossings, rings)
    if not _is_affordable(sum(len(crossing.discs) for _, crossing, _ in short_leads), rings):
        return
    for arm, crossing, lead in short_leads:
        around = _find_places_in_shape(crossing, rings)
        bare_narrowed = _measure_bare_share(crossing, _trace_inner_lines(crossing), around)
        arm.lead = lead
        if _measure_bare_share(crossing, _trace_inner_lines(crossing), around) + MIN_BARE_GAIN > bare_narrowed:
            arm.lead = None


def _is_affordable(discs: int, rings: list[np.ndarray]) -> bool:
    return discs * len(_FINE_GRID) * sum(map(len, rings)) < _MAX_QUERIES


def _find_places_in_shape(crossing: Crossing, rings: list[np.ndarray]) -> np.ndarray:
    """Return the places around a crossing that are in the shape."""
    around = np.vstack([(x, y) + radius * _FINE_GRID for x, y, radius in crossing.discs])
    return around[is_within(around, rings)]


def _trace_inner_lines(crossing: Crossing) -> list[np.ndarray]:
    """Return the stretches of all lines inside a crossing, each as rows (k, 3)."""
    return [
        trace_stub(arm, crossing) if arm.mate is None else trace_bridge(arm, arm.mate, crossing)
        for arm in crossing.arms
    ]


def find_bars(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Find how far bars run beyond the stem at which they end.

    The shape continues a little on the far side of the stem, too little for a branch of its own, as at the bars of
    t and f. Sets `beyond_mm` of the arms, measured from the middle of the crossing.
    """
    ending = [
        (a, c) for c in crossings if not c.is_corner for a in c.arms if a.mate is None and _meets_line_across(a, c)
    ]
    if not ending:
        return
    halves = np.array([arm.line[arm.out, 2] for arm, _ in ending])
    backs = np.array([-arm.direction for arm, _ in ending])
    lefts = np.column_stack([-backs[:, 1], backs[:, 0]])
    middles = np.array([extend_to_middle(arm, crossing) for arm, crossing in ending])
    at = middles[:, None] + (halves[:, None] * BAR_PROBE_OFFSETS)[..., None] * lefts[:, None]
    ways = np.repeat(backs, len(BAR_PROBE_OFFSETS), axis=0)
    reached = np.array(_core.first_crossings(rings, at.reshape(-1, 2), ways)).reshape(len(ending), -1)
    stem = reached[:, [0, -1]].max(axis=1)  # the far side of the stem, next to the bar
    sticks_out = (reached[:, 1:-1] > (stem + MIN_BEYOND_SIDES * halves)[:, None]).all(axis=1)
    sticks_out &= (reached[:, 2] > stem + MIN_BEYOND * halves) & (reached[:, 2] < stem + MAX_BEYOND * halves)
    rooms = np.array(_core.clearance(rings, at[:, [0, -1]].reshape(-1, 2))).reshape(-1, 2)
    sticks_out &= (rooms > MIN_IN_STEM * halves[:, None]).all(axis=1)
    sticks_out &= np.ptp(np.nan_to_num(reached[:, [0, -1]], posinf=np.finfo(float).max), axis=1) < MAX_SLANT * halves
    for k in np.flatnonzero(sticks_out).tolist():
        ending[k][0].beyond_mm = max(float(reached[k, 2] - halves[k]), 0.0)


def _meets_line_across(bar: Arm, crossing: Crossing) -> bool:
    """Return whether a line runs through a crossing and across a bar's direction.

    Where the bar meets the outside of the line's elbow, as at the fork of a Y, the shape beyond it belongs to the
    line's own legs.
    """
    for arm in crossing.arms:
        if arm.mate is not None:
            along = arm.mate.line[arm.mate.out, :2] - arm.line[arm.out, :2]
            is_across = abs(along @ bar.direction) < MAX_BAR_COS * np.hypot(*along)
            if is_across and (arm.direction + arm.mate.direction) @ bar.direction > -MIN_ELBOW_SUM:
                return True
    return False


STRAIGHT_ROWS = 5  # rows of a straight way to where a line begins


def trace_straight(end_mm: np.ndarray, half_mm: float, start: np.ndarray) -> np.ndarray:
    """Return rows from a place up to a row of a line, which is left out.

    end_mm, half_mm: the place and the half width there; start: the row (3,) of the line.
    """
    t = np.linspace(0, 1, STRAIGHT_ROWS + 1)[:-1, None]
    return np.column_stack([end_mm + t * (start[:2] - end_mm), half_mm + t[:, 0] * (start[2] - half_mm)])


def find_corners(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Find where the arms of each corner begin.

    Each arm begins straight on, on its own line, as far as the shape has room for the brush. If that leaves a notch
    between the arms, both begin where their lines meet, or as near to that place as there is room. If both
    arms become one stroke, it turns there too.
    """
    corners = [crossing for crossing in crossings if crossing.is_corner]
    ways = [way for crossing in corners for way in _find_probe_ways(crossing)]
    places = np.array([tail + np.linspace(0, 1, _PROBE_COUNT)[:, None] * by for tail, by in ways])
    around = np.array([disc[:2] + disc[2] * _COARSE_GRID for disc in (crossing.discs[0] for crossing in corners)])
    rooms = np.reshape(_core.clearance(rings, np.reshape(places, (-1, 2))), (-1, 3, _PROBE_COUNT))
    reach_mm = np.reshape([np.hypot(*by) for _, by in ways], (-1, 3))[:, 1:].ravel()
    find_bent_ends(corners, reach_mm, rings)
    for k, (crossing, along) in enumerate(zip(corners, np.reshape(places, (-1, 3, _PROBE_COUNT, 2)), strict=True)):
        disc = crossing.discs[0, 2]
        widths = [arm.line[arm.out, 2] for arm in crossing.arms]
        meet = _find_farthest_clear(along[0], rooms[k, 0], max(widths), disc) or (crossing.discs[0, :2], disc)
        own_ends = [
            _find_farthest_clear(
                along[n],
                rooms[k, n],
                widths[n - 1],
                disc,
                MIN_CLEARANCE_IN_HUMP if crossing.has_hump and widths[n - 1] == max(widths) else MIN_CLEARANCE,
            )
            or meet
            for n in (1, 2)
        ]
        bare = [
            _measure_bare_share(
                crossing,
                [trace_straight(*end, arm.line[arm.out]) for arm, end in zip(crossing.arms, ends, strict=True)],
                around[k],
            )
            for ends in (own_ends, [meet, meet])
        ]
        crossing.corner = meet
        for arm, end in zip(
            crossing.arms, own_ends if bare[0] < bare[1] + MIN_BARE_GAIN else [meet, meet], strict=True
        ):
            arm.corner = end
        onward = [
            arm.lead if arm.lead is not None else trace_straight(*end, arm.line[arm.out])
            for arm, end in zip(crossing.arms, own_ends, strict=True)
        ]
        _choose_bent_ways(crossing, around[k], min(bare))
        if _is_affordable(len(corners), rings):
            _begin_wide_arm_in_disc(crossing, onward, around[k], rings)


def _begin_wide_arm_in_disc(
    crossing: Crossing, ways: list[np.ndarray], around: np.ndarray, rings: list[np.ndarray]
) -> None:
    """Let the wide arm of a corner begin in its disc if that leaves less bare.

    The wide arm begins as wide as the disc, the thin one runs on, and the two become two strokes. An example is the
    e of a bold serif, whose bowl widens towards a thin bar.
    """
    thin, wide = sorted((0, 1), key=lambda n: float(crossing.arms[n].line[crossing.arms[n].out, 2]))
    thin_arm, wide_arm = crossing.arms[thin], crossing.arms[wide]
    is_unlike = thin_arm.line[thin_arm.out, 2] < UNLIKE_WIDTH_RATIO * wide_arm.line[wide_arm.out, 2]
    if (
        not is_unlike
        or crossing.dropped < MIN_STEM_END
        or crossing.discs[0, 2] < MIN_BELLY_RATIO * wide_arm.line[wide_arm.out, 2]
    ):
        return
    around = around[is_within(around, rings)]
    into = trace_straight(crossing.discs[0, :2], float(crossing.discs[0, 2]), wide_arm.line[wide_arm.out])
    chosen = [trace_stub(arm, crossing) for arm in crossing.arms]
    if _measure_bare_share(crossing, [ways[thin], into], around) + MIN_BARE_GAIN < _measure_bare_share(
        crossing, chosen, around
    ):
        thin_arm.lead, wide_arm.lead, crossing.has_tip = ways[thin], into, True


def _choose_bent_ways(crossing: Crossing, around: np.ndarray, most_bare: float) -> None:
    """Keep the ways of arms along bent edges if they leave less of the shape bare.

    A stroke of both arms turns at the end of the arm that bends, or where both ways meet.
    """
    with_lead = [arm for arm in crossing.arms if arm.lead is not None]
    thin, wide = sorted(arm.line[arm.out, 2] for arm in crossing.arms)
    stubs = [trace_stub(arm, crossing) for arm in crossing.arms]
    if with_lead and (thin < UNLIKE_WIDTH_RATIO * wide or _measure_bare_share(crossing, stubs, around) >= most_bare):
        for arm in with_lead:
            arm.lead = None
    elif len(with_lead) == 1:
        if with_lead[0].line[with_lead[0].out, 2] > MIN_BENT_WIDTH_RATIO * max(
            arm.line[arm.out, 2] for arm in crossing.arms
        ):
            crossing.corner = with_lead[0].lead[0, :2], float(with_lead[0].lead[0, 2])
            crossing.is_on_lead = True
        else:
            with_lead[0].lead = None
    elif len(with_lead) == 2 and crossing.dropped < MAX_DROPPED_STEM_END:
        thin, wide = (arm.lead for arm in sorted(with_lead, key=lambda arm: arm.line[arm.out, 2]))
        distances = np.hypot(*(thin[:, None, :2] - wide[None, :, :2]).transpose(2, 0, 1))
        i, j = np.unravel_index(distances.argmin(), distances.shape)
        if distances[i, j] < MAX_MEETING_DISTANCE * wide[j, 2]:
            crossing.corner = thin[i, :2], float(min(thin[i, 2], wide[j, 2]))
            crossing.is_on_lead = True


def _measure_bare_share(crossing: Crossing, stubs: list[np.ndarray], around: np.ndarray) -> float:
    """Return the share of places around (n, 2) that a crossing's arms, rows of stubs, leave bare."""
    discs = np.vstack([*stubs, *(arm.line[arm.out :][:STRAIGHT_ROWS] for arm in crossing.arms)])
    distances = np.hypot(*(around[:, None] - discs[None, :, :2]).transpose(2, 0, 1))
    return float((distances > discs[:, 2]).all(axis=1).mean()) if len(around) else 0.0


def _find_farthest_clear(
    along: np.ndarray, room: np.ndarray, wide: float, disc: float, least: float = MIN_CLEARANCE
) -> tuple[np.ndarray, float] | None:
    """Return the last place with enough clearance, and the half width there.

    Enough is the share `least` of the half width `wide`, or of the disc where that is smaller. None if no place has
    it.
    """
    last = int(np.logical_and.accumulate(room >= least * min(wide, disc)).sum()) - 1
    return (along[last], min(float(room[last]), 1.2 * wide)) if last >= 0 else None


def _find_probe_ways(crossing: Crossing) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return start and vector of three ways that are probed for room at a corner.

    The first runs from the corner's disc to where the lines of its arms meet. The others run from the beginning of
    each arm beyond that place.
    """
    (p, back), (q, d) = ((arm.line[arm.out, :2], -arm.direction) for arm in crossing.arms)
    centre, radius = crossing.discs[0, :2], crossing.discs[0, 2]
    cross = back[0] * d[1] - back[1] * d[0]
    # Parallel arms are one line, or a line there and back. Arms that meet ahead enclose a counter, as in a bold 4.
    meet = centre
    if abs(cross) >= 0.2:
        crossed = p + ((q - p)[0] * d[1] - (q - p)[1] * d[0]) / cross * back
        if max((crossed - p) @ back, (crossed - q) @ d) > 0:
            meet = crossed
    ray = meet - centre
    return [
        (centre, ray * min(1.0, 1.5 * radius / max(np.hypot(*ray), 1e-9))),
        *((at, np.clip((meet - at) @ way + radius, 0, 3 * radius) * way) for at, way in ((p, back), (q, d))),
    ]
