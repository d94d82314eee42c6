"""G-code has the words that LinuxCNC needs.

No controller can misread its numbers.
"""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import in_json, is_reported, refused
from programs import program

from brushsvg import _core, find_brush, read_plan, save_brush, write_cell, write_program
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.moves import program_in_robot_frame
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.posts import POSTS
from brushsvg.machine.posts.gcode import LINE_LIMIT
from brushsvg.machine.realised.rounding import as_written
from brushsvg.verify import simulate_program
from brushsvg.verify.readback import read_program
from brushsvg.verify.readback.gcode import read_gcode

GOLDEN = Path(__file__).parents[1] / "golden" / "two_strokes.ngc"


def text_of(*passes, header=("title: test",), sheet=(100.0, 60.0), limit=25.0, cell="linuxcnc-3axis"):
    passes = [_core.Pass(stroke, np.array(poses, float), speed) for stroke, poses, speed in passes]
    brush = SimpleNamespace(name="b", max_speed_mm_s=limit)
    cell = find_cell(cell)
    made = program(SimpleNamespace(sheet_mm=sheet, passes=passes), brush, cell, header)
    return "".join(POSTS[cell.language].write(program_in_robot_frame(made)))


def feeds_in(text):
    return [float(feed) for feed in re.findall(r"(?m)^F([\d.]+)$", text)]


def code_lines(text):
    return [line for line in text.splitlines() if line and not line.startswith("(")]


TWO = (
    ("n/1", [(10, 10, 0), (12.5, 10, -3), (30.123456, 20.98766, -3.25), (28, 20, 0)], 20.0),
    ("dot", [(40, 30, 0), (40, 30, -2), (43, 30, -2), (42, 30, 0)], 12.5),
)


def test_program_equals_the_golden_file():
    text = text_of(*TWO, header=("title: two strokes", "brush: round-6, 2 strokes"))
    assert text == GOLDEN.read_text(encoding="ascii")


def test_modes_precede_motion_and_the_end_is_marked():
    code = code_lines(text_of(*TWO))
    assert set(code[0].split()) >= {"G21", "G90", "G94", "G17"}
    assert code[2] == "G0 Z10.0000", "up before going anywhere"
    assert code[-1] == "M2"
    before_motion = code[: next(k for k, line in enumerate(code) if line.startswith("G1"))]
    assert any(line.startswith("F") for line in before_motion)


def test_feed_is_in_mm_per_minute_and_follows_every_change():
    code = code_lines(text_of(*TWO))
    feed, seen = None, {}
    for line in code:
        found = re.search(r"^F([\d.]+)$", line)
        feed = float(found[1]) if found else feed
        if line.startswith("G1"):
            seen.setdefault(feed, []).append(line)
    assert set(seen) == {25 * 60, 8 * 60, 20 * 60, 12.5 * 60}
    assert any("X30.1235 Y20.9877 Z-3.2500" in line for line in seen[1200.0])
    assert all("Z0.0000" in line or "Z1.0000" in line or "X40.0000 Y30.0000" in line for line in seen[480.0])
    assert "G1 X40.0000 Y30.0000 Z-2.0000" in seen[480.0], "pressed on the spot as slowly as it lands"


@pytest.mark.parametrize("limit", [50.0, 25.0, 20.0, 7.0009, 2.0])
def test_every_feed_is_under_the_brushs_limit(limit):
    speed = min(limit, 20.0)
    feeds = feeds_in(text_of(("s", TWO[0][1], speed), limit=limit))
    assert max(feeds) <= 60 * limit
    assert min(abs(feed - 60 * speed) for feed in feeds) < 0.1


def test_the_slowest_stroke_has_a_positive_feed():
    assert feeds_in(text_of(("s", TWO[0][1], 1e-5)))[1:] == [0.1]


def test_every_language_has_a_golden_program():
    for post in (
        each for name, each in POSTS.items() if name != "robodk"
    ):  # robodk uses a post that the user writes, which may produce any format
        assert list(GOLDEN.parent.glob(f"*{post.extensions[0]}")), f"tests/golden has no {post.extensions[0]}"


@pytest.mark.parametrize("tiny", [-2.77e-17, -4.9e-5, 1e-300, -0.0])
def test_numbers_are_plain_decimals(tiny):
    text = text_of(("s", [(tiny, 1e-7, min(tiny, 0)), (123456.5, 20, -3), (tiny, 0, 0)], 20.0), sheet=(2e5, 60))
    words = re.findall(r"[XYZFP]\S+", "\n".join(code_lines(text)))
    assert words
    for word in words:
        assert re.fullmatch(r"[XYZFP]-?\d+\.\d+", word), word
        assert not re.fullmatch(r".-0\.0*", word), word


def test_grbl_program_equals_the_golden_file():
    header = ("title: two strokes", "brush: round-6, 2 strokes")
    text = text_of(*TWO, header=header, cell="grbl-3axis")
    assert text == (GOLDEN.parent / "two_strokes_grbl.ngc").read_text(encoding="ascii")


@pytest.mark.parametrize("name", ["fluidnc", "marlin", "klipper"])
def test_programs_for_other_firmware_equal_the_golden_files(name):
    header = ("title: two strokes", "brush: round-6, 2 strokes")
    text = text_of(*TWO, header=header, cell=f"{name}-3axis")
    assert text == (GOLDEN.parent / f"two_strokes_{name}.gcode").read_text(encoding="ascii")


@pytest.mark.parametrize("name", ["marlin-3axis", "klipper-3axis"])
def test_printers_get_one_command_per_line_and_a_feed_for_every_move(name):
    """Printers get one command word per line and a feed for every move.

    They ignore a second word on a line, and G0 moves at the feed of the last F word.
    """
    lines = [line for line in text_of(*TWO, cell=name).splitlines() if line and not line.startswith(";")]
    words = [re.findall(r"[GM]\d+", line) for line in lines]
    assert all(len(each) == 1 for each in words)
    assert {each[0] for each in words} == {"G0", "G1", "G21", "G90", "M400"}
    feed = 0.0
    for line in lines:
        feed = float(found[1]) if (found := re.search(r"F([\d.]+)", line)) else feed
        if line.startswith("G0 X"):
            assert feed == 60 * find_cell(name).speeds.travel_mm_s
    assert feed


@pytest.mark.parametrize(("name", "is_read"), [("marlin-3axis", False), ("klipper-3axis", False), ("grbl-3axis", True)])
def test_printers_ignore_a_command_with_a_sign(name, is_read):
    """Printers do not read a command with a sign.

    Other controllers read G-0 as G0. A printer skips the line, and the next move starts from where the tool
    is.
    """
    damaged, count = re.subn(r"(?m)^G0 X", "G-0 X", text_of(*TWO, cell=name), count=1)
    assert count
    if is_read:
        read_gcode(damaged, find_cell(name))
        return
    with refused("line-unread G-0"):
        read_gcode(damaged, find_cell(name))


HALF_TURNS = [(40 + 4 * np.cos(a), 30 + 4 * np.sin(a), -2.0) for a in np.linspace(0, np.pi, 12)]


@pytest.mark.parametrize(
    ("name", "segment_mm", "off_mm", "is_circle"),
    [
        ("fluidnc-3axis", 0.0, 0.0, True),
        ("fluidnc-3axis", 0.0, 0.009, False),
        ("grbl-3axis", 0.0, 0.009, True),
        ("marlin-3axis", 0.0, 0.0, False),
        ("marlin-3axis", 0.5, 0.0, True),
        ("klipper-3axis", 0.5, 0.0, True),
        ("klipper-3axis", 0.6, 0.0, False),
    ],
)
def test_circles_are_written_as_arcs_only_if_the_firmware_stays_close(name, segment_mm, off_mm, is_circle):
    """Circles are written as arcs only if the firmware stays close to them.

    FluidNC refuses radii that differ by 0.005 mm. Lines of 0.6 mm are up to 0.011 mm from a circle with a
    radius of 4 mm.
    """
    cell = replace(find_cell(name), arc_segment_mm=segment_mm)
    poses = np.array(HALF_TURNS)
    poses[-1, 0] -= off_mm
    a_pass = _core.Pass("round", poses, 20.0, arcs=[_core.Arc(0, 11, (40.0, 30.0), 1)])
    (loaded,) = split_into_loads(_core.Plan("b", "", (100.0, 60.0), [a_pass]), None, cell).loads
    written = as_written(loaded, cell, np.eye(4))
    assert bool(written.arcs) == is_circle
    spokes = np.linalg.norm(written.poses_mm[:, :2] - (40, 30), axis=1)
    assert np.ptp(spokes) < 0.011 and (is_circle or len(spokes) > 12)


def test_grbl_gets_only_commands_it_knows():
    text = text_of(("a" * 200, TWO[0][1], 20.0), cell="grbl-3axis")
    words = {word for line in code_lines(text) for word in re.findall(r"[GM]\d+", line)}
    assert words == {
        "G0",
        "G1",
        "G17",
        "G21",
        "G40",
        "G80",
        "G90",
        "G94",
        "M2",
    }  # grbl 1.1 lists all of these
    assert max(map(len, text.splitlines())) <= 70
    assert "%" not in text


def test_no_rapid_move_is_below_the_safe_height():
    for line in code_lines(text_of(*TWO)):
        if line.startswith("G0 "):
            assert "Z10.0000" in line


def test_comments_are_closed_ascii_without_commands():
    title = "Caf\u00e9 \u6c38 (draft) 50% #5220\nG0 Z-50 " + "x" * 300
    text = text_of(("MSG, (probe)\r\nM3", *TWO[0][1:]), header=(f"title: {title}",))
    comments = [line for line in text.splitlines() if line.startswith("(")]
    assert comments[0].startswith("(title: Cafe ? [draft] 50% #5220 G0 Z-50")
    assert comments[1] == "(stroke 1 of 1: MSG, [probe]  M3)"
    for line in comments:
        assert re.fullmatch(r"\([a-z]+[: ][^()]*\)", line)
    assert all(len(line) <= LINE_LIMIT and line.isascii() for line in text.splitlines())


def test_same_moves_give_the_same_bytes():
    assert text_of(*TWO) == text_of(*TWO)


def test_the_first_rise_clears_all_points_of_tilted_paper():
    cell = find_cell("linuxcnc-3axis")
    cell = replace(cell, paper=replace(cell.paper, rotation_deg=(0.0, -2.0, 0.0)))
    a_pass = SimpleNamespace(
        stroke="s", poses_mm=np.array(TWO[0][1], float), speed_mm_s=20.0, arcs=(), tool_axes=(), colour=""
    )
    plan = SimpleNamespace(sheet_mm=(300.0, 60.0), passes=[a_pass])
    made = program(plan, SimpleNamespace(name="b", max_speed_mm_s=25.0), cell)
    text = "".join(POSTS["linuxcnc"].write(program_in_robot_frame(made)))
    heights = [float(z) for z in re.findall(r"Z(-?[\d.]+)", text)]
    right_edge = 330 * np.sin(np.radians(2)) + 10 * np.cos(np.radians(2))
    assert heights[0] == pytest.approx(right_edge, abs=1e-3) and heights[0] == max(heights)


def cpp_golden(name: str) -> str:
    """Return a golden file of the C++ test of brushsvg::posts.

    tests/cpp/linuxcnc_test.cpp compares the posts with this file. The file belongs to the plan
    flat_machine.plan.json.
    """
    return GOLDEN.with_name(name).read_text(encoding="ascii")


FLAT_PLAN = GOLDEN.with_name("flat_machine.plan.json")


def test_cpp_writes_the_same_program(tmp_path):
    write_program(tmp_path / "it.ngc", read_plan(FLAT_PLAN), find_brush("round-6"))
    text = cpp_golden("flat_machine.ngc")
    assert (tmp_path / "it.ngc").read_text(encoding="ascii") == text
    assert {line[:2] for line in code_lines(text)} >= {"G0", "G1", "G2", "G3", "F4", "F6"}


def bench():
    """A machine, brush and title with unusual numbers and letters.

    linuxcnc_test.cpp has the same values.
    """
    like = find_cell("linuxcnc-3axis")
    speeds = replace(
        like.speeds,
        approach_mm_s=20.0,
        press_mm_s=5.0,
        paint_mm_s=40.0,
        travel_mm_s=8.0,
        acceleration_mm_s2=300.0,
    )
    heights = replace(like.heights, safe_mm=15.0, clearance_mm=2.0)
    blending = replace(like.blending, tolerance_mm=0.0)
    brush, plan = find_brush("round-6"), read_plan(FLAT_PLAN)
    plan.brush = brush.name = "Bürste u\u0308ø"
    return (
        plan,
        brush,
        "Weiß\t(Łódź)",
        replace(like, name="bench", speeds=speeds, heights=heights, blending=blending),
    )


def test_cpp_writes_the_same_program_for_another_machine(tmp_path):
    write_program(tmp_path / "it.ngc", *bench())
    assert (tmp_path / "it.ngc").read_text(encoding="ascii") == cpp_golden("flat_bench.ngc")


def test_check_accepts_cpp_programs_and_finds_changes(tmp_path, capsys):
    (tmp_path / "it.ngc").write_text(cpp_golden("flat_machine.ngc"))
    for call in ([], [FLAT_PLAN]):
        assert in_json(capsys, "check", tmp_path / "it.ngc", *call)[::2] == (0, [])
    _, brush, _, cell = bench()
    save_brush(brush, tmp_path / "own.json")
    (tmp_path / "bench.toml").write_text(write_cell(cell))
    (tmp_path / "it.ngc").write_text(cpp_golden("flat_bench.ngc"))
    call = ("check", tmp_path / "it.ngc", "--cell", tmp_path / "bench.toml", "--brush", tmp_path / "own.json")
    assert in_json(capsys, *call)[::2] == (0, [])
    (tmp_path / "it.ngc").write_text(cpp_golden("flat_bench.ngc").replace("F300.0", "F900.0", 1))
    status, _, reported = in_json(capsys, *call)
    assert status == 1 and is_reported(reported, "program-changed 15.0 5.0")


def test_a_stroke_is_read_with_the_speed_of_its_fastest_move():
    text = GOLDEN.read_text(encoding="ascii").replace(
        "F1200.0\nG1 X12.5000 Y10.0000 Z-3.0000", "F1500.0\nG1 X12.5000 Y10.0000 Z-3.0000\nF1200.0"
    )
    cell = find_cell("linuxcnc-3axis")
    ran = simulate_program.simulate_program(
        read_program(text, ".ngc", cell), find_brush("round-6"), cell, (100.0, 60.0)
    )
    assert ran.plan.passes[0].speed_mm_s == 25.0
