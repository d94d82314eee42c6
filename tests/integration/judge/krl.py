"""Run the KRL that a program of moves needs, as KUKA's programming manual says.

Each module is compiled first. If one line is not KRL, or a name is not declared in the module, nothing runs.
A called routine keeps all settings. BAS(#INITMOV, 0) sets the defaults: the robot's highest speed, no tool
and no base. The program itself must set how far a blend reaches.
"""

from __future__ import annotations

import re

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame, turned_deg

N = r"[-+]?(?:\d+\.?\d*|\.\d+)"
POSE = r"\{[^{}]*\}"
PATTERNS = {
    "def": re.compile(r"def +(\w+) *\( *\)"),
    "end": re.compile(r"end"),
    "declare": re.compile(r"(?:decl +)?(?:e6pos|pos|frame) +(\w+)"),
    "bas": re.compile(r"bas *\( *#initmov *, *0 *\)"),
    "sets": re.compile(rf"\$(tool|base) *= *({POSE})"),
    "rate": re.compile(rf"\$(vel\.cp|acc\.cp|apo\.cdis) *= *({N})"),
    "ptp": re.compile(r"ptp +\$axis_act"),
    "look": re.compile(r"(\w+) *= *\$pos_act"),
    "if": re.compile(rf"if +(\w+)\.([xyzabc]) *(<|>) *({N}) +then"),
    "endif": re.compile(r"endif"),
    "part": re.compile(rf"(\w+)\.([xyzabc]) *= *({N})"),
    "line": re.compile(rf"lin +({POSE}|\w+)( +c_dis)?"),
    "circle": re.compile(rf"circ +({POSE}) *, *({POSE})( +c_dis)?"),
    "call": re.compile(r"(\w+) *\( *\)"),
    "wait": re.compile(rf"wait +sec +({N})"),
    "halt": re.compile(r"halt"),
    "acts": re.compile(
        r"\$\w+(?:\[\d+\])? *= *\S+|(?:ptp|lin_rel|ptp_rel|slin|exit|return|trigger|interrupt|continue)\b.*"
    ),
}
FASTEST_MM_S, HARDEST_M_S2 = 3000.0, 10.0


def run_krl(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray) -> Run:
    """Run a program for KUKA.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell.
    """
    robot = _Robot(start, paper, down, tool)
    try:
        robot.load(text)
    except RefusedError as refusal:
        robot.run.refused = str(refusal)
    return robot.run


class _Robot(Arm):
    def __init__(self, start, paper, down, tool):
        super().__init__(start, paper, down, tool, by_radius=True)
        self.base = np.eye(4)
        self.names: dict[str, dict | None] = {}
        self.modules: dict[str, tuple[list, dict]] = {}
        self.done: set[str] = set()
        self.is_set = self.has_begun = False  # is_set: after BAS; has_begun: after a PTP
        self.speed_mm_s, self.acceleration = 0.0, 0.0
        self.apart_mm: float | None = None
        self.last: dict[str, float] = {}

    def load(self, text: str) -> None:
        """Load all modules and run the first one."""
        lines = text.split("\n")
        begins = [k for k, line in enumerate(lines) if PATTERNS["def"].fullmatch(line.strip().lower())]
        for first, last in zip([0, *begins[1:]], [*begins[1:], len(lines)], strict=True):
            name = f"module {first}" if first else "main"
            if found := PATTERNS["def"].fullmatch(lines[first].strip().lower()):
                name = found[1]
            if name in self.modules:
                raise RefusedError(f"line {first + 1}: a second {name}")
            self.names, is_main = {}, not self.modules
            block = self.compiled("\n".join(lines[first:last]), first, is_main)
            self.modules[name] = block, self.names
        self.routine(next(iter(self.modules)))
        if left := self.modules.keys() - self.done:
            self.run.acts.append(f"never called: {sorted(left)}")

    def routine(self, name: str) -> None:
        before = self.names
        block, self.names = self.modules[name]
        self.done.add(name)
        self.block(block)
        self.names = before

    def _call(self, number: int, found) -> None:
        if found[1] not in self.modules or found[1] in self.done:
            raise RefusedError(f"line {number}: {found[1]} is missing, or runs a second time")
        self.routine(found[1])

    def compiled(self, text: str, before: int, is_main: bool) -> list:
        """Return (line, what, found) of each statement of the routine.

        An if is (line, "if", (found, block)). before is the number of lines of earlier modules.
        """
        blocks: list[list] = [[]]
        opened: list = []
        state, has_code = "before", False
        for number, raw in enumerate(text.split("\n"), before + 1):
            line = raw.rstrip("\r")
            if "\r" in line:
                self.run.acts.append(f"line {number}: a return within a line")
            code, _, words = line.partition(";")
            code = code.strip().lower()
            if words and not code:
                if has_code or not is_main:
                    blocks[-1].append((number, "comment", words.strip()))
                else:
                    self.run.header.append(words.strip())
            if not code:
                continue
            if state == "before" and re.fullmatch(r"&(?:access|comment|rel|param)\b.*", code):
                self.run.frame.append(code)
                continue
            what, found = self._known(number, code)
            if (what == "def") != (state == "before") or state == "after":
                raise RefusedError(f"line {number}: {code[:30]!r} in no routine")
            if what == "def":
                if is_main:
                    self.run.frame.append(code)
                state = "within"
                continue
            if what == "declare":
                if has_code or found[1] in self.names:
                    raise RefusedError(f"line {number}: declared behind statements, or twice")
                self.names[found[1]] = None
                continue
            has_code = has_code or what != "end"
            if what == "if":
                opened.append((number, found))
                blocks.append([])
            elif what == "endif":
                if not opened:
                    raise RefusedError(f"line {number}: an end of nothing")
                block, (first, condition) = blocks.pop(), opened.pop()
                blocks[-1].append((first, "if", (condition, block)))
            elif what == "end":
                state = "after"
            else:
                blocks[-1].append((number, what, found))
        if state != "after" or opened:
            raise RefusedError("END or ENDIF is missing")
        return blocks[0]

    def _known(self, number: int, code: str):
        for what, pattern in PATTERNS.items():
            if found := pattern.fullmatch(code):
                names = {"look": 1, "if": 1, "part": 1, "line": 1}
                name = found[names[what]] if what in names else ""
                if name and not name.startswith("{") and name not in self.names:
                    raise RefusedError(f"line {number}: {name} is not declared")
                for pose in re.findall(POSE, code):
                    _parts(number, pose)
                return what, found
        raise RefusedError(f"line {number}: {code[:40]!r} is no statement")

    def block(self, lines) -> None:
        for number, what, found in lines:
            if what == "comment":
                self.run.titles.append((found, len(self.run.legs)))
            elif what == "if":
                self._if(number, *found)
            else:
                getattr(self, f"_{what}")(number, found)

    # Statements --------------------------------------------------------------------------------------

    def _if(self, number: int, condition, lines) -> None:
        inner = [what for _, what, _ in lines if what != "comment"]
        self.run.frame.append(f"if {condition.groups()[:3]} {float(condition[4])} {inner}")
        value = self._value(number, condition[1])[condition[2]]
        if (value < float(condition[4])) == (condition[3] == "<"):
            self.block(lines)

    def _value(self, number: int, name: str) -> dict:
        value = self.names[name]
        if value is None:
            raise RefusedError(f"line {number}: {name} has no value")
        return value

    def _bas(self, number: int, found) -> None:
        self.is_set, self.base, self.tcp = True, np.eye(4), np.eye(4)
        self.speed_mm_s, self.acceleration, self.apart_mm = FASTEST_MM_S, HARDEST_M_S2, None

    def _sets(self, number: int, found) -> None:
        parts = _parts(number, found[2])
        if set(parts) != set("xyzabc"):
            raise RefusedError(f"line {number}: a frame that is not whole")
        if found[1] == "tool":
            self.tcp = _as_frame(parts)
        else:
            self.base = _as_frame(parts)

    def _rate(self, number: int, found) -> None:
        value = float(found[2])
        if found[1] == "vel.cp":
            self.speed_mm_s = 1e3 * value
        elif found[1] == "acc.cp":
            self.acceleration = value
        else:
            self.apart_mm = value

    def _ptp(self, number: int, found) -> None:
        if not self.is_set:
            raise RefusedError(f"line {number}: no speeds of axes")
        self.has_begun = True

    def _look(self, number: int, found) -> None:
        seen = np.linalg.inv(self.base) @ self.believed()
        m = seen[:3, :3]
        a, c = np.arctan2(m[1, 0], m[0, 0]), np.arctan2(m[2, 1], m[2, 2])
        b = np.arctan2(-m[2, 0], np.hypot(m[0, 0], m[1, 0]))
        angles = np.degrees([a, b, c]).tolist()
        self.names[found[1]] = dict(zip("xyzabc", [*seen[:3, 3].tolist(), *angles], strict=True))

    def _part(self, number: int, found) -> None:
        self._value(number, found[1])[found[2]] = float(found[3])

    def _target(self, number: int, word: str) -> np.ndarray:
        if not self.has_begun:
            raise RefusedError(f"line {number}: the first move must be PTP")
        value = _parts(number, word) if word.startswith("{") else self._value(number, word)
        self.last = self.last | value
        if set(self.last) < set("xyzabc"):
            raise RefusedError(f"line {number}: a place that is not whole")
        return self.base @ _as_frame(self.last)

    def _cut_mm(self, number: int) -> float:
        if self.apart_mm is None:
            self.run.acts.append(f"line {number}: blends as far as somebody has left it")
        return self.apart_mm or 0.0

    def _line(self, number: int, found) -> None:
        cut_mm = self._cut_mm(number) if found[2] else 0.0
        self.line(number, self._target(number, found[1]), self.speed_mm_s, self.acceleration, cut_mm)

    def _circle(self, number: int, found) -> None:
        before = self.last
        via = self._target(number, found[1])
        self.last = before
        end = self._target(number, found[2])
        cut_mm = self._cut_mm(number) if found[3] else 0.0
        self.circle(number, via, end, self.speed_mm_s, self.acceleration, cut_mm)

    def _wait(self, number: int, found) -> None:
        self.rest(number, "wait", float(found[1]))

    def _halt(self, number: int, found) -> None:
        self.rest(number, "stop")

    def _acts(self, number: int, found) -> None:
        self.run.acts.append(f"line {number}: {found[0][:30]}")


def _parts(number: int, pose: str) -> dict[str, float]:
    parts: dict[str, float] = {}
    for word in pose.strip("{}").split(","):
        found = re.fullmatch(rf"\s*([xyzabc])\s+({N})\s*", word)
        if not found or found[1] in parts:
            raise RefusedError(f"line {number}: {pose[:30]!r} is no place")
        parts[found[1]] = float(found[2])
    return parts


def _as_frame(parts: dict[str, float]) -> np.ndarray:
    return frame([parts[axis] for axis in "xyz"], turned_deg(parts["c"], parts["b"], parts["a"]))
