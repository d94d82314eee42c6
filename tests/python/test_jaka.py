"""A stub of the robot runs JAKA scripts, and the reader refuses invalid ones."""

import re
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from diagnostics import refused
from test_urscript import ARC, STROKES, text_for

from brushsvg.cli import main
from brushsvg.machine.cells.cell import Blending, Paper, Reload, Station, robot_from_paper
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.frames import rotation, rotation_deg, transform_points
from brushsvg.verify.readback import read_program

GOLDEN = Path(__file__).parents[1] / "golden" / "two_strokes.jks"
CELL = find_cell("jaka-zu3")
LEVEL = replace(CELL, paper=Paper((-150.0, -500.0, 20.0), (0.0, 0.0, 25.0)))
LEANING = replace(CELL, paper=Paper((-150.0, -500.0, 20.0), (2.0, -3.0, 25.0)))


class Robot:
    """A stub that records events of a program.

    `events` contains (name, poses (n, 6), speed, acceleration, tolerance) for each move, ("sleep", s) and
    ("pause",).
    """

    def __init__(self, height_mm):
        self.here, self.tool, self.events = [-100.0, -400.0, height_mm, 180.0, 0.0, 0.0], None, []

    def set_user_frame_id(self, number):
        assert number == 0

    def set_tool(self, pose):
        assert len(pose) == 6
        self.tool = pose

    def get_atl_tcp_pose(self):
        assert self.tool
        return list(self.here)

    def movl(self, pose, rel_flag, vel, acc, tol):
        assert len(pose) == 6 and rel_flag in (0, 1) and vel > 0 and acc > 0 and tol >= 0
        target = [a + b for a, b in zip(self.here, pose, strict=True)] if rel_flag else pose
        self.events.append(("movl", np.array([target]), vel, acc, tol))
        self.here = target

    def movc(self, pose_mid, pose_end, rel_flag, vel, acc, tol):
        assert rel_flag == 0 and len(pose_mid) == len(pose_end) == 6 and vel > 0 and acc > 0 and tol >= 0
        self.events.append(("movc", np.array([pose_mid, pose_end]), vel, acc, tol))
        self.here = pose_end

    def sleep(self, time):
        self.events.append(("sleep", time))

    def pause(self):
        self.events.append(("pause",))


def run(text, height_mm=300.0):
    """Run a program and return the robot.

    Raise AssertionError or a Python error for anything that the language does not have.
    """
    robot = Robot(height_mm)
    assert text.isascii()
    lines = [line for line in text.splitlines() if line.strip() != "end"]
    for line in lines:
        assert not re.search(r"\d[eE]|-0\.0+\b(?!\d)", line.split("#")[0]), line
    names = {name: getattr(robot, name) for name in dir(robot) if not name.startswith("_")}
    exec("\n".join(lines), names | {"__builtins__": {}})
    return robot


def moves(robot):
    return [event for event in robot.events if event[0].startswith("mov")]


def touched(robot, cell):
    """Return the moves below the clearance.

    Each is (name, point in the paper's frame, speed, tolerance).
    """
    back = np.linalg.inv(robot_from_paper(cell))
    rows = [
        (name, point, speed, cut)
        for name, poses, speed, _, cut in moves(robot)
        for point in transform_points(back, poses[:, :3])
    ]
    return [row for row in rows if row[1][2] < cell.heights.clearance_mm - 2e-3]


@pytest.mark.parametrize(("cell", "circles"), [(CELL, 2), (LEVEL, 2), (LEANING, 0)])
def test_the_robot_passes_all_poses_of_the_plan(cell, circles):
    rows = touched(run(text_for(cell)), cell)
    arc = [ARC[0], ARC[4], ARC[8]] if circles else ARC
    target = [*STROKES["n/1"], *STROKES["dot"], STROKES["turn"][0], *arc, *STROKES["turn"][10:]]
    assert np.array([row[1] for row in rows]) == pytest.approx(np.array(target), abs=2e-3)
    assert [row[0] for row in rows].count("movc") == circles
    assert max(row[2] for row in rows) <= 20.0 + 1e-9


def test_the_brush_is_held_along_the_paper_normal():
    cell = replace(LEANING, tool=replace(CELL.tool, rotation_deg=(0.0, 10.0, 0.0), spin_deg=30.0))
    robot = run(text_for(cell))
    for _, poses, *_ in moves(robot):
        assert rotation(poses[-1, 3:])[:, 2] == pytest.approx(-robot_from_paper(cell)[:3, 2], abs=1e-5)
    assert robot.tool == [0, 0, 150, 0, 10, 0]


def test_corners_are_cut_within_the_tolerance_and_not_at_reversals():
    for tolerance_mm in (0.0, 0.01, 0.05):
        cell = replace(CELL, blending=Blending(tolerance_mm, 2.0))
        rows = touched(run(text_for(cell)), cell)
        assert max(row[3] for row in rows) == tolerance_mm
        for before, here, after in zip(rows, rows[1:], rows[2:], strict=False):
            if (here[1] - before[1]) @ (after[1] - here[1]) < 0:
                assert here[3] == 0


def test_the_brush_is_raised_before_any_other_move():
    low, high = run(text_for(CELL), height_mm=21.0), run(text_for(CELL))
    first, second = moves(low)[:2]
    assert first[1][0] == pytest.approx([-100, -400, 40, 180, 0, 0]) and second[1][0, 2] == 40
    assert len(low.events) == len(high.events) + 1


def test_the_program_waits_for_paint():
    stations = (
        Station("red", (120.0, 10.0), ("#ff0000",), depth_mm=5.0, hold_s=0.5),
        Station("hand", (120.0, 50.0), by_hand=True),
    )
    cell = replace(CELL, reload=Reload("layer"), stations=stations)
    robot = run(text_for(cell, colours=("#ff0000", "#ff0000", "#000000")))
    assert [event for event in robot.events if event[0] in ("sleep", "pause")] == [("sleep", 0.5), ("pause",)]


def test_program_equals_the_golden_file():
    assert text_for(CELL) == GOLDEN.read_text(encoding="ascii")


@pytest.mark.parametrize("cell", [CELL, LEVEL, LEANING], ids=["square", "turned", "leaning"])
def test_a_written_program_is_read_back(cell):
    text = text_for(cell)
    read = read_program(text, ".jks", cell)
    steps = [step for section in read.sections for step in section.steps]
    ends = np.array([poses[-1, :3] for _, poses, *_ in moves(run(text))])
    assert np.array([step[2:5] for step in steps]) == pytest.approx(ends)
    assert read.joint_mm == cell.blending.tolerance_mm
    blanks = read_program(text.replace("\n", "  \n"), ".jks", cell)
    assert (repr(blanks.acts), repr(blanks.sections)) == (repr(read.acts), repr(read.sections))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("movl(to, 0, 20.000", "movl(to, 1, 20.000", "line-unread"),
        ("movl(to, 0, 20.000", "movj(to, 0, 20.000", "line-unread"),
        ("set_user_frame_id(0)", "set_user_frame_id(2)", "line-unread"),
        ("180.0000, 0.0000, 0.0000]\nmovc", "180.0000, 0.6000, 0.0000]\nmovc", "tool-turned 0.6"),
        ("movl(to, 0, 20.000, 300.000, 0.000)", "movl(to, 0, 20.000, 0.000, 0.000)", "line-incomplete speed"),
        ("# end: the brush is held up\n", "", "program-cut-short"),
        ("to = ", "via = ", "line-incomplete"),
    ],
)  # fmt: skip
def test_the_reader_refuses_invalid_programs(old, new, expected):
    text = text_for(CELL)
    assert old in text
    changed = text.replace(old, new) if old == "to = " else text.replace(old, new, 1)
    with refused(expected):
        read_program(changed, ".jks", CELL)


def test_angles_agree_with_the_rotation():
    rng = np.random.default_rng(3)
    for _ in range(50):
        turned = cv2.Rodrigues(rng.normal(size=3))[0]
        assert rotation(rotation_deg(turned)) == pytest.approx(turned, abs=1e-12)


@pytest.mark.parametrize("about_y_deg", [90, -90])
def test_angles_agree_where_two_axes_are_parallel(about_y_deg):
    for about_x_deg, about_z_deg in [(0, 0), (30, 0), (0, 40), (-110, 170), (180, 180)]:
        turned = rotation((about_x_deg, about_y_deg, about_z_deg))
        assert rotation(rotation_deg(turned)) == pytest.approx(turned, abs=1e-12)


@pytest.mark.parametrize(
    ("old", "new"),
    [("movl(", "movel("), ("0.010", "1e-2"), ("set_tool", "#"), ("))", ")"), ("to = [", "to = ["[:-1])],
)
def test_the_stub_refuses_broken_programs(old, new):
    text = text_for(CELL).replace("here[2])", "(here[2]))")
    assert old in text
    with pytest.raises((AssertionError, NameError, TypeError, SyntaxError)):
        run(text.replace(old, new))


def test_check_accepts_programs_with_turns_in_place(tmp_path, capsys):
    path = '<path id="p" d="M20 38 L34 14 L48 38" fill="none" stroke="#000" stroke-width="2"/>'
    drawing, made = tmp_path / "a.svg", tmp_path / "a.jks"
    drawing.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="70mm" height="50mm" viewBox="0 0 70 50">{path}</svg>'
    )
    flags = ["--cell", "jaka-zu3", "--corners", "turn"]
    assert main(["convert", str(drawing), "-o", str(made), *flags]) == 0
    assert "movc(" in made.read_text()
    assert main(["check", str(made), str(drawing), *flags]) == 0
    made.write_text(made.read_text().replace("via = [-", "via = [-1", 1))
    assert main(["check", str(made), str(drawing), *flags]) == 1
