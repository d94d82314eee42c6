"""Round a pass as a program's text does: writers and readers decide from the same places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate, chain, pairwise
from math import atan2, ceil, dist, hypot, inf, tau

import numpy as np

from ... import _core
from ..cells.cell import (
    MAX_RADIUS_DIFFERENCE_MM,
    Cell,
    Servo,
    is_too_steep_for_servo,
    least_move_mm,
    round_points,
    unit_mm,
)
from ..frames import is_upright, moved
from ..motion import via_point
from ..posts import POSTS, circles_by
from ..tool_axes import axes_of
from .arc_chords import OFF_MM, add_chords, with_chords
from .corner_blending import MAX_VERTICAL_SIDEWAYS_MM
from .distortion import commanded_pass, has_lean
from .retimed import on_way

# circles that are smaller or flatter, in units of the last decimal, are run along their chords: rounded, they could
# turn the other way, or all round, or be on one line
CIRCLE_UNITS = 10


@dataclass(frozen=True)
class Written:
    """commanded_mm: (k, 3) the command for each pose that a program has; poses_mm: (k, 3) the same rounded as in the
    program, in the paper's frame; arcs: those of them written as circles; sideways_mm: steps of less than that
    are straight up and down; axes: (k, 3) how the brush is held there, None: upright."""

    commanded_mm: np.ndarray
    poses_mm: np.ndarray
    arcs: list
    sideways_mm: float
    axes: np.ndarray | None = None


def as_written(a_pass, cell: Cell, frame: np.ndarray, was_read: bool = False) -> Written:
    """A pass as the cell's language has it; frame: (4, 4) the paper's in the robot's. The pass is what shall be run,
    written is the command for the cell's machine. was_read: in a program."""
    a_pass = commanded_pass(steep_ways_lifted(a_pass, cell, was_read) if cell.servo else a_pass, cell)
    post = POSTS.get(cell.language)
    unit = unit_mm(cell)
    exact = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    given_by = circles_by(cell)
    in_robot = bool(post and post.in_robot_frame and not np.array_equal(frame, np.eye(4)))
    # a leaning tool is commanded sideways to go straight down, which it does up to rounding
    sideways_mm = 2 * unit if has_lean(cell.machine) else MAX_VERTICAL_SIDEWAYS_MM
    if in_robot and not is_upright(frame):
        sideways_mm = 2 * unit  # up and down are only so up to rounding
        given_by = ""  # and circles are in no plane that the robot knows

    def on_grid(poses: np.ndarray) -> np.ndarray:
        if in_robot:
            return moved(np.linalg.inv(frame), round_points(moved(frame, poses), cell))
        return round_points(poses, cell)

    poses, arcs = on_grid(exact), []
    least_mm = least_move_mm(cell)
    if given_by:
        arcs, others = _split_arcs(a_pass.arcs, poses, given_by, cell)
        dense, arcs = add_chords(exact, others, arcs)
        if len(dense) > len(exact):
            exact, poses = dense, on_grid(dense)
    run = _at_values(poses, cell.servo) if cell.servo else poses
    kept = _kept(run, {row for arc in arcs for row in (arc.first, arc.last)}, least_mm)
    if len(kept) < len(poses):
        arcs = [
            _core.Arc(*np.searchsorted(kept, (arc.first, arc.last)).tolist(), arc.centre_mm, arc.direction)
            for arc in arcs
        ]
    poses = poses[kept]
    commanded_mm = exact[kept]
    if cell.servo:
        held = _held(poses[:, :2], least_mm)
        poses[:, :2], commanded_mm[:, :2] = poses[held, :2], commanded_mm[held, :2]
    axes = axes_of(a_pass)  # without arcs
    return Written(commanded_mm, poses, arcs, sideways_mm, axes if axes is None else axes[kept])


def _at_values(poses: np.ndarray, servo: Servo) -> np.ndarray:
    """The poses at the heights of the servo's whole values, which are all that a reader of the program knows."""
    heights, values = np.array(sorted(servo.table), dtype=float).T
    found = np.rint(np.interp(poses[:, 2], heights, values))
    rising = np.argsort(values)
    return np.column_stack([poses[:, :2], np.interp(found, values[rising], heights[rising])])


def steep_ways_lifted(a_pass, cell: Cell, was_read: bool = False):
    """The same pass for a servo. Its height changes in steps along a way, each with a move of its own. Where a way is
    too steep for that, the brush is pressed before it, or lifted after it, on the spot: both are at an end of a stroke
    for most, and a way that steep is shorter than a tenth of its change of height."""

    def outrun(poses: np.ndarray) -> np.ndarray:
        return np.flatnonzero(
            is_too_steep_for_servo(np.diff(poses, axis=0), a_pass.speed_mm_s, cell, was_read)
        )

    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    if not len(outrun(poses)):
        return a_pass
    poses = np.asarray(with_chords(a_pass).poses_mm, dtype=float)
    rows, ways = outrun(poses), np.diff(poses, axis=0)
    presses = ways[rows, 2] < 0
    places = np.where(presses[:, None], poses[rows, :2], poses[rows + 1, :2])
    heights = np.where(presses, poses[rows + 1, 2], poses[rows, 2])
    return on_way(a_pass, np.insert(poses, rows + 1, np.column_stack([places, heights]), axis=0), [])


def _held(places: np.ndarray, least_mm: float) -> np.ndarray:
    """(n,) at which of its rounded places (n, 2) a servo stands: its lift alone names none, and stays where the last
    way ended as long as the sideways part is less than a move."""
    stays = np.arange(len(places))
    near = np.hypot(*(places[1:] - places[:-1]).T) < least_mm
    on, done = places.tolist(), 0
    for row in (np.flatnonzero(near) + 1).tolist():
        if row <= done:
            continue
        for done in range(row, len(on)):
            if dist(on[row - 1], on[done]) >= least_mm:
                break
            stays[done] = row - 1
    return stays


def _split_arcs(arcs, poses: np.ndarray, given_by: str, cell: Cell) -> tuple[list, list]:
    """Return the arcs that are written as circles, those that come back to where they began or beyond in parts, and
    none where no more than a tiny move would go to it or away from it; and the others."""
    unit, least_mm = unit_mm(cell), least_move_mm(cell)

    def is_tiny(first: int, last: int) -> bool:
        return first != last and dist(poses[first], poses[last]) < least_mm

    written_arcs, others, done = [], [], 0
    for part in chain.from_iterable(_parts(arc, poses, CIRCLE_UNITS * unit) for arc in arcs):
        if (
            _is_writable(poses[part.first : part.last + 1, :2], given_by, CIRCLE_UNITS * unit)
            and _is_round(poses[[part.first, part.last], :2] - part.centre_mm, cell)
            and not is_tiny(done, part.first)
            and not is_tiny(part.last, len(poses) - 1)
        ):
            written_arcs.append(part)
            done = part.last
        else:
            others.append(part)
    return written_arcs, others


def _parts(arc, poses: np.ndarray, least_mm: float) -> Iterator:
    """A circle whose end is its beginning, or rounded may be, would be none at all, and one that goes on beyond it
    would lose a turn: both in parts."""
    x, y = arc.centre_mm  # circles have few poses, for which arrays take longer
    angles = [atan2(b - y, a - x) for a, b in poses[arc.first : arc.last + 1, :2].tolist()]
    turns = ((after - before) * arc.direction for before, after in pairwise(angles))
    turned = list(accumulate(((turn + BACK_RAD) % tau - BACK_RAD for turn in turns), initial=0.0))
    first, ends = 0, dist(poses[arc.first, :2], poses[arc.last, :2])
    if turned[-1] >= tau or ends < least_mm:
        share = turned[-1] / max(2, ceil(turned[-1] / PART_RAD)) - 1e-6
        for row in range(1, len(turned) - 1):
            if turned[row] - turned[first] >= share or turned[row + 1] - turned[first] > MOST_RAD:
                yield _core.Arc(arc.first + first, arc.first + row, arc.centre_mm, arc.direction)
                first = row
    yield _core.Arc(arc.first + first, arc.last, arc.centre_mm, arc.direction)


BACK_RAD = 1.0  # rounding may turn tiny steps of a circle back by less
PART_RAD, MOST_RAD = (
    3.5,
    5.0,
)  # of a circle in parts: two of a little more than all round; no part is all round


def _is_round(spokes: np.ndarray, cell: Cell) -> bool:
    """Whether the firmware takes a circle with the spokes (2, 2) to its ends for one, and keeps near it."""
    first, last = (hypot(*spoke) for spoke in spokes.tolist())
    near_mm = MAX_RADIUS_DIFFERENCE_MM.get(cell.language, inf) - 1.5 * unit_mm(
        cell
    )  # its centre is rounded, too
    sagitta_mm = cell.arc_segment_mm**2 / (8 * max(first, 1e-9))
    return abs(first - last) <= near_mm and sagitta_mm <= OFF_MM


def _is_writable(on: np.ndarray, circles_by: str, least_mm: float) -> bool:
    """Return whether points (n, 2) determine a circle: its ends are apart; by a pose on its way, the three are the
    corners of a triangle that is nowhere flatter."""
    if circles_by == "centre":
        return dist(on[0], on[-1]) >= least_mm
    if len(on) < 3:
        return False
    a, b, c = on[0], via_point(on[1:]), on[-1]
    (x, y), (u, v) = b - a, c - a
    longest_mm = max(np.hypot(x, y), np.hypot(u, v), np.hypot(u - x, v - y))
    return bool(abs(x * v - y * u) > least_mm * longest_mm)


def _kept(poses: np.ndarray, ends: set[int], least_mm: float) -> np.ndarray:
    """Which poses are at least so far from the one before: first, last and the ends of circles stay, others give way to
    them."""
    if (np.linalg.norm(np.diff(poses, axis=0), axis=1) >= least_mm).all():
        return np.arange(len(poses))
    places, stay = poses.tolist(), ends | {0, len(poses) - 1}
    kept = [0]
    for row in range(1, len(places)):
        if row in stay:
            while kept[-1] not in stay and dist(places[kept[-1]], places[row]) < least_mm:
                kept.pop()
            kept.append(row)
        elif dist(places[kept[-1]], places[row]) >= least_mm:
            kept.append(row)
    return np.array(kept)
