"""What a line does where it meets others: it runs straight on."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...geometry.cubics import at
from .junctions import Arm, Crossing

_PLACES = 9  # looked at on the way from a corner's disc to where the lines of its arms meet


def bridge(a: Arm, b: Arm) -> np.ndarray:
    """From one arm to the other through a crossing: a cubic along their directions; the width changes evenly."""
    p, q = a.line[a.out], b.line[b.out]
    length = np.hypot(*(q - p)[:2])
    t = np.linspace(0, 1, 10)[1:-1, None]
    c1, c2 = p[:2] - a.direction * length / 3, q[:2] - b.direction * length / 3
    return np.column_stack([at(t, p[:2], c1, c2, q[:2]), (1 - t) * p[2] + t * q[2]])


def stub(arm: Arm, crossing: Crossing) -> np.ndarray:
    """From the crossing to where the arm leaves it: straight on, at the width it has there; at a corner from where the
    lines of both arms meet."""
    start = arm.line[arm.out]
    if crossing.is_corner:
        end, half = crossing.corner
    else:
        back = -arm.direction
        centre = crossing.discs[:, :2].mean(axis=0)
        end = start[:2] + max(float((centre - start[:2]) @ back), 0.0) * back
        room = (crossing.discs[:, 2] - np.hypot(*(crossing.discs[:, :2] - end).T)).max()
        half = min(start[2], max(room, 0.3 * start[2]))
    t = np.linspace(0, 1, 6)[:-1, None]
    return np.column_stack([end + t * (start[:2] - end), half + t[:, 0] * (start[2] - half)])


def find_corners(crossings: list[Crossing], rings: list[np.ndarray]) -> None:
    """Where both arms of each corner begin: where their lines meet, or as near to that as the shape has room for the
    brush; and the half width there."""
    corners = [crossing for crossing in crossings if crossing.is_corner]
    places = [
        crossing.discs[0, :2] + np.linspace(0, 1, _PLACES)[:, None] * _ray(crossing) for crossing in corners
    ]
    rooms = _core.clearance(rings, np.reshape(places, (-1, 2)))
    for crossing, along, room in zip(corners, places, np.reshape(rooms, (-1, _PLACES)), strict=True):
        wide = max(arm.line[arm.out, 2] for arm in crossing.arms)
        fits = np.flatnonzero(room >= 0.9 * min(wide, crossing.discs[0, 2]))
        last = fits[-1] if len(fits) else 0
        crossing.corner = (along[last], min(float(room[last]), 1.2 * wide))


def _ray(crossing: Crossing) -> np.ndarray:
    """From a corner's disc towards where the lines of its arms meet; nothing where they are one line."""
    one, two = crossing.arms
    p, q = one.line[one.out], two.line[two.out]
    back, d = -one.direction, -two.direction
    cross = back[0] * d[1] - back[1] * d[0]
    if abs(cross) < 0.2:
        return np.zeros(2)
    off = q[:2] - p[:2]
    ray = p[:2] + (off[0] * d[1] - off[1] * d[0]) / cross * back - crossing.discs[0, :2]
    return ray * min(1.0, 1.5 * crossing.discs[0, 2] / max(np.hypot(*ray), 1e-9))
