"""Painted marks that are not where or what all others say: something is on them, or they are of something else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

OUTLYING = 4.7  # standard deviations beyond which a point of an outline is masked by the fit
# A displacement of so many standard deviations of the others' is none of theirs: one good mark in 10^7
FARTHEST, LEAST_SPREAD_MM = 6.0, 0.1
# An outline that is so many times further off than usual, at so large a part of it, is not paint of this stroke alone
UNLIKE, LEAST_USUAL_MM, UNLIKE_PART = 4.0, 0.04, 0.03
MOST = 0.2  # share of all marks: more, and it is the sheet


@dataclass(frozen=True)
class Stray:
    """A mark, its displacement from where the others say, in their standard deviations (spread_mm); the residual of its
    outline then (rms), and the usual one."""

    mark: object
    displacement_mm: tuple[float, float]
    spread_mm: float
    rms_mm: float
    usual_rms_mm: float

    @property
    def is_displaced(self) -> bool:
        return float(np.hypot(*self.displacement_mm)) > FARTHEST * self.spread_mm


def strays(marks: list, fit) -> list[Stray]:
    """Each mark is held against the median of the others, in 1.4826 median absolute deviations: those far off
    have no say in it."""
    if len(marks) < 5:
        return []
    displaced = np.array([residual.displacement_mm for residual in fit.marks])
    rms = np.array([residual.rms_mm for residual in fit.marks])
    out = []
    for k, (mark, residual) in enumerate(zip(marks, fit.marks, strict=True)):
        others = np.delete(displaced, k, axis=0)
        middle = np.median(others, axis=0)
        spread = max(1.4826 * float(np.median(np.abs(others - middle))), LEAST_SPREAD_MM)
        usual = max(float(np.median(np.delete(rms, k))), LEAST_USUAL_MM)
        off = tuple((displaced[k] - middle).tolist())
        part = float(np.mean(np.abs(residual.distance_mm) > OUTLYING * fit.noise_mm))
        found = Stray(mark, off, spread, residual.rms_mm, usual)
        if found.is_displaced or (residual.rms_mm > UNLIKE * usual and part > UNLIKE_PART):
            out.append(found)
    return out
