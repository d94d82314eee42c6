"""Strokes of a program that fetch paint rather than draw: by the comments around them, or by their place."""

from __future__ import annotations

import re

import numpy as np

PLACE_MM = 1.0  # strokes that begin as near to each other are at the same place
LEAST_VISITS = 3  # to one place, for it to be a pot
_COMMENT = re.compile(r"\(([^()]*)\)|;(.*)")
_DIP = re.compile(
    r"\b(?:dip\w*|re-?load\w*|refill\w*|rinse\w*|wash\w*|(?:get|load|fetch)\s+(?:paint|ink|brush))\b", re.I
)
_END = re.compile(r"\b(?:end|done|finished)\b", re.I)


def comments(text: str) -> dict[int, str]:
    """What the lines of a program say to people, by their numbers from 1 on."""
    found = {}
    for number, line in enumerate(text.splitlines(), 1):
        if said := " ".join(filter(None, (a or b for a, b in _COMMENT.findall(line)))).strip():
            found[number] = said
    return found


def dips(strokes: list[tuple[int, np.ndarray]], said: dict[int, str]) -> tuple[list[bool], str]:
    """Which strokes, (line, points (n, 2)) each, are dips, and how they were recognised, in words.

    By comments: those between a comment that names a dip and the next comment. Else by place: those that begin at one
    place again and again, with other strokes between them, outside of all that is drawn elsewhere.
    """
    by_comment = [_named(line, said) for line, _ in strokes]
    if any(by_comment):
        return by_comment, "by their comments"
    return _at_pots([points for _, points in strokes]), "by their place, to which the program comes back"


def _named(line: int, said: dict[int, str]) -> bool:
    """Whether the last comment before a line is of a dip, and not of its end."""
    last = said[max(before)] if (before := [number for number in said if number <= line]) else ""
    return bool(_DIP.search(last)) and not _END.search(last)


def _at_pots(strokes: list[np.ndarray]) -> list[bool]:
    if not strokes:
        return []
    begins = np.array([points[0] for points in strokes])
    near = np.hypot(*(begins[:, None] - begins[None]).transpose(2, 0, 1)) <= PLACE_MM
    visits = near.sum(axis=1)
    # one after the other at one place are coats of paint
    follows = np.array([False, *(near[k, k + 1] for k in range(len(strokes) - 1))])
    is_pot = (visits >= LEAST_VISITS) & ~(near & follows[None]).any(axis=1)
    if not is_pot.any() or is_pot.all():
        return [False] * len(strokes)
    drawn = np.vstack([points for points, pot in zip(strokes, is_pot, strict=True) if not pot])
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    return [
        bool(pot) and not ((points >= low) & (points <= high)).all(axis=1).any()
        for points, pot in zip(strokes, is_pot, strict=True)
    ]
