"""Limits of place hold along the way: strokes, ways between them, visits, circles, rises; in every command alike."""

import re
from dataclasses import replace

import pytest
from programs import call

from brushsvg.brushes import find_brush
from brushsvg.cell_file import find_cell, write_cell

BRUSH = find_brush("round-6")
SHEET = (600.0, 200.0)
BAR, PAIR = (
    f'<svg xmlns="http://www.w3.org/2000/svg" width="600mm" height="200mm" viewBox="0 0 600 200">'
    f'<path d="{d}" fill="none" stroke="#000" stroke-width="3" id="{name}"/>{more}</svg>'
    for d, name, more in (
        ("M40 100 H560", "bar", ""),
        ("M20 100 H60", "left", '<path id="right" d="M540 100 h40" stroke="#000" stroke-width="3"/>'),
    )
)


def robot(**workspace):
    """A robot that stands in the middle of its paper."""
    cell = find_cell("ur5e")
    paper = replace(cell.paper, origin_mm=(-300.0, -100.0, 20.0), example=False)
    limits = {"box_mm": (), "reach_mm": (), "margin_mm": 30.0, "tilt_limit_deg": 15.0} | workspace
    return replace(cell, name="mine", paper=paper, workspace=replace(cell.workspace, **limits))


RING = {"reach_mm": (150.0, 850.0)}
POST = {"keep_out_mm": (((-40.0, -40.0, -50.0), (40.0, 40.0, 300.0)), ((0.0, 300.0, 0.0), (1.0, 301.0, 1.0)))}
AWAY = r"the tool goes (?:0|20|16|40)\.\d mm away from the robot's origin, outside the range \[150, 850\] mm"
KEPT = r"the tool goes through x \S+, y \S+, z \S+ mm, in box 1 that cell mine keeps it out of: x -40 to 40, "


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bar.svg").write_text(BAR)
    (tmp_path / "pair.svg").write_text(PAIR)
    (tmp_path / "free.toml").write_text(write_cell(robot()))
    return tmp_path


@pytest.mark.parametrize(("limits", "words"), [(RING, AWAY), (POST, KEPT)])
@pytest.mark.parametrize(("name", "of_stroke"), [("bar", "bar: "), ("pair", "right: on the way there ")])
def test_no_way_goes_through_the_robot_itself(desk, capsys, name, of_stroke, limits, words):
    """Both ends were asked, and not the way; between strokes nothing was."""
    (desk / "mine.toml").write_text(write_cell(robot(**limits)))
    drawing, cell = f"{name}.svg", ("--cell", "mine.toml")
    for command in ("convert", "border"):
        program = f"{command}.script"
        status, _, err = call(capsys, command, drawing, program, *cell)
        told = of_stroke if command == "convert" else ""
        assert status == 1 and re.search(f"{drawing}: {told}{words}", err[-1]), err
        assert not (desk / program).exists()
        assert call(capsys, command, drawing, program, "--cell", "free.toml")[0] == 0
        status, _, err = call(capsys, "check", program, *cell)
        assert status == 1 and any(re.search(told + words, line) for line in err), err


def test_strokes_that_find_the_paper_and_the_ways_between_them_keep_out_of_boxes(desk, capsys):
    """A clip between the first two lanes, lower than neither of them."""
    clip = robot(keep_out_mm=(((-300.0, 90.0, 30.0), (-200.0, 92.0, 45.0)),))
    (desk / "mine.toml").write_text(write_cell(clip))
    height = ("height", "job.script", "--sheet", "600x200")
    status, _, err = call(capsys, *height, "--cell", "mine.toml")
    assert (
        status == 1 and "on the way there the tool goes through" in err[0] and "y 91.0, z 40.0 mm" in err[0]
    )
    assert call(capsys, *height, "--cell", "free.toml")[0] == 0
    status, _, err = call(capsys, "check", "job.script", "--cell", "mine.toml")
    assert status == 1 and any("on the way there the tool goes through" in line for line in err)
