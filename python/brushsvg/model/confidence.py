"""Confidence in a law at a depth: the 95 % band of its polynomial, from the covariance of a brush."""

from __future__ import annotations

import itertools
import json

import numpy as np

from .. import _core

LEARNED = "learned"  # in a brush file: the brushes before, of what photographs, and how deep their marks were
LAWS = ("lag", "tip_gap", "tip_to_widest", "half_width")


def places(brush) -> dict[str, slice]:
    """Return the rows of the covariance that hold each law's coefficients."""
    ends = np.cumsum([0, *(len(getattr(brush, law).coefficients) for law in LAWS)]).tolist()
    return {law: slice(*pair) for law, pair in zip(LAWS, itertools.pairwise(ends), strict=True)}


def half_interval_mm(covariance: np.ndarray, depths: np.ndarray, freedom: float | None) -> np.ndarray:
    """t sqrt(x^T C x), x the powers of depth, C (n, n) the covariance of a law's coefficients, found from so many
    values to spare, t the 95 % quantile of Student's t; None: nobody knows from how many, t as for a normal value.
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


def learned_of(brush) -> dict:
    """What a brush file says of what it was made from; {} where it says nothing."""
    said = json.loads(brush.extra or "{}").get(LEARNED)
    return said if isinstance(said, dict) else {}


def fitted_down_to_mm(brush, law: str) -> float:
    """The depth down to which a law was fitted to marks or measurements; 0 for one that was typed or assumed. Fits
    leave a covariance. A brush that learned from marks keeps the depths that were typed before as its range, and
    says itself how deep the marks were."""
    place = places(brush)[law]
    if not len(brush.covariance) or not np.any(np.array(brush.covariance)[place, place]):
        return 0.0
    of_laws = learned_of(brush).get("deepest_mm")
    if isinstance(of_laws, dict) and isinstance(deepest_mm := of_laws.get(law), int | float):
        return float(deepest_mm)
    return (getattr(brush, law).calibrated_mm or (0.0, np.inf))[1]


def paint_interval_per_m(paint) -> float:
    """Half of the 95 % interval of how a mark narrows from dip to dip; of paint that has a covariance."""
    return _core.deviations_of_95(paint.degrees_of_freedom) * float(np.sqrt(paint.covariance[0][0]))


def unseen_mm(brush, depth_mm: float) -> float:
    """What a tracking error adds to that of the brush's lag by 3 %, as errors add in squares: a quarter of what
    law_band says of it. 0 where nothing is known."""
    known = law_band(brush, "lag", np.array([depth_mm]))
    return 0.0 if known is None else 0.25 * float(known[0][0])
