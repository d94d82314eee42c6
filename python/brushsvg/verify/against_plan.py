"""Compare a program that was read back with the plan that it should paint."""

from __future__ import annotations

import bisect
import math

import numpy as np

from ..errors import Error, Notice
from ..machine.cells.cell import Cell, ends_rounded_mm, least_move_mm, servo_parts, servo_stands, unit_mm, value_mm
from ..machine.paint_reload import PlanInLoads, list_station_visits
from ..machine.posts.text import spelled
from ..machine.realised.rounding import lift_on_steep_paths
from ..machine.tool_axes import axes_of, between_deg, interpolate_axes, tilts_deg
from .simulate_program import Problems, SimulatedProgram, arc_points, slack_mm

MAX_PATH_DEVIATION_MM = 0.02  # deviation of a path by rounding and by chords of circles: invisible in paint


def compare_with_plan(
    ran: SimulatedProgram, expected: PlanInLoads, cell: Cell, first_stroke: int = 1
) -> tuple[list[int | None], Problems]:
    """Compare the passes of a program with the loads of its plan.

    Returns the index of the load of each pass (None: no load), and the notices. A notice reports a pass that is
    missing, out of order, displaced, too fast, or painted with other paint. Passes before the program's first stroke
    were painted earlier. Raises Error when the plan has no such stroke.
    """
    first, count = first_stroke, len(expected.loads)
    if first > count:
        sentence = f"the program goes on with stroke {first}, the drawing has strokes 1 to {count}"
        raise Error(sentence, code="stroke-unknown")
    due = expected.loads[first - 1 :]
    partners, problems = _match_passes_to_loads(ran.plan.passes, due)
    rows = zip(ran.plan.passes, ran.lines, partners, strict=True)
    for a_pass, lines, k in rows:
        problems += _check_pass(a_pass, lines, due[k], cell) if k is not None else []
    if not problems and len(ran.visits) == len(due):  # otherwise a stroke is not one touch, which is reported elsewhere
        planned_visits = list_station_visits(expected, cell, first)[first - 1 :] or ((),) * len(due)
        problems += _check_station_visits(ran, due, planned_visits)
    return [None if k is None else first - 1 + k for k in partners], problems


def _match_passes_to_loads(passes, due) -> tuple[list[int | None], Problems]:
    """Match the passes of a program to the loads of its plan by their names.

    Returns, for each pass, the index in `due` of its load. Where several loads share a name, they match in order. The
    index is None where no load has the name. Also returns notices for strokes that are unknown, missing or out of
    order.
    """
    names = [spelled(a_pass.stroke).rstrip(" ") for a_pass in passes]
    required = [spelled(each.stroke) for each in due]
    if len(names) == len(required) and all(map(_is_same_name, names, required)):
        return list(range(len(due))), []
    unmatched = dict(enumerate(required))
    by_name: dict[str, list[int]] = {}
    for number, name in reversed(unmatched.items()):
        by_name.setdefault(name.rstrip(" "), []).append(number)
    partners: list[int | None] = []
    for name in names:
        numbers = by_name.get(name)
        number = numbers.pop() if numbers else next((k for k in unmatched if _is_same_name(name, unmatched[k])), None)
        if number is not None:
            unmatched.pop(number, None)
            partners.append(number)
        else:
            partners.append(None)
    problems = [
        Notice(name, "the drawing has no such stroke", code="stroke-not-drawn")
        for name, k in zip(names, partners, strict=True)
        if k is None
    ]
    matched = [k for k in partners if k is not None]
    painted_colours = {due[k].colour for k in matched}
    colour = painted_colours.pop() if len(painted_colours) == 1 else ""
    is_one_colour = colour and colour not in {due[k].colour for k in unmatched}
    advice = f"for a program of one colour, give --colour '{colour}'" if is_one_colour else ""
    problems += [
        Notice(due[k].stroke, "the program does not paint this stroke", code="stroke-not-painted", advice=advice)
        for k in unmatched
    ]
    if not problems and matched != sorted(matched):
        at = next(place for place, k in enumerate(matched) if k != place)
        sentence = f"it is painted where the drawing asks for {required[at]}"
        problems.append(Notice(names[at], sentence, code="stroke-order"))
    return partners, problems


def _is_same_name(written: str, name: str) -> bool:
    """Return whether a read name is this stroke's: programs cut long names and lose blanks at the end."""
    return written == name.rstrip(" ") or (written.endswith("...") and name.startswith(written[:-3]))


def _check_pass(a_pass, lines: np.ndarray, planned, cell: Cell) -> Problems:
    """Report where a pass leaves the planned path or its order, or runs too fast.

    lines: (n,) line of the program for each pose of the pass.
    """
    problems = _check_tool_axes(a_pass, lines, planned)
    planned = lift_on_steep_paths(planned, cell) if cell.servo else planned
    # Where units are coarse, brushsvg drops a pose that is less than the smallest move from another one.
    limit_mm = max(MAX_PATH_DEVIATION_MM, slack_mm(cell), least_move_mm(cell) + unit_mm(cell))
    # A servo's height changes in steps of whole values, so it is off the line by half a step and half a value. A pose
    # at the servo value of the previous one is dropped, so the line may begin up to one value higher. These errors and
    # those of rounding sideways do not depend on each other.
    allowance_mm = (_max_servo_step_mm(planned, cell) + 3 * value_mm(cell)) / 2 if cell.servo else 0.0
    steepness = limit_mm / (limit_mm + allowance_mm)
    if _pose_distance_mm(a_pass, planned) > limit_mm:  # it may still be the same path, with other poses
        (found, owner), (reference, _) = _with_arc_points(a_pass), _with_arc_points(planned)
        found, reference = found * (1, 1, steepness), reference * (1, 1, steepness)
        at = find_departure(found, reference, limit_mm, heights_apart=bool(cell.servo))
        if at is not None:
            away_mm = max(
                _max_distance_mm(_with_midpoints(found), reference),
                _max_distance_mm(_with_midpoints(reference), found),
            )
            sentence = f"line {lines[owner[min(at, len(owner) - 1)]]}: {_deviation_sentence(away_mm, limit_mm)}"
            problems.append(Notice(a_pass.stroke, sentence, code="path-elsewhere"))
    is_dab = not np.ptp(planned.poses_mm[:, :2], axis=0).any()  # a dab is pressed on the spot, as slowly as a landing
    if a_pass.speed_mm_s > planned.speed_mm_s + 0.1 and not is_dab:
        requested = f"the drawing asks for {planned.speed_mm_s:.1f} mm/s"
        sentence = f"it is painted at {a_pass.speed_mm_s:.1f} mm/s, {requested}"
        problems.append(Notice(a_pass.stroke, sentence, code="stroke-too-fast"))
    return problems


def _max_servo_step_mm(a_pass, cell: Cell) -> float:
    """Return the largest height change [mm] of a servo in one part of a move.

    A steep move has no room for more parts. A move whose ends were rounded to whole units may have room for fewer.
    """
    ways = np.diff(np.asarray(a_pass.poses_mm, dtype=float), axis=0)
    ways = ways[~servo_stands(ways, cell)]
    parts = servo_parts(ways, cell, -ends_rounded_mm(cell))
    return max(cell.servo.step_mm, float((np.abs(ways[:, 2]) / parts).max(initial=0.0)))


# Deviation of the brush from its planned direction: smaller ones do not show in a mark.
MAX_TILT_DEVIATION_DEG = 0.5


def _check_tool_axes(a_pass, lines: np.ndarray, planned) -> Problems:
    """Report tilts that differ from the plan, by pose, or by path share where pose counts differ."""
    if not len(a_pass.tool_axes) and axes_of(planned) is None:
        return []
    found, reference = (_tool_axes(each) for each in (a_pass, planned))
    if len(found) != len(reference):
        along, on = (_path_shares(np.asarray(each.poses_mm)) for each in (a_pass, planned))
        reference = interpolate_axes(reference, np.interp(along, on, np.arange(len(on))))
    off_deg = between_deg(found, reference)
    worst = int(off_deg.argmax())
    if off_deg[worst] <= MAX_TILT_DEVIATION_DEG:
        return []
    sentence = (
        f"line {lines[worst]}: the brush is held {off_deg[worst]:.3g} degrees from how the drawing asks for it, by "
        f"{float(tilts_deg(reference[worst])):.3g} degrees from upright: it was changed, or made with other flags or "
        "from another drawing"
    )
    return [Notice(a_pass.stroke, sentence, code="held-otherwise")]


def _tool_axes(a_pass) -> np.ndarray:
    axes = axes_of(a_pass)
    return np.tile((0.0, 0.0, 1.0), (len(a_pass.poses_mm), 1)) if axes is None else axes


def _path_shares(poses: np.ndarray) -> np.ndarray:
    """Return (n,) the share of the path length, from 0 to 1, at each pose (n, 3)."""
    along = np.cumsum(np.linalg.norm(np.diff(poses, axis=0, prepend=poses[:1]), axis=1))
    return along / max(along[-1], 1e-9)


def _deviation_sentence(away_mm: float, limit_mm: float) -> str:
    changed = "it was changed, or made with other flags or from another drawing"
    if away_mm > limit_mm:
        return f"the program runs {away_mm:.2f} mm away from where the drawing asks it to: {changed}"
    return f"from here on the stroke is not painted once, from its start to its end, as the drawing asks: {changed}"


ARC_SAMPLES = 17  # places at which two circles are compared


def _pose_distance_mm(a_pass, planned) -> float:
    """Return the largest distance [mm] between the poses and circles of two passes.

    Returns inf where their poses or circles do not correspond.
    """
    (ours, our_arcs), (theirs, their_arcs) = _poses_outside_arcs(a_pass), _poses_outside_arcs(planned)
    if len(ours) != len(theirs) or our_arcs.keys() != their_arcs.keys():
        return np.inf
    ends_mm = float(np.linalg.norm(ours - theirs, axis=1).max())
    away_mm = ends_mm
    for k, arc in our_arcs.items():
        if arc.direction != their_arcs[k].direction:
            return np.inf
        apart = _sample_arc(a_pass, arc) - _sample_arc(planned, their_arcs[k])
        away_mm = max(away_mm, float(np.hypot(*apart.T).max()))
    return away_mm


def _sample_arc(a_pass, arc) -> np.ndarray:
    """Return places (n, 2) evenly spaced along a circle.

    Comparing places is better than comparing centres, because the centre of a flat circle is ill-determined. Rounding
    three of its places by a thousandth of a millimetre moves the centre by a millimetre, but not the path.
    """
    way = np.asarray(a_pass.poses_mm)[arc.first : arc.last + 1, :2] - arc.centre_mm
    angles = np.unwrap(np.arctan2(way[:, 1], way[:, 0]))
    angles, radii = (np.linspace(each[0], each[-1], ARC_SAMPLES) for each in (angles, np.hypot(*way.T)))
    return arc.centre_mm + radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


def _poses_outside_arcs(a_pass) -> tuple[np.ndarray, dict[int, object]]:
    """Return the poses (n, 3) outside arcs, and the arcs by their first pose's index among these."""
    poses = np.asarray(a_pass.poses_mm)
    inner = np.zeros(len(poses), dtype=bool)
    for arc in a_pass.arcs:
        inner[arc.first + 1 : arc.last] = True
    numbers = np.cumsum(~inner) - 1
    return poses[~inner], {int(numbers[arc.first]): arc for arc in a_pass.arcs}


def _with_arc_points(a_pass) -> tuple[np.ndarray, np.ndarray]:
    """Return poses with chord points along circles, and the pose that each point leads to."""
    poses = np.asarray(a_pass.poses_mm)
    centres = {k: (*arc.centre_mm, arc.direction) for arc in a_pass.arcs for k in range(arc.first, arc.last)}
    if not centres:
        return poses, np.arange(len(poses))
    points, owner = [poses[0]], [0]
    for k in range(len(poses) - 1):
        between = arc_points(poses[k], poses[k + 1], centres[k]) if k in centres else []
        points += [*between, poses[k + 1]]
        owner += [k + 1] * (len(between) + 1)
    return np.array(points), np.array(owner)


def find_departure(
    found: np.ndarray, reference: np.ndarray, limit_mm: float, heights_apart: bool = False
) -> int | None:
    """Return the first point of `found` at which it departs from `reference`.

    Returns None where it never departs. The paths (n, 3) and (m, 3) [mm] consist of straight moves. They match if one
    can go along both at once, from start to end, never backwards on either, and never further apart than the limit.
    Otherwise the returned index is the end of the first move of `found` on which this is no longer possible.

    heights_apart: the limit applies to heights, and to distances seen from above, each by itself.

    The decision is exact, after Alt and Godau. One move of each path makes a cell, in which the pairs of places within
    the limit form a convex region. A cell is entered from the previous move of `found` or from the previous move of
    `reference`. The algorithm keeps how early on the other move it can be entered.
    """
    found, reference = ((path if len(path) > 1 else np.repeat(path, 2, axis=0)).tolist() for path in (found, reference))

    def are_apart(point: list, other: list) -> bool:
        if heights_apart:
            return max(math.dist(point[:2], other[:2]), abs(point[2] - other[2])) > limit_mm
        return math.dist(point, other) > limit_mm

    def part_within(point: list, begin: list, end: list) -> tuple[float, float] | None:
        return _part_within_limit(point, begin, end, limit_mm, heights_apart)

    if are_apart(found[0], reference[0]):
        return 0
    cells = len(reference) - 1
    # By move of reference: the earliest share of it, coming from the previous move of found. Both paths begin here,
    # even if rounding puts their first points just beyond the limit below.
    entered = {0: 0.0}
    for j in range(cells):
        free = part_within(found[0], reference[j], reference[j + 1])
        if free is None or free[0] > 0.0:
            break
        entered[j] = 0.0
        if free[1] < 1.0:
            break
    for i in range(len(found) - 1):
        begin, end = found[i], found[i + 1]
        next_entered: dict[int, float] = {}
        below = None  # the earliest share of the move of found, coming from the previous move of reference
        if entered.get(0) == 0.0 and (free := part_within(reference[0], begin, end)) and free[0] == 0.0:
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
            if free := part_within(end, reference[j], reference[j + 1]):
                least = free[0] if below is not None else max(free[0], early)
                if least <= free[1]:
                    next_entered[j] = least
            free = part_within(reference[j + 1], begin, end)
            if free is None:
                below = None
            else:
                least = free[0] if early is not None else max(free[0], below)
                below = least if least <= free[1] else None
            j += 1
        if not next_entered:
            return i + 1
        entered = next_entered
    is_whole = cells - 1 in entered and not are_apart(found[-1], reference[-1])
    return None if is_whole else len(found) - 1


def _part_within_limit(
    point: list, begin: list, end: list, limit_mm: float, heights_apart: bool = False
) -> tuple[float, float] | None:
    """Return the part of a move, as shares from 0 to 1, within the limit of a point, or None."""
    ax, ay, az = begin[0] - point[0], begin[1] - point[1], begin[2] - point[2]
    bx, by, bz = end[0] - begin[0], end[1] - begin[1], end[2] - begin[2]
    if not heights_apart:
        return _part_in_ball((ax, ay, az), (bx, by, bz), limit_mm)
    flat = _part_in_ball((ax, ay, 0.0), (bx, by, 0.0), limit_mm)
    height = _part_in_ball((0.0, 0.0, az), (0.0, 0.0, bz), limit_mm)
    if flat is None or height is None:
        return None
    first, last = max(flat[0], height[0]), min(flat[1], height[1])
    return (first, last) if first <= last else None


def _part_in_ball(start: tuple, way: tuple, radius_mm: float) -> tuple[float, float] | None:
    """Return the part of a move, as shares from 0 to 1, within a ball around the origin, or None."""
    (ax, ay, az), (bx, by, bz) = start, way
    square, along = bx * bx + by * by + bz * bz, ax * bx + ay * by + az * bz
    over = ax * ax + ay * ay + az * az - radius_mm * radius_mm
    if square < 1e-18:
        return (0.0, 1.0) if over <= 0.0 else None
    root = along * along - square * over
    if root < 0.0:
        return None
    root = math.sqrt(root)
    first, last = (-along - root) / square, (-along + root) / square
    return (max(first, 0.0), min(last, 1.0)) if first <= 1.0 and last >= 0.0 else None


def _with_midpoints(poses: np.ndarray) -> np.ndarray:
    """Return the poses (n, 3), and the midpoints between them."""
    return np.vstack([poses, (poses[1:] + poses[:-1]) / 2])


def _max_distance_mm(points: np.ndarray, path: np.ndarray) -> float:
    """Return the largest distance [mm] of points (n, 3) from a path (m, 3).

    The search is quick where both go the same way. A few points are compared with the moves that come next, and with
    other moves only where these could be nearer.
    """
    starts, ends = (path[:-1], path[1:]) if len(path) > 1 else (path, path)
    boxes = range(0, len(starts), BOX_SIZE)
    box_ends = [np.vstack([starts[k : k + BOX_SIZE], ends[k : k + BOX_SIZE]]) for k in boxes]
    lows = np.array([box.min(axis=0) for box in box_ends])
    highs = np.array([box.max(axis=0) for box in box_ends])
    box_of = np.arange(len(starts)) // BOX_SIZE
    farthest, here = 0.0, 0
    for first in range(0, len(points), BOX_SIZE):
        box_points = points[first : first + BOX_SIZE]
        next_ = slice(max(0, here - BOX_SIZE), here + 3 * BOX_SIZE)
        away, at = _max_distance_to_all_mm(box_points, starts[next_], ends[next_])
        here = next_.start + at
        if away <= farthest:
            continue
        least = np.linalg.norm(
            np.maximum(0, np.maximum(lows - box_points.max(axis=0), box_points.min(axis=0) - highs)), axis=1
        )
        others = np.flatnonzero((least <= away + 1e-9)[box_of])
        away, at = _max_distance_to_all_mm(box_points, starts[others], ends[others])
        here = int(others[at])
        farthest = max(farthest, away)
    return farthest


BOX_SIZE = 64  # points or moves; a smaller number makes more boxes, a larger one more distances to compute


def _max_distance_to_all_mm(points: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> tuple[float, int]:
    """Return the largest distance [mm] of points to any move, and the last point's nearest move."""
    nearest, at_last = np.full(len(points), np.inf), 0
    for first in range(0, len(starts), 4096):  # this number only limits the memory
        steps = ends[first : first + 4096] - starts[first : first + 4096]
        squares = np.maximum((steps**2).sum(axis=1), 1e-30)
        offset = points[:, None] - starts[first : first + 4096]
        along = np.clip((offset * steps).sum(axis=2) / squares, 0, 1)
        away = np.linalg.norm(offset - along[..., None] * steps, axis=2)
        if away[-1].min() < nearest[-1]:
            at_last = first + int(away[-1].argmin())
        nearest = np.minimum(nearest, away.min(axis=1))
    return float(nearest.max()), at_last


def _check_station_visits(ran: SimulatedProgram, due, planned_visits) -> Problems:
    """Report the first stroke with other paint stations than the cell requires."""
    for a_pass, found, required in zip(due, ran.visits, planned_visits, strict=True):
        if found != required:
            stations = [" and ".join(station.name for station in each) or "nothing" for each in (found, required)]
            sentence = f"before it the program visits {stations[0]}, the cell asks for {stations[1]}"
            return [Notice(a_pass.stroke, sentence, code="other-station")]
    return []
