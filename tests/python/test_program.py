"""The program of a plan: its moves, their speeds, and the plans that are refused."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnostics import are_reported, refused
from programs import forbidden, program, whole

from brushsvg import _core
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.job_program import Job, unchecked_program
from brushsvg.machine.moves import MEANINGS_AT_SAFE_HEIGHT, duration_s


def plan_of(*poses, speed=20.0, sheet=(100.0, 60.0)):
    passes = [
        SimpleNamespace(stroke=f"s{k}", poses_mm=np.array(p, float), speed_mm_s=speed, arcs=(), tool_axes=(), colour="")
        for k, p in enumerate(poses, 1)
    ]
    return SimpleNamespace(sheet_mm=sheet, passes=passes)


def brush_of(limit=25.0):
    return SimpleNamespace(name="hog", max_speed_mm_s=limit)


BRUSH = brush_of()
STROKE = [(10, 10, 0), (12, 10, -3), (30, 20, -3), (28, 20, 0)]


def test_a_stroke_has_its_moves_in_order_with_their_meaning():
    made = program(plan_of(STROKE, [(50, 50, 0), (60, 50, -1)]), BRUSH, find_cell())
    sections = list(made.sections())
    assert [section.title for section in sections] == ["stroke 1 of 2: s1", "stroke 2 of 2: s2"]
    moves = sections[0].moves
    assert [move.meaning for move in moves] == ["travel", "approach", "land", "paint", "lift", "retract"]
    assert np.vstack([moves[2].points_mm, moves[3].points_mm]) == pytest.approx(np.array(STROKE, float))


def test_moves_near_the_paper_are_slow_and_vertical():
    cell = find_cell()
    made = program(plan_of(STROKE, [(50, 50, -2), (60, 50, -2)], speed=5.0), BRUSH, cell)
    at = np.array([0.0, 0.0, cell.heights.safe_mm])
    for move in (move for section in made.sections() for move in section.moves):
        for point in move.points_mm:
            if min(at[2], point[2]) < cell.heights.safe_mm and move.meaning != "paint":
                assert at[:2] == pytest.approx(point[:2]), f"{move.meaning} runs sideways"
            if min(at[2], point[2]) < cell.heights.clearance_mm:
                assert move.speed_mm_s <= 5.0
                assert move.meaning not in MEANINGS_AT_SAFE_HEIGHT
            at = point


def test_a_pass_of_one_pose_is_a_dab():
    moves = program(plan_of([(10, 10, -2)]), BRUSH, find_cell())
    moves = next(moves.sections()).moves
    assert [move.meaning for move in moves] == ["travel", "approach", "land", "lift", "retract"]


def moving_s(length, speed, acceleration=500.0):
    ramp = speed / acceleration
    assert length > speed * ramp
    return length / speed + ramp


def test_duration_counts_every_move_at_its_speed_from_rest_to_rest():
    cell, fast = find_cell(), brush_of(40.0)
    expected = moving_s(9, 30) + moving_s(1, 8) + moving_s(30, 20) + moving_s(1, 8) + moving_s(9, 60)
    line = [(0, 0, 0), (30, 0, 0)]
    assert duration_s(unchecked_program(whole(plan_of(line)), fast, cell)) == pytest.approx(expected)
    twice = duration_s(unchecked_program(whole(plan_of(line, line)), fast, cell))
    assert twice == pytest.approx(2 * expected + moving_s(30, 60))
    slowed = expected + moving_s(9, 25) - moving_s(9, 30)
    assert duration_s(unchecked_program(whole(plan_of(line)), BRUSH, cell)) == pytest.approx(slowed)


def test_a_job_may_start_at_a_later_stroke_and_on_higher_paper():
    plan = plan_of(STROKE, STROKE, STROKE)
    made = program(plan, BRUSH, find_cell(), (), Job(z_offset_mm=0.25, first_stroke=2))
    assert [section.title for section in made.sections()] == ["stroke 2 of 3: s2", "stroke 3 of 3: s3"]
    assert made.robot_from_frame[2, 3] == 0.25
    with refused("stroke-unknown 4 '[1, 3]'"):
        program(plan, BRUSH, find_cell(), (), Job(first_stroke=4))


@pytest.mark.parametrize(
    ("poses", "expected"),
    [
        ([(10, 10, 0), (130.5, 10, -1)], "tool-off-sheet 0.50 right"),
        ([(-31.25, 10, 0), (10, 10, -1)], "tool-off-sheet 1.25 left"),
        ([(10, 95, 0), (10, 10, -1)], "tool-off-sheet 5.00 upper"),
        ([(10, -32, 0), (10, 10, -1)], "tool-off-sheet 2.00 lower"),
        ([(10, 10, 0), (20, 10, -20.5)], "too-low -20.5 '[-20.0, 0.0] mm'"),
        ([(10, 10, -1), (20, 10, 0.25)], "above-paper 0.250"),
        ([(10, 10, 0), (np.nan, 10, -1)], "not-finite"),
        (np.zeros((0, 3)), "pass-empty"),
    ],
)
def test_exceeded_limits_are_reported_with_stroke_and_value(poses, expected):
    plan = plan_of(STROKE, poses)
    assert are_reported(forbidden(plan, BRUSH, find_cell()), f"{expected} s2")
    with refused(expected, "s2"):
        program(plan, BRUSH, find_cell())


def test_speed_limits_and_empty_plans_are_refused():
    speed = "speed-out-of-range s1 51 '[0.000001, {}] mm/s' '{}'".format
    too_fast = forbidden(plan_of(STROKE, speed=51.0), brush_of(80.0), find_cell())
    assert are_reported(too_fast, speed("50", "cell linuxcnc-3axis"))
    too_fast = forbidden(plan_of(STROKE, speed=51.0), BRUSH, find_cell())
    assert are_reported(too_fast, speed("25", "brush hog"))
    with refused("speed-out-of-range 25.1 hog"):
        program(plan_of(STROKE, speed=25.1), BRUSH, find_cell())
    assert len(forbidden(plan_of(STROKE, speed=float("nan")), BRUSH, find_cell())) == 1
    (nothing,) = forbidden(plan_of(), BRUSH, find_cell())
    assert (nothing.where, nothing.code) == ("", "nothing-to-paint")


@pytest.mark.parametrize("limit", [40.0, 25.0, 3.0])
def test_moves_down_and_up_respect_the_speed_limit_of_the_brush(limit):
    cell = find_cell()
    made = program(plan_of(STROKE, speed=min(limit, 20.0)), brush_of(limit), cell)
    speeds = {move.meaning: move.speed_mm_s for move in next(made.sections()).moves}
    assert speeds["approach"] == min(cell.speeds.approach_mm_s, limit)
    assert all(speed <= limit for meaning, speed in speeds.items() if meaning not in MEANINGS_AT_SAFE_HEIGHT)


def test_workspace_limits_are_exact():
    assert forbidden(plan_of([(-30, -30, 0), (130, 90, -1)]), BRUSH, find_cell()) == []


def test_a_pass_that_never_presses_is_refused():
    (found,) = forbidden(plan_of([(10, 10, 0), (20, 10, 0)]), brush_of(25.0), find_cell())
    assert (found.where, found.code) == ("s1", "never-pressed")


def test_a_pass_is_refused_if_rounding_leaves_nothing_of_its_depth():
    """Each pose 0.0015 mm deep is less than the shortest move from one that stays, so no program would paint."""
    plan = _core.Plan("b", "", (100, 60), [_core.Pass("s1", [(10, 10, 0), (10, 10, -0.0015), (20, 10, 0)], 20.0)])
    (found,) = forbidden(plan, brush_of(25.0), find_cell("grbl-3axis"))
    assert (found.where, found.code) == ("s1", "never-pressed")
