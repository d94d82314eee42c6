"""A program that was read, held against the plan that it should paint."""

from __future__ import annotations

import bisect
import math

import numpy as np

from ..errors import Error, Notice
from ..machine.cells.cell import (
    Cell,
    ends_rounded_mm,
    least_move_mm,
    servo_parts,
    servo_stands,
    unit_mm,
    value_mm,
)
from ..machine.paint_reload import PlanInLoads, visits
from ..machine.posts.text import spelled
from ..machine.realised.rounding import steep_ways_lifted
from ..machine.tool_axes import axes_of, between_deg, mixed, tilts_deg
from .simulate_program import Problems, Ran, chords, slack_mm

STRAY_MM = 0.02  # what rounding and the chords of circles make of a path; a brush does not show it


def with_plan(
    ran: Ran, expected: PlanInLoads, cell: Cell, first_stroke: int = 1
) -> tuple[list[int | None], Problems]:
    """Return for each pass that was read its load (None: none), and a notice for each pass that is missing, in another
    order, elsewhere, at another speed or with other paint.

    Passes before the program's first stroke were painted before. Error when the plan has no such stroke.
    """
    first, count = first_stroke, len(expected.loads)
    if first > count:
        raise Error(
            f"the program goes on with stroke {first}, the drawing has strokes 1 to {count}",
            code="stroke-unknown",
        )
    due = expected.loads[first - 1 :]
    partners, problems = _partners(ran.plan.passes, due)
    rows = zip(ran.plan.passes, ran.lines, partners, strict=True)
    for a_pass, lines, k in rows:
        problems += _strayed(a_pass, lines, due[k], cell) if k is not None else []
    if not problems and len(ran.visits) == len(due):  # else a stroke is not one touch, which is reported
        planned_visits = visits(expected, cell, first)[first - 1 :] or ((),) * len(due)
        problems += _paint(ran, due, planned_visits)
    return [None if k is None else first - 1 + k for k in partners], problems


def _partners(passes, due) -> tuple[list[int | None], Problems]:
    """For each pass the number of the one of due that has its name, in order where there are several."""
    names = [spelled(a_pass.stroke).rstrip(" ") for a_pass in passes]
    required = [spelled(each.stroke) for each in due]
    if len(names) == len(required) and all(map(_same, names, required)):
        return list(range(len(due))), []
    left = dict(enumerate(required))
    by_name: dict[str, list[int]] = {}
    for number, name in reversed(left.items()):
        by_name.setdefault(name.rstrip(" "), []).append(number)
    partners: list[int | None] = []
    for name in names:
        numbers = by_name.get(name)
        number = numbers.pop() if numbers else next((k for k in left if _same(name, left[k])), None)
        if number is not None:
            left.pop(number, None)
            partners.append(number)
        else:
            partners.append(None)
    problems = [
        Notice(name, "the drawing has no such stroke", code="stroke-not-drawn")
        for name, k in zip(names, partners, strict=True)
        if k is None
    ]
    problems += [
        Notice(due[k].stroke, "the program does not paint this stroke", code="stroke-not-painted")
        for k in left
    ]
    found = [k for k in partners if k is not None]
    if not problems and found != sorted(found):
        at = next(place for place, k in enumerate(found) if k != place)
        sentence = f"it is painted where the drawing asks for {required[at]}"
        problems.append(Notice(names[at], sentence, code="stroke-order"))
    return partners, problems


def _same(written: str, name: str) -> bool:
    """Whether a name that was read is this one; long ones are cut in a program, blanks at the end are lost."""
    return written == name.rstrip(" ") or (written.endswith("...") and name.startswith(written[:-3]))


def _strayed(a_pass, lines: np.ndarray, planned, cell: Cell) -> Problems:
    """Where a pass that was read, its poses in these lines of the program, does not run where it should, in the order
    in which it should, or not as fast."""
    problems = _held_otherwise(a_pass, lines, planned)
    planned = steep_ways_lifted(planned, cell) if cell.servo else planned
    # where units are coarse, a pose gives way to one that is less than a move away
    limit_mm = max(STRAY_MM, slack_mm(cell), least_move_mm(cell) + unit_mm(cell))
    # a servo's height goes in steps of whole values, off the line by half of both; and a pose at the value of the
    # one before gives way to it, by which the line begins up to a value higher
    allowance_mm = (_step_mm(planned, cell) + 3 * value_mm(cell)) / 2 if cell.servo else 0.0
    steepness = limit_mm / (limit_mm + allowance_mm)
    if _pose_by_pose(a_pass, planned) > limit_mm:  # it may yet be the same path, with other poses on it
        (found, owner), (reference, _) = _round(a_pass), _round(planned)
        found, reference = found * (1, 1, steepness), reference * (1, 1, steepness)
        at = follows(found, reference, limit_mm)
        if at is not None:
            away_mm = max(_farthest(_along(found), reference), _farthest(_along(reference), found))
            sentence = f"line {lines[owner[min(at, len(owner) - 1)]]}: {_astray(away_mm, limit_mm)}"
            problems.append(Notice(a_pass.stroke, sentence, code="path-elsewhere"))
    is_dab = not np.ptp(planned.poses_mm[:, :2], axis=0).any()  # pressed on the spot, as slowly as a landing
    if a_pass.speed_mm_s > planned.speed_mm_s + 0.1 and not is_dab:
        requested = f"the drawing asks for {planned.speed_mm_s:.1f} mm/s"
        sentence = f"it is painted at {a_pass.speed_mm_s:.1f} mm/s, {requested}"
        problems.append(Notice(a_pass.stroke, sentence, code="stroke-too-fast"))
    return problems


def _step_mm(a_pass, cell: Cell) -> float:
    """The most that a servo's height changes by in one part of a way: a steep one has no room for more parts, and one
    whose ends were rounded to whole units may have room for fewer."""
    ways = np.diff(np.asarray(a_pass.poses_mm, dtype=float), axis=0)
    ways = ways[~servo_stands(ways, cell)]
    parts = servo_parts(ways, cell, -ends_rounded_mm(cell))
    return max(cell.servo.step_mm, float((np.abs(ways[:, 2]) / parts).max(initial=0.0)))


HELD_DEG = 0.5  # off the planned direction: a brush's mark does not show it


def _held_otherwise(a_pass, lines: np.ndarray, planned) -> Problems:
    """A notice where the brush of a pass that was read is tilted otherwise than it should: at the same pose, or, where
    a pass has others on its way, as far along it."""
    if not len(a_pass.tool_axes) and axes_of(planned) is None:
        return []
    found, reference = (_axes(each) for each in (a_pass, planned))
    if len(found) != len(reference):
        along, on = (_shares(np.asarray(each.poses_mm)) for each in (a_pass, planned))
        reference = mixed(reference, np.interp(along, on, np.arange(len(on))))
    off_deg = between_deg(found, reference)
    worst = int(off_deg.argmax())
    if off_deg[worst] <= HELD_DEG:
        return []
    sentence = (
        f"line {lines[worst]}: the brush is held {off_deg[worst]:.3g} degrees from how the drawing asks for it, by "
        f"{float(tilts_deg(reference[worst])):.3g} degrees from upright: it was changed, or made with other flags or "
        "of another drawing"
    )
    return [Notice(a_pass.stroke, sentence, code="held-otherwise")]


def _axes(a_pass) -> np.ndarray:
    axes = axes_of(a_pass)
    return np.tile((0.0, 0.0, 1.0), (len(a_pass.poses_mm), 1)) if axes is None else axes


def _shares(poses: np.ndarray) -> np.ndarray:
    """(n,) how far along a path each of its poses (n, 3) is, from 0 to 1."""
    along = np.cumsum(np.linalg.norm(np.diff(poses, axis=0, prepend=poses[:1]), axis=1))
    return along / max(along[-1], 1e-9)


def _astray(away_mm: float, limit_mm: float) -> str:
    changed = "it was changed, or made with other flags or of another drawing"
    if away_mm > limit_mm:
        return f"the program runs {away_mm:.2f} mm away from where the drawing asks it to: {changed}"
    return f"from here on the stroke is not painted once, from its start to its end, as the drawing asks: {changed}"


PLACES = 17  # along a circle, of which two are compared


def _pose_by_pose(a_pass, planned) -> float:
    """How far two passes are apart at most [mm], judged by their poses and circles one by one; inf where these do not
    belong to each other."""
    (ours, our_arcs), (theirs, their_arcs) = _corners(a_pass), _corners(planned)
    if len(ours) != len(theirs) or our_arcs.keys() != their_arcs.keys():
        return np.inf
    ends_mm = float(np.linalg.norm(ours - theirs, axis=1).max())
    away_mm = ends_mm
    for k, arc in our_arcs.items():
        if arc.direction != their_arcs[k].direction:
            return np.inf
        apart = _way_round(a_pass, arc) - _way_round(planned, their_arcs[k])
        away_mm = max(away_mm, float(np.hypot(*apart.T).max()))
    return away_mm


def _way_round(a_pass, arc) -> np.ndarray:
    """Places (n, 2) evenly along a circle from its first pose to its last. The centre of a flat one says little: where
    three of its places are rounded by a thousandth of a millimetre, it moves by a millimetre, and the way does not."""
    way = np.asarray(a_pass.poses_mm)[arc.first : arc.last + 1, :2] - arc.centre_mm
    angles = np.unwrap(np.arctan2(way[:, 1], way[:, 0]))
    angles, radii = (np.linspace(each[0], each[-1], PLACES) for each in (angles, np.hypot(*way.T)))
    return arc.centre_mm + radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


def _corners(a_pass) -> tuple[np.ndarray, dict[int, object]]:
    """The poses but those on the way along a circle, and each circle by the number of the one that it begins at."""
    poses = np.asarray(a_pass.poses_mm)
    inner = np.zeros(len(poses), dtype=bool)
    for arc in a_pass.arcs:
        inner[arc.first + 1 : arc.last] = True
    numbers = np.cumsum(~inner) - 1
    return poses[~inner], {int(numbers[arc.first]): arc for arc in a_pass.arcs}


def _round(a_pass) -> tuple[np.ndarray, np.ndarray]:
    """The poses, those on a circle with chords between them; and for each point the pose that it leads to."""
    poses = np.asarray(a_pass.poses_mm)
    centres = {k: (*arc.centre_mm, arc.direction) for arc in a_pass.arcs for k in range(arc.first, arc.last)}
    if not centres:
        return poses, np.arange(len(poses))
    points, owner = [poses[0]], [0]
    for k in range(len(poses) - 1):
        between = chords(poses[k], poses[k + 1], centres[k]) if k in centres else []
        points += [*between, poses[k + 1]]
        owner += [k + 1] * (len(between) + 1)
    return np.array(points), np.array(owner)


def follows(found: np.ndarray, reference: np.ndarray, limit_mm: float) -> int | None:
    """None where one can go along both paths (n, 3) and (m, 3) of straight moves at once, from their starts to their
    ends, never back on either, and never further from each other than the limit; else the point of found to which the
    first move leads on which that is over.

    Decided exactly, after Alt and Godau: a move of each path makes a cell, whose pairs of places within the limit are
    a convex part. A cell is entered from the move of found before it, or from the move of reference before it, and what
    matters is how early on the other move that can be.
    """
    found, reference = (
        (path if len(path) > 1 else np.repeat(path, 2, axis=0)).tolist() for path in (found, reference)
    )
    if math.dist(found[0], reference[0]) > limit_mm:
        return 0
    cells = len(reference) - 1
    entered: dict[
        int, float
    ] = {}  # by the move of reference: how early on it, coming from the move of found before
    for j in range(cells):
        free = _within(found[0], reference[j], reference[j + 1], limit_mm)
        if free is None or free[0] > 0.0:
            break
        entered[j] = 0.0
        if free[1] < 1.0:
            break
    for i in range(len(found) - 1):
        begin, end = found[i], found[i + 1]
        left: dict[int, float] = {}
        below = None  # how early on the move of found, coming from the move of reference before
        if entered.get(0) == 0.0 and (free := _within(reference[0], begin, end, limit_mm)) and free[0] == 0.0:
            below = 0.0
        columns = sorted(entered)
        j = columns[0]
        while j < cells:
            early = entered.get(j)
            if early is None and below is None:
                after = bisect.bisect(columns, j)
                if after == len(columns):
                    break
                j = columns[after]
                continue
            if free := _within(end, reference[j], reference[j + 1], limit_mm):
                least = free[0] if below is not None else max(free[0], early)
                if least <= free[1]:
                    left[j] = least
            free = _within(reference[j + 1], begin, end, limit_mm)
            if free is None:
                below = None
            else:
                least = free[0] if early is not None else max(free[0], below)
                below = least if least <= free[1] else None
            j += 1
        if not left:
            return i + 1
        entered = left
    is_whole = cells - 1 in entered and math.dist(found[-1], reference[-1]) <= limit_mm
    return None if is_whole else len(found) - 1


def _within(point: list, begin: list, end: list, limit_mm: float) -> tuple[float, float] | None:
    """The part of a move, from 0 to 1, that is within the limit of a point."""
    ax, ay, az = begin[0] - point[0], begin[1] - point[1], begin[2] - point[2]
    bx, by, bz = end[0] - begin[0], end[1] - begin[1], end[2] - begin[2]
    square, along = bx * bx + by * by + bz * bz, ax * bx + ay * by + az * bz
    over = ax * ax + ay * ay + az * az - limit_mm * limit_mm
    if square < 1e-18:
        return (0.0, 1.0) if over <= 0.0 else None
    root = along * along - square * over
    if root < 0.0:
        return None
    root = math.sqrt(root)
    first, last = (-along - root) / square, (-along + root) / square
    return (max(first, 0.0), min(last, 1.0)) if first <= 1.0 and last >= 0.0 else None


def _along(poses: np.ndarray) -> np.ndarray:
    """Poses and the middles between them."""
    return np.vstack([poses, (poses[1:] + poses[:-1]) / 2])


def _farthest(points: np.ndarray, path: np.ndarray) -> float:
    """Largest distance [mm] of points (n, 3) from a path (m, 3) of straight moves. Quick where both go the same way:
    a few points are held against the moves that come next, and against others only where these could be nearer."""
    starts, ends = (path[:-1], path[1:]) if len(path) > 1 else (path, path)
    boxes = range(0, len(starts), IN_A_BOX)
    both = [np.vstack([starts[k : k + IN_A_BOX], ends[k : k + IN_A_BOX]]) for k in boxes]
    lows, highs = np.array([box.min(axis=0) for box in both]), np.array([box.max(axis=0) for box in both])
    box_of = np.arange(len(starts)) // IN_A_BOX
    farthest, here = 0.0, 0
    for first in range(0, len(points), IN_A_BOX):
        some = points[first : first + IN_A_BOX]
        next_ = slice(max(0, here - IN_A_BOX), here + 3 * IN_A_BOX)
        away, at = _nearest(some, starts[next_], ends[next_])
        here = next_.start + at
        if away <= farthest:
            continue
        least = np.linalg.norm(
            np.maximum(0, np.maximum(lows - some.max(axis=0), some.min(axis=0) - highs)), axis=1
        )
        others = np.flatnonzero((least <= away + 1e-9)[box_of])
        away, at = _nearest(some, starts[others], ends[others])
        here = int(others[at])
        farthest = max(farthest, away)
    return farthest


IN_A_BOX = 64  # points, and moves: fewer are more boxes to look at, more are more distances to take


def _nearest(points: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> tuple[float, int]:
    """The same with every point held against every move; and which move is nearest to the last point."""
    nearest, at_last = np.full(len(points), np.inf), 0
    for first in range(0, len(starts), 4096):  # bounds the memory, nothing else
        steps = ends[first : first + 4096] - starts[first : first + 4096]
        squares = np.maximum((steps**2).sum(axis=1), 1e-30)
        offset = points[:, None] - starts[first : first + 4096]
        along = np.clip((offset * steps).sum(axis=2) / squares, 0, 1)
        away = np.linalg.norm(offset - along[..., None] * steps, axis=2)
        if away[-1].min() < nearest[-1]:
            at_last = first + int(away[-1].argmin())
        nearest = np.minimum(nearest, away.min(axis=1))
    return float(nearest.max()), at_last


def _paint(ran: Ran, due, planned_visits) -> Problems:
    """The first stroke before which paint is fetched otherwise than the cell says."""
    for a_pass, found, required in zip(due, ran.visits, planned_visits, strict=True):
        if found != required:
            stations = [
                " and ".join(station.name for station in each) or "nothing" for each in (found, required)
            ]
            sentence = f"before it the program visits {stations[0]}, the cell asks for {stations[1]}"
            return [Notice(a_pass.stroke, sentence, code="other-station")]
    return []
