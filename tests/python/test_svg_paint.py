"""Paints of strokes and fills, alone and together, and the notices about them."""

import pytest
from diagnostics import are_reported, refused
from svg_text import read

from brushsvg import find_brush
from brushsvg.jobs.preparation.thin_outlines import remove_thin_outlines
from brushsvg.read.svg import element, paint_servers
from brushsvg.strokes.extraction import strokes

STOPS = '<stop stop-color="red"/><stop offset="1" stop-color="blue"/>'
TILE = '<path d="M0 1H2"/>'
SERVERS = {
    "a gradient": f'<linearGradient id="s">{STOPS}</linearGradient>',
    "a gradient by reference": f'<linearGradient id="t">{STOPS}</linearGradient><radialGradient id="s" href="#t"/>',
    "a pattern": f'<pattern id="s" width="2" height="2">{TILE}</pattern>',
    "a pattern by reference": f'<pattern id="t">{TILE}</pattern><pattern id="s" xlink:href="#t" width="2" height="2"/>',
    "a mesh": '<defs><meshgradient id="s"/></defs>',
}
NOTHING = {
    "a gradient without stops": '<linearGradient id="s"/>',
    "a gradient of itself": '<linearGradient id="s" href="#s"/>',
    "a gradient of unseen stops": '<linearGradient id="s"><stop stop-opacity="0"/></linearGradient>',
    "an empty pattern": '<pattern id="s" width="2" height="2"/>',
    "a pattern without a size": f'<pattern id="s" width="2">{TILE}</pattern>',
    "no paint": '<defs><rect id="s"/></defs>',
}
BOTH = '<path id="p" d="M0 0H5V5Z" fill="{}" stroke="{}" {}/>'


def painted(fill, stroke, more="", before=""):
    return read(f'<path id="first" d="M0 0H1"/>{before}{BOTH.format(fill, stroke, more)}')


def notices_of(design):
    return list(design.notices)


@pytest.mark.parametrize("server", SERVERS.values(), ids=SERVERS)
def test_an_unsupported_paint_is_named_for_fill_and_stroke(server):
    of = "paint-unread p {} #s #000000".format
    assert are_reported(notices_of(painted("url(#s)", "none", before=server)), of("fill"))
    assert are_reported(notices_of(painted("url(#s)", "red", before=server)), of("fill")), "under a stroke, too"
    assert are_reported(notices_of(painted("red", "url(#s)", before=server)), of("stroke"))
    assert are_reported(notices_of(painted("url(#s)", "url(#s)", before=server)), of("fill"), of("stroke"))


@pytest.mark.parametrize("server", NOTHING.values(), ids=NOTHING)
def test_an_empty_paint_server_paints_nothing(server):
    design = painted("url(#s)", "blue", before=server)
    assert (design.elements[1].fill_rule, design.elements[1].colour, notices_of(design)) == (
        "",
        "#0000ff",
        [],
    )
    assert are_reported(notices_of(painted("url(#s)", "none", before=server)), "neither-stroke-nor-fill p")


@pytest.mark.parametrize(
    "gradient",
    [
        '<linearGradient id="s"><stop stop-color="lime"/></linearGradient>',
        '<linearGradient id="s"><stop style="stop-color:#0f0"/><stop offset="1" stop-color="lime"/></linearGradient>',
        '<linearGradient id="t"><stop stop-color="lime"/></linearGradient><linearGradient id="s" xlink:href="#t"/>',
        '<style>.c{stop-color:lime}</style><linearGradient id="s"><stop class="c"/></linearGradient>',
    ],
)
def test_a_gradient_of_one_colour_is_that_colour(gradient):
    design = painted("url(#s)", "none", before=gradient)
    assert (design.elements[1].colour, notices_of(design)) == ("#00ff00", [])


@pytest.mark.parametrize("colour", ["#ff000033", "#f003", "rgba(255,0,0,.2)", "hsl(0 100% 50% / 20%)"])
def test_a_translucent_colour_is_reported_where_it_paints(colour):
    of = "opacity-unread p {} 0.2 1".format
    assert are_reported(notices_of(painted(colour, "none")), of("fill"))
    assert are_reported(notices_of(painted(colour, "blue")), of("fill"))
    assert are_reported(notices_of(painted("blue", colour)), of("stroke"))
    assert are_reported(notices_of(painted("none", "currentColor", f'color="{colour}"')), of("stroke"))
    gradient = f'<linearGradient id="s"><stop stop-color="{colour}"/></linearGradient>'
    assert are_reported(notices_of(painted("url(#s)", "none", before=gradient)), of("fill"))
    assert painted(colour, "none").elements[1].colour == "#ff0000"


@pytest.mark.parametrize("colour", ["transparent", "#f000", "rgb(1 2 3 / 0)"])
def test_a_fully_transparent_colour_paints_nothing(colour):
    assert painted(colour, "blue").elements[1].fill_rule == ""
    assert painted("blue", colour).elements[1].stroke_width_mm == 0
    assert len(painted("none", "currentColor", f'color="{colour}"').elements) == 1


def test_opacities_are_reported_only_for_painted_parts():
    assert are_reported(notices_of(painted("red", "blue", 'fill-opacity=".5"')), "opacity-unread fill-opacity 1")
    assert notices_of(painted("none", "blue", 'fill-opacity=".5"')) == []
    assert notices_of(painted("red", "blue", 'fill-opacity="2" opacity="101%" stroke-opacity="1.0"')) == []
    assert are_reported(notices_of(painted("red", "blue", 'opacity="x"')), "css-invalid opacity x")
    assert painted("red", "blue", 'fill-opacity="-1" stroke-opacity="100%"').elements[1].fill_rule == ""
    with refused("nothing-to-paint transparent"):
        read(BOTH.format("red", "blue", 'opacity="1e-9"'))


def test_an_invalid_visibility_is_ignored():
    assert len(painted("red", "blue", 'visibility="x"').elements) == 2
    assert len(painted("red", "blue", 'visibility="HIDDEN"').elements) == 1


def test_a_paint_server_is_looked_up_once(monkeypatch):
    """Each paint server is looked up once.

    3,000 shapes with a gradient of 3,000 stops once took twenty seconds.
    """
    requested = []
    monkeypatch.setattr(paint_servers.PaintServers, "_stop", lambda _self, stop: requested.append(stop) or "#00ff00")
    gradient = '<linearGradient id="s">' + "<stop/>" * 50 + "</linearGradient>"
    assert len(read(gradient + BOTH.format("url(#s)", "none", "") * 50).elements) == 50
    assert len(requested) == 50


def test_a_bounding_box_is_computed_once(monkeypatch):
    requested = []
    bounds = element.PaintedElements.bounds
    monkeypatch.setattr(element.PaintedElements, "bounds", lambda *words: requested.append(1) or bounds(*words))
    move = "translate(1%, 1%)" * 50
    read(f'<path d="M0 0H5V5" style="transform-box:fill-box;transform:{move};transform-origin:center"/>')
    assert len(requested) == 1


def test_white_paint_is_reported():
    """White paint is reported.

    Shapes under white paint are painted too, because paint is not cut off by shapes on top.
    """
    for fill, stroke in (
        ("white", "blue"),
        ("white", "none"),
        ("blue", "#fff"),
        ("rgb(250 250 248)", "none"),
    ):
        assert are_reported(notices_of(painted(fill, stroke)), "white-paint p data-brushsvg-skip")
    assert not notices_of(painted("#e8e8e8", "none"))


def test_a_fill_keeps_its_colour_next_to_another_stroke_colour():
    for fill, stroke, colours in (
        ("#f00", "#000", [("#ff0000", "nonzero"), ("#000000", "")]),
        ("#f00", "red", [("#ff0000", "nonzero")]),
        ("#f00", "none", [("#ff0000", "nonzero")]),
        ("none", "#f00", [("#ff0000", "")]),
    ):
        design = painted(fill, stroke)
        (_, shape) = design.elements
        assert [(part.colour, part.fill_rule) for part in shape.by_colour()] == colours
        assert design.notices == ()
    design = read('<path d="M0 0H5V5Z" stroke="red"/>')
    assert design.notices == (), "the default fill, which nobody chose"
    assert [part.colour for part in design.elements[0].by_colour()] == ["#ff0000"]


@pytest.mark.parametrize(
    ("order", "is_on_top"),
    [("stroke", False), ("markers stroke fill", False), ("markers", True), ("fill stroke", True), ("normal", True)],
)
def test_a_stroke_below_its_fill_is_reported(order, is_on_top):
    """The stroke is painted last, which covers a part of the fill."""
    shape = '<path id="p" d="M10 10h40v30z" fill="{}" stroke="#00f" stroke-width="4"/>'
    for fill in ("#f00", "#00f", "none"):
        design = read(f'<g style="paint-order:{order}">{shape.format(fill)}</g>')
        expected = ["css-unread p-stroke paint-order"] if fill == "#f00" and not is_on_top else []
        assert are_reported([*design.notices, *strokes(design)[1]], *expected)


@pytest.mark.parametrize("more", ['stroke-dasharray="9 5"', 'clip-path="url(#c)"'])
def test_a_stroke_below_its_fill_is_reported_once_when_it_is_cut(more):
    clip = '<clipPath id="c"><path d="M0 0H30V90H0Z M35 0H90V90H35Z"/></clipPath>'
    shape = f'<path id="p" d="M10 10h40v30z" fill="#f00" stroke="#00f" stroke-width="4" paint-order="stroke" {more}/>'
    reported = [notice.about for notice in strokes(read(clip + shape))[1]]
    assert reported == ["paint-order"]


@pytest.mark.parametrize(
    ("shape", "paths_as", "codes"),
    [
        ('d="M10 10h40v30z" fill="#000" stroke="#f00" stroke-width="0.2"', None, ["outline-too-fine"]),
        ('d="M10 10h40v30z" fill="#000" stroke="#f00" stroke-width="4"', None, ["css-unread"]),
        ('d="M10 10h40v30z" fill="#000" stroke="#f00" stroke-width="4"', "stroke", []),
        ('d="M10 10h40v30z" fill="#000" stroke="#f00" stroke-width="4"', "outline", []),
        ('d="M10 10h40" fill="#000" stroke="#f00" stroke-width="4"', None, []),
        ('d="M0 0H100V60H0Z" fill="#fff" stroke="#f00" stroke-width="4"', None, ["background"]),
    ],
)
def test_paint_order_is_reported_only_where_a_stroke_covers_a_fill(shape, paths_as, codes):
    design = read(f'<path id="p" {shape} paint-order="stroke"/><path id="last" d="M5 5h9v9z" stroke="#000"/>')
    design, thin_notices = remove_thin_outlines(design, find_brush("round-6")) if paths_as is None else (design, [])
    reported = [*design.notices, *thin_notices, *strokes(design, paths_as)[1]]
    assert [notice.code for notice in reported] == codes


@pytest.mark.parametrize("clip", ["", 'clip-path="url(#c)"'])
def test_dashes_around_a_shape_leave_it_whole(clip):
    """Dashes around a shape leave the filled shape whole.

    The filled shape once became the shape of each dash.
    """
    before = '<clipPath id="c"><rect width="90" height="90"/></clipPath>'
    dashed = 'stroke-width="0.5" stroke-dasharray="1 1" ' + clip
    shape, line = painted("#f00", "#00f", dashed, before).elements[1:]
    assert (shape.id, shape.colour, len(shape.subpaths), shape.stroke_width_mm) == ("p", "#ff0000", 1, 0.0)
    assert (line.id, line.colour, line.fill_rule) == ("p-stroke", "#0000ff", "") and len(line.subpaths) > 5
    straight = read('<path id="l" d="M0 0H50" stroke="#000" stroke-width="1" stroke-dasharray="5 5" fill="red"/>')
    assert [each.id for each in straight.elements] == ["l"], "it encloses nothing"
