"""A file of measurements, or of painted marks, to a brush."""

from __future__ import annotations

import os

from ..errors import Error, need
from ..files import read_bytes
from .from_marks import MarkCalibration, calibrate_marks, options_for
from .from_measurements import Calibration
from .from_measurements import calibrate as calibrate_measured
from .machine_found import ask_for
from .mark_input import read_painted
from .measurements import read_measurements


def calibrate(
    path: str | os.PathLike,
    name: str = "",
    *,
    absolute: bool = False,
    total: bool = False,
    machine: tuple[str, ...] = (),
) -> Calibration | MarkCalibration:
    """A brush of what was measured: numbers (.csv, .json) or painted marks (.json), as docs/calibration.md has them.

    name: of the brush, where the file does not say one; else the file's own. absolute: least absolute residuals instead
    of squares; total: total least squares for series of angles. machine: of painted marks, what else to find: "lean",
    "axes", "tilt", "backlash". Returns what was found: brush, a Brush [mm] that save_brush writes; of numbers laws and
    remarks, too, of marks what moved and what is left.

    Raises Error for a file that cannot be read, and measurements that leave a law open or that no brush can have.
    """
    need(path, (str, os.PathLike), "a path")
    need(name, str, "the name of a brush")
    path = os.fspath(path)
    stem, suffix = os.path.splitext(os.path.basename(path))
    measured = read_measurements(read_bytes(path), suffix.lower())
    name = measured.name or name or stem
    if measured.marks is None:
        if machine:
            raise Error(
                "--machine needs painted marks: measured numbers say nothing of the machine",
                code="options-contradict",
            )
        return calibrate_measured(measured, name, bool(absolute), bool(total))
    folder = os.path.dirname(path)
    painted = read_painted(measured.plan, measured.marks, lambda file: read_bytes(os.path.join(folder, file)))
    options = options_for(measured.expected)
    ask_for(options, machine)
    return calibrate_marks(painted, name, measured.depth_range_mm, measured.max_speed_mm_s, options)
