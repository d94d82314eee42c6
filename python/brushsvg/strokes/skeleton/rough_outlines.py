"""Smooth outlines that are rough all along, as scans and traced bitmaps are.

The largest disc between two rough edges touches their dents. A line would become too thin, and deep dents would become
branches. The mean edge gives the line's width instead.

An outline turns one way, then the other. A bump is the part between two such changes, from the middle of one edge to
the middle of another. A clean letter has about 30 bumps, and most of them are as high as its lines are wide. A rough
outline has hundreds of low ones. Each bump counts by how far it turns: long straight edges have no weight.
"""

from __future__ import annotations

import numpy as np

from ... import _core
from ...geometry.polylines import evenly, length
from ...geometry.rings import signed_area

# Fewer bumps are a drawing: an ampersand with serifs has 34. With more, rough letters below 5 mm stay as they are.
MIN_BUMPS = 40
# Lower bumps do not count. Curves are flattened to 0.02 mm, and no brush shows as little. With less, a clean outline of
# many points is rough where its coordinates are rounded; with more, pixels of 0.1 mm stay.
RIPPLE_MM = 0.02
# The share of all turning that must be in low bumps. With half of it, serifs and their brackets count as rough; with
# three quarters, waves of 1 mm stay, because a letter's own corners have nearly a quarter.
MIN_LOW_SHARE = 2 / 3
# Greatest height of a low bump. Higher bumps belong to the drawing: steps of 2 mm are 0.7 mm high. Noise of 0.3 mm
# (standard deviation) makes bumps of 0.5 mm.
MAX_BUMP_MM = 0.6
# The same limit in mean half widths of the shape. Clean letters of any size have at least 1.2; noise of 0.3 mm on a
# letter of 30 mm has up to 0.4.
MAX_BUMP_HALF_WIDTHS = 0.5
# Teeth of a gear and points of a star are alike; noise is not. Where this share of all bumps has one height (within
# 3 %), they were drawn. Noise has up to 0.07; stars and gears with straight flanks have 0.5.
MIN_ALIKE_SHARE, MAX_ALIKE_DIFFERENCE = 0.2, 0.03
# Steps of a bitmap's pixels are alike too. They run in two directions only, for all but a thousandth of the outline,
# and are up to half a pixel high. A larger MAX_STEP_MM smooths drawn steps that a brush can paint; with a smaller one,
# pixels of 0.3 mm stay.
MAX_STEP_MM, MIN_RIGHT_ANGLED_SHARE = 0.15, 0.999
# Length of the smoothing (standard deviation along the outline), in roughnesses. With 4, dents become strokes; with 16,
# bowls and corners lose more of a letter's area than noise does.
SMOOTHING_ROUGHNESSES = 8.0
# The longest smoothing, in mm and in mean half widths of the shape: with more, bowls and corners lose more of a
# letter's area than noise does.
MAX_SMOOTHING_MM, MAX_SMOOTHING_HALF_WIDTHS = 2.0, 1.0
# The longest smoothing as a share of a ring's length. With more, a small hole changes its shape; with less, its
# dents stay.
MAX_RING_SHARE = 0.05
# Side of a square, in roughnesses: smaller specks and pinholes are noise. With less, a speck becomes a stroke and a
# pinhole parts a line in two; with more, the dot of a small i is lost.
SPECK_ROUGHNESSES = 2.0
PLACES_PER_SMOOTHING = 4  # places along a ring per smoothing length: fewer show as corners
# Places on all rings of a smoothed shape: about 50 MB, and as many edges as a shape may have.
MAX_PLACES = 200_000


def smooth_rough_outlines(rings: list[np.ndarray]) -> list[np.ndarray]:
    """Return the mean edge of a rough shape; return a clean shape's rings themselves.

    rings: (n, 2) [mm], as _core.fill returns them.
    """
    roughness_mm, half_width_mm = measure_roughness_mm(rings)
    if roughness_mm == 0.0:
        return rings
    most_mm = min(SMOOTHING_ROUGHNESSES * roughness_mm, MAX_SMOOTHING_HALF_WIDTHS * half_width_mm, MAX_SMOOTHING_MM)
    speck_mm2 = (SPECK_ROUGHNESSES * roughness_mm) ** 2
    lines = [np.vstack([ring, ring[:1]]) for ring in rings if abs(signed_area(ring)) > speck_mm2]
    lengths_mm = np.array([length(line) for line in lines])
    smoothing_mm = np.minimum(most_mm, MAX_RING_SHARE * lengths_mm)
    counts = (PLACES_PER_SMOOTHING * lengths_mm / smoothing_mm).astype(int)
    if counts.sum() > MAX_PLACES:
        return rings
    return _core.unite([_smooth(*each) for each in zip(lines, counts, smoothing_mm, strict=True)])


def measure_roughness_mm(rings: list[np.ndarray]) -> tuple[float, float]:
    """Measure the roughness of an outline, and the mean half width of its shape.

    The roughness is the height [mm] that two thirds of a rough outline's bumps have at most. Both are 0 for a clean
    outline.
    """
    drawn = _find_bumps(rings)
    bumps = drawn and _find_bumps(_without_ripples(rings))
    if not drawn or not bumps:
        return 0.0, 0.0
    heights, turns, length_mm = bumps
    order = np.argsort(heights)
    turned = np.cumsum(turns[order])
    low_mm = float(heights[order][np.searchsorted(turned, MIN_LOW_SHARE * turned[-1])])
    half_width_mm = _core.area(rings) / length_mm
    if low_mm > min(MAX_BUMP_MM, MAX_BUMP_HALF_WIDTHS * half_width_mm):
        return 0.0, 0.0
    is_bitmap = low_mm <= MAX_STEP_MM and _is_right_angled(rings)
    if not is_bitmap and (_are_alike(drawn[0]) or _are_alike(heights)):
        return 0.0, 0.0
    return low_mm, half_width_mm


def _without_ripples(rings: list[np.ndarray]) -> list[np.ndarray]:
    """Return rings with the fewest points that stay within RIPPLE_MM of all points.

    A straight line of many points, rounded to 0.01 mm, changes its direction everywhere.
    """
    import shapely

    fewer = shapely.simplify([shapely.LinearRing(ring) for ring in rings], RIPPLE_MM, preserve_topology=False)
    return [points for line in fewer if len(points := shapely.get_coordinates(line)[:-1]) >= 3]


def _are_alike(heights: np.ndarray) -> bool:
    """Return whether many bumps have the same height."""
    heights = np.sort(heights)
    counts = np.searchsorted(heights, heights * (1 + MAX_ALIKE_DIFFERENCE), "right") - np.arange(len(heights))
    return bool(counts.max() > MIN_ALIKE_SHARE * len(heights))


def _is_right_angled(rings: list[np.ndarray]) -> bool:
    """Return whether all edges run in two directions at right angles. Four times their angles are then the same."""
    step = np.vstack([np.roll(ring, -1, axis=0) - ring for ring in rings])
    lengths_mm = np.hypot(*step.T)
    fourfold = np.exp(4j * np.arctan2(step[:, 1], step[:, 0]))
    return bool(abs(lengths_mm @ fourfold) > MIN_RIGHT_ANGLED_SHARE * lengths_mm.sum())


def _find_bumps(rings: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Return the heights [mm] and turns [rad] of all bumps, and a length [mm].

    The length is that of the line through the ends of the bumps. A ring without a bump counts as one of infinite
    height. Returns None if there are too few bumps.
    """
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
    # Whether the edge after that changes the direction of turning.
    changes = cross * cross[after] < 0.0
    if np.count_nonzero(changes) < MIN_BUMPS:
        return None
    turn = np.arctan2(cross, x * x_after + y * y_after)
    heights: list[np.ndarray] = []
    turns: list[np.ndarray] = []
    length_mm = 0.0
    for first, count in zip(firsts.tolist(), counts.tolist(), strict=True):
        ring_slice = slice(first, first + count)
        ends = np.flatnonzero(changes[ring_slice]) + 1
        ring, turned = np.roll(points[ring_slice], -1, axis=0), turn[ring_slice]
        if len(ends) < 2:
            heights.append(np.array([np.inf]))
            turns.append(np.abs(turned).sum(keepdims=True))
            length_mm += float(np.hypot(*step[ring_slice].T).sum())
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


def _smooth(line: np.ndarray, count: int, smoothing_mm: float) -> np.ndarray:
    """Average places of a closed line along it.

    count: number of places. The gain is exp(-q) (1 + q) with q = (2 pi f s)^2 / 2, s the smoothing length, f waves
    per mm. It leaves long waves as they are to the second order. A Gaussian alone, exp(-q), makes bowls smaller.
    """
    q = 2 * (np.pi * np.fft.rfftfreq(count, length(line) / count) * smoothing_mm) ** 2
    gain = (np.exp(-q) * (1 + q))[:, None]
    return np.fft.irfft(np.fft.rfft(evenly(line, count + 1)[:-1], axis=0) * gain, n=count, axis=0)
