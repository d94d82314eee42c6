"""G-code as brushsvg writes it, read back: straight moves, circles, dwells, stops, a servo's values."""

from __future__ import annotations

import math
import re

from ..cell import Cell, value_mm
from ..errors import Error
from ..posts.gcode_servo import SERVO_END, height_at
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
        self.servo = cell.servo
        # between two values, and two parts of a way, no more than this is written at once
        self.jump_mm = 1.01 * (cell.servo.step_mm + value_mm(cell)) if cell.servo else 0.0
        self.lift: tuple[int, float, float] | None = (
            None  # which step, how far, how long it has been waited for
        )
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
                self.out.comment(number, comment[1])
                self.lift = None  # what is waited for belongs to another section
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
        if codes[:1] != ["G4"]:
            self.lift = None
        if not codes or codes[0] in ("G0", "G1", "G2", "G3"):
            self._move(number, line, codes, values)
        elif codes[0] == "G64":
            self.out.joint_mm = values.get("P", math.inf)
        elif codes[0] == "M3" and self.servo:
            self._lift(number, values)
        elif codes[0] == "G4" and self.lift:
            self._waited(values.get("P", 0.0))
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
            places["Z"] = self._height(number, values["S"])
            # the value takes effect with the move: the lift first, then the way at that height
            change_mm = abs(places["Z"] - self.at["Z"])
            if change_mm > 1e-9:
                speed = math.inf if change_mm > self.jump_mm else None
                self._go(number, codes[0] == "G0", {"Z": places["Z"]}, None, speed)
        centre = None
        if codes[0] in ("G2", "G3"):
            if not {"X", "Y", "I", "J"} <= set(values) or math.isnan(self.at["X"]):
                raise Error(f"line {number}: {line[:40]!r} is a circle without end or centre")
            turn = 1 if codes[0] == "G3" else -1
            centre = (self.at["X"] + values["I"], self.at["Y"] + values["J"], turn)
        if codes[0] != "G0" and not self.feed_mm_s > 0:
            raise Error(f"line {number}: {line[:40]!r} has no feed")
        self._go(number, codes[0] == "G0", places, centre)

    def _go(self, number: int, rapid: bool, places: dict[str, float], centre, speed=None) -> None:
        self.at |= places
        if speed is None:
            speed = self.rapid_mm_s if rapid else self.feed_mm_s
        step = Step(number, rapid, self.at["X"], self.at["Y"], self.at["Z"], speed, 0.0, centre)
        self.out.section().steps.append(step)

    def _lift(self, number: int, values: dict[str, float]) -> None:
        """At once, if nothing is waited for afterwards."""
        before, height = self.at["Z"], self._height(number, values.get("S", math.nan))
        self._go(number, False, {"Z": height}, None, math.inf)
        self.lift = len(self.out.section().steps) - 1, abs(height - before), 0.0

    def _waited(self, seconds: float) -> None:
        """So long after the lift alone: as fast as the feed says, or faster where that is too short."""
        at, way_mm, before_s = self.lift
        waited_s = before_s + seconds
        speed = max(way_mm / waited_s, self.feed_mm_s) if waited_s > 0 else math.inf
        steps = self.out.section().steps
        steps[at] = steps[at]._replace(speed_mm_s=speed)
        self.lift = at, way_mm, waited_s

    def _height(self, number: int, value: float) -> float:
        known = [row[1] for row in self.servo.table]
        low, high = round(min(known)), round(max(known))
        if not low <= value <= high:
            raise Error(f"line {number}: S{value:g} is outside the range [{low}, {high}] of the cell's servo")
        return height_at(self.servo, value)
