"""Typeset text, before it is placed on a sheet."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass

from ..design import Notice, SubPath

# Scripts by the first word of a character's name in Unicode.
_SCRIPTS = {
    word: script
    for script, words in {
        "arabic": ("ARABIC", "SYRIAC", "NKO", "ADLAM", "MANDAIC", "HANIFI"),  # joined, from right to left
        "devanagari": ("DEVANAGARI", "BENGALI", "GURMUKHI"),  # with a headline
        "cjk": ("CJK", "HIRAGANA", "KATAKANA", "BOPOMOFO", "KANGXI"),
        "auto": ("HANGUL",),  # has circles, and no character of the data for "cjk" has one
    }.items()
    for word in words
}


@dataclass(frozen=True)
class PlacedGlyph:
    """One glyph with ink.

    label: the characters that the glyph stands for.
    subpaths: relative to the origin of the glyph, in mm, y down.
    x_mm, y_mm: the origin of the glyph relative to the start of its line of text, y down.
    script: the writing system, one of read.SCRIPTS.
    """

    label: str
    subpaths: tuple[SubPath, ...]
    x_mm: float
    y_mm: float = 0.0
    script: str = "auto"


@dataclass(frozen=True)
class TypesetText:
    """A typeset text.

    lines: the glyphs of each line.
    filled: whether the glyphs are filled shapes, and not single lines.
    missing: characters without a glyph, each once, in the order of the text.
    notices: about the font and its glyphs.
    blank: characters that should be visible and whose glyph has nothing to paint.
    """

    lines: tuple[tuple[PlacedGlyph, ...], ...]
    filled: bool
    missing: tuple[str, ...] = ()
    notices: tuple[Notice, ...] = ()
    blank: tuple[str, ...] = ()


def should_have_ink(character: str) -> bool:
    """Whether a character should have ink.

    Letters, figures, punctuation and symbols have ink, except for fillers and Braille's blank.
    """
    return unicodedata.category(character)[0] in "LNPS" and character not in "\u115f\u1160\u2800\u3164\uffa0"


def needs_shaping(character: str) -> bool:
    """Whether a character is written from right to left, or is a mark with its place at another letter."""
    return unicodedata.bidirectional(character) in ("R", "AL") or unicodedata.category(character) in ("Mn", "Mc")


def find_script(characters: str) -> str:
    """Return the script of characters: the first script that is not "latin", if any."""
    names = (unicodedata.name(character, "").split(" ")[0] for character in characters)
    return next((_SCRIPTS[name] for name in names if name in _SCRIPTS), "latin")
