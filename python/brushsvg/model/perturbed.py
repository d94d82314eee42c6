"""Brushes with changed laws, to measure the effect of a change."""

from __future__ import annotations

import numpy as np

from .. import _core
from .confidence import LAWS


def changed_lag(brush, change: np.ndarray):
    """Return a brush's lag with other coefficients. change: (n,), added to the coefficients."""
    law = brush.lag
    return _core.Profile((np.array(law.coefficients) + change).tolist(), floor=law.floor, floor_slope=law.floor_slope)


def with_lag(brush, change: np.ndarray):
    """Return the brush with other coefficients of the lag.

    The result can be simulated and is good for nothing else.
    """
    changed = _core.Brush()
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
        setattr(changed, name, getattr(brush, name))
    changed.lag = changed_lag(brush, change)
    return changed


def with_factors(brush, factors: dict[str, tuple[float, ...]]):
    """Return the brush with laws multiplied by polynomials of depth.

    factors: for each law the coefficients of its polynomial, ascending. The result can only be simulated. With the
    half width, its footprints become larger by the same factor, like those of a brush with more bristles.
    """
    changed = with_lag(brush, np.zeros(len(brush.lag.coefficients)))
    if "half_width" in factors:
        factors = factors | {"tip_to_widest": factors["half_width"]}
    for name, factor in factors.items():
        law = getattr(brush, name)
        coefficients = np.convolve(law.coefficients, factor).tolist()
        changed_law = _core.Profile(coefficients, floor=law.floor * factor[0], floor_slope=law.floor_slope * factor[0])
        setattr(changed, name, changed_law)
    if "half_width" in factors:
        changed.footprints = _core.FootprintTable(
            dragged=[_scale_footprint(footprint, factors["half_width"]) for footprint in brush.footprints.dragged],
            pressed=[_scale_footprint(footprint, factors["half_width"]) for footprint in brush.footprints.pressed],
        )
    return changed


def _scale_footprint(footprint, factor):
    times = np.polynomial.polynomial.polyval(footprint.depth_mm, factor)
    return _core.Footprint(footprint.depth_mm, np.array(footprint.outline_mm) * times)
