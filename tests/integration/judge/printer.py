"""Run G-code of Marlin 2 and Klipper as their documentation says.

A line has one command. Only the feed holds for the next lines. G0 is no faster than G1. The firmware skips
unknown commands and runs the rest.

Sources: marlinfw.org/docs/gcode (G0-G1, G2-G3, G4, G20-G21, G90-G92, M0, M400) and
klipper3d.org/G-Codes.html, its section on gcode_arcs. Commands that a firmware may be built without count as
text that acts.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from .moves import Leg, RefusedError, Run

LONGEST = {"marlin": 95, "klipper": math.inf}
WORD = re.compile(r"\s*([A-Z])\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*")
STOPS = {"marlin": ("M0", "M1"), "klipper": ("PAUSE",)}
IDLE = ("M400", "M105", "M114", "M115")  # these wait for the moves, or report
AXES = "XYZ"


def run_printer(text: str, firmware: str, start, has_arcs: bool, pen: Pen | None = None) -> Run:
    """Run G-code of a firmware: marlin or klipper.

    start is the place of the tool before the program. has_arcs: the firmware was built with G2 and G3. pen
    belongs to a Marlin with a servo. The servo moves as soon as the firmware reads its line, even before
    waiting moves end.
    """
    machine = _Machine(firmware, start, has_arcs, pen)
    try:
        for number, line in enumerate(text.split("\n"), 1):
            machine.line(number, line)
    except RefusedError as refusal:
        machine.run.refused = str(refusal)
    machine.leave()
    return machine.run


class Pen(NamedTuple):
    """A pen on a servo.

    number is the servo's number. heights [mm] are by the servo's values. least_s is the time that the servo
    needs.
    """

    number: int
    heights: dict[float, float]
    least_s: float


DROPPED_MM_S = 10.0  # speed of a falling pen
KNOWN_S = 0.01  # accuracy to which the duration of a servo's move is known


class _Machine:
    def __init__(self, firmware: str, start, has_arcs: bool, pen: Pen | None):
        self.pen, self.is_still, self.moved_s = pen, True, math.inf
        self.run, self.firmware, self.has_arcs = Run(), firmware, has_arcs
        self.at, self.shift = list(start), [0.0, 0.0, 0.0]
        self.absolute, self.mm = False, 25.4  # the last program may have left any state
        self.feed_mm_s = 200.0
        self.number, self.has_code = 0, False

    def line(self, number: int, line: str) -> None:
        self.number = number
        if "\r" in line[:-1]:
            self._act("a return within a line")
        if any(ord(letter) > 126 or (letter < " " and letter not in "\r\t") for letter in line):
            self._act("a letter that is not plain")
        code, remark, comment = line.rstrip("\r").partition(";")
        code = code.strip().upper()
        if len(code) > LONGEST[self.firmware]:
            self._act("a line that is cut")
        if code:
            self.has_code = True
            self._command(code)
        if remark:
            words = comment.removeprefix(" ").rstrip()
            if self.has_code:
                self.run.titles.append((words, len(self.run.legs)))
            else:
                self.run.header.append(words)

    def leave(self) -> None:
        left = ["relative places"] * (not self.absolute) + ["inches"] * (self.mm != 1.0)
        self.run.frame += left + ["G92"] * any(self.shift)

    def _act(self, what: str) -> None:
        self.run.acts.append(f"line {self.number}: {what}")

    def _command(self, code: str) -> None:
        if code in STOPS[self.firmware]:
            return self._stop()
        words, at = [], 0
        while at < len(code):
            if not (found := WORD.match(code, at)):
                if self.firmware == "klipper":
                    raise RefusedError(f"line {self.number}: malformed command")
                return self._act(f"{code[:20]!r} is no command")
            words.append((found[1], float(found[2])))
            at = found.end()
        name, values = f"{words[0][0]}{words[0][1]:g}", dict(words[1:])
        if name in STOPS[self.firmware] and not values:
            return self._stop()
        if len(values) + 1 != len(words):
            self._act("a word twice: which one holds?")
        self.is_still = name == "M400" or (self.is_still and name not in ("G0", "G1"))
        known = {
            "M280": "PS",
            "G0": "XYZF",
            "G1": "XYZF",
            "G2": "XYZIJF",
            "G3": "XYZIJF",
            "G4": "PS",
            "G92": AXES,
        }
        if set(values) - set(known.get(name, "")):
            self._act(f"{name} with words that it has not, or that move another axis")
        if self.pen and name == "M280":
            self._servo(values)
        elif name in ("G0", "G1", "G2", "G3"):
            self._move(name, values)
        elif name == "G4":
            seconds = values.get("S", values.get("P", 0.0) / 1e3)
            if seconds < 0:
                self._act("a dwell of less than nothing")
            self.moved_s += seconds
            self.run.legs.append(Leg(self.number, "wait", tuple(self.at), tuple(self.at), seconds=seconds))
        elif name in ("G90", "G91"):
            self.absolute = name == "G90"
        elif name == "G21":
            self.mm = 1.0
        elif name == "G92":
            for k, axis in enumerate(AXES):
                if axis in values:
                    self.shift[k] = self.at[k] - values[axis] * self.mm
        elif name not in IDLE:
            self._act(f"{name} is unknown, or does something else")
        return None

    def _stop(self) -> None:
        self.run.legs.append(Leg(self.number, "stop", tuple(self.at), tuple(self.at)))

    def _servo(self, values: dict[str, float]) -> None:
        if values.get("P") != self.pen.number or values.get("S") not in self.pen.heights:
            return self._act("a servo's value that is no pen's")
        if not self.is_still:
            self._act("a servo set while moves are still held")
        there = [*self.at[:2], self.pen.heights[values["S"]]]
        if there != self.at:
            self.run.legs.append(Leg(self.number, "jump", tuple(self.at), tuple(there), DROPPED_MM_S))
            self.moved_s = 0.0
        self.at = there
        return None

    def _move(self, name: str, values: dict[str, float]) -> None:
        if "F" in values:
            if values["F"] <= 0:
                self._act("no feed")
            self.feed_mm_s = abs(values["F"]) * self.mm / 60
        there = list(self.at)
        for k, axis in enumerate(AXES):
            if axis in values:
                there[k] = values[axis] * self.mm + (self.shift[k] if self.absolute else self.at[k])
        start, end = tuple(self.at), tuple(there)
        if self.pen and "Z" in values:
            self._act("an axis that this plotter has not")
        if name in ("G0", "G1"):
            if set(AXES) & set(values):
                if self.pen and self.moved_s < self.pen.least_s - KNOWN_S:
                    self._act("goes before the pen is there")
                self.run.legs.append(Leg(self.number, "feed", start, end, self.feed_mm_s))
        elif not self.has_arcs:
            self._act(f"{name}, which this firmware does not know")
        elif not (values.get("I") or values.get("J")):
            if self.firmware == "klipper":
                raise RefusedError(f"line {self.number}: {name} requires IJ parameters")
            self._act("bad parameters of a circle")
        else:
            if not self.absolute and self.firmware == "klipper":
                raise RefusedError(f"line {self.number}: {name} does not support relative move mode")
            centre = (start[0] + values.get("I", 0.0) * self.mm, start[1] + values.get("J", 0.0) * self.mm)
            turn = 1 if name == "G3" else -1
            self.run.legs.append(Leg(self.number, "arc", start, end, self.feed_mm_s, centre, turn))
        self.at = there
