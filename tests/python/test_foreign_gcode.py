"""Foreign G-code for pens is read: its moves, pen positions and painted marks."""

import re
from dataclasses import replace

import numpy as np
import pytest
from diagnostics import agrees, gives, in_json, is_reported, refused
from programs import RUNNABLE, call

from brushsvg.machine.cells.cell import Workspace
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.read import ReadOptions
from brushsvg.read.gcode import read_gcode
from brushsvg.read.gcode.pen import read_pen
from brushsvg.read.gcode.toolpaths import read_moves

INCHES = """%
N10 G20 G90 (a plate)
G0 Z0.2
G0 X1 Y1 ; over the start
G1 Z-0.1 F20
G1 X2 Y1 F40
G91
G2 X0.5 Y0.5 I0 J0.5
G90
G0 Z0.2
G0 X1 Y2
G1 Z-0.1
X2.5
G0 Z0.2
M2
G1 X9 Y9
"""
SERVO = """G21
M5
G91
G0 X10 Y10
M3 S500
G4 P0.2
G1 F900 X40
G1 Y30
M5
G0 X-40
M3 S500
G1 X20 Y5
M5
"""


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "inches.gcode").write_text(INCHES)
    (tmp_path / "servo.nc").write_text(SERVO)
    return tmp_path


def drawn(text):
    """Return the places (2,) [mm] that the pen reaches while down, by line number."""
    some = read_moves(text)
    down = zip(some, read_pen(some).down, strict=True)
    return {way.line: way.points_mm[-1, :2].round(6).tolist() for way, is_down in down if is_down}


def test_inches_circles_and_relative_positions_are_read():
    target = {6: [50.8, 25.4], 8: [63.5, 38.1], 13: [63.5, 50.8]}
    assert drawn(INCHES) == target
    (circle,) = [way for way in read_moves(INCHES) if way.turn]
    assert circle.turn == -1 and circle.centre_mm == pytest.approx((50.8, 38.1))
    assert np.linalg.norm(circle.points_mm[:, :2] - circle.centre_mm, axis=1) == pytest.approx(12.7)
    assert circle.points_mm[:, 0].min() == pytest.approx(50.8 - 12.7, abs=0.05), "three quarters, by the left"
    by_radius = INCHES.replace("I0 J0.5", "R-0.5")
    (again,) = [way for way in read_moves(by_radius) if way.turn]
    assert again.points_mm == pytest.approx(circle.points_mm)


def test_a_laser_is_off_on_rapid_moves():
    """A laser does not draw on rapid moves.

    The laser uses M4, so grbl switches it off on rapid moves. The power is as the picture requires, high or
    low.
    """
    laser = "G21G90\nM4S0\nG0X20Y20\nG1X80Y20S1000F900\nG1X80Y60\nG0X100Y30\nG1X140Y60S500\nG0X0Y0\nM5\n"
    assert drawn(laser) == {4: [80.0, 20.0], 5: [80.0, 60.0], 7: [140.0, 60.0]}


def test_a_servo_may_be_controlled_by_m300():
    unicorn = (
        "G28 X Y\nM300 S50\nG4 P150\nG1 X20 Y20 F3500\nM300 S30.00\nG1 X80 Y20\nM300 S440 P200\nG1 X80 Y60\n"
        "M300 S50.00\nG1 X100 Y30\nM300 S30\nG1 X140 Y60\nM300 S50\nM18\n"
    )
    assert drawn(unicorn) == {6: [80.0, 20.0], 8: [80.0, 60.0], 12: [140.0, 60.0]}


@pytest.mark.parametrize("command", ["M203 X500 Y500 Z100", "M117 X10 Z9", "N7 M204 X9", "M84 X Y E", "M106 S50"])
def test_settings_and_messages_of_marlin_do_not_move_the_pen(desk, capsys, command):
    """M203 Z100 sets a speed limit. It was once read as a lift to 100 mm, and M106 S50 as a servo angle."""
    dragged = "G21\nG90\nG0 Z5\nG0 X10 Y10\nG1 Z-2 F600\nG1 X60 Y10\n;\nG0 X10 Y30\nG1 X60 Y30\nG0 Z5\n"
    servo = "G21\nG90\nM280 P0 S50\nG1 X20 Y20 F900\nM280 P0 S30\nG1 X80 Y20\n;\nG1 X80 Y60\nM280 P0 S50\n"
    for text in (dragged, servo):
        assert drawn(text.replace(";", command)) == drawn(text)
    (desk / "dragged.gcode").write_text(dragged.replace(";", command))
    status, _, reported = in_json(capsys, "check", "dragged.gcode", "--brush", "round-6")
    assert status == 1 and is_reported(reported, "rapid-too-low 8"), reported


def test_other_commands_of_a_line_are_read():
    """Several controllers read more than one command from a line. M17 G0 Z5 was once skipped with its move."""
    text = "G21\nG90\nG0 Z5\nG0 X10 Y10\nG1 Z-2 F600\nG1 X60 Y10\nG0 Z5\nG0 X10 Y30\nG1 Z-2\nG1 X60 Y30\nG0 Z5\nM84\n"
    several = text.replace("G90\n", "G90 M82\n").replace("Z-2 F600\n", "Z-2 F600 M400\n")
    assert drawn(several) == drawn(text.replace("Y10\nG0 Z5\n", "Y10\nM17 G0 Z5\n")) == drawn(text)
    with refused("line-unread M106"):
        drawn(text.replace("G0 X10 Y30", "M106 S50 G0 X10 Y30"))


def test_check_does_not_read_a_tone_as_a_servo_command(desk, capsys):
    (desk / "tone.gcode").write_text("G21\nG90\nM300 S30\nG1 X20 Y20 F900\nG1 X40 Y20\nM300 S50\nG1 X60 Y20\n")
    status, _, notices = in_json(capsys, "check", "tone.gcode", "--brush", "round-6", "--cell", "marlin-servo")
    assert status == 1 and is_reported(notices, "servo-unknown M300")


def test_a_servo_stays_down_on_rapid_moves_after_m4():
    """After M4, a servo stays down on rapid moves, unlike a laser.

    convert reads the program as a laser's program. check reads it as a servo's program, where M4 sets the
    servo like M3.
    """
    down = [way for way in read_moves("G21G90\nG0X0Y0\nM4S30\nG1X20Y0F900\nG0X40Y0\nM5\n") if way.rapid][-1]
    assert down.power == 30.0


def test_a_visit_to_a_paint_pot_is_a_dip():
    pot = "; paint pot 1\nG0 X-30 Y0\nG1 Z-8 F600\nG1 X-25 Y0\nG1 X-30 Y5\nG0 Z10\n; line\n"
    line = "G0 X20 Y{y}\nG1 Z-1 F600\nG1 X100 Y{y}\nG0 Z10\n"
    text = "G21\nG90\nG0 Z10\n" + "".join(pot + line.format(y=20 + 10 * k) for k in range(2))
    design = read_gcode(text.encode(), ReadOptions())
    assert len(design.elements) == 2
    assert is_reported(design.notices, "dips-left-out 2")


def test_a_servos_pen_is_down_between_m3_and_m5():
    assert drawn(SERVO) == {7: [50.0, 10.0], 8: [50.0, 40.0], 12: [30.0, 45.0]}
    by_value = SERVO.replace("M5", "M3 S700")
    assert drawn(by_value) == drawn(SERVO), "up is the value at which G0 goes"


@pytest.mark.parametrize(
    ("old", "new", "reported"),
    [
        ("G91", "G18", "line-unread 7 G18"),
        ("X2.5", "X#5", "line-unread 13 X#5"),
        ("J0.5", "J0.7", "line-incomplete 8"),
        ("X2.5", "G5 X2.5", "line-unread 13"),
        ("X2.5", "G55 X2.5", "line-unread 13"),
        ("X2.5", "X99999999", "line-unread 13"),
        ("X2.5", "X2.5 X3", "line-unread 13"),
        ("X2.5", "X2e5", "line-unread 13"),
        ("X2.5", "A2 X2.5", "line-unread 13"),
        ("G91", "G90 G91", "line-unread 7"),
        ("X2.5", "G4 P1 X2.5", "line-unread 13"),
        ("J0.5", "J0.5 R0.5", "line-unread 8"),
        ("J0.5", "J0.5 P2", "line-unread 8"),
        ("I0 J0.5", "I99999999999999999999 J0.5", "line-unread 8"),  # its radius was divided by zero
        ("I0 J0.5", "R99999999999999999999", "line-unread 8"),
        ("I0 J0.5", f"R{'9' * 200}", "line-unread 8"),  # no float holds its square
    ],
)
def test_unknown_commands_are_refused(old, new, reported):
    with refused(reported):
        read_moves(INCHES.replace(old, new, 1))


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("G1 Z-1 F300\nG1 X30 Y12 F1200\nG1 X30 Y32\nG0 Z5\nG1 Y10", {"line3": [[30, 12], [30, 32]]}),
        ("G21\nM3 S90\nG1 X10 Y10 F3000\nM3 S50\nG1 X60 Y10\nM5\nG0 X0 Y0", {"line5": [[10, 10], [60, 10]]}),
        # Homed with the pen down: the next line begins at an unknown place, not at the end of the line
        # before.
        (
            "G21\nG0 X0 Y0\nM3 S50\nG1 X9 Y9 F900\nG28 X0 Y0\nG1 X50 Y20\nG1 X60\nM5",
            {"line4": [[0, 0], [9, 9]], "line7": [[50, 20], [60, 20]]},
        ),
    ],
)
def test_a_line_starts_at_its_first_known_position(text, lines):
    """A line begins at its first known place.

    A pen that was down before the first place once caused an IndexError.
    """
    design = read_gcode(text.encode(), ReadOptions(sheet_mm=(100, 100)))
    found = {each.id: each.subpaths[0].cubics for each in design.elements}
    assert {name: [cubics[0, 0].tolist(), cubics[-1, 3].tolist()] for name, cubics in found.items()} == lines


def test_a_program_without_pen_commands_is_refused():
    with refused("pen-unknown 'between strokes, by Z or by M3'"):
        read_pen(read_moves("G21\nG0 X1 Y1\nG1 X5 Y5 F100\n"))
    with refused("pen-unknown '--paper-z 0'"):
        read_pen(read_moves("G21\nG0 X1 Y1 Z0\nG1 X5 Y5 F100\n"))


def test_check_predicts_what_a_brush_paints(desk, capsys):
    status, out, _ = call(capsys, "check", "inches.gcode", "--picture", "p.png")
    assert status == 0 and (desk / "p.png").exists()
    assert RUNNABLE not in out
    status, out, _ = call(capsys, "check", "servo.nc", "--cell", "grbl-servo", "--sheet", "120x100")
    assert status == 0 and gives(out.splitlines()[1], "2")
    status, _, reported = in_json(capsys, "check", "servo.nc")
    assert status == 1 and is_reported(reported, "servo-unknown 7 M3")


ANGLES = """G21 G90
M280 P0 S90
G0 X30 Y30
M280 P0 S30
G1 X50 Y30 F1200
M280 P0 S90
G0 X60 Y50
M280 P0 S30
G1 X80 Y60
M280 P0 S90
"""
SPINDLE = """G21 G90
M3 S1000
G0 Z5
G0 X30 Y30
G1 Z-1 F300
G1 X50 Y30 F1200
G0 Z5
M5
"""


@pytest.mark.parametrize(
    ("program", "typed", "reported"),
    [
        (ANGLES, "", "servo-unknown 3 M280 linuxcnc-3axis"),
        (ANGLES, "--cell grbl-servo", "servo-unknown 3 M280 grbl-servo"),
        (SERVO, "", "servo-unknown 7 M3 linuxcnc-3axis"),
        (SERVO, "--cell marlin-servo", "servo-unknown 7 M3 marlin-servo"),
        (SPINDLE, "--cell grbl-servo", "servo-unknown Z grbl-servo"),
        (SPINDLE, "--cell marlin-servo", "servo-unknown Z marlin-servo"),
        (SPINDLE.replace("Z-1", "Z0"), "", "nothing-painted 0"),
    ],
)
def test_the_advice_of_check_works(desk, capsys, program, typed, reported):
    """The advice of check works when you type it.

    check once advised M3 and grbl-servo for an M280 program, and --paper-z for a servo.
    """
    (desk / "f.gcode").write_text(program)
    status, _, ((_, messages),) = in_json(capsys, "check", "f.gcode", *typed.split())
    assert status == 1 and agrees(messages, reported), messages
    advised = re.search(r"--(cell|paper-z) [\w.-]+", messages.advice)[0].split()
    status, out, _ = call(capsys, "check", "f.gcode", *advised)
    strokes = "1" if "Z5" in program else "2"
    assert status == 0 and gives(out.splitlines()[1], strokes)


def test_servo_values_outside_shipped_tables_advise_to_write_a_table(desk, capsys):
    """Servo values outside every shipped table lead to advice to write a table.

    With a servo from 0 to 90, every value was once deeper than the deepest row of the table.
    """
    (desk / "f.gcode").write_text(SERVO.replace("S500", "S30"))
    for cell in ("linuxcnc-3axis", "grbl-servo"):
        status, _, ((_, reported),) = in_json(capsys, "check", "f.gcode", "--cell", cell)
        assert status == 1 and agrees(reported, "servo-unknown 7 S30 cell grbl-servo [servo]"), reported
    command = re.search(r"brushsvg (cell new .*?)  ", reported.advice)[1]
    assert call(capsys, *command.split())[0] == 0
    table = "table = [[-8.0, 0.0], [-1.0, 30.0], [10.0, 90.0]]"
    mine = re.sub(r"(?m)^table = .*", table, (desk / "mine.toml").read_text())
    (desk / "mine.toml").write_text(mine)
    assert call(capsys, "check", "f.gcode", "--cell", "mine.toml")[0] == 0
    status, _, reported = in_json(capsys, "check", "f.gcode", "--cell", "mine.toml", "--paper-z", "1")
    assert status == 1 and is_reported(reported, "flag-without-effect --paper-z")


def test_without_heights_no_paper_height_is_suggested(desk, capsys):
    (desk / "f.gcode").write_text("G21\nG0 X1 Y1\nG1 X40 Y5 F100\n")
    for command in (("check", "f.gcode"), ("convert", "f.gcode", "-o", "f.ngc")):
        status, _, ((_, reported),) = in_json(capsys, *command)
        assert status == 1 and "--paper-z" not in reported.advice, reported


@pytest.mark.parametrize(
    ("old", "new", "reported"),
    [
        ("F40", "F400", "speed-out-of-range 169.3"),
        ("Z-0.1", "Z-0.5", "depth-out-of-range 12.700"),
        ("G1 X2 Y1 F40", "G0 X2 Y1", "rapid-too-low 6"),
        ("X2.5", "X9", "mark-off-sheet right --sheet"),
        ("G0 X1 Y2", "G0 X-1 Y2", "mark-off-sheet left"),
        ("G0 Z0.2\nM2", "M2", "ends-on-paper 13 -2.54"),
    ],
)
def test_check_refuses_dangerous_programs(desk, capsys, old, new, reported):
    (desk / "bad.gcode").write_text(INCHES.replace(old, new))
    status, _, messages = in_json(capsys, "check", "bad.gcode", "--sheet", "90x80")
    assert status == 1 and is_reported(messages, reported)


def test_comments_and_byte_order_marks_are_skipped(desk, capsys):
    """A semicolon in brackets is part of the comment. check once refused a byte order mark that convert skips."""
    (desk / "marked.gcode").write_text(
        "\ufeffG21 (mm; no inches)\nG0 Z5 ; up (a\nG0 X30 Y30\nG1 Z-1 F300\nG1 X60 F600\nG0 Z5\n", "utf-8"
    )
    for command in ("check marked.gcode", "convert marked.gcode -o out.ngc --width 3"):
        status, _, reported = in_json(capsys, *command.split())
        assert status == 0 and not is_reported(reported, "line-unread"), reported


def test_a_missing_unit_is_reported(desk, capsys):
    (desk / "f.gcode").write_text("G0 Z5\nG0 X30 Y30\nG1 Z-1 F300\nG1 X60 F600\nG0 Z5\n")
    status, _, reported = in_json(capsys, "check", "f.gcode")
    assert status == 0 and is_reported(reported, "unit-assumed 1")
    (desk / "f.gcode").write_text("G21\n" + (desk / "f.gcode").read_text())
    assert in_json(capsys, "check", "f.gcode")[2] == []


@pytest.mark.parametrize("name", ["inches.gcode", "servo.nc"])
def test_convert_accepts_foreign_programs_and_check_agrees(desk, capsys, name):
    assert call(capsys, "convert", name, "-o", "out.ngc", "--width", "3")[0] == 0
    status, out, _ = call(capsys, "check", "out.ngc", name, "--width", "3")
    assert status == 0 and RUNNABLE in out
    status, _, reported = in_json(capsys, "convert", "out.ngc", "-o", "again.ngc")
    assert status == 1 and is_reported(reported, "program-ours")


@pytest.mark.parametrize(
    "flags",
    ["--width 3", "--scale 2", "--z-offset 1", "--speed 5", "--as stroke", "--lenient", "--wide clamp", "--colour red"],
)
def test_check_refuses_flags_without_effect(desk, capsys, flags):
    (desk / "f.ngc").write_text(INCHES)
    status, _, reported = in_json(capsys, "check", "f.ngc", *flags.split())
    assert status == 1 and is_reported(reported, f"flag-without-effect {flags.split()[0]}")


def test_a_move_outside_the_workspace_is_reported_with_its_line(desk, capsys):
    cell = write_cell(
        replace(
            find_cell("linuxcnc-3axis"),
            name="mine",
            workspace=Workspace(box_mm=((-20.0, -20.0, -20.0), (70.0, 70.0, 20.0)), margin_mm=50.0, tilt_limit_deg=2.0),
        )
    )
    (desk / "mine.toml").write_text(cell)
    (desk / "far.gcode").write_text(INCHES.replace("G0 X1 Y2\n", "G0 X1 Y3\nG0 X1 Y2\n"))
    assert call(capsys, "check", "inches.gcode", "--cell", "mine.toml")[0] == 0
    status, _, reported = in_json(capsys, "check", "far.gcode", "--cell", "mine.toml")
    assert status == 1
    assert is_reported(reported, "out-of-box 76.2 -20 70", "line 11"), reported


FULL = "G90\nG0 Z5\nG0 X60 Y60\nG1 Z-1 F300\n{}\nG0 Z5\nM2\n"


@pytest.mark.parametrize("line", ["G2 X60 Y60 I10 J0", "G3 I10", "G2 X60.0001 Y60 I10 J0"])
def test_a_full_circle_is_drawn(desk, capsys, line):
    (desk / "circle.gcode").write_text(FULL.format(line))
    (circle,) = [way for way in read_moves(FULL.format(line)) if way.turn]
    assert np.ptp(circle.points_mm[:, :2], axis=0) == pytest.approx([20, 20], abs=0.02)
    assert call(capsys, "convert", "circle.gcode", "-o", "marks.json", "--width", "3")[0] == 0
    status, out, _ = call(capsys, "check", "circle.gcode", "--json")
    assert status == 0 and re.search(r"circle|line 4", out)


@pytest.mark.parametrize("end", ["M2", "M2 G90", "G90 M30"])
def test_nothing_is_read_after_the_end_of_a_program(end):
    """Nothing is read after the end of a program.

    Words after M2 on its line once made the program continue.
    """
    moves = "G90\nG0 Z5\nG0 X60 Y60\nG1 Z-1 F300\nG1 X80\n"
    assert len(read_moves(f"{moves}{end}\nG1 X90 Y90\n")) == len(read_moves(moves))


@pytest.mark.parametrize(
    ("end", "is_down"),
    [
        ("M5\n", False),
        ("", True),
        ("M2\n", False),
        ("M30\n", False),
        ("M5\nM3 S500\n", True),
        ("S0\n", False),
    ],
)
def test_a_servo_left_down_after_the_last_line_is_reported(desk, capsys, end, is_down):
    """A servo that is still down after the last line is reported.

    The last word is not a move. The end of a program releases the servo that M3 holds, like M5.
    """
    assert SERVO.endswith("M5\n")
    (desk / "end.nc").write_text(SERVO.removesuffix("M5\n") + end)
    status, _, reported = in_json(capsys, "check", "end.nc", "--cell", "grbl-servo", "--sheet", "120x100")
    assert status == is_down and is_reported(reported, "ends-on-paper 12 z") == is_down, reported


DOTS = {
    "z": "G0 Z5\nG0 X60 Y60\nG1 Z-2 F300\nG0 Z5\nG0 X70\nG1 Z-1\nG4 P0.2\nG0 Z5\n",
    "servo": "M5\nG0 X60 Y60\nM3 S500\nG4 P0.2\nM5\nG0 X70\nM3 S500\nM5\n",
}


def test_m3_s0_lifts_the_pen_but_0_degrees_is_a_servo_angle():
    """M3 S0 lifts the pen, but an M280 angle of 0 is a servo angle.

    grbl stops at S0 as at M5. With the cell's table, S0 was once the deepest position. A Marlin servo may be
    down at 0.
    """
    off = "G21 G90\nM3 S0\nG1 F900 X10 Y10\nM3 S500\nG1 X40\nS0\nG1 X60\nM3 S500\nG1 Y30\nS0\n"
    assert drawn(off) == drawn(off.replace("M3 S0", "M5").replace("\nS0", "\nM5")) != []
    angle = "G21 G90\nM280 P0 S90\nG0 X10 Y10\nM280 P0 S0\nG1 X40 F900\nM280 P0 S90\n"
    assert drawn(angle) == drawn(angle.replace("S0", "S10")) != []
    assert [way.power for way in read_moves(angle)][-1] == 0.0


@pytest.mark.parametrize("pen", DOTS)
def test_a_pen_that_goes_down_and_up_again_draws_a_dot(desk, capsys, pen):
    (desk / "dots.gcode").write_text(DOTS[pen])
    design = read_gcode(DOTS[pen].encode(), ReadOptions(sheet_mm=(100.0, 100.0)))
    places = [each.subpaths[0].cubics.reshape(-1, 2) for each in design.elements]
    assert [np.unique(place, axis=0).tolist() for place in places] == [[[60.0, 60.0]], [[70.0, 60.0]]]
    cell = ("--cell", "grbl-servo") if pen == "servo" else ()
    status, out, _ = call(capsys, "check", "dots.gcode", *cell)
    assert status == 0 and gives(out.splitlines()[1], "2")


@pytest.mark.parametrize(
    ("program", "reported"),
    [
        ("G0 Z5\nG0 X50 Y50\nG1 Z-1\nG1 X60\nG0 Z5\n", "speed-out-of-range 4 0"),
        ("G0 Z5\nG0 X50 Y50\nG1 Z-1 F300\nG1 X60 F0\nG0 Z5\n", "speed-out-of-range 4 0"),
        ("G0 Z5\nG0 X50 Y50\nG1 Z-1 F300\nG0 X60\nG0 Z5\n", "rapid-too-low 4"),
        # most of this move touches the paper
        ("G0 Z5\nG0 X50 Y50\nG1 Z-4 F300\nG0 X90 Z1\nG0 Z5\n", "rapid-too-low 4"),
        ("G1 Z-1 F300\nG0 X50\nG0 Z5\n", "line-incomplete 1"),
        ("G0 Z5\nG1 Z-1 F300\nG1 X50 Y50\nG0 Z5\n", "line-incomplete 2"),
        ("M3 S500\nG1 X50 Y10 F600\nM5\n", "line-incomplete 2"),
    ],
)
def test_check_reports_missing_information(desk, capsys, program, reported):
    (desk / "bad.gcode").write_text(program)
    cell = ("--cell", "grbl-servo") if "M3" in program else ()
    status, _, messages = in_json(capsys, "check", "bad.gcode", *cell)
    assert status == 1 and is_reported(messages, reported), messages


def test_a_brushsvg_program_without_its_header_is_recognized_by_its_strokes(desk, capsys):
    assert call(capsys, "convert", "inches.gcode", "-o", "out.ngc", "--width", "3")[0] == 0
    lines = (desk / "out.ngc").read_text().splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("(stroke 1 of "))
    (desk / "headless.ngc").write_text("\n".join(["G21 G90", "G0 Z10", *lines[first:]]))
    status, _, reported = in_json(capsys, "convert", "headless.ngc", "-o", "again.ngc")
    assert status == 1 and is_reported(reported, "program-ours")
    assert call(capsys, "check", "headless.ngc")[0] == 1
