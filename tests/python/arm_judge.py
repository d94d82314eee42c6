"""All joint angles for a place, held against EAIK's, which finds them otherwise.

Places near a singularity (a joint turns by more than 300 degrees for each mm: about 0.1 degree from it, or 0.01 mm from
the end of the reach) are counted apart: two solvers may see one solution or two there. EAIK knows no wrist without a
common point: for xArm Newton's method is begun at hundreds of random angles; what it comes to must be found, and the
angles that made the place must be.
"""

from __future__ import annotations

import numpy as np

from brushsvg.machine.arm.follow import rates
from brushsvg.machine.arm.joints import flange_rates, frames, joints_of
from brushsvg.machine.cell_file import find_cell

SAME_RAD, SINGULAR_RAD_MM = 1e-6, np.radians(300.0)


def judge_of(arm):
    """From a flange frame [mm] to all angles (k, 6), by EAIK; None where it does not know the arm."""
    from eaik.IK_DH import DhRobot

    a, alpha, d, theta = np.array(arm.dh).T
    robot = DhRobot(np.radians(alpha), a * 1e-3, d * 1e-3)
    if not robot.hasKnownDecomposition():
        return None
    base = frames(arm, np.zeros(6))[0]
    zero, here = frames(arm, np.zeros(6))[-1], np.array(robot.fwdKin(np.radians(theta)))
    here[:3, 3] *= 1e3
    behind = np.linalg.inv(zero) @ base @ here

    def solutions(flange):
        wanted = np.linalg.inv(base) @ flange @ behind
        wanted[:3, 3] *= 1e-3
        found = robot.IK(wanted)
        exact = [q for q, least_squares in zip(found.Q, found.is_LS, strict=True) if not least_squares]
        return np.array(exact).reshape(-1, 6) - np.radians(theta)

    return solutions


STARTS, STEPS, MOST_STEP_RAD = 300, 30, 0.6


def newton_of(arm, random):
    """From a flange frame [mm] to angles (k, 6) that Newton's method finds from random ones: nearly always all."""

    def solutions(flange):
        angles = random.uniform(-np.pi, np.pi, (STARTS, 6))
        for _ in range(STEPS):
            there = frames(arm, angles)[:, -1]
            turned = flange[:3, :3] @ there[:, :3, :3].swapaxes(-1, -2)
            axis = np.stack([turned[:, k - 1, k - 2] - turned[:, k - 2, k - 1] for k in (0, 1, 2)], axis=-1)
            off = np.concatenate([flange[:3, 3] - there[:, :3, 3], axis / 2], axis=-1)
            jacobian = flange_rates(arm, angles, flange[:3, 3]) + 1e-9 * np.eye(6)
            step = np.linalg.solve(jacobian, off[..., None])[..., 0]
            longest = np.abs(step).max(axis=-1, keepdims=True)
            angles = angles + step * np.minimum(1.0, MOST_STEP_RAD / np.maximum(longest, 1e-12))
        there = frames(arm, angles)[:, -1]
        found = []
        for one in angles[np.abs(there - flange).max(axis=(1, 2)) < 1e-6]:
            if not found or missing(one[None], np.array(found)):
                found.append(one)
        return np.array(found).reshape(-1, 6)

    return solutions


def missing(some, others) -> int:
    """How many of some angles (k, 6) are none of the others (m, 6)."""
    turns = (some[:, None] - others[None] + np.pi) % (2 * np.pi) - np.pi
    return int((np.abs(turns).max(axis=-1).min(axis=-1, initial=9.0) > SAME_RAD).sum())


def compare(name: str, count: int, seed: int = 0) -> dict:
    """How many random places agree, differ, and lie near a singularity; and how many angles each has found."""
    arm, random = find_cell(name).arm, np.random.default_rng(seed)
    joints, judge = joints_of(arm), judge_of(arm)
    told = {
        "agree": 0,
        "differ": 0,
        "singular": 0,
        "judge": "EAIK" if judge else "Newton",
        "ours": 0,
        "theirs": 0,
    }
    exact, judge = bool(judge), judge or newton_of(arm, random)
    for made_of in random.uniform(-np.pi, np.pi, (count, 6)):
        flange = frames(arm, made_of)[-1]
        ours, theirs = joints.solutions(flange), np.vstack([judge(flange), made_of])
        both = np.vstack([ours, theirs])
        turn = np.linalg.norm(rates(arm, both, flange[:3, 3]), axis=-1).max()
        if turn > SINGULAR_RAD_MM:
            told["singular"] += 1
            continue
        leads = np.abs(frames(arm, both)[:, -1] - flange).max() < 1e-4
        same = missing(theirs, ours) == 0 and (not exact or missing(ours, theirs) == 0)
        told["agree" if leads and same else "differ"] += 1
        told["ours"] += len(ours)
        told["theirs"] += len(ours) - missing(ours, theirs)
    return told
