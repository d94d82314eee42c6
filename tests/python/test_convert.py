"""`convert` writes the files of each language."""

import re
from dataclasses import replace

import numpy as np
import pytest
from diagnostics import refused

from brushsvg import _core
from brushsvg.cli import main
from brushsvg.jobs.preparation import preparation
from brushsvg.jobs.prepared_drawing import order_nearest_first
from brushsvg.machine import job_program, moves, writer
from brushsvg.machine.cells.cell_file import SHIPPED, find_cell
from brushsvg.planning import painting_order

TWO_DEPTHS = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="70mm" viewBox="0 0 120 70">
<g fill="none" stroke="#000"><path id="thin" d="M20 50 C40 10 60 10 90 40" stroke-width="1.6"/>
<path id="bold" d="M20 60 C50 40 70 70 95 50" stroke-width="4.5"/></g></svg>"""


@pytest.fixture
def drawing(tmp_path):
    path = tmp_path / "two.svg"
    path.write_text(TWO_DEPTHS)
    return path


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
