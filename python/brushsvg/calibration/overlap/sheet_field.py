"""Displacement of marks by their place on the sheet: the disagreement of a robot and a camera that were calibrated to
each other.

A smooth field, polynomials of row and column and a displacement of each sheet, found from the marks' own displacements
by Bayesian linear regression. Where only the order is known in which strokes were painted, it is that of rows of as
many columns on sheets of as many rows: how many of each is not picked but averaged over, by their evidence, and that
there is no field at all counts as much as all layouts together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legvander

COLUMNS, ROWS, FEWEST = range(1, 13), range(2, 13), 6  # that a sheet may have; strokes of the smallest sheet
DEGREE = 3
DEGREES = np.array([(i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i) if i + j])
# Standard deviations beforehand, as shares of the single marks': of what is linear, by how much those of each degree
# more are smaller, of a sheet; of the mean of all
SIZES, FALLS, SHEETS, MEAN = (0.5, 1.0, 2.0), (0.2, 0.6), (0.0, 0.7), 10.0
OUTLYING = 3.0  # robust standard deviations beyond which a displacement counts as this far
LEAST_MM = 0.2  # standard deviation of single marks: below, pixels show no more
SHAPE = 2.0  # of the inverse gamma distribution of the single marks' variance
LEAST_WEIGHT = 1e-4


@dataclass(frozen=True)
class Layout:
    """Strokes go along a row of so many columns, then to the next of so many rows, then to the next sheet."""

    columns: int
    rows: int

    def basis(self, order: np.ndarray, count: int) -> np.ndarray:
        """Values (n, terms) of the mean, the polynomials, and each sheet that `count` strokes take."""
        column, row = order % self.columns, order // self.columns % self.rows
        across = legvander(_from_middle(column, self.columns), DEGREE)
        down = legvander(_from_middle(row, self.rows), DEGREE)
        sheets = np.arange(-(-count // self.strokes))
        return np.column_stack(
            [
                np.ones(len(order)),
                across[:, DEGREES[:, 0]] * down[:, DEGREES[:, 1]],
                (order // self.strokes)[:, None] == sheets,
            ]
        )

    @property
    def strokes(self) -> int:
        return self.columns * self.rows

    def variances(self, size: float, fall: float, sheet: float, terms: int) -> np.ndarray:
        """Beforehand, in variances of single marks."""
        is_free = (DEGREES[:, 0] < self.columns) & (DEGREES[:, 1] < self.rows)
        field = np.where(is_free, (size * fall ** (DEGREES.sum(axis=1) - 1.0)) ** 2, 0.0)
        return np.concatenate([[MEAN**2], field, np.full(terms - 1 - len(field), sheet**2)])


@dataclass(frozen=True, eq=False)
class SheetField:
    """Displacements by the order of painting, of `count` strokes. layouts: each with its probability and coefficients
    (terms, 2) [mm]; what is missing to 1 is that there is no field."""

    count: int
    layouts: tuple[tuple[Layout, float, np.ndarray], ...]

    def at(self, order) -> np.ndarray:
        """Expected displacements (n, 2) [mm] of the strokes with these numbers, the first being 0, less the mean."""
        out = np.zeros((len(order), 2))
        for layout, weight, coefficients in self.layouts:
            out += weight * (layout.basis(np.asarray(order), self.count) @ coefficients)
        return out

    @property
    def probability(self) -> float:
        return sum(weight for _, weight, _ in self.layouts)


def sheet_field(order, displacements_mm) -> SheetField:
    """order: as which the strokes with these displacements (n, 2) were painted, of all that were, the first 0 (n,)."""
    order, moved = np.asarray(order), _held(np.asarray(displacements_mm, float))
    count, moved = int(order.max()) + 1, moved - moved.mean(axis=0)
    scale = np.maximum(LEAST_MM, moved.std(axis=0)) ** 2
    layouts = [Layout(c, r) for c in COLUMNS for r in ROWS if FEWEST <= c * r <= count]
    if not layouts or len(moved) < FEWEST:
        return SheetField(count, ())
    nothing, mean = np.ones((len(moved), 1)), np.array([MEAN**2])
    none = sum(_regressed(nothing, one, mean, v)[0] for one, v in zip(moved.T, scale, strict=True))
    found = [_of_layout(layout.basis(order, count), moved, scale, layout) for layout in layouts]
    evidence = np.array([none, *(each[0] for each in found)])
    weights = np.exp(evidence - evidence.max()) / np.array([1.0, *np.full(len(found), len(found))])
    weights /= weights.sum()
    return SheetField(
        count,
        tuple(
            (layout, float(weight), coefficients)
            for layout, weight, (_, coefficients) in zip(layouts, weights[1:], found, strict=True)
            if weight > LEAST_WEIGHT
        ),
    )


def _of_layout(basis, moved, scale, layout: Layout) -> tuple[float, np.ndarray]:
    """Logarithm of the evidence, and coefficients (terms, 2): for each axis the mean over sizes beforehand, of which
    half of the probability is that this axis has no field."""
    sizes = [(0.0, 1.0, 0.0)] + [(size, fall, sheet) for size in SIZES for fall in FALLS for sheet in SHEETS]
    shares = np.log([0.5, *np.full(len(sizes) - 1, 0.5 / (len(sizes) - 1))])
    total, out = 0.0, []
    for one, variance in zip(moved.T, scale, strict=True):
        each = [_regressed(basis, one, layout.variances(*size, basis.shape[1]), variance) for size in sizes]
        log_weights = np.array([evidence for evidence, _ in each]) + shares
        weights = np.exp(log_weights - log_weights.max())
        total += log_weights.max() + np.log(weights.sum())
        out.append(weights / weights.sum() @ [coefficients for _, coefficients in each])
    return total, np.column_stack(out)


def _regressed(basis, values, variances, scale: float) -> tuple[float, np.ndarray]:
    """Logarithm of the evidence up to a constant, and coefficients: conjugate Bayesian linear regression, variances of
    the coefficients in those of single values, whose own is inverse gamma about `scale` (Bishop, Pattern Recognition
    and Machine Learning, 2006, chapter 3, exercise 3.12)."""
    root = np.sqrt(variances)
    inner = np.eye(len(root)) + root[:, None] * (basis.T @ basis) * root
    lower = np.linalg.cholesky(inner)
    solved = np.linalg.solve(inner, root * (basis.T @ values))
    left = values @ values - values @ basis @ (root * solved)
    rate = SHAPE / 2 * scale
    shape = SHAPE + len(values) / 2
    evidence = SHAPE * np.log(rate) - shape * np.log(rate + left / 2) - np.log(np.diag(lower)).sum()
    return float(evidence), root * solved


def _from_middle(numbers: np.ndarray, count: int) -> np.ndarray:
    """-1 for the first, 1 for the last."""
    return 2 * numbers / max(1, count - 1) - 1.0 if count > 1 else np.zeros(len(numbers))


def _held(moved: np.ndarray) -> np.ndarray:
    middle = np.median(moved, axis=0)
    far = OUTLYING * np.maximum(LEAST_MM, 1.4826 * np.median(abs(moved - middle), axis=0))
    return np.clip(moved, middle - far, middle + far)
