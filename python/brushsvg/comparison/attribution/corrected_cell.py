"""Correct the cell's machine for the next job by its certain faults.

They are added to the faults that the cell already compensates. Displacements and widths of marks remain.
"""

from __future__ import annotations

from collections.abc import Container

import numpy as np

from ...calibration.marks.machine_found import format_field_lines, format_pair
from ...machine.cells.cell import LEAST_BACKLASH_MM, Machine
from ..photographs import EDGE_BLUR_MM, Comparison, TargetStroke, subtract_displacements
from ..placing import NOWHERE, Canvas, Placed, locate_mark
from .faults import Faults
from .model import MACHINE, PAPER, FaultModel

MIN_CERTAINTY = 1.0  # smallest distance from 0, in half intervals, at which a number goes into a cell
MAX_PX_PER_MM = 8.0  # of the pictures in which displacements by faults are found
# The machine's axes along x and y of the paper; None: backlash is not changed.
AxesAlongPaper = tuple[int, int] | None


KEY_OF_NAME = {  # keys of the table [machine], by the first word of a number's name
    "lean": "lean_mm_per_mm",
    "scale": "scale",
    "skew": "skew",
    "height": "height_mm",
    "tilt": "tilt_mm_per_mm",
    "backlash": "backlash_mm",
}


def key_of(name: str) -> str:
    return KEY_OF_NAME[name.partition(" ")[0]]


def select_certain_numbers(faults: Faults) -> dict[str, float]:
    """Return the value of each number of machine and paper by its name. A value that is not certain is 0."""
    return {
        fault.number.name: fault.value if abs(fault.value) > MIN_CERTAINTY * fault.half else 0.0
        for fault in faults.found
        if fault.number.cause in (MACHINE, PAPER)
    }


def significant_part(
    faults: Faults, before: Machine | None, along: AxesAlongPaper, left_out: Container[str] = ()
) -> dict[str, float]:
    """Return the part of each number that goes into a cell, by its name.

    The part is 0 where the number is not certain. left_out: keys of the table that this machine cannot compensate.
    """
    certain = {
        name: 0.0 if key_of(name) in left_out else value for name, value in select_certain_numbers(faults).items()
    }
    for paper, name in enumerate("xy"):
        previous_mm = before.backlash_mm[along[paper]] if before and along else 0.0
        total_mm = previous_mm + certain.get(f"backlash in {name}", 0.0) if along else previous_mm
        certain[f"backlash in {name}"] = (total_mm if total_mm >= LEAST_BACKLASH_MM else 0.0) - previous_mm
    return certain


def corrected_machine(
    faults: Faults,
    middle_mm,
    before: Machine | None,
    along: AxesAlongPaper = (0, 1),
    left_out: Container[str] = (),
) -> Machine | None:
    """Return the machine that also compensates the certain faults.

    Returns None where nothing is certain. before: machine errors that the cell of the painted job compensated; the
    certain faults are added to them.
    """
    certain = significant_part(faults, before, along, left_out)
    if not any(certain.values()):
        return None
    before = before or Machine()
    backlash = np.array(before.backlash_mm)
    if along:
        backlash[[*along]] += [certain["backlash in x"], certain["backlash in y"]]
    lean, tilt, scale = (
        np.array([certain[f"{name} in {axis}"] for axis in "xy"]) for name in ("lean", "tilt", "scale")
    )
    previous_axes, beyond = _axis_matrix(before.scale, before.skew), _axis_matrix(1 + scale, certain["skew"])
    new_axes = beyond @ previous_axes
    height_mm = before.height_mm + certain["height"] - tilt @ np.asarray(middle_mm)
    return Machine(
        _round_all(beyond @ before.lean_mm_per_mm + lean),
        _round_all(np.diag(new_axes)),
        round(float(new_axes[0, 1]), 5),
        round(float(height_mm), 3),
        _round_all(np.array(before.tilt_mm_per_mm) + tilt @ previous_axes),
        before.map_mm,
        tuple(round(float(value), 3) for value in backlash),
        tuple(map(_round_all, beyond @ before.field_mm)) if before.field_mm else (),
        before.field_middle_mm,
        before.field_reach_mm,
    )


def _axis_matrix(scale, skew: float) -> np.ndarray:
    return np.array([[scale[0], skew], [0.0, scale[1]]])


def _round_all(values) -> tuple[float, ...]:
    return tuple(round(float(value), 5) for value in values)


def format_machine_table(machine: Machine) -> list[str]:
    """Return the lines of a cell's table [machine].

    Parts without an error are left out.
    """
    lines = ["[machine]"]
    if any(machine.lean_mm_per_mm):
        lines.append(f"lean_mm_per_mm = {format_pair(machine.lean_mm_per_mm)}")
    if machine.skew or machine.scale != (1.0, 1.0):
        lines += [f"scale = {format_pair(machine.scale)}", f"skew = {machine.skew:.5f}"]
    if machine.height_mm or any(machine.tilt_mm_per_mm):
        lines += [
            f"height_mm = {machine.height_mm:.3f}",
            f"tilt_mm_per_mm = {format_pair(machine.tilt_mm_per_mm)}",
        ]
    if machine.map_mm:
        rows = ", ".join("[{:.3f}, {:.3f}, {:.4f}]".format(*row) for row in machine.map_mm)
        lines.append(f"map_mm = [{rows}]")
    if any(machine.backlash_mm):
        lines.append("backlash_mm = [{:.3f}, {:.3f}]".format(*machine.backlash_mm))
    if machine.field_mm:
        lines += format_field_lines(machine)
    return lines


def subtract_faults(
    found: Comparison, certain: dict[str, float], plan, brush, strokes: list[TargetStroke]
) -> Comparison:
    """Return the comparison without the faults that a corrected cell compensates.

    certain: these faults, from `significant_part`; plan: as it was sent to the machine; strokes: the
    strokes that were compared.
    """
    names = tuple(stroke.stroke for stroke in strokes if stroke.predicted)
    model = FaultModel(plan, brush, names, found.middle_mm)
    fault_values = np.array([certain.get(number.name, 0.0) for number in model.numbers])
    straight, moved = (model.rings(numbers) for numbers in (np.zeros_like(fault_values), fault_values))
    displacements = {name: _displacement_by_faults(straight.get(name), moved.get(name), found.canvas) for name in names}
    return subtract_displacements(found, displacements)


def _displacement_by_faults(straight, moved, canvas: Canvas) -> Placed:
    """Return the place of a mark with faults, relative to the one without."""
    if not straight or not moved:
        return NOWHERE
    points = np.vstack([*straight, *moved])
    low, high = points.min(axis=0) - 4 * EDGE_BLUR_MM, points.max(axis=0) + 4 * EDGE_BLUR_MM
    small = Canvas((*low.tolist(), *high.tolist()), min(canvas.px_per_mm, MAX_PX_PER_MM))
    painted = small.filled(moved)
    return locate_mark(painted, np.ones_like(painted), straight, small)
