"""Follow an arm's joints along a program and find what the arm cannot do.

The problems are: places out of reach, joint limits, singularities, wrist flips and joints that turn too fast.

A posture is one of the ways in which an arm reaches a place: elbow up or down, shoulder left or right, wrist turned or
not. Straight moves keep the posture. Each posture that reaches the first place is therefore followed from place to
place. The places are at most MAX_PLACE_SPACING_MM apart, and closer until no joint turns by more than
MAX_JOINT_STEP_RAD between two of them. The arm can run a program if one posture reaches its end. Otherwise the problem
of the posture that comes furthest is reported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import chain, islice

import numpy as np

from ...errors import Notice
from ..cells.cell import MIN_WALL_TILT_DEG, Arm, Cell, joint_number
from ..frames import frame_of_pose, normal_tilt_deg, transform_points
from ..moves import Program
from ..posts.script import upright_tool_rotation
from ..tool_axes import between_deg, normalize, rotation_axes, turned_to
from .inverse_kinematics import JointSolver, flange_rates, flange_rates_at, joint_frames_of, refine_angles

MAX_PLACE_SPACING_MM = 5.0
# Number of places that are solved at once. The results do not depend on it. With fewer places, the calls of numpy cost
# time. With more places, Newton's steps start too far away from the last of them and do not reach them.
CHUNK_PLACES = 64
# Largest turn of a joint between two places. A smaller limit costs time, a larger one could miss a peak of speed.
MAX_JOINT_STEP_RAD = np.radians(6.0)
# A joint that turns by MAX_JOINT_STEP_RAD within a smaller step of the tip and turn of the tool is at a singularity.
MIN_STEP_MM, MIN_TURN_DEG = 0.01, 0.05
# Largest turn of a joint for each mm of the tip's path. A joint that turns faster is about a degree from a singularity,
# where arms slow down, stop or shake.
MAX_JOINT_RATE_RAD_MM = np.radians(5.0)
# Joint rate up to which the arm counts as clear of a singularity. Joints before and behind the singularity then show
# whether the wrist turned over.
CALM_JOINT_RATE_RAD_MM = MAX_JOINT_RATE_RAD_MM / 5
FLIP_SEARCH_MM = 30.0  # distance behind a singularity within which a wrist flip is looked for
# A wrist joint that turns by more has flipped, provided that each of the first three joints turns by less.
MIN_FLIP_RAD, MAX_SAME_ARM_TURN_RAD = np.radians(90.0), np.radians(30.0)
ELBOW_JOINT = 2  # joint 3, counted from 0
WRIST_BEND_JOINT, WRIST_TWIST_JOINTS = 4, [3, 5]  # joint 5 bends the wrist, and joints 4 and 6 twist it


@dataclass(frozen=True)
class Place:
    """A place of the brush's tip on its path.

    name: name of the stroke or station.
    paper_mm, robot_mm: (3,) the tip in the paper's and in the robot's frame.
    velocities: (m, 6) velocities of the moves around the place, in the robot's frame, in mm/s and rad/s.
    axis: (3,) unit vector along the brush, upwards, in the paper's frame.
    """

    name: str
    paper_mm: np.ndarray
    robot_mm: np.ndarray
    velocities: np.ndarray
    axis: np.ndarray


@dataclass(frozen=True)
class FollowedProgram:
    """Result of following an arm along a program.

    problems: what the arm cannot do; empty if it can run the whole program.
    start_rad: (6,) joints at the first place in a posture that can run the whole program. Of several such postures,
        the one with the highest elbow. None if there is none.
    """

    problems: tuple[Notice, ...]
    start_rad: np.ndarray | None


@dataclass(frozen=True)
class _Solutions:
    """Joint angles for n places, k solutions each, and what the arm does there.

    angles_rad: (n, k, 6) joint angles of each solution.
    speeds_deg_s: (n, k, 6) largest speed of each joint in the moves around the place.
    most: (n, k) largest turn of any joint for each mm [rad/mm].
    sides: (n, k) side of all singularities. Between two solutions on different sides there is a singularity.
    lowest_mm: (n, k) height of the lowest joint above the table, or in front of a wall.
    is_wall: whether the paper is on a wall.
    """

    angles_rad: np.ndarray
    speeds_deg_s: np.ndarray
    most: np.ndarray
    sides: np.ndarray
    lowest_mm: np.ndarray
    is_wall: bool

    def __getitem__(self, rows) -> _Solutions:
        arrays = (self.angles_rad, self.speeds_deg_s, self.most, self.sides, self.lowest_mm)
        return _Solutions(*(each[rows] for each in arrays), self.is_wall)


@dataclass
class _Posture:
    start_rad: np.ndarray
    here_rad: np.ndarray  # continuous, not wrapped to one turn
    least_rad: np.ndarray
    greatest_rad: np.ndarray
    calm_rad: np.ndarray  # the last joint angles that were clear of singularities
    side: float
    most: float = 0.0
    failure: Notice | None = None
    failed_at: int = -1
    failed: Place | None = None


@dataclass(frozen=True)
class _PlacedArm:
    """An arm with its tool, and the paper in front of it.

    frame: (4, 4) pose of the paper's frame in the robot's frame.
    tilts: whether the brush is tilted anywhere.
    """

    joints: JointSolver
    cell: Cell
    frame: np.ndarray
    tilts: bool

    @property
    def arm(self) -> Arm:
        return self.joints.arm

    def solve(self, place: Place) -> _Solutions:
        """Find all solutions for a place, (1, k)."""
        angles = self.joints.solutions(self.flanges([place])[0])[None]
        return self.rate(angles, joint_frames_of(self.arm, angles), [place])

    def rate(self, angles: np.ndarray, joint_frames: np.ndarray, places: list[Place]) -> _Solutions:
        """Compute what the arm does at angles (n, k, 6) with joints at joint_frames (n, k, 7, 4, 4)."""
        jacobian = flange_rates_at(joint_frames, np.array([place.robot_mm for place in places])[:, None])
        turns = _invert_jacobian(jacobian)
        speeds = [
            np.degrees(np.abs(place.velocities @ turn.swapaxes(-1, -2)).max(axis=-2, initial=0.0))
            for place, turn in zip(places, turns, strict=True)
        ]
        fastest = np.sqrt((turns[..., :3] ** 2).sum(axis=-1)).max(axis=-1, initial=0.0)
        sides, lowest_mm = np.sign(np.linalg.det(jacobian)), lowest_joint_mm(joint_frames, self.frame)
        return _Solutions(angles, np.array(speeds), fastest, sides, lowest_mm, _is_wall(self.frame))

    def flanges(self, places: list[Place]) -> np.ndarray:
        """Return the flange's poses (n, 4, 4) for places, in the robot's frame."""
        upright = self.frame[:3, :3] @ upright_tool_rotation(self.cell.tool.spin_deg)
        tips = np.tile(np.eye(4), (len(places), 1, 1))
        tips[:, :3, :3] = upright
        if self.tilts:
            tips[:, :3, :3] = turned_to(np.array([place.axis for place in places]) @ self.frame[:3, :3].T, upright)
        tips[:, :3, 3] = [place.robot_mm for place in places]
        return tips @ np.linalg.inv(frame_of_pose(self.cell.tool.tcp_mm, self.cell.tool.rotation_deg))


def flange_at(cell: Cell, frame: np.ndarray, robot_mm: np.ndarray) -> np.ndarray:
    """Return the flange's pose (4, 4) for a place of the tip, in the robot's frame.

    The brush is upright on the paper.

    frame: (4, 4) pose of the paper's frame in the robot's frame.
    robot_mm: (3,) place of the tip in the robot's frame.
    """
    tip = np.eye(4)
    tip[:3, :3] = frame[:3, :3] @ upright_tool_rotation(cell.tool.spin_deg)
    tip[:3, 3] = robot_mm
    return tip @ np.linalg.inv(frame_of_pose(cell.tool.tcp_mm, cell.tool.rotation_deg))


def follow(program: Program, joints: JointSolver, to_the_end: bool = True) -> FollowedProgram:
    """Follow the joints of an arm along a program, from the program's first place on.

    How the arm gets to the first place is not known and not checked.
    to_the_end: whether to continue when no posture is left, because a place out of all reach is a better reason.
    """
    placed = _PlacedArm(joints, program.cell, program.robot_from_frame, program.tilts)
    arm, stream = joints.arm, places_of_program(program)
    postures: list[_Posture] = []
    places: list[Place] = []
    before, number = None, 0
    while places := [*places, *islice(stream, CHUNK_PLACES - len(places))]:
        solutions = _continue_solutions(placed, postures, places)
        count = 0 if solutions is None else _advance_together(arm, postures, solutions)
        if not count:
            place, count = places[0], 1
            solutions = placed.solve(place) if solutions is None else solutions[:1]
            if not solutions.angles_rad.size:
                return FollowedProgram((_reach_notice(place, arm),), None)
            postures = postures or _start_postures(arm, solutions)
            for posture in postures:
                if posture.failure is None:
                    _advance_posture(posture, before or place, place, solutions, placed)
                    posture.failed_at, posture.failed = number, place
                elif _may_have_flipped(posture, place.robot_mm):
                    _note_flip(posture, solutions, arm)
            if not to_the_end and all(posture.failure for posture in postures):
                break
        before, number, places = places[count - 1], number + count, places[count:]
    if not postures:
        return FollowedProgram((), None)
    if feasible := [posture.start_rad for posture in postures if posture.failure is None]:
        elbows_mm = joint_frames_of(arm, np.array(feasible))[:, ELBOW_JOINT, 2, 3]
        return FollowedProgram((), feasible[int(np.round(elbows_mm, 3).argmax())])
    return FollowedProgram((max(postures, key=lambda each: each.failed_at).failure,), None)


def lowest_joint_mm(joint_frames: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """Return the height [mm] of the lowest joint above the table, or in front of a wall with the paper, (...).

    Only joints from the elbow on count. The paper may be on a block and the robot on a pedestal. A joint that is lower
    than both the paper and the base is therefore in the table. A wall has no such gaps.

    joint_frames: (..., n + 1, 4, 4) frames of the joints.
    frame: (4, 4) pose of the paper's frame in the robot's frame.
    """
    joints = joint_frames[..., ELBOW_JOINT:-1, :3, 3]
    over_paper = (joints - frame[:3, 3]) @ frame[:3, 2]
    if _is_wall(frame):
        return over_paper.min(axis=-1, initial=np.inf)
    over_base = joints[..., 2] - joint_frames[..., :1, 2, 3]
    return np.maximum(over_paper, over_base).min(axis=-1, initial=np.inf)


def _is_wall(frame: np.ndarray) -> bool:
    return normal_tilt_deg(frame) >= MIN_WALL_TILT_DEG


def _start_postures(arm: Arm, solutions: _Solutions) -> list[_Posture]:
    """Start a posture at each solution for the first place, or only at the one nearest to the cell's posture."""
    angles, sides = solutions.angles_rad[0], solutions.sides[0]
    if arm.posture_deg:
        turns_rad = np.abs(_joint_turns_rad(np.radians(arm.posture_deg), angles)).max(axis=1)
        nearest = (turns_rad + 9.0 * ~within_limits(arm, angles)).argmin()
        angles, sides = angles[[nearest]], sides[[nearest]]
    return [_Posture(*(each.copy() for _ in range(5)), side) for each, side in zip(angles, sides, strict=True)]


def _continue_solutions(placed: _PlacedArm, postures: list[_Posture], places: list[Place]) -> _Solutions | None:
    """Continue each posture that has not failed to the next places, (n, k).

    Newton's steps start from the posture's last angles. n is the number of places up to the first one for which all
    angles must be searched, because a posture does not converge nearby, or has just passed a singularity. Returns None
    if this is the first place.
    """
    previous = np.array([posture.here_rad for posture in postures if posture.failure is None])
    if not len(previous):
        return None
    robot_mm = np.array([place.robot_mm for place in places])
    may_have_flipped = np.any([_may_have_flipped(posture, robot_mm) for posture in postures], axis=0)
    places = places[: _count_first(~may_have_flipped)]
    if not places:
        return None
    most_step_rad = MAX_JOINT_STEP_RAD * np.arange(1, len(places) + 1)[:, None, None]
    angles, joint_frames, has_converged = refine_angles(
        placed.arm, previous, placed.flanges(places)[:, None], most_step_rad
    )
    turns_rad = np.abs(np.diff(angles, axis=0, prepend=previous[None])).max(axis=-1)
    count = _count_first((has_converged & (turns_rad <= MAX_JOINT_STEP_RAD)).all(axis=1))
    return placed.rate(angles[:count], joint_frames[:count], places[:count]) if count else None


def _count_first(flags: np.ndarray) -> int:
    """Return how many of the flags (n,) are true before the first one that is false."""
    return int(np.logical_and.accumulate(flags).sum())


def _advance_together(arm: Arm, postures: list[_Posture], solutions: _Solutions) -> int:
    """Advance all postures that have not failed, along the first places at which none of them breaks a rule.

    solutions: (n, k) the continued solutions of these k postures.

    Returns the number of places. The posture may turn to another solution, or break a rule, at the place that follows.
    """
    following = [posture for posture in postures if posture.failure is None]
    angles = solutions.angles_rad
    before = np.concatenate([[[posture.here_rad for posture in following]], angles[:-1]])
    turns_rad = np.abs(_joint_turns_rad(before[:, :, None], angles[:, None])).max(axis=-1)
    is_nearest = turns_rad.argmin(axis=-1) == np.arange(len(following))
    breaks_rule = np.any(list(_broken_rules(arm, following, solutions).values()), axis=0)
    count = _count_first((is_nearest & ~breaks_rule).all(axis=1))
    if count:
        for number, posture in enumerate(following):
            _move_posture(posture, solutions[:count, number])
    return count


def within_limits(arm: Arm, joints_rad: np.ndarray) -> np.ndarray:
    """Return which joint angles (k, 6) fit their limits after whole turns, (k,)."""
    return ~_leaves_limits(arm, joints_rad, joints_rad)[0].any(axis=-1)


def far_from_singular(arm: Arm, joints_rad: np.ndarray, robot_mm: np.ndarray) -> np.ndarray:
    """Return which joint angles (k, 6) are far from a singularity, (k,).

    There, no joint turns faster than MAX_JOINT_RATE_RAD_MM.
    """
    return np.linalg.norm(joint_rates(arm, joints_rad, robot_mm), axis=-1).max(axis=-1) <= MAX_JOINT_RATE_RAD_MM


def places_of_program(program: Program) -> Iterator[Place]:
    """Yield the places of a program at which the arm is checked.

    They are at and between the ends of moves, at most MAX_PLACE_SPACING_MM apart.
    """
    last_point = last_axis = None
    for section in program.sections():
        moves = section.moves
        if not moves:
            continue
        points = np.vstack([move.points_mm for move in moves])
        axes = None
        if program.tilts:
            axes = np.vstack(
                [np.tile(UPRIGHT_AXIS, (len(m.points_mm), 1)) if m.axes is None else m.axes for m in moves]
            )
        speeds = np.concatenate([np.full(len(move.points_mm), move.speed_mm_s) for move in moves])
        ends = np.cumsum([len(move.points_mm) for move in moves])
        if last_point is not None:
            points, speeds, ends = np.vstack([last_point, points]), np.r_[speeds[:1], speeds], ends + 1
            axes = None if axes is None else np.vstack([last_axis, axes])
        yield from _places_along(
            section.name, points, axes, speeds, ends - 1, program.robot_from_frame, last_point is None
        )
        last_point, last_axis = points[-1], None if axes is None else axes[-1]


UPRIGHT_AXIS = np.array([0.0, 0.0, 1.0])


def _places_along(name, points, axes, speeds, ends, frame, is_first: bool) -> Iterator[Place]:
    robot = transform_points(frame, points)
    steps = np.diff(robot, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    along = np.r_[0.0, np.cumsum(lengths)]
    sampled = np.unique(np.r_[0.0, along[ends], np.arange(MAX_PLACE_SPACING_MM, along[-1], MAX_PLACE_SPACING_MM)])
    turns = np.zeros_like(steps)
    if axes is not None:
        about = rotation_axes(axes[:-1], axes[1:]) @ frame[:3, :3].T
        turns = np.radians(between_deg(axes[1:], axes[:-1]))[:, None] * about
    with np.errstate(invalid="ignore", divide="ignore"):
        ways = np.hstack([steps, turns])
        velocities = np.where(lengths[:, None] > 0, ways / lengths[:, None] * speeds[1:, None], 0.0)
    neighbours = np.r_[sampled[:1], sampled, sampled[-1:]]
    first = np.maximum(np.searchsorted(along, neighbours[:-2], "right") - 1, 0)
    last = np.searchsorted(along, neighbours[2:], "left")
    at = np.column_stack([np.interp(sampled, along, column) for column in np.hstack([points, robot]).T])
    tilted = np.tile(UPRIGHT_AXIS, (len(sampled), 1))
    if axes is not None:
        tilted = normalize(np.column_stack([np.interp(sampled, along, component) for component in axes.T]))
    # A section begins at the place where the previous one ended.
    for k in range(0 if is_first else 1, len(sampled)):
        yield Place(name, at[k, :3], at[k, 3:], velocities[first[k] : last[k]], tilted[k])


def _advance_posture(posture: _Posture, before: Place, place: Place, solutions: _Solutions, placed: _PlacedArm) -> None:
    """Advance a posture to the next place, or set its failure.

    The path is halved where a joint would turn by more than MAX_JOINT_STEP_RAD.

    solutions: (1, k) the solutions for the place.
    """
    arm = placed.arm
    turns = _joint_turns_rad(posture.here_rad, solutions.angles_rad[0])
    turns_rad = np.abs(turns).max(axis=1)
    nearest = int(turns_rad.argmin())
    if turns_rad[nearest] > MAX_JOINT_STEP_RAD:
        same_axis = between_deg(place.axis, before.axis) < MIN_TURN_DEG
        if same_axis and np.linalg.norm(place.robot_mm - before.robot_mm) < MIN_STEP_MM:
            posture.failure = _near_singularity_notice(place, arm, posture.here_rad, posture.most)
            return
        middle = (before.paper_mm + place.paper_mm) / 2, (before.robot_mm + place.robot_mm) / 2
        half = Place(place.name, *middle, place.velocities, normalize(before.axis + place.axis))
        half_solutions = placed.solve(half)
        if not half_solutions.angles_rad.size:
            posture.failure = _reach_notice(half, arm)
            return
        _advance_posture(posture, before, half, half_solutions, placed)
        if posture.failure is None:
            _advance_posture(posture, half, place, solutions, placed)
        return
    reached = replace(solutions[:, [nearest]], angles_rad=(posture.here_rad + turns[nearest])[None, None])
    for write_notice, is_broken in _broken_rules(arm, [posture], reached).items():
        if is_broken.any():
            posture.failure = write_notice(place, arm, posture, reached[0, 0])
            return
    _move_posture(posture, reached[:, 0])


def _broken_rules(arm: Arm, postures: list[_Posture], solutions: _Solutions) -> dict[Callable, np.ndarray]:
    """Return which rules k postures break at their solutions (n, k) for the next places.

    Each rule has the function that reports it, and the places and postures (n, k) that break it.
    """
    angles = solutions.angles_rad
    least = np.minimum.accumulate([[posture.least_rad for posture in postures], *angles])[1:]
    greatest = np.maximum.accumulate([[posture.greatest_rad for posture in postures], *angles])[1:]
    # Without speeds in the cell, no speed is checked.
    fastest = np.array(arm.speeds_deg_s or np.inf)
    return {
        _crossed_singularity_notice: solutions.sides != [posture.side for posture in postures],
        _limit_notice: _leaves_limits(arm, least, greatest)[0].any(axis=-1),
        _rate_notice: solutions.most > MAX_JOINT_RATE_RAD_MM,
        _speed_notice: (solutions.speeds_deg_s / fastest > 1 + 1e-9).any(axis=-1),
        _table_notice: (solutions.lowest_mm < 0) & (not arm.posture_deg),
    }


def _move_posture(posture: _Posture, solutions: _Solutions) -> None:
    """Move a posture along its solutions (n,) for the next places, which break no rule."""
    angles = solutions.angles_rad
    posture.least_rad = np.minimum(posture.least_rad, angles.min(axis=0))
    posture.greatest_rad = np.maximum(posture.greatest_rad, angles.max(axis=0))
    posture.here_rad, posture.most = angles[-1], solutions.most[-1]
    is_calm = solutions.most <= CALM_JOINT_RATE_RAD_MM
    if is_calm.any():
        posture.calm_rad = angles[is_calm][-1]


def _joint_turns_rad(here_rad: np.ndarray, solutions: np.ndarray) -> np.ndarray:
    """Return the turn [rad] of each joint to each solution (k, 6), the short way."""
    return (solutions - here_rad + np.pi) % (2 * np.pi) - np.pi


def joint_rates(arm: Arm, joints_rad: np.ndarray, robot_mm: np.ndarray) -> np.ndarray:
    """Return the turn [rad] of each joint for each mm of the tip, (..., 6, 3).

    The tip moves along x, y or z without turning.
    """
    return _invert_jacobian(flange_rates(arm, joints_rad, robot_mm))[..., :3]


def _invert_jacobian(jacobian: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.inv(jacobian)
    except np.linalg.LinAlgError:  # exactly at a singularity, near which the joints turn equally fast
        return np.linalg.inv(jacobian + 1e-9 * np.eye(6))


def _leaves_limits(arm: Arm, least_rad: np.ndarray, greatest_rad: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which joints leave their limits, and the whole turns of the others.

    A joint leaves its limits if no number of whole turns helps.

    least_rad, greatest_rad: (..., 6) smallest and largest angle of each joint on its path. Both results are (..., 6).
    """
    low, high = np.radians(np.array(arm.limits_deg)).T
    turns = np.ceil((low - least_rad) / (2 * np.pi) - 1e-9)
    return greatest_rad + 2 * np.pi * turns > high + 1e-9, turns


def _limit_notice(place: Place, arm: Arm, posture: _Posture, reached: _Solutions) -> Notice:
    angles = reached.angles_rad
    beyond, _ = _leaves_limits(arm, np.minimum(posture.least_rad, angles), np.maximum(posture.greatest_rad, angles))
    joint = int(beyond.argmax())
    low, high = arm.limits_deg[joint]
    # These whole turns kept the joint within its limits before this place.
    _, turns = _leaves_limits(arm, posture.least_rad, posture.greatest_rad)
    angle = np.degrees(angles[joint]) + 360 * turns[joint]
    if not angle < low and angle - high > low - (angle - 360):  # at the first place, report the nearer limit
        angle -= 360
    sentence = (
        f"{_near(place)} {_joint(arm, joint)} would turn to {angle:.1f} degrees, outside the range [{low:g}, {high:g}] "
        f"degrees of arm {arm.name}"
    )
    return Notice(place.name, sentence, code="joint-limit", about=str(joint_number(arm, joint)))


def _speed_notice(place: Place, arm: Arm, posture: _Posture, reached: _Solutions) -> Notice:
    worst = int((reached.speeds_deg_s / np.array(arm.speeds_deg_s)).argmax())
    sentence = (
        f"{_near(place)} {_joint(arm, worst)} would turn at {reached.speeds_deg_s[worst]:.0f} degrees/s, outside the "
        f"range [0, {arm.speeds_deg_s[worst]:g}] degrees/s of arm {arm.name}"
    )
    return Notice(place.name, sentence, code="joint-too-fast", about=str(joint_number(arm, worst)))


def _table_notice(place: Place, arm: Arm, posture: _Posture, reached: _Solutions) -> Notice:
    side = "behind the paper" if reached.is_wall else "below the table, lower than the paper and its base"
    sentence = f"{_near(place)} a joint of arm {arm.name} would be {-reached.lowest_mm:.0f} mm {side}"
    return Notice(place.name, sentence, code="joint-below-table")


def _reach_notice(place: Place, arm: Arm) -> Notice:
    at = ", ".join(f"{value:.1f}" for value in place.robot_mm)
    sentence = f"{_near(place)} the brush is out of reach of arm {arm.name}: ({at}) mm in the robot's frame"
    return Notice(place.name, sentence, code="arm-out-of-reach")


def _crossed_singularity_notice(place: Place, arm: Arm, posture: _Posture, reached: _Solutions) -> Notice:
    sentence = f"{_near(place)} arm {arm.name} passes through a singularity, where its joints turn too fast or it stops"
    return Notice(place.name, sentence, code="singularity")


def _rate_notice(place: Place, arm: Arm, posture: _Posture, reached: _Solutions) -> Notice:
    return _near_singularity_notice(place, arm, reached.angles_rad, float(reached.most))


def _near_singularity_notice(place: Place, arm: Arm, joints_rad: np.ndarray, most: float) -> Notice:
    worst = int(np.linalg.norm(joint_rates(arm, joints_rad, place.robot_mm), axis=1).argmax())
    sentence = (
        f"{_near(place)} arm {arm.name} comes near a singularity: {_joint(arm, worst)} would turn by "
        f"{np.degrees(most):.1f} degrees for each mm, more than {np.degrees(MAX_JOINT_RATE_RAD_MM):g}"
    )
    return Notice(place.name, sentence, code="singularity", about=str(joint_number(arm, worst)))


def _may_have_flipped(posture: _Posture, robot_mm: np.ndarray) -> np.ndarray:
    """Return which places (..., 3) within FLIP_SEARCH_MM behind the singularity can show a wrist flip, (...)."""
    failure = posture.failure
    if failure is None or failure.code != "singularity":
        return np.zeros(robot_mm.shape[:-1], dtype=bool)
    return np.linalg.norm(robot_mm - posture.failed.robot_mm, axis=-1) <= FLIP_SEARCH_MM


def _note_flip(posture: _Posture, solutions: _Solutions, arm: Arm) -> None:
    """Report a singularity as a wrist flip if the wrist has turned over.

    Only solutions that are clear of the singularity again, and bend the wrist as before, are compared.
    """
    angles = solutions.angles_rad[0]
    turns = _joint_turns_rad(posture.calm_rad, angles)
    bends = np.sin(angles[:, WRIST_BEND_JOINT]) * np.sin(posture.calm_rad[WRIST_BEND_JOINT])
    is_flip = (
        (np.abs(turns[:, :3]).max(axis=1) < MAX_SAME_ARM_TURN_RAD)
        & (bends > 0)
        & (solutions.most[0] <= CALM_JOINT_RATE_RAD_MM)
    )
    for turn in turns[is_flip]:
        joint = WRIST_TWIST_JOINTS[int(np.abs(turn[WRIST_TWIST_JOINTS]).argmax())]
        if abs(turn[joint]) > MIN_FLIP_RAD:
            sentence = (
                f"{_near(posture.failed)} the wrist of arm {arm.name} would flip: {_joint(arm, joint)} would turn by "
                f"{np.degrees(abs(turn[joint])):.0f} degrees on the way past a singularity"
            )
            posture.failure = Notice(posture.failed.name, sentence, code="wrist-flip")
            return


def _joint(arm: Arm, joint: int) -> str:
    return f"joint {joint_number(arm, joint)}"


def _near(place: Place) -> str:
    return f"near x {place.paper_mm[0]:.1f}, y {place.paper_mm[1]:.1f} mm"


def outermost_places(program: Program) -> np.ndarray:
    """Return a few outermost places (n, 3) [mm] of a program, in the program's frame.

    What the arm can do at these places, it can mostly do between them.
    """
    points = np.vstack(list(chain.from_iterable([m.points_mm for m in s.moves] for s in program.sections())))
    turns = np.radians(np.arange(0, 360, 45))
    ways = np.column_stack([np.cos(turns), np.sin(turns)])
    outermost = points[np.unique((points[:, :2] @ ways.T).argmax(axis=0))]
    heights = points[:, 2].min(), points[:, 2].max()
    return np.vstack([np.column_stack([outermost[:, :2], np.full(len(outermost), z)]) for z in heights])
