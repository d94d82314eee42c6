"""Test whether a sheet of painted marks has the size of its plan: outer marks are then displaced more."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error

LEAST_MARKS = 8  # of fewer the scatter of the displacements is not known
CERTAIN = 4.0  # standard deviations of a normal value that do not come about by chance
LEAST_SCALE = 0.003  # a scan is as good; lag and width are then off by as much at most
REMEDY = (
    "For a printed page, measure its bar and give the length (--bar MM). For a scan, check its resolution in dpi. If "
    "both are right, the machine moves too far or too little: add --machine axes"
)


@dataclass(frozen=True)
class SheetScale:
    """The share by which marks are further apart than planned, in x, in y and on the whole, each (share, standard
    error), with so many degrees of freedom."""

    x: tuple[float, float]
    y: tuple[float, float]
    both: tuple[float, float]
    freedom: int

    def is_off(self, share: tuple[float, float]) -> bool:
        size, error = abs(share[0]), max(share[1], 1e-12)
        return size > LEAST_SCALE and _core.as_normal(size / error, self.freedom) > CERTAIN

    def describe(self, share: tuple[float, float]) -> str:
        """A share with its 95 % interval."""
        size = "larger" if share[0] >= 0 else "smaller"
        half = _core.deviations_of_95(self.freedom) * share[1]
        return f"{100 * abs(share[0]):.2f} +- {100 * half:.2f} % {size}"


def sheet_scale(middles_mm: np.ndarray, displacements_mm: np.ndarray) -> SheetScale | None:
    """Fit the scale to planned places and displacements, both (n, 2). None: it cannot be determined.

    Least squares of dx and of dy over 1, x and y, so that a turn of the sheet does not count.
    """
    n = len(middles_mm)
    out = middles_mm - middles_mm.mean(axis=0)
    over = np.column_stack([np.ones(n), out])
    if n < LEAST_MARKS or np.linalg.matrix_rank(over, tol=1.0) < 3:
        return None
    slopes = np.linalg.lstsq(over, displacements_mm, rcond=None)[0]
    freedom = 2 * (n - 3)
    left = displacements_mm - over @ slopes
    inverse = np.linalg.inv(over.T @ over) * np.sum(left**2) / freedom
    x, y = slopes[1, 0], slopes[2, 1]
    return SheetScale(
        (x, math.sqrt(inverse[1, 1])),
        (y, math.sqrt(inverse[2, 2])),
        ((x + y) / 2, math.sqrt(inverse[1, 1] + inverse[2, 2]) / 2),
        freedom,
    )


def refuse_scale(scale: SheetScale | None) -> None:
    """Error where the sheet is not as large as its plan: lag and width would be off by more than the same share."""
    if scale is None:
        return
    apart = (scale.x[0] - scale.y[0], math.hypot(scale.x[1], scale.y[1]))
    if scale.is_off(apart):
        raise Error(
            f"the sheet is {scale.describe(scale.x)} than the plan in x and {scale.describe(scale.y)} in y. {REMEDY}",
            "marks",
            code="marks-scaled",
        )
    if scale.is_off(scale.both):
        raise Error(
            f"the sheet is {scale.describe(scale.both)} than the plan. {REMEDY}",
            "marks",
            code="marks-scaled",
        )
