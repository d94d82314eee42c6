"""A brush whose law is another, for who asks what a change of it does."""

from __future__ import annotations

import numpy as np

from .. import _core
from .confidence import LAWS


def changed_lag(brush, change: np.ndarray):
    """Its lag with other coefficients."""
    law = brush.lag
    return _core.Profile(
        (np.array(law.coefficients) + change).tolist(), floor=law.floor, floor_slope=law.floor_slope
    )


def with_lag(brush, change: np.ndarray):
    """The brush with other coefficients of the lag: fit to be simulated, nothing else."""
    other = _core.Brush()
    for name in (
        "name",
        "kind",
        "depth_range_mm",
        *LAWS,
        "footprints",
        "paint",
        "max_speed_mm_s",
        "paint_depth_mm",
    ):
        setattr(other, name, getattr(brush, name))
    other.lag = changed_lag(brush, change)
    return other


def with_factors(brush, factors: dict[str, tuple[float, ...]]):
    """The brush with laws times a polynomial of depth, coefficients ascending: fit to be simulated. With the half width
    its footprints become as much larger, as those of a brush with more bristles."""
    other = with_lag(brush, np.zeros(len(brush.lag.coefficients)))
    if "half_width" in factors:
        factors = factors | {"tip_to_widest": factors["half_width"]}
    for name, factor in factors.items():
        law = getattr(brush, name)
        times = np.convolve(law.coefficients, factor).tolist()
        made = _core.Profile(times, floor=law.floor * factor[0], floor_slope=law.floor_slope * factor[0])
        setattr(other, name, made)
    if "half_width" in factors:
        other.footprints = _core.FootprintTable(
            dragged=[_larger(one, factors["half_width"]) for one in brush.footprints.dragged],
            pressed=[_larger(one, factors["half_width"]) for one in brush.footprints.pressed],
        )
    return other


def _larger(footprint, factor):
    times = np.polynomial.polynomial.polyval(footprint.depth_mm, factor)
    return _core.Footprint(footprint.depth_mm, np.array(footprint.outline_mm) * times)
