"""Lengths of polylines, and even places on them."""

from __future__ import annotations

import numpy as np


def steps(points: np.ndarray) -> np.ndarray:
    """Return the length from each point (n, 2) or (n, 3) to the next one, (n - 1,)."""
    step = np.diff(points, axis=0)
    return np.hypot(*step.T) if step.shape[1] == 2 else np.linalg.norm(step, axis=1)


def lengths(points: np.ndarray) -> np.ndarray:
    """Return the length of the way from the first point to each, (n,), from 0."""
    return np.concatenate([[0.0], np.cumsum(steps(points))])


def length(points: np.ndarray) -> float:
    return float(steps(points).sum())


def evenly(points: np.ndarray, count: int) -> np.ndarray:
    """Return places (count, d) that part a polyline into equal lengths. points: (n, d), the polyline."""
    at = lengths(points)
    places = np.linspace(0.0, at[-1], count)
    return np.column_stack([np.interp(places, at, column) for column in points.T])
