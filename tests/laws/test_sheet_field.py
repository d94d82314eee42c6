"""Displacements by the order of painting: planted fields come back at strokes that were not taught."""

import numpy as np
import pytest
from scipy.stats import multivariate_t

from brushsvg.calibration.overlap import sheet_field as fields
from brushsvg.calibration.overlap.sheet_field import sheet_field

ALL = np.arange(240)
NOISE_MM = 0.6


def planted(columns, rows, order):
    """2 mm from the first to the last row and 1 mm from the middle column to those at the sides."""
    column, row = order % columns, order // columns % rows
    bent = 2 * column / (columns - 1) - 1
    return np.column_stack([bent**2 - 0.4, 1 - 2 * row / (rows - 1)])


@pytest.mark.parametrize("columns, rows", [(5, 6), (7, 5)])
def test_odd_strokes_are_where_even_ones_predict(columns, rows):
    truth, rng = planted(columns, rows, ALL), np.random.default_rng(columns)
    found = sheet_field(ALL[::2], truth[::2] + rng.normal(0, NOISE_MM, (120, 2)))
    reported = found.at(ALL[1::2])
    left = truth[1::2] - truth.mean(axis=0) - reported
    assert found.probability > 0.99
    # ten numbers of 120 strokes: a least squares fit of the true layout is off by this
    assert left.std() < 1.5 * NOISE_MM * np.sqrt(10 / 120)


def test_sheets_that_were_laid_anew():
    order, rng = np.arange(0, 150, 2), np.random.default_rng(1)
    truth = planted(5, 3, np.arange(150)) + rng.normal(0, 1.5, (10, 2))[np.arange(150) // 15]
    reported = sheet_field(order, truth[::2] + rng.normal(0, 0.3, (75, 2))).at(order + 1)
    before, left = truth[1::2] - truth[1::2].mean(axis=0), truth[1::2] - truth[::2].mean(axis=0) - reported
    assert (left**2).sum() < 0.25 * (before**2).sum()


@pytest.mark.thorough
def test_displacements_by_chance_have_no_field():
    probabilities, sizes = [], []
    for seed in range(20):
        moved = np.random.default_rng(seed).normal(0, 1.0, (120, 2))
        found = sheet_field(ALL[::2], moved)
        probabilities.append(found.probability)
        sizes.append(found.at(ALL[1::2]).std())
    assert np.mean(probabilities) < 0.5  # what it is beforehand
    assert np.mean(sizes) < 0.1


def test_a_stroke_far_off_moves_no_others():
    truth, rng = planted(5, 6, ALL), np.random.default_rng(3)
    moved = truth[::2] + rng.normal(0, 0.3, (120, 2))
    far = moved.copy()
    far[7] = (60.0, -80.0)
    assert sheet_field(ALL[::2], far).at(ALL) == pytest.approx(sheet_field(ALL[::2], moved).at(ALL), abs=0.15)


def test_too_few_strokes_show_nothing():
    found = sheet_field([0, 2, 4], [[0.0, 1.0], [2.0, 0.0], [3.0, 1.0]])
    assert found.probability == 0
    assert not found.at([1, 3]).any()


def test_evidence_is_that_of_a_multivariate_t():
    rng = np.random.default_rng(5)
    basis, values = rng.normal(size=(30, 4)), rng.normal(size=30)
    scale, shape = 0.7, fields.SHAPE

    def by_scipy(variances):
        spread = np.eye(30) + (basis * variances) @ basis.T
        rate = shape / 2 * scale
        return multivariate_t(np.zeros(30), rate / shape * spread, df=2 * shape).logpdf(values)

    one, other = np.array([1.0, 0.5, 4.0, 0.0]), np.array([0.2, 0.0, 9.0, 1.0])
    ours = [fields._regressed(basis, values, each, scale)[0] for each in (one, other)]
    assert ours[0] - ours[1] == pytest.approx(by_scipy(one) - by_scipy(other), rel=1e-9)


def test_coefficients_are_those_of_ridge_regression():
    rng = np.random.default_rng(6)
    basis, values, variances = rng.normal(size=(30, 3)), rng.normal(size=30), np.array([2.0, 0.5, 7.0])
    ridge = np.linalg.solve(basis.T @ basis + np.diag(1 / variances), basis.T @ values)
    assert fields._regressed(basis, values, variances, 1.0)[1] == pytest.approx(ridge, rel=1e-9)
