"""Turn the command line and the settings of a drawing into options."""

from __future__ import annotations

from ...jobs import options
from ...jobs.choices import drawing_settings
from ...jobs.choices.choices import CHOICES, Choices
from ...jobs.options import Options
from ...jobs.project.ignored_settings import drop_overruled
from ...machine.cells.cell import Cell
from ...machine.preflight import DEFAULT_TOLERANCE_MM, as_exact_as
from ...machine.writer import list_cell_notices
from ..console import refuse_errors, warn
from .output_places import suffix_of


def make_choices(args, **instead) -> Choices:
    """Return the choices from the command line and a project file.

    instead: choices that replace those of the command line.
    """
    given = {name: getattr(args, name, None) for name in CHOICES} | instead
    if isinstance(given["brush"], list):  # an option that may be given more than once
        given["brush"] = given["brush"][0] if given["brush"] else None
    with refuse_errors(""):  # errors name the brush or cell of the project themselves
        return drop_overruled(Choices(**given, from_project=getattr(args, "from_project", ())))


def apply_drawing_settings(chosen: Choices, drawing: str, alone: bool = False) -> Choices:
    with refuse_errors(drawing):
        return drawing_settings.fill_from_drawing(chosen, drawing, alone)


def load_brush(name: str | None):
    with refuse_errors(name or ""):
        return options.load_brush(name)


def load_cell(name: str | None) -> Cell:
    with refuse_errors(name or ""):
        return options.load_cell(name)


def load_exact_cell(name: str | None) -> Cell:
    """Return the cell for work without Options, with the default tolerance. Options would set how exact the cell is."""
    return as_exact_as(load_cell(name), DEFAULT_TOLERANCE_MM)


def make_options(chosen: Choices, cell: Cell | None = None, brush=None) -> Options:
    with refuse_errors(""):  # errors name the brush, cell or file themselves
        return options.make_options(chosen, cell, brush)


def warn_about_cell(args, cell: Cell) -> None:
    """Warn of what makes a program less certain than it looks.

    These are a paper position that nobody taught, and an arm whose joints were not checked.
    """
    if suffix_of(args.output) != ".json":
        warn(cell.name, list_cell_notices(cell))
