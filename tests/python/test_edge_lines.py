"""Narrow lines where passes leave a shape's edge bare: their marks held against shape and bare place by shapely."""

import numpy as np
import pytest
import shapely

from brushsvg import _core, find_brush
from brushsvg.calibration.from_widths import new_brush
from brushsvg.strokes.edge_lines import edge_lines
from brushsvg.strokes.swept_areas import region, rings_of
from brushsvg.strokes.trial_mark import SEEN_MM, Wanted, trial_mark

ELL = shapely.Polygon([(10, 10), (60, 10), (60, 30), (30, 30), (30, 60), (10, 60)])
STAR_TIP = shapely.Polygon([(10, 10), (50, 10), (30, 70)])
DISC = shapely.Point(30, 30).buffer(20, quad_segs=64)


@pytest.fixture
def brush():
    return find_brush("round-6")


def as_stroke(line):
    made = _core.Stroke("p", line.middle_mm, half_width=line.half_width)
    return made.replaced(
        start_covered=True, end_covered=True, settings=made.settings.replaced(start=line.start)
    )


def painted(shape, bare, brush):
    """The lines, and what is painted of a shape of which all but the bare place was."""
    wanted = Wanted(rings_of(shape))
    paint = _core.coverage(rings_of(shape.difference(bare)), wanted.window, wanted.px_per_mm)
    lines = edge_lines(paint, wanted, brush, as_stroke)
    marks = [region(trial_mark([as_stroke(line)], brush)) for line in lines]
    return lines, shapely.union_all([shape.difference(bare), *marks])


BARE = {
    "a straight edge": (ELL, shapely.box(22, 9, 40, 10.7)),
    "an inner corner": (ELL, shapely.Point(30, 30).buffer(1.0)),
    "a bend": (DISC, DISC.difference(DISC.buffer(-0.8)).intersection(shapely.box(20, 45, 38, 60))),
    "amid paint": (ELL, shapely.Point(20, 20).buffer(0.6)),
    "a sharp tip": (STAR_TIP, shapely.box(0, 66, 60, 80)),
}


@pytest.mark.parametrize(("shape", "bare"), BARE.values(), ids=BARE)
def test_what_is_bare_is_painted_and_nothing_sticks_out(brush, shape, bare):
    lines, paint = painted(shape, bare, brush)
    assert lines
    left = shape.buffer(-SEEN_MM).difference(paint)
    seen = shape.buffer(-SEEN_MM).intersection(bare)
    assert left.area < 0.15 * seen.area
    places = shapely.points(shapely.get_coordinates(paint))
    assert shapely.distance(shape, places).max() < 0.2


@pytest.mark.parametrize("deep_mm", [0.0, 0.15])
def test_an_edge_that_nobody_sees_to_be_bare_gets_no_line(brush, deep_mm):
    assert painted(ELL, shapely.box(15, 10, 50, 10 + deep_mm), brush)[0] == []


def test_lines_run_along_the_edge_as_far_beside_it_as_they_are_wide(brush):
    (line,), _ = painted(ELL, BARE["a straight edge"][1], brush)
    way = _core.flatten(as_stroke(line), 0.02)[:, :2]
    assert np.ptp(way[:, 1]) < 0.02
    assert way[0, 1] - 10 == pytest.approx(line.half_width[0][1], abs=0.02)
    assert way[:, 0].min() < 22
    assert way[:, 0].max() > 40


def test_a_pen_has_no_narrow_marks():
    pen = new_brush("pen", 0.0, [(1.0, 2.4)])
    lines, _ = painted(ELL, BARE["a straight edge"][1], pen)
    assert all(half == pytest.approx(1.2) for line in lines for _, half in line.half_width)
