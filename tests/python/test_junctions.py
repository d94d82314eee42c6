"""Where thick limbs meet: shapes that lines with a width made are painted by these lines again, straight beside what
joins them, and as wide where they end in another as before."""

import numpy as np
import pytest
import shapely

from brushsvg import _core
from brushsvg.strokes.skeleton import outline_strokes
from brushsvg.strokes.swept_areas import region

SEEN_MM = 0.15  # what of a shape lies deeper in it and stays bare, or is painted farther out, one sees

EDGE_MM = 0.15


def swept(points_mm: np.ndarray, half_mm: float) -> list[np.ndarray]:
    line = np.column_stack([points_mm, np.full(len(points_mm), half_mm)])
    middle_mm, half_width = _core.fit_curve(line, 0.002, False)
    return _core.wanted_outline(_core.Stroke(middle_mm=middle_mm, half_width=half_width), 0.005)


def straight(*ends) -> np.ndarray:
    return np.linspace(*ends, 20)


def arc(middle, radius_mm: float, from_deg: float, to_deg: float, tall: float = 1.0) -> np.ndarray:
    angles = np.radians(np.linspace(from_deg, to_deg, 120))
    return middle + radius_mm * np.column_stack([np.cos(angles), tall * np.sin(angles)])


STEM = straight((11.5, 12.0), (11.5, -11.0))
SHAPES = {
    "a": [(arc((0, 0), 11, 0, 360), 3.6), (STEM, 3.9)],
    "thin a": [(arc((0, 0), 11, 20, 340), 2.5), (STEM, 3.9)],
    "d": [(arc((0, 0), 11, 0, 360), 3.6), (straight((11.5, 26.0), (11.5, -11.0)), 3.9)],
    "q": [(arc((0, 0), 11, 0, 360), 3.6), (straight((11.5, 10.5), (11.5, -26.0)), 3.9)],
    "e": [(arc((0, 0), 11, 0, 315), 3.6), (straight((-11, 0.0), (11.0, 0.0)), 3.3)],
    "k": [
        (straight((0, 30.0), (0.0, -11.0)), 3.9),
        (straight((20, 16.0), (0.0, -3.0)), 3.5),
        (straight((9.3, 2.0), (21.0, -11.0)), 3.9),
    ],
    "Q": [(arc((0, 0), 15, 0, 360), 3.5), (arc((0, -41), 20, 125, 55), 3.5)],
    "n": [
        (straight((0, 12.0), (0.0, -14.0)), 3.9),
        (np.vstack([arc((11, 0), 11, 180, 0), [(22.0, y) for y in range(-1, -15, -1)]]), 3.7),
    ],
    "Y": [
        (straight((-15, 20.0), (0.0, 0.0)), 3.9),
        (straight((15, 20.0), (0.0, 0.0)), 3.9),
        (straight((0, 0.0), (0.0, -16.0)), 3.9),
    ],
}


def found(name: str):
    shape = _core.unite([ring for line in SHAPES[name] for ring in swept(*line)])
    made = outline_strokes(shape)
    strokes = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width, closed=s.closed) for s in made]
    return region(shape), strokes


@pytest.mark.parametrize("name", SHAPES)
def test_thick_limbs_leave_no_wedge_bare_and_stick_out_nowhere(name):
    shape, strokes = found(name)
    painted = region(_core.unite([ring for each in strokes for ring in _core.wanted_outline(each, 0.01)]))
    bare = shapely.difference(shape.buffer(-SEEN_MM), painted).area
    beside = shapely.difference(painted, shape.buffer(SEEN_MM)).area
    assert bare < (2.5 if name == "a" else 1.0) and beside < 0.05, (bare, beside)


@pytest.mark.parametrize("name", ["a", "thin a", "d", "q"])
def test_a_stem_beside_a_bowl_keeps_its_straight_edge(name):
    _, strokes = found(name)
    painted = region(_core.unite([ring for each in strokes for ring in _core.wanted_outline(each, 0.01)]))
    (x, top), (_, bottom) = SHAPES[name][1][0][[0, -1]]
    beside = shapely.box(x, bottom + 2, x + 10, top - 2)
    edge = shapely.get_coordinates(shapely.intersection(painted, beside).boundary)
    edge = edge[(edge[:, 0] > x + 1) & (edge[:, 1] > bottom + 2.01) & (edge[:, 1] < top - 2.01)]
    assert np.abs(edge[:, 0] - (x + 3.9)).max() < EDGE_MM, np.ptp(edge[:, 0])


def test_a_ring_and_the_tail_that_touches_it_are_two_lines():
    _, strokes = found("Q")
    assert sorted(stroke.closed for stroke in strokes) == [False, True]


def test_the_arm_of_a_k_runs_on_into_its_stem_as_wide_as_it_is():
    _, strokes = found("k")
    lines = [_core.flatten(stroke, 0.02) for stroke in strokes]
    arm = min(lines, key=lambda line: -line[:, :2].sum(axis=1).max() if np.ptp(line[:, 0]) > 5 else 0)
    assert arm[:, 0].min() < 1.0
    assert arm[:, 3].min() > 0.85 * 3.5
