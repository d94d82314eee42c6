"""Read back commands for an EBB that brushsvg wrote."""

from __future__ import annotations

import re

import numpy as np

from ...errors import Error
from ...machine.cells.cell import Cell, mm_from_steps, unit_mm
from ...machine.cells.cell_check import MOST_STEPS_S
from ...machine.posts.ebb import EBB_END, HOME, comment
from ...machine.posts.gcode_servo import height_at
from . import Act, Readback, ReadSection, Step, unread_error

_FEED = re.compile(r"# feed (\d{1,7}\.\d) mm/min")
_SM = re.compile(r"SM,(\d{1,8}),(-?\d{1,8})(?:,(-?\d{1,8}))?", re.IGNORECASE)
_S2 = re.compile(r"S2,(\d{1,5}),(\d{1,2})(?:,-?0+(?:,(-?0|\d{1,5}))?)?", re.IGNORECASE)
_SETUP_COMMANDS = ("SR,0,1", "EM,1,1")
MIN_STEPS_PER_S = 1.31  # at fewer steps per second the board refuses a motor's move


def read_ebb(text: str, cell: Cell) -> Readback:
    """Read a program as steps in the machine frame, starting at its origin.

    Raises Error with the line for a command that brushsvg does not write, and for a slice that is faster than its feed
    or than a motor. Also raises Error for steps that do not lead back to the origin.
    """
    reader = _Reader(cell)
    for number, line in enumerate(text.splitlines(), 1):
        if line := line.strip(" "):
            reader.line(number, line)
    if not reader.ended:
        raise Error("the last lines are missing: half of the program was lost", code="program-cut-short")
    if any(reader.steps):
        sentence = "its steps do not end where it began: a line was lost, or changed"
        raise Error(sentence, code="line-incomplete")
    return reader.out


class _Reader:
    def __init__(self, cell: Cell):
        self.cell, self.out = cell, Readback(blends_by_radius=True)
        self.mm_from_steps, self.unit_mm = mm_from_steps(cell.motors), unit_mm(cell)
        self.steps = [0, 0]
        self.value: int | None = None
        self.pending_value: int | None = None  # a value that takes effect with the next move
        self.feed_mm_s = 0.0
        self.ready: list[str] = []
        self.is_home = self.ended = False
        servo = cell.servo
        self.value_range = sorted(round(row[1]) for row in servo.table)
        self.heights: dict[int, float] = {}

    def line(self, number: int, line: str) -> None:
        if self.ended:
            raise unread_error(number, line)
        if line.startswith("#"):
            self._remark(number, line)
        elif found := _SM.fullmatch(line):
            self._move(number, line, *map(int, found.groups("0")))
        elif found := _S2.fullmatch(line):
            self._set_servo(number, line, *map(int, found.groups("0")))
        elif self.ready and line == _SETUP_COMMANDS[0]:
            return  # already set
        elif len(self.ready) < len(_SETUP_COMMANDS) and line == _SETUP_COMMANDS[len(self.ready)]:
            self.ready.append(line)
            self.out.acts.append(Act(number, "text", line))
        else:
            raise unread_error(number, line)

    def _remark(self, number: int, line: str) -> None:
        if found := _FEED.fullmatch(line):
            self.feed_mm_s = float(found[1]) / 60
            return
        text = line.removeprefix("# ")
        if comment(text).rstrip("\n") != line:
            raise unread_error(number, line)
        if text == HOME:
            self.is_home = True
            self.out.sections.append(ReadSection(text, number))
            self.out.acts.append(Act(number, "text", text))
        elif text == EBB_END:
            self.ended = True
            if self.pending_value is not None or not self.is_home:
                raise unread_error(number, line)
        else:
            self.out.comment(number, text)

    def _check_ready(self, number: int, line: str) -> None:
        if len(self.ready) < len(_SETUP_COMMANDS):
            missing = _SETUP_COMMANDS[len(self.ready)]
            raise Error(f"line {number}: {line!r} stands before {missing}", code="mode-missing")

    def _set_servo(self, number: int, line: str, value: int, pin: int, wait_ms: int) -> None:
        self._check_ready(number, line)
        if pin != self.cell.motors.servo_pin or self.pending_value is not None:
            raise unread_error(number, line)
        if not self.value_range[0] <= value <= self.value_range[-1]:
            raise Error(
                f"line {number}: {line!r} is outside the range [{self.value_range[0]}, {self.value_range[-1]}] "
                "of the cell's servo",
                code="servo-out-of-range",
            )
        if self.value is None:  # before the first move, the servo goes up from any height
            self.value = value
            self.out.rises_mm.append(self._height(value))
            self.out.acts.append(Act(number, "lift", same=(float(value),)))
        elif not wait_ms:
            self.pending_value = value
        else:
            self._lift(number, value)
            self._wait(number, wait_ms)

    def _lift(self, number: int, value: int) -> None:
        if value == self.value:
            return
        self.value = value
        self.out.acts.append(Act(number, "lift", same=(float(value),)))
        self._step(number)

    def _height(self, value: int) -> float:
        if value not in self.heights:
            self.heights[value] = height_at(self.cell.servo, value)
        return self.heights[value]

    def _wait(self, number: int, wait_ms: int) -> None:
        self.out.acts.append(Act(number, "wait", same=(wait_ms / 1e3,)))
        if steps := self.out.section().steps:
            last = steps[-1]
            steps[-1] = last._replace(wait_s=last.wait_s + wait_ms / 1e3, waits=last.waits + 1)

    def _step(self, number: int, took_s: float = 0.0) -> None:
        x, y = self._place()
        height = self._height(self.value)
        speed_mm_s = self.feed_mm_s or self.cell.speeds.press_mm_s  # a lift may come before the first feed
        self.out.section().steps.append(Step(number, False, x, y, height, speed_mm_s, took_s=took_s))

    def _place(self) -> tuple[float, float]:
        x, y = (self.mm_from_steps @ self.steps).tolist()
        return x, y

    def _move(self, number: int, line: str, time_ms: int, steps_1: int, steps_2: int) -> None:
        self._check_ready(number, line)
        if not time_ms or (self.value is None and (steps_1 or steps_2)):
            raise Error(f"line {number}: {line!r} moves at an unknown height, or takes no time", code="line-incomplete")
        if not steps_1 and not steps_2:
            if self.pending_value is not None:
                raise unread_error(number, line)
            self._wait(number, time_ms)
            return
        if self.pending_value is not None:
            if self.pending_value != self.value:
                self.value = self.pending_value
                self._step(number)
            self.value, self.pending_value = self.pending_value, None
        for steps in (steps_1, steps_2):
            if steps and not MIN_STEPS_PER_S <= 1e3 * abs(steps) / time_ms <= MOST_STEPS_S:
                raise Error(
                    f"line {number}: {line!r} has {1e3 * abs(steps) / time_ms:.4g} steps in a second, outside the "
                    f"range [{MIN_STEPS_PER_S:g}, {MOST_STEPS_S}] of a motor",
                    code="speed-out-of-range",
                )
        way_mm = float(np.linalg.norm(self.mm_from_steps @ (steps_1, steps_2)))
        speed_mm_s = 1e3 * way_mm / time_ms
        if speed_mm_s > self.feed_mm_s * (1 + 1e-9) + 1e-9:
            sentence = f"line {number}: speed {speed_mm_s:.1f} mm/s, its limit {self.feed_mm_s:.1f} mm/s"
            raise Error(sentence, code="speed-out-of-range")
        self.steps = [self.steps[0] + steps_1, self.steps[1] + steps_2]
        self._step(number, time_ms / 1e3)
        at_most = (self.feed_mm_s, speed_mm_s, 1e3 * self.unit_mm / time_ms)
        self.out.acts.append(Act(number, "way", "", self._place(), at_most, (float(self.value),)))
