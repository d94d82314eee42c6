"""Marlin with a pen on a servo draws the plan and stands still for pen moves."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import in_json, refused
from judge import printer
from programs import is_refused_when_damaged, program

from brushsvg import _core
from brushsvg.machine import writer
from brushsvg.machine.cells.cell import Paper, Pen, Station
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.posts import POSTS
from brushsvg.machine.writer import text_of
from brushsvg.model.library import find_brush
from brushsvg.verify import against_plan, simulate_program
from brushsvg.verify.readback import read_program

GOLDEN = Path(__file__).parents[1] / "golden" / "two_strokes_marlin_servo.gcode"
CELL = find_cell("marlin-servo")
DOWN = CELL.pen.down_mm
SHEET = (100.0, 60.0)


def drawn(*lines, speed=20.0):
    """Return a plan of lines (n, 2), with the pen set down and lifted on the spot."""
    passes = []
    for number, line in enumerate(lines, 1):
        flat = np.column_stack([line, np.full(len(line), DOWN)])
        poses = np.vstack([flat[:1] * (1, 1, 0), flat, flat[-1:] * (1, 1, 0)])
        passes.append(_core.Pass(f"s{number}", poses, speed))
    return _core.Plan("rigid", "", SHEET, passes)


TWO = drawn([(10, 10), (20.01, 15.555), (40, 24)], [(50, 20), (50, 40)])


def text_for(plan, cell=CELL, header=()):
    return "".join(text_of(POSTS["marlin-servo"], program(plan, find_brush("rigid"), cell, header)))


def run(text, cell=CELL):
    up, down = cell.pen.servo_values
    heights = {up: cell.heights.safe_mm, down: cell.pen.down_mm}
    pen = printer.Pen(cell.pen.servo_number, heights, cell.pen.settle_s)
    found = printer.run_printer(text, "marlin", (0.0, 0.0, 1.0), False, pen)
    assert not found.refused and not found.acts and not found.frame, (found.refused, found.acts)
    return found


def test_program_equals_the_golden_file():
    assert text_for(TWO, header=("title: two strokes",)) == GOLDEN.read_text(encoding="ascii")


@pytest.mark.parametrize("seed", range(6))
def test_the_program_draws_the_plan_and_check_accepts_it(seed):
    rng = np.random.default_rng(seed)
    cell = replace(
        CELL,
        paper=Paper((12.0, 20.0, 0.0), (0.0, 0.0, rng.uniform(0, 360))),
        pen=replace(CELL.pen, servo_values=(30.0, 120.0), servo_number=2, settle_s=0.45),
    )
    count = int(rng.integers(1, 5))
    lines = [np.array([50, 30]) + np.cumsum(rng.uniform(-1, 1, (30, 2)), axis=0) for _ in range(count)]
    plan = drawn(*lines, speed=float(rng.uniform(5, 30)))
    text = "".join(writer.encode(".gcode", plan, find_brush("rigid"), "a (title); x", (), cell))
    turned = np.radians(cell.paper.rotation_deg[2])
    turn = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
    strokes = []
    for leg in run(text, cell).legs:
        if leg.kind == "jump" and leg.end[2] == DOWN:
            strokes.append([leg.end[:2]])
        elif leg.kind == "feed" and leg.end[2] == DOWN:
            strokes[-1].append(leg.end[:2])
            assert leg.speed_mm_s <= plan.passes[0].speed_mm_s
    target = [line @ turn.T + (12.0, 20.0) for line in lines]
    assert np.abs(np.array(strokes) - np.array(target)).max() <= 0.5e-3 + 1e-9
    ran = simulate_program.simulate_program(read_program(text, ".gcode", cell), find_brush("rigid"), cell, SHEET)
    assert ran.problems == []
    assert against_plan.compare_with_plan(ran, split_into_loads(plan, find_brush("rigid"), cell), cell)[1] == []


def test_the_program_stops_for_a_pen_of_another_colour(tmp_path, capsys):
    (tmp_path / "pens.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80"><g fill="none" '
        'stroke-width="1"><path d="M30 20h30" stroke="#000000"/><path d="M30 32h30" stroke="#ff0000"/></g></svg>'
    )
    cell = ("--cell", "marlin-servo", "--brush", "rigid")
    assert in_json(capsys, "convert", tmp_path / "pens.svg", "-o", tmp_path / "pens.gcode", *cell)[0] == 0
    legs = run((tmp_path / "pens.gcode").read_text()).legs
    (stop,) = [leg for leg in legs if leg.kind == "stop"]
    assert stop.end[2] == CELL.heights.safe_mm
    check = ("check", tmp_path / "pens.gcode", tmp_path / "pens.svg", *cell)
    assert in_json(capsys, *check)[0] == 0


@pytest.mark.parametrize(
    ("old", "new", "reported"),
    [
        (r"M400\nM280 P0 S40", "M280 P0 S40", "mode-missing"),
        (r"M400\n", "M00\n", "program-changed"),
        (r"M400\n", "M400\nM00\n", "program-changed"),
        (r"S40", "S41", "servo-out-of-range"),
        (r"M280 P0 S40", "M280 P1 S40", "servo-out-of-range"),
        (r"M280 P0 S40\nG4 P300", "M280 P0 S40", "program-changed"),
        (r"(?s)(S40.*?)M280 P0 S90\n", r"\1", "never-lifted|touches-miscounted|tool-too-low|program-changed"),
        (r"G1 X20\.010", "G1 X20.010 Z-3", "line-unread"),
        (r"G1 X20\.010 Y15\.555", "G2 X20.010 Y15.555", "line-unread"),
        (r"G1 X20\.010", "G1 X22.010", "path-elsewhere"),
        (r"\nM400\n; end.*\n", "\n", "program-cut-short"),
    ],
)
def test_check_refuses_damaged_programs(tmp_path, capsys, old, new, reported):
    text = "".join(writer.encode(".gcode", TWO, find_brush("rigid"), "two", (), CELL))
    (tmp_path / "plan.json").write_text(_core.write_plan(TWO))
    (tmp_path / "two.gcode").write_text(text)
    words = (tmp_path / "plan.json", "--cell", "marlin-servo")
    assert is_refused_when_damaged(capsys, tmp_path / "two.gcode", old, new, reported, *words)


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        ({"pen": None}, "key-missing pen"),
        ({"pen": Pen(-0.2)}, "servo-table"),
        ({"pen": Pen(-0.2, servo_values=(40.0, 40.2))}, "servo-table"),
        ({"pen": Pen(-0.2, ("#000000",), (90.0, 40.0))}, "out-of-range"),
        ({"language": "hpgl"}, "key-unused hpgl"),
        ({"language": "marlin"}, "key-unused 'pen' marlin"),
        ({"stations": (Station("ink", (120.0, 10.0), depth_mm=1.0),)}, "cell-station"),
    ],
)
def test_a_cell_impossible_for_a_servo_pen_is_refused(change, reported):
    with refused(reported):
        parse_cell(write_cell(replace(CELL, **change)))
