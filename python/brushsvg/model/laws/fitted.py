"""Laws of depth through measured values, fitted as in sections 3.2 and 3.3."""

from __future__ import annotations

import math
from numbers import Integral

from numpy.typing import ArrayLike

from ... import _core
from ...errors import Error, need_number, need_truth, require_type
from .numbers import DEEPEST_MM, FARTHEST_MM, numbers


def fit_law(
    depth_mm: ArrayLike,
    value_mm: ArrayLike,
    degree: int,
    *,
    through_zero: bool = False,
    floor_mm: float | None = None,
    absolute: bool = False,
) -> _core.LawFit:
    """Fit a polynomial of the depth to measured values.

    This fits (25) with degree 4, (24) with degree 3 and floor 0, and (26) with degree 1 through zero.

    depth_mm, value_mm: (n,), in [0, 1000] and [-1e6, 1e6]; n is at least the number of coefficients. degree: of
    the polynomial. through_zero: no constant term. floor_mm: the law is never less; None where there is no floor.
    absolute: least absolute residuals, which outliers move less (section 3.3), otherwise least squares. Returns a
    LawFit: law (a Profile with half_interval_95 and rmse_mm), covariance, residual_mm, r_squared,
    degrees_of_freedom, held. If n is the number of coefficients, half_interval_95 and covariance are empty, and rmse_mm
    is None.

    Raises Error for other numbers and for values that leave the law undetermined.
    """
    need_fits()
    depth = numbers(depth_mm, "the depth [mm]", 0.0, DEEPEST_MM)
    value = numbers(value_mm, "the value [mm]", -FARTHEST_MM, FARTHEST_MM)
    if depth.ndim != 1 or value.ndim != 1:
        raise Error("depths and values must be lists of numbers", code="wrong-type")
    require_type(degree, Integral, "a degree")
    need_truth(through_zero, "through_zero")
    need_truth(absolute, "absolute")
    shape = _core.LawShape(
        (float(depth.min(initial=0.0)), float(depth.max(initial=1.0))),
        int(max(-1, min(degree, 99))),
        through_zero=bool(through_zero),
        floor=-math.inf if floor_mm is None else need_number(floor_mm, "the floor [mm]", -FARTHEST_MM, FARTHEST_MM),
        norm=_core.Norm.absolute if absolute else _core.Norm.squares,
    )
    return _core.fit_law(depth, value, shape)


def need_fits() -> None:
    """Raise Error if the library was built without Ceres."""
    if not hasattr(_core, "fit_law"):
        raise Error("this brushsvg was built without fits; build it with Ceres (libceres-dev)", code="package-missing")
