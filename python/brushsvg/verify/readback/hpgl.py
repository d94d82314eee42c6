"""Read back HP-GL that brushsvg wrote."""

from __future__ import annotations

import math
import re

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.cells.language_limits import UNITS_MM
from ...machine.posts.hpgl import CM_S, HELD_UP, comment
from . import Act, Readback, Step, unread_error

_CODE = re.compile(
    r"(IN|PU|PD|PA|PR|SP(-?0|\d{1,2}|)|VS(0{0,2}[1-9]\d{0,2})|P[AUD](-?\d{1,7}),(-?\d{1,7})) *;?",
    re.IGNORECASE,
)
_COMMENT = re.compile(r'CO "([^"]*)";')


def read_hpgl(text: str, cell: Cell) -> Readback:
    """Read an HP-GL program as steps in the plotter frame.

    The raised pen is at the safe height. Raises Error with the line for a statement that brushsvg does not write, and
    for a place without a pen, a speed or an IN before it.
    """
    reader = _Reader(cell)
    for number, line in enumerate(text.splitlines(), 1):
        if line := line.strip(" "):
            reader.line(number, line)
    if not (reader.ended and reader.is_put_away) or reader.is_down:
        raise Error("the last lines are missing: half of the program was lost", code="program-cut-short")
    return reader.out


class _Reader:
    def __init__(self, cell: Cell):
        self.cell, self.out = cell, Readback(rises_mm=[cell.heights.safe_mm])
        self.unit_mm = UNITS_MM["hpgl"]
        self.place: tuple[float, float] | None = None
        self.is_ready = self.is_down = self.is_put_away = self.ended = self.is_relative = False
        self.speed_mm_s, self.pen = 0.0, 0

    def line(self, number: int, line: str) -> None:
        if comment_match := _COMMENT.fullmatch(line):
            if comment(comment_match[1]).strip() != line:
                raise unread_error(number, line)
            self.ended = self.ended or comment_match[1] == HELD_UP
            if comment_match[1] != HELD_UP:
                self.out.comment(number, comment_match[1])
            return
        if not (found := _CODE.fullmatch(line)):
            raise unread_error(number, line)
        word, pen, speed, x, y = found.groups()
        word = word.upper()
        if not self.is_ready and word != "IN":
            raise Error(f"line {number}: {line!r} stands before IN", code="mode-missing")
        if x is not None:
            if word.startswith("PA"):
                self.is_relative = False
            elif self.is_relative:
                raise unread_error(number, line)
            else:
                self._lift(number, line, word.startswith("PD"))
            self._go(number, line, int(x), int(y))
        elif speed is not None:
            self.speed_mm_s = CM_S * int(speed)
        elif pen is not None:
            if self.is_down:
                raise Error(f"line {number}: {line!r} changes a pen that is down", code="line-unread")
            if int(pen or 0) != self.pen:  # SP without a number puts the pen away, like SP0
                self.pen = int(pen or 0)
                self.is_put_away = not self.pen
                self.out.acts.append(Act(number, "text", f"SP{self.pen}"))
        elif word in ("PU", "PD"):
            self._lift(number, line, word == "PD")
        elif word == "IN":
            if self.is_down:
                raise unread_error(number, line)
            if not self.is_ready:
                self.out.acts.append(Act(number, "text", word))
            self.is_ready, self.is_relative, self.speed_mm_s = True, False, 0.0
        else:
            self.is_relative = word == "PR"

    def _go(self, number: int, line: str, x: int, y: int) -> None:
        if not self.pen:
            raise Error(f"line {number}: {line!r} goes without a pen: no SP before", code="line-incomplete")
        self.place = (round(x * self.unit_mm, 3), round(y * self.unit_mm, 3))
        speed = self.speed_mm_s if self.is_down else self.cell.speeds.travel_mm_s
        if not speed > 0:
            raise Error(f"line {number}: {line!r} is drawn at no speed: no VS before", code="line-incomplete")
        self._step(number, not self.is_down, speed)

    def _lift(self, number: int, line: str, is_down: bool) -> None:
        if is_down and self.place is None:
            raise Error(f"line {number}: {line!r} comes before any place", code="line-incomplete")
        if is_down == self.is_down:
            return  # the pen is already there
        self.is_down = is_down
        self._step(number, False, min(self.cell.speeds.press_mm_s, self.speed_mm_s or CM_S))

    def _step(self, number: int, rapid: bool, speed_mm_s: float) -> None:
        height_mm = self.cell.pen.down_mm if self.is_down else self.cell.heights.safe_mm
        self.out.section().steps.append(Step(number, rapid, *self.place, height_mm, speed_mm_s))
        at_most = (math.inf if rapid else speed_mm_s,)
        self.out.acts.append(Act(number, "move", "", (*self.place, height_mm), at_most, (0.0,)))
