"""Strokes of a program that fetch paint rather than draw: by the comments around them, or by their place."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import Counter
from itertools import pairwise

import numpy as np

AT_ONCE = 256  # places whose neighbours are listed: in a file that was made to, each has all others
PLACE_MM = 1.0  # strokes that begin as near to each other are at the same place
LEAST_VISITS = 3  # to one place, for it to be a pot
_COMMENT = re.compile(r"\(([^()]*)\)|;(.*)")
_DIP = re.compile(
    r"\b(?:dip(?:s|ped|ping)?|re-?load(?:s|ed|ing)?|refill(?:s|ed|ing)?|rins(?:e|es|ed|ing)|wash(?:es|ed|ing)?"
    r"|(?:get|load|fetch)\s+(?:paint|ink|brush)|(?:paint|ink|water|colou?r)[- ]?(?:pot|cup|jar|well|tray|station)s?)\b",
    re.I,
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

    By comments: the stroke behind one that names a dip, with those that follow at the same place. A comment that comes
    once may be about a stroke of the drawing, so then the place must be outside of what is drawn. Else by place:
    strokes that begin at one place again and again, with other strokes between them, outside of what is drawn.
    """
    by_comment = _named(strokes, said)
    if any(by_comment):
        return by_comment, "by their comments"
    return _at_pots([points for _, points in strokes]), "by their place, to which the program comes back"


def _named(strokes: list[tuple[int, np.ndarray]], said: dict[int, str]) -> list[bool]:
    lines, kinds = sorted(said), []  # of each stroke what is said of it, without numbers; "" if it is no dip
    last, box = -1, None
    for line, points in strokes:
        at = bisect_right(lines, line) - 1
        words = said[lines[at]] if at >= 0 else ""
        low, high = points.min(axis=0) - PLACE_MM, points.max(axis=0) + PLACE_MM
        if at != last:
            box = (low, high) if _DIP.search(words) and not _END.search(words) else None
        elif box is not None:
            is_there = bool((low <= box[1]).all() and (high >= box[0]).all())
            box = (np.minimum(low, box[0]), np.maximum(high, box[1])) if is_there else None
        last = at
        kinds.append(re.sub(r"\d+", "", words) if box is not None else "")
    visits = Counter(kind for before, kind in pairwise(["", *kinds]) if kind and not before)
    outside = _outside([points for _, points in strokes], [bool(kind) for kind in kinds])
    return [bool(kind) and (is_out or visits[kind] > 1) for kind, is_out in zip(kinds, outside, strict=True)]


def _outside(strokes: list[np.ndarray], chosen: list[bool]) -> list[bool]:
    """Which of the chosen strokes have no point in the box of the others; none where there are no others."""
    others = [points for points, is_chosen in zip(strokes, chosen, strict=True) if not is_chosen]
    if not others:
        return [False] * len(strokes)
    low, high = np.vstack(others).min(axis=0), np.vstack(others).max(axis=0)
    return [
        is_chosen and not ((points >= low) & (points <= high)).all(axis=1).any()
        for points, is_chosen in zip(strokes, chosen, strict=True)
    ]


def _at_pots(strokes: list[np.ndarray]) -> list[bool]:
    import shapely  # loaded for programs of other tools alone

    if not strokes:
        return []
    begins = np.array([points[0] for points in strokes])
    # one after the other at one place are coats of paint
    follows = np.append(False, np.hypot(*np.diff(begins, axis=0).T) <= PLACE_MM)
    places, of = np.unique(begins, axis=0, return_inverse=True)
    there, followed = np.bincount(of), np.bincount(of, follows)
    points = shapely.points(places)
    tree, visits, coats = shapely.STRtree(points), np.zeros(len(places)), np.zeros(len(places))
    for first in range(0, len(places), AT_ONCE):
        queried, found = tree.query(points[first : first + AT_ONCE], predicate="dwithin", distance=PLACE_MM)
        np.add.at(visits, first + queried, there[found])
        np.add.at(coats, first + queried, followed[found])
    is_pot = ((visits >= LEAST_VISITS) & (coats == 0))[of]
    return _outside(strokes, is_pot.tolist())
