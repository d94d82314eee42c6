"""A report as people read it: a verdict, a few lines, and details for those who ask for them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

MOST_LINES = 10
MOST_REASONS = 2  # in a verdict: the others are in the lines below it
GOOD = "good"
AGAINST = "do not use"
GOOD_OVERLAP = 0.95  # differences are hard to see
USABLE_OVERLAP = 0.70  # with another brush than the one in the file it is about 0.6


@dataclass(frozen=True)
class Report:
    """What a person reads. verdict: see `verdict`; lines: what matters most; details: tables and coefficients."""

    verdict: str
    lines: tuple[str, ...]
    details: tuple[str, ...] = ()

    def text(self, details: bool = False, picture: str = "") -> str:
        """Return at most ten lines, or with details all of them, coefficients last. picture: a file that shows it."""
        lines, last = [self.verdict, *self.lines], [f"Picture: {picture}"] if picture else []
        most = MOST_LINES - len(last)
        if len(lines) > most and not details:
            lines[most - 1 :] = [f"and {len(lines) - most + 1} more lines in the details"]
        return "\n".join([*lines, *last, *(["", *self.details] if details and self.details else []), ""])


def verdict(against: Iterable[str], but: Iterable[str] = ()) -> str:
    """Say in a line whether to use something.

    against: why not to use it at all; but: what to know before using it. The gravest reasons come first.
    """
    against, but = list(filter(None, against)), list(filter(None, but))
    if against:
        return f"{AGAINST}, because {_joined(against)}"
    return f"usable, but {_joined(but)}" if but else GOOD


def _joined(reasons: list[str]) -> str:
    more = len(reasons) - MOST_REASONS
    return ", and ".join(reasons[:MOST_REASONS]) + (f" ({more} more reasons below)" if more > 0 else "")


def overlap_reasons(
    overlap: float | None, words: str, good: float = GOOD_OVERLAP, usable: float = USABLE_OVERLAP
) -> tuple[list[str], list[str]]:
    """What an overlap says against use, and what to know. words: for what coincides, such as "paint and drawing"."""
    if overlap is None or overlap >= good:
        return [], []
    reason = f"only {percent(overlap)} of {words} coincide"
    return ([reason], []) if overlap < usable else ([], [reason])


def percent(share: float) -> str:
    """A share in words, rounded down: 95 % is never less than 0.95, and 100 % is all."""
    return f"{int(100 * share + 1e-9)} %"


def plural(count: int, noun: str) -> str:
    """A count with its noun."""
    return f"{count} {noun}{'s' * (count != 1)}"


def place_line(number: int, stroke: str, at_mm, size: str, reason: str, remedy: str = "") -> str:
    """A place in one line, by the number that the picture shows."""
    advice = f". {remedy[0].upper()}{remedy[1:]}." if remedy else ""
    reason = f"; {reason}" if reason else ""
    return f"{number}. {stroke}, x {at_mm[0]:.1f}, y {at_mm[1]:.1f} mm: {size}{reason}{advice}"


def table(head, rows, notes=()) -> list[str]:
    """Lines of a table: the first column flush left, the others flush right. notes: follow the cells of each line."""
    cells = [tuple(head), *(tuple(row) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = [
        "  ".join([first.ljust(widths[0]), *(map(str.rjust, others, widths[1:]))]) for first, *others in cells
    ]
    if notes:
        lines = [f"{line}  {note}" for line, note in zip(lines, notes, strict=True)]
    return [line.rstrip() for line in lines]
