"""Run a program for Dobot in Debian's Lua with a stub of the arm, dobot.lua.

The stub follows Dobot's manual. A program that Lua refuses to load never begins. The manual says:

- A user frame or a tool that is not in the controller's list stops the project.
- A move without a speed has the highest speed, and `speed` is at least 1 mm/s.
- `r` is a radius around a point. Within this radius the path may leave the point.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame, moved

STUB = Path(__file__).with_suffix(".lua")
LUA = shutil.which("lua5.4")
# The heights over the paper at which runs begin, to test that the program rises first.
LOWER_MM = (-3.0, 5.0, 15.0, 19.0, 20.1, 20.5, 21.0, 25.0, 50.0, 300.0)
MOVES = ("line", "arc")
REMARK = "--"


def run_dobot(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray) -> Run:
    """Run a program for Dobot.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell.
    """
    arm = Arm(start, paper, down, tool, by_radius=True)
    at = moved(np.linalg.inv(paper), np.array([start], dtype=float))[0]
    others = [tuple(moved(paper, np.array([[*at[:2], height]]))[0]) for height in LOWER_MM]
    flanges = [_flange(place, paper, down, tool) for place in (start, *others)]
    done = subprocess.run(
        [LUA or "lua5.4", str(STUB), *flanges], input=text.encode("latin-1"), capture_output=True, check=True
    )
    lines = [line.split("\t") for line in done.stdout.decode("latin-1").split("\n")[:-1]]
    begins = [k for k, words in enumerate(lines) if words[0] == "start"]
    runs = [lines[first + 1 : last] for first, last in zip(begins, [*begins[1:], len(lines)], strict=True)]
    try:
        for words in runs[0]:
            _done(arm, words[0], int(words[1]), words[2:])
    except RefusedError as refusal:
        arm.run.refused = str(refusal)
    back = np.linalg.inv(paper)
    for height, place, each in zip(LOWER_MM, others, runs[1:], strict=True):
        more = sum(words[0] in MOVES for words in each) - sum(words[0] in MOVES for words in runs[0])
        first = _first(each, np.array(place), tool, back)
        arm.run.frame.append(f"from {height:g} mm {first}, {more} moves more than from where it stands")
    _commented(text, arm.run)
    return arm.run


def _flange(tip, paper: np.ndarray, down: np.ndarray, tool: np.ndarray) -> str:
    """Return the flange's pose for the brush's tip, upright on the paper."""
    true = paper @ frame((0, 0, 0), down)
    true[:3, 3] = tip
    m = true @ np.linalg.inv(tool)
    b = np.arctan2(-m[2, 0], np.hypot(m[0, 0], m[1, 0]))
    angles = np.degrees([np.arctan2(m[2, 1], m[2, 2]), b, np.arctan2(m[1, 0], m[0, 0])])
    return ",".join(repr(float(value)) for value in (*m[:3, 3], *angles))


def _pose(words: list[str]) -> np.ndarray:
    return np.vstack([np.array([float(word) for word in words]).reshape(3, 4), [0, 0, 0, 1]])


def _done(arm: Arm, kind: str, number: int, words: list[str]) -> None:
    run = arm.run
    if kind == "refused":
        raise RefusedError(words[0])
    if kind == "act":
        run.acts.append(f"line {number}: {words[0]}")
    elif kind == "says":
        run.titles.append((f"stop: {words[0]}", len(run.legs)))
    elif kind in ("wait", "stop"):
        arm.rest(number, kind, float(words[0]) if words else 0.0)
    elif kind == "line":
        speed, acceleration, cut_mm = map(float, words[12:])
        arm.line(number, _pose(words[:12]), speed, acceleration, cut_mm)
    else:
        speed, acceleration, cut_mm = map(float, words[24:])
        arm.circle(number, _pose(words[:12]), _pose(words[12:24]), speed, acceleration, cut_mm)


def _first(lines: list[list[str]], start: np.ndarray, tool: np.ndarray, back: np.ndarray) -> str:
    """Describe how a run begins: straight up to a height, or elsewhere."""
    move = next((words for words in lines if words[0] in MOVES), None)
    if move is None:
        return "goes nowhere"
    if move[0] == "arc":
        return "on a circle"
    step = back[:3, :3] @ ((_pose(move[2:14]) @ tool)[:3, 3] - start)
    return f"rises by {step[2]:.3f} mm at {move[14]}" if np.abs(step[:2]).max() < 1e-3 else "goes on"


def _commented(text: str, run: Run) -> None:
    """Add the comments to the run, each with the number of legs before it."""
    lines = text.split("\n")
    code = [k for k, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith(REMARK)]
    first = min(code, default=0)
    for number, line in enumerate(lines, 1):
        if "\r" in line:
            run.acts.append(f"line {number}: a return within a line")
        if not line.lstrip().startswith(REMARK):
            continue
        words = line.strip()[len(REMARK) :].strip()
        if number < first:
            run.header.append(words)
        else:
            run.titles.append((words, sum(leg.line < number for leg in run.legs)))
