"""What was typed and what the drawing says, as the options of the steps."""

from __future__ import annotations

from ...brush.library import brush_names, find_brush
from ...drawing import ReadOptions, settings_in
from ...drawing.layout import Layout
from ...errors import Error
from ...machine.cell import Cell
from ...machine.cell_check import OF_EXAMPLE
from ...machine.cell_file import cell_names, find_cell
from ...pipeline import preparation
from ..console import about, warn
from .outputs import suffix_of


def settle(args, drawing: str, alone: bool = False) -> None:
    """What was not typed is as the drawing says. It can only name what comes along: it reads no other file. alone:
    nothing else of the drawing is read."""
    with about(drawing):
        said = settings_in(drawing, alone)
        for kind, names in (("brush", brush_names()), ("cell", cell_names())):
            if getattr(args, kind) is None and said.get(kind, names[0]) not in names:
                raise Error(
                    f"data-brushsvg-{kind} asks for {kind} {said[kind]!r}, which does not come along; known are "
                    f"{', '.join(names)}",
                    where="svg",
                    code=f"{kind}-unknown",
                    advice=f"give --{kind}",
                )
    for name, value in said.items():
        if getattr(args, name, value) is None:
            setattr(args, name, value)


def brush_of(args):
    with about(args.brush or ""):
        return find_brush(args.brush) if args.brush is not None else None


def cell_of(args) -> Cell:
    with about(args.cell or ""):
        return find_cell(args.cell) if args.cell is not None else find_cell()


def reading_of(args) -> ReadOptions:
    return ReadOptions(args.sheet, args.units, args.select, lenient=True)  # damage is told with all the rest


def layout_of(args) -> Layout:
    return Layout(tuple(args.layer or ()), args.width, args.fit, args.scale, args.origin)


def options_of(args, cell: Cell, brush=None) -> preparation.Options:
    return preparation.Options(
        brush=brush or brush_of(args),
        reading=reading_of(args),
        layout=layout_of(args),
        compensation=args.compensation or preparation.Options.compensation,
        lag_mm=args.lag,
        tolerance_mm=(suffix_of(args.input) != ".json" and args.tolerance)
        or preparation.Options.tolerance_mm,
        paths_as=args.paths_as,
        wide=args.wide or preparation.Options.wide,
        speed_mm_s=min(preparation.Options.speed_mm_s, cell.speeds.paint_mm_s),
        cell=cell,
        z_offset_mm=getattr(args, "z_offset", None) or 0.0,
    )


def warn_of_example(args, cell: Cell) -> None:
    if cell.paper.example and suffix_of(args.output) != ".json":
        warn(cell.name, [OF_EXAMPLE])
