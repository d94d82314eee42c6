"""Stray paint of strokes that have no middle line of their own."""

import re

import numpy as np
import pytest

from brushsvg import _core, find_brush
from brushsvg.jobs.preparation.paint_astray import find_off_middle_line, find_paint_outside

HALF_MM = 2.0


def bar(name: str, y_mm: float) -> _core.Stroke:
    line = np.array([[20.0, y_mm, 40.0, y_mm, 60.0, y_mm, 80.0, y_mm]])
    return _core.Stroke(id=name, middle_mm=line, half_width=[(0.0, HALF_MM)])


@pytest.fixture(scope="module")
def brush():
    return find_brush("round-6")


@pytest.mark.parametrize(("displaced_mm", "is_reported"), [(0.0, False), (0.8, False), (1.5, True), (2.5, True)])
def test_paint_outside_a_shape_is_reported_with_its_distance(brush, displaced_mm, is_reported):
    """Paint outside a shape is reported by its distance from the shape.

    A straight mark that is shifted sideways is outside by the shift. Kaushan's B, painted as well as
    possible, was once reported with a tracking error of 4.9 mm. Lobster's A had a thorn of 2.3 mm without a
    notice.
    """
    run = _core.compensate([bar("a", 30.0 + displaced_mm)], brush, (100.0, 60.0)).plan.passes[0]
    reported = find_paint_outside([bar("a", 30.0)], [run], brush)
    assert bool(reported) == is_reported
    if reported:
        away = re.search(r"([0-9.]+) mm", reported[0].sentence)[1]
        assert (reported[0].where, reported[0].code) == ("a", "paint-outside")
        assert float(away) == pytest.approx(displaced_mm, abs=0.11)


def test_paint_on_a_neighbouring_stroke_is_not_outside(brush):
    run = _core.compensate([bar("a", 32.5)], brush, (100.0, 60.0)).plan.passes[0]
    assert find_paint_outside([bar("a", 30.0), bar("b", 33.0)], [run, None], brush) == []
    assert len(find_paint_outside([bar("a", 30.0), bar("b", 43.0)], [run, None], brush)) == 1


def test_a_tracking_error_is_reported_beyond_the_uncertainty_of_the_brush(brush):
    """A tracking error is reported only where it exceeds the brush's uncertainty.

    The lag of round-6 has a standard deviation of 0.58 mm, which hides an error of 0.1 mm.
    """
    for displaced_mm, is_reported in ((0.1, False), (0.4, True)):
        run = _core.compensate([bar("a", 30.0 + displaced_mm)], brush, (100.0, 60.0)).plan.passes[0]
        error = _core.tracking_error_of(run, bar("a", 30.0), brush, 0.05)
        assert error.largest_mm == pytest.approx(displaced_mm, abs=0.045) and not error.within_tolerance
        assert bool(find_off_middle_line([bar("a", 30.0)], [error], brush, 0.05)) == is_reported
