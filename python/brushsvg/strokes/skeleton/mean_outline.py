"""The mean edge of a rough outline, as a scan or a tracing program draws it.

The largest disc that fits between two rough edges touches their dents, so a line would be too thin, and each dent deep
enough would be a branch. The outline's roughness is measured, and the outline is smoothed by as much.
"""

from __future__ import annotations

import numpy as np

from ... import _core
from ...geometry.polylines import evenly, length

STEP = 0.3  # of a shape's mean half width, from place to place where roughness is measured: dents are shorter
LEAST_PLACES = 12  # on a ring, or it tells nothing
# Standard deviation of the Gaussian along the outline, in those of the roughness: with 3 dents keep branches, and
# with 12 corners become so round that less of a letter is painted. A corner of 90 degrees loses 0.4 of it.
SMOOTHED = 8.0
LEAST_MM = 0.15  # of the Gaussian: outlines flattened to 0.02 mm ask for up to 0.1
MOST = 0.03  # of the Gaussian, of a ring's length: a ring stays what it is
PER_SIGMA = 4  # places per standard deviation of the Gaussian
NORMAL = 1.4826  # standard deviation of normal noise, in medians of its absolute values


def mean_outline(rings: list[np.ndarray]) -> list[np.ndarray]:
    """Rings (n, 2) [mm] of a shape, smoothed by 8 times their roughness; as they are where that is hardly any."""
    sigma_mm = SMOOTHED * roughness_mm(rings)
    if sigma_mm < LEAST_MM:
        return rings
    return _core.unite([_smoothed(_closed(ring), sigma_mm) for ring in rings])


def roughness_mm(rings: list[np.ndarray]) -> float:
    """Standard deviation of the noise across outlines.

    A place lies off the chord of its neighbours by o. On a curve o changes slowly, and at a corner once; white noise of
    deviation s across the outline changes it by sqrt(5) s from place to place. The median leaves corners out.
    """
    lines = [_closed(ring) for ring in rings]
    step_mm = STEP * _core.area(rings) / max(sum(map(length, lines)), 1e-9)
    changes = [
        change
        for line in lines
        if (count := int(length(line) / max(step_mm, 1e-9))) >= LEAST_PLACES
        for change in _changes(evenly(line, count + 1)[:-1])
    ]
    return float(NORMAL * np.median(np.abs(changes)) / np.sqrt(5)) if changes else 0.0


def _changes(places: np.ndarray) -> np.ndarray:
    """Of how far places of a ring lie off the chords of their neighbours, from each to the next [mm]."""
    before, after = np.roll(places, 1, axis=0), np.roll(places, -1, axis=0)
    chord, off = after - before, places - (before + after) / 2
    o = (chord[:, 0] * off[:, 1] - chord[:, 1] * off[:, 0]) / np.maximum(np.hypot(*chord.T), 1e-9)
    return o - np.roll(o, 1)


def _smoothed(line: np.ndarray, sigma_mm: float) -> np.ndarray:
    """The places of a closed line averaged along it by a Gaussian."""
    length_mm = length(line)
    sigma_mm = min(sigma_mm, MOST * length_mm)
    count = max(int(PER_SIGMA * length_mm / max(sigma_mm, 1e-9)), LEAST_PLACES)
    waves = np.fft.rfftfreq(count, length_mm / count)
    gain = np.exp(-2 * (np.pi * waves * sigma_mm) ** 2)[:, None]
    places = evenly(line, count + 1)[:-1]
    return np.fft.irfft(np.fft.rfft(places, axis=0) * gain, n=count, axis=0)


def _closed(ring: np.ndarray) -> np.ndarray:
    return np.vstack([ring, ring[:1]])
