"""A post for RoboDK is called with the moves of the arm.

Moves that the post cannot make are refused.
"""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import gives, in_json, is_reported, refused
from programs import call
from test_urscript import ARC, STROKES, text_for

from brushsvg import _core, find_brush
from brushsvg.machine.cells.cell import Reload, RoboDK, Station
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.job_program import make_checked_program
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.posts import POSTS
from brushsvg.machine.writer import text_of

POST = Path(__file__).with_name("robodk_post.py")


def cell_with(post: Path):
    cell = find_cell("kr6-r900")
    return replace(cell, name="mine", language="robodk", robodk=RoboDK(str(post)))


def test_the_post_is_called_for_each_move(capsys):
    hand = Station("hand", (120.0, 50.0), by_hand=True)
    ink = Station("ink", (120.0, 10.0), ("#ff0000",), depth_mm=5.0, hold_s=0.5)
    cell = replace(cell_with(POST), reload=Reload("layer"), stations=(ink, hand))
    lines = text_for(cell, colours=("#ff0000", "#ff0000", "#000000")).splitlines()
    assert capsys.readouterr().out == "", "what a post prints is no output of brushsvg"
    assert lines[:5] == [
        *("start brushsvg", "; title: two strokes", "frame -150.000 -650.000 20.000 down 1"),
        *("tool 0.000 0.000 150.000 down 1", "acceleration 500"),
    ]
    places = np.array([list(map(float, line.split()[1:4])) for line in lines if line.startswith("line")])
    target = np.array([*STROKES["n/1"], *STROKES["dot"], STROKES["turn"][0], ARC[0], *STROKES["turn"][10:]])
    assert np.linalg.norm(places[None] - target[:, None], axis=2).min(axis=1).max() < 1e-3
    assert all(line.endswith("down -1") for line in lines if line.startswith(("line", "circle")))
    (circle,) = (line for line in lines if line.startswith("circle"))
    assert list(map(float, circle.split(" to ")[1].split()[:3])) == pytest.approx(ARC[8], abs=1e-3)
    at = lines.index("line 12.500 10.000 -3.000 down -1")
    assert lines[at - 1] == "zone 0.039" and lines[at + 1] == "zone 0.152"
    assert "pause 500" in lines and lines[lines.index("pause -1") - 1].endswith(": hand")
    assert lines[-1] == "finish"


def test_a_circle_right_after_the_press_is_painted_at_the_speed_of_painting():
    turn = np.linspace(0, np.pi, 9)
    round_ = np.column_stack([60 - 10 * np.cos(turn), 30 + 10 * np.sin(turn), np.full(9, -2.0)])
    poses = [[50, 30, 0], *round_.tolist(), [70, 20, -2], [70, 20, 0]]
    a_pass = _core.Pass("s", poses, 17.0, arcs=[_core.Arc(1, 9, (60, 30), -1)])
    cell = replace(cell_with(POST), arm=None)
    loads = split_into_loads(_core.Plan("round-6", "", (100, 60), [a_pass]), find_brush("round-6"), cell)
    lines = "".join(
        text_of(POSTS["robodk"], make_checked_program(loads, find_brush("round-6"), cell).allowed())
    ).splitlines()
    (at,) = (k for k, line in enumerate(lines) if line.startswith("circle"))
    speeds = [line for line in lines[:at] if line.startswith("speed")]
    assert speeds[-1] == "speed 17" and speeds[-2] != "speed 17"


def test_a_tilted_brush_is_written_as_single_poses():
    """A tilted brush is written pose by pose.

    The brush leans by 20 degrees towards x from its second pose on, with the tip where the plan has it.
    """
    leans = np.array([[0.0, 0, 1], [np.sin(np.pi / 9), 0, np.cos(np.pi / 9)]])[[0, 1, 1]]
    poses = [[20, 20, 0], [40, 20, -2], [60, 20, -2]]
    plan = _core.Plan("round-6", "", (100, 60), [_core.Pass("s", poses, 20.0, tool_axes=leans)])
    cell = replace(cell_with(POST), arm=None)
    made = make_checked_program(
        split_into_loads(plan, find_brush("round-6"), cell), find_brush("round-6"), cell
    ).allowed()
    lines = "".join(text_of(POSTS["robodk"], made)).splitlines()
    for pose, axis in zip(poses, leans, strict=True):
        place = " ".join(f"{each:.3f}" for each in pose)
        (line,) = {line for line in lines if line.startswith(f"line {place} ")}
        assert float(line.split()[-1]) == pytest.approx(-axis[2], abs=1e-5)
    assert lines[-2].endswith("down -1")  # upright while it travels


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("class RobotPost", "class Post", "post-failed RobotPost"),
        ("def setZoneData", "def setZones", "post-failed setZoneData"),
        ('LOG = ""', 'LOG = "circles are lines"', "post-failed 'circles are lines'"),
        ("assert joints is None", "joints[0]", "post-failed TypeError"),
        ('print("SAVED")', "return", "post-failed 0"),
        ("class RobotPost", "import nowhere\n\n\nclass RobotPost", "post-failed nowhere"),
        ("def ", "de ", "post-failed SyntaxError"),
        ('file.write("\\n".join', 'file.write("" and "\\n".join', "post-failed ProgSave"),
        (
            '.{self.PROG_EXT}", "w") as file:',
            '.{self.PROG_EXT}", "w", encoding="utf-16") as file:',
            "post-failed UTF-8",
        ),
    ],
)
def test_a_post_that_fails_is_refused(tmp_path, old, new, expected):
    text = POST.read_text()
    assert old in text
    (tmp_path / "post.py").write_text(text.replace(old, new, 1))
    with refused(expected):
        text_for(cell_with(tmp_path / "post.py"))


def test_posts_in_threads_leave_the_standard_output_as_it_was(capsys):
    """Another thread prints while posts run. Some of its lines are lost."""
    before, is_over = sys.stdout, threading.Event()

    def print_lines() -> None:
        while not is_over.is_set():
            print("other thread")

    with ThreadPoolExecutor(5) as pool:
        pool.submit(print_lines)
        texts = list(pool.map(lambda _: text_for(cell_with(POST)), range(12)))
        is_over.set()
    assert sys.stdout is before and len(set(texts)) == 1
    assert set(capsys.readouterr().out.split("\n")) <= {"other thread", ""}, "nothing of the posts"


@pytest.mark.parametrize("has_output", [True, False])
def test_all_that_a_post_prints_is_dropped(tmp_path, capsys, monkeypatch, has_output):
    """A post may also write lines or flush. A program without a console has no standard output."""
    post = tmp_path / "post.py"
    printing = 'import sys\n\nsys.stdout.writelines(["a", "b"])\nprint("c", flush=True)\n'
    post.write_text(printing + POST.read_text())
    if not has_output:
        monkeypatch.setattr(sys, "stdout", None)
    assert text_for(cell_with(post)).startswith("start brushsvg")
    assert capsys.readouterr().out == ""


def test_cell_check_refuses_a_missing_post(tmp_path, monkeypatch, capsys):
    """A relative path starts at the current folder, which is often another one than that of the cell."""
    cell = tmp_path / "mine.toml"
    cell.write_text(write_cell(cell_with("mypost.py")))
    (tmp_path / "mypost.py").write_text("")
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    status, out, reported = in_json(capsys, "cell", "check", cell)
    assert (status, out) == (1, "")
    assert is_reported(reported, f"file-unreadable mypost.py {tmp_path / 'other'} 'whole path'", "robodk.post"), (
        reported
    )
    monkeypatch.chdir(tmp_path)
    assert in_json(capsys, "cell", "check", cell)[0] == 0


def test_a_missing_post_and_tables_of_other_languages_are_refused(tmp_path):
    with refused("file-unreadable nowhere.py"):
        text_for(cell_with(tmp_path / "nowhere.py"))
    with refused("key-missing robodk"):
        parse_cell(write_cell(replace(cell_with(POST), robodk=None)))
    with refused("key-unused robodk"):
        parse_cell(write_cell(replace(cell_with(POST), language="krl")))


def test_a_robodk_program_is_written_without_a_check(tmp_path, capsys):
    (tmp_path / "mine.toml").write_text(write_cell(cell_with(POST)))
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="70mm" height="50mm" viewBox="0 0 70 50">'
        '<path id="p" d="M20 25 L48 27" fill="none" stroke="#000" stroke-width="2"/></svg>'
    )
    out = str(tmp_path / "a.robodk")
    status, _, reported = call(
        capsys, "convert", str(tmp_path / "a.svg"), "-o", out, "--cell", str(tmp_path / "mine.toml")
    )
    assert status == 0, reported
    assert Path(out).read_text().startswith("start brushsvg\n; title: ")
    status, _, reported = call(capsys, "check", out, "--cell", str(tmp_path / "mine.toml"))
    assert status == 1 and gives(reported[-1], "a.robodk")
    (tmp_path / "mine.toml").write_text(write_cell(cell_with(tmp_path / "none.py")))
    status, _, reported = in_json(capsys, "convert", tmp_path / "a.svg", "-o", out, "--cell", tmp_path / "mine.toml")
    assert status == 1 and is_reported(reported, "file-unreadable")
