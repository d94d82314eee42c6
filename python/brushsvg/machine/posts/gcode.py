"""Moves -> G-code for LinuxCNC (RS274/NGC), grbl 1.1, FluidNC, Marlin 2 and Klipper, 7-bit text, the same bytes for the
same moves. Their differences are in DIALECTS."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ..cells.cell import MAX_RADIUS_DIFFERENCE_MM
from ..motion import MEANINGS_AT_SAFE_HEIGHT, Move, Program, Wait
from .text import AT_ONCE, BRACKETS, feed_mm_min, number, plain, rows

LINE_LIMIT = 120  # LinuxCNC reads 252 characters; this also fits a screen
GRBL_LINE_LIMIT = (
    70  # grbl 1.1 reads 79 characters of a line, not counting blanks, builds with less memory 69
)
PRINTER_LINE_LIMIT = 90  # Marlin keeps 96
MODES = "G21 G90 G94 G17 G40 G80"
HELD_UP = "end: the brush is held up"


def linuxcnc(program: Program) -> Iterator[str]:
    """The whole program: header, one commented section per stroke, M2."""
    # G64 P, not G61: exact path stops the machine at the joint of any two moves, and a brush that stands
    # still bleeds. Rounding the joints by a fraction of the plan's tolerance keeps the speed even.
    tolerance = number(program.cell.blending.tolerance_mm, program.cell.decimals)
    path = f"G64 P{tolerance}" if float(tolerance) else "G61"
    yield from _program(program, [f"{MODES} G91.1", path], DIALECTS["linuxcnc"])


def gcode(program: Program) -> Iterator[str]:
    """As for LinuxCNC, but for G64, which no other dialect knows: a setting of the
    firmware says how joints are taken."""
    dialect = DIALECTS[program.cell.language]
    yield from _program(program, [MODES] if dialect.has_blocks else MODES.split()[:2], dialect)


def comment(text: str) -> str:
    """One line of comment. LinuxCNC acts on comments that start with MSG, DEBUG, LOG, PRINT and the like, so
    callers begin with a word of their own; brackets cannot stay."""
    return f"({plain(text.translate(BRACKETS), LINE_LIMIT - 2)})\n"


def grbl_comment(text: str) -> str:
    """The same without the letters that grbl takes for immediate commands anywhere in a line: ~ would end a stop
    while somebody's hand is at the brush, ! would begin one."""
    text = plain(text.translate(BRACKETS), GRBL_LINE_LIMIT - 2)
    return f"({text.translate(AT_ONCE)})\n"


def printer_comment(text: str) -> str:
    """Up to the line's end. Marlin's emergency parser, where it is built in, looks at the beginning of lines alone."""
    return f"; {plain(text.translate(BRACKETS), PRINTER_LINE_LIMIT - 2)}\n"


@dataclass(frozen=True)
class Dialect:
    """How one firmware's G-code is read.

    comment: a line that says something; remark: the pattern of one, what it says as its group; acts: of what it
    says, when the firmware obeys it; longest: letters of a line that it keeps, blanks among them or not.
    has_blocks: a line may have several words of command, G1 holds, G0 is as fast as the machine likes, M2 ends; else,
    as in printers, each line has one word of command, G0 goes at the feed as well, and a comment is all that marks the
    end. per_s: of a dwell's number; stops: lines of a stop until a person lets the program go on.
    radii_mm: how much the radii of a circle's ends may differ.
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


DIALECTS = {  # LinuxCNC's length and radii by trying its version 2.9
    "linuxcnc": Dialect(comment, 252, True, acts=r"\s*(\w+\s*,|(PROBE|LOG)\w+)"),
    "grbl": Dialect(grbl_comment, 79),  # a buffer of 80
    # Protocol.h: 255 letters; GCode.cpp: radii that differ by more than 0.005 mm may be an error; (MSG, and (PRINT, act
    "fluidnc": Dialect(grbl_comment, 255, acts=r"\s*\w+\s*,", radii_mm=MAX_RADIUS_DIFFERENCE_MM["fluidnc"]),
    "marlin": Dialect(
        printer_comment, 95, True, "; ?(.*)", has_blocks=False, per_s=1e3, stops=("M400", "M0")
    ),
    "klipper": Dialect(
        printer_comment, 255, True, "; ?(.*)", has_blocks=False, per_s=1e3, stops=("M400", "PAUSE")
    ),
}
DIALECTS["grbl-servo"] = DIALECTS["grbl"]
DIALECTS["marlin-servo"] = DIALECTS["marlin"]


def wait(step: Wait, dialect: Dialect) -> str:
    """A dwell, or a stop until a person presses start."""
    if step.seconds is None:
        return dialect.comment(f"stop: {step.message}") + "".join(f"{line}\n" for line in dialect.stops)
    return f"G4 P{number(step.seconds * dialect.per_s, 3 if dialect.per_s == 1 else 0)}\n"


def _program(program: Program, modes: list[str], dialect: Dialect) -> Iterator[str]:
    decimals = program.cell.decimals
    yield "".join(map(dialect.comment, program.header))
    yield "\n".join(modes) + "\n"
    here, feed = None, ""
    for section in program.sections():
        if here is None:  # up before going anywhere
            first = next((step for step in section.steps if isinstance(step, Move)), None)
            is_slow = first is not None and first.meaning not in MEANINGS_AT_SAFE_HEIGHT
            if first is not None and (is_slow or not dialect.has_blocks):
                feed = f"F{feed_mm_min(first.speed_mm_s):.1f}\n"
                yield feed if dialect.has_blocks else f"G1 {feed}"
            yield f"{'G1' if is_slow else 'G0'} Z{number(program.rise_mm, decimals)}\n"
        yield "\n" + dialect.comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield wait(step, dialect)
                continue
            if step.meaning not in MEANINGS_AT_SAFE_HEIGHT or not dialect.has_blocks:
                feed_word = f"F{feed_mm_min(step.speed_mm_s):.1f}\n"
                if feed_word != feed:
                    yield feed_word if dialect.has_blocks else f"G1 {feed_word}"
                feed = feed_word
            yield from _lines(step, here, decimals)
            here = step.points_mm[-1]
    yield "\nM2\n" if dialect.has_blocks else "\nM400\n" + dialect.comment(HELD_UP)


def _lines(move: Move, here: np.ndarray | None, decimals: int) -> Iterator[str]:
    if move.arc is not None and here is not None:
        # I and J are counted from the point as it was written, so that both ends are on one circle
        start = np.round(here[:2], decimals)
        values = np.array([[*move.points_mm[-1], *(np.array(move.arc.centre_mm) - start)]])
        word = "G3" if move.arc.turn > 0 else "G2"
        yield from rows(" ".join([word, *(f"{axis}%.{decimals}f" for axis in "XYZIJ")]), values, decimals)
        return
    word = "G0" if move.meaning in MEANINGS_AT_SAFE_HEIGHT else "G1"
    yield from rows(f"{word} X%.{decimals}f Y%.{decimals}f Z%.{decimals}f", move.points_mm, decimals)
