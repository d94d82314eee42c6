"""HP-GL stays within half a unit of the plan and refuses what a pen cannot draw."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import in_json, is_reported, refused
from judge.hpgl import UNIT_MM, run_hpgl
from programs import RUNNABLE, call, is_refused_when_damaged, program

from brushsvg import _core
from brushsvg.machine import writer
from brushsvg.machine.cells.cell import Machine, Paper, Pen, robot_from_paper
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.job_program import Job
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.posts import POSTS
from brushsvg.machine.writer import text_of
from brushsvg.model.library import find_brush
from brushsvg.verify import against_plan, simulate_program
from brushsvg.verify.readback import read_program

GOLDEN = Path(__file__).parents[1] / "golden" / "two_strokes.hpgl"
CELL = find_cell("hpgl-plotter")
DOWN = CELL.pen.down_mm
SHEET = (100.0, 60.0)
MIDDLE = np.array([50, 30])
PENS = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80"><g fill="none" '
    'stroke-width="1"><path d="M30 20h30" stroke="#000000"/><path d="M30 32h30" stroke="#ff0000"/>'
    '<path d="M30 44h30" stroke="#ff0000"/><path d="M30 56h30" stroke="#000000"/></g></svg>'
)


def pen(max_speed_mm_s=100.0):
    brush = _core.read_brush(_core.write_brush(find_brush("rigid")))
    brush.max_speed_mm_s = max_speed_mm_s
    return brush


def drawn(*lines, speed=20.0, height=DOWN):
    """Return a plan of lines (n, 2) at one height, set down and lifted in place."""
    passes = []
    for number, line in enumerate(lines, 1):
        line = np.asarray(line, dtype=float)
        flat = np.column_stack([line, np.full(len(line), height)])
        poses = np.vstack([flat[:1] * (1, 1, 0), flat, flat[-1:] * (1, 1, 0)])
        passes.append(_core.Pass(f"s{number}", poses, speed))
    return _core.Plan("pen", "", SHEET, passes)


TWO = drawn([(10, 10), (20.01, 15.555), (40, 24)], [(50, 20), (50, 40)], speed=25.0)


def text_for(plan, cell=CELL, job=None, header=()):
    made = program(plan, pen(), cell, header, **({"job": job} if job else {}))
    return "".join(text_of(POSTS["hpgl"], made))


def run(text, cell=CELL):
    found = run_hpgl(text, (0.0, 0.0, 1.0), cell.pen.down_mm, cell.heights.safe_mm, cell.speeds.travel_mm_s)
    assert not found.refused and not found.acts and not found.frame
    return found


def test_program_equals_the_golden_file():
    assert text_for(TWO, header=("title: two strokes",)) == GOLDEN.read_text(encoding="ascii")


@pytest.mark.parametrize("turned_deg", [0.0, 37.0, 90.0])
def test_the_drawn_path_is_within_half_a_unit_of_the_plan(turned_deg):
    rng = np.random.default_rng(5)
    cell = replace(CELL, paper=Paper((120.0, 20.0, 0.0), (0.0, 0.0, turned_deg)))
    lines = [MIDDLE + np.cumsum(rng.uniform(-1, 1, (30, 2)), axis=0) for _ in range(4)]
    found = run(text_for(drawn(*lines), cell), cell)
    frame = robot_from_paper(cell)
    target = [line @ frame[:2, :2].T + frame[:2, 3] for line in lines]
    strokes = []
    for leg in found.legs:
        if leg.kind == "jump" and leg.end[2] == DOWN:
            strokes.append([leg.end[:2]])
        elif leg.kind == "feed":
            strokes[-1].append(leg.end[:2])
    assert [len(stroke) for stroke in strokes] == [30] * 4
    away = np.abs(np.array(strokes) - np.array(target)).max()
    assert UNIT_MM / 4 < away <= UNIT_MM / 2 + 1e-9


def test_the_speed_is_rounded_down_to_whole_centimetres():
    found = run(text_for(TWO))
    assert {leg.speed_mm_s for leg in found.legs if leg.kind == "feed"} == {20.0}
    with refused("speed-out-of-range 9 '[10, 100] mm/s of cell hpgl-plotter'"):
        text_for(drawn([(10, 10), (20, 10)], speed=9.0))


@pytest.mark.parametrize(
    "poses",
    [
        [(10, 10, 0), (12, 10, -0.2), (30, 10, -0.2), (30, 10, 0)],
        [(10, 10, 0), (10, 10, -0.2), (30, 10, -0.2), (31, 10, 0)],
        [(10, 10, 0), (10, 10, -0.2), (20, 10, -0.21), (30, 10, -0.2), (30, 10, 0)],
        [(10, 10, 0), (10, 10, -0.3), (30, 10, -0.3), (30, 10, 0)],
        [(10, 10, 0), (10, 10, -0.1), (10, 10, 0)],
    ],
)
def test_a_depth_other_than_the_pens_is_refused(poses):
    plan = _core.Plan("pen", "", SHEET, [_core.Pass("s", np.array(poses, float), 20.0)])
    with refused("pen-depth -0.2"):
        text_for(plan)


@pytest.mark.parametrize("width_mm", [3, 4.5])
def test_a_pressing_brush_on_a_plotter_suggests_the_pen(tmp_path, capsys, width_mm):
    """The pen is the remedy for every width, also for one that needs a depth of more than the 5 mm of the cell."""
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">'
        f'<path id="a" fill="none" stroke="#000" stroke-width="{width_mm}" d="M20 30Q50 0 80 30"/></svg>'
    )
    words = ("convert", tmp_path / "a.svg", "-o", tmp_path / "a.hpgl", "--cell", "hpgl-plotter")
    status, _, reported = in_json(capsys, *words)
    assert status == 1 and is_reported(reported, "pen-depth --brush rigid")
    status, _, reported = in_json(capsys, *words, "--brush", "rigid")
    assert status == 0


def test_the_paper_height_cannot_be_set(tmp_path, capsys):
    with refused("pen-depth"):
        text_for(TWO, job=Job(0.1))
    status, _, reported = in_json(
        capsys, "setup", "height", "--cell", "hpgl-plotter", "--brush", "rigid", "-o", tmp_path / "h.hpgl"
    )
    assert status == 1 and is_reported(reported, "pen-depth")


@pytest.mark.parametrize("seed", range(20))
def test_random_lines_are_read_back(seed):
    """Random lines are read back unchanged.

    The program exceeds no limit, and check recognizes the plan.
    """
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(60, 200, 2)
    machine = Machine(scale=tuple(rng.uniform(0.97, 1.03, 2)), skew=float(rng.uniform(-0.02, 0.02)))
    cell = replace(
        CELL,
        paper=Paper((x, y, 0.0), (0.0, 0.0, rng.uniform(0, 360))),
        workspace=replace(CELL.workspace, box_mm=()),
        pen=Pen(-float(rng.uniform(0.05, 0.9))),
        machine=machine if seed % 2 else None,
    )
    steps = rng.choice([0.01, 0.1, 1.0, 5.0])
    lines = [
        np.clip(MIDDLE + np.cumsum(rng.uniform(-steps, steps, (rng.integers(2, 40), 2)), axis=0), 1, 59)
        for _ in range(rng.integers(1, 5))
    ]
    brush = pen(float(rng.uniform(12, 60)))
    plan = drawn(*lines, speed=float(rng.uniform(10, brush.max_speed_mm_s)), height=cell.pen.down_mm)
    text = "".join(writer.encode(".hpgl", plan, brush, 'a "title"; caf\u00e9', (), cell))
    assert text.isascii() and text.endswith("\n")
    for leg in run(text, cell).legs:
        if leg.kind in ("feed", "rapid"):
            assert leg.end[2] == leg.start[2] and (leg.kind == "rapid") == (leg.end[2] > 0)
        assert leg.kind != "feed" or leg.speed_mm_s <= plan.passes[0].speed_mm_s
    ran = simulate_program.simulate_program(read_program(text, ".hpgl", cell), brush, cell, SHEET)
    assert ran.problems == []
    assert against_plan.compare_with_plan(ran, split_into_loads(plan, brush, cell), cell)[1] == []


def test_a_plotter_selects_pens_by_the_colours_of_the_cell(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("pens.svg").write_text(PENS, encoding="utf-8")
    colours = sorted(set(re.findall("#[0-9a-f]{6}", PENS)))
    own = replace(CELL, name="own", pen=replace(CELL.pen, colours=tuple(reversed(colours))))
    Path("own.toml").write_text(write_cell(own))
    words = ("pens.svg", "-o", "pens.hpgl", "--cell", "own.toml", "--brush", "rigid")
    status, _, reported = call(capsys, "convert", *words)
    assert status == 0 and reported[-1].count(", ") == 2, "how many strokes, how long, how often another pen"
    text = Path("pens.hpgl").read_text()
    taken, target = [], []
    for line in text.splitlines():
        if found := re.fullmatch(r"SP(\d);", line):
            taken.append(int(found[1]))
        if found := re.fullmatch(r'CO "paint: pen (\w{6})";', line):
            target.append(1 + own.pen.colours.index(f"#{found[1]}"))
    assert taken == [*target, 0] and len(set(target)) == len(colours)
    check = ("check", "pens.hpgl", "pens.svg", "--cell", "own.toml")
    assert RUNNABLE in call(capsys, *check)[1]
    Path("pens.hpgl").write_text(text.replace(f"SP{target[0]};", f"SP{target[1]};", 1))
    status, _, reported = in_json(capsys, *check)
    assert status == 1 and is_reported(reported, "program-changed")
    Path("pens.hpgl").write_text(re.sub('"paint: pen (......)"', '"paint: pen fedcba"', text, count=1))
    status, _, reported = in_json(capsys, *check)
    assert status == 1 and is_reported(reported, "colour-not-served #fedcba")
    one = replace(own, pen=replace(own.pen, colours=own.pen.colours[:1]))
    Path("own.toml").write_text(write_cell(one))
    status, _, reported = in_json(capsys, "convert", "--force", *words)
    assert status == 1 and is_reported(reported, "colour-not-served")


def test_an_air_run_is_drawn_with_the_pen_up(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("pens.svg").write_text(PENS, encoding="utf-8")
    words = ("pens.svg", "-o", "air.hpgl", "--cell", "hpgl-plotter", "--brush", "rigid")
    assert call(capsys, "setup", "border", *words)[0] == 0
    found = run(Path("air.hpgl").read_text())
    assert sum(leg.kind == "rapid" for leg in found.legs) >= 4 and not any(leg.kind == "feed" for leg in found.legs)
    assert call(capsys, "check", "air.hpgl")[0] == 0


@pytest.mark.parametrize("cell", ["hpgl-plotter", "marlin-servo"])
def test_a_stroke_at_the_end_of_the_previous_one_lands_there(tmp_path, capsys, cell):
    """A stroke that begins at the end of the one before is set down there.

    The pen is lifted and set down again without a move.
    """
    lines = '<path d="M20 20H50"/><path d="M50 20L80 40"/><path d="M80 40V50"/>'
    drawing = tmp_path / "lines.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">'
        f'<g fill="none" stroke="#000" stroke-width="1">{lines}</g></svg>'
    )
    made = str(tmp_path / f"lines{POSTS[find_cell(cell).language].extensions[0]}")
    flags = ("--cell", cell, "--brush", "rigid")
    assert call(capsys, "convert", str(drawing), "-o", made, *flags)[0] == 0
    status, printed, _ = call(capsys, "check", made, str(drawing), *flags)
    assert status == 0 and RUNNABLE in printed


@pytest.mark.parametrize(
    ("old", "new", "reported"),
    [
        (r"PA2000,800;\n", "PA2000,8000;\n", "tool-off-sheet"),
        (r"VS2;", "VS30;", "speed-out-of-range"),
        (r"PU;\n(?=CO \"stroke 2)", "", "program-changed"),
        (r"IN;\n", "", "mode-missing"),
        (r"SP1;\n", "", "line-incomplete"),
        (r"PD;\n", "", "touches-miscounted"),
        (r"PA2000,800;\n", "PR2000,800;\n", "line-unread"),
        (r"SP0;\n.*\n", "", "program-cut-short"),
        (r"PD;\nPA", "PD;\nRO90;\nPA", "line-unread"),
        (r"PD;\nPA", "PD;\nSP2;\nPA", "line-unread"),
        (r"PU;\nPU;\nSP0", "SP0", "line-unread"),
        (r"VS2;\n", "", "line-incomplete"),
        (r"VS2;", "VS0;", "line-unread"),
        (r"SP1;", "SP;", "line-incomplete"),
    ],
)
def test_check_refuses_damaged_programs(tmp_path, capsys, old, new, reported):
    text = "".join(writer.encode(".hpgl", TWO, pen(25.0), "two", (), CELL))
    (tmp_path / "pen.json").write_text(_core.write_brush(pen(25.0)))
    (tmp_path / "two.hpgl").write_text(text)
    words = ("--cell", "hpgl-plotter", "--brush", tmp_path / "pen.json")
    assert is_refused_when_damaged(capsys, tmp_path / "two.hpgl", old, new, reported, *words)


def test_sp_without_a_number_stores_the_pen(tmp_path, capsys):
    text = "".join(writer.encode(".hpgl", TWO, pen(25.0), "two", (), CELL))
    (tmp_path / "pen.json").write_text(_core.write_brush(pen(25.0)))
    (tmp_path / "two.hpgl").write_text(text.replace("SP0;", "SP;"))
    check = ("check", tmp_path / "two.hpgl", "--cell", "hpgl-plotter", "--brush", tmp_path / "pen.json")
    assert in_json(capsys, *check)[0] == 0


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        ({"pen": None}, "key-missing pen"),
        ({"language": "linuxcnc"}, "key-unused 'pen' linuxcnc"),
        ({"paper": Paper((0.0, 0.0, 1.0))}, "paper-tilted"),
        ({"pen": Pen(-6.0)}, "cell-heights -6 -5"),
        ({"pen": Pen(-0.2, ("#000000", "red"))}, "colour-invalid red"),
        ({"pen": Pen(-0.2, ("#000000", "#000000"))}, "colour-invalid"),
        ({"machine": Machine(height_mm=0.1)}, "cell-machine height_mm"),
        ({"machine": Machine(lean_mm_per_mm=(0.1, 0.0))}, "cell-machine lean_mm_per_mm"),
    ],
)
def test_a_cell_impossible_for_a_pen_plotter_is_refused(change, reported):
    with refused(reported):
        parse_cell(write_cell(replace(CELL, **change)))


def test_a_tolerance_finer_than_the_units_is_refused(tmp_path, capsys):
    (tmp_path / "a.svg").write_text(PENS)
    words = (
        "convert",
        tmp_path / "a.svg",
        "-o",
        tmp_path / "a.hpgl",
        "--cell",
        "hpgl-plotter",
        "--brush",
        "rigid",
    )
    status, _, reported = in_json(capsys, *words, "--tolerance", "0.04")
    assert status == 1 and is_reported(reported, "decimals-too-few 0.025 0.0125 0.01")
