"""Lines of a filling whose marks stick out of the shape, led otherwise: marks held against the shape by shapely."""

import numpy as np
import pytest
import shapely

from brushsvg import _core, find_brush
from brushsvg.strokes.bulges import mended
from brushsvg.strokes.offset_passes import Line
from brushsvg.strokes.swept_areas import region
from brushsvg.strokes.trial_mark import trial_mark

BAR = shapely.box(10, 20, 90, 38)
RINGS = [np.array(BAR.exterior.coords)[:-1]]


@pytest.fixture
def brush():
    return find_brush("round-6")


def straight(start, end, half=4.2):
    return Line(np.linspace(start, end, 4).reshape(1, 8), [(0.0, half), (1.0, half)])


def as_stroke(k, line):
    stroke = _core.Stroke(f"p~{k + 1}", line.middle_mm, half_width=line.half_width)
    return stroke.replaced(start_covered=True, end_covered=True)  # by other passes


def farthest_mm(lines, brush) -> float:
    """How far the mark of lines lies outside of the bar."""
    mark = region(trial_mark([as_stroke(k, line) for k, line in enumerate(lines)], brush))
    return shapely.distance(BAR, shapely.points(shapely.get_coordinates(mark))).max()


def test_a_line_that_sticks_out_is_led_otherwise_and_others_stay(brush):
    through = [straight((16, y), (84, y)) for y in (33.5, 24.5)]
    lines = [*through, straight((50, 33), (50, 20))]
    assert farthest_mm(lines, brush) > 1
    made, _, _ = mended(lines, [], RINGS, brush, as_stroke)
    assert all(new is old for new, old in zip(made[:2], through, strict=True))
    assert made[2] is not None
    assert farthest_mm(made, brush) < 0.25


def test_a_line_that_paints_hardly_more_than_a_bulge_is_left_out_unless_it_is_the_first(brush):
    through = [straight((16, y), (84, y)) for y in (33.7, 29, 24.3)]
    across = straight((50, 23), (50, 18))
    made, _, _ = mended([*through, across], [], RINGS, brush, as_stroke)
    assert made[-1] is None
    assert all(new is old for new, old in zip(made[:-1], through, strict=True))
    assert mended([across, *through], [], RINGS, brush, as_stroke)[0][0] is not None


def test_lines_that_stay_within_the_shape_are_left_as_they_are(brush):
    lines = [straight((18, 33.5), (82, 33.5)), straight((18, 24.5), (82, 24.5))]
    made, _, _ = mended(lines, [], RINGS, brush, as_stroke)
    assert all(new is old for new, old in zip(made, lines, strict=True))
