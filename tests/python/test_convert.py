"""`convert` finds the best constant lag and writes the files of each language."""

import re
from dataclasses import replace

import numpy as np
import pytest
from diagnostics import refused

from brushsvg import _core
from brushsvg.cli import main
from brushsvg.jobs import prediction
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation import constant_lag, preparation
from brushsvg.jobs.prepared_drawing import order_nearest_first
from brushsvg.machine import job_program, moves, writer
from brushsvg.machine.cells.cell_file import SHIPPED, find_cell
from brushsvg.model.library import find_brush
from brushsvg.planning import painting_order
from brushsvg.reporting.report_text import format_overlap
from brushsvg.show.evaluation import figures, report

TWO_DEPTHS = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="70mm" viewBox="0 0 120 70">
<g fill="none" stroke="#000"><path id="thin" d="M20 50 C40 10 60 10 90 40" stroke-width="1.6"/>
<path id="bold" d="M20 60 C50 40 70 70 95 50" stroke-width="4.5"/></g></svg>"""


@pytest.fixture
def drawing(tmp_path):
    path = tmp_path / "two.svg"
    path.write_text(TWO_DEPTHS)
    return path


def total(work):
    return figures.measure_figures(figures.PaintedPlan(work.plan, prediction.predict(work), work.brush, work.strokes))[
        1
    ]


def test_the_best_constant_lag_has_the_smallest_error(drawing):
    best = constant_lag.find_best_constant_lag(preparation.prepare(drawing))
    assert best.options.compensation == "constant"
    assert 3 < best.options.lag_mm < 12
    assert best.options.lag_mm % 0.25 == 0
    there = total(best).overlap
    for lag_mm in (0.0, best.options.lag_mm - 1, best.options.lag_mm + 1, 13.0):
        options = Options(compensation="constant", lag_mm=lag_mm)
        assert total(preparation.prepare(drawing, options)).overlap < there
    again = preparation.prepare(drawing, best.options)
    assert [p.poses_mm.tolist() for p in again.plan.passes] == [p.poses_mm.tolist() for p in best.plan.passes]
    assert len(best.tracking_errors) == 2


def test_the_best_constant_lag_of_a_pen_is_zero(drawing):
    work = preparation.prepare(drawing, Options(brush=find_brush("rigid")))
    assert constant_lag.find_best_constant_lag(work).options.lag_mm == 0


def test_the_comparison_is_a_table(drawing):
    works = {how: preparation.prepare(drawing, Options(compensation=how)) for how in ("none", "closed")}
    totals = {how: total(work) for how, work in works.items()}
    lines = report.comparison_text(list(totals.items())).splitlines()
    assert len(re.split("  +", lines[2])) == 4
    assert len({len(line) for line in lines[2:]}) == 1
    for line, (how, row) in zip(lines[4:], totals.items(), strict=True):
        name, overlap, *errors_mm = line.split()
        assert (name, overlap) == (how, format_overlap(row.overlap))
        expected = (row.centre_mean_mm, row.centre_largest_mm)
        assert [float(error_mm) for error_mm in errors_mm] == pytest.approx(expected, abs=5.1e-4)


def test_a_program_is_written_in_the_language_of_its_cell(drawing):
    work = preparation.prepare(drawing)
    parts = work.plan, work.brush, "two"
    assert "".join(writer.encode(".ngc", *parts)).startswith("(title: two)")
    for suffix in (".txt", "", ".NGC"):
        with refused("program-format .json .ngc LinuxCNC"):
            writer.encode(suffix, *parts)
    cell = replace(find_cell(), language="semaphore")
    assert writer.encode(".json", *parts, cell=cell).startswith(b"{")
    with refused("language-unknown semaphore linuxcnc-3axis linuxcnc", "language"):
        writer.encode(".ngc", *parts, cell=cell)


def test_a_program_too_fast_for_the_brush_is_not_encoded(drawing):
    work = preparation.prepare(drawing)
    work.plan.passes[1].speed_mm_s = 25.5
    with refused("speed-out-of-range 25.5 '[0.000001, 25] mm/s' round-6", "bold"):
        writer.encode(".ngc", work.plan, work.brush, "two")


def test_nearest_first_order_does_not_change_the_prepared_work(tmp_path):
    line = '<path id="{}" fill="none" stroke="#000" stroke-width="3" d="M{} 20h20"/>'.format
    path = tmp_path / "three.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="70mm" viewBox="0 0 120 70">'
        + line("a", 10)
        + line("far", 90)
        + line("near", 40)
        + "</svg>"
    )
    work = preparation.prepare(path)
    moved = order_nearest_first(work)
    assert [p.stroke for p in moved.plan.passes] == [s.id for s in moved.strokes] == ["a", "near", "far"]
    assert [p.stroke for p in work.plan.passes] == [s.id for s in work.strokes] == ["a", "far", "near"]
    assert moved.plan.sheet_mm == work.plan.sheet_mm and moved.plan.brush_sha256 == work.plan.brush_sha256


def test_nearest_first_order_paints_no_colour_in_between():
    """Strokes of two colours side by side once took turns, so that the brush was changed before every stroke."""
    passes = [_core.Pass(name, np.array([[x, 20, 0], [x + 5, 20, 0]], dtype=float), 10.0) for name, x in NEIGHBOURS]
    for a_pass in passes:
        a_pass.colour = "#c62828" if a_pass.stroke.startswith("red") else "#1a237e"
    assert painting_order.list_nearest_first(passes) == [0, 2, 1, 3, 5, 4]


NEIGHBOURS = (("red 1", 10), ("red 2", 90), ("red 3", 50), ("blue 1", 16), ("blue 2", 96), ("blue 3", 56))


def test_loads_of_a_stroke_stay_together_in_nearest_first_order():
    """The loads of a stroke stay together even if other strokes begin nearer.

    The second load once counted as a load of another stroke and was painted after that stroke.
    """
    rows = {"a": (0, 40, 1), "a+2": (35, 80, 2), "b": (40, 20, 0)}
    passes = []
    for name, (begin, end, load) in rows.items():
        poses = [(begin, 20, 0), (begin, 20, -2), (end, 20, -2), (end, 20, 0)]
        passes.append(_core.Pass(name, np.array(poses, dtype=float), 10.0))
        passes[-1].load = load
    assert painting_order.list_nearest_first(passes) == [0, 1, 2]
    passes[1].load = 0
    assert painting_order.list_nearest_first(passes) == [0, 2, 1], "b begins where a ends"


FEW_COLOURS = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
width="120mm" height="70mm" viewBox="0 0 120 70"><title>two</title>
<g inkscape:groupmode="layer" inkscape:label="one" fill="none" stroke="#000000" stroke-width="3">
<path id="a" d="M20 50 C40 10 60 10 90 41" data-brushsvg-passes="2"/>
<path id="b" d="M20 60 h30 v-20 h-12" stroke="#ff0000" data-brushsvg-reload="true"/></g>
<g inkscape:groupmode="layer" inkscape:label="two" fill="none" stroke="#000000" stroke-width="2">
<path id="c" d="M20 20 h80 m0 3 h-80" data-brushsvg-reload="false"/></g></svg>"""
PAINT = """
[reload]
when = "{when}"
every_mm = 60
[[stations]]
name = "ink"
place_mm = [-15, 20]
depth_mm = 3
[[stations]]
name = "red"
place_mm = [-15, 35]
colours = ["#ff0000"]
depth_mm = 2
"""


@pytest.mark.parametrize("when", ["length", "stroke", "layer"])
@pytest.mark.parametrize("name", ["linuxcnc-3axis", "ur5e"])
def test_a_program_from_a_saved_plan_equals_the_program_from_the_drawing(tmp_path, monkeypatch, name, when):
    """A program made from a saved plan equals the program made from the drawing.

    The headers may differ in lines that a plan does not contain: the drawing's title and the planning method.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "some.svg").write_text(FEW_COLOURS)
    (tmp_path / "mine.toml").write_text((SHIPPED / f"{name}.toml").read_text() + PAINT.format(when=when))
    suffix = ".script" if name == "ur5e" else ".ngc"
    files = (
        ("some.svg", "-o", "some.json"),
        ("some.json", "-o", f"by{suffix}"),
        ("some.svg", "-o", f"direct{suffix}"),
    )
    for each in files:
        assert main(["convert", *each, "--cell", "mine.toml", "--quiet"]) == 0
    ours, theirs = ((tmp_path / f"{one}{suffix}").read_text().splitlines() for one in ("by", "direct"))
    planned = re.compile(r"(\(|  # )(title|compensation|warnings): .*")
    reported = [[line for line in lines if not planned.fullmatch(line)] for lines in (ours, theirs)]
    assert reported[0] == reported[1]
    parts = [line for line in theirs if "stroke " in line]
    assert any("a+2" in line for line in parts) == (when == "length") and any("a#2" in line for line in parts)
    assert sum("paint: " in line for line in theirs) >= 3


def test_each_stroke_and_its_time_are_computed_once(drawing, tmp_path, monkeypatch):
    requested, timed = [], []
    as_written, duration_s = job_program.as_written, moves._duration_s
    monkeypatch.setattr(job_program, "as_written", lambda *args: requested.append(args[0].stroke) or as_written(*args))
    monkeypatch.setattr(moves, "_duration_s", lambda made: timed.append(made) or duration_s(made))
    assert main(["convert", str(drawing), "-o", str(tmp_path / "a.ngc"), "--quiet"]) == 0
    assert requested
    assert len(requested) == len(set(requested))
    assert len(timed) == 1
