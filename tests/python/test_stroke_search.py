"""Filled shapes are painted whole: corners, slabs, arms and counters.

The search uses the simulated marks.
"""

import numpy as np
import pytest
import shapely

from brushsvg import _core, find_brush
from brushsvg.errors import Error
from brushsvg.jobs.options import Options
from brushsvg.jobs.prediction import predict
from brushsvg.jobs.preparation.preparation import prepare
from brushsvg.read.svg import read_svg
from brushsvg.strokes import skeleton
from brushsvg.strokes.skeleton import filled_rings, outline_strokes
from brushsvg.strokes.swept_areas import region

FLAG = "M10 5H25V50H17V10H10Z"
CORNERS = {
    "an L": "M20 5H28V42H45V49H20Z",
    "a P": "M20 5H33Q46 5 46 15Q46 25 33 25H28V39H20ZM28 11V19H33Q39 19 39 15Q39 11 33 11Z",
    "a flag": FLAG,
    "a foot": "M17 5H25V45H12V42.3H17Z",
    "a thin foot": "M17 5H25V45H14.2V43H17Z",
    "a Z": "M10 6H44V12L20 38H44V44H10V38L34 12H10Z",
    "a slab on both sides": "M8 44V38H20V14H12V8H36V14H28V38H40V44Z",
    "a diamond": "M30 12L40 26L30 40L20 26Z",
    "a bar wider than the brush": "M10 20H52V30H10Z",
    # the end of the bar that a changed stroke painted in the search was bare in the plan
    "a 7": "M16.005 54.132C16.076 41.21 21.472 25.519 30.56 5H5C5 8.408 5.426 12.1 7.13 12.1"
    "C12.242 12.1 16.076 11.958 20.194 11.674C15.153 20.549 7.84 40.997 7.84 51.931"
    "C7.84 53.777 9.331 54.132 16.005 54.132Z",
    # the line through the waist was wider than the shape there
    "an R with a waist": "M5 54.7C12.81 54.7 12.95 54.7 12.95 53.28V35.53H13.45C13.88 35.53 14.3 35.53 14.66 35.46"
    "C16.43 38.02 19.06 43.62 19.27 54.7C21.05 54.84 22.68 54.91 23.96 54.91C27.79 54.91 28.07 54.49 28.07 53.14"
    "C27.72 42.35 24.31 36.1 21.97 32.97C24.88 30.7 26.94 26.65 26.94 19.63C26.94 7.98 22.04 5 13.09 5H6.42"
    "C5 5 5 6.42 5 6.42ZM12.95 28.22V11.89H14.87C17.07 11.89 17.99 14.09 17.99 19.2"
    "C17.99 26.58 16.57 28.22 14.37 28.22Z",
    # between the tip of the stem and its nearest middle line, that of the arm, is a notch
    "an r": "M6.1 30.5Q5.7 30.5 5.3 30.3Q5 30.1 5 29.7Q5 29.3 5.3 29Q5.7 28.8 6.3 28.6"
    "Q7.6 28.2 8 27.7Q8.4 27.3 8.4 26.4V13.3Q8.4 12.1 8.1 11.4"
    "Q7.8 10.6 6.7 10.3Q6.4 10.2 6.2 10Q6 9.8 6 9.3Q6 8.5 6.7 8.3Q8.5 7.9 10.7 7.1"
    "Q12.9 6.4 14.4 5.6Q14.7 5.4 15.1 5.2Q15.5 5 15.7 5Q16.2 5 16.2 5.6Q16.2 5.9 16.2 6.8Q16.2 7.7 16.1 8.6"
    "Q16.1 9.5 16.1 10.1Q16.1 10.6 16.3 10.6Q17.1 9.4 18.3 8.3Q19.5 7.2 20.8 6.4Q22.2 5.7 23.5 5.7Q25.5 5.7 26.3 6.4"
    "Q27.2 7.2 27.2 8.4Q27.2 9.2 26.7 10.2Q26.2 11.3 25.5 12Q24.7 12.8 23.9 12.8Q23.4 12.8 22.8 12.5"
    "Q22.2 12.2 21.6 12Q21.1 11.7 20.5 11.5Q20 11.2 19.5 11.2Q18.1 11.2 17 12.3Q15.9 13.4 15.9 16.6V25.9"
    "Q15.9 27.1 16.6 27.6Q17.3 28.1 18.9 28.6Q19.5 28.8 19.8 29Q20.2 29.3 20.2 29.7Q20.2 30.5 19.2 30.5"
    "Q17.5 30.5 15.7 30.4Q13.8 30.3 12.4 30.3Q11.4 30.3 10.4 30.3Q9.4 30.4 8.3 30.5Q7.3 30.5 6.1 30.5Z",
}


def painted(tmp_path, d, **options):
    """Return the shape, the mark and the plan of a path."""
    file = tmp_path / "shape.svg"
    file.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="0 0 60 60">'
        f'<path id="p" d="{d}"/></svg>'
    )
    work = prepare(file, Options(brush=find_brush("round-6"), **options))
    return (
        region(filled_rings(read_svg(file.read_bytes()).elements[0])),
        region(predict(work).outline_mm),
        work.plan,
    )


@pytest.mark.parametrize("d", CORNERS.values(), ids=CORNERS)
def test_no_visible_area_is_missing_or_overpainted(tmp_path, d):
    shape, mark, _ = painted(tmp_path, d)
    assert mark.difference(shape.buffer(0.3)).area < 0.1
    missing = shape.buffer(-0.15).difference(mark)
    largest = max((each.area for each in shapely.get_parts(missing)), default=0.0)
    # A stroke costs as much as 0.1 squares of the largest half width. Smaller areas get no stroke.
    assert largest < 0.03 * 4.2**2
    assert shape.intersection(mark).area / shape.union(mark).area > 0.965


BRACKETED = (
    "M5 76.2 5.8 73H15.8Q18.4 73 19.1 70.4L26.1 44.4L18.2 12.6Q17.4 10.1 16.3 9.15Q15.2 8.2 13.2 8.2H5.8L6.6 5H38.2"
    "L37.4 8.2H31.5Q29 8.2 27.8 9.7Q26.6 11.2 27.3 12.9L33.9 40.7L51.1 20.9Q52.6 19.1 53.35 18.25Q54.1 17.4 55.1 15.5"
    "Q56.1 13.6 56.1 12.1Q56.1 8.2 51.3 8.2H47L47.8 5H77.4L76.6 8.2H71.9Q66.2 8.2 60 15.5L35.5 43.3L28.2 70.4"
    "Q27.4 73 30 73H40L39.2 76.2Z"
)


def test_a_bracket_that_belongs_to_two_strokes_is_painted(tmp_path):
    """The bracket between a hairline and its serif is painted, although two strokes share its edge.

    Rounding left a slit between the parts of both strokes. No stroke was added along the edge with the slit, and
    2.8 mm2 stayed bare.
    """
    shape, mark, _ = painted(tmp_path, BRACKETED)
    missing = shape.buffer(-0.15).difference(mark)
    assert max(each.area for each in shapely.get_parts(missing)) < 1.0


HAIRLINES = {  # heavy diagonals with hairlines, as in the letters z and k
    "z": "M20 6H41.99L29.83 27.4C33.99 27.4 39.22 25.02 40.49 19.28H41.49V28.02H20"
    "L32.16 6.61C28 6.61 22.77 9 21.5 14.73H20.5Z",
    "a low z": "M20 6H41.18L29.6 28.33C33.18 28.33 38.53 25.91 39.68 22.53H40.68V28.91H20"
    "L31.58 6.58C28 6.58 22.65 9 21.5 12.38H20.5Z",
    "k": "M19.5 6H28.75V27.61L39.75 20.38H36.75V19.82H44.75V20.38H41.05L35.14 24.01L45.49 36.91H46.99V37.47H36.5V36.91"
    "H38L29.75 28.97L28.75 29.17V36.91H30.75V37.47H19.5V36.91H22V6.56H19.5Z",
}


@pytest.mark.parametrize("d", HAIRLINES.values(), ids=HAIRLINES)
def test_hairlines_hold_a_letter_together_in_few_strokes(tmp_path, d):
    """Hairlines hold a letter together without many strokes.

    An added stroke was once cut short of the area that it should paint, and was added again up to 200 times.
    Where a stroke was cut in parts, no candidate ran along its middle line, and the hairline between the
    parts stayed bare.
    """
    shape, mark, plan = painted(tmp_path, d)
    assert len(plan.passes) < 25
    assert len(shapely.get_parts(mark)) == 1
    assert shape.intersection(mark).area / shape.union(mark).area > 0.95


def test_the_arms_of_a_k_touch_its_stem(tmp_path):
    """The arms of a k touch its stem.

    Each stroke was within its own limb, and a gap of 0.24 mm was left between them without a notice.
    """
    shape, mark, _ = painted(
        tmp_path, "M20 20H26.1V32.7L31.5 20H37.4L31.8 33.5L37.8 50H31.7L27.1 36.6L26.1 38.3V50H20Z"
    )
    assert len(shapely.get_parts(shape)) == len(shapely.get_parts(mark)) == 1


def test_corners_stay_bare_with_plain_turns_and_ends(tmp_path):
    plans = [painted(tmp_path, CORNERS["an L"], **plain)[2] for plain in ({}, {"corners": "turn"}, {"end": "round"})]
    assert len(plans[0].passes) > len(plans[1].passes) == len(plans[2].passes) == 1


def test_a_counter_stays_open(tmp_path):
    """A counter stays open.

    In a fat 4, a stroke once ran down the counter.
    """
    shape, mark, _ = painted(tmp_path, "M20 5H32V35H38V43H32V52H22V43H6V36ZM22 18L14 35H22Z")
    assert mark.difference(shape.buffer(0.15)).area < 1.0
    counter = shapely.Polygon([(22, 60 - 18), (14, 60 - 35), (22, 60 - 35)])
    assert counter.buffer(-0.3).intersection(mark).area < 0.05 * counter.area


@pytest.mark.parametrize(("detail", "corners"), [("draft", 0), ("normal", 4), ("fine", 4)])
def test_the_detail_setting_limits_the_area_that_gets_a_stroke(detail, corners):
    """The detail setting decides how small an area can be and still get a stroke.

    A square of 5 mm, painted by a dot, lacks 0.21 squares of its half width in each corner.
    """
    square = np.array([(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 5.0)])
    brush = find_brush("round-6")
    dot = _core.Stroke("p", np.full((1, 8), 2.5), half_width=[(0.0, 2.5)])
    passes = _core.compensate([dot], brush, None, start="round").plan.passes
    ((_, _, added),) = _core.search_strokes([([square], [dot], list(passes))], brush, detail)
    assert len(added) == corners


def test_a_stroke_with_user_defined_ends_stays_unchanged(tmp_path):
    d, words = CORNERS["a slab on both sides"], 'data-brushsvg-end="round" data-brushsvg-start="pointed"'
    file = tmp_path / "s.svg"
    file.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="0 0 60 60">'
        f'<path id="p" d="{d}" {words}/></svg>'
    )
    work = prepare(file, Options(brush=find_brush("round-6")))
    assert {stroke.settings.end for stroke in work.strokes} == {"round"}
    assert len(work.strokes) == len(prepare(file, Options(brush=find_brush("round-6"), detail="draft")).strokes)


@pytest.mark.parametrize("plain", [{"end": "round"}, {"start": "pointed"}, {"corners": "turn"}])
def test_the_sides_of_a_wide_shape_are_painted_with_any_end_style(tmp_path, plain):
    """The sides of a wide shape are painted with any kind of end.

    Only two thirds of a bar 12 mm wide were painted once an end was set.
    """
    shape, mark, _ = painted(tmp_path, "M5 20H55V32H5Z", **plain)
    assert shape.intersection(mark).area / shape.union(mark).area > 0.93


def letters(tmp_path, places, d=CORNERS["an R with a waist"], more=""):
    """Return the preparation of a text that repeats a letter at places [mm], rounded as drawing programs do."""
    paths = "".join(
        f'<path id="l{k}" fill="#00000{k}" transform="translate({x:.3f} {y:.3f}) scale(0.4)" d="{d}"/>'
        for k, (x, y) in enumerate(places)
    )
    file = tmp_path / "text.svg"
    file.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" viewBox="0 0 200 100">'
        f"{paths}{more}</svg>"
    )
    return prepare(file, Options(brush=find_brush("round-6")))


def test_a_letter_that_repeats_is_painted_alike_everywhere(tmp_path, monkeypatch):
    places = [(7.1, 3.3), (31.4157, 3.3), (60.0003, 41.77), (150.9, 60.2)]
    alone = [letters(tmp_path, [place]) for place in places]
    calls = []
    monkeypatch.setattr(skeleton, "outline_strokes", lambda *given: calls.append(given) or outline_strokes(*given))
    # The last one is slightly larger, so it has strokes of its own.
    larger = f'<path id="larger" transform="translate(100 3) scale(0.4003)" d="{CORNERS["an R with a waist"]}"/>'
    work = letters(tmp_path, places, more=larger)
    assert len(calls) == 2
    passes = {k: [each for each in work.plan.passes if str(each.stroke).startswith(f"l{k}")] for k in range(4)}
    for k, (place, by_itself) in enumerate(zip(places, alone, strict=True)):
        by_mm = np.subtract(place, places[0]) * (1, -1)
        assert len(passes[k]) == len(passes[0]) == len(by_itself.plan.passes)
        for own, first in zip(passes[k], passes[0], strict=True):
            assert own.poses_mm == pytest.approx(first.poses_mm + np.append(by_mm, 0), abs=2e-3)
            assert own.colour == f"#00000{k}"
            assert str(own.stroke) == str(first.stroke).replace("l0", f"l{k}")


def test_a_letter_that_repeats_keeps_its_own_settings(tmp_path):
    """Strokes that the search replaced had the speed, order, passes and reload of the first equal letter."""
    shape = CORNERS["a Z"]
    first = f'<path id="first" data-brushsvg-speed="5" data-brushsvg-reload="yes" d="{shape}"/>'
    again = f'<path id="again" data-brushsvg-speed="12" data-brushsvg-order="1" d="{shape}" transform="translate(60)"/>'
    passes = letters(tmp_path, [], more=first + again).plan.passes
    for name, speed_mm_s, order, reload in (("first", 5, None, True), ("again", 12, 1, None)):
        own = [each for each in passes if str(each.stroke).startswith(name)]
        assert {each.speed_mm_s for each in own} == {speed_mm_s}
        assert {(each.settings.order, each.settings.reload) for each in own} == {(order, reload)}


def test_equal_strokes_are_compensated_once_and_keep_their_names_and_places():
    brush = find_brush("round-6")
    first = _core.Stroke.from_points([(20, 20), (50, 20), (50, 45)], 4.0, "first")
    by_mm = np.array([33.3, -7.7])
    again = _core.Stroke.from_points(np.array([(20, 20), (50, 20), (50, 45)]) + by_mm, 4.0, "again")
    again = again.replaced(colour="#ff0000", layer="top", settings=_core.Settings(order=3))
    wider = _core.Stroke.from_points([(20, 20), (50, 20), (50, 45)], 6.0, "wider")
    done = _core.compensate([first, again, wider], brush, None)
    (one, two, three), (error, moved_error, _) = done.plan.passes, done.tracking_errors
    assert two.poses_mm == pytest.approx(one.poses_mm + np.append(by_mm, 0), abs=1e-9)
    assert moved_error.at_mm == pytest.approx(error.at_mm + by_mm, abs=1e-9)
    assert moved_error.largest_mm == error.largest_mm
    assert (str(two.stroke), two.colour, two.layer, two.settings.order) == ("again", "#ff0000", "top", 3)
    assert three.poses_mm[:, 2].min() < one.poses_mm[:, 2].min() - 0.5
    assert two.poses_mm == pytest.approx(_core.compensate([again], brush, None).plan.passes[0].poses_mm, abs=1e-6)


@pytest.mark.parametrize(
    ("place_mm", "width_mm"), [((2e6, 20), 2.0), ((20, 50), float("nan")), ((20, 50), -2.0)], ids=str
)
def test_an_invalid_copy_of_a_stroke_is_refused(place_mm, width_mm):
    line = np.array([(0, 0), (10, 0)] * 2).ravel() * 1.0
    strokes = [
        _core.Stroke(id=name, middle_mm=[line + np.tile(place, 4)], half_width=[(0.0, width)])
        for name, place, width in (("first", (20, 20), 2.0), ("copy", place_mm, width_mm))
    ]
    with pytest.raises(Error) as refusal:
        _core.compensate(strokes, find_brush("round-6"), None)
    assert refusal.value.where == "copy"


def test_a_refined_stroke_near_the_edge_of_the_sheet_differs_from_one_in_the_middle():
    brush = find_brush("round-6")
    points = np.array([(3.2, 5.0), (3.2, 30.0)])
    strokes = [
        _core.Stroke.from_points(points + np.array([x, 0]), 5.5, name) for x, name in ((0, "edge"), (50, "middle"))
    ]
    both = _core.compensate(strokes, brush, (100, 60), "refined").plan.passes
    for stroke, a_pass in zip(strokes, both, strict=True):
        assert np.array_equal(
            _core.compensate([stroke], brush, (100, 60), "refined").plan.passes[0].poses_mm, a_pass.poses_mm
        )
