"""Find where paper can be for an arm to paint on it: the nearest place for a job, and a map of the table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...errors import Notice
from ..cells.cell import Arm, Cell
from ..frames import frame_of_pose, moved, rotation, rotation_deg
from ..motion import Program
from .follow import extremes, far_from_singular, flange_at, follow, lowest_joint_mm, within_limits
from .joints import Joints, frames, joints_of

SHIFTS_MM = (10, 20, 40, 60, 80, 100, 125, 150, 175, 200, 250, 300, 350, 400, 500, 600)
DIRECTIONS = 16
TURNS_DEG = (15, -15, 30, -30, 45, -45, 60, -60, 90, -90, 120, -120, 150, -150, 180)
# Places whose outermost points are in reach are nearly always right; where so many are not, the job is a hopeless one.
MOST_TRIED = 80
NOWHERE = "no shift or turn of the sheet was found that would do"
MOST_SQUARES = 45  # along the longer side of a table
UNREACHED, LIMITED, SINGULAR, REACHED = range(4)  # what a place on the table is to an arm, from worst to best


@dataclass(frozen=True)
class Elsewhere:
    """The place that the paper would need: moved by shift_mm (x, y) of the robot's frame, or turned in its plane about
    the job's middle, about_mm (x, y) of the sheet. frame: (4, 4) it then has in the robot's."""

    shift_mm: tuple[float, float]
    turn_deg: float
    about_mm: tuple[float, float]
    frame: np.ndarray

    @property
    def text(self) -> str:
        if self.turn_deg:
            x, y = self.about_mm
            return f"turned by {self.turn_deg:g} degrees about x {x:.0f}, y {y:.0f} mm of it"
        return "moved by x {:+.0f}, y {:+.0f} mm in the robot's frame".format(*self.shift_mm)


def unreachable(made: Program, allowed: Callable[[Program], bool]) -> list[Notice]:
    """What the arm of a program's cell cannot do of it, with the place of the paper at which it could. allowed: whether
    a program breaks no other limit. Error where there is no library for joints."""
    joints = joints_of(made.cell.arm)
    problems = follow(made, joints).problems
    if not problems:
        return []
    found = nearest(made, joints, allowed)
    advice = f"the sheet {found.text} would do" if found else NOWHERE
    return [replace(problem, advice=advice) for problem in problems]


def nearest(made: Program, joints: Joints, allowed: Callable[[Program], bool]) -> Elsewhere | None:
    """The smallest shift of the paper, or else turn, at which the arm can do the whole program; None where none of
    those tried will do."""
    outermost, tried = extremes(made), 0
    for place in _elsewheres(made, outermost):
        there = at(made, place.frame)
        robot = moved(place.frame, outermost)
        if not all(_some(joints, there.cell, place.frame, each) for each in robot) or not allowed(there):
            continue
        if not follow(there, joints, to_the_end=False).problems:
            return place
        tried += 1
        if tried == MOST_TRIED:
            return None
    return None


def at(made: Program, frame: np.ndarray) -> Program:
    """The program with the paper elsewhere."""
    rise = made.rise_in_robot_mm + frame[2, 3] - made.robot_from_frame[2, 3]
    return replace(made, cell=cell_at(made.cell, frame), robot_from_frame=frame, rise_in_robot_mm=rise)


def cell_at(cell: Cell, frame: np.ndarray) -> Cell:
    """The cell with its paper at a pose (4, 4) in the robot's frame."""
    origin, turned = (
        tuple((np.round(each, 6) + 0.0).tolist()) for each in (frame[:3, 3], rotation_deg(frame[:3, :3]))
    )
    return replace(cell, paper=replace(cell.paper, origin_mm=origin, rotation_deg=turned, taught_mm=()))


def _elsewheres(made: Program, outermost: np.ndarray):
    frame = made.robot_from_frame
    middle = (outermost[:, :2].min(axis=0) + outermost[:, :2].max(axis=0)) / 2
    about = tuple(middle.tolist())
    for length in SHIFTS_MM:
        for angle in np.arange(DIRECTIONS) * 2 * np.pi / DIRECTIONS:
            shift = np.round([length * np.cos(angle), length * np.sin(angle)])
            there = frame.copy()
            there[:2, 3] += shift
            yield Elsewhere(tuple(shift.tolist()), 0.0, about, there)
    for turn in TURNS_DEG:
        back = frame_of_pose((*middle, 0.0), (0.0, 0.0, 0.0))
        there = np.eye(4)
        there[:3, :3] = rotation((0.0, 0.0, turn))
        yield Elsewhere((0.0, 0.0), turn, about, frame @ back @ there @ np.linalg.inv(back))


def _some(joints: Joints, cell: Cell, frame: np.ndarray, robot_mm: np.ndarray) -> bool:
    found = joints.solutions(flange_at(cell, frame, robot_mm))
    within = within_limits(joints.arm, found) & _above_table(joints.arm, found, frame)
    return bool((within & far_from_singular(joints.arm, found, robot_mm)).any())


def _above_table(arm: Arm, joints_rad: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """(k,) which of joints (k, 6) keep all of them above the table; all do where the cell names the posture."""
    return (lowest_joint_mm(frames(arm, joints_rad), frame) >= 0) | bool(arm.posture_deg)


@dataclass(frozen=True)
class Table:
    """x_mm (n,), y_mm (m,): middles of squares on the paper's plane, in the robot's frame; what (m, n): the worst that
    each is to the arm, at the paper and at the safe height."""

    x_mm: np.ndarray
    y_mm: np.ndarray
    what: np.ndarray


def table_of(cell: Cell, frame: np.ndarray, joints: Joints) -> Table:
    """What each square of the table is to the arm: in the cell's box, or as far as the links go."""
    far = sum(float(np.hypot(a, d)) for a, _, d, _ in joints.arm.dh)
    low, high = cell.workspace.box_mm or ((-far,) * 3, (far,) * 3)
    step_mm = max(high[0] - low[0], high[1] - low[1]) / MOST_SQUARES
    x, y = (np.arange(low[k] + step_mm / 2, high[k], step_mm) for k in (0, 1))
    normal, origin = frame[:3, 2], frame[:3, 3]
    what = np.full((len(y), len(x)), REACHED)
    for row, there_y in enumerate(y):
        for column, there_x in enumerate(x):
            there_z = (
                origin[2]
                - ((there_x - origin[0]) * normal[0] + (there_y - origin[1]) * normal[1]) / normal[2]
            )
            paper = np.array([there_x, there_y, there_z])
            for height in (0.0, cell.heights.safe_mm):
                what[row, column] = min(
                    what[row, column], _what(joints, cell, frame, paper + height * normal)
                )
    return Table(x, y, what)


def _what(joints: Joints, cell: Cell, frame: np.ndarray, robot_mm: np.ndarray) -> int:
    found = joints.solutions(flange_at(cell, frame, robot_mm))
    found = found[_above_table(joints.arm, found, frame)]
    if not len(found):
        return UNREACHED
    far, within = far_from_singular(joints.arm, found, robot_mm), within_limits(joints.arm, found)
    if (far & within).any():
        return REACHED
    return LIMITED if far.any() else SINGULAR
