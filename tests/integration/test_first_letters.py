"""In scripts with joined letters, the first letter is painted first, dots and headline last."""

import io

import numpy as np
import pytest
import uharfbuzz
from fontTools.ttLib import TTFont

from brushsvg import _core
from brushsvg.read.svg import read_svg
from brushsvg.read.text import text_svg
from brushsvg.strokes.extraction import strokes

PACKAGES = {"@fontsource/noto-naskh-arabic": "5.3.0", "@fontsource/noto-sans-devanagari": "5.3.0"}
SIZE_MM = 50.0
ARABIC = "سلام كتاب بيت شمس قمر مدرسة باب نور حب خط قلم ورد بحر جبل سماء طريق مدينة شجرة زهرة بن".split()
DEVANAGARI = "नमस्ते भारत पानी कमल घर किताब राम सीता फल जल वन नदी सूरज चाँद पुस्तक विद्या मन आकाश बादल हिन्दी गगन".split()
DOT_SHARE = 0.25  # a line is a dot if it is shorter than this share of the longest one
TOLERANCE = 1.15  # a letter extends slightly beyond its advance


@pytest.fixture(scope="module")
def fonts(npm):
    modules = npm("scripts", PACKAGES)

    def get(name: str, script: str) -> bytes:
        font = TTFont(modules / "@fontsource" / name / "files" / f"{name}-{script}-400-normal.woff")
        font.flavor = None  # HarfBuzz reads no WOFF
        unpacked = io.BytesIO()
        font.save(unpacked)
        return unpacked.getvalue()

    return get


def painted(word: str, font: bytes) -> list[np.ndarray]:
    """Return the lines (n, 2) of a word, in the order in which they are painted."""
    document, _ = text_svg(word, font, size_mm=SIZE_MM)
    made, _ = strokes(read_svg(document.encode()))
    return [np.asarray(_core.flatten(stroke, 0.05))[:, :2] for stroke in made]


def first_advance_mm(word: str, font: bytes) -> float:
    """Return the width of the first letter, with the marks and half letters that HarfBuzz counts to it."""
    face = uharfbuzz.Face(font)
    buffer = uharfbuzz.Buffer()
    buffer.add_str(word)
    buffer.guess_segment_properties()
    uharfbuzz.shape(uharfbuzz.Font(face), buffer)
    glyphs = zip(buffer.glyph_infos, buffer.glyph_positions, strict=True)
    return sum(at.x_advance for glyph, at in glyphs if glyph.cluster == 0) * SIZE_MM / face.upem


@pytest.mark.parametrize("word", ARABIC)
def test_arabic_words_start_with_the_first_letter_and_end_with_dots(fonts, word):
    font = fonts("noto-naskh-arabic", "arabic")
    lines = painted(word, font)
    every = np.vstack(lines)
    first = lines[0]
    begins = every[:, 0].max() - TOLERANCE * first_advance_mm(word, font)
    assert first[0, 0] > begins or first[:, 0].mean() > begins
    assert first[0, 0] > first[-1, 0] or first[:, 0].mean() > begins, "joined letters are written to the left"
    assert not is_dot(lines)[0]


@pytest.mark.parametrize("word", DEVANAGARI)
def test_devanagari_words_start_with_the_first_letter_and_end_with_the_headline(fonts, word):
    font = fonts("noto-sans-devanagari", "devanagari")
    lines = painted(word, font)
    assert lines[0][:, 0].mean() < np.vstack(lines)[:, 0].min() + TOLERANCE * first_advance_mm(word, font)
    width, height = np.ptp(lines[-1], axis=0)
    assert height < 0.25 * width, "the headline is flat"


def is_dot(lines: list[np.ndarray]) -> list[bool]:
    spans = [float(np.ptp(line, axis=0).max()) for line in lines]
    return [span < DOT_SHARE * max(spans) for span in spans]
