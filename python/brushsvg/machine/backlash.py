"""What an axis is told beside its place, so that its slide is there whichever way it came: half its backlash ahead."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

# An axis that goes back by less stands still, as lines along the other axis do up to rounding.
STILL_MM = 0.012
SAME_MM = 0.03  # places that stand twice, as the coarsest text rounds them
SETTLED = (
    1.2  # times the backlash, from where an axis comes to the first place of a stroke: then its side is known
)


def behind_mm(told_mm: np.ndarray, backlash_mm) -> np.ndarray:
    """(n, 2) by how much the slides stay behind at places (n, 2) that they are told in turn; first as if they came the
    way that they go on."""
    half = 0.5 * np.asarray(backlash_mm, dtype=float)
    columns = []
    for k in (0, 1):
        at = half[k] * _first_way(told_mm[:, k])
        columns.append(walked(np.diff(told_mm[:, k], prepend=told_mm[:1, k]), float(half[k]), float(at)))
    return np.column_stack(columns).reshape(-1, 2)


def walked(moves: np.ndarray, half: float, at: float) -> list[float]:
    """By how much one axis stays behind after each move [mm]; at: before them."""
    found = []
    for move in moves.tolist():
        at = min(max(at + move, -half), half)
        found.append(at)
    return found


def ahead_mm(places_mm: np.ndarray, backlash_mm) -> np.ndarray:
    """(n, 2) by how much more the axes are told, for their slides to be at places (n, 2) in turn. An axis turns back
    where a place stands twice alone, so that a program that is read back is told alike."""
    half = 0.5 * np.asarray(backlash_mm, dtype=float)
    twice = np.flatnonzero(_is_twice(places_mm))
    return np.column_stack([_ahead(places_mm[:, k], twice, half[k]) for k in (0, 1)]).reshape(-1, 2)


def _ahead(places: np.ndarray, twice: np.ndarray, half: float) -> np.ndarray:
    """Of one axis, that stands at the farthest place while it goes back by less than would be told."""
    if not half or not len(places):
        return np.zeros(len(places))
    bounds = [0, *twice.tolist(), len(places)]
    way, place, found = _first_way(places), places[0], np.zeros(len(places))
    for first, last in pairwise(bounds):
        net = places[min(last, len(places) - 1)] - place
        if abs(net) > STILL_MM / 2:
            way = 1.0 if net > 0 else -1.0
        for row in range(first, last):
            place = max(place, places[row]) if way > 0 else min(place, places[row])
            found[row] = place + way * half - places[row]
    return found


def turning_rows(places_mm: np.ndarray, backlash_mm) -> np.ndarray:
    """Rows (k,) of places (n, 2) at which an axis with backlash turns back: they are to stand twice, so that it takes
    up its play on the spot. Those that stand twice already are left out."""
    is_twice = _is_twice(places_mm)
    found = {
        out
        for k in (0, 1)
        if np.asarray(backlash_mm)[k] > 0
        for far, out in _turns(places_mm[:, k])
        if not is_twice[far : out + 1].any()
    }
    return np.array(sorted(found), dtype=int)


def _is_twice(places_mm: np.ndarray) -> np.ndarray:
    """(n,) whether a place is the one before it."""
    near = np.abs(np.diff(places_mm, axis=0)).max(axis=1) <= SAME_MM
    return np.concatenate([[False], near])[: len(places_mm)]


def settled_mm(first_mm: np.ndarray, ahead: np.ndarray) -> np.ndarray:
    """(2,) whence the axes come to the first place (2,) that they are told, ahead by so much (2,) there."""
    return first_mm - 2 * SETTLED * ahead


def _first_way(places: np.ndarray) -> float:
    """1 or -1: where an axis goes first; one that stands still comes upwards."""
    goes = np.flatnonzero(np.abs(places - places[:1]) > STILL_MM)
    return -1.0 if len(goes) and places[goes[0]] < places[0] else 1.0


def _turns(places: np.ndarray) -> Iterator[tuple[int, int]]:
    """Where one axis turns back: the row that is farthest out, and the last that is hardly less so."""
    way, far, out = _first_way(places), 0, 0
    on = places.tolist()
    for row in range(1, len(on)):
        beyond = way * (on[row] - on[far])
        if beyond < -STILL_MM:
            yield far, out
            way, far, out = -way, row, row
            continue
        out = row
        if beyond > 0:
            far = row
