"""G-code as brushsvg writes it, read back: straight moves, circles, dwells, stops, a servo's values."""

from __future__ import annotations

import math
import re

import numpy as np

from ..cell import Cell
from ..errors import Error
from ..posts.gcode_servo import SERVO_END
from . import Readback, Step

_COMMENT = re.compile(r"\(([^()]*)\)")
_CODE = re.compile(r"(?:[A-Z]-?\d+(?:\.\d+)?(?: |$))+")
_WORD = re.compile(r"([A-Z])(-?\d+(?:\.\d+)?)")
MODES = {"G17", "G40", "G80", "G91.1", "G94", "G61"}
ALONE = {"G0", "G1", "G2", "G3", "G4", "G64", "G61", "M0", "M2", "M3"}  # no other word of command beside them
NEEDED = {"G21": "millimetres", "G90": "absolute places"}


def read_gcode(text: str, cell: Cell) -> Readback:
    """The program as steps. Error with the line for words that brushsvg does not write, or a missing G21, G90, M2."""
    return _Reader(cell).read(text)


class _Reader:
    def __init__(self, cell: Cell):
        self.out = Readback()
        self.servo = sorted(cell.servo.table, key=lambda row: row[1]) if cell.servo else None
        self.at = {axis: math.nan for axis in "XYZ"}
        self.feed_mm_s = 0.0
        self.rapid_mm_s = cell.speeds.travel_mm_s
        self.seen: set[str] = set()
        self.ended = False

    def read(self, text: str) -> Readback:
        for number, line in enumerate(text.splitlines(), 1):
            if self.servo and line == f"({SERVO_END})":
                self.ended = True
            elif comment := _COMMENT.fullmatch(line):
                self.out.comment(comment[1])
            elif line:
                self._line(number, line)
        for mode, meaning in NEEDED.items():
            if mode not in self.seen:
                raise Error(f"{mode} is missing: nothing says that its numbers are {meaning}")
        if not self.ended:
            end = f"({SERVO_END})" if self.servo else "M2"
            raise Error(f"{end} is missing: the program has no end, or half of it was lost")
        return self.out

    def _line(self, number: int, line: str) -> None:
        if self.ended:
            raise Error(f"line {number}: {line[:40]!r} stands behind the end of the program")
        if not _CODE.fullmatch(line):
            raise Error(f"line {number}: {line[:40]!r} is not a line that brushsvg writes")
        words = [(letter, value) for letter, value in _WORD.findall(line)]
        codes = [letter + value for letter, value in words if letter in "GM"]
        if len(codes) > 1 and (set(codes) & ALONE):
            raise Error(f"line {number}: {line[:40]!r} is not a line that brushsvg writes")
        values = {letter: float(value) for letter, value in words if letter not in "GM"}
        if len(values) + len(codes) != len(words) or not set(values) <= set("XYZIJFPS"):
            raise Error(f"line {number}: {line[:40]!r} has a word twice, or one that brushsvg does not write")
        if not codes or codes[0] in ("G0", "G1", "G2", "G3"):
            self._move(number, line, codes, values)
        elif codes[0] == "G64":
            self.out.joint_mm = values.get("P", math.inf)
        elif codes[0] == "M3" and self.servo:
            self._lift(number, values)
        elif codes[0] == "M2":
            self.ended = True
        elif not set(codes) <= MODES | set(NEEDED) | {"M0", "G4"}:
            raise Error(f"line {number}: {line[:40]!r} is not a line that brushsvg writes")
        self.seen |= set(codes)

    def _move(self, number: int, line: str, codes: list[str], values: dict[str, float]) -> None:
        if "F" in values:
            self.feed_mm_s = values["F"] / 60
        places = {axis: values[axis] for axis in "XYZ" if axis in values}
        if not codes:
            if places:
                raise Error(f"line {number}: {line[:40]!r} does not say how to go there")
            return
        if self.servo and "S" in values:
            places["Z"] = self._height(values["S"])
            # the value takes effect with the move: the lift first, then the way at that height
            if not math.isnan(self.at["Z"]) and abs(places["Z"] - self.at["Z"]) > 1e-9:
                self._go(number, codes[0] == "G0", {"Z": places["Z"]}, None)
        centre = None
        if codes[0] in ("G2", "G3"):
            if not {"X", "Y", "I", "J"} <= set(values) or math.isnan(self.at["X"]):
                raise Error(f"line {number}: {line[:40]!r} is a circle without end or centre")
            turn = 1 if codes[0] == "G3" else -1
            centre = (self.at["X"] + values["I"], self.at["Y"] + values["J"], turn)
        if codes[0] != "G0" and not self.feed_mm_s > 0:
            raise Error(f"line {number}: {line[:40]!r} has no feed")
        self._go(number, codes[0] == "G0", places, centre)

    def _go(self, number: int, rapid: bool, places: dict[str, float], centre) -> None:
        self.at |= places
        speed = self.rapid_mm_s if rapid else self.feed_mm_s
        step = Step(number, rapid, self.at["X"], self.at["Y"], self.at["Z"], speed, 0.0, centre)
        self.out.section().steps.append(step)

    def _lift(self, number: int, values: dict[str, float]) -> None:
        self._go(number, False, {"Z": self._height(values.get("S", math.nan))}, None)

    def _height(self, value: float) -> float:
        heights, known = [row[0] for row in self.servo], [row[1] for row in self.servo]
        return float(np.interp(value, known, heights))
