"""Run the part of JAKA script that a program of moves needs, as the manual says.

Each line is one statement. Names may be in any case. Variables hold poses of six numbers in millimetres and
degrees, and the angles turn about the fixed axes. The whole file is compiled first. If one line is not a
statement, nothing runs.
"""

from __future__ import annotations

import re

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame, turned_deg

N = r"[-+]?(?:\d+\.?\d*|\.\d+)"
SUM = rf"\(?(?:{N}|\w+(?:\[\d\])?)(?: [-+] (?:{N}|\w+(?:\[\d\])?))?\)?"
PATTERNS = {
    "end": re.compile(r"end"),
    "if": re.compile(rf"if\((\w+)\[([0-5])\] < ({N})\):"),
    "here": re.compile(r"(\w+) = get_atl_tcp_pose\(\)"),
    "array": re.compile(rf"(\w+) = \[((?:{N}|\w+)(?:, (?:{N}|\w+))*)\]"),
    "scalar": re.compile(rf"(\w+) = ({SUM})"),
    "frame": re.compile(r"set_user_frame_id\((\d+)\)"),
    "tool": re.compile(r"set_tool\((\w+)\)"),
    "line": re.compile(rf"(movl|movj)\((\w+), ([0-2]), ({N}), ({N}), ({N})\)"),
    "circle": re.compile(rf"movc\((\w+), (\w+), ([01]), ({N}), ({N}), ({N})\)"),
    "sleep": re.compile(rf"sleep\(({N})\)"),
    "pause": re.compile(r"pause\(\)"),
    "acts": re.compile(r"(?:set_\w+|log_message|enable_\w+|exit|create_thread)\(.*\)"),
}


def run_jaka(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray) -> Run:
    """Run a program for JAKA.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell.
    """
    robot = _Robot(start, paper, down, tool)
    try:
        robot.block(_compiled(text, robot.run))
    except RefusedError as refusal:
        robot.run.refused = str(refusal)
    return robot.run


def _compiled(text: str, run: Run) -> list:
    """Return (line, what, found) of each statement.

    An if with its block is (line, "if", (found, block)).
    """
    blocks: list[list] = [[]]
    opened = []
    for number, raw in enumerate(text.split("\n"), 1):
        line = raw.rstrip("\r").strip()
        if "\r" in line:
            run.acts.append(f"line {number}: a return within a line")
        if not line:
            continue
        if line.startswith("#"):
            blocks[-1].append((number, "comment", line[1:].strip()))
            continue
        line = line.split("#")[0].rstrip()
        matches = ((what, pattern.fullmatch(line)) for what, pattern in PATTERNS.items())
        what, found = next((each for each in matches if each[1]), ("", None))
        if not found:
            raise RefusedError(f"line {number}: {line[:40]!r} is no statement")
        if what == "if":
            opened.append((number, found))
            blocks.append([])
        elif what == "end":
            if not opened:
                raise RefusedError(f"line {number}: an end of nothing")
            block, (first, condition) = blocks.pop(), opened.pop()
            blocks[-1].append((first, "if", (condition, block)))
        else:
            blocks[-1].append((number, what, found))
    if opened:
        raise RefusedError("an end is missing")
    return blocks[0]


class _Robot(Arm):
    def __init__(self, start, paper, down, tool):
        super().__init__(start, paper, down, tool, by_radius=False)
        self.names: dict[str, object] = {}
        self.in_base = False
        self.had_code = False

    def block(self, lines) -> None:
        for number, what, found in lines:
            if what == "comment":
                where = self.run.titles if self.had_code else self.run.header
                where.append((found, len(self.run.legs)) if self.had_code else found)
                continue
            self.had_code = True
            if what == "if":
                self._if(number, *found)
            else:
                getattr(self, f"_{what}")(number, found)

    def _known(self, number: int, name: str, length: int = 6):
        value = self.names.get(name.lower())
        if value is None or (length and np.size(value) != length):
            raise RefusedError(f"line {number}: {name} is no such variable")
        return value

    def _value(self, number: int, word: str) -> float:
        if re.fullmatch(N, word):
            return float(word)
        name, _, index = word.partition("[")
        if index:
            return float(self._known(number, name)[int(index[:-1]) % 6])
        return float(np.ravel(self._known(number, name, 1))[0])

    # Statements --------------------------------------------------------------------------------------

    def _if(self, number: int, condition, lines) -> None:
        inner = [what for _, what, _ in lines if what != "comment"]
        self.run.frame.append(f"if {condition[2]} {float(condition[3])} {inner}")
        if self._known(number, condition[1])[int(condition[2])] < float(condition[3]):
            self.block(lines)

    def _array(self, number: int, found) -> None:
        words = found[2].split(", ")
        self.names[found[1].lower()] = np.array([self._value(number, word) for word in words])

    def _scalar(self, number: int, found) -> None:
        parts = re.findall(rf"(^| [-+] )({N}|\w+(?:\[\d\])?)", found[2].strip("()"))
        total = sum((-1 if "-" in sign else 1) * self._value(number, word) for sign, word in parts)
        self.names[found[1].lower()] = np.array([total])

    def _frame(self, number: int, found) -> None:
        if int(found[1]):
            raise RefusedError(f"line {number}: a frame that nobody has set")
        self.in_base = True

    def _tool(self, number: int, found) -> None:
        values = self._known(number, found[1])
        self.tcp = frame(values[:3], turned_deg(*values[3:]))

    def _here(self, number: int, found) -> None:
        """Store the place of the TCP as the controller believes it.

        Our programs do not use its angles.
        """
        self.names[found[1].lower()] = np.array([*self.believed()[:3, 3], 0.0, 0.0, 0.0])

    def _target(self, number: int, values: np.ndarray) -> np.ndarray:
        if not self.in_base:
            self.run.acts.append(f"line {number}: in a frame that somebody has left")
        return frame(values[:3], turned_deg(*values[3:]))

    def _line(self, number: int, found) -> None:
        values = self._known(number, found[2])
        speed, acceleration, cut_mm = map(float, found.groups()[3:])
        if found[1] == "movj":
            self.run.acts.append(f"line {number}: a move of the joints, whose way nobody knows")
        if found[3] == "0":
            self.line(number, self._target(number, values), speed, acceleration, cut_mm)
            return
        along = np.eye(3) if found[3] == "1" else self.paper[:3, :3] @ self.down
        tip, at = self.at + along @ values[:3], tuple(self.at)
        tilt = float(np.radians(np.abs(values[3:]).max()))
        self.line(number, self.believed(), speed, acceleration, cut_mm)
        self.run.legs[-1] = self.run.legs[-1]._replace(start=at, end=tuple(tip), tilt_rad=tilt)
        self.at = tip

    def _circle(self, number: int, found) -> None:
        via, end = (self._target(number, self._known(number, name)) for name in (found[1], found[2]))
        if found[3] != "0":
            self.run.acts.append(f"line {number}: a circle counted from where the tool is")
        self.circle(number, via, end, *map(float, found.groups()[3:]))

    def _sleep(self, number: int, found) -> None:
        self.rest(number, "wait", float(found[1]))

    def _pause(self, number: int, found) -> None:
        self.rest(number, "stop")

    def _acts(self, number: int, found) -> None:
        self.run.acts.append(f"line {number}: {found[0][:30]}")
