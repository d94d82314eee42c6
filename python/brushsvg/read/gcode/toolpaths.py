"""G-code that somebody else wrote for a pen plotter, run for the ways that its pen goes: absolute, relative, inches,
circles, a pen that goes by Z or by M3 and M5. What is not known is refused, not passed over."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ...errors import Error

_WORD = re.compile(r"([A-Z])\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*")
_PASSED_OVER = {  # of which no pen's way hangs
    "G": {4, 10, 17, 21.1, 40, 43, 43.1, 49, 54, 61, 64, 80, 94},
    "M": {0, 1, 2, 6, 7, 8, 9, 17, 18, 30, 82, 83, 84, 105, 106, 107, 114, 117, 201, 203, 204, 205, 300, 400},
}
_WITH_TEXT = re.compile(r"(?:N\d+\s*)?M\s*0*(?:0|1|117)(?![\d.])")  # a message may follow: M0 change the pen
_ONE_OF = ({0, 1, 2, 3}, {20, 21}, {90, 91}, {90.1, 91.1})  # G: a line may have one of each
_LETTERS = set("GMNTXYZIJRFSPELHOQKD")
_OTHER_S = (("G", 4.0), ("M", 280.0), ("M", 300.0))  # whose S is a time, an angle, a tone
CHORD_MM = 0.005
LARGEST_MM = 1e6
MOST_ANGLE_DEG = 180.0


@dataclass(frozen=True)
class Way:
    """One move, as points (n, 3) [mm] from where the tool is; rapid: by G0; turn: 1 or -1 of a circle about a centre,
    counter-clockwise or not; power: what M3, M4 or M280 holds while it goes, None behind M5 or S0 and before either;
    by_angle: 280 or 300 by that M, 0 by another; by_laser: by M4; unit_told: whether G20 or G21 stands before it,
    without which its numbers count as mm."""

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


def ways(text: str) -> list[Way]:
    """All moves to the side or up and down, in order; a way that leads nowhere is a dot: there the pen goes down and up
    again. Error with the line for what is not read."""
    return ways_and_end(text)[0]


def ways_and_end(text: str) -> tuple[list[Way], float | None]:
    """The same, and what M3, M4 or M280 holds behind the last line. M2 and M30 end what M3 holds, as M5 does, and
    leave a servo of M280 where it is."""
    reader = _Reader()
    for number, line in enumerate(text.splitlines(), 1):
        reader.line(number, line)
    return list(_with_dots(reader.ways)), reader.pen()


def _with_dots(some: list[Way]) -> Iterator[Way]:
    for way, following in pairwise([*some, None]):
        yield way
        if following is not None and _sinks(way) and _sinks(following, -1):
            yield replace(way, points_mm=way.points_mm[[-1, -1]], rapid=False)


def _sinks(way: Way, turn: int = 1) -> bool:
    """Straight down, or, turned, up."""
    (x, y, high), *_, (u, v, low) = way.points_mm
    return x == u and y == v and not way.turn and turn * (high - low) > 0


class _Reader:
    def __init__(self):
        self.ways: list[Way] = []
        self.at = np.full(3, np.nan)  # where the tool is before, nobody knows
        self.shift = np.zeros(3)
        self.mm, self.unit_known = 1.0, False
        self.absolute, self.absolute_centres = True, False
        self.motion, self.feed_mm_s = None, 0.0
        self.power, self.on, self.by_angle, self.ended = 0.0, False, 0, False
        self.percents, self.ways_before = 0, 0
        self.by_laser = False

    def line(self, number: int, line: str) -> None:
        code = re.sub(r"\([^()]*\)", "", line.partition(";")[0]).strip().upper()
        code = re.sub(r"\*\d+$", "", code.lstrip("/"))  # a checksum
        if re.match(r"(?:N\d+\s*)?G28(?!\d)", code):  # axes without numbers: home these
            code = re.sub(r"([XYZ])(?!\s*[-+.\d])", r"\g<1>0", code)
        if (
            not code or self.ended or code.startswith("$")
        ):  # a setting of grbl's, or $H: where it goes, nobody knows
            self.at[:] = np.nan if code.startswith("$H") else self.at
            return
        if code.startswith("%"):  # the second ends the program
            self.percents += 1
            self.ended = self.percents > 1
            return
        if re.search(r"\dE[-+]?\d", code):
            raise _unread(number, line)
        words, at = [], 0
        while at < len(code):
            if not (found := _WORD.match(code, at)):
                if _WITH_TEXT.match(code):
                    return
                raise _unread(number, line)
            words.append((found[1], float(found[2])))
            at = found.end()
        named = [letter for letter, _ in words if letter not in "GM"]
        codes = {value for letter, value in words if letter == "G"}
        if (
            set(named) - _LETTERS
            or len(set(named)) < len(named)
            or any(len(codes & group) > 1 for group in _ONE_OF)
        ):
            raise _unread(number, line)
        values = {letter: value for letter, value in words if letter not in "GMNT"}
        power = self.pen()
        for letter, code_number in words:
            if letter in "GM":
                self._mode(number, line, letter, code_number, values)
        if "F" in values:
            self.feed_mm_s = values["F"] * self.mm / 60
        if "S" in values and not any(word in _OTHER_S for word in words):
            self.power = values["S"]
        if self.pen() != power:
            self._dot(number, power)
        if 4 in codes and set("XYZIJ") & set(values):  # a wait by some, a way behind it by others
            raise _unread(number, line)
        if codes & {92, 10, 43, 43.1}:  # offsets, not places
            return
        if 53 in codes:  # a place of the machine's own frame
            self.at[[k for k, axis in enumerate("XYZ") if axis in values]] = np.nan
            return
        if set("XYZ") & set(values) or (self.motion in (2, 3) and set("IJ") & set(values)):
            self._move(number, line, values)

    def pen(self) -> float | None:
        """What M3, M4 or M280 holds, None where the pen is up: M3 S0 lets go as M5 does, and 0 is an angle of M280."""
        return self.power if self.on and (self.power or self.by_angle) else None

    def _dot(self, number: int, power: float | None) -> None:
        """Where a pen goes down and up again without a move."""
        if power is not None and len(self.ways) == self.ways_before and np.isfinite(self.at[:2]).all():
            here = np.array([self.at, self.at])
            dot = Way(number, here, False, self.feed_mm_s, power, self.unit_known, by_angle=self.by_angle)
            self.ways.append(dot)
        self.ways_before = len(self.ways)

    def _mode(self, number: int, line: str, letter: str, code: float, values: dict) -> None:
        if letter == "G" and code in (0, 1, 2, 3):
            self.motion = int(code)
        elif letter == "G" and code in (20, 21):
            self.mm, self.unit_known = 25.4 if code == 20 else 1.0, True
        elif letter == "G" and code in (90, 91):
            self.absolute = code == 90
        elif letter == "G" and code in (90.1, 91.1):
            self.absolute_centres = code == 90.1
        elif letter == "G" and (code == 92 or (code == 10 and values.get("L") == 20)):
            for k, axis in enumerate("XYZ"):
                if axis in values:
                    # of a place that nobody knows it is the beginning
                    known = 0.0 if math.isnan(self.at[k]) else self.at[k]
                    self.at[k], self.shift[k] = known, known - values[axis] * self.mm
        elif letter == "G" and code == 28:
            self.at[:] = np.nan
            for axis in "XYZ":
                values.pop(axis, None)
        elif letter == "M" and code in (3, 4, 5):
            self.on, self.by_angle, self.by_laser = code != 5, 0, code == 4
        elif letter == "M" and "S" in values and (code == 280 or _is_angle(code, values)):  # a servo's angle
            self.on, self.power, self.by_angle = True, values["S"], int(code)
            self.by_laser = False
        elif letter == "G" and code == 53:
            pass
        elif code not in _PASSED_OVER[letter]:
            raise _unread(number, line)
        self.ended = letter == "M" and code in (2, 30)
        self.on = self.on and (self.by_angle or not self.ended)

    def _move(self, number: int, line: str, values: dict) -> None:
        if self.motion is None:
            self.motion = 0  # what grbl and Marlin begin with
        start, end = self.at.copy(), self.at.copy()
        for k, axis in enumerate("XYZ"):
            if axis in values:
                given_mm = values[axis] * self.mm
                if not self.absolute and math.isnan(self.at[k]):
                    self.at[k] = start[k] = 0.0  # what begins relative begins at its zero
                end[k] = given_mm + self.shift[k] if self.absolute else self.at[k] + given_mm
        if np.abs(np.nan_to_num(end)).max() > LARGEST_MM:
            raise _too_far(number, line)
        straight = np.array([start, end])
        rapid, by_angle = self.motion == 0, self.by_angle
        way = Way(number, straight, rapid, self.feed_mm_s, self.pen(), self.unit_known, by_angle=by_angle)
        way = replace(way, by_laser=self.by_laser)
        if self.motion in (2, 3):
            way = self._circle(number, line, way, values)
        if way.turn or not np.array_equal(start, end, equal_nan=True):
            self.ways.append(way)
        self.at = end

    def _circle(self, number: int, line: str, way: Way, values: dict) -> Way:
        start, end = way.points_mm
        turn = 1 if self.motion == 3 else -1
        if not np.isfinite([*start[:2], *end[:2]]).all():
            raise Error(f"line {number}: a circle from nowhere", code="line-incomplete")
        if ("R" in values and {"I", "J"} & set(values)) or values.get("P", 1.0) != 1.0:
            raise _unread(number, line)
        if "R" in values:
            radius = values["R"] * self.mm
            half, chord = (end - start)[:2] / 2, math.dist(start[:2], end[:2])
            if not 0 < chord <= 2 * abs(radius) + 0.01:
                raise Error(f"line {number}: {line.strip()[:40]!r} is no circle", code="line-incomplete")
            high = math.sqrt(max(radius**2 - chord**2 / 4, 0.0)) * turn * (1 if radius > 0 else -1)
            centre = start[:2] + half + high * np.array([-half[1], half[0]]) * 2 / chord
        elif {"I", "J"} & set(values):
            offset_mm = np.array([values.get("I", 0.0), values.get("J", 0.0)]) * self.mm
            centre = offset_mm + self.shift[:2] if self.absolute_centres else start[:2] + offset_mm
        else:
            raise Error(f"line {number}: {line.strip()[:40]!r} is no circle", code="line-incomplete")
        if not np.abs(centre).max() <= LARGEST_MM:
            raise _too_far(number, line)
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


def _is_angle(code: float, values: dict) -> bool:
    """Whether M300 moves a servo to an angle, as on the MakerBot Unicorn, and plays no tone, which lasts for P ms and
    is higher than 180 Hz."""
    return code == 300 and values["S"] <= MOST_ANGLE_DEG and "P" not in values


def _too_far(number: int, line: str) -> Error:
    return Error(f"line {number}: {line.strip()[:40]!r} leads beyond 1e6 mm", code="line-unread")


def _unread(number: int, line: str) -> Error:
    return Error(f"line {number}: {line.strip()[:40]!r} is not read", code="line-unread")
