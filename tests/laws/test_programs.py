"""Programs of random plans, cells and brushes are safe to run.

The tests have their own reader of programs.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_up_brushes import make_brush, random_poses
from sampling import sample

from brushsvg import _core
from brushsvg.errors import Error
from brushsvg.machine import writer
from brushsvg.machine.cells.cell import Heights, Machine, Paper, Reload, Station, robot_from_paper
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.cells.language_limits import ARCS_IN_SEGMENTS
from brushsvg.machine.job_program import Job
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.posts import POSTS
from brushsvg.verify import against_plan, simulate_program
from brushsvg.verify.readback import read_program

LANGUAGES = {
    "linuxcnc-3axis": ".ngc",
    "grbl-3axis": ".ngc",
    "grbl-servo": ".ngc",
    "fluidnc-3axis": ".ngc",
    "marlin-3axis": ".gcode",
    "klipper-3axis": ".gcode",
    "ur5e": ".script",
    "jaka-zu3": ".jks",
    "irb120": ".mod",
    "xarm6": ".py",
    "kr6-r900": ".src",
    "cr5": ".lua",
    "lrmate200id": ".ls",
    "m0609": ".drl",
    "fr3": ".csv",
    "axidraw-ebb": ".ebb",
}
SERVOS = {  # with the values of a table that has a large enough range
    "grbl-servo": ((-12.0, 100.0), (0.0, 500.0), (25.0, 900.0)),
    "axidraw-ebb": ((-12.0, 10000.0), (0.0, 16000.0), (25.0, 30000.0)),
}
SHEET = (400.0, 400.0)


def random_cell(rng, name):
    """Return a random cell of a language: heights, speeds, paper and paint."""
    cell = find_cell(name)
    safe = rng.uniform(6, 20)
    if name in SERVOS:
        cell = replace(cell, servo=replace(cell.servo, table=SERVOS[name]))
    lowest = -rng.uniform(5, 10)
    cell = replace(cell, heights=Heights(safe, rng.uniform(0.5, 3), lowest))
    cell = replace(cell, speeds=replace(cell.speeds, press_mm_s=rng.uniform(2, 30), approach_mm_s=rng.uniform(5, 60)))
    if name not in SERVOS:  # values of a servo do not support leaning paper
        paper = Paper(
            tuple(rng.uniform(-300, 300, 3)),
            (*rng.uniform(-1, 1, 2) * rng.integers(0, 2), rng.uniform(0, 360)),
        )
        cell = replace(cell, paper=paper)
    cell = replace(cell, workspace=replace(cell.workspace, box_mm=(), reach_mm=(), margin_mm=60.0))
    if rng.random() < 0.6:
        ink = Station("ink", (-20.0, 30.0), ("#000000",), surface_mm=-1.0, depth_mm=3.0, rim_mm=1.0, hold_s=0.3)
        wiped = Station(
            "red",
            (-20.0, 60.0),
            surface_mm=0.0,
            depth_mm=2.0,
            wipe_mm=((-15.0, 60.0, 2.0), (-10.0, 60.0, 2.0)),
        )
        when = str(rng.choice(["length", "stroke", "layer"]))
        cell = replace(cell, reload=Reload(when, float(rng.uniform(40, 200)), 4.0), stations=(ink, wiped))
    return cell


def random_plan(rng, brush, lowest):
    passes = []
    for number in range(rng.integers(1, 5)):
        poses = random_poses(rng, rng.integers(2, 12), deepest=0.95 * -lowest)
        poses[:, :2] += np.array(SHEET) / 2 - poses[:, :2].mean(axis=0)
        colour = str(rng.choice(["#000000", "#ff0000"]))
        speed = float(rng.uniform(1, brush.max_speed_mm_s))
        passes.append(_core.Pass(f"s{number}(\u00e9)", poses, speed, str(rng.choice(["a", "b"])), colour))
    return _core.Plan(brush.name, "", SHEET, passes)


def gcode_moves(text, cell):
    """Return (rapid, point, mm/s, in a visit) of every move.

    A circle counts by its end.
    """
    at, feed, visit, word = [np.nan] * 3, 0.0, False, ""
    table = np.array(sorted(cell.servo.table, key=lambda row: row[1])) if cell.servo else None
    for line in text.splitlines():
        if line.startswith(("(", "; ")):
            visit = line.startswith(("(paint", "; paint"))
            continue
        words = re.findall(r"([A-Z])(-?\d+(?:\.\d+)?)", line)
        values = {letter: float(value) for letter, value in words if letter != "G"}
        feed = values.get("F", feed) if "F" in values else feed
        codes = [value for letter, value in words if letter == "G"]
        if codes and codes[0] in ("0", "1", "2", "3"):
            word = codes[0]
        moves = {"X", "Y", "Z", "S"} & set(values)
        if "S" in values:
            height = float(np.interp(values["S"], table[:, 1], table[:, 0]))
            yield word == "0" and "X" in values, (at[0], at[1], height), feed / 60, visit
            at[2] = height
        for k, axis in enumerate("XYZ"):
            at[k] = values.get(axis, at[k])
        if moves:
            yield (
                bool(codes) and word == "0" and cell.language not in ARCS_IN_SEGMENTS,
                tuple(at),
                feed / 60,
                visit,
            )


def moves_on_paper(text, remark, speed, unit_mm=1.0):
    """Return the moves of languages whose places are on_paper(x, y, z)."""
    visit = False
    for line in text.splitlines():
        if line.startswith(remark):
            visit = line.startswith(f"{remark}paint")
        match = re.search(speed, line)
        for point in re.findall(r"on_paper\((-?[\d.]+), (-?[\d.]+), (-?[\d.]+)\)", line):
            yield False, tuple(unit_mm * float(value) for value in point), unit_mm * float(match[1]), visit


def jaka_moves(text):
    visit, places = False, {}
    for line in text.splitlines():
        if line.startswith("# "):
            visit = line.startswith("# paint")
        if pose := re.fullmatch(r"(to|via) = \[(-?[\d.]+), (-?[\d.]+), (-?[\d.]+), .*\]", line):
            places[pose[1]] = tuple(map(float, pose.groups()[1:]))
        if move := re.fullmatch(r"(movl\(|movc\(via, )to, 0, ([\d.]+), [\d.]+, [\d.]+\)", line):
            names = ("via", "to") if move[1].startswith("movc") else ("to",)
            yield from ((False, places[name], float(move[2]), visit) for name in names)


def xarm_moves(text):
    visit = False
    for line in text.splitlines():
        if line.startswith("# "):
            visit = line.startswith("# paint")
        if move := re.fullmatch(r"go\((-?[\d.]+), (-?[\d.]+), (-?[\d.]+), ([\d.]+), .*\)", line):
            *point, speed = map(float, move.groups())
            yield False, tuple(point), speed, visit


def krl_moves(text):
    visit, speed = False, 0.0
    for line in text.splitlines():
        if line.startswith("; "):
            visit = line.startswith("; paint")
        if match := re.fullmatch(r"\$VEL\.CP = ([\d.]+)", line):
            speed = 1e3 * float(match[1])
        if line.startswith(("LIN {", "CIRC {")):
            for point in re.findall(r"\{X (-?[\d.]+), Y (-?[\d.]+), Z (-?[\d.]+), ", line):
                yield False, tuple(map(float, point)), speed, visit


def ebb_moves(text, cell):
    """Return the moves of two motors with a 2x2 table.

    The duration of a slice gives its speed. A servo is set before.
    """
    rows, table = (
        np.array(cell.motors.steps_per_mm),
        np.array(sorted(cell.servo.table, key=lambda row: row[1])),
    )
    steps, height, visit = np.zeros(2), np.nan, False
    for line in text.splitlines():
        if line.startswith("# "):
            visit = line.startswith("# paint") or (visit and line.startswith("# feed"))
            continue
        word, *numbers = line.split(",")
        values = [int(number) for number in numbers]
        x, y = np.linalg.solve(rows, steps)
        if word == "S2":
            height = float(np.interp(values[0], table[:, 1], table[:, 0]))
            yield False, (x, y, height), 0.0, visit
        elif word == "SM" and any(values[1:]):
            steps = steps + values[1:]
            there = np.linalg.solve(rows, steps)
            assert max(map(abs, values[1:])) <= 25 * values[0], "25,000 steps in a second"
            speed = float(np.hypot(*(there - (x, y)))) / values[0] * 1e3
            yield False, (*there, height), speed, visit
    assert not steps.any(), "it ends where it began"


ROBOTS = {
    "ur5e": lambda text: moves_on_paper(text, "  # ", r"v=([\d.]+)", 1e3),
    "jaka-zu3": jaka_moves,
    "irb120": lambda text: moves_on_paper(text, "  ! ", r"mm_s\(([\d.]+)\)"),
    "xarm6": xarm_moves,
    "kr6-r900": krl_moves,
    "cr5": lambda text: moves_on_paper(text, "-- ", r"speed = (\d+)"),
}
ON_PAPER = ("ur5e", "irb120", "kr6-r900", "cr5")  # their points are in the paper's frame


def in_paper_frame(moves, cell, name, z_offset):
    back = np.eye(4) if name in ON_PAPER else np.linalg.inv(robot_from_paper(cell, z_offset))
    for rapid, point, speed, visit in moves:
        yield rapid, back[:3, :3] @ np.array(point) + back[:3, 3], speed, visit


@sample("name", LANGUAGES, keep=4)
@given(seed=st.integers(0, 2**32 - 1))
def test_all_random_programs_are_safe(name, seed):
    rng = np.random.default_rng(seed)
    cell, brush = random_cell(rng, name), make_brush(name="made")
    brush.max_speed_mm_s = float(rng.uniform(3, 40))
    plan = random_plan(rng, brush, cell.heights.lowest_mm)
    z_offset = float(rng.choice([0.0, 0.7]))
    job = Job(z_offset, int(rng.integers(1, len(plan.passes) + 1)))
    try:
        text = "".join(writer.encode(LANGUAGES[name], plan, brush, "t\u00e9\u66f8", (), cell, job))
    except Error as refusal:
        assert len(str(refusal)) > 20 and "mm" in str(refusal)
        return
    again = "".join(writer.encode(LANGUAGES[name], plan, brush, "t\u00e9\u66f8", (), cell, job))
    assert text == again and text.isascii() and text.endswith("\n")
    assert text.count("\r\n") == text.count("\r") in (0, text.count("\n"))
    robot = ROBOTS.get(name)
    code = re.sub(r"\b9E9\b" if robot else r"\(.*\)|[#;].*", "", text)  # RAPID writes 9E9 for a missing axis
    assert not re.search(r"\d[eE][-+]?\d|nan|inf\b|-0\.0+(?![\d])", code)
    moves = robot(text) if robot else ebb_moves(text, cell) if cell.motors else gcode_moves(text, cell)
    slack = {"grbl-servo": 0.15, "axidraw-ebb": 0.02}.get(name, 2e-3)
    fastest = min(brush.max_speed_mm_s, cell.speeds.paint_mm_s)
    # Rounding in the robot's frame of leaning paper gives an equal error in the paper's frame.
    last = None
    for rapid, point, speed, visit in in_paper_frame(moves, cell, name, z_offset):
        assert np.isnan(point[2]) or point[2] >= cell.heights.lowest_mm - slack
        low = point[2] if last is None else min(point[2], last[2])
        sideways = last is not None and np.abs(point[:2] - last[:2]).max() > slack
        if low < cell.heights.safe_mm - slack:
            straight_up = rapid and point[2] > low and not sideways
            assert not rapid or straight_up, "fast only at safe height, or straight up to it"
            if sideways and not visit:
                assert low <= slack and point[2] <= slack, "sideways below the safe height only on the paper"
        if low <= slack and not rapid:
            assert speed <= fastest + 0.01
        if not np.isnan(point).any():
            assert (point[:2] > -61).all() and (point[:2] < SHEET[0] + 61).all()
        last = point


def test_every_language_is_tested():
    # A user's own post may write anything. A pen draws no plan of this kind: see test_hpgl and
    # test_marlin_servo.
    posts = set(POSTS) - {"robodk", "hpgl", "marlin-servo"}
    assert {find_cell(name).language for name in LANGUAGES} == posts


@pytest.mark.parametrize("seed", range(15))
def test_programs_for_inexact_machines_pass_check_and_are_read_back(seed):
    rng = np.random.default_rng(seed + 71)
    name = list(LANGUAGES)[seed % len(LANGUAGES)]
    cell, brush = random_cell(rng, name), make_brush(name="made")
    axes = {"scale": tuple(rng.uniform(0.97, 1.03, 2)), "skew": rng.uniform(-0.02, 0.02)}
    if name not in SERVOS:
        axes["lean_mm_per_mm"] = tuple(rng.uniform(-0.5, 0.5, 2))
        axes |= {"height_mm": rng.uniform(-0.5, 0.5), "tilt_mm_per_mm": tuple(rng.uniform(-0.004, 0.004, 2))}
    cell = replace(cell, machine=Machine(**axes))
    plan = random_plan(rng, brush, cell.heights.lowest_mm)
    text = "".join(writer.encode(LANGUAGES[name], plan, brush, "random", (), cell))
    ran = simulate_program.simulate_program(read_program(text, LANGUAGES[name], cell), brush, cell, plan.sheet_mm)
    assert ran.problems == []
    assert against_plan.compare_with_plan(ran, split_into_loads(plan, brush, cell), cell)[1] == []
