"""Dots that touch each other, as pairs of them in Arabic letters do: each is a dot, both are no line with a waist."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...geometry.polylines import lengths

# Half width of the waist, of the smaller dot's. Of each dot's half width: the distance of its middle from the waist, at
# most, as the corner of a square does from its own, and how long its line is beyond the waist.
WAIST, TO_MIDDLE, LENGTH = 0.65, 1.45, 1.9


def touching_dots(pieces: list, area: list[np.ndarray]) -> list[tuple[np.ndarray, list[np.ndarray]]]:
    """The two dots that a shape consists of, parted across its waist: of each the widest disc (x, y, half width) and
    its part of the area; none if it is no such shape. area: its outer ring and holes; pieces: of its skeleton."""
    if len(pieces) != 1 or len(area) != 1 or pieces[0].closed:
        return []
    line = pieces[0].line
    half = line[:, 2]
    smaller = np.minimum(np.maximum.accumulate(half), np.maximum.accumulate(half[::-1])[::-1])
    k = int(np.argmin(half / np.maximum(smaller, np.finfo(float).tiny)))
    if half[k] > WAIST * smaller[k]:
        return []
    sides = line[k::-1], line[k:]
    if not all(_is_dot(side) for side in sides):
        return []
    one, two = (side[np.argmax(side[:, 2])] for side in sides)
    ahead = (two - one)[:2] / np.hypot(*(two - one)[:2])
    far_mm = float(np.ptp(area[0], axis=0).sum())
    dots = []
    for disc, way in ((one, -ahead), (two, ahead)):
        left = np.array([-way[1], way[0]])
        half_plane = line[k, :2] + far_mm * np.array([left, -left, way - left, way + left])
        dots.append((disc, _core.intersect(area, [half_plane])))
    return dots


def _is_dot(side: np.ndarray) -> bool:
    """Of a line's rows from the waist on."""
    way = lengths(side[:, :2])
    widest = int(np.argmax(side[:, 2]))
    half = side[widest, 2]
    return bool(way[widest] < TO_MIDDLE * half and way[-1] < LENGTH * half)
