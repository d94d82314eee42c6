"""Read back G-code that brushsvg wrote.

The programs consist of straight moves, circles, dwells, stops and servo values.
"""

from __future__ import annotations

import math
import re
from functools import cache, lru_cache

from ...errors import Error
from ...machine.cells.cell import Cell
from ...machine.cells.language_limits import ARCS_IN_SEGMENTS
from ...machine.posts.gcode import DIALECTS, HELD_UP, comment
from ...machine.posts.gcode_servo import height_at
from . import Act, Readback, Step

_VALUE = r"(?:[GM]-?|[A-FH-LN-Z][+-]?)(?:\d+\.?\d*|\.\d+)"
_CODE = re.compile(rf"(?:{_VALUE}(?: +|$))+")
_WORD = re.compile(r"([A-Z])([+-]?(?:\d+\.?\d*|\.\d+))")
_END = re.compile(r"M(?:0?2|30)")
# Motion codes, and the words that may follow them.
MOTION_WORDS = {"G0": "XYZF", "G1": "XYZF", "G2": "XYZIJF", "G3": "XYZIJF"}
# The modes that each mode replaces.
REPLACED_MODES = {"G18": ["G17"], "G19": ["G17"], "G90.1": ["G91.1"], "G61": ["G64"], "G64": ["G61"]}
MODES = {"G17", "G40", "G80", "G91.1", "G94", "G61", "G18", "G19", "G90.1"}
# Codes that must be the only G or M code of their line.
EXCLUSIVE_CODES = set("G0 G1 G2 G3 G4 G64 G61 M0 M2 M3 M5".split())
LASTING_MODES = set("G17 G18 G19 G21 G40 G90 G90.1 G91.1 G94".split())  # modes that end no motion
# Grbl answers these codes with an error, and senders then stop with the brush pressed.
UNKNOWN_TO_GRBL = {"G64", "G90.1"}
PRINTER_WORDS = MOTION_WORDS | {"G4": "P", "G21": "", "G90": "", "M400": ""}
REQUIRED_MODES = {"G21": "millimetres", "G90": "absolute places"}


@lru_cache(maxsize=10_000)  # the steps of a servo are a few different lines, repeated many times
def _words(line: str) -> tuple[tuple[str, float], ...]:
    """Return the letters and numbers of a line; () for a line without words."""
    if not _CODE.fullmatch(line):
        return ()
    return tuple((letter, float(value) + 0.0) for letter, value in _WORD.findall(line))


def read_gcode(text: str, cell: Cell) -> Readback:
    """Read a G-code program as steps.

    Raises Error with the line for words that brushsvg does not write, and for a missing G21, G90 or M2.
    """
    return _Reader(cell).read(text)


class _Reader:
    def __init__(self, cell: Cell):
        self.out = Readback()
        self.dialect = DIALECTS[cell.language]
        self.remark = re.compile(self.dialect.remark)
        self.words = dict.fromkeys(MODES | set(REQUIRED_MODES) | {"M0", "M2"}, "") | MOTION_WORDS
        self.words |= {"G4": "P", "G64": "P", "": "F"} | ({"M3": "SF", "G1": "XYSF"} if cell.servo else {"M5": ""})
        if not self.dialect.has_blocks:
            self.words = dict(PRINTER_WORDS)
            if cell.pen:
                self.words |= {"G0": "XYF", "G1": "XYF", "G2": "", "G3": "", "M280": "PS"}
        self.pen, self.heights, self.press_mm_s = cell.pen, cell.heights, cell.speeds.press_mm_s
        self.stands = True  # whether the tool stands: after M400, and before any move
        self.known = EXCLUSIVE_CODES | MODES | set(REQUIRED_MODES)
        if cell.language != "linuxcnc":
            self.known -= UNKNOWN_TO_GRBL
        self.for_circles = {"G17", "G91.1"} if cell.language == "linuxcnc" else {"G17"}
        self.ends_by_words = bool(cell.servo) or not self.dialect.has_blocks
        self.may_circle = bool(cell.arc_segment_mm) or cell.language not in ARCS_IN_SEGMENTS
        self.motion = ""
        self.value = math.nan  # of the servo
        self.unit_mm = 10.0**-cell.decimals
        self.servo = cell.servo
        self.firmware = {"linuxcnc": "LinuxCNC", "fluidnc": "FluidNC"}.get(cell.language, cell.language)
        self.height_at = cache(lambda value: height_at(cell.servo, value))
        self.at = {axis: math.nan for axis in "XYZ"}
        self.feed_mm_s = 0.0
        self.rapid_mm_s = cell.speeds.travel_mm_s
        self.seen: set[str] = set()
        self.ended = False

    def read(self, text: str) -> Readback:
        for number, line in enumerate(text.splitlines(), 1):
            self._check_length(number, line)
            line = line.rstrip(" ")
            if line and self.ended:
                if _END.fullmatch(line) and not self.ends_by_words:
                    continue  # a second end has no effect
                raise Error(f"line {number}: {line[:40]!r} stands behind the end of the program", code="line-unread")
            if comment_match := self.remark.fullmatch(line):
                self._comment(number, line, comment_match[1])
                self.ended = self.ends_by_words and comment_match[1] == HELD_UP
            elif line and self.dialect.has_blocks:
                self._read_block(number, line)
            elif line:
                self._read_printer_line(number, line)
        for mode, meaning in REQUIRED_MODES.items():
            if mode not in self.seen:
                raise Error(f"{mode} is missing: nothing says that its numbers are {meaning}", code="mode-missing")
        if not self.ended:
            end = self.dialect.comment(HELD_UP).strip() if self.ends_by_words else "M2"
            raise Error(f"{end} is missing: the program has no end, or half of it was lost", code="program-cut-short")
        return self.out

    def _check_length(self, number: int, line: str) -> None:
        """Raise Error for a line that is longer than the controller reads."""
        # grbl drops blanks before it counts letters.
        size = len(line) if self.dialect.counts_blanks else len(line.replace(" ", ""))
        if size > self.dialect.longest:
            sentence = f"line {number} has {size} letters, the controller reads no more than {self.dialect.longest}"
            raise Error(sentence, code="line-unread")

    def _read_printer_line(self, number: int, line: str) -> None:
        """Read a printer's line: it obeys only the first G or M code, and does not remember it."""
        words = () if line[1:2] == "-" else _words(line)  # other controllers read G-0 as G0, this firmware does not
        first = f"{words[0][0]}{words[0][1]:g}" if words else ""
        stop = self.dialect.stops[-1]
        if line == stop or (first == stop and len(words) == 1):
            self.out.acts.append(Act(number, "text", stop))
            return
        values = dict(words[1:])
        if first not in self.words or len(values) + 1 != len(words) or not set(values) <= set(self.words[first]):
            raise Error(f"line {number}: {line[:40]!r} is not a line that brushsvg writes", code="line-unread")
        if values and self.out.modes is None:
            self.out.modes = frozenset(self.seen)
        if first in ("G2", "G3") and not self.may_circle:
            raise Error(
                f"line {number}: {line[:40]!r} is a circle, which brushsvg does not write for the cell's firmware",
                code="line-unread",
            )
        if first in MOTION_WORDS:
            self._move(number, line, first, values)
        elif first == "G4":
            self._wait(number, line, values.get("P", -1.0) / self.dialect.per_s)
        elif first == "M280":
            self._move_pen(number, line, values)
        self.stands = first == "M400" or (self.stands and first not in MOTION_WORDS)
        self.seen |= {first} - {"M400"}  # M400 sets no mode

    def _move_pen(self, number: int, line: str, values: dict[str, float]) -> None:
        """Move the pen up or down at once. The firmware would run moves that it still holds after the pen."""
        ups = [float(round(value)) for value in self.pen.servo_values]
        if values.get("P") != self.pen.servo_number or values.get("S") not in ups:
            sentence = f"line {number}: {line[:40]!r} is neither up nor down of the cell's pen"
            raise Error(sentence, code="servo-out-of-range")
        if not self.stands:
            raise Error(f"line {number}: {line[:40]!r} has no M400 before it", code="mode-missing")
        is_down = values["S"] == ups[1]
        height_mm = self.pen.down_mm if is_down else self.heights.safe_mm
        if height_mm == self.at["Z"]:
            return  # the pen is already there
        self.at["Z"] = height_mm
        if math.isnan(self.at["X"]):
            self.out.rises_mm.append(self.at["Z"])
        self._add_step(number, False, {}, None)
        step = self.out.section().steps[-1]
        self.out.section().steps[-1] = step._replace(speed_mm_s=min(self.press_mm_s, self.feed_mm_s or math.inf))
        self.out.acts.append(Act(number, "text", f"M280 {'down' if is_down else 'up'}"))

    def _read_block(self, number: int, line: str) -> None:
        if not (words := _words(line)):
            raise Error(f"line {number}: {line[:40]!r} is not a line that brushsvg writes", code="line-unread")
        codes = [f"{letter}{value:g}" for letter, value in words if letter in "GM"]
        values = {letter: value for letter, value in words if letter not in "GM"}
        if codes == ["M30"] and not self.servo:
            codes = ["M2"]  # M2 and M30 both end the program
        idle = [code for code in codes if code == "M9"]  # M9 switches off a coolant that no program switches on
        if len(codes) > 1 and not values and (motion := self._find_unused_motion(codes)):
            self.motion = motion
            idle.append(motion)
        codes = [code for code in codes if code not in idle]
        if (len(codes) > 1 and set(codes) & EXCLUSIVE_CODES) or not set(codes) <= self.known:
            raise Error(f"line {number}: {line[:40]!r} is not a line that brushsvg writes", code="line-unread")
        first = codes[0] if codes else self.motion if set(values) - {"F"} else ""
        if self.servo and not codes and set(values) == {"S"} and "M3" in self.seen:
            first = "M3"  # M3 stays in force
        if values and first in LASTING_MODES and self.motion in ("G0", "G1"):
            first = self.motion  # the motion code stays in force on a line with a mode
        if first not in self.words:
            raise Error(f"line {number}: {line[:40]!r} is not a line that brushsvg writes", code="line-unread")
        if len(values) + len(set(codes)) + len(idle) != len(words) or not set(values) <= set(self.words[first]):
            sentence = f"line {number}: {line[:40]!r} has a word twice, or one that brushsvg does not write"
            raise Error(sentence, code="line-unread")
        if self.servo:
            self._check_servo_held(number, line, first, codes)
        if first == "G64" and "G21" not in self.seen:
            sentence = f"line {number}: {line[:40]!r} stands before G21: nothing says that its number is millimetres"
            raise Error(sentence, code="mode-missing")
        if values and first != "G64" and self.out.modes is None:
            self.out.modes = frozenset(self.seen)
        if first in MOTION_WORDS or not first:
            self._move(number, line, first, values)
        elif first == "G64":
            self.out.joint_mm = values.get("P") or math.inf  # without P, or with P0, the machine decides
        elif first == "M3":
            self._lift(number, values)
        elif first == "G4":
            self._wait(number, line, values.get("P", -1.0))
        elif first in ("M0", "M2"):
            self.out.acts.append(Act(number, "text", first))
            self.ended = first == "M2"
        if "G61" in codes:
            self.out.joint_mm = 0.0
        if "G80" in codes:
            self.motion = ""
        self.seen -= {mode for code in codes for mode in REPLACED_MODES.get(code, ())}
        self.seen |= set(codes)

    def _check_servo_held(self, number: int, line: str, first: str, codes: list[str]) -> None:
        """Raise Error for codes that end G1. Without G1, grbl switches the servo off, and the brush falls."""
        if first == "G0" or ("G80" in codes and "G1" in self.seen):
            sentence = f"line {number}: {line[:40]!r} leaves the servo without a G1 that holds: the brush would fall"
            raise Error(sentence, code="line-unread")

    def _comment(self, number: int, line: str, text: str) -> None:
        """Read a comment.

        Raises Error for a comment that brushsvg would write differently, and for one that the firmware acts on.
        """
        if (plain := self.dialect.comment(text).rstrip("\n")) != line:
            sentence = f"line {number}: {line[:40]!r}: in this language brushsvg would write {plain[:40]!r}"
            raise Error(sentence, code="line-unread")
        if self.dialect.acts and re.match(self.dialect.acts, text, re.IGNORECASE):
            raise Error(f"line {number}: {line[:40]} is a comment that {self.firmware} acts on", code="line-unread")
        self.out.comment(number, text)

    def _wait(self, number: int, line: str, seconds: float) -> None:
        if seconds < 0:
            raise Error(f"line {number}: {line[:40]!r} does not say how long", code="line-incomplete")
        self.out.acts.append(Act(number, "wait", same=(seconds,)))
        if steps := self.out.section().steps:
            last = steps[-1]
            steps[-1] = last._replace(wait_s=last.wait_s + seconds, waits=last.waits + 1)

    def _move(self, number: int, line: str, code: str, values: dict[str, float]) -> None:
        if "F" in values:
            if values["F"] < 0:
                raise Error(f"line {number}: {line[:40]!r} is no feed", code="line-incomplete")
            self.feed_mm_s = values["F"] / 60
        if not code:
            if set(values) - {"F"}:
                raise Error(f"line {number}: {line[:40]!r} does not say how to go there", code="line-incomplete")
            return
        self.motion = code
        places = {axis: values[axis] for axis in "XYZ" if axis in values}
        if not places and "S" not in values:
            if code in ("G2", "G3"):
                raise Error(f"line {number}: {line[:40]!r} is a circle without end or centre", code="line-incomplete")
            return
        if self.servo and "S" in values:
            self.value = values["S"]
            places["Z"] = self._servo_height_mm(number, values["S"])
            # The value takes effect with the move: first the lift, then the path at that height.
            if places["Z"] != self.at["Z"]:
                self._add_step(number, False, {"Z": places["Z"]}, None)
        centre = None
        if code in ("G2", "G3"):
            if self.dialect.has_blocks and not self.for_circles <= self.seen:
                raise Error(
                    f"line {number}: {line[:40]!r} stands where {' '.join(sorted(self.for_circles))} does not hold",
                    code="mode-missing",
                )
            if not {"X", "Y", "I", "J"} <= set(values) or math.isnan(self.at["X"]):
                raise Error(f"line {number}: {line[:40]!r} is a circle without end or centre", code="line-incomplete")
            if math.dist((self.at["X"], self.at["Y"]), (values["X"], values["Y"])) < self.unit_mm / 2:
                raise Error(
                    f"line {number}: {line[:40]!r} is a circle that ends where it began: brushsvg writes two halves",
                    code="line-incomplete",
                )
            turn = 1 if code == "G3" else -1
            centre = (self.at["X"] + values["I"], self.at["Y"] + values["J"], turn)
            radii = [math.dist(centre[:2], end) for end in ((self.at["X"], self.at["Y"]), (values["X"], values["Y"]))]
            if abs(radii[0] - radii[1]) > max(self.dialect.radii_mm, 4 * self.unit_mm):
                sentence = f"line {number}: {line[:40]!r} is a circle whose ends are not equally far from its centre"
                raise Error(sentence, code="line-incomplete")
        if (code != "G0" or not self.dialect.has_blocks) and not self.feed_mm_s > 0:
            raise Error(f"line {number}: {line[:40]!r} has no feed", code="line-incomplete")
        rapid = code == "G0" and self.dialect.has_blocks
        self._add_step(number, rapid, places, centre)
        x, y, z = self.at.values()
        speed = math.inf if rapid else self.feed_mm_s
        if self.servo:
            self.out.acts.append(Act(number, "way", "", (x, y), (speed,), (self.value,)))
        elif centre:
            self.out.acts.append(Act(number, "circle", code, (x, y, z), (speed,), centre[:2]))
        else:
            self.out.acts.append(Act(number, "move", "", (x, y, z), (speed,), (self.out.joint_mm,)))

    def _add_step(self, number: int, rapid: bool, places: dict[str, float], centre) -> None:
        self.at |= places
        # A servo may lift before any F.
        speed = self.rapid_mm_s if rapid else self.feed_mm_s or self.press_mm_s
        if "Z" in places and math.isnan(self.at["X"] + self.at["Y"]):
            self.out.rises_mm.append(places["Z"])
        step = Step(number, rapid, self.at["X"], self.at["Y"], self.at["Z"], speed, 0.0, centre)
        self.out.section().steps.append(step)

    def _lift(self, number: int, values: dict[str, float]) -> None:
        self.feed_mm_s = values["F"] / 60 if "F" in values else self.feed_mm_s
        self.value = values.get("S", self.value)
        before, height = self.at["Z"], self._servo_height_mm(number, self.value)
        if height == before:
            return  # the servo already has this value
        self._add_step(number, False, {"Z": height}, None)
        self.out.acts.append(Act(number, "lift", same=(self.value,)))

    def _find_unused_motion(self, codes: list[str]) -> str:
        """Return a mode line's unused motion code, "" for none and LinuxCNC, which stops at such a line."""
        if self.dialect.comment is comment:
            return ""
        motions = [code for code in codes if code == "G1" or (code == "G0" and not self.servo)]
        rest = set(codes) - set(motions)
        return motions[0] if len(motions) == 1 and rest <= LASTING_MODES else ""

    def _servo_height_mm(self, number: int, value: float) -> float:
        known = [row[1] for row in self.servo.table]
        low, high = round(min(known)), round(max(known))
        if not low <= value <= high:
            sentence = f"line {number}: S{value:g} is outside the range [{low}, {high}] of the cell's servo"
            raise Error(sentence, code="servo-out-of-range")
        return self.height_at(value)
