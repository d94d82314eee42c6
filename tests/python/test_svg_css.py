"""Which CSS declaration wins, and how much time style sheets may cost."""

import pytest
from diagnostics import agrees, are_reported, is_reported, refused
from svg_text import read

from brushsvg import Error
from brushsvg.read.svg.css import selectors, style_sheets

P = '<path id="p" class="a b" d="M0 0H5"/>'


def width(css, body=P):
    design = read(f"<style>{css}</style>{body}")
    assert not design.notices
    return design.elements[0].stroke_width_mm


@pytest.mark.parametrize(
    ("css", "mm"),
    [
        ("path{stroke-width:2}", 2),
        (".a{stroke-width:2}", 2),
        (".c{stroke-width:2}", 1),
        ("#p{stroke-width:2} .a{stroke-width:3}", 2),
        (".a{stroke-width:2} .b{stroke-width:3}", 3),
        (".a.b{stroke-width:2} .b{stroke-width:3}", 2),
        ("*{stroke-width:2}", 2),
        ("svg > path{stroke-width:2}", 2),
        ("g path{stroke-width:2}", 1),
        ("path[d]{stroke-width:2} [id='q']{stroke-width:3}", 2),
        ("path:first-child{stroke-width:2}", 1),
        ("style + path{stroke-width:2}", 2),
        ("style ~ path{stroke-width:2}", 2),
        ("g, path{stroke-width:2}", 2),
        (".a{stroke-width:2!important} #p{stroke-width:3}", 2),
        ("@media screen{path{stroke-width:2}} @media print{path{stroke-width:3}}", 2),
        ("@font-face{src:x} path{stroke-width:2}", 2),
        ("@media not print{path{stroke-width:2}}", 2),
        ("@media (prefers-color-scheme: dark){path{stroke-width:2}}", 1),
        ("@media (prefers-color-scheme: light), (color){path{stroke-width:2}}", 2),
        ("@namespace url(http://www.w3.org/2000/svg);path{stroke-width:2}", 2),
        ("/* c */ path{/* c */stroke-width:2/* c */}", 2),
        ("path{stroke-width:2;bogus;stroke:}", 2),
        ("<![CDATA[svg > path{stroke-width:2}]]>", 2),
        (":root{--w:2} path{stroke-width:var(--w)}", 2),
        ("path{stroke-width:var(--none, 2)}", 2),
        (":root{--a:var(--b);--b:2} path{stroke-width:var(--a)}", 2),
        ("path{stroke-width:50%} svg{stroke-width:2}", pytest.approx(0.5 * (100**2 + 50**2) ** 0.5 / 2**0.5)),
    ],
)
def test_selectors_and_rules_set_the_stroke_width(css, mm):
    assert width(css) == mm


MM = 96 / 25.4  # in px


@pytest.mark.parametrize(
    ("value", "px"),
    [
        ("calc(1mm + 2px)", MM + 2),
        ("calc(2 * (3px - 1px) / 4 + 1PX)", 2),
        ("CALC(3 * 2)", 6),
        ("min(3px, 1mm)", 3),
        ("max(3px, 1mm, .1px)", MM),
        ("clamp(1px, 5px, 2mm)", 5),
        ("clamp(1px, 9px, 2mm)", 2 * MM),
        ("calc(0.5em * 2)", 16),
        ("calc(min(3px, 1mm) + max(1px, 2px))", 5),
        ("calc(1px/**/ + 1px)", 2),
        ("calc(3px - -1px)", 4),
        ("calc(100% / 2)", 0.5 * (100**2 + 50**2) ** 0.5 / 2**0.5),
    ],
)
def test_css_lengths_are_computed(value, px):
    assert width(f"path{{stroke-width:{value}}}") == pytest.approx(px)
    assert width(f":root{{--w:{value}}} path{{stroke-width:var(--w)}}") == pytest.approx(px)
    (circle,) = read(f'<circle cx="20" cy="20" style="r:{value.replace("3 * 2", "6px")}"/>').elements
    assert circle.subpaths[0].cubics[..., 0].max() == pytest.approx(20 + px)


@pytest.mark.parametrize(
    "value",
    [
        *("calc(50% - 1px)", "calc(1px+1px)", "calc(1px +1px)", "calc(1px * 1px)", "calc(1px / 0)", "calc()"),
        *(
            "calc(1px + 1)",
            "calc(2 / 1px)",
            "clamp(1px, 2px)",
            "min()",
            "calc(1 px)",
            "calc(+ 1px)",
            "sin(1)",
        ),
        *(
            "calc(1px,2px)",
            "calc(1furlong)",
            "calc(1px) calc(1px)",
            "calc(" * 400 + "1px" + ")" * 400,
            "calc(1e999px)",
        ),
    ],
)
def test_values_that_are_not_a_single_length_are_damaged(value):
    design = read(f"<style>path{{stroke-width:{value}}}</style>{P}")
    assert are_reported(design.notices, "stroke-width-invalid") and design.notices[0].damaged


def test_an_invalid_width_of_a_line_that_is_not_drawn_is_no_damage():
    """The SVG files of ezdxf have stroke-width: none for filled shapes, and convert refused all of them."""
    style = "<style>.shape{stroke:none;stroke-width:none;fill:#000}.line{stroke:#000;stroke-width:none}</style>"
    square = '<path id="square" class="shape" d="M5 5h9v9h-9z"/>'
    design = read(style + square)
    assert design.notices == () and design.elements[0].fill_rule
    design = read(f'{style}<g class="shape">{square}<path id="line" class="line" d="M5 5h9"/></g>')
    assert [each.where for each in design.notices if each.code == "stroke-width-invalid"] == ["g 1", "line"]


def test_attribute_rule_style_and_important_have_css_precedence():
    body = '<path id="p" d="M0 0H5" stroke-width="2"{}/>'
    assert width("", body.format("")) == 2
    assert width("path{stroke-width:3}", body.format("")) == 3
    assert width("path{stroke-width:3}", body.format(' style="stroke-width:4"')) == 4
    assert width("path{stroke-width:3!important}", body.format(' style="stroke-width:4"')) == 3
    assert width("path{stroke-width:3!important}", body.format(' style="stroke-width:4!important"')) == 4


def test_style_elements_in_the_html_namespace_are_read():
    style = '<style xmlns="http://www.w3.org/1999/xhtml">path{stroke-width:2}</style>'
    assert read(style + P).elements[0].stroke_width_mm == 2


def test_rules_are_inherited_and_variables_can_be_overridden():
    css = "g{stroke-width:var(--w);--w:3} .in{--w:7;stroke-width:var(--w)}"
    design = read(f'<style>{css}</style><g><path d="M0 0H5"/><path class="in" d="M0 0H5"/></g>')
    assert [element.stroke_width_mm for element in design.elements] == [3, 7]


def test_display_visibility_and_geometry_can_be_set_by_rules():
    css = "#x{display:none} #y{visibility:hidden} #z{d:path('M1 2H3')} circle{r:4px;transform:translate(10px,2px)}"
    body = '<path id="x" d="M0 0H5"/><path id="y" d="M0 0H5"/><path id="z" d="M0 0H9"/><circle id="c" r="9"/>'
    design = read(f"<style>{css}</style>{body}")
    assert [element.id for element in design.elements] == ["z", "c"]
    assert design.elements[0].subpaths[0].cubics[0, [0, 3]].tolist() == [[1, 48], [3, 48]]
    assert design.elements[1].subpaths[0].cubics[0, 0].tolist() == [14, 48]


def test_lengths_without_a_unit_are_invalid_in_css():
    """Lengths without a unit are invalid in CSS.

    In an attribute they are px. Browsers drop an invalid declaration, and the next weaker declaration counts.
    """
    body = '<circle id="c" r="5" cx="9" cy="9" style="r:8;cx:9.5e0;cy:0"/><circle id="d" r="5" cx="9" style="r:8px"/>'
    design = read(f"<style>#c{{r:6px}}</style>{body}")
    starts = [element.subpaths[0].cubics[0, 0].tolist() for element in design.elements]
    assert starts == [[15, 50], [17, 50]]
    assert [notice.where for notice in design.notices] == ["c", "c"]
    assert are_reported(design.notices, "css-invalid r '8' unit", "css-invalid cx '9.5e0' unit")


def test_own_properties_are_inherited_only_when_requested():
    body = '<g style="opacity:.5"><path id="p" style="opacity:inherit" d="M0 0H5"/><path id="q" d="M0 0H5"/></g>'
    assert are_reported(read(body).notices, "css-unread opacity", "css-unread opacity p")


@pytest.mark.parametrize(
    ("css", "expected"),
    [
        ("path:hover::foo(){stroke:red}", "css-unread path:hover::foo()"),
        ("@import 'x.css';", "css-unread @import"),
        ("path:nth-child(2n +){stroke:red}", "css-unread 'path:nth-child(2n +)'"),
        ("@layer ink{path{stroke-width:2}}", "css-unread @layer"),
        ("@supports (fill: red){path{stroke-width:2}}", "css-unread @supports"),
        ("path stroke:red", "css-invalid"),
        ("@media (min-width:1px){path{stroke-width:2}}", "css-unread '@media (min-width:1px)'"),
        ("@media screen and (color), print{path{stroke-width:2}}", "css-unread '@media screen and (color)'"),
        ("svg{path{stroke-width:2}}", "css-unread rules svg"),
        ("@namespace url(urn:x);path{stroke-width:2}", "css-unread @namespace"),
    ],
)
def test_unsupported_parts_of_a_style_sheet_are_reported(css, expected):
    assert is_reported(read(f"<style>{css}</style>{P}").notices, expected)


def test_a_self_referencing_variable_has_no_value():
    design = read(f"<style>:root{{--a:var(--b)x;--b:var(--a)}} path{{stroke-width:var(--a)}}</style>{P}")
    assert design.elements[0].stroke_width_mm == 1
    assert are_reported(design.notices, "css-invalid stroke-width var(--a) --b") and design.notices[0].damaged
    unknown = read(f"<style>path{{stroke:blue;stroke:var(--c)}}</style>{P}")
    assert unknown.elements[0].colour == "#ff0000", "what is inherited, not the weaker declaration"
    (notice,) = unknown.notices
    assert agrees(notice, "css-invalid --c") and not notice.damaged
    assert read(f"<style>path{{font-size:var(--c)}}</style>{P}").notices == ()
    grown = "".join(f"--v{k}:var(--v{k + 1})var(--v{k + 1});" for k in range(60))
    read(f"<style>:root{{{grown}}} path{{stroke-width:var(--v0)}}</style>{P}")


@pytest.mark.parametrize("value", ["var(--none,)", "var(--none, /* nothing */)", "/* nothing */"])
def test_path_data_in_css_without_a_value_count_as_not_given(value):
    (element,) = read(f'<path d="M0 0H5" style="d: {value}"/>').elements
    assert element.subpaths[0].cubics[-1, 3, 0] - element.subpaths[0].cubics[0, 0, 0] == pytest.approx(5)


@pytest.mark.parametrize(
    ("css", "body"),
    [
        (
            "h " + "g " * 12 + "path{stroke:blue}",
            "<g>" * 3000 + P + "</g>" * 3000,
        ),
        ("h ~ " + "g ~ " * 6 + "path{stroke:red}", "<g/>" * 3000 + P),
        ("g:has(x) {stroke:red}", "<g>" * 2500 + P + "</g>" * 2500),
        ("".join(f"[a{k}]{{stroke:red}}" for k in range(2000)), '<path d="M0 0H1"/>' * 4000),
    ],
)
def test_selectors_that_take_too_many_steps_are_refused(css, body, monkeypatch):
    monkeypatch.setattr(selectors, "STEP_LIMIT", 20_000)
    with refused("css-too-complex"):
        read(f"<style>{css}</style>{body}")


def test_deep_and_wide_documents_with_rules_are_read():
    css = "g path{stroke-width:2} g + path{stroke:blue}"
    design = read(f"<style>{css}</style>{'<g>' * 5000}{P}{'</g>' * 5000}{'<g/>' * 5000}{P}")
    assert [element.stroke_width_mm for element in design.elements] == [2, 1]
    assert design.elements[1].colour == "#0000ff"


@pytest.mark.parametrize(
    ("selector", "reaches"),
    [
        ("#p", True),
        ("path", True),
        ("g path", True),
        ("g > path:first-child", True),
        ("*:not(:root) path", True),
        ("svg path", False),
        ("defs > g", False),
        (":root path", False),
        (":scope path", False),
        (".here path", False),
        ("use path", False),
        ("i + g", False),
        ("g:nth-child(2)", False),
        ("g:first-child", True),
        ("g:only-of-type", True),
    ],
)
def test_selectors_in_a_copy_match_only_copied_elements(selector, reaches):
    """In a copy, selectors match within the copied elements only.

    See SVG 2, 5.6.3. Inkscape matches at the place of the original. If this gives another style, a notice
    reports the difference.
    """
    copied = '<defs><i/><g id="g"><path id="p" d="M0 0H5"/></g></defs>'
    design = read(f'<style>{selector}{{stroke-width:7}}</style>{copied}<g class="here"><use id="u" href="#g"/></g>')
    (element,) = design.elements
    assert element.stroke_width_mm == (7 if reaches else 1)
    assert is_reported(design.notices, "css-of-copies", "p") == (selector in ("svg path", ":root path", ":scope path"))
    assert {notice.code for notice in design.notices} <= {"css-of-copies"}


def test_a_nested_copy_is_matched_separately():
    body = '<defs><g id="a"><path id="p" d="M0 0H5"/></g><g id="b"><use href="#p"/><use href="#a"/></g></defs>'
    design = read(f'<style>g path{{stroke-width:7}}</style>{body}<use href="#b"/>')
    assert [element.stroke_width_mm for element in design.elements] == [1, 7]


def test_copies_count_toward_the_step_limit(monkeypatch):
    monkeypatch.setattr(selectors, "STEP_LIMIT", 20_000)
    nested = "".join(f'<g id="g{k}">' for k in range(300)) + "<i/>" * 300 + "</g>" * 300
    uses = "".join(f'<use href="#g{k}"/>' for k in range(300))
    assert read(f"<style>b{{stroke:red}}</style>{P}<defs>{nested}</defs>").elements
    with refused("css-too-complex"):
        read(f"<style>b{{stroke:red}}</style>{P}<defs>{nested}</defs>{uses}")


def test_elements_can_be_selected_with_css_selectors():
    body = '<g id="g"><path id="a" d="M0 0H5"/><text>x</text></g><path id="b" d="M0 0H5"/><use id="u" href="#a"/>'
    assert [element.id for element in read(body, select="#g").elements] == ["a"]
    assert [element.id for element in read(body, select="path").elements] == ["a", "b"], "a copy is its use's"
    assert [element.id for element in read(body, select="#a").elements] == ["a"]
    assert [element.id for element in read(body, select="use").elements] == ["u/a"]
    assert not read(body, select="#b").notices
    for text, expected in (("#none", "selector-matches-nothing #none"), ("g >", "selector-invalid 'g >'")):
        with refused(expected):
            read(body, select=text)


@pytest.mark.parametrize(
    "body",
    [f'<path style="stroke:{"(" * 30_000}" d="M0 0H5"/>', f"<style>{'a{' * 30_000}</style>{P}"],
)
def test_css_nested_too_deeply_is_refused(body):
    try:
        assert read(P + body).elements
    except Error as reported:
        assert agrees(reported, "css-too-complex")


def test_overlong_style_sheets_are_refused(monkeypatch):
    monkeypatch.setattr(style_sheets, "TEXT_LIMIT", 1000)
    with refused("css-too-complex 1300 1000"):
        read(f"<style>{'.a{top:1;red}' * 50}</style><style>{'.a{top:1;red}' * 50}</style>{P}")


@pytest.mark.parametrize("style", ["transform:rotate({}deg)", "transform:scale({})", "rotate:{}deg"])
def test_a_number_beyond_floating_point_range_is_reported(style):
    (notice,) = read(f'<path id="p" style="{style.format("1" * 400)}" d="M0 0H5"/>').notices
    assert notice.damaged and agrees(notice, "transform-unread", "p")
