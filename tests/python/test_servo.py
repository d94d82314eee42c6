"""G-code for a brush on a servo paints at the heights that the plan asks for."""

import itertools
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import agrees, in_json, is_reported, refused
from programs import RUNNABLE, call, program
from test_gcode import TWO, text_of

from brushsvg import _core, write_plan
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.machine.cells.cell import Machine, Reload, Servo, Station, is_too_steep_for_servo
from brushsvg.machine.cells.cell_file import cell_names, find_cell, parse_cell, write_cell
from brushsvg.machine.job_program import Job
from brushsvg.machine.posts.gcode_servo import grbl_servo, servo_values_at
from brushsvg.machine.realised.rounding import as_written
from brushsvg.machine.setup_programs import make_border_program
from brushsvg.model.library import find_brush
from brushsvg.verify import simulate_program
from brushsvg.verify.against_regenerated import _ActComparison
from brushsvg.verify.readback import Act, read_program
from brushsvg.verify.servo_lifts import drop_rounding_lifts

GOLDEN = Path(__file__).parents[1] / "golden" / "two_strokes_servo.ngc"
CELL = find_cell("grbl-servo")


def run(text):
    """Return (x, y, height) at the end of each move, and the total waiting time [s].

    The servo keeps its height along each line.
    """
    table = np.array(sorted(CELL.servo.table))
    x = y = value = None
    rows, waited = [], 0.0
    for line in text.splitlines():
        words = dict(re.findall(r"([XYSP])(-?[\d.]+)", line.split("(")[0]))
        waited += float(words.get("P", 0))
        value = int(words["S"]) if "S" in words else value
        if "X" in words:
            x, y = float(words["X"]), float(words["Y"])
        if x is not None and {"X", "S"} & set(words):
            rows.append((x, y, float(np.interp(value, table[:, 1], table[:, 0]))))
    return rows, waited


def test_program_equals_the_golden_file():
    header = ("title: two strokes", "brush: round-6, 2 strokes")
    assert text_of(*TWO, header=header, cell="grbl-servo") == GOLDEN.read_text(encoding="ascii")


def test_heights_along_the_path_equal_the_plan():
    rows, _ = run(text_of(*TWO, cell="grbl-servo"))
    for _, poses, _ in TWO:
        for pose in poses:
            near = [row for row in rows if np.hypot(row[0] - pose[0], row[1] - pose[1]) < 1e-3]
            away = min(abs(row[2] - pose[2]) for row in near)
            assert away <= CELL.servo.step_mm / 2 + 0.02, "half a step, and half a value"


def test_only_lifts_wait_for_the_servo():
    _, waited = run(text_of(("dab", [(10, 10, 0), (10, 10, -2), (10, 10, 0)], 20.0), cell="grbl-servo"))
    down_s = (CELL.heights.safe_mm - CELL.heights.clearance_mm) / 20 + CELL.heights.clearance_mm / 6 + 2 / 6
    up_s = 2 / 6 + CELL.heights.clearance_mm / 6 + (CELL.heights.safe_mm - CELL.heights.clearance_mm) / 50
    lifts = 7  # one up before all else; then approach, land, press, release, lift, retract
    assert waited == pytest.approx(down_s + up_s + lifts * CELL.servo.settle_s, abs=0.06)


@pytest.mark.parametrize(("values", "step_mm"), [(80, 0.5), (150, 0.25), (1000, 0.1)])
def test_no_lift_is_faster_than_programmed_after_rounding(values, step_mm):
    """No lift is faster than programmed, for the values that are written.

    The last part of a line is held at half a step from its end height. A lift after the line begins there,
    and values are whole numbers. Waits were once computed from the plan's heights and were up to half too
    short.
    """
    cell = replace(CELL, servo=Servo(((-10.0, 0.0), (0.0, 0.6 * values), (5.0, float(values))), step_mm, 0.0))
    poses = np.array([(10, 10, 0), (10, 10, -1), (14, 10, -3.3), (16, 11, -1.7), (16, 11, 0)])
    plan = SimpleNamespace(
        sheet_mm=(100.0, 60.0),
        passes=[SimpleNamespace(stroke="a", poses_mm=poses, speed_mm_s=5.0, arcs=(), tool_axes=(), colour="")],
    )
    brush = SimpleNamespace(name="b", max_speed_mm_s=25.0)
    lines = "".join(grbl_servo(program(plan, brush, cell))).splitlines()
    table, height, feed, lifts = np.array(cell.servo.table), None, None, 0
    for line, after in itertools.pairwise(lines):
        words = dict(re.findall(r"([FSP])(-?[\d.]+)", line.split("(")[0]))
        feed = float(words.get("F", feed or 0)) / (60 if "F" in words else 1)
        if "S" not in words:
            continue
        before, height = height, np.interp(float(words["S"]), table[:, 1], table[:, 0])
        if line.startswith("M3") and before is not None:
            lifts += 1
            assert abs(height - before) / float(after.removeprefix("G4 P")) <= feed + 1e-9
    assert lifts > 8


def test_a_lift_waits_for_the_value_of_a_short_line_before_it():
    """Where a value is more than a step, a short line and a lift after it set two values, but not at once."""
    cell = replace(CELL, servo=Servo(((-10.0, 0.0), (18.0, 100.0)), 0.1, 0.0))  # 0.28 mm for each value
    poses = np.array([(10, 10, 0), (12, 10, -2.72), (12.02, 10, -2.53), (12.02, 10, 0)])
    plan = SimpleNamespace(
        sheet_mm=(100.0, 60.0),
        passes=[SimpleNamespace(stroke="a", poses_mm=poses, speed_mm_s=5.0, arcs=(), tool_axes=(), colour="")],
    )
    lines = "".join(grbl_servo(program(plan, SimpleNamespace(name="b", max_speed_mm_s=25.0), cell))).splitlines()
    short_line = next(k for k, line in enumerate(lines) if line.startswith("G1 X12.020"))
    set_before, set_here = (int(re.search(r"S(\d+)", lines[k])[1]) for k in (short_line - 1, short_line))
    assert set_here == set_before + 1, "the short line sets a new value"
    after = [line for line in lines[short_line + 1 :] if not line.startswith("F")]
    assert re.fullmatch(r"G4 P0\.0[45]\d*", after[0]), "0.28 mm at the speed of lifts, 6 mm/s"
    assert after[1].startswith("M3 S")


@pytest.mark.parametrize("rim_mm", [-5.0, 0.0])
@pytest.mark.parametrize("language", ["grbl-servo", "grbl-3axis"])
def test_moves_in_a_vessel_below_the_paper_are_slow(tmp_path, monkeypatch, capsys, language, rim_mm):
    """The brush moves slowly into and out of a vessel that is lower than the paper.

    Programs once moved down to the vessel and up again at the speed for free air, and the reader refused
    them. The reader also refused a dip faster than the cell paints.
    """
    ink = Station("ink", (-10.0, 10.0), surface_mm=-5.5, depth_mm=2.0, rim_mm=rim_mm, wipe_mm=((-8.0, 10.0, rim_mm),))
    cell = find_cell(language)
    cell = replace(cell, name="mine", stations=(ink,), reload=Reload("stroke"))
    cell = replace(cell, speeds=replace(cell.speeds, paint_mm_s=4.0, press_mm_s=6.0))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(write_cell(cell))
    drawing = '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="30mm" viewBox="0 0 60 30">'
    (tmp_path / "a.svg").write_text(drawing + '<path d="M15 15 h30" stroke="#000" stroke-width="3"/></svg>')
    assert call(capsys, "convert", "a.svg", "-o", "a.nc", "--cell", "mine.toml")[0] == 0
    status, out, err = call(capsys, "check", "a.nc", "a.svg", "--cell", "mine.toml")
    assert (status, err) == (0, []), err
    assert RUNNABLE in out


def test_a_clearance_below_one_servo_value_is_refused():
    coarse = replace(CELL, servo=Servo(((-10.0, 0.0), (5.0, 50.0))), heights=replace(CELL.heights, clearance_mm=0.5))
    with refused("cell-heights 0.5 '[0.6, 5] mm'", "heights.clearance_mm"):
        parse_cell(write_cell(coarse))


@pytest.mark.parametrize(
    ("z_offset", "height"),
    [
        (6.0, "11.0"),  # the safe height
        (-9.0, "-11.0"),  # the deepest pose
    ],
)
def test_heights_outside_the_servo_table_are_refused(z_offset, height):
    """Heights outside the servo's table are refused.

    Otherwise they would silently become the ends of the table: the brush would travel through the paint, or
    strokes would stay thin.
    """
    plan = SimpleNamespace(
        sheet_mm=(100.0, 60.0),
        passes=[
            SimpleNamespace(
                stroke="s",
                poses_mm=np.array([(10, 10, 0), (20, 10, -2.0)]),
                speed_mm_s=9.0,
                arcs=(),
                tool_axes=(),
            )
        ],
    )
    brush = SimpleNamespace(name="b", max_speed_mm_s=25.0)
    assert list(program(plan, brush, CELL, (), Job(-8.0)).sections())
    with refused(f"servo-out-of-range {height} '[-10, 10] mm'"):
        program(plan, brush, CELL, (), Job(z_offset))
    with refused("servo-out-of-range grbl-servo"):
        make_border_program((10, 20, 60, 45), brush, CELL, plan.sheet_mm, z_offset * 10)


@pytest.mark.parametrize(("cell", "offset", "widest_mm"), [("grbl-servo", "0", 6.72), ("axidraw-ebb", "-1", 5.88)])
def test_shapes_and_lines_are_no_wider_than_the_cell_can_press_the_brush(
    tmp_path, monkeypatch, capsys, cell, offset, widest_mm
):
    """Shapes that need a deeper brush than the servo reaches are filled in narrower passes; wider lines are refused."""
    monkeypatch.chdir(tmp_path)
    svg = '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="50mm" viewBox="0 0 90 50">{}</svg>'
    (tmp_path / "shape.svg").write_text(svg.format('<rect id="s" x="30" y="15" width="30" height="20"/>'))
    (tmp_path / "line.svg").write_text(svg.format('<path id="l" d="M20 20H60" stroke="#000" stroke-width="8"/>'))
    program = "shape.ebb" if cell == "axidraw-ebb" else "shape.gcode"
    flags = ("--cell", cell, "--z-offset", offset)
    status, _, reported = in_json(capsys, "convert", "shape.svg", "-o", program, *flags)
    assert status == 0 and is_reported(reported, f"width-out-of-reach '[0, {widest_mm}] mm' round-6 {cell}"), reported
    assert in_json(capsys, "check", program, "shape.svg", "--z-offset", offset)[0] == 0
    status, _, reported = in_json(capsys, "convert", "line.svg", "-o", program, "--force", *flags)
    assert status == 1 and is_reported(reported, f"width-out-of-reach 8.000 {widest_mm:.3f} {cell}", "l"), reported
    (tmp_path / "line.svg").write_text(svg.format('<path id="l" d="M20 20H60" stroke="#000" stroke-width=".5"/>'))
    status, _, reported = in_json(capsys, "convert", "line.svg", "-o", program, "--force", *flags)
    assert status == 0 and is_reported(reported, f"depth-not-measured '0.84 to {widest_mm:.2g},'", "l"), reported


def test_a_preview_leaves_out_only_the_lines_that_the_cell_cannot_paint(tmp_path):
    lines = '<path id="wide" d="M20 15H60" stroke-width="7.2"/><path id="fine" d="M20 35H60" stroke-width="6"/>'
    size = 'width="90mm" height="50mm" viewBox="0 0 90 50"'
    path = tmp_path / "lines.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="none" stroke="#000">{lines}</svg>')
    work = prepare(path, Options(cell=find_cell("grbl-servo")), partly=True)
    (left_out,) = work.refused
    assert agrees(left_out, "width-out-of-reach 7.200 6.720] grbl-servo", "wide")
    assert [a_pass.stroke for a_pass in work.plan.passes] == ["fine"]


def test_the_program_contains_only_words_grbl_knows():
    text = text_of(*TWO, cell="grbl-servo")
    assert not re.search(r"Z-?\d", text)
    assert max(map(len, text.splitlines())) <= 70
    values = [int(value) for value in re.findall(r"S(\d+)", text)]
    assert min(values) >= 200 and max(values) == 800


def test_servo_values_follow_the_table():
    assert [servo_values_at(CELL.servo, height) for height in (-10, -5, 0, 5, 12)] == [
        200,
        400,
        600,
        800,
        1000,
    ]


def test_the_servo_output_is_never_switched_off():
    """The program contains no command that switches the output off.

    In laser mode, grbl switches the output off if the motion mode is not G1, at M5 and at M2.
    """
    text = text_of(*TWO, cell="grbl-servo")
    code = [line for line in text.splitlines() if line and not line.startswith("(")]
    assert code.index("G1 F3000.0") < code.index("M3 S800")
    assert not re.search(r"(?m)^(G0|M5|M2|M30)", text)
    assert text.splitlines()[-1].startswith("(end: ")


def test_a_lift_may_wait_less_if_rounded_heights_are_nearer():
    """A lift may wait less if rounded heights make it begin nearer to its end.

    Rounded heights do not show the exact value at which the line before a lift was held. A lift that began
    four values later waited for a tenth of a millimetre less, and was mistaken for a changed lift.
    """
    like = _ActComparison(CELL)

    def lift(waits_s):
        return Act(1, "lift", same=(510.0, waits_s, 500.0, 510.0))

    assert like.is_same(lift(0.275), lift(0.325))
    assert not like.is_same(lift(0.150), lift(0.325)), "shorter than that something was taken away"


def test_lifts_caused_by_rounding_are_ignored_in_the_comparison():
    def lift(value):
        return Act(1, "lift", same=(value,))

    def without(ours, theirs):
        return drop_rounding_lifts(ours, theirs, lambda act: act.same == (0.0,), lambda a, b: a.same == b.same)

    ours, theirs = [lift(5.0), lift(0.0), lift(6.0), lift(0.0)], [lift(5.0), lift(6.0)]
    assert without(ours, theirs) == ([lift(5.0), lift(6.0), lift(0.0)], theirs)
    assert without(theirs, ours) == (theirs, [lift(5.0), lift(6.0), lift(0.0)])


@pytest.mark.parametrize("width_mm", [0.0004, 0.002, 0.003, 0.006, 0.04, 0.08, 0.3])
@pytest.mark.parametrize(("name", "suffix"), [("grbl-servo", ".nc"), ("axidraw-ebb", ".ebb")])
def test_a_steep_path_is_pressed_and_lifted_in_place(name, suffix, width_mm):
    """A steep path is pressed and lifted on the spot.

    Strokes of the typed brush begin this steeply, and every servo plotter refused them (too-steep).
    """
    steep = [(20, 20, 0), (20 + width_mm, 20, -4), (40, 20, -4), (40 + width_mm, 20, 0)]
    cell = find_cell(name)
    text = text_of(("a", steep, 20.0), cell=name)
    read = read_program(text, suffix, cell)
    ran = simulate_program.simulate_program(read, find_brush("round-6"), cell, (100.0, 60.0))
    assert ran.problems == []
    [path] = [np.asarray(each.poses_mm) for each in ran.plan.passes]
    assert path[:, 2].min() == pytest.approx(-4, abs=0.15)
    deep = path[path[:, 2] < -2]
    assert deep[:, 0].min() == pytest.approx(20, abs=0.16)
    assert deep[:, 0].max() == pytest.approx(40 + width_mm, abs=0.16)


@pytest.mark.parametrize("cell", ["grbl-servo", "axidraw-ebb"])
@pytest.mark.parametrize("lag", ["2", "5", "8"])
def test_check_accepts_a_straight_line_by_a_brush_with_constant_lag(tmp_path, monkeypatch, capsys, lag, cell):
    """Check accepts a straight line by a brush with a constant lag.

    This stroke ends with a lift of 2.1 mm on a path of 0.04 mm, in parts of nearly two steps each.
    """
    monkeypatch.chdir(tmp_path)
    Path("line.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="60mm" viewBox="0 0 120 60">'
        '<path d="M20 30H100" fill="none" stroke="#000" stroke-width="4"/></svg>'
    )
    words = ("--lag", lag, "--width-at", "3=2.5", "--width-at", "8=7")
    assert call(capsys, "brush", "new", "-o", "mine.json", *words)[0] == 0
    program = "line.ebb" if cell.endswith("ebb") else "line.gcode"
    assert call(capsys, "convert", "line.svg", "-o", program, "--brush", "mine.json", "--cell", cell)[0] == 0
    status, _, reported = call(capsys, "check", program, "line.svg", "--brush", "mine.json", "--cell", cell)
    assert status == 0, reported


def test_check_accepts_a_pose_with_the_previous_servo_value(tmp_path, monkeypatch, capsys):
    """Check accepts a pose that has the servo value of the pose before it.

    The program leaves out the second pose, and the line begins 0.024 mm higher than planned.
    """
    monkeypatch.chdir(tmp_path)
    servo = Servo(((-10.613, 262.466), (11.656, 1012.189)), 0.05, 0.0)
    machine = Machine(height_mm=-0.18880217172035013)
    Path("mine.toml").write_text(write_cell(replace(CELL, servo=servo, machine=machine)))
    poses = [
        (27.885, 26.897, 0),
        (27.885, 26.897, -0.0244),
        (30.5614, 28.031, -1.5931),
        (33.2121, 28.8717, 0),
    ]
    plan = _core.Plan("round-6", "", (100, 60), [_core.Pass("a", np.array(poses), 6.42)])
    Path("p.json").write_text(write_plan(plan))
    assert call(capsys, "convert", "p.json", "-o", "p.nc", "--cell", "mine.toml")[0] == 0
    status, _, reported = call(capsys, "check", "p.nc", "p.json", "--cell", "mine.toml")
    assert status == 0, reported


@pytest.mark.parametrize("scale", [0.94, 1.06])
def test_check_times_a_slope_by_the_commanded_way(tmp_path, monkeypatch, capsys, scale):
    """Check accepts a slope that is painted at the speed limit by a machine with errors of scale.

    A machine with a scale of 0.94 goes 0.94 mm for each commanded mm, and a feed is for commanded mm. Check divided the
    shorter way by the feed, and refused its own program as 5 % too fast.
    """
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text(write_cell(replace(CELL, machine=Machine(scale=(scale, scale)))))
    poses = np.array([(20, 20, 0), (26, 20, -7.8), (40, 20, -7.8), (46, 20, 0)])
    Path("p.json").write_text(write_plan(_core.Plan("round-6", "", (100, 60), [_core.Pass("a", poses, 25.0)])))
    assert call(capsys, "convert", "p.json", "-o", "p.nc", "--cell", "mine.toml")[0] == 0
    status, _, reported = call(capsys, "check", "p.nc", "p.json", "--cell", "mine.toml")
    assert status == 0, reported


@pytest.mark.parametrize("width_mm", [0.0503, 0.0707, 0.1103])
def test_rounded_parts_of_a_steep_path_are_not_a_jump(width_mm):
    """Rounded parts of a steep path do not look like a jump.

    Coordinates rounded by half a unit of 3e-3 mm shortened the time of the path, and check rejected its own
    program as too fast.
    """
    cell = find_cell("grbl-servo")
    steep = [(21.522, 28.978, 0), (21.522, 28.978, -2.785), (21.522 + width_mm, 28.978, -0.105)]
    text = text_of(("a", [*steep, (21.522 + width_mm, 28.978, 0)], 15.0), cell="grbl-servo")
    read = read_program(text, ".nc", cell)
    assert simulate_program.simulate_program(read, find_brush("round-6"), cell, (100.0, 60.0)).problems == []


def test_a_servo_path_is_not_steep_because_its_heights_are_rounded_as_lengths():
    """A rise of two steps and a value counted 0.0004 mm more, and the reader pressed the brush on the spot."""
    servo = Servo(((-8.969, 10840.0), (19.092, 40140.0)), 0.05, 0.15)
    heights = [-8.969 + (value - 10840) * 28.061 / 29300 for value in (14481, 14586)]
    poses = np.array([(10, 10, heights[0]), (10.0125, 10.05, heights[1]), (11, 11, heights[1])])
    a_pass = _core.Pass("a", poses, 20.0)
    written = as_written(a_pass, replace(find_cell("axidraw-ebb"), servo=servo), np.eye(4), was_read=True)
    assert len(written.commanded_mm) == 3


def test_a_lift_before_any_feed_has_a_speed():
    text = GOLDEN.read_text(encoding="utf-8").replace("G21 G90", "M3 S800\nM3 S796\nG21 G90")
    read = read_program(text, ".ngc", CELL)
    assert all(step.speed_mm_s > 0 for section in read.sections for step in section.steps)
    ebb = GOLDEN.with_name("two_strokes.ebb").read_text(encoding="utf-8")
    begin, feed, rest = ebb.partition("# feed 6000.0 mm/min\n")
    read = read_program(begin + "S2,17280,4,0,25\n" + feed + rest, ".ebb", find_cell("axidraw-ebb"))
    assert all(step.speed_mm_s > 0 for section in read.sections for step in section.steps)


def test_the_tip_respects_the_speed_limit_of_the_brush_on_a_slope():
    """The tip is nowhere faster than the brush allows on a slope.

    The machine's feed ignores the lift: at 20 mm/s, a slope of 1.2 gave the tip 31 mm/s.
    """
    poses = np.array([(10, 10, 0), (13, 10, -3.6), (20, 10, -3.6), (23, 10, 0)])
    plan = SimpleNamespace(
        sheet_mm=(100.0, 60.0),
        passes=[SimpleNamespace(stroke="a", poses_mm=poses, speed_mm_s=20.0, arcs=(), tool_axes=(), colour="")],
    )
    brush = SimpleNamespace(name="b", max_speed_mm_s=25.0)
    feed, feeds = 0.0, {}
    for line in "".join(grbl_servo(program(plan, brush, CELL))).splitlines():
        words = dict(re.findall(r"([FX])(-?[\d.]+)", line.split("(")[0]))
        feed = float(words["F"]) / 60 if "F" in words else feed
        if "X" in words:
            feeds.setdefault(13 < float(words["X"]) <= 20, []).append(feed)
    assert set(feeds[True]) == {20.0}
    assert max(feeds[False][2:-1]) <= 25 / np.hypot(1, 1.2), "the first is travel"


@pytest.mark.parametrize("name", [name for name in cell_names() if find_cell(name).servo])
def test_shipped_tables_reach_the_safe_height_over_thicker_paper(name):
    """Shipped servo tables reach the safe height over thicker paper as well.

    The table of grbl-servo once ended at the safe height, so every positive --z-offset was refused.
    """
    cell = find_cell(name)
    poses = np.array([(10, 10, 0), (12, 10, -2.0), (40, 10, -2.0), (42, 10, 0)])
    plan = _core.Plan("round-6", "", (100, 60), [_core.Pass("s", poses, 9.0)])
    for z_offset in (-1.0, 0.3, 2.0):
        assert list(program(plan, find_brush("round-6"), cell, (), Job(z_offset)).sections())


@pytest.mark.parametrize("name", ["axidraw-ebb", "grbl-servo"])
def test_rounding_leaves_no_steep_path(name):
    """Places of a steep path that are less than a move apart stay a lift on the spot, followed by a level path."""
    cell, random, written_ways = find_cell(name), np.random.default_rng(5), 0
    for _ in range(400):
        ways_mm = random.uniform(-1, 1, (8, 2)) * random.choice([0.01, 0.03, 0.1], (8, 1))
        heights_mm = np.r_[0.0, -5.0, -5.0 + np.cumsum(random.uniform(0.05, 1.0, 7))]
        poses = np.column_stack([40 + np.cumsum([(0, 0), *ways_mm], axis=0), np.minimum(heights_mm, 0.0)])
        written = as_written(_core.Pass("s", poses, 20.0), cell, np.eye(4))
        ways = np.diff(written.poses_mm, axis=0)
        steep = is_too_steep_for_servo(ways, 20.0, cell, "read")
        assert not steep.any(), (poses[:-1][:3], ways[steep])
        written_ways += len(ways)
    assert written_ways > 2000


def test_a_path_that_is_not_too_steep_is_not_divided_after_rounding():
    """The program would go elsewhere than planned: level first, and then up on the spot."""
    cell, random, gentle = find_cell("axidraw-ebb"), np.random.default_rng(7), 0
    for _ in range(3000):
        length_mm, angle = random.uniform(0.06, 0.2), random.uniform(0, 2 * np.pi)
        places = np.cumsum([(40, 30), (6, 0), (length_mm * np.cos(angle), length_mm * np.sin(angle)), (0, 6)], axis=0)
        poses = np.column_stack([places, (-3.0, -5.0, random.uniform(-4.9, -4.2), -3.0)])
        if is_too_steep_for_servo(np.diff(poses, axis=0), 20.0, cell).any():
            continue
        gentle += 1
        assert len(as_written(_core.Pass("s", poses, 20.0), cell, np.eye(4)).poses_mm) == len(poses)
    assert gentle > 1000
