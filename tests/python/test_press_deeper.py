"""Plans press deeper as paint runs out.

Marks then have the drawn width, within the measured depths.
"""

import random
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely
from diagnostics import is_reported
from sampling import sample

import brushsvg
from brushsvg import _core
from brushsvg.cli import main
from brushsvg.jobs.conversion import simulate_and_check
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict_plan_marks
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.machine.cells.cell import Reload, Station
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.machine.job_program import Job
from brushsvg.machine.paint_reload import list_station_visits, split_into_loads
from brushsvg.model.library import find_brush

COUNT = 60


@cache
def drawing():
    """Return a drawing of lines, waves and bows, 20 mm long and 2 to 5 mm wide."""
    rng = random.Random(3)
    rows = []
    for k in range(COUNT):
        x, y = 12 + (k % 6) * 32, 14 + (k // 6) * 27
        bend, width = rng.uniform(-12, 12), rng.uniform(2, 5)
        d = (f"l20,{bend / 2:.2f}", "c6,-8 14,8 20,0", f"q10,{bend:.2f} 20,0")[k % 3]
        rows.append(f'<path id="s{k}" d="M{x},{y} {d}" stroke-width="{width:.2f}"/>')
    size = 'width="210mm" height="297mm" viewBox="0 0 210 297"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="none" stroke="#000">{"".join(rows)}</svg>'


def brush_of(rate):
    brush = find_brush("round-6")
    brush.paint = _core.Paint(rate) if rate else None
    return brush


def cell_with(reload):
    return replace(find_cell(), name="painting", reload=reload, stations=(Station("any", (-20.0, 40.0), depth_mm=5.0),))


ONE_LOAD = cell_with(Reload("length", 1e5, 6.0))


def prepared(tmp_path, rate, cell=ONE_LOAD, compensation="closed", drawn=None, **ways):
    path = tmp_path / "d.svg"
    path.write_text(drawn or drawing())
    return prepare(path, Options(brush=brush_of(rate), compensation=compensation, cell=cell, **ways))


def mean_overlap(work, rate):
    """Return the mean overlap of marks with drawn strokes, each stroke alone."""
    marks = predict_plan_marks(work.plan, brush_of(rate), cell=work.options.cell)
    found = []
    for trace, stroke in zip(marks.passes, work.strokes, strict=True):
        mark, drawn = (
            shapely.union_all([shapely.Polygon(ring).buffer(0) for ring in rings])
            for rings in (trace.outline_mm, _core.target_outline(stroke, 0.02))
        )
        found.append(mark.intersection(drawn).area / mark.union(drawn).area)
    return np.mean(found)


@pytest.mark.slow
@sample("compensation", ["closed", "refined"], keep=1)
def test_marks_of_a_job_with_one_load_have_the_drawn_width(tmp_path, compensation):
    """The marks of a job with one load are as wide as drawn.

    Without the correction, the last marks would be a sixth too narrow.
    """
    always, now = (prepared(tmp_path, rate, compensation=compensation) for rate in (0.0, 0.05))
    fresh = mean_overlap(always, 0.0)
    assert mean_overlap(always, 0.05) < fresh - 0.07
    assert mean_overlap(now, 0.05) > fresh - 0.005
    assert not now.notices


def test_sections_through_the_middle_of_marks_have_the_drawn_width(tmp_path):
    """A cut through the middle of each mark has the drawn width.

    Without the correction, the last marks were half as wide.
    """
    # On lines as short as these, turns in round caps reach as far as the middle.
    work = prepared(tmp_path, 0.22, start="pointed", end="round")
    marks = predict_plan_marks(work.plan, brush_of(0.22), cell=ONE_LOAD)
    assert marks.passes[-1].width_share[-1] < 0.6
    for trace, stroke in zip(marks.passes[::3], work.strokes[::3], strict=True):  # the strokes that are lines
        ends = np.asarray(stroke.middle_mm).reshape(-1, 2)[[0, -1]]
        along = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
        across = 20 * np.array([-along[1], along[0]])
        cut = shapely.LineString([ends.mean(axis=0) - across, ends.mean(axis=0) + across])
        mark = shapely.union_all([shapely.Polygon(ring).buffer(0) for ring in trace.outline_mm])
        assert mark.intersection(cut).length == pytest.approx(2 * stroke.half_width[0][1], rel=0.01)


def test_depth_returns_to_normal_after_a_paint_visit(tmp_path):
    cell = cell_with(Reload("length", 1e5, 6.0, narrower_percent=20.0))
    same = drawing().replace('stroke-width="', 'stroke-width="3" data-was="')
    work = prepared(tmp_path, 0.4, cell, drawn=same)
    fetched = [bool(each) for each in list_station_visits(split_into_loads(work.plan, brush_of(0.4), cell), cell)]
    deepest = np.array([-np.asarray(one.poses_mm)[:, 2].min() for one in work.plan.passes])
    fresh = prepared(tmp_path, 0.0, cell, drawn=same).plan.passes
    usual = np.array([-np.asarray(one.poses_mm)[:, 2].min() for one in fresh])
    more = (deepest / usual)[::3]  # each line has one depth
    assert 5 < sum(fetched) < COUNT / 3
    assert more.min() < 1.05 and 1.15 < more.max() < 1.4
    after = [k for k in range(3, COUNT, 3) if fetched[k]]
    assert after and all(deepest[k] < deepest[k - 3] for k in after)


def test_plans_without_paint_decay_are_unchanged(tmp_path):
    """A brush without paint, or with paint that never runs out, gets the usual plan.

    The two plans are equal to the last bit.
    """
    plans = [_core.write_plan(prepared(tmp_path, rate).plan) for rate in (0.0, 1e-12)]
    assert plans[0].split('"passes"')[1] == plans[1].split('"passes"')[1]


def test_reaching_the_depth_limit_is_reported_once(tmp_path):
    work = prepared(tmp_path, 0.4)
    deepest = max(-np.asarray(one.poses_mm)[:, 2].min() for one in work.plan.passes)
    assert 9.9 < deepest <= 10
    assert is_reported(work.notices, "paint-runs-out round-6 '10 mm'")
    assert len(work.notices) == 1
    share = predict_plan_marks(work.plan, brush_of(0.4), False, cell=ONE_LOAD).passes[-1].width_share[-1]
    assert share < 0.3, "far beyond what depth could make up for"
    heights = replace(find_cell().heights, lowest_mm=-7.0)
    shallow = prepared(tmp_path, 0.4, replace(ONE_LOAD, heights=heights))
    assert max(-np.asarray(one.poses_mm)[:, 2].min() for one in shallow.plan.passes) <= 7.0
    assert is_reported(shallow.notices, "paint-runs-out round-6 '7 mm'")


@pytest.mark.parametrize(("offset_mm", "deepest_mm"), [(0.0, "8"), (-2.2, "7.8")])
def test_strokes_are_pressed_as_deep_as_the_cell_allows(tmp_path, offset_mm, deepest_mm):
    """The servo's table ends at -10 mm, and lower paper brings its end closer. lowest_mm is -8."""
    lines = "".join(f'<path d="M20,{30 + 30 * k} h140" stroke="#000" stroke-width="6"/>' for k in range(5))
    drawn = f'<svg xmlns="http://www.w3.org/2000/svg" width="210mm" height="200mm" viewBox="0 0 210 200">{lines}</svg>'
    work = prepared(tmp_path, 3.0, find_cell("grbl-servo"), drawn=drawn, z_offset_mm=offset_mm)
    assert is_reported(work.notices, f"paint-runs-out round-6 grbl-servo '{deepest_mm} mm'"), work.notices
    assert not simulate_and_check(work, ".gcode", Job(offset_mm)).problems


@pytest.mark.parametrize(("order", "first"), [("nearest", 1), ("drawn", 31)])
def test_another_order_and_a_resumed_job_are_reported(tmp_path, order, first):
    work = prepared(tmp_path, 0.2)
    reported = simulate_and_check(work, ".ngc", Job(first_stroke=first), order).remarks()
    assert is_reported(reported, "paint-out-of-turn" + (" 31" if first > 1 else ""))
    assert not simulate_and_check(work, ".ngc").remarks()
    often = prepared(tmp_path, 0.2, cell_with(Reload("stroke")))
    assert not simulate_and_check(often, ".ngc", Job(first_stroke=first), order).remarks()


def test_shapes_dabs_and_closed_paths_are_pressed_deeper(tmp_path):
    shapes = (
        '<rect x="20" y="40" width="60" height="4" fill="#000"/>'
        '<path d="M100,40 l0,0" stroke="#000" stroke-width="4" stroke-linecap="round"/>'
        '<circle cx="60" cy="80" r="15" fill="none" stroke="#000" stroke-width="3"/>'
    )
    long = '<path id="long" d="M10,120 h180 v20 h-180 v20 h180" fill="none" stroke="#000" stroke-width="2"/>'
    size = 'width="210mm" height="297mm" viewBox="0 0 210 297"'
    drawn = f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{long}{shapes}</svg>'
    for compensation in ("closed", "refined"):
        off = [prepared(tmp_path, rate, compensation=compensation, drawn=drawn) for rate in (0.0, 0.2)]
        assert len(off[1].plan.passes) == len(off[0].plan.passes) == 4
        kept, pressed = (mean_overlap(work, 0.2) for work in off)
        assert pressed > kept + 0.04
        assert pressed > mean_overlap(off[0], 0.0) - 0.02


def test_check_accepts_the_program(tmp_path, capsys):
    brush = brush_of(0.4)
    (tmp_path / "b.json").write_bytes(_core.write_brush(brush).encode())
    cell = cell_with(Reload("length", 200.0, 6.0, narrower_percent=15.0))
    (tmp_path / "c.toml").write_text(write_cell(cell))
    (tmp_path / "d.svg").write_text(drawing())
    out = str(tmp_path / "d.ngc")
    flags = ["--brush", str(tmp_path / "b.json"), "--cell", str(tmp_path / "c.toml")]
    assert main(["convert", str(tmp_path / "d.svg"), "-o", out, *flags]) == 0
    assert main(["check", out, str(tmp_path / "d.svg"), *flags]) == 0, capsys.readouterr()


def test_check_repeats_that_the_brush_runs_dry(tmp_path):
    brush = find_brush("round-6")
    brush.paint = _core.Paint(0.1, lasts_mm=50.0)
    (tmp_path / "d.svg").write_text(drawing())
    out = tmp_path / "d.ngc"
    written = brushsvg.convert(tmp_path / "d.svg", out, brush=brush)
    checked = brushsvg.check(out, tmp_path / "d.svg", brush=brush)
    for notices in (written.notices, checked.notices):
        assert is_reported(notices, "paint-runs-out '[0, 50] mm' round-6"), notices
