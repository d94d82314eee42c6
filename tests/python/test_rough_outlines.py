"""The strokes of rough outlines follow the mean edge.

Scans and traced bitmaps have rough outlines. Clean outlines stay unchanged.
"""

import tracemalloc

import numpy as np
import pytest
import shapely

from brushsvg import _core
from brushsvg.geometry.polylines import evenly, length
from brushsvg.strokes.skeleton import outline_strokes
from brushsvg.strokes.skeleton.rough_outlines import MAX_PLACES, measure_roughness_mm, smooth_rough_outlines

HALF_MM = 2.2


def drawn(*cubics, half_mm=HALF_MM):
    """Return the outline of lines of one width with round ends.

    Each line is a chain of cubics.
    """
    rings = []
    for cubic in cubics:
        points = np.array(cubic, float).reshape(-1, 2)
        middle = [points[k : k + 4].ravel() for k in range(0, len(points) - 1, 3)]
        line = _core.Stroke(middle_mm=np.array(middle), half_width=[(0.0, half_mm)])
        rings += _core.target_outline(line, 0.005)
    return _core.unite(rings)


LETTERS = {
    "R": drawn(
        (0, 0, 0, 14, 0, 28, 0, 42),
        (0, 40, 8, 40, 24, 42, 24, 31, 24, 20, 8, 21, 0, 21),
        (8, 21, 12, 14, 18, 6, 24, 0),
    ),
    "e": drawn((2, 17, 30, 17, 28, 33, 15, 33, 2, 33, -4, 4, 15, 1, 20, 0, 25, 2, 27, 5)),
    "S": drawn((27, 36, 20, 44, 3, 43, 3, 32, 3, 20, 28, 24, 28, 11, 28, -2, 8, -2, 1, 6)),
    "n": drawn((0, 0, 0, 10, 0, 20, 0, 30), (0, 20, 6, 32, 22, 34, 22, 20, 22, 14, 22, 7, 22, 0)),
}


def roughened(rings, sigma_mm, step_mm, seed=4):
    """Return points at the given spacing, each displaced across the outline by noise.

    The noise has a normal distribution.
    """
    noise, made = np.random.default_rng(seed), []
    for ring in rings:
        closed = np.vstack([ring, ring[:1]])
        places = evenly(closed, int(length(closed) / step_mm))[:-1]
        along = np.roll(places, -1, axis=0) - np.roll(places, 1, axis=0)
        across = along[:, ::-1] * (-1, 1) / np.hypot(*along.T)[:, None]
        made.append(places + noise.normal(0, sigma_mm, len(places))[:, None] * across)
    return _core.fill(made, "nonzero")


def pixels(rings, side_mm):
    """Return the outline of all pixels whose centre is inside the shape."""
    shape = region(rings)
    left, low, right, high = np.array(shape.bounds) + np.array([-1, -1, 1, 1]) * side_mm
    xs, ys = np.meshgrid(np.arange(left, right, side_mm), np.arange(low, high, side_mm))
    inside = shapely.contains_xy(shape, xs + side_mm / 2, ys + side_mm / 2)
    squares = shapely.box(xs[inside], ys[inside], xs[inside] + side_mm, ys[inside] + side_mm)
    whole = shapely.union_all(shapely.set_precision(squares, 1e-6))
    parts = [ring for part in shapely.get_parts(whole) for ring in (part.exterior, *part.interiors)]
    return _core.fill([shapely.get_coordinates(ring)[:-1] for ring in parts], "evenodd")


def region(rings):
    shape = shapely.Polygon()
    for ring in rings:
        shape = shape.symmetric_difference(shapely.Polygon(ring).buffer(0))
    return shape


def overlap(strokes, rings) -> float:
    """Return the intersection over union of the disc paint along strokes and a shape."""
    bare = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width, closed=s.closed) for s in strokes]
    painted = region(_core.unite([ring for each in bare for ring in _core.target_outline(each, 0.01)]))
    shape = region(rings)
    return painted.intersection(shape).area / painted.union(shape).area


ROUGH = {
    "0.1 mm": lambda rings: roughened(rings, 0.1, 0.3),
    "0.2 mm": lambda rings: roughened(rings, 0.2, 0.25),
    "waves of 1 mm": lambda rings: roughened(rings, 0.1, 1.0),
    "pixels of 0.2 mm": lambda rings: pixels(rings, 0.2),
}


@pytest.mark.parametrize("letter", LETTERS)
@pytest.mark.parametrize("kind", ROUGH)
def test_a_rough_letter_has_the_strokes_of_the_clean_one(letter, kind):
    """A rough letter has the strokes of the clean letter.

    An R with noise of 0.2 mm once became 11 strokes instead of 6, with an overlap of 0.87.
    """
    clean = LETTERS[letter]
    expected = outline_strokes(clean)
    found = outline_strokes(ROUGH[kind](clean))
    assert len(found) == len(expected)
    assert overlap(found, clean) > 0.97 * overlap(expected, clean)


def test_noise_of_0_3_mm_does_not_change_the_number_of_strokes():
    for clean in LETTERS.values():
        found = outline_strokes(roughened(clean, 0.3, 0.3))
        assert abs(len(found) - len(outline_strokes(clean))) <= 1
        assert overlap(found, clean) > 0.94


def regular(radius_mm: float, count: int) -> np.ndarray:
    angles = 2 * np.pi * np.arange(count) / count
    return radius_mm * np.column_stack([np.cos(angles), np.sin(angles)])


def star(radius_mm: float, points: int, depth: float) -> np.ndarray:
    return regular(radius_mm, 2 * points) * np.where(np.arange(2 * points) % 2, 1 - depth, 1)[:, None]


def ragged(radius_mm: float, points: int, least_mm: float, most_mm: float) -> np.ndarray:
    """Return the outline of a leaf with irregular teeth."""
    depths = np.random.default_rng(2).uniform(least_mm, most_mm, points) / radius_mm
    return regular(radius_mm, 2 * points) * (1 - np.repeat(depths, 2) * np.tile([0, 1], points))[:, None]


def gear(radius_mm: float, teeth: int) -> np.ndarray:
    """Return the outline of a gear whose teeth have straight flanks, as high as wide."""
    turn = 2 * np.pi / teeth
    at = (np.arange(teeth)[:, None] + [0.0, 0.45, 0.55, 0.95]).ravel() * turn
    radii = np.tile([0, 0, 1, 1], teeth) * radius_mm * turn / 2 + radius_mm
    return radii[:, None] * np.column_stack([np.cos(at), np.sin(at)])


def curved_gear(radius_mm: float, teeth: int) -> np.ndarray:
    """Return a gear with teeth of 20 points each, narrower than their gaps."""
    at = np.arange(20 * teeth) / 20
    wave = np.clip(1.4 * np.sin(2 * np.pi * at) + 0.35 * np.sin(4 * np.pi * at) ** 2, -0.8, 1)
    angles, radii = 2 * np.pi * at / teeth, radius_mm * (1 + 2 * wave / teeth)
    return radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


def stairs(count: int, step_mm: float) -> np.ndarray:
    corners = np.repeat(np.arange(count + 1), 2) * step_mm
    return np.vstack([np.column_stack([corners[1:], corners[:-1]]), [(0, count * step_mm)]])


CLEAN = {
    "nonagon": [regular(20, 9)],
    "star": [star(20, 5, 0.6)],
    "star of 60 points": [star(10, 60, 0.05)],
    "ragged leaf": [ragged(20, 40, 1.5, 4)],
    "leaf of 12 points": [ragged(5, 12, 0.4, 0.8)],
    "burst of thin rays": [ragged(1.2, 25, 0.5, 0.9)],
    "gear": [gear(20, 24)],
    "gear of 60 teeth": [gear(10, 60)],
    "gear of 120 fine teeth": [gear(5, 120)],
    "gear with curved flanks": [curved_gear(10, 60)],
    "stairs": [stairs(30, 2.0)],
    "page of letters": [
        ring + np.array([x, y]) for x in range(0, 200, 40) for y in range(0, 200, 50) for ring in LETTERS["R"]
    ],
    **{f"letter {name}": rings for name, rings in LETTERS.items()},
}


@pytest.mark.parametrize("name", CLEAN)
def test_a_clean_shape_stays_unchanged(name):
    """A clean shape stays unchanged.

    A first attempt mistook the corners of a nonagon and the teeth of a gear for dents.
    """
    rings = _core.fill(CLEAN[name], "nonzero")
    assert smooth_rough_outlines(rings) is rings


@pytest.mark.parametrize("step_mm", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("decimals", [2, 3, 12])
def test_rounded_coordinates_of_many_points_are_not_rough(step_mm, decimals):
    """Many points with rounded coordinates are not a rough outline.

    A straight line of points rounded to 0.01 mm turns left and right along its whole length.
    """
    turned = shapely.transform(region(LETTERS["n"]), lambda xy: xy @ [[0.8, 0.6], [-0.6, 0.8]])
    for shape in (turned, shapely.Polygon([(0, 0), (31, 7), (27, 30), (14, 12), (3, 29)])):
        rings = [shapely.get_coordinates(shapely.segmentize(shape.exterior, step_mm))[:-1].round(decimals)]
        assert smooth_rough_outlines(rings) is rings


@pytest.mark.parametrize("sigma_mm", [0.05, 0.1, 0.2])
def test_measured_roughness_equals_the_noise(sigma_mm):
    assert measure_roughness_mm(roughened(LETTERS["S"], sigma_mm, 0.3))[0] == pytest.approx(sigma_mm, rel=0.35)


@pytest.mark.parametrize("side_mm", [0.1, 0.3])
def test_the_roughness_of_a_pixel_outline_is_half_a_pixel(side_mm):
    """The roughness of a pixel outline is half a pixel.

    The steps are as regular as the teeth of a gear.
    """
    rough_mm, half_width_mm = measure_roughness_mm(pixels(LETTERS["S"], side_mm))
    assert 0.4 * side_mm < rough_mm <= 0.5 * side_mm
    assert half_width_mm == pytest.approx(HALF_MM, rel=0.1)


def test_the_mean_edge_keeps_width_and_corners():
    square = roughened([np.array([(0, 0), (30, 0), (30, 30), (0, 30)], float)], 0.1, 0.25)
    (ring,) = smooth_rough_outlines(square)
    assert 0.05 < np.hypot(*(ring - (30, 30)).T).min() < 0.6
    assert _core.area([ring]) == pytest.approx(900, abs=3)


def test_specks_and_pinholes_of_a_rough_shape_are_left_out():
    letter = roughened(LETTERS["S"], 0.2, 0.25)
    speck, pinhole = 0.1 * regular(1, 4) + (60, 20), 0.1 * regular(1, 4)[::-1] + (14.5, 21.5)
    dot = 1.5 * regular(1, 12) + (60, 40)
    assert len(smooth_rough_outlines([*letter, pinhole, speck, dot])) == len(smooth_rough_outlines(letter)) + 1


def test_a_large_rough_shape_stays_within_the_memory_limit():
    """Smoothing a large rough shape stays within its memory limit.

    Smoothing needs points every 0.1 mm along 80 m.
    """
    x = np.linspace(0, 40_000, 90_000)
    noise = np.random.default_rng(1).normal(0, 0.05, (2, len(x)))
    hair = np.vstack([np.column_stack([x, noise[0]]), np.column_stack([x[::-1], 6 + noise[1]])])
    tracemalloc.start()
    rings = smooth_rough_outlines([hair])
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert sum(map(len, rings)) <= MAX_PLACES
    assert most < 60e6
