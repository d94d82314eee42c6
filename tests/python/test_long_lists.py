"""Lists and arrays that are too long are refused before memory is allocated.

This includes nested lists.
"""

import itertools

import numpy as np
import pytest
from diagnostics import agrees, refused
from svg_text import read

import brushsvg
from brushsvg import _core
from brushsvg.read.svg.paths import path_data, shapes
from brushsvg.strokes import path_objects

SQUARE = np.array([[0, 0], [9, 0], [9, 9], [0, 9.0]])
LONG = range(10**9)  # a copy would need 8 GB


def all_rows(columns: int) -> np.ndarray:
    """Return ten thousand million rows that share the memory of one."""
    return np.broadcast_to(0.0, (10**10, columns))


CALLS = {
    "a ring": lambda: brushsvg.area([LONG]),
    "a ring that is one row": lambda: brushsvg.area([all_rows(2)]),
    "a thousand rings": lambda: brushsvg.area([np.zeros((10**5, 2))] * 1000),
    "rings next to rings": lambda: brushsvg.overlap([SQUARE], [SQUARE, LONG]),
    "points": lambda: _core.convex_hull(LONG),
    "poses": lambda: brushsvg.Pass("a", LONG),
    "poses that are one": lambda: brushsvg.Pass("a", all_rows(3)),
    "cubics": lambda: brushsvg.Stroke("a", all_rows(8)),
    "a line": lambda: _core.fit_cubics(LONG, 0.1),
    "a footprint": lambda: _core.Footprint(1.0, LONG),
    "rows within rows": lambda: setattr(brushsvg.Brush(), "covariance", [[0.0], LONG]),
    "depths": lambda: brushsvg.find_brush("round-6").lag(LONG),
    "depths that are one": lambda: brushsvg.find_brush("round-6").lag(np.broadcast_to(1.0, 10**10)),
    "a path": lambda: brushsvg.stroke_from_path(LONG, 3.0),
    "a path's points": lambda: brushsvg.stroke_from_path([[LONG, LONG]], 3.0),
    "a path that is one cubic": lambda: brushsvg.stroke_from_path(all_rows(8), 3.0),
}


@pytest.mark.parametrize("what", CALLS)
def test_overlong_nested_lists_are_refused(what):
    with pytest.raises(brushsvg.Error) as refused:
        CALLS[what]()
    assert refused.value.code == "list-too-long"
    assert refused.value.value > 10**7 == refused.value.range[1] == _core.MAX_ENTRIES


UNLIKE = {
    "rows of any length": lambda: brushsvg.area([[LONG, LONG]]),
    "one row without end": lambda: brushsvg.Arc(1, 2, itertools.count(), 1),
    "a place of any length": lambda: brushsvg.Arc(1, 2, LONG, 1),
    "points without end": lambda: brushsvg.area([SQUARE, itertools.count()]),
    "numbers with an imaginary part": lambda: brushsvg.area([SQUARE + 1j]),
    "dates": lambda: brushsvg.area([SQUARE.astype("datetime64[s]")]),
    "words": lambda: brushsvg.area([SQUARE.astype(str)]),
    "numbers beyond any": lambda: brushsvg.area([[[10**400, 1]]]),
    "nothing in place of a number": lambda: brushsvg.find_brush("round-6").lag(None),
    "a dict": lambda: brushsvg.Pass("a", {}),
    "three columns": lambda: brushsvg.area([np.zeros((4, 3))]),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("what", UNLIKE)
def test_values_that_are_not_numeric_arrays_are_refused(what):
    with pytest.raises(TypeError):
        UNLIKE[what]()


def test_an_endless_generator_is_read_only_up_to_the_limit():
    read = 0

    def endless():
        nonlocal read
        while True:
            read += 1
            yield SQUARE

    with pytest.raises(brushsvg.Error) as refused:
        _core.area(endless())
    assert (refused.value.code, read < 10**7) == ("list-too-long", True)


@pytest.mark.parametrize(
    "ring",
    [
        SQUARE,
        SQUARE.tolist(),
        [tuple(row) for row in SQUARE],
        list(SQUARE),
        SQUARE.astype(int),
        SQUARE.astype(np.float32),
        np.asfortranarray(SQUARE),
        np.repeat(SQUARE, 2, axis=0)[::2],
        memoryview(SQUARE),
        np.ascontiguousarray(SQUARE[::-1])[::-1],
    ],
)
def test_rows_may_have_any_array_form(ring):
    assert brushsvg.area([ring]) == 81
    poses = np.array(brushsvg.Pass("a", np.column_stack([np.asarray(ring), np.zeros(4)])).poses_mm)
    assert np.array_equal(poses[:, :2], SQUARE)


def test_laws_return_the_shape_of_their_arguments():
    lag = brushsvg.find_brush("round-6").lag
    assert isinstance(lag(3), float) and lag([1, 2]).shape == (2,)
    assert lag(np.full((2, 3), 3.0)).tolist() == [[lag(3)] * 3] * 2


@pytest.mark.parametrize(
    "d", ["M0 0" + "h1" * 200, "M0 0l" + "1 1 " * 200, "M0 0a" + "3 3 0 0 1 1 1 " * 200, "M" + "1 1 " * 200]
)
def test_a_path_with_too_many_commands_is_read_up_to_the_limit(monkeypatch, d):
    """A path with too many commands is read up to the limit.

    A path of 40 MB once needed 6 GB of memory and more than a minute.
    """
    for module in (path_data, shapes, path_objects):
        monkeypatch.setattr(module, "MOST_COMMANDS", 100)
    commands, error = path_data.parse_path(d)
    assert len(commands) == 100
    assert error is not None
    (notice,) = read(f'<path id="p" d="{d}" stroke="black"/>').notices
    assert notice.damaged and agrees(notice, "geometry-damaged 100", "p")
    with refused("list-too-long 100"):
        brushsvg.stroke_from_path(d, width_mm=2)
