"""What may be chosen for a drawing."""

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
    """What may be chosen. brush None: round-6, or the one a plan names; the rest has no effect on a plan."""

    brush: _core.Brush | None = None
    reading: read.ReadOptions = read.AS_DRAWN
    layout: layout.Layout = layout.AS_DRAWN
    compensation: str = "closed"
    lag_mm: float | None = None
    tolerance_mm: float = DEFAULT_TOLERANCE_MM
    speed_mm_s: float = 20.0  # of painting, where the drawing does not say; at most the brush's
    speed_of_all_mm_s: float | None = None  # overrides the drawing and the plan
    start: str = "auto"  # of strokes, where the drawing does not set it: "auto", "round", "butt", "pointed"
    end: str = "auto"  # the same
    paths_as: str | None = (
        None  # "stroke", "outline": reads every path as this, in place of the drawing's choice
    )
    wide: str = "auto"  # outlines wider than the brush: "auto", "clamp", "passes", "refuse"
    corners: str = "auto"  # "auto": lifted at sharp corners where the mark is better; "turn": never
    detail: str = "normal"  # how small an area of a shape gets a stroke of its own: "draft", "normal", "fine"
    script: str = "auto"  # how shapes are written: "auto", "latin", "arabic", "devanagari", "cjk"
    margin_strokes: str = "off"  # "auto": where the brush is not calibrated, "on", "off"
    colour: str | None = None  # "#rrggbb": paint the strokes of this colour
    join: bool = False  # lines that meet end to end are one stroke
    cell: Cell | None = None  # whose limits no refined stroke breaks, unless its closed form does
    z_offset_mm: float = 0.0  # of the paper, against the cell's
    corrections: tuple[Correction, ...] = ()  # for the errors that a painted sheet showed

    def __post_init__(self):
        if self.cell is not None:  # from here on it is as exact as the plan
            object.__setattr__(self, "cell", as_exact_as(self.cell, self.tolerance_mm))
        left = select_for_machine(self.corrections, self.cell.machine if self.cell else None)
        object.__setattr__(self, "corrections", left)


DEFAULTS = Options()
