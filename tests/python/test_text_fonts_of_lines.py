"""Single-line fonts as TrueType are read as lines.

Their contours go back along themselves, or have two points.
"""

import numpy as np
import pytest
from diagnostics import are_reported
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen

from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg

GLYPHS = {
    "L": [[(100, 700), (100, 0), (500, 0)]],
    "A": [[(50, 0), (300, 700), (550, 0), (300, 700)], [(150, 250), (450, 250)]],
    "I": [[(100, 0), (100, 700)]],
    "V": [[(50, 700), (300, 0), (550, 700), (300, 0)]],
    "O": [[(300 + 300 * np.cos(a), 350 + 350 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 24, endpoint=False)]],
}


@pytest.fixture
def font(tmp_path):
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder([".notdef", *GLYPHS, "c"])
    builder.setupCharacterMap({ord(letter): letter for letter in [*GLYPHS, "c"]})
    glyphs = {".notdef": TTGlyphPen(None).glyph()}
    for letter, contours in GLYPHS.items():
        pen = TTGlyphPen(None)
        for first, *others in contours:
            pen.moveTo(tuple(map(round, first)))
            for point in others:
                pen.lineTo(tuple(map(round, point)))
            pen.closePath()
        glyphs[letter] = pen.glyph()
    glyphs["c"] = _loop()
    builder.setupGlyf(glyphs)
    builder.setupHorizontalMetrics({name: (650, 0) for name in glyphs})
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupNameTable({"familyName": "Lines", "styleName": "Regular"})
    builder.setupOS2()
    builder.setupPost()
    builder.save(tmp_path / "lines.ttf")
    return (tmp_path / "lines.ttf").read_bytes()


def _loop():
    """Return a glyph of one curve that ends where it begins."""
    pen = TTGlyphPen(None)
    pen.moveTo((100, 0))
    pen.qCurveTo((300, 700), (100, 0))
    pen.closePath()
    return pen.glyph()


def lines_of(font, letter):
    """Return the points (n, 2) of each line of a letter, in font units.

    The origin is the lower left corner of the letter.
    """
    document, reported = text_svg(letter, font, size_mm=100, width_mm=2)
    design = read_svg(document.encode())
    assert are_reported(reported, "font-of-lines") and all(not element.fill_rule for element in design.elements)
    lines = [np.vstack([s.cubics[:1, 0], s.cubics[:, 3]]) for e in design.elements for s in e.subpaths]
    corner = np.vstack(lines).min(axis=0)
    return [np.round((line - corner) * 10).astype(int).tolist() for line in lines]


def test_letters_are_read_as_their_drawn_lines(font):
    assert lines_of(font, "L") == [[[0, 700], [0, 0], [400, 0]]]
    assert lines_of(font, "I") == [[[0, 0], [0, 700]]]
    assert lines_of(font, "A") == [[[0, 0], [250, 700], [500, 0]], [[100, 250], [400, 250]]]
    assert lines_of(font, "V") == [[[0, 700], [250, 0], [500, 700]]]


def test_a_ring_stays_closed(font):
    (ring,) = lines_of(font, "O")
    assert ring[0] == ring[-1] and len(ring) == 25


def test_a_contour_of_one_curve_is_kept(font):
    (loop,) = lines_of(font, "c")
    assert loop[0] == loop[-1]
