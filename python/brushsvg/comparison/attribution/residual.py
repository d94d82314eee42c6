"""Displacements and widths of marks that remain after the machine is corrected."""

from __future__ import annotations

import numpy as np

from ..photographs import BESIDE_MM, Comparison, Wanted, without
from ..placing import NOWHERE, Canvas, Placed, place
from .model import FaultModel

FINE_PX_PER_MM = 8.0


def beside_machine(
    found: Comparison, certain: dict[str, float], plan, brush, strokes: list[Wanted]
) -> Comparison:
    """Return the comparison without the effect of the faults that a corrected cell undoes.

    certain: these faults, from `corrected_cell.sure`; plan: as it was sent to the machine; strokes: those compared.
    """
    names = tuple(stroke.stroke for stroke in strokes if stroke.predicted)
    model = FaultModel(plan, brush, names, found.middle_mm)
    amiss = np.array([certain.get(number.name, 0.0) for number in model.numbers])
    straight, led = (model.rings(numbers) for numbers in (np.zeros_like(amiss), amiss))
    done = {name: _does(straight.get(name), led.get(name), found.canvas) for name in names}
    return without(found, done)


def _does(straight, led, canvas: Canvas) -> Placed:
    """Where a mark lies, against what it would be."""
    if not straight or not led:
        return NOWHERE
    points = np.vstack([*straight, *led])
    low, high = points.min(axis=0) - 4 * BESIDE_MM, points.max(axis=0) + 4 * BESIDE_MM
    small = Canvas((*low.tolist(), *high.tolist()), min(canvas.px_per_mm, FINE_PX_PER_MM))
    painted = small.filled(led)
    return place(painted, np.ones_like(painted), straight, small)
