"""`--compensation refined` on shapes wider than the brush, and what is told of where it goes."""

import numpy as np
import pytest

from brushsvg import _core, compensate, find_brush
from brushsvg.convert import Options, _misses, prepare
from brushsvg.refining import towards_reach

BRUSH = find_brush("round-6")
BARS = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="90mm" viewBox="0 0 120 90">
<rect id="w12" x="20" y="10" width="12" height="70"/><rect id="w24" x="70" y="10" width="24" height="70"/></svg>"""


def works(tmp_path, text, **how):
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(text)
    return [prepare(drawing, Options(compensation=each, **how)) for each in ("closed", "refined")]


def overlap(work, number):
    marks = _core.simulate(work.plan, work.brush).passes[number]
    return _core.common_area([marks], [work.strokes[number]], work.brush).overlap


def test_a_stroke_too_wide_for_the_brush_stays_straight(tmp_path):
    """Bars of 12 and 24 mm had hooks and became a C, up to 14 mm off the middle, since that covers more."""
    closed, refined = works(tmp_path, BARS)
    marks = _core.simulate(refined.plan, refined.brush).passes
    for number, (middle_mm, trace) in enumerate(zip((26.0, 82.0), marks, strict=True)):
        widest = _core.widest_points(trace, refined.brush)
        inside = (widest[:, 1] > 22) & (widest[:, 1] < 68)
        assert widest[inside, 0] == pytest.approx(np.full(inside.sum(), middle_mm), abs=0.15)
        assert overlap(refined, number) > overlap(closed, number) + 0.01  # ends are refined as ever
    assert not [notice for notice in refined.notices if "widest point" in notice.sentence]


def bar(half, wanted=True):
    """A bar of a constant half width, as its outline gives it."""
    p = np.linspace((30, 50), (90, 50), 4).reshape(1, 8)
    stroke = _core.Stroke("bar", p, half_width=[(0, half), (1, half)])
    if wanted:
        x0, x1, y0, y1 = 30 - half, 90 + half, 50 - half, 50 + half
        stroke.wanted_mm = [np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])]
    return stroke


def test_outlines_within_reach_and_a_little_beyond_are_refined_towards():
    greatest = BRUSH.half_width_range_mm()[1]
    for half in (0.5 * greatest, 1.05 * greatest):
        assert towards_reach(bar(min(half, greatest)), bar(half), BRUSH).wanted_mm
    assert not towards_reach(bar(greatest), bar(1.2 * greatest), BRUSH).wanted_mm


@pytest.mark.parametrize(("away_mm", "is_told"), [(1.0, [True, False]), (2.5, [True, True])])
def test_a_refined_mark_beside_its_stroke_is_told_of(away_mm, is_told):
    """Two strokes 4 mm wide: the miss of one in closed form counts from the tolerance on, that of a refined one from
    where its middle leaves the stroke."""
    stroke = bar(2.0, wanted=False)
    a_pass = compensate([stroke], BRUSH, (120, 90)).plan.passes[0]
    a_pass.poses_mm = a_pass.poses_mm + np.array([0, away_mm, 0])
    miss = _core.miss_of(a_pass, stroke, BRUSH)
    told = [bool(_misses([stroke], [miss], [moved], BRUSH, 0.05)) for moved in (False, True)]
    assert told == is_told


def test_a_refined_plan_tells_of_strokes_left_in_closed_form(tmp_path):
    """Nothing is refined on a thread, and its misses were told with --compensation closed only."""
    text = """<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 90 60"><path id="z"
        d="M20 20 H70 L22 24" fill="none" stroke="#000" stroke-width="0.2"/></svg>"""
    closed, refined = works(tmp_path, text)
    assert any("turns too sharply" in notice.sentence for notice in closed.notices)
    assert refined.notices == closed.notices
