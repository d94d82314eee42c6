"""What a line does where it meets others: it runs straight on."""

from __future__ import annotations

import numpy as np

from .crossings import Arm, Crossing


def bridge(a: Arm, b: Arm) -> np.ndarray:
    """From one arm to the other through a crossing: a cubic along their directions; the width changes evenly."""
    p, q = a.line[a.out], b.line[b.out]
    length = np.hypot(*(q - p)[:2])
    t = np.linspace(0, 1, 10)[1:-1, None]
    u = 1 - t
    c1, c2 = p[:2] - a.direction * length / 3, q[:2] - b.direction * length / 3
    xy = u**3 * p[:2] + 3 * t * u**2 * c1 + 3 * t**2 * u * c2 + t**3 * q[:2]
    return np.column_stack([xy, u * p[2] + t * q[2]])


def stub(arm: Arm, crossing: Crossing, rings: list[np.ndarray]) -> np.ndarray:
    """From the crossing to where the arm leaves it: straight on, at the width it has there; at a corner from where the
    lines of both arms meet."""
    start = arm.line[arm.out]
    if crossing.is_corner:
        end, half = _corner(crossing, rings)
    else:
        back = -arm.direction
        centre = crossing.discs[:, :2].mean(axis=0)
        end = start[:2] + max(float((centre - start[:2]) @ back), 0.0) * back
        room = (crossing.discs[:, 2] - np.hypot(*(crossing.discs[:, :2] - end).T)).max()
        half = min(start[2], max(room, 0.3 * start[2]))
    t = np.linspace(0, 1, 6)[:-1, None]
    return np.column_stack([end + t * (start[:2] - end), half + t[:, 0] * (start[2] - half)])


def _corner(crossing: Crossing, rings: list[np.ndarray]) -> tuple[np.ndarray, float]:
    """Where the lines of both arms of a corner meet, or as near to that as the shape has room for the brush, and the
    half width there."""
    one, two = crossing.arms
    p, q = one.line[one.out], two.line[two.out]
    back, d = -one.direction, -two.direction
    centre, room = crossing.discs[0, :2], crossing.discs[0, 2]
    cross = back[0] * d[1] - back[1] * d[0]
    if abs(cross) < 0.2:
        return centre, max(p[2], q[2])
    off = q[:2] - p[:2]
    meet = p[:2] + (off[0] * d[1] - off[1] * d[0]) / cross * back
    ray = meet - centre
    ray *= min(1.0, 1.5 * room / max(np.hypot(*ray), 1e-9))
    places = centre + np.linspace(0, 1, 9)[:, None] * ray
    rooms = _clearance(places, rings)
    wide = max(p[2], q[2])
    fits = np.flatnonzero(rooms >= 0.9 * min(wide, room))
    last = fits[-1] if len(fits) else 0
    return places[last], min(float(rooms[last]), 1.2 * wide)


def _clearance(points: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """Distance [mm] of points (n, 2) from the outline; it does not say on which side."""
    tails = np.vstack(rings)
    along = np.vstack([np.roll(ring, -1, axis=0) for ring in rings]) - tails
    off = points[:, None] - tails
    t = np.clip((off * along).sum(axis=2) / np.maximum((along * along).sum(axis=1), 1e-18), 0.0, 1.0)
    return np.hypot(*np.moveaxis(off - t[..., None] * along, 2, 0)).min(axis=1)
