"""What a calibration may look for of a machine: only what its cell can undo."""

from __future__ import annotations

from ..errors import Notice
from ..machine.cells.cell import Cell, not_undone

CELL_KEY_BY_PART = {  # of a cell's table machine, by the part of `calibrate --machine` that finds them
    "lean": "lean_mm_per_mm",
    "axes": "scale",
    "tilt": "tilt_mm_per_mm",
    "backlash": "backlash_mm",
    "field": "field_mm",
}


def select_correctable_parts(parts: tuple[str, ...], cell: Cell) -> tuple[tuple[str, ...], list[Notice]]:
    """The parts that a cell of this kind can undo, and one notice on the rest."""
    left_out = not_undone(cell)
    rest = [part for part in parts if CELL_KEY_BY_PART[part] in left_out]
    if not rest:
        return parts, []
    why = "; ".join(dict.fromkeys(left_out[CELL_KEY_BY_PART[part]] for part in rest))
    sentence = f"cell {cell.name} cannot undo {', '.join(rest)}, which is not looked for: {why}"
    kept = tuple(part for part in parts if part not in rest)
    return kept, [Notice("machine", sentence, code="machine-not-undone")]
