"""What was typed and what the drawing says, as the options of the steps."""

from __future__ import annotations

from ...jobs import choices
from ...jobs.choices import CHOICES, Choices
from ...jobs.conversion import of_cell
from ...jobs.options import Options
from ...machine.cells.cell import Cell
from ...machine.preflight import DEFAULT_TOLERANCE_MM, as_exact_as
from ..console import about, warn
from .output_places import suffix_of


def typed(args, **instead) -> Choices:
    """What was typed or comes from a project file, but for what is known better."""
    given = {name: getattr(args, name, None) for name in CHOICES} | instead
    if isinstance(given["brush"], list):  # of an option that may be given more than once
        given["brush"] = given["brush"][0] if given["brush"] else None
    return choices.without_overruled(Choices(**given, from_project=getattr(args, "from_project", ())))


def settled(chosen: Choices, drawing: str, alone: bool = False) -> Choices:
    with about(drawing):
        return choices.settled(chosen, drawing, alone)


def brush_of(name: str | None):
    with about(name or ""):
        return choices.brush_of(name)


def cell_of(name: str | None) -> Cell:
    with about(name or ""):
        return choices.cell_of(name)


def exact_cell(name: str | None) -> Cell:
    """The machine for what is prepared with no Options, which would make it as exact."""
    return as_exact_as(cell_of(name), DEFAULT_TOLERANCE_MM)


def options_of(chosen: Choices, cell: Cell | None = None, brush=None) -> Options:
    with about(""):  # errors name the brush, cell or file
        return choices.options_of(chosen, cell, brush)


def warn_of_cell(args, cell: Cell) -> None:
    """Of what makes a program less sure than it looks: a paper that nobody taught, an arm that is not followed."""
    if suffix_of(args.output) != ".json":
        warn(cell.name, of_cell(cell))
