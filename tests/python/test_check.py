"""brushsvg.check does the same as the command, in one call from Python."""

import json
from concurrent.futures import CancelledError
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import in_json, is_reported, refused
from programs import LANGUAGES

import brushsvg

PAGE = '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">{}</svg>'
LINE = '<path id="{}" d="M{} 40 C40 10 60 10 {} 30" fill="none" stroke="black" stroke-width="{}"/>'
TWO = PAGE.format(LINE.format("a", 20, 90, 3) + LINE.format("b", 30, 100, 4))


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """A folder with a drawing and its program."""
    monkeypatch.chdir(tmp_path)
    Path("two.svg").write_text(TWO)
    brushsvg.convert("two.svg", "two.ngc")
    return tmp_path


def test_a_valid_program_agrees_with_its_drawing(desk):
    made = brushsvg.convert("two.svg", figures=True)
    found = brushsvg.check("two.ngc", "two.svg")
    assert (found.job, found.problems, found.is_compared, found.is_foreign) == ("painting", (), True, False)
    assert found.time_s == pytest.approx(made.time_s, abs=0.01)
    # LinuxCNC rounds corners by a few hundredths of a millimetre, at both edges of lines of 3 and 4 mm.
    assert found.figures.total.overlap == pytest.approx(made.figures.total.overlap, abs=2e-3)
    for ours, theirs in zip(found.plan.passes, made.plan.passes, strict=True):
        assert np.abs(ours.poses_mm[-1] - theirs.poses_mm[-1]).max() < 2e-3


def test_the_report_has_the_title_of_the_drawing(desk):
    """A program has ASCII letters only: the report once began with "...... ...." for this title."""
    Path("two.svg").write_text(TWO.replace("<path", "<title>Привет, мир</title><path", 1))
    brushsvg.convert("two.svg", "title.gcode", cell="grbl-3axis")
    assert brushsvg.check("title.gcode", "two.svg").figures.title == "Привет, мир"
    assert "Привет" not in brushsvg.check("title.gcode").figures.title


def test_check_reports_the_same_codes_as_the_command(desk, capsys):
    lines = Path("two.ngc").read_text().splitlines(keepends=True)
    Path("short.ngc").write_text("".join(line for line in lines if not line.startswith("G2 ")))
    status, _, reported = in_json(capsys, "check", "short.ngc", "two.svg")
    found = brushsvg.check("short.ngc", "two.svg")
    assert status == 1 and found.problems
    assert {problem.code for problem in found.problems} == {each.code for _, each in reported}

    _, output, _ = in_json(capsys, "check", "two.ngc", "two.svg", "--json")
    alone = brushsvg.check(desk / "two.ngc")
    assert not alone.is_compared
    reported = json.loads(output)["total"]["overlap"]
    assert brushsvg.check("two.ngc", "two.svg").figures.total.overlap == pytest.approx(reported, abs=1e-3)


@pytest.mark.parametrize("cell", ["linuxcnc-3axis", "grbl-3axis"])
def test_a_program_for_a_brush_and_a_cell_with_long_names_is_accepted(desk, cell):
    brush = brushsvg.find_brush("round-6")
    brush.name = "b" * 110
    named = replace(brushsvg.find_cell(cell), name="c" * 190)
    brushsvg.convert("two.svg", "long.ngc", brush=brush, cell=named)
    assert brushsvg.check("long.ngc", "two.svg", brush=brush, cell=named).problems == ()


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("name", ["x, 5 strokes", "a" * 60, 'ten% "of"; G0; -- (it) ', "日本 Käfig"])
def test_a_program_of_another_cell_or_brush_is_refused_by_its_name(desk, language, name):
    cell, brush = brushsvg.find_cell(language), brushsvg.find_brush("round-6")
    named_cell, named_brush = replace(cell, name=name), brushsvg.find_brush("round-6")
    named_brush.name = name
    program = f"named{LANGUAGES[language]}"
    brushsvg.convert("two.svg", program, brush=named_brush, cell=named_cell)
    assert brushsvg.check(program, "two.svg", brush=named_brush, cell=named_cell).problems == ()
    for other in ({"brush": named_brush, "cell": cell}, {"brush": brush, "cell": named_cell}):
        with refused("program-for-other"):
            brushsvg.check(program, **other)


def test_flags_for_the_drawing_have_no_effect_without_one(desk, capsys):
    status, _, reported = in_json(capsys, "check", "two.ngc", "--width", "3", "--detail", "fine", "--sheet", "120x60")
    assert status == 0
    assert [each.sentence.split()[0] for _, each in reported] == ["--width", "--detail"]
    project = {"width": 3.0, "from_project": ("width",)}
    assert brushsvg.check("two.ngc", **project).notices == (), "a project also serves other commands"
    assert is_reported(brushsvg.check("two.ngc", colour="red").notices, "flag-without-effect --colour")


def test_notices_are_returned_and_not_printed(desk, capsys):
    white = LINE.format("w", 20, 90, 3).replace("black", "white")
    Path("white.svg").write_text(PAGE.format(white))
    brushsvg.convert("white.svg", "white.ngc")
    found = brushsvg.check("white.ngc", "white.svg")
    assert found.notices and capsys.readouterr() == ("", "")
    assert is_reported(found.notices, "white-paint", "w")


def test_a_foreign_program_is_checked_with_a_brush(desk):
    Path("pen.ngc").write_text("G21 G90\nG0 Z5\nG0 X20 Y20\nG1 Z-3 F600\nG1 X80 Y20\nG0 Z5\nM2\n")
    found = brushsvg.check("pen.ngc", sheet=(120, 60))
    assert found.is_foreign and found.time_s is None and len(found.plan.passes) == 1
    assert brushsvg.check("pen.ngc", sheet=(120, 21)).problems[0].code == "mark-off-sheet"
    with refused("nothing-to-compare"):
        brushsvg.check("pen.ngc", "two.svg")


def test_a_setup_program_is_checked(desk, capsys):
    assert in_json(capsys, "setup", "border", "two.svg", "-o", "border.ngc")[0] == 0
    found = brushsvg.check("border.ngc", "two.svg")
    left, bottom, right, top = found.border_mm
    assert (found.job, found.problems, found.plan, found.figures) == ("border", (), None, None)
    assert 15 < left < 25 < 90 < right < 120 and 10 < bottom < top < 60
    plan = brushsvg.convert("two.svg").plan
    tool_mm = np.vstack([a_pass.poses_mm[:, :2] for a_pass in plan.passes])
    assert np.all(tool_mm >= (left, bottom)) and np.all(tool_mm <= (right, top)), "a clamp there would be hit"
    moved = TWO.replace("M20 40", "M5 50")
    Path("moved.svg").write_text(moved)
    assert is_reported(brushsvg.check("border.ngc", "moved.svg").problems, "border-elsewhere")


def test_unreadable_files_and_options_without_effect_are_refused(desk):
    with refused("file-unreadable") as caught:
        brushsvg.check("none.ngc")
    assert caught.value.file == "none.ngc"
    with refused("flag-without-effect", "tolerance"):
        brushsvg.check("two.ngc", "two.svg", tolerance=0.2)
    with refused("options-contradict", "corrections"):
        brushsvg.check("two.ngc", corrections="c.json")
    Path("bad.svg").write_text("<svg")
    with refused("not-xml") as caught:
        brushsvg.check("two.ngc", "bad.svg")
    assert caught.value.file == "bad.svg"


def test_an_open_drawing_or_a_plan_is_accepted(desk):
    design = brushsvg.read_drawing("two.svg")
    assert brushsvg.check("two.ngc", design).problems == ()
    made = brushsvg.convert("two.svg", "two.json")
    assert brushsvg.check("two.ngc", made.plan).problems == ()
    other = replace(design, elements=design.elements[:1])
    assert brushsvg.check("two.ngc", other).problems


def test_check_can_be_cancelled(desk):
    with pytest.raises(CancelledError):
        brushsvg.check("two.ngc", "two.svg", cancel=lambda: True)
