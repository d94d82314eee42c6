"""In pictures, the paint is where the marks are, in its colour, with y up."""

import re
import xml.etree.ElementTree as ET

import cv2
import numpy as np
import pytest
from diagnostics import refused

from brushsvg import (
    Pass,
    Plan,
    Stroke,
    area,
    compensate,
    coverage,
    find_brush,
    marks_png,
    marks_svg,
    simulate,
    trace_outlines,
)
from brushsvg.show.overlap_png import overlap_png
from brushsvg.show.overlap_svg import overlap_svg
from brushsvg.show.panels_png import Panel, panels_png
from brushsvg.show.picture_colours import TOOLPATH

SHEET = (60.0, 30.0)
RED, BLUE = "#c01020", "#1020c0"
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def painted():
    """Return marks of three lines.

    A red line is low on the left, a blue line high on the right, and a red line crosses the blue one.
    """
    brush = find_brush("round-6")
    lines = [((8, 6), (24, 6), RED), ((30, 24), (50, 24), BLUE), ((40, 10), (40, 25), RED)]
    strokes = [
        Stroke(f'<s"{k}', np.array([[*a, *a, *b, *b]], float), half_width=[(0, 1.5), (1, 1.5)], colour=colour)
        for k, (a, b, colour) in enumerate(lines)
    ]
    marks = simulate(compensate(strokes, brush, SHEET).plan, brush)
    trace_outlines(marks, brush)
    return marks, brush, [colour for _, _, colour in lines]


def pixel(image, x_mm, y_mm):
    scale = image.shape[1] / SHEET[0]
    blue, green, red = image[int(image.shape[0] - y_mm * scale), int(x_mm * scale)]
    return f"#{red:02x}{green:02x}{blue:02x}"


def decode(data):
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)


def test_png_shows_colours_at_their_places_and_in_order(painted):
    marks, brush, colours = painted
    image = decode(marks_png(marks, brush, SHEET, colours))
    assert image.shape[:2] == (600, 1200)
    assert pixel(image, 16, 6) == RED
    assert pixel(image, 33, 24) == BLUE
    assert pixel(image, 40, 24) == RED, "the later stroke is on top"
    assert pixel(image, 16, 24) == "#ffffff"
    edge = image[(image != 255).any(axis=2) & (image != decode_colour(RED)).any(axis=2)]
    assert len(np.unique(edge, axis=0)) > 20, "edges are anti-aliased"


def decode_colour(colour):
    return [int(colour[5:7], 16), int(colour[3:5], 16), int(colour[1:3], 16)]


@pytest.mark.parametrize("at", [(0, 0), (6, 4), (20, 12), (34, 20), (46, 2)])
def test_part_of_a_picture_equals_the_whole_picture_there(painted, at):
    marks, brush, _ = painted
    (x, y), (width, height), px = at, (14, 10), 8
    whole = coverage(marks, brush, (0, 0, *SHEET), px)
    bottom = whole.shape[0] - y * px
    shown = whole[bottom - height * px : bottom, x * px : (x + width) * px]
    np.testing.assert_allclose(coverage(marks, brush, (x, y, width, height), px), shown, atol=1e-5)


def test_svg_contains_the_same_paint_with_y_inverted(painted):
    marks, _, colours = painted
    root = ET.fromstring(marks_svg(marks, SHEET, colours, "A & B"))
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("60mm", "30mm", "0 0 60 30")
    assert root.find(f"{SVG}title").text == "A & B"
    paths = root.findall(f"{SVG}path")
    assert [path.get("fill") for path in paths] == colours
    assert [path.get("data-stroke") for path in paths] == ['<s"0', '<s"1', '<s"2']
    for path, trace in zip(paths, marks.passes, strict=True):
        rings = [
            np.array([pair.split(",") for pair in ring.strip("MZ").split("L")], float)
            for ring in re.findall(r"M[^Z]*Z", path.get("d"))
        ]
        back = [np.column_stack([ring[:, 0], SHEET[1] - ring[:, 1]]) for ring in rings]
        assert area(back) == pytest.approx(area(trace.outline_mm), rel=1e-3)


@pytest.mark.parametrize(
    ("colours", "drawn"),
    [
        (["", "none", '"/><script/>'], ["#000000"] * 3),
        (["red", "#00f", "rgb(0, 128, 0)"], ["#ff0000", "#0000ff", "#008000"]),
    ],
)
def test_colours_are_those_of_css_and_an_invalid_one_is_drawn_black(painted, colours, drawn):
    marks, brush, _ = painted
    assert pixel(decode(marks_png(marks, brush, SHEET, colours)), 16, 6) == drawn[0]
    paths = ET.fromstring(marks_svg(marks, SHEET, colours)).findall(f"{SVG}path")
    assert [path.get("fill") for path in paths] == drawn


def test_the_toolpath_is_drawn_over_the_paint(painted):
    marks, brush, colours = painted
    toolpath_mm = [
        np.array([(5.0, 3.0, 2.0), (25.0, 3.0, -4.0)]),
        np.array([(25.0, 18.0, 2.0), (45.0, 18.0, 0.0)]),
    ]
    root = ET.fromstring(marks_svg(marks, SHEET, colours, toolpath_mm=toolpath_mm))
    paths = {path.get("class"): path.get("d") for path in root.findall(f"{SVG}path")}
    assert paths["toolpath"] == "M5.000 27.000L25.000 27.000M25.000 12.000L45.000 12.000"
    assert paths["travel"] == "M25.000 27.000L25.000 12.000"
    image = decode(marks_png(marks, brush, SHEET, colours, toolpath_mm=toolpath_mm))
    assert pixel(image, 10, 3) == pixel(image, 40, 18) == TOOLPATH


def test_lines_may_be_nested_lists(painted):
    marks, brush, colours = painted
    lists = {"blank": [[[5, 5], [9, 5], [9, 9]]], "toolpath_mm": [[[5, 3, 2], [25, 3, -4]], [], [[25, 18], [45, 18]]]}
    arrays = {name: [np.array(line, float) for line in lines if line] for name, lines in lists.items()}
    assert marks_svg(marks, SHEET, colours, **lists) == marks_svg(marks, np.array(SHEET), tuple(colours), **arrays)
    assert marks_png(marks, brush, SHEET, colours, **lists) == marks_png(marks, brush, SHEET, colours, **arrays)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({"band": 3}, "wrong-type 3 band"),
        ({"blank": 3}, "wrong-type blank"),
        ({"blank": [[[5, 5], [9]]]}, "wrong-type blank"),
        ({"blank": [[[[5, 5], [9, 9]]]]}, "wrong-type blank"),
        ({"blank": [[["x", 5]]]}, "wrong-type blank"),
        ({"blank": [[[5, np.nan], [9, 9]]]}, "not-finite blank"),
        ({"blank": [[[5, 10**400], [9, 9]]]}, "wrong-type blank"),
        ({"toolpath_mm": [[5, 5], [9, 9]]}, "wrong-type toolpath_mm"),
        ({"toolpath_mm": [None]}, "wrong-type toolpath_mm"),
        ({"colours": "rgb"}, "wrong-type rgb"),
        ({"colours": [RED, BLUE, 3]}, "wrong-type 3"),
        ({"colours": None}, "wrong-type None"),
        ({"sheet_mm": (60, True)}, "wrong-type True"),
        ({"sheet_mm": (60, 10**400)}, "out-of-range inf"),
        ({"sheet_mm": (60, 0)}, "out-of-range 0 1e6"),
    ],
)
def test_what_cannot_be_drawn_is_refused(painted, changed, expected):
    marks, brush, colours = painted
    given = {"sheet_mm": SHEET, "colours": colours} | changed
    with refused(expected):
        marks_svg(marks, **given)
    with refused(expected):
        marks_png(marks, brush, **given)


def test_marks_without_outlines_are_refused_as_svg():
    brush = find_brush("round-6")
    painting, touching = (Pass("a", [(10, 10, -depth), (30, 10, -depth)]) for depth in (2.0, 0.0))
    marks = simulate(Plan("round-6", "", SHEET, [painting]), brush)
    with refused("nothing-to-show trace_outlines"):
        marks_svg(marks, SHEET, [RED])
    assert marks_png(marks, brush, SHEET, [RED])
    trace_outlines(marks, brush)
    assert RED in marks_svg(marks, SHEET, [RED])
    assert marks_svg(simulate(Plan("round-6", "", SHEET, [touching]), brush), SHEET, [RED])


def test_svg_numbers_are_plain_decimals(painted):
    marks, _, colours = painted
    marks.passes[0].outline_mm = []
    text = marks_svg(marks, SHEET, colours)
    assert not re.search(r"\de|nan|inf|-0\.000", text)


@pytest.mark.parametrize(("shape", "landscape"), [((90, 30), True), ((40, 40), True)])
def test_panels_are_complete_and_share_one_scale(shape, landscape):
    width, height = shape
    ring = np.array([(5, 5), (5 + width, 5), (5 + width, 5 + height), (5, 5 + height)], float)
    line = ring[[0, 2]]
    panels = [
        Panel(f"panel {k}", ("0.5", "overlap"), ("some", "words"), [ring], [ring] if k else [], [line])
        for k in range(3)
    ]
    image = decode(panels_png(panels, "Heading", "note"))
    assert image.shape[1] == 2000
    assert (image.shape[1] > image.shape[0]) == landscape
    grey = (np.abs(image.astype(int) - 180).max(axis=2) < 8).sum()
    ink = ((image[..., 0] > 90) & (image[..., 2] < 80)).sum()
    assert ink == pytest.approx(2 * grey, rel=0.1), "one panel of the target, two painted over it"


def test_parallel_painting_equals_painting_each_stroke_alone():
    """Several processors paint a page as each stroke is painted alone.

    Where strokes cross, their order does not change the picture. Where no strokes cross, the picture is the
    maximum of their pictures.
    """
    brush, rng = find_brush("round-6"), np.random.default_rng(2)
    sheet, count = (400.0, 300.0), 96
    apart = [((10 + 30 * (k % 12), 15 + 34 * (k // 12)), rng.uniform(-9, 9, 2)) for k in range(count)]
    crossing = [(rng.uniform(40, 260, 2), rng.uniform(-90, 90, 2)) for _ in range(count)]

    def marks_of(lines):
        strokes = [
            Stroke(f"s{k}", np.array([[*a, *a, *(a + way), *(a + way)]], float), half_width=[(0, 1), (1, 1.5)])
            for k, (a, way) in enumerate(lines)
        ]
        return simulate(compensate(strokes, brush, sheet).plan, brush)

    def picture(marks, passes):
        some = type(marks)()
        some.passes = passes
        return coverage(some, brush, (0, 0, *sheet), 4)

    marks = marks_of(apart)
    alone = np.max([picture(marks, [each]) for each in marks.passes], axis=0)
    assert np.abs(picture(marks, marks.passes) - alone).max() < 1e-5  # the row sums have single precision
    marks = marks_of(crossing)
    assert (picture(marks, marks.passes) == picture(marks, marks.passes[::-1])).all()


PLACES = {1: (16.0, 4.4), 2: (59.5, 29.5)}


def test_place_numbers_stay_inside_the_picture_and_off_the_paint(painted):
    """The numbers of places stay inside the picture and off the paint.

    The second place is in a corner of the sheet.
    """
    marks, brush, _ = painted
    scale = 20.0
    paint = coverage(marks, brush, (0, 0, *SHEET), scale)
    at_px = {number: (x * scale, (SHEET[1] - y) * scale) for number, (x, y) in PLACES.items()}
    plain, numbered = (decode(overlap_png(paint, paint, places=places)) for places in ({}, at_px))
    assert plain.shape == numbered.shape
    changed = (plain != numbered).any(axis=2)[: len(paint)]
    far = np.ones_like(changed)
    for x, y in at_px.values():
        cv2.circle(far.view(np.uint8), (round(x), round(y)), 16, 0, -1)
    assert changed[far].sum() > 100 and not (changed & far & (paint > 0.05)).any()
    tree = ET.fromstring(overlap_svg(marks.outline_mm, marks.outline_mm, SHEET, places=PLACES))
    rings = [(float(each.get("cx")), float(each.get("cy"))) for each in tree.iter(f"{SVG}circle")]
    assert rings == [(x, SHEET[1] - y) for x, y in PLACES.values()]
    texts = [each for each in tree.iter(f"{SVG}text") if each.text in ("1", "2")]
    assert len(texts) == 2
    for text in texts:
        x, y, size = (float(text.get(key)) for key in ("x", "y", "font-size"))
        assert 0 <= x <= SHEET[0] - 0.65 * size and size <= y + 0.2 * size and y <= SHEET[1]


def test_the_legend_of_misplaced_paint_fits_a_narrow_picture():
    """The last entry, of surplus paint, was once cut off on a narrow sheet."""
    plain, with_legend = (decode(overlap_png(np.zeros((2400, 240)), np.zeros((2400, 240)), shown)) for shown in (0, 1))
    assert plain.shape[1] == 240 and len(with_legend) > 2400
    assert (with_legend[2400:] != 255).any(axis=(0, 2)).nonzero()[0].max() < with_legend.shape[1] - 20
    tree = ET.fromstring(overlap_svg([], [], (30.0, 300.0)))
    texts = list(tree.iter(f"{SVG}text"))
    assert len(texts) == 3
    for text in texts:
        assert float(text.get("x")) + 0.55 * float(text.get("font-size")) * len(text.text) <= float(
            tree.get("viewBox").split()[2]
        )
