"""Edges of the shape that lines follow next to junctions.

Next to a junction, the medial axis is not that of a line: it bends and widens towards the junction's disc. What
continues there is the outline on one side. A line that passes a junction keeps its distance from that edge. A line
that ends there runs on along the edge, with the width that it had.
"""

from __future__ import annotations

import numpy as np

from ... import _core
from .junctions import MIN_STEM_END, Arm, Crossing

# Arms times points of the outline: letters have some thousands, Chinese characters a hundred thousand.
MAX_ARMS_TIMES_POINTS = 3_000_000
# How far an edge may be off a line's half width next to a junction and still belong to the line, in its half
# widths. An edge that is further off belongs to an arm that leaves there.
MAX_EDGE_DEVIATION = 0.3
# An edge along which a line would turn by this much more has a corner.
MAX_EXTRA_TURN_RAD = np.radians(20)
STEP_COUNT = 16  # steps on the way of a line into a junction
# How far an edge may leave the direction of a step, in step lengths. It leaves by more at a corner of the outline,
# where an arm leaves. The first step has the direction of the axis, which may be slanted.
MAX_FIRST_DEVIATION, MAX_STEP_DEVIATION = 1.0, 0.5
TANGENT_REACH = 0.25  # half widths over which the direction of the axis is measured
# Half widths for which an edge has to last. Otherwise the line runs straight on.
MIN_EDGE_LENGTH = 0.6
# A line follows the edge that turns by less than this share of the turn of the edge on the other side.
MAX_TURN_RATIO = 0.5
# Turn along a followed edge. More is the foot of an arch, which returns along the stem.
MAX_TURN_RAD = np.radians(60)
# Change of clearance per length. A limb ends where its clearance falls faster, and the line ends there too.
MIN_CLEARANCE_SLOPE = -0.7
# Cosine of a bend. A way that bends by less is left to the code for straight ways.
STRAIGHT_COS = np.cos(np.radians(2))
# A line that is wider than the line in which it ends by this factor is narrowed.
MAX_WIDTH_RATIO = 1.25
# Shares of the half width: the clearance that a line needs on its way, and how far it may stick out of the discs
# that cover it.
MIN_CLEARANCE, MAX_OVERHANG = 0.85, 0.05


def can_follow(arms: int, rings: list[np.ndarray]) -> bool:
    return arms * sum(map(len, rings)) < MAX_ARMS_TIMES_POINTS


def follow_edges(lines: list[np.ndarray], rings: list[np.ndarray]) -> tuple[list[np.ndarray], list[bool]]:
    """Move lines that pass junctions so that they keep their distance from an edge.

    lines: rows (k, 3) of the stretches of lines through junctions. Each is moved so that it keeps its half width
    from the one edge of the shape that continues along it. A line without such an edge, or with one on both sides,
    stays as it is. Returns the lines, and whether each has an edge.
    """
    has_edge = [False] * len(lines)
    for _ in range(2):
        lefts = [_left_of(_directions(line)) for line in lines]
        sides = np.vstack([side * left for left in lefts for side in (1, -1)])
        places = np.vstack([line[:, :2] for line in lines for _ in (1, -1)])
        reached = np.array(_core.first_crossings(rings, places, sides))
        moved, at = [], 0
        for n, (line, left) in enumerate(zip(lines, lefts, strict=True)):
            k = len(line)
            off = reached[at : at + 2 * k].reshape(2, k) - line[:, 2]
            at += 2 * k
            is_edge = (np.abs(off) < MAX_EDGE_DEVIATION * line[:, 2]).all(axis=1)
            has_edge[n] = is_edge.sum() == 1
            if has_edge[n]:
                side = int(is_edge.argmax())
                on_edge = line.copy()
                on_edge[:, :2] += (off[side] * (1, -1)[side])[:, None] * left
                has_edge[n] = _measure_total_turn(on_edge) < _measure_total_turn(line) + MAX_EXTRA_TURN_RAD
                line = on_edge if has_edge[n] else line
            moved.append(line)
        lines = moved
    return lines, has_edge


def _directions(line: np.ndarray) -> np.ndarray:
    steps = np.gradient(line[:, :2], axis=0)
    return steps / np.maximum(np.hypot(*steps.T), 1e-12)[:, None]


def _measure_total_turn(line: np.ndarray) -> float:
    """Return how far a line turns in all [rad], to either side."""
    steps = np.diff(line[:, :2], axis=0)
    cross = steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0]
    return float(np.abs(np.arctan2(cross, (steps[:-1] * steps[1:]).sum(axis=1))).sum())


def _left_of(ways: np.ndarray) -> np.ndarray:
    return np.stack([-ways[..., 1], ways[..., 0]], axis=-1)


def continue_lines(
    starts: np.ndarray, ahead: np.ndarray, tangents: np.ndarray, reach_mm: np.ndarray, rings: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Continue lines from their starts, along an edge of the shape or straight on.

    starts: (n, 3) rows of lines; ahead: (n, 2), their directions; tangents: (n, 2), the directions of the axis
    right there; reach_mm: (n,), how far to go. A line follows an edge that lasts on one side alone, or that turns
    far less than the one on the other side. Otherwise it is straight. Returns places (n, STEP_COUNT + 1, 2) and the
    length [mm], (n,), over which each line follows an edge.
    """
    n = len(starts)
    here, way = np.tile(starts[:, :2], (2, 1)), np.tile(tangents, (2, 1))
    half, step = np.tile(starts[:, 2], 2), np.tile(reach_mm / STEP_COUNT, 2)
    side = np.repeat([1.0, -1.0], n)
    is_followed, lasted = np.ones(2 * n, bool), np.zeros(2 * n)
    places = [here]
    for _ in range(STEP_COUNT):
        left = side[:, None] * _left_of(way)
        place = here + step[:, None] * way
        off = np.array(_core.first_crossings(rings, place, left)) - half
        is_followed &= np.abs(off) < (MAX_STEP_DEVIATION if len(places) > 1 else MAX_FIRST_DEVIATION) * step
        lasted += step * is_followed
        place = place + np.where(is_followed, off, 0.0)[:, None] * left
        moved = place - here
        way = np.where(is_followed[:, None], moved / np.maximum(np.hypot(*moved.T), 1e-12)[:, None], way)
        turned = np.arccos(np.clip((way * np.tile(tangents, (2, 1))).sum(axis=1), -1, 1))
        is_followed &= turned < MAX_TURN_RAD
        here = place
        places.append(here)
    bent = np.stack(places, axis=1).reshape(2, n, STEP_COUNT + 1, 2)
    lasts = (lasted > MIN_EDGE_LENGTH * half).reshape(2, n)
    straight = starts[:, None, :2] + (np.arange(STEP_COUNT + 1) * step[:n, None])[..., None] * ahead[:, None]
    turned = np.where(lasts, turned.reshape(2, n), np.inf)
    follows = lasts.any(axis=0) & (turned.min(axis=0) < MAX_TURN_RATIO * turned.max(axis=0))
    bent = bent[turned.argmin(axis=0), np.arange(n)]
    lasted = np.where(follows, lasted.reshape(2, n)[turned.argmin(axis=0), np.arange(n)], 0.0)
    return np.where(follows[:, None, None], bent, straight), lasted


def extend_to_middle(arm: Arm, crossing: Crossing) -> np.ndarray:
    """Continue straight along an arm, up to the middle of its crossing."""
    start, back = arm.line[arm.out, :2], -arm.direction
    return start + max(float((crossing.discs[:, :2].mean(axis=0) - start) @ back), 0.0) * back


def find_leads(crossings: list[Crossing], rings: list[np.ndarray]) -> list[tuple[Arm, Crossing, np.ndarray]]:
    """Find how the arms that end at crossings run on into them.

    An arm runs on with the width that it has, at least up to the middle of the crossing, until lines that run
    through cover it. It goes only as far as the shape has room for it. Sets `lead` of the arms that reach the
    middle. Returns the other arms that end at a line running through, with their ways as far as there is room.
    """
    ending = [
        (arm, crossing)
        for crossing in crossings
        if not crossing.is_corner
        for arm in crossing.arms
        if arm.mate is None and arm.beyond_mm is None and arm.line[arm.out, 2] > 0
    ]
    if not ending or not can_follow(len(ending), rings):
        return []
    starts = np.array([arm.line[arm.out] for arm, _ in ending])
    ahead = np.array([-arm.direction for arm, _ in ending])
    to_mid = np.array([np.hypot(*extend_to_middle(arm, crossing) - arm.line[arm.out, :2]) for arm, crossing in ending])
    reach_mm = to_mid + np.array([np.hypot(*np.ptp(c.discs[:, :2], axis=0)) + c.discs[:, 2].max() for _, c in ending])
    tangents = np.array([_find_tangent(arm) for arm, _ in ending])
    places, _ = continue_lines(starts, ahead, tangents, reach_mm, rings)
    rooms = np.array(_core.clearance(rings, places.reshape(-1, 2))).reshape(len(ending), -1)
    short_leads = []
    for k, (arm, crossing) in enumerate(ending):
        half = starts[k, 2]
        last = int(np.logical_and.accumulate(rooms[k] >= MIN_CLEARANCE * half).sum()) - 1
        mid = min(round(to_mid[k] / reach_mm[k] * STEP_COUNT), STEP_COUNT)
        through = _collect_rows_through(crossing)
        covering = np.vstack([through, *(_take_first_rows(leg) for leg in crossing.neighbours)])
        end = min(mid + _find_covered_row(places[k, mid:], half, covering), last)
        if end <= 0 or (len(through) and half > MAX_WIDTH_RATIO * through[:, 2].max()):
            # no room for its width, or a stem that ends in a thin bar: the stem is narrowed
            continue
        way = places[k, : end + 1]
        widths = np.minimum(rooms[k, : len(way)], half)
        lead = np.column_stack([way, widths])[:0:-1]
        if last >= mid:
            arm.lead = lead
        elif len(through):
            short_leads.append((arm, crossing, lead))
    return short_leads


def find_bent_ends(corners: list[Crossing], reach_mm: np.ndarray, rings: list[np.ndarray]) -> None:
    """Find the ways of arms whose edge bends as they run into a corner.

    The bowl of an e, where it runs into the bar, is an example. The way follows the edge up to the middle of the
    other arm, or into the end of a stem, as far as there is room. reach_mm: how far each arm goes, in order.
    """
    arms = [arm for corner in corners for arm in corner.arms]
    if not arms or not can_follow(len(arms), rings):
        return
    longest_mm = [3 * corner.discs[0, 2] if corner.dropped > MIN_STEM_END else 0.0 for corner in corners]
    reach_mm = np.maximum(reach_mm, np.repeat(longest_mm, 2))
    starts = np.array([arm.line[arm.out] for arm in arms])
    ahead = np.array([-arm.direction for arm in arms])
    places, lasted = continue_lines(starts, ahead, np.array([_find_tangent(arm) for arm in arms]), reach_mm, rings)
    at, finer = np.arange(STEP_COUNT + 1), np.linspace(0, STEP_COUNT, 8 * STEP_COUNT + 1)
    for k, corner in enumerate(corners):
        first_arm, second_arm = corner.arms
        leads, are_bent = {}, []
        for n, other_arm in ((2 * k, second_arm), (2 * k + 1, first_arm)):
            if not lasted[n]:
                continue
            way = np.column_stack([np.interp(finer, at, column) for column in places[n].T])
            rooms, half = np.array(_core.clearance(rings, way)), starts[n, 2]
            to_axis = (way - other_arm.line[other_arm.out, :2]) @ _left_of(other_arm.direction)
            is_on = (rooms >= MIN_CLEARANCE * half) & ((to_axis * to_axis[0] > 0) | (corner.dropped > MIN_STEM_END))
            is_on &= finer <= lasted[n] / reach_mm[n] * STEP_COUNT
            if corner.dropped > MIN_STEM_END:
                is_on &= (rooms >= half) | (np.gradient(rooms, reach_mm[n] / (len(way) - 1)) > MIN_CLEARANCE_SLOPE)
            way = way[: int(np.logical_and.accumulate(is_on).sum())]
            if len(way) < 6:
                continue
            onward = way[-1] - way[0]
            is_bent = onward @ ahead[n] < STRAIGHT_COS * np.hypot(*onward)
            if is_bent or corner.dropped > MIN_STEM_END:
                leads[n] = np.column_stack([way, np.minimum(rooms[: len(way)], half)])[:0:-4]
                are_bent.append(is_bent)
        if any(are_bent) and len(corner.discs) == 1:
            for n, lead in leads.items():
                arms[n].lead = lead


def _find_tangent(arm: Arm) -> np.ndarray:
    """Return the direction of the axis where an arm meets its crossing, into it."""
    here = arm.line[arm.out]
    rows = arm.line[arm.out :]
    is_beyond = np.hypot(*(rows[:, :2] - here[:2]).T) > TANGENT_REACH * here[2]
    step = here[:2] - rows[is_beyond.argmax() if is_beyond.any() else -1, :2]
    return step / np.hypot(*step) if step.any() else -arm.direction


def _collect_rows_through(crossing: Crossing) -> np.ndarray:
    """Return rows of the lines that run through a crossing."""
    rows = [
        part
        for arm in crossing.arms
        if arm.mate is not None
        for part in (arm.line[arm.out :][:STEP_COUNT], *([] if arm.bridge is None else [arm.bridge]))
    ]
    return np.vstack([_refine_rows(part) for part in rows]) if rows else np.empty((0, 3))


def _take_first_rows(arm: Arm) -> np.ndarray:
    """Return the first rows of the line that begins at a corner."""
    begins = [] if arm.corner is None else [[*arm.corner[0], arm.corner[1]]]
    return _refine_rows(np.vstack([*begins, arm.line[arm.out :][:STEP_COUNT]]))


def _refine_rows(rows: np.ndarray) -> np.ndarray:
    at = np.linspace(0, len(rows) - 1, 4 * len(rows))
    return np.column_stack([np.interp(at, np.arange(len(rows)), column) for column in rows.T])


def _find_covered_row(places: np.ndarray, half: float, discs: np.ndarray) -> int:
    """Return where discs first cover a line, or the place nearest to the middle of a disc."""
    if not len(discs):
        return 0
    distances = np.hypot(*(places[:, None] - discs[None, :, :2]).transpose(2, 0, 1))
    is_covered = (distances + half < discs[:, 2] + MAX_OVERHANG * half).any(axis=1)
    return int(is_covered.argmax() if is_covered.any() else distances.min(axis=1).argmin())
