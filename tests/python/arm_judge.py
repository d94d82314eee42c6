"""Compare all joint angles that we find for a place with the angles of EAIK.

EAIK uses another method. EAIK's forward kinematics also checks that the angles reach the place.

Places near a singularity are counted separately, because two solvers may see one solution or two there. A
place is near a singularity if a joint turns by more than 300 degrees for each mm. This is about 0.1 degree
from the singularity, or 0.01 mm from the end of the reach.

EAIK cannot solve a wrist whose axes have no common point. For xArm, Newton's method starts at hundreds of
random angles instead. It starts at ten times as many if it missed a solution that we found.
"""

from __future__ import annotations

import numpy as np

from brushsvg.machine.arm.follow_joints import joint_rates
from brushsvg.machine.arm.inverse_kinematics import flange_rates, joint_frames_of, joints_of
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.frames import frame_of_pose

SAME_RAD, SINGULAR_RAD_MM = 1e-6, np.radians(300.0)


class Eaik:
    """An arm in EAIK; `knows` says whether EAIK can find its angles.

    EAIK can compute the place that given angles reach for every arm.
    """

    def __init__(self, arm):
        from eaik.IK_DH import DhRobot

        a, alpha, d, theta = np.array(arm.dh).T
        self.robot = DhRobot(np.radians(alpha), a * 1e-3, d * 1e-3)
        self.knows = self.robot.hasKnownDecomposition()
        self.theta = np.radians(theta)
        self.base = frame_of_pose(arm.base_mm, arm.base_rotation_deg)
        self.behind = frame_of_pose((0.0, 0.0, 0.0), arm.flange_rotation_deg)

    def flange(self, joints_rad):
        """Return the flange frame (4, 4) [mm] for joints (6,)."""
        here = np.array(self.robot.fwdKin(joints_rad + self.theta))
        here[:3, 3] *= 1e3
        return self.base @ here @ self.behind

    def solutions(self, flange):
        """Return all joint angles (k, 6) for a flange frame [mm]."""
        target = np.linalg.inv(self.base) @ flange @ np.linalg.inv(self.behind)
        target[:3, 3] *= 1e-3
        found = self.robot.IK(target)
        exact = [q for q, least_squares in zip(found.Q, found.is_LS, strict=True) if not least_squares]
        return np.array(exact).reshape(-1, 6) - self.theta


def judge_of(arm):
    """Return EAIK's solver, or None if EAIK cannot solve the arm.

    The solver takes a flange frame [mm] and returns all joint angles (k, 6).
    """
    judge = Eaik(arm)
    return judge.solutions if judge.knows else None


STARTS, STEPS, MOST_STEP_RAD = 300, 30, 0.6
# Angles that come near the target late are not exact yet: 1e-6 mm may be 5e-6 rad.
NEAR_MM, MORE_STEPS, THERE_MM = 1e-3, 10, 1e-8


def newton_of(arm):
    """Return a solver that uses Newton's method from random joint angles.

    The solver takes a flange frame [mm] and returns angles (k, 6): nearly always all solutions.
    """
    random = np.random.default_rng(0)

    def nearer(angles, flange):
        there = joint_frames_of(arm, angles)[:, -1]
        turned = flange[:3, :3] @ there[:, :3, :3].swapaxes(-1, -2)
        axis = np.stack([turned[:, k - 1, k - 2] - turned[:, k - 2, k - 1] for k in (0, 1, 2)], axis=-1)
        off = np.concatenate([flange[:3, 3] - there[:, :3, 3], axis / 2], axis=-1)
        jacobian = flange_rates(arm, angles, flange[:3, 3]) + 1e-9 * np.eye(6)
        step = np.linalg.solve(jacobian, off[..., None])[..., 0]
        longest = np.abs(step).max(axis=-1, keepdims=True)
        return angles + step * np.minimum(1.0, MOST_STEP_RAD / np.maximum(longest, 1e-12))

    def within(angles, flange, most_mm):
        return angles[np.abs(joint_frames_of(arm, angles)[:, -1] - flange).max(axis=(1, 2)) < most_mm]

    def solutions(flange, starts=STARTS):
        angles = random.uniform(-np.pi, np.pi, (starts, 6))
        for _ in range(STEPS):
            angles = nearer(angles, flange)
        angles = within(angles, flange, NEAR_MM)
        for _ in range(MORE_STEPS):
            angles = nearer(angles, flange)
        found = []
        for one in within(angles, flange, THERE_MM):
            if not found or missing(one[None], np.array(found)):
                found.append(one)
        return np.array(found).reshape(-1, 6)

    return solutions


def missing(some, others) -> int:
    """Count the angles of `some` (k, 6) that are not among `others` (m, 6)."""
    turns = (some[:, None] - others[None] + np.pi) % (2 * np.pi) - np.pi
    return int((np.abs(turns).max(axis=-1).min(axis=-1, initial=9.0) > SAME_RAD).sum())


def compare(name: str, count: int, seed: int = 0) -> dict:
    """Count random places where both solvers agree or differ, and singular places.

    Also count the angles that each solver has found.
    """
    arm, random = find_cell(name).arm, np.random.default_rng(seed)
    joints, judge = joints_of(arm), Eaik(arm)
    reported = {
        "agree": 0,
        "differ": 0,
        "singular": 0,
        "judge": "EAIK" if judge.knows else "Newton",
        "ours": 0,
        "theirs": 0,
    }
    newton = None if judge.knows else newton_of(arm)
    solutions = newton or judge.solutions
    for made_of in random.uniform(-np.pi, np.pi, (count, 6)):
        flange = joint_frames_of(arm, made_of)[-1]
        ours, theirs = joints.solutions(flange), np.vstack([solutions(flange), made_of])
        if newton and missing(ours, theirs):
            theirs = np.vstack([theirs, newton(flange, 10 * STARTS)])
        both = np.vstack([ours, theirs])
        turn = np.linalg.norm(joint_rates(arm, both, flange[:3, 3]), axis=-1).max()
        if turn > SINGULAR_RAD_MM:
            reported["singular"] += 1
            continue
        leads = max(np.abs(judge.flange(one) - flange).max() for one in both) < 1e-4
        same = missing(theirs, ours) == 0 and missing(ours, theirs) == 0
        reported["agree" if leads and same else "differ"] += 1
        reported["ours"] += len(ours)
        reported["theirs"] += len(ours) - missing(ours, theirs)
    return reported
