"""Displacements and widths of marks that remain after the machine is corrected."""

from __future__ import annotations

import numpy as np

from ..photographs import EDGE_BLUR_MM, Comparison, TargetStroke, subtract_displacements
from ..placing import NOWHERE, Canvas, Placed, locate_mark
from .model import FaultModel

MAX_PX_PER_MM = 8.0


def subtract_faults(
    found: Comparison, certain: dict[str, float], plan, brush, strokes: list[TargetStroke]
) -> Comparison:
    """Return the comparison without the faults that a corrected cell compensates.

    certain: these faults, from `corrected_cell.significant_part`; plan: as it was sent to the machine; strokes: the
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
