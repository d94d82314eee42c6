"""Write HP-GL (.hpgl) for pen plotters.

The unit is 0.025 mm, from the plotter's origin. The pen is up or down.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...errors import Error
from ..cells.cell import Cell
from ..cells.language_limits import UNITS_MM
from ..moves import Move, Program
from .text import QUOTES, STATEMENT_ENDS, format_rows, plain_text

LINE_LIMIT = 80
UNIT_MM = UNITS_MM["hpgl"]
CM_S = 10.0  # VS takes whole centimetres per second
HELD_UP = "end: the pen is put away"
PUT_AWAY_LINES = ("PU;", "SP0;")


def hpgl(program: Program) -> Iterator[str]:
    """Write a program in HP-GL.

    It begins with IN and uses absolute places. Each line has one instruction, with no more parameters than the oldest
    plotters accept. CO is a comment of HP-GL/2. The plotter decides the speed of a raised pen.
    """
    cell = program.cell
    yield "".join(map(comment, program.header))
    yield "IN;\nPU;\n" + ("" if cell.pen.colours else "SP1;\n") + "PA;\n"
    here, speed = None, ""
    for section in program.sections():
        yield comment(section.title)
        if not section.moves:
            yield f"SP{find_pen_number(section.name, cell)};\n"
        for move in section.moves:
            if move.meaning == "land" and speed != (speed_word := f"VS{round(section.drawn_mm_s / CM_S)};\n"):
                yield speed_word
                speed = speed_word
            here = yield from _move_lines(move, here)
    yield "".join(f"{line}\n" for line in PUT_AWAY_LINES) + comment(HELD_UP)


def comment(text: str) -> str:
    return f'CO "{plain_text(text, LINE_LIMIT - 6).translate(STATEMENT_ENDS | QUOTES)}";\n'


def find_pen_number(name: str, cell: Cell) -> int:
    """Return the number of the pen in the name of a section: pen rrggbb.

    Raises Error if the cell has no pen of this colour.
    """
    colours, colour = [colour.lower() for colour in cell.pen.colours], "#" + name.removeprefix("pen ")
    if colour not in colours:
        raise Error(f"no pen of cell {cell.name} has colour {colour}", code="colour-not-served")
    return colours.index(colour) + 1


def _move_lines(move: Move, here: tuple | None):
    """Yield the lines of a move, and return the end of the move in units."""
    if move.meaning in ("approach", "retract"):
        return here  # the pen only moves up and down
    places = np.rint(move.points_mm[:, :2] / UNIT_MM).astype(int)
    path = np.vstack([[here] if here else places[:1] + 1, places])
    changed_places = path[1:][np.diff(path, axis=0).any(axis=1)]
    if move.meaning == "lift":
        yield "PU;\n"
    yield from format_rows("PA%d,%d;", changed_places, 0)
    if move.meaning == "land":
        yield "PD;\n"
    return tuple(places[-1].tolist())
