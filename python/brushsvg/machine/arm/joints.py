"""An arm's joints: where they put the flange, and all angles that put it somewhere, which the library ssik finds."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...errors import Error, lacking
from ..cells.cell import Arm
from ..frames import frame_of_pose

MM = 1e-3  # ssik's lengths are in metres
# A prebuilt arm may be off its links in the cell by the rounding of the file that it was built from. 0.01 mm is less
# than any arm repeats a place by; a link of another arm is off by more.
PREBUILT_MM = 0.01

THERE = 1e-8  # how far off, in mm and rad, Newton's steps may end
MOST_STEP_RAD = 0.02  # a longer one is no rounding: at a singularity it leads anywhere


@dataclass(frozen=True)
class Joints:
    """solutions: from a flange frame (4, 4) [mm, robot's frame] to all angles (k, 6) [rad, each in (-pi, pi]] that put
    the flange there, limits are not checked; k = 0 where there are none."""

    arm: Arm
    solutions: Callable[[np.ndarray], np.ndarray]


def is_installed() -> bool:
    return importlib.util.find_spec("ssik") is not None


@lru_cache(maxsize=8)
def joints_of(arm: Arm) -> Joints:
    """Error where ssik is not installed, does not know the prebuilt arm, or has it with other links."""
    try:
        import ssik
    except ImportError:
        raise lacking("the joints of an arm need", "ssik") from None
    return Joints(arm, _of_prebuilt(arm, ssik) if arm.prebuilt else _of_links(arm, ssik))


def frames(arm: Arm, joints_rad: np.ndarray) -> np.ndarray:
    """(..., n + 1, 4, 4) in the robot's frame [mm]: that about whose z each joint (..., n) turns, the flange's last."""
    joints_rad = np.asarray(joints_rad, dtype=float)
    base, links, flange = _fixed(arm)
    theta = joints_rad + np.radians([row[3] for row in arm.dh])
    c, s = np.cos(theta)[..., None], np.sin(theta)[..., None]
    steps = np.empty((*theta.shape, 4, 4))  # about z by theta, and along the link
    steps[..., 0, :] = c * links[:, 0] - s * links[:, 1]
    steps[..., 1, :] = s * links[:, 0] + c * links[:, 1]
    steps[..., 2:, :] = links[:, 2:]
    found = np.empty((*theta.shape[:-1], len(links) + 1, 4, 4))
    found[..., 0, :, :] = base
    for number in range(len(links)):
        found[..., number + 1, :, :] = found[..., number, :, :] @ steps[..., number, :, :]
    found[..., -1, :, :] = found[..., -1, :, :] @ flange
    return found


def flange_rates(arm: Arm, joints_rad: np.ndarray, tip_mm: np.ndarray) -> np.ndarray:
    """(..., 6, n): how the tip at tip_mm (3,), held by the flange, moves [mm/rad] and turns with each joint."""
    return rates_at(frames(arm, joints_rad), tip_mm)


def rates_at(there: np.ndarray, tip_mm: np.ndarray) -> np.ndarray:
    """The same for frames (..., n + 1, 4, 4)."""
    axes, arms = there[..., :-1, :3, 2], tip_mm - there[..., :-1, :3, 3]
    (u, v, w), (x, y, z) = np.moveaxis(axes, -1, 0), np.moveaxis(arms, -1, 0)
    return np.stack([v * z - w * y, w * x - u * z, u * y - v * x, u, v, w], axis=-2)


@lru_cache(maxsize=64)
def _fixed(arm: Arm) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What does not turn: the base; of each link along z by d, along x by a, about x by alpha; the flange."""
    links = np.array([frame_of_pose((a, 0.0, d), (alpha, 0.0, 0.0)) for a, alpha, d, _ in arm.dh])
    nowhere = (0.0, 0.0, 0.0)
    return (
        frame_of_pose(arm.base_mm, arm.base_rotation_deg),
        links,
        frame_of_pose(nowhere, arm.flange_rotation_deg),
    )


def _of_links(arm: Arm, ssik) -> Callable[[np.ndarray], np.ndarray]:
    a, alpha, d, theta = np.array(arm.dh).T
    made = ssik.Manipulator.from_dh(np.radians(alpha), a * MM, d * MM)
    base, _, flange = _fixed(arm)
    into, behind = np.linalg.inv(base), np.linalg.inv(flange)
    return _solver(made.solve, into, behind, np.radians(theta))


def _of_prebuilt(arm: Arm, ssik) -> Callable[[np.ndarray], np.ndarray]:
    """The arm that ssik has ready; its frames at base and flange may be other ones, turned about z or anyhow."""
    if not any(each.name == f"{arm.prebuilt}_ik" for each in ssik.list_arms()):
        sentence = f"ssik has no arm {arm.prebuilt!r} ready"
        raise Error(sentence, where="arm.prebuilt", code="cell-arm")
    made = ssik.Manipulator.from_prebuilt(arm.prebuilt)
    tried = np.random.default_rng(0).uniform(-1.0, 1.0, (5, len(arm.dh)))
    ours = frames(arm, tried)[:, -1]
    theirs = np.array([_scaled(made.fk(each), 1 / MM) for each in tried])
    for half_turns in (0.0, 180.0):
        into = frame_of_pose((0, 0, 0), (0, 0, half_turns))
        behind = np.linalg.inv(ours[0]) @ np.linalg.inv(into) @ theirs[0]
        if np.abs(into @ ours @ behind - theirs).max() < PREBUILT_MM:
            rough = _solver(made.solve, into, behind, np.zeros(len(arm.dh)))
            return lambda flange: _on_these_links(arm, rough(flange), flange)
    sentence = f"the links of arm {arm.name} are not those of ssik's {arm.prebuilt!r}"
    raise Error(sentence, where="arm.prebuilt", code="cell-arm")


def _on_these_links(arm: Arm, angles: np.ndarray, flange: np.ndarray) -> np.ndarray:
    """Angles found for links that are rounded otherwise, on those of the cell: two steps of Newton's are enough, more
    near a singularity."""
    return towards(arm, angles, flange, 5, MOST_STEP_RAD)[0]


def towards(
    arm: Arm, angles: np.ndarray, flange: np.ndarray, steps: int, most_step_rad: float
) -> tuple[np.ndarray, np.ndarray | None]:
    """Angles (k, 6) that put the flange at (4, 4), from angles that put it near, by at most so many steps of Newton's;
    a step that would be longer than that is none. And, where all are there, the frames of the joints, else None."""
    for number in range(steps + 1):
        there = frames(arm, angles)
        rates = rates_at(there, flange[:3, 3])
        turned = flange[:3, :3] @ there[:, -1, :3, :3].swapaxes(-1, -2)
        turn = [turned[:, k - 1, k - 2] - turned[:, k - 2, k - 1] for k in (0, 1, 2)]
        off = np.concatenate([flange[:3, 3] - there[:, -1, :3, 3], np.stack(turn, axis=-1) / 2], axis=-1)
        if np.abs(off).max(initial=0.0) < THERE and np.abs(there[:, -1] - flange).max(initial=0.0) < THERE:
            return angles, there
        if number == steps:
            break
        try:
            step = np.linalg.solve(rates, off[..., None])[..., 0]
        except np.linalg.LinAlgError:  # at a singularity to the last digit
            break
        longest = np.abs(step).max(axis=-1, keepdims=True)
        angles = angles + np.where(longest < most_step_rad, step, 0.0)
    return angles, None


def _solver(solve, into: np.ndarray, behind: np.ndarray, theta: np.ndarray):
    def solutions(flange: np.ndarray) -> np.ndarray:
        found = solve(_scaled(into @ flange @ behind, MM), respect_limits=False)
        angles = np.array([each.q for each in found]).reshape(-1, len(theta)) - theta
        return np.pi - (np.pi - angles) % (2 * np.pi)

    return solutions


def _scaled(frame: np.ndarray, factor: float) -> np.ndarray:
    return np.vstack([np.hstack([frame[:3, :3], factor * frame[:3, 3:]]), frame[3:]])
