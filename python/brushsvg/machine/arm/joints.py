"""An arm's joints: where they put the flange, and all angles that put it somewhere, which the library ssik finds."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...errors import Error, lacking
from ..cell import Arm
from ..frames import frame_of_pose

MM = 1e-3  # ssik's lengths are in metres
# A prebuilt arm may be off its links in the cell by the rounding of the file that it was built from. 0.01 mm is less
# than any arm repeats a place by; a link of another arm is off by more.
PREBUILT_MM = 0.01

MOST_STEP_RAD = 0.02  # a longer one is no rounding: at a singularity it leads anywhere


@dataclass(frozen=True)
class Joints:
    """solutions: from a flange frame (4, 4) [mm, robot's frame] to all angles (k, 6) [rad, each in (-pi, pi]] that put
    the flange there, limits not asked; k = 0 where there are none."""

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
    here = np.broadcast_to(base, (*joints_rad.shape[:-1], 4, 4))
    found = [here]
    for number, link in enumerate(links):
        turn = np.zeros((*joints_rad.shape[:-1], 4, 4))
        c, s = np.cos(theta[..., number]), np.sin(theta[..., number])
        turn[..., 0, 0] = turn[..., 1, 1] = c
        turn[..., 0, 1], turn[..., 1, 0] = -s, s
        turn[..., 2, 2] = turn[..., 3, 3] = 1.0
        here = here @ turn @ link
        found.append(here)
    found[-1] = here @ flange
    return np.stack(found, axis=-3)


def flange_rates(arm: Arm, joints_rad: np.ndarray, tip_mm: np.ndarray) -> np.ndarray:
    """(..., 6, n): how the tip at tip_mm (3,), held by the flange, moves [mm/rad] and turns with each joint."""
    at = frames(arm, joints_rad)[..., :-1, :, :]
    axes, arms = at[..., :3, 2], tip_mm - at[..., :3, 3]
    return np.concatenate([np.cross(axes, arms), axes], axis=-1).swapaxes(-1, -2)


@lru_cache(maxsize=64)
def _fixed(arm: Arm) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """What does not turn: the base; of each link along z by d, along x by a, about x by alpha; the flange."""
    links = [frame_of_pose((a, 0.0, d), (alpha, 0.0, 0.0)) for a, alpha, d, _ in arm.dh]
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
    """Angles found for links that are rounded otherwise, on those of the cell: two steps of Newton's are enough."""
    if not len(angles):
        return angles
    for _ in range(2):
        there = frames(arm, angles)[:, -1]
        turned = flange[:3, :3] @ there[:, :3, :3].swapaxes(-1, -2)
        turn = [turned[:, k - 1, k - 2] - turned[:, k - 2, k - 1] for k in (0, 1, 2)]
        off = np.concatenate([flange[:3, 3] - there[:, :3, 3], np.stack(turn, axis=-1) / 2], axis=-1)
        try:
            step = np.linalg.solve(flange_rates(arm, angles, flange[:3, 3]), off[..., None])[..., 0]
        except np.linalg.LinAlgError:  # at a singularity to the last digit
            return angles
        angles = angles + np.where(np.abs(step).max(axis=-1, keepdims=True) < MOST_STEP_RAD, step, 0.0)
    return angles


def _solver(solve, into: np.ndarray, behind: np.ndarray, theta: np.ndarray):
    def solutions(flange: np.ndarray) -> np.ndarray:
        found = solve(_scaled(into @ flange @ behind, MM), respect_limits=False)
        angles = np.array([each.q for each in found]).reshape(-1, len(theta)) - theta
        return np.pi - (np.pi - angles) % (2 * np.pi)

    return solutions


def _scaled(frame: np.ndarray, factor: float) -> np.ndarray:
    return np.vstack([np.hstack([frame[:3, :3], factor * frame[:3, 3:]]), frame[3:]])
