"""JAKA script as brushsvg writes it, read back."""

from __future__ import annotations

import re

import numpy as np

from ...errors import Error
from ...machine.cell import Cell
from ...machine.posts.jaka import DEGREE_DECIMALS, JAKA_END, turned_deg
from . import Act, Readback, Step, circle

LEANS_DEG = 0.5  # what no brush shows

_N = r"[-+]?(?:\d+\.?\d*|\.\d+)"
_POSE = re.compile(rf"(to|via) = \[({_N}(?:, {_N}){{5}})\]")
_MOVE = re.compile(rf"movl\(to, 0, ({_N}), ({_N}), ({_N})\)")
_CIRCLE = re.compile(rf"movc\(via, to, 0, ({_N}), ({_N}), (?:0+\.?0*|\.0+)\)")
_HEIGHT = re.compile(rf"rise = \(({_N}) - here\[2\]\)")
_RISE = re.compile(rf"movl\(up, 1, ({_N}), ({_N}), 0\)")
_SLEEP = re.compile(r"sleep\((\d+\.?\d*|\.\d+)\)")
_OTHER = re.compile(  # the frame around the moves
    rf"set_user_frame_id\(0\)|tool = \[{_N}(?:, {_N}){{5}}\]|set_tool\(tool\)|here = get_atl_tcp_pose\(\)"
    rf"|if\(here\[2\] < {_N}\):|rise = \({_N} - here\[2\]\)|up = \[0, 0, rise, 0, 0, 0\]|end|pause\(\)"
)


_SETS = re.compile(r"set_|\w+ = ")


def read_jaka(text: str, cell: Cell) -> Readback:
    """The program as steps in the robot's frame. Error with the line for what brushsvg does not write."""
    out, poses = Readback(), {}
    turned = np.round(turned_deg(cell), DEGREE_DECIMALS) + 0.0
    lines = [(number, line.strip(" ")) for number, line in enumerate(text.splitlines(), 1) if line.strip(" ")]
    for number, line in lines:
        if line.startswith("# "):
            out.comment(number, line[2:])
        elif found := _POSE.fullmatch(line):
            pose = np.array([float(value) for value in found[2].split(", ")])
            _stands(number, line, pose[3:], turned)
            poses[found[1]] = pose[:3]
        elif found := _MOVE.fullmatch(line):
            speed, acceleration, cut_mm = (float(value) for value in found.groups())
            place = _known(number, line, poses, "to")
            _is_run(number, line, acceleration, speed)
            if cut_mm < 0:
                raise Error(f"line {number}: {line[:60]!r} has a negative tolerance", code="line-unread")
            out.joint_mm = max(out.joint_mm, cut_mm)
            out.section().steps.append(Step(number, False, *place.tolist(), speed))
            out.acts.append(Act(number, "move", "movl", tuple(place), (speed, acceleration), (cut_mm,)))
        elif found := _CIRCLE.fullmatch(line):
            speed, acceleration = (float(value) for value in found.groups())
            via, place = (_known(number, line, poses, name) for name in ("via", "to"))
            _is_run(number, line, acceleration, speed)
            circle(out, number, via, place, speed)
            out.acts.append(Act(number, "circle", "", tuple(place), (speed, acceleration), tuple(via)))
        elif found := _SLEEP.fullmatch(line):
            out.acts.append(Act(number, "wait", same=(float(found[1]),)))
        elif found := _RISE.fullmatch(line):
            speed, acceleration = (float(value) for value in found.groups())
            _is_run(number, line, acceleration, speed)
            out.acts.append(Act(number, "text", "movl(up, 1)", (), (speed, acceleration)))
        elif _OTHER.fullmatch(line):
            out.rises_mm += [float(height) for height in _HEIGHT.findall(line)]
            is_again = bool(out.acts) and out.acts[-1].text == line and _SETS.match(line)
            out.acts += [] if is_again else [Act(number, "text", line)]  # set twice, it is the same
        else:
            raise Error(
                f"line {number}: {line[:60]!r} is not a line that brushsvg writes", code="line-unread"
            )
    if not lines or lines[-1][1] != f"# {JAKA_END}":
        raise Error("the last line is missing: half of the program was lost", code="program-cut-short")
    return out


def _known(number: int, line: str, poses: dict[str, np.ndarray], name: str) -> np.ndarray:
    if name not in poses:
        raise Error(f"line {number}: {line[:60]!r} goes where no line before it says", code="line-incomplete")
    return poses[name]


def _stands(number: int, line: str, found_deg: np.ndarray, wanted_deg: np.ndarray) -> None:
    """The brush stands on the paper: whole turns are none."""
    off_deg = np.abs((found_deg - wanted_deg + 180.0) % 360.0 - 180.0).max()
    if off_deg > LEANS_DEG:
        wanted = ", ".join(f"{value:g}" for value in wanted_deg)
        raise Error(
            f"line {number}: {line[:60]!r} turns the tool {off_deg:.4g} degrees from {wanted}, "
            "which sets the brush upright on the cell's paper",
            code="tool-turned",
        )


def _is_run(number: int, line: str, acceleration: float, speed: float) -> None:
    if not (acceleration > 0 and speed > 0):
        raise Error(f"line {number}: {line[:60]!r} has no speed or acceleration", code="line-incomplete")
