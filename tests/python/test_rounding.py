"""The rounding of a pass in a program's text: readers decide as the writer does."""

import random
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import in_json, refused
from programs import LANGUAGES, call, whole
from sampling import sample

from brushsvg import _core
from brushsvg.machine.cells.cell import Paper, least_move_mm, robot_from_paper, unit_mm
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.machine.job_program import unchecked_program
from brushsvg.machine.moves import duration_s
from brushsvg.machine.posts import POSTS
from brushsvg.machine.realised.rounding import as_written
from brushsvg.machine.writer import text_of
from brushsvg.model.library import find_brush
from brushsvg.verify import against_regenerated, simulate_program
from brushsvg.verify.readback import read_program

BRUSH = find_brush("round-6")
SHEET_MM = (100.0, 80.0)
DOWN, UP = (20.0, 20.0, 0.0), (60.0, 50.0, 0.0)


def arc(centre_mm, radius_mm, first, last, count, z=-2.0):
    angles = np.radians(np.linspace(first, last, count))
    x, y = centre_mm
    return [(x + radius_mm * np.cos(a), y + radius_mm * np.sin(a), z) for a in angles]


def cell_of(name, decimals, **changes):
    return replace(find_cell(name), decimals=decimals, **changes)


def found_by_check(poses, arcs, cell):
    """Return the text of one stroke, and the line that check reports as different."""
    a_pass = _core.Pass("one", np.array(poses), 20.0, arcs=arcs)
    made = unchecked_program(whole(_core.Plan(BRUSH.name, "", SHEET_MM, [a_pass])), BRUSH, cell)
    text = "".join(text_of(POSTS[cell.language], made))
    read = read_program(text, LANGUAGES[cell.name], cell)
    ran = simulate_program.simulate_program(read, BRUSH, cell, SHEET_MM)
    return text, against_regenerated.differing_line(
        text, read, against_regenerated.regenerate_program(ran, BRUSH, cell, 0.0), cell
    )


# Between lines, the arc has a chord of 0.7 mm on a circle of 14 mm. Turns that fill a corner end like this.
ONE_CHORD = [DOWN, (30, 20, -2), (45, 22, -2), *arc((50, 40), 14, -70, -67.2, 2), (60, 40, -2), UP]
# On a circle of 400 m, the points are on one line at any number of decimals in use.
FLAT = [DOWN, (30, 20, -2), *arc((40, 4e5 + 20), 4e5, -89.9993, -89.9985, 3), (60, 40, -2), UP]
# The arc is smaller than the written unit: after rounding, it may run the other way round.
SMALL = [DOWN, (30, 20, -2), *arc((50, 40), 14, -70.001, -70.0, 4), (60, 40, -2), UP]


@pytest.mark.parametrize("decimals", [3, 4, 6])
@pytest.mark.parametrize("name", ["linuxcnc-3axis", "grbl-3axis", "ur5e"])
@pytest.mark.parametrize(
    ("poses", "ends", "centre_mm"),
    [(ONE_CHORD, (3, 4), (50, 40)), (FLAT, (2, 4), (40, 4e5 + 20)), (SMALL, (2, 5), (50, 40))],
)
def test_a_circle_that_cannot_be_written_becomes_chords(name, decimals, poses, ends, centre_mm):
    circle = _core.Arc(*ends, centre_mm, 1)
    text, reported = found_by_check(poses, [circle], cell_of(name, decimals))
    assert reported is None
    if name == "ur5e":
        assert "movec" not in text


def test_a_circle_that_can_be_written_stays_a_circle():
    poses = [DOWN, (30, 20, -2), *arc((50, 40), 14, -70, -40, 4), (60, 40, -2), UP]
    text, reported = found_by_check(poses, [_core.Arc(2, 5, (50, 40), 1)], cell_of("ur5e", 4))
    assert reported is None and text.count("movec") == 1
    text, reported = found_by_check(ONE_CHORD, [_core.Arc(3, 4, (50, 40), 1)], cell_of("linuxcnc-3axis", 4))
    assert reported is None and text.count("G3") == 1


@pytest.mark.parametrize("sideways_mm", [0.0, 1e-5, 3e-4, 2e-3])
@pytest.mark.parametrize("rotation_deg", [(0, 0, 0), (0, 0, 12.3), (1.1, -2.3, 12.3)])
@pytest.mark.parametrize("name", ["linuxcnc-3axis", "grbl-3axis", "ur5e"])
def test_almost_vertical_moves_are_accepted_after_rounding(name, rotation_deg, sideways_mm):
    cell = cell_of(name, 3, paper=Paper((0.0, -400.0, 20.0), rotation_deg))
    poses = [DOWN, (20 + sideways_mm, 20, -2), (40, 25, -2), (40 + sideways_mm, 25, -1), (60, 50, -1), UP]
    assert found_by_check(poses, [], cell)[1] is None


@pytest.mark.parametrize("sideways_mm", [0.0, 1e-5, 3e-4])
@pytest.mark.parametrize("x", [40.0, 40.0004])
def test_a_servo_skips_moves_below_half_a_unit_next_to_a_lift(x, sideways_mm):
    """A servo stays in place if it moves by less than half a unit next to its lift.

    From 40.0004 to 40.0007 is 3e-4 mm, but one unit after rounding. No post wrote this move, and no reader
    accepted the line as a lift.
    """
    poses = [DOWN, (20, 20, -2), (x, 25, -2), (x + sideways_mm, 25, -1), (60, 50, -1), UP]
    assert found_by_check(poses, [], cell_of("grbl-servo", 3))[1] is None


SERVO_ROWS = (
    ((-10.0, 900.0), (0.0, 600.0), (5.0, 400.0)),
    ((-10.0, 200.0), (0.0, 600.0), (8.0, 920.0)),
    ((-10.0, 0.0), (5.0, 60.0)),  # one value is a quarter of a millimetre
)


def to_and_fro(chance: random.Random) -> list:
    """Return poses at several depths, on one spot, to and fro, or on a short line."""
    x, y = (round(chance.uniform(20, 40), 4) for _ in "xy")
    angle, length = chance.uniform(0, 2 * np.pi), chance.choice([0.0, 0.2, 0.5, 1.0, 6.0])
    along = [(0.0, length)[k % 2] if chance.random() < 0.7 else 0.0 for k in range(chance.randint(2, 9))]
    noise = chance.choice([0.0, 3e-4])
    return [
        (x + by * np.cos(angle) + chance.uniform(0, noise), y + by * np.sin(angle), -chance.uniform(0.3, 2.5))
        for by in along
    ]


@pytest.mark.slow
@sample("table", SERVO_ROWS, keep=1)
@pytest.mark.parametrize("step_mm", [0.05, 0.2, 0.5])
def test_check_accepts_back_and_forth_strokes_of_a_servo(tmp_path, capsys, table, step_mm):
    """Check accepts the to-and-fro strokes that a servo paints.

    Check once refused half of these programs. It ignored a rest in the middle of a lift, left out moves of
    one unit, and required a lift that rounding can remove.
    """
    chance = random.Random(f"to and fro {table} {step_mm}")
    cell = cell_of("grbl-servo", chance.choice([3, 4]))
    servo = replace(cell.servo, table=table, step_mm=step_mm)
    cell = replace(cell, name="mine", servo=servo, heights=replace(cell.heights, clearance_mm=0.6))
    toml, source, program = (str(tmp_path / name) for name in ("c.toml", "a.json", "a.nc"))
    Path(toml).write_text(write_cell(cell), encoding="utf-8")
    for _ in range(12):
        both = [_core.Pass(name, np.array(to_and_fro(chance)), chance.choice([5.0, 20.0])) for name in "ab"]
        Path(source).write_text(_core.write_plan(_core.Plan(BRUSH.name, "", SHEET_MM, both)))
        status, _, reported = in_json(capsys, "convert", source, "-o", program, "--cell", toml)
        assert status == 0, reported
        for words in ((program, source), (program,)):
            status, _, reported = in_json(capsys, "check", *words, "--cell", toml)
            assert status == 0, ([each.poses_mm for each in both], reported)


def test_check_accepts_a_landing_between_two_coarse_values():
    poses = [
        (25.711771, 28.8686, -0.368637),
        (25.560389, 28.99917, -2.423742),
        (25.711957, 28.8686, -2.154541),
    ]
    servo = replace(find_cell("grbl-servo").servo, table=((-10.0, 0.0), (5.0, 60.0)), step_mm=0.05)
    assert found_by_check(poses, [], replace(cell_of("grbl-servo", 3), servo=servo))[1] is None


@pytest.mark.parametrize("name", ["axidraw-ebb", "grbl-servo"])
def test_poses_that_rounding_leaves_out_are_within_a_move_of_the_path(name):
    """A pose at a similar height was left out first, and then the pose before it for its place."""
    chance, cell = random.Random("tiny strokes"), find_cell(name)
    for _ in range(200):
        x, y = chance.uniform(20, 40), chance.uniform(20, 40)
        step_mm = least_move_mm(cell) * chance.uniform(0.4, 1)
        near = [(x + k * step_mm, y, -4 - 0.01 * k) for k in range(3)]
        a_pass = _core.Pass("s", np.array([(x + 6, y, 0), *near, (x + 6, y, 0)]), 20.0)
        written = as_written(a_pass, cell, np.eye(4)).poses_mm
        limit_mm = least_move_mm(cell) + unit_mm(cell)
        assert max(np.hypot(*(written[:, :2] - place[:2]).T).min() for place in near) <= limit_mm


@pytest.mark.parametrize("turn_deg", np.linspace(99.99, 100.01, 9))
def test_a_robot_stops_at_corners_that_are_sharp_after_rounding(turn_deg):
    angle = np.radians(turn_deg)
    poses = [DOWN, (30, 20, -2), (40, 20, -2), (40 + np.cos(angle), 20 + np.sin(angle), -2), (50, 50, -2), UP]
    assert found_by_check(poses, [], cell_of("ur5e", 3))[1] is None


def test_positions_are_rounded_in_the_frame_of_the_text():
    a_pass = _core.Pass("s", [(1.23456, 2.0, 0.0), (1.2349, 2.0, -1.0)], 20.0)
    upright = as_written(a_pass, cell_of("linuxcnc-3axis", 3), np.eye(4))
    assert upright.poses_mm[:, 0].tolist() == [1.235, 1.235]
    cell = cell_of("linuxcnc-3axis", 3, paper=Paper((0.5, 0.0, 0.0), (2.0, 1.0, 30.0)))
    leaning = as_written(a_pass, cell, robot_from_paper(cell))
    assert leaning.poses_mm == pytest.approx(np.array(a_pass.poses_mm), abs=1e-3)
    assert leaning.sideways_mm > upright.sideways_mm


def test_a_nearly_straight_lift_is_straight_on_leaning_paper():
    """There, a step of two units sideways counts as straight, and rounding decides what a reader sees."""
    a_pass = _core.Pass("s", [(0.0, 0.0, 0.0), (10.0, 0.0, -3.0), (20.0, 0.0, -0.5), (20.0025, 0.0, 0.0)], 20.0)
    cell = cell_of("linuxcnc-3axis", 3, paper=Paper((0.5, 0.0, 0.0), (2.0, 1.0, 30.0)))
    leaning = as_written(a_pass, cell, robot_from_paper(cell))
    assert leaning.commanded_mm[-2:, :2].tolist() == [[20.0, 0.0], [20.0, 0.0]]
    many = np.linspace((20.0, 0.0, -3.0), (21.0, 0.0, 0.0), 501)  # a steep slope in steps of two units sideways
    slope = _core.Pass("s", [(0.0, 0.0, 0.0), (10.0, 0.0, -3.0), *many.tolist()], 20.0)
    written = as_written(slope, cell, robot_from_paper(cell))
    height = written.commanded_mm[2:, 2]
    assert written.commanded_mm[2:, 0] == pytest.approx(20.0 + (height + 3.0) / 3.0, abs=0.004)
    level = as_written(a_pass, cell_of("linuxcnc-3axis", 3), np.eye(4))
    assert level.commanded_mm[-1].tolist() == [20.0025, 0.0, 0.0]


# A path that is 40 times as steep as long, like the end of a dab with a long lag. Each of its parts is two
# units long.
STEEP = [(49.4, 50, 0), (57.4, 50, -3.4833148), (57.310625, 50, -1.5511636), (57.35, 50, 0)]


def test_steep_slow_moves_on_level_paper_are_not_vertical():
    assert found_by_check(STEEP, [], find_cell("grbl-servo"))[1] is None


HALF_TURN = [DOWN, (30, 20, -2), *arc((50, 40), 14, -70, 110, 12), (60, 40, -2), UP]


@pytest.mark.parametrize(
    "cell",
    [find_cell("grbl-servo"), replace(find_cell("jaka-zu3"), paper=Paper((0.0, -400.0, 20.0), (1, -2, 12)))],
    ids=["servo", "leaning"],
)
def test_circles_written_as_lines_have_no_stops(cell):
    took_s = [
        duration_s(
            unchecked_program(
                whole(_core.Plan("", "", SHEET_MM, [_core.Pass("one", np.array(HALF_TURN), 20.0, arcs=arcs)])),
                BRUSH,
                cell,
            )
        )
        for arcs in ([], [_core.Arc(2, 13, (50, 40), 1)])
    ]
    assert took_s[0] == took_s[1]
    assert found_by_check(HALF_TURN, [_core.Arc(2, 13, (50, 40), 1)], cell)[1] is None


@pytest.mark.parametrize("decimals", [3, 4, 6])
@pytest.mark.parametrize("name", LANGUAGES)
def test_no_move_is_shorter_than_the_rounding(name, decimals):
    chance = np.random.default_rng(decimals)
    steps = np.column_stack([chance.uniform(-1e-3, 1e-3, (40, 2)), np.zeros(40)])
    poses = [DOWN, (30, 20, -2), *np.add(np.cumsum(steps, axis=0), (45, 22, -2)), (60, 40, -2), UP]
    cell = cell_of(name, decimals)
    _, reported = found_by_check(poses, [], cell)
    assert reported is None
    written = as_written(_core.Pass("one", np.array(poses), 20.0), cell, robot_from_paper(cell))
    assert np.linalg.norm(np.diff(written.poses_mm, axis=0), axis=1).min() > 2e-3
    assert np.linalg.norm(written.poses_mm[[0, -1]] - np.array(poses)[[0, -1]], axis=1).max() < 1e-6


def test_circles_separated_by_less_than_a_move_are_merged():
    first, last = arc((50, 40), 14, -70, -40, 4), arc((50, 40), 14, -39.998, -10, 4)
    poses = [DOWN, (30, 20, -2), *first, *last, (60, 40, -2), UP]
    arcs = [_core.Arc(2, 5, (50, 40), 1), _core.Arc(6, 9, (50, 40), 1)]
    cell = cell_of("ur5e", 4)
    text, messages = found_by_check(poses, arcs, cell)
    assert messages is None and text.count("movec") == 1
    written = as_written(_core.Pass("one", np.array(poses), 20.0, arcs=arcs), cell, robot_from_paper(cell))
    (reported,) = written.arcs
    run = np.delete(written.poses_mm[:, :2], slice(reported.first + 1, reported.last), axis=0)
    radii_mm = np.linalg.norm((run[3:-3] + run[4:-2]) / 2 - (50, 40), axis=1)
    assert len(radii_mm) > 3 and np.abs(radii_mm - 14).max() < 0.0101  # chords of the other circle


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("degrees", [359.999, 360.0])
@pytest.mark.parametrize(
    "name",
    ["linuxcnc-3axis", "grbl-3axis", "ur5e", "jaka-zu3", "irb120", "kr6-r900", "cr5", "lrmate200id", "m0609"],
)
def test_a_whole_circle_is_written_in_halves(name, degrees, turn):
    """A whole circle is written as two halves.

    After rounding, its end could be on either side of its beginning. The machine would then run all the way
    round, or not at all.
    """
    cell = cell_of(name, 3, paper=Paper((0.3, -400.1, 20.0), (0, 0, 97.57)))
    on = arc((50, 40), 14, -70, -70 + turn * degrees, 24)
    poses = [DOWN, (*on[0][:2], -1.0), *on, (60, 40, -2), UP]
    text, reported = found_by_check(poses, [_core.Arc(2, 25, (50, 40), turn)], cell)
    assert reported is None
    words = {"ur5e": "movec", "jaka-zu3": "movc", "irb120": "MoveC", "kr6-r900": "CIRC", "cr5": "Arc"}
    words |= {"lrmate200id": ": C P", "m0609": "movec"}
    word = words.get(name, "G3 " if turn > 0 else "G2 ")
    assert sum(line.strip().startswith(word) for line in text.splitlines()) == 2


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("degrees", [361.0, 371.4, 540.0, 800.0])
@pytest.mark.parametrize("name", ["linuxcnc-3axis", "grbl-3axis", "ur5e", "jaka-zu3"])
def test_a_circle_beyond_a_full_turn_keeps_all_its_turns(name, degrees, turn):
    """A circle that goes on beyond its beginning keeps all its turns.

    A small closed triangle was turned by 371.4 degrees. Written in one line, the circle ran 11.4 degrees, or
    the other way round.
    """
    on = arc((50, 40), 9.47, 72.19, 72.19 + turn * degrees, 67)
    poses = [DOWN, (*on[0][:2], -1.0), *on, (60, 40, -2), UP]
    reported, cell = _core.Arc(2, 68, (50, 40), turn), cell_of(name, 4)
    text, messages = found_by_check(poses, [reported], cell)
    assert messages is None
    read = simulate_program.simulate_program(read_program(text, LANGUAGES[name], cell), BRUSH, cell, SHEET_MM)
    x, y = np.transpose([pose[:2] for pose in read.plan.passes[0].poses_mm if pose[2] < -1.99])
    turned = np.diff(np.unwrap(np.arctan2(y - 40, x - 50))[:-1]).sum()
    assert np.degrees(turned) == pytest.approx(turn * degrees, abs=0.1)


@pytest.mark.parametrize("at", [100, 180, 190, 250])
@pytest.mark.parametrize("name", ["ur5e", "jaka-zu3"])
def test_a_circle_is_read_back_with_its_via_pose_anywhere(name, at):
    """A circle is read back with its named pose at any position.

    The program line names the middle one of the poses, which can be anywhere on the circle.
    """
    angles = [0, at / 3, at / 2, at, (at + 300) / 2, 290, 300]
    on = [point for angle in angles for point in arc((50, 40), 14, angle, angle, 1)]
    poses = [DOWN, (30, 20, -2), *on, (60, 40, -2), UP]
    text, reported = found_by_check(poses, [_core.Arc(2, 8, (50, 40), 1)], cell_of(name, 3))
    assert reported is None and text.count("movc(" if name == "jaka-zu3" else "movec") == 1


def test_a_whole_circle_in_one_line_is_refused():
    text = "G21 G90 G94 G17 G40 G80\nG0 Z5\nG1 X10 Y10 F600\nG2 X10 Y10 I5 J0\nM2\n"
    with refused("line-incomplete 4"):
        read_program(text, ".gcode", find_cell("grbl-3axis"))


def drawing(chance: random.Random) -> str:
    def place():
        return f"{chance.uniform(30, 70):.3f},{chance.uniform(30, 70):.3f}"

    size, tall = chance.uniform(6, 40), chance.uniform(6, 30)
    filled, line = 'fill="black"', f'stroke="black" fill="none" stroke-width="{chance.uniform(1, 7):.2f}"'
    shapes = [
        f'<rect {filled} x="{chance.uniform(20, 40)}" y="30" width="{size}" height="{tall}"/>',
        f'<path {filled} d="M25,25h{size + 8}v8h-{size}v8h{size / 2}v8h-{size / 2}v10h-8z"/>',
        f'<circle {line} cx="50" cy="50" r="{size / 2}"/>',
        f'<path {line} d="M{place()}C{place()} {place()} {place()}S{place()} {place()}"/>',
        f'<path {line} d="M{place()}L{place()}L{place()}L{place()}"/>',
        f'<path {line} stroke-linecap="round" d="M{place()}h{chance.choice([0, 0.01, 0.5])}"/>',
    ]
    turn = f"rotate({chance.choice([0, chance.uniform(0, 360)]):.3f} 50 50)"
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">'
    return f'{head}<g transform="{turn}">{chance.choice(shapes)}{chance.choice(shapes)}</g></svg>'


@pytest.mark.slow
@sample("seed", range(24), keep=6)
def test_check_accepts_all_programs_of_convert(seed, tmp_path, capsys):
    chance = random.Random(seed)
    name = chance.choice(["linuxcnc-3axis", "grbl-3axis", "ur5e"])
    cell, source, program = tmp_path / "c.toml", tmp_path / "a.svg", tmp_path / f"a{LANGUAGES[name]}"
    cell.write_text(write_cell(cell_of(name, chance.randrange(3, 7))), encoding="utf-8")
    source.write_text(drawing(chance), encoding="ascii")
    words = ("--wide", "passes", "--cell", str(cell))
    status, _, reported = call(capsys, "convert", str(source), "-o", str(program), *words)
    assert status == 0, reported
    status, _, reported = call(capsys, "check", str(program), str(source), *words)
    assert status == 0, reported


@pytest.mark.parametrize(("cell", "radius_mm"), [("grbl-servo", 7.5048828125), ("irb120", 7.505615234375)])
def test_check_accepts_marks_that_touch_the_edge_of_the_sheet(cell, radius_mm, tmp_path, capsys):
    """Check accepts marks that touch the edge of the sheet.

    The marks are as large as convert allows. Whole servo values, or corners that are cut, then extend the
    mark by 0.01 mm.
    """
    source, program = tmp_path / "a.svg", tmp_path / f"a{'.gcode' if cell == 'grbl-servo' else '.mod'}"
    ring = f'<circle cx="8" cy="8" r="{radius_mm}" fill="none" stroke="black" stroke-width="1"/>'
    source.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="16mm" height="16mm" viewBox="0 0 16 16">{ring}</svg>'
    )
    status, _, reported = call(capsys, "convert", str(source), "-o", str(program), "--cell", cell)
    assert status == 0, reported
    status, _, reported = call(capsys, "check", str(program), "--cell", cell)
    assert status == 0, reported


def test_tiny_steps_after_a_landing_on_leaning_paper_are_read_as_written():
    """A reader makes the landing straight. Moving its deeper end would change the first step along the stroke."""
    chance = random.Random("landings on leaning paper")
    cell = cell_of("linuxcnc-3axis", 3, paper=Paper((0.5, 0.0, 0.0), (0.0, 0.9, 16.0)))
    for _ in range(20):
        x, y, turn = chance.uniform(20, 40), chance.uniform(20, 40), chance.uniform(0, 2 * np.pi)
        steps = [(k * 0.0023 * np.cos(turn), k * 0.0023 * np.sin(turn)) for k in range(5)]
        near = [(x + dx, y + dy, -3.0) for dx, dy in steps]
        assert found_by_check([(x, y, 0.0), *near, (x + 5, y + 5, -3.0), (x + 5, y + 5, 0.0)], [], cell)[1] is None


def test_a_steep_step_as_short_as_rounding_is_read_as_written():
    """Rounding makes the step vertical. A vertical step of the same height would be rounded to nothing."""
    chance = random.Random("short steep steps")
    cell = cell_of("linuxcnc-3axis", 3, paper=Paper((0.5, 0.0, 0.0), (-8.5, -6.0, 49.0)))
    for _ in range(40):
        x, y, turn = chance.uniform(20, 40), chance.uniform(20, 40), chance.uniform(0, 2 * np.pi)
        step = (0.0018 * np.cos(turn), 0.0018 * np.sin(turn), chance.uniform(0.0014, 0.0026))
        poses = [(x, y, 0.0), (x + 5, y, -3.0), (x + 5 + step[0], y + step[1], -3.0 + step[2]), (x + 9, y + 5, 0.0)]
        assert found_by_check(poses, [], cell)[1] is None
