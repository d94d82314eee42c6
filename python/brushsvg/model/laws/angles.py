"""Laws of angles: Theorem 2 on the tip; Theorems 3 and 4 on lag and tip gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ... import _core
from ...array_values import ArrayValue
from ...errors import Error, need_truth
from .fitted import need_fits
from .numbers import FARTHEST_MM, frozen, numbers, together

MAX_ANGLE_RAD = 2 * np.pi


def tip_direction(
    alpha0_rad: ArrayLike, alpha1_rad: ArrayLike, s_mm: ArrayLike, lag_mm: ArrayLike, tip_gap_mm: ArrayLike
) -> np.ndarray:
    """Return beta, from the direction of motion to the tip's displacement.

    This is (11) and (12), at one depth:

        beta = atan2(D (sin(alpha0) - sin(alpha1)), s - D (cos(alpha1) - cos(alpha0))),   D = r + b

    alpha0_rad, alpha1_rad, s_mm, lag_mm, tip_gap_mm: (...), the angle before, in [0, pi / 2], the angle after, in
    [0, pi / 2], the way between them, in [0, 1e6], the lag and the tip gap, in [0, 5e5]. Returns beta [rad], (...).
    Beyond 90 degrees the patch rests at first and Theorem 2 does not hold. The proof drops the tip's first place
    between two lines; (11) is right again.

    Raises Error for numbers outside of these ranges and shapes that do not broadcast.
    """
    right = np.pi / 2 + 1e-12
    given = together(
        numbers(alpha0_rad, "alpha0 [rad]", 0.0, right),
        numbers(alpha1_rad, "alpha1 [rad]", 0.0, right),
        numbers(s_mm, "the way s [mm]", 0.0, FARTHEST_MM),
        numbers(lag_mm, "the lag [mm]", 0.0, FARTHEST_MM / 2),
        numbers(tip_gap_mm, "the tip gap [mm]", 0.0, FARTHEST_MM / 2),
    )
    return _core.lag.tip_direction(*given)


@dataclass(frozen=True, eq=False, repr=False)
class FromAngles(ArrayValue):
    """Lag and tip gap of each series [mm], (...), with the RMSE of their lines.

    Both are slopes of these lines. The arrays are read-only. tip_gap_mm, tip_gap_rmse_mm: nan without beta.
    left_out: readings without a logarithm, alpha not in (0, alpha0).
    """

    lag_mm: np.ndarray
    lag_rmse_mm: np.ndarray
    tip_gap_mm: np.ndarray
    tip_gap_rmse_mm: np.ndarray
    left_out: np.ndarray


def from_angles(
    alpha0_rad: ArrayLike,
    s_mm: ArrayLike,
    alpha_rad: ArrayLike,
    beta_rad: ArrayLike | None = None,
    *,
    total: bool = False,
) -> FromAngles:
    """Return lag and tip gap from series of angles, Theorems 3 and 4, (19) to (23).

        r = -F^+ s,   F_i = log cot(alpha0 / 2) - log cot(alpha_i / 2)
        b = (mu - 1) r,   mu = I^+ s
        I_i = r (cos(alpha_i) - cos(alpha0)) + r (sin(alpha0) - sin(alpha_i)) cot(beta_i)

    alpha0_rad: (...), one for each series, in (0, 95 degrees]. s_mm, alpha_rad, beta_rad: (..., n), the ways since
    alpha0 and the angles after them; beta_rad may be None. total: both sides count as measured (total least
    squares), where the article takes F and I as exact. Exact angles give exact results; with one
    degree of noise r is 9.24 +- 0.45 instead of 9.3.

    Raises Error for numbers outside of these ranges, series without a usable reading and shapes that do not
    broadcast.
    """
    need_fits()
    need_truth(total, "total")
    alpha0 = numbers(alpha0_rad, "alpha0 [rad]", 0.0, np.radians(95.0) + 1e-9)
    rows = [
        numbers(s_mm, "the way s [mm]", 0.0, FARTHEST_MM),
        numbers(alpha_rad, "alpha [rad]", -MAX_ANGLE_RAD, MAX_ANGLE_RAD),
    ]
    if beta_rad is not None:
        rows.append(numbers(beta_rad, "beta [rad]", -MAX_ANGLE_RAD, MAX_ANGLE_RAD))
    alpha0, *rows = together(alpha0[..., None], *rows)
    if alpha0.size == 0:
        raise Error("there is no reading", code="measurement-missing")
    line_kind = _core.Lines.total if total else _core.Lines.plain
    results = [
        _core.from_angles(alpha0[at][0], *(row[at] for row in rows), lines=line_kind)
        for at in np.ndindex(alpha0.shape[:-1])
    ]
    names = FromAngles.__dataclass_fields__
    return FromAngles(*(frozen(np.reshape([result[name] for result in results], alpha0.shape[:-1])) for name in names))
