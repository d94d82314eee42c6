"""Run a program for Doosan in Python, with a stub of the arm after DRL's manual.

The manual says:

- set_tcp needs a name from the pendant's list.
- A user coordinate system has a number from 101 on.
- Angles turn about z, the new y and the newest z.
- A move without a speed has the speed of set_velx.
- radius is the radius of the blend around the end. A radius of half of the move or more is an error.
- A popup of kind 1 waits for Resume.
"""

from __future__ import annotations

import ast
import math
import sys

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame, turned_deg
from .xarm import FILE, _commented, _line

DR_BASE, DR_TOOL, DR_WORLD = 0, 1, 2
DR_MV_MOD_ABS, DR_MV_RA_DUPLICATE, DR_MV_APP_NONE, DR_MV_ORI_TEACH = 0, 0, 0, 0
DR_PM_MESSAGE, DR_PM_WARNING, DR_PM_ALARM = 0, 1, 2
FIRST_USER, USERS = 101, 20
BUILTINS = {"abs": abs, "sum": sum, "range": range, "len": len}
EXITED = "exits"


def run_doosan(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray) -> Run:
    """Run a program for Doosan.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell.
    """
    arm = _Doosan(start, paper, down, tool)
    run = arm.run
    try:
        code = compile(text, FILE, "exec")
    except (SyntaxError, ValueError) as mistake:
        run.refused = f"no Python: {mistake}"
        return run
    kinds = ast.FunctionDef, ast.If
    run.frame += [ast.dump(each) for each in ast.parse(text).body if isinstance(each, kinds)]
    try:
        exec(code, {"__name__": "drl", "__builtins__": BUILTINS, **arm.functions()})
        run.frame.append(f"ends in coordinates {arm.reference}")
    except RefusedError as refusal:
        run.refused = str(refusal)
    except Exception as mistake:
        run.refused = f"{type(mistake).__name__}: {mistake}"
    _commented(text, run)
    return run


class posx(list):  # noqa: N801 as the manual calls it
    def __init__(self, x=0, y=0, z=0, a=0, b=0, c=0):
        super().__init__(x if isinstance(x, list) else [x, y, z, a, b, c])
        if len(self) != 6 or not all(isinstance(each, (int, float)) and math.isfinite(each) for each in self):
            raise RefusedError(f"line {_line()}: no place")


def _turned(a: float, b: float, c: float) -> np.ndarray:
    about_y = turned_deg(0.0, b, 0.0)
    return turned_deg(0.0, 0.0, a) @ about_y @ turned_deg(0.0, 0.0, c)


def _posx(pose: np.ndarray) -> posx:
    m = pose[:3, :3]
    b = math.atan2(math.hypot(m[2, 0], m[2, 1]), m[2, 2])
    if math.sin(b) > 1e-7:
        a, c = math.atan2(m[1, 2], m[0, 2]), math.atan2(m[2, 1], -m[2, 0])
    else:
        a, c = 0.0, math.atan2(m[1, 0], m[1, 1])
    return posx(*pose[:3, 3].tolist(), *(math.degrees(angle) for angle in (a, b, c)))


class _Doosan(Arm):
    def __init__(self, start, paper, down, tool):
        super().__init__(start, paper, down, tool, by_radius=True)
        self.users: dict[int, np.ndarray] = {}
        self.reference = DR_BASE
        self.speed = self.acceleration = None

    def functions(self) -> dict:
        names = (
            *("set_tcp", "set_velx", "set_accx", "set_ref_coord", "set_user_cart_coord", "get_current_posx"),
            *("get_current_tool_flange_posx", "movel", "movec", "wait", "tp_popup", "exit"),
        )
        acts = (
            *("movej", "movejx", "amovel", "set_digital_output", "tp_log", "stop", "task_compliance_ctrl"),
            *("set_tool", "change_operation_speed"),
        )
        known = {name: getattr(self, name) for name in names} | {"posx": posx}
        known |= {name: self._acts(name) for name in acts}
        module = sys.modules[__name__]
        return known | {name: getattr(module, name) for name in dir(module) if name.startswith("DR_")}

    def _acts(self, name: str):
        def called(*_, **__):
            self.run.acts.append(f"line {_line()}: {name}")
            return 0

        return called

    def _frame(self, ref) -> np.ndarray:
        if ref in (DR_BASE, DR_WORLD):
            return np.eye(4)
        if ref not in self.users:
            raise RefusedError(f"line {_line()}: nobody knows coordinates {ref}")
        return self.users[ref]

    def _at(self, pos, ref) -> np.ndarray:
        values = posx(*pos) if isinstance(pos, list) and len(pos) == 6 else posx(pos)
        return self._frame(self.reference if ref is None else ref) @ frame(values[:3], _turned(*values[3:]))

    # The manual's --------------------------------------------------------------------------------------

    def set_tcp(self, name):
        if name != "brush":
            raise RefusedError(f"line {_line()}: no TCP {name}")
        self.tcp = self.true_tool
        return 0

    def set_velx(self, vel1, vel2=None):
        self.speed = self._positive(vel1, vel2)
        return 0

    def set_accx(self, acc1, acc2=None):
        self.acceleration = self._positive(acc1, acc2)
        return 0

    def _positive(self, first, second) -> float:
        if not first > 0 or (second is not None and not second > 0):
            raise RefusedError(f"line {_line()}: DR_ERROR_VALUE")
        return float(first)

    def set_ref_coord(self, coord):
        self._frame(coord)
        self.reference = coord
        return 0

    def set_user_cart_coord(self, pos, ref=DR_BASE):
        if not isinstance(pos, posx) or ref != DR_BASE or len(self.users) == USERS:
            raise RefusedError(f"line {_line()}: no coordinates")
        self.users[FIRST_USER + len(self.users)] = frame(pos[:3], _turned(*pos[3:]))
        return FIRST_USER + len(self.users) - 1

    def get_current_posx(self, ref=DR_BASE):
        return _posx(np.linalg.inv(self._frame(ref)) @ self.believed()), 2

    def get_current_tool_flange_posx(self, ref=DR_BASE):
        return _posx(np.linalg.inv(self._frame(ref)) @ self.believed() @ np.linalg.inv(self.tcp))

    def movel(
        self,
        pos,
        vel=None,
        acc=None,
        time=None,
        radius=None,
        ref=None,
        mod=DR_MV_MOD_ABS,
        ra=DR_MV_RA_DUPLICATE,
        v=None,
        a=None,
        t=None,
        r=None,
    ):
        number, target = _line(), self._at(pos, ref)
        speed, acceleration, cut_mm = self._how(number, vel, acc, time, radius, mod, ra, v, a, t, r)
        if cut_mm and 2 * cut_mm > np.linalg.norm(self.tip(target)[0] - self.at):
            raise RefusedError(f"line {number}: the blend begins before the middle")
        self.line(number, target, speed, acceleration, cut_mm)
        return 0

    def movec(
        self,
        pos1,
        pos2,
        vel=None,
        acc=None,
        time=None,
        radius=None,
        ref=None,
        mod=DR_MV_MOD_ABS,
        angle=None,
        ra=DR_MV_RA_DUPLICATE,
        v=None,
        a=None,
        t=None,
        r=None,
        an=None,
    ):
        number, both = _line(), (self._at(pos1, ref), self._at(pos2, ref))
        if angle or an:
            self.run.acts.append(f"line {number}: a circle that goes on")
        self.circle(number, *both, *self._how(number, vel, acc, time, radius, mod, ra, v, a, t, r))
        return 0

    def _how(self, number, vel, acc, time, radius, mod, ra, v, a, t, r) -> tuple[float, float, float]:
        if time or t or mod != DR_MV_MOD_ABS or ra != DR_MV_RA_DUPLICATE:
            self.run.acts.append(f"line {number}: a move of another kind")
        speeds = [each for each in (vel, v, self.speed) if each is not None]
        accelerations = [each for each in (acc, a, self.acceleration) if each is not None]
        if not speeds or not accelerations:
            raise RefusedError(f"line {number}: as fast as somebody has left it")
        return speeds[0], accelerations[0], next((each for each in (radius, r) if each is not None), 0.0)

    def wait(self, time):
        self.rest(_line(), "wait", float(time))
        return 0

    def tp_popup(self, message, pm_type=DR_PM_MESSAGE, button_type=0):
        if pm_type != DR_PM_MESSAGE or button_type != 1:
            self.run.acts.append(f"line {_line()}: a popup after which nothing goes on")
        self.run.titles.append((f"stop: {message}", len(self.run.legs)))
        self.rest(_line(), "stop")
        return 0

    def exit(self):
        raise RefusedError(EXITED)
