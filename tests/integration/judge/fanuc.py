"""Run the TP that a program of moves needs, as FANUC's operator's manual says.

Every program is translated first. If one line is not TP, nothing runs. The program stops at a place that was
recorded in a different user frame or tool. It also stops if the configuration changes on a straight line.
With CNT100 the next move begins when the arm begins to slow down. With CNT0 it begins when the arm has slowed
down. Between both, the time is in proportion.
"""

from __future__ import annotations

import re

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame, turned_deg

N = r"-?(?:\d+\.?\d*|\.\d+)"
V = rf"(?:{N}|\({N}\))"
HEADS = (
    r"OWNER *= \w+;",
    r"COMMENT *= \"[^\"]{0,16}\";",
    r"(?:PROG_SIZE|VERSION|LINE_COUNT|MEMORY_SIZE) *= \d+;",
    r"(?:CREATE|MODIFIED) *= DATE \d\d-\d\d-\d\d +TIME \d\d:\d\d:\d\d;",
    r"FILE_NAME *= \w*;",
    r"PROTECT *= (?:READ|READ_WRITE);",
    r"DEFAULT_GROUP *= (?:1|\*),(?:1|\*),\*,\*,\*;",
)
STATEMENTS = {
    "remark": re.compile(r"!(.*)"),
    "empty": re.compile(r""),
    "move": re.compile(rf"([LJ]) +(P|PR)\[(\d+)\] +({N}) *(mm/sec|%|cm/min|sec) +(FINE|CNT *\d+|CR\d+)"),
    "circle": re.compile(r"C +P\[(\d+)\]"),
    "onward": re.compile(rf"P\[(\d+)\] +({N}) *(mm/sec|cm/min) +(FINE|CNT *\d+)"),
    "look": re.compile(r"PR\[(\d+)\]=(LPOS|JPOS|PR\[\d+\])"),
    "element": re.compile(rf"PR\[(\d+),([1-6])\]=({V})"),
    "number": re.compile(rf"R\[(\d+)\]=(?:({V})|PR\[(\d+),([1-6])\])"),
    "frame": re.compile(r"(UFRAME|UTOOL)\[([1-9])\]=PR\[(\d+)\]"),
    "choose": re.compile(r"(UFRAME|UTOOL)_NUM=([0-9])"),
    "if": re.compile(rf"IF \(R\[(\d+)\](<|>)({N})\) THEN"),
    "endif": re.compile(r"ENDIF"),
    "wait": re.compile(rf"WAIT +({N})\(sec\)"),
    "pause": re.compile(r"PAUSE"),
    "call": re.compile(r"CALL +([A-Z]\w*)"),
    "acts": re.compile(
        r"(?:DO|RO|GO|F)\[\d+\]=\(?\w+\)?|ABORT|END|OVERRIDE=\d+%|MESSAGE\[.{1,24}\]|PAYLOAD\[\d+\]|JMP LBL\[\d+\]"
        r"|LBL\[\d+\]|UALM\[\d+\]|LINEAR_MAX_SPEED=\d+|OFFSET CONDITION PR\[\d+\]"
    ),
}
GROUP = re.compile(
    rf"P\[(\d+)\]\{{ GP1: UF : (\d), UT : (\d), CONFIG : '([NF] [UD] [TB], -?\d, -?\d, -?\d)', "
    rf"X = ({N}) mm, Y = ({N}) mm, Z = ({N}) mm, W = ({N}) deg, P = ({N}) deg, R = ({N}) deg \}};"
)
FASTEST_MM_S = 2000
REMARK = 32


class _Program:
    def __init__(self, name: str):
        self.name, self.heads, self.lines, self.points = name, [], [], {}


def run_fanuc(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray, ramp_s=0.5) -> Run:
    """Run a program for FANUC.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell.
    """
    robot = _Robot(start, paper, down, tool, ramp_s)
    try:
        found = _translated(text.replace("\r\n", "\n"))
        first = next(iter(found.values()))
        robot.programs = found
        for program in found.values():
            robot.run.frame += sorted(set(program.heads))
        robot.called(first)
        if unused := set(found) - robot.done:
            robot.run.acts.append(f"never called: {sorted(unused)}")
    except RefusedError as refusal:
        robot.run.refused = str(refusal)
    return robot.run


def _translated(text: str) -> dict[str, _Program]:
    found: dict[str, _Program] = {}
    state, held, program = "out", "", None
    for number, raw in enumerate(text.split("\n"), 1):
        line = re.sub(r"[ \t]+", " ", raw).strip(" ")
        if "\r" in raw:
            raise RefusedError(f"line {number}: a return within a line")
        if not line:
            continue
        if state == "out":
            begins = re.fullmatch(r"/PROG +([A-Z]\w{0,35})", line)
            if not begins or begins[1] in found:
                raise RefusedError(f"line {number}: {line[:30]!r} in no program")
            program = found[begins[1]] = _Program(begins[1])
            state = "prog"
        elif state == "prog":
            if line != "/ATTR":
                raise RefusedError(f"line {number}: no attributes")
            state = "attr"
        elif state == "attr":
            if line == "/MN":
                state = "mn"
                continue
            if not any(re.fullmatch(head, line) for head in HEADS):
                raise RefusedError(f"line {number}: {line[:30]!r} is no attribute")
            program.heads.append(line)
        elif state == "mn":
            if line == "/POS":
                state = "pos"
                continue
            program.lines.append((number, *_statement(number, raw)))
        elif state == "pos":
            if line == "/END":
                if held:
                    raise RefusedError(f"line {number}: half a place")
                state = "out"
                continue
            held = f"{held} {line}".strip()
            if line.endswith("};"):
                point = GROUP.fullmatch(held)
                if not point or int(point[1]) in program.points or not 1 <= int(point[1]) <= 32766:
                    raise RefusedError(f"line {number}: {held[:40]!r} is no place")
                program.points[int(point[1])] = point
                held = ""
    if state != "out" or not found:
        raise RefusedError("/END is missing")
    for program in found.values():
        if not any(head.startswith("DEFAULT_GROUP") and "= 1" in head for head in program.heads):
            raise RefusedError(f"{program.name}: no group of axes")
        _nested(program)
    return found


def _nested(program: _Program) -> None:
    depth, is_open = 0, False
    for number, what, found in program.lines:
        if (what == "onward") != is_open:
            raise RefusedError(f"line {number}: a circle in two lines")
        is_open = what == "circle"
        depth += (what == "if") - (what == "endif")
        if depth < 0:
            raise RefusedError(f"line {number}: ENDIF of nothing")
        numbers = [found[k] for k in {"circle": (1,), "onward": (1,)}.get(what, ())]
        numbers += [found[3]] if what == "move" and found[2] == "P" else []
        if any(int(each) not in program.points for each in numbers):
            raise RefusedError(f"line {number}: no such place")
    if depth or is_open:
        raise RefusedError("ENDIF or the end of a circle is missing")


def _statement(number: int, raw: str):
    line = re.fullmatch(r" *\d* *:(.*?)(;?) *", raw)
    if not line:
        raise RefusedError(f"line {number}: {raw[:30]!r} is no instruction")
    text = line[1].strip(" ")
    if text.startswith("!"):
        if not line[2] or ";" in text or len(text) > REMARK + 1:
            raise RefusedError(f"line {number}: a remark that is too long, or has no end")
        return "remark", text[1:]
    text = re.sub(" +", " ", text)
    for what, pattern in STATEMENTS.items():
        if what != "remark" and (found := pattern.fullmatch(text)):
            if bool(line[2]) == (what == "circle"):
                raise RefusedError(f"line {number}: an end too much, or none")
            return what, found
    raise RefusedError(f"line {number}: {text[:40]!r} is no instruction")


class _Robot(Arm):
    def __init__(self, start, paper, down, tool, ramp_s):
        super().__init__(start, paper, down, tool, by_radius=True)
        self.ramp_s = ramp_s
        self.programs: dict[str, _Program] = {}
        self.done: set[str] = set()
        self.frames = {"UFRAME": {0: np.eye(4)}, "UTOOL": {0: np.eye(4)}}
        self.chosen = {"UFRAME": 0, "UTOOL": 0}
        self.places: dict[int, list[float]] = {}
        self.numbers: dict[int, float] = {}
        self.configuration = ""
        self.has_code = False

    @property
    def base(self) -> np.ndarray:
        return self.frames["UFRAME"][self.chosen["UFRAME"]]

    def called(self, program: _Program) -> None:
        self.done.add(program.name)
        skips, via, inner = False, None, None
        for number, what, found in program.lines:
            if what == "remark":
                self._remark(found)
                continue
            if inner is not None and what != "endif":
                inner.append(re.sub(N, lambda each: f"{float(each[0]):g}", found[0]))
            if what == "if":
                value = self.numbers.get(int(found[1]))
                if value is None:
                    raise RefusedError(f"line {number}: a register without a number")
                skips = not (value < float(found[3]) if found[2] == "<" else value > float(found[3]))
                inner = [f"if {found[2]} {float(found[3])}"]
            elif what == "endif":
                self.run.frame.append(str(inner))
                skips, inner = False, None
            elif not skips and what == "circle":
                via = found[1]
            elif not skips and what == "onward":
                self._onward(number, program, via, found)
            elif not skips and what == "move":
                self._move(number, program, found)
            elif not skips and what != "empty":
                getattr(self, f"_{what}")(number, found)
            self.has_code = self.has_code or what != "empty"

    def _remark(self, words: str) -> None:
        if words.startswith("+"):
            if self.has_code and self.run.titles:
                before, at = self.run.titles[-1]
                self.run.titles[-1] = (before + words[1:], at)
            elif self.run.header:
                self.run.header[-1] += words[1:]
        elif self.has_code:
            self.run.titles.append((words, len(self.run.legs)))
        else:
            self.run.header.append(words)

    # Statements --------------------------------------------------------------------------------------

    def _look(self, number: int, found) -> None:
        if found[2] != "LPOS":
            self.run.acts.append(f"line {number}: {found[0]}")
            return
        seen = np.linalg.inv(self.base) @ self.believed()
        m = seen[:3, :3]
        b = np.arctan2(-m[2, 0], np.hypot(m[0, 0], m[1, 0]))
        w, r = np.arctan2(m[2, 1], m[2, 2]), np.arctan2(m[1, 0], m[0, 0])
        self.places[int(found[1])] = [*seen[:3, 3].tolist(), *np.degrees([w, b, r]).tolist()]

    def _element(self, number: int, found) -> None:
        if int(found[1]) not in self.places:
            raise RefusedError(f"line {number}: a register without a place")
        self.places[int(found[1])][int(found[2]) - 1] = float(found[3].strip("()"))

    def _number(self, number: int, found) -> None:
        if found[2]:
            self.numbers[int(found[1])] = float(found[2].strip("()"))
            return
        if int(found[3]) not in self.places:
            raise RefusedError(f"line {number}: a register without a place")
        self.run.frame.append(found[0])
        self.numbers[int(found[1])] = self.places[int(found[3])][int(found[4]) - 1]

    def _frame(self, number: int, found) -> None:
        if int(found[3]) not in self.places:
            raise RefusedError(f"line {number}: a register without a place")
        self.frames[found[1]][int(found[2])] = _as_frame(self.places[int(found[3])])
        self._use()

    def _choose(self, number: int, found) -> None:
        if int(found[2]) not in self.frames[found[1]]:
            raise RefusedError(f"line {number}: nobody knows {found[1]}[{found[2]}]")
        self.chosen[found[1]] = int(found[2])
        self._use()

    def _use(self) -> None:
        self.tcp = self.frames["UTOOL"][self.chosen["UTOOL"]]

    def _target(self, number: int, program: _Program, name: str) -> np.ndarray:
        point = program.points[int(name)]
        if (int(point[2]), int(point[3])) != (self.chosen["UFRAME"], self.chosen["UTOOL"]):
            raise RefusedError(f"line {number}: INTP-251 another frame or tool")
        if self.configuration not in ("", point[4]):
            raise RefusedError(f"line {number}: another configuration")
        self.configuration = point[4]
        return self.base @ _as_frame([float(value) for value in point.groups()[4:]])

    def _speed(self, number: int, text: str, unit: str) -> float:
        speed = float(text) / (6 if unit == "cm/min" else 1)
        if "." in text or not 1 <= float(text) <= FASTEST_MM_S:
            raise RefusedError(f"line {number}: a speed of {text}")
        return speed

    def _cut_mm(self, number: int, text: str, speed: float) -> float:
        if text == "FINE":
            return 0.0
        if text.startswith("CR"):
            self.run.acts.append(f"line {number}: {text} is an option")
            return 0.0
        percent = int(text[3:])
        if percent > 100:
            raise RefusedError(f"line {number}: {text}")
        return percent / 100 * self.ramp_s * speed / 2

    def _move(self, number: int, program: _Program, found) -> None:
        if found[1] == "J" or found[5] in ("%", "sec"):
            self.run.acts.append(f"line {number}: {found[0][:30]}")
            return
        speed = self._speed(number, found[4], found[5])
        if found[2] == "PR":
            if int(found[3]) not in self.places:
                raise RefusedError(f"line {number}: a register without a place")
            target = self.base @ _as_frame(self.places[int(found[3])])
        else:
            target = self._target(number, program, found[3])
        self.line(number, target, speed, 1.0, self._cut_mm(number, found[6], speed))

    def _onward(self, number: int, program: _Program, via: str, found) -> None:
        speed = self._speed(number, found[2], found[3])
        both = self._target(number, program, via), self._target(number, program, found[1])
        self.circle(number, *both, speed, 1.0, self._cut_mm(number, found[4], speed))

    def _wait(self, number: int, found) -> None:
        self.rest(number, "wait", float(found[1]))

    def _pause(self, number: int, found) -> None:
        self.rest(number, "stop")

    def _call(self, number: int, found) -> None:
        if found[1] not in self.programs:
            raise RefusedError(f"line {number}: no program {found[1]}")
        if found[1] in self.done:
            self.run.acts.append(f"line {number}: calls {found[1]} again")
            return
        self.called(self.programs[found[1]])

    def _acts(self, number: int, found) -> None:
        self.run.acts.append(f"line {number}: {found[0][:30]}")


def _as_frame(values: list[float]) -> np.ndarray:
    return frame(values[:3], turned_deg(*values[3:]))
