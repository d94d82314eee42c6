"""Every key of a cell is read, checked and written back.

The paper's frame comes from a pose or from taught points.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import agrees, are_reported, in_json, is_reported, refused

from brushsvg.cli import main
from brushsvg.machine.cells.cell import Machine, Paper, Reload, RoboDK, Servo, Station, Tool, robot_from_paper
from brushsvg.machine.cells.cell_check import check, report_unusual_values, report_workspace_out_of_reach
from brushsvg.machine.cells.cell_file import SHIPPED, cell_names, find_cell, parse_cell, read_cell, write_cell
from brushsvg.machine.cells.describe_cell import cell_page
from brushsvg.machine.frames import frame_of_pose, normal_tilt_deg, rotation, rotation_vector, transform_points
from brushsvg.machine.posts import POSTS

TEXT = (SHIPPED / "linuxcnc-3axis.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", cell_names())
def test_every_shipped_cell_loads_and_equals_the_output_of_the_tool(name):
    cell = find_cell(name)
    assert cell.name == name
    assert write_cell(cell) == (SHIPPED / f"{name}.toml").read_text(encoding="utf-8")
    assert cell.language in POSTS
    assert cell.paper.example == (cell.tool is not None), "a robot's paper must be taught"


@pytest.mark.parametrize(
    ("old", "new", "where", "expected"),
    [
        ("press_mm_s = 8.0", "", "speeds.press_mm_s", "key-missing"),
        ("press_mm_s = 8.0", "press_mm_s = 8.0\npress = 3", "speeds.press", "key-unknown travel_mm_s"),
        ("press_mm_s = 8.0", 'press_mm_s = "8"', "speeds.press_mm_s", "wrong-type \"not '8'\""),
        ("press_mm_s = 8.0", "press_mm_s = nan", "speeds.press_mm_s", "wrong-type nan"),
        ("press_mm_s = 8.0", "press_mm_s = true", "speeds.press_mm_s", "wrong-type True"),
        ("press_mm_s = 8.0", "press_mm_s = 0", "speeds.press_mm_s", "out-of-range 0 0.01 5000"),
        (
            "press_mm_s = 8.0",
            f"press_mm_s = 1{'0' * 400}",
            "speeds.press_mm_s",
            "out-of-range 0.01 5000",
        ),
        ("decimals = 4", f"decimals = -1{'0' * 400}", "decimals", "out-of-range 3 6"),
        ("decimals = 4", f"decimals = 1{'0' * 5000}", "", "not-toml"),
        ("decimals = 4", "decimals = 4\n" + "a." * 40 + "a = 1", "", "not-toml 20"),
        ("decimals = 4", "decimals = " + "[" * 5000 + "]" * 5000, "", "not-toml"),
        ("decimals = 4", "decimals = 4.0", "decimals", "wrong-type"),
        ("decimals = 4", "decimals = 9", "decimals", "out-of-range 9 3 6"),
        ("safe_mm = 10.0", "safe_mm = 0.5", "heights.clearance_mm", "cell-heights safe_mm 0.5"),
        ("lowest_mm = -20.0", "lowest_mm = 20", "heights.lowest_mm", "out-of-range -200 -0.01"),
        ("margin_mm = 30.0", "margin_mm = -1", "workspace.margin_mm", "out-of-range 0 10000"),
        (
            "margin_mm = 30.0",
            "margin_mm = 30.0\nreach_mm = [9, 2]",
            "workspace.reach_mm",
            "cell-workspace",
        ),
        ("margin_mm = 30.0", "margin_mm = 3\nbox_mm = [[0, 0, 0]]", "workspace.box_mm", "wrong-type 2"),
        (
            "margin_mm = 30.0",
            "margin_mm = 3\nbox_mm = [[0, 0, 0], [1, 1]]",
            "workspace.box_mm[1]",
            "wrong-type 3",
        ),
        (
            "margin_mm = 30.0",
            "margin_mm = 3\nbox_mm = [[0, 5, 0], [1, 1, 1]]",
            "workspace.box_mm",
            "cell-workspace",
        ),
        ('name = "linuxcnc-3axis"', 'name = "a\\nb"', "name", "wrong-type"),
        ("[speeds]", "[speed]", "speed", "key-unknown speeds"),
        ("[workspace]", "[[workspace]]", "workspace", "wrong-type"),
        ("version = 1", "version = 2", "version", "version-unknown 2"),
        ("version = 1", 'version = "1\\n2"', "version", "version-unknown '1\\n2'"),
        ('format = "brushsvg/cell"', "", "format", "format-unknown"),
        ("decimals = 4", "decimals = ", "", "not-toml"),
        (
            "[paper]",
            "[paper]\nrotation_deg = [3, 0, 0]",
            "paper",
            "paper-tilted 3.00 0 2",
        ),
        ("[paper]", "[paper]\ntaught_mm = [[0, 0, 0]]", "paper.taught_mm", "paper-taught 1"),
    ],
)
def test_an_invalid_cell_is_refused_with_its_key(old, new, where, expected):
    assert old in TEXT
    with refused(expected, where):
        parse_cell(TEXT.replace(old, new))


FULL = replace(
    find_cell("ur5e"),
    description="\u00e9criture, \"quoted\" \\ and 'plain'",
    paper=Paper(
        taught_mm=((0.0, 0.0, 1.0), (200.0, 0.0, 1.0), (0.0, 150.0, 1.5), (100.0, 100.0, 1.2)),
        flatness_mm=0.4,
    ),
    reload=Reload("length", 120.0, 4.0, "water", 8.0),
    stations=(
        Station(
            "ink",
            (250.0, 10.0),
            ("#000000", "#ff0000"),
            depth_mm=7.0,
            drip_s=1.5,
            wipe_mm=((260.0, 10.0, 3.0),),
        ),
        Station("water", (280.0, 10.0), depth_mm=12.0),
        Station("mixed", (0.0, -20.0), depth_mm=3.0),
    ),
)


@pytest.mark.parametrize(
    ("station", "expected"),
    [
        (
            Station("ink", (1.0, 2.0), depth_mm=25.0),
            "cell-station -25 lowest_mm -20",
        ),
        (
            Station("ink", (1.0, 2.0), surface_mm=5.0, depth_mm=2.0),
            "cell-station rim_mm 0 5 18",
        ),
        (
            Station("ink", (1.0, 2.0), depth_mm=2.0, wipe_mm=((0.0, 0.0, -3.0),)),
            "cell-station -3 0 20",
        ),
    ],
)
def test_a_station_that_the_tool_cannot_visit_is_refused(station, expected):
    with refused(expected):
        parse_cell(write_cell(replace(FULL, stations=(station,), reload=Reload("stroke"))))


def test_a_manual_station_is_refused_if_the_brush_would_drop():
    by_hand = (Station("ink", (1.0, 2.0), by_hand=True),)
    with refused("cell-station servo"):
        parse_cell(write_cell(replace(find_cell("grbl-servo"), stations=by_hand, reload=Reload("stroke"))))


@pytest.mark.parametrize("cell", [FULL, *map(find_cell, cell_names())])
def test_a_written_cell_is_read_back_unchanged(cell):
    assert parse_cell(write_cell(cell)) == cell


def test_comments_of_a_written_cell_have_single_spaces():
    corrected = replace(FULL, machine=Machine(scale=(1.01, 1.0)))
    comments = [line for line in write_cell(corrected).splitlines() if line.startswith("# ")]
    assert any("calibrate --machine" in line for line in comments)
    assert not [line for line in comments if "  " in line]


@pytest.mark.parametrize(
    ("change", "where", "expected"),
    [
        ({"reload": None}, "reload", "cell-reload"),
        ({"stations": ()}, "reload", "cell-reload"),
        ({"reload": Reload("hourly")}, "reload.when", "cell-reload 'hourly'"),
        ({"reload": Reload("stroke", wash="tea")}, "reload.wash", "cell-reload 'tea'"),
        ({"stations": (FULL.stations[0], FULL.stations[0])}, "station 2", "name-taken 'ink'"),
        ({"stations": (Station("ink", (1.0, 2.0)),)}, "station 1", "cell-station depth_mm 0"),
        (
            {"stations": (Station("ink", (1.0, 2.0), depth_mm=5.0, rim_mm=19.0),)},
            "station 1",
            "cell-station rim_mm 19 0 18",
        ),
        (
            {"stations": (replace(FULL.stations[0], colours=("red",)),)},
            "station 1",
            "colour-invalid 'red'",
        ),
        ({"reload": Reload("length", 10.0, 5.0)}, "reload.every_mm", "cell-reload backtrack_mm 5"),
        ({"tool": Tool((0.0, 0.0, 99000.0))}, "tool.tcp_mm", "out-of-range 99000 -2000 2000"),
        (
            {"arm": replace(FULL.arm, posture_deg=(0.0, 0.0, -190.0, 0.0, 0.0, 360.0))},
            "arm.posture_deg",
            "cell-arm 'joint 3' -190 '[-180, 180]'",
        ),
    ],
)
def test_contradictions_between_keys_are_refused(change, where, expected):
    with refused(expected, where):
        parse_cell(write_cell(replace(FULL, **change)))


def test_cell_check_refuses_units_that_convert_refuses(tmp_path, capsys):
    """Units that are too coarse for the usual tolerance are refused.

    `cell check` once accepted such a cell, and convert refused every drawing.
    """
    cell = find_cell("axidraw-ebb")
    coarse = replace(cell, motors=replace(cell.motors, steps_per_mm=((2.0, -2.0), (2.0, 2.0))))
    (tmp_path / "coarse.toml").write_text(write_cell(coarse))
    status, out, reported = in_json(capsys, "cell", "check", tmp_path / "coarse.toml")
    assert (status, out) == (1, "") and is_reported(reported, "decimals-too-few 0.5 0.25 0.0125"), reported


@pytest.mark.parametrize(
    ("workspace", "expected"),
    [
        (
            {"box_mm": ((-450.0, -850.0, 50.0), (450.0, -200.0, 500.0))},
            "sheet-out-of-reach 'z below 50' 50 500",
        ),
        ({"box_mm": ((-450.0, -850.0, -50.0), (450.0, -700.0, 500.0))}, "sheet-out-of-reach 'y above -700'"),
        (
            {"box_mm": ((-450.0, -850.0, -50.0), (450.0, -200.0, 30.0))},
            "sheet-out-of-reach 20 'z above 30'",
        ),
        ({"reach_mm": (10.0, 150.0)}, "sheet-out-of-reach 201 10 150"),
        ({"reach_mm": (1500.0, 1600.0)}, "sheet-out-of-reach 816 1500 1600"),
    ],
)
def test_a_cell_that_reaches_no_paper_is_reported(workspace, expected):
    cell = find_cell("ur5e")
    assert report_workspace_out_of_reach(cell) == []
    (reported,) = report_workspace_out_of_reach(replace(cell, workspace=replace(cell.workspace, **workspace)))
    assert reported.where == f"workspace.{next(iter(workspace))}" and agrees(reported, expected), reported


@pytest.mark.slow
def test_a_sheet_is_out_of_reach_only_if_no_point_of_it_is_reachable():
    """A sheet is out of reach exactly if no point of it can be reached.

    The reference tries points one by one, on papers with random poses.
    """
    random = np.random.default_rng(5)
    found = {True: 0, False: 0}
    for _ in range(200):
        paper = Paper(tuple(random.uniform(-400, 400, 3)), (*random.uniform(-40, 40, 2), random.uniform(0, 360)))
        low = random.uniform(-500, 300, 3)
        workspace = replace(
            find_cell("ur5e").workspace,
            margin_mm=0.0,
            box_mm=(tuple(low), tuple(low + random.uniform(50, 600, 3))),
            reach_mm=(100.0, float(random.uniform(200, 600))),
        )
        cell = replace(find_cell("ur5e"), paper=paper, workspace=workspace)
        x, y = (axis.ravel() for axis in np.meshgrid(np.arange(0, 2000, 16.0), np.arange(0, 2000, 16.0)))
        is_met = True
        for height in (0.0, cell.heights.safe_mm):
            points = transform_points(robot_from_paper(cell), np.column_stack([x, y, np.full(len(x), height)]))
            away = np.linalg.norm(points, axis=1)
            inside = ((points >= low) & (points <= workspace.box_mm[1])).all(axis=1)
            is_met &= bool((inside & (away >= 100) & (away <= workspace.reach_mm[1])).any())
        is_reported_out = bool(report_workspace_out_of_reach(cell))
        # The sheet may meet the box and the reach at different points; the limits of each program cover that
        # case.
        assert not (is_reported_out and is_met)
        found[is_reported_out] += 1
    assert min(found.values()) > 20


@pytest.mark.parametrize(
    ("table", "change", "expected"),
    [
        ("heights", {"safe_mm": 1.0, "clearance_mm": 0.5}, "unusual-value 1 2 200"),
        ("heights", {"lowest_mm": -120.0}, "unusual-value -120 -50 -0.5"),
        ("speeds", {"travel_mm_s": 4000.0}, "unusual-value 4000 1 1000"),
        ("speeds", {"paint_mm_s": 0.1}, "unusual-value 0.1 1 500"),
        ("speeds", {"acceleration_mm_s2": 40000.0}, "unusual-value 10 10000"),
        ("tool", {"tcp_mm": (0.0, 0.0, 1800.0)}, "unusual-value 1800"),
        ("tool", {"tcp_mm": (0.0, 0.0, 0.15)}, "unusual-value 0.15 10 500"),
        ("tool", {"tcp_mm": (0.0, 0.0, -150.0)}, "unusual-value 150 behind rotation_deg"),
        ("tool", {"tcp_mm": (130.0, 0.0, 45.0), "rotation_deg": (0.0, -90.0, 0.0)}, "unusual-value 130 behind"),
        (
            "workspace",
            {"box_mm": ((-100.0, -850.0, -50.0), (450.0, -200.0, 500.0))},
            "out-of-box",
        ),
        ("workspace", {"reach_mm": (200.0, 600.0)}, "out-of-reach 668.3 200 600"),
    ],
)
def test_unusual_values_are_reported(table, change, expected):
    cell = replace(find_cell("ur5e"), paper=replace(find_cell("ur5e").paper, example=False))
    assert report_unusual_values(cell) == []
    (reported,) = report_unusual_values(replace(cell, **{table: replace(getattr(cell, table), **change)}))
    assert reported.where.startswith(table) and agrees(reported, expected), reported


@pytest.mark.parametrize(
    ("tilt_deg", "by_hand", "is_remarked"), [(45, False, True), (45, True, False), (14, False, False)]
)
def test_dips_next_to_leaning_paper_are_remarked_on(tilt_deg, by_hand, is_remarked):
    """The brush dips along the paper's normal, which may lead it against the rim of a level vessel."""
    station = Station("ink", (-20.0, 20.0), by_hand=by_hand, depth_mm=0.0 if by_hand else 5.0)
    cell = find_cell("ur5e")
    leaning = replace(
        cell,
        paper=Paper((-50.0, -600.0, 200.0), (float(tilt_deg), 0.0, 0.0)),
        workspace=replace(cell.workspace, tilt_limit_deg=90.0),
        stations=(station,),
        reload=Reload("stroke"),
    )
    reported = report_unusual_values(parse_cell(write_cell(leaning)))
    assert is_reported(reported, f"paper-tilted {tilt_deg} by_hand", "stations") is is_remarked, reported


@pytest.mark.parametrize("name", cell_names())
def test_shipped_cells_have_no_unusual_values(name):
    cell = find_cell(name)
    assert [key for key, _ in report_unusual_values(cell)] == (["paper"] if cell.paper.example else [])
    assert report_workspace_out_of_reach(cell) == []


def test_the_paper_frame_passes_through_the_taught_points():
    truth = frame_of_pose((120.0, -340.0, 25.0), (1.0, -0.5, 37.0))
    on_paper = np.array([(0, 0, 0), (210, 0, 0), (14, 150, 0), (180, 120, 0)], dtype=float)
    taught = tuple(map(tuple, transform_points(truth, on_paper).tolist()))
    cell = replace(FULL, paper=Paper(taught_mm=taught))
    assert robot_from_paper(cell) == pytest.approx(truth, abs=1e-9)
    higher = robot_from_paper(cell, 2.0)
    assert higher[:3, 3] - truth[:3, 3] == pytest.approx(2.0 * truth[:3, 2])


@pytest.mark.parametrize(
    ("language", "where"), [("grbl-servo", "servo"), ("urscript", "tool"), ("linuxcnc", None), ("grbl", None)]
)
def test_a_missing_table_of_a_language_is_reported(language, where):
    text = TEXT.replace('language = "linuxcnc"', f'language = "{language}"')
    if where is None:
        assert parse_cell(text).language == language
        return
    with refused(f"key-missing {language}", where):
        parse_cell(text)


TABLES = {
    "servo": find_cell("grbl-servo").servo,
    "motors": find_cell("axidraw-ebb").motors,
    "pen": find_cell("hpgl-plotter").pen,
    "tool": find_cell("ur5e").tool,
    "robodk": RoboDK("post.py"),
}


@pytest.mark.parametrize("name", cell_names())
@pytest.mark.parametrize("table", TABLES)
def test_a_table_that_only_other_languages_use_is_refused(name, table):
    """A table that only other languages use is refused.

    A cell for ROS 2 with a servo was once accepted, and check then refused its programs.
    """
    cell = find_cell(name)
    if getattr(cell, table) is None:
        with refused(f"key-unused {cell.language}", table):
            parse_cell(write_cell(replace(cell, **{table: TABLES[table]})))


def test_an_unknown_language_is_reported_instead_of_its_tables(tmp_path, capsys):
    """A cell with the language "KRL" was once refused because that language 'does not use a table tool'."""
    text = write_cell(find_cell("kr6-r900")).replace('language = "krl"', 'language = "KRL"')
    (tmp_path / "mine.toml").write_text(text)
    status, _, reported = in_json(capsys, "cell", "check", tmp_path / "mine.toml")
    assert status == 0 and is_reported(reported, "language-unknown 'KRL' krl robodk", "language"), reported


def test_a_language_of_ones_own_may_have_motors_without_a_servo():
    """Such a cell once ended in an AttributeError, because only EBB cells have motors and all of them a servo."""
    cell = replace(find_cell("axidraw-ebb"), language="mine", servo=None)
    assert parse_cell(write_cell(cell)) == cell


def test_a_page_of_a_cell_shows_how_the_tool_is_turned():
    cell = find_cell("ur5e")
    tool = replace(cell.tool, tcp_mm=(130.0, 0.0, 45.0), rotation_deg=(0.0, 90.0, 0.0), spin_deg=25.0)
    turned, spun = (line for line in cell_page(replace(cell, tool=tool)).splitlines() if "turned" in line)
    assert "0, 90, 0" in turned and turned.startswith("tool ") and "25" in spun
    assert not any("turned" in line for line in cell_page(cell).splitlines())


def test_a_page_of_a_cell_shows_its_arm_its_machine_errors_and_its_post():
    """`cell show` once left out the tables arm, machine and robodk."""
    machine = Machine(lean_mm_per_mm=(0.31, -0.04), skew=0.004, map_mm=((0.0, 0.0, 0.1), (9.0, 0.0, 0.2)))
    cell = replace(find_cell("ur5e"), machine=machine, robodk=RoboDK("posts/mine.py"))
    rows = [line.strip() for line in cell_page(cell).splitlines()]
    for expected in (
        "machine         lean_mm_per_mm: 0.31, -0.04",
        "skew: 0.004",
        "map_mm: 0, 0, 0.1; 9, 0, 0.2",
        "arm             name: UR5e",
        "limits_deg: -360, 360; -360, 360; -180, 180; -360, 360; -360, 360; -360, 360",
        "robodk          post: posts/mine.py",
    ):
        assert expected in rows, rows
    assert not any("height_mm" in row or "base_mm" in row for row in rows), "keys with their default are left out"
    assert "machine" not in cell_page(replace(cell, machine=Machine()))


@pytest.mark.parametrize(
    ("servo", "expected"),
    [
        (Servo(((0.0, 1.0), (0.0, 2.0))), "servo-table"),
        (Servo(((0.0, 1.0), (9.0, 2.0))), "servo-table lowest_mm -8 safe_mm 5"),
        (Servo(((-30.0, -1.0), (30.0, 2.0))), "servo-table -1 0"),
        (Servo(((-30.0, 0.0), (30.0, 50.0))), "servo-coarse 1.2 0 0.5"),
    ],
)
def test_a_servo_without_a_value_for_each_height_is_refused(servo, expected):
    with refused(expected, "servo.table"):
        parse_cell(write_cell(replace(find_cell("grbl-servo"), servo=servo)))


def test_taught_paper_of_a_servo_must_be_level():
    text = (SHIPPED / "grbl-servo.toml").read_text(encoding="utf-8")
    level = "taught_mm = [[10, 5, 0], [110, 15, 0], [0, 105, 0]]"
    assert parse_cell(text.replace("[paper]", f"[paper]\n{level}")).paper.taught_mm
    for z in ("[110, 15, 0.5]", "[110, 15, -0.1]"):
        with refused("paper-tilted 0") as refusal:
            parse_cell(text.replace("[paper]", f"[paper]\n{level.replace('[110, 15, 0]', z)}"))
        assert refusal.value.where == "paper"
    with refused("paper-tilted 0"):
        parse_cell(text.replace("[paper]", "[paper]\norigin_mm = [0, 0, 1]"))


@pytest.mark.parametrize("towards", [(1, 0), (0, -1), (-0.6, 0.8)])
def test_a_wall_that_was_taught_facing_away_is_reported(towards):
    """A wall that was taught facing away from the robot is reported.

    The wall is in front of a robot that looks towards it. It is taught from left to right, and up.
    """
    x, y = towards
    left, right = ((600 * x - side * y, 600 * y + side * x, 300.0) for side in (150.0, -150.0))
    up = (left[0] + 40 * x, left[1] + 40 * y, 500.0)  # the wall leans back
    cell = replace(find_cell("ur5e"), workspace=replace(find_cell("ur5e").workspace, tilt_limit_deg=120.0))
    towards_it = replace(cell, paper=Paper(taught_mm=(left, right, up)))
    away = replace(cell, paper=Paper(taught_mm=(right, left, (*np.add(up, right)[:2] - left[:2], 500.0))))
    for each in (towards_it, away):
        check(each)
    assert [notice for notice in report_unusual_values(towards_it) if notice.code == "paper-faces-away"] == []
    assert are_reported(
        [notice for notice in report_unusual_values(away) if notice.where == "paper"], "paper-faces-away"
    )


def test_paper_that_leans_on_purpose_is_taught_after_its_limit_is_raised(tmp_path, capsys):
    taught = ("--taught=150,-550,200", "--taught=-140,-550,200", "--taught=150,-550,400")
    wall = str(tmp_path / "wall.toml")
    status, _, reported = in_json(capsys, "cell", "new", "-o", wall, "--like", "ur5e", *taught)
    assert status == 1 and is_reported(reported, "paper-tilted 90.00 0 15 workspace.tilt_limit_deg --like", "paper")
    shipped = find_cell("ur5e")
    leaning = replace(shipped, workspace=replace(shipped.workspace, tilt_limit_deg=90.0))
    (tmp_path / "base.toml").write_text(write_cell(leaning))
    status, _, reported = in_json(capsys, "cell", "new", "-o", wall, "--like", tmp_path / "base.toml", *taught)
    assert status == 0 and reported == []


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        ([(0, 0, 0), (5, 0, 0), (0, 99, 0)], "paper-taught 5.0"),
        ([(0, 0, 0), (99, 0, 0), (99, 3, 0)], "paper-taught 3.0"),
        ([(0, 0, 0), (99, 0, 0), (0, 99, 0), (99, 99, 0.8)], "paper-not-flat 0.80"),
        ([(0, 0, 0), (99, 0, 0), (0, 99, 9)], "paper-tilted 5.19"),
        ([(0, 0, 0), (0, 99, 0), (99, 0, 0)], "paper-tilted 180.00"),
    ],
)
def test_badly_taught_points_are_refused(points, expected):
    cell = replace(find_cell(), paper=Paper(taught_mm=tuple(tuple(map(float, point)) for point in points)))
    with refused(expected):
        parse_cell(write_cell(cell))


def test_right_angles_are_exact_and_tilt_follows_the_normal():
    assert (rotation((0, 0, 90)) == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]).all()
    assert (rotation((90, 0, 90)) @ [0, 1, 0] == [0, 0, 1]).all()
    assert normal_tilt_deg(frame_of_pose((0, 0, 0), (0, 30, 77))) == pytest.approx(30)
    assert (rotation((0, 0, -1e-15)) == np.eye(3)).all(), "so little below 0 is 360 once it is rounded"


def test_rotation_vectors_agree_with_the_matrix():
    import cv2

    random = np.random.default_rng(7)
    for angle in (0.0, 1e-9, 1e-3, 1.0, 3.0, np.pi - 1e-9, np.pi, *random.uniform(0, np.pi, 200)):
        axis = random.normal(size=3)
        turned = cv2.Rodrigues(axis / np.linalg.norm(axis) * angle)[0]
        assert cv2.Rodrigues(rotation_vector(turned))[0] == pytest.approx(turned, abs=1e-12)


def test_too_many_forbidden_boxes_are_refused_with_their_number():
    box = [[0, 0, 0], [1, 1, 1]]
    text = write_cell(find_cell()).replace("[workspace]", f"[workspace]\nkeep_out_mm = {[box] * 1001}")
    with refused("out-of-range workspace.keep_out_mm 1001 1000") as refusal:
        parse_cell(text)
    assert refusal.value.code == "out-of-range"


@pytest.mark.parametrize(
    ("value", "where", "target"),
    [
        ("7", "workspace.keep_out_mm", "2 rows of 3 numbers"),
        ("[[0, 0, 0], [1, 1, 1]]", "workspace.keep_out_mm[0]", "2 rows of 3 numbers"),
        (
            "[[[0, 0, 0], [1, 1, 1]], [[0, 0, 0], [1, 1]]]",
            "workspace.keep_out_mm[1][1]",
            "3 numbers, not [1, 1]",
        ),
        ("[[[0, 0, 0], [1, 'a', 1]]]", "workspace.keep_out_mm[0][1]", "a finite number, not a"),
        ("[[]]", "workspace.keep_out_mm[0]", "2 rows of 3 numbers"),
    ],
)
def test_malformed_forbidden_boxes_are_refused_with_index_and_shape(value, where, target):
    text = write_cell(find_cell()).replace("[workspace]", f"[workspace]\nkeep_out_mm = {value}")
    with refused(f"wrong-type {where} {target}") as refusal:
        parse_cell(text)
    assert refusal.value.where.startswith("workspace.keep_out_mm")


def test_a_new_cell_does_not_get_the_name_of_a_shipped_cell(tmp_path, monkeypatch, capsys):
    """A new cell does not get the name of a shipped cell.

    Otherwise, check would compare its program with the shipped cell and refuse it with a confusing message.
    """
    monkeypatch.chdir(tmp_path)
    taught = [f"--taught={place}" for place in ("-150,-450,20", "150,-450,20", "-150,-250,20")]
    assert main(["cell", "new", "-o", "ur5e.toml", "--like", "ur5e", *taught]) == 0
    assert read_cell("ur5e.toml").name not in cell_names()
    Path("a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="99mm" height="50mm" viewBox="0 0 99 50">'
        '<path d="M20 20L50 30" fill="none" stroke="#000" stroke-width="4"/></svg>'
    )
    assert main(["convert", "a.svg", "-o", "a.script", "--cell", "ur5e.toml"]) == 0
    status, _, reported = in_json(capsys, "check", "a.script", "a.svg")
    assert status == 1 and is_reported(reported, "cell-unknown my-ur5e"), reported
    assert in_json(capsys, "check", "a.script", "a.svg", "--cell", "ur5e.toml")[0] == 0


@pytest.mark.parametrize("line", ["decimals = {}", "version = {}", "arc_segment_mm = {}", "pause_per_colour = {}"])
def test_a_number_of_thousands_of_digits_is_refused(line):
    key = line.partition(" ")[0]
    lines = [each for each in write_cell(find_cell()).split("\n") if not each.startswith(key)]
    with refused("not-toml"):
        parse_cell("\n".join([line.format(f"0x{'f' * 5000}"), *lines]))


@pytest.mark.parametrize(
    ("table", "key", "value"),
    [
        ("heights", "safe_mm", np.float32(12)),
        ("heights", "safe_mm", np.linspace(10, 14, 3)[1]),
        ("paper", "origin_mm", np.array([1.0, 2.0, 3.0])),
        ("paper", "origin_mm", tuple(np.array([1.0, 2.0, 3.0]))),
        ("workspace", "keep_out_mm", np.array([[[0, 0, 0], [5, 5, 5.0]]])),
    ],
)
def test_numbers_of_numpy_in_a_cell_are_written_as_numbers(table, key, value):
    cell = find_cell()
    changed = replace(cell, **{table: replace(getattr(cell, table), **{key: value})})
    written = getattr(getattr(parse_cell(write_cell(changed)), table), key)
    assert np.array_equal(written, value)


def test_whole_numbers_and_truths_of_numpy_in_a_cell_are_written_as_such():
    cell = replace(find_cell(), decimals=np.int64(4), pause_per_colour=np.bool_(False))
    written = parse_cell(write_cell(cell))
    assert (written.decimals, written.pause_per_colour) == (4, False)
