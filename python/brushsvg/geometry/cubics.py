"""Cubic Bezier curves: points, bounds, chords, parts, and how many an arc needs."""

from __future__ import annotations

import math

import numpy as np


def at(t, p0, p1, p2, p3):
    """Return the points of curves at t; arrays broadcast together."""
    u = 1 - t
    return u**3 * p0 + 3 * t * u**2 * p1 + 3 * t**2 * u * p2 + t**3 * p3


def extremes(cubics: np.ndarray) -> np.ndarray:
    """Return points that bound cubics (n, 4, 2). These are their ends, and the places where x or y turns back."""
    p = np.moveaxis(cubics, 1, 0)
    a, b, c = p[3] - p[0] + 3 * (p[1] - p[2]), 2 * (p[0] - 2 * p[1] + p[2]), p[1] - p[0]
    # The roots of a t^2 + b t + c = 0, in the form that is exact even where a is small.
    with np.errstate(all="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(b * b - 4 * a * c), b))
        t = np.stack((q / a, c / q))
    t = np.where((t > 0) & (t < 1), t, 0.0)
    return np.concatenate((cubics[:, 0], cubics[:, 3], at(t, *p).reshape(-1, 2)))


def flattened(cubics: np.ndarray, tolerance: float) -> np.ndarray:
    """Return points (k, 2) of cubics (n, 4, 2) within the tolerance.

    No chord is further from its cubic than the tolerance: the chord of 1/n of a cubic is off by |B''| / 8 n^2 at
    most.
    """
    second = 6 * np.abs(np.diff(cubics, n=2, axis=1)).max(axis=1)
    bend = np.hypot(second[:, 0], second[:, 1])
    counts = np.clip(np.ceil(np.sqrt(bend / (8 * tolerance))), 1, 1000).astype(int)
    which = np.repeat(np.arange(len(cubics)), counts)
    first = np.cumsum(counts) - counts
    t = ((np.arange(len(which)) - first[which] + 1) / counts[which])[:, None]
    return np.vstack([cubics[:1, 0], at(t, *(cubics[which, k] for k in range(4)))])


def split(cubic: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Split a cubic (4, 2) at t and return both parts."""
    left, right = [], []
    while len(cubic):
        left.append(cubic[0])
        right.append(cubic[-1])
        cubic = (1 - t) * cubic[:-1] + t * cubic[1:]
    return np.array(left), np.array(right[::-1])


def between(cubics: np.ndarray, begin: tuple[int, float], end: tuple[int, float]) -> np.ndarray:
    """Return the part of joined cubics (n, 4, 2) between two places.

    begin, end: each the number of a cubic and a parameter in it.
    """
    (first, t0), (last, t1) = begin, end
    if begin == end:
        return np.repeat(split(cubics[first], t0)[0][None, 3:], 4, axis=1)
    if first == last:
        return split(split(cubics[last], t1)[0], t0 / t1)[1][None]
    head = [split(cubics[first], t0)[1][None]] if t0 < 1 else []
    tail = [split(cubics[last], t1)[0][None]] if t1 > 0 else []
    return np.concatenate([*head, cubics[first + 1 : last], *tail])


def arc_count(swept: float, radius: float, tolerance: float) -> int:
    """Return the number of cubics for an arc.

    swept: the angle by which the arc turns [rad], for an ellipse the range of its parameter; radius: the greater
    one; tolerance: in the unit of the radius. A cubic over an angle t is off by (2/27) sin(t/4)^6 / cos(t/4)^2 of
    the radius.
    """
    count = max(1, math.ceil(swept / (math.pi / 2) - 1e-9))
    radius = min(radius, 1e15 * tolerance)  # a double has no more digits
    while radius * 2 / 27 * math.sin(swept / count / 4) ** 6 > tolerance * math.cos(swept / count / 4) ** 2:
        count += 1
    return count
