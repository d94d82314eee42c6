"""Damaged or hostile DXF files end in a drawing or in one sentence."""

import logging
import random
from dataclasses import replace

import numpy as np
import pytest
from diagnostics import agrees, gives, refused
from dxf_text import SHEET, apart, bulged, drawing, encoded, read, text_dxf

import brushsvg
from brushsvg.errors import Error
from brushsvg.notice_summary import summarize_notices
from brushsvg.read import ReadOptions, read_drawing
from brushsvg.read.design import Design
from brushsvg.read.dxf import entity_walk, read_dxf, splines
from brushsvg.read.layout import Layout, arrange, bounds_mm
from brushsvg.strokes.extraction import strokes

OPTIONS = ReadOptions(sheet_mm=SHEET, units="mm")


@pytest.fixture(autouse=True)
def _nothing_logged():
    """Switch logging off.

    ezdxf logs the contents of damaged files, including incomplete characters, which pytest-xdist cannot pass
    on.
    """
    logging.disable()
    yield
    logging.disable(logging.NOTSET)


LINE = "0 LINE 8 0 10 0 20 0 11 5 21 5"


def refusal(data):
    with pytest.raises(Error) as caught:
        read_dxf(data, OPTIONS)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400
    return caught.value


def some_drawing():
    document = drawing()
    msp = document.modelspace()
    document.blocks.new("b").add_lwpolyline([(0, 0, 1, 2, 0.3), (9, 3, 2, 0, 0)], format="xyseb")
    msp.add_blockref("b", (5, 5), {"column_count": 2, "column_spacing": 9})
    msp.add_spline([(0, 0), (3, 3), (5, 1)])
    msp.add_ellipse((0, 0), (9, 3), 0.5)
    msp.add_hatch().paths.add_polyline_path([(0, 0), (5, 0), (5, 5)])
    msp.add_linear_dim((0, 30), (0, 0), (50, 0)).render()
    return document


def test_sections_may_be_missing():
    (element,) = read_dxf(text_dxf(LINE), OPTIONS).elements
    assert element.subpaths[0].cubics[-1, 3].tolist() == [5, 5]
    assert read_dxf(text_dxf(LINE).replace(b"\n", b"\r\n") + b"\x1a", OPTIONS).notices == ()


# Minimal exporters write no markers, and the properties in any order.
BARE = {
    "LWPOLYLINE": "90 3 70 1 43 2.5 10 0 20 0 62 1 10 50 20 0 42 1 10 50 20 50 8 L",
    "SPLINE": "8 L 70 8 71 3 72 8 73 4 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 10 0 20 0 10 10 20 0 10 10 20 10 "
    "10 20 20 10 62 1",
    "HATCH": "8 L 62 1 10 0 20 0 30 0 210 0 220 0 230 1 2 SOLID 70 1 71 0 91 1 92 2 72 0 73 1 93 3 10 0 20 0 10 5 20 0 "
    "10 5 20 5 97 0 75 0 76 1 98 0",
    "MTEXT": "8 L 62 1 10 0 20 0 40 5 71 1 1 Hello",
}  # fmt: skip
HEADERS = {
    "none": "",
    "no version": "0 SECTION 2 HEADER 9 $INSBASE 10 0 20 0 30 0 0 ENDSEC",
    "R12": "0 SECTION 2 HEADER 9 $ACADVER 1 AC1009 9 $EXTMIN 10 0 20 0 30 0 0 ENDSEC",
    "R2000": "0 SECTION 2 HEADER 9 $ACADVER 1 AC1015 0 ENDSEC",
}


@pytest.mark.parametrize("header", HEADERS)
@pytest.mark.parametrize("kind", BARE)
@pytest.mark.parametrize("markers", ["", "100 AcDbEntity", "100 AcDbPolyline", "5 2F 330 1F"])
def test_newer_entities_are_read_without_header_and_markers(header, kind, markers):
    data = text_dxf(LINE, f"0 {kind} {markers} {BARE[kind]}", "0 CIRCLE 8 0 10 0 20 0 40 5", header=HEADERS[header])
    design = read_dxf(data, OPTIONS)
    first, *found, last = design.elements
    assert (first.id, last.id[:6]) == ("LINE-1", "CIRCLE")
    if kind == "MTEXT":
        return  # its text needs a font, which may be missing
    assert design.notices == ()
    (element,) = found
    assert (element.layer, element.colour) == ("L", "#ff0000")
    assert element.id.startswith(f"{kind}-")
    ((subpath,), width) = (element.subpaths, element.stroke_width_mm)
    if kind == "LWPOLYLINE":
        assert (subpath.closed, width) == (True, 2.5)
        assert apart(subpath, bulged([(0, 0, 0), (50, 0, 1), (50, 50, 0)], closed=True)) < 2e-4
    elif kind == "SPLINE":
        assert subpath.cubics.tolist() == [[[0, 0], [10, 0], [10, 10], [20, 10]]]
    else:
        assert (element.fill_rule, subpath.cubics[:, 0].tolist()) == ("evenodd", [[0, 0], [5, 0], [5, 5]])
    with refused("unit-unknown"):
        read_dxf(data, ReadOptions())


def test_r12_blocks_layers_and_handles_are_kept_with_newer_entities():
    document = drawing(version="R12")
    document.layers.add("Off").off()
    block = document.blocks.new("b")
    block.add_polyline2d([(0, 0), (9, 0), (9, 9)])
    msp = document.modelspace()
    msp.add_blockref("b", (30, 0), {"xscale": -1})
    msp.add_line((0, 0), (9, 9), {"layer": "Off"})
    msp.add_linear_dim((0, 30), (0, 0), (50, 0)).render()
    document.paperspace().add_viewport((0, 0), (9, 9), (0, 0), 9)
    document.paperspace().add_line((0, 0), (9, 9))
    plain = encoded(document)
    end = plain.rindex(b"  0\nENDSEC")
    bare = f"0 LWPOLYLINE {BARE['LWPOLYLINE']}".replace(" ", "\n").encode() + b"\n"
    before, after = (read_dxf(data, OPTIONS) for data in (plain, plain[:end] + bare + plain[end:]))
    assert [e.id for e in after.elements[:-1]] == [e.id for e in before.elements]
    assert after.elements[-1].id.startswith("LWPOLYLINE")
    assert after.notices == before.notices


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"", "dxf-damaged"),
        (b"<svg/>", "dxf-damaged"),
        (b"AC1032\0\0\0\0", "dxf-damaged DWG"),
        (bytes(range(256)) + b"ENTITIES\n0\nEOF\n", "dxf-damaged Invalid"),
        (
            b"AutoCAD Binary DXF\r\n\x1a\x00" + bytes(range(256)) + b"ENTITIES",
            "dxf-damaged",
        ),
    ],
)
def test_a_file_that_is_not_dxf_is_refused(data, expected):
    assert agrees(refusal(data), expected)


def test_a_truncated_file_is_read_up_to_its_end():
    whole = encoded(drawing(lambda m: [m.add_circle((0, 0), 9), m.add_line((0, 0), (9, 9))]))
    start = whole.rindex(b"AcDbLine")
    for cut in range(start - 20, start + 40):
        design = read_dxf(whole[:cut], OPTIONS)
        assert [element.id.split("-")[0] for element in design.elements] == ["CIRCLE"]
        notice = design.notices[0]
        assert (notice.where, notice.code, notice.damaged) == ("file", "dxf-repaired", True)


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.slow
def test_any_damage_gives_a_drawing_or_a_refusal(binary):
    """Any damage ends in a drawing or in one sentence.

    The file is cut anywhere, bytes are changed, or lines are removed or doubled.
    """
    whole, rng = encoded(some_drawing(), binary), random.Random(7)
    lines = whole.split(b"\n")
    for _ in range(60):
        data = bytearray(whole)
        kind = rng.randrange(4)
        if kind == 0:
            data = data[: rng.randrange(len(data))]
        elif kind == 1:
            for _ in range(rng.randint(1, 30)):
                data[rng.randrange(len(data))] = rng.choice(b"0123456789-.eE \n\0\xff")
        else:
            k = rng.randrange(len(lines))
            data = b"\n".join(lines[:k] + lines[k : k + 1] * (kind - 2) * 2 + lines[k + 1 :])
        try:
            design = read_dxf(bytes(data), OPTIONS)
        except Error as error:
            assert str(error).isprintable()
            continue
        assert isinstance(design, Design)
        assert all(np.isfinite(s.cubics).all() for element in design.elements for s in element.subpaths)
        strokes(design)


@pytest.mark.parametrize(
    ("entity", "expected"),
    [
        (LINE.replace("11 5", "11 nan"), "geometry-out-of-range 1e6"),
        (LINE.replace("11 5", "11 1e400"), "geometry-out-of-range 1e6"),
        (LINE.replace("11 5", "11 1000001"), "geometry-out-of-range 1e6"),
        ("0 CIRCLE 8 0 10 0 20 0 40 1e300", "geometry-out-of-range 1e6"),
        (
            "0 POLYLINE 8 0 66 1 0 VERTEX 8 0 10 0 20 0 40 -1 41 2 0 VERTEX 8 0 10 9 20 0 0 SEQEND",
            "geometry-out-of-range",
        ),
        ("0 INSERT 8 0 2 nowhere 10 0 20 0", "dxf-block nowhere"),
    ],
)  # fmt: skip
def test_damaged_geometry_is_left_out_and_the_rest_is_read(entity, expected):
    design = read_dxf(text_dxf(entity, "0 CIRCLE 8 0 10 0 20 0 40 5"), OPTIONS)
    assert len(design.elements) == 1
    damaged = [notice for notice in design.notices if notice.damaged]
    assert len(damaged) == 1
    assert agrees(damaged[0], expected), damaged
    assert damaged[0].layer == "0"
    assert refusal(text_dxf(entity)).code == "nothing-to-paint"


@pytest.mark.parametrize(
    ("degree", "knots", "weights", "count", "expected"),
    [
        (3, [0, 1], [], 4, "geometry-damaged 2 4 3"),
        (9, [], [], 2, "geometry-damaged 2 9"),
        (99, [], [], 2, "geometry-damaged 99 1 32"),
        (1, [0, 1, 2, 3], [1, -1], 2, "geometry-damaged weight 0"),
        (1, [3, 2, 1, 0], [], 2, "geometry-damaged ascend"),
        (1, [3, 3, 3, 3], [], 2, "geometry-damaged coincide"),
    ],
)
def test_broken_splines_are_left_out(degree, knots, weights, count, expected):
    def draw(msp):
        spline = msp.add_spline(degree=degree)
        spline.knots, spline.weights = knots, weights
        spline.control_points = [(k, k % 2, 0) for k in range(count)]
        msp.add_circle((0, 0), 5)

    design = read(drawing(draw))
    assert [element.id[:6] for element in design.elements] == ["CIRCLE"]
    (notice,) = design.notices
    assert notice.damaged
    assert agrees(notice, expected)


def test_splines_that_are_too_complex_are_left_out(monkeypatch):
    monkeypatch.setattr(splines, "_MAX_PIECES", 5000)

    def draw(msp):
        msp.add_spline([(k, k % 3) for k in range(4000)])
        rough = msp.add_spline(degree=5)
        rough.control_points = [(k * 300, k % 3 * 1e5, 0) for k in range(3000)]
        rough.knots = list(range(3006))
        msp.add_circle((0, 0), 5)

    design = read(drawing(draw))
    assert [element.id[:6] for element in design.elements] == ["CIRCLE"]
    assert agrees(design.notices[0], "geometry-damaged 4000") and agrees(design.notices[1], "geometry-damaged 5000")


def test_entities_without_size_are_left_out():
    placed = "0 CIRCLE 8 0 10 0 20 0 40 0"
    assert agrees(refusal(text_dxf(placed)), "nothing-to-paint CIRCLE-1")
    for draw in (lambda m: m.add_line((3, 4), (3, 4)), lambda m: m.add_lwpolyline([(3, 4)], close=True)):
        (element,) = read(drawing(draw)).elements
        assert element.subpaths[0].cubics.tolist() == [[[3, 4]] * 4]
        assert not element.subpaths[0].closed


# Blocks made to break -------------------------------------------------------------------------------


def chain(count, *others):
    """Return a drawing in which each block inserts the next block twice.

    The two inserts have one name, or alternate between the names of several chains.
    """
    document = drawing()
    kinds = ("A", *others)
    for k in range(count):
        for kind in kinds:
            document.blocks.new(f"{kind}{k}")
    for k in range(count - 1):
        for kind in kinds:
            for place in range(2):
                document.blocks.get(f"{kind}{k}").add_blockref(f"{kinds[place % len(kinds)]}{k + 1}", (place, 0))
    document.modelspace().add_blockref("A0", (0, 0))
    return document


@pytest.mark.parametrize("others", [(), ("B",)])
def test_chains_of_blocks_that_double_are_refused(others, monkeypatch):
    monkeypatch.setattr(entity_walk, "_MAX_ENTITIES", 2000)
    with refused("drawing-too-large 2000 entities"):
        read(chain(41, *others))


def test_blocks_that_contain_themselves_are_refused():
    document = drawing()
    for name, other in (("A", "B"), ("B", "a")):
        document.blocks.new(name).add_line((0, 0), (1, 1))
        document.blocks.get(name).add_blockref(other, (1, 1))
    document.modelspace().add_blockref("A", (0, 0))
    with refused("dxf-block a"):
        read(document)


@pytest.mark.slow
def test_deep_blocks_and_wide_arrays_are_refused():
    document = drawing()
    for k in range(1100):  # deeper than Python's own stack
        block = document.blocks.new(f"B{k}")
        if k:
            block.add_blockref(f"B{k - 1}", (0, 0))
    insert = document.modelspace().add_blockref("B1099", (0, 0))
    with refused("drawing-too-large 50"):
        read(document)
    insert.dxf.name = "B0"
    insert.dxf.update({"row_count": 400, "column_count": 32767, "row_spacing": 1, "column_spacing": 1})
    with refused("drawing-too-large 400 32767 100000"):
        read(document)
    insert.dxf.column_spacing = 0  # All columns are at one place and count as one.
    document.blocks.get("B0").add_point((0, 0))
    assert len(read(document).elements) == 400


def test_heavy_blocks_are_refused():
    document = drawing()
    document.blocks.new("heavy").add_lwpolyline([(k, k % 7) for k in range(5000)])
    array = {"row_count": 20, "column_count": 20, "row_spacing": 1, "column_spacing": 1}
    document.modelspace().add_blockref("heavy", (0, 0), array)
    with refused("drawing-too-large 1000000"):
        read(document)


@pytest.mark.parametrize("value", ["x", "1.#QNAN", "1,5", "--3"])
def test_only_an_entity_with_a_bad_number_is_left_out(value):
    bad = LINE.replace("11 5", f"11 {value}")
    design = read_dxf(text_dxf(LINE, bad, "0 CIRCLE 8 0 10 0 20 0 40 5"), OPTIONS)
    assert [element.id[:6] for element in design.elements] == ["LINE-1", "CIRCLE"]
    (notice,) = design.notices
    assert (notice.where, notice.damaged) == ("LINE-2", True)
    assert agrees(notice, f"dxf-repaired '{value}' 11")


def test_a_polyline_with_one_bad_vertex_is_left_out():
    vertices = "0 VERTEX 8 0 10 0 20 0 0 VERTEX 8 0 10 9 20 y 0 VERTEX 8 0 10 9 20 9 0 SEQEND"
    design = read_dxf(text_dxf(f"0 POLYLINE 8 0 5 2F 66 1 {vertices}", LINE), OPTIONS)
    assert [element.id[:4] for element in design.elements] == ["LINE"]
    assert [notice.where for notice in design.notices] == ["POLYLINE-2F"]


def test_only_an_entity_with_missing_data_is_left_out():
    design = read_dxf(text_dxf(LINE, "0 HATCH 8 0 10 0 20 0"), OPTIONS)
    assert len(design.elements) == 1
    assert [(notice.where, notice.damaged) for notice in design.notices] == [("HATCH-2", True)]


@pytest.mark.parametrize("header", HEADERS)
@pytest.mark.parametrize("markers", ["", "100 AcDbEntity"])
@pytest.mark.parametrize("kind", ["IMAGE", "3DSOLID", "MESH", "WIPEOUT", "ACAD_TABLE", "LAYER", "WHATEVER"])
def test_unsupported_entities_are_counted_for_any_author(header, markers, kind):
    entity = f"0 {kind} {markers} 8 0 10 0 20 0 30 0 40 3"
    design = read_dxf(text_dxf(LINE, entity, entity, header=HEADERS[header]), OPTIONS)
    assert len(design.elements) == 1
    (notice,) = design.notices
    assert (notice.where, notice.damaged) == (kind, False)
    assert agrees(notice, f"dxf-entity-unread {kind} 2") and ("covers" in notice.sentence) == (kind == "WIPEOUT")


def test_a_helix_is_read_only_with_markers():
    knots = "40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 10 0 20 0 30 0 10 10 20 0 30 0 10 10 20 10 30 0 10 20 20 10 30 0"
    spline, axis = (
        f"70 8 71 3 72 8 73 4 {knots}",
        "90 29 91 63 10 0 20 0 30 0 11 1 21 0 31 0 12 0 22 0 32 1 40 1",
    )
    marked = f"0 HELIX 100 AcDbEntity 8 0 100 AcDbSpline {spline} 100 AcDbHelix {axis}"
    bare = f"0 HELIX 8 0 {spline} {axis}"
    design = read_dxf(text_dxf(marked, bare), OPTIONS)
    assert [element.subpaths[0].cubics[-1, 3].tolist() for element in design.elements] == [[20, 10]]
    (notice,) = design.notices
    assert agrees(notice, "dxf-entity-unread HELIX 1")


def test_map_coordinates_are_moved_to_the_sheet_and_distant_lines_left_out():
    def line(x, y):
        return f"0 LINE 8 0 10 {x} 20 {y} 11 {x + 5} 21 {y + 50}"

    anywhere = ReadOptions(units="mm")
    design = read_dxf(text_dxf(line(5e9, 4e9), line(5e9 + 30, 4e9), line(0, 0)), anywhere)
    assert [(notice.where, notice.damaged) for notice in design.notices] == [("LINE-3", True)]
    assert agrees(design.notices[0], "geometry-out-of-range 1e6")
    assert design.sheet_mm == pytest.approx((75.25, 90.25), abs=1e-5)
    assert design.elements[1].subpaths[0].cubics[0, 0].tolist() == pytest.approx([50.125, 20.125], abs=1e-5)
    near = read_dxf(text_dxf(line(0, 0), line(30, 0), line(5e9, 4e9)), anywhere)
    assert [notice.where for notice in near.notices] == ["LINE-3"]
    assert near.sheet_mm == pytest.approx((75.25, 90.25))
    for far in (line(5e9, 4e9), line(5e12, 0)):  # OPTIONS sets a sheet.
        assert agrees(refusal(text_dxf(far)), "nothing-to-paint LINE-1 1e6")
    with refused("nothing-to-paint 1e6"):
        read_dxf(text_dxf("0 LINE 8 0 10 5e9 20 0 11 5.01e9 21 0"), anywhere)


@pytest.mark.parametrize("placed", [{"fit_mm": (20, 100)}, {"origin_mm": (30, 40)}])
def test_map_coordinates_are_placed_on_a_requested_sheet(tmp_path, placed):
    """Without a place on the sheet, the refusal advises to give one. A place was once refused as well."""
    (tmp_path / "far.dxf").write_bytes(text_dxf("0 LINE 8 0 10 35e5 20 54e5 11 3500005 21 5400050"))
    job = {"sheet": SHEET, "units": "mm", "width": 2}
    with refused("nothing-to-paint LINE-1 1e6 --fit --origin"):
        brushsvg.convert(tmp_path / "far.dxf", tmp_path / "far.ngc", **job)
    place = {name.removesuffix("_mm"): value for name, value in placed.items()}
    brushsvg.convert(tmp_path / "far.dxf", tmp_path / "far.ngc", **job, **place)
    arranged = arrange(
        read_drawing(tmp_path / "far.dxf", replace(OPTIONS, is_placed_later=True)), Layout(width_mm=2.0, **placed)
    )
    box = bounds_mm(arranged.elements)
    if "origin_mm" in placed:
        assert box == pytest.approx((30, 40, 37, 92))
    else:
        assert box[2:] + box[:2] == pytest.approx(SHEET)


LOOK = "0 LINE 8 0 10 0 20 {y} 11 50 21 {y} "


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("6 NOWHERE", "undefined linetype nowhere"),
        ("62 999", "invalid color index"),
        ("62 -999", "invalid color index"),
        ("370 33", "invalid lineweight"),
        ("210 0 220 0 230 0", "extrusion vector"),
    ],
)
def test_a_repair_is_reported_at_the_painted_element(more, words):
    """A repair is reported at the element that is painted.

    The audit removes entries that it cannot understand. The line then has another width, or is solid instead
    of dashed.
    """
    lines = [LOOK.format(y=y) + more for y in range(5)]
    notices = read_dxf(text_dxf(LOOK.format(y=9), *lines), OPTIONS).notices
    reported = [notice for notice in summarize_notices(notices) if notice.code == "dxf-repaired"]
    assert [words in notice.sentence for notice in reported] == [True], notices
    assert reported[0].where.startswith("LINE(#") and gives(reported[0].where, "4")


def test_invisible_repairs_are_not_reported():
    lines = [LOOK.format(y=y) + "330 FFFF" for y in range(3)]
    assert read_dxf(text_dxf(*lines), OPTIONS).notices == ()
