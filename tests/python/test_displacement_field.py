"""Machines with a smooth field of position errors over the sheet.

Programs compensate for the field, and check knows where the tool goes.
"""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from diagnostics import are_reported, refused
from programs import LANGUAGES, RUNNABLE, call
from sampling import sample
from scipy.spatial import cKDTree
from test_corrected_cell import MIDDLE, TRUE, found
from test_distortion import DRAWING, GRID, cell_with, commanded_places, text_of

from brushsvg import _core
from brushsvg.comparison.attribution.corrected_cell import corrected_machine
from brushsvg.comparison.corrections import machine_sha256
from brushsvg.jobs.preparation import preparation
from brushsvg.machine import writer
from brushsvg.machine.cells.cell import Machine
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.realised.arc_chords import with_chords
from brushsvg.machine.realised.displacement_field import beyond_field
from brushsvg.machine.realised.distortion import commanded_mm, true_mm
from brushsvg.model.library import find_brush
from brushsvg.verify import simulate_program
from brushsvg.verify.readback import read_program

FIELD = {
    "field_mm": ((0.7, -0.4, 0.9), (-0.5, 0.6, -1.1)),
    "field_middle_mm": (60.0, 35.0),
    "field_reach_mm": (62.0, 40.0),
}
BENT = Machine(**FIELD)
NARROW = replace(BENT, field_reach_mm=(30.0, 40.0))  # strokes go beyond this reach
BOTH = replace(BENT, lean_mm_per_mm=(0.2, 0.1), scale=(1.01, 0.99), skew=0.005, height_mm=0.3)
ON_A_MAP = replace(BOTH, map_mm=tuple(GRID))


@pytest.fixture
def desk(tmp_path, monkeypatch):
    (tmp_path / "two.svg").write_text(DRAWING)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def goes(reported, machine):
    """Return the positions (n, 3) that a machine without a map reaches for commands.

    The formula is written independently of the package.
    """
    out = []
    for x, y, z in reported:
        (mx, my), (rx, ry) = machine.field_middle_mm, machine.field_reach_mm
        u, v = (min(max(w, -1.0), 1.0) for w in ((x - mx) / rx, (y - my) / ry))
        (a, b, c), (d, e, f) = machine.field_mm
        z -= machine.height_mm
        lean = [each * max(-z, 0.0) for each in machine.lean_mm_per_mm]
        to_x = machine.scale[0] * x + machine.skew * y + a * u**2 + b * u * v + c * v**2 + lean[0]
        out.append((to_x, machine.scale[1] * y + d * u**2 + e * u * v + f * v**2 + lean[1], z))
    return np.array(out)


@pytest.mark.parametrize("machine", [BENT, NARROW, BOTH])
def test_commanded_and_true_positions_are_inverse(machine):
    target = np.random.default_rng(1).uniform((-20, -20, -6), (140, 110, 2), (500, 3))
    reported = commanded_mm(target, machine)
    assert goes(reported, machine) == pytest.approx(target, abs=1e-7)
    assert true_mm(reported, machine) == pytest.approx(target, abs=1e-7)
    assert np.abs(reported - target)[:, :2].max() > 0.5


@pytest.mark.parametrize("machine", [BENT, NARROW, BOTH])
def test_straight_lines_on_the_paper_stay_straight(desk, machine):
    work = preparation.prepare("two.svg")
    reported = commanded_places(text_of(work, cell_with(machine)))
    between = np.vstack([a + np.linspace(0, 1, 9)[:, None] * (b - a) for a, b in pairwise(reported)])
    painted = goes(between, machine)
    painted = painted[painted[:, 2] < -0.2]
    plan = np.vstack(
        [
            a + np.linspace(0, 1, 2000)[:, None] * (b - a)
            for a_pass in work.plan.passes
            for a, b in pairwise(np.asarray(with_chords(a_pass).poses_mm))
        ]
    )
    away = cKDTree(plan).query(painted)[0]
    assert len(painted) > 300 and away.max() < 0.015
    near_by = cKDTree(plan).query(between[between[:, 2] < -0.5])[0]
    assert near_by.max() > 0.3, "and the command differs"


@sample(
    "name",
    ["linuxcnc-3axis", "grbl-servo", "ur5e", "jaka-zu3", "irb120", "axidraw-ebb"],
    keep=2,
)
@pytest.mark.parametrize("machine", [BENT, NARROW, ON_A_MAP])
def test_check_reads_back_the_plan(desk, capsys, name, machine):
    if LANGUAGES[name] in (".nc", ".ebb"):
        machine = replace(
            machine, lean_mm_per_mm=(0.0, 0.0), map_mm=(), height_mm=0.0
        )  # the machine lifts no more than 5 mm
    suffix = LANGUAGES[name]
    cell = replace(find_cell(name), name="mine", machine=machine)
    (desk / "mine.toml").write_text(write_cell(cell))
    (desk / "straight.toml").write_text(write_cell(replace(cell, machine=None)))
    assert call(capsys, "convert", "two.svg", "-o", "two" + suffix, "--cell", "mine.toml")[0] == 0
    status, out, err = call(capsys, "check", "two" + suffix, "two.svg", "--cell", "mine.toml")
    assert status == 0 and RUNNABLE in out, err
    status, _, err = call(capsys, "check", "two" + suffix, "two.svg", "--cell", "straight.toml")
    assert status == 1 and any("curve" in line or "hook" in line for line in err)


def test_the_mark_is_read_back(desk):
    work, cell = preparation.prepare("two.svg"), cell_with(BOTH)
    back = simulate_program.simulate_program(
        read_program(text_of(work, cell), ".ngc", cell), work.brush, cell, work.plan.sheet_mm
    )
    assert back.problems == []
    planned = _core.simulate(work.plan, work.brush)
    for marks in (planned, back.marks):
        _core.trace_outlines(marks, work.brush)
    assert _core.overlap(planned.outline_mm, back.marks.outline_mm) > 0.997


def test_circles_are_written_as_lines():
    angle = np.linspace(0.0, 2.0, 30)
    on = np.column_stack([60 + 20 * np.cos(angle), 40 + 20 * np.sin(angle), np.full(30, -3.0)])
    arcs = [_core.Arc(1, 30, (60, 40), 1)]
    plan = _core.Plan(
        "round-6",
        "",
        (120.0, 90.0),
        [_core.Pass("c", np.vstack([[70, 40, 0], on, [50, 70, 0]]), 20.0, arcs=arcs)],
    )
    text = "".join(writer.encode(".ngc", plan, find_brush("round-6"), "c", (), cell_with(BENT)))
    assert not re.search(r"(?m)^G[23] ", text)
    reported = commanded_places(text)
    between = np.vstack([a + np.linspace(0, 1, 9)[:, None] * (b - a) for a, b in pairwise(reported)])
    painted = goes(between, BENT)
    deep = painted[painted[:, 2] < -2.99]
    assert np.hypot(*(deep[:, :2] - [60, 40]).T) == pytest.approx(20.0, abs=0.015)


def test_strokes_outside_the_measured_area_are_reported(desk, capsys):
    work = preparation.prepare("two.svg")
    assert beyond_field(work.plan.passes, cell_with(BENT)) == []
    assert beyond_field(work.plan.passes, cell_with(None)) == []
    farthest = max(np.asarray(one.poses_mm)[:, 0].max() for one in work.plan.passes) - 90.0
    nearest = 30.0 - min(np.asarray(one.poses_mm)[:, 0].min() for one in work.plan.passes)
    expected = f"beyond-field {max(farthest, nearest):.1f} 30.0 90.0 -5.0 75.0"
    assert are_reported(beyond_field(work.plan.passes, cell_with(NARROW)), expected)
    (desk / "mine.toml").write_text(write_cell(replace(find_cell("linuxcnc-3axis"), name="mine", machine=NARROW)))
    status, _, err = call(capsys, "convert", "two.svg", "-o", "two.ngc", "--cell", "mine.toml")
    assert status == 0 and any("[30.0, 90.0]" in line for line in err)


@pytest.mark.parametrize(
    ("lines", "where", "expected"),
    [
        (["field_mm = [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]"], "machine.field_middle_mm", "key-missing"),
        (
            ["field_middle_mm = [50.0, 50.0]", "field_reach_mm = [50.0, 50.0]"],
            "machine.field_mm",
            "key-missing",
        ),
        (
            [
                "field_mm = [[0.0, 1.0, 0.0], [0.0, 0.0, 3.0]]",
                "field_middle_mm = [50.0, 50.0]",
                "field_reach_mm = [50.0, 50.0]",
            ],
            "machine.field_mm",
            "cell-machine 0.12 0 0.1",
        ),
        (["field_reach_mm = [50.0, 1.0]"], "machine.field_reach_mm", "out-of-range 1 5 2000"),
        (["field_mm = [1.0, 2.0]"], "machine.field_mm[0]", "wrong-type"),
    ],
)
def test_an_invalid_field_table_is_refused(lines, where, expected):
    text = write_cell(find_cell("linuxcnc-3axis"))
    with refused(expected, where):
        parse_cell(f"{text}\n[machine]\n" + "\n".join(lines) + "\n")


def test_the_field_table_is_read_back_unchanged():
    cell = replace(find_cell("linuxcnc-3axis"), machine=BOTH)
    assert parse_cell(write_cell(cell)) == cell


def test_a_corrected_cell_compensates_the_field():
    """A corrected cell also undoes the field.

    Faults beyond the cell are added at the position to which the cell moved the tool.
    """
    now = corrected_machine(found(replace(TRUE, lean_mm_per_mm=(0.0, 0.0))), MIDDLE, BENT)
    reported = np.random.default_rng(2).uniform((0, 0, 0), (120, 70, 0), (50, 3))
    once = goes(reported, BENT)[:, :2]
    twice = np.column_stack([TRUE.scale[0] * once[:, 0] + TRUE.skew * once[:, 1], TRUE.scale[1] * once[:, 1]])
    assert goes(reported, now)[:, :2] == pytest.approx(twice, abs=1e-3)


def test_corrections_for_a_cell_without_a_field_stay_valid():
    plain = Machine((0.3, -0.2), (1.01, 0.99), 0.012)
    # This is the value at commit 06aaa888.
    of_before = "7ccbf0b11ef28f6cc52756145aa04d87cf6649893894d3ca953761c866dc2b9d"
    assert machine_sha256(plain) == of_before
    assert machine_sha256(replace(plain, **FIELD)) != machine_sha256(plain)
