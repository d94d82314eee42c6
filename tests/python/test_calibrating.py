"""brushsvg.calibrate and `brushsvg calibrate` give the same results.

Both return the same brush, the same report and the same refusals.
"""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from diagnostics import refused

import brushsvg
from brushsvg.calibration.chart.photograph import list_measured_marks
from brushsvg.cli import main
from brushsvg.jobs.calibrating import GivenOptions, make_checked_options, read_chart_photographs
from brushsvg.jobs.calibration_options import CalibrationOptions, find_contradiction

NUMBERS = "kind,depth_mm,value_mm\nlag,1,1.9\nlag,2,2.4\nlag,3,3.1\nwidth,1,2.2\nwidth,2,4.1\nwidth,3,6.2\n"


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text(NUMBERS)
    return path


def test_python_and_the_command_give_equal_bytes_and_reports(table, tmp_path, capsys):
    out = tmp_path / "brush.json"
    assert main(["calibrate", str(table), "-o", str(out)]) == 0
    printed = capsys.readouterr().out
    made = brushsvg.calibrate(table, "brush")
    assert isinstance(made, brushsvg.BrushCalibration)
    assert brushsvg._core.write_brush(made.brush) == out.read_text()
    assert made.text == printed


def test_names_come_from_the_call_or_the_file(table):
    assert brushsvg.calibrate(table).brush.name == "mine"
    assert brushsvg.calibrate(table, "other").brush.name == "other"


def test_the_name_in_measurements_yields_only_to_the_name_in_the_call(tmp_path):
    rows = [line.split(",") for line in NUMBERS.splitlines()[1:]]
    measured = {"name": "own"}
    for kind, depth_mm, value_mm in rows:
        measured.setdefault(kind, []).append({"depth_mm": float(depth_mm), "value_mm": float(value_mm)})
    assert brushsvg.calibrate(measured).brush.name == "own"
    assert brushsvg.calibrate(measured, "other").brush.name == "other"
    path, out = tmp_path / "measured.json", tmp_path / "brush.json"
    path.write_text(json.dumps({"format": "brushsvg/measurements", "version": 1, **measured}))
    assert main(["calibrate", str(path), "-o", str(out), "--quiet"]) == 0
    assert brushsvg.find_brush(out).name == "own"


def test_a_calibration_of_numbers_has_no_photograph(table):
    with refused("nothing-to-show"):
        brushsvg.calibrate(table).picture()


CONTRADICTIONS = [
    ("marks.json", {"chart": "chart.json"}),
    ("marks.json", {"cell": "ur5e"}),
    ("marks.json", {"plan": "plan.json", "prior": "round-6"}),
    ("photo.jpg", {}),
    ("photo.jpg", {"chart": "chart.json", "paint": True, "aim": "overlap"}),
    ("photo.jpg", {"chart": "chart.json", "brush": "round-6", "aim": "overlap"}),
    ("photo.jpg", {"chart": "chart.json", "absolute": True}),
    ("photo.jpg", {"chart": "chart.json", "total": True}),
    ("photo.jpg", {"chart": "chart.json", "dpi": 300.0, "bar_mm": 100.0}),
    ("photo.jpg", {"plan": "plan.json"}),
    ("photo.jpg", {"plan": "plan.json", "prior": "round-6", "aim": "overlap"}),
    (["photo.jpg", "marks.json"], {"chart": "chart.json"}),
]


@pytest.mark.parametrize(("source", "options"), CONTRADICTIONS)
def test_options_that_contradict_are_refused_before_any_file_is_read(source, options):
    assert find_contradiction(source, CalibrationOptions(**options))
    with refused("options-contradict"):
        brushsvg.calibrate(source, **options)


@pytest.mark.parametrize(
    "options",
    [{}, {"machine": ("lean",)}, {"spread": "spread.json"}, {"height_mm": 0.1}],
    ids=lambda options: [*options],
)
def test_options_that_dabs_do_not_have_are_refused_before_the_photograph_is_read(options):
    chart = brushsvg.chart(brushsvg.find_brush("round-6"), (210, 297), "few", dabs=True)
    known = {"brush": "round-6"} if options else {}
    with refused("options-contradict"):
        brushsvg.calibrate("missing.jpg", chart=chart, **known, **options)
    with refused("brush-unknown"):
        brushsvg.calibrate("missing.jpg", chart=chart, brush="nobody")


def test_files_of_options_are_refused_before_the_photograph_is_read(tmp_path):
    chart = brushsvg.chart(brushsvg.find_brush("round-6"), (210, 297), "few")
    (tmp_path / "spread.json").write_text("[]")
    for options, file in (({"spread": tmp_path / "spread.json"}, "spread.json"), ({"brush": "rigid"}, "rigid")):
        with pytest.raises(brushsvg.Error) as caught:
            brushsvg.calibrate("missing.jpg", chart=chart, **options)
        assert Path(caught.value.file).name == file, caught.value


@pytest.mark.parametrize("option", ["absolute", "total"])
def test_options_for_numbers_are_refused_for_painted_marks(option):
    with refused("options-contradict"):
        brushsvg.calibrate({"plan": {}, "marks": [{}]}, **{option: True})


def test_the_command_refuses_contradicting_options_as_wrong_usage(table, capsys):
    assert main(["calibrate", str(table), "-o", "b.json", "--chart", "chart.json"]) == 2
    assert find_contradiction(str(table), CalibrationOptions(chart="chart.json")) in capsys.readouterr().err


def test_an_unknown_option_is_a_type_error(table):
    with pytest.raises(TypeError, match="known are"):
        brushsvg.calibrate(table, colour="red")


def test_type_checkers_know_every_option():
    assert [*GivenOptions.__annotations__] == [*CalibrationOptions.__dataclass_fields__]


def test_help_lists_every_option():
    listed = re.findall(r"^ *(\w+):", brushsvg.calibrate.__doc__, re.M)
    assert listed == ["source", "name", "progress", *CalibrationOptions.__dataclass_fields__]


def test_a_list_of_one_file_equals_the_file(table):
    assert brushsvg.calibrate([table]).brush == brushsvg.calibrate(table).brush


def test_a_resolution_too_low_to_measure_is_refused():
    with refused("out-of-range dpi"):
        brushsvg.calibrate("scan.png", chart="chart.json", dpi=50)


@pytest.mark.slow
def test_a_chart_and_a_plan_may_be_given_as_their_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main("chart -o c.ngc --chart chart.json --strokes few --quiet".split()) == 0
    assert main("simulate-photo chart.json -o photo.jpg --quiet".split()) == 0
    chart = brushsvg.chart(brushsvg.find_brush("round-6"), (210, 297), "few")

    def read(chart):
        found = read_chart_photographs(["photo.jpg"], make_checked_options({"chart": chart}), print, print)
        return found.chart, list_measured_marks(found)

    by_path, by_chart = read("chart.json"), read(chart)
    assert len(by_path[1]) == len(chart.strokes) and by_chart == by_path
    with refused("chart-markers", "dictionary"):
        read(replace(chart, dictionary="none"))
    Path("plan.json").write_text(brushsvg.write_plan(chart.plan))
    refusals = []
    for plan in ("plan.json", chart.plan):
        with pytest.raises(brushsvg.Error) as caught:  # the photograph shows the page of the chart
            brushsvg.calibrate("photo.jpg", plan=plan, prior="round-6")
        refusals.append((caught.value.code, caught.value.file, str(caught.value)))
    assert refusals[0] == refusals[1] and refusals[0][1] == "photo.jpg"


@pytest.mark.parametrize("name", ["chart", "plan", "spread"])
def test_what_is_neither_a_file_nor_its_contents_is_refused(name):
    with refused(f"wrong-type 3 {name}"):
        brushsvg.calibrate("photo.jpg", **{name: 3})


@pytest.mark.parametrize(
    "options", [{"brush": 5}, {"prior": 5, "plan": "plan.json"}, {"cell": 5, "machine": ("axes",)}]
)
def test_a_brush_or_cell_that_is_neither_name_nor_value_is_refused(options):
    with refused("wrong-type 5"):
        brushsvg.calibrate("photo.jpg", **options)
