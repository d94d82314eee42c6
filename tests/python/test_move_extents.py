"""Extents of lines and circles by formula agree with a thousand points on each.

The points are found in another way than the formulas.
"""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from brushsvg.machine.cells.cell import Blending
from brushsvg.machine.frames import frame_of_pose, transform_points
from brushsvg.machine.limits.move_extents import (
    distances_from_origin,
    find_place_inside,
    make_paths,
    measure_bounds,
    paths_in_frame,
)
from brushsvg.machine.realised.corner_blending import blend_radii, cut_corners

COUNT = 1500
LENGTH = st.floats(-300, 300)
POINT = st.tuples(LENGTH, LENGTH, LENGTH)
ANGLE = st.floats(-180, 180)
FRAME = st.builds(frame_of_pose, POINT, st.tuples(ANGLE, ANGLE, ANGLE))


FLAT = st.just(0.0)


@st.composite
def circles(draw, rise=FLAT):
    """Draw (start, end, (x, y, turn)) and the sweep [rad] of a circle.

    The formula must recover the sweep.
    """
    x, y, z = draw(POINT)
    radius, first = draw(st.floats(0.5, 300)), draw(st.floats(-4, 4))
    turn, sweep = draw(st.sampled_from([1, -1])), draw(st.floats(0.01, 6.2))
    places = [complex(x, y) + cmath.rect(radius, angle) for angle in (first, first + turn * sweep)]
    start, end = ((place.real, place.imag, height) for place, height in zip(places, (z, z + draw(rise)), strict=True))
    return start, end, (x, y, turn), sweep


def sampled(circle) -> np.ndarray:
    """Return points along a circle: its start, turned about its centre step by step."""
    start, end, (x, y, turn), sweep = circle
    shares = np.linspace(0, 1, COUNT)
    spoke = complex(start[0] - x, start[1] - y)
    on = complex(x, y) + spoke * np.exp(1j * turn * sweep * shares)
    return np.column_stack([on.real, on.imag, start[2] + (end[2] - start[2]) * shares])


def both(frame, start, end, circle):
    """Return a line and a circle in a frame, points along both, and the step in mm."""
    line = np.linspace(start, end, COUNT)
    return (
        paths_in_frame(frame, make_paths([[start, end]], [circle[:3]])),
        transform_points(frame, np.vstack([line, sampled(circle)])),
        max(math.dist(start, end), np.linalg.norm(np.diff(sampled(circle), axis=0), axis=1).sum()) / COUNT,
    )


@given(FRAME, POINT, POINT, circles())
@pytest.mark.slow
def test_extents_and_distances_match_sampled_points(frame, start, end, circle):
    some, places, step_mm = both(frame, start, end, circle)
    low, high = measure_bounds(some)
    assert low == pytest.approx(places.min(axis=0), abs=step_mm) and (low <= places.min(axis=0) + 1e-9).all()
    assert high == pytest.approx(places.max(axis=0), abs=step_mm) and (high >= places.max(axis=0) - 1e-9).all()
    away = np.linalg.norm(places, axis=1)
    nearest, farthest = distances_from_origin(some)
    assert nearest == pytest.approx(away.min(), abs=step_mm) and nearest <= away.min() + 1e-9
    assert farthest == pytest.approx(away.max(), abs=step_mm) and farthest >= away.max() - 1e-9


@given(FRAME, POINT, POINT, circles(), POINT, st.tuples(*[st.floats(0.5, 300)] * 3))
def test_a_path_through_a_box_is_found_inside_it(frame, start, end, circle, corner, size):
    low, high = np.array(corner), np.add(corner, size)
    some, places, step_mm = both(frame, start, end, circle)
    place = find_place_inside(some, low, high)
    if ((places > low + 1e-9) & (places < high - 1e-9)).all(axis=1).any():
        assert place is not None
    if place is not None:
        assert (place > low - 1e-9).all() and (place < high + 1e-9).all()
        assert np.linalg.norm(places - place, axis=1).min() <= step_mm, "it is on the way"


@given(FRAME, circles(rise=st.floats(-100, 100)), POINT, st.tuples(*[st.floats(0.5, 300)] * 3))
def test_extents_of_a_climbing_circle_are_never_underestimated(frame, circle, corner, size):
    """The extents of a climbing circle are never underestimated.

    Only edited programs contain a climbing circle. The whole space that circle and climb span is checked
    instead.
    """
    some, places = (
        paths_in_frame(frame, make_paths([], [circle[:3]])),
        transform_points(frame, sampled(circle)),
    )
    low, high = measure_bounds(some)
    assert (low <= places + 1e-9).all() and (high >= places - 1e-9).all()
    away = np.linalg.norm(places, axis=1)
    assert distances_from_origin(some)[0] <= away.min() + 1e-9 and distances_from_origin(some)[1] >= away.max() - 1e-9
    box = np.array(corner), np.add(corner, size)
    if ((places > box[0]) & (places < box[1])).all(axis=1).any():
        assert find_place_inside(some, *box) is not None


def test_a_circle_that_ends_where_it_starts_goes_all_the_way_round():
    """A circle that ends where it starts goes all the way round.

    Machines run it this way, although its start and end do not show it.
    """
    some = make_paths([], [((10, 0, -2), (10, 0, -2), (7, 0, 1))])
    low, high = measure_bounds(some)
    assert np.vstack([low, high]) == pytest.approx(np.array([(4, -3, -2), (10, 3, -2)], dtype=float))
    assert distances_from_origin(some) == pytest.approx((math.hypot(4, 2), math.hypot(10, 2)))
    assert find_place_inside(some, (3.9, -1, -3), (4.1, 1, -1)) == pytest.approx([4, 0, -2], abs=0.2)


def test_single_points_and_paths_along_a_side_of_a_box():
    box = (0, 0, 0), (10, 10, 10)
    assert find_place_inside(make_paths([[(5, 5, 5)]]), *box) == pytest.approx([5, 5, 5])
    assert find_place_inside(make_paths([[(5, 5, 15)]]), *box) is None
    assert find_place_inside(make_paths([[(-5, 5, 10), (15, 5, 10)]]), *box) is None, "along a side is not inside"
    assert find_place_inside(make_paths([[(-5, 5, 9.9), (15, 5, 9.9)]]), *box) == pytest.approx([5, 5, 9.9])
    assert find_place_inside(make_paths([]), *box) is None


@given(st.floats(0.05, 3.0), st.floats(5, 200), st.floats(5, 200), st.floats(1e-3, 2))
@pytest.mark.slow
def test_a_corner_that_is_cut_stays_within_twice_the_cut(turn_rad, before_mm, after_mm, tolerance_mm):
    """A cut corner stays within twice the cut, which is the allowance of the limits.

    No point of the triangle at a joint is further from the two moves.
    """
    path = np.array([(-before_mm, 0, 0), (0, 0, 0), (after_mm * math.cos(turn_rad), after_mm * math.sin(turn_rad), 0)])
    radii = blend_radii(path, Blending(tolerance_mm))
    cut = cut_corners(path, radii)[0]
    if len(cut) < 5:
        return
    third_side = np.linspace(cut[1], cut[3], 101)
    starts, ends = path[:-1], path[1:]
    along = ends - starts
    for place in third_side:
        share = np.clip(((place - starts) * along).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
        away = np.linalg.norm(place - (starts + share[:, None] * along), axis=1).min()
        assert away <= 2 * tolerance_mm + 1e-9


def test_a_circle_that_climbs_through_a_box_is_found():
    half = make_paths([], [((10, 0, 0), (-10, 0, 8), (0, 0, 1))])
    assert find_place_inside(half, (-1, 9, 3), (1, 11, 5)) is not None
    assert find_place_inside(half, (-1, -11, 3), (1, -9, 5)) is None


def test_the_nearest_point_of_a_climbing_circle_is_on_its_path():
    climbing = make_paths([], [((2, 0, -3), (2, 0, 5), (0, 0, 1))])  # around the z axis; nearest at z 0
    assert distances_from_origin(climbing) == pytest.approx((2.0, math.hypot(2, 5)))


def test_a_circle_that_only_grazes_a_box_is_found_in_it():
    flat = make_paths([], [((10, 0, 0), (10, 0, 0), (0, 0, 1))])
    place = find_place_inside(flat, (-0.5, 9.9, -1), (0.5, 11, 1))
    assert place == pytest.approx((0, 10, 0))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_move_along_the_face_of_a_box_is_not_inside(axis):
    """Only the interior of a box that the tool must not enter is refused."""
    ends = np.full((2, 3), 5.0)
    ends[:, axis], ends[1, (axis + 1) % 3] = 0.0, 8.0
    assert find_place_inside(make_paths([ends]), (0, 0, 0), (10, 10, 10)) is None
    ends[:, axis] = 1e-6
    assert find_place_inside(make_paths([ends]), (0, 0, 0), (10, 10, 10)) is not None
