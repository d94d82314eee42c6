import numpy as np
import pytest
from diagnostics import refused

from brushsvg import Stroke, _core, compensate, find_brush, flatten
from brushsvg.read.design import Design, Element, SubPath
from brushsvg.read.svg import read_svg
from brushsvg.strokes.extraction import strokes

LINE = SubPath(np.array([[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]]))


def named(*elements):
    """Return the names and notices of elements given as (id, number of sub-paths)."""
    made = tuple(Element(name, (LINE,) * count, 1.0) for name, count in elements)
    result, notices = strokes(Design((10.0, 10.0), made))
    return [stroke.id for stroke in result], notices


def test_strokes_are_named_after_their_elements():
    names, notices = named(("v", 1), ("", 1), ("i", 2), ("", 3))
    assert names == ["v", "stroke1", "i/1", "i/2", "stroke2/1", "stroke2/2", "stroke2/3"]
    assert notices == []


def test_a_duplicate_name_stays_with_the_first_and_is_reported():
    names, notices = named(("p", 1), ("p", 1), ("p-2", 1), ("p", 2))
    assert names == ["p", "p-3", "p-2", "p-4/1", "p-4/2"]
    assert [notice.where for notice in notices] == ["p", "p"]
    assert "'p-3'" in notices[0].sentence


def test_names_that_collide_after_numbering_are_made_unique():
    assert named(("p", 2), ("p/1", 1))[0] == ["p/1", "p/2", "p/1-2"]
    assert named(("stroke1", 1), ("", 1))[0] == ["stroke1", "stroke1-2"]
    assert named(("p", 2), ("p", 1))[0] == ["p/1", "p/2", "p-2"]


def test_thousands_of_equal_names_are_made_unique():
    names, notices = named(*[("p", 1)] * 5000)
    assert len(set(names)) == 5000
    assert len(notices) == 4999


def test_a_stroke_has_the_properties_of_its_element():
    element = Element(
        "s",
        (LINE, SubPath(LINE.cubics + 5, closed=True)),
        3.0,
        "#123456",
        "ink",
        {"speed_mm_s": 7.0, "brush": "x"},
    )
    (first, second), _ = strokes(Design((10.0, 10.0), (element,)))
    assert np.array_equal(first.middle_mm, [[0, 0, 1, 0, 2, 0, 3, 0]])
    assert np.array_equal(second.middle_mm, [[5, 5, 6, 5, 7, 5, 8, 5]])
    assert (first.closed, second.closed) == (False, True)
    assert [tuple(knot) for knot in first.half_width] == [(0.0, 1.5)]
    assert (first.colour, first.layer) == ("#123456", "ink")
    assert first.settings == _core.Settings(brush="x", speed_mm_s=7.0)


def test_from_svg_to_strokes_in_drawing_order():
    data = b"""<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm" viewBox="0 0 100 50">
      <g fill="none" stroke="red" stroke-width="2"><path id="b" d="M10 10H30M40 10H60"/>
      <line x1="30" y1="20" x2="10" y2="20"/></g><path id="a" stroke="blue" d="M5 5V10"/></svg>"""
    result, notices = strokes(read_svg(data))
    assert [stroke.id for stroke in result] == ["b/1", "b/2", "stroke1", "a"]
    ends = [stroke.middle_mm[0, [0, 1, 6, 7]].tolist() for stroke in result]
    assert ends == [[10, 40, 30, 40], [40, 40, 60, 40], [30, 30, 10, 30], [5, 45, 5, 40]]
    assert [stroke.half_width[0][1] for stroke in result] == [1.0, 1.0, 1.0, 0.5]
    assert notices == []


def test_repeats_differ_from_names_that_look_like_repeats():
    made = (Element("a", (LINE,), 1.0, settings={"passes": 2}), Element("a#2", (LINE,), 1.0))
    names = [stroke.id for stroke in strokes(Design((10.0, 10.0), made))[0]]
    assert len(set(names)) == 3, names


def test_no_stroke_has_the_name_of_a_part_of_another_stroke():
    """No stroke has a name that a part of another stroke gets.

    Lifted at its corners, `a` becomes a, a~2, a~3. The name `a~2` once stood for a second stroke.
    """
    names, notices = named(("a", 1), ("a~2", 1), ("b~2", 1), ("c~2+3", 1), ("c", 2), ("c/2~2", 1), ("c/1+2", 1))
    assert names == ["a", "a~2-2", "b~2", "c~2+3", "c/1", "c/2", "c/2~2-2", "c/1+2"]
    assert [(notice.where, notice.code) for notice in notices] == [
        ("a~2", "name-taken"),
        ("c/2~2", "name-taken"),
    ]
    assert "'a'" in notices[0].sentence
    assert named(("a~2", 1), ("a", 1))[0] == ["a~2-2", "a"]
    assert named(("p-2~2", 1), ("p", 1), ("p", 1))[0] == ["p-2~2", "p", "p-3"]


ARC = 20 * np.column_stack([np.cos(np.linspace(0, np.pi, 60)), np.sin(np.linspace(0, np.pi, 60))]) + 50


def off(stroke, points):
    """Return the distances [mm] of points from the middle line."""
    line = flatten(stroke, 1e-4)[:, :2]
    a, d = line[:-1], np.diff(line, axis=0)
    t = np.clip(((points[:, None] - a) * d).sum(-1) / (d**2).sum(-1), 0, 1)
    return np.hypot(*np.moveaxis(a + t[..., None] * d - points[:, None], -1, 0)).min(axis=1)


def test_a_stroke_from_points_is_straight_lines_with_the_widths_given():
    stroke = Stroke.from_points([(0, 0), (3, 4), (3, 4), (3, 9)], [2, 4, 4, 3], "w")
    assert (stroke.id, len(stroke.middle_mm), stroke.closed) == ("w", 2, False)
    assert stroke.middle_mm[0, [0, 1, 6, 7]].tolist() == [0, 0, 3, 4]
    assert stroke.half_width == ((0, 1), (0.5, 2), (1, 1.5))
    line = flatten(stroke, 0.01)
    assert line[[0, -1], 3].tolist() == [1, 1.5]
    assert line[-1, 2] == pytest.approx(10)
    ring = Stroke.from_points([(0, 0), (3, 4), (3, 9), (0, 0)], 2)
    assert ring.closed and ring.half_width == ((0, 1), (1, 1)) and ring.id == "stroke1"


@pytest.mark.parametrize("tolerance_mm", [1.0, 0.05, 0.001])
@pytest.mark.parametrize("corner", [False, True])
def test_a_smooth_stroke_passes_every_point_within_the_tolerance(tolerance_mm, corner):
    points = np.vstack([ARC, [(45, 50), (60, 50)]]) if corner else ARC
    stroke = Stroke.from_points(points, 3.0, tolerance_mm=tolerance_mm)
    assert off(stroke, points).max() <= tolerance_mm
    lines = len(Stroke.from_points(points, 3.0).middle_mm)
    assert lines == len(points) - 1
    # A circle through the points differs from them by up to 0.007 mm in between.
    few = 12 if tolerance_mm > 0.007 else lines
    assert len(stroke.middle_mm) <= few


def test_a_line_of_nine_metres_becomes_fewer_cubics_than_lines():
    """One fit of all of it would have points 4 mm apart. 2,000 such fits took half a minute and left 3,550 cubics."""
    angle = np.linspace(0, 80 * np.pi, 4000)
    points = np.column_stack([200 + 0.75 * angle * np.cos(angle), 200 + 0.75 * angle * np.sin(angle)])
    stroke = Stroke.from_points(points, 2.0, tolerance_mm=0.05)
    assert off(stroke, points).max() <= 0.05 and len(stroke.middle_mm) < 3200


def test_a_long_zigzag_keeps_its_teeth():
    """A long zigzag keeps its teeth.

    Even steps along a long line once cut off its corners.
    """
    points = np.column_stack([np.arange(400.0) * 5, np.arange(400) % 2 * 9.0])
    stroke = Stroke.from_points(points, 1.0, tolerance_mm=0.1)
    assert off(stroke, points).max() <= 0.1


@pytest.mark.parametrize(
    ("points", "width", "expected"),
    [
        ([(5, 5)], 3, "stroke-empty"),
        ([(5, 5)] * 3, 3, "stroke-empty"),
        (np.zeros((0, 2)), 3, "stroke-empty"),
        ([(5, 5), (9, np.nan)], 3, "geometry-out-of-range 1"),
        ([(5, 5), (9, 2e6)], 3, "geometry-out-of-range 1"),
        ([(5, 5), (9, 9)], 0, "out-of-range"),
        ([(5, 5), (9, 9)], [3, -1], "out-of-range 1"),
        ([(5, 5), (9, 9)], np.inf, "out-of-range"),
        (np.ma.masked_equal([(5, 5), (9, 8), (9, 9)], 8), 3, "geometry-out-of-range 1"),
        ([(5, 5), (9, 9)], np.ma.masked_equal([3, 4], 4), "out-of-range 1"),
        ([(5, 5), (9, 9)], [3, 3, 3], "sizes-differ 2 3"),
        ([(5, 5), (9, 9)], np.array([[3], [3]]), "sizes-differ 1 2 widths.ravel"),
    ],
)
def test_points_that_form_no_stroke_are_refused(points, width, expected):
    with refused(expected, "s"):
        Stroke.from_points(points, width, "s")


@pytest.mark.parametrize("points", [[(1, 2, 3)], [1, 2], "ab", None])
def test_an_array_of_the_wrong_shape_is_a_type_error(points):
    with pytest.raises(TypeError):
        Stroke.from_points(points, 3.0)


def test_width_of_nothing_is_refused_in_a_sentence():
    stroke = Stroke.from_points([(20, 40), (60, 40)], 1.0, "s").replaced(half_width=[(0, 1.0), (1, 0.0)])
    with refused("width-out-of-reach 0", "s"):
        compensate([stroke], find_brush("round-6"), (140, 100))
