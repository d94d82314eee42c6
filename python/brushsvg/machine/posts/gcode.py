"""Write G-code for LinuxCNC (RS274/NGC), grbl 1.1, FluidNC, Marlin 2 and Klipper.

The text is 7-bit, and equal moves give equal bytes. DIALECTS holds the differences between the firmwares.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ..cells.language_limits import MAX_RADIUS_DIFFERENCE_MM
from ..moves import MEANINGS_AT_SAFE_HEIGHT, Move, Program, Wait
from .text import BRACKETS, IMMEDIATE_COMMANDS, feed_of_speed_mm_min, format_number, format_rows, plain_text

LINE_LIMIT = 120  # letters of a line; LinuxCNC reads 252, and 120 also fit a screen
# Letters of a line for grbl 1.1, which reads 79 without blanks. Builds with less memory read 69.
GRBL_LINE_LIMIT = 70
PRINTER_LINE_LIMIT = 90  # letters of a line; Marlin keeps 96
MODE_WORDS = "G21 G90 G94 G17 G40 G80"
HELD_UP = "end: the brush is held up"


def linuxcnc(program: Program) -> Iterator[str]:
    """Write a program for LinuxCNC. It has a header, one commented section per stroke, and M2."""
    # G64 P instead of G61: the exact path mode stops the machine between any two moves, and a brush that stands still
    # bleeds. Rounding the joints by a fraction of the plan's tolerance keeps the speed even.
    tolerance = format_number(program.cell.blending.tolerance_mm, program.cell.decimals)
    path = f"G64 P{tolerance}" if float(tolerance) else "G61"
    yield from _write_program(program, [f"{MODE_WORDS} G91.1", path], DIALECTS["linuxcnc"])


def gcode(program: Program) -> Iterator[str]:
    """Write a program for one of the other firmwares.

    They do not know G64. A setting of the firmware decides how joints between moves are run.
    """
    dialect = DIALECTS[program.cell.language]
    yield from _write_program(program, [MODE_WORDS] if dialect.has_blocks else MODE_WORDS.split()[:2], dialect)


def comment(text: str) -> str:
    """Return a line with a comment for LinuxCNC.

    LinuxCNC acts on comments that start with MSG, DEBUG, LOG, PRINT and similar words. Callers therefore begin with
    another word. Brackets in the text are replaced.
    """
    return f"({plain_text(text.translate(BRACKETS), LINE_LIMIT - 2)})\n"


def grbl_comment(text: str) -> str:
    """Return a line with a comment for grbl.

    Letters that grbl obeys anywhere in a line are replaced. For example, ! would begin a stop, and ~ would end a stop
    while somebody's hand is at the brush.
    """
    text = plain_text(text.translate(BRACKETS), GRBL_LINE_LIMIT - 2)
    return f"({text.translate(IMMEDIATE_COMMANDS)})\n"


def printer_comment(text: str) -> str:
    """Return a comment for a printer's firmware, up to the end of the line.

    The emergency parser that some builds of Marlin have reads only the beginning of lines.
    """
    return f"; {plain_text(text.translate(BRACKETS), PRINTER_LINE_LIMIT - 2)}\n"


@dataclass(frozen=True)
class Dialect:
    """How one firmware reads G-code.

    comment: writes a line with a comment.
    longest: number of letters of a line that the firmware keeps.
    counts_blanks: whether blanks count among these letters.
    remark: pattern of a comment, with its text as the group.
    acts: pattern of comment texts that the firmware obeys.
    has_blocks: whether a line may have several command words. G1 then stays active, G0 is as fast as possible, and M2
        ends the program. Otherwise, as in printers, each line has one command word, G0 uses the feed as well, and only
        a comment marks the end.
    per_s: number of a dwell for one second.
    stops: lines of a stop until a person continues the program.
    radii_mm: largest difference of the radii at the two ends of a circle.
    """

    comment: Callable[[str], str]
    longest: int
    counts_blanks: bool = False
    remark: str = r"\(([^()]*)\)"
    acts: str = ""
    has_blocks: bool = True
    per_s: float = 1.0
    stops: tuple[str, ...] = ("M0",)
    radii_mm: float = 0.01


DIALECTS = {  # the line length and radii of LinuxCNC were measured with version 2.9
    "linuxcnc": Dialect(comment, 252, True, acts=r"\s*(\w+\s*,|(PROBE|LOG)\w+)"),
    "grbl": Dialect(grbl_comment, 79),  # the buffer has 80 letters
    # Protocol.h: 255 letters. GCode.cpp: radii that differ by more than 0.005 mm may be an error. Comments that
    # begin with (MSG, or (PRINT, are obeyed.
    "fluidnc": Dialect(grbl_comment, 255, acts=r"\s*\w+\s*,", radii_mm=MAX_RADIUS_DIFFERENCE_MM["fluidnc"]),
    "marlin": Dialect(printer_comment, 95, True, "; ?(.*)", has_blocks=False, per_s=1e3, stops=("M400", "M0")),
    "klipper": Dialect(printer_comment, 255, True, "; ?(.*)", has_blocks=False, per_s=1e3, stops=("M400", "PAUSE")),
}
DIALECTS["grbl-servo"] = DIALECTS["grbl"]
DIALECTS["marlin-servo"] = DIALECTS["marlin"]


def write_wait(step: Wait, dialect: Dialect) -> str:
    """Return a dwell, or a stop until a person presses start."""
    if step.seconds is None:
        return dialect.comment(f"stop: {step.message}") + "".join(f"{line}\n" for line in dialect.stops)
    return f"G4 P{format_number(step.seconds * dialect.per_s, 3 if dialect.per_s == 1 else 0)}\n"


def _write_program(program: Program, modes: list[str], dialect: Dialect) -> Iterator[str]:
    decimals = program.cell.decimals
    yield "".join(map(dialect.comment, program.header))
    yield "\n".join(modes) + "\n"
    here, feed = None, ""
    for section in program.sections():
        if here is None:  # rise before the first move
            first = next((step for step in section.steps if isinstance(step, Move)), None)
            starts_slowly = first is not None and first.meaning not in MEANINGS_AT_SAFE_HEIGHT
            if first is not None and (starts_slowly or not dialect.has_blocks):
                feed = f"F{feed_of_speed_mm_min(first.speed_mm_s):.1f}\n"
                yield feed if dialect.has_blocks else f"G1 {feed}"
            yield f"{'G1' if starts_slowly else 'G0'} Z{format_number(program.rise_mm, decimals)}\n"
        yield "\n" + dialect.comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield write_wait(step, dialect)
                continue
            if step.meaning not in MEANINGS_AT_SAFE_HEIGHT or not dialect.has_blocks:
                feed_word = f"F{feed_of_speed_mm_min(step.speed_mm_s):.1f}\n"
                if feed_word != feed:
                    yield feed_word if dialect.has_blocks else f"G1 {feed_word}"
                feed = feed_word
            yield from _move_lines(step, here, decimals)
            here = step.points_mm[-1]
    yield "\nM2\n" if dialect.has_blocks else "\nM400\n" + dialect.comment(HELD_UP)


def _move_lines(move: Move, here: np.ndarray | None, decimals: int) -> Iterator[str]:
    if move.arc is not None and here is not None:
        # I and J are relative to the written point, so that both ends are on one circle
        start = np.round(here[:2], decimals)
        values = np.array([[*move.points_mm[-1], *(np.array(move.arc.centre_mm) - start)]])
        word = "G3" if move.arc.turn > 0 else "G2"
        yield from format_rows(" ".join([word, *(f"{axis}%.{decimals}f" for axis in "XYZIJ")]), values, decimals)
        return
    word = "G0" if move.meaning in MEANINGS_AT_SAFE_HEIGHT else "G1"
    yield from format_rows(f"{word} X%.{decimals}f Y%.{decimals}f Z%.{decimals}f", move.points_mm, decimals)
