"""Dots that touch each other, as pairs of dots in Arabic letters do.

Each is a dot of its own. The two are not a line with a waist.
"""

from __future__ import annotations

import numpy as np

from ... import _core
from ...geometry.polylines import lengths

# Greatest half width of the waist, as a share of the smaller dot's half width. For each dot, in its half widths:
# the greatest distance of its middle from the waist (the corner of a square is 1.41 away from its middle), and the
# greatest length of its line beyond the waist.
MAX_WAIST, MAX_TO_MIDDLE, MAX_LENGTH = 0.65, 1.45, 1.9


def part_touching_dots(pieces: list, area: list[np.ndarray]) -> list[tuple[np.ndarray, list[np.ndarray]]]:
    """Return the two dots that a shape consists of, parted across its waist.

    pieces: of the shape's skeleton; area: its outer ring and holes. Returns for each dot its widest disc (x, y,
    half width) and its part of the area. The list is empty if the shape is no pair of dots.
    """
    if len(pieces) != 1 or len(area) != 1 or pieces[0].closed:
        return []
    line = pieces[0].line
    half = line[:, 2]
    smaller_dot = np.minimum(np.maximum.accumulate(half), np.maximum.accumulate(half[::-1])[::-1])
    waist = int(np.argmin(half / np.maximum(smaller_dot, np.finfo(float).tiny)))
    if half[waist] > MAX_WAIST * smaller_dot[waist]:
        return []
    sides = line[waist::-1], line[waist:]
    if not all(_is_dot(side) for side in sides):
        return []
    first_disc, second_disc = (side[np.argmax(side[:, 2])] for side in sides)
    ahead = (second_disc - first_disc)[:2] / np.hypot(*(second_disc - first_disc)[:2])
    far_mm = float(np.ptp(area[0], axis=0).sum())
    dots = []
    for disc, way in ((first_disc, -ahead), (second_disc, ahead)):
        left = np.array([-way[1], way[0]])
        half_plane = line[waist, :2] + far_mm * np.array([left, -left, way - left, way + left])
        dots.append((disc, _core.intersect(area, [half_plane])))
    return dots


def _is_dot(side: np.ndarray) -> bool:
    """Return whether the rows of a line from the waist on are a dot."""
    way = lengths(side[:, :2])
    widest = int(np.argmax(side[:, 2]))
    half = side[widest, 2]
    return bool(way[widest] < MAX_TO_MIDDLE * half and way[-1] < MAX_LENGTH * half)
