"""HP-GL as brushsvg writes it, read back."""

from __future__ import annotations

import math
import re

from ...errors import Error
from ...machine.cell import UNITS_MM, Cell
from ...machine.posts.hpgl import CM_S, HELD_UP, PUT_AWAY, comment
from . import Act, Readback, Step

_CODE = re.compile(r"(IN|PU|PD|PA|SP(\d{1,2})|VS(\d{1,3})|PA(-?\d{1,7}),(-?\d{1,7}));")
_COMMENT = re.compile(r'CO "([^"]*)";')


def read_hpgl(text: str, cell: Cell) -> Readback:
    """The program as steps in the plotter's frame, the pen up at the safe height. Error with the line for what brushsvg
    does not write, and for places that no pen, no speed or no IN comes before."""
    reader = _Reader(cell)
    last: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        if line := line.strip(" "):
            reader.line(number, line)
            last = [*last[-len(PUT_AWAY) :], line]
    if last != [*PUT_AWAY, comment(HELD_UP).strip()]:
        raise Error("the last lines are missing: half of the program was lost", code="program-cut-short")
    return reader.out


class _Reader:
    def __init__(self, cell: Cell):
        self.cell, self.out = cell, Readback(rises_mm=[cell.heights.safe_mm])
        self.unit_mm = UNITS_MM["hpgl"]
        self.place: tuple[float, float] | None = None
        self.is_ready = self.is_down = self.has_pen = self.ended = False
        self.speed_mm_s = 0.0

    def line(self, number: int, line: str) -> None:
        if self.ended:
            raise _unread(number, line)
        if said := _COMMENT.fullmatch(line):
            if comment(said[1]).strip() != line:
                raise _unread(number, line)
            self.ended = said[1] == HELD_UP
            if not self.ended:
                self.out.comment(number, said[1])
            return
        if not (found := _CODE.fullmatch(line)):
            raise _unread(number, line)
        if not self.is_ready and line != "IN;":
            raise Error(f"line {number}: {line!r} stands before IN", code="mode-missing")
        word, pen, speed, x, y = found.groups()
        if x is not None:
            self._go(number, line, int(x), int(y))
        elif speed is not None:
            self.speed_mm_s = CM_S * int(speed)
        elif pen is not None:
            if self.is_down:
                raise Error(f"line {number}: {line!r} changes a pen that is down", code="line-unread")
            self.has_pen = pen != "0"
            self.out.acts.append(Act(number, "text", line))
        elif word in ("PU", "PD"):
            self._lift(number, line, word == "PD")
        else:
            if self.is_down or (word == "IN" and self.is_ready):
                raise _unread(number, line)
            self.is_ready = True
            self.out.acts.append(Act(number, "text", line))

    def _go(self, number: int, line: str, x: int, y: int) -> None:
        if not self.has_pen:
            raise Error(f"line {number}: {line!r} goes without a pen: no SP before", code="line-incomplete")
        self.place = (round(x * self.unit_mm, 3), round(y * self.unit_mm, 3))
        speed = self.speed_mm_s if self.is_down else self.cell.speeds.travel_mm_s
        self._step(number, not self.is_down, speed)

    def _lift(self, number: int, line: str, is_down: bool) -> None:
        if is_down and (self.place is None or not self.speed_mm_s > 0):
            raise Error(f"line {number}: {line!r} has no place or no speed yet", code="line-incomplete")
        if is_down == self.is_down:
            return  # as it was
        self.is_down = is_down
        self._step(number, False, min(self.cell.speeds.press_mm_s, self.speed_mm_s))

    def _step(self, number: int, rapid: bool, speed_mm_s: float) -> None:
        height_mm = self.cell.pen.down_mm if self.is_down else self.cell.heights.safe_mm
        self.out.section().steps.append(Step(number, rapid, *self.place, height_mm, speed_mm_s))
        at_most = (math.inf if rapid else speed_mm_s,)
        self.out.acts.append(Act(number, "move", "", (*self.place, height_mm), at_most, (0.0,)))


def _unread(number: int, line: str) -> Error:
    return Error(f"line {number}: {line[:60]!r} is not a line that brushsvg writes", code="line-unread")
