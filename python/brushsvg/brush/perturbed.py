"""A brush whose law is another, for who asks what a change of it does."""

from __future__ import annotations

import numpy as np

from .. import _core
from .confidence import LAWS


def with_lag(brush, change: np.ndarray):
    """The brush with other coefficients of the lag: fit to be simulated, nothing else."""
    other = _core.Brush()
    for name in ("name", "kind", "depth_range_mm", *LAWS, "footprints", "max_speed_mm_s", "paint_depth_mm"):
        setattr(other, name, getattr(brush, name))
    law = brush.lag
    other.lag = _core.Profile(
        (np.array(law.coefficients) + change).tolist(), floor=law.floor, floor_slope=law.floor_slope
    )
    return other
