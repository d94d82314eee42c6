"""Arc length of cubics, and back from length to parameter."""

from __future__ import annotations

import numpy as np

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_PARTS = 8  # of each cubic: 64 nodes give 1e-9 of the length where no handle turns back


def _speed(cubics: np.ndarray, t: np.ndarray) -> np.ndarray:
    """|dB/dt| of cubics (n, 4, 2) at t, (m,) or (n, m): (n, m)."""
    d = 3 * np.diff(cubics, axis=1)[:, None]
    t = np.broadcast_to(t, (len(cubics), t.shape[-1]))[..., None]
    velocity = (1 - t) ** 2 * d[:, :, 0] + 2 * t * (1 - t) * d[:, :, 1] + t**2 * d[:, :, 2]
    return np.hypot(velocity[..., 0], velocity[..., 1])


def _between(cubics: np.ndarray, t0: np.ndarray, t1: np.ndarray) -> np.ndarray:
    """Length of each cubic between its two parameters, (n,): by one Gauss rule."""
    half = 0.5 * (t1 - t0)[:, None]
    return half[:, 0] * (_speed(cubics, t0[:, None] + half * (1 + _NODES)) @ _WEIGHTS)


def knots(cubics: np.ndarray) -> np.ndarray:
    """Arc length [mm] from the start of each of the cubics (n, 4, 2) to equally spaced parameters: (n, parts + 1)."""
    half = 0.5 / _PARTS
    t = np.arange(_PARTS)[:, None] / _PARTS + half * (1 + _NODES)
    parts = half * (_speed(cubics, t.ravel()).reshape(-1, *t.shape) @ _WEIGHTS)
    return np.column_stack([np.zeros(len(cubics)), np.cumsum(parts, axis=1)])


def parameters_at(cubics: np.ndarray, known: np.ndarray, at_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cubic numbers and parameters in them at distances along the line; known: knots(cubics)."""
    ends = np.cumsum(known[:, -1])
    k = np.minimum(np.searchsorted(ends, at_mm), len(cubics) - 1)
    cubics, known = cubics[k], known[k]
    rest = np.clip(at_mm - (ends[k] - known[:, -1]), 0.0, known[:, -1])
    part = np.minimum((known[:, 1:-1] <= rest[:, None]).sum(axis=1), _PARTS - 1)
    each = np.arange(len(k))
    before, length = known[each, part], known[each, part + 1] - known[each, part]
    begin = part / _PARTS
    low, high = begin, (part + 1) / _PARTS
    with np.errstate(all="ignore"):
        t = np.where(length > 0, low + (high - low) * (rest - before) / length, low)
        for _ in range(60):  # Newton, kept inside the bracket
            off = before + _between(cubics, begin, t) - rest
            if (np.abs(off) <= 1e-12 * (1.0 + known[:, -1])).all():
                break
            low, high = np.where(off < 0, t, low), np.where(off < 0, high, t)
            step = t - off / _speed(cubics, t[:, None])[:, 0]
            t = np.where((step > low) & (step < high), step, 0.5 * (low + high))
    return k, t
