"""use, symbol, nested svg, switch, layers, and settings for brushsvg."""

import pytest
from diagnostics import agrees, are_reported, refused
from svg_text import HEAD, lines, read

from brushsvg.read import ReadOptions
from brushsvg.read.svg import element as svg_element
from brushsvg.read.svg import read_svg, tree_walk

LINE = '<path id="l" d="M0 0H4"/>'


def test_use_places_copies_under_its_own_name():
    body = f'<defs>{LINE}</defs><use id="u" href="#l" x="10" y="5"/><use xlink:href="#l" transform="scale(2)"/>'
    design = read(body)
    assert lines(design) == [("u/l", (10, 5), (14, 5)), ("l", (0, 0), (8, 0))]
    assert [element.stroke_width_mm for element in design.elements] == [1, 2]
    assert not design.notices


@pytest.mark.parametrize("href", ["#ä", "#%C3%A4", "#a%20b", "#a b"])
def test_references_are_read_as_urls(href):
    name = "ä" if "a" not in href else "a b"
    design = read(f'<defs>{LINE.replace("l", name, 1)}</defs><use href="{href}"/>')
    assert len(design.elements) == 1 and not design.notices


def test_the_id_as_written_precedes_the_unquoted_id():
    near, far = (f'<path id="{name}" d="M0 {y}H10"/>' for name, y in (("%C3%A4", 1), ("ä", 9)))
    design = read(f"<defs>{far}{near}</defs><use href='#%C3%A4'/>")
    assert [line[1:] for line in lines(design)] == [((0, 1), (10, 1))]


@pytest.mark.parametrize("paint", ["url(#ä)", "url(#%C3%A4)", "url('#%C3%A4')"])
def test_paints_are_referenced_as_urls(paint):
    stop = '<stop stop-color="#123456"/>'
    body = f'<linearGradient id="ö">{stop}</linearGradient><linearGradient id="ä" href=" #%C3%B6"/>'
    design = read(f'{body}<path d="M0 0H10" fill="none" stroke="{paint}"/>')
    assert [element.colour for element in design.elements] == ["#123456"]


def test_use_passes_its_style_on_and_may_precede_its_target():
    group = f'<g id="g">{LINE}<path d="M0 1H4" stroke-width="2"/></g>'
    body = f'<use id="u" href="#g" stroke-width="3"/><defs>{group}</defs>'
    design = read(body)
    assert [(element.id, element.stroke_width_mm) for element in design.elements] == [("u/l", 3), ("u", 2)]


def test_use_may_refer_to_a_use_or_a_visible_group():
    body = f'<g id="g">{LINE}</g><use id="u" href="#g" x="10"/><use id="v" href="#u" x="1"/>'
    assert lines(read(body)) == [
        ("l", (0, 0), (4, 0)),
        ("u/l", (10, 0), (14, 0)),
        ("v/u/l", (11, 0), (15, 0)),
    ]


def test_symbols_fit_their_view_box_into_the_size_requested():
    symbol = '<symbol id="s" viewBox="0 0 4 4"><path d="M0 0L4 4"/></symbol>'
    design = read(f'{symbol}<use id="u" href="#s" x="10" width="8" height="20"/>')
    assert lines(design) == [("u", (10, 6), (18, 14))]
    assert design.elements[0].stroke_width_mm == 2
    assert lines(read(f'{symbol}<use id="u" href="#s"/>')) == [("u", (25, 0), (75, 50))]
    body = '<symbol id="s" preserveAspectRatio="none" viewBox="1 1 4 4" width="8" height="4">'
    assert lines(read(f'{body}<path d="M1 1L5 5"/></symbol><use href="#s"/>')) == [("stroke1", (0, 0), (8, 4))]


def test_nested_svg_has_its_own_viewport():
    inner = '<svg x="10" y="5" width="50%" height="20" viewBox="0 0 5 2"><line id="l" x2="100%" y2="50%"/></svg>'
    assert lines(read(inner)) == [("l", (10, 5), (60, 15))]
    plain = '<svg x="10" width="40" height="20"><line id="l" x2="50%" y2="100%"/></svg>'
    assert lines(read(plain)) == [("l", (10, 0), (30, 20))]
    assert lines(read('<svg width="0" height="5"><path id="x" d="M0 0H5"/></svg>' + LINE)) == [("l", (0, 0), (4, 0))]


def test_elements_hidden_by_a_viewport_are_left_out_or_reported():
    body = '<svg width="10" height="10"><path id="out" d="M20 1H30"/><path id="over" d="M5 5H15"/>{}</svg>'
    design = read(body.format('<path id="in" d="M1 1Q5 -1 9 1"/>'))
    assert [element.id for element in design.elements] == ["over", "in"]
    assert lines(design)[0] == ("over", (5, 5), (10, 5))
    assert are_reported(design.notices, "clipped-away out", "clipping-unread in")
    shown = read(body.replace("<svg", '<svg overflow="visible"').format(""))
    assert len(shown.elements) == 2 and not shown.notices


@pytest.mark.parametrize(
    ("body", "expected", "damaged"),
    [
        ('<use id="u" href="#none"/>', "use-of-nothing '#none'", False),
        ('<use id="u" href="other.svg#a"/>', "use-of-nothing 'other.svg#a'", False),
        ('<use id="u" href=" #l"/>', "use-of-nothing u ' #l' blanks browsers", False),
        ('<use id="u" href="#l "/>', "use-of-nothing u '#l ' blanks browsers", False),
        ('<use id="u"/>', "use-of-nothing", False),
        ('<use id="u" href="#u"/>', "use-of-itself u #u", True),
        ('<g id="g"><use id="u" href="#g"/></g>', "use-of-itself u #g", True),
        ('<defs><g id="a"><use id="ub" href="#b"/></g><g id="b"><use id="ua" href="#a"/></g></defs><use href="#a"/>',
         "use-of-itself ua #a", True),
        ('<use id="u" href="#l" x="2furlongs"/>', "not-a-length '2furlongs'", True),
        ('<svg id="s" viewBox="0 0 1"/>', "viewbox-invalid '0 0 1'", True),
    ],
)  # fmt: skip
def test_broken_use_references_are_reported(body, expected, damaged):
    design = read(LINE + body)
    (found,) = (notice for notice in design.notices if agrees(notice, expected))
    assert found.damaged == damaged
    assert len(design.elements) == 1


def test_use_chains_that_double_are_refused(monkeypatch):
    monkeypatch.setattr(tree_walk, "_MAX_COPIES", 2000)
    chain = "".join(f'<g id="a{k}"><use href="#a{k + 1}"/><use href="#a{k + 1}"/></g>' for k in range(40))
    with refused("drawing-too-large 2000"):
        read(f'<defs>{chain}<g id="a40">{LINE}</g></defs><use href="#a0"/>')


def test_a_long_chain_of_uses_is_read_without_recursion():
    chain = "".join(f'<use id="u{k}" href="#u{k + 1}"/>' for k in range(3000))
    design = read(f"<defs>{chain}{LINE.replace('l', 'u3000', 1)}</defs><use href='#u0'/>")
    assert len(design.elements) == 1


def test_overlong_path_data_is_refused(monkeypatch):
    monkeypatch.setattr(svg_element, "_MAX_PATH_DATA", 1000)
    assert read(LINE * 100).elements
    with refused("drawing-too-large 1000"):
        read(LINE * 200)


def test_switch_paints_the_first_child_that_applies():
    body = """<switch><foreignObject requiredExtensions="http://ns.adobe.com/AdobeIllustrator/10.0/"/>
      <path id="fr" systemLanguage="fr" d="M0 0H4"/><path id="en" systemLanguage="de, en-GB" d="M0 0H4"/>
      <path id="any" d="M0 0H4"/></switch><path id="lone" systemLanguage="fr" d="M0 0H4"/>"""
    design = read(body)
    assert [element.id for element in design.elements] == ["en"]
    assert not design.notices


def test_css_transforms_and_origins_are_applied():
    def start(attributes):
        return lines(read(f'<path d="M10 0H20" {attributes}/>'))[0][1]

    assert start('style="transform:translate(2px, 3px)"') == (12, 3)
    assert start('style="transform:translateX(2px) translateY(1px) scaleX(2) scaleY(3)"') == (22, 1)
    assert start('style="transform:rotate(.25turn)"') == pytest.approx((0, 10))
    assert start('style="transform:rotate(100grad) skew(0deg, 0)"') == pytest.approx((0, 10))
    assert start('transform="scale(2)" style="transform:none"') == (10, 0)
    assert start('transform="rotate(90)" transform-origin="10 10"') == pytest.approx((20, 10))
    assert start('transform="scale(2)" transform-origin="50% 0"') == (-30, 0)
    assert start('transform="scale(2)" transform-origin="right bottom"') == (-80, -50)
    assert start('transform="scale(2)" transform-origin="top left"') == (20, 0)
    assert start('style="transform:scale(50%) scaleX(200%)"') == (10, 0)
    for broken in (
        "rotate(20)",
        "translate(2 3)",
        "scale(x)",
        "turn(3)",
        "rotate(1deg, 2px)",
        "skewX(1rad) x",
    ):
        design = read(f'<path id="p" d="M10 0H5" transform="scale(2)" style="transform:{broken}"/>')
        assert lines(design)[0][1] == (20, 0), "the attribute serves"
        assert [notice.damaged for notice in design.notices] == [True]
    design = read('<path id="p" d="M0 0H5" transform="scale(2)" transform-origin="1vw 0"/>')
    assert design.notices[0].damaged


@pytest.mark.parametrize("text", ["rotate(90deg)", "translateX(2)", "scale(50%)", "translate(2px 3px)", "skew(3)"])
def test_the_transform_attribute_refuses_units_and_css_functions(text):
    design = read(f'<path d="M10 0H20" transform="{text}"/>')
    assert lines(design)[0][1] == (10, 0)
    assert [notice.damaged for notice in design.notices] == [True]


@pytest.mark.parametrize(
    ("origin", "point"),
    [
        ("top", (50, 0)),
        ("bottom", (50, 50)),
        ("left", (0, 25)),
        ("right", (100, 25)),
        ("center", (50, 25)),
        ("TOP left", (0, 0)),
        ("center right", (100, 25)),
        ("center bottom", (50, 50)),
        ("bottom center", (50, 50)),
        ("10px", (10, 25)),
        ("10% 20%", (10, 10)),
        ("left 20px", (0, 20)),
        ("1in top", (96, 0)),
        ("-10px 0 5px", (-10, 0)),
    ],
)
def test_transform_origin_accepts_all_keywords(origin, point):
    x, y = point
    for keywords in (
        f'transform="scale(2)" transform-origin="{origin}"',
        f'style="transform:scale(2);transform-origin:{origin}"',
        f'style="scale:2;-webkit-transform-origin:{origin}"',
    ):
        assert lines(read(f'<path d="M10 4H20" {keywords}/>'))[0][1] == pytest.approx((20 - x, 8 - y)), keywords


@pytest.mark.parametrize("origin", ["top 20px", "20px left", "left left", "1 2 3 4", "10% 20% 30%", "x", "5,6"])
def test_an_invalid_transform_origin_is_reported(origin):
    design = read(f'<path id="p" d="M10 4H20" transform="scale(2)" transform-origin="{origin}"/>')
    assert lines(design)[0][1] == (20, 8)
    assert [notice.damaged for notice in design.notices] == [True]


def test_transform_box_uses_the_box_of_the_shape():
    def start(attributes, shape='path d="M10 4H20V14"'):
        return lines(read(f"<{shape} {attributes}/>"))[0][1]

    box = "transform-box:fill-box;transform"
    assert start(f'style="{box}:scale(3);transform-origin:center"') == (0, -6)
    assert start(f'style="{box}-origin:100% 0" transform="scale(3)"') == (-10, 4)
    assert start(f'style="{box}:scale(3)"') == (10, 4), "about its corner where no origin is said"
    assert start(f'style="{box}:translate(50%, 20%)"') == (15, 6)
    circle = 'circle r="5" cx="30" cy="20"'
    assert start(f'style="{box}:rotate(90deg);transform-origin:50% 50%"', circle) == pytest.approx((30, 25))
    for body in (
        f'<g id="p" style="{box}:scale(3)"><path d="M10 4H20"/></g>',
        '<path id="p" style="transform-box:stroke-box;transform:scale(3)" d="M10 4H20"/>',
    ):
        (notice,) = read(body).notices
        assert notice.damaged and agrees(notice, "transform-unread transform-box", "p")


def test_translate_rotate_and_scale_properties_are_applied():
    def start(style, attribute=""):
        return lines(read(f'<path d="M10 0H20" style="{style}" {attribute}/>'))[0][1]

    assert start("translate:2px 3px") == (12, 3)
    assert start("translate:10%") == (20, 0)
    assert start("rotate:90deg") == pytest.approx((0, 10))
    assert start("scale:2 3", 'transform="translate(1 1)"') == (22, 3)
    assert start("transform:translate(1px, 2px);scale:200%;rotate:90deg;translate:5px") == pytest.approx((1, 22))
    assert start("rotate:none;scale:none;translate:none") == (10, 0)
    for style in ("rotate:x 20deg", "rotate:20", "translate:3", "scale:1 2 3", "scale:x"):
        assert [notice.damaged for notice in read(f'<path d="M0 0H5" style="{style}"/>').notices] == [True]


def test_a_transform_of_the_drawing_itself_is_reported():
    text = HEAD.replace("<svg", '<svg transform="rotate(20)"') + '<path d="M10 0H20"/></svg>'
    design = read_svg(text.encode())
    assert lines(design)[0][1] == (10, 0)
    (notice,) = design.notices
    assert notice.damaged and agrees(notice, "transform-unread")


@pytest.mark.parametrize(
    "name",
    "mix-blend-mode:darken offset-path:none animation:a mask-image:none -webkit-filter:blur(5px)"
    " content-visibility:hidden all:unset".split(),
)
def test_unsupported_css_only_properties_are_reported(name):
    of, value = name.split(":")
    reported = read(f'<g id="g" style="{name}"><path d="M0 0H5"/></g>').notices
    expected = f"css-unread g {of.removeprefix('-webkit-')}"
    assert are_reported(reported, *([] if value == "none" else [expected]))


def test_empty_attributes_are_ignored():
    names = "x y rx ry transform transform-origin stroke stroke-width opacity style class fill visibility"
    empty = " ".join(f'{name}=""' for name in names.split())
    design = read(f'<rect width="5" height="5" {empty}/><use href="#a" x="" y=" "/><path id="a" d="M0 0H1"/>')
    assert not design.notices and len(design.elements) == 3
    assert (design.elements[0].colour, design.elements[0].stroke_width_mm) == ("#ff0000", 1)
    flat = read('<path d="M0 0H1"/><rect id="r" width="5" height=""/>')
    assert are_reported(flat.notices, "geometry-empty r")
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="" height="" viewBox="0 0 9 9" preserveAspectRatio="">'
    root = head + '<rect width="1" height="1"/></svg>'
    (notice,) = read_svg(root.encode()).notices
    assert notice.code == "size-assumed"
    sized = root.replace('width="" height=""', 'width="30mm" height="40mm"').replace('"0 0 9 9"', '""')
    assert read_svg(sized.encode()).sheet_mm == (30, 40)


def test_a_blank_before_a_unit_is_invalid():
    (notice,) = read('<path id="p" d="M0 0H5" stroke-width="12 px"/>').notices
    assert notice.damaged and agrees(notice, "stroke-width-invalid '12 px' blank", "p")


def test_an_invalid_css_d_property_is_ignored():
    for text in ("M1 1H3", "path(evenodd, 'M1 1H3')", "path('M1 1H3' x)", "circle(5px)"):
        assert lines(read(f'<path d="M0 0H5" style="d:{text}"/>'))[0][1:] == ((0, 0), (5, 0))
    assert len(read('<path d="M0 0H5" style="d:none"/><path d="M0 0H5"/>').elements) == 1


def test_an_empty_href_overrides_xlink_href():
    design = read('<path id="a" d="M0 0H5"/><use id="u" href="" xlink:href="#a"/>')
    assert are_reported(design.notices, "use-of-nothing u href")


def test_nameless_elements_are_counted_and_notices_use_the_same_name():
    body = '<path d="M0 0H4"/><text>x</text><path stroke="none" d="M0 0"/>'
    body += '<path d="M0 0H4" opacity=".5"/><path d="M0 0H4 x"/>'
    design = read(body)
    assert [element.id for element in design.elements] == ["stroke1", "stroke2", "stroke3"]
    assert [notice.where for notice in design.notices] == ["text 1", "path 2", "path 3", "stroke3 (path 4)"]


def test_nested_layers_are_kept_and_notices_name_their_layer():
    body = """<g inkscape:groupmode="layer" inkscape:label="A"><g inkscape:groupmode="layer" inkscape:label="B">
      <path d="M0 0H4"/><text id="t">x</text></g></g>"""
    design = read(body)
    assert design.elements[0].layer == "A/B"
    assert [notice.layer for notice in design.notices] == ["A/B"]


def test_non_scaling_strokes_keep_their_width_in_px():
    design = read('<path d="M0 0H5" transform="scale(7)" stroke-width="2" vector-effect="non-scaling-stroke"/>')
    assert design.elements[0].stroke_width_mm == pytest.approx(2 * 25.4 / 96)


def test_filled_shapes_are_read():
    body = '<path id="f" d="M0 0H5V5Z" stroke="none" fill="#123" fill-rule="evenodd"/>'
    body += '<rect id="b" width="5" height="5" fill="blue"/>'
    shape, both = read(body).elements
    assert (shape.stroke_width_mm, shape.fill_rule, shape.colour, shape.is_stroked) == (
        0,
        "evenodd",
        "#112233",
        False,
    )
    assert (both.stroke_width_mm, both.fill_rule, both.colour, both.is_stroked) == (
        1,
        "nonzero",
        "#ff0000",
        True,
    )


def test_illustrator_is_known_by_its_comment():
    head = b'<!-- Generator: Adobe Illustrator 24.0 --><svg xmlns="http://www.w3.org/2000/svg" '
    head += b'width="72px" height="72px">'
    from brushsvg.read.svg import read_svg

    design = read_svg(head + b'<path d="M0 0H5" stroke="red"/></svg>')
    reported = design.notices[0]
    assert reported.code == "other-pixels" and "25.4 x 25.4 mm" in reported.sentence
    assert 'width="25.4mm" height="25.4mm"' in reported.advice


def test_settings_are_inherited_and_carried():
    body = """<g data-brushsvg-speed="12.5" data-brushsvg-passes="2">
      <path id="a" d="M0 0H4" data-brushsvg-width="0.3cm"/>
      <path id="b" d="M0 0H4" data-brushsvg-passes="1" data-brushsvg-reload="yes" data-brushsvg-brush="rigid"/>
      <g data-brushsvg-skip="yes"><path id="c" d="M0 0H4"/><path id="d" data-brushsvg-skip="no" d="M0 0H4"/></g></g>
      <path id="e" d="M0 0H4" stroke="none" data-brushsvg-width="2" data-brushsvg-order="-3"/>"""
    design = read(body)
    assert not design.notices
    assert {element.id: element.settings for element in design.elements} == {
        "a": {"speed_mm_s": 12.5, "passes": 2, "width_mm": 3.0},
        "b": {"speed_mm_s": 12.5, "passes": 1, "reload": True, "brush": "rigid"},
        "d": {"speed_mm_s": 12.5, "passes": 2, "skip": False},
        "e": {"width_mm": 2.0, "order": -3},
    }
    assert [element.stroke_width_mm for element in design.elements] == [3, 1, 1, 2]


def test_a_width_for_a_layer_does_not_turn_its_shapes_into_lines():
    body = '<path id="f" d="M0 0H5V5Z" fill="black"/><path id="l" d="M0 0H5"/>'
    body = f'<g data-brushsvg-width="3" stroke="none">{body}</g>'
    shape, line = read(body).elements
    assert (shape.is_stroked, shape.fill_rule) == (False, "nonzero")
    assert (line.is_stroked, line.stroke_width_mm) == (True, 3)


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ('speed="fast"', "setting-invalid 'fast'"),
        ('speed="-1"', "setting-invalid -1 0.001 10000"),
        ('speed="nan"', "setting-invalid 'nan'"),
        ('speed="1_0"', "setting-invalid '1_0'"),
        ('passes="\u0663"', "setting-invalid '٣'"),  # an Arabic digit three
        ('width="5 furlongs"', "setting-invalid '5 furlongs'"),
        ('width="0"', "setting-invalid 0 0.001 1000"),
        ('passes="1.5"', "setting-invalid '1.5'"),
        ('passes="21"', "setting-invalid 21 1 20"),
        ('skip="perhaps"', "setting-invalid 'perhaps'"),
        ('brush=""', "setting-invalid"),
        ('colour="red"', "setting-invalid data-brushsvg-colour width speed"),
    ],
)
def test_invalid_settings_stop_convert(setting, expected):
    design = read(f'<path id="p" d="M0 0H4" data-brushsvg-{setting}/>')
    (notice,) = design.notices
    assert agrees(notice, expected) and notice.damaged, notice
    assert not design.elements[0].settings


def test_the_advice_for_illustrator_does_not_depend_on_the_requested_sheet():
    text = (
        '<!-- Generator: Adobe Illustrator 27.0 --><svg xmlns="http://www.w3.org/2000/svg" width="283.5px" '
        'height="198.4px" viewBox="0 0 283.5 198.4"><path fill="none" stroke="#000" d="M50 60h100"/></svg>'
    )
    for sheet_mm in (None, (200.0, 150.0)):
        (notice,) = read_svg(text.encode(), ReadOptions(sheet_mm=sheet_mm)).notices
        assert 'width="100.013mm" height="69.9911mm"' in notice.advice


@pytest.mark.parametrize(
    ("attributes", "sheet_mm", "reported"),
    [
        ('style="width:50mm;height:4cm"', (50.0, 40.0), []),
        ('width="100mm" height="100mm" style="width:50mm;height:100mm"', (100.0, 100.0), ["100 50"]),
        ('width="100mm" height="100mm" style="width:100%;height:auto"', (100.0, 100.0), []),
        ('width="80mm" style="height:40mm"', (80.0, 40.0), []),
    ],
)
def test_a_page_size_in_the_style_is_read(attributes, sheet_mm, reported):
    text = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100" {attributes}>{LINE}</svg>'
    design = read_svg(text.encode())
    assert design.sheet_mm == pytest.approx(sheet_mm)
    assert are_reported(design.notices, *(f"size-assumed {each}" for each in reported)), design.notices
