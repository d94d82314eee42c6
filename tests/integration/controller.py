"""Run LinuxCNC itself without a machine.

It runs its task, its motion planner and its loop of a thousand steps per second.
"""

import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

DISPLAY = Path(__file__).with_name("linuxcnc_display.py")
NOBODY = 65534
MOST = "MIN_LIMIT = -1000\nMAX_LIMIT = 1000\nMAX_VELOCITY = {v}\nMAX_ACCELERATION = {a}\n"
AXIS = "[AXIS_{name}]\n" + MOST
JOINT = (
    "[JOINT_{number}]\nTYPE = LINEAR\nHOME = 0\nFERROR = 100\nMIN_FERROR = 100\n"
    "HOME_SEARCH_VEL = 0\nHOME_LATCH_VEL = 0\nHOME_SEQUENCE = 0\n" + MOST
)
INI = """[EMC]
VERSION = 1.1
MACHINE = none
[DISPLAY]
DISPLAY = {display}
[TASK]
TASK = milltask
CYCLE_TIME = 0.005
[RS274NGC]
PARAMETER_FILE = linuxcnc.var
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 1.0
SERVO_PERIOD = 1000000
[HAL]
HALFILE = linuxcnc.hal
[TRAJ]
COORDINATES = X Y Z
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = {v}
MAX_LINEAR_VELOCITY = {v}
DEFAULT_LINEAR_ACCELERATION = {a}
MAX_LINEAR_ACCELERATION = {a}
NO_FORCE_HOMING = 1
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.1
TOOL_TABLE = linuxcnc.tbl
[KINS]
JOINTS = 3
KINEMATICS = trivkins
"""
HAL = """loadrt trivkins
loadrt motmod servo_period_nsec=1000000 num_joints=3
loadrt sampler depth=60000 cfg=fff
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net x joint.0.motor-pos-cmd => joint.0.motor-pos-fb sampler.0.pin.0
net y joint.1.motor-pos-cmd => joint.1.motor-pos-fb sampler.0.pin.1
net z joint.2.motor-pos-cmd => joint.2.motor-pos-fb sampler.0.pin.2
addf sampler.0 servo-thread
net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net change iocontrol.0.tool-change => iocontrol.0.tool-changed
"""


def ran(program: str, folder: Path, fastest_mm_s: float, acceleration_mm_s2: float) -> np.ndarray:
    """Return the commanded places (n, 3) of the axes [mm] for each millisecond.

    Raise AssertionError with LinuxCNC's message if it does not run the program.
    """
    of = {"v": fastest_mm_s, "a": acceleration_mm_s2, "display": DISPLAY}
    parts = [AXIS.format(name=name, **of) for name in "XYZ"]
    parts += [JOINT.format(number=number, **of) for number in range(3)]
    (folder / "linuxcnc.ini").write_text(INI.format(**of) + "".join(parts))
    (folder / "linuxcnc.hal").write_text(HAL)
    (folder / "program.ngc").write_text(program)
    for empty in ("linuxcnc.var", "linuxcnc.tbl"):
        (folder / empty).touch()
    environment = {**os.environ, "HOME": str(folder)}
    environment.pop("DISPLAY", None)
    with tempfile.TemporaryDirectory() as socket:  # the socket needs a short name
        if os.getuid() == 0:  # LinuxCNC drops the rights of root, for the user in this variable
            Path(socket).chmod(0o777)
            environment |= {"RTAPI_UID": str(NOBODY), "RTAPI_FIFO_PATH": f"{socket}/fifo"}
        done = subprocess.run(
            ["linuxcnc", "linuxcnc.ini"],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=150,
            check=False,
        )
    logs = [path.read_text() for path in sorted(folder.glob("linuxcnc_*.txt"))]
    samples = folder / "samples.txt"
    assert done.returncode == 0 and samples.exists(), [done.stdout, done.stderr, *logs]
    assert not (errors := (folder / "errors.txt").read_text()), errors
    rows = [line.split() for line in samples.read_text().splitlines()]
    assert not any("overrun" in row for row in rows), "places were lost"
    return np.array(rows, dtype=float)[:, 1:]
