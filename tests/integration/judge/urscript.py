"""Run the URScript that a program of moves needs, as the script manual says.

The whole file is compiled first. If one line is not a statement, nothing runs. In a job of several files,
each file names the next one and starts with nothing set. Poses are metres and rotation vectors. movel stops
at its end unless it has a blend radius, movep keeps its speed, and movec passes through a point.
"""

from __future__ import annotations

import re

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame, turned_vector

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
    "thread": re.compile(r"thread (\w+)\(\):"),
    "while": re.compile(r"while True:"),
    "pressed": re.compile(rf"if force\(\) > ({N}):"),
    "sync": re.compile(r"sync\(\)"),
    "zero": re.compile(r"zero_ftsensor\(\)"),
    "run": re.compile(r"(\w+) = run (\w+)\(\)"),
    "kill": re.compile(r"kill (\w+)"),
    "call": re.compile(r"(\w+)\(\)"),
    "next": re.compile(r'textmsg\("brushsvg: go on with part (\d+)"\)'),
    "acts": re.compile(r"(?:textmsg|set_\w+|write_output_\w+|socket_\w+|powerdown|halt)\(.*\)|halt"),
}


MAIN = "brushsvg"


def run_urscript(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray, force_n: float = 0.0) -> Run:
    """Run a program in URScript.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell. At
    force_n the program has to end by itself; 0 means that the cell requests no limit.
    """
    robot = _Robot(start, paper, down, tool, force_n)
    run = robot.run
    try:
        lines = _compiled(text, run)
        begins = [k for k, (_, what, found) in enumerate(lines) if what == "def" and found[1] == MAIN]
        for count, (first, last) in enumerate(zip([0, *begins[1:]], [*begins[1:], None], strict=True), 1):
            if count > 1:
                robot = _Robot(robot.at, paper, down, tool, force_n)
                robot.run, header = run, run.header[:]
            robot.execute(lines[first:last])
            if count > 1 and run.header[len(header) :] != [f"part: {count}", *header]:
                raise RefusedError(f"part {count} is of another job")
            run.header[:] = run.header if count == 1 else header
            if robot.following != (0 if last is None else count + 1):
                raise RefusedError(f"part {count} is followed by {robot.following}")
    except RefusedError as refusal:
        run.refused = str(refusal)
    return run


def _compiled(text: str, run: Run) -> list:
    """Return (line, indent, what, found) of each statement; comments go to the run."""
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


class _Robot(Arm):
    """The robot with its state.

    threads: the force [N] at which each thread ends the program.
    watches: the name and the force of the running thread.
    """

    def __init__(self, start, paper, down, tool, force_n):
        super().__init__(start, paper, down, tool, by_radius=True)
        self.force_n, self.is_zeroed = force_n, False
        self.threads: dict[str, float] = {}
        self.watches: tuple[str, float] | None = None
        self.names: dict[str, np.ndarray] = {}
        self.places: dict[str, tuple[str, np.ndarray]] = {}
        self.here: np.ndarray | None = None
        self.here_tip = self.at
        self.had_code = False
        self.following = 0  # the number of the part that runs next

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
            depth += lines[k][1] in ("def", "if", "thread", "while", "pressed")
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
            if what == "thread":
                end = self._end(lines, at)
                self.threads[found[1]] = self._newtons(number, lines[at + 1 : end])
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
            self.rest(number, "wait", float(found[1]))
        elif what == "popup":
            self.rest(number, "stop" if found[1] == "True" else "wait")
        elif what == "zero":
            self.is_zeroed = True
            self.rest(number, "wait", 0.0)
        elif what == "run":
            self._watch(number, *found.groups())
        elif what == "kill":
            if self.watches is None or self.watches[0] != found[1]:
                raise RefusedError(f"line {number}: {found[1]} does not run")
            self.watches = None
        elif what == "next":
            self.following = int(found[1])
        elif what == "acts":
            self.run.acts.append(f"line {number}: {found[0][:30]}")
        else:
            raise RefusedError(f"line {number}: {what} has no place here")

    def _newtons(self, number: int, lines) -> float:
        """Return the force at which a thread ends the program.

        The thread must do nothing else.
        """
        lines = [each for each in lines if each[1] != "comment"]
        lines = [each for each in lines if each[1] != "acts" or not each[2][0].startswith("textmsg")]
        if [what for _, what, _ in lines] != ["while", "pressed", "acts", "end", "sync", "end"]:
            raise RefusedError(f"line {number}: a thread that does something else")
        if lines[2][2][0] != "halt":
            raise RefusedError(f"line {number}: a thread that ends nothing")
        return float(lines[1][2][1])

    def _watch(self, number: int, name: str, thread: str) -> None:
        if thread not in self.threads:
            raise RefusedError(f"line {number}: no thread {thread}")
        if self.watches:
            self.run.acts.append(f"line {number}: two threads at once")
        if not self.is_zeroed:
            self.run.acts.append(f"line {number}: the weight of the tool counts as contact")
        if self.threads[thread] > self.force_n + 0.01:
            self.run.acts.append(f"line {number}: {self.threads[thread]} N end nothing")
        self.watches = name, self.threads[thread]
        self.run.frame.append(f"ends at {self.threads[thread]} N")

    def _watched(self, number: int) -> None:
        if self.force_n and self.watches is None:
            self.run.acts.append(f"line {number}: nothing ends a move that presses too hard")

    def _known(self, number: int, name: str) -> np.ndarray:
        if name not in self.names:
            raise RefusedError(f"line {number}: {name} is not known")
        return self.names[name]

    def _look(self, number: int, name: str) -> None:
        """Store the pose of the TCP in the paper that the program has set.

        The pose is the controller's belief, not the true one.
        """
        seen = np.linalg.inv(self._known(number, name)) @ self.believed()
        self.here = np.array([*(seen[:3, 3] * 1e-3), 0.0, 0.0, 0.0])
        self.here_turned = seen[:3, :3]

    def _rise(self, number: int, found) -> None:
        if self.here is None:
            raise RefusedError(f"line {number}: here is not known")
        which = [int(found[k]) for k in (2, 3, 5, 6, 7)]
        if max(which) > 5:
            raise RefusedError(f"line {number}: a pose has six numbers")
        place = np.array([self.here[which[0]], self.here[which[1]], float(found[4])]) * 1e3
        turned = self.here_turned if which[2:] == [3, 4, 5] else np.eye(3)
        target = self._known(number, found[1]) @ frame(place, turned)
        self.line(number, target, 1e3 * float(found[9]), float(found[8]), 0.0)

    def _place(self, number: int, name: str, texts) -> np.ndarray:
        if name not in self.places:
            raise RefusedError(f"line {number}: no function {name}")
        paper, down = self.places[name]
        place = np.array([float(text) for text in texts]) * 1e3
        return self._known(number, paper) @ frame(place, down)

    def _move(self, number: int, found) -> None:
        self._watched(number)
        target = self._place(number, found[2], found.groups()[2:5])
        if found[1] == "movej":
            self.run.acts.append(f"line {number}: a move of the joints, whose way nobody knows")
        acceleration, speed, cut = (float(found[k] or 0) for k in (6, 7, 8))
        self.line(number, target, 1e3 * speed, acceleration, 1e3 * cut)
        if found[1] == "movep":
            self.run.legs[-1] = self.run.legs[-1]._replace(kind="process")

    def _circle(self, number: int, found) -> None:
        self._watched(number)
        self.run.frame.append(f"circles turn the tool by mode {found[12]}")
        via = self._place(number, found[1], found.groups()[1:4])
        end = self._place(number, found[5], found.groups()[5:8])
        acceleration, speed, cut = (float(found[k]) for k in (9, 10, 11))
        self.circle(number, via, end, 1e3 * speed, acceleration, 1e3 * cut)
