"""Shapes wider than the brush, filled in several passes: what discs and what the brush cover of them."""

import numpy as np
import pytest
import shapely
from diagnostics import agrees
from svg_text import read

from brushsvg import _core, find_brush
from brushsvg.calibration.from_widths import new_brush
from brushsvg.strokes.contour_fill import contour_passes, painted, region
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.offset_passes import Line
from brushsvg.strokes.skeleton import shape_to_strokes
from brushsvg.strokes.wide_shapes import within_reach

HALF_MM = 4.2  # of round-6 at its deepest
SQUARE = "M5 0H50V45H5Z"
SHAPES = {
    "square": SQUARE,
    "triangle": "M5 48H55L30 4.7Z",
    "heart": "M40 49C12 26 10 17 10 15A15 13 0 0 1 40 11A15 13 0 0 1 70 15C70 17 68 26 40 49Z",
    "bow-tie": "M10 5L70 45V5L10 45Z",
    "bow-tie on its side": "M5 4L95 45V4L5 45Z",
    "plate with a hole": "M5 0H50V45H5ZM17 25a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z",
    "star": "M40 0L46.2 17.9L65 18.2L50 29.7L55.5 47.7L40 37L24.5 47.7L30 29.7L15 18.2L33.8 17.9Z",
    "ring": "M40 1A24 24 0 1 1 39.99 1ZM40 15A10 10 0 1 0 40.01 15Z",
    "disc": "M40 1A24 24 0 1 1 39.99 1Z",
    "bar": "M5 20H85V36H5Z",
    "short bar": "M30 20H54V36H30Z",
    "round short bar": "M35 10H55A8 8 0 0 1 55 26H35A8 8 0 0 1 35 10Z",
    "ell": "M10 0H26V32H60V48H10Z",
    "comb": "M5 5H85V45H70V20H62V45H50V20H40V45H25V20H20V45H5Z",
}


@pytest.fixture
def brush():
    return find_brush("round-6")


def of(d: str, rest: str = 'fill="red" fill-rule="nonzero" stroke="none"'):
    return strokes(read(f'<path id="p" d="{d}" {rest}/>'))[0]


def share_left(shape, made) -> float:
    return shape.difference(painted(made)).area / shape.area


@pytest.mark.slow
@pytest.mark.parametrize("d", SHAPES.values(), ids=SHAPES)
def test_passes_fill_a_shape_and_stay_in_it(brush, d):
    made = of(d)
    shape = region(_core.unite([ring for stroke in made for ring in stroke.wanted_mm]))
    passes, wanted, notices = within_reach(made, brush, "passes")
    assert share_left(shape, passes) < 0.01
    assert painted(passes).difference(shape.buffer(0.03 * HALF_MM + 0.02)).area < 0.01
    assert max(half for each in passes for _, half in each.half_width) <= HALF_MM + 1e-9
    assert not any("unpainted" in notice.sentence for notice in notices)
    assert [each.id for each in passes] == [each.id for each in wanted]
    assert len({each.id for each in passes}) == len(passes)
    assert not any(each.wanted_mm for each in passes)  # or `refined` would draw each to the whole shape
    meant = region(_core.unite([ring for each in wanted for ring in _core.wanted_outline(each, 0.01)]))
    assert meant.symmetric_difference(shape).area < 0.006 * shape.area

    plan = _core.compensate(passes, brush, (100, 50), "closed", 0.05, None).plan
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    whole = _core.unite([ring for stroke in made for ring in stroke.wanted_mm])
    assert _core.overlap(marks.outline_mm, whole) > 0.95


def test_holes_belong_to_no_stroke():
    made = of(SHAPES["plate with a hole"], 'fill="red" fill-rule="evenodd" stroke="none"')
    assert len(made) > 1
    part = _core.unite([ring for stroke in made for ring in stroke.wanted_mm])
    assert _core.area(part) == pytest.approx(45 * 45 - np.pi * 4.5**2, rel=1e-3)


def test_holes_belong_to_no_stroke_of_a_shape_too_large_to_be_cut(monkeypatch):
    monkeypatch.setattr(shape_to_strokes, "MOST_CUT", 0)
    test_holes_belong_to_no_stroke()


def test_a_disc_hardly_wider_than_the_brush_is_no_ring_to_turn_round_in(brush):
    passes, _, _ = within_reach(of("M40 20A5 5 0 1 1 39.99 20Z"), brush, "passes")
    assert not any(each.closed for each in passes)


def test_the_first_pass_is_asked_for_its_own_discs_and_not_for_the_whole_shape(brush):
    passes, wanted, _ = within_reach(of(SQUARE), brush, "passes")
    own = painted(passes[:1]).area
    assert _core.area(wanted[0].wanted_mm) == pytest.approx(own, rel=0.02)
    assert own < 0.7 * 45 * 45


def test_the_outermost_ring_comes_first_and_corners_are_entered_from_their_points(brush):
    passes, _, _ = within_reach(of(SQUARE), brush, "passes")
    rings, corners = [s for s in passes if s.closed], [s for s in passes if s.half_width[0][1] < 1]
    assert [each.id for each in passes[: len(rings)]] == [each.id for each in rings]
    sizes = [np.ptp(_core.flatten(each, 0.02)[:, 0]) for each in rings]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] == pytest.approx(45 - 2 * HALF_MM, abs=0.02)
    assert len(corners) == 4
    for each in corners:
        assert each.half_width[-1][1] > 0.5 * HALF_MM


def test_a_ring_begins_amid_an_edge_as_its_tip_would_stick_out_of_a_corner(brush):
    passes, _, _ = within_reach(of(SQUARE), brush, "passes")
    start = passes[0].middle_mm[0, :2]
    corners = np.array([[5, 50], [50, 50], [50, 5], [5, 5]])
    assert np.hypot(*(corners - start).T).min() > 20


def test_a_short_fat_stroke_is_a_ring_without_a_tip(brush):
    passes, _, _ = within_reach(of(SHAPES["round short bar"]), brush, "passes")
    assert [each.closed for each in passes] == [True]


def test_a_stroke_that_its_own_passes_cover_keeps_them_and_its_direction(brush):
    (stroke,) = of("M10 30Q25 4 50 18T90 15V17Q70 38 48 30T12 32Z")
    passes, wanted, _ = within_reach([stroke], brush, "passes")
    assert [each.id for each in passes] == ["p", "p~2", "p~3"]
    assert passes[0].middle_mm.tolist() == stroke.middle_mm.tolist()
    assert wanted[0].half_width == stroke.half_width


def test_narrow_strokes_of_a_shape_stay_as_they_are(brush):
    made = of("M10 5H30V20H80V25H30V40H10Z")
    narrow = [s for s in made if max(h for _, h in s.half_width) < HALF_MM]
    passes, _, _ = within_reach(made, brush, "passes")
    assert len(narrow) == 1
    assert narrow[0] in passes


def test_strokes_of_one_shape_are_filled_together_others_apart(brush):
    made = of(SHAPES["heart"])
    assert len(made) > 1
    _, _, notices = within_reach(made, brush, "passes")
    assert [notice.where for notice in notices] == [each.id for each in made]
    assert agrees(notices[1], "width-out-of-reach 'first stroke'")
    apart = of("M5 5H30V45H5ZM60 5H85V45H60Z")
    passes, _, _ = within_reach(apart, brush, "passes")
    assert {each.id.split("~")[0] for each in passes} == {"p/1", "p/2"}


def test_what_stays_unpainted_is_told():
    """A brush without narrow marks cannot enter corners."""
    blunt = find_brush("round-6")
    blunt.half_width = _core.Profile([4.0, (HALF_MM - 4.0) / blunt.depth_range_mm[1]])
    (stroke,) = of("M10 5H26V21H10Z")
    passes, _, (notice,) = within_reach([stroke], blunt, "passes")
    left = share_left(region(stroke.wanted_mm), passes)
    assert left == pytest.approx((4 - np.pi) * HALF_MM**2 / 16**2, abs=0.002)
    assert agrees(notice, f"width-out-of-reach '{100 * left:.2g} % of' unpainted 1.4")
    (stroke,) = of(SQUARE)
    assert share_left(region(stroke.wanted_mm), within_reach([stroke], blunt, "passes")[0]) < 0.02


def test_a_line_of_changing_width_is_as_wide_as_its_knots_say():
    """Between the ends of a straight line, too, which was flattened to two rows: a third of the mark was lost."""
    knots = [(0.0, 0.1), (0.4, 4.2), (1.0, 4.2)]
    stroke = _core.Stroke(middle_mm=np.array([[0, 0, 10 / 3, 0, 20 / 3, 0, 10, 0]]), half_width=knots)
    wanted = _core.area(_core.wanted_outline(stroke, 0.005))
    assert wanted == pytest.approx(painted([stroke]).area, rel=2e-3)
    assert wanted == pytest.approx(105.8, abs=0.3)


def test_what_is_no_lettering_is_left_to_the_middle_lines():
    turns = np.linspace(0, 2 * np.pi, 9000, endpoint=False)
    far = 30 + np.arange(9000) * 7919 % 1000 / 1000
    rough = shapely.Polygon(np.column_stack([far * np.cos(turns), far * np.sin(turns)]))
    assert contour_passes(rough, [], [], 0.0, HALF_MM) == []
    assert contour_passes(shapely.box(0, 0, 4000, 4000), [], [], 0.0, 1.0) == []
    line = Line(np.array([[0.0, 0, 1, 0, 2, 0, 3, 0]]), [(0.0, 1.0)])
    assert painted([line]).area == pytest.approx(6 + np.pi, rel=1e-3)


@pytest.mark.parametrize("names", [("icon/1", "icon/2"), ("a", "b")])
def test_shapes_that_touch_are_filled_each_in_its_own_colour(brush, names):
    """Names that look like parts of one element made one shape of two: all passes in the first one's red."""
    body = "".join(
        f'<path id="{name}" fill="{colour}" stroke="none" d="M{x} 10h40v30h-40z"/>'
        for name, colour, x in zip(names, ("#ff0000", "#0000ff"), (10, 40), strict=True)
    )
    passes, wanted, _ = within_reach(strokes(read(body))[0], brush, "passes")
    for name, colour, x in zip(names, ("#ff0000", "#0000ff"), (10, 40), strict=True):
        own = [each for each in passes if each.origin.element == name]
        assert {each.colour for each in own} == {colour}
        assert [each.origin.lane for each in own] == list(range(1, len(own) + 1))
        assert share_left(shapely.box(x, 10, x + 40, 40), own) < 0.02
    assert [each.id for each in wanted] == [each.id for each in passes]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["square", "triangle", "star", "heart", "comb"])
def test_a_pen_fills_a_shape_in_passes_of_its_one_width(name):
    """Where it is as narrow as the pen, and in corners, it stays out: its nib is never narrower."""
    pen = new_brush("pen", 0.0, [(1.0, 2.4)])
    made = of(SHAPES[name])
    shape = region(_core.unite([ring for stroke in made for ring in stroke.wanted_mm]))
    passes, _, _ = within_reach(made, pen, "passes")
    marks = _core.simulate(_core.compensate(passes, pen, (100.0, 100.0)).plan, pen)
    _core.trace_outlines(marks, pen)
    inked = region(_core.unite([ring for each in marks.passes for ring in each.outline_mm]))
    assert inked.difference(shape.buffer(0.03 * 1.2 + 0.02)).area < 0.05
    assert shape.difference(inked).area / shape.area < 0.03
    assert within_reach(made, pen, "auto") == (made, made, [])  # unless asked it draws middle lines
