"""Confidence in a law at a depth.

The 95 % band of the law's polynomial follows from the covariance of the brush.
"""

from __future__ import annotations

import itertools

import numpy as np

from .. import _core
from .extra_keys import read_extra_keys

# Key of a brush file: the earlier brushes, the photographs they learned from, and how deep their marks were.
LEARNED = "learned"
LAWS = ("lag", "tip_gap", "tip_to_widest", "half_width")


def places(brush) -> dict[str, slice]:
    """Return the rows of the covariance that hold each law's coefficients."""
    ends = np.cumsum([0, *(len(getattr(brush, law).coefficients) for law in LAWS)]).tolist()
    return {law: slice(*pair) for law, pair in zip(LAWS, itertools.pairwise(ends), strict=True)}


def half_interval_mm(covariance: np.ndarray, depths: np.ndarray, freedom: float | None) -> np.ndarray:
    """Return half of the 95 % interval of a law at depths, t sqrt(x^T C x) [mm].

    covariance: C, (n, n), of the law's coefficients; depths: (k,) [mm], whose powers are x; freedom: degrees of
    freedom of the fit, for the 95 % quantile t of Student's t. None stands for an unknown number, with t as for a
    normal value.
    """
    powers = np.vander(depths, len(covariance), increasing=True)
    squared = np.einsum("ij,jk,ik->i", powers, covariance, powers)
    return _core.interval_factor_95(freedom) * np.sqrt(np.maximum(squared, 0.0))


def law_band(brush, name: str, depths: np.ndarray) -> tuple[np.ndarray, str] | None:
    """Return half the height [mm] of a law's band at depths, and its meaning.

    It follows from the covariance, or otherwise from the RMSE. Returns None where both are unknown. The intervals of
    single coefficients give no band, because the coefficients depend on each other.
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


def learned_of(brush) -> dict:
    """Return the entry `learned` of a brush file, or {} if it has none."""
    learned = read_extra_keys(brush.extra).get(LEARNED)
    return learned if isinstance(learned, dict) else {}


def fitted_down_to_mm(brush, law: str) -> float:
    """Return the depth down to which a law was fitted to marks or measurements.

    Returns 0 for a law that was typed or assumed, because only fits have a covariance. A brush that learned from marks
    keeps its earlier depth range. Its file has the greatest depth of the marks.
    """
    place = places(brush)[law]
    if not len(brush.covariance) or not np.any(np.array(brush.covariance)[place, place]):
        return 0.0
    of_laws = learned_of(brush).get("deepest_mm")
    if isinstance(of_laws, dict) and isinstance(deepest_mm := of_laws.get(law), int | float):
        return float(deepest_mm)
    return (getattr(brush, law).calibrated_mm or (0.0, np.inf))[1]


def paint_interval_per_m(paint) -> float:
    """Return half of the 95 % interval of how a mark narrows from dip to dip. paint: has a covariance."""
    return _core.interval_factor_95(paint.degrees_of_freedom) * float(np.sqrt(paint.covariance[0][0]))


def unseen_mm(brush, depth_mm: float) -> float:
    """Return the tracking error that adds 3 % to the error of the brush's lag.

    Errors add in squares, so it is a quarter of the band of law_band. Returns 0 where nothing is known.
    """
    known = law_band(brush, "lag", np.array([depth_mm]))
    return 0.0 if known is None else 0.25 * float(known[0][0])
