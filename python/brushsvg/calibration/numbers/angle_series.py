"""A series of angles to a lag and a tip gap, and how much both scatter for one radian in every angle."""

from __future__ import annotations

import math

import numpy as np

from ... import _core
from ...errors import Error
from . import plausibility
from .measurements import Row

GREATEST_ALPHA0_RAD = math.radians(95.0)
STEP_RAD = 1e-7  # of the differences by which an angle's influence is found


def read_series(row: Row, total: bool) -> dict:
    """Lag and tip gap of one series by Theorems 3 and 4; Error for angles that no drag shows."""
    series = [row.numbers[name] for name in ("alpha0_deg", "s_mm", "alpha_deg")]
    plausibility.refuse_series(row.where, *series)
    try:
        found = _core.from_angles(*_radians(row), lines=_lines(total))
    except Error as refusal:
        raise Error(str(refusal), row.where, refusal.value, code=refusal.code) from None
    plausibility.refuse_other_start(row.where, *series)
    return found


def scatter_of_series(row: Row, lag_mm: float, tip_gap_mm: float, total: bool) -> tuple[float, float]:
    """Standard deviations of the lag and the tip gap [mm] of a series whose angles all scatter by one radian.

    To first order, at the angles that a brush of this lag and tip gap shows after the distances of the series: at its
    own readings, a value that noise made too small would get too much weight. The tip gap is nan without beta.
    """
    alpha0, s, alpha, beta = _radians(row)
    alpha0 = min(alpha0, GREATEST_ALPHA0_RAD - STEP_RAD)  # or a step would leave what can be read
    used = [k for k in range(len(s)) if s[k] > 0 and 0 < alpha[k] < alpha0]
    s = np.array(s)[used]
    # no angle is closer to where it could not be read, to 0 or to 180 degrees, than those that were read
    alphas = _within(_core.lag.alpha_after(alpha0, s / lag_mm), np.array(alpha)[used], alpha0)
    shown = [alpha0, *alphas]
    if beta:
        directions = _core.lag.tip_direction(alpha0, alphas, s, lag_mm, max(tip_gap_mm, 0.0))
        shown += [*_within(directions, np.array(beta)[used], math.pi)]

    def lengths(angles) -> np.ndarray:
        first, alphas, betas = angles[0], angles[1 : 1 + len(s)], angles[1 + len(s) :]
        found = _core.from_angles(first, s, alphas, betas, _lines(total))
        return np.array([found["lag_mm"], found["tip_gap_mm"]])

    squares = np.zeros(2)
    for k in range(len(shown)):
        more, less = np.array(shown), np.array(shown)
        more[k] += STEP_RAD
        less[k] -= STEP_RAD
        squares += ((lengths(more) - lengths(less)) / (2 * STEP_RAD)) ** 2
    lag, tip_gap = np.sqrt(squares).tolist()
    return lag, tip_gap


def _within(angles: np.ndarray, read: np.ndarray, most: float) -> np.ndarray:
    """The angles, none outside of those that were read, nor at an end of (0, most)."""
    return np.clip(angles, max(read.min(), 2 * STEP_RAD), min(read.max(), most - 2 * STEP_RAD))


def _radians(row: Row) -> tuple[float, list[float], list[float], list[float]]:
    """alpha0, s [mm], alpha and beta of a row."""
    degree = math.radians(1.0)
    return (
        row.numbers["alpha0_deg"] * degree,
        list(row.numbers["s_mm"]),
        [angle * degree for angle in row.numbers["alpha_deg"]],
        [angle * degree for angle in row.numbers["beta_deg"]],
    )


def _lines(total: bool) -> _core.Lines:
    return _core.Lines.total if total else _core.Lines.plain
