"""The options that a drawing is read, planned and painted with, made from choices."""

from __future__ import annotations

import os
from dataclasses import dataclass

from .. import _core, read
from ..comparison.corrections import Correction, SheetBefore, read_sheet_before, select_for_machine
from ..errors import name_file_in_errors
from ..machine.cells.cell import Cell
from ..machine.cells.cell_file import find_cell
from ..machine.preflight import DEFAULT_TOLERANCE_MM, as_exact_as
from ..model.library import find_brush
from ..read import ReadOptions, layout
from ..read.layout import Layout
from .choices.choices import Choices, suffix_of

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


def load_brush(given):
    """Return the brush with this name or path. Return a Brush or None as it is."""
    if given is None or isinstance(given, _core.Brush):
        return given
    with name_file_in_errors(given):
        return find_brush(given)


def load_cell(given) -> Cell:
    """Return the cell with this name or path.

    A Cell is returned as it is. None stands for the default cell.
    """
    if given is None or isinstance(given, Cell):
        return given or find_cell()
    with name_file_in_errors(given):
        return find_cell(given)


def load_sheet_before(path: str | os.PathLike[str] | None) -> SheetBefore:
    if path is None:
        return SheetBefore()
    with name_file_in_errors(path):
        return read_sheet_before(path)


def make_read_options(chosen: Choices) -> ReadOptions:
    return ReadOptions(
        chosen.sheet,
        chosen.units,
        chosen.select,
        chosen.background or ReadOptions.background,
        chosen.pen,
        chosen.paper_z,
        tuple(chosen.skip_region or ()),
        tuple(chosen.skip_comment or ()),
        lenient=True,  # damaged geometry is reported together with the other notices
        is_placed_later=chosen.fit is not None or chosen.origin is not None,
    )


def make_layout(chosen: Choices) -> Layout:
    needs_layers = "layer" not in chosen.from_project  # a project also serves drawings without layers
    return Layout(tuple(chosen.layer or ()), chosen.width, chosen.fit, chosen.scale, chosen.origin, needs_layers)


def make_options(chosen: Choices, cell: Cell | None = None, brush=None) -> Options:
    """Return the options for these choices.

    cell, brush: the loaded cell and brush, if they are known already.
    """
    cell = cell or load_cell(chosen.cell)
    return Options(
        brush=brush or load_brush(chosen.brush),
        reading=make_read_options(chosen),
        layout=make_layout(chosen),
        compensation=chosen.compensation or Options.compensation,
        lag_mm=chosen.lag,
        tolerance_mm=(suffix_of(chosen.input) != ".json" and chosen.tolerance) or Options.tolerance_mm,
        start=chosen.start or chosen.terminals or Options.start,
        end=chosen.end or chosen.terminals or Options.end,
        paths_as=chosen.paths_as,
        wide=chosen.wide or Options.wide,
        corners=chosen.corners or Options.corners,
        detail=chosen.detail or Options.detail,
        script=chosen.script or Options.script,
        colour=chosen.colour,
        join=bool(chosen.join),
        margin_strokes=chosen.margin_strokes or Options.margin_strokes,
        speed_mm_s=min(Options.speed_mm_s, cell.speeds.paint_mm_s),
        speed_of_all_mm_s=chosen.paint_speed,
        cell=cell,
        z_offset_mm=chosen.z_offset or 0.0,
        corrections=load_sheet_before(chosen.corrections).corrections,
    )
