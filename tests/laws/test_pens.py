"""The mark of a pen is its path with the width of the nib, by shapely.

This includes corners and reversals.
"""

import functools

import numpy as np
import pytest
import shapely

core = pytest.importorskip("brushsvg._core")

SHEET_MM = (100.0, 60.0)
LINES = {
    "square": [(10, 10), (40, 10), (40, 40), (10, 40), (10, 10)],
    "triangle": [(80, 10), (90, 10), (85, 18), (80, 10)],
    "open": [(50, 40), (50, 50), (42, 50), (42, 40), (49.99, 40)],
    "there and back": [(10, 10), (60, 10), (20, 10)],
    "up": [(10, 20), (10, 45)],
    "diagonal": [(20, 20), (60, 40)],
    "comb": [(x, 10 + 10 * (k % 4 in (1, 2))) for k, x in enumerate(np.repeat(range(10, 60, 3), 2))],
}


def pen(name):
    from brushsvg import find_brush
    from brushsvg.calibration.numbers.from_widths import new_brush

    return find_brush("rigid") if name == "rigid" else new_brush("pen", 0.0, [(0.5, 1.0)])


def stroke_along(points):
    a, b = np.array(points[:-1], float), np.array(points[1:], float)
    return core.Stroke("s", np.hstack([a, a + (b - a) / 3, b - (b - a) / 3, b]), half_width=[(0.0, 0.5)])


def share(a, b):
    return a.intersection(b).area / a.union(b).area


@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("name", ["rigid", "brush new --lag 0"])
@pytest.mark.parametrize("compensation", ["none", "constant", "closed", "refined"])
def test_a_pen_paints_all_of_its_line(compensation, name, line):
    from brushsvg.show.evaluation import figures

    brush, stroke = pen(name), stroke_along(LINES[line])
    plan = core.compensate([stroke], brush, SHEET_MM, compensation).plan
    drawn = shapely.LineString(LINES[line]).buffer(0.5)
    painted = shapely.LineString(plan.passes[0].poses_mm[:, :2]).buffer(0.5)
    assert share(painted, drawn) > 0.99
    marks = core.simulate(plan, brush)
    core.trace_outlines(marks, brush)
    rings = [shapely.Polygon(ring) for ring in marks.passes[0].outline_mm]
    predicted = functools.reduce(shapely.symmetric_difference, rings)  # areas of holes and of their rings
    assert share(predicted, painted) > 0.98
    assert figures.measure_figures(figures.PaintedPlan(plan, marks, brush, [stroke]))[1].overlap > 0.95
