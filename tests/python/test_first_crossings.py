"""The distance to the first crossing of an outline agrees with shapely."""

import numpy as np
from diagnostics import refused
from shapely import LineString, MultiLineString, Point, get_coordinates

from brushsvg import _core


def _blob(random, middle, radius_mm):
    angles = np.sort(random.uniform(0, 2 * np.pi, random.integers(3, 40)))
    return middle + random.uniform(0.3, 1, (len(angles), 1)) * radius_mm * np.column_stack(
        [np.cos(angles), np.sin(angles)]
    )


def test_the_first_crossing_ahead_agrees_with_shapely():
    random, crossed = np.random.default_rng(3), 0
    for _ in range(60):
        rings = [_blob(random, (0, 0), 20), _blob(random, (0, 0), 5)[::-1], _blob(random, (25, 9), 6)]
        outlines = MultiLineString([[*ring, ring[0]] for ring in rings])
        places, angles = random.uniform(-30, 40, (9, 2)), random.uniform(0, 2 * np.pi, 9)
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        for place, way, found in zip(places, ways, _core.first_crossings(rings, places, ways), strict=True):
            met = get_coordinates(LineString([place, place + 200 * way]).intersection(outlines))
            target = min((Point(place).distance(Point(at)) for at in met), default=np.inf)
            crossed += np.isfinite(target)
            np.testing.assert_allclose(found, target, atol=1e-9)
    assert crossed > 150


def test_no_outline_ahead_gives_an_infinite_distance():
    square = np.array([[0, 0], [4, 0], [4, 4], [0, 4.0]])
    assert _core.first_crossings([square], [[2, 2]], [[1, 0]]) == [2]
    assert _core.first_crossings([square], [[5, 2], [5, 2]], [[1, 0], [-1, 0]]) == [np.inf, 1]
    assert _core.first_crossings([], [[5, 2]], [[1, 0]]) == [np.inf]
    assert _core.first_crossings([np.empty((0, 2))], [[5, 2]], [[1, 0]]) == [np.inf]


def test_places_and_directions_must_be_equally_many():
    with refused("sizes-differ 1 2"):
        _core.first_crossings([], [[5, 2], [6, 2]], [[1, 0]])
