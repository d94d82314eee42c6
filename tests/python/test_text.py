"""Text becomes drawings; the fonts are made here, so every coordinate is known."""

import io
import re
import struct
import sys
import xml.etree.ElementTree as ET
from fractions import Fraction

import numpy as np
import pytest
import svgpathtools
from diagnostics import agrees, are_reported, refused
from fontTools.feaLib.builder import addOpenTypeFeaturesFromString
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTCollection, TTFont
from fontTools.ttLib.sfnt import SFNTReader, SFNTWriter
from fontTools.ttLib.tables.DefaultTable import DefaultTable

from brushsvg.errors import Error
from brushsvg.read.text import text_svg

SVG = "{http://www.w3.org/2000/svg}"
GLYPHS = """
  <missing-glyph horiz-adv-x="500" d="M 0 0 L 900 900"/>
  <glyph unicode=" " horiz-adv-x="300"/>
  <glyph unicode="I" glyph-name="I" horiz-adv-x="200" d="M 100 0 L 100 700"/>
  <glyph unicode="T" glyph-name="T" d="M 0 700 L 400 700 M 200 700 L 200 0"/>
  <glyph unicode="f" glyph-name="f" horiz-adv-x="250" d="M 100 0 V 500"/>
  <glyph unicode="fi" glyph-name="f_i" horiz-adv-x="450" d="M 100 0 V 600"/>
  <glyph unicode="ffi" glyph-name="f_f_i" horiz-adv-x="650" d="M 100 0 V 650"/>
  <glyph unicode="i" glyph-name="i" horiz-adv-x="200" d="M 100 0 V 400 M 100 500 L 100 500"/>
  <glyph unicode="," glyph-name="comma" horiz-adv-x="150" d="M 50 0 L 0 -100"/>
  <glyph unicode="&#xe9;" glyph-name="eacute" horiz-adv-x="300" d="M 0 0 C 0 400 300 400 300 0"/>
  <glyph unicode="o" glyph-name="o" horiz-adv-x="400" d="M 0 0 h 300 v 300 h -300 z"/>
"""
FONT = 'horiz-adv-x="400"'
FACE = 'units-per-em="1000" ascent="800" descent="-200"'


def svg_font(glyphs=GLYPHS, font=FONT, face=FACE):
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg"><defs><font {font}><font-face {face}/>{glyphs}</font></defs></svg>'
    ).encode()


def paths(document):
    return ET.fromstring(document.encode()).findall(SVG + "path")


def drawn(text, font=None, **options):
    """Return d of each path of a text without notices.

    The em is 10 mm by default.
    """
    options = {"size_mm": 10, **options}
    document, notices = text_svg(text, font or svg_font(), **options)
    assert notices == []
    return [path.get("d") for path in paths(document)]


def refusal(text, font, **options) -> Error:
    with pytest.raises(Error) as caught:
        text_svg(text, font, **options)
    return caught.value


def starts(text, glyphs=GLYPHS, **options):
    """Return x of the first point of each glyph [mm], relative to the first glyph."""
    found = [float(re.match(r"M (-?[\d.]+)", d)[1]) for d in drawn(text, svg_font(glyphs), **options)]
    return [round(x - found[0], 4) for x in found]


# Single-line fonts


def test_a_letter_is_upright_with_a_margin_of_20_mm_plus_half_its_width():
    document, notices = text_svg("T", svg_font(), size_mm=10, width_mm=1)
    root = ET.fromstring(document.encode())
    # The ink is 4 by 7 mm, and the line's width adds 1 mm.
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("45mm", "48mm", "0 0 45 48")
    assert root.find(SVG + "title").text == "T"
    (path,) = paths(document)
    assert path.attrib == {
        "id": "glyph-1-T",
        "fill": "none",
        "stroke": "#000000",
        "stroke-width": "1",
        "stroke-linecap": "round",
        "stroke-linejoin": "round",
        "d": "M 20.5000,20.5000 L 24.5000,20.5000 M 22.5000,20.5000 L 22.5000,27.5000",
    }
    assert notices == []


def test_the_size_is_the_em_of_the_font():
    font = svg_font(face='units-per-em="2000"')
    assert drawn("T", font, size_mm=20) == drawn("T", size_mm=10)


def test_a_font_without_units_has_1000_units_per_em():
    assert drawn("T", svg_font(face="")) == drawn("T")


def test_glyphs_follow_at_their_own_advance_or_the_fonts():
    # I is at 100 with an advance of 200; T starts at 0 and has the font's advance of 400.
    assert starts("ITI I") == [0, 1, 6, 11]


def test_sub_paths_that_touch_stay_separate():
    glyph = '<glyph unicode="L" d="M 0 700 L 0 0 M 0 0 L 300 0"/>'
    assert drawn("L", svg_font(glyph)) == ["M 20.5000,20.5000 L 20.5000,27.5000 M 20.5000,27.5000 L 23.5000,27.5000"]


def test_points_stay_dabs_and_closed_lines_stay_closed():
    assert drawn("i")[0].endswith(" M 20.5000,20.5000 L 20.5000,20.5000")
    document, _ = text_svg("o", svg_font(), size_mm=10)
    (path,) = paths(document)
    assert path.get("d") == "M 20.5000,23.5000 L 23.5000,23.5000 L 23.5000,20.5000 L 20.5000,20.5000 Z"


def test_ink_bounds_come_from_the_curve_not_its_handles():
    """The bounds of the ink come from the curve, not from its handles.

    The handles reach up to 400, the curve itself to 300.
    """
    (d,) = drawn("\u00e9")
    assert d == "M 20.5000,23.5000 C 20.5000,19.5000 23.5000,19.5000 23.5000,23.5000"


def test_every_path_command_agrees_with_svgpathtools():
    """Every path command agrees with svgpathtools.

    Tilted arcs are left to the next test: svgpathtools 1.8 turns them the wrong way under a flip.
    """
    d = "M 10 20 l 30 40 h 50 V 300 q 50 60 80 0 t 90 10 c 10 20 30 40 50 -60 s 40 20 90 0 A 90 60 0 0 1 300 40 z"
    ours = svgpathtools.parse_path(drawn("x", svg_font(f'<glyph unicode="x" d="{d} m 5 5 l 9 9"/>'))[0])
    theirs = svgpathtools.parse_path(d + " m 5 5 l 9 9")
    flip = 0.01  # mm per font unit
    shift = ours[0].start - complex(theirs[0].start.real, -theirs[0].start.imag) * flip
    lengths = [part.length() for part in (ours, theirs)]
    assert lengths[0] == pytest.approx(lengths[1] * flip, abs=1e-3)
    for segment in theirs:
        target = [complex(z.real, -z.imag) * flip + shift for z in (segment.point(0.3), segment.point(0.8))]
        for z in target:
            assert min(abs(near.point(near.radialrange(z)[0][1]) - z) for near in ours) < 2e-4


def test_a_tilted_arc_is_mirrored_with_its_letter():
    """A tilted arc is mirrored with its letter.

    The arc is tilted by 30 degrees, drawn as in SVG's appendix B.2.4, and mirrored by hand.
    """
    arc = svgpathtools.parse_path("M 0 0 A 300 100 30 0 1 400 50")
    ours = svgpathtools.parse_path(drawn("x", svg_font('<glyph unicode="x" d="M 0 0 A 300 100 30 0 1 400 50"/>'))[0])
    for t in (0.2, 0.5, 0.9):
        z = arc.point(t)
        target = complex(z.real, -z.imag) * 0.01 + ours[0].start
        assert min(abs(part.point(part.radialrange(target)[0][1]) - target) for part in ours) < 3e-4


def test_a_new_line_starts_below_the_first():
    one, two = drawn("I\nI", line_spacing=1.5)
    assert one == "M 20.5000,27.5000 L 20.5000,20.5000"
    assert two == "M 20.5000,42.5000 L 20.5000,35.5000"
    assert drawn("I\r\nI") == drawn("I\rI") == drawn("I\nI")
    assert len(drawn("I\n\nI")) == 2


def test_the_longest_ligature_is_used():
    document, _ = text_svg("ffiffi f", svg_font(), size_mm=10)
    assert [path.get("id") for path in paths(document)] == ["glyph-1-ffi", "glyph-2-ffi", "glyph-3-f"]
    document, _ = text_svg("fff", svg_font(), size_mm=10)
    assert [path.get("id") for path in paths(document)] == ["glyph-1-f", "glyph-2-f", "glyph-3-f"]


def test_the_first_of_two_glyphs_for_a_character_is_used():
    assert drawn("I", svg_font(GLYPHS + '<glyph unicode="I" d="M 0 0 L 9 9"/>')) == drawn("I")


def test_a_letter_and_its_accent_use_the_composed_glyph():
    assert drawn("e\u0301") == drawn("\u00e9")


@pytest.mark.parametrize(
    "kern",
    [
        'u1="T" u2="I"',
        'u1="x, T ,y" u2="a,I"',
        'g1="T" g2="I"',
        'g1="a,T" u2="U+49"',
        'u1="U+0050-0054" u2="U+4?"',
        'u1="T" u2="I" id="first"/><hkern k="999" u1="T" u2="I"',
    ],
)
def test_kerning_moves_the_next_glyph(kern):
    glyphs = GLYPHS + f'<hkern k="150" {kern}/>'
    # T is 400 wide and the line of I is at 100: 5 mm without kerning, 3.5 mm with it. No other pair is moved.
    assert starts("TI", glyphs) == [0, 3.5]
    assert starts("TTIT I", glyphs) == [0, 4, 7.5, 8.5, 16.5]


@pytest.mark.parametrize("kern", ['u1="T" u2="o"', 'u1="I" u2="T"', 'u1="U+0055-0060" u2="I"', 'g1="T"', 'u2="I"'])
def test_kerning_does_not_affect_other_pairs(kern):
    assert starts("TI", GLYPHS + f'<hkern k="150" {kern}/>') == [0, 5]


def test_a_comma_can_be_kerned():
    assert starts("T,", GLYPHS + '<hkern k="150" u1="T" u2=","/>') == [0, 3]
    assert starts("T,", GLYPHS) == [0, 4.5]


def test_characters_without_a_glyph_are_left_out_and_named_once():
    document, notices = text_svg("I\u03a9\u03a9I\u20acZ", svg_font(), size_mm=10)
    assert [path.get("id") for path in paths(document)] == ["glyph-1-I", "glyph-2-I"]
    (notice,) = notices
    assert agrees(notice, "glyph-missing U+03A9 \u03a9 U+20AC \u20ac U+005A Z")
    assert notice.sentence.count("U+") == 3, "each once"
    _, (notice,) = text_svg("I" + "".join(map(chr, range(0x400, 0x420))), svg_font())
    assert agrees(notice, "glyph-missing U+040B 20")


def test_text_without_glyphs_is_refused():
    assert agrees(refusal("\u03a9", svg_font()), "nothing-to-paint U+03A9")
    assert agrees(refusal("  \n", svg_font()), "nothing-to-paint")
    assert agrees(refusal("", svg_font()), "text-empty")
    assert agrees(refusal("\x07", svg_font()), "nothing-to-paint U+0007")


def test_control_characters_are_dropped_and_markup_is_escaped():
    glyphs = '<glyph unicode="&amp;" d="M 0 0 L 9 9"/><glyph unicode="&lt;" d="M 0 0 L 9 9"/>'
    document, notices = text_svg('&<\x00"\x1b\ud800\uffff]]>', svg_font(glyphs))
    assert [path.get("id") for path in paths(document)] == ["glyph-1-u0026", "glyph-2-u003C"]
    assert ET.fromstring(document.encode()).find(SVG + "title").text == '&<"]]>'
    assert agrees(notices[0], "control-characters U+0000 U+001B U+D800 U+FFFF")


@pytest.mark.parametrize("end", ["\r", "\r\n", "\v", "\f", "\x85", "\u2028", "\u2029"])
def test_line_ends_of_other_programs_start_a_line(end):
    assert drawn(f"TI{end}T") == drawn("TI\nT")


def test_a_tab_is_a_space():
    assert drawn("T\tI") == drawn("T I")


@pytest.mark.parametrize(
    ("d", "expected"),
    [
        ("M 0 0 X 5 5", "glyph-damaged 7 'X 5 5'"),
        ("L 5 5", "glyph-damaged 1"),
        ("M 0 0 L 5", "glyph-damaged 10 end"),
        ("M 0 0 L 1e9 0", "glyph-damaged 1e6 7"),
        ("M 0 0 L 1e400 0", "glyph-damaged 1e6 7"),
    ],
)
def test_a_broken_glyph_is_skipped_and_keeps_its_advance(d, expected):
    glyphs = GLYPHS + f'<glyph unicode="x" glyph-name="ex" horiz-adv-x="300" d="{d}"/>'
    document, (notice,) = text_svg("IxIx", svg_font(glyphs), size_mm=10)
    assert [path.get("id") for path in paths(document)] == ["glyph-1-I", "glyph-2-I"]
    assert agrees(notice, expected, "glyph ex") and notice.damaged
    first, second = (float(path.get("d").split()[1].split(",")[0]) for path in paths(document))
    assert second - first == pytest.approx(5)


def test_unpainted_parts_of_a_glyph_are_reported():
    glyphs = GLYPHS + '<glyph unicode="m" d="M 0 0 M 1 1 L 2 2"/><glyph unicode="e"><path d="M 0 0 L 1 1"/></glyph>'
    _, notices = text_svg("me", svg_font(glyphs))
    assert [(notice.where, notice.code) for notice in notices] == [
        ("glyph m", "moveto-alone"),
        ("glyph e", "glyph-damaged"),
    ]


def test_filled_glyphs_in_an_svg_font_are_reported():
    _, notices = text_svg("oo", svg_font())
    assert [notice.code for notice in notices] == ["font-of-outlines"]


@pytest.mark.parametrize(
    ("font", "expected"),
    [
        (b"", "file-empty"),
        (b"GIF89a", "font-unknown"),
        (b"<html/>", "font-unknown <html>"),
        (b"<svg", "not-xml"),
        (svg_font(""), "font-damaged 'no glyph'"),
        (svg_font(face='units-per-em="0"'), "font-damaged units-per-em 0"),
        (svg_font(face='units-per-em="1000x"'), "font-damaged units-per-em 1000x"),
        (svg_font('<glyph unicode="I" d="M 0 0 L 1 1"/>', font=""), "font-damaged horiz-adv-x missing"),
        (
            svg_font('<glyph unicode="I" horiz-adv-x="1e999" d="M 0 0 L 1 1"/>'),
            "font-damaged horiz-adv-x 1e999",
        ),
        (svg_font(GLYPHS + '<hkern u1="I" u2="I" k="wide"/>'), "font-damaged k wide"),
    ],
)
def test_files_that_are_not_fonts_are_refused(font, expected):
    with refused(expected):
        text_svg("II", font)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_fonts_in_other_encodings_are_read(encoding):
    assert drawn("I", svg_font().decode().encode(encoding)) == drawn("I")


# Numbers and their ranges


@pytest.mark.parametrize("value", [0, -1, float("nan"), float("inf"), 1000.5])
def test_numbers_out_of_range_are_refused(value):
    reported = f"out-of-range {value:g}"
    assert agrees(refusal("I", svg_font(), size_mm=value), f"{reported} size '(0, 1000] mm'")
    assert agrees(refusal("I", svg_font(), width_mm=value), f"{reported} width")
    assert agrees(refusal("I", svg_font(), line_spacing=value), f"{reported} '(0, 100]'")
    if value != 1000.5:
        assert agrees(refusal("I", svg_font(), sheet_mm=(10, value)), f"{reported} sheet_mm")


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"size_mm": "20"}, "wrong-type 20 size"),
        ({"size_mm": None}, "wrong-type None size"),
        ({"size_mm": True}, "wrong-type True size"),
        ({"size_mm": 10**400}, "out-of-range inf size"),
        ({"width_mm": "1"}, "wrong-type 1 width"),
        ({"width_mm": 10**400}, "out-of-range inf width"),
        ({"line_spacing": None}, "wrong-type None spacing"),
        ({"line_spacing": [1]}, "wrong-type spacing"),
        ({"sheet_mm": 0}, "wrong-type 0 sheet_mm"),
        ({"sheet_mm": True}, "wrong-type True sheet_mm"),
        ({"sheet_mm": "9x9"}, "wrong-type 9x9 sheet_mm"),
        ({"sheet_mm": ()}, "wrong-type 0 2 sheet_mm"),
        ({"sheet_mm": (100,)}, "wrong-type 1 2 sheet_mm"),
        ({"sheet_mm": (100, "60")}, "wrong-type 60 sheet_mm"),
        ({"sheet_mm": (100, 10**400)}, "out-of-range inf sheet_mm"),
        ({"sheet_mm": np.zeros((2, 2))}, "wrong-type sheet_mm"),
    ],
)
def test_values_that_are_no_numbers_are_refused_in_a_sentence(options, expected):
    assert agrees(refusal("I", svg_font(), **options), expected)


def test_an_array_of_two_numbers_is_a_sheet():
    given = {"size_mm": 10.0, "width_mm": 0.5, "line_spacing": 1.5, "sheet_mm": (100, 60)}
    arrays = {"size_mm": np.int64(10), "width_mm": Fraction(1, 2), "line_spacing": np.float32(1.5)}
    assert text_svg("I\nI", svg_font(), **arrays, sheet_mm=np.array([100, 60])) == text_svg("I\nI", svg_font(), **given)


def test_text_is_centred_on_a_given_sheet_or_refused():
    assert drawn("T", sheet_mm=(100, 60)) == ["M 48.0000,26.5000 L 52.0000,26.5000 M 50.0000,26.5000 L 50.0000,33.5000"]
    assert drawn("T", sheet_mm=(5, 8)) == ["M 0.5000,0.5000 L 4.5000,0.5000 M 2.5000,0.5000 L 2.5000,7.5000"]
    reported = refusal("T", svg_font(), size_mm=10, sheet_mm=(4.9, 60))
    assert agrees(reported, "text-does-not-fit '5.00 x 8.00 mm' '4.9 x 60 mm' --size --sheet")
    reported = refusal("T", svg_font(), size_mm=10, sheet_mm=(60, 7.9))
    assert agrees(reported, "text-does-not-fit '60 x 7.9 mm'")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("text", ["I", "T", "TT\nI", "TIT\nT\nT\nT"])
@pytest.mark.parametrize("sheet_mm", [(4.9, 60), (60, 7.9), (3.3, 3.1), (1.01, 60)])
def test_the_advised_size_fits_and_is_hardly_smaller_than_the_largest(text, sheet_mm):
    reported = refusal(text, svg_font(), size_mm=123, sheet_mm=sheet_mm)
    size_mm = float(re.search(r"--size ([\d.]+)", reported.advice).group(1))
    assert drawn(text, size_mm=size_mm, sheet_mm=sheet_mm)
    assert agrees(refusal(text, svg_font(), size_mm=size_mm * 1.02, sheet_mm=sheet_mm), "text-does-not-fit")
    reported = refusal("T", svg_font(), size_mm=10, width_mm=5, sheet_mm=(4.9, 60))
    assert agrees(reported, "text-does-not-fit --width --sheet")


def test_overlong_text_is_refused():
    assert agrees(refusal("I" * 100_001, svg_font()), "text-too-long 100001 100000")
    assert agrees(refusal("T" * 3000, svg_font(), size_mm=1000), "text-too-long '[0, 1e6] mm'")
    heavy = svg_font(f'<glyph unicode="x" d="M 0 0{" L 1 1 L 0 0" * 2000}"/>')
    assert agrees(refusal("x" * 1000, heavy), "text-too-long 4000000")


def test_same_input_gives_the_same_bytes():
    assert text_svg("ffi TI", svg_font()) == text_svg("ffi TI", svg_font())


def test_right_to_left_text_is_reported():
    glyphs = GLYPHS + '<glyph unicode="\u05d0" d="M 0 0 L 9 9"/>'
    _, (notice,) = text_svg("I\n\u05d0", svg_font(glyphs))
    assert agrees(notice, "text-direction 2 TrueType")


# Outline fonts

FEATURES = """
feature kern { pos A V -200; pos A A <10 100 0 0>; } kern;
feature liga { sub f i by f_i; } liga;
"""


def outline_font(features=FEATURES):
    """Return a font with a few glyphs.

    The font has 1000 units to the em. The glyphs are a triangle A, its mirror V, bars for f, i and their
    ligature, and a curve o. The glyph .notdef has ink.
    """
    names = [".notdef", "space", "A", "V", "f", "i", "f_i", "o"]
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder(names)
    builder.setupCharacterMap({ord(c): c for c in "AVfio"} | {0x20: "space", 0xE000: ".notdef"})
    glyphs = {
        ".notdef": [(0, 0), (0, 900), (900, 0)],
        "space": [],
        "A": [(0, 0), (300, 700), (600, 0)],
        "V": [(0, 700), (600, 700), (300, 0)],
        "f": [(50, 0), (50, 700), (150, 700), (150, 0)],
        "i": [(50, 0), (50, 500), (150, 500), (150, 0)],
        "f_i": [(50, 0), (50, 700), (350, 700), (350, 0)],
    }
    shapes = {}
    for name, points in glyphs.items():
        pen = TTGlyphPen(None)
        if points:
            pen.moveTo(points[0])
            for point in points[1:]:
                pen.lineTo(point)
            pen.closePath()
        shapes[name] = pen.glyph()
    pen = TTGlyphPen(None)
    pen.moveTo((0, 0))
    pen.qCurveTo((300, 600), (600, 0))
    pen.closePath()
    shapes["o"] = pen.glyph()
    builder.setupGlyf(shapes)
    widths = {"space": 300, "f": 200, "i": 200, "f_i": 400}
    return finished(builder, widths, 600, features)


def finished(builder, widths, usual_width, features) -> bytes:
    """Return the font of a builder that has its glyphs. Glyphs that widths does not name have the usual width."""
    order = builder.font.getGlyphOrder()
    builder.setupHorizontalMetrics({name: (widths.get(name, usual_width), 0) for name in order})
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupNameTable({"familyName": "Test", "styleName": "Regular"})
    builder.setupOS2()
    builder.setupPost()
    if features:
        addOpenTypeFeaturesFromString(builder.font, features)
    builder.font.recalcTimestamp = False
    return saved(builder.font)


@pytest.fixture(scope="module")
def ttf():
    return outline_font()


def filled(text, font, **options):
    """Return (id, d) of each glyph, and the notices."""
    document, notices = text_svg(text, font, **{"size_mm": 10, **options})
    return [(path.get("id"), path.get("d")) for path in paths(document)], notices


def test_a_width_for_outlines_is_reported_to_have_no_effect(ttf):
    document, notices = text_svg("A", ttf, size_mm=10, width_mm=3)
    assert agrees(notices[-1], "width-without-effect 3")
    assert text_svg("A", ttf, size_mm=10) == (document, notices[:-1])


def test_an_outline_glyph_is_filled_at_its_exact_position(ttf):
    document, _ = text_svg("A", ttf, size_mm=10, width_mm=3)
    root = ET.fromstring(document.encode())
    assert root.get("viewBox") == "0 0 46 47"
    (path,) = paths(document)
    assert path.attrib == {
        "id": "glyph-1-A",
        "fill": "#000000",
        "fill-rule": "nonzero",
        "stroke": "none",
        "data-brushsvg-script": "latin",
        "d": "M 20.0000,27.0000 L 23.0000,20.0000 L 26.0000,27.0000 Z",
    }


def test_quadratic_curves_become_equal_cubics(ttf):
    (glyph,), _ = filled("o", ttf)
    assert glyph[1] == "M 20.0000,23.0000 C 22.0000,19.0000 24.0000,19.0000 26.0000,23.0000 Z"


def test_outline_glyphs_are_kerned_and_ligatures_joined(ttf):
    glyphs, _ = filled("AVA", ttf)
    assert [d.split()[1] for _, d in glyphs] == ["20.0000,27.0000", "24.0000,20.0000", "30.0000,27.0000"]
    glyphs, _ = filled("fi i", ttf)
    assert [name for name, _ in glyphs] == ["glyph-1-fi", "glyph-2-i"]
    glyphs, _ = filled("fi", outline_font(""))
    assert [name for name, _ in glyphs] == ["glyph-1-f", "glyph-2-i"]


def test_a_glyph_is_raised_as_the_font_specifies(ttf):
    """A glyph is raised as the font specifies.

    The pair A A moves its first letter 10 to the right and 100 up.
    """
    glyphs, _ = filled("AA", ttf)
    assert [d.split()[1] for _, d in glyphs] == ["20.0000,27.0000", "25.9000,28.0000"]


def test_outline_text_may_have_several_lines(ttf):
    glyphs, _ = filled("A\n A", ttf, line_spacing=2)
    assert [d.split()[1] for _, d in glyphs] == ["20.0000,27.0000", "23.0000,47.0000"]


def test_a_missing_outline_glyph_is_left_out_without_a_box(ttf):
    glyphs, (notice,) = filled("A\u03a9A", ttf)
    assert [d.split()[1] for _, d in glyphs] == ["20.0000,27.0000", "26.0000,27.0000"]
    assert agrees(notice, "glyph-missing U+03A9 \u03a9")
    assert agrees(refusal("\u03a9", ttf), "nothing-to-paint U+03A9")
    assert agrees(refusal("\ue000", ttf), "nothing-to-paint U+E000")


def font_of_bars(characters: str, features="", accents="") -> bytes:
    """Return a font with a bar for each character. Each glyph is 200 units wide, accents have no width."""
    names = {character: f"uni{ord(character):04X}" for character in characters + accents}
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder([".notdef", "space", *names.values()])
    builder.setupCharacterMap({ord(character): name for character, name in names.items()} | {0x20: "space"})
    pen = TTGlyphPen(None)
    for k, point in enumerate([(50, 0), (50, 700), (150, 700), (150, 0)]):
        (pen.lineTo if k else pen.moveTo)(point)
    pen.closePath()
    bar, empty = pen.glyph(), TTGlyphPen(None).glyph()
    builder.setupGlyf({".notdef": empty, "space": empty} | dict.fromkeys(names.values(), bar))
    widths = {names[accent]: 0 for accent in accents}
    return finished(builder, widths, 200, features)


def bars(text, font):
    """Return (character, place from the left) of each bar in the order of painting, and the notices."""
    document, notices = text_svg(text, font, size_mm=10)
    found = [(path.get("id").split("-")[2], float(path.get("d").split()[1].split(",")[0])) for path in paths(document)]
    letters = [re.sub("u([0-9A-F]{4})", lambda code: chr(int(code[1], 16)), name) for name, _ in found]
    return [(letter, round((x - 20) / 2)) for letter, (_, x) in zip(letters, found, strict=True)], notices


def read_from_the_left(text, font):
    found, notices = bars(text, font)
    assert notices == []
    return "".join(letter for letter, _ in sorted(found, key=lambda bar: bar[1]))


def test_letters_from_right_to_left_are_painted_in_the_order_of_reading():
    font = font_of_bars("\u05d0\u05d1\u05d2", accents="\u05b0")
    assert bars("\u05d0\u05d1 \u05d2", font) == ([("\u05d0", 3), ("\u05d1", 2), ("\u05d2", 0)], [])
    letter, accent = bars("\u05d0\u05b0\u05d1", font)[0][:2]
    assert letter == accent == ("\u05d0\u05b0", 1)
    glyphs, _ = text_svg("\u05d0\u05b0", font)
    assert len(paths(glyphs)) == 2


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ab \u05d0\u05d1 12", "ab12\u05d1\u05d0"),
        ("\u05d0\u05d1 12 ab", "ab12\u05d1\u05d0"),
        ("\u05d0 1,2-2 \u05d1", "\u05d11,2-2\u05d0"),
        ("ab, 12", "ab,12"),
        ("12 \u05d0", "\u05d012"),
        ("a \u05d0, \u05d1 b", "a\u05d1,\u05d0b"),
        ("\u05d0 (ab) 12", "12)ab(\u05d0"),  # mirrored brackets
        ("ab (\u05d0) \u05d1", "ab(\u05d0)\u05d1"),
    ],
)
def test_numbers_and_words_of_other_directions_keep_their_order(text, expected):
    assert read_from_the_left(text, font_of_bars("ab12,-()\u05d0\u05d1")) == expected


def test_lines_from_right_to_left_begin_at_the_right():
    font = font_of_bars("ab\u05d0\u05d1")
    assert bars("abab\n\u05d0\u05d1\nb", font)[0][4:] == [("\u05d0", 3), ("\u05d1", 2), ("b", 0)]


def test_each_script_of_a_line_is_shaped_by_its_own_rules():
    """Each script of a line is shaped by its own rules.

    In Devanagari, the vowel I stands before its consonant. The font joins the two glyphs in this order only.
    """
    rules = "languagesystem dev2 dflt; feature pres { sub uni093F uni0915 by uni0062; } pres;"
    font = font_of_bars("ab\u0915\u093f", rules)
    assert [found[0] for found in bars("a \u0915\u093f", font)[0]] == ["a", "\u0915\u093f"]
    document, _ = text_svg("a \u0915\u093f", font)
    assert [path.get("d").count("Z") for path in paths(document)] == [1, 1]


@pytest.mark.parametrize(
    ("word", "script"),
    [
        ("\u0995\u09b2", "devanagari"),  # Bengali
        ("\u0a15\u0a32", "devanagari"),  # Gurmukhi
        ("\u0721\u0720", "arabic"),  # Syriac
        ("\u07de\u07ca", "arabic"),  # N'Ko
        ("\U0001e900\U0001e923", "arabic"),  # Adlam
    ],
)
def test_a_word_of_a_joined_script_is_one_shape(word, script):
    document, _ = text_svg(word, font_of_bars(word))
    (path,) = paths(document)
    assert path.get("data-brushsvg-script") == script and path.get("d").count("Z") == len(word)


@pytest.mark.parametrize(
    ("character", "script"), [("\u6c38", "cjk"), ("\u3042", "cjk"), ("\uc655", None), ("\u05d0", "latin")]
)
def test_a_character_has_the_script_by_which_it_is_written(character, script):
    document, _ = text_svg(character, font_of_bars(character))
    (path,) = paths(document)
    assert path.get("data-brushsvg-script") == script


def test_letters_that_a_font_joins_by_graphite_are_reported():
    font = TTFont(io.BytesIO(font_of_bars("a\u0628")))
    font["Silf"] = DefaultTable("Silf")
    font["Silf"].data = bytes(16)
    assert bars("a", saved(font))[1] == []
    assert are_reported(bars("a\u0628", saved(font))[1], "font-rules-unread Graphite")
    addOpenTypeFeaturesFromString(font, "feature liga { sub uni0628 by uni0061; } liga;")
    assert bars("a\u0628", saved(font))[1] == []


def test_marks_of_direction_are_reported():
    _, notices = bars("a\u202e\u05d0\u202c", font_of_bars("a\u05d0"))
    assert are_reported(notices, "text-direction 1 U+202E")


def repacked(ttf, flavor):
    font = TTFont(io.BytesIO(ttf))
    font.flavor = flavor
    out = io.BytesIO()
    font.save(out)
    return out.getvalue()


def test_woff_is_unpacked_and_woff2_refused(ttf):
    assert filled("AV fi", repacked(ttf, "woff")) == filled("AV fi", ttf)
    assert agrees(refusal("A", b"wOF2" + bytes(60)), "font-unknown WOFF2 brotli FILE")


def test_a_woff_bomb_is_refused(ttf, monkeypatch):
    monkeypatch.setattr("brushsvg.read.text.outline_font._MAX_UNPACKED_BYTES", 500)
    assert agrees(refusal("A", repacked(ttf, "woff")), "file-too-large 500")


def test_the_first_font_of_a_collection_is_used(ttf):
    """The first font of a collection is used.

    The test puts a collection header before one font and moves the offsets of its tables accordingly.
    """
    header = struct.pack(">4sHHLL", b"ttcf", 1, 0, 1, 16)
    count = struct.unpack(">H", ttf[4:6])[0]
    rows = [struct.unpack(">4sLLL", ttf[12 + 16 * k : 28 + 16 * k]) for k in range(count)]
    moved = b"".join(struct.pack(">4sLLL", tag, check, offset + 16, size) for tag, check, offset, size in rows)
    assert filled("AV", header + ttf[:12] + moved + ttf[12 + 16 * count :]) == filled("AV", ttf)


def test_outline_fonts_need_the_extra_and_line_fonts_do_not(ttf, monkeypatch):
    monkeypatch.delitem(sys.modules, "brushsvg.read.text.outline_font", raising=False)
    monkeypatch.delattr("brushsvg.read.text.outline_font", raising=False)
    monkeypatch.setitem(sys.modules, "uharfbuzz", None)
    reported = refusal("A", ttf)
    assert reported.code == "package-missing"
    assert sys.executable in reported.sentence and reported.sentence.endswith("install fonttools uharfbuzz")
    assert len(drawn("TI")) == 2


def test_damaged_fonts_give_a_drawing_or_a_refusal(ttf):
    woff = repacked(ttf, "woff")
    refusals = set()
    for font in (ttf, woff):
        for cut in (4, 12, 40, 200, len(font) // 2, len(font) - 40):
            refusals.add(outcome(font[:cut]))
        for at in range(4, len(font), 7):
            refusals.add(outcome(font[:at] + bytes([font[at] ^ 0xFF]) + font[at + 1 :]))
    assert None in refusals
    reported = [each for each in refusals if each and each.code == "font-damaged"]
    assert {"WOFF" in each.sentence for each in reported} == {False, True}


@pytest.mark.parametrize(
    ("tag", "at", "becomes", "expected"),
    [
        ("head", 18, b"\0\0", "font-damaged head 0 16 16384"),
        ("head", 18, b"\x40\x01", "font-damaged head 16385 16 16384"),
        ("head", None, b"", "font-damaged head missing 16 16384"),
        ("hhea", 34, b"\0\0", "font-damaged hmtx 0"),
        ("hhea", None, b"", "font-damaged hmtx 0"),
        ("hmtx", None, b"", "font-damaged hmtx 0"),
    ],
)
def test_a_font_without_a_valid_em_size_is_refused(ttf, tag, at, becomes, expected):
    """A font without a valid em size is refused.

    HarfBuzz would accept the font, with 1000 units to the em or with each letter an em wide.
    """
    row = next(k for k in range(12, len(ttf), 16) if ttf[k : k + 4] == tag.encode())
    offset = struct.unpack(">L", ttf[row + 8 : row + 12])[0]
    start = row if at is None else offset + at
    becomes = becomes or b"zzzz"  # the table gets another name
    with refused(expected):
        text_svg("AV", ttf[:start] + becomes + ttf[start + len(becomes) :])


def outcome(font):
    try:
        ET.fromstring(text_svg("AVfi o", font)[0])
    except Error as error:
        assert "\n" not in error.sentence
        return error


def test_recursive_composite_glyphs_terminate():
    """Reading composite glyphs that contain each other comes to an end.

    Each glyph contains the next one twice, and the last glyph contains the first one. Without a limit,
    reading would never end.
    """
    count = 40
    glyphs = [bytes(10)]  # .notdef is empty
    for k in range(count):
        parts = [struct.pack(">HHbb", more | 0x0002, (k + 1) % count + 1, 9, 0) for more in (0x0020, 0)]
        glyphs.append(struct.pack(">hhhhh", -1, 0, 0, 99, 99) + b"".join(parts))
    offsets = [sum(map(len, glyphs[:k])) for k in range(len(glyphs) + 1)]
    names = [".notdef", *(f"g{k}" for k in range(count))]
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder(names)
    builder.setupCharacterMap({65: "g0"})
    builder.setupGlyf({name: TTGlyphPen(None).glyph() for name in names})
    builder.setupHorizontalMetrics(dict.fromkeys(names, (600, 0)))
    builder.setupHorizontalHeader()
    sound = io.BytesIO()
    builder.font.save(sound)
    reader = SFNTReader(sound)
    tables = {tag: reader[tag] for tag in reader.keys()}  # noqa: SIM118
    head = bytearray(tables["head"])
    head[50:52] = b"\0\1"  # offsets have four bytes
    tables |= {
        "head": bytes(head),
        "glyf": b"".join(glyphs),
        "loca": struct.pack(f">{len(offsets)}L", *offsets),
    }
    hostile = io.BytesIO()
    writer = SFNTWriter(hostile, len(tables))
    for tag, data in tables.items():
        writer[tag] = data
    writer.close()
    glyph_set = TTFont(hostile).getGlyphSet()
    with pytest.raises(RecursionError):  # this shows that the font is as bad as intended
        glyph_set["A"].draw(DecomposingRecordingPen(glyph_set))
    assert agrees(refusal("A", hostile.getvalue()), "nothing-to-paint")


@pytest.mark.parametrize("text", ["A\n\nV", "A\nV\n", "\nA\nV", "A\n\ud800\nV"])
def test_empty_line_of_an_outline_font_is_left_blank(ttf, text):
    document, _ = text_svg(text, ttf)
    assert len(paths(document)) == 2


def reported_of(font, text="AV"):
    """Return the notices about a text, and how many glyphs were drawn."""
    document, notices = text_svg(text, font)
    return notices, len(paths(document))


def saved(font) -> bytes:
    out = io.BytesIO()
    font.save(out)
    return out.getvalue()


def test_letters_without_an_outline_are_named():
    """Letters without an outline are named.

    Fonts that hold pictures have letters of this kind. Characters that are blank by nature are not named.
    """
    font = TTFont(io.BytesIO(outline_font()))
    font["glyf"]["V"] = TTGlyphPen(None).glyph()
    reported, count = reported_of(saved(font), "A V\u00adA")
    assert count == 2 and are_reported(reported, "glyph-missing U+0056")
    blank = svg_font(GLYPHS + '<glyph unicode="x" horiz-adv-x="300"/>')
    reported, count = reported_of(blank, "I x")
    assert count == 1 and are_reported(reported, "glyph-missing U+0078")
    assert agrees(refusal("x", blank), "nothing-to-paint U+0078")
    font["glyf"]["space"], font["glyf"]["f_i"] = font["glyf"]["V"], font["glyf"]["V"]
    reported, _ = reported_of(saved(font), "A\u00a0fi")
    assert are_reported(reported, "glyph-missing 'U+0066 f, U+0069 i'")


def test_the_chosen_font_of_several_is_reported():
    font = TTFont(io.BytesIO(outline_font()))
    builder = FontBuilder(font=font)
    builder.setupFvar([("wght", 100, 350, 900, "Weight"), ("wdth", 50, 100, 200, "Width")], [])
    builder.setupGvar({name: [] for name in font.getGlyphOrder()})
    reported, count = reported_of(saved(font))
    assert count == 2 and are_reported(reported, "font-of-choices 'wght 350, wdth 100' wght=350")
    both = TTCollection()
    both.fonts = [TTFont(io.BytesIO(outline_font())), TTFont(io.BytesIO(outline_font(features="")))]
    reported, count = reported_of(saved(both), "fi")
    assert count == 1 and are_reported(reported, "font-of-choices 2 second.ttf")
    builder = FontBuilder(font=TTFont(io.BytesIO(outline_font())))
    builder.setupCOLR({"A": [("V", 0)]})
    builder.setupCPAL([[(1, 0, 0, 1)]])
    reported, count = reported_of(saved(builder.font))
    assert count == 2 and are_reported(reported, "font-of-colours")
