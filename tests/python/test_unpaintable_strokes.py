"""Strokes that cannot be painted are refused when they become a plan."""

import numpy as np
import pytest
from diagnostics import refused
from small_drawings import line

from brushsvg import Error, Stroke, _core, find_brush

BRUSH = find_brush("round-6")
SHEET = (100.0, 60.0)


def stroke(middle_mm, closed=False):
    return Stroke("one", np.array(middle_mm, float), closed, [(0.0, 1.0)])


@pytest.mark.parametrize("sheet_mm", [(0, 0), (0, 60), (100, -60), (np.nan, 60), (100, np.inf), (100, 2e6)])
def test_an_impossible_sheet_is_refused(sheet_mm):
    with refused("out-of-range 1e6", "sheet_mm") as caught:
        _core.compensate([stroke(line([(20, 20), (60, 20)]))], BRUSH, sheet_mm)
    assert list(caught.value.range) == [0.0, 1e6]


def test_cubics_of_a_stroke_must_be_connected():
    """Cubics of a stroke must be connected.

    A gap between two cubics was once painted straight across.
    """
    middle = line([(20, 20), (40, 20), (60, 20)])
    middle[1] += [0, 3] * 4
    with refused("geometry-out-of-range 1 0 3", "one"):
        _core.compensate([stroke(middle)], BRUSH, SHEET)
    middle[1] -= [0, 2.995] * 4
    assert _core.compensate([stroke(middle)], BRUSH, SHEET).plan.passes, "as near as lines that are joined"


def test_a_closed_stroke_must_end_at_its_start():
    ring = [(20, 20), (40, 20), (40, 40), (20, 40)]
    with refused("geometry-out-of-range 0 2 20", "one"):
        _core.compensate([stroke(line(ring), closed=True)], BRUSH, SHEET)
    assert _core.compensate([stroke(line([*ring, ring[0]]), closed=True)], BRUSH, SHEET).plan.passes


def test_an_array_of_degrees_of_freedom_is_refused():
    """An array of degrees of freedom is refused.

    The code once built the full product of a column and a row of a hundred thousand values each.
    """
    with pytest.raises(TypeError):
        _core.normal_equivalent(np.ones((100_000, 1)), np.ones(100_000))


@pytest.mark.parametrize("freedom", [0.0, -1.0, 1e-300, float("nan")])
def test_an_interval_without_degrees_of_freedom_is_refused(freedom):
    for ask in (lambda: _core.interval_factor_95(freedom), lambda: _core.normal_equivalent(np.ones(3), freedom)):
        with pytest.raises(Error):
            ask()
