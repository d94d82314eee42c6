"""What every language needs: comments that stay comments, numbers that nobody misreads."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterator, Sequence

import numpy as np

BRACKETS = {ord("("): "[", ord(")"): "]"}
AT_ONCE = {ord("!"): ".", ord("?"): ".", ord("%"): ".", ord("~"): "-"}
ENDS = {ord(";"): ","}  # an instruction of TP, and of HP-GL
QUOTES = {ord('"'): "'"}  # that end a comment of HP-GL
NAMED = 40  # letters of a name that no line of a program is too short for
ROWS_AT_ONCE = 10_000  # of points that become text: some megabytes, for any stroke length


def plain(text: str, room: int) -> str:
    """One line of 7-bit text of at most room letters: accents go, what has no such letter becomes '?'."""
    letters = unicodedata.normalize("NFKD", text)
    letters = "".join(letter for letter in letters if not unicodedata.combining(letter))
    letters = "".join(
        letter if " " <= letter <= "~" else " " if letter.isspace() else "?" for letter in letters
    )
    return letters if len(letters) <= room else letters[: room - 3] + "..."


def spelled(text: str) -> str:
    """A text with no letter that some language leaves out: what any program makes of it, until it is cut."""
    return plain(text, len(text) * 18).translate(BRACKETS | AT_ONCE | ENDS | QUOTES)


def make_unique(names: Sequence[str]) -> list[str]:
    """The names, with their number where a program would write them like another one, or as nothing at all."""
    short = [spelled(name)[:NAMED] for name in names]
    has_own = [
        short.count(each) == 1 and re.search("[0-9A-Za-z]", each) and not each.startswith("station ")
        for each in short
    ]
    return [
        name if own else f"station {number}, {name}"
        for number, (name, own) in enumerate(zip(names, has_own, strict=True), 1)
    ]


def number(value: float, decimals: int) -> str:
    """Fixed decimals, a point in any locale, no minus sign before a zero."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def rows(pattern: str, values: np.ndarray, decimals: int) -> Iterator[str]:
    """A line for every row of values (n, k), by a pattern with k places such as %.4f, in pieces of many lines."""
    for first in range(0, len(values), ROWS_AT_ONCE):
        part = np.round(values[first : first + ROWS_AT_ONCE], decimals) + 0.0  # -0.0 + 0.0 is 0.0
        yield "\n".join([pattern] * len(part)) % tuple(part.ravel().tolist()) + "\n"


def feed_mm_min(speed_mm_s: float) -> float:
    """mm/min in steps of 0.1, rounded down, so that a limit is kept; but not to 0, at which a machine stands still."""
    return max(math.floor(600.0 * speed_mm_s + 1e-6), 1) / 10
