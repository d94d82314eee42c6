"""What of a pass is left in a program's text: who writes it and who reads it back decide from the same places."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cell import Cell
from .corner_blending import ON_THE_SPOT_MM
from .frames import is_upright, moved
from .motion import via
from .posts import POSTS

# circles that are smaller or flatter, in units of the last decimal, are run along their chords: rounded, they could
# turn the other way, or all round, or lie on one line
CIRCLE_UNITS = 10


@dataclass(frozen=True)
class Written:
    """poses_mm: (n, 3) as a program has them, in the paper's frame; arcs: those that it tells as circles; sideways_mm:
    steps of less than that are straight up and down."""

    poses_mm: np.ndarray
    arcs: list
    sideways_mm: float


def as_written(a_pass, cell: Cell, frame: np.ndarray) -> Written:
    """A pass as the cell's language has it; frame: (4, 4) the paper's in the robot's."""
    post = POSTS.get(cell.language)
    unit_mm = 10.0**-cell.decimals
    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    sideways_mm = ON_THE_SPOT_MM
    if post and post.in_robot_frame and not np.array_equal(frame, np.eye(4)):
        poses = moved(np.linalg.inv(frame), np.round(moved(frame, poses), cell.decimals))
        if not is_upright(frame):  # there up and down are only so up to rounding
            sideways_mm = 2 * unit_mm
    else:
        poses = np.round(poses, cell.decimals)
    is_told = _told_by_pose if post and post.circles_by_pose else _told_by_centre
    arcs = [
        arc for arc in a_pass.arcs if is_told(poses[arc.first : arc.last + 1, :2], CIRCLE_UNITS * unit_mm)
    ]
    return Written(poses, arcs, sideways_mm)


def _told_by_centre(on: np.ndarray, least_mm: float) -> bool:
    return bool(np.linalg.norm(on - on[0], axis=1).max() >= least_mm)


def _told_by_pose(on: np.ndarray, least_mm: float) -> bool:
    """Whether first pose, via and last one are the corners of a triangle that is nowhere flatter."""
    if len(on) < 3:
        return False
    a, b, c = on[0], via(on[1:]), on[-1]
    (x, y), (u, v) = b - a, c - a
    longest_mm = max(np.hypot(x, y), np.hypot(u, v), np.hypot(u - x, v - y))
    return bool(abs(x * v - y * u) > least_mm * longest_mm)
