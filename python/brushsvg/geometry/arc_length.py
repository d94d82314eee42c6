"""Arc length of cubics, and parameters at arc lengths."""

from __future__ import annotations

import numpy as np

_GAUSS_NODES, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(8)
# Parts of each cubic: 64 nodes give 1e-9 of the length where no handle turns back.
_PARTS_PER_CUBIC = 8


def _measure_speed(cubics: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return |dB/dt|, (n, m), of cubics (n, 4, 2) at t, (m,) or (n, m)."""
    d = 3 * np.diff(cubics, axis=1)[:, None]
    t = np.broadcast_to(t, (len(cubics), t.shape[-1]))[..., None]
    velocity = (1 - t) ** 2 * d[:, :, 0] + 2 * t * (1 - t) * d[:, :, 1] + t**2 * d[:, :, 2]
    return np.hypot(velocity[..., 0], velocity[..., 1])


def _integrate_length(cubics: np.ndarray, t0: np.ndarray, t1: np.ndarray) -> np.ndarray:
    """Return the length of each cubic between two parameters, (n,), by a Gauss rule."""
    half = 0.5 * (t1 - t0)[:, None]
    return half[:, 0] * (_measure_speed(cubics, t0[:, None] + half * (1 + _GAUSS_NODES)) @ _GAUSS_WEIGHTS)


def knots(cubics: np.ndarray) -> np.ndarray:
    """Return arc lengths [mm] at equally spaced parameters, (n, parts + 1).

    They are measured from the start of each of the cubics (n, 4, 2).
    """
    half = 0.5 / _PARTS_PER_CUBIC
    t = np.arange(_PARTS_PER_CUBIC)[:, None] / _PARTS_PER_CUBIC + half * (1 + _GAUSS_NODES)
    parts = half * (_measure_speed(cubics, t.ravel()).reshape(-1, *t.shape) @ _GAUSS_WEIGHTS)
    return np.column_stack([np.zeros(len(cubics)), np.cumsum(parts, axis=1)])


def parameters_at(cubics: np.ndarray, known: np.ndarray, at_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return cubic numbers and parameters in them at distances along a line.

    cubics: (n, 4, 2); known: knots(cubics); at_mm: (k,), the distances.
    """
    ends = np.cumsum(known[:, -1])
    k = np.minimum(np.searchsorted(ends, at_mm), len(cubics) - 1)
    cubics, known = cubics[k], known[k]
    rest = np.clip(at_mm - (ends[k] - known[:, -1]), 0.0, known[:, -1])
    part = np.minimum((known[:, 1:-1] <= rest[:, None]).sum(axis=1), _PARTS_PER_CUBIC - 1)
    each = np.arange(len(k))
    before, length = known[each, part], known[each, part + 1] - known[each, part]
    begin = part / _PARTS_PER_CUBIC
    low, high = begin, (part + 1) / _PARTS_PER_CUBIC
    with np.errstate(all="ignore"):
        t = np.where(length > 0, low + (high - low) * (rest - before) / length, low)
        for _ in range(60):  # Newton's method, kept inside the bracket
            off = before + _integrate_length(cubics, begin, t) - rest
            if (np.abs(off) <= 1e-12 * (1.0 + known[:, -1])).all():
                break
            low, high = np.where(off < 0, t, low), np.where(off < 0, high, t)
            step = t - off / _measure_speed(cubics, t[:, None])[:, 0]
            t = np.where((step > low) & (step < high), step, 0.5 * (low + high))
    return k, t
