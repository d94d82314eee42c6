"""Jobs around painting from Python: programs to set up a machine, charts, and simulated photographs.

Their results equal the files of the commands byte for byte.
"""

from dataclasses import replace
from pathlib import Path

import pytest
from diagnostics import refused

import brushsvg
from brushsvg.cli import main
from brushsvg.machine.cells.cell import Machine
from brushsvg.machine.cells.cell_file import write_cell

DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="80mm" viewBox="0 0 120 80">'
    '<path id="a" d="M20 20H90" fill="none" stroke="#000" stroke-width="3"/>'
    '<path id="b" d="M20 40C40 60 70 60 90 40" fill="none" stroke="#000" stroke-width="2"/></svg>'
)
STUDIO = 'format = "brushsvg/studio"\nversion = 1\n[brush]\nlag = 1.1\n'


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("word.svg").write_text(DRAWING, encoding="utf-8")
    Path("studio.toml").write_text(STUDIO, encoding="utf-8")
    return tmp_path


def written(*words) -> bytes:
    """Run a command that writes the file after -o, and return its bytes."""
    assert main(list(words)) == 0
    return Path(words[words.index("-o") + 1]).read_bytes()


JOBS = {
    "border": (
        ("setup", "border", "word.svg", "-o", "own.gcode", "--cell", "grbl-3axis", "--z-offset", "0.5"),
        lambda: brushsvg.setup_border("word.svg", "py.gcode", cell="grbl-3axis", z_offset=0.5),
    ),
    "first run": (
        ("setup", "first-run", "linuxcnc-3axis", "-o", "own.ngc", "--sheet", "160x100", "--brush", "liner-1"),
        lambda: brushsvg.setup_first_run("linuxcnc-3axis", "py.ngc", sheet=(160, 100), brush="liner-1"),
    ),
    "height": (
        ("setup", "height", "-o", "own.script", "--cell", "ur5e", "--from", "0.5", "--to", "-0.5", "--step", "0.25"),
        lambda: brushsvg.setup_height("ur5e", "py.script", highest=0.5, lowest=-0.5, step=0.25),
    ),
}


@pytest.mark.parametrize("name", JOBS)
def test_python_writes_the_same_setup_program_as_the_command(desk, name):
    words, make = JOBS[name]
    own = written(*words)
    made = make()
    assert own == Path("py" + Path(words[words.index("-o") + 1]).suffix).read_bytes() == made.text.encode()
    assert made.time_s > 1
    assert made.stroke_count == {"border": 0, "first run": 22, "height": 5}[name]


def test_a_setup_program_without_a_path_is_only_returned(desk):
    made = brushsvg.setup_border("word.svg", cell="grbl-3axis")
    assert "border of" in made.text
    assert {path.name for path in desk.iterdir()} == {"word.svg", "studio.toml"}
    assert [notice.code for notice in brushsvg.setup_border("word.svg", cell="ur5e").notices] == ["paper-example"]


def test_a_border_warns_of_limits_that_the_job_breaks_at_its_own_height(desk):
    cell = brushsvg.find_cell("linuxcnc-3axis")
    low = replace(cell, workspace=replace(cell.workspace, box_mm=((-99.0, -99.0, -5.0), (500.0, 500.0, 60.0))))
    with refused("out-of-box 'z -6.6' '[-5, 60]'", "a"):
        brushsvg.convert("word.svg", cell=low, z_offset=-3.0)
    assert not any(notice.refused for notice in brushsvg.setup_border("word.svg", cell=low).notices)
    made = brushsvg.setup_border("word.svg", cell=low, z_offset=-3.0)
    assert {(each.code, each.where) for each in made.notices if each.refused} == {
        ("out-of-box", "a"),
        ("out-of-box", "b"),
    }


def test_a_long_setup_program_is_written_in_several_files(desk):
    """A dense map of the paper gives each stroke more lines than one program of URScript has room for."""
    places = [(float(x), float(y)) for x in range(0, 126, 5) for y in range(20, 201, 5)]
    bumpy = Machine(map_mm=tuple((x, y, 0.3 * ((x + y) // 5 % 2)) for x, y in places))
    cell = replace(brushsvg.find_cell("ur5e"), name="bumpy", machine=bumpy)
    Path("bumpy.toml").write_text(write_cell(cell), encoding="utf-8")
    made = brushsvg.setup_height(cell, "py.script", sheet=(200, 200), step=0.021)
    assert made.text == Path("py.script").read_text() + Path("py-part2.script").read_text()
    assert brushsvg.check("py.script", cell=cell).problems == ()
    words = ("setup", "height", "--cell", "bumpy.toml", "--sheet", "200x200", "--step", "0.021", "-o", "own.script")
    assert main([*words, "--force"]) == 0
    assert Path("own-part2.script").read_bytes() == Path("py-part2.script").read_bytes()
    assert "programs-of-before" not in {notice.code for notice in made.notices}
    # Shorter programs at the same path leave the second part there. Nobody should run it.
    for shorter in (
        brushsvg.setup_height(cell, "py.script", sheet=(200, 200)),
        brushsvg.convert("word.svg", "py.script", cell=cell),
    ):
        (named,) = [notice for notice in shorter.notices if notice.code == "programs-of-before"]
        assert "py-part2.script" in named.sentence


def test_setup_programs_are_also_written_in_a_binary_format(desk):
    own = written("setup", "height", "--cell", "fr3", "-o", "own.cdr")
    assert own == brushsvg.setup_height("fr3", "py.cdr").text == Path("py.cdr").read_bytes()


@pytest.mark.parametrize(
    ("workspace", "code", "key"),
    [
        ({"box_mm": ((-500.0, -900.0, -50.0), (-120.0, -200.0, 500.0))}, "out-of-box", "box_mm"),
        ({"box_mm": ((-500.0, -900.0, -50.0), (500.0, -200.0, 30.0))}, "out-of-box z", "box_mm"),
        ({"reach_mm": (200.0, 620.0)}, "out-of-reach", "reach_mm"),
        ({"keep_out_mm": (((-129.0, -800.0, -50.0), (-120.0, -200.0, 500.0)),)}, "in-kept-out-box", "keep_out_mm"),
    ],
)
def test_setup_programs_beyond_a_limit_of_place_are_refused_with_a_remedy(desk, workspace, code, key):
    cell = brushsvg.find_cell("ur5e")
    cell = replace(cell, workspace=replace(cell.workspace, **workspace))
    for setup in (
        lambda: brushsvg.setup_height(cell),
        lambda: brushsvg.setup_first_run(cell),
        lambda: brushsvg.setup_border("word.svg", cell=cell),
        lambda: brushsvg.convert("word.svg", cell=cell).program(".script"),
    ):
        with refused(code) as reported:
            setup()
        assert f"workspace.{key}" in reported.value.advice


def test_setup_programs_refuse_wrong_values(desk):
    with refused("program-format"):
        brushsvg.setup_border("word.svg", "border.script", cell="grbl-3axis")
    with refused("cannot-wait"):
        brushsvg.setup_first_run("axidraw-ebb")
    with refused("out-of-range"):
        brushsvg.setup_height(step=0.0)
    with refused("wrong-type"):
        brushsvg.setup_height(highest="high")
    with refused("height-out-of-range"):
        brushsvg.setup_height(lowest=-15, step=1)
    with refused("wrong-type"):
        brushsvg.setup_first_run("grbl-3axis", 3)
    for setup in (brushsvg.setup_height, brushsvg.setup_first_run):
        assert setup("grbl-3axis", sheet=None).text == setup("grbl-3axis").text, "None is the default, as for convert"


def test_nothing_that_is_read_is_replaced(desk):
    pen = "G21\nG90\nG0 Z5\nG0 X20 Y20\nG1 Z-1 F300\nG1 X60 Y20 F600\nG0 Z5\nM2\n"
    Path("pen.gcode").write_text(pen, encoding="utf-8")
    calls = (
        lambda: brushsvg.setup_border("pen.gcode", desk / "pen.gcode", cell="grbl-3axis", width=3),
        lambda: brushsvg.setup_height("grbl-3axis", "pen.gcode", brush="pen.gcode"),
        lambda: brushsvg.simulate_photo("word.svg", "word.jpg", true_brush="word.jpg"),
    )
    for call in calls:
        with refused("options-contradict"):
            call()
    assert Path("pen.gcode").read_text(encoding="utf-8") == pen
    for nowhere in ("", "program"):
        with refused("program-format"):
            brushsvg.setup_height("grbl-3axis", nowhere)


def test_python_makes_the_same_chart_as_the_command(desk):
    own = written(
        *("chart", "-o", "own.ngc", "--sheet", "250x180", "--strokes", "few"),
        *("--chart", "own.json", "--page", "own.svg"),
    )
    brush = brushsvg.find_brush("round-6")
    chart = brushsvg.chart(brush, (250, 180), "few", deepest_mm=10)
    brushsvg.write_program("py.ngc", chart.plan, brush, "calibration chart of brush round-6")
    assert Path("py.ngc").read_bytes() == own
    assert brushsvg.write_chart(chart) == Path("own.json").read_text(encoding="utf-8")
    assert brushsvg.chart_page(chart, ".svg") == Path("own.svg").read_bytes()
    assert brushsvg.chart_page(chart, ".pdf").startswith(b"%PDF")
    with refused("choice-unknown"):
        brushsvg.chart_page(chart, ".png")


@pytest.mark.parametrize("choices", [{}, {"studio": "studio.toml"}, {"true_brush": "liner-1", "seed": 3}])
def test_python_simulates_the_same_photograph_as_the_command(desk, choices):
    flags = [word for name, value in choices.items() for word in ("--" + name.replace("_", "-"), str(value))]
    own = written("simulate-photo", "word.svg", "-o", "own.jpg", *flags)
    made = brushsvg.simulate_photo("word.svg", "py.jpg", **choices)
    assert own == Path("py.jpg").read_bytes() == made.jpeg
    assert "lag = 1.1\n" in made.studio or "studio" not in choices


def test_a_chart_is_photographed_from_its_file_and_from_its_value(desk):
    chart_brush = brushsvg.find_brush("round-6")
    chart = brushsvg.chart(chart_brush, (180, 180), "few")
    Path("chart.json").write_text(brushsvg.write_chart(chart), encoding="utf-8")
    for drawing in (chart, "chart.json"):
        photographed = brushsvg.simulate_photo(drawing, "photo.jpg", studio="studio.toml")
        assert photographed.stroke_count == len(chart.plan.passes)
        assert brushsvg.calibrate("photo.jpg", chart=chart).brush.lag(4) > 1.05 * chart_brush.lag(4)


def test_a_pass_of_one_pose_is_photographed_by_a_machine_with_backlash(desk):
    plan = brushsvg.convert("word.svg").plan
    dab = brushsvg.Pass("a", [[40, 40, -2]], 20, "#000000")
    Path("studio.toml").write_text(STUDIO + "[machine]\nbacklash_mm = [0.3, 0.3]\n", encoding="utf-8")
    dotted = brushsvg.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, [dab, plan.passes[1]])
    assert brushsvg.simulate_photo(dotted, studio="studio.toml").stroke_count == 2


def test_a_simulated_photograph_refuses_wrong_values(desk):
    with refused("program-format"):
        brushsvg.simulate_photo("word.svg", "photo.png")
    with refused("out-of-range"):
        brushsvg.simulate_photo("word.svg", seed=0)
    with refused("wrong-type"):
        brushsvg.simulate_photo("word.svg", studio=3)
    with refused("wrong-type"):
        brushsvg.simulate_photo("word.svg", true_brush=3)
