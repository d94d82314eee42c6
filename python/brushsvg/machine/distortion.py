"""Where a machine takes the tool that is told to go elsewhere, and what to tell it instead. In the paper's frame."""

from __future__ import annotations

import numpy as np

from .. import _core
from .cell import Cell, Machine
from .pass_way import on_way


def is_similar(machine: Machine | None) -> bool:
    """Whether a circle at one depth stays a circle."""
    return machine is None or (
        not machine.skew and machine.scale[0] == machine.scale[1] and not any(machine.tilt_mm_per_mm)
    )


def leans(machine: Machine | None) -> bool:
    return machine is not None and any(machine.lean_mm_per_mm)


def true_mm(points_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """(n, 3): where the tool goes that is told to go there. It leans as deep as it is pressed: not in the air."""
    if machine is None:
        return points_mm
    told = np.asarray(points_mm, dtype=float)
    z = told[:, 2] - machine.height_mm - told[:, :2] @ machine.tilt_mm_per_mm
    depth = np.maximum(-z, 0.0)
    return np.column_stack([told[:, :2] @ _axes(machine).T + np.outer(depth, machine.lean_mm_per_mm), z])


def told_mm(points_mm: np.ndarray, machine: Machine | None) -> np.ndarray:
    """(n, 3): what to tell the machine so that the tool goes there."""
    if machine is None:
        return points_mm
    wanted = np.asarray(points_mm, dtype=float)
    depth = np.maximum(-wanted[:, 2], 0.0)
    place = (wanted[:, :2] - np.outer(depth, machine.lean_mm_per_mm)) @ np.linalg.inv(_axes(machine)).T
    z = wanted[:, 2] + machine.height_mm + place @ machine.tilt_mm_per_mm
    return np.column_stack([place, z])


def told_high_mm(told_mm: np.ndarray, height_mm: float, machine: Machine | None) -> np.ndarray:
    """(n,) what to tell the machine at places (n, 2) that it is told, so that the tool is at least so high over the
    paper, and over what stands as it was taught, such as vessels."""
    rises_mm = np.zeros(len(told_mm))
    if machine is not None:
        rises_mm = np.maximum(machine.height_mm + told_mm @ machine.tilt_mm_per_mm, 0.0)
    return height_mm + rises_mm


def _axes(machine: Machine) -> np.ndarray:
    return np.array([[machine.scale[0], machine.skew], [0.0, machine.scale[1]]])


def true_pass(a_pass, cell: Cell):
    """A pass that the machine was told, as it runs it; circles that do not stay any as the poses on them."""
    return _mapped(a_pass, cell.machine, true_mm)


def told_pass(a_pass, cell: Cell):
    """What to tell the machine so that it runs this pass."""
    return _mapped(a_pass, cell.machine, told_mm)


def _mapped(a_pass, machine: Machine | None, to):
    if machine is None:
        return a_pass
    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    arcs = []
    for arc in a_pass.arcs if is_similar(machine) else ():
        centre = to(np.array([[*arc.centre_mm, poses[arc.first, 2]]]), machine)[0, :2]
        arcs.append(_core.Arc(arc.first, arc.last, tuple(centre.tolist()), arc.direction))
    return on_way(a_pass, to(poses, machine), arcs)
