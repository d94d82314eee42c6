"""Rotation of points in the plane."""

from __future__ import annotations

import numpy as np


def rotation(turn_rad: float) -> np.ndarray:
    """Return the matrix (2, 2) of a rotation by turn_rad.

    Points (n, 2) times the matrix are turned counter-clockwise about the origin.
    """
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    return np.array([[c, s], [-s, c]])


def angle_between(one: np.ndarray, other: np.ndarray) -> float:
    """Return the angle between two vectors (2,), in [0, pi] rad."""
    return abs(float(np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other)))
