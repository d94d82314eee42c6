"""A path that was read is compared correctly with the intended path."""

import itertools
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from brushsvg import _core
from brushsvg.machine.cells.cell_file import find_cell
from brushsvg.verify.against_plan import BOX_SIZE, _check_pass, _max_distance_mm, find_departure


def by_every_move(points, path):
    """Return the greatest distance of points from a path, by trying every move.

    This is slow, but leaves nothing out.
    """
    starts, ends = (path[:-1], path[1:]) if len(path) > 1 else (path, path)
    steps = ends - starts
    squares = np.maximum((steps**2).sum(axis=1), 1e-30)
    farthest = 0.0
    for point in points:
        along = np.clip(((point - starts) * steps).sum(axis=1) / squares, 0, 1)
        farthest = max(farthest, np.linalg.norm(point - starts - along[:, None] * steps, axis=1).min())
    return farthest


@settings(deadline=None, derandomize=True)
@given(
    some.integers(0, 10_000),
    some.sampled_from([1, 2, 3, BOX_SIZE, BOX_SIZE + 1, 300]),
    some.sampled_from([1, 2, 100, 300]),
    some.sampled_from([0.0, 1e-3, 0.5, 30.0]),
    some.sampled_from(["along", "back", "anywhere"]),
)
@pytest.mark.slow
def test_the_farthest_point_is_found_without_looking_at_every_move(seed, moves, points, away_mm, how):
    random = np.random.default_rng(seed)
    path = np.cumsum(random.choice([-1.0, 0.0, 1.0], (moves, 3)), axis=0)  # may overlap itself or stand still
    at = np.sort(random.integers(0, moves, points))
    requested = path[{"along": at, "back": at[::-1], "anywhere": random.permutation(at)}[how]]
    requested = requested + away_mm * random.choice([-1, 0, 1], (points, 3))
    assert _max_distance_mm(requested, path) == pytest.approx(by_every_move(requested, path), abs=1e-9)


def test_a_detour_in_the_middle_of_many_poses_is_found():
    t = np.linspace(0, 60, 5000)
    path = np.column_stack([10 * np.sin(7 * t), t, -2 + np.cos(t)])
    requested = path.copy()
    requested[3333, 2] += 0.3
    assert _max_distance_mm(requested, path) == pytest.approx(by_every_move(requested[3333:3334], path))


ARC = np.array([(0, 0, -2), (5, 0, -2), (10, 5, -2), (5, 10, -2), (0, 10, -2)], dtype=float)


def turned(poses, centre_mm, direction=1):
    return _core.Pass(
        "turn", np.array(poses, dtype=float), 20.0, arcs=[_core.Arc(1, len(poses) - 2, centre_mm, direction)]
    )


def strayed(a_pass, expected):
    return _check_pass(a_pass, np.arange(1, 1 + len(a_pass.poses_mm)), expected, find_cell())


def test_a_circle_with_fewer_poses_is_the_same_path():
    whole, short = turned(ARC, (5, 5)), turned(np.delete(ARC, 2, axis=0), (5, 5))
    assert strayed(short, whole) == []


@pytest.mark.parametrize("away_mm", [0.001, 0.5])
def test_a_circle_with_another_centre_or_direction_is_another_path(away_mm):
    whole = turned(ARC, (5, 5))
    reported = strayed(turned(ARC, (5 + away_mm, 5)), whole)
    assert len(reported) == (away_mm > 0.02)
    lens = [(0, 5, -2), (5, 5, -2), (8, 5.5, -2), (8, 9, -2)]
    one, other = turned(lens, (6.25, 6.75)), turned(lens, (6.25, 6.75), -1)
    (notice,) = strayed(other, one)
    assert notice.code == "path-elsewhere" and re.search(r"\d mm", notice.sentence)


@pytest.mark.parametrize("decimals", [3, 4])
@pytest.mark.parametrize(("chord_mm", "rise_mm"), [(61.0, 0.58), (42.0, 0.05), (5.0, 0.02), (60.0, 20.0)])
@pytest.mark.parametrize("inner", [[3], [2, 4], [1, 2, 3, 4, 5]])
def test_a_flat_circle_read_from_rounded_points_is_the_same_path(chord_mm, rise_mm, inner, decimals):
    """A flat circle read from rounded places is the same path.

    A robot gets three places of a circle. Rounding the places of a flat circle moves its centre by a
    millimetre, but its path only by the rounding error.
    """
    random = np.random.default_rng(1)
    radius = (chord_mm**2 / 4 + rise_mm**2) / (2 * rise_mm)
    half = np.arcsin(chord_mm / 2 / radius)
    for _ in range(20):
        middle = random.uniform(0, 2 * np.pi)
        angles = middle + np.linspace(half, -half, 7)
        outwards = np.array([np.cos(middle), np.sin(middle), 0.0])
        centre = random.uniform(0, 100, 2) - radius * outwards[:2]
        points = np.column_stack([centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]), [-2] * 7])
        expected = turned(points[[0, 0, *inner, 6, 6]], centre, -1)
        read = np.round(points[[0, 3, 6]], decimals)
        again = turned(read[[0, 0, 1, 2, 2]], centre_of(read[:, :2]), -1)
        assert strayed(again, expected) == []
        lower = np.round(points[[0, 3, 6]] - [[0], [0.04], [0]] * outwards, decimals)
        other = turned(lower[[0, 0, 1, 2, 2]], centre_of(lower[:, :2]), -1 if rise_mm > 0.04 else 1)
        assert [notice.code for notice in strayed(other, expected)] == ["path-elsewhere"]


def centre_of(places):
    """Return the centre of the circle through three places."""
    a, b, c = places
    return np.linalg.solve(2 * np.array([b - a, c - a]), [b @ b - a @ a, c @ c - a @ a])


@pytest.mark.parametrize("count", [2, 4, 8, 16])
def test_a_flat_circle_as_chords_is_the_same_path_within_tolerance(count):
    def on_circle(angles):
        return np.column_stack([600 * np.sin(angles), 600 * np.cos(angles) - 600, np.full(len(angles), -2.0)])

    few, many = (on_circle(np.linspace(-0.04, 0.04, n)) for n in (3, count + 1))
    expected = turned(few[[0, 0, 1, 2, 2]], (0, -600), -1)
    chords = _core.Pass("turn", many[[0, *range(len(many)), -1]], 20.0)
    off_mm = 600 * (1 - np.cos(0.04 / count))
    assert bool(strayed(chords, expected)) == (off_mm > 0.02)


STEP_MM = 0.05


def dense(path):
    """Return points of a path that are at most STEP_MM apart."""
    parts = [path[:1]]
    for begin, end in itertools.pairwise(path):
        count = max(1, int(np.ceil(np.linalg.norm(end - begin) / STEP_MM)))
        parts.append(begin + (end - begin) * (np.arange(1, count + 1) / count)[:, None])
    return np.vstack(parts)


def leash_mm(one, other, heights_apart=False):
    """Return the shortest leash between two walkers from point to point.

    This is the discrete Frechet distance. It is at least the distance of the paths themselves, and at most
    one step more.
    """
    offsets = one[:, None] - other[None]
    away = np.linalg.norm(offsets, axis=2)
    if heights_apart:
        away = np.maximum(np.hypot(offsets[..., 0], offsets[..., 1]), np.abs(offsets[..., 2]))
    reached = np.empty_like(away)
    for i in range(len(one)):
        for j in range(len(other)):
            before = [reached[a, b] for a, b in ((i - 1, j), (i, j - 1), (i - 1, j - 1)) if a >= 0 and b >= 0]
            reached[i, j] = max(away[i, j], min(before, default=0.0))
    return reached[-1, -1]


@settings(deadline=None, max_examples=150)
@given(
    some.integers(0, 10_000),
    some.integers(1, 6),
    some.sampled_from(["same", "other poses", "scrubbed", "backwards", "swapped", "shorter", "any"]),
    some.sampled_from([0.0, 0.1, 0.4]),
    some.sampled_from([0.06, 0.2, 0.5, 1.0]),
    some.booleans(),
)
@pytest.mark.slow
def test_path_comparison_agrees_with_following_the_path_in_steps(seed, moves, how, away_mm, limit_mm, heights_apart):
    random = np.random.default_rng(seed)
    requested = np.cumsum(random.choice([-0.7, 0.0, 0.7], (moves + 1, 3)), axis=0)  # may overlap itself or stand still
    some_ = int(random.integers(0, moves + 1))
    found = {
        "same": requested,
        "other poses": dense(requested)[
            np.unique(np.r_[0, random.integers(0, len(dense(requested)), 4), -1 % len(dense(requested))])
        ],
        "scrubbed": np.vstack([requested[: some_ + 1], requested[:some_][::-1], requested]),
        "backwards": requested[::-1],
        "swapped": requested[random.permutation(moves + 1)],
        "shorter": requested[: some_ + 1],
        "any": np.cumsum(random.choice([-0.7, 0.0, 0.7], (3, 3)), axis=0),
    }[how]
    found = found + away_mm * random.uniform(-1, 1, found.shape)
    leash = leash_mm(dense(found), dense(requested), heights_apart)
    at = find_departure(found, requested, limit_mm, heights_apart)
    if at is None:
        assert leash <= limit_mm + STEP_MM
    else:
        assert leash > limit_mm - 1e-9 and 0 <= at < max(len(found), 2)


def test_the_first_departure_from_a_path_is_reported():
    requested = np.array([(x, 0.0, -1.0) for x in range(10)])
    scrubbed = np.vstack([requested[:6], requested[3:5][::-1], requested[3:]])
    assert find_departure(scrubbed, requested, 0.02) in (6, 7)
    assert find_departure(requested[::-1], requested, 0.02) == 0
    assert find_departure(requested[:-1], requested, 0.02) == len(requested) - 2
    assert find_departure(np.vstack([requested, requested[-2:]]), requested, 0.02) in (
        len(requested),
        len(requested) + 1,
    )
    assert find_departure(requested[::3], requested, 0.02) is None


def test_comparing_long_paths_looks_only_at_nearby_points(monkeypatch):
    """Comparing long paths looks only at places near each other.

    The comparison examines few cells of the two paths. The time for a page grows with its length, not with
    the square of the length.
    """
    from brushsvg.verify import against_plan

    t = np.linspace(0, 60, 3000)
    requested = np.column_stack([10 * np.sin(7 * t), t, -2 + np.cos(t)])
    found = np.repeat(requested, 2, axis=0)
    counted = []
    within = against_plan._part_within_limit
    monkeypatch.setattr(against_plan, "_part_within_limit", lambda *some_: counted.append(1) or within(*some_))
    assert find_departure(found, requested, 0.02) is None
    assert len(counted) < 8 * len(found)


def test_paths_that_begin_exactly_the_limit_apart_are_compared():
    """Rounding decides whether the first points are within the limit, in two ways that need not agree."""
    found = np.array([(0.209, 15.048, -1.0), (-0.24625419303409143, 15.943435931880655, -1.0)])
    requested = np.array([(0.197, 15.032, -1.0), (0.48171279843137954, 16.707936453621663, -1.0)])
    assert find_departure(found, requested, 0.02) == 1


def test_a_servo_may_be_off_sideways_and_in_height():
    """Rounding sideways and the steps of a servo's height do not depend on each other."""
    requested = np.array([(x, 0.0, -1.0) for x in range(10)])
    assert find_departure(requested + np.array((0, 0.018, 0.018)), requested, 0.02) == 0
    assert find_departure(requested + np.array((0, 0.018, 0.018)), requested, 0.02, heights_apart=True) is None
    for away in ((0, 0.018, 0.021), (0, 0.021, 0.018), (0.015, 0.015, 0.018)):
        assert find_departure(requested + away, requested, 0.02, heights_apart=True) is not None
