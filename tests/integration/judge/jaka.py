"""The part of JAKA script that a program of moves needs, run as the script manual says.

One statement a line, names in any case, poses of six numbers in millimetres and degrees held by variables; the angles
turn about the fixed axes. The whole file is compiled first: one line that is no statement, and nothing runs.
"""

from __future__ import annotations

import re

import numpy as np

from .moves import Leg, RefusedError, Run
from .places import angle_rad, frame, turned_deg

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
    """start: where the brush's tip is [mm, robot's frame]; paper, down, tool: what the cell says of them."""
    robot = _Robot(start, paper, down, tool)
    try:
        robot.block(_compiled(text, robot.run))
    except RefusedError as refusal:
        robot.run.refused = str(refusal)
    return robot.run


def _compiled(text: str, run: Run) -> list:
    """(line, what, found) of every statement, an if with its block as (line, "if", found, block)."""
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


class _Robot:
    def __init__(self, start, paper, down, tool):
        self.run = Run()
        self.at = np.array(start, dtype=float)
        self.paper, self.down, self.true_tool = paper, down, tool
        self.tcp = np.eye(4)  # of the installation: the flange
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

    def _leg(self, leg: Leg) -> None:
        self.run.legs.append(leg)
        self.at = np.array(leg.end)

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
        """The pose of the TCP as the controller believes it to be; of its angles a program of ours asks nothing."""
        true = self.paper @ frame((0, 0, 0), self.down)
        true[:3, 3] = self.at
        believed = true @ np.linalg.inv(self.true_tool) @ self.tcp
        self.names[found[1].lower()] = np.array([*believed[:3, 3], 0.0, 0.0, 0.0])

    def _tip(self, number: int, values: np.ndarray) -> tuple[np.ndarray, float]:
        """Where the real brush's tip comes, and how far it leans."""
        if not self.in_base:
            self.run.acts.append(f"line {number}: in a frame that somebody has left")
        target = frame(values[:3], turned_deg(*values[3:]))
        tip = target @ np.linalg.inv(self.tcp) @ self.true_tool
        return tip[:3, 3], angle_rad(tip[:3, :3], self.paper[:3, :3] @ self.down)

    def _speeds(self, number: int, speed: str, acceleration: str, cut: str) -> tuple[float, float, float]:
        if not (float(speed) > 0 and float(acceleration) > 0 and float(cut) >= 0):
            raise RefusedError(f"line {number}: no speed, no acceleration or a tolerance below 0")
        return float(speed), float(acceleration), float(cut)

    def _line(self, number: int, found) -> None:
        values = self._known(number, found[2])
        speed, acceleration, cut_mm = self._speeds(number, *found.groups()[3:])
        if found[1] == "movj":
            self.run.acts.append(f"line {number}: a move of the joints, whose way nobody knows")
        if found[3] == "0":
            tip, tilt = self._tip(number, values)
        else:
            along = np.eye(3) if found[3] == "1" else self.paper[:3, :3] @ self.down
            tip, tilt = self.at + along @ values[:3], float(np.radians(np.abs(values[3:]).max()))
        at = tuple(self.at)
        self._leg(
            Leg(
                number,
                "feed",
                at,
                tuple(tip),
                speed,
                cut_mm=cut_mm,
                tilt_rad=tilt,
                acceleration=acceleration,
            )
        )

    def _circle(self, number: int, found) -> None:
        via, _ = self._tip(number, self._known(number, found[1]))
        end, tilt = self._tip(number, self._known(number, found[2]))
        if found[3] != "0":
            self.run.acts.append(f"line {number}: a circle counted from where the tool is")
        speed, acceleration, cut_mm = self._speeds(number, *found.groups()[3:])
        a, b, c = self.at, via, end
        if max(abs(a[2] - b[2]), abs(a[2] - c[2])) > 0.05:
            self.run.acts.append(f"line {number}: a circle that is not level")
        (x, y), (u, v) = (b - a)[:2], (c - a)[:2]
        cross = x * v - y * u
        if abs(cross) < 1e-6:
            raise RefusedError(f"line {number}: three points of a circle on one line")
        one, other = x * x + y * y, u * u + v * v
        centre = a[:2] + np.array([v * one - y * other, x * other - u * one]) / (2 * cross)
        self._leg(
            Leg(
                number,
                "arc",
                tuple(self.at),
                tuple(end),
                speed,
                tuple(centre),
                1 if cross > 0 else -1,
                cut_mm,
                tilt_rad=tilt,
                acceleration=acceleration,
            )
        )

    def _sleep(self, number: int, found) -> None:
        if float(found[1]) < 0:
            raise RefusedError(f"line {number}: sleeps less than nothing")
        self._leg(Leg(number, "wait", tuple(self.at), tuple(self.at), seconds=float(found[1])))

    def _pause(self, number: int, found) -> None:
        self._leg(Leg(number, "stop", tuple(self.at), tuple(self.at)))

    def _acts(self, number: int, found) -> None:
        self.run.acts.append(f"line {number}: {found[0][:30]}")
