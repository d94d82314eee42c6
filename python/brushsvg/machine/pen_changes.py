"""Changes of the pen between strokes of different colours, by a person or by the plotter itself."""

from __future__ import annotations

from collections.abc import Sequence

from .. import _core
from ..errors import Error, Notice
from .cells.cell import Cell, Station, reason_for_no_waiting


def may_pause(cell: Cell) -> bool:
    """Return whether the program stops for another pen, or takes it by itself."""
    return cell.pause_per_colour and (has_pens(cell) or not reason_for_no_waiting(cell))


def has_pens(cell: Cell) -> bool:
    """Return whether the machine takes pens of several colours by itself."""
    return bool(cell.pen and cell.pen.colours)


def pen(colour: str) -> Station:
    """Return a station at which a person or the plotter changes the pen or brush.

    It has no place: the tool waits at the safe height above any place.
    """
    return Station(f"pen {colour.lower().lstrip('#')}", (), by_hand=True)


def pen_visits(passes: Sequence[_core.Pass], cell: Cell, first_stroke: int) -> tuple[tuple[Station, ...], ...]:
    """Return for each load the change of the pen before it, () if none changes."""
    if has_pens(cell):
        return _plotter_pen_visits(passes, cell, first_stroke)
    is_new_pen, last_colour = [], ""
    for a_pass in passes:  # a stroke without a colour is painted with the pen that is there
        colour = a_pass.colour.lower()
        is_new_pen.append(bool(colour and last_colour) and colour != last_colour)
        last_colour = colour or last_colour
    # The person mounts the first pen before the program starts.
    is_new_pen[:first_stroke] = [False] * len(is_new_pen[:first_stroke])
    if not any(is_new_pen):
        return ()
    return tuple((pen(a_pass.colour),) if is_new else () for a_pass, is_new in zip(passes, is_new_pen, strict=True))


def _plotter_pen_visits(passes: Sequence[_core.Pass], cell: Cell, first_stroke: int) -> tuple[tuple[Station, ...], ...]:
    """Return the plotter's pen for each load, 1 without a colour; raise Error for a colour without a pen."""
    colours = [colour.lower() for colour in cell.pen.colours]
    visits_of_loads, last_colour = [()] * (first_stroke - 1), ""
    for a_pass in passes[first_stroke - 1 :]:
        colour = a_pass.colour.lower() or colours[0]
        if colour not in colours:
            sentence = f"no pen of cell {cell.name} has colour {colour}; there are {', '.join(colours)}"
            raise Error(sentence, a_pass.stroke, code="colour-not-served")
        visits_of_loads.append((pen(colour),) if colour != last_colour else ())
        last_colour = colour
    return tuple(visits_of_loads)


def count_pen_changes(passes: Sequence[_core.Pass], cell: Cell, first_stroke: int = 1) -> int:
    """Return how often the pen changes between strokes, on a cell without paint."""
    taken = () if cell.reload else pen_visits(passes, cell, first_stroke)
    return sum(map(bool, taken)) - (1 if taken and has_pens(cell) else 0)


def report_single_pen(passes: Sequence[_core.Pass], cell: Cell, first_stroke: int = 1) -> list[Notice]:
    """Report strokes of several colours that are painted in one run.

    Cells with pause_per_colour set to false are not reported.
    """
    if not cell.pause_per_colour or may_pause(cell) or not count_pen_changes(passes, cell, first_stroke):
        return []
    sentence = f"strokes of several colours are painted with one pen: {reason_for_no_waiting(cell)}"
    return [Notice("", sentence, code="colours-as-one", advice="convert --per-colour writes a program for each")]
