import subprocess
import sys

import numpy as np
import pytest
from diagnostics import agrees, are_reported, is_reported, refused
from dxf_text import SHEET, along, apart, bulged, circle, drawing, encoded, only, read
from scipy.interpolate import BSpline, CubicSpline

from brushsvg.read import READERS, ReadOptions, read_drawing
from brushsvg.read.dxf import read_dxf
from brushsvg.read.dxf.ezdxf_import import ezdxf
from brushsvg.strokes.extraction import strokes

CONTROL = np.array([(0, 0, 0), (20, 40, 0), (50, -30, 0), (70, 10, 0), (90, 35, 0), (120, 0, 0), (130, 30, 0)], float)
BULGES = [(0, 0, 0.5), (40, 0, -1.3), (60, 30, 0.0), (10, 50, 3.0), (0, 20, 1e-3)]


def b_spline(degree, knots=None, points=CONTROL):
    if knots is None:
        inner = np.arange(len(points) - degree + 1.0)
        knots = np.concatenate((np.zeros(degree), inner, np.full(degree, inner[-1])))
    t = np.linspace(knots[degree], knots[len(points)], 8001)
    return BSpline(knots, points, degree)(t)


def add_spline(msp, degree, knots=None, points=CONTROL, weights=None):
    spline = msp.add_spline(degree=degree)
    spline.control_points = points
    if knots is None:
        inner = np.arange(len(points) - degree + 1.0)
        knots = [*[0.0] * degree, *inner, *[inner[-1]] * degree]
    spline.knots = knots
    if weights is not None:
        spline.weights = weights


def add_nurbs_circle(msp):
    half = 2**-0.5
    points = [(60, 0), (60, 60), (0, 60), (-60, 60), (-60, 0), (-60, -60), (0, -60), (60, -60), (60, 0)]
    knots, weights = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], [1, half, 1, half, 1, half, 1, half, 1]
    add_spline(msp, 2, knots, np.column_stack((points, np.zeros(9))), weights)


def add_edges(msp):
    """Add an edge path with half a disc, half an ellipse, a spline and lines.

    The first and the last edge are drawn backwards.
    """
    path = msp.add_hatch(color=1).paths.add_edge_path()
    path.add_arc((40, 0), 20, 0, 180, ccw=False)
    path.add_line((60, 0), (60, 80))
    path.add_ellipse((0, 80), (60, 0), 0.5, 0, 180, ccw=True)
    path.add_spline(control_points=[(-60, 80), (-50, 40), (-30, 60), (-20, 0)], degree=3, knot_values=[0] * 4 + [1] * 4)
    path.add_line((20, 0), (-20, 0))


EDGES = np.concatenate(
    (
        [(-20, 0), (20, 0)],
        circle((40, 0), 20, begin=180, end=0),
        [(60, 0), (60, 80)],
        circle((0, 80), 60, 30, 0, 180),
        BSpline([0] * 4 + [1] * 4, [(-60, 80), (-50, 40), (-30, 60), (-20, 0)], 3)(np.linspace(0, 1, 4000)),
    )
)
UNCLAMPED = np.arange(11.0)
CORNERED = [0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2.0]
SQUARE = [(0, 0), (40, 0), (40, 20), (0, 30)]
ROUND = [(0, 0), (40, 0), (40, 20), (0, 30), (0, 0)]

# name: (function that draws it, its points, whether it is closed)
SHAPES = {
    "line": (lambda m: m.add_line((3, 4), (50, 20)), [(3, 4), (50, 20)], False),
    "arc": (lambda m: m.add_arc((10, 20), 150, 30, 200), circle((10, 20), 150, begin=30, end=200), False),
    "arc past 0": (lambda m: m.add_arc((10, 20), 50, 350, 20), circle((10, 20), 50, begin=350, end=380), False),
    "circle": (lambda m: m.add_circle((10, 20), 200), circle((10, 20), 200), True),
    "ellipse": (
        lambda m: m.add_ellipse((5, 6), (60, 80), 0.3),
        circle((5, 6), 100, 30, turn=np.degrees(np.arctan2(80, 60))),
        True,
    ),
    "part of an ellipse": (
        lambda m: m.add_ellipse((5, 6), (0, 90), 0.5, np.radians(40), np.radians(250)),
        circle((5, 6), 90, 45, 40, 250, 90),
        False,
    ),
    "lwpolyline": (lambda m: m.add_lwpolyline(BULGES, format="xyb"), bulged(BULGES), False),
    "closed lwpolyline": (
        lambda m: m.add_lwpolyline(BULGES, format="xyb", close=True),
        bulged(BULGES, True),
        True,
    ),
    "polyline": (lambda m: m.add_polyline2d(BULGES, format="xyb"), bulged(BULGES), False),
    "closed polyline": (
        lambda m: m.add_polyline2d(BULGES, format="xyb", close=True),
        bulged(BULGES, True),
        True,
    ),
    "3d polyline": (
        lambda m: m.add_polyline3d([(*place, 7) for place in SQUARE]),
        SQUARE,
        False,
    ),
    "polyline back at its start": (lambda m: m.add_lwpolyline(ROUND), ROUND, True),
    "degree 1": (lambda m: add_spline(m, 1), CONTROL, False),
    "degree 2": (lambda m: add_spline(m, 2), b_spline(2), False),
    "degree 3": (lambda m: add_spline(m, 3), b_spline(3), False),
    "degree 5": (lambda m: add_spline(m, 5), b_spline(5), False),
    "unclamped": (lambda m: add_spline(m, 3, UNCLAMPED), b_spline(3, UNCLAMPED), False),
    "cornered": (lambda m: add_spline(m, 3, CORNERED), b_spline(3, CORNERED), False),
    "rational": (add_nurbs_circle, circle((0, 0), 60), True),
    "solid": (lambda m: m.add_solid([SQUARE[0], SQUARE[1], SQUARE[3], SQUARE[2]]), ROUND, True),
    "trace": (lambda m: m.add_trace([SQUARE[0], SQUARE[1], SQUARE[3], SQUARE[2]]), ROUND, True),
    "3dface": (lambda m: m.add_3dface(SQUARE), ROUND, True),
    "hatch": (
        lambda m: m.add_hatch().paths.add_polyline_path([(x, y, b) for x, y, b in BULGES], is_closed=True),
        bulged(BULGES, True),
        True,
    ),
    "hatch of edges": (add_edges, EDGES, True),
    "mpolygon": (lambda m: m.add_mpolygon().paths.add_polyline_path(SQUARE, is_closed=True), ROUND, True),
    "circle seen from below": (
        lambda m: m.add_circle((-10, 20), 30, dxfattribs={"extrusion": (0, 0, -1)}),
        circle((10, 20), 30),
        True,
    ),
    "arc seen from below": (
        lambda m: m.add_arc((-10, 20), 30, 10, 60, dxfattribs={"extrusion": (0, 0, -1)}),
        circle((10, 20), 30, begin=120, end=170),
        False,
    ),
    "lwpolyline seen from below": (
        lambda m: m.add_lwpolyline(BULGES, format="xyb", dxfattribs={"extrusion": (0, 0, -1)}),
        bulged(BULGES) * (-1, 1),
        False,
    ),
}  # fmt: skip
FILLED = {"solid", "trace", "hatch", "hatch of edges"}
each_shape = pytest.mark.parametrize("name", SHAPES)


@each_shape
def test_every_entity_is_within_a_micrometre_of_the_true_curve(name):
    draw, points, closed = SHAPES[name]
    element = only(drawing(draw))
    (subpath,) = element.subpaths
    assert apart(subpath, points) < 2e-4
    assert subpath.closed == closed
    assert element.fill_rule == ("evenodd" if name in FILLED else "")
    assert element.stroke_width_mm == (0 if name in FILLED else 0.25)


@each_shape
@pytest.mark.slow
def test_every_entity_in_a_block_moves_with_the_block(name):
    """Every entity in a block moves with the block.

    The block is scaled unevenly, turned and mirrored. It is inside another block that is scaled and turned.
    """
    draw, points, closed = SHAPES[name]
    document = drawing()
    inner, outer = document.blocks.new("inner", base_point=(5, 7)), document.blocks.new("outer")
    draw(inner)
    outer.add_blockref("inner", (20, 10), {"xscale": 2, "yscale": -0.5, "zscale": 1, "rotation": 30})
    document.modelspace().add_blockref("outer", (-40, 60), {"xscale": 1.5, "yscale": 1.5, "rotation": 70})
    element = only(document)
    (subpath,) = element.subpaths
    moved = turned((np.array(points)[:, :2] - (5, 7)) * (2, -0.5), 30) + np.array((20, 10))
    moved = turned(moved * 1.5, 70) + np.array((-40, 60))
    assert apart(subpath, moved) < 2e-4
    assert subpath.closed == closed
    # a block's scale does not change a line weight
    assert element.stroke_width_mm == (0 if name in FILLED else 0.25)


def turned(points, degrees):
    turn = np.radians(degrees)
    return points @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])


FITTED = [(0, 0), (30, 40), (80, -10), (100, 20)]


@pytest.mark.parametrize("weights", [None, [1.0] * 4 + [2.0] * 4])
def test_a_spline_with_a_gap_is_two_lines(weights):
    points = np.array([(0, 0), (10, 0), (20, 10), (30, 10), (30, 40), (40, 40), (50, 50), (60, 50)], float)
    knots = [0] * 4 + [1] * 4 + [2] * 4
    element = only(drawing(lambda m: add_spline(m, 3, knots, np.column_stack((points, 0 * points[:, 0])), weights)))
    for subpath, part in zip(element.subpaths, (points[:4], points[4:]), strict=True):
        assert apart(subpath, BSpline([0] * 4 + [1] * 4, part, 3)(np.linspace(0, 1, 4000))) < 1e-3
    near = points.copy()
    near[4] = near[3] + (0.004, 0)  # With few digits, one place may become two.
    whole = only(drawing(lambda m: add_spline(m, 3, knots, np.column_stack((near, 0 * near[:, 0])), weights)))
    assert len(whole.subpaths) == 1


def test_a_repeated_fit_point_counts_once():
    document = drawing()
    document.modelspace().add_spline([FITTED[0], FITTED[1], FITTED[1], FITTED[2]])
    other = drawing()
    other.modelspace().add_spline(FITTED[:3])
    assert np.array_equal(only(document).subpaths[0].cubics, only(other).subpaths[0].cubics)


def test_a_spline_passes_its_fit_points():
    (subpath,) = only(drawing(lambda m: m.add_spline(FITTED))).subpaths
    assert len(subpath.cubics) == 3
    assert np.abs(subpath.cubics[[0, 1, 2, 2], [0, 0, 0, 3]] - FITTED).max() < 1e-9
    at = np.concatenate(([0], np.cumsum(np.hypot(*np.diff(FITTED, axis=0).T))))
    true = CubicSpline(at, FITTED, bc_type="natural")(np.linspace(0, at[-1], 8001))
    assert apart(subpath, true) < 2e-4


@pytest.mark.parametrize("count", [2, 3, 4])
@pytest.mark.parametrize("tangents", [None, ((1, 2, 0), (0, 5, 0)), ((1, 2, 0), None)])
def test_fit_points_are_joined_as_in_ezdxf(count, tangents):
    document = drawing()
    spline = document.modelspace().add_spline(FITTED[:count])
    begin, end = tangents or (None, None)
    if begin:
        spline.dxf.start_tangent = begin
    if end:
        spline.dxf.end_tangent = end
    (subpath,) = only(document).subpaths
    assert apart(subpath, [point.xyz for point in spline.flattening(1e-5, 64)]) < 2e-4
    if begin and end:
        ends = [np.diff(subpath.cubics[0, :2], axis=0)[0], np.diff(subpath.cubics[-1, 2:], axis=0)[0]]
        for turn, tangent in zip(ends, (begin, end), strict=True):
            assert turn / np.hypot(*turn) == pytest.approx(tangent[:2] / np.hypot(*tangent[:2]))


def test_the_frame_of_a_smoothed_polyline_is_not_drawn():
    def draw(msp):
        line = msp.add_polyline2d([(0, 0), (5, 30), (10, 0), (5, 9)], dxfattribs={"flags": 4})
        line.vertices[1].dxf.flags = line.vertices[3].dxf.flags = 16

    assert apart(only(drawing(draw)).subpaths[0], [(0, 0), (10, 0)]) < 1e-9


@pytest.mark.parametrize("pitch", [5, 0])
@pytest.mark.parametrize("turns", [0.3, 1, 2.4])
@pytest.mark.slow
def test_a_helix_is_seen_from_above(pitch, turns):
    document = drawing()
    helix = document.modelspace().add_helix(30, pitch, turns)
    assert len(helix.control_points)
    design = read(document)
    assert [notice.where for notice in design.notices] == ["z"] * (pitch > 0)
    (subpath,) = design.elements[0].subpaths
    assert apart(subpath, [point.xyz for point in helix.flattening(1e-5, 64)]) < 2e-4
    # ezdxf's spline approximates the helix itself to 1 % of the radius.
    assert apart(subpath, circle((0, 0), 30, end=360 * turns)) < 0.3


@pytest.mark.parametrize(
    ("units", "mm"),
    [
        (1, 25.4),
        (2, 304.8),
        (3, 1609344.0),
        (4, 1),
        (5, 10),
        (6, 1000),
        (8, 25.4e-6),
        (9, 0.0254),
        (10, 914.4),
    ],
)
def test_units_are_converted_to_mm(units, mm):
    size = 100 / mm
    element = only(drawing(lambda m: m.add_circle((size, 0), size), units))
    assert apart(element.subpaths[0], circle((100, 0), 100)) < 2e-4
    assert element.stroke_width_mm == 0.25


def test_a_drawing_without_units_is_refused_with_the_flag_to_add():
    for version in ("R12", "R2010"):
        document = drawing(lambda m: m.add_line((0, 0), (2, 0)), 0, version)
        with refused("unit-unknown '--units mm' '--units in'"):
            read(document)
        for units, mm in (("mm", 1.0), ("in", 25.4)):
            element = only(document, units=units)
            assert element.subpaths[0].cubics[-1, 3].tolist() == pytest.approx([2 * mm, 0], rel=0, abs=1e-12)


def test_a_drawing_too_large_for_its_unit_causes_a_warning():
    """A drawing that is too large for its unit causes a warning.

    ezdxf and other programs write metres if nobody chose a unit.
    """

    def line(unit, length, **more):
        return read(drawing(lambda m: m.add_line((0, 0), (0, length)), unit), **more).notices

    assert are_reported(line(6, 100), "unit-doubtful metres '100 m' --units")
    assert are_reported(line(1, 250), "unit-doubtful inches '6.35 m'")
    assert line(6, 4.9) == line(4, 9000) == ()
    assert are_reported(line(6, 100, units="mm"), "unit-overruled")


def test_requested_units_override_the_file_with_a_notice():
    design = read(drawing(lambda m: m.add_line((0, 0), (2, 0)), units=1), units="mm")
    assert design.elements[0].subpaths[0].cubics[-1, 3].tolist() == [2, 0]
    assert are_reported(design.notices, "unit-overruled inches millimetres")
    for units in (None, "in"):
        element = only(drawing(lambda m: m.add_line((0, 0), (2, 0)), units=1), units=units)
        assert element.subpaths[0].cubics[-1, 3].tolist() == [50.8, 0]


def test_the_sheet_is_the_drawing_with_a_margin_of_20_mm():
    def draw(msp):
        msp.add_circle((100, 50), 10, {"lineweight": 200})
        msp.add_lwpolyline([(100, 50, 4, 4), (130, 50, 4, 4)], format="xyse")

    design = read(drawing(draw), sheet_mm=None)
    # x is from 89 (circle, half of 2 mm) to 132 (polyline, half of 4 mm); y is from 39 to 61.
    assert design.sheet_mm == pytest.approx((20 + 43 + 20, 20 + 22 + 20), abs=1e-3)
    assert apart(design.elements[0].subpaths[0], circle((31, 31), 10)) < 2e-4
    given = read(drawing(draw), sheet_mm=(300.0, 200.0))
    assert given.sheet_mm == (300, 200)
    assert apart(given.elements[0].subpaths[0], circle((100, 50), 10)) < 2e-4


# Widths ---------------------------------------------------------------------------------------------


def test_a_polyline_keeps_its_varying_widths():
    rows = [(0, 0, 1, 3, 0), (30, 0, 2, 2, 1), (30, 20, 0, 0, 0), (0, 20, 0, 4, 0), (0, 60, 9, 9, 0)]
    for add in ("add_lwpolyline", "add_polyline2d"):
        document = drawing(lambda m, add=add: getattr(m, add)(rows, format="xyseb", dxfattribs={"lineweight": 50}))
        element = only(document)
        (subpath,) = element.subpaths
        at = np.cumsum([0, 30, 10 * np.pi, 30, 40]) / (100 + 10 * np.pi)
        # The third side has the line weight, so both its widths are 0.
        knots = [(0, 1), (at[1], 3), (at[1], 2), (at[2], 2), (at[2], 0.5), (at[3], 0.5), (at[3], 0), (1, 4)]
        found = subpath.widths[np.r_[0:3, -5:0]]  # between them are the arc's own widths
        assert found == pytest.approx(np.array(knots), abs=1e-6)
        assert (subpath.widths[2:-5, 1] == 2).all()
        assert element.stroke_width_mm == 4


def test_widths_scale_with_units_and_blocks():
    document = drawing(units=1)
    document.blocks.new("b").add_lwpolyline([(0, 0, 0.1, 0.2), (1, 0, 0, 0)], format="xyse")
    document.modelspace().add_blockref("b", (0, 0), {"xscale": 3, "yscale": -3, "rotation": 20})
    assert only(document).subpaths[0].widths == pytest.approx(np.array([(0, 7.62), (1, 15.24)]))


def test_a_constant_width_is_the_stroke_width():
    element = only(drawing(lambda m: m.add_lwpolyline([(0, 0), (9, 0)], dxfattribs={"const_width": 2.5})))
    assert element.stroke_width_mm == 2.5
    assert element.subpaths[0].widths is None


@pytest.mark.parametrize(("weight", "mm"), [(100, 1.0), (-1, 0.7), (-2, 0.25), (-3, 0.25), (0, 0.25), (211, 2.11)])
def test_line_weights_become_widths(weight, mm):
    document = drawing()
    document.layers.add("thick", lineweight=70)
    document.modelspace().add_line((0, 0), (9, 0), {"layer": "thick", "lineweight": weight})
    assert only(document).stroke_width_mm == mm


# Lines that meet ------------------------------------------------------------------------------------


def test_consecutive_lines_are_joined():
    def draw(msp):
        msp.add_line((0, 0), (10, 0))
        msp.add_line((10, 10), (10, 0))
        msp.add_arc((10, 15), 5, 270, 90)
        msp.add_line((10, 20), (-5, 20))
        msp.add_line((40, 40), (50, 50))  # elsewhere
        msp.add_line((50, 50), (60, 40), {"color": 1})  # another colour
        msp.add_line((60, 40), (70, 40), {"color": 1})

    design = read(drawing(draw))
    true = np.concatenate(([(0, 0), (10, 0), (10, 10)], circle((10, 15), 5, begin=-90, end=90), [(-5, 20)]))
    assert [len(element.subpaths) for element in design.elements] == [1, 1, 1]
    line = design.elements[0].subpaths[0]
    assert apart(line, true) < 2e-4
    assert line.cubics[0, 0].tolist() == [0, 0]
    assert not line.closed
    assert design.elements[2].subpaths[0].cubics[[0, -1], [0, 3]].tolist() == [[50, 50], [70, 40]]


def test_a_chain_that_returns_to_its_start_is_closed():
    corners = [(10, 0), (0, 0), (10, 0), (10, 10), (10, 10), (0, 0), (0, 0), (-9, -9)]

    def draw(msp):
        for begin, end in zip(corners[::2], corners[1::2], strict=True):
            msp.add_line(begin, end)

    ring, rest = read(drawing(draw)).elements
    assert ring.subpaths[0].closed
    assert ring.subpaths[0].cubics[:, 0].tolist() == [[0, 0], [10, 0], [10, 10]]
    assert rest.subpaths[0].cubics[0, 0].tolist() == [0, 0]


def test_lines_of_two_insertions_stay_separate():
    document = drawing()
    document.blocks.new("b").add_line((0, 0), (10, 0))
    for x in (0, 10):
        document.modelspace().add_blockref("b", (x, 0))
    assert len(read(document).elements) == 2


# Blocks, layers, colours ----------------------------------------------------------------------------


def test_rows_and_columns_of_an_insertion_are_repeated():
    document = drawing()
    document.blocks.new("b").add_circle((1, 0), 3)
    grid = {
        "row_count": 2,
        "column_count": 3,
        "row_spacing": 20,
        "column_spacing": 30,
        "rotation": 90,
        "xscale": 2,
    }
    document.modelspace().add_blockref("b", (5, 5), {**grid, "yscale": 2})
    design = read(document)
    found = {tuple(np.mean(along(e.subpaths[0].cubics, 400)[:-1], axis=0).round(0) + 0.0) for e in design.elements}
    assert found == {(5.0 - 20 * row, 7.0 + 30 * column) for row in range(2) for column in range(3)}
    assert len({element.id for element in design.elements}) == 6


def test_ids_are_made_from_types_and_handles():
    document = drawing()
    line = document.blocks.new("b").add_line((0, 0), (9, 0))
    circle_ = document.modelspace().add_circle((0, 0), 5)
    insert = document.modelspace().add_blockref("b", (0, 30))
    names = [f"CIRCLE-{circle_.dxf.handle}", f"INSERT-{insert.dxf.handle}/LINE-{line.dxf.handle}"]
    assert [element.id for element in read(document).elements] == names


def test_colours_layers_and_weights_come_from_layers_and_blocks():
    document = drawing()
    document.layers.add("Red", color=1, lineweight=100)
    document.layers.add("Rose", true_color=ezdxf.colors.rgb2int((250, 100, 150)))
    block = document.blocks.new("b")
    for attributes in ({}, {"color": 0, "lineweight": -2}, {"color": 5}, {"layer": "Rose"}):
        block.add_point((0, 0), attributes)
    msp = document.modelspace()
    msp.add_blockref("b", (0, 0), {"layer": "Red", "color": 3, "lineweight": 50})
    for attributes in (
        {"color": 7},
        {"color": 255},
        {"true_color": 0xFFFFFF},
        {"true_color": 0x0A0B0C, "color": 1},
    ):
        msp.add_point((0, 0), attributes)
    msp.add_point((0, 0), {"layer": "Nowhere", "color": 2})
    found = [(e.colour, e.layer, e.stroke_width_mm) for e in read(document).elements]
    assert found == [
        ("#ff0000", "Red", 1.0),
        ("#00ff00", "Red", 0.5),
        ("#0000ff", "Red", 1.0),
        ("#fa6496", "Rose", 0.25),
        ("#000000", "0", 0.25),
        ("#000000", "0", 0.25),
        ("#000000", "0", 0.25),
        ("#0a0b0c", "0", 0.25),
        ("#ffff00", "Nowhere", 0.25),
    ]


def test_hidden_entities_are_left_out_and_counted():
    document = drawing()
    document.layers.add("Off").off()
    document.layers.add("Frozen").freeze()
    document.layers.add("Plan").dxf.plot = 0
    msp = document.modelspace()
    block = document.blocks.new("b")
    block.add_line((0, 0), (1, 1))
    block.add_line((0, 0), (1, 2), {"layer": "Kept"})
    msp.add_line((5, 5), (9, 9), {"layer": "off"})
    msp.add_blockref("b", (0, 0), {"layer": "Off"})
    msp.add_blockref("b", (0, 0), {"layer": "Frozen"})
    msp.add_line((5, 5), (9, 9), {"layer": "Plan"})
    msp.add_line((5, 5), (9, 9), {"invisible": 1})
    document.paperspace().add_circle((0, 0), 5)
    design = read(document)
    assert [element.layer for element in design.elements] == ["Kept"]
    expected = {
        "Off": "hidden off '2 entities'",
        "Frozen": "hidden frozen '1 entity'",
        "Plan": "hidden plotting '1 entity'",
        "invisible": "hidden '1 entity'",
        "Layout1": "paper-space 1",
    }
    assert len(design.notices) == len(expected)
    for where, code in expected.items():
        assert is_reported(design.notices, code, where), (code, design.notices)


def test_paper_space_alone_is_refused():
    document = drawing()
    document.paperspace().add_circle((0, 0), 5)
    with refused("nothing-to-paint Layout1 '1 entity'"):
        read(document)
    with refused("nothing-to-paint") as caught:
        read(drawing())
    assert ":" not in caught.value.sentence, "no reason, where nothing was drawn"


def test_unsupported_entities_are_named():
    document = drawing()
    msp = document.modelspace()
    msp.add_ray((0, 0), (1, 0))
    with msp.add_mesh().edit_data() as mesh:
        mesh.vertices, mesh.faces = [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]
    hatch = msp.add_hatch()
    hatch.set_pattern_fill("ANSI31")
    hatch.paths.add_polyline_path(SQUARE)
    reported = read(document).notices
    assert is_reported(reported, "line-without-ends '1 entity'", "RAY")
    assert is_reported(reported, "dxf-entity-unread '1 entity'", "MESH")
    assert is_reported(reported, "paint-unread pattern", f"HATCH-{hatch.dxf.handle}")
    assert len(reported) == 3


def test_a_hatch_keeps_its_holes():
    document = drawing()
    hatch = document.modelspace().add_hatch()
    hatch.paths.add_polyline_path([(0, 0), (40, 0), (40, 40), (0, 40)], flags=1)
    hatch.paths.add_polyline_path([(10, 10), (30, 10), (30, 30), (10, 30)], flags=16)
    element = only(document)
    assert element.fill_rule == "evenodd"
    assert [subpath.cubics[0, 0].tolist() for subpath in element.subpaths] == [[0, 0], [10, 10]]
    hatch.dxf.hatch_style = 2  # holes are ignored
    assert len(only(document).subpaths) == 1


def test_points_become_dabs_and_dimensions_become_lines():
    def draw(msp):
        msp.add_point((3, 4), {"lineweight": 100})
        msp.add_linear_dim((0, 30), (0, 0), (50, 0)).render()

    dab, *rest = read(drawing(draw)).elements
    assert dab.stroke_width_mm == 1.0
    assert dab.subpaths[0].cubics.tolist() == [[[3, 4]] * 4]
    assert any((e.subpaths[0].cubics[..., 1] == 30).all() for e in rest)  # the dimension line


def test_widths_in_a_squeezed_block_are_measured_across_the_line():
    document = drawing()
    block = document.blocks.new("b")
    block.add_lwpolyline([(0, 0), (40, 0), (40, 40)], dxfattribs={"const_width": 1})
    document.modelspace().add_blockref("b", (50, 50), {"yscale": 4, "rotation": 30})
    (subpath,) = only(document).subpaths
    assert subpath.widths[[0, -1], 1] == pytest.approx([4, 1])


def test_vertex_widths_override_the_width_of_the_polyline():
    def draw(msp):
        msp.add_lwpolyline([(0, 0, 2, 2), (9, 0, 2, 2)], format="xyse", dxfattribs={"const_width": 5})

    assert only(drawing(draw)).stroke_width_mm == 2


def test_an_mpolygon_has_a_fill_and_a_border_in_their_colours():
    document = drawing()
    document.modelspace().add_mpolygon(color=1, fill_color=5).paths.add_polyline_path(SQUARE, is_closed=True)
    border, filling = read(document).elements
    assert (border.colour, border.fill_rule, border.stroke_width_mm) == ("#ff0000", "", 0.25)
    assert (filling.colour, filling.fill_rule, filling.stroke_width_mm) == ("#0000ff", "evenodd", 0)
    assert border.id == f"{filling.id}.border"


@pytest.mark.parametrize(
    ("draw", "header", "expected"),
    [
        (lambda m: [m.add_point((k, 3)) for k in range(3)], {"$PDMODE": 3}, "shown-otherwise points 3"),
        (lambda m: m.add_solid(SQUARE), {"$FILLMODE": 0}, "shown-otherwise outlines"),
        (lambda m: setattr(m.add_line((0, 0), (9, 9)), "transparency", 0.5), {}, "opacity-unread see-through"),
        (lambda m: m.add_line((0, 0), (9, 0), {"thickness": 5, "extrusion": (0, 1, 0)}), {}, "thickness-unread"),
        (lambda m: m.add_hatch().set_gradient() or SQUARE, {}, "paint-unread"),
    ],
)  # fmt: skip
def test_properties_that_are_not_reproduced_are_named_once(draw, header, expected):
    document = drawing()
    drawn = draw(document.modelspace())
    if drawn is SQUARE:
        document.modelspace()[0].paths.add_polyline_path(SQUARE)
    for name, value in header.items():
        document.header[name] = value
    (notice,) = read(document).notices
    assert agrees(notice, expected)


def test_heights_are_ignored_with_one_notice():
    design = read(drawing(lambda m: m.add_line((0, 0, 5), (9, 0, 25))))
    assert are_reported(design.notices, "dxf-not-flat 5 25")
    assert read(drawing(lambda m: m.add_line((0, 0, 5), (9, 0, 5)))).notices == ()


# Files ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", ["R12", "R2000", "R2004", "R2007", "R2010", "R2013", "R2018"])
@pytest.mark.parametrize("binary", [False, True])
def test_every_version_is_read_as_text_and_binary(version, binary):
    document = drawing(None, 4, version)
    document.layers.add("Größe", color=1)
    document.modelspace().add_circle((10, 20), 30, {"layer": "Größe"})
    element = only(document, binary=binary, units="mm")
    assert apart(element.subpaths[0], circle((10, 20), 30)) < 2e-4
    assert (element.layer, element.colour) == ("Größe", "#ff0000")


def test_a_dxf_file_becomes_strokes(tmp_path):
    def draw(msp):
        msp.add_lwpolyline([(0, 0, 1, 3), (30, 0, 3, 1), (30, 40, 0, 0)], format="xyse")
        msp.add_circle((50, 50), 20, {"lineweight": 200})

    (tmp_path / "a.DXF").write_bytes(encoded(drawing(draw)))
    design = read_drawing(tmp_path / "a.DXF", ReadOptions(sheet_mm=SHEET))
    made, notices = strokes(design)
    assert notices == []
    assert [stroke.id.split("-")[0] for stroke in made] == ["LWPOLYLINE", "CIRCLE"]
    assert np.array(made[0].half_width) == pytest.approx(np.array([(0, 0.5), (3 / 7, 1.5), (1, 0.5)]))
    assert made[1].half_width == ((0.0, 1.0),)
    assert read_dxf(encoded(drawing(draw))).sheet_mm == read_drawing(tmp_path / "a.DXF").sheet_mm


@pytest.mark.slow
def test_ezdxf_is_loaded_only_for_dxf_and_writes_no_files_to_the_home_folder(tmp_path):
    (tmp_path / "a.dxf").write_bytes(encoded(drawing(lambda m: m.add_line((0, 0), (9, 9)))))
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="9mm" height="9mm"><path stroke="red" d="M1 1h5"/></svg>'
    )
    script = (
        "import sys, brushsvg.read as i; i.read_drawing('a.svg'); assert 'ezdxf' not in sys.modules; "
        "i.read_drawing('a.dxf'); import ezdxf, os; assert os.environ['HOME'] == os.getcwd(); "
        "assert 'XDG_CACHE_HOME' not in os.environ"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, env={"HOME": str(tmp_path)}, capture_output=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.dxf", "a.svg"]
    assert ".dxf" in READERS
