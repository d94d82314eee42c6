"""Layers from Inkscape, Illustrator, CorelDRAW, Affinity and Figma, and --layer."""

import pytest
from diagnostics import agrees, refused
from svg_text import HEAD, read

from brushsvg import Error
from brushsvg.read import ReadOptions
from brushsvg.read.layout import Layout, arrange
from brushsvg.read.svg import read_svg

A, B = '<path id="a" d="M1 1H9"/>', '<path id="b" d="M1 5H9"/>'


def layers(body):
    return {element.id: element.layer for element in read(body).elements}


def why_not(body, name):
    with pytest.raises(Error) as caught:
        arrange(read(body), Layout(layers=(name,)))
    return caught.value


def test_inkscape_layers_override_named_groups():
    marked = 'inkscape:groupmode="layer" inkscape:label="Ink"'
    assert layers(f'<g id="g1">{A}</g><g id="g2"><g {marked}>{B}</g></g>') == {"a": "", "b": "Ink"}


@pytest.mark.parametrize(
    ("group", "name"),
    [
        ('id="Layer_x0020_1"', "Layer 1"),  # CorelDRAW
        ('id="Ink_x20__x26__x20_paper"', "Ink & paper"),  # Illustrator
        ('id="Layer_2" data-name="Fine lines"', "Fine lines"),  # Illustrator's export
        ('id="Layer1" serif:id="Layer 1" xmlns:serif="http://www.serif.com/"', "Layer 1"),  # Affinity
        ('id="figure_1"', "figure_1"),  # matplotlib
        ('id="snake_xyz_case_x1_"', "snake_xyz_case_x1_"),
        ('id="bell_x07_"', "bell_x07_"),
    ],
)
def test_the_outermost_named_groups_are_layers(group, name):
    body = f'<g><g {group}><g id="inner">{A}</g></g></g>{B}'
    assert layers(body) == {"a": name, "b": ""}
    assert [element.id for element in arrange(read(body), Layout(layers=(name,))).elements] == ["a"]


def test_a_group_around_everything_is_a_page_with_layers():
    body = f'<title>t</title><defs/><switch><g id="Page"><g id="One">{A}</g><g id="Two">{B}</g></g></switch>'
    assert layers(body) == {"a": "Page/One", "b": "Page/Two"}
    assert layers(f'<g id="Page"><g id="One">{A}</g>{B}</g>') == {"a": "Page/One", "b": "Page"}
    assert layers(f'<rect id="board" width="9" height="9"/><g id="Top"><g id="One">{A}</g></g>')["a"] == "Top"


def test_a_layer_prefix_before_a_slash_selects_all_its_layers():
    body = f'<g id="Icon/one">{A}</g><g id="Icon/two">{B}</g>'
    assert [element.id for element in arrange(read(body), Layout(layers=("Icon",))).elements] == ["a", "b"]


def test_a_layer_is_found_by_its_unique_ending_ignoring_case():
    body = f'<g id="Page"><g id="Ink_one"><g id="Fine">{A}</g></g><g id="Two">{B}</g></g>'
    for name in ("Page/Ink_one", "Ink_one", "ink one", "page/ink one"):
        assert [element.id for element in arrange(read(body), Layout(layers=(name,))).elements] == ["a"]
    marked = 'inkscape:groupmode="layer" inkscape:label'
    body = f'<g {marked}="X"><g {marked}="Fine">{A}</g></g><g {marked}="Y"><g {marked}="Fine">{B}</g></g>'
    assert agrees(why_not(body, "Fine"), "layer-ambiguous Fine 2 X/Fine Y/Fine")
    assert [element.id for element in arrange(read(body), Layout(layers=("Y/Fine",))).elements] == ["b"]


def test_a_layer_that_is_not_painted_is_reported_with_the_reason():
    marked = 'inkscape:groupmode="layer" inkscape:label'
    body = (
        f'{A}<g {marked}="Off" style="display:none">{B}<g {marked}="In">{B}</g></g><g {marked}="Faint" '
        f'visibility="hidden">{B}</g><g {marked}="Bad"><path id="c" d="x"/></g><g {marked}="Empty"/>'
    )
    for name in ("Off", "Off/In", "In", "Faint"):
        assert agrees(why_not(body, name), f"nothing-to-paint {name} hidden")
    assert agrees(why_not(body, "Bad"), "nothing-to-paint Bad 'c: d' 1")
    empty = why_not(body, "Empty")
    assert agrees(empty, "nothing-to-paint Empty") and ": " not in empty.sentence, "and no reason"
    assert agrees(why_not(body, "New"), "layer-unknown New Off Off/In Faint Bad Empty")


def test_long_layer_lists_are_shortened():
    depth = 3000
    body = '<g inkscape:groupmode="layer" inkscape:label="layer">' * depth + A + "</g>" * depth
    (element,) = read(body).elements
    assert len(element.layer) == 599


def test_a_refusal_for_nothing_to_paint_names_every_reason():
    body = (
        '<text id="t">x</text><text>y</text><g display="none"/><path d="M0 0H1" data-brushsvg-skip="yes"/>'
        '<image/><path id="p" d="M0 0"/>'
    )
    with refused("nothing-to-paint 't and 1 like it: text' --export-text-to-path 'image 1: ' 'p: ' 2"):
        read(body)
    with refused("nothing-to-paint 2 hidden"):
        read('<g display="none"/><path d="M0 0H1" visibility="hidden"/>')


def test_lengths_in_em_and_ex_follow_the_font_size():
    px = 25.4 / 96
    svg = HEAD.replace('width="100mm" height="50mm" viewBox="0 0 100 50"', 'width="400" height="200"')
    body = (
        '<g font-size="10"><path id="a" d="M0 0H5" stroke-width=".2em"/><g font-size="150%" stroke-width=".4ex">'
        '<path d="M0 0H9"/><line style="font-size:2em" x2="1em" y2="1rem"/></g></g>'
    )
    one, two, three = read_svg(f"{svg}{body}</svg>".encode(), ReadOptions()).elements
    assert [e.stroke_width_mm / px for e in (one, two, three)] == pytest.approx([2, 3, 3])
    assert (three.subpaths[0].cubics[0, 3] / px).tolist() == pytest.approx([30, 200 - 16])
