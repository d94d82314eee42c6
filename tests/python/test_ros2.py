"""Poses with times for ROS 2: the table, and the message as rosbags reads it.

The machine must be able to keep the times.
"""

import json
import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from diagnostics import gives, refused
from judge import places
from judge.ros2 import run_ros2
from programs import RUNNABLE, call, program
from test_robot_scripts import GOLDEN, LEANING, SQUARE, TURNED, on
from test_urscript import ARC, BRUSH, STROKES, text_for

from brushsvg import _core, batch, convert, write_plan
from brushsvg.errors import Error
from brushsvg.machine.cells.cell import Machine, Paper, Reload, Station, robot_from_paper
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.moves import program_in_robot_frame
from brushsvg.machine.posts import POSTS
from brushsvg.machine.timed_moves import POSE_ROW, SLICE_S, make_timed_sections, time_lines
from brushsvg.machine.writer import text_of
from brushsvg.verify.readback import read_program

DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">'
    '<path d="M20 20H60" fill="none" stroke="#000" stroke-width="3"/></svg>'
)
WAVE = np.linspace(0, 1, 40)
POSES = np.column_stack([20 + 40 * WAVE, 30 + 4 * np.sin(9 * WAVE), -2 * np.minimum(1, 8 * np.minimum(WAVE, 1 - WAVE))])


def made(cell):
    plan = _core.Plan("b", "", (100.0, 60.0), [_core.Pass("wave", POSES, 20.0)])
    return program(plan, BRUSH, cell)


def table(cell) -> np.ndarray:
    return np.vstack([rows for _, rows in make_timed_sections(program_in_robot_frame(made(cell)))])


def run(text: str, cell):
    spin = places.down_of({"tool": {"spin_deg": cell.tool.spin_deg}})
    tool = places.tool_of({"tool": {"tcp_mm": cell.tool.tcp_mm, "rotation_deg": cell.tool.rotation_deg}})
    return run_ros2(text, (0.0, 0.0, 0.0), robot_from_paper(cell), spin, tool)


@pytest.mark.parametrize("paper", [SQUARE, TURNED, LEANING], ids=["square", "turned", "leaning"])
def test_the_brush_passes_all_poses_of_the_plan(paper):
    cell = on("fr3", paper)
    cell = replace(cell, tool=replace(cell.tool, rotation_deg=(0.0, 10.0, 0.0), spin_deg=30.0))
    text = text_for(cell)
    ran = run(text, cell)
    assert not ran.refused and not ran.acts and max(leg.tilt_rad for leg in ran.legs) < 1e-6
    ends = places.moved(np.linalg.inv(robot_from_paper(cell)), np.array([leg.end for leg in ran.legs]))
    target = np.array([*STROKES["n/1"], *STROKES["dot"], STROKES["turn"][0], *ARC, *STROKES["turn"][10:]])
    away_mm = np.linalg.norm(ends[None] - target[:, None], axis=2).min(axis=1)
    assert away_mm.max() < 1e-3
    on_paper = np.minimum(ends[1:, 2], ends[:-1, 2]) < 0
    speeds = np.array([leg.speed_mm_s for leg in ran.legs[1:]])
    assert speeds[on_paper].max() < 20.01 and speeds.max() < 100.01


def test_speeds_and_accelerations_respect_the_cell():
    """Speeds and accelerations stay within the cell's limits.

    The test uses differences between rows, which the rounding of the table changes only a little.
    """
    cell = on("fr3", SQUARE)
    most = cell.speeds.acceleration_mm_s2
    rows = table(cell)
    after_s = np.diff(rows[:, 0])
    assert after_s.min() > 0
    steps = np.diff(rows[:, 1:4], axis=0)
    ways = np.linalg.norm(steps, axis=1)
    speeds = ways / after_s
    assert (speeds <= rows[1:, 4] * (1 + 1e-6)).all()
    # With constant acceleration, the difference of two mean speeds is proportional to the time between the
    # middles of the two intervals.
    changes = np.abs(np.diff(speeds)) / (after_s[1:] + after_s[:-1]) * 2
    assert changes.max() < most * 1.01
    ramps = (after_s < 1.5 * SLICE_S) & (speeds < 0.99 * rows[1:, 4])
    assert ramps.sum() > 20 and np.median(changes[ramps[1:] & ramps[:-1]]) > 0.5 * most


def test_uncut_corners_are_stops_and_cut_corners_are_slow():
    cell = on("fr3", SQUARE)
    rows = table(cell)
    gentle = replace(cell, speeds=replace(cell.speeds, acceleration_mm_s2=20.0))
    stiff = replace(cell, blending=replace(cell.blending, tolerance_mm=0.0))
    assert table(gentle)[-1, 0] > 1.5 * rows[-1, 0]
    assert table(stiff)[-1, 0] > 1.2 * rows[-1, 0]
    poses = rows[rows[:, 5] == POSE_ROW]
    middle = np.flatnonzero(poses[:, 4] == 20.0)[5:-5]
    speeds = np.linalg.norm(np.diff(poses[middle, 1:4], axis=0), axis=1) / np.diff(poses[middle, 0])
    assert speeds.max() > 19.0 and speeds.min() > 10.0, "the brush does not stop on its way"


def message(text: str) -> tuple[list[list[float]], str, str]:
    """Return the times, positions and rotations of a table, its frame and its link."""
    rows = [line.split(",") for line in text.splitlines() if line[0] in "-0123456789"]
    frames = re.search(r"# frame: (\S+)\n# link: (\S+)", text).groups()
    return [[float(cell) for cell in row[:8]] for row in rows], *frames


@pytest.mark.parametrize("acceleration_mm_s2", [20.0, 100.0, 500.0])
def test_each_row_has_a_later_time_than_the_row_before_it(acceleration_mm_s2):
    random = np.random.default_rng(1)
    for _ in range(1000):
        count = int(random.integers(2, 12))
        lengths = np.round(10 ** random.uniform(-2, 1.5, count), 3).tolist()
        caps = random.choice([0, 3, 5, 15, 20, 100, 1e9], count - 1).tolist()
        top_mm_s = float(random.choice([5, 20, 100]))
        times = [when_s for _, when_s, _ in time_lines(lengths, caps, [top_mm_s] * count, acceleration_mm_s2)]
        assert np.diff([0.0, *times]).min() > 1e-7


def test_json_contains_the_rows_of_the_table():
    cell = on("fr3", SQUARE)
    post, whole = POSTS["ros2"], made(cell)
    csv, traj = ("".join(text_of(post, whole, suffix)) for suffix in (".csv", ".traj"))
    rows = json.loads(traj)["rows"]
    reported = [row for row in rows if len(row) == 10 and row[0] != "time_s"]
    assert [row[:8] for row in reported] == message(csv)[0]
    assert {row[9] for row in reported} == {"pose", "way"}
    read = [read_program(text, ".csv", cell) for text in (csv, traj)]
    assert [act[1:] for act in read[0].acts] == [act[1:] for act in read[1].acts]


@pytest.mark.skipif(not find_spec("rosbags"), reason="rosbags is not installed")
@pytest.mark.parametrize("name", ["fr3_link8", "tool0", "arm/flange", "a"])
def test_rosbags_reads_the_message(name):
    """rosbags reads the message for frame names of any length.

    The length of a name shifts the position of the doubles in the message.
    """
    from rosbags.typesys import Stores, get_typestore

    cell = on("fr3", TURNED)
    cell = replace(cell, tool=replace(cell.tool, flange_frame=name))
    rows, frame, link = message("".join(text_of(POSTS["ros2"], made(cell))))
    data = b"".join(text_of(POSTS["ros2"], made(cell), ".cdr"))
    store = get_typestore(Stores.ROS2_HUMBLE)
    kind = "trajectory_msgs/msg/MultiDOFJointTrajectory"
    reported = store.deserialize_cdr(data, kind)
    assert (reported.header.frame_id, list(reported.joint_names)) == (frame, [link]) == ("fr3_link0", [name])
    assert len(reported.points) == len(rows) > 60
    for point, row in zip(reported.points, rows, strict=True):
        (one,) = point.transforms
        at, turn, time = one.translation, one.rotation, point.time_from_start
        assert time.sec + 1e-9 * time.nanosec == pytest.approx(row[0], abs=1e-7)
        assert (at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w) == pytest.approx(row[1:])
        assert len(point.velocities) == len(point.accelerations) == 0
    assert bytes(store.serialize_cdr(reported, kind)) == data


def test_check_accepts_a_job_as_table_and_as_json(tmp_path, capsys):
    plan = _core.Plan("round-6", "", (100.0, 60.0), [_core.Pass("wave", POSES, 20.0)])
    (tmp_path / "a.json").write_text(_core.write_plan(plan))
    for suffix in (".csv", ".traj", ".cdr"):
        out = str(tmp_path / f"a{suffix}")
        assert call(capsys, "convert", str(tmp_path / "a.json"), "-o", out, "--cell", "fr3")[0] == 0
        status, printed, reported = call(capsys, "check", out, str(tmp_path / "a.json"))
        assert (RUNNABLE in printed) if suffix != ".cdr" else (status == 1 and gives(reported[-1], ".csv"))
    message = (tmp_path / "a.cdr").read_bytes()
    done = convert(plan, tmp_path / "py.cdr", cell="fr3")
    assert done.texts[".cdr"] == (tmp_path / "py.cdr").read_bytes() == message
    with pytest.raises(Error, match="binary"):
        _ = done.text
    made = batch([("line", DRAWING)], tmp_path / "many", cell="fr3", format=".cdr", executor=ThreadPoolExecutor(1))
    assert [row.code for row in made.rows] == [""] and (tmp_path / "many/programs/line.cdr").read_bytes()[:1] == b"\0"
    text = (tmp_path / "a.traj").read_text()
    (tmp_path / "a.traj").write_text(text.replace('0.02,"pose"', '0.02,"way"', 1))
    assert call(capsys, "check", str(tmp_path / "a.traj"))[0] == 1
    (tmp_path / "a.traj").write_text(text[:-4])
    assert "not valid JSON" in call(capsys, "check", str(tmp_path / "a.traj"))[2][-1]
    (tmp_path / "a.traj").write_text("[" * 100_000)
    assert "nested too deeply" in call(capsys, "check", str(tmp_path / "a.traj"))[2][-1]


def test_programs_equal_the_golden_files():
    assert text_for(find_cell("fr3")).encode("ascii") == (GOLDEN / "two_strokes.csv").read_bytes()


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("0.02,pose", "0.03,pose", "line-unread"),
        ("\n0.7700000", "\n0.7450000", "line-unread"),
        ("\n0.7700000", "\n0.7450001", "speed-out-of-range"),
        ("1.000000000,0.000000000,0", "0.999900000,0.014000000,0", "tool-turned"),
        ("1.000000000,0", "1.200000000,0", "line-unread"),
        ("0.0000000,", "0.1000000,", "line-unread 0"),
        ("time_s,", "", "line-unread"),
        (",way", ",rest", "line-unread"),
        ("# end: the brush is held up\n", "", "program-cut-short"),
    ],
)
def test_the_reader_refuses_invalid_programs(old, new, expected):
    text = text_for(find_cell("fr3"))
    assert old in text
    with refused(expected):
        read_program(text.replace(old, new, 1), ".csv", find_cell("fr3"))


def test_manual_stations_are_refused_and_frames_need_names():
    cell = find_cell("fr3")
    by_hand = replace(cell, reload=Reload("layer"), stations=(Station("hand", (120.0, 50.0), by_hand=True),))
    for each, expected in (
        (by_hand, "cell-station"),
        (replace(cell, tool=replace(cell.tool, base_frame="a b")), "name-invalid 'a b'"),
        # A message gives the length of a name in bytes, and a table has 7-bit text only.
        (replace(cell, tool=replace(cell.tool, flange_frame="flänge")), "name-invalid 'flänge'"),
        (
            replace(find_cell("cr5"), tool=replace(find_cell("cr5").tool, base_frame="base")),
            "key-unused frames",
        ),
    ):
        with refused(expected):
            parse_cell(write_cell(each))


def test_check_accepts_lifts_hardly_longer_than_the_rounding(tmp_path, monkeypatch, capsys):
    """Check accepts lifts that are hardly longer than the rounding.

    The lifts are about 0.015 mm long, on a machine that leans. Their speed depends on the last decimals of
    both ends.
    """
    monkeypatch.chdir(tmp_path)
    cell = find_cell("fr3")
    leans = Machine(lean_mm_per_mm=(-0.333, -0.861), scale=(1.0014, 1.035), skew=0.0589, height_mm=-1.2)
    cell = replace(cell, paper=Paper(cell.paper.origin_mm, (0.0, 0.0, 276.023)), arm=None, machine=leans)
    Path("mine.toml").write_text(write_cell(cell))
    random, passes = np.random.default_rng(3), []
    for k in range(40):
        x, y, z = random.uniform(10, 80), random.uniform(10, 45), -random.uniform(0.009, 0.02)
        way = [(x, y, 0), (x, y, -2), (x + 3, y + 1, -2), (x + 3.3, y + 1.2, z), (x + 3.3, y + 1.2, 0)]
        passes.append(_core.Pass(f"s{k}", np.array(way), 20.0))
    Path("p.json").write_text(write_plan(_core.Plan("round-6", "", (100, 60), passes)))
    assert call(capsys, "convert", "p.json", "-o", "p.csv", "--cell", "mine.toml")[0] == 0
    status, _, reported = call(capsys, "check", "p.csv", "p.json", "--cell", "mine.toml")
    assert status == 0, reported
