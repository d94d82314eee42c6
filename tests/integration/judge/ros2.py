"""Run a table of poses with times as a controller follows it.

The flange carries the tip straight and evenly from row to row. A user moves the arm to the first row before,
so no way to it is checked. Remarks begin with #.
"""

from __future__ import annotations

import math
import re

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame

NAMES = ["time_s", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "limit_m_s", "row"]
N = re.compile(r"-?(?:\d+\.?\d*|\.\d+)")


def run_ros2(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray) -> Run:
    """Run a table of poses.

    start is not used, since the arm is already at the first row. paper, down and tool come from the cell.
    """
    arm = Arm(start, paper, down, tool, by_radius=True)
    try:
        _followed(text, arm)
    except RefusedError as refusal:
        arm.run.refused = str(refusal)
        arm.run.legs.clear()  # a controller checks the whole trajectory before it moves
    return arm.run


def _followed(text: str, arm: Arm) -> None:
    names, now, begun, limits = None, 0.0, False, []
    for number, raw in enumerate(text.split("\n"), 1):
        line = raw.strip(" ")
        if "\r" in raw:
            arm.run.acts.append(f"line {number}: a return within a line")
        if not line:
            continue
        if line.startswith("#"):
            words = line[1:].strip()
            if names is None:
                arm.run.header.append(words)
            else:
                arm.run.titles.append((words, len(arm.run.legs)))
            continue
        cells = line.split(",")
        if names is None:
            if cells != NAMES:
                raise RefusedError(f"line {number}: no names of columns")
            names = cells
            continue
        if len(cells) != len(NAMES) or not all(N.fullmatch(each) for each in cells[:9]):
            raise RefusedError(f"line {number}: no row")
        time, x, y, z, qx, qy, qz, qw, limit = map(float, cells[:9])
        limits.append(f"{cells[9]} {limit}")
        if cells[9] not in ("pose", "way", "rest"):
            raise RefusedError(f"line {number}: a row of no kind")
        flange = frame((1e3 * x, 1e3 * y, 1e3 * z), _turned(number, qx, qy, qz, qw))
        target = flange  # the pose of the flange, because arm.tcp is not set
        if not begun:
            arm.at, begun, now = arm.tip(target)[0], True, time
            if time != 0:
                raise RefusedError(f"line {number}: it does not begin at time 0")
            arm.run.frame.append(f"begins at {np.round(arm.at, 3).tolist()}")
            continue
        if time <= now:
            raise RefusedError(f"line {number}: time does not go on")
        way = float(np.linalg.norm(arm.tip(target)[0] - arm.at))
        if way < 1e-4:
            arm.rest(number, "wait", time - now)
        else:
            arm.line(number, target, way / (time - now), 1.0, 0.0)
        now = time
    if names is None:
        raise RefusedError("no table")
    ways = {each for each in limits if each.startswith("way")}  # no controller reads these columns
    arm.run.frame.append(" ".join(sorted([*ways, *(each for each in limits if each not in ways)])))


def _turned(number: int, x: float, y: float, z: float, w: float) -> np.ndarray:
    size = math.sqrt(x * x + y * y + z * z + w * w)
    if abs(size - 1) > 0.01:
        raise RefusedError(f"line {number}: a quaternion that is none")
    x, y, z, w = (each / size for each in (x, y, z, w))
    axis = np.array([x, y, z])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return (w * w - axis @ axis) * np.eye(3) + 2 * np.outer(axis, axis) + 2 * w * cross
