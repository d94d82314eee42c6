"""Forward and inverse kinematics of an arm; ssik solves the inverse."""

from __future__ import annotations

import importlib.util
import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...errors import Error, missing_packages_error
from ..cells.cell import Arm
from ..frames import frame_of_pose

M_PER_MM = 1e-3  # lengths of ssik are in metres
# Largest difference of the flange's pose between a prebuilt arm and the links in the cell. The two may differ by the
# rounding of the file that the arm was built from. 0.01 mm is less than the repeatability of any arm, and the links of
# another arm differ by more.
MAX_PREBUILT_DIFFERENCE_MM = 0.01

NEWTON_TOLERANCE = 1e-8  # largest error of the flange's pose after Newton's steps, in mm and rad
# Largest Newton step of a joint. A longer step does not correct rounding, and near a singularity may go anywhere.
MAX_NEWTON_STEP_RAD = 0.02
MAX_NEWTON_STEPS = 5


@dataclass(frozen=True)
class JointSolver:
    """An arm with a function that finds its joint angles.

    solutions: maps a flange pose (4, 4) [mm, robot's frame] to all joint angles (k, 6) [rad, each in (-pi, pi]] that
        put the flange there. k is 0 if there are none. Joint limits are not checked. With at_singularities=False, a
        pose exactly at a singularity may have none, and a pose out of reach is answered much sooner.
    """

    arm: Arm
    solutions: Callable[..., np.ndarray]


def is_installed() -> bool:
    return importlib.util.find_spec("ssik") is not None


# ssik fills its tables at the first use. Another thread that uses ssik at that moment finds half of the entries.
_solver_lock = threading.Lock()


@lru_cache(maxsize=8)
def joints_of(arm: Arm) -> JointSolver:
    """Make the solver for the joint angles of an arm.

    Raises Error if ssik is not installed, does not know the prebuilt arm, or has this arm with other links.
    """
    try:
        import ssik
    except ImportError:
        raise missing_packages_error("the joints of an arm need", "ssik") from None
    with _solver_lock:
        return JointSolver(arm, _solver_of_prebuilt(arm, ssik) if arm.prebuilt else _solver_of_links(arm, ssik))


def joint_frames_of(arm: Arm, joints_rad: np.ndarray) -> np.ndarray:
    """Return the frames of the joints and the flange, (..., n + 1, 4, 4).

    They are in the robot's frame [mm]. Each joint (..., n) turns about the z axis of its frame. The flange's frame is
    the last one.
    """
    joints_rad = np.asarray(joints_rad, dtype=float)
    base, links, flange = _fixed_frames(arm)
    theta = joints_rad + np.radians([row[3] for row in arm.dh])
    c, s = np.cos(theta)[..., None], np.sin(theta)[..., None]
    steps = np.empty((*theta.shape, 4, 4))  # turn about z by theta, then move along the link
    steps[..., 0, :] = c * links[:, 0] - s * links[:, 1]
    steps[..., 1, :] = s * links[:, 0] + c * links[:, 1]
    steps[..., 2:, :] = links[:, 2:]
    joint_frames = np.empty((*theta.shape[:-1], len(links) + 1, 4, 4))
    joint_frames[..., 0, :, :] = base
    for number in range(len(links)):
        joint_frames[..., number + 1, :, :] = joint_frames[..., number, :, :] @ steps[..., number, :, :]
    joint_frames[..., -1, :, :] = joint_frames[..., -1, :, :] @ flange
    return joint_frames


def flange_rates(arm: Arm, joints_rad: np.ndarray, tip_mm: np.ndarray) -> np.ndarray:
    """Return how the tip moves and turns with each joint, (..., 6, n).

    The units are mm/rad and rad/rad.

    tip_mm: (..., 3) place of the tip, which the flange holds, in the robot's frame.
    """
    return flange_rates_at(joint_frames_of(arm, joints_rad), tip_mm)


def flange_rates_at(joint_frames: np.ndarray, tip_mm: np.ndarray) -> np.ndarray:
    """Return flange_rates for given frames of joints and flange.

    joint_frames: (..., n + 1, 4, 4) frames, see joint_frames_of.
    """
    axes, arms = joint_frames[..., :-1, :3, 2], tip_mm[..., None, :] - joint_frames[..., :-1, :3, 3]
    (u, v, w), (x, y, z) = np.moveaxis(axes, -1, 0), np.moveaxis(arms, -1, 0)
    return np.stack([v * z - w * y, w * x - u * z, u * y - v * x, u, v, w], axis=-2)


@lru_cache(maxsize=64)
def _fixed_frames(arm: Arm) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return base, link and flange transforms: a link moves along z by d and x by a, and turns about x by alpha."""
    links = np.array([frame_of_pose((a, 0.0, d), (alpha, 0.0, 0.0)) for a, alpha, d, _ in arm.dh])
    nowhere = (0.0, 0.0, 0.0)
    return (
        frame_of_pose(arm.base_mm, arm.base_rotation_deg),
        links,
        frame_of_pose(nowhere, arm.flange_rotation_deg),
    )


def _solver_of_links(arm: Arm, ssik) -> Callable[..., np.ndarray]:
    a, alpha, d, theta = np.array(arm.dh).T
    manipulator = ssik.Manipulator.from_dh(np.radians(alpha), a * M_PER_MM, d * M_PER_MM)
    base, _, flange = _fixed_frames(arm)
    ssik_from_robot, ssik_flange_offset = np.linalg.inv(base), np.linalg.inv(flange)
    return _make_solver(manipulator.solve, ssik_from_robot, ssik_flange_offset, np.radians(theta))


def _solver_of_prebuilt(arm: Arm, ssik) -> Callable[..., np.ndarray]:
    """Return the solver of an arm that ssik provides.

    Its base frame may be turned about z by half a turn, and its flange frame may be turned in any way.
    """
    if not any(each.name == f"{arm.prebuilt}_ik" for each in ssik.list_arms()):
        sentence = f"ssik has no arm {arm.prebuilt!r} ready"
        raise Error(sentence, where="arm.prebuilt", code="cell-arm", advice="leave prebuilt out")
    manipulator = ssik.Manipulator.from_prebuilt(arm.prebuilt)
    sample_angles = np.random.default_rng(0).uniform(-1.0, 1.0, (5, len(arm.dh)))
    our_flanges = joint_frames_of(arm, sample_angles)[:, -1]
    ssik_flanges = np.array([_scale_origin(manipulator.fk(each), 1 / M_PER_MM) for each in sample_angles])
    for half_turns in (0.0, 180.0):
        ssik_from_robot = frame_of_pose((0, 0, 0), (0, 0, half_turns))
        ssik_flange_offset = np.linalg.inv(our_flanges[0]) @ np.linalg.inv(ssik_from_robot) @ ssik_flanges[0]
        if np.abs(ssik_from_robot @ our_flanges @ ssik_flange_offset - ssik_flanges).max() < MAX_PREBUILT_DIFFERENCE_MM:
            solve_roughly = _make_solver(manipulator.solve, ssik_from_robot, ssik_flange_offset, np.zeros(len(arm.dh)))
            # Two steps are enough for differently rounded links, except near a singularity.
            return lambda flange, at_singularities=True: refine_angles(
                arm, solve_roughly(flange, at_singularities), flange, MAX_NEWTON_STEP_RAD
            )[0]
    sentence = f"the links of arm {arm.name} are not those of ssik's {arm.prebuilt!r}"
    raise Error(sentence, where="arm.prebuilt", code="cell-arm", advice="correct the links, or leave prebuilt out")


def refine_angles(
    arm: Arm, angles: np.ndarray, flanges: np.ndarray, most_step_rad: float | np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Refine joint angles for flange poses by Newton's steps.

    angles: (..., 6) angles that put the flange near the poses.
    flanges: (..., 4, 4) the poses. Their leading axes are broadcast against those of the angles.
    most_step_rad: longest step of a joint, a number or (..., 1). A longer step is left out.

    Returns the angles (..., 6), the frames of the joints (..., 7, 4, 4), and which angles have converged, (...).
    """
    angles = np.broadcast_to(angles, (*np.broadcast_shapes(angles.shape[:-1], flanges.shape[:-2]), angles.shape[-1]))
    for number in range(MAX_NEWTON_STEPS + 1):
        joint_frames = joint_frames_of(arm, angles)
        reached = joint_frames[..., -1, :, :]
        turned = flanges[..., :3, :3] @ reached[..., :3, :3].swapaxes(-1, -2)
        turn = [turned[..., k - 1, k - 2] - turned[..., k - 2, k - 1] for k in (0, 1, 2)]
        error = np.concatenate([flanges[..., :3, 3] - reached[..., :3, 3], np.stack(turn, axis=-1) / 2], axis=-1)
        has_converged = (np.abs(error).max(axis=-1) < NEWTON_TOLERANCE) & (
            np.abs(reached - flanges).max(axis=(-2, -1)) < NEWTON_TOLERANCE
        )
        if number == MAX_NEWTON_STEPS or has_converged.all():
            break
        try:
            step = np.linalg.solve(flange_rates_at(joint_frames, flanges[..., :3, 3]), error[..., None])[..., 0]
        except np.linalg.LinAlgError:  # exactly at a singularity
            break
        longest = np.abs(step).max(axis=-1, keepdims=True)
        angles = angles + np.where(longest < most_step_rad, step, 0.0)
    return angles, joint_frames, has_converged


def _make_solver(solve, ssik_from_robot: np.ndarray, ssik_flange_offset: np.ndarray, theta: np.ndarray):
    def solutions(flange: np.ndarray, at_singularities: bool = True) -> np.ndarray:
        target = _scale_origin(ssik_from_robot @ flange @ ssik_flange_offset, M_PER_MM)
        solutions_found = solve(target, respect_limits=False, allow_rescue=at_singularities)
        angles = np.array([solution.q for solution in solutions_found]).reshape(-1, len(theta)) - theta
        return np.pi - (np.pi - angles) % (2 * np.pi)

    return solutions


def _scale_origin(frame: np.ndarray, factor: float) -> np.ndarray:
    return np.vstack([np.hstack([frame[:3, :3], factor * frame[:3, 3:]]), frame[3:]])
