"""Duration of a program at the feeds that it contains."""

from __future__ import annotations

import math

from ..machine.cells.cell import Cell
from .readback import Readback, Step


def time_as_run_s(read: Readback, cell: Cell) -> float:
    """Return the duration of a program [s] at full speed, without acceleration.

    The time counts from the first place that the program names. Rapid moves are as fast as the cell travels. A circle
    that is written as many lines starts and stops at none of them.
    """
    total_s, here = 0.0, None
    for step in (step for section in read.sections for step in section.steps):
        there = (step.x, step.y, step.z)
        known = here is not None and all(map(math.isfinite, (*here, *there)))
        if cell.servo and known and here[:2] == there[:2]:
            known = False  # a lift takes exactly its wait
        length_mm = _length_mm(here, there, step) if known else 0.0
        speed_mm_s = cell.speeds.travel_mm_s if step.rapid else step.speed_mm_s
        if length_mm > 0 and 0 < speed_mm_s < math.inf:
            total_s += length_mm / speed_mm_s
        total_s += step.wait_s
        here = there
    return total_s


def _length_mm(here, there, step: Step) -> float:
    chord_mm = math.dist(here, there)
    if step.centre is None:
        return chord_mm
    x, y, turn = step.centre
    before, after = (math.atan2(each[1] - y, each[0] - x) for each in (here, there))
    angle = (turn * (after - before)) % (2 * math.pi)
    return math.hypot(angle * math.dist(there[:2], (x, y)), there[2] - here[2])
