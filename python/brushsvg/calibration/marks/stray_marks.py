"""Find painted marks that are unlike all others.

Something covers them, or they belong to something else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MAX_RESIDUAL_SIGMAS = 4.7  # the fit masks points of an outline beyond this many standard deviations
# A mark is displaced if its displacement exceeds this many standard deviations of the other displacements. One good
# mark in 10^7 does.
MAX_DISPLACEMENT_SIGMAS, MIN_SPREAD_MM = 6.0, 0.1
# An outline is not the paint of its stroke alone if its residual is this many times the usual residual, and if at
# least this share of its points is masked.
MAX_RMS_RATIO, MIN_USUAL_RMS_MM, MAX_MASKED_SHARE = 4.0, 0.04, 0.03
MAX_STRAY_SHARE = 0.2  # share of all marks; if more are strays, the sheet is wrong


@dataclass(frozen=True)
class Stray:
    """A mark that is unlike the others.

    displacement_mm: from the place that the other marks predict. spread_mm: standard deviation of the displacements of
    the others. rms_mm: residual of its outline after the displacement. usual_rms_mm: residual of the other outlines.
    """

    mark: object
    displacement_mm: tuple[float, float]
    spread_mm: float
    rms_mm: float
    usual_rms_mm: float

    @property
    def is_displaced(self) -> bool:
        return float(np.hypot(*self.displacement_mm)) > MAX_DISPLACEMENT_SIGMAS * self.spread_mm


def find_strays(marks: list, fit) -> list[Stray]:
    """Find the marks that are unlike the others.

    Each mark is compared with the median of the others, in units of 1.4826 median absolute deviations, so that marks
    that are far off have no influence.
    """
    if len(marks) < 5:
        return []
    displaced = np.array([residual.displacement_mm for residual in fit.marks])
    rms = np.array([residual.rms_mm for residual in fit.marks])
    found = []
    for k, (mark, residual) in enumerate(zip(marks, fit.marks, strict=True)):
        others = np.delete(displaced, k, axis=0)
        middle = np.median(others, axis=0)
        spread = max(1.4826 * float(np.median(np.abs(others - middle))), MIN_SPREAD_MM)
        usual = max(float(np.median(np.delete(rms, k))), MIN_USUAL_RMS_MM)
        displacement = tuple((displaced[k] - middle).tolist())
        masked_share = float(np.mean(np.abs(residual.distance_mm) > MAX_RESIDUAL_SIGMAS * fit.noise_mm))
        stray = Stray(mark, displacement, spread, residual.rms_mm, usual)
        if stray.is_displaced or (residual.rms_mm > MAX_RMS_RATIO * usual and masked_share > MAX_MASKED_SHARE):
            found.append(stray)
    return found
