"""Points turned in the plane."""

from __future__ import annotations

import numpy as np


def rotation(turn_rad: float) -> np.ndarray:
    """(2, 2): points (n, 2) times it are turned counter-clockwise about the origin."""
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    return np.array([[c, s], [-s, c]])
