"""Strokes in the margin of a page: where they are added and where not.

They change no figure in the report on the drawing.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from diagnostics import in_json, is_reported
from shapely.geometry import Polygon, box

import brushsvg
from brushsvg import _core
from brushsvg.cli import main
from brushsvg.comparison.job_page import job_page
from brushsvg.jobs.json_files import read_plan
from brushsvg.jobs.preparation.margin_strokes import is_calibrated
from brushsvg.model.confidence import LAWS
from brushsvg.model.library import save_brush

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="{0}mm" height="60mm" viewBox="0 0 {0} 60">
<g fill="none" stroke="#000"><path id="bow" d="M14 40 C24 16 34 16 {1} 38" stroke-width="3"/>
<path id="margin-1" d="M12 52 H{1}" stroke-width="2"/></g></svg>"""


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "word.svg").write_text(SVG.format(110, 80))
    words = "brush new -o mine.json --lag-at 1=5 --lag-at 4=8 --lag-at 8=11 --width-at 3=2.4 --width-at 8=5.8 --quiet"
    assert main(words.split()) == 0
    return tmp_path


def run(line: str) -> None:
    assert main([*line.split(), "--quiet", "--force"]) == 0, line


def added(plan) -> list:
    return [each for each in plan.passes if each.settings.kind == "margin"]


def test_margin_strokes_are_added_for_an_uncalibrated_brush(desk):
    run("convert word.svg -o plan.json --brush mine.json --page page.svg")
    run("convert word.svg -o bare.json --brush mine.json")
    plan, bare = read_plan("plan.json"), read_plan("bare.json")
    own = [each for each in plan.passes if each.settings.kind != "margin"]
    assert own == list(bare.passes)  # margin strokes do not change the job itself
    assert [each.stroke for each in added(plan)] == [
        "margin-2",
        "margin-3",
        "margin-4",
    ]  # the drawing has a stroke named margin-1
    deepest = [-np.min(each.poses_mm[:, 2]) for each in added(plan)]
    assert deepest == sorted(deepest) and deepest[0] < 0.6 * deepest[2]
    assert deepest[2] <= max(-np.min(each.poses_mm[:, 2]) for each in own) + 0.01  # no deeper than the job
    assert plan.sheet_mm[0] == bare.sheet_mm[0] and plan.sheet_mm[1] > bare.sheet_mm[1]
    for flags in ("--brush mine.json", "--brush mine.json --page page.svg --margin-strokes off"):
        run(f"convert word.svg -o plan.json {flags}")
        assert not added(read_plan("plan.json"))
    run("convert word.svg -o plan.json --brush mine.json --margin-strokes on")
    assert len(added(read_plan("plan.json"))) == 3


def test_margin_strokes_stay_apart_with_half_or_one_and_a_half_times_the_lag(desk):
    run("convert word.svg -o plan.json --brush mine.json --page page.svg")
    plan, brush = read_plan("plan.json"), brushsvg.find_brush("mine.json")
    page = job_page(plan)
    markers = [Polygon(marker.corners_mm) for marker in page.printed.markers]
    sheet = box(0, 0, *plan.sheet_mm)
    for share in (0.5, 1.0, 1.5):
        other = brushsvg.find_brush("mine.json")
        other.lag = _core.Profile([share * each for each in brush.lag.coefficients])
        marks = _core.simulate(plan, other)
        _core.trace_outlines(marks, other)
        shapes = {
            each.stroke: Polygon(each.outline_mm[0]).buffer(0)
            for each, a_pass in zip(marks.passes, plan.passes, strict=True)
            if a_pass.settings.kind == "margin"
        }
        for name, shape in shapes.items():
            assert sheet.contains(shape) and shape.bounds[1] > 60, (share, name)
            moved = Polygon(np.array(shape.exterior.coords) + page.frame_mm)
            assert not any(moved.intersects(marker) for marker in markers)
            assert all(shape.distance(each) > 1 for key, each in shapes.items() if key != name)


def test_check_and_report_ignore_margin_strokes(desk, capsys):
    run("convert word.svg -o with.ngc --brush mine.json --page page.svg --report with.json")
    run("convert word.svg -o bare.ngc --brush mine.json --report bare.json")
    reports = [json.loads((desk / f"{name}.json").read_text()) for name in ("with", "bare")]
    assert reports[0]["strokes"] == reports[1]["strokes"] and reports[0]["total"] == reports[1]["total"]
    assert reports[0]["time_s"] > reports[1]["time_s"] + 5
    for order in ("", " --order nearest"):
        run(f"convert word.svg -o with.ngc --brush mine.json --page page.svg{order}")
        found = brushsvg.check("with.ngc", "word.svg", brush="mine.json")
        assert not found.problems and len(found.plan.passes) == 5
        assert found.figures.total.overlap == pytest.approx(reports[1]["total"]["overlap"], abs=2e-3)
    text = (desk / "with.ngc").read_text()
    at = text.index("margin-3)")
    (desk / "cut.ngc").write_text(text[:at] + text[at:].replace("Z-", "Z", 1))
    assert brushsvg.check("cut.ngc", "word.svg", brush="mine.json").problems
    run("setup border word.svg -o border.ngc --brush mine.json --margin-strokes on")
    assert not brushsvg.check("border.ngc", "word.svg", brush="mine.json").problems


def test_margin_strokes_are_painted_in_the_colour_of_the_job(desk):
    red_bow = SVG.format(110, 80).replace('id="bow"', 'id="bow" stroke="#c62828"')
    (desk / "word.svg").write_text(red_bow)
    for colour in ("#c62828", "#000000"):
        run(f"convert word.svg -o plan.json --brush mine.json --page page.svg --colour {colour}")
        plan = read_plan("plan.json")
        assert len(added(plan)) == 3 and {each.colour for each in plan.passes} == {colour}
        deepest_of_job = max(-np.min(each.poses_mm[:, 2]) for each in plan.passes if each not in added(plan))
        assert max(-np.min(each.poses_mm[:, 2]) for each in added(plan)) <= deepest_of_job + 0.01
        run(f"convert word.svg -o word.ngc --brush mine.json --page page.svg --colour {colour}")
        run(f"check word.ngc word.svg --brush mine.json --colour {colour}")
    command = "convert word.svg -o plan.json --brush mine.json --page page.svg --force --colour #00ff00"
    assert main(command.split()) == 1  # the drawing has no such colour


def test_convert_reports_what_margin_strokes_will_calibrate(desk, capsys):
    words = "convert word.svg -o plan.json --brush mine.json --page page.svg".split()
    status, out, _ = in_json(capsys, *words)
    assert status == 0 and "margin strokes" in out and out.count("lag +-") == 3
    assert "--plan PLAN --prior" in out
    assert "margin" not in in_json(capsys, *words, "--margin-strokes", "off", "--force")[1]


@pytest.mark.parametrize(
    ("width", "cell"),
    [
        (24, ""),
        (110, "box_mm = [[-50, -50, -20], [160, 70, 200]]"),
        (110, "keep_out_mm = [[[0, 80, -50], [200, 90, 50]]]"),
    ],
    ids=["narrow sheet", "box of the workspace", "keep-out box"],
)
def test_without_space_no_margin_stroke_is_added_and_a_notice_is_given(desk, capsys, width, cell):
    lines = SVG.format(width, 80) if width > 50 else SVG.format(width, 12).replace("M12 52 H12", "M12 52 V40")
    (desk / "word.svg").write_text(lines.replace("M14 40 C24 16 34 16 12 38", "M8 20 V46"))
    run("cell new -o mine.toml")
    text = (desk / "mine.toml").read_text()
    (desk / "mine.toml").write_text(text.replace("[workspace]", f"[workspace]\n{cell}"))
    words = "convert word.svg -o job.ngc --brush mine.json --cell mine.toml --page page.svg".split()
    status, out, reported = in_json(capsys, *words)
    assert status == 0 and is_reported(reported, "margin-strokes-left-out", "margin"), reported
    assert "margin strokes" not in out
    check = brushsvg.check("job.ngc", "word.svg", brush="mine.json", cell="mine.toml")
    assert not check.problems and len(check.plan.passes) == 2


def test_a_calibrated_brush_gets_no_margin_strokes(desk):
    brush = brushsvg.find_brush("round-6")
    size = sum(len(getattr(brush, law).coefficients) for law in ("lag", "tip_gap", "tip_to_widest", "half_width"))
    brush.covariance = (1e-6 * np.eye(size)).tolist()
    save_brush(brush, "known.json")
    run("convert word.svg -o plan.json --brush known.json --page page.svg")
    assert not added(read_plan("plan.json"))
    for pen in ("rigid",):
        run(f"convert word.svg -o plan.json --brush {pen} --page page.svg")
        assert not added(read_plan("plan.json"))


def test_typed_depths_do_not_count_as_calibrated(desk):
    """Depths that were only typed do not count as calibrated.

    The brush was calibrated down to 4 mm and typed in down to 8 mm. Its range covers both, and a job of 6 mm
    once got no margin strokes.
    """
    brush = brushsvg.find_brush("mine.json")
    size = sum(len(getattr(brush, law).coefficients) for law in LAWS)
    brush.covariance = (1e-6 * np.eye(size)).tolist()
    brush.extra = json.dumps({"learned": {"deepest_mm": {law: 4.0 for law in LAWS}}})
    save_brush(brush, "mine-2.json")
    brush = brushsvg.find_brush("mine-2.json")
    assert brush.lag.calibrated_mm[1] == 8
    assert is_calibrated(brush, 3.9) and not is_calibrated(brush, 6.0)


def test_figures_of_a_photograph_exclude_margin_strokes(desk):
    """Figures from a photograph describe the drawing, not the margin strokes.

    The figures are equal with and without margin strokes, except for camera noise. `compare` finds the right
    page by itself.
    """
    (desk / "studio.toml").write_text('format = "brushsvg/studio"\nversion = 1\n[brush]\nlag = 1.15\n')
    seen = {}
    for margin in ("auto", "off"):
        run(f"simulate-photo word.svg -o {margin}.jpg --brush mine.json --studio studio.toml --margin-strokes {margin}")
        run(f"compare {margin}.jpg word.svg --brush mine.json -o {margin}.json")
        seen[margin] = json.loads((desk / f"{margin}.json").read_text())
    assert [row["stroke"] for row in seen["auto"]["strokes"]] == ["bow", "margin-1"]
    for key in ("overlap_wanted", "overlap_predicted", "overlap_sheet_placed", "overlap_strokes_placed"):
        assert seen["auto"][key] == pytest.approx(seen["off"][key], abs=0.02), key
    assert seen["auto"]["elsewhere_mm2"] < 1


def test_margin_strokes_calibrate_the_lag_at_more_depths(desk):
    """A sheet with margin strokes calibrates the lag at more depths.

    The drawing has two strokes at one depth each, so the lag at other depths stays unknown. The simulator
    supplies the true lag.
    """
    (desk / "studio.toml").write_text('format = "brushsvg/studio"\nversion = 1\n[brush]\nlag = 1.2\n')
    off = {}
    for margin in ("auto", "off"):
        flags = f"--brush mine.json --margin-strokes {margin}"
        run(f"convert word.svg -o {margin}-plan.json {flags} --page page.svg")
        run(f"simulate-photo {margin}-plan.json -o {margin}.jpg --brush mine.json --studio studio.toml")
        run(f"calibrate {margin}.jpg --plan {margin}-plan.json --prior mine.json -o {margin}-brush.json")
        found, was = (brushsvg.find_brush(name) for name in (f"{margin}-brush.json", "mine.json"))
        off[margin] = max(abs(found.lag(d) / (1.2 * was.lag(d)) - 1) for d in (2.0, 3.0, 4.0))
    learned = json.loads((desk / "auto-brush.json").read_text())["learned"]
    brush, plan = brushsvg.find_brush("auto-brush.json"), read_plan("auto-plan.json")
    deepest = max(-np.min(each.poses_mm[:, 2]) for each in plan.passes)
    assert learned["deepest_mm"]["lag"] == pytest.approx(deepest, abs=0.01)
    assert brush.lag.calibrated_mm[1] == pytest.approx(deepest, abs=0.01)  # the marks contradict the typed lag
    assert is_calibrated(brush, 0.99 * deepest) and not is_calibrated(brush, 8.0)
    assert off["auto"] < 0.03 and off["auto"] < off["off"], off
