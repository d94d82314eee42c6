"""Student's t."""

from __future__ import annotations

import numpy as np


def as_normal(t, freedom: float):
    """The size of a normal value that is as unlikely as t with so many degrees of freedom: D. L. Wallace 1959."""
    stretch = (8 * freedom + 1) / (8 * freedom + 3)
    return stretch * np.sqrt(freedom * np.log1p(np.square(t) / freedom))
