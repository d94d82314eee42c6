"""Next to a junction the medial axis is not that of a line: it bends and widens towards the junction's disc. What goes
on there is the outline on one side. A line that passes a junction keeps its distance from that edge; one that ends
there runs on along it, with the width that it had."""

from __future__ import annotations

import numpy as np

from ... import _core
from .junctions import STEM_END, Arm, Crossing

# Arms times points of the outline: letters have some thousands, Chinese characters a hundred thousand.
MOST = 3_000_000
# How far an edge may be off a line's half width, next to a junction that it passes, and be its edge still: an arm that
# leaves there is wider. In its half widths.
OWN = 0.3
WAVES_RAD = np.radians(20)  # an edge along which a line would turn by so much more has a corner
STEPS = 16  # on the way of a line into a junction
# An edge that leaves a step's way by more is lost, in lengths of it: at a corner of the outline, where an arm leaves.
# The first step is that of the axis, which may be slanted.
FIRST, BENDS = 1.0, 0.5
NEAR = 0.25  # half widths over which the axis has its direction
LASTS = 0.6  # half widths for which an edge has to last, or the line runs straight on
STRAIGHTER = 0.5  # of the turn of one edge: an edge on the other side that turns by less is the line's
MOST_TURN = np.radians(60)  # in all: more is the foot of an arch, which leads back along the stem
AT_END = -0.7  # half width won per length where a limb ends: there its line does
AS_STRAIGHT = np.cos(np.radians(2))  # a way that bends by less is left to what finds straight ones
WIDER = 1.25  # than the line in which it ends
# Shares of the half width: what room there must be for it on the way, and how far it may stick out of what covers it.
MIN_SPACE, COVERED = 0.85, 0.05


def can_follow(arms: int, rings: list[np.ndarray]) -> bool:
    return arms * sum(map(len, rings)) < MOST


def follow_edges(lines: list[np.ndarray], rings: list[np.ndarray]) -> tuple[list[np.ndarray], list[bool]]:
    """Stretches of lines through junctions, rows (k, 3), each moved so that it keeps its half width from the one edge
    of the shape that continues along it, and which have one; as they are where there is none or one on both sides."""
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
            is_edge = (np.abs(off) < OWN * line[:, 2]).all(axis=1)
            has_edge[n] = is_edge.sum() == 1
            if has_edge[n]:
                side = int(is_edge.argmax())
                on_edge = line.copy()
                on_edge[:, :2] += (off[side] * (1, -1)[side])[:, None] * left
                has_edge[n] = _turned(on_edge) < _turned(line) + WAVES_RAD
                line = on_edge if has_edge[n] else line
            moved.append(line)
        lines = moved
    return lines, has_edge


def _directions(line: np.ndarray) -> np.ndarray:
    steps = np.gradient(line[:, :2], axis=0)
    return steps / np.maximum(np.hypot(*steps.T), 1e-12)[:, None]


def _turned(line: np.ndarray) -> float:
    """How much a line turns, to either side, in all."""
    steps = np.diff(line[:, :2], axis=0)
    cross = steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0]
    return float(np.abs(np.arctan2(cross, (steps[:-1] * steps[1:]).sum(axis=1))).sum())


def _left_of(ways: np.ndarray) -> np.ndarray:
    return np.stack([-ways[..., 1], ways[..., 0]], axis=-1)


def ways_on(
    starts: np.ndarray, ahead: np.ndarray, tangents: np.ndarray, reach_mm: np.ndarray, rings: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """How lines go on: places (n, STEPS + 1, 2) from their starts on, and for how long [mm] each follows an edge.
    starts: (n, 3) rows of lines; ahead: their directions, tangents: those of the axis right there. A line follows an
    edge that lasts on one side alone, or turns less by far than that on the other; else it is straight."""
    n = len(starts)
    here, way = np.tile(starts[:, :2], (2, 1)), np.tile(tangents, (2, 1))
    half, step = np.tile(starts[:, 2], 2), np.tile(reach_mm / STEPS, 2)
    side = np.repeat([1.0, -1.0], n)
    is_followed, lasted = np.ones(2 * n, bool), np.zeros(2 * n)
    places = [here]
    for _ in range(STEPS):
        left = side[:, None] * _left_of(way)
        place = here + step[:, None] * way
        off = np.array(_core.first_crossings(rings, place, left)) - half
        is_followed &= np.abs(off) < (BENDS if len(places) > 1 else FIRST) * step
        lasted += step * is_followed
        place = place + np.where(is_followed, off, 0.0)[:, None] * left
        moved = place - here
        way = np.where(is_followed[:, None], moved / np.maximum(np.hypot(*moved.T), 1e-12)[:, None], way)
        turned = np.arccos(np.clip((way * np.tile(tangents, (2, 1))).sum(axis=1), -1, 1))
        is_followed &= turned < MOST_TURN
        here = place
        places.append(here)
    bent = np.stack(places, axis=1).reshape(2, n, STEPS + 1, 2)
    lasts = (lasted > LASTS * half).reshape(2, n)
    straight = starts[:, None, :2] + (np.arange(STEPS + 1) * step[:n, None])[..., None] * ahead[:, None]
    turned = np.where(lasts, turned.reshape(2, n), np.inf)
    follows = lasts.any(axis=0) & (turned.min(axis=0) < STRAIGHTER * turned.max(axis=0))
    bent = bent[turned.argmin(axis=0), np.arange(n)]
    lasted = np.where(follows, lasted.reshape(2, n)[turned.argmin(axis=0), np.arange(n)], 0.0)
    return np.where(follows[:, None, None], bent, straight), lasted


def amid(arm: Arm, crossing: Crossing) -> np.ndarray:
    """Continue straight along an arm, up to the middle of its crossing."""
    start, back = arm.line[arm.out, :2], -arm.direction
    return start + max(float((crossing.discs[:, :2].mean(axis=0) - start) @ back), 0.0) * back


def find_ways_in(
    crossings: list[Crossing], rings: list[np.ndarray]
) -> list[tuple[Arm, Crossing, np.ndarray]]:
    """How the arms that end at crossings run on into them, amid them at least: with the width they have, until lines
    that run through cover them, as far as the shape has room for it. Returns those without room up to the middle, where
    a line runs through, with their ways as far as they have room."""
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
    to_mid = np.array([np.hypot(*amid(arm, crossing) - arm.line[arm.out, :2]) for arm, crossing in ending])
    reach_mm = to_mid + np.array(
        [np.hypot(*np.ptp(c.discs[:, :2], axis=0)) + c.discs[:, 2].max() for _, c in ending]
    )
    tangents = np.array([_tangent(arm) for arm, _ in ending])
    places, _ = ways_on(starts, ahead, tangents, reach_mm, rings)
    rooms = np.array(_core.clearance(rings, places.reshape(-1, 2))).reshape(len(ending), -1)
    short = []
    for k, (arm, crossing) in enumerate(ending):
        half = starts[k, 2]
        last = int(np.logical_and.accumulate(rooms[k] >= MIN_SPACE * half).sum()) - 1
        mid = min(round(to_mid[k] / reach_mm[k] * STEPS), STEPS)
        through = _through(crossing)
        covering = np.vstack([through, *(_beginning(leg) for leg in crossing.neighbours)])
        end = min(mid + _covered_at(places[k, mid:], half, covering), last)
        if end <= 0 or (len(through) and half > WIDER * through[:, 2].max()):
            continue  # no room for its width, or a stem that ends in a thin bar: narrowed
        way = places[k, : end + 1]
        widths = np.minimum(rooms[k, : len(way)], half)
        lead = np.column_stack([way, widths])[:0:-1]
        if last >= mid:
            arm.lead = lead
        elif len(through):
            short.append((arm, crossing, lead))
    return short


def find_bent_ends(corners: list[Crossing], reach_mm: np.ndarray, rings: list[np.ndarray]) -> None:
    """Arms whose edge bends as they run into a corner, as the bowl of an e into its bar: along the edge up to the
    middle of the other arm, or into the end of a stem, as far as there is room. reach_mm: of each arm, in order."""
    arms = [arm for corner in corners for arm in corner.arms]
    if not arms or not can_follow(len(arms), rings):
        return
    longest_mm = [3 * corner.discs[0, 2] if corner.dropped > STEM_END else 0.0 for corner in corners]
    reach_mm = np.maximum(reach_mm, np.repeat(longest_mm, 2))
    starts = np.array([arm.line[arm.out] for arm in arms])
    ahead = np.array([-arm.direction for arm in arms])
    places, lasted = ways_on(starts, ahead, np.array([_tangent(arm) for arm in arms]), reach_mm, rings)
    at, finer = np.arange(STEPS + 1), np.linspace(0, STEPS, 8 * STEPS + 1)
    for k, corner in enumerate(corners):
        one, other = corner.arms
        leads, are_bent = {}, []
        for n, past in ((2 * k, other), (2 * k + 1, one)):
            if not lasted[n]:
                continue
            way = np.column_stack([np.interp(finer, at, column) for column in places[n].T])
            rooms, half = np.array(_core.clearance(rings, way)), starts[n, 2]
            to_axis = (way - past.line[past.out, :2]) @ _left_of(past.direction)
            is_on = (rooms >= MIN_SPACE * half) & ((to_axis * to_axis[0] > 0) | (corner.dropped > STEM_END))
            is_on &= finer <= lasted[n] / reach_mm[n] * STEPS
            if corner.dropped > STEM_END:
                is_on &= (rooms >= half) | (np.gradient(rooms, reach_mm[n] / (len(way) - 1)) > AT_END)
            way = way[: int(np.logical_and.accumulate(is_on).sum())]
            if len(way) < 6:
                continue
            onward = way[-1] - way[0]
            is_bent = onward @ ahead[n] < AS_STRAIGHT * np.hypot(*onward)
            if is_bent or corner.dropped > STEM_END:
                leads[n] = np.column_stack([way, np.minimum(rooms[: len(way)], half)])[:0:-4]
                are_bent.append(is_bent)
        if any(are_bent) and len(corner.discs) == 1:
            for n, lead in leads.items():
                arms[n].lead = lead


def _tangent(arm: Arm) -> np.ndarray:
    """The direction of the axis where an arm meets its crossing, into it."""
    here = arm.line[arm.out]
    rows = arm.line[arm.out :]
    is_beyond = np.hypot(*(rows[:, :2] - here[:2]).T) > NEAR * here[2]
    step = here[:2] - rows[is_beyond.argmax() if is_beyond.any() else -1, :2]
    return step / np.hypot(*step) if step.any() else -arm.direction


def _through(crossing: Crossing) -> np.ndarray:
    """Rows of the lines that run through a crossing."""
    rows = [
        part
        for arm in crossing.arms
        if arm.mate is not None
        for part in (arm.line[arm.out :][:STEPS], *([] if arm.bridge is None else [arm.bridge]))
    ]
    return np.vstack([_finer(part) for part in rows]) if rows else np.empty((0, 3))


def _beginning(arm: Arm) -> np.ndarray:
    """Rows of the line that begins at a corner."""
    begins = [] if arm.corner is None else [[*arm.corner[0], arm.corner[1]]]
    return _finer(np.vstack([*begins, arm.line[arm.out :][:STEPS]]))


def _finer(rows: np.ndarray) -> np.ndarray:
    at = np.linspace(0, len(rows) - 1, 4 * len(rows))
    return np.column_stack([np.interp(at, np.arange(len(rows)), column) for column in rows.T])


def _covered_at(places: np.ndarray, half: float, discs: np.ndarray) -> int:
    """The first of places on a line at which discs cover it, or where it is nearest to their middles."""
    if not len(discs):
        return 0
    off = np.hypot(*(places[:, None] - discs[None, :, :2]).transpose(2, 0, 1))
    is_covered = (off + half < discs[:, 2] + COVERED * half).any(axis=1)
    return int(is_covered.argmax() if is_covered.any() else off.min(axis=1).argmin())
