"""A smooth displacement field of a machine over the sheet, in the paper's frame."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ...errors import Notice
from ..cells.cell import Cell, Machine

MAX_FIELD_OFFSET_MM = 0.003  # largest distance of the path from its target between the ends of a commanded line
MIN_REPORTED_BEYOND_MM = 1.0  # smaller distances are not reported, because a field hardly changes within a mm


def has_field(machine: Machine | None) -> bool:
    return machine is not None and bool(machine.field_mm)


def field_displacement_mm(places_mm: np.ndarray, machine: Machine) -> np.ndarray:
    """Return the displacement (n, 2) [mm] at commanded places (n, 2).

    The displacement is a u^2 + b u v + c v^2 for x and for y, with u and v from -1 to 1 over the measured area. Beyond
    this area it is the displacement at its edge.
    """
    if not machine.field_mm:
        return np.zeros_like(places_mm)
    u, v = np.clip((places_mm - machine.field_middle_mm) / machine.field_reach_mm, -1.0, 1.0).T
    return np.column_stack([u * u, u * v, v * v]) @ np.array(machine.field_mm).T


def max_field_slope(machine: Machine) -> float:
    """Return the largest change of the field with x or y, in mm per mm.

    The change is linear in u and v, so it is largest at a corner.
    """
    ((a, b, c), (d, e, f)), (reach_x, reach_y) = machine.field_mm, machine.field_reach_mm
    by_x = max(2 * abs(a) + abs(b), 2 * abs(d) + abs(e)) / reach_x
    by_y = max(2 * abs(c) + abs(b), 2 * abs(f) + abs(e)) / reach_y
    return max(by_x, by_y)


def count_line_parts(commanded_mm: np.ndarray, machine: Machine) -> np.ndarray:
    """Return the number of parts that make each line straight enough, (n - 1,).

    The lines connect commanded places (n, 2). A curve with the second derivative q that is divided into k chords is at
    most q / (8 k^2) away from them.
    """
    du, dv = (np.diff(commanded_mm, axis=0) / machine.field_reach_mm).T
    bends = 2 * np.column_stack([du * du, du * dv, dv * dv]) @ np.array(machine.field_mm).T
    return np.maximum(np.ceil(np.sqrt(np.hypot(*bends.T) / (8 * MAX_FIELD_OFFSET_MM))), 1).astype(int)


def cuts_at_field_edge(commanded_mm: np.ndarray, machine: Machine) -> list[np.ndarray]:
    """Return the shares at which each line crosses the field's edge.

    The lines connect commanded places (n, 2). The last share of each line is 1. The field has a kink at the edge of the
    measured area.
    """
    if not distance_beyond_field_mm(commanded_mm, machine):
        return [np.ones(1)] * (len(commanded_mm) - 1)
    normalized = (commanded_mm - machine.field_middle_mm) / machine.field_reach_mm
    cuts = []
    for start, end in pairwise(normalized):
        with np.errstate(divide="ignore", invalid="ignore"):
            crossed = np.concatenate([(edge - start) / (end - start) for edge in (-1.0, 1.0)])
        cuts.append(np.unique([*crossed[(crossed > 0) & (crossed < 1)], 1.0]))
    return cuts


def distance_beyond_field_mm(commanded_mm: np.ndarray, machine: Machine) -> float:
    """Return the largest distance [mm] of places beyond the field. commanded_mm: (n, 2) commanded places."""
    beyond = np.abs(commanded_mm - machine.field_middle_mm) - machine.field_reach_mm
    return float(np.max(beyond, initial=0.0))


def beyond_field(passes, cell: Cell) -> list[Notice]:
    """Report the stroke that goes furthest beyond the measured field."""
    if not has_field(cell.machine):
        return []
    far_mm = {
        a_pass.stroke: distance_beyond_field_mm(np.asarray(a_pass.poses_mm)[:, :2], cell.machine) for a_pass in passes
    }
    stroke = max(far_mm, key=far_mm.get, default="")
    if not far_mm or far_mm[stroke] <= MIN_REPORTED_BEYOND_MM:
        return []
    (x, y), (reach_x, reach_y) = cell.machine.field_middle_mm, cell.machine.field_reach_mm
    sentence = (
        f"the tool goes {far_mm[stroke]:.1f} mm beyond where the field of cell {cell.name} was measured, outside the "
        f"ranges [{x - reach_x:.1f}, {x + reach_x:.1f}] "
        f"and [{y - reach_y:.1f}, {y + reach_y:.1f}] mm: beyond that, the field counts as at its edge"
    )
    return [
        Notice(
            stroke,
            sentence,
            code="beyond-field",
            advice="paint a chart on as large a sheet, or keep the drawing within",
        )
    ]
