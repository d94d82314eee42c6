"""How far a path that was read lies from the one that was meant."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from brushsvg import _core
from brushsvg.cell_file import find_cell
from brushsvg.comparing import IN_A_BOX, _farthest, _strayed


def by_every_move(points, path):
    """Each point against each move: slow, and nothing left out."""
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
    some.sampled_from([1, 2, 3, IN_A_BOX, IN_A_BOX + 1, 300]),
    some.sampled_from([1, 2, 100, 300]),
    some.sampled_from([0.0, 1e-3, 0.5, 30.0]),
    some.sampled_from(["along", "back", "anywhere"]),
)
def test_the_farthest_point_is_found_without_looking_at_every_move(seed, moves, points, away_mm, how):
    random = np.random.default_rng(seed)
    path = np.cumsum(
        random.choice([-1.0, 0.0, 1.0], (moves, 3)), axis=0
    )  # on itself, too, and standing still
    at = np.sort(random.integers(0, moves, points))
    asked = path[{"along": at, "back": at[::-1], "anywhere": random.permutation(at)}[how]]
    asked = asked + away_mm * random.choice([-1, 0, 1], (points, 3))
    assert _farthest(asked, path) == pytest.approx(by_every_move(asked, path), abs=1e-9)


def test_a_detour_in_the_middle_of_many_poses_is_found():
    t = np.linspace(0, 60, 5000)
    path = np.column_stack([10 * np.sin(7 * t), t, -2 + np.cos(t)])
    asked = path.copy()
    asked[3333, 2] += 0.3
    assert _farthest(asked, path) == pytest.approx(by_every_move(asked[3333:3334], path))


ARC = np.array([(0, 0, -2), (5, 0, -2), (10, 5, -2), (5, 10, -2), (0, 10, -2)], dtype=float)


def turned(poses, centre_mm, direction=1):
    return _core.Pass(
        "turn", np.array(poses, dtype=float), 20.0, arcs=[_core.Arc(1, len(poses) - 2, centre_mm, direction)]
    )


def test_a_circle_is_the_same_with_fewer_poses_on_it():
    whole, short = turned(ARC, (5, 5)), turned(np.delete(ARC, 2, axis=0), (5, 5))
    assert _strayed(short, whole, find_cell()) == []


@pytest.mark.parametrize("away_mm", [0.001, 0.5])
def test_a_circle_about_another_centre_or_the_other_way_round_is_another_path(away_mm):
    whole = turned(ARC, (5, 5))
    told = _strayed(turned(ARC, (5 + away_mm, 5)), whole, find_cell())
    assert len(told) == (away_mm > 0.02)
    lens = [(0, 5, -2), (5, 5, -2), (8, 5.5, -2), (8, 9, -2)]
    one, other = turned(lens, (6.25, 6.75)), turned(lens, (6.25, 6.75), -1)
    assert "mm away from where the drawing asks it to" in _strayed(other, one, find_cell())[0][1]
