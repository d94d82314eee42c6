"""Cells: every key read, checked and written back; the paper's frame by pose and by taught points."""

from dataclasses import replace

import numpy as np
import pytest

from brushsvg.cell import Paper, Reload, Servo, Station, robot_from_paper
from brushsvg.cell_file import SHIPPED, cell_names, find_cell, read_cell, write_cell
from brushsvg.errors import Error
from brushsvg.frame import frame_of_pose, moved, normal_tilt_deg, rotation, rotation_vector
from brushsvg.posts import POSTS

TEXT = (SHIPPED / "linuxcnc-3axis.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", cell_names())
def test_every_shipped_cell_loads_and_is_as_written_by_the_tool(name):
    cell = find_cell(name)
    assert cell.name == name
    assert write_cell(cell) == (SHIPPED / f"{name}.toml").read_text(encoding="utf-8")
    assert (cell.language in POSTS) == (name != "jaka-zu3")
    assert cell.paper.example == (cell.tool is not None), "a robot's paper must be taught"


@pytest.mark.parametrize(
    ("old", "new", "where", "words"),
    [
        ("press_mm_s = 8.0", "", "speeds.press_mm_s", "lacks the key speeds.press_mm_s"),
        ("press_mm_s = 8.0", "press_mm_s = 8.0\npress = 3", "speeds.press", "known here: travel_mm_s"),
        ("press_mm_s = 8.0", 'press_mm_s = "8"', "speeds.press_mm_s", "must be a finite number, not 8"),
        ("press_mm_s = 8.0", "press_mm_s = nan", "speeds.press_mm_s", "finite number, not nan"),
        ("press_mm_s = 8.0", "press_mm_s = true", "speeds.press_mm_s", "finite number, not True"),
        ("press_mm_s = 8.0", "press_mm_s = 0", "speeds.press_mm_s", "0 is outside the range [0.01, 10000]"),
        ("decimals = 4", "decimals = 4.0", "decimals", "a whole number"),
        ("decimals = 4", "decimals = 9", "decimals", "9 is outside the range [1, 6]"),
        ("safe_mm = 10.0", "safe_mm = 0.5", "heights.clearance_mm", "must not be above safe_mm 0.5"),
        ("lowest_mm = -20.0", "lowest_mm = 20", "heights.lowest_mm", "outside the range [-1000, -0.01]"),
        ("margin_mm = 30.0", "margin_mm = -1", "workspace.margin_mm", "outside the range [0, 10000]"),
        (
            "margin_mm = 30.0",
            "margin_mm = 30.0\nreach_mm = [9, 2]",
            "workspace.reach_mm",
            "below the greatest",
        ),
        ("margin_mm = 30.0", "margin_mm = 3\nbox_mm = [[0, 0, 0]]", "workspace.box_mm", "must be 2 rows"),
        ("margin_mm = 30.0", "margin_mm = 3\nbox_mm = [[0, 0, 0], [1, 1]]", "workspace.box_mm", "3 numbers"),
        (
            "margin_mm = 30.0",
            "margin_mm = 3\nbox_mm = [[0, 5, 0], [1, 1, 1]]",
            "workspace.box_mm",
            "lower one",
        ),
        ('name = "linuxcnc-3axis"', 'name = "a\\nb"', "name", "one line of text"),
        ("[speeds]", "[speed]", "speeds", "lacks the table speeds"),
        ("[workspace]", "[[workspace]]", "workspace", "must be a table"),
        ("version = 1", "version = 2", "version", "version 2 of the cell file is not known"),
        ('format = "brushsvg/cell"', "", "format", "is not a cell"),
        ("decimals = 4", "decimals = ", "", "not TOML"),
        (
            "[paper]",
            "[paper]\nrotation_deg = [3, 0, 0]",
            "paper",
            "leans 3.00 degrees, outside the range [0, 2]",
        ),
        ("[paper]", "[paper]\ntaught_mm = [[0, 0, 0]]", "paper.taught_mm", "1 points were taught"),
    ],
)
def test_a_faulty_cell_is_refused_by_key(old, new, where, words):
    assert old in TEXT
    with pytest.raises(Error) as refusal:
        read_cell(TEXT.replace(old, new))
    assert (refusal.value.where, words in str(refusal.value)) == (where, True), str(refusal.value)


FULL = replace(
    find_cell("ur5e"),
    description="\u00e9criture, \"quoted\" \\ and 'plain'",
    paper=Paper(
        taught_mm=((0.0, 0.0, 1.0), (200.0, 0.0, 1.0), (0.0, 150.0, 1.5), (100.0, 100.0, 1.2)),
        flatness_mm=0.4,
    ),
    servo=Servo(((-30.0, 100.0), (0.0, 500.0), (30.0, 900.0)), 0.2, 0.1),
    reload=Reload("length", 120.0, 4.0, "water"),
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
    ("station", "words"),
    [
        (Station("ink", (1.0, 2.0), depth_mm=25.0), "it dips to -25 mm, below lowest_mm -20"),
        (
            Station("ink", (1.0, 2.0), surface_mm=5.0, depth_mm=2.0),
            "rim_mm 0 is outside the range [5, 18] mm",
        ),
        (
            Station("ink", (1.0, 2.0), depth_mm=2.0, wipe_mm=((0.0, 0.0, -3.0),)),
            "a wipe at -3 mm is outside the range [0, 20]",
        ),
        (Station("ink", (1.0, 2.0), by_hand=True), "a servo's brush falls while the program waits"),
    ],
)
def test_a_station_that_the_tool_cannot_visit_is_refused(station, words):
    with pytest.raises(Error) as refusal:
        read_cell(write_cell(replace(FULL, stations=(station,), reload=Reload("stroke"))))
    assert words in str(refusal.value)


def test_what_is_written_is_read_back():
    assert read_cell(write_cell(FULL)) == FULL


@pytest.mark.parametrize(
    ("change", "where", "words"),
    [
        ({"reload": None}, "reload", "stations need a table reload"),
        ({"stations": ()}, "reload", "no station to reload at"),
        ({"reload": Reload("hourly")}, "reload.when", "'hourly' is none of length, stroke, layer"),
        ({"reload": Reload("stroke", wash="tea")}, "reload.wash", "there is no station 'tea'"),
        ({"stations": (FULL.stations[0], FULL.stations[0])}, "station 2", "'ink' is given twice"),
        ({"stations": (Station("ink", (1.0, 2.0)),)}, "station 1", "depth_mm 0 takes no paint"),
        (
            {"stations": (Station("ink", (1.0, 2.0), depth_mm=5.0, rim_mm=19.0),)},
            "station 1",
            "rim_mm 19 is outside the range [0, 18] mm",
        ),
        ({"servo": Servo(((0.0, 1.0), (0.0, 2.0)))}, "servo.table", "steadily rising or falling"),
        ({"servo": Servo(((0.0, 1.0), (9.0, 2.0)))}, "servo.table", "must hold lowest_mm -20 and safe_mm 20"),
        ({"servo": Servo(((-30.0, -1.0), (30.0, 2.0)))}, "servo.table", "value -1 is below 0"),
    ],
)
def test_what_no_single_key_tells_is_refused_too(change, where, words):
    with pytest.raises(Error) as refusal:
        read_cell(write_cell(replace(FULL, **change)))
    assert (refusal.value.where, words in str(refusal.value)) == (where, True), str(refusal.value)


def test_the_frame_of_taught_points_is_where_they_were():
    truth = frame_of_pose((120.0, -340.0, 25.0), (1.0, -0.5, 37.0))
    on_paper = np.array([(0, 0, 0), (210, 0, 0), (14, 150, 0), (180, 120, 0)], dtype=float)
    taught = tuple(map(tuple, moved(truth, on_paper).tolist()))
    cell = replace(FULL, paper=Paper(taught_mm=taught))
    assert robot_from_paper(cell) == pytest.approx(truth, abs=1e-9)
    higher = robot_from_paper(cell, 2.0)
    assert higher[:3, 3] - truth[:3, 3] == pytest.approx(2.0 * truth[:3, 2])


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(0, 0, 0), (5, 0, 0), (0, 99, 0)], "the second point lies 5.0 mm from the first"),
        ([(0, 0, 0), (99, 0, 0), (99, 3, 0)], "3.0 mm beside the line of the other two"),
        ([(0, 0, 0), (99, 0, 0), (0, 99, 0), (99, 99, 0.8)], "0.80 mm off the plane"),
        ([(0, 0, 0), (99, 0, 0), (0, 99, 9)], "leans 5.19 degrees"),
        ([(0, 0, 0), (0, 99, 0), (99, 0, 0)], "leans 180.00 degrees"),
    ],
)
def test_badly_taught_points_are_refused(points, words):
    cell = replace(find_cell(), paper=Paper(taught_mm=tuple(tuple(map(float, point)) for point in points)))
    with pytest.raises(Error) as refusal:
        read_cell(write_cell(cell))
    assert words in str(refusal.value)


def test_right_angles_are_exact_and_tilt_is_the_normals():
    assert (rotation((0, 0, 90)) == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]).all()
    assert (rotation((90, 0, 90)) @ [0, 1, 0] == [0, 0, 1]).all()
    assert normal_tilt_deg(frame_of_pose((0, 0, 0), (0, 30, 77))) == pytest.approx(30)


def test_rotation_vectors_turn_as_the_matrix_does():
    import cv2

    random = np.random.default_rng(7)
    for angle in (0.0, 1e-9, 1e-3, 1.0, 3.0, np.pi - 1e-9, np.pi, *random.uniform(0, np.pi, 200)):
        axis = random.normal(size=3)
        turned = cv2.Rodrigues(axis / np.linalg.norm(axis) * angle)[0]
        assert cv2.Rodrigues(rotation_vector(turned))[0] == pytest.approx(turned, abs=1e-12)
