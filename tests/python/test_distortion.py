"""Programs compensate for a machine's distortion, and check accounts for it."""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from diagnostics import agrees, refused
from programs import LANGUAGES, RUNNABLE, call
from scipy.interpolate import RegularGridInterpolator
from scipy.spatial import cKDTree

from brushsvg import _core
from brushsvg.jobs.preparation import preparation
from brushsvg.machine import preflight, writer
from brushsvg.machine.cells.cell import Machine, Reload, Station
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.limits.speeds import check_painting_speed
from brushsvg.machine.realised.arc_chords import with_chords
from brushsvg.model.library import find_brush
from brushsvg.verify import simulate_program
from brushsvg.verify.readback import read_program

DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="70mm" viewBox="0 0 120 70">
<title>two</title><g fill="none" stroke="#000" stroke-width="3"><path id="curve" d="M20 50 C40 10 60 10 90 40"/>
<path id="hook" d="M20 60 h30 v-20 h-12"/></g></svg>"""
LEANS = Machine((0.3, -0.2), (1.01, 0.99), 0.012)
TILTED = Machine((0.3, 0.0), (1.0, 1.0), 0.0, 0.4, (0.004, -0.003))
GRID = [
    (x, y, h)
    for y, row in ((0, (0.0, 0.8, -0.3)), (40, (0.5, -0.6, 0.9)), (90, (0.2, 0.7, 0.0)))
    for x, h in zip((0, 50, 130), row, strict=True)
]
BUMPY = Machine((0.2, 0.1), (1.01, 0.99), 0.005, 0.3, (0.002, 0.001), tuple(GRID))


@pytest.fixture
def desk(tmp_path, monkeypatch):
    (tmp_path / "two.svg").write_text(DRAWING)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def cell_with(machine, name="linuxcnc-3axis"):
    return preflight.as_exact_as(replace(find_cell(name), machine=machine), 0.05)


def text_of(work, cell):
    return "".join(writer.encode(LANGUAGES[cell.name], work.plan, work.brush, "two", (), cell))


def commanded_places(text):
    """Return the places (n, 3) that a G-code program commands.

    The parser uses nothing of the package. Circles count by their ends.
    """
    at, out = [np.nan] * 3, []
    for line in text.splitlines():
        if re.match(r"G[0123] ", line):
            for letter, value in re.findall(r"([XYZ])(-?\d+(?:\.\d+)?)", line):
                at["XYZ".index(letter)] = float(value)
            out.append(list(at))
    out = np.array(out)
    return out[~np.isnan(out).any(axis=1)]


@pytest.mark.parametrize("machine", [LEANS, TILTED])
def test_a_distorted_machine_follows_the_plan(desk, machine):
    work = preparation.prepare("two.svg")
    reported = commanded_places(text_of(work, cell_with(machine)))
    z = reported[:, 2] - machine.height_mm - reported[:, :2] @ np.array(machine.tilt_mm_per_mm)
    depth = np.maximum(0.0, -z)
    x = machine.scale[0] * reported[:, 0] + machine.skew * reported[:, 1] + machine.lean_mm_per_mm[0] * depth
    y = machine.scale[1] * reported[:, 1] + machine.lean_mm_per_mm[1] * depth
    goes = np.column_stack([x, y, z])
    for a_pass in work.plan.passes:
        poses = np.asarray(a_pass.poses_mm)
        away = np.linalg.norm(goes[None] - poses[:, None], axis=2).min(axis=1)
        assert away.max() < 2e-3
        near_by = np.linalg.norm(reported[None] - poses[:, None], axis=2).min(axis=1)
        assert near_by.max() > 0.5, "and the command differs"
    assert np.isclose(z, 10.0, atol=2e-3).sum() >= 4, "travel is at the safe height over the paper"


def paper_mm(reported, machine):
    """Return how much higher (n,) the paper is at commanded places than taught.

    scipy interpolates the height map.
    """
    xs, ys = (np.unique([row[k] for row in GRID]) for k in range(2))
    map_mm = RegularGridInterpolator((ys, xs), np.array([row[2] for row in GRID]).reshape(3, 3))
    at = np.clip(reported[:, :2], (xs[0], ys[0]), (xs[-1], ys[-1]))
    return machine.height_mm + reported[:, :2] @ np.array(machine.tilt_mm_per_mm) + map_mm(at[:, ::-1])


def test_the_height_above_a_paper_map_is_kept_along_the_path(desk):
    work = preparation.prepare("two.svg")
    cell = cell_with(BUMPY)
    reported = commanded_places(text_of(work, cell))
    between = np.vstack([a + np.linspace(0, 1, 9)[:, None] * (b - a) for a, b in pairwise(reported)])
    goes = between[:, 2] - paper_mm(between, BUMPY)
    depth = np.maximum(0.0, -goes)
    x = BUMPY.scale[0] * between[:, 0] + BUMPY.skew * between[:, 1] + BUMPY.lean_mm_per_mm[0] * depth
    y = BUMPY.scale[1] * between[:, 1] + BUMPY.lean_mm_per_mm[1] * depth
    painted = np.column_stack([x, y, goes])[goes < -0.2]
    plan = np.vstack(
        [
            a + np.linspace(0, 1, 2000)[:, None] * (b - a)
            for a_pass in work.plan.passes
            for a, b in pairwise(np.asarray(with_chords(a_pass).poses_mm))
        ]
    )
    away = cKDTree(plan).query(painted)[0]
    assert len(painted) > 300 and away.max() < 0.015
    assert np.ptp(paper_mm(reported, BUMPY)) > 0.8, "and the map is used"
    sideways = np.hypot(*np.diff(reported[:, :2], axis=0).T) > 5.0
    over = reported[:, 2] - paper_mm(reported, BUMPY)
    travels = [k for k in np.flatnonzero(sideways) if min(over[k], over[k + 1]) > 0.5]
    assert travels and over[travels].min() > 10.0 - 2e-3, "travel is over the highest place"


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        (GRID[:-1], "cell-machine 130 90 3 3"),
        ([*GRID, GRID[0]], "cell-machine 0 0"),
        (GRID[:3], "cell-machine 3 1 2 2"),
        ([(0, 0, 0), (3, 0, 0), (0, 9, 0), (3, 9, 0)], "cell-machine 0 3 5"),
        ([(*row[:2], 9.0) for row in GRID], "cell-machine 9 0 0 -5 5"),
    ],
)
def test_a_map_that_is_not_a_grid_is_refused(rows, expected):
    text = write_cell(find_cell("linuxcnc-3axis"))
    with refused(expected, "machine.map_mm"):
        parse_cell(f"{text}\n[machine]\nmap_mm = {[list(map(float, row)) for row in rows]}\n")


@pytest.mark.parametrize("name", ["linuxcnc-3axis", "grbl-3axis", "ur5e", "jaka-zu3"])
@pytest.mark.parametrize("machine", [LEANS, TILTED, BUMPY])
def test_a_distorted_program_is_read_back_as_the_plan(desk, name, machine):
    work, cell = preparation.prepare("two.svg"), cell_with(machine, name)
    read = read_program(text_of(work, cell), LANGUAGES[name], cell)
    back = simulate_program.simulate_program(read, work.brush, cell, work.plan.sheet_mm)
    assert back.problems == []
    for expected, found in zip(work.plan.passes, back.plan.passes, strict=True):
        away = np.linalg.norm(found.poses_mm[None] - expected.poses_mm[:, None], axis=2).min(axis=1)
        assert away.max() < 2.5e-3
        assert found.speed_mm_s == pytest.approx(expected.speed_mm_s, rel=1e-3)
    planned = _core.simulate(work.plan, work.brush)
    for marks in (planned, back.marks):
        _core.trace_outlines(marks, work.brush)
    assert _core.overlap(planned.outline_mm, back.marks.outline_mm) > 0.997


@pytest.mark.parametrize("machine", [LEANS, TILTED])
@pytest.mark.parametrize("name", ["linuxcnc-3axis", "ur5e"])
def test_check_accepts_a_program_only_on_its_own_machine(desk, capsys, name, machine):
    suffix = LANGUAGES[name]
    (desk / "mine.toml").write_text(write_cell(replace(find_cell(name), name="mine", machine=machine)))
    other = replace(machine, lean_mm_per_mm=(0.1, 0.0))
    (desk / "other.toml").write_text(write_cell(replace(find_cell(name), name="mine", machine=other)))
    assert call(capsys, "convert", "two.svg", "-o", "two" + suffix, "--cell", "mine.toml")[0] == 0
    status, out, _ = call(capsys, "check", "two" + suffix, "two.svg", "--cell", "mine.toml")
    assert status == 0 and RUNNABLE in out
    status, _, err = call(capsys, "check", "two" + suffix, "two.svg", "--cell", "other.toml")
    assert status == 1 and any("curve" in line for line in err)


@pytest.mark.parametrize(
    ("machine", "are_reported"),
    [(Machine((0.3, 0.1), (1.01, 1.01)), True), (LEANS, False), (TILTED, False), (BUMPY, False)],
)
def test_circles_stay_circles_only_if_the_machine_keeps_them_round(machine, are_reported):
    angle = np.linspace(0.0, 2.0, 30)
    on = np.column_stack([60 + 20 * np.cos(angle), 40 + 20 * np.sin(angle), np.full(30, -3.0)])
    poses = np.vstack([[70, 40, 0], on, [50, 70, 0]])
    brush, cell = find_brush("round-6"), cell_with(machine)
    plan = _core.Plan(
        brush.name, "", (120.0, 90.0), [_core.Pass("c", poses, 20.0, arcs=[_core.Arc(1, 30, (60, 40), 1)])]
    )
    text = "".join(writer.encode(".ngc", plan, brush, "c", (), cell))
    assert bool(re.search(r"(?m)^G[23] ", text)) == are_reported
    back = simulate_program.simulate_program(read_program(text, ".ngc", cell), brush, cell, plan.sheet_mm)
    assert back.problems == [] and bool(back.plan.passes[0].arcs) == are_reported
    found = np.asarray(back.plan.passes[0].poses_mm)
    deep = found[found[:, 2] < -2.9]
    assert np.hypot(*(deep[:, :2] - [60, 40]).T) == pytest.approx(20.0, abs=2e-3)
    assert np.linalg.norm(found[None] - poses[[0, 1, 30, 31], None], axis=2).min(axis=1).max() < 2e-3


@pytest.mark.parametrize(
    "machine",
    [
        Machine(scale=(1.06, 1.0)),
        Machine(scale=(1.0, 1.05), skew=0.03),
        Machine(field_mm=((1.5, -0.4, 0.3), (-0.9, 0.5, 1.2)), field_middle_mm=(60, 35), field_reach_mm=(60, 35)),
    ],
)
def test_the_tip_of_a_distorted_machine_keeps_the_speed_limit(machine):
    """The limit was compared with the commanded speed, and a tip that went too far was too fast."""
    brush, cell = find_brush("round-6"), cell_with(machine)
    poses = np.array([[20, 15, -3], [100, 15, -3], [100, 55, -3], [20, 55, -3], [100, 20, -3]], dtype=float)
    plan = _core.Plan(brush.name, "", (120.0, 70.0), [_core.Pass("a", poses, brush.max_speed_mm_s)])
    text = "".join(writer.encode(".ngc", plan, brush, "fast", (), cell))
    done = simulate_program.simulate_program(read_program(text, ".ngc", cell), brush, cell, plan.sheet_mm)
    assert done.problems == []
    before, feed, after = re.search(r"(G1 .*\n)F(.*)\n((?:G1 .* Z-3\.0000\n){4,})", text).groups()
    x, y = np.array(re.findall(r"X([-\d.]+) Y([-\d.]+)", before + after), dtype=float).T
    (sx, sy), u, v = machine.scale, (x - 60) / 60, (y - 35) / 35
    terms = np.stack([u * u, u * v, v * v])
    true_x, true_y = sx * x + machine.skew * y, sy * y
    if machine.field_mm:
        true_x, true_y = true_x + machine.field_mm[0] @ terms, true_y + machine.field_mm[1] @ terms
    stretch = np.hypot(np.diff(true_x), np.diff(true_y)) / np.hypot(np.diff(x), np.diff(y))
    assert stretch.max() > 1.01
    assert stretch.max() * float(feed) / 60 <= brush.max_speed_mm_s
    faster = text.replace(f"F{feed}", f"F{60 * brush.max_speed_mm_s:g}")
    checked = simulate_program.simulate_program(read_program(faster, ".ngc", cell), brush, cell, plan.sheet_mm)
    assert {each.code for each in checked.problems} == {"speed-out-of-range"}


def test_a_limit_that_the_language_cannot_command_is_refused():
    """HP-GL has whole cm/s: a tip that may have 10 mm/s had 10.6."""
    brush, plotter = find_brush("round-6"), find_cell("hpgl-plotter")
    slow = replace(plotter, speeds=replace(plotter.speeds, paint_mm_s=10.0))
    assert check_painting_speed(10.0, brush, slow) == []
    (notice,) = check_painting_speed(10.0, brush, replace(slow, machine=Machine(scale=(1.06, 1.0))))
    assert agrees(notice, "speed-out-of-range 9.434 10")


def test_limits_are_checked_at_commanded_positions(desk):
    work = preparation.prepare("two.svg")
    cell = cell_with(Machine(scale=(0.92, 1.0)))
    tight = replace(cell, workspace=replace(cell.workspace, box_mm=((-30.0, -30.0, -30.0), (100.0, 100.0, 50.0))))
    straight = replace(tight, machine=None)
    marks = _core.simulate(work.plan, work.brush)
    assert preflight.check_job(_loads(work), work.brush, marks, straight, 0.05).problems == []
    assert preflight.check_job(_loads(work), work.brush, marks, tight, 0.05).problems != []


def _loads(work):
    from brushsvg.machine.paint_reload import PlanInLoads

    return PlanInLoads(tuple(work.plan.sheet_mm), tuple(work.plan.passes))


@pytest.mark.parametrize(
    ("line", "where", "expected"),
    [
        ("lean_mm_per_mm = [2.0, 0.0]", "machine.lean_mm_per_mm", "out-of-range 2 -1.5 1.5"),
        ("scale = [1.0, 1.2]", "machine.scale", "out-of-range 1.2 0.9 1.1"),
        ("skew = 0.2", "machine.skew", "out-of-range 0.2 -0.1 0.1"),
        ("tilt_mm_per_mm = [0.2, 0.0]", "machine.tilt_mm_per_mm", "out-of-range 0.2 -0.05 0.05"),
        ("height_mm = 9", "machine.height_mm", "out-of-range 9 -5 5"),
        ("scale = 1.0", "machine.scale", "wrong-type 2"),
        ("leans = 1.0", "machine.leans", "key-unknown lean_mm_per_mm"),
    ],
)
def test_an_invalid_machine_table_is_refused(line, where, expected):
    text = write_cell(find_cell("linuxcnc-3axis"))
    with refused(expected, where):
        parse_cell(f"{text}\n[machine]\n{line}\n")


def test_a_leaning_servo_machine_is_refused():
    text = write_cell(find_cell("grbl-servo"))
    with refused("cell-machine 0.3", "machine.lean_mm_per_mm"):
        parse_cell(f"{text}\n[machine]\nlean_mm_per_mm = [0.3, 0.0]\n")
    assert parse_cell(f"{text}\n[machine]\nscale = [1.01, 1.0]\n").machine.scale == (1.01, 1.0)


def test_the_machine_table_is_read_back_unchanged():
    cell = replace(find_cell("linuxcnc-3axis"), machine=LEANS)
    assert parse_cell(write_cell(cell)) == cell


HIGH = Machine(scale=(1.02, 0.98), skew=0.01, height_mm=4.0, tilt_mm_per_mm=(0.01, 0.02))
LOW = Machine(height_mm=-3.0, tilt_mm_per_mm=(-0.01, 0.0))
INK = Station("ink", (-20.0, 10.0), surface_mm=-1.0, depth_mm=2.0, rim_mm=3.0)


def with_paint(machine, name="linuxcnc-3axis", safe_mm=5.0):
    cell = cell_with(machine, name)
    heights = replace(cell.heights, safe_mm=safe_mm, clearance_mm=1.0)
    space = replace(cell.workspace, box_mm=(), reach_mm=())
    return replace(cell, name="mine", heights=heights, workspace=space, reload=Reload("stroke"), stations=(INK,))


def over_the_paper(reported, machine):
    if machine.map_mm:
        return reported[:, 2] - paper_mm(reported, machine)
    return reported[:, 2] - machine.height_mm - reported[:, :2] @ np.array(machine.tilt_mm_per_mm)


@pytest.mark.parametrize("machine", [HIGH, LOW, BUMPY])
def test_the_tool_stays_at_the_safe_height_between_strokes_and_paint(desk, machine):
    """Between strokes and paint, the tool stays at the safe height.

    Over paper 4 mm higher than taught, the tool once came back from the paint only 1 mm above the paper.
    """
    work, cell = preparation.prepare("two.svg"), with_paint(machine)
    text = "".join(writer.encode(".ngc", work.plan, work.brush, "two", (), cell))
    reported = commanded_places(text)
    (rise,) = re.findall(r"(?m)^G0 Z(\S+)$", text.split("(paint:")[0])
    sideways = np.hypot(*np.diff(reported[:, :2], axis=0).T) > 1e-6
    over = over_the_paper(reported, machine)
    travels = [k for k in np.flatnonzero(sideways) if min(over[k], over[k + 1]) > 0.5]
    assert len(travels) == 3, "and one from nobody knows where"
    for k in travels:
        assert min(over[k : k + 2]) > 5.0 - 2e-3 and min(reported[k : k + 2, 2]) > 5.0 - 2e-3
    corners = np.array([(x, y, float(rise)) for x in (-30, 150) for y in (-30, 100)])
    assert over_the_paper(corners, machine).min() > 5.0 - 2e-3


@pytest.mark.parametrize("machine", [Machine(height_mm=0.4), Machine(height_mm=-0.4)])
@pytest.mark.parametrize("name", ["grbl-servo", "linuxcnc-3axis", "ur5e"])
def test_check_accepts_paint_visits_on_a_machine_with_higher_paper(desk, capsys, name, machine):
    suffix, safe_mm = LANGUAGES[name], 4.5
    cell = replace(with_paint(machine, name, safe_mm), blending=find_cell(name).blending)
    (desk / "mine.toml").write_text(write_cell(cell))
    assert call(capsys, "convert", "two.svg", "-o", "two" + suffix, "--cell", "mine.toml")[0] == 0
    status, out, err = call(capsys, "check", "two" + suffix, "two.svg", "--cell", "mine.toml")
    assert status == 0 and RUNNABLE in out, err


@pytest.mark.parametrize("machine", [HIGH, LOW, BUMPY])
def test_a_border_surrounds_the_painted_area_at_safe_height(desk, capsys, machine):
    (desk / "mine.toml").write_text(write_cell(with_paint(machine)))
    assert call(capsys, "setup", "border", "two.svg", "-o", "border.ngc", "--cell", "mine.toml")[0] == 0
    text = (desk / "border.ngc").read_text()
    reported = commanded_places(text)
    assert over_the_paper(reported, machine).min() > 5.0 - 2e-3 and reported[:, 2].min() > 5.0 - 2e-3
    x = machine.scale[0] * reported[:, 0] + machine.skew * reported[:, 1]
    ((left, right),) = re.findall(r"\(border: (\S+) to (\S+) mm,", text)
    assert (x.min(), x.max()) == pytest.approx((float(left), float(right)), abs=2e-3)
    assert call(capsys, "check", "border.ngc", "two.svg", "--cell", "mine.toml")[0] == 0


@pytest.mark.parametrize("machine", [HIGH, LOW, LEANS, BUMPY])
def test_the_height_program_shows_the_height_error_of_the_paper(desk, capsys, machine):
    """The height program shows how much higher the paper is than known.

    The first stroke that paints gives the value for `convert --z-offset`, which adds the value to height_mm.
    """
    (desk / "mine.toml").write_text(write_cell(with_paint(machine)))
    assert call(capsys, "setup", "height", "-o", "height.ngc", "--cell", "mine.toml")[0] == 0
    text = (desk / "height.ngc").read_text()
    sections = re.findall(r"first to paint means --z-offset (-?[\d.]+)\)\n((?:.+\n)+)", text)
    assert len(sections) > 10
    for title, lines in sections:
        reported = commanded_places(lines)
        over = over_the_paper(reported, machine)
        assert np.isclose(over, float(title), atol=2e-3).sum() == 2 and over.min() > float(title) - 2e-3
        assert over[[0, -1]].min() > 5.0 - 2e-3
    assert call(capsys, "check", "height.ngc", "--cell", "mine.toml")[0] == 0
