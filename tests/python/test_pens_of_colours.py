"""On a machine without paint, the program stops for each other pen.

The strokes have several colours. The option --speed applies to all strokes.
"""

import json
import re
from dataclasses import replace

import pytest
from diagnostics import gives, in_json, is_reported
from programs import LANGUAGES, RUNNABLE, SERVOS, call

from brushsvg.machine.cells.cell_file import find_cell, write_cell

DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80"><g fill="none" '
    'stroke-width="3"><path d="M30 20h30" stroke="#000"/><path d="M30 32h30" stroke="#f00"/>'
    '<path d="M30 44h30" stroke="#FF0000"/><path d="M30 56h30" stroke="#000" data-brushsvg-speed="5"/></g></svg>'
)


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pens.svg").write_text(DRAWING)
    return tmp_path


@pytest.mark.parametrize("name", [name for name in LANGUAGES if name not in (*SERVOS, "fr3")])
def test_a_program_stops_for_each_pen_change_and_check_requires_it(desk, capsys, name):
    program = f"pens{LANGUAGES[name]}"
    status, _, reported = call(capsys, "convert", "pens.svg", "-o", program, "--cell", name)
    assert status == 0 and sum(gives(line, "2") for line in reported) == 1
    text = (desk / program).read_text(encoding="ascii")
    assert re.findall("paint: pen ([0-9a-f]+)", text) == ["ff0000", "000000"]
    status, out, _ = call(capsys, "check", program, "pens.svg")
    assert status == 0 and RUNNABLE in out
    lines = text.split("\n")
    at = next(k for k, line in enumerate(lines) if "paint: pen 000000" in line)
    end = next(k for k, line in enumerate(lines) if "stroke 4 of 4" in line)
    (desk / program).write_text("\n".join(lines[:at] + lines[end:]), newline="")
    status, _, reported = in_json(capsys, "check", program, "pens.svg")
    assert status == 1 and is_reported(reported, "other-station nothing 'pen 000000'")


def test_a_job_resumed_after_a_pen_change_does_not_stop_for_it(desk, capsys):
    words = ("convert", "pens.svg", "-o", "rest.ngc", "--from-stroke")
    (resumed,) = call(capsys, *words, "2")[2]
    (behind,) = call(capsys, *words, "4")[2]
    assert resumed.count(", ") == behind.count(", ") + 1, "it stops once"
    assert "pen " not in (desk / "rest.ngc").read_text()
    assert call(capsys, "check", "rest.ngc", "pens.svg")[0] == 0


def test_a_stroke_without_a_colour_is_painted_with_the_pen_that_is_there(desk, capsys):
    assert call(capsys, "convert", "pens.svg", "-o", "pens.json")[0] == 0
    plan = json.loads((desk / "pens.json").read_text())
    for a_pass, colour in zip(plan["passes"], ["#000000", "", "#ff0000", ""], strict=True):
        a_pass["colour"] = colour
    (desk / "pens.json").write_text(json.dumps(plan))
    assert call(capsys, "convert", "pens.json", "-o", "pens.ngc")[0] == 0
    titles = re.findall(r"\((stroke \d|paint: pen [0-9a-f]+)", (desk / "pens.ngc").read_text())
    assert titles == ["stroke 1", "stroke 2", "paint: pen ff0000", "stroke 3", "stroke 4"]
    assert call(capsys, "check", "pens.ngc", "pens.json")[0] == 0


@pytest.mark.parametrize(
    ("colour", "expected"), [("red", "colour-invalid red"), ("#12", "colour-invalid"), ("#FF0000", "")]
)
def test_colours_of_a_plan_are_written_as_in_a_drawing(desk, capsys, colour, expected):
    assert call(capsys, "convert", "pens.svg", "-o", "pens.json")[0] == 0
    text = (desk / "pens.json").read_text().replace("#ff0000", colour)
    (desk / "pens.json").write_text(text)
    status, _, reported = in_json(capsys, "convert", "pens.json", "-o", "red.ngc", "--colour", "red")
    assert status == (1 if expected else 0)
    assert is_reported(reported, expected) if expected else "stroke 2 of 2" in (desk / "red.ngc").read_text()


def test_a_cell_without_pauses_reports_that_colours_are_drawn_as_one(desk, capsys):
    for program, name in (("pens.nc", "grbl-servo"), ("pens.csv", "fr3"), ("pens.ebb", "axidraw-ebb")):
        status, _, reported = in_json(capsys, "convert", "pens.svg", "-o", program, "--cell", name)
        assert status == 0 and is_reported(reported, "colours-as-one 'convert --per-colour'")
        assert call(capsys, "check", program, "pens.svg")[0] == 0
    one = replace(find_cell("linuxcnc-3axis"), name="one", pause_per_colour=False)
    (desk / "one.toml").write_text(write_cell(one))
    assert call(capsys, "convert", "pens.svg", "-o", "pens.ngc", "--cell", "one.toml")[0] == 0
    assert "M0" not in (desk / "pens.ngc").read_text()


def test_one_speed_fits_all_strokes_within_the_limits(desk, capsys):
    assert call(capsys, "convert", "pens.svg", "-o", "pens.ngc", "--speed", "12")[0] == 0
    feeds = re.findall(r"F([\d.]+)", (desk / "pens.ngc").read_text())
    assert set(map(float, feeds)) == {720.0, 1500.0, 480.0}, "painting, approach and press"
    assert call(capsys, "check", "pens.ngc", "pens.svg", "--speed", "12")[0] == 0
    status, _, reported = in_json(capsys, "check", "pens.ngc", "pens.svg")
    assert status == 1 and is_reported(reported, "stroke-too-fast 12.0 5.0")
    reported = in_json(capsys, "convert", "pens.svg", "-o", "x.ngc", "--speed", "26")[2]
    assert is_reported(reported, "speed-out-of-range 26 0.000001 25 round-6")
    reported = in_json(capsys, "convert", "pens.svg", "-o", "x.lua", "--cell", "cr5", "--speed", "0.5")[2]
    assert is_reported(reported, "speed-out-of-range 0.5 1 25")
    assert not (desk / "x.ngc").exists()
