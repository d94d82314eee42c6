"""The cell's machine for the next job: what is certain of its faults, besides what it undid already."""

from __future__ import annotations

import numpy as np

from ..machine.cell import Machine
from .fault_model import MACHINE, PAPER
from .faults import Faults

SURE = 1.0  # half intervals from 0, from where on a number goes into a cell


def sure(faults: Faults) -> dict[str, float]:
    """By the name of each number what of it goes into a cell: 0 where it is not certain."""
    return {
        one.number.name: one.value if abs(one.value) > SURE * one.half else 0.0
        for one in faults.found
        if one.number.cause in (MACHINE, PAPER) and not one.number.name.startswith("backlash")
    }


def mended(faults: Faults, middle_mm, before: Machine | None) -> Machine | None:
    """before: what the painted job's cell undid; the rest comes on top. None where nothing is certain."""
    certain = sure(faults)
    if not any(certain.values()):
        return None
    before = before or Machine()
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
    return lines


def _pair(values) -> str:
    return "[{:.5f}, {:.5f}]".format(*values)
