"""Find dips: strokes that fetch paint, known by their comments or their place."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import Counter
from itertools import pairwise

import numpy as np

# Places whose neighbours are listed at once. The limit bounds the memory for files whose places are all neighbours.
QUERY_BATCH = 256
SAME_PLACE_MM = 1.0  # strokes that begin within this distance are at the same place
MIN_POT_VISITS = 3  # visits that make a place a paint pot
_COMMENT = re.compile(r"\(([^()]*)\)|;(.*)")
_DIP = re.compile(
    r"\b(?:dip(?:s|ped|ping)?|re-?load(?:s|ed|ing)?|refill(?:s|ed|ing)?|rins(?:e|es|ed|ing)|wash(?:es|ed|ing)?"
    r"|(?:get|load|fetch)\s+(?:paint|ink|brush)|(?:paint|ink|water|colou?r)[- ]?(?:pot|cup|jar|well|tray|station)s?)\b",
    re.I,
)
_END = re.compile(r"\b(?:end|done|finished)\b", re.I)


def read_comments(text: str) -> dict[int, str]:
    """Return the comments of a program by line number, counted from 1."""
    comment_by_line = {}
    for number, line in enumerate(text.splitlines(), 1):
        if comment := " ".join(filter(None, (a or b for a, b in _COMMENT.findall(line)))).strip():
            comment_by_line[number] = comment
    return comment_by_line


def find_dips(strokes: list[tuple[int, np.ndarray]], comment_by_line: dict[int, str]) -> tuple[list[bool], str]:
    """Find the strokes that are dips.

    Returns for each stroke whether it is a dip, and a phrase that says how the dips were recognised.

    By comment: the stroke after a comment that names a dip, with the strokes that follow at the same place. A
    comment that occurs once may be about a stroke of the drawing, so its place must be outside of the drawing.

    By place, if no comment names a dip: strokes that begin at the same place repeatedly, with other strokes in
    between, outside of the drawing.

    strokes: (line number, points (n, 2) [mm]) of each stroke; comment_by_line: comments by line number.
    """
    by_comment = _find_commented_dips(strokes, comment_by_line)
    if any(by_comment):
        return by_comment, "by their comments"
    return _find_pot_dips([points for _, points in strokes]), "by their place, to which the program returns"


def _find_commented_dips(strokes: list[tuple[int, np.ndarray]], comment_by_line: dict[int, str]) -> list[bool]:
    # kinds: the comment of each stroke without numbers, "" if the stroke is not a dip.
    lines, kinds = sorted(comment_by_line), []
    last, box = -1, None
    for line, points in strokes:
        at = bisect_right(lines, line) - 1
        words = comment_by_line[lines[at]] if at >= 0 else ""
        low, high = points.min(axis=0) - SAME_PLACE_MM, points.max(axis=0) + SAME_PLACE_MM
        if at != last:
            box = (low, high) if _DIP.search(words) and not _END.search(words) else None
        elif box is not None:
            is_there = bool((low <= box[1]).all() and (high >= box[0]).all())
            box = (np.minimum(low, box[0]), np.maximum(high, box[1])) if is_there else None
        last = at
        kinds.append(re.sub(r"\d+", "", words) if box is not None else "")
    visits = Counter(kind for before, kind in pairwise(["", *kinds]) if kind and not before)
    outside = _find_outside_others([points for _, points in strokes], [bool(kind) for kind in kinds])
    return [bool(kind) and (is_out or visits[kind] > 1) for kind, is_out in zip(kinds, outside, strict=True)]


def _find_outside_others(strokes: list[np.ndarray], chosen: list[bool]) -> list[bool]:
    """Return a flag for each chosen stroke: whether it has no point in the box of the others, if there are any."""
    others = [points for points, is_chosen in zip(strokes, chosen, strict=True) if not is_chosen]
    if not others:
        return [False] * len(strokes)
    low, high = np.vstack(others).min(axis=0), np.vstack(others).max(axis=0)
    return [
        is_chosen and not ((points >= low) & (points <= high)).all(axis=1).any()
        for points, is_chosen in zip(strokes, chosen, strict=True)
    ]


def _find_pot_dips(strokes: list[np.ndarray]) -> list[bool]:
    import shapely  # imported here because only programs of other tools need it

    if not strokes:
        return []
    begins = np.array([points[0] for points in strokes])
    # Strokes that follow each other at one place are coats of paint, not dips.
    is_coat = np.append(False, np.hypot(*np.diff(begins, axis=0).T) <= SAME_PLACE_MM)
    places, place_of_stroke = np.unique(begins, axis=0, return_inverse=True)
    stroke_counts, coat_counts = np.bincount(place_of_stroke), np.bincount(place_of_stroke, is_coat)
    points = shapely.points(places)
    tree, visits, coats = shapely.STRtree(points), np.zeros(len(places)), np.zeros(len(places))
    for first in range(0, len(places), QUERY_BATCH):
        queried, neighbours = tree.query(
            points[first : first + QUERY_BATCH], predicate="dwithin", distance=SAME_PLACE_MM
        )
        np.add.at(visits, first + queried, stroke_counts[neighbours])
        np.add.at(coats, first + queried, coat_counts[neighbours])
    is_pot = ((visits >= MIN_POT_VISITS) & (coats == 0))[place_of_stroke]
    return _find_outside_others(strokes, is_pot.tolist())
