"""Strokes from svgpathtools' paths, path data and arrays, and back.

Drawings that are already open can be used as well.
"""

import io
import xml.etree.ElementTree as ET
from pathlib import Path
from xml.etree.ElementTree import ElementTree

import ezdxf
import numpy as np
import pytest
import svgpathtools
from diagnostics import refused

import brushsvg

EXAMPLES = Path(__file__).parents[2] / "examples"
DATA = "M10 20 L30 20 Q40 20 40 30 A 10 6 30 0 1 25 45 C 20 50 15 40 12 30"


def sampled(path, count=400):
    return np.array([path.point(t) for t in np.linspace(0, 1, count)])


def way_mm(a_pass):
    """Return the length of a pass over the paper, from its poses and the circles of its arcs."""
    poses = np.asarray(a_pass.poses_mm)[:, :2]
    moves_mm = np.linalg.norm(np.diff(poses, axis=0), axis=1)
    for arc in a_pass.arcs:
        moves, radius = slice(arc.first, arc.last), np.linalg.norm(poses[arc.first] - arc.centre_mm)
        moves_mm[moves] = 2 * radius * np.arcsin(moves_mm[moves] / (2 * radius))
    return moves_mm.sum()


def away(points, others):
    return np.abs(points[:, None] - others[None, :]).min(axis=1).max()


@pytest.mark.slow
@pytest.mark.parametrize("given", [svgpathtools.parse_path(DATA), DATA], ids=["Path", "text"])
def test_a_path_object_gives_the_curve_of_svgpathtools(given):
    stroke = brushsvg.stroke_from_path(given, 3.0, id="s")
    theirs = sampled(svgpathtools.parse_path(DATA), 20000)
    ours = brushsvg.flatten(stroke, 0.001)[:, :2] @ (1, 1j)
    assert away(ours, theirs) < 0.01
    assert (stroke.id, stroke.closed, stroke.half_width) == ("s", False, ((0.0, 1.5), (1.0, 1.5)))


def test_y_points_down_if_a_page_height_is_given():
    up, down = (brushsvg.stroke_from_path("M10 20 L30 25", 3.0, page_height_mm=height) for height in (None, 100.0))
    assert np.allclose(np.asarray(up.middle_mm)[0, [0, 1, 6, 7]], (10, 20, 30, 25))
    assert np.allclose(np.asarray(down.middle_mm)[0, [0, 1, 6, 7]], (10, 80, 30, 75))
    back = brushsvg.path_from_stroke(down, page_height_mm=100.0)
    assert (back.start, back.end) == (10 + 20j, 30 + 25j)


@pytest.mark.parametrize("shape", [(1, 4, 2), (1, 8)])
def test_arrays_are_read_as_cubics(shape):
    cubics = np.array([[0, 0], [10, 0], [20, 10], [30, 10.0]])
    stroke = brushsvg.stroke_from_path(cubics.reshape(shape), 2.0)
    assert np.array_equal(np.asarray(stroke.middle_mm), cubics.reshape(1, 8))
    as_complex = brushsvg.stroke_from_path((cubics @ (1, 1j)).reshape(1, 4), 2.0)
    assert np.array_equal(as_complex.middle_mm, stroke.middle_mm)


def test_a_path_with_a_closing_command_is_closed():
    square = "M10 10 H30 V30 H10 "
    assert brushsvg.stroke_from_path(square + "Z", 2.0).closed
    assert not brushsvg.stroke_from_path(square, 2.0).closed
    assert brushsvg.stroke_from_path(svgpathtools.parse_path(square + "Z"), 2.0).closed


def test_a_stroke_from_a_path_is_painted_and_returned_as_a_path():
    stroke = brushsvg.stroke_from_path("M30 40 C50 70 80 70 100 40", 4.0)
    brush = brushsvg.find_brush("round-6")
    done = brushsvg.compensate([stroke], brush, (140, 100))
    way = brushsvg.path_from_pass(done.plan.passes[0])
    poses = np.asarray(done.plan.passes[0].poses_mm)[:, :2] @ (1, 1j)
    assert (way.start, way.end) == (poses[0], poses[-1])
    assert way.length() == pytest.approx(way_mm(done.plan.passes[0]))
    assert brushsvg.path_from_stroke(stroke).d() == "M 30.0,40.0 C 50.0,70.0 80.0,70.0 100.0,40.0"


@pytest.mark.parametrize("page_height_mm", [None, 100.0])
@pytest.mark.parametrize("direction", [1, -1])
def test_moves_along_arcs_are_arcs_of_the_circle(direction, page_height_mm):
    angles = np.radians(direction * np.array([0, 90, 180, 270, 360]))
    circle = np.column_stack([60 + 20 * np.cos(angles), 50 + 20 * np.sin(angles), np.full(5, -2.0)])
    poses = np.vstack([circle, [90, 50, -2]])
    a_pass = brushsvg.Pass("a", poses, arcs=[brushsvg.Arc(0, 4, (60, 50), direction)])
    way = brushsvg.path_from_pass(a_pass, page_height_mm)
    assert [type(piece) for piece in way] == [svgpathtools.Arc] * 4 + [svgpathtools.Line]
    assert way.length() == pytest.approx(40 * np.pi + 10)
    assert np.abs(sampled(svgpathtools.Path(*way[:4])) - (60 + 50j)) == pytest.approx(20)
    quarter = way[0].point(0.5) - (60 + 50j)
    assert np.sign(quarter.imag) == (direction if page_height_mm is None else -direction)


@pytest.mark.parametrize("direction", [1, -1])
def test_an_arc_too_short_for_its_direction_is_a_line(direction):
    angle = direction * 5e-9
    poses = [[20, 0, -2], [20 * np.cos(angle), 20 * np.sin(angle), -2]]
    a_pass = brushsvg.Pass("a", poses, arcs=[brushsvg.Arc(0, 1, (0, 0), direction)])
    assert brushsvg.path_from_pass(a_pass).length() == pytest.approx(1e-7, abs=1e-7)


@pytest.mark.parametrize(
    "arc", [brushsvg.Arc(-1, 5, (25, 20), 1), brushsvg.Arc(0, 1, (np.nan, 20), 1), brushsvg.Arc(0, 1, (20, 20), 1)]
)
def test_an_arc_that_does_not_agree_with_its_poses_is_refused(arc):
    with refused("arc-invalid 0"):
        brushsvg.path_from_pass(brushsvg.Pass("a", [[20, 20, -2], [30, 20, -2]], arcs=[arc]))


def test_the_way_of_a_plan_with_arcs_is_as_long_as_its_passes():
    done = brushsvg.convert(EXAMPLES / "vincent.svg")
    assert any(a_pass.arcs for a_pass in done.plan.passes)
    for a_pass in done.plan.passes:
        assert brushsvg.path_from_pass(a_pass).length() == pytest.approx(way_mm(a_pass))


@pytest.mark.parametrize(
    ("path", "width_mm", "expected"),
    [
        ("M0 0 L10 0 M20 0 L30 0", 2, "wrong-type 2"),
        ("", 2, "wrong-type"),
        ("M0 0 L10 x", 2, "geometry-damaged x"),
        ("M0 0 L1e9 0", 2, "geometry-out-of-range 1e6"),
        (svgpathtools.Path(), 2, "wrong-type"),
        (svgpathtools.parse_path("M0 0 L10 0 M20 0 L30 0"), 2, "wrong-type 2"),
        (np.zeros((2, 3)), 2, "wrong-type '(n, 4, 2)'"),
        (None, 2, "wrong-type '(n, 4, 2)'"),
        (np.array([[0, 0, 1, 0, 2, 0, 3, 0], [4, 0, 5, 0, 6, 0, 7, 0]]), 2, "wrong-type 2"),
        (np.array([[0, 0, 1, 0, 2, 0, np.nan, 0]]), 2, "not-finite"),
        (np.zeros((0, 8)), 2, "stroke-empty"),
        ([[10**400] * 8], 2, "wrong-type '(n, 4, 2)'"),
        ("M0 0 L10 0", 0, "out-of-range 0 (0"),
        ("M0 0 L10 0", np.nan, "out-of-range nan (0"),
        ("M0 0 L10 0", 2e6, "out-of-range 2e+06 (0"),  # the message named this limit, and nothing compared with it
    ],
)
def test_invalid_paths_are_refused(path, width_mm, expected):
    with refused(expected):
        brushsvg.stroke_from_path(path, width_mm)


def test_open_documents_are_read_like_their_files(tmp_path):
    text = '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="50mm" viewBox="0 0 90 50"><path id="a" '
    text += 'd="M10 20 C20 5 30 5 40 30" fill="none" stroke="#123456" stroke-width="3"/></svg>'
    (tmp_path / "a.svg").write_text(text)
    of_file = brushsvg.read_drawing(tmp_path / "a.svg")
    tree = ElementTree(ET.fromstring(text))
    for open_drawing in (tree, tree.getroot()):
        ours = brushsvg.read_drawing(open_drawing)
        assert ours.sheet_mm == of_file.sheet_mm
        assert np.array_equal(ours.elements[0].subpaths[0].cubics, of_file.elements[0].subpaths[0].cubics)
        assert ours.elements[0].colour == "#123456"


def test_trees_that_cannot_be_written_as_xml_are_refused():
    numbers = ET.Element("svg", {"width": "90mm", "height": 50})
    deep = inner = ET.Element("svg", {"width": "90mm", "height": "50mm"})
    for _ in range(10_000):
        inner = ET.SubElement(inner, "g")
    for tree, expected in ((numbers, "not-xml 50 int"), (deep, "drawing-too-large")):
        with refused(expected):
            brushsvg.read_drawing(tree)
        with refused(expected):
            brushsvg.convert(tree)


def test_an_ezdxf_document_is_read_like_its_file(tmp_path):
    document = ezdxf.new("R2010", units=4)
    document.modelspace().add_lwpolyline([(0, 0, 1, 3, 0), (40, 10, 3, 1, 0.5), (60, 0, 1, 1, 0)])
    document.saveas(tmp_path / "a.dxf")
    of_file, ours = brushsvg.read_drawing(tmp_path / "a.dxf"), brushsvg.read_drawing(document)
    assert ours.sheet_mm == of_file.sheet_mm and len(ours.elements) == len(of_file.elements)
    for a, b in zip(ours.elements, of_file.elements, strict=True):
        assert np.array_equal(a.subpaths[0].cubics, b.subpaths[0].cubics)


def test_objects_that_are_neither_file_nor_document_are_refused():
    for wrong in (None, 3, io.BytesIO(b"x"), object()):
        with refused("drawing-format ElementTree path") as reported:
            brushsvg.read_drawing(wrong)
        assert "open file" not in str(reported.value), "one is refused, too"


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"skip_comments": "fill"}, "wrong-type fill skip_comments"),
        ({"skip_comments": None}, "wrong-type skip_comments"),
        ({"skip_comments": (3,)}, "wrong-type 3 skip_comments"),
        ({"skip_regions_mm": None}, "wrong-type skip_regions_mm"),
        ({"skip_regions_mm": "0,0,9,9"}, "wrong-type skip_regions_mm"),
        ({"skip_regions_mm": [("0", 0, 9, 9)]}, "wrong-type 0 skip_regions_mm"),
        ({"skip_regions_mm": [(0, 0, 9)]}, "wrong-type 3 4 skip_regions_mm"),
        ({"skip_regions_mm": [(0, 0, 9, 10**400)]}, "out-of-range inf skip_regions_mm"),
        ({"sheet_mm": 100}, "wrong-type 100 sheet_mm"),
        ({"sheet_mm": np.zeros(3)}, "wrong-type 3 2 sheet_mm"),
        ({"sheet_mm": (100, True)}, "wrong-type True sheet_mm"),
        ({"paper_z_mm": "0"}, "wrong-type 0"),
    ],
)
def test_options_of_reading_that_are_none_are_refused(options, expected):
    with refused(expected):
        brushsvg.read_drawing(EXAMPLES / "vincent.svg", brushsvg.ReadOptions(**options))


def test_options_of_reading_may_be_arrays():
    options = brushsvg.ReadOptions(sheet_mm=np.array([300, 200]), skip_regions_mm=np.array([[0, 0, 9, 9]]))
    assert brushsvg.read_drawing(EXAMPLES / "vincent.svg", options).sheet_mm == (300.0, 200.0)
