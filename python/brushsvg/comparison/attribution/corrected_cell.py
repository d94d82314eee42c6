"""Correct the cell's machine for the next job: by its certain faults, in addition to those undone before."""

from __future__ import annotations

from collections.abc import Container

import numpy as np

from ...calibration.marks.machine_found import field_lines
from ...machine.cells.cell import LEAST_BACKLASH_MM, Machine
from .faults import Faults
from .model import MACHINE, PAPER

SURE = 1.0  # half intervals from 0, from where on a number goes into a cell
# Which of the machine's axes go along x and y of the paper; None: backlash stays.
Along = tuple[int, int] | None


KEYS = {  # of a table machine, by the first word of a number's name
    "lean": "lean_mm_per_mm",
    "scale": "scale",
    "skew": "skew",
    "height": "height_mm",
    "tilt": "tilt_mm_per_mm",
    "backlash": "backlash_mm",
}


def key_of(name: str) -> str:
    return KEYS[name.partition(" ")[0]]


def certain_of(faults: Faults) -> dict[str, float]:
    """By the name of each number of the machine and the paper its value, 0 where it is not certain."""
    return {
        one.number.name: one.value if abs(one.value) > SURE * one.half else 0.0
        for one in faults.found
        if one.number.cause in (MACHINE, PAPER)
    }


def sure(
    faults: Faults, before: Machine | None, along: Along, left_out: Container[str] = ()
) -> dict[str, float]:
    """Return by the name of each number the part that goes into a cell: 0 where it is not certain. left_out: keys of
    the table that this machine cannot undo."""
    certain = {name: 0.0 if key_of(name) in left_out else value for name, value in certain_of(faults).items()}
    for paper, name in enumerate("xy"):
        was = before.backlash_mm[along[paper]] if before and along else 0.0
        now = was + certain.get(f"backlash in {name}", 0.0) if along else was
        certain[f"backlash in {name}"] = (now if now >= LEAST_BACKLASH_MM else 0.0) - was
    return certain


def corrected_machine(
    faults: Faults,
    middle_mm,
    before: Machine | None,
    along: Along = (0, 1),
    left_out: Container[str] = (),
) -> Machine | None:
    """before: what the painted job's cell undid; the rest comes on top. None where nothing is certain."""
    certain = sure(faults, before, along, left_out)
    if not any(certain.values()):
        return None
    before = before or Machine()
    backlash = np.array(before.backlash_mm)
    if along:
        backlash[[*along]] += [certain["backlash in x"], certain["backlash in y"]]
    lean, tilt, scale = (
        np.array([certain[f"{name} in {axis}"] for axis in "xy"]) for name in ("lean", "tilt", "scale")
    )
    was, beyond = _axes(before.scale, before.skew), _axes(1 + scale, certain["skew"])
    now = beyond @ was
    height_mm = before.height_mm + certain["height"] - tilt @ np.asarray(middle_mm)
    return Machine(
        _rounded(beyond @ before.lean_mm_per_mm + lean),
        _rounded(np.diag(now)),
        round(float(now[0, 1]), 5),
        round(float(height_mm), 3),
        _rounded(np.array(before.tilt_mm_per_mm) + tilt @ was),
        before.map_mm,
        tuple(round(float(value), 3) for value in backlash),
        tuple(map(_rounded, beyond @ before.field_mm)) if before.field_mm else (),
        before.field_middle_mm,
        before.field_reach_mm,
    )


def _axes(scale, skew: float) -> np.ndarray:
    return np.array([[scale[0], skew], [0.0, scale[1]]])


def _rounded(values) -> tuple[float, ...]:
    return tuple(round(float(value), 5) for value in values)


def as_table(machine: Machine) -> list[str]:
    """The lines of a cell's table [machine]; parts that are as they should be are left out."""
    lines = ["[machine]"]
    if any(machine.lean_mm_per_mm):
        lines.append(f"lean_mm_per_mm = {_pair(machine.lean_mm_per_mm)}")
    if machine.skew or machine.scale != (1.0, 1.0):
        lines += [f"scale = {_pair(machine.scale)}", f"skew = {machine.skew:.5f}"]
    if machine.height_mm or any(machine.tilt_mm_per_mm):
        lines += [
            f"height_mm = {machine.height_mm:.3f}",
            f"tilt_mm_per_mm = {_pair(machine.tilt_mm_per_mm)}",
        ]
    if machine.map_mm:
        rows = ", ".join("[{:.3f}, {:.3f}, {:.4f}]".format(*row) for row in machine.map_mm)
        lines.append(f"map_mm = [{rows}]")
    if any(machine.backlash_mm):
        lines.append("backlash_mm = [{:.3f}, {:.3f}]".format(*machine.backlash_mm))
    if machine.field_mm:
        lines += field_lines(machine)
    return lines


def _pair(values) -> str:
    return "[{:.5f}, {:.5f}]".format(*values)
