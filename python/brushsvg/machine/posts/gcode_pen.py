"""Write G-code for Marlin plotters with a pen on a servo.

M280 P0 S... lifts or lowers the pen.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..cells.cell import Cell
from ..moves import Move, Program, Wait
from .gcode import DIALECTS, HELD_UP, MODE_WORDS, write_wait
from .text import feed_of_speed_mm_min, format_number, format_rows


def marlin_servo(program: Program) -> Iterator[str]:
    """Write a program for Marlin with a pen on a servo.

    The firmware sets a servo as soon as it reads the command, even while moves are queued. M400 therefore precedes each
    value and stops the machine. So the pen is up or down, and its height does not change along a line.
    """
    cell, dialect = program.cell, DIALECTS["marlin-servo"]
    yield "".join(map(dialect.comment, program.header))
    yield "\n".join(MODE_WORDS.split()[:2]) + "\n"
    yield pen_lift_lines(cell, is_down=False)
    here, feed = None, ""
    for section in program.sections():
        yield "\n" + dialect.comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield write_wait(step, dialect)
                continue
            if step.meaning in ("approach", "retract"):
                continue  # the pen only moves up and down
            if step.meaning == "lift":
                yield pen_lift_lines(cell, is_down=False)
            places = np.round(step.points_mm[:, :2], cell.decimals) + 0.0
            path = np.vstack([places[:1] + 1 if here is None else here, places])
            changed_places, here = places[(path[1:] != path[:-1]).any(axis=1)], places[-1]
            speed_mm_s = section.drawn_mm_s if step.meaning == "land" else step.speed_mm_s
            feed_word = f"G1 F{feed_of_speed_mm_min(speed_mm_s):.1f}\n"
            if (len(changed_places) or step.meaning == "land") and feed_word != feed:
                yield feed_word
                feed = feed_word
            yield from format_rows(
                f"{_motion_word(step)} X%.{cell.decimals}f Y%.{cell.decimals}f", changed_places, cell.decimals
            )
            if step.meaning == "land":
                yield pen_lift_lines(cell, is_down=True)
    yield "\nM400\n" + dialect.comment(HELD_UP)


def pen_lift_lines(cell: Cell, is_down: bool) -> str:
    value = round(cell.pen.servo_values[is_down])
    return f"M400\nM280 P{cell.pen.servo_number} S{value}\nG4 P{format_number(1e3 * cell.pen.settle_s, 0)}\n"


def _motion_word(move: Move) -> str:
    return "G0" if move.meaning == "travel" else "G1"
