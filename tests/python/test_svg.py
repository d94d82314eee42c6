import gzip
import math
import random
import re
import subprocess
import sys
import tracemalloc

import numpy as np
import pytest
import svgpathtools
import tinycss2
from diagnostics import agrees, refused

from brushsvg.read import ReadOptions, read_drawing
from brushsvg.read.svg import read_svg
from brushsvg.read.svg.colour import parse_colour
from brushsvg.read.svg.css.declarations import declarations
from brushsvg.read.svg.paths.path_data import parse_path
from brushsvg.read.svg.paths.path_to_cubics import trace
from brushsvg.read.svg.transform import IDENTITY, multiply, parse_transform

NAMESPACES = (
    'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
    'xmlns:xlink="http://www.w3.org/1999/xlink"'
)
PAGE = 'width="100mm" height="50mm" viewBox="0 0 100 50" stroke="red" fill="none"'


def read(body, page=PAGE, **options):
    return read_svg(f"<svg {NAMESPACES} {page}>{body}</svg>".encode(), ReadOptions(**options))


def only(body, page=PAGE):
    """Return the single element of a drawing that has no notices."""
    design = read(body, page)
    assert design.notices == ()
    (element,) = design.elements
    return element


def ends(element):
    """Return the joints of the first sub-path, in SVG's frame on the 50 mm high page."""
    cubics = element.subpaths[0].cubics
    points = np.vstack((cubics[:, 0], cubics[-1:, 3]))
    return (points * (1, -1) + (0, 50)).round(9).tolist()


def points_along(cubics, count=64):
    t = np.linspace(0, 1, count)[:, None, None]
    a, b, c, d = (cubics[:, k] for k in range(4))
    return ((1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d).reshape(-1, 2)


def in_user_units(d, matrix=IDENTITY, scale=1.0):
    commands, error = parse_path(d)
    assert error is None
    return trace(commands, matrix, scale)


# The path grammar and its curves are compared with svgpathtools.


def random_path(rng):
    """Return valid path data in the styles of drawing programs.

    Arcs have a test of their own.
    """

    def number():
        value = rng.choice((rng.uniform(-90, 90), rng.uniform(-1, 1), float(rng.randint(-9, 9))))
        text = rng.choice((f"{value:.3f}", f"{value:.6g}", f"{value:.2e}", f"{value:.0f}", f"{value:+.4f}"))
        if rng.random() < 0.4:
            text = text.replace("0.", ".", 1) if text.lstrip("+-").startswith("0.") else text
        return text

    counts = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "Z": 0}
    text = ""
    for kind in ["M", *rng.choices("LLHVCCSSQQTTZM", k=8)]:
        text += rng.choice((kind, kind.lower()))
        before = ""
        for _ in range(counts[kind] * rng.randint(1, 3)):
            token = number()
            may_touch = token[0] in "+-" or (token[0] == "." and "." in before and "e" not in before)
            text += (rng.choice(("", " ")) if may_touch or not before else rng.choice((" ", ",", " , "))) + token
            before = token
        text += rng.choice(("", " ", "\n"))
    return text


def test_paths_agree_with_svgpathtools():
    rng = random.Random(7)
    compared = 0
    for _ in range(60):
        d = random_path(rng)
        ours = np.concatenate([line.cubics for line in in_user_units(d).subpaths])
        theirs = []
        for segment in svgpathtools.parse_path(d):
            theirs.append([segment.point(t) for t in (0, 0.3, 0.8, 1)])
        t = np.array([0, 0.3, 0.8, 1])[None, :, None]
        a, b, c, e = (ours[:, k, None] for k in range(4))
        points = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * e
        points = points[..., 0] + 1j * points[..., 1]
        theirs = np.array(theirs)
        theirs = theirs[np.abs(theirs - theirs[:, :1]).max(axis=1) > 1e-6]
        points = points[np.abs(points - points[:, :1]).max(axis=1) > 1e-6]
        lines = [k for k in range(len(theirs)) if abs(theirs[k, 1] - (0.7 * theirs[k, 0] + 0.3 * theirs[k, 3])) < 1e-9]
        assert points.shape == theirs.shape, d
        assert np.abs(points - theirs).max() < 1e-9, d
        compared += len(theirs) - len(lines)
    assert compared > 300


def test_subpaths_are_continuous_and_start_where_the_last_one_closed():
    line = in_user_units("M1 1h4v4zl-2 3M9 9t1 1")
    assert [subpath.closed for subpath in line.subpaths] == [True, False, False]
    for subpath in line.subpaths:
        assert np.array_equal(subpath.cubics[1:, 0], subpath.cubics[:-1, 3])
    assert line.subpaths[0].cubics[-1, 3].tolist() == [1, 1]
    assert line.subpaths[1].cubics[0, [0, 3]].tolist() == [[1, 1], [-1, 4]]


def test_closing_adds_a_line_only_where_there_is_a_gap():
    assert len(in_user_units("M0 0H4V4L0 0Z").subpaths[0].cubics) == 3
    assert len(in_user_units("M0 0H4V4Z").subpaths[0].cubics) == 3
    snapped = in_user_units("M0 0H4V4L0.00005 0Z").subpaths[0].cubics
    assert len(snapped) == 3
    assert len(in_user_units("M0 0H4V4ZzZ").subpaths) == 1
    assert snapped[-1, 3].tolist() == [0, 0]


def test_segments_without_length_are_dropped():
    cubics = in_user_units("M0 0l0 0 4 0 0 0c0 0 0 0 0 0l0 1e-8 0 4").subpaths[0].cubics
    assert len(cubics) == 2
    assert np.array_equal(cubics[1, 0], cubics[0, 3])
    assert cubics[1, 3].tolist() == [4, 4.00000001]
    closed = in_user_units("M0 0h1e-7l4 0v4L1e-7 1e-7L0 0Z").subpaths[0].cubics
    assert np.array_equal(closed[0, 0], closed[-1, 3])


@pytest.mark.parametrize("seed", range(12))
def test_arcs_stay_within_the_tolerance_after_the_transform(seed):
    rng = random.Random(seed)
    start, end = (complex(rng.uniform(-40, 40), rng.uniform(-40, 40)) for _ in range(2))
    rx, ry, turn = rng.uniform(1, 60), rng.uniform(1, 60), rng.uniform(-200, 200)
    large, sweep = rng.randint(0, 1), rng.randint(0, 1)
    text = f"M{start.real},{start.imag}A{rx},{ry} {turn} {large}{sweep}{end.real},{end.imag}"
    oracle = svgpathtools.Arc(start, complex(rx, ry), turn, bool(large), bool(sweep), end)
    matrix = parse_transform("matrix(1.2 .4 -.7 .9 30 40) skewX(20)")
    a, b, c, d, e, f = matrix
    mapped = np.array([[a, b], [c, d]]), np.array([e, f])
    cubics = in_user_units(text, matrix, np.linalg.norm(mapped[0], 2)).subpaths[0].cubics

    joints = [oracle.point(k / len(cubics)) for k in range(len(cubics) + 1)]
    joints = np.array([[p.real, p.imag] for p in joints]) @ mapped[0] + mapped[1]
    assert np.abs(np.vstack((cubics[:, 0], cubics[-1:, 3])) - joints).max() < 1e-8
    # Map the points to where the ellipse is the unit circle, and find their largest distance from it on
    # paper.
    points = (points_along(cubics) - mapped[1]) @ np.linalg.inv(mapped[0]) @ (1, 1j) - oracle.center
    points *= np.exp(-1j * math.radians(turn))
    off_unit = np.abs(np.hypot(points.real / oracle.radius.real, points.imag / oracle.radius.imag) - 1).max()
    largest = np.linalg.norm(mapped[0], 2) * max(oracle.radius.real, oracle.radius.imag)
    assert off_unit * largest < 1e-4
    assert off_unit > 1e-9  # cubics are not exact circles, so the measure must be above zero


@pytest.mark.parametrize(("radius", "cubics"), [(0.3, 4), (23.0, 8), (24.0, 10), (4e5, 42)])
def test_arcs_cost_no_more_cubics_than_needed(radius, cubics):
    line = in_user_units(f"M{radius} 0A{radius} {radius} 0 1 1 {-radius} 0A{radius} {radius} 0 0 1 {radius} 0z")
    found = line.subpaths[0].cubics
    assert len(found) == cubics
    assert np.abs(np.linalg.norm(points_along(found), axis=1) - radius).max() < 1e-4


def test_arcs_at_the_edge_of_their_definition():
    too_small = in_user_units("M0 0A1 1 0 0 1 10 0").subpaths[0].cubics  # its radii grow to a half circle
    assert np.abs(np.linalg.norm(points_along(too_small) - (5, 0), axis=1) - 5).max() < 1e-4
    assert points_along(too_small)[:, 1].min() == pytest.approx(-5, abs=1e-3)
    nearly_whole = in_user_units("M0 0a5 5 0 1 1 1e-7 0").subpaths[0].cubics
    assert len(nearly_whole) > 4
    assert np.abs(np.linalg.norm(points_along(nearly_whole) - (0, -5), axis=1) - 5).max() < 1e-4
    assert in_user_units("M0 0A0 5 0 0 1 10 0").subpaths[0].cubics[:, 1].tolist() == [[10 / 3, 0]]
    assert in_user_units("M0 0A-5-5 0 0 1 10 0").subpaths[0].cubics[-1, 3].tolist() == [10, 0]
    assert len(in_user_units("M0 0A5 5 0 1 1 0 0L9 9").subpaths[0].cubics) == 1


# Damaged path data is read up to the error, and the error is named.


@pytest.mark.parametrize(
    ("d", "cubics", "character", "found"),
    [
        ("M0 0L1 1 nan 3", 1, 10, "nan 3"),
        ("M0 0L1 1Lnan 3", 1, 10, "nan 3"),
        ("M0 0L1 1L inf 3", 1, 11, "inf 3"),
        ("M0 0L1 1L 2", 1, 12, "the end"),
        ("M0 0L1 1L 2 V 3", 1, 13, "V 3"),
        ("M0 0L1 1,", 1, 9, ","),
        ("M0 0L1 1,,2 2", 1, 9, ",,2 2"),
        ("M0 0L1 1C1 2 3 4 5 x", 1, 20, "x"),
        ("M0 0L1 1 2 2 3", 2, 15, "the end"),
        ("M0 0L1 1A5 5 0 2 0 9 9", 1, 16, "2 0 9 9"),
        ("M0 0L1 1A5 5 0 0 9 9", 1, 18, "9 9"),
        ("M0 0L1 1 # M5 5L6 6", 1, 10, "# M5 5L6 6"),
        ("M0 0L1 1L1e 5", 1, 11, "e 5"),
        ("M0 0L1 1L\u0661 5", 1, 10, "\u0661 5"),
        ("M0 0L1 1L1e999 5", 1, 9, "L1e999 5"),
        ("M0 0L1 1C1 1 1e30 5 6 7", 1, 9, "C1 1 1e30 5 6 7"),
        ("M0 0L1 1 2 2 3 -1e7 M5 5H6", 2, 14, "3 -1e7 M5 5H6"),
        ("M0 0L1 1A1e300 5 0 0 1 9 9", 1, 9, "A1e300 5 0 0 1 9..."),
        ("M0 0L1 1A5 5 1e999 0 1 9 9", 1, 9, "A5 5 1e999 0 1 9..."),
        ("M0 0L1 1a5 5 0 0 1 9 1e999a5 5 0 0 1 9 -1e999a5 5 0 0 1 1 1", 1, 9, "a5 5 0 0 1 9 1e9..."),
    ],
)
def test_damaged_paths_are_read_up_to_the_error(d, cubics, character, found):
    design = read(f'<path id="bad" d="{d}"/>')
    (notice,) = design.notices
    assert notice.damaged
    assert notice.where == "bad"
    code = "geometry-out-of-range" if re.search("1e[379]", d) else "geometry-damaged"
    assert agrees(notice, f"{code} {character}", "bad")
    assert notice.sentence.split("found ")[1].startswith(found if found == "the end" else repr(found))
    (subpath,) = design.elements[0].subpaths
    assert len(subpath.cubics) == cubics
    assert np.abs(subpath.cubics).max() < 1e3


@pytest.mark.parametrize("d", ["L1 1", "nan", "1 1", ",M1 1L2 2", "M", "M5", "M1e9 1L2 2", "\u017f1 1"])
def test_a_path_damaged_from_the_start_is_left_out(d):
    design = read(f'<path id="bad" d="{d}"/><path d="M0 0H1"/>')
    assert [(notice.where, notice.damaged) for notice in design.notices] == [("bad", True)]
    assert len(design.elements) == 1


def test_coordinate_limits_apply_on_paper():
    scaled = '<g transform="scale(1e-6)"><path stroke-width="1e6" d="M1e6 0H9e6"/></g>'
    assert ends(only(scaled)) == [[1, 0], [9, 0]]
    design = read('<path id="ok" d="M0 0H5"/><path id="far" d="M0 0H5" transform="translate(1e6 0)"/>')
    assert [(notice.where, notice.damaged) for notice in design.notices] == [("far", True)]


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        ('<circle id="bad" r="nan"/>', "geometry-damaged r nan"),
        ('<circle id="bad" r="-1"/>', "geometry-damaged r -1"),
        ('<circle id="bad" r="1e300"/>', "geometry-out-of-range 1e6"),
        ('<rect id="bad" width="1e999" height="5"/>', "geometry-damaged width 1e999"),
        ('<ellipse id="bad" rx="2vw" ry="5"/>', "geometry-damaged rx 2vw"),
        ('<line id="bad" x2="5,"/>', "geometry-damaged x2 5,"),
        ('<polyline id="bad" points="1,1 2,2 3"/>', "geometry-damaged points 10"),
        ('<polygon id="bad" points="1,1 2,2 L 3"/>', "geometry-damaged points 9 'L 3'"),
        ('<polyline id="bad" points="x"/>', "geometry-damaged 1 'x'"),
        ('<polyline id="bad" points="1,1 2,2 1e9,0"/>', "geometry-out-of-range 9 '1e9,0'"),
        ('<path id="bad" d="M0 0H5" transform="rotate(nan)"/>', "transform-unread 1"),
        ('<path id="bad" d="M0 0H5" transform="scale(2) rotate(1 2)"/>', "transform-unread 10 'rotate(1 2)'"),
        ('<path id="bad" d="M0 0H5" transform="scale(1e999)"/>', "transform-unread 1"),
        ('<g id="bad" transform="scale(1e200)"><g transform="scale(1e200)"/></g>', None),
        ('<svg id="bad" viewBox="0 0 9 1e308"><svg><path d="M0 0H5"/></svg></svg>', None),
        ('<svg id="bad" width="1e300"><path d="M0 0H5"/></svg>', "geometry-out-of-range bad 1e6"),
        ('<path id="bad" d="M0 0H5" stroke-width="-1"/>', "stroke-width-invalid -1"),
        ('<path id="bad" d="M0 0H5" stroke-width="1e9"/>', "geometry-out-of-range 1e+09 1e6"),
        (
            '<g id="bad" style="stroke-width:nan"><path d="M0 0H5"/></g>',
            "stroke-width-invalid 'nan'",
        ),
    ],
)
def test_damaged_shapes_transforms_and_widths_are_named(shape, expected):
    design = read(shape + '<path id="sound" d="M0 0H1"/>')
    damaged = [notice for notice in design.notices if notice.damaged]
    assert len(damaged) == 1
    if expected:
        assert damaged[0].where == "bad" and agrees(damaged[0], expected), damaged
    assert design.elements[-1].id == "sound"


# Shapes, transforms and the page.


def corners(body):
    """Return the joints of a shape, without the joints inside its arcs.

    A joint inside an arc is between two cubics of equal direction.
    """
    cubics = only(body).subpaths[0].cubics
    into, out = cubics[:-1, 3] - cubics[:-1, 2], cubics[1:, 1] - cubics[1:, 0]
    alike = np.abs(into - out).max(axis=1) < 1e-9
    points = np.vstack((cubics[:1, 0], cubics[1:, 0][~alike], cubics[-1:, 3]))
    return (points * (1, -1) + (0, 50)).round(9).tolist()


def test_shapes_have_the_start_and_direction_of_the_svg_standard():
    box = [[1, 2], [11, 2], [11, 7], [1, 7], [1, 2]]
    assert ends(only('<rect x="1" y="2" width="10" height="5"/>')) == box
    rounded = corners('<rect x="1" y="2" width="10" height="5" rx="2" ry="1"/>')
    assert rounded == [[3, 2], [9, 2], [11, 3], [11, 6], [9, 7], [3, 7], [1, 6], [1, 3], [3, 2]]
    circle = [[23, 10], [20, 13], [17, 10], [20, 7], [23, 10]]
    assert ends(only('<circle cx="20" cy="10" r="3"/>'))[::2] == circle
    ellipse = [[23, 10], [20, 11], [17, 10], [20, 9], [23, 10]]
    assert ends(only('<ellipse cx="20" cy="10" rx="3" ry="1"/>'))[::2] == ellipse
    assert ends(only('<line x1="1" y1="2" x2="3"/>')) == [[1, 2], [3, 0]]
    assert ends(only('<polyline points="1,2 3-4,5,6"/>')) == [[1, 2], [3, -4], [5, 6]]
    assert ends(only('<polygon points="1,2 3,4 5,6"/>')) == [[1, 2], [3, 4], [5, 6], [1, 2]]
    shapes = ('circle r="3"', 'line x2="3"', 'rect width="1" height="1"')
    assert [only(f"<{shape}/>").subpaths[0].closed for shape in shapes] == [True, False, True]


def test_corner_radii_are_clamped_and_a_missing_one_equals_the_other():
    clamped = only('<rect width="10" height="4" rx="9" ry="9"/>').subpaths[0].cubics * (1, -1) + (0, 50)
    assert np.abs(np.hypot(*((points_along(clamped) - (5, 2)) / (5, 2)).T) - 1).max() < 1e-4
    assert clamped[0, 0].tolist() == [5, 0]
    assert corners('<rect width="10" height="4" rx="1"/>')[:3] == [[1, 0], [9, 0], [10, 1]]
    assert corners('<rect width="10" height="4" ry="3"/>')[:2] == [[3, 0], [7, 0]]
    assert corners('<rect width="10" height="4" ry="0"/>')[:2] == [[0, 0], [10, 0]]


def test_lengths_in_shapes_accept_units_and_percentages():
    page = 'width="100mm" height="50mm" stroke="red"'
    assert ends(only('<line x1="1in" y1="5mm" x2="50%" y2="100%"/>', page)) == [[25.4, 5], [50, 50]]
    circle = only('<circle cx="50" cy="25" r="10%"/>')
    assert np.ptp(circle.subpaths[0].cubics[:, 0, 0]) / 2 == pytest.approx(0.1 * math.hypot(100, 50) / math.sqrt(2))


@pytest.mark.parametrize(
    ("text", "point"),
    [
        ("translate(3)", (4, 2)),
        ("translate(3,-4)", (4, -2)),
        ("scale(2)", (2, 4)),
        ("scale(2 3)", (2, 6)),
        ("rotate(90)", (-2, 1)),
        ("rotate(90 1 1)", (0, 1)),
        ("skewX(45)", (3, 2)),
        ("skewY(45)", (1, 3)),
        ("matrix(1,2 3-4.5.5.25)", (7.5, -6.75)),
        (" translate ( 1 , 1 ) , scale(2)rotate(180)", (-1, -3)),
        ("none", (1, 2)),
        ("", (1, 2)),
    ],
)
def test_transforms_are_applied(text, point):
    a, b, c, d, e, f = parse_transform(text)
    assert (a + 2 * c + e, b + 2 * d + f) == pytest.approx(point, abs=1e-12)


@pytest.mark.parametrize("text", ["translate(1 2),,rotate(3)", "translate(1 2),", ",translate(1 2)"])
def test_transforms_that_browsers_ignore_are_reported_as_damaged(text):
    with refused("transform-unread character"):
        parse_transform(text)


def test_nested_transforms_apply_from_the_inside_out():
    line = '<a transform="scale(2)"><path d="M1 1H2" transform="rotate(90)"/></a>'
    line = f'<g transform="translate(10 0)">{line}</g>'
    assert ends(only(line)) == [[8, 2], [8, 4]]
    assert multiply(parse_transform("translate(1 0)"), parse_transform("scale(2)")) == (2, 0, 0, 2, 1, 0)


def test_y_points_up_from_the_lower_left_corner():
    cubics = only('<path d="M10 10L20 40"/>').subpaths[0].cubics
    assert cubics[0, [0, 3]].tolist() == [[10, 40], [20, 10]]


@pytest.mark.parametrize(
    ("page", "sheet", "corner"),
    [  # corner: the position of user point (10, 10) on paper
        ('width="100mm" height="50mm" viewBox="0 0 100 50"', (100, 50), (10, 40)),
        ('width="4in" height="2in"', (101.6, 50.8), (10 * 25.4 / 96, 50.8 - 10 * 25.4 / 96)),
        ('width="10cm" height="5cm" viewBox="10 10 1000 500"', (100, 50), (0, 50)),
        ('width="100mm" height="100mm" viewBox="0 0 100 50"', (100, 100), (10, 65)),
        (
            'width="100mm" height="100mm" viewBox="0 0 100 50" preserveAspectRatio="xMinYMin"',
            (100, 100),
            (10, 90),
        ),
        (
            'width="100mm" height="100mm" viewBox="0 0 100 50" preserveAspectRatio="xMaxYMax meet"',
            (100, 100),
            (10, 40),
        ),
        (
            'width="100mm" height="100mm" viewBox="0 0 100 50" preserveAspectRatio="none"',
            (100, 100),
            (10, 80),
        ),
        (
            'width="100mm" height="100mm" viewBox="0 0 100 50" preserveAspectRatio="xMidYMid slice"',
            (100, 100),
            (-30, 80),
        ),
        (
            'width="100mm" height="100mm" viewBox="0 0 100 50" preserveAspectRatio="xMaxYMin slice"',
            (100, 100),
            (-80, 80),
        ),
        (
            'width="360px" height="180" viewBox="0 0 360 180"',
            (95.25, 47.625),
            (10 * 25.4 / 96, 47.625 - 10 * 25.4 / 96),
        ),
    ],
)
def test_viewports_follow_view_box_and_aspect_ratio(page, sheet, corner):
    design = read('<line id="l" x1="10" y1="10" x2="11" y2="12" stroke="red"/>', page)
    assert design.sheet_mm == pytest.approx(sheet)
    assert design.elements[0].subpaths[0].cubics[0, 0] == pytest.approx(corner)


@pytest.mark.parametrize("size", ["", 'width="100%" height="100%"', 'width="auto"'])
def test_without_a_size_the_view_box_is_read_in_px(size):
    design = read('<line x2="96" stroke="red"/>', f'{size} viewBox="0 0 192 96"')
    assert design.sheet_mm == pytest.approx((50.8, 25.4))
    assert design.elements[0].subpaths[0].cubics[0, 3] == pytest.approx((25.4, 25.4))
    (notice,) = design.notices
    assert "96 to the inch" in notice.sentence
    assert "50.8 x 25.4 mm" in notice.sentence


def test_a_missing_width_or_height_follows_from_the_view_box():
    design = read('<line x2="96" stroke="red"/>', 'height="10mm" viewBox="0 0 200 100"')
    assert design.sheet_mm == pytest.approx((20, 10))
    assert len(design.notices) == 1


def test_a_given_sheet_replaces_the_size_and_keeps_scale_and_upper_left_corner():
    design = read('<line x2="10"/>', sheet_mm=(200.0, 80.0))
    assert design.sheet_mm == (200, 80)
    assert design.elements[0].subpaths[0].cubics[0, [0, 3]].tolist() == [[0, 80], [10, 80]]
    assert read('<line stroke="red" x2="10"/>', "", sheet_mm=(200.0, 80.0)).sheet_mm == (200, 80)


@pytest.mark.parametrize(
    ("page", "reported"),
    [
        ("", "size-unknown"),
        ('width="10mm"', "size-unknown"),
        ('viewBox="0 0 10"', "viewbox-invalid"),
        ('viewBox="0 0 nan 5"', "viewbox-invalid"),
        ('viewBox="0 0 0 5"', "viewbox-invalid"),
        ('width="0" height="5"', "out-of-range width 0 '(0, 1000000] mm'"),
        ('width="0" viewBox="0 0 9 9"', "out-of-range width 0"),
        ('width="5" height="-1mm"', "out-of-range height -1"),
        ('width="5" height="1e9mm"', "out-of-range height 1e+09"),
        ('width="5 furlongs" height="5"', "not-a-length width '5 furlongs'"),
    ],
)
def test_invalid_pages_are_refused(page, reported):
    with refused(reported):
        read('<line x2="1" stroke="red"/>', page)


# Style.


@pytest.mark.parametrize(
    ("body", "width"),
    [
        ('<path d="M0 0H5" stroke-width="2"/>', 2),
        ('<path d="M0 0H5" stroke-width="3" style="stroke-width: 2"/>', 2),
        (
            '<path d="M0 0H5" style="font:url(a;b) ; /*stroke-width:9;*/ stroke-width:.2CM !important"/>',
            2 * 96 / 25.4,
        ),
        ('<g stroke-width="2"><g><path d="M0 0H5"/></g></g>', 2),
        ('<g style="stroke-width:5"><path d="M0 0H5" stroke-width="2"/></g>', 2),
        ('<g style="stroke-width:2"><path d="M0 0H5" stroke-width="inherit"/></g>', 2),
        ('<g stroke-width="5"><path d="M0 0H5" stroke-width="initial"/></g>', 1),
        ('<path d="M0 0H5"/>', 1),
        ('<path d="M0 0H5" stroke-width="10%"/>', 0.1 * math.hypot(100, 50) / math.sqrt(2)),
        ('<g transform="scale(2)"><path d="M0 0H5" transform="rotate(30)"/></g>', 2),
        ('<path d="M0 0H5" transform="scale(-1.02 1)"/>', math.sqrt(1.02)),
    ],
)
def test_stroke_widths_are_read(body, width):
    assert only(body).stroke_width_mm == pytest.approx(width, rel=1e-12)


def test_a_width_under_an_uneven_transform_is_averaged_with_a_notice():
    design = read('<path id="p" d="M0 0H5" transform="scale(4 1)"/>')
    assert design.elements[0].stroke_width_mm == pytest.approx(2)
    assert [notice.where for notice in design.notices] == ["p"]
    assert "2 mm" in design.notices[0].sentence


@pytest.mark.parametrize(
    ("text", "colour"),
    [
        ("red", "#ff0000"),
        ("RebeccaPurple", "#663399"),
        ("#1a2", "#11aa22"),
        ("#A1B2C3", "#a1b2c3"),
        ("#a1b2c3ff", "#a1b2c3"),
        ("rgb(255, 0,10)", "#ff000a"),
        ("rgb(100% 0% 50%)", "#ff0080"),
        ("rgba(1,2,3,.5)", "#01020380"),
        ("hsl(120, 100%, 25%)", "#008000"),
        ("none", "none"),
        ("transparent", "#00000000"),
        ("#a1b2c300", "#a1b2c300"),
        ("rgba(1,2,3,0)", "#01020300"),
        ("mauve-ish", None),
        ("#12345", None),
        ("rgb(1,2)", None),
        ("hwb(0 100% 0%)", "#ffffff"),
        ("lab(50% 20 20)", None),
    ],
)
def test_colours_are_read(text, colour):
    assert parse_colour(text) == colour


def test_colours_are_inherited_and_currentcolor_works():
    body = '<g stroke="blue" color="lime"><path d="M0 0H5"/><path d="M0 0H5" stroke="currentColor"/></g>'
    assert [element.colour for element in read(body).elements] == ["#0000ff", "#00ff00"]
    design = read('<path id="p" d="M0 0H5" stroke="#12"/>')
    assert design.elements[0].colour == "#ff0000"
    assert agrees(design.notices[0], "colour-invalid '#12'", "p")
    unclosed = read('<path d="M0 0H5" stroke="url(#a"/>').notices[0]
    assert agrees(unclosed, "colour-invalid 'url(#a'")


@pytest.mark.parametrize(
    "hidden",
    [
        '<path id="x" d="M0 0H9" display="none"/>',
        '<g style="display:none"><path id="x" d="M0 0H9" display="inline"/><text>x</text></g>',
        '<path id="x" d="M0 0H9" visibility="hidden"/>',
        '<g visibility="collapse"><path id="x" d="M0 0H9 nan"/><use/></g>',
        '<defs><path id="x" d="M0 0H9"/></defs>',
        '<symbol><path id="x" d="M0 0H9"/></symbol>',
        '<other xmlns="http://example.org/"><path id="x" d="M0 0H9"/></other>',
        "<title>x</title><desc>x</desc><metadata><a>x</a></metadata>",
    ],
)
def test_hidden_elements_are_left_out_without_notice(hidden):
    assert only(hidden + '<path id="seen" d="M0 0H5"/>').id == "seen"


def test_a_child_can_be_visible_in_a_hidden_group():
    assert only('<g visibility="hidden"><path d="M0 0H5" visibility="visible"/></g>')


def test_layers_are_named_by_their_label():
    body = """<g inkscape:groupmode="layer" inkscape:label=" Ink  1 "><g inkscape:label="no layer">
      <path id="a" d="M0 0H5"/></g><g inkscape:groupmode="layer" id="layer2"><path id="b" d="M0 0H5"/></g></g>
      <path id="c" d="M0 0H5"/>"""
    layers = {element.id: element.layer for element in read(body).elements}
    assert layers == {"a": "Ink 1", "b": "Ink 1/layer2", "c": ""}


def test_document_order_is_kept_across_groups_and_tags():
    body = """<rect id="1" width="1" height="1"/><g><path id="2" d="M0 0H1"/><g><circle id="3" r="1"/></g>
      <path id="4" d="M0 0H1"/></g><line id="5" x2="1"/><path id="6" d="M0 0H1"/>"""
    assert [element.id for element in read(body).elements] == list("123456")


# Anything that is not painted is named.

FIRST = '<path d="M0 0H5"/>'
GRADIENT = '<linearGradient id="g"><stop/><stop stop-color="red"/></linearGradient>'


@pytest.mark.parametrize(
    ("body", "where", "reported"),
    [
        ('<text id="t">x</text>', "t", "text-unread"),
        ('<image id="i"/>', "i", "element-unread image"),
        ("<foreignObject/>", "foreignObject 1", "element-unread foreignObject"),
        ("<g><set/><animate/></g>", "svg", "animations-unread 2"),
        ('<path id="p" d="M0 0H5" stroke="none"/>', "p", "neither-stroke-nor-fill 'neither stroke'"),
        ('<path id="p" d="M0 0H5" stroke-opacity="0"/>', "p", "neither-stroke-nor-fill 'stroke is fully'"),
        ('<path id="p" d="M0 0H5" stroke="transparent"/>', "p", "neither-stroke-nor-fill 'stroke is fully'"),
        ('<path id="p" d="M0 0H5" stroke-width="0"/>', "p", "neither-stroke-nor-fill 'stroke-width is 0'"),
        ('<path id="p" d="M0 0H5" stroke="url(#q)"/>', "p", "neither-stroke-nor-fill #q nowhere"),
        ('<line id="p" x2="5" stroke="none" fill="red"/>', "p", "neither-stroke-nor-fill"),
        ('<path id="p" d="M5 5"/>', "p", "moveto-alone"),
        ('<path id="p" d="M5 5M6 6H7M8 8"/>', "p", "moveto-alone 2"),
        ('<polyline id="p" points="1,1"/>', "p", "moveto-alone a moveto"),
        ('<path id="p"/>', "p", "geometry-empty"),
        ('<circle id="p" r="0"/>', "p", "geometry-empty"),
        ('<rect id="p" width="5"/>', "p", "geometry-empty"),
        ('<path id="p" d="M0 0H5" transform="scale(0 1)"/>', "p", "geometry-empty"),
        ('<g marker-end="url(#a)"><path id="p" d="M0 0H5"/></g>', "p", "markers-unread"),
        ('<path id="p" d="M0 0H5" style="marker:url(#a)"/>', "p", "markers-unread"),
        ('<path id="p" d="M0 0H5" stroke-opacity=".5"/>', "p", "opacity-unread stroke-opacity"),
        ('<g id="g" clip-path="inset(2px)"><path d="M0 0H5"/></g>', "g", "clipping-unread"),
        (
            '<mask id="a"><circle r="9" fill="#888"/></mask><g id="g" style="mask:url(#a)"><path d="M0 0H5"/></g>',
            "g",
            "clipping-unread mask",
        ),
        ('<g id="g" opacity=".5"><path d="M0 0H5"/></g>', "g", "css-unread opacity"),
        *(
            (
                f'<symbol id="y"><path d="M0 0H9V9"/></symbol><mask id="a">{inside}</mask>'
                '<path id="p" d="M0 0H5" mask="url(#a)"/>',
                "p",
                "clipping-unread mask",
            )
            for inside in (
                '<g opacity=".5"><path fill="#fff" d="M0 0H9V9"/></g>',
                '<g filter="url(#f)"><path fill="#fff" d="M0 0H9V9"/></g>',
                '<path id="u" fill="#fff" d="M0 0H9V9"/><use href="#u" opacity=".5"/>',
                '<use href="#y" fill="#fff"/>',
            )
        ),
        ('<g id="g" opacity="0"><path d="M0 0H5"/></g>', "g", "transparent"),
        (
            GRADIENT + '<path id="p" d="M0 0H5" stroke="url(#g)"/>',
            "p",
            "paint-unread #g #000000",
        ),
        (
            GRADIENT + '<path id="p" d="M0 0H5" stroke="url(\'#g\') red"/>',
            "p",
            "paint-unread #g #ff0000",
        ),
    ],
)
def test_unsupported_content_is_named(body, where, reported):
    design = read(FIRST + body)
    (named,) = (notice for notice in design.notices if notice.where == where)
    assert agrees(named, reported)
    assert not any(notice.damaged for notice in design.notices)


@pytest.mark.parametrize(
    "body",
    [
        '<path class="a" d="M0 0H5"/>',
        '<style>  </style><path class="a" d="M0 0H5"/>',
        '<path d="M0 0H5" stroke-dasharray="0 0" stroke-linecap="butt" opacity="1" stroke-opacity="100%"/>',
        '<rect width="5" height="5" marker-end="url(#a)"/>',
    ],
)
def test_unsupported_content_without_effect_is_not_named(body):
    assert only(body)


def test_names_and_messages_stay_on_one_line():
    design = read('<path id="a&#10;b&#x85;" d="M0 0H5"/><path id="c" d="M0 0H5&#10;&#x85;x"/>')
    assert design.elements[0].id == "a b"
    assert "found 'x'" in design.notices[0].sentence.replace("? ", "").replace("?", "")


def test_the_default_fill_of_a_stroked_path_is_not_reported():
    assert only('<path d="M0 0H5V5Z"/>', 'width="9" height="9" stroke="red"')


def test_a_subpath_without_length_is_a_dab():
    for d in ("M5 5z", "M5 5L5 5", "M5 5h0z", "M5 5A1 1 0 0 0 5 5", "M5 5c0 0 0 0 0 0", "M5 5h1e-8v1e-8"):
        (subpath,) = only(f'<path d="{d}"/>').subpaths
        assert subpath.cubics.tolist() == [[[5, 45]] * 4]
        assert not subpath.closed
    assert only('<line x1="5" y1="5" x2="5" y2="5"/>').subpaths[0].cubics.shape == (1, 4, 2)


@pytest.mark.parametrize("body", ["", "<text id='t'>x</text>", "<path id='t' d='nan'/>", "<path id='t' d='M1 1'/>"])
def test_a_drawing_without_strokes_is_refused_with_a_reason(body):
    with refused("nothing-to-paint") as caught:
        read(body)
    assert (": t: " in str(caught.value)) == bool(body)


def test_damage_is_the_first_reason_given():
    with refused("nothing-to-paint 'p: d' 1 nan") as caught:
        read("<text/><path id='p' d='nan'/><text/>")
    assert caught.value.sentence.index(" p: d") < caught.value.sentence.index("text")


# Files and XML.


@pytest.mark.parametrize(
    ("data", "reported"),
    [
        (b"", "file-empty"),
        (b" \n", "file-empty"),
        (b"M0 0", "not-xml 1"),
        (b"<svg>\n<path></svg>", "not-xml 2"),
        (b"<svg>\n<path", "not-xml 2"),
        (b"\x89PNG\r\n\x1a\n", "not-xml PNG"),
        (b"%PDF-1.6\n", "not-xml PDF"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n", "not-xml PostScript"),
        (b"PK\x03\x04\x14\0", "not-xml ZIP"),
        (gzip.compress(b"\xff\xd8\xff\xe0", mtime=0), "not-xml JPEG"),
        (
            b'<?xml version="1.0" encoding="utf-8"?>\n<svg id="\xe4"/>',
            "not-xml 2",
        ),
        (b'<?xml version="1.0" encoding="klingon"?><svg/>', "not-xml klingon"),
        (b"<html/>", "not-svg <html>"),
        (b'<svg xmlns="http://example.org/"/>', "not-svg <svg>"),
    ],
)
def test_files_that_are_not_svg_are_refused(data, reported):
    with refused(reported):
        read_svg(data)


def test_text_encodings_are_read():
    body = f'<svg {NAMESPACES} {PAGE}><path id="\u00e4" d="M0 0h1"/></svg>'
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "iso-8859-1", "windows-1252"):
        data = f'<?xml version="1.0" encoding="{encoding.removesuffix("-sig")}"?>{body}'.encode(encoding)
        assert read_svg(data).elements[0].id == "\u00e4"


def test_internal_entities_are_expanded():
    data = f"""<?xml version="1.0"?><!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "svg11.dtd" [
      <!ENTITY ns_svg "http://www.w3.org/2000/svg"><!ENTITY st0 "fill:none;stroke:#00ff00;">]>
      <svg xmlns="&ns_svg;" {PAGE}><path style="&st0;" d="M0 0H5"/></svg>"""
    assert read_svg(data.encode()).elements[0].colour == "#00ff00"


LAUGHS = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))


@pytest.mark.parametrize(
    ("subset", "content", "reported"),
    [
        ('<!ENTITY e0 "ha">' + LAUGHS, "&e11;", "xml-entity 1 e1"),
        (f'<!ENTITY e "{"x" * 100_000}">', "&e;" * 5000, "xml-entity 10000000"),
        ('<!ENTITY % p "x">', "", "xml-entity p"),
        ('<!ENTITY e SYSTEM "file:///etc/passwd">', "&e;", "xml-entity e"),
        (f'<!ATTLIST g a CDATA "{"x" * 100_000}">', "<g/>" * 5000, "xml-entity"),
    ],
)
def test_entity_bombs_and_external_files_are_refused_early(subset, content, reported):
    data = f"<!DOCTYPE svg [{subset}]><svg>{content}</svg>".encode()
    tracemalloc.start()
    with refused(reported):
        read_svg(data)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5e6


def test_deep_nesting_is_read_without_recursion():
    depth = 20_000
    assert only("<g>" * depth + FIRST + "</g>" * depth)


@pytest.mark.parametrize(
    "body",
    [
        f'<path d="M0 0{" " * 100_000}!"/>',
        f'<path d="M0 0 {"1" * 100_000}!"/>',
        f'<path style="{"(" * 100_000}" d="M0 0H1"/>',
        f'<path style="stroke:a{" " * 100_000}b" d="M0 0H1"/>',
        f'<path transform="{"a" * 100_000}" d="M0 0H1"/>',
        f'<path transform="rotate({" " * 100_000}" d="M0 0H1"/>',
        f'<line x2="{"1" * 100_000}!"/>',
        f'<path stroke="rgb({"1" * 100_000}" d="M0 0H1"/>',
    ],
)
def test_long_invalid_input_is_read_in_linear_time(body):
    assert read(FIRST + body).elements  # code with quadratic running time would not end


@pytest.mark.parametrize(
    "text",
    [
        "stroke:red;fill:none;stroke-width:1.5mm;stroke-opacity:50%;stroke:#F00",
        " stroke : red ;; ;fill:\tnone\n;junk;: ;9:1;a:",
        "font-family:'a;b';stroke:red",
        'font-family:"a;stroke:red',
        "fill:url(a;b);stroke:red",
        "fill:rgb(1, 2, 3);stroke:red !important",
        "a{b:c;d:e};stroke:red",
        "grid:[a;b];stroke:red",
        "/* a;b */stroke:red/*;*/;fill:no/**/ne",
        "@media a;stroke:red",
        "a:b\\;c;stroke:red",
        "STROKE:Red;--Own:x;-a:b;_a:b;opacity:-.5;x:1e3;y:+1;z:1em;v:1e;w:a-",
    ],
)
def test_style_declarations_follow_css(text):
    parsed = tinycss2.parse_blocks_contents(text, skip_comments=True, skip_whitespace=True)
    target = [
        (each.name if each.name.startswith("--") else each.lower_name, value, each.important)
        for each in parsed
        if each.type == "declaration" and (value := tinycss2.serialize(each.value).strip())
    ]
    assert list(declarations(text)) == target


def test_drawings_are_read_by_file_name_and_unreadable_ones_refused(tmp_path):
    drawing = f'<svg {NAMESPACES} {PAGE}><path d="M0 0H5"/></svg>'
    (tmp_path / "vincent.SVG").write_text(drawing)
    assert read_drawing(tmp_path / "vincent.SVG").title == "", "a path is no title"
    (tmp_path / "titled.svg").write_text(drawing.replace("<path", "<title> My\n word </title><path", 1))
    assert read_drawing(str(tmp_path / "titled.svg")).title == "My word"
    (tmp_path / "folder.svg").mkdir()
    (tmp_path / "folder").mkdir()
    (tmp_path / "drawing.txt").write_text(drawing)
    for name, expected in (
        ("missing.svg", "file-unreadable"),
        ("folder.svg", "file-unreadable"),
        ("folder", "file-unreadable"),
        ("drawing.txt", "drawing-format .txt .svg"),
        ("drawing", "drawing-format"),
    ):
        with refused(expected):
            read_drawing(tmp_path / name)


def loaded_by(code: str, *arguments) -> set[str]:
    """Return the modules of a fresh process that has run a piece of code."""
    code += "\nprint(*sys.modules, file=sys.stderr)"
    command = [sys.executable, "-c", code, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return set(done.stderr.split())


HEAVY = {"scipy", "cv2", "svgpathtools", "ezdxf"}


def test_reading_a_small_drawing_loads_no_large_library(tmp_path):
    drawing = tmp_path / "small.svg"
    drawing.write_text(f'<svg {NAMESPACES} {PAGE}><style>path{{fill:none}}</style>{FIRST}<circle r="3"/></svg>')
    loaded = loaded_by("import sys, brushsvg\nbrushsvg.read_drawing(sys.argv[1])", drawing)
    assert "brushsvg.read.svg" in loaded
    assert not loaded & HEAVY


def test_help_loads_no_numeric_library():
    loaded = loaded_by("import sys\nfrom brushsvg.cli import main\nassert main(['--help']) == 0")
    assert "brushsvg.cli.arguments" in loaded
    assert not loaded & {*HEAVY, "numpy", "tinycss2"}
