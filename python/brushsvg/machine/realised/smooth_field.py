"""A smooth field: by how much a machine takes the tool elsewhere at each place of the sheet. In the paper's frame."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...errors import Notice
from ..cells.cell import Cell, Machine

OFF_MM = 0.003  # greatest distance of the way from its target, between the ends of a commanded line
BEYOND_MM = 1.0  # reported only from there on: a field does not change within a mm


def is_bent(machine: Machine | None) -> bool:
    return machine is not None and bool(machine.field_mm)


def field_mm(places_mm: np.ndarray, machine: Machine) -> np.ndarray:
    """(n, 2): the displacement at commanded places (n, 2), a u^2 + b u v + c v^2 for x and for y, with u and
    v from -1 to 1 over where the field was measured; beyond as at its edge."""
    if not machine.field_mm:
        return np.zeros_like(places_mm)
    u, v = np.clip((places_mm - machine.field_middle_mm) / machine.field_reach_mm, -1.0, 1.0).T
    return np.column_stack([u * u, u * v, v * v]) @ np.array(machine.field_mm).T


def steepest(machine: Machine) -> float:
    """The most that x or y of the field changes with x or y: at a corner, as it does so evenly."""
    ((a, b, c), (d, e, f)), (along, up) = machine.field_mm, machine.field_reach_mm
    by_x = max(2 * abs(a) + abs(b), 2 * abs(d) + abs(e)) / along
    by_y = max(2 * abs(c) + abs(b), 2 * abs(f) + abs(e)) / up
    return max(by_x, by_y)


def parts_of(commanded_mm: np.ndarray, machine: Machine) -> np.ndarray:
    """Return (n - 1,) the lines from each commanded place (n, 2) to the next, so that each is straight enough: a
    way with the second derivative q over it has chords that leave it by q / 8 k^2, in k of them."""
    du, dv = (np.diff(commanded_mm, axis=0) / machine.field_reach_mm).T
    bends = 2 * np.column_stack([du * du, du * dv, dv * dv]) @ np.array(machine.field_mm).T
    return np.maximum(np.ceil(np.sqrt(np.hypot(*bends.T) / (8 * OFF_MM))), 1).astype(int)


def edge_cuts(commanded_mm: np.ndarray, machine: Machine) -> list[np.ndarray]:
    """Return for each line between commanded places (n, 2) shares of it, up to 1, where it leaves or enters what was
    measured: there the field has a kink."""
    if not beyond_mm(commanded_mm, machine):
        return [np.ones(1)] * (len(commanded_mm) - 1)
    at = (commanded_mm - machine.field_middle_mm) / machine.field_reach_mm
    cuts = []
    for start, end in pairwise(at):
        with np.errstate(divide="ignore", invalid="ignore"):
            crossed = np.concatenate([(edge - start) / (end - start) for edge in (-1.0, 1.0)])
        cuts.append(np.unique([*crossed[(crossed > 0) & (crossed < 1)], 1.0]))
    return cuts


def beyond_mm(commanded_mm: np.ndarray, machine: Machine) -> float:
    """Return the farthest distance of commanded places (n, 2) beyond where the field was measured."""
    out = np.abs(commanded_mm - machine.field_middle_mm) - machine.field_reach_mm
    return float(np.max(out, initial=0.0))


def beyond_field(passes, cell: Cell) -> list[Notice]:
    """Return a notice of the stroke that goes farthest beyond where the cell's field was measured."""
    if not is_bent(cell.machine):
        return []
    far = {one.stroke: beyond_mm(np.asarray(one.poses_mm)[:, :2], cell.machine) for one in passes}
    stroke = max(far, key=far.get, default="")
    if not far or far[stroke] <= BEYOND_MM:
        return []
    (x, y), (along, up) = cell.machine.field_middle_mm, cell.machine.field_reach_mm
    sentence = (
        f"the tool goes {far[stroke]:.1f} mm beyond where the field of cell {cell.name} was measured, outside the "
        f"ranges [{x - along:.1f}, {x + along:.1f}] and [{y - up:.1f}, {y + up:.1f}] mm: there it is taken to be as at "
        "its edge"
    )
    return [
        Notice(
            stroke,
            sentence,
            code="beyond-field",
            advice="paint a chart on as large a sheet, or keep the drawing within",
        )
    ]
