"""Moves -> G-code for LinuxCNC (RS274/NGC) and grbl 1.1, 7-bit text, the same bytes for the same moves."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..motion import SAFE_MEANINGS, Move, Program, Wait
from .text import AT_ONCE, BRACKETS, feed_mm_min, number, plain, rows

LINE_LIMIT = 120  # LinuxCNC reads 252 characters; this also fits a screen
GRBL_LINE_LIMIT = 70  # grbl 1.1 reads 79 characters of a line beside blanks, builds with less memory 69
MODES = "G21 G90 G94 G17 G40 G80"


def linuxcnc(program: Program) -> Iterator[str]:
    """The whole program: header, one commented section per stroke, M2."""
    # G64 P, not G61: exact path stops the machine at the joint of any two moves, and a brush that stands
    # still bleeds. Rounding the joints by a fraction of the plan's tolerance keeps the speed even.
    tolerance = number(program.cell.blending.tolerance_mm, program.cell.decimals)
    path = f"G64 P{tolerance}" if float(tolerance) else "G61"
    yield from _program(program, [f"{MODES} G91.1", path], comment)


def grbl(program: Program) -> Iterator[str]:
    """As for LinuxCNC, but for G64, which grbl does not know: its setting $11 says how joints are taken."""
    yield from _program(program, [MODES], grbl_comment)


def comment(text: str) -> str:
    """One line of comment. LinuxCNC acts on comments that start with MSG, DEBUG, LOG, PRINT and the like, so
    callers begin with a word of their own; brackets cannot stay."""
    return f"({plain(text.translate(BRACKETS), LINE_LIMIT - 2)})\n"


def grbl_comment(text: str) -> str:
    """The same without the letters that grbl takes for commands of the moment wherever they stand: ~ would end a stop
    while somebody's hand is at the brush, ! would begin one."""
    text = plain(text.translate(BRACKETS), GRBL_LINE_LIMIT - 2)
    return f"({text.translate(AT_ONCE)})\n"


def wait(step: Wait, comment: Callable[[str], str]) -> str:
    """A dwell, or a stop until a person presses start."""
    if step.seconds is None:
        return comment(f"stop: {step.message}") + "M0\n"
    return f"G4 P{number(step.seconds, 3)}\n"


def _program(program: Program, modes: list[str], comment: Callable[[str], str]) -> Iterator[str]:
    decimals = program.cell.decimals
    yield "".join(map(comment, program.header))
    yield "\n".join(modes) + "\n"
    here, feed = None, ""
    for section in program.sections():
        if here is None:  # up before going anywhere
            yield f"G0 Z{number(program.rise_mm, decimals)}\n"
        yield "\n" + comment(section.title)
        for step in section.steps:
            if isinstance(step, Wait):
                yield wait(step, comment)
                continue
            if step.meaning not in SAFE_MEANINGS:
                wanted = f"F{feed_mm_min(step.speed_mm_s):.1f}\n"
                if wanted != feed:
                    yield wanted
                feed = wanted
            yield from _lines(step, here, decimals)
            here = step.points_mm[-1]
    yield "\nM2\n"


def _lines(move: Move, here: np.ndarray | None, decimals: int) -> Iterator[str]:
    if move.arc is not None and here is not None:
        # I and J are counted from the point as it was written, so that both ends lie on one circle
        start = np.round(here[:2], decimals)
        values = np.array([[*move.points_mm[-1], *(np.array(move.arc.centre_mm) - start)]])
        word = "G3" if move.arc.turn > 0 else "G2"
        yield from rows(" ".join([word, *(f"{axis}%.{decimals}f" for axis in "XYZIJ")]), values, decimals)
        return
    word = "G0" if move.meaning in SAFE_MEANINGS else "G1"
    yield from rows(f"{word} X%.{decimals}f Y%.{decimals}f Z%.{decimals}f", move.points_mm, decimals)
