"""Lists and rings from Python are checked before anything is computed with them."""

import numpy as np
import pytest
import shapely

from brushsvg import Error, _core, area, coverage, find_brush, overlap, unite
from brushsvg.geometry.rings import is_within

SQUARE = np.array([[0, 0], [4, 0], [4, 4], [0, 4.0]])


class Endless:
    """A list that has a length but no entries.

    Each request for an entry is counted: it shows that the caller has begun to copy the list.
    """

    def __init__(self, length):
        self.length, self.requested = length, 0

    def __len__(self):
        return self.length

    def __getitem__(self, index):
        self.requested += 1
        raise IndexError


@pytest.mark.parametrize(
    "call",
    [
        lambda some: _core.compensate(some, find_brush("round-6"), (9, 9)),
        area,
        unite,
        lambda some: overlap([SQUARE], some),
        lambda some: coverage(some, (0, 0, 9, 9), 1.0),
        lambda some: _core.Stroke("a", [[0.0] * 8], half_width=some),
        lambda some: _core.Plan("b", "", (9, 9), some),
    ],
)
def test_an_overlong_list_is_refused_before_it_is_copied(call):
    some = Endless(10_000_001)
    with pytest.raises(Error) as refused:
        call(some)
    assert (refused.value.code, refused.value.value, some.requested) == ("list-too-long", 10_000_001, 0)
    assert tuple(refused.value.range) == (0, 10_000_000)
    with pytest.raises(Error):
        call(range(10**9))


def test_clockwise_rings_are_refused():
    turned = SQUARE[::-1]
    assert overlap([SQUARE], [SQUARE]) == 1
    for call in (
        lambda: overlap([SQUARE], [turned]),
        lambda: overlap([turned], [turned]),
        lambda: unite([turned]),
        lambda: _core.intersect([turned], [SQUARE]),
    ):
        with pytest.raises(Error) as refused:
            call()
        assert (refused.value.code, refused.value.value) == ("outline-clockwise", -16)
    assert area([turned]) == -16
    assert coverage([turned], (0, 0, 4, 4), 1.0).min() == 1


def test_is_within_agrees_with_shapely():
    random = np.random.default_rng(5)
    around = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    outer = (5 + np.sin(7 * around))[:, None] * np.column_stack([np.cos(around), np.sin(around)])
    hole, places = 0.4 * outer[::-1], random.uniform(-7, 7, (3000, 2))
    inside = shapely.contains_xy(shapely.Polygon(outer, [hole]), *places.T)
    assert (is_within(places, [outer, hole]) == inside).all()
    assert not is_within(places, []).any()
