"""Interpreter for the G-code of pen plotters: it returns the ways of the pen.

It knows absolute and relative coordinates, inches, circles, and pens that follow Z or M3 and M5. An unknown command
is an error, because ignoring it could move the pen elsewhere.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ...errors import Error

_WORD = re.compile(r"([A-Z])\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*")
_IGNORED_CODES = {  # commands that do not change the way of a pen
    "G": {4, 10, 17, 21.1, 40, 43, 43.1, 49, 54, 61, 64, 80, 94},
    "M": {0, 1, 2, 6, 7, 8, 9, 17, 18, 30, 82, 83, 84, 105, 107, 114, 300, 400},
}
# Commands that a message may follow, for example: M0 change the pen.
_MESSAGE_COMMAND = re.compile(r"(?:N\d+\s*)?M\s*0*[01](?![\d.])")
# Commands of Marlin that do not change the way of a pen. All other words of their line are settings, as in M203 X500,
# or a message, as in M117 X10. Other controllers read several commands from a line, as in M17 G0 Z5.
_MARLIN_COMMAND = re.compile(
    r"(?:N\d+\s*)?M\s*0*(?:117(?![\d.])|(?:17|18|82|83|84|105|106|107|114|201|203|204|205|400)(?![\d.])[^GM]*$)"
)
_MODAL_GROUPS = ({0, 1, 2, 3}, {20, 21}, {90, 91}, {90.1, 91.1})  # G codes: a line may have one of each group
_KNOWN_LETTERS = set("GMNTXYZIJRFSPELHOQKD")
# Commands whose S is a time, an angle or a tone, and not the power.
_COMMANDS_WITH_OTHER_S = (("G", 4.0), ("M", 280.0), ("M", 300.0))
CHORD_MM = 0.005  # largest distance between a circle and its chords
MAX_COORDINATE_MM = 1e6
MAX_SERVO_ANGLE_DEG = 180.0  # S of M300 up to this value can be an angle; larger values are tones in Hz


@dataclass(frozen=True)
class Way:
    """One move of the tool.

    line: line number in the program, counted from 1.
    points_mm: (n, 3), from the position of the tool to the end of the move.
    rapid: whether it is a G0 move.
    speed_mm_s: feed rate, 0 if the program has not set one.
    power: the S value of M3, M4 or M280 during the move; None after M5 or S0, and before any of these commands.
    unit_known: whether G20 or G21 comes before the move; otherwise numbers count as mm.
    centre_mm: centre of a circle, None for a straight move.
    turn: 1 for a counter-clockwise circle, -1 for a clockwise circle, 0 for a straight move.
    by_angle: 280 or 300 if M280 or M300 set the power, otherwise 0.
    by_laser: whether M4 set the power.
    """

    line: int
    points_mm: np.ndarray
    rapid: bool
    speed_mm_s: float
    power: float | None
    unit_known: bool
    centre_mm: tuple[float, float] | None = None
    turn: int = 0
    by_angle: int = 0
    by_laser: bool = False


def read_moves(text: str) -> list[Way]:
    """Return all moves of a program, in order.

    A way without length is a dot: the pen goes down and up again there. Raises Error with the number of a line that
    cannot be read.
    """
    return ways_and_end(text)[0]


def ways_and_end(text: str) -> tuple[list[Way], float | None]:
    """Return all moves of a program, and the pen value after the last line.

    The pen value is the value of M3, M4 or M280, or None if the pen is up.
    M2 and M30 end the value of M3, as M5 does. They do not move a servo of M280.
    """
    interpreter = _Interpreter()
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1):
        interpreter.run_line(number, line)
    return list(_insert_dots(interpreter.ways)), interpreter.pen_value()


def _insert_dots(all_ways: list[Way]) -> Iterator[Way]:
    for way, following in pairwise([*all_ways, None]):
        yield way
        if following is not None and _is_plunge(way) and _is_plunge(following, -1):
            yield replace(way, points_mm=way.points_mm[[-1, -1]], rapid=False)


def _is_plunge(way: Way, turn: int = 1) -> bool:
    """Whether a way is straight down, or with turn=-1 straight up."""
    (x, y, high), *_, (u, v, low) = way.points_mm
    return x == u and y == v and not way.turn and turn * (high - low) > 0


class _Interpreter:
    def __init__(self):
        self.ways: list[Way] = []
        self.position_mm = np.full(3, np.nan)  # the position at the start is unknown
        self.offset_mm = np.zeros(3)
        self.mm_per_unit, self.unit_known = 1.0, False
        self.absolute, self.absolute_centres = True, False
        self.motion, self.feed_mm_s = None, 0.0
        self.power, self.is_on, self.by_angle, self.is_ended = 0.0, False, 0, False
        self.percent_count, self.way_count_at_pen_change = 0, 0
        self.by_laser = False

    def run_line(self, number: int, line: str) -> None:
        code = re.sub(r"\([^()]*\)|;.*", "", line).strip().upper()
        code = re.sub(r"\*\d+$", "", code.lstrip("/"))  # a checksum
        if re.match(r"(?:N\d+\s*)?G28(?!\d)", code):  # axes without numbers name the axes to home
            code = re.sub(r"([XYZ])(?!\s*[-+.\d])", r"\g<1>0", code)
        # $ begins a setting of grbl, or $H, which moves to an unknown position.
        if not code or self.is_ended or code.startswith("$"):
            self.position_mm[:] = np.nan if code.startswith("$H") else self.position_mm
            return
        if code.startswith("%"):  # the second % ends the program
            self.percent_count += 1
            self.is_ended = self.percent_count > 1
            return
        if _MARLIN_COMMAND.match(code):
            return
        if re.search(r"\dE[-+]?\d", code):
            raise _unread_line_error(number, line)
        words, at = [], 0
        while at < len(code):
            if not (found := _WORD.match(code, at)):
                if _MESSAGE_COMMAND.match(code):
                    return
                raise _unread_line_error(number, line)
            words.append((found[1], float(found[2])))
            at = found.end()
        named = [letter for letter, _ in words if letter not in "GM"]
        codes = {value for letter, value in words if letter == "G"}
        if (
            set(named) - _KNOWN_LETTERS
            or len(set(named)) < len(named)
            or any(len(codes & group) > 1 for group in _MODAL_GROUPS)
        ):
            raise _unread_line_error(number, line)
        values = {letter: value for letter, value in words if letter not in "GMNT"}
        power = self.pen_value()
        for letter, code_number in words:
            if letter in "GM":
                self._apply_code(number, line, letter, code_number, values)
        if "F" in values:
            self.feed_mm_s = values["F"] * self.mm_per_unit / 60
        if "S" in values and not any(word in _COMMANDS_WITH_OTHER_S for word in words):
            self.power = values["S"]
        if self.pen_value() != power:
            self._add_dot(number, power)
        if 4 in codes and set("XYZIJ") & set(values):  # some controllers only wait, others also move
            raise _unread_line_error(number, line)
        if codes & {92, 10, 43, 43.1}:  # the numbers are offsets, not positions
            return
        if 53 in codes:  # the position is in the frame of the machine, so it is unknown here
            self.position_mm[[k for k, axis in enumerate("XYZ") if axis in values]] = np.nan
            return
        if set("XYZ") & set(values) or (self.motion in (2, 3) and set("IJ") & set(values)):
            self._add_move(number, line, values)

    def pen_value(self) -> float | None:
        """Return the value of M3, M4 or M280, None if the pen is up.

        M3 S0 raises the pen as M5 does. For M280, 0 is an angle like any other.
        """
        return self.power if self.is_on and (self.power or self.by_angle) else None

    def _add_dot(self, number: int, power: float | None) -> None:
        """Add a dot if the pen went down and up again without a move."""
        if (
            power is not None
            and len(self.ways) == self.way_count_at_pen_change
            and np.isfinite(self.position_mm[:2]).all()
        ):
            here = np.array([self.position_mm, self.position_mm])
            dot = Way(number, here, False, self.feed_mm_s, power, self.unit_known, by_angle=self.by_angle)
            self.ways.append(dot)
        self.way_count_at_pen_change = len(self.ways)

    def _apply_code(self, number: int, line: str, letter: str, code: float, values: dict) -> None:
        if letter == "G" and code in (0, 1, 2, 3):
            self.motion = int(code)
        elif letter == "G" and code in (20, 21):
            self.mm_per_unit, self.unit_known = 25.4 if code == 20 else 1.0, True
        elif letter == "G" and code in (90, 91):
            self.absolute = code == 90
        elif letter == "G" and code in (90.1, 91.1):
            self.absolute_centres = code == 90.1
        elif letter == "G" and (code == 92 or (code == 10 and values.get("L") == 20)):
            for k, axis in enumerate("XYZ"):
                if axis in values:
                    # An unknown position becomes the origin.
                    known = 0.0 if math.isnan(self.position_mm[k]) else self.position_mm[k]
                    self.position_mm[k], self.offset_mm[k] = known, known - values[axis] * self.mm_per_unit
        elif letter == "G" and code == 28:
            self.position_mm[:] = np.nan
            for axis in "XYZ":
                values.pop(axis, None)
        elif letter == "M" and code in (3, 4, 5):
            self.is_on, self.by_angle, self.by_laser = code != 5, 0, code == 4
        elif letter == "M" and "S" in values and (code == 280 or _is_servo_angle(code, values)):
            # S is a servo angle.
            self.is_on, self.power, self.by_angle = True, values["S"], int(code)
            self.by_laser = False
        elif letter == "G" and code == 53:
            pass
        elif code not in _IGNORED_CODES[letter]:
            raise _unread_line_error(number, line)
        self.is_ended = self.is_ended or (letter == "M" and code in (2, 30))
        self.is_on = self.is_on and (self.by_angle or not self.is_ended)

    def _add_move(self, number: int, line: str, values: dict) -> None:
        if self.motion is None:
            self.motion = 0  # grbl and Marlin begin with G0
        start, end = self.position_mm.copy(), self.position_mm.copy()
        for k, axis in enumerate("XYZ"):
            if axis in values:
                given_mm = values[axis] * self.mm_per_unit
                if not self.absolute and math.isnan(self.position_mm[k]):
                    # A program that begins with a relative move begins at its zero.
                    self.position_mm[k] = start[k] = 0.0
                end[k] = given_mm + self.offset_mm[k] if self.absolute else self.position_mm[k] + given_mm
        if np.abs(np.nan_to_num(end)).max() > MAX_COORDINATE_MM:
            raise _out_of_range_error(number, line)
        straight = np.array([start, end])
        rapid, by_angle = self.motion == 0, self.by_angle
        way = Way(number, straight, rapid, self.feed_mm_s, self.pen_value(), self.unit_known, by_angle=by_angle)
        way = replace(way, by_laser=self.by_laser)
        if self.motion in (2, 3):
            way = self._bend_into_circle(number, line, way, values)
        if way.turn or not np.array_equal(start, end, equal_nan=True):
            self.ways.append(way)
        self.position_mm = end

    def _bend_into_circle(self, number: int, line: str, way: Way, values: dict) -> Way:
        start, end = way.points_mm
        turn = 1 if self.motion == 3 else -1
        if not np.isfinite([*start[:2], *end[:2]]).all():
            raise Error(f"line {number}: a circle without a starting point", code="line-incomplete")
        if ("R" in values and {"I", "J"} & set(values)) or values.get("P", 1.0) != 1.0:
            raise _unread_line_error(number, line)
        if "R" in values:
            radius = values["R"] * self.mm_per_unit
            if abs(radius) > MAX_COORDINATE_MM:
                raise _out_of_range_error(number, line)
            half, chord = (end - start)[:2] / 2, math.dist(start[:2], end[:2])
            if not 0 < chord <= 2 * abs(radius) + 0.01:
                raise Error(f"line {number}: {line.strip()[:40]!r} is not a valid circle", code="line-incomplete")
            offset = math.sqrt(max(radius**2 - chord**2 / 4, 0.0)) * turn * (1 if radius > 0 else -1)
            centre = start[:2] + half + offset * np.array([-half[1], half[0]]) * 2 / chord
        elif {"I", "J"} & set(values):
            offset_mm = np.array([values.get("I", 0.0), values.get("J", 0.0)]) * self.mm_per_unit
            centre = offset_mm + self.offset_mm[:2] if self.absolute_centres else start[:2] + offset_mm
        else:
            raise Error(f"line {number}: {line.strip()[:40]!r} is not a valid circle", code="line-incomplete")
        if not np.abs(centre).max() <= MAX_COORDINATE_MM:
            raise _out_of_range_error(number, line)
        radii = [math.dist(point[:2], centre) for point in (start, end)]
        if min(radii) < 1e-6 or abs(radii[0] - radii[1]) > max(0.02, 0.002 * radii[0]):
            raise Error(
                f"line {number}: {line.strip()[:40]!r} is a circle whose ends are not equally far from its centre",
                code="line-incomplete",
            )
        first, last = (math.atan2(*(point[:2] - centre)[::-1]) for point in (start, end))
        sweep = (last - first) * turn % math.tau or math.tau
        step = 2 * math.acos(max(0.0, 1 - CHORD_MM / max(radii)))
        part = np.linspace(0, 1, max(2, math.ceil(sweep / min(step, 0.5)) + 1))
        radius, angle = radii[0] + (radii[1] - radii[0]) * part, first + turn * sweep * part
        points = np.column_stack(
            [
                centre[0] + radius * np.cos(angle),
                centre[1] + radius * np.sin(angle),
                start[2] + (end[2] - start[2]) * part,
            ]
        )
        points[0], points[-1] = start, end
        return replace(way, points_mm=points, centre_mm=tuple(centre.tolist()), turn=turn)


def _is_servo_angle(code: float, values: dict) -> bool:
    """Whether M300 turns a servo (MakerBot Unicorn) and is no tone, which lasts P ms above 180 Hz."""
    return code == 300 and values["S"] <= MAX_SERVO_ANGLE_DEG and "P" not in values


def _out_of_range_error(number: int, line: str) -> Error:
    return Error(f"line {number}: {line.strip()[:40]!r} goes beyond 1e6 mm", code="line-unread")


def _unread_line_error(number: int, line: str) -> Error:
    return Error(f"line {number}: {line.strip()[:40]!r} is not read", code="line-unread")
