"""Machines cut corners: by how much, and how the cuts change the mark."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnostics import are_reported
from programs import problems

from brushsvg import _core
from brushsvg.cli import main
from brushsvg.machine.cells.cell import Blending
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.machine.preflight import as_exact_as
from brushsvg.machine.realised.corner_blending import blend_radii, blend_radii_and_angles, cut_corners
from brushsvg.model.library import find_brush

CORNER = np.array([(0, 0, -2), (20, 0, -2), (20, 30, -2)], dtype=float)


def test_turns_are_the_angles_between_moves():
    path = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (2, 0, 0), (2, 0, 5)], dtype=float)
    assert blend_radii_and_angles(path, Blending(0.1))[1] == pytest.approx([0, 0, np.pi / 2, np.pi, np.pi / 2, 0])


@pytest.mark.parametrize("tolerance", [0.001, 0.01, 0.5])
def test_a_corner_is_cut_by_the_tolerance(tolerance):
    path, at, _ = cut_corners(CORNER, blend_radii(CORNER, Blending(tolerance)))
    away = np.linalg.norm(path - CORNER[1], axis=1)
    assert away.min() == pytest.approx(tolerance, rel=1e-6)
    assert at == pytest.approx([0, 1 - away[1] / 20, 1, 1 + away[3] / 30, 2])
    centre = CORNER[1] + (-away[1], away[1], 0)  # centre of the circle that touches both moves
    assert np.linalg.norm(path[1:4] - centre, axis=1) == pytest.approx([away[1]] * 3)


# The tool turns in place; the turn begins and ends across the stroke's direction.
QUARTER = _core.Arc(1, 3, (20.0, 5.0), 1)
TURN_IN_PLACE = np.array(
    [(0, 0, -2), (20, 0, -2), (20 + 5 * np.sqrt(0.5), 5 - 5 * np.sqrt(0.5), -2), (25, 5, -2), (9, 5, -2)]
)


def test_a_circle_has_a_corner_only_at_a_change_of_direction():
    assert blend_radii_and_angles(TURN_IN_PLACE, Blending(0.1), [QUARTER])[1] == pytest.approx([0, 0, 0, np.pi / 2, 0])


@pytest.mark.parametrize("tolerance", [0.001, 0.02, 0.1])
def test_corners_of_circles_are_cut_like_corners_of_lines(tolerance):
    radii = blend_radii(TURN_IN_PLACE, Blending(tolerance), [QUARTER])
    path, at, points = cut_corners(TURN_IN_PLACE, radii, [QUARTER])
    assert len(path) == 7
    away = np.linalg.norm(path[3:6] - TURN_IN_PLACE[3], axis=1)
    assert away[1] == pytest.approx(tolerance)
    assert away[[0, 2]] == pytest.approx([away[2]] * 2, rel=1e-3), "as far before as after"
    assert points.tolist() == [[0, 0], [1, 1], [2, 2], [3, 5], [6, 6]]
    assert np.hypot(*(path[1:4, :2] - QUARTER.centre_mm).T) == pytest.approx([5] * 3)
    assert at == pytest.approx([0, 1, 2, 3 - radii[3] / (5 * np.pi / 4), 3, 3 + radii[3] / 16, 4])


def test_the_blend_at_a_small_angle_starts_close_to_the_end_of_the_circle():
    """The blend at a small angle starts close to the end of the circle.

    Otherwise the arc that the blend leaves out would be further from its chord than the tolerance.
    """
    path = TURN_IN_PLACE.copy()
    path[4] = (24, 20, -2)
    radii = blend_radii(path, Blending(0.01), [QUARTER])
    assert radii[3] ** 2 / (2 * 5) <= 0.01 / 2 + 1e-12
    assert 2 * radii[3] ** 2 / (2 * 5) > 0.005, "but no nearer than needed"


def test_a_robot_stops_where_a_circle_begins_and_ends():
    assert (blend_radii(TURN_IN_PLACE, Blending(0.1, 5.0), [QUARTER]) == 0).all()


def test_blends_do_not_overlap_or_exceed_the_robots_radius():
    zigzag = np.array([(k, k % 2, -1) for k in range(20)], dtype=float)
    lengths = np.linalg.norm(np.diff(zigzag, axis=0), axis=1)
    radii = blend_radii(zigzag, Blending(9.0))
    assert (radii[1:] + radii[:-1] < lengths).all()
    assert blend_radii(zigzag, Blending(9.0, 0.2)).max() == 0.2


def test_a_robot_does_not_blend_where_it_turns_back_or_presses():
    path = np.array([(0, 0, 0), (9, 0, 0), (1, 0.5, 0), (9, 1, 0), (9, 1, -2), (20, 1, -2)], dtype=float)
    assert (blend_radii(path, Blending(0.1, 5.0)) == 0).all()
    assert (blend_radii(path, Blending(0.1)) > 0).any()


def test_corners_in_the_air_are_cut_little_with_a_coarse_tolerance():
    """Corners in the air are cut by little, even with a coarse tolerance.

    With 2 mm the tool moved sideways from 4.8 mm below the safe height on.
    """
    cell = find_cell("linuxcnc-3axis")
    coarse = replace(cell, blending=replace(cell.blending, tolerance_mm=2.0))
    assert as_exact_as(coarse, 10.0).blending.tolerance_mm == pytest.approx(0.04)
    assert as_exact_as(coarse, 0.05).blending.tolerance_mm == pytest.approx(0.01)


def test_zero_tolerance_leaves_the_path_unchanged():
    assert cut_corners(CORNER, blend_radii(CORNER, Blending(0.0)))[0] is CORNER


def marks_and_plan(brush):
    poses = [(10, 20, 0), (16, 20, -3), (40, 20, -3), (40, 45, -3), (40, 44, 0)]
    plan = _core.Plan(brush.name, "", (80.0, 80.0), [_core.Pass("angle", np.array(poses, float), 20.0)])
    return plan, _core.simulate(plan, brush)


def test_blends_that_move_the_mark_too_far_are_refused():
    brush = find_brush("round-6")
    plan, marks = marks_and_plan(brush)
    wide = replace(find_cell(), blending=Blending(2.0))
    assert are_reported(problems(plan, brush, marks, wide, 0.05), "shifted-by-blends angle 2 linuxcnc-3axis")
    assert problems(plan, brush, marks, wide, 5.0) == []
    assert problems(plan, brush, marks, as_exact_as(wide, 0.05), 0.05) == []


@pytest.mark.parametrize("cut_mm", [0.0005, 0.005, 0.05, 0.2, 0.5])
def test_a_cut_moves_the_mark_by_at_most_the_size_of_the_cut(cut_mm):
    """A cut moves the mark by no more than the cut itself.

    The reference is the position of the widest section on the plan's own mark.
    """
    brush = find_brush("round-6")
    plan, marks = marks_and_plan(brush)
    cell = replace(find_cell(), blending=Blending(cut_mm))
    assert problems(plan, brush, marks, cell, 1.15 * cut_mm) == []
    assert problems(plan, brush, marks, cell, 0.5 * cut_mm) != []


def with_circle(brush):
    poses = [
        (10, 20, 0),
        (16, 20, -3),
        (40, 20, -3),
        *((40 + 9 * np.sin(a), 29 - 9 * np.cos(a), -3) for a in (1, 2)),
    ]
    poses += [(60, 30, -3), (60, 29, 0)]
    arc = _core.Arc(2, 4, (40.0, 29.0), 1)
    return _core.Plan(brush.name, "", (80.0, 80.0), [_core.Pass("round", np.array(poses, float), 20.0, arcs=[arc])])


@pytest.mark.parametrize("cut_mm", [0.0005, 0.005, 0.05])
def test_a_circle_is_not_treated_as_a_row_of_corners(cut_mm):
    """A circle is not treated as a row of corners.

    Its poses may be far apart; only its end has a corner that can be cut.
    """
    brush = find_brush("round-6")
    plan = with_circle(brush)
    marks = _core.simulate(plan, brush)
    cell = replace(find_cell(), blending=Blending(cut_mm))
    assert problems(plan, brush, marks, cell, 1.15 * cut_mm) == []
    assert problems(plan, brush, marks, cell, 0.3 * cut_mm) != []


@pytest.mark.parametrize("tolerance", ["0.005", "0.002", "0.0005"])
def test_a_very_fine_tolerance_is_accepted(tolerance, tmp_path):
    """A very fine tolerance does not cause a refusal.

    The check once treated straight chords between rows of the mark as the mark itself.
    """
    robot = Path(__file__).parents[2] / "examples" / "robot.svg"
    assert main(["convert", str(robot), "-o", str(tmp_path / "out.ngc"), "--tolerance", tolerance]) == 0


@pytest.mark.parametrize("cell", ["linuxcnc-3axis", "ur5e"])
@pytest.mark.parametrize("first_mm", [0.0, -3.0])
@pytest.mark.parametrize("last_mm", [0.0, -4.0])
def test_a_plan_may_begin_and_end_pressed_down(first_mm, last_mm, cell):
    """A plan may begin and end pressed down.

    All rows of a landing or lift in place have one pose. They were once compared with each other's places, so
    the mark seemed to move by its own lag.
    """
    poses = [(40, 40, first_mm), (60, 40, -4), (100, 40, -4), (130, 40.5, -4), (131, 40.5, last_mm)]
    plan = _core.Plan("round-6", "", (200.0, 100.0), [_core.Pass("a", np.array(poses, float), 20.0)])
    brush = find_brush("round-6")
    tight = replace(find_cell(cell), workspace=find_cell().workspace)
    assert problems(plan, brush, _core.simulate(plan, brush), tight, 0.05) == []


def test_zero_tolerance_gives_no_blends_and_repeated_points_are_not_corners():
    line = np.array([[0, 0, -1], [5, 0, -1], [10, 0, -1.0]])
    assert not blend_radii(line, Blending(tolerance_mm=0.0)).any()
    twice = np.array([[0, 0, -1], [5, 0, -1], [5, 0, -1], [5, 5, -1.0]])
    assert np.array_equal(cut_corners(twice, np.array([0.0, 1.0, 1.0, 0.0]))[0], twice)
    once = np.array([[4, 0, -1], [5, 0, -1], [5, 1, -1.0]])
    path, _, _ = cut_corners(once, np.array([0.0, 0.3, 0.0]))
    assert len(path) == 5  # A move of exactly 1 mm is cut like any other move.
