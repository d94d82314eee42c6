"""A small interpreter of URScript that records where the tool goes.

The signatures come from the manual.
"""

import contextlib
import re

import numpy as np


class Pose(tuple):
    """A URScript pose p[x, y, z, rx, ry, rz] in metres, with a rotation vector."""


CALLS = (
    *("movel", "movep", "movec", "set_tcp", "sleep", "popup"),
    *("force", "zero_ftsensor", "run", "kill", "halt", "sync", "textmsg"),
)


class _PoseLiteral:
    def __getitem__(self, values):
        assert len(values) == 6 and all(isinstance(value, int | float) for value in values)
        return Pose(values)


def matrix(pose):
    import cv2

    frame = np.eye(4)
    frame[:3, :3] = cv2.Rodrigues(np.array(pose[3:], dtype=float))[0]
    frame[:3, 3] = pose[:3]
    return frame


def pose_of(frame):
    import cv2

    return Pose((*frame[:3, 3].tolist(), *cv2.Rodrigues(np.ascontiguousarray(frame[:3, :3]))[0].ravel().tolist()))


class HaltedError(Exception):
    """The program has ended, from any of its threads."""


class _NextFrameError(Exception):
    """A thread gives up the rest of its time slice."""


class Robot:
    """A robot that records what a program does.

    `events` contains (name, poses, speed m/s, blend radius m) for each move, ("sleep", s) and ("popup",
    text). `force` returns the force [N] that presses on the TCP at a place [m]. After each move, a thread
    runs once.
    """

    def __init__(self, start=(0.0, -0.4, 0.5, 3.14159265, 0.0, 0.0), force=lambda place: 0.0):
        self.here, self.tcp, self.events = Pose(start), None, []
        self.presses, self.none_n, self.thread, self.is_halted = force, 0.0, None, False

    def force(self):
        return abs(self.presses(self.here) - self.none_n)

    def zero_ftsensor(self):
        self.none_n = self.presses(self.here)

    def run(self, thread):
        self.thread = thread
        return thread

    def kill(self, thread):
        assert self.thread is thread, "no such thread runs"
        self.thread = None

    def halt(self):
        self.is_halted = True
        raise HaltedError

    def sync(self):
        raise _NextFrameError

    def textmsg(self, text):
        self.events.append(("textmsg", text))

    def movel(self, pose, a=1.2, v=0.25, t=0, r=0):
        self._move("movel", (pose,), a, v, r)

    def movep(self, pose, a=1.2, v=0.25, r=0):
        self._move("movep", (pose,), a, v, r)

    def movec(self, pose_via, pose_to, a=1.2, v=0.25, r=0, mode=0):
        assert mode in (0, 1)
        self._move("movec", (pose_via, pose_to), a, v, r)

    def _move(self, name, poses, a, v, r):
        assert self.tcp is not None, "the tool is not set"
        assert all(isinstance(pose, Pose) for pose in poses)
        assert 0 < a <= 20 and 0 < v <= 3 and 0 <= r < 0.1
        self.events.append((name, poses, v, r))
        self.here = poses[-1]
        if self.thread:
            with contextlib.suppress(_NextFrameError):
                self.thread()

    def set_tcp(self, pose):
        assert isinstance(pose, Pose)
        self.tcp = pose

    def sleep(self, t):
        assert t >= 0
        self.events.append(("sleep", t))

    def popup(self, s, title="Popup", warning=False, error=False, blocking=False):
        assert isinstance(s, str)
        self.events.append(("popup", s))


def _in_python(line):
    """Translate URScript lines that start or end a thread to Python."""
    line = re.sub(r"^( *)thread (\w+\(\):)$", r"\1def \2", line)
    line = re.sub(r"^( *)halt$", r"\1halt()", line)
    line = re.sub(r"^( *)kill (\w+)$", r"\1kill(\2)", line)
    return re.sub(r"^( *\w+ = )run (\w+)\(\)$", r"\1run(\2)", line)


def run(text, **settings):
    """Run programs one after the other and return the robot.

    Raise AssertionError or a Python error for anything that the language does not have.
    """
    robot = Robot(**settings)
    for program in re.split(r"(?m)^(?=def )", text):
        robot.tcp = robot.thread = None
        _run(program, robot)
    return robot


def _run(text, robot):
    assert text.isascii()
    lines = [line for line in text.splitlines() if line.strip() != "end"]
    lines = [_in_python(line) for line in lines]
    for line in lines:
        code = line.split("#")[0]
        assert not re.search(r"\d[eE]|-0\.0+\b(?!\d)", re.sub(r'"[^"]*"', "", code)), line
    names = {
        **{name: getattr(robot, name) for name in CALLS},
        "p": _PoseLiteral(),
        "True": True,
        "False": False,
        "pose_trans": lambda a, b: pose_of(matrix(a) @ matrix(b)),
        "pose_inv": lambda a: pose_of(np.linalg.inv(matrix(a))),
        "get_actual_tcp_pose": lambda: robot.here,
        "__builtins__": {},
    }
    with contextlib.suppress(HaltedError):
        exec("\n".join(lines), names)
