"""Programs that tilt the brush: the position of its tip and its axis.

The tests compute both with scipy's rotations. They also check which programs check refuses.
"""

import inspect
import json
import re
import subprocess
import sys
from dataclasses import replace
from importlib.util import find_spec
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import agrees, in_json, is_reported, refused
from sampling import sample
from scipy.spatial.transform import Rotation, Slerp
from urscript_stub import run

import brushsvg
from brushsvg import _core
from brushsvg.machine.cells.cell import Machine, Paper, robot_from_paper
from brushsvg.machine.cells.cell_file import write_cell
from brushsvg.machine.frames import of_quaternion, of_rotation_vector
from brushsvg.machine.job_program import find_moves_out_of_arm, make_checked_program
from brushsvg.machine.moves import program_in_robot_frame
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.posts import POSTS, ros2
from brushsvg.machine.preflight import check_job
from brushsvg.machine.realised.tilt import check_tilt_limits, limit_turning_speed, split_turning_moves
from brushsvg.machine.tool_axes import turned_to
from brushsvg.machine.writer import text_of
from brushsvg.verify.against_regenerated import _ActComparison
from brushsvg.verify.readback import Act, read_program
from brushsvg.verify.simulate_program import simulate_program as played

BRUSH = brushsvg.find_brush("round-6")
POSES = [[20, 20, 0], [30, 20, -2], [60, 20, -2], [75, 35, -1], [75, 35, 0]]
SUFFIXES = {"ur5e": ".script", "irb120": ".mod", "fr3": ".csv"} | {
    "kr6-r900": ".src",
    "cr5": ".lua",
    "xarm6": ".py",
    "jaka-zu3": ".jks",
    "m0609": ".drl",
    "lrmate200id": ".ls",
}
TILTING = tuple(SUFFIXES)


def axes(*tilts_deg, towards_deg=0.0):
    """Return unit vectors that lean towards a direction of the paper, or one each."""
    tilts, towards = np.radians(tilts_deg), np.radians(towards_deg)
    return np.column_stack([np.sin(tilts) * np.cos(towards), np.sin(tilts) * np.sin(towards), np.cos(tilts)])


TILTED = axes(0, 8, 8, 20, 20, towards_deg=np.array([0, 40, 40, 130, 130]))


def plan(*tool_axes, poses=POSES, speed=20.0):
    passes = [_core.Pass(f"s{k}", poses, speed, tool_axes=each) for k, each in enumerate(tool_axes)]
    return _core.Plan("round-6", "", (100, 60), passes)


def anyhow(name="ur5e"):
    """Return a cell in which nothing is parallel to an axis.

    The paper leans, the tool is turned, and its holder is bent.
    """
    cell = brushsvg.find_cell(name)
    x, y, z = cell.paper.origin_mm
    tool = replace(cell.tool, tcp_mm=(12.0, -7.0, 150.0), rotation_deg=(0.0, 10.0, 5.0), spin_deg=30.0)
    return replace(cell, paper=Paper((x, y, z + 20.0), (2.0, -3.0, 25.0)), tool=tool, arm=None)


def text_for(of, cell):
    made = make_checked_program(split_into_loads(of, BRUSH, cell), BRUSH, cell).allowed()
    return "".join(text_of(POSTS[cell.language], made))


# Commands of a robot ---------------------------------------------------------------------------------------


def commanded_ur(text, cell):
    """Return the tips (n, 3) [mm] and rotations of all moves, in the robot's frame."""
    rows = [(pose, name) for name, *rest in run(text).events for pose in rest[0] if name.startswith("move")]
    tips = 1e3 * np.array([pose[:3] for pose, _ in rows])
    return tips, Rotation.from_rotvec([pose[3:] for pose, _ in rows])


N = r"(-?[\d.]+)"


def in_paper(tips, turned, cell):
    """Convert tips and rotations from the paper frame to the robot's frame."""
    frame = robot_from_paper(cell)
    return tips @ frame[:3, :3].T + frame[:3, 3], Rotation.from_matrix(frame[:3, :3]) * turned


def commanded_rapid(text, cell):
    """Read RAPID, whose quaternions begin with the scalar part."""
    upright = re.search(rf"RETURN \[\[x, y, z\], \[{N}, {N}, {N}, {N}\]", text).groups()
    moves = re.findall(rf"MoveL (?:on_paper|tilted)\({N}, {N}, {N}(?:, {N}, {N}, {N}, {N})?\)", text)
    tips = np.array([move[:3] for move in moves], dtype=float)
    turned = np.array([move[3:] if move[3] else upright for move in moves], dtype=float)
    return in_paper(tips, Rotation.from_quat(turned[:, [1, 2, 3, 0]]), cell)


def commanded_ros2(text, cell):
    """Read rows with poses of the plan, which give the flange that holds the tip."""
    rows = np.array([line.split(",")[:8] for line in text.splitlines() if line.endswith(",pose")], dtype=float)
    flange = Rotation.from_quat(rows[:, 4:])
    bent = Rotation.from_euler("xyz", cell.tool.rotation_deg, degrees=True)
    return 1e3 * rows[:, 1:4] + flange.apply(cell.tool.tcp_mm), flange * bent


def commanded_krl(text, cell):
    """Read KRL angles: A about z, B about the new y, C about the newest x."""
    rows = re.findall(rf"LIN [{{]X {N}, Y {N}, Z {N}, A {N}, B {N}, C {N}[}}]", text)
    rows = np.array(rows, dtype=float)
    return in_paper(rows[:, :3], Rotation.from_euler("ZYX", rows[:, 3:], degrees=True), cell)


def commanded_dobot(text, cell):
    """Read Dobot angles, which are about the fixed axes x, y, z."""
    upright = re.search(rf"pose = [{{]x, y, z, {N}, {N}, {N}[}}]", text).groups()
    moves = re.findall(rf"MovL\((?:on_paper|tilted)\({N}, {N}, {N}(?:, {N}, {N}, {N})?\)", text)
    rows = np.array([move if move[3] else (*move[:3], *upright) for move in moves], dtype=float)
    return in_paper(rows[:, :3], Rotation.from_euler("xyz", rows[:, 3:], degrees=True), cell)


def commanded_xarm(text, cell):
    """Read roll, pitch and yaw, which are about the fixed axes x, y, z of the robot."""
    upright = re.search(rf"UPRIGHT = \({N}, {N}, {N}\)", text).groups()
    moves = re.findall(rf"(?m)^(?:go|lean)\({N}, {N}, {N}(?:, {N}, {N}, {N})?, {N}, (?:None|{N})\)$", text)
    rows = np.array([move[:6] if move[3] else (*move[:3], *upright) for move in moves], dtype=float)
    return rows[:, :3], Rotation.from_euler("xyz", rows[:, 3:], degrees=True)


def commanded_doosan(text, cell):
    """Read Doosan angles: A about z, B about the new y, C about the newest z."""
    upright = re.search(rf"return posx\(x, y, z, {N}, {N}, {N}\)", text).groups()
    moves = re.findall(rf"movel\((?:on_paper|tilted)\({N}, {N}, {N}(?:, {N}, {N}, {N})?\)", text)
    rows = np.array([move if move[3] else (*move[:3], *upright) for move in moves], dtype=float)
    return in_paper(rows[:, :3], Rotation.from_euler("ZYZ", rows[:, 3:], degrees=True), cell)


def commanded_jaka(text, cell):
    rows = np.array(re.findall(rf"to = \[{N}, {N}, {N}, {N}, {N}, {N}\]", text), dtype=float)
    return rows[:, :3], Rotation.from_euler("xyz", rows[:, 3:], degrees=True)


def commanded_fanuc(text, cell):
    """Read the points in the order in which the program visits them.

    W, P and R are about the fixed axes x, y, z.
    """
    points = re.findall(
        rf"P\[(\d+)\][^X]*X = {N}  mm,\s*Y = {N}  mm,\s*Z = {N}  mm,\s*W = {N} deg,\s*P = {N} deg,\s*R = {N} deg",
        text,
    )
    of = {name: [float(each) for each in values] for name, *values in points}
    rows = np.array([of[name] for name in re.findall(r"(?m): L P\[(\d+)\]", text)])
    return in_paper(rows[:, :3], Rotation.from_euler("xyz", rows[:, 3:], degrees=True), cell)


COMMANDED = {
    "ur5e": commanded_ur,
    "irb120": commanded_rapid,
    "fr3": commanded_ros2,
    "kr6-r900": commanded_krl,
    "cr5": commanded_dobot,
    "xarm6": commanded_xarm,
    "jaka-zu3": commanded_jaka,
    "m0609": commanded_doosan,
    "lrmate200id": commanded_fanuc,
}


def strokes(tips, cell):
    """Return slices of the moves between positions at safe height, and tips on paper.

    The tips are in the paper frame.
    """
    frame = robot_from_paper(cell)
    paper = (tips - frame[:3, 3]) @ frame[:3, :3]
    high = np.flatnonzero(paper[:, 2] > cell.heights.safe_mm - 0.01)
    return [slice(a + 1, b) for a, b in pairwise(high) if b > a + 1], paper


@pytest.mark.parametrize("name", TILTING)
def test_tip_position_and_brush_tilt_match_the_plan(name):
    cell = anyhow(name)
    tips, turned = COMMANDED[name](text_for(plan(TILTED), cell), cell)
    (on,), paper = strokes(tips, cell)
    target = split_turning_moves(plan(TILTED).passes[0])
    poses, leans = np.asarray(target.poses_mm), np.asarray(target.tool_axes)
    # Approach and landing before the stroke, lift after it.
    poses = np.vstack(
        [poses[0] + (0, 0, cell.heights.clearance_mm), poses, poses[-1] + (0, 0, cell.heights.clearance_mm)]
    )
    leans = np.vstack([leans[:1], leans, leans[-1:]])
    assert paper[on] == pytest.approx(poses, abs=1.5e-3)
    frame = Rotation.from_matrix(robot_from_paper(cell)[:3, :3])
    along = frame.inv().apply(turned[on].apply((0.0, 0.0, -1.0)))  # the tool's z points into the paper
    assert along == pytest.approx(leans, abs=2e-5)
    # The turn from upright is the shortest one, which equals the angle between the axes.
    upright = frame * Rotation.from_euler("x", 180, degrees=True) * Rotation.from_euler("z", 30, degrees=True)
    tilts_deg = np.degrees(np.arccos(np.clip(leans[:, 2], -1, 1)))
    assert np.degrees((turned[on] * upright.inv()).magnitude()) == pytest.approx(tilts_deg, abs=2e-3)
    assert np.degrees((turned[[0, -1]] * upright.inv()).magnitude()).max() < 1e-3  # upright while it travels


@pytest.mark.skipif(not find_spec("rapidchecker"), reason="rapidchecker is not installed")
@pytest.mark.parametrize("broken", [None, (", num q4)", ", q4)")])
def test_rapidchecker_accepts_a_tilted_program(tmp_path, broken):
    text = text_for(plan(TILTED), brushsvg.find_cell("irb120"))
    (tmp_path / "p.mod").write_text(text.replace(*broken, 1) if broken else text, newline="")
    (tmp_path / "rapidchecker.toml").write_text("indentation_check = false\n")
    done = subprocess.run([sys.executable, "-m", "rapidchecker", "p.mod"], cwd=tmp_path, capture_output=True)
    assert (done.returncode == 0) == (broken is None), done.stdout


@pytest.mark.skipif(not find_spec("xarm"), reason="the vendor's SDK is not installed")
def test_an_xarm_receives_the_lines_as_written():
    """An xArm receives the lines as written.

    The test runs the program and binds every call to the signature of the vendor's SDK.
    """
    from xarm.wrapper import XArmAPI

    reported = []

    class Arm:
        def __init__(self, address):
            assert address == "here"

        def __getattr__(self, name):
            def call(*given, **named):
                bound = inspect.signature(getattr(XArmAPI, name)).bind(self, *given, **named).arguments
                reported.append((name, bound))
                return (0, [0.0, 0.0, 300.0, 180.0, 0.0, 0.0]) if name == "get_position" else 0

            return call

    cell = anyhow("xarm6")
    text = text_for(plan(TILTED), cell)
    modules = {"sys": SimpleNamespace(argv=["p.py", "here"]), "xarm.wrapper": SimpleNamespace(XArmAPI=Arm)}
    exec(text, {"__builtins__": {"__import__": lambda name, *_: modules[name]}})
    moves = [given for name, given in reported if name == "set_position" and "x" in given]
    rows = [[move[key] for key in ("x", "y", "z", "roll", "pitch", "yaw")] for move in moves]
    tips, turned = COMMANDED["xarm6"](text, cell)
    assert np.array(rows)[:, :3] == pytest.approx(tips)
    again = Rotation.from_euler("xyz", np.array(rows)[:, 3:], degrees=True)
    assert (again.inv() * turned).magnitude().max() < 1e-9
    assert len(rows) > 15


def test_a_pass_with_an_invalid_position_is_returned_unchanged():
    """A pass with an invalid position is returned unchanged.

    The simulation of the plan refuses it.
    """
    (a_pass,) = plan(TILTED, poses=np.where(np.arange(15).reshape(5, 3) == 6, np.nan, POSES)).passes
    assert split_turning_moves(a_pass) is a_pass


def test_robot_poses_include_the_poses_of_the_plan():
    of = plan(TILTED)
    steps = split_turning_moves(of.passes[0])
    for pose, axis in zip(of.passes[0].poses_mm, of.passes[0].tool_axes, strict=True):
        away = np.linalg.norm(steps.poses_mm - pose, axis=1) + np.linalg.norm(steps.tool_axes - axis, axis=1)
        assert away.min() < 1e-9


def test_the_tip_stays_in_place_while_the_tool_tilts_and_lands():
    poses = [(20.0, 30.0, 0.0), (20.0, 30.0, -4.0), (40.0, 30.0, -4.0)]
    steps = split_turning_moves(_core.Pass("s", poses, 5.0, tool_axes=axes(0, 20, 20)))
    down = np.asarray(steps.poses_mm)[np.asarray(steps.poses_mm)[:, 0] < 20.1]
    assert len(down) > 8 and np.abs(down[:, :2] - (20.0, 30.0)).max() < 1e-9


def test_a_turn_of_less_than_a_degree_is_slowed():
    cell = brushsvg.find_cell("ur5e")
    speed_mm_s = limit_turning_speed(20.0, 0.05, 0.5, cell)
    assert speed_mm_s == pytest.approx(0.05 * cell.tool.turn_deg_s / 0.5)
    assert speed_mm_s < 20.0


@pytest.mark.parametrize("seed", range(5))
def test_even_turning_between_poses_paints_the_predicted_mark(seed):
    """A robot that turns evenly between poses paints what the simulation predicts.

    In the simulation, the point where the brush's axis meets the paper moves straight between poses, and the
    lean changes evenly. A robot moves the tip straight and turns the tool evenly about one axis.
    """
    random = np.random.default_rng(seed)
    poses = np.column_stack([np.cumsum(random.uniform(5, 15, 6)), random.uniform(10, 40, 6), -random.uniform(0, 6, 6)])
    poses[[0, -1], 2] = 0.0
    held = axes(*random.uniform(0, 25, 6), towards_deg=random.uniform(0, 360, 6))
    one = _core.Pass("s", poses, 5.0, tool_axes=held)
    steps = split_turning_moves(one)
    on = lambda tips, leans: tips[:, :2] - leans * tips[:, 2:]  # noqa: E731
    leans = held[:, :2] / held[:, 2:]
    places, row = on(poses, leans), 0
    upright = Rotation.from_euler("x", 180, degrees=True)
    down = np.asarray(steps.tool_axes)
    turned = []
    for axis in down:
        across = np.cross((0, 0, 1), axis)
        size = np.linalg.norm(across)
        turned.append(Rotation.from_rotvec(across / max(size, 1e-12) * np.arctan2(size, axis[2])) * upright)
    turned = Rotation.concatenate(turned)
    for k in range(len(down) - 1):
        if np.linalg.norm(steps.poses_mm[k] - poses[row + 1]) < 1e-9:
            row += 1
        middle = Slerp([0, 1], turned[[k, k + 1]])(0.5).apply((0, 0, -1.0))
        tip = (steps.poses_mm[k] + steps.poses_mm[k + 1]) / 2
        lean = middle[:2] / middle[2]
        place = on(tip[None], lean[None])[0]
        # Distance from the straight path of the axis on the paper, and from the lean that belongs to this
        # position.
        way = places[row + 1] - places[row]
        share = (place - places[row]) @ way / (way @ way)
        assert np.linalg.norm(place - places[row] - share * way) < 0.006
        target = leans[row] + share * (leans[row + 1] - leans[row])
        assert np.degrees(np.linalg.norm(lean - target)) < 0.03


def test_rotations_agree_with_scipy():
    random = np.random.default_rng(5)
    for turned in Rotation.random(200, random_state=1):
        assert of_quaternion(np.roll(turned.as_quat(), 1)) == pytest.approx(turned.as_matrix(), abs=1e-12)
        assert of_rotation_vector(turned.as_rotvec()) == pytest.approx(turned.as_matrix(), abs=1e-12)
        axis = random.normal(size=3)
        axis /= np.linalg.norm(axis)
        held = turned_to(axis, turned.as_matrix())
        assert -held[:, 2] == pytest.approx(axis, abs=1e-9)
        turn = Rotation.from_matrix(held) * turned.inv()
        apart = np.arccos(np.clip(-turned.as_matrix()[:, 2] @ axis, -1, 1))
        assert turn.magnitude() == pytest.approx(apart, abs=1e-7)  # the turn is the shortest one to this axis
    assert of_rotation_vector((0, 0, 0)) == pytest.approx(np.eye(3))


@pytest.mark.parametrize("name", TILTING)
def test_upright_rows_are_written_as_before(name):
    cell = brushsvg.find_cell(name)
    upright = axes(0, 0, 0, 0, 0)
    none = np.zeros((0, 3))
    assert text_for(plan(upright, none), cell) == text_for(plan(none, none), cell)
    before, both = text_for(plan(none, none), cell), text_for(plan(none, TILTED), cell)
    first = lambda text: text[text.index("stroke 1 of 2") : text.index("stroke 2 of 2")]  # noqa: E731
    assert first(both) == first(before)
    lines = both[both.index("stroke 2 of 2") :].splitlines()
    asbefore = before[before.index("stroke 2 of 2") :].splitlines()
    assert lines[1] == asbefore[1]  # the travel move, and the landing of a first pose that is upright
    assert lines[2:4] == asbefore[2:4]


# Checked ----------------------------------------------------------------------------------------------------


def written(folder, name, of, cell=None):
    """Write a plan.json; return its path, the program's path and the --cell option."""
    given, made = folder / "a.json", folder / f"a{SUFFIXES[name]}"
    given.write_text(_core.write_plan(of))
    words = ["--cell", name]
    if cell is not None:
        (folder / "cell.toml").write_text(write_cell(cell))
        words = ["--cell", folder / "cell.toml"]
    return given, made, words


def read_leaning():
    """Return a cell with many machine errors.

    The paper leans, rises and has a height map, and the tool gives way under load.
    """
    machine = Machine(
        lean_mm_per_mm=(0.1, -0.05),
        height_mm=0.2,
        tilt_mm_per_mm=(0.002, -0.001),
        map_mm=((0, 0, 0.1), (100, 0, 0.0), (0, 60, -0.1), (100, 60, 0.2)),
    )
    return replace(anyhow(), machine=machine)


@pytest.mark.parametrize("name", TILTING)
@pytest.mark.parametrize("of_cell", [lambda name: None, anyhow])
def test_check_accepts_tilted_programs(name, of_cell, tmp_path, capsys):
    given, made, words = written(tmp_path, name, plan(np.zeros((0, 3)), TILTED), of_cell(name))
    assert in_json(capsys, "convert", given, "-o", made, *words)[0] == 0
    assert in_json(capsys, "check", made, given, *words)[0] == 0
    assert in_json(capsys, "check", made, *words)[0] == 0


@sample("seed", range(2 * len(TILTING)), keep=5)
def test_check_accepts_random_tilts(seed, tmp_path, capsys):
    """Check accepts random tilts.

    Strokes, tilts, papers, tools and machine errors are all random. Strokes that turn too fast are left out.
    """
    random, name = np.random.default_rng(seed), TILTING[seed % len(TILTING)]
    cell = anyhow(name) if seed < len(TILTING) else replace(brushsvg.find_cell(name), arm=None)
    tool = replace(cell.tool, spin_deg=float(random.uniform(-180, 180)), turn_deg_s=300.0)
    machine = Machine(lean_mm_per_mm=tuple(random.uniform(-0.2, 0.2, 2).tolist()), scale=(1.003, 0.998), skew=0.002)
    cell = replace(cell, tool=tool, machine=machine, workspace=replace(cell.workspace, box_mm=(), reach_mm=()))
    passes = []
    for k in range(3):
        n = int(random.integers(3, 8))
        poses = np.column_stack([random.uniform(20, 80, n), random.uniform(15, 45, n), -random.uniform(0.2, 6, n)])
        poses[[0, -1], 2] *= k > 0  # the other strokes are set down and lifted on the spot
        held = axes(*random.uniform(0, 29.5, n), towards_deg=random.uniform(0, 360, n))
        passes.append(_core.Pass(f"s{k}", poses, float(random.uniform(3, 25)), tool_axes=np.round(held, 3)))
    given, made, words = written(tmp_path, name, _core.Plan("round-6", "", (100, 60), passes), cell)
    status, _, reported = in_json(capsys, "convert", given, "-o", made, *words)
    if status == 0:
        assert in_json(capsys, "check", made, given, *words)[0] == 0
        assert in_json(capsys, "check", made, *words)[0] == 0
    assert status == 0 or is_reported(reported, "tool-turns-too-fast")


def test_check_accepts_tilted_programs_on_tilted_mapped_paper(tmp_path, capsys):
    given, made, words = written(tmp_path, "ur5e", plan(TILTED), read_leaning())
    assert in_json(capsys, "convert", given, "-o", made, *words)[0] == 0
    assert in_json(capsys, "check", made, given, *words)[0] == 0


def test_check_simulates_the_tilted_mark(tmp_path, capsys):
    """Check simulates the tilted mark.

    Its picture agrees with the prediction for the tilted brush, not for an upright brush.
    """
    of = plan(axes(*[25] * 5), poses=[[20, 20, 0], [30, 20, -4], [60, 20, -4], [75, 35, -3], [75, 35, 0]])
    given, made, words = written(tmp_path, "ur5e", of)
    rings = {}
    for name, tool_axes in (("tilted", of.passes[0].tool_axes), ("upright", np.zeros((0, 3)))):
        marks = brushsvg.simulate(plan(tool_axes, poses=of.passes[0].poses_mm), BRUSH)
        brushsvg.trace_outlines(marks, BRUSH)
        rings[name] = marks.outline_mm
    in_json(capsys, "convert", given, "-o", made, *words)
    cell = brushsvg.find_cell("ur5e")
    ran = played(read_program(made.read_text(), ".script", cell), BRUSH, cell, (100, 60))
    _core.trace_outlines(ran.marks, BRUSH)
    assert _core.overlap(ran.marks.outline_mm, rings["tilted"]) > 0.995
    assert _core.overlap(ran.marks.outline_mm, rings["upright"]) < 0.97


def test_a_program_with_another_tilt_is_refused(tmp_path, capsys):
    given, made, words = written(tmp_path, "ur5e", plan(TILTED))
    in_json(capsys, "convert", given, "-o", made, *words)
    for other in (np.zeros((0, 3)), axes(0, 9, 9, 20, 20, towards_deg=np.array([0, 40, 40, 130, 130]))):
        given.write_text(_core.write_plan(plan(other)))
        status, _, reported = in_json(capsys, "check", made, given, *words)
        assert status == 1
        assert is_reported(reported, "held-otherwise") or is_reported(reported, "path-elsewhere")
    given.write_text(_core.write_plan(plan(axes(0, 8.3, 8.3, 20, 20, towards_deg=np.array([0, 40, 40, 130, 130])))))
    assert in_json(capsys, "check", made, given, *words)[0] == 0  # the change is too small to show in a mark


# For languages that give a position with a rotation: the pattern of its numbers, and the conversions from and
# to scipy's rotations.
IN_DEGREES = (
    lambda xyz: Rotation.from_euler("xyz", xyz, degrees=True),
    lambda turned: turned.as_euler("xyz", degrees=True),
)
TURNS = {
    "ur5e": (r"(?<=\(tilted\()[^)]*", Rotation.from_rotvec, Rotation.as_rotvec),
    "irb120": (
        r"(?<=MoveL tilted\()[^)]*",
        lambda wxyz: Rotation.from_quat([*wxyz[1:], wxyz[0]]),
        lambda turned: np.roll(turned.as_quat(), 1),
    ),
    "kr6-r900": (
        r"(?<=LIN \{)X [^}]*",
        lambda abc: Rotation.from_euler("ZYX", abc, degrees=True),
        lambda turned: turned.as_euler("ZYX", degrees=True),
    ),
    "cr5": (r"(?<=MovL\(tilted\()[^)]*", *IN_DEGREES),
    "m0609": (
        r"(?<=movel\(tilted\()[^)]*",
        lambda abc: Rotation.from_euler("ZYZ", abc, degrees=True),
        lambda turned: turned.as_euler("ZYZ", degrees=True),
    ),
    "xarm6": (r"(?m)(?<=^lean\()(?:[^,]*, ){5}[^,]*", *IN_DEGREES),
    "jaka-zu3": (r"(?<=to = \[)[^]]*", *IN_DEGREES),
    "lrmate200id": (r"(?<=\t)X = [^}]*", *IN_DEGREES),
    "fr3": (r"(?<=\d,)[^,]*(?:,[^,]*){6}(?=,[^,]*,(?:pose|way)\n)", Rotation.from_quat, Rotation.as_quat),
}


@sample("name", TILTING, keep=3)
def test_damaged_directions_are_refused(name, tmp_path, capsys):
    """Check refuses programs with one damaged direction.

    The direction is turned by a degree or more about any axis, including the tool's own axis. In other cases,
    its numbers are exchanged or negated. There are a hundred cases for UR and thirty for each other language.
    """
    given, made, words = written(tmp_path, name, plan(np.zeros((0, 3)), TILTED))
    in_json(capsys, "convert", given, "-o", made, *words)
    text = made.read_text()
    pattern, of, to = TURNS[name]
    spots = [*re.finditer(pattern, text)]
    random = np.random.default_rng(3)
    allowed = []
    for number in range(100 if name == "ur5e" else 30):
        spot = spots[random.integers(len(spots))]
        values = [float(each) for each in re.findall(N, spot[0])]
        before, kind = of(values[3:]), number % 5
        if kind == 0:
            about = random.normal(size=3)
            by = Rotation.from_rotvec(about / np.linalg.norm(about) * np.radians(random.uniform(1, 40)))
            turn = list(to(before * by))
        elif kind == 1:  # about the brush's own axis
            turn = list(to(before * Rotation.from_euler("z", random.uniform(1, 90), degrees=True)))
        elif kind == 2:
            turn = values[3:]
            turn[random.integers(len(turn))] += (
                random.choice([-1, 1]) * random.uniform(0.04, 0.5) * (60 if len(turn) == 3 and name != "ur5e" else 1)
            )
        elif kind == 3:
            turn = [*values[3:-1], -values[-1]]
        else:
            turn = [*values[4:], values[3]]
        if np.degrees((before.inv() * of(turn)).magnitude()) < 0.6:
            continue
        numbers = iter([*values[:3], *turn])
        reported = re.sub(N, lambda _, left=numbers: f"{next(left):.9f}", spot[0])
        made.write_text(text[: spot.start()] + reported + text[spot.end() :])
        # Turned about its own axis, the brush paints an equal mark, but the program is not one of ours.
        if in_json(capsys, "check", made, *([] if kind == 1 else [given]), *words)[0] == 0:
            allowed.append((number, spot[0], reported))
    assert not allowed
    made.write_text(text)
    assert in_json(capsys, "check", made, given, *words)[0] == 0


@pytest.mark.parametrize("name", TILTING)
def test_a_tilted_program_needs_the_tilt_in_its_header(name, tmp_path, capsys):
    given, made, words = written(tmp_path, name, plan(TILTED))
    in_json(capsys, "convert", given, "-o", made, *words)
    # FANUC remarks are short and continue on the next line.
    line = r"\n[^\n]*tilt: the brush is held as each(?: ;\n : !\+)? move says[^\n]*"
    text, count = re.subn(line, "", made.read_text(), count=1)
    assert count == 1
    made.write_text(text)
    status, _, reported = in_json(capsys, "check", made, given, *words)
    assert status == 1
    assert is_reported(reported, "program-changed" if name == "ur5e" else "tool-turned")


@pytest.mark.parametrize("about", ["x", "y", "z"])
def test_damaged_rows_between_poses_are_refused(about, tmp_path, capsys):
    """Check refuses a damaged row between two poses of a trajectory.

    The row is turned by 3 degrees about the brush or to the side, with its tip in place.
    """
    given, made, words = written(tmp_path, "fr3", plan(TILTED))
    in_json(capsys, "convert", given, "-o", made, *words)
    text = made.read_text()
    ways = [*re.finditer(r"(?m)^(\d[^,]*,(?:[^,]*,){3})([^,]*,[^,]*,[^,]*,[^,]*)(,[^,]*,way)$", text)]
    cell = brushsvg.find_cell("fr3")
    way = ways[len(ways) // 2]
    before = Rotation.from_quat([float(each) for each in way[2].split(",")])
    turned = before * Rotation.from_euler(about, 3, degrees=True)
    tip = np.array([float(each) for each in way[1].split(",")[1:4]]) + before.apply(cell.tool.tcp_mm) / 1e3
    place = tip - turned.apply(cell.tool.tcp_mm) / 1e3  # turned about its tip
    reported = ",".join(f"{value:.9f}" for value in [*place, *turned.as_quat()])
    made.write_text(text[: way.start()] + way[1].split(",")[0] + "," + reported + way[3] + text[way.end() :])
    status, _, messages = in_json(capsys, "check", made, given, *words)
    assert status == 1
    assert is_reported(messages, "line-unread")


def test_a_serialized_trajectory_has_the_rotations_of_the_table(tmp_path):
    cell = brushsvg.find_cell("fr3")
    made = make_checked_program(split_into_loads(plan(TILTED), BRUSH, cell), BRUSH, cell).allowed()
    table, message = (made_of(program_in_robot_frame(made)) for made_of in (ros2.csv, ros2.cdr))
    rows = [line.split(",") for line in "".join(table).splitlines() if line[0].isdigit()]
    data = b"".join(message)
    points = np.frombuffer(data[-len(rows) * ros2.POINT_DTYPE.itemsize :], dtype=ros2.POINT_DTYPE)
    reported = np.array([[float(each) for each in row[1:8]] for row in rows])
    assert np.hstack([points["place_m"], points["turn_xyzw"]]) == pytest.approx(reported, abs=1e-9)
    assert len(np.unique(points["turn_xyzw"], axis=0)) > 10


def test_changed_positions_missing_tilts_and_lost_lines_are_refused(tmp_path, capsys):
    given, made, words = written(tmp_path, "ur5e", plan(TILTED))
    in_json(capsys, "convert", given, "-o", made, *words)
    text = made.read_text()
    lines = text.splitlines(keepends=True)
    tilted = [k for k, line in enumerate(lines) if "(tilted(" in line]
    damaged, own = [], 0
    for k in tilted:
        upright = re.sub(r"tilted\((\S+, \S+, [^,]+), [^)]*\)", r"on_paper(\1)", lines[k])
        damaged.append([*lines[:k], upright, *lines[k + 1 :]])
        place = [1e3 * float(each) for each in re.search(r"tilted\((\S+), (\S+), (\S+),", lines[k]).groups()]
        # The other positions are between poses.
        if np.linalg.norm(np.subtract(POSES[:-1], place), axis=1).min() < 1e-6:
            damaged.append([*lines[:k], *lines[k + 1 :]])
            own += 1
        damaged += [[*lines[:k], lines[k], lines[k - 1], *lines[k + 1 :]]]
    assert own == 3
    damaged.append([line.replace("p[x, y, z, rx, ry, rz]", "p[x, y, z, ry, rx, rz]") for line in lines])
    for each in damaged:
        made.write_text("".join(each))
        assert in_json(capsys, "check", made, given, *words)[0] == 1, set(each) ^ set(lines)


# Limits -----------------------------------------------------------------------------------------------------


def test_a_tilt_beyond_the_cells_limit_is_refused():
    cell = brushsvg.find_cell("ur5e")
    cell = replace(cell, tool=replace(cell.tool, tilt_limit_deg=15.0))
    with refused("tilt-out-of-range 20 15 ur5e", "s0"):
        text_for(plan(TILTED), cell)
    text_for(plan(axes(0, 15, 15, 15, 15)), cell)


@pytest.mark.parametrize(("tilt_deg", "count"), [(15.0005, 0), (15.0015, 1)])
def test_a_tilt_may_exceed_the_limit_only_by_rounding(tilt_deg, count):
    cell = brushsvg.find_cell("ur5e")
    cell = replace(cell, tool=replace(cell.tool, tilt_limit_deg=15.0, turn_deg_s=360.0))
    (a_pass,) = plan(axes(0, 5, 10, tilt_deg, 10)).passes
    assert len(check_tilt_limits(a_pass, cell)) == count


def test_a_tool_that_would_turn_too_fast_is_refused():
    """A tool that would turn too fast is refused.

    The tool turns from 8 to 20 degrees over 21 mm at 20 mm/s.
    """
    cell = brushsvg.find_cell("ur5e")
    text_for(plan(TILTED), cell)
    cell = replace(cell, tool=replace(cell.tool, turn_deg_s=15.0))
    with refused("tool-turns-too-fast 15 ur5e", "s0"):
        text_for(plan(TILTED), cell)
    text_for(plan(TILTED, speed=10.0), cell)


@pytest.mark.parametrize("name", TILTING)
def test_check_accepts_turns_and_tilts_exactly_at_the_limit(name, tmp_path, capsys):
    """Check accepts a program whose turns and tilts are exactly at the limit.

    Rounded positions shorten some paths, and rounded directions increase some tilts.
    """
    poses = [[20, 20, 0], [22, 21, -2], [25, 20, -2.5], [29, 20.5, -1.5], [33, 20, 0]]
    of = plan(axes(0, 12, 20, 30, 30, towards_deg=np.array([0, 10, 50, 60, 90])), poses=poses, speed=10.0)
    cell = replace(brushsvg.find_cell(name), arm=None)
    (a_pass,) = split_into_loads(of, BRUSH, cell).loads
    least, most = 1.0, 360.0
    for _ in range(40):
        middle = (least + most) / 2
        is_too_fast = check_tilt_limits(a_pass, replace(cell, tool=replace(cell.tool, turn_deg_s=middle)))
        least, most = (middle, most) if is_too_fast else (least, middle)
    assert 20 < most < 300
    cell = replace(cell, tool=replace(cell.tool, turn_deg_s=most))
    given, made, words = written(tmp_path, name, of, cell)
    assert in_json(capsys, "convert", given, "-o", made, *words)[0] == 0
    assert in_json(capsys, "check", made, given, *words)[0] == 0
    assert in_json(capsys, "check", made, *words)[0] == 0


def test_a_turn_in_place_is_refused():
    poses = [[20, 20, 0], [30, 20, -2], [30, 20, -2], [60, 20, 0]]
    with refused("tool-turns-too-fast", "s0"):
        text_for(plan(axes(0, 0, 10, 10), poses=poses), brushsvg.find_cell("ur5e"))


def test_a_repeated_position_is_not_a_turn():
    poses = [[20, 20, 0], [30, 20, -2], [30, 20, -2], [60, 20, 0]]
    (a_pass,) = plan(axes(10, 10, 10, 10), poses=poses).passes
    assert check_tilt_limits(a_pass, brushsvg.find_cell("ur5e")) == []


def test_turns_in_the_air_respect_the_turning_speed():
    cell = brushsvg.find_cell("ur5e")
    robot = run(text_for(plan(axes(*[30] * 5)), cell))
    turns = []
    for (_, (before,), *_), (_, (after,), speed, _) in pairwise(robot.events):
        turn = (Rotation.from_rotvec(before[3:]).inv() * Rotation.from_rotvec(after[3:])).magnitude()
        way = np.linalg.norm(np.subtract(after[:3], before[:3]))
        if np.degrees(turn) > 1e-3:
            turns.append(np.degrees(turn) * speed / way)
    assert len(turns) == 2  # on the way down to the clearance, and on the way up from it
    assert max(turns) <= cell.tool.turn_deg_s * 1.001
    assert max(turns) > cell.tool.turn_deg_s * 0.9


def test_corners_of_a_tilted_stroke_are_cut_as_far_as_the_mark_allows(tmp_path, capsys):
    """Corners of a tilted stroke are cut as far as the mark allows.

    The joints are cut like the joints of an upright stroke. A cut that shifts the mark is refused.
    """
    cell = brushsvg.find_cell("ur5e")
    wide = replace(cell, blending=replace(cell.blending, tolerance_mm=5.0, radius_mm=20.0))
    poses = [[20, 20, 0], [30, 20, -2], [60, 20, -2], [60, 50, -2], [60, 50, 0]]
    of = plan(axes(*[20] * 5), poses=poses)
    loads = split_into_loads(of, BRUSH, wide)
    found = check_job(loads, BRUSH, brushsvg.simulate(of, BRUSH), wide, 0.05).problems
    assert any(agrees(each, "shifted-by-blends", "s0") for each in found)
    assert not check_job(loads, BRUSH, brushsvg.simulate(of, BRUSH), cell, 0.05).problems


@pytest.mark.parametrize(
    ("poses", "held", "expected"),
    [
        (POSES, axes(0, 8, 8, 95, 20), "tool-axis-invalid s0 3 95 30"),
        (POSES, axes(0, 8, 8, 20), "sizes-differ s0 4 5"),
        (POSES, axes(0, 8, 8, 20, 20) * [[1], [1], [0], [1], [1]], "tool-axis-invalid s0 2 0"),
        (POSES, axes(0, 8, 8, np.nan, 20), "tool-axis-invalid s0 3"),
        (np.multiply(POSES, (1, np.inf, 1)), axes(0, 8, 8, 20, 20), "not-finite"),
    ],
)
def test_an_invalid_tilt_is_refused_before_use(poses, held, expected, tmp_path):
    with np.errstate(all="ignore"), refused(expected):
        brushsvg.write_program(tmp_path / "a.script", plan(held, poses=poses), BRUSH, cell=brushsvg.find_cell("ur5e"))
    with np.errstate(all="ignore"):
        split_into_loads(
            plan(held, poses=poses), BRUSH, brushsvg.find_cell("ur5e")
        )  # this call must not raise an exception


# Joints of an arm -------------------------------------------------------------------------------------------


def arm_problems(of, cell):
    made = make_checked_program(split_into_loads(of, BRUSH, cell), BRUSH, cell).made
    return find_moves_out_of_arm(made, (100, 60))


@pytest.mark.arm
def test_the_joint_check_uses_the_tilt_of_the_brush():
    """The check of an arm's joints uses the tilt of the brush.

    At the edge of its reach, a UR5e can paint with the handle towards itself. It cannot paint with the handle
    leaned away.
    """
    cell = brushsvg.find_cell("ur5e")
    cell = replace(cell, paper=Paper((-50.0, -870.0, 20.0)), workspace=replace(cell.workspace, box_mm=(), reach_mm=()))
    for far in np.arange(-870.0, -990.0, -10.0):
        there = replace(cell, paper=Paper((-50.0, far, 20.0)))
        if arm_problems(plan(axes(*[25] * 5, towards_deg=270)), there):
            break
    else:
        pytest.fail("it reaches everywhere")
    assert not arm_problems(plan(axes(*[25] * 5, towards_deg=90)), there)


@pytest.mark.arm
def test_a_joint_that_turns_too_fast_because_of_the_tilt_is_refused():
    cell = brushsvg.find_cell("ur5e")
    slow = replace(cell, arm=replace(cell.arm, speeds_deg_s=(9.0,) * 6), speeds=replace(cell.speeds, travel_mm_s=20.0))
    upright, tilted = plan(np.zeros((0, 3))), plan(TILTED)
    assert not arm_problems(upright, slow)
    assert any(each.code == "joint-too-fast" for each in arm_problems(tilted, slow))


# Warned beforehand --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("words", [(), ("--cell", "ur5e")])
def test_predict_warns_of_paint_off_the_sheet(words, tmp_path, capsys):
    given = tmp_path / "a.json"
    poses = np.add(POSES, (40, 0, 0))
    given.write_text(_core.write_plan(plan(axes(*[20] * 5), poses=poses)))
    status, _, reported = in_json(capsys, "preview", given, "-o", tmp_path / "b.svg", *words)
    assert status == 0
    assert is_reported(reported, "mark-off-sheet right", "s0")


def test_the_cell_sets_tilt_limit_and_turning_speed(tmp_path, capsys):
    """The cell file sets the tilt limit and the turning speed.

    They are keys of the table [tool].
    """
    cell = brushsvg.find_cell("ur5e")
    text = write_cell(replace(cell, tool=replace(cell.tool, tilt_limit_deg=12.0, turn_deg_s=20.0)))
    assert "tilt_limit_deg = 12.0" in text.split("[tool]")[1]
    (tmp_path / "cell.toml").write_text(text.replace("tilt_limit_deg = 12.0", "tilt_limit_deg = 31.0"))
    given = tmp_path / "a.json"
    given.write_text(json.dumps(json.loads(_core.write_plan(plan(TILTED)))))
    status, _, reported = in_json(
        capsys, "convert", given, "-o", tmp_path / "a.script", "--cell", tmp_path / "cell.toml"
    )
    assert status == 1
    assert is_reported(reported, "out-of-range 31 30")


def test_a_visibly_different_tool_axis_is_a_change():
    like = _ActComparison(brushsvg.find_cell("ur5e"), upright=np.eye(3))

    def turned(deg):
        return tuple(Rotation.from_euler("z", deg, degrees=True).as_matrix().ravel())

    assert like.is_same_rotation(turned(0.4), ()) and not like.is_same_rotation(turned(0.7), ())


def test_a_different_paper_tilt_is_a_change():
    like = _ActComparison(brushsvg.find_cell("ur5e"))
    ours = Act(1, "text", "paper = p[0.1, 0.2, 0.3, 0.000000, 0.000000, 0.000000]")
    hardly, more = (
        ours._replace(text=ours.text.replace("0.3, 0.000000", f"0.3, {a}")) for a in ("0.000008", "0.000015")
    )
    assert like.is_same(hardly, ours) and not like.is_same(more, ours)
