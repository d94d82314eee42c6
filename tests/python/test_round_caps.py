"""Round ends of wide lines: the brush turns round within the cap.

The front of a footprint is too blunt to paint the cap alone.
"""

import numpy as np
import pytest
import shapely
from svg_text import read

from brushsvg import _core, find_brush
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.swept_areas import region

MIDDLE = shapely.LineString([(30, 25), (75, 25)])


def of(d: str, rest: str = 'fill="black" stroke="none"') -> list:
    return strokes(read(f'<path id="p" d="{d}" {rest}/>'))[0]


def line(width_mm: float) -> list:
    return of("M30 25H75", f'stroke-linecap="round" stroke-width="{width_mm}"')


def capsule(width_mm: float) -> list:
    half = width_mm / 2
    arc = f"A{half} {half} 0 0 1"
    return of(f"M30 {25 - half}H75{arc} 75 {25 + half}H30{arc} 30 {25 - half}Z")


def mark(some: list, start: str = "auto", end: str = "auto"):
    brush = find_brush("round-6")
    plan = _core.compensate(some, brush, (100, 50), start=start, end=end).plan
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    return region(marks.outline_mm), plan


def strays_mm(painted, width_mm: float) -> float:
    """Return the largest distance between the edges of mark and drawn capsule."""
    target = MIDDLE.buffer(width_mm / 2, quad_segs=64)
    points = [shapely.points(shapely.get_coordinates(each)) for each in (painted, target)]
    return float(
        max(
            shapely.distance(target.boundary, points[0]).max(),
            shapely.distance(painted.boundary, points[1]).max(),
        )
    )


@pytest.mark.parametrize("drawn", [line, capsule])
@pytest.mark.parametrize("width_mm", [5.75, 6, 7, 8, 8.4])
def test_both_ends_are_round(drawn, width_mm):
    """Both ends of a wide line are round.

    At 6 mm, the ends were hexagons like the front of a footprint, with an error of 0.4 mm. An error of 0.1 mm
    is invisible.
    """
    painted, plan = mark(drawn(width_mm))
    assert strays_mm(painted, width_mm) < 0.1
    assert len(plan.passes[0].poses_mm) < 60
    blunt, _ = mark(drawn(width_mm), "pointed", "round")
    assert strays_mm(blunt, width_mm) > 1.0


def test_a_covered_start_is_round():
    painted, _ = mark(line(8), "round", "round")
    left = shapely.box(0, 0, 50, 50)
    beyond = painted.symmetric_difference(MIDDLE.buffer(4, quad_segs=64)).intersection(left)
    assert beyond.area < 1.0


@pytest.mark.parametrize("width_mm", [3, 5])
def test_narrower_lines_need_no_turn(width_mm):
    painted, plan = mark(line(width_mm))
    assert strays_mm(painted, width_mm) < 0.15
    assert len(plan.passes[0].poses_mm) < 20


def test_butt_ends_of_a_line_are_straight():
    painted, _ = mark(line(8), "butt", "butt")
    assert all(painted.contains(shapely.Point(x, y)) for x in (26.8, 78.2) for y in (21.8, 28.2))


def test_only_stem_ends_below_a_serif_are_covered():
    made = of("M20 10H50V13H39V37H50V40H20V37H31V13H20Z")
    (stem,) = [
        each for each in made if abs(np.diff(each.middle_mm[:, 0]).sum()) + abs(np.ptp(each.middle_mm[:, 0::2])) < 3
    ]
    assert stem.start_covered and stem.end_covered
    for (bar,) in (capsule(8), line(8)):
        assert not bar.start_covered and not bar.end_covered
