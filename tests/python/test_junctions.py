"""Thick limbs that meet are painted by the lines that made their shape.

Lines with a width make each shape. The strokes found in the shape stay straight next to a joining line, and
keep their width where they end in another line.
"""

import numpy as np
import pytest
import shapely

from brushsvg import _core
from brushsvg.strokes.skeleton import outline_strokes
from brushsvg.strokes.swept_areas import region

SEEN_MM = 0.15  # A person sees an unpainted depth or an overspill larger than this.

EDGE_MM = 0.15


def swept(points_mm: np.ndarray, half_mm: float) -> list[np.ndarray]:
    line = np.column_stack([points_mm, np.full(len(points_mm), half_mm)])
    middle_mm, half_width = _core.fit_cubics(line, 0.002, False)
    return _core.target_outline(_core.Stroke(middle_mm=middle_mm, half_width=half_width), 0.005)


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


# An arm and a leg with straight cuts. Their outer edges meet at the right edge of a stem, or would meet
# inside it.
LIMBS = {
    "K": [(3.2, -1.8), (23, -21.6), (28, -16.6), (10.8, 0.6), (24, 13.8), (20.5, 17.3), (3.2, 0)],
    "forked k": [(3.1, -1), (21, -18.9), (26.2, -13.7), (12.5, 0), (26.2, 13.7), (21, 18.9), (3.1, 1)],
}


def found(name: str):
    if name in LIMBS:
        limbs = np.array(LIMBS[name], float)
        shape = _core.unite([*swept(straight((0, 30.0), (0, -22.0)), 3.9), limbs])
    else:
        shape = _core.unite([ring for line in SHAPES[name] for ring in swept(*line)])
    made = outline_strokes(shape)
    strokes = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width, closed=s.closed) for s in made]
    return region(shape), strokes


@pytest.mark.parametrize("name", SHAPES)
def test_thick_limbs_leave_no_bare_wedge_and_no_overspill(name):
    shape, strokes = found(name)
    painted = region(_core.unite([ring for each in strokes for ring in _core.target_outline(each, 0.01)]))
    bare = shapely.difference(shape.buffer(-SEEN_MM), painted).area
    near_by = shapely.difference(painted, shape.buffer(SEEN_MM)).area
    assert bare < (2.5 if name == "a" else 1.0) and near_by < 0.05, (bare, near_by)


@pytest.mark.parametrize("name", ["a", "thin a", "d", "q"])
def test_a_stem_next_to_a_bowl_keeps_its_straight_edge(name):
    _, strokes = found(name)
    painted = region(_core.unite([ring for each in strokes for ring in _core.target_outline(each, 0.01)]))
    (x, top), (_, bottom) = SHAPES[name][1][0][[0, -1]]
    near_by = shapely.box(x, bottom + 2, x + 10, top - 2)
    edge = shapely.get_coordinates(shapely.intersection(painted, near_by).boundary)
    edge = edge[(edge[:, 0] > x + 1) & (edge[:, 1] > bottom + 2.01) & (edge[:, 1] < top - 2.01)]
    assert np.abs(edge[:, 0] - (x + 3.9)).max() < EDGE_MM, np.ptp(edge[:, 0])


def test_a_ring_and_the_tail_that_touches_it_are_two_lines():
    _, strokes = found("Q")
    assert sorted(stroke.closed for stroke in strokes) == [False, True]


def test_the_arm_of_a_k_continues_into_its_stem_at_full_width():
    _, strokes = found("k")
    lines = [_core.flatten(stroke, 0.02) for stroke in strokes]
    arm = min(lines, key=lambda line: -line[:, :2].sum(axis=1).max() if np.ptp(line[:, 0]) > 5 else 0)
    assert arm[:, 0].min() < 1.0
    assert arm[:, 3].min() > 0.85 * 3.5


@pytest.mark.parametrize("name", LIMBS)
def test_limbs_that_meet_next_to_a_stem_leave_no_bare_wedges(name):
    shape, strokes = found(name)
    painted = region(_core.unite([ring for each in strokes for ring in _core.target_outline(each, 0.01)]))
    bare = shapely.difference(shape.buffer(-SEEN_MM), painted)
    assert bare.intersection(shapely.box(-4, -8, 12, 8)).area < 0.3
    assert shapely.difference(painted, shape.buffer(SEEN_MM)).area < 0.05


def test_a_serif_next_to_the_leg_of_an_m_keeps_its_height_and_its_width():
    leg = np.array([(-11.7, 6.0), (-8.6, 6.0), (1.3, 28.0), (1.3, 30.0), (-0.9, 30.0)])
    boxes = [((0, 0), (8.7, 30)), ((0, 27.2), (13.0, 30))]
    corners = [np.array([a, (b[0], a[1]), b, (a[0], b[1])], float) for a, b in boxes]
    lines = [
        _core.flatten(_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width), 0.02)
        for s in outline_strokes(_core.unite([leg, *corners]))
    ]
    assert len(lines) == 3
    serif = max(lines, key=lambda line: line[:, 0].max())
    assert serif[:, 0].min() < 2.0 and np.ptp(serif[:, 1]) < 0.3 and np.ptp(serif[:, 3]) < 0.3


def test_a_bowl_that_widens_towards_a_thin_bar_leaves_no_wedge_in_the_counter():
    outside = [(-12, -2.9), (9.5, -2.9), (8.5, 2.5), (6.4, 6), (4, 10), (0, 12.5)]
    counter = [(-3, 10.5), (-1, 8.5), (-0.2, 5), (0, 2), (0, 0), (-12, 0)]
    rings = _core.unite([np.array(outside + counter, float)])
    strokes = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width) for s in outline_strokes(rings)]
    painted = region(_core.unite([ring for each in strokes for ring in _core.target_outline(each, 0.01)]))
    bare = shapely.difference(region(rings).buffer(-SEEN_MM), painted)
    assert bare.intersection(shapely.box(-2, -2.6, 4, 6)).area < 0.3
    bar = min((_core.flatten(each, 0.02) for each in strokes), key=lambda line: line[:, 0].min())
    assert len(strokes) == 2 and bar[:, 0].max() > 6 and np.ptp(bar[:, 1]) < 0.5


def test_no_line_of_a_bold_4_crosses_its_counter():
    outside = [
        *[(28.0, 6.4), (27.5, 10.7), (25.9, 10.9), (25.2, 23.5), (14.4, 24.2), (12.7, 23.8), (3.0, 12.9), (1.3, 10.3)],
        *[(1.2, 7.5), (3.0, 5.7), (11.8, 5.5), (12.1, 2.4), (13.6, 0.8), (23.5, 0.7), (25.4, 1.8), (25.9, 5.5)],
    ]
    counter = np.array([(11.7, 16.5), (11.7, 10.9), (7.9, 11.0), (8.1, 12.2)])
    strokes = [
        _core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width)
        for s in outline_strokes([np.array(outside), counter])
    ]
    painted = region(_core.unite([ring for each in strokes for ring in _core.target_outline(each, 0.01)]))
    assert shapely.Polygon(counter).intersection(painted).area < 0.2 * shapely.Polygon(counter).area
