"""The machine errors that a calibration may estimate.

Only errors that the cell can undo are estimated.
"""

from __future__ import annotations

from ..errors import Notice
from ..machine.cells.cell import Cell, not_undone

CELL_KEY_BY_PART = {  # keys in the table machine of a cell, by the part of `calibrate --machine` that estimates them
    "lean": "lean_mm_per_mm",
    "axes": "scale",
    "tilt": "tilt_mm_per_mm",
    "backlash": "backlash_mm",
    "field": "field_mm",
}


def select_correctable_parts(parts: tuple[str, ...], cell: Cell) -> tuple[tuple[str, ...], list[Notice]]:
    """Return the parts that this cell can undo, and a notice on the other parts."""
    left_out = not_undone(cell)
    uncorrectable = [part for part in parts if CELL_KEY_BY_PART[part] in left_out]
    if not uncorrectable:
        return parts, []
    why = "; ".join(dict.fromkeys(left_out[CELL_KEY_BY_PART[part]] for part in uncorrectable))
    sentence = f"cell {cell.name} cannot undo {', '.join(uncorrectable)}, so it is not estimated: {why}"
    kept = tuple(part for part in parts if part not in uncorrectable)
    return kept, [Notice("machine", sentence, code="machine-not-undone")]
