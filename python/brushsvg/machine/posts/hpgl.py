"""Moves -> HP-GL (.hpgl) for pen plotters: whole units of 0.025 mm from the plotter's origin, a pen up or down."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...errors import Error
from ..cells.cell import UNITS_MM, Cell
from ..motion import Move, Program
from .text import ENDS, QUOTES, plain, rows

LINE_LIMIT = 80
UNIT_MM = UNITS_MM["hpgl"]
CM_S = 10.0  # VS takes whole centimetres in a second
HELD_UP = "end: the pen is put away"
PUT_AWAY = ("PU;", "SP0;")


def hpgl(program: Program) -> Iterator[str]:
    """IN, absolute places, one instruction a line, each with no more parameters than the oldest plotters take. CO is a
    comment of HP-GL/2. How fast a pen goes that is up, the plotter decides."""
    cell = program.cell
    yield "".join(map(comment, program.header))
    yield "IN;\nPU;\n" + ("" if cell.pen.colours else "SP1;\n") + "PA;\n"
    here, speed = None, ""
    for section in program.sections():
        yield comment(section.title)
        if not section.moves:
            yield f"SP{pen_number(section.name, cell)};\n"
        for move in section.moves:
            if move.meaning == "land" and speed != (speed_word := f"VS{round(section.drawn_mm_s / CM_S)};\n"):
                yield speed_word
                speed = speed_word
            here = yield from _lines(move, here)
    yield "".join(f"{line}\n" for line in PUT_AWAY) + comment(HELD_UP)


def comment(text: str) -> str:
    return f'CO "{plain(text, LINE_LIMIT - 6).translate(ENDS | QUOTES)}";\n'


def pen_number(name: str, cell: Cell) -> int:
    """Of the one that a section is named after: pen rrggbb. Error where the cell has none of that colour."""
    colours, colour = [colour.lower() for colour in cell.pen.colours], "#" + name.removeprefix("pen ")
    if colour not in colours:
        raise Error(f"no pen of cell {cell.name} has colour {colour}", code="colour-not-served")
    return colours.index(colour) + 1


def _lines(move: Move, here: tuple | None):
    """A move's lines, and where it ends, in units."""
    if move.meaning in ("approach", "retract"):
        return here  # goes with the pen
    places = np.rint(move.points_mm[:, :2] / UNIT_MM).astype(int)
    path = np.vstack([[here] if here else places[:1] + 1, places])
    new = path[1:][np.diff(path, axis=0).any(axis=1)]
    if move.meaning == "lift":
        yield "PU;\n"
    yield from rows("PA%d,%d;", new, 0)
    if move.meaning == "land":
        yield "PD;\n"
    return tuple(places[-1].tolist())
