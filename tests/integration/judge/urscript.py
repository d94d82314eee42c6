"""The part of URScript that a program of moves needs, run as the script manual says.

The whole file is compiled first: one line that is no statement, and nothing runs. Poses are metres and rotation
vectors; movel stops at its end unless it has a blend radius; movep keeps its speed; movec passes a point.
"""

from __future__ import annotations

import re

import numpy as np

from .moves import Leg, RefusedError, Run
from .places import angle_rad, frame, turned_vector

N = r"[-+]?(?:\d+\.?\d*|\.\d+)"
POSE = rf"p\[({N}), ({N}), ({N}), ({N}), ({N}), ({N})\]"
PLACE = rf"(\w+)\(({N}), ({N}), ({N})\)"
PATTERNS = {
    "def": re.compile(r"def (\w+)\(([\w, ]*)\):"),
    "end": re.compile(r"end"),
    "tcp": re.compile(rf"set_tcp\({POSE}\)"),
    "paper": re.compile(rf"(\w+) = {POSE}"),
    "place": re.compile(rf"return pose_trans\((\w+), p\[x, y, z, ({N}), ({N}), ({N})\]\)"),
    "here": re.compile(r"here = pose_trans\(pose_inv\((\w+)\), get_actual_tcp_pose\(\)\)"),
    "if": re.compile(rf"if here\[([0-5])\] < ({N}):"),
    "rise": re.compile(
        rf"movel\(pose_trans\((\w+), p\[here\[(\d)\], here\[(\d)\], ({N}), here\[(\d)\], here\[(\d)\], "
        rf"here\[(\d)\]\]\), a=({N}), v=({N})\)"
    ),
    "move": re.compile(rf"(movel|movep|movej)\({PLACE}, a=({N}), v=({N})(?:, r=({N}))?\)"),
    "circle": re.compile(rf"movec\({PLACE}, {PLACE}, a=({N}), v=({N}), r=({N}), mode=([01])\)"),
    "sleep": re.compile(rf"sleep\(({N})\)"),
    "popup": re.compile(
        r'popup\("[^"]*", "[^"]*", (?:True|False), (?:True|False), blocking=(True|False)\)|popup\("[^"]*"\)'
    ),
    "call": re.compile(r"(\w+)\(\)"),
    "acts": re.compile(r"(?:textmsg|set_\w+|write_output_\w+|socket_\w+|powerdown|halt)\(.*\)|halt"),
}


def run_urscript(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray) -> Run:
    """start: where the brush's tip is [mm, robot's frame]; paper, down, tool: what the cell says of them."""
    robot = _Robot(start, paper, down, tool)
    try:
        lines = _compiled(text, robot.run)
        robot.execute(lines)
    except RefusedError as refusal:
        robot.run.refused = str(refusal)
    return robot.run


def _compiled(text: str, run: Run) -> list:
    """(line, indent, what, found) of every statement; comments go to the run."""
    out = []
    for number, raw in enumerate(text.split("\n"), 1):
        line = raw.rstrip("\r").strip()
        if "\r" in line:
            run.acts.append(f"line {number}: a return within a line")
        if not line:
            continue
        if line.startswith("#"):
            out.append((number, "comment", line[1:].strip()))
            continue
        line = _without_comment(line)
        for what, pattern in PATTERNS.items():
            if found := pattern.fullmatch(line):
                out.append((number, what, found))
                break
        else:
            raise RefusedError(f"line {number}: {line[:40]!r} is no statement")
    return out


def _without_comment(line: str) -> str:
    quoted = False
    for k, letter in enumerate(line):
        quoted ^= letter == '"'
        if letter == "#" and not quoted:
            return line[:k].rstrip()
    return line


class _Robot:
    def __init__(self, start, paper, down, tool):
        self.run = Run(blends_by_radius=True)
        self.at = np.array(start, dtype=float)
        self.true_paper, self.true_down, self.true_tool = paper, down, tool
        self.tcp = np.eye(4)  # of the installation: the flange
        self.names: dict[str, np.ndarray] = {}
        self.places: dict[str, tuple[str, np.ndarray]] = {}
        self.here: np.ndarray | None = None
        self.here_tip = self.at
        self.had_code = False

    # Blocks ------------------------------------------------------------------------------------------

    def execute(self, lines) -> None:
        functions, at = {}, 0
        top = []
        while at < len(lines):
            number, what, found = lines[at]
            if what == "def":
                end = self._end(lines, at)
                functions[found[1]] = lines[at + 1 : end]
                at = end + 1
            else:
                if what == "end":
                    raise RefusedError(f"line {number}: an end of nothing")
                top.append(lines[at])
                at += 1
        for number, what, found in top:
            if what == "comment":
                self._comment(found)
            elif what == "call" and found[1] in functions:
                self._body(functions[found[1]])
            elif what == "call":
                raise RefusedError(f"line {number}: no such function")
            else:
                raise RefusedError(f"line {number}: a statement outside of a function")

    def _end(self, lines, at: int) -> int:
        depth = 0
        for k in range(at, len(lines)):
            depth += lines[k][1] in ("def", "if")
            depth -= lines[k][1] == "end"
            if depth == 0:
                return k
        raise RefusedError("an end is missing")

    def _body(self, lines) -> None:
        at = 0
        while at < len(lines):
            number, what, found = lines[at]
            if what == "def":
                end = self._end(lines, at)
                inner = [line for line in lines[at + 1 : end] if line[1] != "comment"]
                if len(inner) != 1 or inner[0][1] != "place" or found[2] != "x, y, z":
                    raise RefusedError(f"line {number}: a function that does not return a place")
                vector = [float(text) for text in inner[0][2].groups()[1:]]
                self.places[found[1]] = (inner[0][2][1], turned_vector(vector))
                at = end + 1
                continue
            if what == "if":
                end = self._end(lines, at)
                if self.here is None:
                    raise RefusedError(f"line {number}: here is not known")
                inner = [each[1] for each in lines[at + 1 : end] if each[1] != "comment"]
                self.run.frame.append(f"if {found[1]} {float(found[2])} {inner}")
                if self.here[int(found[1])] < float(found[2]):
                    self._body(lines[at + 1 : end])
                at = end + 1
                continue
            self._statement(number, what, found)
            at += 1

    # Statements --------------------------------------------------------------------------------------

    def _comment(self, words: str) -> None:
        if self.had_code:
            self.run.titles.append((words, len(self.run.legs)))
        else:
            self.run.header.append(words)

    def _statement(self, number: int, what: str, found) -> None:
        if what == "comment":
            self._comment(found)
            return
        self.had_code = True
        if what == "tcp":
            values = [float(text) for text in found.groups()]
            self.tcp = frame(np.array(values[:3]) * 1e3, turned_vector(values[3:]))
        elif what == "paper":
            values = [float(text) for text in found.groups()[1:]]
            self.names[found[1]] = frame(np.array(values[:3]) * 1e3, turned_vector(values[3:]))
        elif what == "here":
            self._look(number, found[1])
        elif what == "rise":
            self._rise(number, found)
        elif what == "move":
            self._move(number, found)
        elif what == "circle":
            self._circle(number, found)
        elif what == "sleep":
            if float(found[1]) < 0:
                raise RefusedError(f"line {number}: sleeps less than nothing")
            self._leg(Leg(number, "wait", tuple(self.at), tuple(self.at), seconds=float(found[1])))
        elif what == "popup":
            kind = "stop" if found[1] == "True" else "wait"
            self._leg(Leg(number, kind, tuple(self.at), tuple(self.at)))
        elif what == "acts":
            self.run.acts.append(f"line {number}: {found[0][:30]}")
        else:
            raise RefusedError(f"line {number}: {what} has no place here")

    def _leg(self, leg: Leg) -> None:
        self.run.legs.append(leg)
        self.at = np.array(leg.end)

    def _known(self, number: int, name: str) -> np.ndarray:
        if name not in self.names:
            raise RefusedError(f"line {number}: {name} is not known")
        return self.names[name]

    def _look(self, number: int, name: str) -> None:
        """The pose of the TCP, as the controller believes it to be, in the paper that the program has set."""
        true = self.true_paper @ frame((0, 0, 0), self.true_down)
        true[:3, 3] = self.at
        believed = true @ np.linalg.inv(self.true_tool) @ self.tcp
        seen = np.linalg.inv(self._known(number, name)) @ believed
        self.here = np.array([*(seen[:3, 3] * 1e-3), 0.0, 0.0, 0.0])
        self.here_turned = seen[:3, :3]

    def _tip(self, target: np.ndarray) -> tuple[np.ndarray, float]:
        """Where the real brush's tip comes, and how far it leans, when the believed TCP is at a pose."""
        tip = target @ np.linalg.inv(self.tcp) @ self.true_tool
        return tip[:3, 3], angle_rad(tip[:3, :3], self.true_paper[:3, :3] @ self.true_down)

    def _rise(self, number: int, found) -> None:
        if self.here is None:
            raise RefusedError(f"line {number}: here is not known")
        which = [int(found[k]) for k in (2, 3, 5, 6, 7)]
        if max(which) > 5:
            raise RefusedError(f"line {number}: a pose has six numbers")
        place = np.array([self.here[which[0]], self.here[which[1]], float(found[4])]) * 1e3
        turned = self.here_turned if which[2:] == [3, 4, 5] else np.eye(3)
        tip, tilt = self._tip(self._known(number, found[1]) @ frame(place, turned))
        self._checked(number, found[8], found[9])
        speed, acceleration = 1e3 * float(found[9]), float(found[8])
        at = tuple(self.at)
        self._leg(Leg(number, "feed", at, tuple(tip), speed, tilt_rad=tilt, acceleration=acceleration))

    def _place(self, number: int, name: str, texts) -> tuple[np.ndarray, float]:
        if name not in self.places:
            raise RefusedError(f"line {number}: no function {name}")
        paper, down = self.places[name]
        place = np.array([float(text) for text in texts]) * 1e3
        return self._tip(self._known(number, paper) @ frame(place, down))

    def _checked(self, number: int, acceleration: str, speed: str) -> None:
        if not (float(acceleration) > 0 and float(speed) > 0):
            raise RefusedError(f"line {number}: no acceleration or speed")

    def _move(self, number: int, found) -> None:
        kind = found[1]
        tip, tilt = self._place(number, found[2], found.groups()[2:5])
        self._checked(number, found[6], found[7])
        cut_mm = 1e3 * float(found[8] or 0)
        if cut_mm < 0:
            raise RefusedError(f"line {number}: a negative radius")
        if kind == "movej":
            self.run.acts.append(f"line {number}: a move of the joints, whose way nobody knows")
        speed = 1e3 * float(found[7])
        self._leg(
            Leg(
                number,
                "process" if kind == "movep" else "feed",
                tuple(self.at),
                tuple(tip),
                speed,
                cut_mm=cut_mm,
                tilt_rad=tilt,
                acceleration=float(found[6]),
            )
        )

    def _circle(self, number: int, found) -> None:
        self.run.frame.append(f"circles turn the tool by mode {found[12]}")
        via, _ = self._place(number, found[1], found.groups()[1:4])
        end, tilt = self._place(number, found[5], found.groups()[5:8])
        self._checked(number, found[9], found[10])
        # in the plane of the three points, told in the paper's frame
        back = np.linalg.inv(self.true_paper)
        a, b, c = (back[:3, :3] @ np.asarray(point) + back[:3, 3] for point in (self.at, via, end))
        if max(abs(a[2] - b[2]), abs(a[2] - c[2])) > 0.05:
            self.run.acts.append(f"line {number}: a circle that is not level")
        (x, y), (u, v) = (b - a)[:2], (c - a)[:2]
        cross = x * v - y * u
        if abs(cross) < 1e-6:
            raise RefusedError(f"line {number}: three points of a circle on one line")
        square_via, square_end = x * x + y * y, u * u + v * v
        centre = a[:2] + np.array([v * square_via - y * square_end, x * square_end - u * square_via]) / (
            2 * cross
        )
        self._leg(
            Leg(
                number,
                "arc",
                tuple(self.at),
                tuple(end),
                1e3 * float(found[10]),
                tuple(centre),
                1 if cross > 0 else -1,
                1e3 * float(found[11]),
                tilt_rad=tilt,
                acceleration=float(found[9]),
            )
        )
