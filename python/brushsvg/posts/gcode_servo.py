"""Moves -> G-code for grbl machines whose brush hangs on a servo: M3 S... sets a value instead of a height."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..cell import Servo
from ..moves import Move, Program, Wait
from .gcode import MODES, grbl_comment, wait
from .text import ROWS_AT_ONCE, feed_mm_min, number, rows

SERVO_END = "end: the brush is held up"
TOUCHING = (
    "land",
    "paint",
    "lift",
    "dip",
    "wipe",
)  # here the lift goes as slowly as it is told; in the air at once


def grbl_servo(program: Program) -> Iterator[str]:
    """Heights become values of the servo's table, held along each line; a line is split where the height
    changes by more than the servo's step. The machine must run in grbl's laser mode ($32=1), in which a new S
    takes effect with the move that it stands in and does not stop it. There grbl switches the output off wherever
    the motion mode is not G1, G2 or G3, at M5 and at M2, and the brush would fall: so all is G1, from the first line
    to the last, and the program ends without M2, the brush held up."""
    servo, decimals = program.cell.servo, program.cell.decimals
    yield "".join(grbl_comment(line) for line in program.header)
    yield grbl_comment("note: set $32=1, so that S changes along with the moves")
    yield f"{MODES}\n"
    feed = f"F{feed_mm_min(program.cell.speeds.travel_mm_s):.1f}\n"
    yield f"G1 {feed}"
    here = None
    for section in program.sections():
        if here is None:  # up before going anywhere
            here = np.array([0.0, 0.0, program.rise_mm])
            yield f"M3 S{value_at(servo, here[2])}\n"
            yield f"G4 P{number(servo.settle_s, 3)}\n" if servo.settle_s else ""
        yield "\n" + grbl_comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield wait(step, grbl_comment)
                continue
            wanted = f"F{feed_mm_min(step.speed_mm_s):.1f}\n"
            if wanted != feed:
                yield wanted
                feed = wanted
            yield from _lines(step, here, servo, decimals)
            here = step.points_mm[-1]
    yield "\n" + grbl_comment(SERVO_END)


def value_at(servo: Servo, height_mm):
    """The servo's value for a height, or for each of an array."""
    heights, values = zip(*sorted(servo.table), strict=True)
    return np.rint(np.interp(height_mm, heights, values)).astype(int)


def _lines(move: Move, here: np.ndarray, servo: Servo, decimals: int) -> Iterator[str]:
    path = np.vstack([here, move.points_mm])
    still = np.abs(np.diff(path[:, :2], axis=0)).max(axis=1) < 0.5 * 10.0**-decimals
    for run in np.split(np.arange(len(still)), np.flatnonzero(np.diff(still)) + 1):
        if not still[run[0]]:
            yield from _ways(path[run[0] : run[-1] + 2], servo, decimals)
            continue
        step_mm = servo.step_mm if move.meaning in TOUCHING else np.inf
        for k in run:
            yield from _lift(path[k, 2], path[k + 1, 2], move.speed_mm_s, step_mm, servo)


def _lift(from_mm: float, to_mm: float, speed_mm_s: float, step_mm: float, servo: Servo) -> Iterator[str]:
    """The lift alone: step by step, waiting as long as the way takes at the speed, then until the servo rests."""
    if from_mm == to_mm:
        return
    count = max(1, int(np.ceil(abs(to_mm - from_mm) / step_mm - 1e-9)))
    for k in range(1, count + 1):
        yield f"M3 S{value_at(servo, from_mm + (to_mm - from_mm) * k / count)}\n"
        yield f"G4 P{number(max(abs(to_mm - from_mm) / count / speed_mm_s, 0.001), 3)}\n"
    if servo.settle_s:
        yield f"G4 P{number(servo.settle_s, 3)}\n"


def _ways(path: np.ndarray, servo: Servo, decimals: int) -> Iterator[str]:
    """Straight lines, each in parts on which the height is the one half way along the part."""
    pattern = f"G1 X%.{decimals}f Y%.{decimals}f S%d"
    for first in range(0, len(path) - 1, ROWS_AT_ONCE):
        part = path[first : first + ROWS_AT_ONCE + 1]
        way = np.diff(part, axis=0)
        counts = np.maximum(1, np.ceil(np.abs(way[:, 2]) / servo.step_mm - 1e-9)).astype(int)
        which = np.repeat(np.arange(len(way)), counts)
        number = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
        ends = part[which, :2] + way[which, :2] * (number / counts[which])[:, None]
        heights = part[which, 2] + way[which, 2] * (number - 0.5) / counts[which]
        yield from rows(pattern, np.column_stack([ends, value_at(servo, heights)]), decimals)
