"""Format reports for people: a verdict, a few lines, and optional details."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

MAX_LINES = 10
MAX_REASONS = 2  # in a verdict; other reasons are in the lines below it
GOOD = "good"
AGAINST = "do not use"
GOOD_OVERLAP = 0.95  # differences are hard to see
USABLE_OVERLAP = 0.70  # the overlap is about 0.6 when the brush is not the one in the file


@dataclass(frozen=True)
class Report:
    """A report for people.

    verdict: see `verdict`; lines: the main results; details: tables and coefficients.
    """

    verdict: str
    lines: tuple[str, ...]
    details: tuple[str, ...] = ()

    def text(self, details: bool = False, picture: str = "") -> str:
        """Return at most ten lines, or all lines and the details. picture: name of a picture of the results."""
        lines, last = [self.verdict, *self.lines], [f"Picture: {picture}"] if picture else []
        most = MAX_LINES - len(last)
        if len(lines) > most and not details:
            lines[most - 1 :] = [f"and {len(lines) - most + 1} more lines in the details"]
        return "\n".join([*lines, *last, *(["", *self.details] if details and self.details else []), ""])


def verdict(against: Iterable[str], but: Iterable[str] = ()) -> str:
    """Return one line that says whether to use a result.

    against: reasons not to use it at all; but: reasons for caution. The gravest reasons come first.
    """
    against, but = list(filter(None, against)), list(filter(None, but))
    if against:
        return f"{AGAINST}, because {_join_reasons(against)}"
    return f"usable, but {_join_reasons(but)}" if but else GOOD


def _join_reasons(reasons: list[str]) -> str:
    more = len(reasons) - MAX_REASONS
    return ", and ".join(reasons[:MAX_REASONS]) + (f" ({plural(more, 'more reason')} below)" if more > 0 else "")


def overlap_reasons(
    overlap: float | None, words: str, good: float = GOOD_OVERLAP, usable: float = USABLE_OVERLAP
) -> tuple[list[str], list[str]]:
    """Return the reasons that follow from an overlap.

    The first list has reasons against use, the second reasons for caution. words: the things that coincide, such as
    "paint and drawing".
    """
    if overlap is None or overlap >= good:
        return [], []
    reason = f"only {percent(overlap)} of {words} coincide"
    return ([reason], []) if overlap < usable else ([], [reason])


def percent(share: float) -> str:
    """Format a share as a percentage, rounded down. 95 % is never less than 0.95, and 100 % is everything."""
    return f"{int(100 * share + 1e-9)} %"


def format_overlap(overlap: float) -> str:
    """Format an overlap, rounded down as `percent` rounds: 0.9496 is not shown as 0.950."""
    return f"{np.floor(1000 * overlap + 1e-9) / 1000:.3f}"


def plural(count: int, noun: str) -> str:
    """Format a count with its noun."""
    return f"{count} {noun}{'s' * (count != 1)}"


def place_line(number: int, stroke: str, at_mm, size: str, reason: str, remedy: str = "") -> str:
    """Format a place as one line, with the number that the picture shows."""
    advice = f". {remedy[0].upper()}{remedy[1:]}." if remedy else ""
    reason = f"; {reason}" if reason else ""
    return f"{number}. {stroke}, x {at_mm[0]:.1f}, y {at_mm[1]:.1f} mm: {size}{reason}{advice}"


def table(head, rows, notes=()) -> list[str]:
    """Return the lines of a table.

    The first column is flush left, the others flush right. notes: texts that follow the cells of each line.
    """
    cells = [tuple(head), *(tuple(row) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ["  ".join([first.ljust(widths[0]), *(map(str.rjust, others, widths[1:]))]) for first, *others in cells]
    if notes:
        lines = [f"{line}  {note}" for line, note in zip(lines, notes, strict=True)]
    return [line.rstrip() for line in lines]
