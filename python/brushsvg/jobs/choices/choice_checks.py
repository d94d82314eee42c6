"""Check choices: their types, values and ranges, and which of them contradict each other."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace

from ... import _core
from ...errors import Error, need_number, need_numbers, need_one_of, need_truth, require_type
from ...files import find_file_used_twice
from ...machine.cells.cell import Cell
from ...machine.cells.cell_file import parse_cell, write_cell
from ...read import SIZE_MM, need_regions, need_texts
from ..project.ignored_settings import drop_overruled
from .choices import CHOICE_RANGES, CHOICE_VALUES, CHOICES, END_CHOICES, METHODS_WITHOUT_ENDS, Choices, suffix_of


def check_choices(chosen: Choices) -> Choices:
    """Return the choices, validated and with values in their final types.

    Raises Error for a value that the flag of the command line would refuse as well.
    """
    require_type(chosen.from_project, (tuple, list), "a list of choices", "from_project")
    for name in chosen.from_project:
        need_one_of(name, CHOICES, "a name of from_project")
    chosen = drop_overruled(chosen)
    for name, choices in CHOICE_VALUES.items():
        if getattr(chosen, name) is not None:
            need_one_of(getattr(chosen, name), choices, name)
    for name, limits in CHOICE_RANGES.items():
        if getattr(chosen, name) is not None:
            chosen = replace(chosen, **{name: need_number(getattr(chosen, name), name, *limits)})
    for name, limits in (("sheet", SIZE_MM), ("fit", SIZE_MM), ("origin", (-1e6, 1e6))):
        if getattr(chosen, name) is not None:
            chosen = replace(chosen, **{name: need_numbers(getattr(chosen, name), name, 2, *limits)})
    if chosen.skip_region is not None:
        chosen = replace(chosen, skip_region=[*need_regions(chosen.skip_region, "skip_region")])
    if chosen.colour is not None:
        require_type(chosen.colour, str, "a colour, as #1a237e")
        chosen = replace(chosen, colour=read_colour(chosen.colour))
    if chosen.join is not None:
        need_truth(chosen.join, "join")
    for name in ("layer", "skip_comment"):
        if getattr(chosen, name) is not None:
            need_texts(getattr(chosen, name), name)
    if chosen.select is not None:
        require_type(chosen.select, str, "a text", "select")
    for name in ("brush", "cell", "corrections"):
        kinds = {"brush": (_core.Brush,), "cell": (Cell,)}.get(name, ())
        if getattr(chosen, name) is not None:
            require_type(getattr(chosen, name), (str, os.PathLike, *kinds), f"the name or the path of {name}")
    if isinstance(chosen.brush, _core.Brush):
        _core.check(chosen.brush)
    if isinstance(chosen.cell, Cell):  # a cell made in Python must also be valid as a file
        chosen = replace(chosen, cell=parse_cell(write_cell(chosen.cell)))
    if chosen.fit is not None and chosen.scale is not None:
        raise Error("fit and scale exclude each other", code="options-contradict")
    if chosen.compensation is not None or chosen.input is None:  # otherwise the drawing may name one
        refuse_lag_without_effect(chosen)
    suffix = suffix_of(chosen.input)
    if chosen.units and suffix in (".svg", ".svgz"):
        sentence = "units are for drawings that do not define their unit; an SVG does"
        raise Error(sentence, "units", code="options-contradict")
    if chosen.select and suffix == ".dxf":
        sentence = "select is for SVG; layers of a DXF are chosen by layer"
        raise Error(sentence, "select", code="options-contradict")
    return chosen


def refuse_lag_without_effect(chosen: Choices) -> None:
    if chosen.lag is not None and chosen.compensation != "constant":
        advice = "give --compensation constant"
        raise Error("a lag needs compensation constant", "lag", code="options-contradict", advice=advice)


def refuse_ends_without_effect(chosen: Choices) -> None:
    """Raise Error for ends that were chosen for this call, if the compensation has no choice of ends.

    The ends of a project file or of a drawing are no mistake: they hold for other compensations, too.
    """
    if chosen.compensation not in METHODS_WITHOUT_ENDS:
        return
    for name in END_CHOICES:
        end = getattr(chosen, name)
        if end not in (None, "auto") and name not in chosen.from_project:
            sentence = f"{name} {end} needs compensation closed or refined, not {chosen.compensation}"
            raise Error(sentence, name, code="options-contradict")


def read_colour(text: str) -> str:
    """Return a colour as "#rrggbb", written as in SVG, or as in names of files: rrggbb. Error for any other text."""
    from ...read.svg.colour import parse_colour

    colour = parse_colour(text.strip()) or parse_colour(f"#{text.strip()}")
    if colour is None or not colour.startswith("#"):
        sentence = f"{text[:24]!r} is not a colour; write for example #1a237e or red"
        raise Error(sentence, "colour", code="colour-invalid")
    return colour[:7]


def refuse_file_used_twice(chosen: Choices, written: Iterable[object], more_read: Iterable[object] = ()) -> None:
    """Raise Error if a written file is also read, or written twice.

    written, more_read: paths; everything else, such as None or a Brush, is no path.
    """
    read = (chosen.input, chosen.brush, chosen.cell, chosen.corrections, *more_read)
    if twice := find_file_used_twice(read, written):
        sentence = "this file is named twice: each file that is read or written needs its own path"
        raise Error(sentence, file=twice, code="options-contradict")
