"""Moves -> G-code for LinuxCNC (RS274/NGC) and grbl 1.1, 7-bit text, the same bytes for the same moves."""

from __future__ import annotations

import math
import unicodedata

import numpy as np

from ..program import SAFE_MEANINGS, Move, Program

LINE_LIMIT = 120  # LinuxCNC reads 255 characters; this also fits a screen
GRBL_LINE_LIMIT = 70  # grbl 1.1 keeps 80 characters of a line, builds with less memory 70


def linuxcnc(program: Program) -> str:
    """The whole program as text: header, one commented section per stroke, M2."""
    # G64 P, not G61: exact path stops the machine at the joint of any two moves, and a brush that stands
    # still bleeds. Rounding the joints by a fraction of the plan's tolerance keeps the speed even.
    tolerance = _number(program.path_tolerance_mm, program.decimals)
    return _text(program, ["G21 G90 G94 G17 G40 G80", f"G64 P{tolerance}"], LINE_LIMIT)


def grbl(program: Program) -> str:
    """As for LinuxCNC, but for G64, which grbl does not know: its setting $11 says how joints are taken."""
    return _text(program, ["G21 G90 G94 G17 G40 G80"], GRBL_LINE_LIMIT)


def _text(program: Program, modes: list[str], line_limit: int) -> str:
    decimals = program.decimals
    lines = [_comment(line, line_limit) for line in program.header]
    lines += modes
    lines.append(f"G0 Z{_number(program.safe_height_mm, decimals)}")
    feed = ""
    for number, section in enumerate(program.sections, 1):
        lines += ["", _comment(f"stroke {number} of {len(program.sections)}: {section.stroke}", line_limit)]
        for move in section.moves:
            points = _lines(move, decimals)
            if move.meaning not in SAFE_MEANINGS:
                wanted = f" F{_feed_mm_min(move.speed_mm_s):.1f}"
                points[0] += wanted if wanted != feed else ""
                feed = wanted
            lines += points
    return "\n".join([*lines, "", "M2", ""])


def _lines(move: Move, decimals: int) -> list[str]:
    word = "G0" if move.meaning in SAFE_MEANINGS else "G1"
    pattern = f"{word} X%.{decimals}f Y%.{decimals}f Z%.{decimals}f"
    rounded = np.round(move.points_mm, decimals) + 0.0  # -0.0 + 0.0 is 0.0: no minus sign before a zero
    return ("\n".join([pattern] * len(rounded)) % tuple(rounded.ravel().tolist())).split("\n")


def _feed_mm_min(speed_mm_s: float) -> float:
    """Rounded down, so that a limit is kept; but not to 0, at which the machine would stand still."""
    return max(math.floor(600.0 * speed_mm_s + 1e-6), 1) / 10


def _number(value: float, decimals: int) -> str:
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def _comment(text: str, line_limit: int) -> str:
    """One line of comment. LinuxCNC acts on comments that start with MSG, DEBUG, LOG, PRINT and the like, so
    callers begin with a word of their own; brackets, line ends and letters beyond ASCII cannot stay."""
    plain = unicodedata.normalize("NFKD", text)
    plain = "".join(letter for letter in plain if not unicodedata.combining(letter))
    plain = plain.translate({ord("("): "[", ord(")"): "]", ord("\n"): " ", ord("\r"): " ", ord("\t"): " "})
    plain = "".join(letter if " " <= letter <= "~" else "?" for letter in plain)
    room = line_limit - 2
    return f"({plain if len(plain) <= room else plain[: room - 3] + '...'})"
