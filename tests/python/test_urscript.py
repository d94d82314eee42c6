"""A stub of the robot runs our URScript programs, and refuses broken ones."""

from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import in_json, is_reported, refused
from programs import program
from urscript_stub import matrix, run

from brushsvg import _core
from brushsvg.jobs.preparation import preparation
from brushsvg.machine import preflight, writer
from brushsvg.machine.cells.cell import Contact, Paper, Reload, Station, robot_from_paper
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.frames import transform_points
from brushsvg.machine.job_program import Job
from brushsvg.machine.moves import Move
from brushsvg.machine.posts import POSTS
from brushsvg.machine.posts.urscript import _move_lines
from brushsvg.machine.writer import text_of
from brushsvg.model.library import find_brush

GOLDEN = Path(__file__).parents[1] / "golden" / "two_strokes.script"
CELL = find_cell("ur5e")
BRUSH = SimpleNamespace(name="b", max_speed_mm_s=25.0)
ARC = [(20.0 - 8 * np.cos(a), 30 + 8 * np.sin(a), -2.0) for a in np.linspace(0, 2, 9)]
STROKES = {
    "n/1": [(10, 10, 0), (12.5, 10, -3), (30.123456, 20.98766, -3.25), (40, 24, -3.25), (38, 23.5, 0)],
    "dot": [(40, 30, 0), (40, 30, -2), (43, 30, -2), (42, 30, 0)],
    "turn": [(12, 10, 0), *ARC, (30, 45, -2), (30, 44, 0)],
}
ARCS = {"turn": [SimpleNamespace(first=1, last=9, centre_mm=(20.0, 30.0), direction=-1)]}


def text_for(cell=CELL, strokes=STROKES, header=("title: two strokes",), colours=(), **job):
    passes = [
        SimpleNamespace(
            stroke=name,
            poses_mm=np.array(poses, float),
            speed_mm_s=20.0,
            arcs=ARCS.get(name, ()),
            tool_axes=(),
            colour=colour,
            layer="",
            settings=_core.Settings(),
            load=0,
        )
        for (name, poses), colour in zip_longest(strokes.items(), colours, fillvalue="")
    ]
    made = program(SimpleNamespace(sheet_mm=(100.0, 60.0), passes=passes), BRUSH, cell, header, Job(**job))
    return "".join(text_of(POSTS[cell.language], made))


def rows_of(robot, cell):
    """Return (name, point [mm], speed [mm/s], blend [mm]) of all points.

    Points are in the paper frame.
    """
    paper_from_robot = np.linalg.inv(robot_from_paper(cell))
    rows = []
    for name, *rest in robot.events:
        if name in ("sleep", "popup", "textmsg"):
            continue
        poses, speed, blend = rest
        for pose in poses:
            point = transform_points(paper_from_robot, 1e3 * np.array([pose[:3]]))[0]
            rows.append((name, point, 1e3 * speed, 1e3 * blend))
    return rows


def on_a_circle(start, via, end, count=200):
    """Return points between the first and the last of three points on a level circle."""
    (a, b, c), level = (np.array(each[:2]) @ (1, 1j) for each in (start, via, end)), start[2]
    ratio = (c - a) / (b - a)
    centre = (b - a) * (ratio - abs(ratio) ** 2) / (2j * ratio.imag) + a
    turn = np.angle((c - centre) / (a - centre))
    if np.sign(turn) != np.sign(((b - a).conjugate() * (c - b)).imag):
        turn -= np.copysign(2 * np.pi, turn)
    at = centre + (a - centre) * np.exp(1j * turn * np.linspace(0, 1, count + 1)[1:-1])
    assert np.abs(at - b).min() < abs(a - centre) * abs(turn) / count
    return list(np.column_stack([at.real, at.imag, np.full(len(at), level)]))


def touched(robot, cell):
    """Return the rows below the clearance."""
    return [row for row in rows_of(robot, cell) if row[1][2] < cell.heights.clearance_mm - 1e-6]


EXAMPLE = Path(__file__).parents[2] / "examples" / "vincent.svg"


@pytest.mark.parametrize("paper", [CELL.paper, Paper((-300.0, -500.0, 40.0), (2.0, -3.0, 25.0))])
def test_the_robot_passes_all_poses_of_the_plan(paper):
    cell = replace(CELL, paper=paper)
    rows = touched(run(text_for(cell)), cell)
    target = [
        *STROKES["n/1"],
        *STROKES["dot"],
        STROKES["turn"][0],
        ARC[0],
        ARC[4],
        ARC[8],
        *STROKES["turn"][10:],
    ]
    assert np.array([row[1] for row in rows]) == pytest.approx(np.array(target), abs=1e-3)
    assert [row[0] for row in rows].count("movec") == 2
    assert max(row[2] for row in rows) <= 20.0 + 1e-9


@pytest.mark.slow
def test_the_simulated_marks_equal_the_planned_marks():
    brush = find_brush("round-6")
    work = preparation.prepare(EXAMPLE)
    cell = preflight.as_exact_as(CELL, 0.05)
    cell = replace(cell, workspace=replace(cell.workspace, box_mm=(), reach_mm=()))
    robot = run("".join(writer.encode(".script", work.plan, brush, "v", (), cell)))
    passes, here = [], []
    rows, via = rows_of(robot, cell), False
    for k, (name, point, _, _) in enumerate(rows):
        if point[2] > 1e-6 and here:
            passes.append(here)
            here = []
        elif point[2] <= 1e-6:
            via = name == "movec" and not via  # a circle has a point on its path, then its end
            here += on_a_circle(here[-1], point, rows[k + 1][1]) if via else [point]
    rings = []
    reported = [_core.Pass("s", np.array(each), 20.0) for each in passes]
    for plan in (work.plan, _core.Plan("round-6", "", (400.0, 400.0), reported)):
        marks = _core.simulate(plan, brush, 0.005)
        _core.trace_outlines(marks, brush)
        rings.append(marks.outline_mm)
    assert _core.overlap(*rings) > 0.999


def test_the_brush_is_held_along_the_paper_normal():
    cell = replace(CELL, paper=Paper((-300.0, -500.0, 40.0), (2.0, -3.0, 25.0)), tool=replace(CELL.tool, spin_deg=30.0))
    robot = run(text_for(cell))
    normal = robot_from_paper(cell)[:3, 2]
    for name, *rest in robot.events:
        if name.startswith("move"):
            assert matrix(rest[0][-1])[:3, 2] == pytest.approx(-normal, abs=1e-6)
    assert robot.tcp[:3] == (0.0, 0.0, 0.15)


def test_the_robot_stops_at_reversals_and_blends_other_corners():
    rows = touched(run(text_for()), CELL)
    for before, here, after in zip(rows, rows[1:], rows[2:], strict=False):
        into, out = here[1] - before[1], after[1] - here[1]
        if min(np.linalg.norm(into), np.linalg.norm(out)) < 1e-9:
            continue
        cosine = into @ out / np.linalg.norm(into) / np.linalg.norm(out)
        if cosine < np.cos(np.radians(100)):
            assert here[0] != "movep" and here[3] == 0, "movep cannot turn back"
        assert here[3] <= 0.45 * min(np.linalg.norm(into), np.linalg.norm(out)) + 1e-9
    assert any(row[3] > 0.1 for row in rows)


def test_the_brush_is_raised_before_any_other_move():
    low = run(text_for(), start=(-0.1, -0.5, 0.021, 3.14159265, 0, 0))
    first, second = (event[1][0] for event in low.events[:2])
    assert first[:2] == pytest.approx((-0.1, -0.5)) and first[2] == pytest.approx(0.04)
    assert second[2] == pytest.approx(0.04)
    high = run(text_for(), start=(-0.1, -0.5, 0.3, 3.14159265, 0, 0))
    assert len(high.events) == len(low.events) - 1


def test_the_program_waits_for_paint():
    stations = (
        Station("red", (120.0, 10.0), ("#ff0000",), depth_mm=5.0, hold_s=0.5),
        Station("hand", (120.0, 50.0), by_hand=True),
    )
    cell = replace(CELL, reload=Reload("layer"), stations=stations)
    robot = run(text_for(cell, colours=("#ff0000", "#ff0000", "#000000")))
    waits = [event for event in robot.events if event[0] in ("sleep", "popup")]
    assert waits[0] == ("sleep", 0.5)
    assert waits[1][0] == "popup" and waits[1][1].endswith(": hand") and len(waits) == 2


def test_program_equals_the_golden_file():
    assert text_for() == GOLDEN.read_text(encoding="ascii")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("movep(", "mover("),
        (", v=", ", w="),
        ("0.0100000", "1e-2"),
        ("p[x, y, z, ", "p[x, y, "),
        ("set_tcp", "#"),
        ("v=0.02000", "v=20.0"),
        ("))", ")"),
    ],
)
def test_the_stub_refuses_broken_programs(old, new):
    text = text_for()
    assert old in text
    with pytest.raises((AssertionError, NameError, TypeError, SyntaxError)):
        run(text.replace(old, new))


WATCHED = replace(CELL, contact=Contact(force_n=10.0))


def pressed(height_mm, newtons):
    """Return a function for the force on a tool at a pose.

    A hand that holds the tool presses with 3 N. Below the height, the force is greater.
    """
    paper_from_robot = np.linalg.inv(robot_from_paper(CELL))

    def force(pose):
        z = transform_points(paper_from_robot, 1e3 * np.array([pose[:3]]))[0, 2]
        return 3.0 + newtons * (z < height_mm)

    return force


@pytest.mark.parametrize(("newtons", "halts"), [(9.0, False), (12.0, True)])
def test_a_tool_that_is_pressed_too_hard_ends_the_program(newtons, halts):
    robot = run(text_for(WATCHED), force=pressed(0.5, newtons))
    assert robot.is_halted == halts
    if halts:
        what, text = robot.events[-1]
        assert what == "textmsg" and "10.0 N" in text
        low = [row[1][2] < 0.5 for row in rows_of(robot, CELL)]
        assert low == [False] * (len(low) - 1) + [True]
    else:
        assert len(robot.events) == len(run(text_for()).events)


def test_the_weight_of_the_tool_does_not_count_as_contact():
    high = run(text_for(WATCHED), force=lambda pose: 80.0)
    assert not high.is_halted and high.none_n == 80.0


def test_contact_is_not_monitored_during_manual_work():
    stations = (Station("hand", (120.0, 50.0), by_hand=True),)
    text = text_for(replace(WATCHED, reload=Reload("layer"), stations=stations))
    lines = [line.strip() for line in text.splitlines()]
    at = next(k for k, line in enumerate(lines) if line.startswith("popup"))
    assert (lines[at - 1], lines[at + 1]) == ("kill watching", "watching = run watch()")
    assert not run(text, force=lambda pose: 3.0).is_halted


@pytest.mark.parametrize(
    ("name", "contact", "reported"),
    [
        ("ur5e", Contact(sensitivity=3), "cell-contact force_n"),
        ("ur5e", Contact(10.0, 3), "cell-contact sensitivity"),
        ("xarm6", Contact(force_n=10.0), "cell-contact force_n"),
        ("kr6-r900", Contact(force_n=10.0), "cell-contact krl"),
    ],
)
def test_a_contact_limit_is_refused_in_languages_without_one(name, contact, reported):
    with refused(reported):
        parse_cell(write_cell(replace(find_cell(name), contact=contact)))


@pytest.mark.parametrize(
    ("name", "contact", "old", "new"),
    [
        ("ur5e", Contact(10.0), "force() > 10.0", "force() > 90.0"),
        ("ur5e", Contact(10.0), "        halt\n", ""),
        ("ur5e", Contact(10.0), "  watching = run watch()\n", ""),
        ("ur5e", Contact(10.0), "  watching = run watch()\n", "  watching = run watch()\n" * 2),
        ("ur5e", Contact(10.0), "  zero_ftsensor()\n", ""),
        ("xarm6", Contact(sensitivity=4), "sensitivity(4)", "sensitivity(0)"),
        ("xarm6", Contact(sensitivity=4), "done(arm.set_collision_sensitivity(4))\n", ""),
    ],
)
def test_check_refuses_a_program_with_weaker_contact_monitoring(name, contact, old, new, tmp_path, capsys):
    cell = replace(find_cell(name), contact=contact)
    (tmp_path / "own.toml").write_text(write_cell(cell))
    program = tmp_path / f"first{POSTS[cell.language].extensions[0]}"
    assert in_json(capsys, "setup", "first-run", tmp_path / "own.toml", "-o", program)[0] == 0
    check = ("check", program, "--cell", tmp_path / "own.toml")
    assert in_json(capsys, *check)[0] == 0
    text = program.read_text()
    assert old in text
    program.write_text(text.replace(old, new))
    status, _, reported = in_json(capsys, *check)
    assert status == 1 and is_reported(reported, "program-changed")
    # The program must also be refused in place of the program of a cell without contact sensing.
    program.write_text(text)
    assert in_json(capsys, "check", program, "--cell", name)[0] == 1


def test_a_blend_is_left_out_only_if_it_rounds_to_zero():
    points = np.array([[0.0, 0, -1], [1, 0, -1], [2, 1, -1], [3, 1, -1]])
    move = Move("paint", points, 20.0, blends_mm=np.array([0.004, 0.006, 0.05, 0.0]))
    lines = "".join(_move_lines(move, np.eye(3), "a=1", 5)).splitlines()
    assert [line.rpartition("r=")[2].strip(")") for line in lines[:3]] == ["0.00000", "0.00001", "0.00005"]
