import numpy as np

from brushsvg import _core
from brushsvg.drawing.design import Design, Element, SubPath
from brushsvg.drawing.svg import read_svg
from brushsvg.strokes.extraction import strokes

LINE = SubPath(np.array([[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]]))


def named(*elements):
    """Names and notices of elements given as (id, number of sub-paths)."""
    made = tuple(Element(name, (LINE,) * count, 1.0) for name, count in elements)
    result, notices = strokes(Design((10.0, 10.0), made))
    return [stroke.id for stroke in result], notices


def test_names_are_the_elements():
    names, notices = named(("v", 1), ("", 1), ("i", 2), ("", 3))
    assert names == ["v", "stroke1", "i/1", "i/2", "stroke2/1", "stroke2/2", "stroke2/3"]
    assert notices == []


def test_a_name_given_twice_stays_with_the_first_and_the_second_is_told():
    names, notices = named(("p", 1), ("p", 1), ("p-2", 1), ("p", 2))
    assert names == ["p", "p-3", "p-2", "p-4/1", "p-4/2"]
    assert [notice.where for notice in notices] == ["p", "p"]
    assert "'p-3'" in notices[0].sentence


def test_names_that_only_collide_once_numbered():
    assert named(("p", 2), ("p/1", 1))[0] == ["p/1", "p/2", "p/1-2"]
    assert named(("stroke1", 1), ("", 1))[0] == ["stroke1", "stroke1-2"]
    assert named(("p", 2), ("p", 1))[0] == ["p/1", "p/2", "p-2"]


def test_thousands_of_equal_names_are_told_apart():
    names, notices = named(*[("p", 1)] * 5000)
    assert len(set(names)) == 5000
    assert len(notices) == 4999


def test_a_stroke_carries_what_the_drawing_says():
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


def test_repeats_are_told_apart_from_names_that_look_like_them():
    made = (Element("a", (LINE,), 1.0, settings={"passes": 2}), Element("a#2", (LINE,), 1.0))
    names = [stroke.id for stroke in strokes(Design((10.0, 10.0), made))[0]]
    assert len(set(names)) == 3, names


def test_no_stroke_is_called_as_the_parts_of_another_are():
    """Lifted at its corners `a` becomes a, a~2, a~3: `a~2` named a second stroke."""
    names, notices = named(
        ("a", 1), ("a~2", 1), ("b~2", 1), ("c~2+3", 1), ("c", 2), ("c/2~2", 1), ("c/1+2", 1)
    )
    assert names == ["a", "a~2-2", "b~2", "c~2+3", "c/1", "c/2", "c/2~2-2", "c/1+2"]
    assert [(notice.where, notice.code) for notice in notices] == [
        ("a~2", "name-taken"),
        ("c/2~2", "name-taken"),
    ]
    assert "a part of 'a'" in notices[0].sentence
    assert named(("a~2", 1), ("a", 1))[0] == ["a~2-2", "a"]
    assert named(("p-2~2", 1), ("p", 1), ("p", 1))[0] == ["p-2~2", "p", "p-3"]
