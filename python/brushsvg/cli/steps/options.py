"""What was typed and what the drawing says, as the options of the steps."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from ...brush.library import brush_names, find_brush
from ...drawing import ReadOptions, settings_in
from ...drawing.layout import Layout
from ...errors import Error, Notice, lacking
from ...machine.arm.joints import is_installed
from ...machine.cell import Cell
from ...machine.cell_check import OF_EXAMPLE
from ...machine.cell_file import cell_names, find_cell
from ...machine.preflight import DEFAULT_TOLERANCE_MM, as_exact_as
from ...painted.corrections import Correction, read_corrections
from ...pipeline import preparation
from ..console import about, warn
from .output_places import suffix_of


@dataclass(frozen=True)
class Choices:
    """What a drawing or plan is read and painted with, as typed or as the drawing says; None where nobody says it."""

    input: str | None
    brush: str | None
    cell: str | None
    sheet: tuple[float, float] | None
    units: str | None
    layer: list[str] | None
    select: str | None
    width: float | None
    paths_as: str | None
    fit: tuple[float, float] | None
    scale: float | None
    origin: tuple[float, float] | None
    wide: str | None
    corners: str | None
    join: bool | None
    compensation: str | None
    lag: float | None
    paint_speed: float | None
    tolerance: float | None
    start: str | None
    end: str | None
    z_offset: float | None
    corrections: str | None


def typed(args, **instead) -> Choices:
    """What was typed, but for what is known better."""
    names = [field.name for field in fields(Choices)]
    return Choices(**({name: getattr(args, name, None) for name in names} | instead))


def settled(chosen: Choices, drawing: str, alone: bool = False) -> Choices:
    """What was not typed is as the drawing says. It can only name what comes along: it reads no other file. alone:
    nothing else of the drawing is read."""
    with about(drawing):
        said = settings_in(drawing, alone)
        for kind, names in (("brush", brush_names()), ("cell", cell_names())):
            if getattr(chosen, kind) is None and said.get(kind, names[0]) not in names:
                raise Error(
                    f"data-brushsvg-{kind} asks for {kind} {said[kind]!r}, which does not come along; known are "
                    f"{', '.join(names)}",
                    where="svg",
                    code=f"{kind}-unknown",
                    advice=f"give --{kind}",
                )
    return replace(chosen, **{name: value for name, value in said.items() if getattr(chosen, name) is None})


def brush_of(name: str | None):
    with about(name or ""):
        return find_brush(name) if name is not None else None


def cell_of(name: str | None) -> Cell:
    with about(name or ""):
        return find_cell(name) if name is not None else find_cell()


def corrections_of(path: str | None) -> tuple[Correction, ...]:
    if path is None:
        return ()
    with about(path):
        return read_corrections(path)


def exact_cell(name: str | None, tolerance_mm: float | None = None) -> Cell:
    """The machine for what is prepared with no Options, which would make it as exact."""
    return as_exact_as(cell_of(name), tolerance_mm or DEFAULT_TOLERANCE_MM)


def reading_of(chosen: Choices) -> ReadOptions:
    return ReadOptions(
        chosen.sheet, chosen.units, chosen.select, lenient=True
    )  # damage is told with all the rest


def layout_of(chosen: Choices) -> Layout:
    return Layout(tuple(chosen.layer or ()), chosen.width, chosen.fit, chosen.scale, chosen.origin)


def options_of(chosen: Choices, cell: Cell | None = None, brush=None) -> preparation.Options:
    """cell, brush: where they are known already."""
    cell = cell or cell_of(chosen.cell)
    return preparation.Options(
        brush=brush or brush_of(chosen.brush),
        reading=reading_of(chosen),
        layout=layout_of(chosen),
        compensation=chosen.compensation or preparation.Options.compensation,
        lag_mm=chosen.lag,
        tolerance_mm=(suffix_of(chosen.input) != ".json" and chosen.tolerance)
        or preparation.Options.tolerance_mm,
        start=chosen.start or preparation.Options.start,
        end=chosen.end or preparation.Options.end,
        paths_as=chosen.paths_as,
        wide=chosen.wide or preparation.Options.wide,
        corners=chosen.corners or preparation.Options.corners,
        join=bool(chosen.join),
        speed_mm_s=min(preparation.Options.speed_mm_s, cell.speeds.paint_mm_s),
        speed_of_all_mm_s=chosen.paint_speed,
        cell=cell,
        z_offset_mm=chosen.z_offset or 0.0,
        corrections=corrections_of(chosen.corrections),
    )


def warn_of_cell(args, cell: Cell) -> None:
    """Of what makes a program less sure than it looks: a paper that nobody taught, an arm that is not followed."""
    if suffix_of(args.output) == ".json":
        return
    if cell.paper.example:
        warn(cell.name, [OF_EXAMPLE])
    warn_of_arm(cell)


def warn_of_arm(cell: Cell) -> None:
    if cell.arm and not is_installed():
        sentence = f"whether arm {cell.arm.name} reaches all that is painted was not looked at"
        advice = lacking("its joints need", "ssik").sentence
        warn(cell.name, [Notice("arm", sentence, code="arm-not-followed", advice=advice)])
