"""`--compensation refined`: wide shapes, notices, and the limits of a machine.

Wide shapes are wider than the brush.
"""

from dataclasses import replace

import numpy as np
import pytest
from diagnostics import is_reported
from programs import problems

from brushsvg import _core, cli, compensate, find_brush, find_cell
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.paint_astray import find_off_middle_line, find_paint_outside
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.machine.preflight import as_exact_as
from brushsvg.planning.refinement import FORBIDDEN, NO_GAIN, limit_target_to_reach

BRUSH = find_brush("round-6")
BARS = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="90mm" viewBox="0 0 120 90">
<rect id="w12" x="20" y="10" width="12" height="70"/><rect id="w24" x="70" y="10" width="24" height="70"/></svg>"""


def works(tmp_path, text, **how):
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(text)
    # With a round or butt terminal, nothing would be left to refine.
    plain = {"start": "pointed", "end": "round"}
    return [prepare(drawing, Options(compensation=each, **plain, **how)) for each in ("closed", "refined")]


def overlap(work, number):
    marks = _core.simulate(work.plan, work.brush).passes[number]
    return _core.common_area([marks], [work.strokes[number]], work.brush).overlap


def test_a_stroke_too_wide_for_the_brush_stays_straight(tmp_path):
    """A stroke that is too wide for the brush stays straight.

    Bars of 12 and 24 mm once had hooks and became a C, up to 14 mm off the middle, because this covers more.
    """
    closed, refined = works(tmp_path, BARS, wide="clamp")
    marks = _core.simulate(refined.plan, refined.brush).passes
    # For the bar that is three times too wide, turning the brush at the ends gains almost nothing.
    least = (0.01, 0.0)
    for number, (middle_mm, trace) in enumerate(zip((26.0, 82.0), marks, strict=True)):
        widest = _core.widest_points(trace, refined.brush)
        inside = (widest[:, 1] > 22) & (widest[:, 1] < 68)
        assert widest[inside, 0] == pytest.approx(np.full(inside.sum(), middle_mm), abs=0.15)
        assert overlap(refined, number) > overlap(closed, number) + least[number]  # the ends are refined
    assert not is_reported(refined.notices, "off-middle-line")


def bar(half, target=True):
    """Return a bar of constant half width, in the form that an outline gives."""
    p = np.linspace((30, 50), (90, 50), 4).reshape(1, 8)
    stroke = _core.Stroke("bar", p, half_width=[(0, half), (1, half)])
    if target:
        x0, x1, y0, y1 = 30 - half, 90 + half, 50 - half, 50 + half
        stroke.target_mm = [np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])]
    return stroke


def test_outlines_up_to_slightly_beyond_reach_are_refinement_targets():
    greatest = BRUSH.half_width_range_mm()[1]
    for half in (0.5 * greatest, 1.05 * greatest):
        assert limit_target_to_reach(bar(min(half, greatest)), bar(half), BRUSH).target_mm
    assert not limit_target_to_reach(bar(greatest), bar(1.2 * greatest), BRUSH).target_mm


@pytest.mark.parametrize(("away_mm", "is_reported"), [(0.8, [True, False]), (2.5, [True, True])])
def test_a_displaced_refined_mark_is_reported(away_mm, is_reported):
    """A refined mark next to its stroke is reported.

    The strokes are 4 mm wide. In closed form, the tracking error counts from the tolerance on. In a refined
    plan, it counts from where the paint is outside by half the half width.
    """
    stroke = bar(2.0, target=False)
    a_pass = compensate([stroke], BRUSH, (120, 90)).plan.passes[0]
    a_pass.poses_mm = a_pass.poses_mm + np.array([0, away_mm, 0])
    miss = _core.tracking_error_of(a_pass, stroke, BRUSH)
    in_closed_form = find_off_middle_line([stroke], [miss], BRUSH, 0.05)
    assert [bool(in_closed_form), bool(find_paint_outside([stroke], [a_pass], BRUSH))] == is_reported


def test_a_refined_plan_reports_strokes_left_in_closed_form(tmp_path):
    """A refined plan reports the tracking errors of strokes left in closed form.

    Nothing is refined on a thin line, and its errors were once reported with --compensation closed only.
    """
    text = """<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 90 60"><path id="z"
        d="M20 20 H70 L22 24" fill="none" stroke="#000" stroke-width="0.4"/></svg>"""
    closed, refined = works(tmp_path, text, corners="turn")
    assert is_reported(closed.notices, "off-middle-line", "z")
    assert [notice for notice in refined.notices if notice not in said_of_nothing(refined)] == list(closed.notices)


TWO = """<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100"><g fill="none"
stroke="#000" stroke-linecap="round"><path id="one" d="M20 20 H40 V40" stroke-width="3"/>
<path id="far" d="{d}" stroke-width="{width}"/></g></svg>"""


@pytest.mark.parametrize(
    ("limit", "d", "width"),
    [("height", "M20 80 H60", 5), ("margin", "M94 50 h0", 8)],
    ids=["height", "margin"],
)
def test_a_refined_stroke_beyond_a_limit_is_left_in_closed_form(tmp_path, limit, d, width):
    """A refined stroke that would exceed a limit of the machine stays in closed form.

    Refined strokes go lower, or further beyond the edge. A drawing that closed form painted was once refused
    in refined mode.
    """
    text = TWO.format(d=d, width=width)
    closed, refined = works(tmp_path, text)
    poses = [np.vstack([each.poses_mm for each in work.plan.passes]) for work in (closed, refined)]
    cell = find_cell()
    if limit == "height":
        low, lower = (each[:, 2].min() for each in poses)
        assert lower < low - 0.1
        cell = replace(cell, heights=replace(cell.heights, lowest_mm=(low + lower) / 2))
    else:
        near, far = (each[:, 0].max() - 100 for each in poses)
        assert far > near + 0.1
        cell = replace(cell, workspace=replace(cell.workspace, margin_mm=(near + far) / 2))
    _, held = works(tmp_path, text, cell=cell)
    checked = as_exact_as(cell, 0.05)
    assert problems(refined.plan, BRUSH, predict(refined, False), checked, 0.05)
    assert not problems(held.plan, BRUSH, predict(held, False), checked, 0.05)
    one, far = held.plan.passes
    assert np.array_equal(one.poses_mm, refined.plan.passes[0].poses_mm)
    assert not np.array_equal(one.poses_mm, closed.plan.passes[0].poses_mm)
    assert np.array_equal(far.poses_mm, closed.plan.passes[1].poses_mm)


def test_the_command_line_refines_within_its_cell(tmp_path, monkeypatch):
    """The command line refines within the limits of its cell, and check accepts it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two.svg").write_text(TWO.format(d="M20 80 H60", width=5))
    assert cli.main(["cell", "new", "-o", "low.toml"]) == 0
    cell = tmp_path / "low.toml"
    cell.write_text(cell.read_text().replace("lowest_mm = -20.0", "lowest_mm = -6.0"))
    words = ["two.svg", "-o", "two.ngc", "--cell", "low.toml", "--compensation", "refined"]
    assert cli.main(["convert", *words]) == 0
    assert cli.main(["check", "two.ngc", "two.svg", "--cell", "low.toml"]) == 0


def test_a_refined_dot_stays_round(tmp_path):
    """A dot stays round in a refined plan.

    Its footprint turns on the spot. When refinement moved the footprint, the dot had bulges.
    """
    drawing = tmp_path / "drawing.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 90 60">'
        '<circle cx="30" cy="30" r="3"/><rect x="50" y="27" width="5.8" height="5"/></svg>'
    )
    closed, refined = (prepare(drawing, Options(compensation=each)).plan for each in ("closed", "refined"))
    for before, after in zip(closed.passes, refined.passes, strict=True):
        np.testing.assert_array_equal(after.poses_mm, before.poses_mm)


BAR = """<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">
<path id="a" fill="none" stroke="#000" stroke-width="5" d="M20 80H60"/></svg>"""


def said_of_nothing(work):
    return [notice for notice in work.notices if notice.code == "flag-without-effect"]


def test_refinement_without_effect_is_reported_with_its_reason(tmp_path):
    (tmp_path / "bar.svg").write_text(BAR)
    refined = prepare(tmp_path / "bar.svg", Options(compensation="refined"))
    assert len(said_of_nothing(refined)) == 1 and NO_GAIN in said_of_nothing(refined)[0].sentence
    closed, refined = works(tmp_path, BAR)  # equal except for the ends, which are refined
    assert not np.array_equal(closed.plan.passes[0].poses_mm, refined.plan.passes[0].poses_mm)
    assert not said_of_nothing(closed) and not said_of_nothing(refined)
    low, lower = (work.plan.passes[0].poses_mm[:, 2].min() for work in (closed, refined))
    cell = find_cell()
    _, held = works(tmp_path, BAR, cell=replace(cell, heights=replace(cell.heights, lowest_mm=(low + lower) / 2)))
    assert len(said_of_nothing(held)) == 1 and FORBIDDEN in said_of_nothing(held)[0].sentence
