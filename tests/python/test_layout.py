import numpy as np
import pytest
from diagnostics import agrees, refused
from svg_text import read

from brushsvg.read.layout import AS_DRAWN, Layout, arrange, bounds_mm

BODY = """<g inkscape:groupmode="layer" inkscape:label="Ink"><path id="a" d="M10 10H30V20" stroke-width="4"/>
  <g inkscape:groupmode="layer" inkscape:label="Fine"><path id="b" d="M20 10Q25 0 30 10"/><text id="t">x</text></g></g>
  <path id="c" d="M60 30H80"/>"""


def box(layout, body=BODY):
    return bounds_mm(arrange(read(body), layout).elements).round(9).tolist()


def test_the_default_layout_leaves_the_drawing_unchanged():
    design = read(BODY)
    assert arrange(design, AS_DRAWN) is design


def test_bounds_include_the_curve_and_its_width():
    assert bounds_mm(read('<path d="M20 10Q25 0 30 10"/>').elements).round(9).tolist() == [19.5, 39.5, 30.5, 45.5]
    assert bounds_mm(read('<path d="M0 0C0 20 20 20 20 0"/>').elements, with_widths=False).round(9).tolist() == [
        0,
        35,
        20,
        50,
    ]


def test_layers_can_be_selected():
    def ids(*names):
        return [element.id for element in arrange(read(BODY), Layout(layers=names)).elements]

    assert ids("Ink") == ["a", "b"]
    assert ids("Ink/Fine") == ["b"]
    assert [n.where for n in arrange(read(BODY), Layout(layers=("Ink",))).notices] == ["t"]
    assert ids("Fine") == ids("ink/fine") == ["b"]
    with refused("layer-unknown Inks Ink Ink/Fine"):
        ids("Inks")


def test_one_width_can_be_set_for_all_lines():
    design = arrange(read(BODY), Layout(width_mm=2.5))
    assert {element.stroke_width_mm for element in design.elements} == {2.5}


@pytest.mark.parametrize(
    ("dashes", "layout", "gap_mm"),
    [
        ("6 3", AS_DRAWN, None),
        ("6 2", AS_DRAWN, "2 2"),
        ("6 1", AS_DRAWN, "1 2"),
        ("6 9 6 1", AS_DRAWN, "1 2"),
        ("9 6 1", AS_DRAWN, "1 2"),
        ("6 0", AS_DRAWN, None),
        ("60 1", AS_DRAWN, None),
        ("6 3", Layout(width_mm=3.0), "3 3"),
        ("6 1", Layout(width_mm=0.5), None),
        ("6 3", Layout(scale=2.0, width_mm=3.0), None),
        ("6 1", Layout(scale=2.0), "2 4"),
    ],
)
def test_dashes_that_join_are_reported(dashes, layout, gap_mm):
    """Dashes join if the gaps are not wider than the line, which its final width and size decide."""
    design = arrange(read(f'<path id="p" d="M5 5H45" stroke-width="2" stroke-dasharray="{dashes}"/>'), layout)
    joining = [each for each in design.notices if each.code == "dashes-join"]
    assert len(joining) == (gap_mm is not None)
    assert all(agrees(each, f"dashes-join p {gap_mm}") for each in joining)


SHAPES = "".join(f'<path id="s{k}" fill="red" stroke="none" d="M{9 * k} 5h7v7z"/>' for k in range(5))


def test_filled_shapes_have_no_width():
    """A width for them is reported: once for the option, for each element that asks for one itself."""
    design = arrange(read(BODY + SHAPES), Layout(width_mm=2.5))
    (reported,) = (each for each in design.notices if each.code == "width-without-effect")
    assert agrees(reported, "width-without-effect --width s0 s1 s2") and "s3" not in reported.sentence
    assert {each.id: each.stroke_width_mm for each in design.elements}["c"] == 2.5
    assert not any("width" in each.code for each in arrange(read(BODY), Layout(width_mm=2.5)).notices)
    of_ink = arrange(read(BODY + SHAPES), Layout(width_mm=2.5, layers=("Ink",)))
    assert not any("width" in each.code for each in of_ink.notices)
    both = '<path id="b" fill="red" d="M60 5h7v7z"/><path id="l" d="M70 5h7"/>'
    own = read(f'<g data-brushsvg-width="2">{SHAPES}{both}</g>')
    assert [each.where for each in own.notices] == [f"s{k}" for k in range(5)], "lines have a width"
    assert {each.code for each in own.notices} == {"width-without-effect"}


def test_fit_scales_to_the_size_and_centres_on_the_sheet():
    x0, y0, x1, y1 = box(Layout(fit_mm=(40, 40)))
    assert max(x1 - x0, y1 - y0) == pytest.approx(40)
    assert ((x0 + x1) / 2, (y0 + y1) / 2) == pytest.approx((50, 25))
    x0, y0, x1, y1 = box(Layout(fit_mm=(200, 30), width_mm=3.0))
    assert y1 - y0 == pytest.approx(30)


def test_fit_scales_drawn_widths_but_not_requested_ones():
    drawn = arrange(read('<path d="M0 0H10"/>'), Layout(fit_mm=(22, 90)))
    assert drawn.elements[0].stroke_width_mm == pytest.approx(2)
    kept = arrange(read('<path d="M0 0H10"/>'), Layout(fit_mm=(22, 90), width_mm=2.0))
    assert kept.elements[0].stroke_width_mm == 2
    assert np.ptp(kept.elements[0].subpaths[0].cubics[..., 0]) == pytest.approx(20)


def test_scale_keeps_the_middle_and_origin_sets_the_corner():
    before, after = np.array(box(AS_DRAWN)), np.array(box(Layout(scale=0.5)))
    assert (before[:2] + before[2:]).tolist() == pytest.approx((after[:2] + after[2:]).tolist())
    assert (after[2:] - after[:2]).tolist() == pytest.approx(((before[2:] - before[:2]) / 2).tolist())
    assert box(Layout(origin_mm=(5, 7)))[:2] == [5, 7]
    assert box(Layout(origin_mm=(5, 7), scale=2, width_mm=3))[:2] == [5, 7]


def test_a_drawing_that_cannot_fit_is_refused():
    with refused("drawing-does-not-fit 12 '10 x 10 mm'"):
        box(Layout(fit_mm=(10, 10), width_mm=12.0))
    with refused("drawing-does-not-fit"):
        box(Layout(fit_mm=(10, 10), width_mm=2.0), '<path d="M5 5z"/>')


def test_a_requested_width_drops_notices_about_drawn_widths():
    design = read('<path id="a" transform="scale(1 2)" d="M10 10H50"/><text id="t">A</text>')
    assert [each.code for each in design.notices] == ["stretched-unevenly", "text-unread"]
    arranged = arrange(design, Layout(width_mm=3.0))
    assert [each.code for each in arranged.notices] == ["text-unread"]
