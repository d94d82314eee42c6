"""Rough outlines, as of scans: the mean edge counts, not the largest disc that fits between dents."""

import numpy as np
import pytest

from brushsvg import _core
from brushsvg.geometry.polylines import evenly
from brushsvg.strokes.skeleton import outline_strokes
from brushsvg.strokes.skeleton.mean_outline import mean_outline, roughness_mm

HALF_MM = 2.5


def outline(*cubics, half=HALF_MM):
    """Rings of lines of one width."""
    rings = []
    for cubic in cubics:
        line = _core.Stroke(middle_mm=np.array([cubic], float).reshape(-1, 8), half_width=[(0.0, half)])
        rings += _core.wanted_outline(line, 0.005)
    return _core.unite(rings)


S = outline((0, 0, 20, 30, 40, -30, 60, 0))
CROSS = outline((0, 0, 10, 1, 20, -1, 30, 0), (15, -15, 16, -5, 14, 5, 15, 15))


def roughened(rings, sigma_mm, seed):
    """Each place moved across the outline, about a quarter of a millimetre from the next."""
    noise, made = np.random.default_rng(seed), []
    for ring in rings:
        closed = np.vstack([ring, ring[:1]])
        places = evenly(closed, int(np.hypot(*np.diff(closed, axis=0).T).sum() / 0.25))[:-1]
        along = np.roll(places, -1, axis=0) - np.roll(places, 1, axis=0)
        across = along[:, ::-1] * (-1, 1) / np.hypot(*along.T)[:, None]
        made.append(places + noise.normal(0, sigma_mm, len(places))[:, None] * across)
    return _core.unite(made)


def mean_half_mm(strokes):
    """By length."""
    rows = [
        _core.flatten(_core.Stroke(middle_mm=each.middle_mm, half_width=each.half_width)) for each in strokes
    ]
    return np.average(
        np.concatenate([row[1:, 3] for row in rows]),
        weights=np.concatenate([np.diff(row[:, 2]) for row in rows]),
    )


@pytest.mark.parametrize("shape", [S, CROSS], ids=["s", "cross"])
@pytest.mark.parametrize("sigma_mm", [0.05, 0.1, 0.2])
def test_a_rough_shape_becomes_the_strokes_of_the_smooth_one(shape, sigma_mm):
    smooth, rough = outline_strokes(shape), outline_strokes(roughened(shape, sigma_mm, 4))
    assert len(rough) == len(smooth)
    assert mean_half_mm(rough) == pytest.approx(mean_half_mm(smooth), abs=0.1)


@pytest.mark.parametrize("sigma_mm", [0.05, 0.1, 0.2])
def test_noise_is_measured(sigma_mm):
    """Straight between places of the noise, so less of it is seen between them."""
    assert 0.5 * sigma_mm < roughness_mm(roughened(S, sigma_mm, 5)) < 1.1 * sigma_mm


def test_what_was_drawn_smoothly_is_left_as_it_is():
    square = [np.array([(0, 0), (30, 0), (30, 30), (0, 30)], float)]
    for shape in (S, CROSS, square, outline((0, 0, 1, 0, 2, 0, 3, 0))):
        assert mean_outline(shape) is shape


def test_corners_lose_no_more_than_the_gaussian():
    square = roughened([np.array([(0, 0), (30, 0), (30, 30), (0, 30)], float)], 0.1, 6)
    (ring,) = mean_outline(square)
    corner_mm = min(np.hypot(*(ring - (30, 30)).T))
    assert 0.05 < corner_mm < 0.8
    assert _core.area([ring]) == pytest.approx(900, abs=4)
