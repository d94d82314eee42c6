"""An arm's joints along a whole program: out of reach, limits, singularities, flips of the wrist, joints too fast.

A posture is one of the ways in which an arm reaches a place: elbow up or down, shoulder left or right, wrist turned or
not. Straight moves keep it. So each posture that reaches the first place is followed from place to place, at most
STEP_MM apart, and closer until no joint turns by more than SAME_RAD between two. What one of them does to the end, the
arm can do; else the problem of the one that comes farthest is reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np

from ...errors import Notice
from ..cells.cell import Arm, Cell, joint_number
from ..frames import frame_of_pose, moved
from ..motion import Program
from ..posts.script import down
from ..tool_axes import across, between_deg, turned_to, unit
from .joints import Joints, flange_rates, frames, rates_at, towards

STEP_MM = 5.0
# Joints may turn by so much between two places: less would only cost time, more could pass a peak of speed unseen.
SAME_RAD = np.radians(6.0)
# a joint that turns by SAME_RAD within less is at a singularity
LEAST_STEP_MM, LEAST_TURN_DEG = 0.01, 0.05
# A joint that turns by more for each mm is about a degree from a singularity: arms slow down there, stop or shake.
SINGULAR_RAD_MM = np.radians(5.0)
CALM_RAD_MM = (
    SINGULAR_RAD_MM / 5
)  # before and behind a singularity, where joints show whether the wrist turned over
AHEAD_MM = 30.0  # so far behind it that is looked for
FLIP_RAD, SAME_ARM_RAD = np.radians(90.0), np.radians(30.0)
ELBOW = 2  # joint 3
BENDS, TWISTS = 4, [3, 5]  # joint 5 bends a wrist, 4 and 6 twist it


@dataclass(frozen=True)
class Place:
    """name: of the stroke; paper_mm, robot_mm: (3,) the tip; velocities: (m, 6) of the moves around it, in the robot's
    frame, mm/s and rad/s; axis: (3,) in the paper's frame, along the brush, up."""

    name: str
    paper_mm: np.ndarray
    robot_mm: np.ndarray
    velocities: np.ndarray
    axis: np.ndarray


@dataclass(frozen=True)
class Followed:
    """problems: what the arm cannot do, empty when it can; start_rad: (6,) joints at the first place in a posture that
    does it all, of several the one with the highest elbow."""

    problems: tuple[Notice, ...]
    start_rad: np.ndarray | None


@dataclass(frozen=True)
class _Found:
    """All angles (k, 6) for a place, and how the joints then turn for each mm and rad (k, 6, 6), see rates."""

    angles_rad: np.ndarray
    rates: np.ndarray
    most: np.ndarray  # (k,) of any joint, by mm
    sides: np.ndarray  # (k,) on which side of all singularities: where two differ, there is one between them
    lowest_mm: np.ndarray  # (k,) how far the lowest joint is above the table


@dataclass
class _Posture:
    start_rad: np.ndarray
    here_rad: np.ndarray  # not wrapped
    least_rad: np.ndarray
    greatest_rad: np.ndarray
    calm_rad: np.ndarray  # before it came near a singularity
    most: float = 0.0
    side: float = 0.0
    failure: Notice | None = None
    failed_at: int = -1
    failed: Place | None = None
    beyond_deg: float = 0.0  # of its limits a joint is, where that is the reason


def flange_at(cell: Cell, frame: np.ndarray, robot_mm: np.ndarray) -> np.ndarray:
    """(4, 4) the flange, in the robot's frame, that holds the tip at a place with the brush upright on the paper."""
    tip = np.eye(4)
    tip[:3, :3] = frame[:3, :3] @ down(cell.tool.spin_deg)
    tip[:3, 3] = robot_mm
    return tip @ np.linalg.inv(frame_of_pose(cell.tool.tcp_mm, cell.tool.rotation_deg))


def follow(made: Program, joints: Joints, to_the_end: bool = True) -> Followed:
    """The joints of the arm along a program, from its first place on; how it gets there nobody knows. to_the_end: where
    no posture is left it goes on, since what is out of all reach is the better reason."""
    cell, arm, frame = made.cell, joints.arm, made.robot_from_frame
    behind = np.linalg.inv(frame_of_pose(cell.tool.tcp_mm, cell.tool.rotation_deg))
    upright = frame[:3, :3] @ down(cell.tool.spin_deg)

    def flange(place: Place) -> np.ndarray:
        tip = np.eye(4)
        tip[:3, :3] = turned_to(frame[:3, :3] @ place.axis, upright) if made.tilts else upright
        tip[:3, 3] = place.robot_mm
        return tip @ behind

    def find(place: Place) -> _Found:
        angles = joints.solutions(flange(place))
        return _found(angles, frames(arm, angles), place, frame)

    postures: list[_Posture] | None = None
    before = None
    for number, place in enumerate(places(made)):
        found = (_gone_on(arm, postures, flange(place), place, frame) if postures else None) or find(place)
        if not len(found.angles_rad):
            return Followed((_out_of_reach(place, arm),), None)
        if postures is None:
            begun = found.angles_rad
            if arm.posture_deg:
                far = np.abs(_turned(np.radians(arm.posture_deg), begun)).max(axis=1)
                begun = begun[[(far + 9.0 * ~within_limits(arm, begun)).argmin()]]
            postures = [_Posture(*(angles.copy() for _ in range(5))) for angles in begun]
        for posture in postures:
            if posture.failure is None:
                _go_on(posture, before, place, found, find, arm)
                posture.failed_at, posture.failed = number, place
            elif _may_have_flipped(posture, place.robot_mm):
                _note_flip(posture, found, arm)
        before = place
        if not to_the_end and all(posture.failure for posture in postures):
            break
    if not postures:
        return Followed((), None)
    if able := [posture.start_rad for posture in postures if posture.failure is None]:
        elbows_mm = frames(arm, np.array(able))[:, ELBOW, 2, 3]
        return Followed((), able[int(np.round(elbows_mm, 3).argmax())])
    return Followed((max(postures, key=lambda each: (each.failed_at, -each.beyond_deg)).failure,), None)


def _found(angles: np.ndarray, there: np.ndarray, place: Place, frame: np.ndarray) -> _Found:
    jacobian = rates_at(there, place.robot_mm)
    turns = _inverse(jacobian)
    most = np.sqrt((turns[..., :3] ** 2).sum(axis=-1)).max(axis=-1, initial=0.0)
    return _Found(angles, turns, most, np.sign(np.linalg.det(jacobian)), lowest_joint_mm(there, frame))


def lowest_joint_mm(there: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """(...) how far the lowest joint from the elbow on is above the table, by the frames (..., n + 1, 4, 4) of joints.
    Paper may be on a block and a robot stand on a pedestal: what is lower than both paper and base is in the table.

    frame: (4, 4) the paper's in the robot's.
    """
    joints = there[..., ELBOW:-1, :3, 3]
    over_paper = (joints - frame[:3, 3]) @ frame[:3, 2]
    over_base = joints[..., 2] - there[..., :1, 2, 3]
    return np.maximum(over_paper, over_base).min(axis=-1, initial=np.inf)


def _gone_on(
    arm: Arm, postures: list[_Posture], flange: np.ndarray, place: Place, frame: np.ndarray
) -> _Found | None:
    """Return the angles of postures that go on, each by Newton's steps from where it was; None where all angles for a
    place must be searched: one comes nowhere near, or a singularity is behind one."""
    if any(_may_have_flipped(posture, place.robot_mm) for posture in postures):
        return None
    here = [posture.here_rad for posture in postures if posture.failure is None]
    if not here:
        return None
    before = np.array(here)
    angles, there = towards(arm, before, flange, 5, SAME_RAD)
    if there is None or np.abs(angles - before).max() > SAME_RAD:
        return None
    return _found(angles, there, place, frame)


def within_limits(arm: Arm, joints_rad: np.ndarray) -> np.ndarray:
    """(k,) which of joints (k, 6) can be had within their limits, by whole turns."""
    return ~_beyond(arm, joints_rad, joints_rad)[0].any(axis=-1)


def far_from_singular(arm: Arm, joints_rad: np.ndarray, robot_mm: np.ndarray) -> np.ndarray:
    """(k,) at which of joints (k, 6) none turns by more than SINGULAR_RAD_MM for each mm."""
    return np.linalg.norm(rates(arm, joints_rad, robot_mm), axis=-1).max(axis=-1) <= SINGULAR_RAD_MM


def places(made: Program) -> Iterator[Place]:
    """Where the tip is looked at: at the ends of moves and between them, at most STEP_MM apart."""
    here = held = None
    for section in made.sections():
        moves = section.moves
        if not moves:
            continue
        points = np.vstack([move.points_mm for move in moves])
        axes = None
        if made.tilts:
            axes = np.vstack(
                [np.tile(UP, (len(m.points_mm), 1)) if m.axes is None else m.axes for m in moves]
            )
        speeds = np.concatenate([np.full(len(move.points_mm), move.speed_mm_s) for move in moves])
        ends = np.cumsum([len(move.points_mm) for move in moves])
        if here is not None:
            points, speeds, ends = np.vstack([here, points]), np.r_[speeds[:1], speeds], ends + 1
            axes = None if axes is None else np.vstack([held, axes])
        yield from _along(section.name, points, axes, speeds, ends - 1, made.robot_from_frame, here is None)
        here, held = points[-1], None if axes is None else axes[-1]


UP = np.array([0.0, 0.0, 1.0])


def _along(name, points, axes, speeds, ends, frame, is_first: bool) -> Iterator[Place]:
    robot = moved(frame, points)
    steps = np.diff(robot, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    along = np.r_[0.0, np.cumsum(lengths)]
    looked = np.unique(np.r_[0.0, along[ends], np.arange(STEP_MM, along[-1], STEP_MM)])
    turns = np.zeros_like(steps)
    if axes is not None:
        about = across(axes[:-1], axes[1:]) @ frame[:3, :3].T
        turns = np.radians(between_deg(axes[1:], axes[:-1]))[:, None] * about
    with np.errstate(invalid="ignore", divide="ignore"):
        ways = np.hstack([steps, turns])
        velocities = np.where(lengths[:, None] > 0, ways / lengths[:, None] * speeds[1:, None], 0.0)
    around = np.r_[looked[:1], looked, looked[-1:]]
    first = np.maximum(np.searchsorted(along, around[:-2], "right") - 1, 0)
    last = np.searchsorted(along, around[2:], "left")
    for k, at in enumerate(looked):
        if k == 0 and not is_first:
            continue  # where the section before ended
        paper_mm, robot_mm = (
            np.array([np.interp(at, along, axis) for axis in path.T]) for path in (points, robot)
        )
        axis = UP if axes is None else unit(np.array([np.interp(at, along, each) for each in axes.T]))
        yield Place(name, paper_mm, robot_mm, velocities[first[k] : last[k]], axis)


def _go_on(posture: _Posture, before: Place | None, place: Place, found: _Found, find, arm: Arm) -> None:
    """The posture at the next place, by halves of the way where its joints turn far; or what forbids it."""
    turns = _turned(posture.here_rad, found.angles_rad)
    far = np.abs(turns).max(axis=1)
    which = int(far.argmin())
    if before is not None and far[which] > SAME_RAD:
        is_held = between_deg(place.axis, before.axis) < LEAST_TURN_DEG
        if is_held and np.linalg.norm(place.robot_mm - before.robot_mm) < LEAST_STEP_MM:
            posture.failure = _near_singularity(place, arm, posture.most, posture.here_rad)
            return
        middle = (before.paper_mm + place.paper_mm) / 2, (before.robot_mm + place.robot_mm) / 2
        half = Place(place.name, *middle, place.velocities, unit(before.axis + place.axis))
        between = find(half)
        if not len(between.angles_rad):
            posture.failure = _out_of_reach(half, arm)
            return
        _go_on(posture, before, half, between, find, arm)
        if posture.failure is None:
            _go_on(posture, half, place, found, find, arm)
        return
    posture.here_rad = posture.here_rad + turns[which]
    posture.most = found.most[which]
    if before is not None and found.sides[which] != posture.side:
        posture.failure = _through_singularity(place, arm)
        return
    posture.side = found.sides[which]
    posture.failure = _forbidden(posture, place, found.rates[which], arm)
    if posture.failure is None and not arm.posture_deg and found.lowest_mm[which] < 0:
        sentence = (
            f"{_near(place)} a joint of arm {arm.name} would be {-found.lowest_mm[which]:.0f} mm below the table, "
            "lower than the paper and its base"
        )
        posture.failure = Notice(place.name, sentence, code="joint-below-table")


def _turned(here_rad: np.ndarray, found: np.ndarray) -> np.ndarray:
    """(k, 6) how far each joint turns to each of solutions (k, 6), the short way round."""
    return (found - here_rad + np.pi) % (2 * np.pi) - np.pi


def rates(arm: Arm, joints_rad: np.ndarray, robot_mm: np.ndarray) -> np.ndarray:
    """(..., 6, 3) how each joint turns [rad] for each mm that the tip goes along x, y or z and does not turn."""
    return _inverse(flange_rates(arm, joints_rad, robot_mm))[..., :3]


def _inverse(jacobian: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.inv(jacobian)
    except np.linalg.LinAlgError:  # at a singularity to the last digit: anything near it turns as fast
        return np.linalg.inv(jacobian + 1e-9 * np.eye(6))


def _forbidden(posture: _Posture, place: Place, turns: np.ndarray, arm: Arm) -> Notice | None:
    angles = posture.here_rad
    least, greatest = np.minimum(posture.least_rad, angles), np.maximum(posture.greatest_rad, angles)
    beyond, _ = _beyond(arm, least, greatest)
    if beyond.any():
        return _beyond_limit(place, arm, int(beyond.argmax()), posture)
    posture.least_rad, posture.greatest_rad = least, greatest
    if posture.most > SINGULAR_RAD_MM:
        return _near_singularity(place, arm, posture.most, angles)
    if posture.most <= CALM_RAD_MM:
        posture.calm_rad = angles
    if len(place.velocities) and arm.speeds_deg_s:
        fastest = np.degrees(np.abs(place.velocities @ turns.T).max(axis=0))
        over = fastest / np.array(arm.speeds_deg_s)
        if over[worst := int(over.argmax())] > 1 + 1e-9:
            sentence = (
                f"{_near(place)} {_joint(arm, worst)} would turn at {fastest[worst]:.0f} degrees/s, outside the range "
                f"[0, {arm.speeds_deg_s[worst]:g}] degrees/s of arm {arm.name}"
            )
            return Notice(place.name, sentence, code="joint-too-fast", about=str(joint_number(arm, worst)))
    return None


def _beyond(arm: Arm, least_rad: np.ndarray, greatest_rad: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(..., 6) of joints that go from least to greatest, which leave their limits however they are turned by whole
    turns; and by how many the others are."""
    low, high = np.radians(np.array(arm.limits_deg)).T
    turns = np.ceil((low - least_rad) / (2 * np.pi) - 1e-9)
    return greatest_rad + 2 * np.pi * turns > high + 1e-9, turns


def _beyond_limit(place: Place, arm: Arm, joint: int, posture: _Posture) -> Notice:
    low, high = arm.limits_deg[joint]
    _, turns = _beyond(arm, posture.least_rad, posture.greatest_rad)  # as it came here
    angle = np.degrees(posture.here_rad[joint]) + 360 * turns[joint]
    if not angle < low and angle - high > low - (
        angle - 360
    ):  # at the first place: the nearer end is the reason
        angle -= 360
    sentence = (
        f"{_near(place)} {_joint(arm, joint)} would turn to {angle:.1f} degrees, outside the range [{low:g}, {high:g}] "
        f"degrees of arm {arm.name}"
    )
    return Notice(place.name, sentence, code="joint-limit", about=str(joint_number(arm, joint)))


def _out_of_reach(place: Place, arm: Arm) -> Notice:
    at = ", ".join(f"{value:.1f}" for value in place.robot_mm)
    sentence = f"{_near(place)} the brush is out of reach of arm {arm.name}: ({at}) mm in the robot's frame"
    return Notice(place.name, sentence, code="arm-out-of-reach")


def _through_singularity(place: Place, arm: Arm) -> Notice:
    sentence = (
        f"{_near(place)} arm {arm.name} passes through a singularity, where its joints rush or it stops"
    )
    return Notice(place.name, sentence, code="singularity")


def _near_singularity(place: Place, arm: Arm, most: float, joints_rad: np.ndarray) -> Notice:
    worst = int(np.linalg.norm(rates(arm, joints_rad, place.robot_mm), axis=1).argmax())
    sentence = (
        f"{_near(place)} arm {arm.name} comes near a singularity: {_joint(arm, worst)} would turn by "
        f"{np.degrees(most):.1f} degrees for each mm, more than {np.degrees(SINGULAR_RAD_MM):g}"
    )
    return Notice(place.name, sentence, code="singularity", about=str(joint_number(arm, worst)))


def _may_have_flipped(posture: _Posture, robot_mm: np.ndarray) -> bool:
    """Return whether a place is so near to a posture's singularity that the joints show its outcome."""
    failure = posture.failure
    if failure is None or failure.code != "singularity":
        return False
    return float(np.linalg.norm(robot_mm - posture.failed.robot_mm)) <= AHEAD_MM


def _note_flip(posture: _Posture, found: _Found, arm: Arm) -> None:
    """Report the failure at a singularity as a flip where, calm again behind it, the wrist that bends the same way has
    turned over."""
    turns = _turned(posture.calm_rad, found.angles_rad)
    bends = np.sin(found.angles_rad[:, BENDS]) * np.sin(posture.calm_rad[BENDS])
    same = (np.abs(turns[:, :3]).max(axis=1) < SAME_ARM_RAD) & (bends > 0) & (found.most <= CALM_RAD_MM)
    for turn in turns[same]:
        joint = TWISTS[int(np.abs(turn[TWISTS]).argmax())]
        if abs(turn[joint]) > FLIP_RAD:
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


def extremes(made: Program) -> np.ndarray:
    """Return (n, 3) few outermost places of a program, in its frame: what those allow, most between them do."""
    points = np.vstack(list(chain.from_iterable([m.points_mm for m in s.moves] for s in made.sections())))
    turns = np.radians(np.arange(0, 360, 45))
    ways = np.column_stack([np.cos(turns), np.sin(turns)])
    outermost = points[np.unique((points[:, :2] @ ways.T).argmax(axis=0))]
    heights = points[:, 2].min(), points[:, 2].max()
    return np.vstack([np.column_stack([outermost[:, :2], np.full(len(outermost), z)]) for z in heights])
