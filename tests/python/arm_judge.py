"""All joint angles for a place, held against EAIK's, which finds them otherwise.

Places near a singularity (a joint turns by more than 300 degrees for each mm: about 0.1 degree from it, or 0.01 mm from
the end of the reach) are counted apart: two solvers may see one solution or two there. EAIK knows no wrist without a
common point: for xArm6 the angles that made the place must be found again, and all others must lead there.
"""

from __future__ import annotations

import numpy as np

from brushsvg.machine.arm.follow import rates
from brushsvg.machine.arm.joints import frames, joints_of
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


def missing(some, others) -> int:
    """How many of some angles (k, 6) are none of the others (m, 6)."""
    turns = (some[:, None] - others[None] + np.pi) % (2 * np.pi) - np.pi
    return int((np.abs(turns).max(axis=-1).min(axis=-1, initial=9.0) > SAME_RAD).sum())


def compare(name: str, count: int, seed: int = 0) -> dict:
    """How many random places agree, differ, and lie near a singularity."""
    arm = find_cell(name).arm
    joints, judge = joints_of(arm), judge_of(arm)
    told = {"agree": 0, "differ": 0, "singular": 0, "judge": "EAIK" if judge else "forward chain"}
    for made_of in np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 6)):
        flange = frames(arm, made_of)[-1]
        ours = joints.solutions(flange)
        theirs = judge(flange) if judge else made_of[None]
        both = np.vstack([ours, theirs])
        turn = np.linalg.norm(rates(arm, both, flange[:3, 3]), axis=-1).max()
        if turn > SINGULAR_RAD_MM:
            told["singular"] += 1
            continue
        there = frames(arm, both)[:, -1]
        leads = np.abs(there - flange).max() < 1e-4
        same = missing(theirs, ours) == 0 and (not judge or missing(ours, theirs) == 0)
        told["agree" if leads and same else "differ"] += 1
    return told
