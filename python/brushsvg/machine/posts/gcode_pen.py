"""Moves -> G-code for Marlin plotters whose pen hangs on a servo: M280 P0 S... lifts it or lets it down."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..cells.cell import Cell
from ..motion import Move, Program, Wait
from .gcode import DIALECTS, HELD_UP, MODES, wait
from .text import feed_mm_min, number, rows


def marlin_servo(program: Program) -> Iterator[str]:
    """The firmware sets a servo as soon as it reads of it, even while it still holds moves: M400 stands before each
    value, and the machine stands. So a pen is up or down, and no height changes along a line."""
    cell, dialect = program.cell, DIALECTS["marlin-servo"]
    yield "".join(map(dialect.comment, program.header))
    yield "\n".join(MODES.split()[:2]) + "\n"
    yield lifted(cell, is_down=False)
    here, feed = None, ""
    for section in program.sections():
        yield "\n" + dialect.comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield wait(step, dialect)
                continue
            if step.meaning in ("approach", "retract"):
                continue  # goes with the pen
            if step.meaning == "lift":
                yield lifted(cell, is_down=False)
            places = np.round(step.points_mm[:, :2], cell.decimals) + 0.0
            path = np.vstack([places[:1] + 1 if here is None else here, places])
            new, here = places[(path[1:] != path[:-1]).any(axis=1)], places[-1]
            speed_mm_s = section.drawn_mm_s if step.meaning == "land" else step.speed_mm_s
            feed_word = f"G1 F{feed_mm_min(speed_mm_s):.1f}\n"
            if (len(new) or step.meaning == "land") and feed_word != feed:
                yield feed_word
                feed = feed_word
            yield from rows(f"{_word(step)} X%.{cell.decimals}f Y%.{cell.decimals}f", new, cell.decimals)
            if step.meaning == "land":
                yield lifted(cell, is_down=True)
    yield "\nM400\n" + dialect.comment(HELD_UP)


def lifted(cell: Cell, is_down: bool) -> str:
    value = round(cell.pen.servo_values[is_down])
    return f"M400\nM280 P{cell.pen.servo_number} S{value}\nG4 P{number(1e3 * cell.pen.settle_s, 0)}\n"


def _word(move: Move) -> str:
    return "G0" if move.meaning == "travel" else "G1"
