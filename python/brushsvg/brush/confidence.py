"""Confidence in a law at a depth: the 95 % band of its polynomial, from the covariance of a brush."""

from __future__ import annotations

import itertools

import numpy as np

from .. import _core

LAWS = ("lag", "tip_gap", "tip_to_widest", "half_width")


def places(brush) -> dict[str, slice]:
    """Where each law's coefficients lie among the rows of the covariance."""
    ends = np.cumsum([0, *(len(getattr(brush, law).coefficients) for law in LAWS)]).tolist()
    return {law: slice(*pair) for law, pair in zip(LAWS, itertools.pairwise(ends), strict=True)}


def half_interval_mm(covariance: np.ndarray, depths: np.ndarray, freedom: float | None) -> np.ndarray:
    """t sqrt(x^T C x), x the powers of depth, C (n, n) the covariance of a law's coefficients, found from so many
    values to spare, t what 95 % of Student's t lie within; None: nobody knows from how many, t as for a normal value.
    """
    powers = np.vander(depths, len(covariance), increasing=True)
    squared = np.einsum("ij,jk,ik->i", powers, covariance, powers)
    return _core.deviations_of_95(freedom) * np.sqrt(np.maximum(squared, 0.0))


def law_band(brush, name: str, depths: np.ndarray) -> tuple[np.ndarray, str] | None:
    """Half height [mm] of a law's band at depths, and what it is; None where nothing is known.

    From the covariance; else the RMSE. The intervals of single coefficients make no band: these depend on each other.
    """
    law, place = getattr(brush, name), places(brush)[name]
    if len(brush.covariance):
        block = np.array(brush.covariance)[place, place]
        if np.any(block):
            return half_interval_mm(
                block, depths, law.degrees_of_freedom
            ), "half the 95 % confidence interval of the law"
    if law.rmse_mm is not None:
        return np.full_like(depths, law.rmse_mm), "RMSE of the data, not of the law"
    return None


def paint_interval_per_m(paint) -> float:
    """Half of the 95 % interval of how a mark narrows from dip to dip; of paint that has a covariance."""
    return _core.deviations_of_95(paint.degrees_of_freedom) * float(np.sqrt(paint.covariance[0][0]))


def unseen_mm(brush, depth_mm: float) -> float:
    """What a tracking error adds to that of the brush's lag by 3 %, as errors add in squares: a quarter of what
    law_band says of it. 0 where nothing is known."""
    known = law_band(brush, "lag", np.array([depth_mm]))
    return 0.0 if known is None else 0.25 * float(known[0][0])
