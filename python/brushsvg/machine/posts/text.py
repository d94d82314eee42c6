"""Text for all languages: safe comments and unambiguous numbers."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterator, Sequence

import numpy as np

BRACKETS = {ord("("): "[", ord(")"): "]"}
IMMEDIATE_COMMANDS = {ord("!"): ".", ord("?"): ".", ord("%"): ".", ord("~"): "-"}
STATEMENT_ENDS = {ord(";"): ","}  # ends an instruction of TP and of HP-GL
QUOTES = {ord('"'): "'"}  # ends a comment of HP-GL
PROGRAM_END = "end: the brush is held up"  # the last comment of a program
NAMED = 40  # length of a name that fits in a line of any program
MAX_ROWS_AT_ONCE = 10_000  # points that become text at once; limits the memory to some megabytes for long strokes


def plain_text(text: str, room: int) -> str:
    """Return a text as one line of 7-bit text with at most `room` letters.

    Accents are removed, and other letters become '?'.
    """
    letters = unicodedata.normalize("NFKD", text)
    letters = "".join(letter for letter in letters if not unicodedata.combining(letter))
    letters = "".join(letter if " " <= letter <= "~" else " " if letter.isspace() else "?" for letter in letters)
    return letters if len(letters) <= room else letters[: room - 3] + "..."


def spelled(text: str) -> str:
    """Return a text as every language can write it, not yet shortened."""
    return plain_text(text, len(text) * 18).translate(BRACKETS | IMMEDIATE_COMMANDS | STATEMENT_ENDS | QUOTES)


def make_unique_names(names: Sequence[str]) -> list[str]:
    """Return names that stay distinct in a program.

    A name that a program would write like another name, or as nothing, gets its number.
    """
    short_names = [spelled(name)[:NAMED] for name in names]
    has_own_name = [
        short_names.count(short_name) == 1
        and re.search("[0-9A-Za-z]", short_name)
        and not short_name.startswith("station ")
        for short_name in short_names
    ]
    return [
        name if is_kept else f"station {number}, {name}"
        for number, (name, is_kept) in enumerate(zip(names, has_own_name, strict=True), 1)
    ]


def format_number(value: float, decimals: int) -> str:
    """Format a number with fixed decimals. It has a point in any locale, and a zero has no minus sign."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def format_rows(pattern: str, values: np.ndarray, decimals: int) -> Iterator[str]:
    """Yield text with a line for every row of values (n, k), in pieces of many lines.

    pattern: a line with k fields such as %.4f.
    """
    for first in range(0, len(values), MAX_ROWS_AT_ONCE):
        # Adding 0.0 turns -0.0 into 0.0.
        part = np.round(values[first : first + MAX_ROWS_AT_ONCE], decimals) + 0.0
        yield "\n".join([pattern] * len(part)) % tuple(part.ravel().tolist()) + "\n"


def feed_of_speed_mm_min(speed_mm_s: float) -> float:
    """Return the feed [mm/min] of a speed, rounded down to a multiple of 0.1.

    Rounding down keeps limits. The feed is never 0, at which a machine would stand still.
    """
    return max(math.floor(600.0 * speed_mm_s + 1e-6), 1) / 10
