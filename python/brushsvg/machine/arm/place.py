"""Find places of the paper within reach of an arm, and map the table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...errors import Notice
from ..cells.cell import Arm, Cell
from ..frames import frame_of_pose, rotation, rotation_deg, transform_points
from ..moves import Program
from .follow_joints import far_from_singular, flange_at, follow, lowest_joint_mm, outermost_places, within_limits
from .inverse_kinematics import JointSolver, joint_frames_of, joints_of

TRIED_SHIFTS_MM = (10, 20, 40, 60, 80, 100, 125, 150, 175, 200, 250, 300, 350, 400, 500, 600)
SHIFT_DIRECTIONS = 16
TRIED_TURNS_DEG = (15, -15, 30, -30, 45, -45, 60, -60, 90, -90, 120, -120, 150, -150, 180)
# Largest number of places whose outermost points are in reach and that are followed completely. Nearly all such places
# are right. After so many failures, the search gives up.
MAX_FOLLOWED_PLACES = 80
NO_PLACE_FOUND = "no shift or turn of the sheet was found at which the arm reaches everything"
MAX_TABLE_SQUARES = 45  # squares along the longer side of the table
UNREACHED, LIMITED, SINGULAR, REACHED = range(4)  # ratings of a place on the table, from worst to best


@dataclass(frozen=True)
class PaperPlace:
    """A place for the paper, found by moving or turning the sheet.

    shift_mm: shift (x, y) in the robot's frame.
    turn_deg: turn in the paper's plane about the middle of the job.
    about_mm: middle of the job (x, y) on the sheet.
    frame: (4, 4) pose of the paper's frame in the robot's frame, at this place.
    """

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


def find_unreachable(program: Program, allowed: Callable[[Program], bool] | None = None) -> list[Notice]:
    """Report what the arm of a program's cell cannot do.

    The advice is a place of the paper at which the arm can do it.

    allowed: returns whether a program breaks no other limit. Without it there is no advice.

    Raises Error if the library for joints is not installed.
    """
    joints = joints_of(program.cell.arm)
    problems = follow(program, joints).problems
    if not problems or allowed is None:
        return list(problems)
    place = find_nearest_place(program, joints, allowed)
    advice = f"the arm reaches everything with the sheet {place.text}" if place else NO_PLACE_FOUND
    return [replace(problem, advice=advice) for problem in problems]


def find_nearest_place(program: Program, joints: JointSolver, allowed: Callable[[Program], bool]) -> PaperPlace | None:
    """Find the nearest place of the paper at which the arm can run a program.

    Shifts of the paper are tried first, then turns. Returns None if no place that was tried works.
    """
    outermost_mm, followed_count = outermost_places(program), 0
    for place in _tried_places(program, outermost_mm):
        moved_program = move_paper(program, place.frame)
        robot_points_mm = transform_points(place.frame, outermost_mm)
        if not all(
            _can_reach(joints, moved_program.cell, place.frame, point) for point in robot_points_mm
        ) or not allowed(moved_program):
            continue
        if not follow(moved_program, joints, to_the_end=False).problems:
            return place
        followed_count += 1
        if followed_count == MAX_FOLLOWED_PLACES:
            return None
    return None


def move_paper(program: Program, frame: np.ndarray) -> Program:
    """Return the program with the paper at a pose (4, 4) in the robot's frame."""
    rise = program.rise_in_robot_mm + frame[2, 3] - program.robot_from_frame[2, 3]
    return replace(program, cell=move_paper_of_cell(program.cell, frame), robot_from_frame=frame, rise_in_robot_mm=rise)


def move_paper_of_cell(cell: Cell, frame: np.ndarray) -> Cell:
    """Return the cell with the paper at a pose (4, 4) in the robot's frame."""
    origin, turned = (tuple((np.round(each, 6) + 0.0).tolist()) for each in (frame[:3, 3], rotation_deg(frame[:3, :3])))
    return replace(cell, paper=replace(cell.paper, origin_mm=origin, rotation_deg=turned, taught_mm=()))


def _tried_places(program: Program, outermost: np.ndarray):
    frame = program.robot_from_frame
    middle = (outermost[:, :2].min(axis=0) + outermost[:, :2].max(axis=0)) / 2
    about = tuple(middle.tolist())
    for length in TRIED_SHIFTS_MM:
        for angle in np.arange(SHIFT_DIRECTIONS) * 2 * np.pi / SHIFT_DIRECTIONS:
            shift = np.round([length * np.cos(angle), length * np.sin(angle)])
            moved_frame = frame.copy()
            moved_frame[:2, 3] += shift
            yield PaperPlace(tuple(shift.tolist()), 0.0, about, moved_frame)
    for turn in TRIED_TURNS_DEG:
        frame_at_middle = frame_of_pose((*middle, 0.0), (0.0, 0.0, 0.0))
        moved_frame = np.eye(4)
        moved_frame[:3, :3] = rotation((0.0, 0.0, turn))
        yield PaperPlace(
            (0.0, 0.0), turn, about, frame @ frame_at_middle @ moved_frame @ np.linalg.inv(frame_at_middle)
        )


def _can_reach(joints: JointSolver, cell: Cell, frame: np.ndarray, robot_mm: np.ndarray) -> bool:
    angles = joints.solutions(flange_at(cell, frame, robot_mm), at_singularities=False)
    is_allowed = within_limits(joints.arm, angles) & _is_above_table(joints.arm, angles, frame)
    return bool((is_allowed & far_from_singular(joints.arm, angles, robot_mm)).any())


def _is_above_table(arm: Arm, joints_rad: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """Return for which joint angles (k, 6) all joints stay above the table, (k,).

    All angles count as above the table if the cell gives the posture.
    """
    return (lowest_joint_mm(joint_frames_of(arm, joints_rad), frame) >= 0) | bool(arm.posture_deg)


@dataclass(frozen=True)
class ReachTable:
    """A map of the paper's plane that shows where an arm can paint: of the table, or of a wall.

    axes: the two axes of the robot's frame that the map shows, 0 to 2: to the right, and up.
    x_mm (n,), y_mm (m,): middles of the squares along these axes, on the paper's plane, in the robot's frame.
    what (m, n): the worse rating of each square, at the paper and at the safe height.
    """

    axes: tuple[int, int]
    x_mm: np.ndarray
    y_mm: np.ndarray
    what: np.ndarray


def rate_table(cell: Cell, frame: np.ndarray, joints: JointSolver) -> ReachTable:
    """Rate each square of the paper's plane for the arm.

    The plane is seen along the axis of the robot's frame that is nearest to its normal. The map covers the cell's box,
    or the area that the links reach.
    """
    reach_mm = sum(float(np.hypot(a, d)) for a, _, d, _ in joints.arm.dh)
    low, high = cell.workspace.box_mm or ((-reach_mm,) * 3, (reach_mm,) * 3)
    normal, origin = frame[:3, 2], frame[:3, 3]
    # A paper that leans 45 degrees is seen from above.
    along = max((2, 1, 0), key=lambda axis: round(abs(float(normal[axis])), 6))
    axes = tuple(axis for axis in range(3) if axis != along)
    step_mm = max(high[axis] - low[axis] for axis in axes) / MAX_TABLE_SQUARES
    x, y = (np.arange(low[axis] + step_mm / 2, high[axis], step_mm) for axis in axes)
    what = np.full((len(y), len(x)), REACHED)
    paper_point = origin.copy()
    for row, paper_point[axes[1]] in enumerate(y):
        for column, paper_point[axes[0]] in enumerate(x):
            paper_point[along] = origin[along]
            paper_point[along] -= (paper_point - origin) @ normal / normal[along]
            for height in (0.0, cell.heights.safe_mm):
                what[row, column] = min(
                    what[row, column], _rate_place(joints, cell, frame, paper_point + height * normal)
                )
    return ReachTable((axes[0], axes[1]), x, y, what)


def _rate_place(joints: JointSolver, cell: Cell, frame: np.ndarray, robot_mm: np.ndarray) -> int:
    angles = joints.solutions(flange_at(cell, frame, robot_mm), at_singularities=False)
    angles = angles[_is_above_table(joints.arm, angles, frame)]
    if not len(angles):
        return UNREACHED
    is_regular, is_within = far_from_singular(joints.arm, angles, robot_mm), within_limits(joints.arm, angles)
    if (is_regular & is_within).any():
        return REACHED
    return LIMITED if is_regular.any() else SINGULAR
