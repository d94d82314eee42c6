"""Limbs that are thinner than the shape they leave are painted.

Corners do not get extra limbs.
"""

import warnings

import numpy as np
import pytest
from svg_text import read

from brushsvg import _core
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.skeleton.cut_ends import run_to_cut


def found(d: str):
    return strokes(read(f'<g fill="#123456" stroke="none"><path id="p" d="{d}"/></g>'))[0]


def swept(made) -> list:
    bare = [_core.Stroke(middle_mm=s.middle_mm, half_width=s.half_width, closed=s.closed) for s in made]
    return _core.unite([ring for stroke in bare for ring in _core.target_outline(stroke, 0.01)])


def reached(made, x0: float, y0: float, x1: float, y1: float) -> float:
    """Return the share of a box that discs of the strokes reach.

    The box is in the drawing's frame of 50 mm.
    """

    box = [np.array([(x0, 50 - y1), (x1, 50 - y1), (x1, 50 - y0), (x0, 50 - y0)], float)]
    return _core.area(_core.intersect(box, swept(made))) / _core.area(box)


def t_of(stem: float, bar: float, out: float) -> str:
    """Return a stem that ends above its bar.

    The bar sticks out by `out` on both sides.
    """
    left, right = 25 - stem / 2, 25 + stem / 2
    return f"M{left} 5H{right}V15H{right + out}V{15 + bar}H{right}V45H{left}V{15 + bar}H{left - out}V15H{left}Z"


@pytest.mark.parametrize(("stem", "bar", "out"), [(8, 2, 2.5), (8, 3, 3.0), (8, 1.2, 3), (12, 2, 4), (6, 2, 2)])
def test_the_bar_of_a_t_is_painted_however_thick_its_stem(stem, bar, out):
    made = found(t_of(stem, bar, out))
    assert len(made) == 2, "a stem and a bar"
    left, right = 25 - stem / 2, 25 + stem / 2
    for x0, x1 in ((left - out, left), (right, right + out)):
        assert reached(made, x0, 15, x1, 15 + bar) > 0.8
    assert reached(made, left, 25, right, 40) > 0.99


def test_the_foot_of_a_serif_letter_is_painted():
    made = found("M20 5H28V42H31V45H17V42H20Z")
    assert reached(made, 17, 42, 20, 45) > 0.8
    assert reached(made, 28, 42, 31, 45) > 0.8


def test_a_flag_on_one_side_is_painted():
    made = found("M20 5H28V45H20V8H16.5V5Z")
    assert reached(made, 16.5, 5, 20, 8) > 0.8


@pytest.mark.parametrize(
    "d",
    [
        "M20 5H28V45H20Z",  # sans serif
        "M20 5L28 7V45L20 43Z",  # with slanted cuts and corners of 76 degrees
        "M20 5.5Q20 5 20.5 5H27.5Q28 5 28 5.5V44.5Q28 45 27.5 45H20.5Q20 45 20 44.5Z",  # rounded
        "M19 5H29Q28 6 28 9V41Q28 44 29 45H19Q20 44 20 41V9Q20 6 19 5Z",  # flared
        "M20 5H28V20L28.4 20.3V20.9L28 21.2V45H20V33L19.6 32.7V32L20 31.7Z",  # with teeth
    ],
)
def test_ends_and_rough_edges_of_a_stem_get_no_hairlines(d):
    assert len(found(d)) == 1


@pytest.mark.parametrize(
    ("d", "end"),
    [
        ("M22.5 12H29.5L29.2 14Q32 11.5 36 11.5V16Q31 16 28.5 20L26 45H18Z", (23, 13, 28.5, 17)),
        ("M22 12H30L29.6 14Q33 11 38 12V17Q33 16.5 28.5 22L26 45H18Z", (22.5, 12.5, 29, 16)),
    ],
)
def test_the_end_of_a_stem_is_painted_if_its_ear_leaves_near_the_top(d, end):
    """The end of a stem is painted if its ear leaves it near the top.

    A single line once cut the corner from the stem into the ear, and left the stem's end bare.
    """
    made = found(d)
    assert len(made) == 2
    assert reached(made, *end) > 0.9


def test_a_stem_inside_a_crossing_is_painted():
    """A stem inside a crossing is painted.

    A thick stem between a bar and its foot once counted as part of both crossings, where no line ran.
    """
    made = found("M20 5H28V33H33V37H28V42H32V45H16V42H20V37H8V33H20Z")
    assert reached(made, 20.5, 36, 27.5, 42) > 0.9


@pytest.mark.parametrize(("top", "slant_deg"), [(5, 0), (8, 16)])
def test_the_stem_of_an_a_runs_from_its_top_to_its_foot_next_to_the_bowl(top, slant_deg):
    """The stem of an a runs from its top to its foot, next to the bowl.

    Bowl and stem meet in two necks. At the first, a ring once ran through both bowl and stem, and left the
    foot over. At the second, the stem once began where the bowl leaves it.
    """
    outer = (
        f"M20 {top}H29V34C29 38 32 39 37 37C36 43 32 46 27 46C23 46 20 43 20 39"
        "C17 44 13 46 9 46C-1 46 -1 5 10 5C15 5 18 7 20 10Z"
    )
    hole = "M20 14V34C18 38 15 40 12 40C5 40 5 11 12 11C16 11 18 12 20 14Z"
    how = f'fill="#123456" stroke="none" fill-rule="evenodd" transform="translate(14) skewX({-slant_deg})"'
    made, _ = strokes(read(f'<path id="a" {how} d="{outer}{hole}"/>'))
    assert len(made) == 2, "a bowl and a stem"
    down = [50 - _core.flatten(stroke, 0.05)[[0, -1], 1] for stroke in made]
    assert any(first < top + 4.6 and last > 36 for first, last in down), down


def test_a_line_that_returns_to_its_end_has_no_direction_there():
    """A line that returns to its own end has no direction there.

    The line goes out and back by half a width each. numpy must not warn.
    """
    line = np.array([[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 0.0, 2.0]])
    square = [np.array([[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]])]
    with warnings.catch_warnings(action="error"):
        assert run_to_cut(line, square) is line
