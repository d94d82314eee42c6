"""Corners of drawn lines: where closed ones begin, and where the brush is lifted."""

import itertools
import re

import numpy as np
import pytest
from svg_text import read

from brushsvg import _core, find_brush
from brushsvg.__main__ import main
from brushsvg.pipeline.options import Options
from brushsvg.pipeline.preparation import prepare
from brushsvg.strokes import corners, outline_corners
from brushsvg.strokes.corners import lifted_at_corners
from brushsvg.strokes.extraction import strokes
from brushsvg.strokes.outline_corners import squared_at_corners
from brushsvg.strokes.swept_areas import region
from brushsvg.strokes.trial_mark import trial_mark

LINE = 'fill="none" stroke="black" stroke-width="4"'
RECT = "M15 15H55V45H15Z"
STAR = "M50 2L55 16H70L58 25L62 40L50 31L38 40L42 25L30 16H45Z"
APEX = "M25 50L40 12L55 50"


def of(d: str, rest: str = LINE) -> list:
    return strokes(read(f'<path id="p" d="{d}" {rest}/>'))[0]


@pytest.fixture
def brush():
    return find_brush("round-6")


def marks_of(some: list, brush):
    marks = _core.simulate(_core.compensate(some, brush, (100, 60)).plan, brush)
    _core.trace_outlines(marks, brush)
    return marks.outline_mm


def length_mm(stroke) -> float:
    return _core.flatten(stroke, 0.01)[-1, 2]


def test_a_closed_line_begins_amid_its_longest_straight_side_and_paints_no_thorn(brush):
    (made,) = of(RECT)
    start = made.middle_mm[0, :2]
    assert start == pytest.approx([35, 35], abs=1e-9) or start == pytest.approx([35, 5], abs=1e-9)
    assert made.middle_mm[-1, 6:] == pytest.approx(start, abs=1e-12)
    assert length_mm(made) == pytest.approx(140, abs=1e-6)
    wanted = _core.wanted_outline(made, 0.01)
    points = np.concatenate(marks_of([made], brush))
    box = np.concatenate(wanted)
    beyond = np.maximum(box.min(axis=0) - points.min(axis=0), points.max(axis=0) - box.max(axis=0))
    assert beyond.max() < 0.3  # 1.7 before


@pytest.mark.parametrize(
    "d", ["M10 30a20 20 0 1 0 40 0a20 20 0 1 0 -40 0Z", "M10 10C40 10 40 50 10 50C30 40 30 20 10 10Z"]
)
def test_closed_lines_without_a_corner_there_or_without_a_straight_side_begin_as_drawn(d):
    (made,) = of(d)
    assert made.middle_mm[0, 0] == pytest.approx(10, abs=1e-9)


def test_widths_go_with_the_line_when_it_begins_elsewhere():
    from brushsvg.strokes.corners import begun_amid_a_side

    corners = np.array([[0, 0], [30, 0], [30, 10], [0, 10], [0, 0]], float)
    cubics = np.stack([corners[:-1] + k / 3 * np.diff(corners, axis=0) for k in range(4)], axis=1)
    begun, widths = begun_amid_a_side(cubics, [(0.0, 1.0), (0.5, 3.0), (1.0, 1.0)])
    assert begun[0, 0] == pytest.approx([15, 0])
    at, half = np.array(widths).T
    assert (np.diff(at) >= 0).all()
    assert (at[0], at[-1]) == (0, 1)
    # 15, 45 and 65 mm along the old line of 80 mm lie 0, 30 and 50 mm along the new one
    assert np.interp(np.array([0, 30, 50, 65, 80]) / 80, at, half) == pytest.approx(
        [1.75, 2.75, 1.75, 1.0, 1.75]
    )


@pytest.mark.parametrize(("d", "count"), [(STAR, 5), (APEX, 2), ("M35 5H60L35 20H60", 3)])
def test_it_is_lifted_at_sharp_corners_where_a_turn_would_leave_a_blot(brush, d, count):
    made = of(d)
    parts = lifted_at_corners(made, brush)
    assert [part.id for part in parts] == ["p", *(f"p~{k}" for k in range(2, count + 1))]
    assert sum(map(length_mm, parts)) == pytest.approx(length_mm(made[0]), abs=1e-6)
    assert all(a.middle_mm[-1, 6:] == pytest.approx(b.middle_mm[0, :2]) for a, b in itertools.pairwise(parts))
    wanted = _core.wanted_outline(made[0], 0.01)
    turned, lifted = (_core.overlap(marks_of(some, brush), wanted) for some in (made, parts))
    assert lifted > turned + 0.004


@pytest.mark.parametrize("d", [RECT, "M10 10L40 10L60 30L90 30", "M10 30C30 0 60 0 90 30"])
def test_it_turns_in_place_where_that_is_as_good(brush, d):
    made = of(d)
    assert lifted_at_corners(made, brush) == made


def test_a_pen_without_lag_and_strokes_of_letters_are_not_lifted(brush):
    made = of(APEX)
    assert lifted_at_corners(made, find_brush("rigid")) == made
    letter = of("M10 10H15L35 50H30Z", 'fill="black" stroke="none"')
    assert lifted_at_corners(letter, brush) == letter


def test_widths_of_parts_are_those_of_the_line(brush):
    stroke = of(APEX)[0]
    stroke.half_width = [(0.0, 1.0), (0.25, 2.0), (1.0, 3.0)]
    first, second = lifted_at_corners([stroke], brush)
    there = 2 + 1 / 3
    assert np.array(first.half_width) == pytest.approx(np.array([(0, 1), (0.5, 2), (1, there)]))
    assert np.array(second.half_width) == pytest.approx(np.array([(0, there), (1, 3)]))


@pytest.mark.parametrize(
    ("flags", "count"), [([], 2), (["--corners", "turn"], 1), (["--compensation", "none"], 1)]
)
def test_corners_can_be_chosen_and_check_knows(tmp_path, capsys, flags, count):
    drawing = tmp_path / "apex.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="60mm" viewBox="0 0 80 60">'
        f'<path id="p" d="{APEX}" {LINE}/></svg>'
    )
    program = tmp_path / "apex.ngc"
    assert main(["convert", str(drawing), str(program), "--lenient", *flags]) == 0
    assert re.search(rf"; {count}\b", capsys.readouterr().err)
    assert main(["check", str(program), str(drawing), *(flags if flags[:1] == ["--corners"] else [])]) == 0


def test_a_zigzag_finer_than_it_is_wide_is_not_lifted_nor_tried(brush, monkeypatch):
    """Five hundred corners took half a minute."""
    zigzag = "M10 30" + "".join(f"L{10.4 + 0.4 * k:.1f} {30 + 3 * (k % 2)}" for k in range(60))
    (made,) = of(zigzag)
    monkeypatch.setattr(corners, "_is_better_lifted", None)
    assert lifted_at_corners([made], brush) == [made]


def test_strokes_without_width_or_length_stay(brush):
    (made,) = of(APEX)
    made.half_width = []
    assert lifted_at_corners([made], brush) == [made]
    still = _core.Stroke("s", np.full((3, 8), 5.0), half_width=[(0.0, 1.0)])
    assert lifted_at_corners([still], brush) == [still]


def test_parts_of_two_lines_have_names_of_their_own(brush):
    drawn = strokes(read(f'<path id="a~2" d="{APEX}" {LINE}/><path id="a" d="{APEX}" {LINE}/>'))[0]
    names = [stroke.id for stroke in lifted_at_corners(drawn, brush)]
    assert len(names) == 4 and len(set(names)) == 4, names


FILL = 'fill="black" stroke="none"'
EL = "M20 5H28V42H45V49H20Z"


PEE = "M20 5H33Q46 5 46 15Q46 25 33 25H28V39H20ZM28 11V19H33Q39 19 39 15Q39 11 33 11Z"


@pytest.mark.parametrize(("d", "corner_mm", "most"), [(EL, (20.0, 1.0), 0.3), (PEE, (20.0, 45.0), 0.4)])
def test_an_outline_that_turns_in_a_corner_is_two_strokes_whose_marks_fill_it(brush, d, corner_mm, most):
    """Turned in one stroke the outer corner is as round as the stem is wide. The second of P runs back to the first."""
    whole = of(d, FILL)
    assert len(whole) == 1
    parts = squared_at_corners(whole, brush)
    assert [str(part.id) for part in parts] == ["p", "p~2"]
    assert parts[0].settings.start is None
    assert parts[1].settings.start == "exposed"
    shape = whole[0].wanted_mm
    assert _core.area(_core.unite([ring for part in parts for ring in part.wanted_mm])) == pytest.approx(
        _core.area(shape), abs=1e-3
    )

    def bare_mm2(some) -> float:
        low = np.array(corner_mm) - (0.0, 4.0 * (corner_mm[1] > 30))
        corner = [low + np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)])]
        wanted = _core.intersect(shape, corner)
        assert _core.area(wanted) == pytest.approx(16, abs=0.1)
        mark = trial_mark(some, brush)
        return _core.area(wanted) - _core.area(_core.intersect(wanted, mark))

    assert bare_mm2(parts) < most * bare_mm2(whole)


FLAG = "M10 5H25V50H17V10H10Z"


@pytest.mark.parametrize("neighbour", ["", "M40 20H52V22H40Z"])
def test_the_flag_of_a_serif_is_thinner_than_its_stem_and_their_corner_is_filled(brush, neighbour):
    """The stem fills the corner: the flag is lifted inside of it. What stands beside is wider than the brush."""
    wide = "M40 5H52V45H40Z" if neighbour else ""
    whole = of(FLAG + wide, FILL)
    stroke = next(each for each in whole if each.wanted_mm[0][:, 0].min() < 30)
    flag, stem = [each for each in squared_at_corners(whole, brush) if each.wanted_mm[0][:, 0].min() < 30]
    assert flag.settings.end == "lifted"
    assert stem.settings.start in (None, "auto")
    np.testing.assert_allclose(stem.middle_mm[0, :2], (21, 41), atol=0.2)  # half a width inside
    corner = [np.array([(21.0, 41.0), (25.0, 41.0), (25.0, 45.0), (21.0, 45.0)])]

    def bare_mm2(some) -> float:
        return _core.area(corner) - _core.area(_core.intersect(corner, trial_mark(some, brush)))

    assert _core.area(_core.intersect(corner, stroke.wanted_mm)) == pytest.approx(16, abs=0.1)
    assert bare_mm2([flag, stem]) < 0.25 * bare_mm2([stroke])


FEET = ["M17 5H25V45H12V42.3H17Z", "M17 5H25V45H14.2V43H17Z"]
FLAG_AND_FOOT = "M12 5H25V19.3H30V22H17V7.7H12Z"


@pytest.mark.parametrize(("d", "thin"), [(FEET[0], [1]), (FEET[1], [1]), (FLAG_AND_FOOT, [0, 2])])
def test_a_stem_and_its_serifs_are_strokes_along_their_edges_that_fill_their_corners(brush, d, thin):
    """Serifs were led aslant, since the axis of one as short bends all along, and began pointed amid the corner; the
    thinner one was not cut, since its line turns by less than 50 degrees there."""
    whole = of(d, FILL)
    parts = squared_at_corners(whole, brush)
    assert (len(whole), len(parts)) == (1, 1 + len(thin))
    for k in thin:
        cubics = parts[k].middle_mm
        onward = cubics[:, 6:] - cubics[:, :2]
        along = onward[np.hypot(*onward.T).argmax()]
        assert abs(along[1]) < 0.02 * abs(along[0])
    assert_is_whole(whole[0], parts, brush)


def test_two_corners_of_one_leg_take_no_more_of_it_than_there_is(brush, monkeypatch):
    """Each looked for its straight leg up to the other one: the stem ran back, and a round blot stuck out beside it."""
    whole = of(FLAG_AND_FOOT, FILL)
    monkeypatch.setattr(outline_corners, "AWAY", 2.4)
    parts = squared_at_corners(whole, brush)
    assert len(parts) == 3
    assert_is_whole(whole[0], parts, brush)


def assert_is_whole(stroke, parts, brush):
    """Nothing that one sees is missing, or sticks out."""
    shape, mark = region(stroke.wanted_mm), region(trial_mark(parts, brush))
    assert mark.difference(shape.buffer(0.3)).area < 0.05
    assert shape.difference(mark).buffer(-0.3).buffer(0.3).area < 0.002 * shape.area


def test_bends_and_shapes_wider_than_the_brush_stay_one_stroke(brush):
    bend = of("M20 5H28V30Q28 42 40 42H45V50H40Q20 50 20 30Z", FILL)
    wide = of("M20 5H31V36H55V47H20Z", FILL)
    for some in (bend, wide):
        assert len(squared_at_corners(some, brush)) == len(some)


def test_corners_of_outlines_are_cut_unless_said_otherwise(tmp_path):
    file = tmp_path / "l.svg"
    file.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="0 0 60 60">'
        f'<path id="p" d="{EL}"/></svg>'
    )
    assert len(prepare(file, Options()).plan.passes) == 2
    assert len(prepare(file, Options(corners="turn")).plan.passes) == 1
    assert len(prepare(file, Options(end="lifted")).plan.passes) == 1


def test_the_sharp_corners_of_a_z_are_filled_by_strokes_of_their_own(brush):
    """They turn by 133 degrees: as one stroke both were round outside."""
    whole = of("M10 6H44V12L20 38H44V44H10V38L34 12H10Z", 'fill="black" stroke="none"')
    shape = region(whole[0].wanted_mm)
    parts = squared_at_corners(whole, brush)
    assert (len(whole), len(parts)) == (1, 3)
    one, three = (region(marks_of(each, brush)) for each in (whole, parts))
    overlaps = [shape.intersection(mark).area / shape.union(mark).area for mark in (one, three)]
    assert overlaps[1] > overlaps[0] + 0.01


@pytest.mark.parametrize("side", [1, -1])
def test_a_thin_serif_is_cut_from_the_stem_that_it_widens_into(brush, side):
    """Beside an arm there is no corner, and one stroke bulged out by 3.6 mm2 where it was pressed as it turned."""
    outline = [(6, 10), (20, 10), (20, 13), (30, 9), (30, 10), (20, 15.2)]
    outline += [(20, 50), (12, 50), (12, 10.8), (6, 10.8)]
    points = " ".join(f"{18 + side * (x - 18)} {y}" for x, y in outline)
    whole = of(f"M{points}Z", FILL)
    shape = region([ring for stroke in whole for ring in stroke.wanted_mm])
    parts = squared_at_corners(whole, brush)
    assert (len(whole), len(parts)) == (2, 3)
    one, three = (
        region(marks_of(each, brush)).difference(shape.buffer(0.15)).area for each in (whole, parts)
    )
    assert one > 3 and three < 0.1
