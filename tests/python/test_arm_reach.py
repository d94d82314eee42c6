"""Jobs that an arm cannot do are refused with the reason and a place that works."""

from __future__ import annotations

import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from arm_judge import judge_of
from diagnostics import agrees, are_reported, gives, in_json, is_reported
from sampling import sample
from test_arm import DESCRIBED, about, placed

import brushsvg
from brushsvg import _core
from brushsvg.cli import main
from brushsvg.machine import preflight
from brushsvg.machine.arm import follow_joints, place
from brushsvg.machine.arm.follow_joints import flange_at, follow, joint_rates, lowest_joint_mm
from brushsvg.machine.arm.inverse_kinematics import joint_frames_of, joints_of
from brushsvg.machine.cells.cell import Paper, robot_from_paper
from brushsvg.machine.cells.cell_file import find_cell, write_cell
from brushsvg.machine.frames import transform_points
from brushsvg.machine.job_program import unchecked_program
from brushsvg.machine.paint_reload import split_into_loads
from brushsvg.machine.setup_programs import make_sheet_program
from brushsvg.model.library import find_brush

pytestmark = pytest.mark.arm

BRUSH = find_brush("round-6")
ALONG, ACROSS = ((10, 20), (90, 20)), ((50, 5), (50, 55))
UP_FRONT = (90.0, -36.0, 126.0, 0.0, 5.0, 0.0)  # a KR 6 with its elbow up and its hand hanging down

# cell, the paper's corner in the robot's frame, the paper's tilt, stroke, posture, speeds, expected code
JOBS = [
    ("ur5e", (-50, -980, 20), (), ALONG, (), {}, "arm-out-of-reach"),
    ("ur5e", (-50, -150, 20), (), ALONG, (), {}, "arm-out-of-reach"),
    ("ur3e", (-50, -20, 20), (), ALONG, (), {}, "arm-out-of-reach"),
    ("irb120", (-50, -650, 20), (), ALONG, (), {}, "arm-out-of-reach"),
    ("jaka-zu3", (-50, -640, 20), (), ALONG, (), {}, "arm-out-of-reach"),
    ("xarm6", (-50, -800, 20), (), ALONG, (), {}, "arm-out-of-reach"),
    ("cr5", (-50, -950, 20), (), ALONG, (), {}, "arm-out-of-reach"),
    ("irb120", (-50, -180, 20), (), ALONG, (), {}, "joint-limit"),
    ("irb120", (-450, -30, 20), (), ACROSS, (), {}, "joint-limit"),
    ("kr6-r900", (-50, -450, 20), (), ACROSS, UP_FRONT, {}, "wrist-flip"),
    ("kr6-r900", (-50, -450, 20), (0, 1, 0), ACROSS, UP_FRONT, {}, "wrist-flip"),
    ("kr6-r900", (-50, -450, 20), (0, 5, 0), ACROSS, UP_FRONT, {"travel_mm_s": 1000.0}, "joint-too-fast"),
]


def job(name, corner, leans, line, posture, speeds):
    cell = find_cell(name)
    paper = replace(cell.paper, origin_mm=corner, rotation_deg=leans or (0, 0, 0))
    cell = replace(cell, paper=paper, workspace=replace(cell.workspace, box_mm=(), reach_mm=()))
    cell = replace(cell, arm=replace(cell.arm, posture_deg=posture), speeds=replace(cell.speeds, **speeds))
    return cell, plan_of(line)


def plan_of(line):
    start, end = line
    poses = [[*start, 0], [*start, -2], [*end, -2], [*end, 0]]
    return _core.Plan("round-6", "", (100, 60), [_core.Pass("line", poses, 15.0)])


def look(cell, plan):
    return preflight.check_job(split_into_loads(plan, BRUSH, cell), BRUSH, _core.simulate(plan, BRUSH), cell, 0.05)


@sample("which", range(len(JOBS)), keep=4)
def test_a_job_out_of_reach_is_refused_and_the_suggested_paper_position_works(which):
    *given, code = JOBS[which]
    cell, plan = job(*given)
    (problem,) = look(cell, plan).problems
    assert (problem.where, problem.code) == ("line", code)
    x, y = map(float, re.search(r"x (-?[\d.]+), y (-?[\d.]+) mm", problem.sentence).groups())
    (x0, y0), (x1, y1) = given[3]
    assert min(x0, x1) <= x <= max(x0, x1) and min(y0, y1) <= y <= max(y0, y1)
    dx, dy = map(float, re.search(r"x ([+-]\d+), y ([+-]\d+) mm", problem.advice).groups())
    moved = tuple(np.add(cell.paper.origin_mm, (dx, dy, 0)).tolist())
    there = replace(cell, paper=replace(cell.paper, origin_mm=moved))
    assert look(there, plan).problems == []
    # The other library confirms the answer for the suggested place.
    frame, judge = robot_from_paper(cell), judge_of(cell.arm)
    if judge is not None and code == "arm-out-of-reach":
        for height in (0.0, cell.heights.safe_mm):
            robot_mm = frame @ (x, y, height, 1)
            if not len(judge(flange_at(cell, frame, robot_mm[:3]))):
                break
        else:
            pytest.fail("EAIK reaches it, touching and above")
    if judge is not None and code == "joint-limit":
        low, high = np.radians(cell.arm.limits_deg).T
        robot_mm = (frame @ (x, y, cell.heights.safe_mm, 1))[:3]
        found = judge(flange_at(cell, frame, robot_mm))
        wrapped = np.stack([found + turn * 2 * np.pi for turn in (-1, 0, 1)])
        assert not (((wrapped >= low) & (wrapped <= high)).any(axis=0)).all(axis=1).any()


FEASIBLE = ("ur5e", (-50, -500, 20), (), ALONG, (), {})
BEHIND = ("irb120", (-400, 60, 20), (), ((10, 55), (90, 5)), (), {})


@pytest.mark.parametrize(
    ("given", "is_feasible"),
    [(FEASIBLE, True), (BEHIND, False), *((JOBS[number][:-1], False) for number in (9, 10, 11))],
)
def test_the_arm_check_does_not_depend_on_the_number_of_places_solved_at_once(given, is_feasible, monkeypatch):
    """Places are solved many at once. A problem may be at the first of them, in their middle or at the last."""
    cell, plan = job(*given)
    made, joints = unchecked_program(split_into_loads(plan, BRUSH, cell), BRUSH, cell), joints_of(cell.arm)
    continue_solutions, together = follow_joints._continue_solutions, follow_joints._advance_together
    chunk, stops = [], set()

    def note_stop(count):
        if count < len(chunk) > 2:
            stops.add({0: "first", len(chunk) - 1: "last"}.get(count, "middle"))
        return count

    def watched_continue(placed, postures, places):
        chunk[:] = places
        found = continue_solutions(placed, postures, places)
        if found is None and any(posture.failure is None for posture in postures):
            note_stop(0)
        return found

    def watched_together(*given):
        return note_stop(together(*given))

    monkeypatch.setattr(follow_joints, "_advance_together", lambda *_: 0)
    one_by_one = follow(made, joints)
    monkeypatch.setattr(follow_joints, "_continue_solutions", watched_continue)
    monkeypatch.setattr(follow_joints, "_advance_together", watched_together)
    for count in (*range(1, 13), 64):
        monkeypatch.setattr(follow_joints, "CHUNK_PLACES", count)
        found = follow(made, joints)
        assert found.problems == one_by_one.problems
        if is_feasible:
            assert found.start_rad == pytest.approx(one_by_one.start_rad, abs=1e-9)
    assert bool(one_by_one.problems) is not is_feasible
    assert is_feasible or stops == {"first", "middle", "last"}


def test_joint_rates_match_finite_differences():
    cell, _ = job(*JOBS[0][:-1])
    found, frame = joints_of(cell.arm), robot_from_paper(cell)
    at = np.array([-100.0, -500.0, 30.0])
    here = found.solutions(flange_at(cell, frame, at))[0]
    expected = joint_rates(cell.arm, here, at)
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = 1e-3
        there = found.solutions(flange_at(cell, frame, at + step))
        turned = there[np.abs(there - here).max(axis=1).argmin()] - here
        assert turned / 1e-3 == pytest.approx(expected[:, axis], abs=1e-5)


def test_the_nearest_workable_position_may_need_a_rotation_of_the_paper():
    """The nearest workable place may be a turn of the paper.

    The paper is behind the robot, where joint 1 cannot pass. Turned lengthwise, the stroke stays clear of
    this limit.
    """
    cell, plan = job("irb120", (-450, 90, 20), (), ACROSS, (), {})
    (problem,) = look(cell, plan).problems
    assert problem.code == "joint-limit"
    made = unchecked_program(split_into_loads(plan, BRUSH, cell), BRUSH, cell)
    found = place.find_nearest_place(made, joints_of(cell.arm), lambda there: there.robot_from_frame[0, 0] < 0.999)
    assert found.turn_deg != 0
    there = place.move_paper_of_cell(cell, found.frame)
    assert look(there, plan).problems == []
    assert gives(found.text, f"{found.turn_deg:g}")


def test_convert_and_check_use_the_arm_check(tmp_path, capsys):
    cell, plan = job(*JOBS[0][:-1])
    drawing, near, far = (tmp_path / name for name in ("plan.json", "near.toml", "far.toml"))
    drawing.write_text(_core.write_plan(plan))
    far.write_text(write_cell(cell))
    near.write_text(write_cell(replace(cell, paper=replace(cell.paper, origin_mm=(-50.0, -500.0, 20.0)))))
    program = tmp_path / "line.script"
    status, _, reported = in_json(capsys, "convert", drawing, "-o", program, "--cell", far)
    assert status == 1 and is_reported(reported, "arm-out-of-reach UR5e", "line") and not program.exists()
    assert main(["convert", str(drawing), "-o", str(program), "--cell", str(near), "--quiet"]) == 0
    assert main(["check", str(program), "--cell", str(near)]) == 0
    text = program.read_text()
    assert text.count("-0.5000000") == 1  # the line that sets the paper
    program.write_text(text.replace("-0.5000000", "-0.9800000").replace("-500.0 20.0", "-980.0 20.0"))
    capsys.readouterr()
    status, _, reported = in_json(capsys, "check", program, "--cell", far)
    assert status == 1 and is_reported(reported, "arm-out-of-reach UR5e", "line")


def test_a_missing_library_is_reported_with_the_package_to_install(tmp_path, capsys, monkeypatch):
    cell, plan = job(*JOBS[0][:-1])
    drawing, far = tmp_path / "plan.json", tmp_path / "far.toml"
    drawing.write_text(_core.write_plan(plan))
    far.write_text(write_cell(cell))
    monkeypatch.setitem(sys.modules, "ssik", None)
    joints_of.cache_clear()
    status, _, reported = in_json(capsys, "convert", drawing, "-o", tmp_path / "a.script", "--cell", far)
    assert status == 0 and is_reported(reported, "arm-not-followed ssik UR5e")
    _, _, reported = in_json(capsys, "check", tmp_path / "a.script", "--cell", far)
    assert is_reported(reported, "arm-not-followed ssik UR5e")
    status, _, reported = in_json(capsys, "cell", "place", far)
    assert status == 1 and is_reported(reported, "package-missing ssik")


def test_no_joint_is_behind_a_wall():
    """The wrist once passed for free behind a wall, because only a joint below the robot's base was in the table."""
    shipped = find_cell("ur5e")
    workspace = replace(shipped.workspace, tilt_limit_deg=90.0)
    wall = Paper(taught_mm=((150, -550, 200), (-140, -550, 200), (150, -550, 400)))
    cell = replace(shipped, workspace=workspace, paper=wall)
    made = make_sheet_program(BRUSH, cell, (200.0, 100.0))
    assert not follow(made, joints_of(cell.arm)).problems
    reversed_tool = replace(cell, tool=replace(cell.tool, tcp_mm=(0.0, 0.0, -250.0)))
    made = make_sheet_program(BRUSH, reversed_tool, (200.0, 100.0))
    (notice,) = follow(made, joints_of(cell.arm)).problems
    assert agrees(notice, "joint-below-table 'behind the paper'")
    named = replace(reversed_tool, arm=replace(cell.arm, posture_deg=(-37.0, -93.0, -134.0, -133.0, -37.0, 180.0)))
    assert not follow(make_sheet_program(BRUSH, named, (200.0, 100.0)), joints_of(named.arm)).problems


@pytest.mark.parametrize(
    ("taught", "axes"),
    [
        (((150, -550, 200), (-140, -550, 200), (150, -550, 400)), (0, 2)),
        (((-550, -150, 200), (-550, 140, 200), (-600, -150, 400)), (1, 2)),
        (((150, -450, 200), (-140, -450, 200), (150, -550, 300)), (0, 1)),
    ],
)
def test_place_draws_a_wall_from_the_front(tmp_path, capsys, taught, axes):
    """`cell place -o` once failed for paper that stands upright, because the map was always seen from above."""
    shipped = find_cell("ur5e")
    workspace = replace(shipped.workspace, tilt_limit_deg=90.0, box_mm=((-700.0, -700.0, 0.0), (700.0, 700.0, 800.0)))
    cell = replace(shipped, workspace=workspace, paper=Paper(taught_mm=taught))
    (tmp_path / "wall.toml").write_text(write_cell(cell))
    assert in_json(capsys, "cell", "place", tmp_path / "wall.toml", "-o", tmp_path / "wall.svg")[0] == 0
    table = place.rate_table(cell, robot_from_paper(cell), joints_of(cell.arm))
    assert table.axes == axes and np.count_nonzero(table.what == place.REACHED) > 100
    seen = " and ".join("xyz"[axis] for axis in axes)
    assert (f"{seen}, mm" in (tmp_path / "wall.svg").read_text()) is (axes != (0, 1))


def test_place_reports_workable_paper_positions_and_draws_the_table(tmp_path, capsys):
    cell, plan = job(*JOBS[0][:-1])
    drawing, far, near, picture = (tmp_path / n for n in ("plan.json", "far.toml", "near.toml", "table.svg"))
    drawing.write_text(_core.write_plan(plan))
    box = ((-400.0, -1000.0, -50.0), (400.0, -700.0, 500.0))
    cell = replace(cell, workspace=replace(cell.workspace, box_mm=box))
    far.write_text(write_cell(cell))
    status, output, reported = in_json(capsys, "cell", "place", far, drawing, "-o", picture)
    assert status == 1 and is_reported(reported, "arm-out-of-reach UR5e")
    assert picture.read_text().count('class="sheet"') == 2
    numbers = re.search(r"origin_mm = \[(.*?)\]", output).group(1).split(",")
    paper = replace(cell.paper, origin_mm=tuple(map(float, numbers)))
    near.write_text(write_cell(replace(cell, paper=paper)))
    assert in_json(capsys, "cell", "place", near, drawing)[0] == 0
    by_python = brushsvg.place_paper(str(far), drawing, tmp_path / "by-python.svg")
    assert by_python.cell.paper.origin_mm == pytest.approx(paper.origin_mm, abs=1e-3)
    assert [notice.code for notice in by_python.problems] == [notice.code for _, notice in reported]
    assert (tmp_path / "by-python.svg").read_text() == picture.read_text() == by_python.picture
    status, _, reported = in_json(capsys, "cell", "place", "linuxcnc-3axis")
    assert status == 1 and is_reported(reported, "arm-missing")


def test_place_paper_changes_only_the_paper_of_the_cell():
    """The returned cell once cut corners less than the given one, as the program of a drawing does."""
    shipped = find_cell("ur5e")
    cell = replace(shipped, blending=replace(shipped.blending, tolerance_mm=0.5))
    assert brushsvg.place_paper(cell).cell == cell
    far = replace(cell, paper=replace(cell.paper, origin_mm=(-150.0, -1100.0, 20.0)))
    moved = brushsvg.place_paper(far).cell
    assert moved.paper != far.paper and replace(moved, paper=far.paper) == far


def test_place_paper_reports_notices_of_the_drawing_and_choices_without_effect(tmp_path):
    drawing = tmp_path / "d.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40">'
        '<path d="M20 20H40" fill="none" stroke="#000" stroke-width="3"/><text id="t" x="9" y="9">a</text></svg>'
    )
    assert are_reported(brushsvg.place_paper("ur5e", drawing).notices, "text-unread")
    choices = {"z_offset": 1.0, "compensation": "none", "colour": "#000", "paint_speed": 9.0, "fit": (30.0, 30.0)}
    found = brushsvg.place_paper("ur5e", **choices).notices
    assert {each.code for each in found} == {"flag-without-effect"}
    assert [each.about for each in found] == ["z-offset", "colour", "speed", "fit", "compensation"]
    assert brushsvg.place_paper("ur5e", sheet=(100.0, 80.0), brush="liner-1").notices == ()


def test_place_suggests_no_joints_to_begin_with_if_no_place_was_found(capsys, tmp_path):
    """The arm reaches the sheet, but the box excludes it. Joints were once suggested for the forbidden place."""
    shipped = find_cell("ur5e")
    box = ((5000.0, 5000.0, 5000.0), (5001.0, 5001.0, 5001.0))
    cell = replace(shipped, workspace=replace(shipped.workspace, box_mm=box))
    found = brushsvg.place_paper(cell)
    assert {each.code for each in found.problems} == {"out-of-box"}
    assert (found.cell, found.move_text, found.start_deg) == (None, "", None)
    (tmp_path / "boxed.toml").write_text(write_cell(cell))
    status, output, _ = in_json(capsys, "cell", "place", tmp_path / "boxed.toml")
    assert (status, output) == (1, "")


def elbow_mm(name, joints_rad):
    """Return the position (3,) of joint 3 in the robot's frame, by its description."""
    here = np.eye(4)
    for (xyz, rpy, axis), angle in zip(DESCRIBED[name][0][:3], joints_rad, strict=False):
        here = here @ placed(xyz, rpy) @ about(axis, angle)
    return here[:3, 3]


@pytest.mark.parametrize("name", ["ur10e", "ur5e", "ur3e", "irb120", "kr6-r900"])
def test_the_posture_with_the_highest_elbow_is_suggested(name):
    """brushsvg suggests the posture whose elbow is highest.

    The suggested posture of ur10e once had its elbow 221 mm below the paper.
    """
    cell = find_cell(name)
    made = make_sheet_program(BRUSH, cell, (200.0, 100.0))
    solved = joints_of(cell.arm)
    found = follow(made, solved)
    assert not found.problems
    height = elbow_mm(name, found.start_rad)[2]
    assert height > robot_from_paper(cell)[2, 3]
    first = transform_points(made.robot_from_frame, next(made.sections()).moves[0].points_mm[:1])[0]
    for start in solved.solutions(flange_at(cell, made.robot_from_frame, first)):
        named = replace(cell.arm, posture_deg=tuple(np.degrees(start).tolist()))
        other = follow(replace(made, cell=replace(cell, arm=named)), joints_of(named))
        if not other.problems:
            assert elbow_mm(name, other.start_rad)[2] < height + 0.01


def test_joints_below_the_table_are_refused_unless_the_cell_sets_the_posture():
    cell = find_cell("ur10e")
    (x, y, z), first = cell.paper.origin_mm, robot_from_paper(cell)
    below = [
        angles
        for angles in joints_of(cell.arm).solutions(flange_at(cell, first, np.array([x, y, z + 40.0])))
        if elbow_mm("ur10e", angles)[2] < min(0.0, z)
    ]
    assert below
    bends = np.sign(below[0][2])
    only = [(-360.0, 360.0)] * 6
    only[2] = (0.0, 180.0) if bends > 0 else (-180.0, 0.0)
    shoulder = np.degrees(below[0][0])
    only[0] = (shoulder - 40, shoulder + 40)
    arm = replace(cell.arm, limits_deg=tuple(only))
    made = make_sheet_program(BRUSH, replace(cell, arm=arm), (200.0, 100.0))
    (notice,) = follow(made, joints_of(arm)).problems
    assert agrees(notice, "joint-below-table mm")
    named = replace(arm, posture_deg=tuple(np.degrees(below[0]).tolist()))
    made = make_sheet_program(BRUSH, replace(cell, arm=named), (200.0, 100.0))
    assert not follow(made, joints_of(named)).problems
    # The paper is far below the robot's base: a frame that is only lower than the base is in the air.
    there, low = joint_frames_of(arm, below[0]), first.copy()
    low[2, 3] = -1000.0
    assert lowest_joint_mm(there, first) < 0 < lowest_joint_mm(there, low)


def test_refinement_does_not_search_a_place_of_the_paper(monkeypatch, tmp_path):
    """The search takes seconds, and only the refusal of the job gives its result."""
    cell, _ = job("irb120", (-50, -650, 20), (), ALONG, (), {})
    (tmp_path / "far.toml").write_text(write_cell(cell))
    curves = "".join(f'<path d="M10 {y}C40 {y + 9} 60 {y - 9} 90 {y}"/>' for y in (15, 30, 45))
    style = 'fill="none" stroke="#000" stroke-width="3"'
    size = 'width="100mm" height="60mm" viewBox="0 0 100 60"'
    (tmp_path / "curves.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" {size}><g {style}>{curves}</g></svg>'
    )
    searches, nearest = [], place.find_nearest_place
    monkeypatch.setattr(place, "find_nearest_place", lambda *given: searches.append(given) or nearest(*given))
    convert = ["convert", str(tmp_path / "curves.svg"), "-o", str(tmp_path / "curves.mod")]
    assert main([*convert, "--cell", str(tmp_path / "far.toml"), "--compensation", "refined"]) == 1
    assert len(searches) == 1
