"""Workspace limits hold along the whole path, in every command alike.

The path includes strokes, travel between them, visits, circles and rises.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from diagnostics import agrees, are_reported, in_json, is_reported, refused
from programs import call, forbidden

from brushsvg import _core
from brushsvg.jobs.options import Options
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.machine.cells.cell import Reload, Station
from brushsvg.machine.cells.cell_file import find_cell, parse_cell, write_cell
from brushsvg.machine.limits import move_extents
from brushsvg.machine.limits.move_extents import make_paths
from brushsvg.machine.limits.workspace import find_broken_limits, find_limits_broken_between
from brushsvg.machine.setup_programs import make_border_program, make_height_program
from brushsvg.model.library import find_brush

BRUSH = find_brush("round-6")
SHEET = (600.0, 200.0)
BAR, PAIR = (
    f'<svg xmlns="http://www.w3.org/2000/svg" width="600mm" height="200mm" viewBox="0 0 600 200">'
    f'<path d="{d}" fill="none" stroke="#000" stroke-width="3" id="{name}"/>{more}</svg>'
    for d, name, more in (
        ("M40 100 H560", "bar", ""),
        ("M20 100 H60", "left", '<path id="right" d="M540 100 h40" stroke="#000" stroke-width="3"/>'),
    )
)


def robot(**workspace):
    """Return a robot that stands in the middle of its paper."""
    cell = find_cell("ur5e")
    paper = replace(cell.paper, origin_mm=(-300.0, -100.0, 20.0), example=False)
    limits = {"box_mm": (), "reach_mm": (), "margin_mm": 30.0, "tilt_limit_deg": 15.0} | workspace
    return replace(cell, name="mine", paper=paper, workspace=replace(cell.workspace, **limits))


RING = {"reach_mm": (150.0, 850.0)}
POST = {"keep_out_mm": (((-40.0, -40.0, -50.0), (40.0, 40.0, 300.0)), ((0.0, 300.0, 0.0), (1.0, 301.0, 1.0)))}
AWAY = "out-of-reach '[150, 850] mm'"
KEPT = "in-kept-out-box 'box 1' mine 'x -40 to 40'"


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bar.svg").write_text(BAR)
    (tmp_path / "pair.svg").write_text(PAIR)
    (tmp_path / "free.toml").write_text(write_cell(robot()))
    return tmp_path


@pytest.mark.parametrize(("limits", "code"), [(RING, AWAY), (POST, KEPT)])
@pytest.mark.parametrize(("name", "of_stroke", "way"), [("bar", "bar", ""), ("pair", "right", " way")])
def test_no_path_goes_through_the_robot(desk, capsys, name, of_stroke, way, limits, code):
    """No path goes through the robot itself.

    Only the two ends of a path were once checked, and nothing was checked between strokes.
    """
    (desk / "mine.toml").write_text(write_cell(robot(**limits)))
    drawing, cell = f"{name}.svg", ("--cell", "mine.toml")
    for command in (["convert"], ["setup", "border"]):
        program = f"{command[-1]}.script"
        status, _, reported = in_json(capsys, *command, drawing, "-o", program, *cell)
        file, last = reported[-1]
        expected = (f"{code}{way}", of_stroke) if command == ["convert"] else (code,)
        assert (status, file) == (1, drawing) and agrees(last, *expected), reported
        if limits == RING:
            assert 0 <= float(re.search(r"goes ([\d.]+) mm away", last.sentence)[1]) <= 40
        assert not (desk / program).exists()
        assert call(capsys, *command, drawing, "-o", program, "--cell", "free.toml")[0] == 0
        status, _, reported = in_json(capsys, "check", program, *cell)
        assert status == 1 and is_reported(reported, *expected), reported


LEFT = {"keep_out_mm": (((-285.0, -40.0, 0.0), (-235.0, 40.0, 300.0)), ((0.0, 300.0, 0.0), (1.0, 301.0, 1.0)))}


@pytest.mark.parametrize(("limits", "x_mm"), [(RING, 20), (POST, 20), (LEFT, 20), ({}, -20)])
def test_only_the_rest_of_a_resumed_job_is_checked(desk, capsys, limits, x_mm):
    """In a resumed job, only the rest is checked.

    The first stroke, the path from it and its paint may break any limit, because the machine does not repeat
    them.
    """
    (desk / "mine.toml").write_text(write_cell(robot(**limits)))
    (desk / "pair.svg").write_text(PAIR.replace("M20 100", f"M{x_mm} 100"))
    words = ("convert", "pair.svg", "-o", "pair.script", "--cell", "mine.toml")
    assert call(capsys, *words)[0] == 1
    assert call(capsys, *words, "--from-stroke", "2")[0] == 0
    assert call(capsys, "check", "pair.script", "pair.svg", "--cell", "mine.toml")[::2] == (0, [])
    (desk / "pair.svg").write_text(PAIR.replace("h40", "h60"))
    status, _, err = call(capsys, *words, "--from-stroke", "2")
    assert status == 1 and all("right: " in line for line in err)
    status, _, reported = in_json(capsys, *words, "--from-stroke", "3")
    assert status == 1 and is_reported(reported, "stroke-unknown 3 '[1, 2]'"), reported


def test_height_strokes_and_their_paths_avoid_forbidden_boxes(desk, capsys):
    """Height measurements and the paths between them keep out of forbidden boxes.

    The box is a clip between the first two lanes, and its top is not lower than the lanes.
    """
    clip = robot(keep_out_mm=(((-300.0, 90.0, 30.0), (-200.0, 92.0, 45.0)),))
    (desk / "mine.toml").write_text(write_cell(clip))
    height = ("setup", "height", "-o", "job.script", "--sheet", "600x200")
    status, _, ((_, reported), *_) = in_json(capsys, *height, "--cell", "mine.toml")
    assert status == 1 and agrees(reported, "in-kept-out-box way 'y 91.0, z 40.0 mm'"), reported
    assert call(capsys, *height, "--cell", "free.toml")[0] == 0
    status, _, reported = in_json(capsys, "check", "job.script", "--cell", "mine.toml")
    assert status == 1 and is_reported(reported, "in-kept-out-box way"), reported


@pytest.mark.parametrize("language", ["linuxcnc-3axis", "ur5e"])
@pytest.mark.parametrize(
    ("box", "who", "expected"),
    [
        (((-6.0, 30.0, 5.0), (-4.0, 50.0, 100.0)), "s", "in-kept-out-box way"),  # on the path from the paint
        # At the bottom of the vessel.
        (
            ((-21.0, 39.0, -20.0), (-19.0, 41.0, -4.5)),
            "ink",
            "in-kept-out-box",
        ),
        # Between the points of a wipe.
        (
            ((-16.0, 39.0, -20.0), (-15.0, 41.0, 5.5)),
            "ink",
            "in-kept-out-box",
        ),
    ],
)
def test_paint_visits_and_their_paths_avoid_forbidden_boxes(desk, capsys, language, box, who, expected):
    ink = Station("ink", (-20.0, 40.0), depth_mm=5.0, rim_mm=4.0, wipe_mm=((-18.0, 40.0, 5.0), (-12.0, 40.0, 5.0)))
    cell = find_cell(language)
    cell = replace(
        cell,
        name="mine",
        paper=replace(cell.paper, origin_mm=(0.0, 0.0, 0.0), example=False),
        workspace=replace(find_cell().workspace, tilt_limit_deg=15.0),
        stations=(ink,),
        reload=Reload("stroke"),
    )
    (desk / "free.toml").write_text(write_cell(cell))
    (desk / "mine.toml").write_text(write_cell(replace(cell, workspace=replace(cell.workspace, keep_out_mm=(box,)))))
    (desk / "s.svg").write_text(BAR.replace("M40 100 H560", "M40 160 H90").replace('"bar"', '"s"'))
    program = "s.script" if language == "ur5e" else "s.ngc"
    for words, file in (
        (("convert", "s.svg", "-o", program), "s.svg"),
        (("check", program, "s.svg"), program),
    ):
        status, _, reported = in_json(capsys, *words, "--cell", "mine.toml")
        assert status == 1 and is_reported([each for each in reported if each[0] == file], expected, who), reported
        assert call(capsys, "convert", "s.svg", "-o", program, "--cell", "free.toml")[0] == 0


ROUND = np.array([(50, 30, -2), (50, -20, -2)], dtype=float)  # the lower one is at the edge of a 30 mm margin


def plan_of(poses, arcs=(), name="a"):
    return _core.Plan(BRUSH.name, "", SHEET, [_core.Pass(name, poses, 20.0, arcs=list(arcs))])


@pytest.mark.parametrize(("turn", "x"), [(1, "25.0"), (-1, "75.0")])
def test_a_circle_that_bulges_beyond_a_limit_is_refused(turn, x):
    cell = find_cell()
    boxed = replace(cell, workspace=replace(cell.workspace, box_mm=((40.0, -50.0, -50.0), (60.0, 50.0, 50.0))))
    arc = _core.Arc(0, 1, (50.0, 5.0), turn)
    assert forbidden(plan_of(ROUND), BRUSH, boxed) == []
    (reported,) = forbidden(plan_of(ROUND, [arc]), BRUSH, boxed)
    assert agrees(reported, f"out-of-box 'x {x} mm' '[40, 60] mm'", "a")


def test_a_circle_that_bulges_beyond_the_margin_is_refused(desk, capsys):
    """A circle that bulges beyond the margin is refused.

    All of its poses are inside.
    """
    poses = np.array([(40, -25, -2), (60, -25, -2)], dtype=float)
    below = _core.Arc(0, 1, (50.0, -25.0), 1)
    assert forbidden(plan_of(poses), BRUSH, find_cell()) == []
    assert are_reported(forbidden(plan_of(poses, [below]), BRUSH, find_cell()), "tool-off-sheet 5.00 lower")


def test_a_rise_on_tilted_paper_may_end_below_a_box():
    """A rise on paper that leans ends below the top of the box.

    The highest position over the sheet is checked before all else. Nothing is painted there.
    """
    cell = find_cell()
    leans = replace(
        cell,
        paper=replace(cell.paper, rotation_deg=(10.0, 0.0, 0.0)),
        workspace=replace(cell.workspace, tilt_limit_deg=15.0, box_mm=((-99.0, -99.0, -99.0), (700.0, 300.0, 40.0))),
    )
    low = plan_of(np.array([(50, 20, 0), (80, 20, -2)], dtype=float))
    (reported,) = forbidden(low, BRUSH, leans)
    assert agrees(reported, "out-of-box first 'z 49.8 mm' '[-99, 40]'", "")


@pytest.mark.parametrize("name", ["linuxcnc-3axis", "jaka-zu3"])
@pytest.mark.parametrize(("limit", "expected"), [("reach_mm", "out-of-reach"), ("keep_out_mm", "in-kept-out-box")])
def test_a_rise_before_the_first_move_avoids_forbidden_boxes(desk, capsys, name, limit, expected):
    """A rise before the first move keeps out of the forbidden space.

    Over the stroke, everything up to the safe height is allowed. On paper that leans, the tool first rises
    above the highest position of the paper. Only the height of the box was once checked for this rise.
    """
    cell = find_cell(name)
    suffix = ".ngc" if name == "linuxcnc-3axis" else ".jks"
    lamp = ((-80.0, -160.0, -366.0), (20.0, -100.0, -300.0)), ((900.0, 900.0, 0.0), (901.0, 901.0, 1.0))
    tight, free = {
        "reach_mm": ((388.0, 900.0), (330.0, 900.0)),
        "keep_out_mm": (lamp, tuple(((x, -140.0, -330.0), (x + 40.0, -100.0, -300.0)) for x in (-40.0, 0.0))),
    }[limit]
    paper = replace(cell.paper, origin_mm=(-300.0, -150.0, -400.0), rotation_deg=(10.0, 0.0, 0.0), example=False)
    for file, value in (("mine.toml", tight), ("free.toml", free)):
        space = replace(cell.workspace, box_mm=(), reach_mm=(), tilt_limit_deg=15.0, margin_mm=0.0)
        some = replace(cell, name="mine", paper=paper, workspace=replace(space, **{limit: value}))
        (desk / file).write_text(write_cell(some))
    (desk / "s.svg").write_text(BAR.replace("M40 100 H560", "M250 170 H290").replace('"bar"', '"s"'))
    for command in (["convert"], ["setup", "border"]):
        program = f"{command[-1]}{suffix}"
        status, _, reported = in_json(capsys, *command, "s.svg", "-o", program, "--cell", "mine.toml")
        assert status == 1 and is_reported(reported, f"{expected} rise mine", ""), reported
        assert not (desk / program).exists()
        assert call(capsys, *command, "s.svg", "-o", program, "--cell", "free.toml")[0] == 0
        assert call(capsys, "check", program, "--cell", "free.toml")[0] == 0
        status, _, reported = in_json(capsys, "check", program, "--cell", "mine.toml")
        assert status == 1 and is_reported(reported, f"{expected} rise mine"), reported


def test_a_path_exactly_at_a_limit_stays_valid_after_rounding(desk, capsys):
    """A path that keeps a limit exactly still keeps it after rounding.

    The reach once had no allowance for the rounding of a program, and check then refused the program.
    """
    cell = replace(robot(), decimals=3)
    (desk / "free.toml").write_text(write_cell(cell))
    assert call(capsys, "convert", "bar.svg", "-o", "bar.json", "--cell", "free.toml")[0] == 0
    poses = np.array(_core.read_plan((desk / "bar.json").read_text()).passes[0].poses_mm)
    high = poses[[0, -1]] * (1, 1, 0) + (-300.0, -100.0, 20.0 + cell.heights.safe_mm)
    poses += (-300.0, -100.0, 20.0)
    far = float(np.linalg.norm(np.vstack([poses, high]), axis=1).max())
    left, right = poses[:, 0].min(), poses[:, 0].max()
    box = ((float(left), -200.0, -50.0), (float(right), 200.0, 20.0 + cell.heights.safe_mm))
    exact = replace(cell.workspace, reach_mm=(0.0, far), box_mm=box)
    (desk / "mine.toml").write_text(write_cell(replace(cell, workspace=exact)))
    assert call(capsys, "convert", "bar.json", "-o", "bar.script", "--cell", "mine.toml")[0] == 0
    status, _, err = call(capsys, "check", "bar.script", "bar.json", "--cell", "mine.toml")
    assert (status, err) == (0, [])


def test_corners_keep_a_clearance_of_twice_the_cut():
    near = robot(keep_out_mm=(((-10.0, 0.015, 0.0), (10.0, 50.0, 100.0)),))
    path = make_paths([[(-100, 0, 50), (100, 0, 50)]])
    assert near.blending.tolerance_mm == 0.01
    assert len(find_broken_limits(path, np.eye(4), near)) == 1
    exact = replace(near, blending=replace(near.blending, tolerance_mm=0.005))
    assert find_broken_limits(path, np.eye(4), exact) == []
    path = make_paths([[(-200, 150.015, 0), (200, 150.015, 0)]])
    assert len(find_broken_limits(path, np.eye(4), robot(**RING))) == 1
    assert find_broken_limits(path, np.eye(4), replace(robot(**RING), blending=exact.blending)) == []


def test_a_path_reports_only_limits_that_its_end_points_keep():
    cell = robot(**RING)
    (reported,) = find_limits_broken_between((-500, 0, 0), (500, 0, 0), np.eye(4), cell)
    assert agrees(reported, "out-of-reach way 0.0")
    assert find_limits_broken_between((-900, 0, 0), (500, 0, 0), np.eye(4), cell) == [], "it begins too far away"


def test_a_reported_value_is_visibly_out_of_range():
    cell = robot(reach_mm=(150.0, 850.0))
    (reported,) = find_broken_limits(make_paths([[(850.0004, 0, 0)]]), np.eye(4), cell)
    assert agrees(reported, "out-of-reach 850.0004")


def test_forbidden_boxes_are_written_read_and_named(desk, capsys):
    cell = robot(**POST)
    assert parse_cell(write_cell(cell)) == cell
    (desk / "mine.toml").write_text(write_cell(cell))
    assert "x -40 to 40, y -40 to 40, z -50 to 300 mm" in call(capsys, "cell", "show", "mine.toml")[1]
    turned = robot(keep_out_mm=(((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), ((0.0, 0.0, 5.0), (1.0, 1.0, 1.0))))
    with refused("cell-workspace 'box 2'", "workspace.keep_out_mm"):
        parse_cell(write_cell(turned))


def test_setup_jobs_check_their_whole_path():
    cell = robot(keep_out_mm=(((-1.0, -200.0, 0.0), (1.0, 200.0, 300.0)),))
    with refused("in-kept-out-box") as caught:
        make_border_program((20.0, 20.0, 580.0, 180.0), BRUSH, cell, SHEET)
    assert re.search(r"x -?0\.0", caught.value.sentence)
    assert len(list(make_border_program((20.0, 20.0, 280.0, 180.0), BRUSH, cell, SHEET).sections())) == 1
    assert len(list(make_height_program(BRUSH, cell, SHEET, 1.0, -1.0, 0.1).sections())) == 21


def test_a_wipe_beyond_the_sheet_does_not_cross_the_sheet():
    """A wipe beyond the sheet must not be reached across the sheet.

    Vessel and wipe are next to the sheet. The tip, full of paint, once crossed the sheet at the height of the
    rim.
    """
    ink = Station("ink", (-20.0, 40.0), depth_mm=5.0, wipe_mm=((-10.0, 40.0, 5.0), (-10.0, 80.0, 5.0)))
    cell = replace(find_cell(), stations=(ink,), reload=Reload("stroke"))
    assert forbidden(plan_of(ROUND), BRUSH, cell) == []
    across = replace(ink, wipe_mm=((50.0, -10.0, 5.0), (80.0, -10.0, 5.0)))
    found = forbidden(plan_of(ROUND), BRUSH, replace(cell, stations=(across,)))
    assert are_reported(found, "station-on-sheet ink '600 x 200 mm'")


def test_the_advice_for_a_station_beyond_the_margin_names_the_station():
    cell = find_cell()
    ink = Station("ink", (-cell.workspace.margin_mm - 20.0, 40.0), depth_mm=5.0)
    found = forbidden(plan_of(ROUND), BRUSH, replace(cell, stations=(ink,), reload=Reload("stroke")))
    beyond = [each for each in found if each.code == "tool-off-sheet"]
    assert beyond and all(each.where == "ink" and "the station away" in each.advice for each in beyond), found


@pytest.mark.parametrize("at_once", [1, 7, 10_000])
def test_path_checks_do_not_depend_on_grouping(monkeypatch, at_once):
    """The result does not depend on how many moves are checked at once.

    The strokes are on both sides of the robot, and some paths between them go through it.
    """
    monkeypatch.setattr(move_extents, "MAX_MOVES_AT_ONCE", at_once)
    sides = [30.0, 40.0, 500.0, 540.0, 50.0, 520.0]
    passes = [
        _core.Pass(f"s{k}", np.array([(x, 100, 0), (x + 20, 100, -2)], dtype=float), 20.0) for k, x in enumerate(sides)
    ]
    reported = forbidden(_core.Plan(BRUSH.name, "", SHEET, passes), BRUSH, robot(**RING))
    assert are_reported(reported, "out-of-reach s2 way", "out-of-reach s4 way", "out-of-reach s5 way")


EDGES = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60" fill="none" '
    'stroke="#000" stroke-width="4"><path id="edge" d="M97 30H40"/><path id="own" d="M97 45H40" '
    'data-brushsvg-start="{own}"/><path id="amid" d="M40 15H80"/></svg>'
)


def test_an_automatic_start_is_one_that_the_cell_can_run(tmp_path, capsys):
    """An automatic beginning is chosen so that the cell can run it.

    At the edge, a round beginning once landed beyond the workspace, and the whole drawing was refused.
    """
    cell = find_cell()
    cell = replace(cell, name="tight", workspace=replace(cell.workspace, margin_mm=2.0))
    (tmp_path / "tight.toml").write_text(write_cell(cell), encoding="utf-8")
    (tmp_path / "a.svg").write_text(EDGES.format(own="auto"), encoding="utf-8")
    words = ("--cell", str(tmp_path / "tight.toml"))
    passes = {}
    for start in ("auto", "pointed"):
        plan = tmp_path / f"{start}.json"
        assert call(capsys, "convert", str(tmp_path / "a.svg"), "-o", str(plan), "--start", start, *words)[0] == 0
        passes[start] = _core.read_plan(plan.read_text(encoding="utf-8")).passes
    same = [
        np.array_equal(one.poses_mm, other.poses_mm)
        for one, other in zip(passes["auto"], passes["pointed"], strict=True)
    ]
    assert same == [True, True, False], "amid the sheet it begins round, as it suits it"
    program = str(tmp_path / "a.ngc")
    assert call(capsys, "convert", str(tmp_path / "a.svg"), "-o", program, *words)[0] == 0
    assert call(capsys, "check", program, str(tmp_path / "a.svg"), *words)[0] == 0
    (tmp_path / "a.svg").write_text(EDGES.format(own="round"), encoding="utf-8")
    status, _, reported = call(capsys, "convert", str(tmp_path / "a.svg"), "-o", program, *words)
    assert status == 1 and "own" in reported[-1], "a round start that was requested is refused"


BARS = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">'
    '<path id="edge" d="M95.5 12h4v30h-4z"/><path id="amid" d="M50 12h4v30h-4z"/></svg>'
)


def test_a_butt_start_outside_the_workspace_becomes_round_or_pointed(tmp_path, capsys):
    cell = find_cell()
    cell = replace(cell, name="tight", workspace=replace(cell.workspace, margin_mm=2.0))
    (tmp_path / "tight.toml").write_text(write_cell(cell), encoding="utf-8")
    (tmp_path / "a.svg").write_text(BARS, encoding="utf-8")
    words = ("--cell", str(tmp_path / "tight.toml"))

    def passes(*more):
        plan = tmp_path / "a.json"
        assert call(capsys, "convert", str(tmp_path / "a.svg"), "-o", str(plan), "--end", "round", *more)[0] == 0
        return [one.poses_mm for one in _core.read_plan(plan.read_text(encoding="utf-8")).passes]

    chosen, butt, rounded = passes(*words), passes("--start", "butt"), passes("--start", "round")
    assert np.array_equal(chosen[1], butt[1]), "amid the sheet it begins butt, as it suits it"
    assert np.array_equal(chosen[0], rounded[0]) and not np.array_equal(rounded[0], butt[0])


def test_a_stroke_whose_round_start_exceeds_the_sheet_starts_pointed(tmp_path, capsys):
    """A stroke whose round beginning exceeds the sheet begins pointed.

    The round beginning is 0.17 mm beyond the edge, and the drawing was once refused.
    """
    drawn = (
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80">'
        '<path id="edge" d="M96.4 45l-18.73 -37.09" stroke="#000" fill="none" stroke-width="7.6"/></svg>'
    )
    (tmp_path / "a.svg").write_text(drawn, encoding="utf-8")
    drawing, program = str(tmp_path / "a.svg"), str(tmp_path / "a.ngc")
    assert call(capsys, "convert", drawing, "-o", program, "--start", "round")[0] == 1
    assert call(capsys, "convert", drawing, "-o", program)[0] == 0
    assert call(capsys, "check", program, drawing)[0] == 0


def test_copies_beyond_a_limit_are_reported_by_the_one_that_is_furthest_beyond(tmp_path, capsys):
    """The first copy was reported, and a drawing that was moved by that distance was refused again."""
    lines = "".join(
        f'<path id="l{k}" d="M{x} {10 + 10 * k}h20" fill="none" stroke="#000" stroke-width="3"/>'
        for k, x in enumerate((1, -6, 1, 0, 1))
    )
    sheet = 'width="100mm" height="80mm" viewBox="0 0 100 80"'
    (tmp_path / "a.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {sheet}>{lines}</svg>')
    (tmp_path / "box.toml").write_text(write_cell(robot(box_mm=((-295.0, -200.0, -50.0), (300.0, 200.0, 300.0)))))
    files = (tmp_path / "a.svg", "-o", tmp_path / "a.script", "--cell", tmp_path / "box.toml")
    status, _, reported = in_json(capsys, "convert", *files)
    assert status == 1
    assert is_reported(reported, "out-of-box l1 4 -312.9")
    assert is_reported(reported, "mark-off-sheet l1 4 7.50")


@pytest.mark.parametrize(("margin_mm", "strokes"), [(8.0, 3), (3.0, 1)])
def test_an_extra_stroke_outside_the_workspace_is_left_out(tmp_path, margin_mm, strokes):
    """An added stroke is left out where the cell has no room for it.

    The drawing was once refused because strokes into the corners of an L were 0.6 mm beyond the workspace.
    """
    file = tmp_path / "l.svg"
    file.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="46mm" height="50mm" viewBox="0 0 46 50">'
        '<path id="p" d="M20 5H28V42H45V49H20Z"/></svg>'
    )
    work = prepare(file, Options(brush=BRUSH, cell=robot(margin_mm=margin_mm)))
    assert len(work.strokes) == len(work.plan.passes) == strokes
    assert work.strokes[0].id == "p"
