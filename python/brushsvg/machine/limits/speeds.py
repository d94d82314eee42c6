"""The highest and lowest speeds on a machine while a brush touches."""

from __future__ import annotations

import numpy as np

from ...errors import Notice
from ..cells.cell import Cell
from ..cells.language_limits import LEAST_SPEED_MM_S
from ..realised.distortion import max_true_per_commanded

MIN_SPEED_MM_S = 1e-6  # below this speed, durations would be meaningless


def touching_mm_s(brush, cell: Cell) -> float:
    """Return the highest speed [mm/s] of the brush's tip on the paper."""
    return min(cell.speeds.paint_mm_s, brush.max_speed_mm_s)


def commanded_touching_mm_s(brush, cell: Cell) -> float:
    """Return the highest commanded speed [mm/s] at which the tip keeps its limit.

    A machine that goes too far for each mm is also faster than commanded.
    """
    return touching_mm_s(brush, cell) / max_true_per_commanded(cell.machine)


def check_painting_speed(speed_mm_s: float, brush, cell: Cell | None) -> list[Notice]:
    """Report a speed outside the limits of the brush and the cell, with the one whose limit it breaks."""
    min_mm_s, max_mm_s, owner = MIN_SPEED_MM_S, brush.max_speed_mm_s, f"brush {brush.name}"
    if cell is not None:
        min_mm_s, max_mm_s = LEAST_SPEED_MM_S.get(cell.language, MIN_SPEED_MM_S), touching_mm_s(brush, cell)
        if speed_mm_s < min_mm_s or max_mm_s < brush.max_speed_mm_s:
            owner = f"cell {cell.name}"
    least = np.format_float_positional(min_mm_s, trim="-")
    if min_mm_s <= speed_mm_s <= max_mm_s:
        if cell is None or (most_mm_s := commanded_touching_mm_s(brush, cell)) >= min_mm_s:
            return []
        sentence = (
            f"the machine of cell {cell.name} goes too far, so its limit while painting is {most_mm_s:.4g} mm/s, "
            f"outside the range [{least}, {max_mm_s:g}] mm/s that its language can command"
        )
        advice = "use a higher paint_mm_s in the cell or a faster brush, or correct the scale of the machine itself"
        return [Notice("", sentence, code="speed-out-of-range", advice=advice)]
    sentence = f"speed {speed_mm_s:.4g} mm/s is outside the range [{least}, {max_mm_s:g}] mm/s of {owner}"
    return [Notice("", sentence, code="speed-out-of-range")]
