"""Cubic Bezier curves: points on them, the box round them, chords along them, their parts."""

from __future__ import annotations

import numpy as np


def at(t, p0, p1, p2, p3):
    """Where curves of these points are at t; arrays that broadcast together."""
    u = 1 - t
    return u**3 * p0 + 3 * t * u**2 * p1 + 3 * t**2 * u * p2 + t**3 * p3


def extremes(cubics: np.ndarray) -> np.ndarray:
    """Points that bound cubics (n, 4, 2): their ends, and where x or y turns back."""
    p = np.moveaxis(cubics, 1, 0)
    a, b, c = p[3] - p[0] + 3 * (p[1] - p[2]), 2 * (p[0] - 2 * p[1] + p[2]), p[1] - p[0]
    # a t^2 + b t + c = 0 by the form of the roots that is exact where a is small, too
    with np.errstate(all="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(b * b - 4 * a * c), b))
        t = np.stack((q / a, c / q))
    t = np.where((t > 0) & (t < 1), t, 0.0)
    return np.concatenate((cubics[:, 0], cubics[:, 3], at(t, *p).reshape(-1, 2)))


def flattened(cubics: np.ndarray, tolerance: float) -> np.ndarray:
    """Points (k, 2) of cubics (n, 4, 2), nowhere further from them than the tolerance: the chord of 1/n of a cubic
    is off by |B''| / 8 n^2 at most."""
    second = 6 * np.abs(np.diff(cubics, n=2, axis=1)).max(axis=1)
    bend = np.hypot(second[:, 0], second[:, 1])
    counts = np.clip(np.ceil(np.sqrt(bend / (8 * tolerance))), 1, 1000).astype(int)
    which = np.repeat(np.arange(len(cubics)), counts)
    first = np.cumsum(counts) - counts
    t = ((np.arange(len(which)) - first[which] + 1) / counts[which])[:, None]
    return np.vstack([cubics[:1, 0], at(t, *(cubics[which, k] for k in range(4)))])


def split(cubic: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    """A cubic (4, 2) up to t and from there on."""
    left, right = [], []
    while len(cubic):
        left.append(cubic[0])
        right.append(cubic[-1])
        cubic = (1 - t) * cubic[:-1] + t * cubic[1:]
    return np.array(left), np.array(right[::-1])


def between(cubics: np.ndarray, begin: tuple[int, float], end: tuple[int, float]) -> np.ndarray:
    """The part of joined cubics (n, 4, 2) between two places, each a cubic's number and a parameter in it."""
    (first, t0), (last, t1) = begin, end
    if begin == end:
        return np.repeat(split(cubics[first], t0)[0][None, 3:], 4, axis=1)
    if first == last:
        return split(split(cubics[last], t1)[0], t0 / t1)[1][None]
    head = [split(cubics[first], t0)[1][None]] if t0 < 1 else []
    tail = [split(cubics[last], t1)[0][None]] if t1 > 0 else []
    return np.concatenate([*head, cubics[first + 1 : last], *tail])
