"""The displacements of its marks show whether a sheet has the size of its plan."""

import re

import numpy as np
import pytest
from diagnostics import refused

from brushsvg.calibration.marks.sheet_scale import fit_sheet_scale, refuse_scale
from brushsvg.errors import Error

A5 = np.array([[x, y] for y in (25.0, 75.0, 125.0, 175.0) for x in (20.0, 50.0, 80.0, 110.0)])


def off(middles, seed, sigma_mm=0.5, by=(1.0, 1.0), turn=0.0):
    """Return the displacements of marks on a stretched, shifted and turned sheet.

    Each mark is also displaced at random.
    """
    c, s = np.cos(turn), np.sin(turn)
    out = middles - middles.mean(axis=0)
    there = (out * by) @ np.array([[c, s], [-s, c]])
    return there - out + [1.0, -2.0] + np.random.default_rng(seed).normal(0, sigma_mm, out.shape)


def is_refused(middles, displacements):
    try:
        refuse_scale(fit_sheet_scale(middles, displacements))
    except Error:
        return True
    return False


@pytest.mark.parametrize(
    ("by", "expected"),
    [
        ((0.97, 0.97), "smaller"),
        ((1.02, 1.02), "larger"),
        ((1.03, 1.0), "larger 'plan in x'"),
        ((1.0, 0.97), "smaller"),
    ],
)
def test_a_sheet_of_another_scale_is_refused(by, expected):
    found = fit_sheet_scale(A5, off(A5, 1, 0.3, by))
    with refused(f"marks-scaled {expected} --bar", "marks"):
        refuse_scale(found)
    for (share, error), true in zip((found.x, found.y), by, strict=True):
        assert abs(share - (true - 1)) < 3 * error < 0.01


def test_the_scale_error_is_reported_with_its_uncertainty():
    scatter = np.random.default_rng(0).normal(0, 0.05, A5.shape)
    with refused("marks-scaled smaller") as caught:
        refuse_scale(fit_sheet_scale(A5, -0.03 * A5 + scatter))
    assert re.search(r" 3\.0\d \+- 0\.0\d % smaller", caught.value.sentence)


@pytest.mark.parametrize("count", [8, 12, 16])
def test_displacements_alone_are_not_a_scale_error(count):
    rng = np.random.default_rng(count)
    wrong = 0
    for seed in range(400):
        middles = A5[rng.permutation(len(A5))[:count]]
        wrong += is_refused(middles, off(middles, seed, rng.uniform(0.5, 1.0), turn=0.02))
    assert wrong <= 1


def test_an_undetermined_scale_is_accepted():
    shift = off(A5, 3, 0.5, (0.9, 0.9))
    assert fit_sheet_scale(A5[:7], shift[:7]) is None, "too few to know the scatter"
    row = np.column_stack([np.linspace(0, 200, 12), np.full(12, 40.0)])
    assert fit_sheet_scale(row, np.zeros((12, 2))) is None, "all in one row"
    refuse_scale(None)


def test_a_sheet_as_exact_as_a_scan_is_accepted():
    """A sheet as exact as a scan is accepted.

    Without noise, any difference of scale is significant. The test allows the scale error of a scan.
    """
    assert not is_refused(A5, 0.002 * (A5 - A5.mean(axis=0)))
    assert is_refused(A5, 0.004 * (A5 - A5.mean(axis=0)))
