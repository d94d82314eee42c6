"""Round a pass as its program's text does.

Writers and readers of programs then decide from the same places.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate, chain, pairwise
from math import atan2, ceil, dist, hypot, inf, tau

import numpy as np

from ... import _core
from ..cells.cell import Cell, Servo, is_too_steep_for_servo, least_move_mm, round_points, unit_mm
from ..cells.language_limits import MAX_RADIUS_DIFFERENCE_MM
from ..frames import is_upright, transform_points
from ..moves import via_point
from ..posts import POSTS, circles_by
from ..tool_axes import axes_of
from .arc_chords import OFF_MM, add_chords, with_chords
from .corner_blending import MAX_VERTICAL_SIDEWAYS_MM, find_vertical_steps
from .distortion import commanded_pass, has_lean
from .pass_on_path import move_pass_to_path

# Smallest size and height of a circle, in units of the last decimal. Smaller or flatter circles are run along their
# chords. Rounded, they could turn the other way or all round, or become a line.
MIN_CIRCLE_UNITS = 10


@dataclass(frozen=True)
class Written:
    """A pass as a program contains it.

    commanded_mm: (k, 3) the command for each pose of the program.
    poses_mm: (k, 3) the commands rounded as in the program, in the paper's frame.
    arcs: the arcs that are written as circles.
    sideways_mm: steps that are shorter than this sideways are straight up or down.
    axes: (k, 3) the brush's axes at the poses; None for an upright brush.
    """

    commanded_mm: np.ndarray
    poses_mm: np.ndarray
    arcs: list
    sideways_mm: float
    axes: np.ndarray | None = None


def as_written(a_pass, cell: Cell, frame: np.ndarray, was_read: bool = False) -> Written:
    """Return a pass as the cell's language writes it.

    The result has the commands for the cell's machine.

    frame: (4, 4) pose of the paper's frame in the robot's frame.
    was_read: whether the pass was read from a program.
    """
    post = POSTS.get(cell.language)
    unit = unit_mm(cell)
    circle_definition = circles_by(cell)
    in_robot = bool(post and post.in_robot_frame and not np.array_equal(frame, np.eye(4)))
    # a leaning tool is commanded sideways so that it goes straight down, except for rounding
    sideways_mm = 2 * unit if has_lean(cell.machine) else MAX_VERTICAL_SIDEWAYS_MM
    if in_robot and not is_upright(frame):
        sideways_mm = 2 * unit  # vertical moves are only vertical up to rounding
        circle_definition = ""  # circles are not in a plane that the robot knows
    if cell.servo:
        a_pass = lift_on_steep_paths(a_pass, cell, was_read)
    if sideways_mm > MAX_VERTICAL_SIDEWAYS_MM and not was_read:
        a_pass = _straighten_lifts(a_pass, sideways_mm + 2**0.5 * unit)
    a_pass = commanded_pass(a_pass, cell)
    exact = np.array(a_pass.poses_mm, dtype=float).reshape(-1, 3)

    def on_grid(poses: np.ndarray) -> np.ndarray:
        if in_robot:
            return transform_points(np.linalg.inv(frame), round_points(transform_points(frame, poses), cell))
        return round_points(poses, cell)

    poses, arcs = on_grid(exact), []
    least_mm = least_move_mm(cell)
    if circle_definition:
        arcs, others = _split_arcs(a_pass.arcs, poses, circle_definition, cell)
        dense_poses, arcs = add_chords(exact, others, arcs)
        if len(dense_poses) > len(exact):
            exact, poses = dense_poses, on_grid(dense_poses)
    poses_run = poses
    if cell.servo:  # first, so that a pose that is left out is never further than least_mm from where the servo stands
        held_rows = _servo_rows(poses[:, :2], least_mm)
        poses[:, :2], exact[:, :2] = poses[held_rows, :2], exact[held_rows, :2]
        poses[:, 2] = exact[:, 2]  # heights become servo values and have no decimals
        poses_run = _at_servo_values(poses, cell.servo)
    kept = _select_distinct_poses(poses_run, {row for arc in arcs for row in (arc.first, arc.last)}, least_mm)
    if len(kept) < len(poses):
        arcs = [
            _core.Arc(*np.searchsorted(kept, (arc.first, arc.last)).tolist(), arc.centre_mm, arc.direction)
            for arc in arcs
        ]
    exact, poses = exact[kept], poses[kept]
    if cell.servo:
        # Rounding may have made a lift on the spot a short steep path.
        ends = "read" if was_read else "rounded"
        steep = is_too_steep_for_servo(np.diff(poses, axis=0), a_pass.speed_mm_s, cell, ends)
        on_arcs = [row for arc in arcs for row in range(arc.first, arc.last)]
        rows = np.setdiff1d(np.flatnonzero(steep), on_arcs)
        exact, poses = _insert_lifts(exact, rows), _insert_lifts(poses, rows)
        arcs = [
            _core.Arc(*(np.searchsorted(rows, ends) + ends).tolist(), arc.centre_mm, arc.direction)
            for arc in arcs
            for ends in [np.array([arc.first, arc.last])]
        ]
    axes = axes_of(a_pass)  # a pass with axes has no arcs
    return Written(exact, poses, arcs, sideways_mm, axes if axes is None else axes[kept])


def _at_servo_values(poses: np.ndarray, servo: Servo) -> np.ndarray:
    """Return poses at the heights of whole servo values; a program's reader knows no other heights."""
    heights, values = np.array(sorted(servo.table), dtype=float).T
    rounded_values = np.rint(np.interp(poses[:, 2], heights, values))
    rising = np.argsort(values)
    return np.column_stack([poses[:, :2], np.interp(rounded_values, values[rising], heights[rising])])


def lift_on_steep_paths(a_pass, cell: Cell, was_read: bool = False):
    """Return a pass without moves that are too steep for a servo.

    A servo changes its height in steps along a move, each with a move of its own. Where a move is too steep for that,
    the brush is pressed on the spot before it, or lifted on the spot after it. This is mostly at the end of a stroke,
    and such a move is shorter than a tenth of its change of height.

    was_read: whether the pass was read from a program.
    """

    ends = "read" if was_read else "planned"

    def find_steep_rows(poses: np.ndarray) -> np.ndarray:
        return np.flatnonzero(is_too_steep_for_servo(np.diff(poses, axis=0), a_pass.speed_mm_s, cell, ends))

    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    if not len(find_steep_rows(poses)):
        return a_pass
    poses = np.asarray(with_chords(a_pass).poses_mm, dtype=float)
    return move_pass_to_path(a_pass, _insert_lifts(poses, find_steep_rows(poses)), [])


def _straighten_lifts(a_pass, sideways_mm: float):
    """Return a pass whose steps that are nearly straight up or down are exactly so.

    Rounding would turn such a step into a straight one in one program and not in another.

    sideways_mm: a step that is shorter than this sideways becomes straight.
    """
    poses = np.array(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    steps = np.diff(poses, axis=0)
    is_nearly_vertical = find_vertical_steps(steps, sideways_mm) & steps[:, :2].any(axis=1)
    arc_starts = {arc.first for arc in a_pass.arcs}
    rows = [row for row in np.flatnonzero(is_nearly_vertical).tolist() if row + 1 not in arc_starts]
    if not rows:
        return a_pass
    for row in rows:
        if np.abs(poses[row + 1, :2] - poses[row, :2]).max() < sideways_mm:  # many short steps do not add up
            poses[row + 1, :2] = poses[row, :2]
    return move_pass_to_path(a_pass, poses, a_pass.arcs, axes_of(a_pass))


def _insert_lifts(poses: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Divide the paths that begin at rows into a lift or press on the spot and a level path.

    The brush is pressed before the level path, and lifted after it.
    """
    presses = poses[rows + 1, 2] < poses[rows, 2]
    places = np.where(presses[:, None], poses[rows, :2], poses[rows + 1, :2])
    heights = np.where(presses, poses[rows + 1, 2], poses[rows, 2])
    return np.insert(poses, rows + 1, np.column_stack([places, heights]), axis=0)


def _servo_rows(places: np.ndarray, least_mm: float) -> np.ndarray:
    """Return for each rounded place (n, 2) the row at which the servo stands, (n,).

    A lift alone names no place. The servo stays where the last move ended while the sideways part is shorter than a
    move.
    """
    stays = np.arange(len(places))
    is_near = np.hypot(*(places[1:] - places[:-1]).T) < least_mm
    positions, last_row = places.tolist(), 0
    for row in (np.flatnonzero(is_near) + 1).tolist():
        if row <= last_row:
            continue
        for last_row in range(row, len(positions)):
            if dist(positions[row - 1], positions[last_row]) >= least_mm:
                break
            stays[last_row] = row - 1
    return stays


def _split_arcs(arcs, poses: np.ndarray, circle_definition: str, cell: Cell) -> tuple[list, list]:
    """Return arcs written as circles, split where they come back to their beginning, and the other arcs."""
    unit, least_mm = unit_mm(cell), least_move_mm(cell)

    def is_tiny(first: int, last: int) -> bool:
        return first != last and dist(poses[first], poses[last]) < least_mm

    written_arcs, others, last_end = [], [], 0
    for part in chain.from_iterable(_split_full_circles(arc, poses, MIN_CIRCLE_UNITS * unit) for arc in arcs):
        if (
            _defines_circle(poses[part.first : part.last + 1, :2], circle_definition, MIN_CIRCLE_UNITS * unit)
            and _is_accepted_as_circle(poses[[part.first, part.last], :2] - part.centre_mm, cell)
            and not is_tiny(last_end, part.first)
            and not is_tiny(part.last, len(poses) - 1)
        ):
            written_arcs.append(part)
            last_end = part.last
        else:
            others.append(part)
    return written_arcs, others


def _split_full_circles(arc, poses: np.ndarray, least_mm: float) -> Iterator:
    """Split an arc that comes back to its beginning or beyond into parts.

    A circle whose rounded ends coincide would vanish, and a circle that goes beyond its beginning would lose a turn.
    """
    x, y = arc.centre_mm  # circles have few poses, for which arrays are slower
    angles = [atan2(b - y, a - x) for a, b in poses[arc.first : arc.last + 1, :2].tolist()]
    turns = ((after - before) * arc.direction for before, after in pairwise(angles))
    turned_rad = list(
        accumulate(((turn + MAX_BACKWARD_TURN_RAD) % tau - MAX_BACKWARD_TURN_RAD for turn in turns), initial=0.0)
    )
    first, end_distance_mm = 0, dist(poses[arc.first, :2], poses[arc.last, :2])
    if turned_rad[-1] >= tau or end_distance_mm < least_mm:
        part_rad = turned_rad[-1] / max(2, ceil(turned_rad[-1] / TARGET_PART_RAD)) - 1e-6
        for row in range(1, len(turned_rad) - 1):
            if (
                turned_rad[row] - turned_rad[first] >= part_rad
                or turned_rad[row + 1] - turned_rad[first] > MAX_PART_RAD
            ):
                yield _core.Arc(arc.first + first, arc.first + row, arc.centre_mm, arc.direction)
                first = row
    yield _core.Arc(arc.first + first, arc.last, arc.centre_mm, arc.direction)


MAX_BACKWARD_TURN_RAD = 1.0  # rounding turns tiny steps of a circle back by less than this
# Angle of the parts of a circle, and the largest angle of one part. A circle of slightly more than one turn has two
# parts, and no part is a whole turn.
TARGET_PART_RAD, MAX_PART_RAD = 3.5, 5.0


def _is_accepted_as_circle(spokes: np.ndarray, cell: Cell) -> bool:
    """Return whether the firmware accepts a circle and stays close to it; spokes (2, 2): centre to ends."""
    first, last = (hypot(*spoke) for spoke in spokes.tolist())
    # The centre of the circle is rounded, too.
    max_difference_mm = MAX_RADIUS_DIFFERENCE_MM.get(cell.language, inf) - 1.5 * unit_mm(cell)
    sagitta_mm = cell.arc_segment_mm**2 / (8 * max(first, 1e-9))
    return abs(first - last) <= max_difference_mm and sagitta_mm <= OFF_MM


def _defines_circle(points: np.ndarray, circle_definition: str, least_mm: float) -> bool:
    """Return whether points (n, 2) define a circle.

    With a centre, the ends must be apart. With an intermediate pose, the three points must form a triangle that is not
    too flat.
    """
    if circle_definition == "centre":
        return dist(points[0], points[-1]) >= least_mm
    if len(points) < 3:
        return False
    a, b, c = points[0], via_point(points[1:]), points[-1]
    (x, y), (u, v) = b - a, c - a
    longest_mm = max(np.hypot(x, y), np.hypot(u, v), np.hypot(u - x, v - y))
    return bool(abs(x * v - y * u) > least_mm * longest_mm)


def _select_distinct_poses(poses: np.ndarray, ends: set[int], least_mm: float) -> np.ndarray:
    """Return rows at least least_mm from the row before; first, last and circles' ends stay."""
    if (np.linalg.norm(np.diff(poses, axis=0), axis=1) >= least_mm).all():
        return np.arange(len(poses))
    places, kept_ends = poses.tolist(), ends | {0, len(poses) - 1}
    kept = [0]
    for row in range(1, len(places)):
        if row in kept_ends:
            while kept[-1] not in kept_ends and dist(places[kept[-1]], places[row]) < least_mm:
                kept.pop()
            kept.append(row)
        elif dist(places[kept[-1]], places[row]) >= least_mm:
            kept.append(row)
    return np.array(kept)
