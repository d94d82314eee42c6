"""Cell and program: what the robot does with a plan, and what it refuses."""

from importlib.resources import files
from types import SimpleNamespace

import numpy as np
import pytest

from brushsvg.cell import find_cell, read_cell
from brushsvg.errors import Error
from brushsvg.posts import POSTS
from brushsvg.program import SAFE_MEANINGS, broken_limits, duration_s, program

CELLS = sorted(files("brushsvg").joinpath("data", "cells").iterdir(), key=lambda file: file.name)


def plan_of(*poses, speed=20.0, sheet=(100.0, 60.0)):
    passes = [
        SimpleNamespace(stroke=f"s{k}", poses_mm=np.array(p, float), speed_mm_s=speed)
        for k, p in enumerate(poses, 1)
    ]
    return SimpleNamespace(sheet_mm=sheet, passes=passes)


def brush_of(limit=25.0):
    return SimpleNamespace(name="hog", max_speed_mm_s=limit)


BRUSH = brush_of()
STROKE = [(10, 10, 0), (12, 10, -3), (30, 20, -3), (28, 20, 0)]


@pytest.mark.parametrize("file", CELLS, ids=lambda file: file.name)
def test_every_shipped_cell_loads(file):
    cell = read_cell(file.read_text())
    assert f"{cell.name}.toml" == file.name
    assert find_cell(cell.name) == cell
    assert cell.language in POSTS


@pytest.mark.parametrize(
    ("old", "new", "where"),
    [
        ("press_mm_s = 8.0", "", "press_mm_s"),
        ("press_mm_s = 8.0", "press_mm_s = 8.0\npress_speed = 3", "press_speed"),
        ("press_mm_s = 8.0", 'press_mm_s = "8"', "press_mm_s"),
        ("press_mm_s = 8.0", "press_mm_s = nan", "press_mm_s"),
        ("press_mm_s = 8.0", "press_mm_s = 0", "press_mm_s"),
        ("decimals = 4", "decimals = 4.0", "decimals"),
        ("decimals = 4", "decimals = 9", "decimals"),
        ("safe_height_mm = 10.0", "safe_height_mm = 0.5", "safe_height_mm"),
        ("z_range_mm = [-20.0, 60.0]", "z_range_mm = [60.0, -20.0]", "z_range_mm"),
        ("z_range_mm = [-20.0, 60.0]", "z_range_mm = [60.0]", "z_range_mm"),
        ("workspace_margin_mm = 30.0", "workspace_margin_mm = -1", "workspace_margin_mm"),
        ("decimals = 4", "decimals = ", ""),
    ],
)
def test_a_faulty_cell_is_refused_by_key(old, new, where):
    text = next(file for file in CELLS if file.stem == "linuxcnc-3axis").read_text()
    assert old in text
    with pytest.raises(Error) as refusal:
        read_cell(text.replace(old, new))
    assert refusal.value.where == where


def test_moves_in_order_with_their_meaning():
    made = program(plan_of(STROKE, [(50, 50, 0), (60, 50, -1)]), BRUSH, find_cell())
    assert [section.stroke for section in made.sections] == ["s1", "s2"]
    moves = made.sections[0].moves
    assert [move.meaning for move in moves] == ["travel", "approach", "land", "paint", "lift", "retract"]
    assert np.vstack([moves[2].points_mm, moves[3].points_mm]) == pytest.approx(np.array(STROKE, float))


def test_nothing_fast_or_sideways_near_the_paper():
    cell = find_cell()
    made = program(plan_of(STROKE, [(50, 50, -2), (60, 50, -2)], speed=5.0), BRUSH, cell)
    at = np.array([0.0, 0.0, cell.safe_height_mm])
    for move in (move for section in made.sections for move in section.moves):
        for point in move.points_mm:
            if min(at[2], point[2]) < cell.safe_height_mm and move.meaning != "paint":
                assert at[:2] == pytest.approx(point[:2]), f"{move.meaning} runs sideways"
            if min(at[2], point[2]) < cell.clearance_mm:
                assert move.speed_mm_s <= 5.0
                assert move.meaning not in SAFE_MEANINGS
            at = point


def test_a_pass_of_one_pose_is_a_dab():
    moves = program(plan_of([(10, 10, -2)]), BRUSH, find_cell()).sections[0].moves
    assert [move.meaning for move in moves] == ["travel", "approach", "land", "lift", "retract"]


def test_duration_counts_every_way_at_its_speed():
    cell = find_cell()
    expected = (10 - 1) / 30 + 1 / 8 + 30 / 20 + 1 / 8 + (10 - 1) / 60
    fast = brush_of(40.0)
    assert duration_s(plan_of([(0, 0, 0), (30, 0, 0)]), fast, cell) == pytest.approx(expected)
    twice = duration_s(plan_of([(0, 0, 0), (30, 0, 0)], [(0, 0, 0), (30, 0, 0)]), fast, cell)
    assert twice == pytest.approx(2 * expected + 30 / 60)
    slowed = expected + (10 - 1) / 25 - (10 - 1) / 30
    assert duration_s(plan_of([(0, 0, 0), (30, 0, 0)]), BRUSH, cell) == pytest.approx(slowed)


@pytest.mark.parametrize(
    ("poses", "words"),
    [
        ([(10, 10, 0), (130.5, 10, -1)], "0.50 mm beyond the right edge of the workspace"),
        ([(-31.25, 10, 0), (10, 10, -1)], "1.25 mm beyond the left edge"),
        ([(10, 95, 0), (10, 10, -1)], "5.00 mm beyond the upper edge"),
        ([(10, -32, 0), (10, 10, -1)], "2.00 mm beyond the lower edge"),
        ([(10, 10, 0), (20, 10, -20.5)], "height -20.5 mm is outside the range [-20.0, 60.0] mm"),
        ([(10, 10, -1), (20, 10, 0.25)], "height 0.250 mm inside a pass is above the paper"),
        ([(10, 10, 0), (np.nan, 10, -1)], "not a finite number"),
        (np.zeros((0, 3)), "no poses"),
    ],
)
def test_limits_are_named_with_stroke_and_number(poses, words):
    plan = plan_of(STROKE, poses)
    broken = broken_limits(plan, BRUSH, find_cell())
    assert [(where, words in sentence) for where, sentence in broken] == [("s2", True)]
    with pytest.raises(Error) as refusal:
        program(plan, BRUSH, find_cell())
    assert refusal.value.where == "s2"
    assert words in str(refusal.value)


def test_speed_limits_and_nothing_to_paint():
    too_fast = broken_limits(plan_of(STROKE, speed=51.0), brush_of(80.0), find_cell())
    assert too_fast == [("s1", "speed 51.0 mm/s is outside the range (0, 50.0] mm/s of cell linuxcnc-3axis")]
    too_fast = broken_limits(plan_of(STROKE, speed=51.0), BRUSH, find_cell())
    assert too_fast == [("s1", "speed 51.0 mm/s is outside the range (0, 25.0] mm/s of brush hog")]
    with pytest.raises(Error, match="brush hog"):
        program(plan_of(STROKE, speed=25.1), BRUSH, find_cell())
    assert len(broken_limits(plan_of(STROKE, speed=float("nan")), BRUSH, find_cell())) == 1
    assert broken_limits(plan_of(), BRUSH, find_cell()) == [("", "there is nothing to paint")]


@pytest.mark.parametrize("limit", [40.0, 25.0, 3.0])
def test_no_move_on_the_way_down_or_up_is_faster_than_the_brush_may_go(limit):
    cell = find_cell()
    made = program(plan_of(STROKE, speed=min(limit, 20.0)), brush_of(limit), cell)
    speeds = {move.meaning: move.speed_mm_s for move in made.sections[0].moves}
    assert speeds["approach"] == min(cell.approach_mm_s, limit)
    assert all(speed <= limit for meaning, speed in speeds.items() if meaning not in SAFE_MEANINGS)


def test_the_workspace_ends_where_it_says():
    assert broken_limits(plan_of([(-30, -30, 0), (130, 90, -1)]), BRUSH, find_cell()) == []


def test_a_pass_that_never_presses_is_refused():
    (found,) = broken_limits(plan_of([(10, 10, 0), (20, 10, 0)]), brush_of(25.0), find_cell())
    assert found[1] == "the brush is never pressed to the paper: nothing would be painted"
