"""Run G-code of LinuxCNC, grbl 1.1 and FluidNC as strictly as their manuals do.

The interpreters cover everything that a damage could write.

- LinuxCNC follows RS274/NGC of its manual: lines of 252 letters, G64 P, comments that act.
- grbl 1.1 has its own list of commands, real-time letters anywhere and lines of 79 letters. A servo needs laser
  mode ($32=1).
- FluidNC follows its wiki. It is like grbl, but has lines of 255 letters and comments that act. Both ends of a
  circle must be equally far from its centre, to 0.005 mm.
"""

from __future__ import annotations

import itertools
import math
import re

from .moves import Leg, RefusedError, Run

WORD = re.compile(r"([A-Z])([+-]?(?:\d+\.?\d*|\.\d+))")
ACTS = re.compile(
    r"\s*((MSG|DEBUG|PRINT|LOG|LOGOPEN|LOGAPPEND|PY|PYRUN|AXIS|ABORT)\s*,|LOGCLOSE|PROBEOPEN|PROBECLOSE)",
    re.I,
)
GROUPS = {
    "linuxcnc": (
        ("motion", "0 1 2 3 33 38.2 38.3 38.4 38.5 73 76 80 81 82 83 84 85 86 87 88 89 5 5.1 5.2"),
        ("still", "4 10 28 28.1 30 30.1 52 53 92 92.1 92.2 92.3"),
        ("plane", "17 17.1 18 18.1 19 19.1"),
        ("units", "20 21"),
        ("radius", "40 41 41.1 42 42.1"),
        ("length", "43 43.1 43.2 49"),
        ("system", "54 55 56 57 58 59 59.1 59.2 59.3"),
        ("path", "61 61.1 64"),
        ("distance", "90 91"),
        ("centres", "90.1 91.1"),
        ("feed", "93 94 95"),
        ("spindle mode", "96 97"),
        ("retract", "98 99"),
        ("lathe", "7 8"),
    ),
    "grbl": (
        ("motion", "0 1 2 3 38.2 38.3 38.4 38.5 80"),
        ("still", "4 10 28 28.1 30 30.1 53 92 92.1"),
        ("plane", "17 18 19"),
        ("units", "20 21"),
        ("radius", "40"),
        ("length", "43.1 49"),
        ("system", "54 55 56 57 58 59"),
        ("path", "61"),
        ("distance", "90 91"),
        ("centres", "91.1"),
        ("feed", "93 94"),
    ),
}
M_GROUPS = {
    "linuxcnc": (
        ("stop", "0 1 2 30 60"),
        ("spindle", "3 4 5 19"),
        ("tool", "6 61"),
        ("coolant", "7 8 9"),
        ("override", "48 49 50 51 52 53"),
        ("io", "62 63 64 65 66 67 68"),
    ),
    "grbl": (("stop", "0 1 2 30"), ("spindle", "3 4 5"), ("coolant", "7 8 9")),
}
KNOWN = {
    dialect: (
        {float(code): name for name, codes in groups for code in codes.split()},
        {float(code): name for name, codes in M_GROUPS[dialect] for code in codes.split()},
    )
    for dialect, groups in GROUPS.items()
}
USUAL = {"units": 21.0, "distance": 90.0, "centres": 91.1, "plane": 17.0, "radius": 40.0, "feed": 94.0}
PUT_BACK = {"distance", "plane", "radius", "feed"}  # M2 and M30 reset these
AXES = "XYZ"
OTHER_AXES = "ABCUVW"
LONGEST = {
    "linuxcnc": 252,
    "grbl": 79,
    "fluidnc": 255,
}  # rs274 stops at 253; grbl counts neither blanks nor comments


def run_gcode(text: str, dialect: str, start, servo=None, travel_mm_s: float = math.inf) -> Run:
    """Run G-code of a dialect: linuxcnc, grbl or fluidnc.

    start is the place of the tool before the program. servo holds rows (height, value) of a brush on M3 S.
    """
    controller = _Controller(dialect, start, servo, travel_mm_s)
    lines = text.split("\n")
    if lines and not lines[-1]:
        lines.pop()
    try:
        for number, line in enumerate(lines, 1):
            controller.line(number, line)
            if controller.ended:
                break
        if not controller.ended and dialect == "linuxcnc":
            controller.run.acts.append("the file ends without M2 or %")
        done = controller.number if controller.ended else len(lines)
        for number, line in enumerate(lines[done:], done + 1):
            controller.behind_the_end(number, line)
        controller.leave()
    except RefusedError as refusal:
        controller.run.refused = str(refusal)
    return controller.run


class _Controller:
    def __init__(self, dialect, start, servo, travel_mm_s):
        self.run = Run()
        self.firmware, self.servo, self.travel_mm_s = dialect, servo, travel_mm_s
        self.dialect = "linuxcnc" if dialect == "linuxcnc" else "grbl"
        self.at = list(start)
        self.shift = [0.0, 0.0, 0.0]  # the offset that G92 sets
        # Any program or person may have left the state before. Here each setting has its worst value.
        self.motion: float | None = None
        self.mm = 25.4
        self.absolute = False
        self.absolute_centres = dialect == "linuxcnc"
        self.plane = "XZ"
        self.chosen: dict[str, float] = {}
        self.odd = {"radius compensation": dialect == "linuxcnc", "another mode of feed": True}
        self.feed_mm_s = 0.0
        self.cut_mm = math.inf if dialect == "linuxcnc" else 0.0
        self.spindle, self.value, self.was_up = 5, 0.0, False
        self.ended = False
        self.number = 0
        self.has_code = False

    # Letters -----------------------------------------------------------------------------------------

    def line(self, number: int, line: str) -> None:
        self.number = number
        if self.dialect == "grbl":
            self._at_once(line)
        if line.endswith("\r"):
            line = line[:-1]  # the line end of a Windows file
        if "\r" in line:
            self._act("a return within a line")
            for part in line.split("\r"):
                self.line(number, part)
            return
        read = line if self.dialect == "linuxcnc" else re.sub(r"\(.*\)|\s", "", line)
        if len(read) > LONGEST[self.firmware]:
            self._act(f"a line of {len(read)} letters")
            if self.dialect == "linuxcnc":
                raise RefusedError(f"line {number}: command too long")
        code = self._without_comments(line).upper()
        code = "".join(code.split())
        if not code:
            return
        self.has_code = True
        if code.startswith("%"):
            self._act("%")
            if self.dialect == "grbl":
                return
            self.ended = True
            return
        if code.startswith("/"):
            self._act("a block that may be deleted")
            code = code[1:]
        if code.startswith("$") and self.dialect == "grbl":
            self._act("a setting of grbl's")
            return
        self._block(self._words(code))

    def behind_the_end(self, number: int, line: str) -> None:
        self.number = number
        if self.dialect == "grbl":  # a sender may send the rest, or take this for the end
            before = len(self.run.legs)
            self.line(number, line)
            if len(self.run.legs) > before:
                self._act("goes on behind the end")
        elif line.strip():
            self.run.titles.append((line.strip(), len(self.run.legs)))

    def leave(self) -> None:
        """Record the settings that the program changes for the next program or user.

        The program's end resets some settings, but no offset.
        """
        holds = set(USUAL) - (PUT_BACK if self.ended else set())
        left = [f"G{code:g}" for name, code in self.chosen.items() if name in holds and code != USUAL[name]]
        self.run.frame += [f"leaves {word}" for word in left + ["G92"] * any(self.shift)]

    def _at_once(self, line: str) -> None:
        for letter in line:
            if letter in "!?~%" or letter == "\x18" or ord(letter) > 127:
                self._act(f"the letter {letter!r}, which grbl or its sender obeys at once")

    def _without_comments(self, line: str) -> str:
        out, rest = "", line
        while rest:
            place = next((k for k, letter in enumerate(rest) if letter in "(;"), None)
            if place is None:
                out += rest
                break
            out += rest[:place]
            if rest[place] == ";":
                self._comment(rest[place + 1 :])
                break
            end = rest.find(")", place)
            inner = rest[place + 1 : end if end >= 0 else None]
            if self.dialect == "linuxcnc" and (end < 0 or "(" in inner):
                raise RefusedError(f"line {self.number}: unclosed or nested comment")
            self._comment(inner if end >= 0 else f"{inner} ... unclosed")
            rest = rest[end + 1 :] if end >= 0 else ""
        if ")" in out:
            raise RefusedError(f"line {self.number}: a bracket that closes nothing")
        return out

    def _comment(self, words: str) -> None:
        if self.firmware != "grbl" and ACTS.match(words):
            self._act(f"the comment ({words[:30]})")
        if self.has_code:
            self.run.titles.append((words, len(self.run.legs)))
        else:
            self.run.header.append(words)

    def _act(self, what: str) -> None:
        self.run.acts.append(f"line {self.number}: {what}")

    def _words(self, code: str) -> list[tuple[str, float]]:
        words, at = [], 0
        while at < len(code):
            found = WORD.match(code, at)
            if not found:
                raise RefusedError(f"line {self.number}: {code[at : at + 10]!r} is no word")
            words.append((found[1], float(found[2])))
            at = found.end()
        return words

    # A line ------------------------------------------------------------------------------------------

    def _block(self, words) -> None:
        codes: dict[str, float] = {}
        m_codes: dict[str, float] = {}
        values: dict[str, float] = {}
        for letter, value in words:
            if letter in "GM":
                name = KNOWN[self.dialect][letter == "M"].get(round(value, 4))
                if name is None:
                    raise RefusedError(f"line {self.number}: unknown {letter}{value:g}")
                into = codes if letter == "G" else m_codes
                if name in into:
                    raise RefusedError(f"line {self.number}: two codes of one group")
                into[name] = round(value, 4)
            elif letter in values:
                raise RefusedError(f"line {self.number}: {letter} twice")
            else:
                values[letter] = value
        known = AXES + OTHER_AXES + "IJKFSPNRQLDHTE" if self.dialect == "linuxcnc" else AXES + "IJKFSPNRLT"
        for letter in values:
            if letter not in known or (letter in OTHER_AXES and self.dialect == "linuxcnc"):
                raise RefusedError(f"line {self.number}: bad letter {letter}")
        if any(values.get(letter, 0) < 0 for letter in "FSNT"):
            raise RefusedError(f"line {self.number}: negative")
        used = set("FSNT") & set(values)
        self._settings(codes, m_codes, values)
        still = codes.get("still")
        self._before(codes, m_codes, values, used)
        has_axes = bool(set(AXES) & set(values))
        motion = codes.get("motion")
        if motion is not None and has_axes and still in (10.0, 28.0, 30.0, 92.0):
            raise RefusedError(f"line {self.number}: two codes want the axes")
        if still == 92.0:
            self._shift(values)
            used |= set(AXES) & set(values)
        elif still in (10.0, 28.0, 28.1, 30.0, 30.1, 53.0, 52.0) or (still and still > 92):
            self._act(f"G{still:g}: offsets or places that no program here may rely on")
            used |= set(AXES) & set(values) | set("PLR")
            if still == 53.0 and has_axes:
                raise RefusedError(f"line {self.number}: machine coordinates")
        if motion is not None:
            self.motion = None if motion == 80.0 else motion
        if still != 92.0 and (has_axes or motion is not None):
            used |= self._move(values, motion, has_axes)
        if unused := set(values) - used:
            raise RefusedError(f"line {self.number}: words that nothing uses: {sorted(unused)}")
        self._light()
        stop = m_codes.get("stop")
        if stop in (0.0, 1.0, 60.0):
            here = tuple(self.at)
            self.run.legs.append(Leg(self.number, "stop", here, here))
        elif stop in (2.0, 30.0):
            self.ended = True
            self.run.frame.append("end")
            self.spindle = 5
            self._light()

    def _settings(self, codes, m_codes, values) -> None:
        self.chosen |= codes
        if "units" in codes:
            self.mm = 25.4 if codes["units"] == 20.0 else 1.0
        if "feed" in codes:
            self.odd["another mode of feed"] = codes["feed"] != 94.0
        if "F" in values:
            if values["F"] == 0 and self.dialect == "linuxcnc":
                self.feed_mm_s = 0.0
            self.feed_mm_s = values["F"] * self.mm / 60
        if "S" in values:
            self.value = values["S"]
        spindle = m_codes.get("spindle")
        if spindle is not None:
            if self.servo is None and spindle != 5.0:
                self._act("the spindle turns")
            self.spindle = int(spindle)
        if set(m_codes) & {"tool", "io", "override"} or m_codes.get("coolant", 9.0) != 9.0:
            self._act("M codes for what is not there")
        if "plane" in codes:
            self.plane = {17.0: "XY", 18.0: "XZ", 19.0: "YZ"}.get(codes["plane"], "UV")
        if "radius" in codes:
            self.odd["radius compensation"] = codes["radius"] != 40.0
        if codes.get("length", 49.0) != 49.0:
            self._act("a tool's length")
        if codes.get("system", 54.0) != 54.0:
            self._act("another coordinate system")
        elif "system" in codes:  # in another system, the sound program would run at an unknown place
            self.run.frame.append("chooses the coordinate system")
        if "distance" in codes:
            self.absolute = codes["distance"] == 90.0
        if "centres" in codes:
            self.absolute_centres = codes["centres"] == 90.1
        if set(codes) & {"lathe", "spindle mode"}:
            self._act("a lathe's mode")

    def _before(self, codes, m_codes, values, used) -> None:
        """Execute the words that act before a move: dwell, path mode, servo value."""
        if codes.get("still") == 4.0:
            if values.get("P", -1.0) < 0:
                raise RefusedError(f"line {self.number}: a dwell without time")
            if set(AXES) & set(values):
                raise RefusedError(f"line {self.number}: a dwell with axes")
            here = tuple(self.at)
            self.run.legs.append(Leg(self.number, "wait", here, here, seconds=values["P"]))
            used.add("P")
        path = codes.get("path")
        if path == 64.0:
            if values.get("P", 0) < 0:
                raise RefusedError(f"line {self.number}: a negative tolerance")
            self.cut_mm = values.get("P", 0) * self.mm or math.inf  # rs274 reads a missing P as 0
            used |= {"P", "Q"} & set(values)
        elif path is not None:
            self.cut_mm = 0.0

    def _shift(self, values) -> None:
        for k, axis in enumerate(AXES):
            if axis in values:
                self.shift[k] = self.at[k] - values[axis] * self.mm

    def _light(self) -> None:
        """Set the value that the servo holds after this line."""
        if self.servo is None:
            return
        on = self.spindle == 3 and self.motion in (1.0, 2.0, 3.0)
        if self.spindle == 4:
            self._act("M4: the value hangs on the speed")
        if on:
            self.was_up = True
        elif self.was_up:
            self._act("the servo is switched off, the brush falls")
            self.was_up = False
            return
        if on:
            self._jump()

    def _jump(self) -> None:
        rows = sorted(self.servo, key=lambda row: row[1])
        low, high = rows[0][1], rows[-1][1]
        if not round(low) - 0.5 <= self.value <= round(high) + 0.5:
            self._act(f"S{self.value:g} is beyond the servo's values")
        if math.floor(self.value) != self.value:
            self.value = float(math.floor(self.value))
        height = _between(rows, self.value)
        if height != self.at[2]:
            there = (self.at[0], self.at[1], height)
            self.run.legs.append(Leg(self.number, "jump", tuple(self.at), there, self.feed_mm_s))
            self.at[2] = height

    def _move(self, values, motion, has_axes) -> set[str]:
        used = set(AXES) & set(values)
        if self.motion is None:
            if has_axes:
                raise RefusedError(f"line {self.number}: axes without a motion")
            return used
        for what in [what for what, is_so in self.odd.items() if is_so]:
            self._act(what)
            self.odd[what] = False
        if self.motion not in (0.0, 1.0, 2.0, 3.0):
            raise RefusedError(f"line {self.number}: G{self.motion:g} is not for this machine")
        if not has_axes:
            if self.motion in (2.0, 3.0):
                raise RefusedError(f"line {self.number}: a circle without an end")
            if motion is not None and self.dialect == "linuxcnc":
                raise RefusedError(f"line {self.number}: a motion without axes")
            return used
        there = list(self.at)
        for k, axis in enumerate(AXES):
            if axis in values:
                given = values[axis] * self.mm
                there[k] = given + (self.shift[k] if self.absolute else self.at[k])
        if self.motion != 0.0 and not self.feed_mm_s > 0:
            raise RefusedError(f"line {self.number}: no feed")
        if self.servo is not None:
            if "Z" in values:
                self._act("an axis that the machine does not need")
            there[2] = self.at[2]
            self._light()
            there[2] = self.at[2]
        start, end = tuple(self.at), tuple(there)
        if self.motion == 0.0:
            if set("IJKR") & set(values):
                raise RefusedError(f"line {self.number}: a centre without a circle")
            leg = Leg(self.number, "rapid", start, end, self.travel_mm_s, cut_mm=self.cut_mm)
        elif self.motion == 1.0:
            if set("IJKR") & set(values):
                raise RefusedError(f"line {self.number}: a centre without a circle")
            leg = Leg(self.number, "feed", start, end, self.feed_mm_s, cut_mm=self.cut_mm)
        else:
            leg = self._arc(values, start, end)
            used |= set("IJ") & set(values)
        self.run.legs.append(leg)
        self.at = there
        return used

    def _arc(self, values, start, end) -> Leg:
        if self.plane != "XY":
            raise RefusedError(f"line {self.number}: a circle in another plane")
        if set("KR") & set(values) or not set("IJ") & set(values):
            raise RefusedError(f"line {self.number}: a circle without a centre in this plane")
        i, j = (values.get(letter, 0.0) * self.mm for letter in "IJ")
        centre = (i, j) if self.absolute_centres else (start[0] + i, start[1] + j)
        first, last = (math.dist(centre, point[:2]) for point in (start, end))
        off_mm = abs(first - last)
        if first < 1e-9:
            raise RefusedError(f"line {self.number}: a circle of no radius")
        if self.dialect == "linuxcnc":
            bad = off_mm > 0.254 or (off_mm > 0.00254 and off_mm > 0.001 * first)
        else:
            bad = off_mm > 0.5 or (off_mm > 0.005 and off_mm > 0.001 * first)
            bad |= self.firmware == "fluidnc" and off_mm > 0.005
        if bad:
            raise RefusedError(f"line {self.number}: the circle's ends are on two circles")
        turn = 1 if self.motion == 3.0 else -1
        return Leg(self.number, "arc", start, end, self.feed_mm_s, centre, turn, self.cut_mm)


def _between(rows, value: float) -> float:
    """Return the height at a value, from rows (height, value) with rising values.

    Values beyond the rows get the height of the nearest end.
    """
    if value <= rows[0][1]:
        return rows[0][0]
    for (low, first), (high, last) in itertools.pairwise(rows):
        if value <= last:
            return low + (high - low) * (value - first) / (last - first)
    return rows[-1][0]
