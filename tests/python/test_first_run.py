"""Every shipped cell has a safe first run that check accepts.

Near the paper, a first run is never fast or deep.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from diagnostics import in_json, is_reported
from programs import SERVOS
from sampling import sample

from brushsvg.machine.cells.cell import robot_from_paper
from brushsvg.machine.cells.cell_file import cell_names, find_cell, write_cell
from brushsvg.machine.moves import Wait
from brushsvg.machine.posts import POSTS
from brushsvg.machine.setup_programs import make_first_run_program
from brushsvg.machine.writer import text_of
from brushsvg.model.library import find_brush

pytestmark = pytest.mark.arm

SHEET_MM = (200.0, 100.0)
# xarm7 uses the language of xarm6. In a new home folder, its angles take half a minute to prepare.
OTHERS = (*SERVOS, "fr3", "hpgl-plotter", "marlin-servo", "xarm7")
WAITING = [name for name in cell_names() if name not in OTHERS]


@sample("name", WAITING, keep=4)
def test_check_accepts_the_first_run_of_every_cell(name, tmp_path, capsys):
    program = tmp_path / f"first{POSTS[find_cell(name).language].extensions[0]}"
    assert in_json(capsys, "setup", "first-run", name, "-o", program)[0] == 0
    status, _, reported = in_json(capsys, "check", program)
    assert status == 0, reported


@sample("name", WAITING, keep=5)
def test_the_first_run_does_its_steps_in_a_safe_order(name):
    cell = find_cell(name)
    sections = [*make_first_run_program(find_brush("round-6"), cell, SHEET_MM, 1.0, -1.0, 0.1).sections()]
    lows = [min(move.points_mm[:, 2].min() for move in section.moves) for section in sections]
    safe_mm = cell.heights.safe_mm
    high, border, touches, strokes, one = lows[0], lows[1], lows[2:6], lows[6:-1], lows[-1]
    assert high > safe_mm
    assert border == safe_mm and touches == [0.0] * 4
    assert strokes == pytest.approx(np.arange(1.0, -1.05, -0.1), abs=1e-9)
    assert one == -2.0
    asks = [sum(isinstance(s, Wait) and s.seconds is None for s in section.steps) for section in sections]
    assert asks == [0, 1, 2, 2, 2, 2, 1, *[0] * (len(strokes) - 1), 1]
    assert sections[-1].moves[-1].points_mm[-1, 2] == safe_mm
    for before, move in zip(all_moves(sections), all_moves(sections)[1:], strict=False):
        if min(before.points_mm[-1, 2], move.points_mm[:, 2].min()) < 1.5:  # The paper may be 1 mm higher.
            assert move.speed_mm_s <= max(cell.speeds.press_mm_s, 15.0)


@sample("name", WAITING, keep=4)
def test_without_room_above_the_safe_height_the_high_lap_is_left_out(name, tmp_path, capsys):
    """Without room above the safe height, the high lap is left out.

    It was once run at the safe height under the title "high in the air".
    """
    cell = find_cell(name)
    top_mm = float(robot_from_paper(cell)[2, 3]) + cell.heights.safe_mm + 14.0
    low, high = cell.workspace.box_mm or ((-50.0, -50.0, -50.0), (300.0, 200.0, 0.0))
    cell = replace(cell, name="low", workspace=replace(cell.workspace, box_mm=(low, (*high[:2], top_mm))))
    (tmp_path / "low.toml").write_text(write_cell(cell))
    program = tmp_path / f"first{POSTS[cell.language].extensions[0]}"
    status, _, reported = in_json(capsys, "setup", "first-run", tmp_path / "low.toml", "-o", program)
    assert status == 0 and is_reported(reported, f"out-of-box 15 z '{top_mm:g}] mm'"), reported
    status, _, reported = in_json(capsys, "check", program, "--cell", tmp_path / "low.toml")
    assert status == 0, reported
    made = make_first_run_program(find_brush("round-6"), cell, SHEET_MM, 1.0, -1.0, 0.1)
    assert made.rise_mm == pytest.approx(cell.heights.safe_mm)
    first, *others = made.sections()
    assert first.title.endswith("at safe height") and isinstance(first.steps[0], Wait)
    assert not any("high" in section.title.split() for section in others)


@pytest.mark.parametrize("x_mm", [0.0, SHEET_MM[0]])
def test_a_lamp_over_either_side_of_the_sheet_lowers_the_high_lap(x_mm):
    cell = find_cell("linuxcnc-3axis")
    lamp = (x_mm - 5.0, 40.0, cell.heights.safe_mm + 20.0), (x_mm + 5.0, 60.0, 200.0)
    cell = replace(cell, workspace=replace(cell.workspace, keep_out_mm=(lamp,)))
    made = make_first_run_program(find_brush("round-6"), cell, SHEET_MM, 1.0, -1.0, 0.1)
    assert made.rise_mm == pytest.approx(cell.heights.safe_mm + 15.0)


@pytest.mark.parametrize("name", WAITING)
def test_the_first_run_rises_to_its_own_height_and_never_lowers_fast(name):
    """The first run rises to its own height, and never lowers the tool fast.

    It once rose to the safe height, and then moved on a slant from any place to the height of its air run.
    """
    cell = find_cell(name)
    made = make_first_run_program(find_brush("round-6"), cell, SHEET_MM, 1.0, -1.0, 0.1)
    moves = all_moves(made.sections())
    start = moves[0].points_mm[0]
    assert made.rise_mm == pytest.approx(start[2]) and start[2] > cell.heights.safe_mm
    assert made.rise_in_robot_mm == pytest.approx(robot_from_paper(cell)[2, 3] + start[2])
    post, here = POSTS[cell.language], [made.rise_mm + 100.0]  # the tool may be higher
    for move in moves:
        down_mm = max(a - b for a, b in pairwise([*here[-1:], *move.points_mm[:, 2]]))
        assert down_mm <= 0 or move.speed_mm_s <= cell.speeds.approach_mm_s
        here.append(float(move.points_mm[-1, 2]))
    if ".ngc" in post.extensions:
        lines = [line for line in "".join(text_of(post, made)).splitlines() if line[:3] in ("G0 ", "G1 ")]
        lines = [line for line in lines if not line.startswith("G1 F")]
        assert float(lines[0].removeprefix("G1 Z")) == made.rise_mm
        heights = [float(line.partition("Z")[2]) for line in lines]
        fast = [line.startswith("G0") for line in lines]
        assert not any(b < a and quick for a, b, quick in zip(heights, heights[1:], fast[1:], strict=False))


@pytest.mark.parametrize(
    ("name", "program"),
    [
        ("grbl-servo", "first.nc"),
        ("fr3", "first.csv"),
        ("axidraw-ebb", "first.ebb"),
        ("hpgl-plotter", "first.hpgl"),
    ],
)
def test_a_machine_that_cannot_wait_has_no_first_run(name, program, tmp_path, capsys):
    """A machine that cannot wait has no first run.

    While it waits, a servo's brush would fall, and a trajectory would go on.
    """
    status, _, reported = in_json(capsys, "setup", "first-run", name, "-o", tmp_path / program)
    assert status == 1 and is_reported(reported, "cannot-wait") and not (tmp_path / program).exists()


def test_a_pen_with_one_height_has_no_first_run(tmp_path, capsys):
    status, _, reported = in_json(capsys, "setup", "first-run", "marlin-servo", "-o", tmp_path / "first.gcode")
    assert status == 1 and is_reported(reported, "pen-depth") and not (tmp_path / "first.gcode").exists()


def all_moves(sections):
    return [move for section in sections for move in section.moves]


def test_a_changed_first_run_is_refused(tmp_path, capsys):
    program = tmp_path / "first.ngc"
    assert in_json(capsys, "setup", "first-run", "linuxcnc-3axis", "-o", program)[0] == 0
    text = program.read_text()
    assert "Y6.0000 Z0.0000" in text
    program.write_text(text.replace("Y6.0000 Z0.0000", "Y6.0000 Z-3.0000", 1))
    status, _, reported = in_json(capsys, "check", program)
    assert status == 1 and is_reported(reported, "too-low -3.00")


def test_a_sheet_that_is_too_small_is_refused(tmp_path, capsys):
    command = ("setup", "first-run", "linuxcnc-3axis", "-o", tmp_path / "first.ngc", "--sheet", "60x60")
    status, _, reported = in_json(capsys, *command)
    assert status == 1 and is_reported(reported, "strokes-out-of-range 'larger sheet'")
