"""Read lag and tip gap from a series of angles.

The effect of noise of the angles on both lengths is estimated as well.
"""

from __future__ import annotations

import math

import numpy as np

from ... import _core
from ...errors import Error
from . import plausibility
from .measurements import Row

MAX_ALPHA0_RAD = math.radians(95.0)
DERIVATIVE_STEP_RAD = 1e-7  # step of the numerical derivatives with respect to the angles


def read_series(row: Row, total: bool) -> dict:
    """Read lag and tip gap from one series by Theorems 3 and 4.

    total: use total least squares. Raises Error for angles that no drag shows.
    """
    series = [row.numbers[name] for name in ("alpha0_deg", "s_mm", "alpha_deg")]
    plausibility.refuse_series(row.where, *series)
    try:
        lengths = _core.from_angles(*_series_in_radians(row), lines=_line_fit(total))
    except Error as refusal:
        raise Error(str(refusal), row.where, refusal.value, code=refusal.code) from None
    plausibility.refuse_displaced_start(row.where, *series)
    return lengths


def scatter_of_series(row: Row, lag_mm: float, tip_gap_mm: float, total: bool) -> tuple[float, float]:
    """Return the standard deviations of lag and tip gap [mm] of a series.

    All angles of the series scatter by one radian.

    The standard deviations are of first order. They are taken at the angles that a brush with this lag and tip gap
    shows after the distances of the series. At the readings themselves, a value that noise made too small would get
    too much weight. The second value is nan if the series has no beta.
    """
    alpha0, s, alpha, beta = _series_in_radians(row)
    alpha0 = min(alpha0, MAX_ALPHA0_RAD - DERIVATIVE_STEP_RAD)  # a step must stay in the range that can be read
    usable = [k for k in range(len(s)) if s[k] > 0 and 0 < alpha[k] < alpha0]
    s = np.array(s)[usable]
    # No angle is closer to 0 or 180 degrees, where it could not be read, than the angles that were read.
    alphas = _clip_to_readings(_core.lag.alpha_after(alpha0, s / lag_mm), np.array(alpha)[usable], alpha0)
    predicted = [alpha0, *alphas]
    if beta:
        directions = _core.lag.tip_direction(alpha0, alphas, s, lag_mm, max(tip_gap_mm, 0.0))
        predicted += [*_clip_to_readings(directions, np.array(beta)[usable], math.pi)]

    def lengths(angles) -> np.ndarray:
        first, alphas, betas = angles[0], angles[1 : 1 + len(s)], angles[1 + len(s) :]
        series = _core.from_angles(first, s, alphas, betas, _line_fit(total))
        return np.array([series["lag_mm"], series["tip_gap_mm"]])

    squares = np.zeros(2)
    for k in range(len(predicted)):
        more, less = np.array(predicted), np.array(predicted)
        more[k] += DERIVATIVE_STEP_RAD
        less[k] -= DERIVATIVE_STEP_RAD
        squares += ((lengths(more) - lengths(less)) / (2 * DERIVATIVE_STEP_RAD)) ** 2
    lag, tip_gap = np.sqrt(squares).tolist()
    return lag, tip_gap


def _clip_to_readings(angles: np.ndarray, read: np.ndarray, most: float) -> np.ndarray:
    """Clip the angles to the range of the angles that were read, and inside (0, most)."""
    return np.clip(angles, max(read.min(), 2 * DERIVATIVE_STEP_RAD), min(read.max(), most - 2 * DERIVATIVE_STEP_RAD))


def _series_in_radians(row: Row) -> tuple[float, list[float], list[float], list[float]]:
    """Return alpha0, s [mm], alpha and beta of a row, angles in radians."""
    degree = math.radians(1.0)
    return (
        row.numbers["alpha0_deg"] * degree,
        list(row.numbers["s_mm"]),
        [angle * degree for angle in row.numbers["alpha_deg"]],
        [angle * degree for angle in row.numbers["beta_deg"]],
    )


def _line_fit(total: bool) -> _core.Lines:
    return _core.Lines.total if total else _core.Lines.plain
