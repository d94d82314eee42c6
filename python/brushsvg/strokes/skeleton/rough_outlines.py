"""Smooth outlines that are rough all along, as scans and traced bitmaps are.

The largest disc between two rough edges touches their dents. A line would become too thin, and deep dents would become
branches. The mean edge gives the line's width instead.

An outline bends one way, then the other. A bump is what lies between two such changes, from the middle of one edge to
the middle of another. A clean letter has about 30 bumps, most of them as high as its lines are wide. A rough outline has
hundreds of low ones. Each bump counts by how far it turns, so long straight stems neither hide nor feign roughness.
"""

from __future__ import annotations

import numpy as np

from ... import _core
from ...geometry.polylines import evenly, length
from ...geometry.rings import signed_area

# Fewer bumps are a drawing: an ampersand with serifs has 34. More would leave rough letters below 5 mm as they are.
MIN_BUMPS = 40
# The share of all turning that must be in low bumps. A clean alphabet has up to half of it in serifs and their
# brackets; a letter with waves of 0.2 mm and 1 mm length keeps a quarter for its own corners.
LOW_SHARE = 2 / 3
# What is low. Higher bumps are a drawing's own: steps of 2 mm are 0.7 mm high. Noise of 0.3 mm (standard deviation)
# makes bumps up to 0.5 mm high.
MAX_BUMP_MM = 0.6
MAX_BUMP_HALF_WIDTHS = 0.5  # of the shape's mean half width: with more, an alphabet of 3 mm height is rough
# Teeth of a gear and points of a star are alike; noise is not. Where this share of all bumps has one height (within
# 3 %), they were drawn. Noise has up to 0.07, gears and regular stars have at least 0.5 per kind of bump.
ALIKE_SHARE, ALIKE = 0.2, 0.03
# Steps of a bitmap's pixels are alike too. They run in two directions only, for all but a thousandth of the outline, and
# are up to half a pixel high. A larger MAX_STEP_MM smooths drawn steps that a brush can paint; with a smaller one, pixels
# of 0.3 mm stay.
MAX_STEP_MM, RIGHT_ANGLED = 0.15, 0.999
# Curves are flattened to 0.02 mm, so lower bumps mean nothing, and no brush shows them.
MIN_ROUGHNESS_MM = 0.02
# Length of the smoothing (standard deviation along the outline), in roughnesses. With 4, dents become strokes; with 16,
# bowls and corners lose more of a letter's area than noise does.
SMOOTHING = 8.0
# The longest smoothing, in mm and in mean half widths of the shape: with more, bowls and corners lose more of a letter's
# area than noise does.
MAX_SMOOTHING_MM, MAX_HALF_WIDTHS = 2.0, 1.0
MAX_RING_SHARE = 0.05  # of the smoothing length, of a ring's length: a longer one changes a small hole's shape
# Side of a square, in roughnesses: smaller specks and pinholes are noise. A speck becomes a stroke, and a pinhole parts a
# line in two; more would lose the dot of a small i.
SPECK = 2.0
PLACES_PER_SMOOTHING = 4  # places along a ring per smoothing length: fewer show as corners
ROUNDS = 3  # fine ripples on longer waves: the first round smooths the ripples, the next one the waves
MAX_PLACES = 200_000  # of a smoothed shape; about 50 MB, and as many edges as a shape may have


def smooth_rough_outlines(rings: list[np.ndarray]) -> list[np.ndarray]:
    """Return the mean edge of a rough shape; return a clean shape's rings themselves.

    rings: (n, 2) [mm], as _core.fill returns them.
    """
    for _ in range(ROUNDS):
        roughness_mm, half_width_mm = measure_roughness_mm(rings)
        smoothing_mm = min(
            SMOOTHING * roughness_mm, MAX_HALF_WIDTHS * half_width_mm, MAX_SMOOTHING_MM
        )
        speck_mm2 = (SPECK * roughness_mm) ** 2
        lines = [np.vstack([ring, ring[:1]]) for ring in rings if abs(signed_area(ring)) > speck_mm2]
        if PLACES_PER_SMOOTHING * sum(map(length, lines)) >= MAX_PLACES * smoothing_mm:
            break
        rings = _core.unite([_smooth(line, smoothing_mm) for line in lines])
    return rings


def measure_roughness_mm(rings: list[np.ndarray]) -> tuple[float, float]:
    """Return the height that two thirds of a rough outline's bumps have at most, and the shape's mean half width; zeros
    for a clean outline."""
    bumps = _find_bumps(rings)
    if bumps is None:
        return 0.0, 0.0
    heights, turns, length_mm = bumps
    order = np.argsort(heights)
    turned = np.cumsum(turns[order])
    low_mm = float(heights[order][np.searchsorted(turned, LOW_SHARE * turned[-1])])
    half_width_mm = _core.area(rings) / length_mm
    if not MIN_ROUGHNESS_MM < low_mm < min(MAX_BUMP_MM, MAX_BUMP_HALF_WIDTHS * half_width_mm):
        return 0.0, 0.0
    is_bitmap = low_mm <= MAX_STEP_MM and _is_right_angled(rings)
    return (low_mm, half_width_mm) if is_bitmap or not _are_alike(heights[order]) else (0.0, 0.0)


def _are_alike(heights: np.ndarray) -> bool:
    """Return whether many of these ascending heights are the same."""
    counts = np.searchsorted(heights, heights * (1 + ALIKE), "right") - np.arange(len(heights))
    return bool(counts.max() > ALIKE_SHARE * len(heights))


def _is_right_angled(rings: list[np.ndarray]) -> bool:
    """Return whether all edges run in two directions, at right angles: four times their angles are the same."""
    step = np.vstack([np.roll(ring, -1, axis=0) - ring for ring in rings])
    lengths_mm = np.hypot(*step.T)
    fourfold = np.exp(4j * np.arctan2(step[:, 1], step[:, 0]))
    return bool(abs(lengths_mm @ fourfold) > RIGHT_ANGLED * lengths_mm.sum())


def _find_bumps(rings: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Heights [mm] and turns [rad] of all bumps, and the length [mm] of the line through their ends; None if there are
    too few. A ring without a bump is one, without end of height."""
    counts = np.array([len(ring) for ring in rings])
    if counts.sum() < MIN_BUMPS:
        return None
    points = np.vstack(rings)
    firsts = np.cumsum(counts) - counts
    after = np.arange(1, len(points) + 1)
    after[firsts + counts - 1] = firsts
    step = points[after] - points
    x, y = step.T
    x_after, y_after = step[after].T
    cross = x * y_after - y * x_after  # at the end of each edge
    changes = cross * cross[after] < 0.0  # on the edge after that
    if np.count_nonzero(changes) < MIN_BUMPS:
        return None
    turn = np.arctan2(cross, x * x_after + y * y_after)
    heights, turns, length_mm = [], [], 0.0
    for first, count in zip(firsts.tolist(), counts.tolist(), strict=True):
        own = slice(first, first + count)
        ends = np.flatnonzero(changes[own]) + 1
        ring, turned = np.roll(points[own], -1, axis=0), turn[own]
        if len(ends) < 2:
            heights.append([np.inf])
            turns.append([np.abs(turned).sum()])
            length_mm += float(np.hypot(*step[own].T).sum())
            continue
        ring, turned, starts = np.roll(ring, -ends[0], axis=0), np.roll(turned, -ends[0]), ends - ends[0]
        middles = (ring + np.roll(ring, 1, axis=0))[starts] / 2
        chords = np.roll(middles, -1, axis=0) - middles
        bump = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, count)))
        off, chord = ring - middles[bump], chords[bump]
        chords_mm = np.hypot(*chords.T)
        area = np.abs(chord[:, 0] * off[:, 1] - chord[:, 1] * off[:, 0])
        heights.append(np.maximum.reduceat(area, starts) / np.maximum(chords_mm, 1e-9))
        turns.append(np.abs(np.add.reduceat(turned, starts)))
        length_mm += float(chords_mm.sum())
    return np.concatenate(heights), np.concatenate(turns), length_mm


def _smooth(line: np.ndarray, smoothing_mm: float) -> np.ndarray:
    """Places of a closed line averaged along it.

    Gain exp(-q) (1 + q) with q = (2 pi f s)^2 / 2, s the smoothing length, f waves per mm. To the second order it
    leaves long waves as they are: a Gaussian alone, exp(-q), makes bowls smaller.
    """
    length_mm = length(line)
    smoothing_mm = min(smoothing_mm, MAX_RING_SHARE * length_mm)
    count = int(PLACES_PER_SMOOTHING * length_mm / max(smoothing_mm, 1e-9)) + 1
    q = 2 * (np.pi * np.fft.rfftfreq(count, length_mm / count) * smoothing_mm) ** 2
    gain = (np.exp(-q) * (1 + q))[:, None]
    return np.fft.irfft(np.fft.rfft(evenly(line, count + 1)[:-1], axis=0) * gain, n=count, axis=0)
