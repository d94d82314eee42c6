"""The options that a drawing is read, planned and painted with."""

from __future__ import annotations

from dataclasses import dataclass

from .. import _core, read
from ..comparison.corrections import Correction, select_for_machine
from ..machine.cells.cell import Cell
from ..machine.preflight import DEFAULT_TOLERANCE_MM, as_exact_as
from ..read import layout

DEFAULT_BRUSH = "round-6"


@dataclass(frozen=True)
class Options:
    """Options for a drawing; most of them have no effect on a plan.

    brush: None for round-6, or for the brush that a plan names.
    """

    brush: _core.Brush | None = None
    reading: read.ReadOptions = read.AS_DRAWN
    layout: layout.Layout = layout.AS_DRAWN
    compensation: str = "closed"
    lag_mm: float | None = None
    tolerance_mm: float = DEFAULT_TOLERANCE_MM
    # The painting speed where the drawing sets none. It is at most the speed limit of the brush.
    speed_mm_s: float = 20.0
    # The painting speed of all strokes. It overrides the drawing and the plan.
    speed_of_all_mm_s: float | None = None
    start: str = "auto"  # start of strokes where the drawing sets none: "auto", "round", "butt", "pointed"
    end: str = "auto"  # end of strokes; values as for start
    # How to read every path, in place of the drawing's choice: "stroke" or "outline".
    paths_as: str | None = None
    wide: str = "auto"  # how to paint outlines wider than the brush: "auto", "clamp", "passes", "refuse"
    # "auto" lifts the brush at sharp corners where the mark is better. "turn" never lifts it.
    corners: str = "auto"
    detail: str = "normal"  # how small an area gets a stroke of its own: "draft", "normal", "fine"
    script: str = "auto"  # how shapes are written: "auto", "latin", "arabic", "devanagari", "cjk"
    margin_strokes: str = "off"  # "on", "off", or "auto": only where the brush is not calibrated
    colour: str | None = None  # "#rrggbb": paint only the strokes of this colour
    join: bool = False  # paint lines that meet end to end as one stroke
    # Refined strokes keep the limits of this cell, unless the closed form already breaks them.
    cell: Cell | None = None
    z_offset_mm: float = 0.0  # height of the paper above the paper of the cell
    corrections: tuple[Correction, ...] = ()  # displacements for the errors that a painted sheet showed

    def __post_init__(self):
        if self.cell is not None:  # from here on the cell is as exact as the plan
            object.__setattr__(self, "cell", as_exact_as(self.cell, self.tolerance_mm))
        kept = select_for_machine(self.corrections, self.cell.machine if self.cell else None)
        object.__setattr__(self, "corrections", kept)


DEFAULTS = Options()
