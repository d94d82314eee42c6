"""DXF line types become dashes.

Dashes and block clips that cannot be applied are reported.
"""

import numpy as np
import pytest
from diagnostics import agrees, are_reported, refused
from dxf_text import circle, drawing, encoded, only, read

from brushsvg.read import ReadOptions
from brushsvg.read.dxf import linetypes, read_dxf
from brushsvg.read.dxf.ezdxf_import import ezdxf

PATTERNS = {
    "DASHED": [15.0, 10.0, -5.0],
    "DOTTED": [5.0, 0.0, -5.0],
    "GAP FIRST": [15.0, -5.0, 10.0],
    "DASH LAST": [20.0, 4.0, -5.0, 5.0, -5.0, 1.0],
    "TWO GAPS": [15.0, 10.0, -2.0, -3.0],
    "PLAIN": [10.0, 4.0, 6.0],
    "ENDLESS": [15.0, float("inf"), -5.0],
    "ONLY GAPS": [15.0, -10.0, -5.0],
    "TINY": [2e-6, 1e-6, -1e-6],
}


def typed(draw=None, units=4):
    document = drawing(None, units)
    for name, pattern in PATTERNS.items():
        document.linetypes.add(name, pattern)
    document.linetypes.add("GAS", 'A,.5,-.2,["GAS",STANDARD,S=.1,U=0.0,X=-0.1,Y=-.05],-.25', length=1)
    if draw is not None:
        draw(document.modelspace())
    return document


def spans(element):
    """Return where each dash of a line along x begins and ends."""
    return [(round(s.cubics[0, 0, 0], 9), round(s.cubics[-1, 3, 0], 9)) for s in element.subpaths]


@pytest.mark.parametrize(
    ("name", "dashes"),
    [
        ("DASHED", [(0, 10), (15, 25), (30, 32)]),
        ("dashed", [(0, 10), (15, 25), (30, 32)]),
        ("DOTTED", [(x, x) for x in range(0, 32, 5)]),
        ("GAP FIRST", [(0, 10), (15, 25), (30, 32)]),
        ("DASH LAST", [(0, 5), (10, 15), (20, 25), (30, 32)]),
        ("TWO GAPS", [(0, 10), (15, 25), (30, 32)]),
    ],
)
def test_each_dash_is_a_stroke(name, dashes):
    design = read(typed(lambda m: m.add_line((0, 0), (32, 0), {"linetype": name, "lineweight": 50})))
    (element,) = design.elements
    assert spans(element) == dashes
    assert (element.stroke_width_mm, element.dash_gap_mm) == (0.5, pytest.approx(5))
    assert are_reported(design.notices, f"dashed {element.id} {len(dashes)}") and design.notices[0].layer == "0"


def test_patterns_scale_with_the_drawing_the_entity_and_the_unit_but_not_with_blocks():
    document = typed(units=5)
    document.header["$LTSCALE"] = 2.0
    document.layers.add("L", linetype="DASHED")
    block = document.blocks.new("b")
    block.add_line((0, 0), (3, 0), {"ltscale": 0.1, "layer": "L"})
    document.modelspace().add_blockref("b", (0, 0), {"xscale": 2})
    (element,) = read(document).elements
    # The dashes are 10 and 5 cm, times 2, times 0.1; the line is 60 mm long.
    assert spans(element) == [(0, 20), (30, 50)]


def test_line_types_come_from_layers_and_blocks():
    document = typed()
    document.layers.add("L", linetype="DASHED")
    block = document.blocks.new("b")
    for line_type in ("BYLAYER", "BYBLOCK", "Continuous", "DASHED"):
        block.add_line((0, 0), (30.5, 0), {"linetype": line_type})
        block.add_point((0, 0))
    document.modelspace().add_blockref("b", (0, 0), {"layer": "L", "linetype": "DOTTED"})
    document.modelspace().add_blockref("b", (0, 0), {"linetype": "DOTTED"})
    counts = [len(e.subpaths) for e in read(document).elements if "LINE" in e.id]
    assert counts == [3, 7, 1, 3, 1, 7, 1, 3]


def test_a_line_in_parts_is_dashed_as_one_line():
    def draw(msp):
        msp.add_line((0, 0), (8, 0), {"linetype": "DASHED"})
        msp.add_line((8, 0), (32, 0), {"linetype": "DASHED"})
        msp.add_line((32, 0), (40, 0), {"linetype": "DASHED", "ltscale": 0.6})

    first, last = read(typed(draw)).elements
    assert spans(first) == [(0, 10), (15, 25), (30, 32)]
    assert spans(last) == [(32, 40)]  # shorter than its pattern, so it is not dashed


def test_dashes_follow_a_curve():
    (element,) = read(typed(lambda m: m.add_circle((0, 0), 20, {"linetype": "DASHED"}))).elements
    true = circle((0, 0), 20)
    assert len(element.subpaths) == 8  # the ninth, 5.7 mm long, is joined to the first
    for k, subpath in enumerate(element.subpaths):
        ends = subpath.cubics[[0, -1], [0, 3]]
        at = np.mod(np.arctan2(ends[:, 1], ends[:, 0]), 2 * np.pi) * 20
        expected = (120 % (2 * np.pi * 20), 10) if k == 0 else (15 * k, 15 * k + 10)
        assert at == pytest.approx(expected, abs=1e-3)
        assert np.abs(np.hypot(*ends.T) - np.hypot(*true[0])).max() < 1e-3


@pytest.mark.parametrize("name", ["GAS", "ENDLESS", "ONLY GAPS"])
def test_unsupported_line_types_are_drawn_unbroken(name):
    def draw(msp):
        for y in (0, 9):
            msp.add_line((0, y), (32, y), {"linetype": name})

    design = read(typed(draw))
    assert [len(element.subpaths) for element in design.elements] == [1, 1]
    (notice,) = design.notices
    assert agrees(notice, "dashes-unread", name) and notice.layer is None


@pytest.mark.parametrize(("drawing_scale", "scale"), [(-1.0, 1.0), (0.0, 1.0), (1.0, float("nan")), (1e308, 1e308)])
def test_invalid_line_type_scales_are_ignored(drawing_scale, scale):
    document = typed(lambda m: m.add_line((0, 0), (32, 0), {"linetype": "DASHED", "ltscale": 0.5}))
    document.header["$LTSCALE"] = drawing_scale
    data = encoded(document).replace(b"\n 48\n0.5\n", f"\n 48\n{scale}\n".encode())
    design = read_dxf(data, ReadOptions(sheet_mm=(100.0, 100.0)))
    assert len(design.elements[0].subpaths) == 1
    (notice,) = design.notices
    assert agrees(notice, "dashes-unread", "DASHED") and notice.layer is None


def test_unbroken_and_filled_shapes_have_no_dashes():
    assert len(only(typed(lambda m: m.add_line((0, 0), (99, 0), {"linetype": "PLAIN"}))).subpaths) == 1
    for name in ("DASHED", "GAS"):
        assert len(only(typed(lambda m, name=name: m.add_point((0, 0), {"linetype": name}))).subpaths) == 1
    solid = [(0, 0), (99, 0), (0, 99)]
    assert len(only(typed(lambda m: m.add_solid(solid, {"linetype": "DASHED"}))).subpaths) == 1


def test_lines_of_changing_width_are_not_dashed():
    rows = [(0, 0, 1, 3), (99, 0, 0, 0)]
    design = read(typed(lambda m: m.add_lwpolyline(rows, format="xyse", dxfattribs={"linetype": "DASHED"})))
    assert len(design.elements[0].subpaths) == 1
    assert are_reported(design.notices, "dashes-unread")


def test_too_many_dashes_are_refused(monkeypatch):
    monkeypatch.setattr(linetypes, "_MAX_DASHES", 1000)

    def draw(msp):
        for k in range(2):
            msp.add_line((0, k), (0.0012, k), {"linetype": "TINY"})

    with refused("drawing-too-large 2e-06 600 400") as caught:
        read(typed(draw))
    assert caught.value.where.startswith("LINE-")


def test_clipped_blocks_are_reported():
    document = drawing()
    document.blocks.new("b").add_line((0, 0), (99, 0))
    for clipped in (True, False):
        insert = document.modelspace().add_blockref("b", (0, 0))
        clip = ezdxf.xclip.XClip(insert)
        clip.set_block_clipping_path([(0, -5), (20, 5)])
        if not clipped:
            clip.disable_clipping()
    design = read(document)
    assert [spans(element) for element in design.elements] == [[(0, 99)]] * 2
    (notice,) = design.notices
    assert agrees(notice, "clipping-unread XCLIP", design.elements[0].id.split("/")[0]) and notice.layer == "0"


def corners(element):
    """Return the points at which each dash begins, turns and ends."""
    return [
        [tuple(float(round(x, 6)) + 0.0 for x in point) for point in (*s.cubics[:, 0], s.cubics[-1, 3])]
        for s in element.subpaths
    ]


SIDES = [(0, 0), (32, 0), (32, 32)]
TURNING = [
    [(0, 0), (10, 0)],
    [(15, 0), (25, 0)],
    [(30, 0), (32, 0), (32, 10)],
    [(32, 15), (32, 25)],
    [(32, 30), (32, 32)],
]


@pytest.mark.parametrize("kind", ["add_lwpolyline", "add_polyline2d"])
def test_dashes_restart_at_corners_unless_the_polyline_is_continuous(kind):
    def draw(flags, close=False):
        look = {"linetype": "DASHED", "flags": flags}
        return lambda m: getattr(m, kind)(SIDES, close=close, dxfattribs=look)

    (anew,) = read(typed(draw(0))).elements
    assert corners(anew) == TURNING
    (on,) = read(typed(draw(128))).elements
    assert [ends[0] for ends in corners(on)] == [(0, 0), (15, 0), (30, 0), (32, 13), (32, 28)]
    assert corners(on)[2] == [(30, 0), (32, 0), (32, 8)]
    (ring,) = read(typed(draw(0, close=True))).elements  # its closing side is 45.25 mm long
    assert corners(ring)[4] == [(32, 30), (32, 32), (pytest.approx(32 - 50**0.5, abs=1e-5),) * 2]
    assert corners(ring)[0][-2:] == [(0, 0), (10, 0)] and len(corners(ring)) == 7


def test_sides_shorter_than_the_pattern_are_unbroken():
    def draw(points, closed=False):
        return lambda m: m.add_lwpolyline(points, close=closed, dxfattribs={"linetype": "DASHED"})

    (element,) = read(typed(draw([(0, 0), (14, 0), (14, 14), (28, 14), (28, 0), (28, -14)]))).elements
    assert corners(element) == [
        [(0, 0), (14, 0), (14, 14), (28, 14), (28, 0), (28, -14)],
    ]
    (square,) = read(typed(draw([(0, 0), (14, 0), (14, 14), (0, 14)], closed=True))).elements
    assert len(square.subpaths) == 1 and square.subpaths[0].closed
