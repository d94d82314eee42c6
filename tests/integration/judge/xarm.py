"""Run a program for xArm in Python with a stub of the vendor's SDK, an ideal arm.

The stub follows the manual of the SDK. Codes other than 0 are errors. An arm moves only if it is enabled, in
mode 0 and in state 0. A radius of None or below 0 is a line that stops at its end. Angles turn about fixed
axes.
"""

from __future__ import annotations

import ast
import builtins
import math
import sys
import types

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame, turned_deg

NOT_READY = 9
FILE = "<program>"


def run_xarm(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray, sensitivity: int = 0) -> Run:
    """Run a program for xArm.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell.
    sensitivity is the setting that the arm must have; 0 means any.
    """
    return executed(text, XArmAPI(start, paper, down, tool, sensitivity)).run


def executed(text: str, arm: XArmAPI) -> XArmAPI:
    """Run the program and return the arm after the program ends or stops."""
    run = arm.run
    try:
        code = compile(text, FILE, "exec")
    except (SyntaxError, ValueError) as mistake:
        run.refused = f"no Python: {mistake}"
        return arm
    run.frame += [ast.dump(each) for each in ast.parse(text).body if isinstance(each, ast.FunctionDef)]
    known = {name: getattr(builtins, name) for name in ("len", "range", "SystemExit")}
    known |= {"__import__": arm.imported, "input": arm.requested, "print": arm.printed}
    try:
        exec(code, {"__name__": "__main__", "__builtins__": known})
        run.frame.append(f"ends in mode {arm.mode}, state {arm.state}, waits {arm.is_waiting}, closed {arm.is_closed}")
    except RefusedError as refusal:
        run.refused = str(refusal)
    except SystemExit as ended:
        run.refused = f"ended: {ended}"
    except Exception as mistake:
        run.refused = f"{type(mistake).__name__}: {mistake}"
    _commented(text, run)
    return arm


def _commented(text: str, run: Run) -> None:
    """Add the comments to the run, each with the number of legs before it."""
    lines = text.split("\n")
    code = [k for k, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    first = min(code, default=0)
    for number, line in enumerate(lines, 1):
        if "\r" in line:
            run.acts.append(f"line {number}: a return within a line")
        if not line.lstrip().startswith("#"):
            continue
        words = line.strip()[1:].strip()
        if number < first:
            run.header.append(words)
        else:
            run.titles.append((words, sum(leg.line < number for leg in run.legs)))


def _line() -> int:
    """Return the current line of the program, outside of its functions."""
    at = sys._getframe(1)
    while at and not (at.f_code.co_filename == FILE and at.f_code.co_name == "<module>"):
        at = at.f_back
    return at.f_lineno if at else 0


def _rpy_deg(turned: np.ndarray) -> list[float]:
    pitch = math.atan2(-turned[2, 0], math.hypot(turned[0, 0], turned[1, 0]))
    roll, yaw = math.atan2(turned[2, 1], turned[2, 2]), math.atan2(turned[1, 0], turned[0, 0])
    if math.hypot(turned[0, 0], turned[1, 0]) < 1e-9:  # roll and yaw turn about one axis
        roll, yaw = 0.0, math.atan2(-turned[0, 1], turned[1, 1])
    return [math.degrees(angle) for angle in (roll, pitch, yaw)]


class XArmAPI(Arm):
    """The SDK's class, whose calls have the SDK's parameters.

    calls holds (name, positional, keywords) of all calls.
    """

    def __init__(self, start, paper, down, tool, sensitivity=0):
        super().__init__(start, paper, down, tool, by_radius=True)
        self.target_sensitivity, self.sensitivity = sensitivity, 0
        self.calls: list[tuple[str, tuple, dict]] = []
        self.is_enabled = self.is_closed = False
        self.mode, self.state = 2, 4  # a user may have left this state
        self.is_waiting = False
        self.world: np.ndarray | None = None
        self.last: list[float] = []

    def imported(self, name, *_):
        if name == "sys":
            return types.SimpleNamespace(argv=["program.py", "192.168.1.200"], exit=sys.exit)
        if name == "xarm.wrapper":
            return types.SimpleNamespace(XArmAPI=self._connected)
        raise RefusedError(f"line {_line()}: there is no module {name}")

    def requested(self, message=""):
        self.run.titles.append((f"stop: {message}", len(self.run.legs)))
        self.rest(_line(), "stop")
        return ""

    def printed(self, *_):
        self.run.acts.append(f"line {_line()}: prints")

    def _connected(self, port=None, is_radian=False, do_not_open=False):
        self.calls.append(("__init__", (port,), {"is_radian": is_radian}))
        if port != "192.168.1.200":
            raise RefusedError(f"line {_line()}: no arm at {port}")
        return _Recorded(self)

    def _ready(self) -> bool:
        return self.is_enabled and self.mode == 0 and self.state == 0

    # The SDK's ---------------------------------------------------------------------------------------

    def motion_enable(self, enable=True, servo_id=None):
        self.is_enabled = bool(enable) and servo_id is None
        return 0

    def set_mode(self, mode=0, detection_param=0):
        if mode != 0:  # in mode 2 a person can move the arm by hand
            self.run.acts.append(f"line {_line()}: mode {mode}")
        self.mode, self.state = mode, 4
        return 0

    def set_state(self, state=0):
        if state not in (0, 3, 4):
            return NOT_READY
        self.state = state
        return 0

    def set_collision_sensitivity(self, value, wait=True):
        if value not in range(6):
            return NOT_READY
        self.sensitivity = value
        self.run.frame.append(f"stops at a collision, sensitivity {value}")
        return 0

    def set_world_offset(self, offset, is_radian=None, wait=True):
        self.world, self.state = self._pose(offset, is_radian), 4
        return 0

    def set_tcp_offset(self, offset, is_radian=None, wait=True):
        self.tcp, self.state = self._pose(offset, is_radian), 4
        return 0

    def set_pause_time(self, sltime, wait=False):
        self.rest(_line(), "wait", float(sltime))
        return 0

    def get_position(self, is_radian=None):
        world = np.eye(4) if self.world is None else self.world
        seen = np.linalg.inv(world) @ self.believed()
        return 0, [*seen[:3, 3].tolist(), *_rpy_deg(seen[:3, :3])]

    def disconnect(self):
        self.is_closed = True

    def set_position(
        self,
        x=None,
        y=None,
        z=None,
        roll=None,
        pitch=None,
        yaw=None,
        radius=None,
        speed=None,
        mvacc=None,
        mvtime=None,
        relative=False,
        is_radian=None,
        wait=False,
        timeout=None,
    ):
        number = _line()
        if not self._ready() or self.is_closed:
            return NOT_READY
        if self.sensitivity != self.target_sensitivity:
            self.run.acts.append(f"line {number}: another sensitivity of collisions")
        given = [x, y, z, roll, pitch, yaw]
        self.is_waiting = wait
        if given == [None] * 6:
            if self.run.legs and self.run.legs[-1].cut_mm > 0:  # the arm stops where it should blend
                self.rest(number, "wait", 0.0)
            return 0
        if relative or is_radian or mvtime:
            self.run.acts.append(f"line {number}: a move of another kind")
        last = self.last or self.get_position()[1]
        self.last = [old if new is None else new for new, old in zip(given, last, strict=True)]
        if not all(isinstance(each, (int, float)) and math.isfinite(each) for each in (*self.last, speed, mvacc)):
            raise RefusedError(f"line {number}: no number")
        if self.world is None:
            self.run.acts.append(f"line {number}: in a frame that somebody has left")
        world = np.eye(4) if self.world is None else self.world
        cut_mm = radius if radius is not None and radius >= 0 else 0.0
        self.line(number, world @ self._pose(self.last, is_radian), speed, mvacc, cut_mm)
        return 0

    def _pose(self, values, is_radian) -> np.ndarray:
        if len(values) != 6:
            raise RefusedError(f"line {_line()}: a pose has six numbers")
        if is_radian:
            raise RefusedError(f"line {_line()}: angles in radians")
        return frame(values[:3], turned_deg(*values[3:]))


SDK = (
    *("motion_enable", "set_mode", "set_state", "set_world_offset", "set_tcp_offset", "set_pause_time"),
    *("get_position", "set_position", "disconnect", "set_collision_sensitivity"),
)


class _Recorded:
    """The arm as the program sees it: only the SDK's calls."""

    def __init__(self, arm: XArmAPI):
        self._arm = arm

    def __getattr__(self, name: str):
        if name not in SDK:
            raise AttributeError(f"XArmAPI has no {name}")

        def call(*given, **named):
            self._arm.calls.append((name, given, named))
            return getattr(self._arm, name)(*given, **named)

        return call
