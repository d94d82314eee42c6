"""EBB commands have exact places, allowed slice times and servo heights.

Places are whole steps without drift. No slice is too fast or too slow for a motor or a brush. A stub made
from the board's documentation reads the commands.
"""

import re
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import in_json, is_reported, refused
from judge.ebb import run_ebb
from programs import RUNNABLE, call, is_refused_when_damaged, program
from shown_code import DOCS, blocks
from test_urscript import BRUSH, STROKES, text_for

from brushsvg import _core
from brushsvg.machine.cells.cell import Motors, Paper, robot_from_paper
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.moves import duration_s
from brushsvg.machine.posts import POSTS, ebb
from brushsvg.machine.posts.ebb import HOME
from brushsvg.machine.writer import text_of

GOLDEN = Path(__file__).parents[1] / "golden" / "two_strokes.ebb"
CELL = find_cell("axidraw-ebb")
ROWS = np.array(CELL.motors.steps_per_mm)
SHEET = (100.0, 60.0)
DRAWING = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60"><g fill="none" '
    'stroke="#000"><path d="M20 30c10-20 30 20 50 0" stroke-width="2"/><path d="M30 45h30"/></g></svg>'
)


def made(*passes, cell=CELL, speed=20.0):
    passes = [_core.Pass(f"s{k}", np.array(poses, float), speed) for k, poses in enumerate(passes, 1)]
    return "".join(text_of(POSTS["ebb"], program(_core.Plan("b", "", SHEET, passes), BRUSH, cell)))


def run(text, cell=CELL):
    motors = {"steps_per_mm": cell.motors.steps_per_mm, "servo_pin": cell.motors.servo_pin}
    found = run_ebb(text, (0.0, 0.0, 1.0), motors, cell.servo.table)
    assert not found.refused and not found.acts
    assert found.legs[-1].end[:2] == (0.0, 0.0), "the next program begins where this one did"
    return found


def wave(count=200):
    t = np.linspace(0, 1, count)
    depth = -3 * np.minimum(1, 8 * np.minimum(t, 1 - t))
    return np.column_stack([10 + 70 * t, 30 + 15 * np.sin(9 * t), depth])


def test_program_equals_the_golden_file():
    assert text_for(CELL) == GOLDEN.read_text(encoding="ascii")


@pytest.mark.parametrize(
    "motors", [CELL.motors, Motors(((80.0, 0.0), (0.0, -100.0)), 5), Motors(((80.0, 30.0), (-20.0, 60.0)))]
)
@pytest.mark.parametrize("turned_deg", [0.0, 25.0])
def test_every_pose_is_reached_within_half_a_motor_step(motors, turned_deg):
    cell = replace(CELL, motors=motors, paper=Paper((-8.0, 5.0, 0.0), (0.0, 0.0, turned_deg)))
    paths = [wave(), STROKES["n/1"], STROKES["dot"]]
    found = run(made(*paths, cell=cell), cell)
    rows, frame = np.array(motors.steps_per_mm), robot_from_paper(cell)
    ends = np.array([leg.end for leg in found.legs])
    steps = ends[:, :2] @ rows.T
    assert np.abs(steps - np.rint(steps)).max() < 1e-6
    away_steps = 0.0
    for pose in np.vstack([np.array(path, float) for path in paths]):
        target = (frame @ [*pose[:2], 0.0, 1.0])[:2] @ rows.T
        off = np.abs(steps - target).max(axis=1)
        at = off <= 0.5 + 1e-6
        assert at.any(), pose
        assert np.abs(ends[at, 2] - pose[2]).min() < cell.servo.step_mm, "half a step, where parts may be so short"
        away_steps = max(away_steps, off[at].min())
    assert away_steps > 0.4


def test_the_program_time_is_the_sum_of_its_commands():
    dashes = [[(10 + 2 * k, 10, 0), (10 + 2 * k, 12, -2), (10 + 2 * k, 30, -2)] for k in range(40)]
    passes = [_core.Pass(f"s{k}", np.array(poses, float), 20.0) for k, poses in enumerate(dashes, 1)]
    ran = program(_core.Plan("b", "", SHEET, passes), BRUSH, CELL)
    text = "".join(text_of(POSTS["ebb"], ran))
    waits_ms = [int(row[1]) for row in re.finditer(r"^S[M2],(?:\d+,\d+,\d+,)?(\d+)", text, re.MULTILINE)]
    assert duration_s(ran) == pytest.approx(sum(waits_ms) / 1e3, rel=0.06)


def test_rounding_does_not_accumulate_over_a_page():
    """A page does not drift.

    Steps are differences of rounded places. The errors of rounded differences would add up.
    """
    dashes = [
        [(10 + 0.83 * k, 10, 0), (10.303 + 0.83 * k, 40.007, -1), (10.303 + 0.83 * k, 40.007, 0)] for k in range(90)
    ]
    found = run(made(*dashes))
    last = [leg for leg in found.legs if leg.end[2] < 0][-1]
    assert np.abs(np.subtract(last.end[:2], dashes[-1][-1][:2])).max() <= 0.00625 + 1e-9


def test_speeds_change_by_the_cells_acceleration_in_slices():
    found = run(made([(10, 10, 0), (10, 10, -2), (70, 10, -2), (70, 10, 0)]))
    most = CELL.speeds.acceleration_mm_s2
    for low in (False, True):
        legs = [leg for leg in found.legs if leg.kind == "feed" and (leg.end[2] < 0) == low]
        speeds = np.array([leg.speed_mm_s for leg in legs])
        times = np.array([np.linalg.norm(np.subtract(leg.end, leg.start)) for leg in legs]) / speeds
        limit = 20.0 if low else CELL.speeds.travel_mm_s
        assert 0.97 * limit < speeds.max() <= limit + 1e-9
        # Rounding a slice adds or removes a step and a millisecond.
        slack = 2 * 0.0125 / times.min()
        changes = np.abs(np.diff(np.r_[0.0, speeds, 0.0]))
        between = (np.r_[0.0, times] + np.r_[times, 0.0]) / 2
        assert (changes <= 1.1 * most * between + slack + 1.5).all()


def test_no_slice_is_too_short_and_path_and_heights_are_unchanged(monkeypatch):
    """No slice is too short for the board; path and heights stay unchanged.

    Without this rule, 7 of 10 slices of a wave are shorter than 16 ms.
    """
    t = np.linspace(0, 1, 900)
    straight = [(10, 50, 0), (10, 50, -1), (11.3, 50, -1), (12.2, 50.4, -1), (12.2, 50.4, 0)]
    paths = [
        wave(),
        np.column_stack([10 + 20 * t, 10 + 0.3 * np.sin(300 * t), -1 - np.sin(9 * t) ** 2]),
        straight,
    ]
    texts = [made(*paths)]
    monkeypatch.setattr(ebb, "MIN_SLICE_MS", 1)
    texts.append(made(*paths))
    times = [[int(each) for each in re.findall(r"(?m)^SM,(\d+),(?!0,0$)", text)] for text in texts]
    assert min(times[0]) >= 16 and np.mean(np.array(times[1]) < 16) > 0.5
    assert len(times[0]) < len(times[1])
    new, old = ([(leg.start, leg.end) for leg in run(text).legs if leg.kind != "wait"] for text in texts)
    assert [leg for leg in new if leg[0][:2] == leg[1][:2]] == [leg for leg in old if leg[0][:2] == leg[1][:2]]
    places, k = np.array([end for _, end in old]), 0
    for start, end in new:  # each slice merges one or several old slices on one straight line
        first, k = k, k + 1 + int((np.abs(places[k:] - end).max(axis=1) < 1e-9).argmax())
        assert np.allclose(places[k - 1], end)
        along = np.subtract(end, start)[:2]
        off = places[first:k, :2] - start[:2]
        across = np.abs(off @ (-along[1], along[0])) / max(np.hypot(*along), 1e-9)
        assert across.max() < 0.0125 and np.ptp(places[first:k, 2]) < 1e-9
    assert k == len(places)


def test_no_speed_is_too_low_or_too_high_for_a_motor():
    """No speed is too low or too high for a motor.

    The stub refuses less than 1.31 and more than 25,000 steps per second.
    """
    fast = replace(CELL, speeds=replace(CELL.speeds, travel_mm_s=220.0, acceleration_mm_s2=5000.0))
    run(made(wave(), cell=fast))
    found = run(made([(10, 10, 0), (10, 10, -1), (12.003, 11.984, -1), (12.003, 11.984, 0)], speed=0.1))
    slow = [leg.speed_mm_s for leg in found.legs if leg.kind == "feed" and leg.end[2] < 0]
    assert 0.05 < max(slow) <= 0.1
    fine = replace(fast, motors=Motors(((300.0, 0.0), (0.0, 300.0)), 5))  # no cell file may contain this
    run(made(wave(), cell=fine), fine)
    with refused("out-of-range 222 0.1 221.0"):
        parse_cell(write_cell(replace(CELL, speeds=replace(CELL.speeds, travel_mm_s=222.0))))


def test_the_servo_stays_on_and_is_set_before_the_motors_move():
    lines = [line for line in text_for(CELL).splitlines() if not line.startswith("#")]
    assert lines[:3] == ["SR,0,1", "EM,1,1", "S2,21200,4,0,0"]
    assert all(re.fullmatch(r"S2,\d+,4,0,\d+|SM,\d+,-?\d+,-?\d+", line) for line in lines[2:])


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.svg").write_text(DRAWING)
    return tmp_path


def test_check_accepts_written_programs(desk, capsys):
    assert call(capsys, "convert", "a.svg", "-o", "a.ebb", "--cell", "axidraw-ebb")[0] == 0
    assert RUNNABLE in call(capsys, "check", "a.ebb", "a.svg")[1]
    for name, words in (
        ("b", ("setup", "border", "a.svg", "-o", "b.ebb")),
        ("h", ("setup", "height", "-o", "h.ebb")),
    ):
        assert call(capsys, *words, "--cell", "axidraw-ebb")[0] == 0
        assert RUNNABLE in call(capsys, "check", f"{name}.ebb")[1]


@pytest.mark.parametrize(
    ("old", "new", "reported"),
    [
        (r"(SM,\d+,-?\d+,-?\d+\n)(?=# feed)", "", "line-incomplete"),
        (r"# feed 1200.0 mm/min(?=\nS2,\d+,4,0,0\n)", "# feed 6000.0 mm/min", "speed-out-of-range"),
        (r"# feed 1200.0 mm/min\n(?=S2,\d+,4,0,0\n)", "", "speed-out-of-range"),
        (r"(?<=SM,)\d+(?=,-?[1-9]\d\d,)", "5", "speed-out-of-range"),
        (r"SR,0,1\n", "", "line-unread"),
        (r"EM,1,1\n", "", "mode-missing"),
        (r"EM,1,1", "EM,2,2", "line-unread"),
        (r"S2,21200,4,0,0", "S2,25000,4,0,0", "servo-out-of-range 10800 23600"),
        (r"S2,\d+,4,0,(?=[1-9])", "S2,21200,5,0,", "line-unread"),
        (r"S2,21200,4,0,\d+\n(?=SM,150,0,0\n# stroke 2)", "", "program-changed"),
        (rf"# {HOME}\n[^#]*", "", "line-unread"),
        (r"# end: the .*\n", "", "program-cut-short"),
        (r"\n# stroke 2", "\nSP,0\n# stroke 2", "line-unread"),
    ],
)
def test_check_refuses_damaged_programs(desk, capsys, old, new, reported):
    call(capsys, "convert", "a.svg", "-o", "a.ebb", "--cell", "axidraw-ebb")
    assert is_refused_when_damaged(capsys, Path("a.ebb"), old, new, reported)


def test_the_documented_sender_sends_only_commands_and_stops_at_an_error(desk, capsys, monkeypatch):
    call(capsys, "convert", "a.svg", "-o", "a.ebb", "--cell", "axidraw-ebb")
    (sender,) = (block.code for block in blocks(DOCS / "machines" / "ebb.md") if block.kind == "python")
    sent = []

    class Serial:
        def __init__(self, port, timeout):
            assert port == "/dev/ttyACM0" and timeout > 10

        __enter__ = lambda self: self  # noqa: E731
        __exit__ = lambda *_: None  # noqa: E731

        def write(self, data):
            assert data.endswith(b"\r")
            sent.append(data[:-1].decode())

        def readline(self):
            return b"!8 Err: no\r\n" if len(sent) == most else b"OK\r\n"

    monkeypatch.setitem(sys.modules, "serial", SimpleNamespace(Serial=Serial))
    monkeypatch.setattr(sys, "argv", ["send.py", "a.ebb", "/dev/ttyACM0"])
    most = 0
    exec(sender, {})
    target = [line for line in Path("a.ebb").read_text().splitlines() if not line.startswith("#")]
    assert sent == target
    sent.clear()
    most = 5
    with pytest.raises(SystemExit, match="!8 Err"):
        exec(sender, {})
    assert sent == target[:5]


def test_a_start_outside_the_workspace_is_reported(desk, capsys):
    far = replace(CELL, name="far", paper=Paper((100.0, 0.0, 0.0)))
    Path("far.toml").write_text(write_cell(far))
    status, _, reported = in_json(capsys, "convert", "a.svg", "-o", "a.ebb", "--cell", "far.toml")
    assert status == 1 and is_reported(reported, "tool-off-sheet 70.00 motors")


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        ({"motors": None}, "key-missing motors"),
        ({"servo": None}, "key-missing servo"),
        ({"motors": Motors(((80.0, 80.0), (80.0, 80.0)))}, "out-of-range 'motors.steps_per_mm'"),
        ({"language": "grbl-servo"}, "key-unused motors grbl-servo"),
        ({"servo": replace(CELL.servo, table=((-8.0, 0.0), (6.0, 70000.0)))}, "servo-table 65535"),
        ({"servo": replace(CELL.servo, table=())}, "servo-table"),
        ({"paper": Paper((0.0, 0.0, 3.0))}, "paper-tilted"),
    ],
)
def test_a_cell_that_the_board_cannot_run_is_refused(change, reported):
    with refused(reported):
        parse_cell(write_cell(replace(CELL, **change)))
