"""Test whether a sheet of painted marks has the size of its plan.

If it has not, outer marks are displaced more.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error

MIN_MARKS = 8  # with fewer marks the scatter of the displacements is unknown
MIN_SIGNIFICANT_SIGMAS = 4.0  # standard deviations of a normal value that hardly occur by chance
# Relative error of the scale that is accepted. A scan is as accurate; lag and width are then wrong by this share at
# most.
MAX_SCALE_ERROR = 0.003
REMEDY = (
    "For a printed page, measure its bar and give the length (--bar MM). For a scan, check its resolution in dpi. If "
    "both are right, the machine moves too far or too little: add --machine axes"
)


@dataclass(frozen=True)
class SheetScale:
    """The share by which marks are further apart than planned.

    x, y, both: (share, standard error) along x, along y and for both. freedom: degrees of freedom.
    """

    x: tuple[float, float]
    y: tuple[float, float]
    both: tuple[float, float]
    freedom: int

    def is_off(self, share: tuple[float, float]) -> bool:
        size, error = abs(share[0]), max(share[1], 1e-12)
        return size > MAX_SCALE_ERROR and _core.normal_equivalent(size / error, self.freedom) > MIN_SIGNIFICANT_SIGMAS

    def describe(self, share: tuple[float, float]) -> str:
        """Return a phrase with a share and its 95 % interval."""
        size = "larger" if share[0] >= 0 else "smaller"
        half = _core.interval_factor_95(self.freedom) * share[1]
        return f"{100 * abs(share[0]):.2f} +- {100 * half:.2f} % {size}"


def fit_sheet_scale(middles_mm: np.ndarray, displacements_mm: np.ndarray) -> SheetScale | None:
    """Fit the scale of a sheet to the displacements of its marks.

    middles_mm, displacements_mm: planned positions and displacements, both (n, 2).

    dx and dy are fitted by least squares to 1, x and y, so that a turn of the sheet has no effect. Return None if the
    scale cannot be determined.
    """
    n = len(middles_mm)
    centred = middles_mm - middles_mm.mean(axis=0)
    columns = np.column_stack([np.ones(n), centred])
    if n < MIN_MARKS or np.linalg.matrix_rank(columns, tol=1.0) < 3:
        return None
    slopes = np.linalg.lstsq(columns, displacements_mm, rcond=None)[0]
    freedom = 2 * (n - 3)
    residuals = displacements_mm - columns @ slopes
    covariance = np.linalg.inv(columns.T @ columns) * np.sum(residuals**2) / freedom
    x, y = slopes[1, 0], slopes[2, 1]
    return SheetScale(
        (x, math.sqrt(covariance[1, 1])),
        (y, math.sqrt(covariance[2, 2])),
        ((x + y) / 2, math.sqrt(covariance[1, 1] + covariance[2, 2]) / 2),
        freedom,
    )


def refuse_scale(scale: SheetScale | None) -> None:
    """Raise Error if the sheet has not the size of its plan.

    Lag and width would be wrong by a similar share.
    """
    if scale is None:
        return
    difference = (scale.x[0] - scale.y[0], math.hypot(scale.x[1], scale.y[1]))
    if scale.is_off(difference):
        raise Error(
            f"the sheet is {scale.describe(scale.x)} than the plan in x and {scale.describe(scale.y)} in y. {REMEDY}",
            "marks",
            code="marks-scaled",
        )
    if scale.is_off(scale.both):
        sentence = f"the sheet is {scale.describe(scale.both)} than the plan. {REMEDY}"
        raise Error(sentence, "marks", code="marks-scaled")
