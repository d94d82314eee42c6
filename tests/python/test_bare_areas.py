"""A limb too small to be found as a stroke gets an extra stroke."""

import numpy as np
import pytest
import shapely

from brushsvg import _core, find_brush
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.show.evaluation import figures
from brushsvg.strokes.swept_areas import region, rings_of

SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:b="https://brushsvg.org/ns" width="60mm" height="60mm" '
    'viewBox="0 0 60 60"><path id="p" {} d="{}"/></svg>'
)
FLAG = [(20, 12), (31, 3), (28, 14), (28, 45), (20, 45)]
APEX = [(20, 16), (30, 3), (30, 50), (22, 50), (22, 16)]
BLOCK = [(20, 5), (28, 5), (28, 30), (20, 30)]


def prepared(tmp_path, outline, attributes="", **options):
    file = tmp_path / "p.svg"
    points = " ".join(f"{x} {y}" for x, y in outline)
    file.write_text(SVG.format(attributes, f"M{points}Z"))
    return prepare(file, Options(**options))


def shape_of(corners):
    return shapely.Polygon([(x, 60 - y) for x, y in corners])


def blank(corners, marks):
    """Return the largest bare piece as a share of the shape, and whether a line fits.

    The line is the brush's finest one.
    """
    shape = shape_of(corners)
    painted = shapely.union_all([shapely.make_valid(shapely.Polygon(ring)) for ring in marks.outline_mm])
    left = shapely.difference(shape, painted).buffer(-0.3).buffer(0.3)
    largest = max(shapely.get_parts(left), key=shapely.area, default=shapely.Point())
    brush = find_brush("round-6")
    fits = largest.area > 0 and shapely.maximum_inscribed_circle(largest, 0.01).length > brush.half_width(1.0)
    return largest.area / shape.area, fits


@pytest.mark.parametrize("compensation", ["closed", "refined"])
@pytest.mark.parametrize("corners", [FLAG, APEX])
def test_limbs_of_a_thick_stem_are_painted(tmp_path, corners, compensation):
    work = prepared(tmp_path, corners, compensation=compensation)
    share, fits = blank(corners, predict(work))
    assert share < 0.03 or not fits
    assert not work.unreached and not work.missed
    # A plan that is already as good is not refined, and a notice says so. Which plan is better depends on the
    # last digits.
    assert {notice.code for notice in work.notices} <= ({"flag-without-effect"} if compensation == "refined" else set())


TAIL = [(20, 5), (28, 5), (28, 36), (29, 40), (32, 44.5), (25, 45), (21, 44), (20, 41)]


def test_a_visible_bare_corner_is_painted_except_with_plain_ends_or_corners(tmp_path):
    """A visible bare corner is painted, except with plain ends or plain corners.

    The corner is 1.3 % of the shape: the tail of a foot, like the R of Lobster. Bare pieces once counted only
    from 3 % on.
    """
    work = prepared(tmp_path, TAIL)
    assert [stroke.id for stroke in work.strokes][:2] == ["p", "p~2"]
    share, _ = blank(TAIL, predict(work))
    assert share < 0.005
    for plain in ({"end": "round"}, {"start": "pointed"}, {"corners": "turn"}):
        work = prepared(tmp_path, TAIL, **plain)
        assert [stroke.id for stroke in work.strokes] == ["p"]
    share, _ = blank(TAIL, predict(work))
    assert share > 0.01


def test_a_flag_without_its_extra_stroke_stays_bare(tmp_path):
    work = prepared(tmp_path, FLAG)
    work.plan.passes = [each for each in work.plan.passes if each.stroke == "p"]
    share, fits = blank(FLAG, predict(work))
    assert share > 0.03 and fits


def knobbed(out_mm, long_mm):
    """Return a thin stem with a round knob at its side."""
    turns = np.linspace(0, np.pi, 10)
    knob = zip(24 + out_mm * np.sin(turns), 18 + long_mm / 2 * (1 - np.cos(turns)), strict=True)
    return [(20, 10), (24, 10), *((round(x, 2), round(y, 2)) for x, y in knob), (24, 50), (20, 50)]


@pytest.mark.parametrize(("out_mm", "most_turns"), [(2.5, 0.7), (3, 0.3), (4, 0.3)])
def test_a_knob_on_a_stem_is_painted_along_its_edge(tmp_path, out_mm, most_turns):
    """A knob along its stem is painted along its edge and is no blob.

    A straight stroke into the knob once added a full turn to the outline, or left a tenth of the knob bare.
    """
    corners = knobbed(out_mm, 2 * out_mm)
    work = prepared(tmp_path, corners)
    assert not work.notices
    mark, shape = predict(work).outline_mm, rings_of(shape_of(corners))
    assert _core.excess_turning(mark, shape) < most_turns
    assert _core.overlap(mark, shape) > 0.98


def swelling(broadest_mm):
    """Return a stroke of 48 mm that swells from 5 mm to the given width."""
    along = np.linspace(-24, 24, 33)
    half = 2.5 + (broadest_mm / 2 - 2.5) * np.cos(np.pi * along / 48) ** 2
    left, right = (np.round(np.column_stack([30 + side * half, 30 + along]), 3).tolist() for side in (-1, 1))
    return [*left, *right[::-1]]


def test_a_shape_wider_than_the_brush_gets_extra_strokes_except_with_clamp(tmp_path):
    broad = swelling(10.8)
    work = prepared(tmp_path, broad)
    assert [stroke.id for stroke in work.strokes] == ["p", "p~2", "p~3"]
    assert _core.overlap(predict(work).outline_mm, rings_of(shape_of(broad))) > 0.98
    assert [(each.code, each.advice) for each in work.notices] == [("width-out-of-reach", "")]
    work = prepared(tmp_path, broad, wide="clamp")
    assert [stroke.id for stroke in work.strokes] == ["p"]
    assert "width-out-of-reach" in [each.code for each in work.notices]


def test_all_strokes_of_a_drawing_are_painted_wider_than_the_brush_or_none(tmp_path):
    """All wide strokes of a drawing are painted wider than the brush, or none.

    The drawing has sides of 2.9 %, and stems of 9.1 mm next to them.
    """
    broad = swelling(10.4)
    assert [stroke.id for stroke in prepared(tmp_path, broad).strokes] == ["p", "p~2", "p~3"]
    stems = "".join(f'<path id="s{x}" d="M{x} 6h9.1v48h-9.1z"/>' for x in (2, 46))
    file = tmp_path / "p.svg"
    file.write_text(file.read_text().replace("</svg>", f"{stems}</svg>"))
    names = [stroke.id for stroke in prepare(file, Options()).strokes]
    assert {"p~2", "s2~2", "s46~2"} <= set(names) or names == ["p", "s2", "s46"]


def test_an_extra_stroke_is_named_after_its_stem_and_painted_after_it(tmp_path):
    work = prepared(tmp_path, FLAG)
    assert [stroke.id for stroke in work.strokes] == ["p", "p~2"]
    assert [stroke.id for stroke in work.drawn] == ["p", "p~2"]
    assert [each.stroke for each in work.plan.passes] == ["p", "p~2"]


def test_an_extra_stroke_begins_under_paint_and_stays_inside_the_shape(tmp_path):
    stem, limb = prepared(tmp_path, FLAG).strokes
    begun = shapely.Point(limb.middle_mm[0][:2])
    assert shapely.LineString(stem.middle_mm.reshape(-1, 2)).distance(begun) < 0.2
    shape = shape_of(FLAG)
    for at, half in limb.half_width:
        place = limb.middle_mm[0][:2] + at * (limb.middle_mm[-1][-2:] - limb.middle_mm[0][:2])
        assert shape.boundary.distance(shapely.Point(place)) > half - 0.15
    assert shapely.union_all([shapely.Polygon(ring) for ring in limb.target_mm]).within(shape.buffer(1e-3))


def test_each_stroke_is_compared_with_its_own_part_of_the_shape(tmp_path):
    """Each stroke is compared with the part of the shape that it must paint.

    The target of the stem once still contained its flag. The target of the flag contained its covered
    beginning.
    """
    work = prepared(tmp_path, FLAG)
    rows, _ = figures.measure_figures(figures.PaintedPlan(work.plan, predict(work), work.brush, work.strokes))
    assert all(row.overlap > 0.9 for row in rows)
    stem, limb = (region(stroke.target_mm) for stroke in work.strokes)
    shape = shape_of(FLAG)
    assert shapely.union(stem, limb).area == pytest.approx(shape.area, rel=1e-3)
    tip = shape.intersection(shapely.box(0, 60 - 7, 60, 60))
    assert shapely.intersection(limb, tip).area > 0.9 * tip.area
    assert shapely.intersection(stem, tip).area < 0.1 * tip.area


def test_an_extra_stroke_is_repeated_as_often_as_its_shape(tmp_path):
    work = prepared(tmp_path, FLAG, 'data-brushsvg-passes="2"')
    assert [stroke.id for stroke in work.strokes] == ["p", "p#2", "p~2", "p#2~2"]


def test_shapes_without_bare_areas_and_uncompensated_lines_get_no_extra_strokes(tmp_path):
    assert [stroke.id for stroke in prepared(tmp_path, BLOCK).strokes] == ["p"]
    assert [stroke.id for stroke in prepared(tmp_path, FLAG, compensation="none").strokes] == ["p"]
