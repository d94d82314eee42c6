"""Text as a font sets it, before it has a place on a sheet."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass

from ..design import Notice, SubPath

_SCRIPTS = {"ARABIC": "arabic", "DEVANAGARI": "devanagari"} | dict.fromkeys(
    ("CJK", "HIRAGANA", "KATAKANA", "HANGUL", "BOPOMOFO", "KANGXI"), "cjk"
)  # by the first word of a character's name


@dataclass(frozen=True)
class Placed:
    """One glyph with ink. x_mm, y_mm: its origin from where its line of text begins, y down.

    label: the characters it stands for; subpaths: from its origin, in mm, y down; script: how it is written, one of
    drawing.SCRIPTS.
    """

    label: str
    subpaths: tuple[SubPath, ...]
    x_mm: float
    y_mm: float = 0.0
    script: str = "auto"


@dataclass(frozen=True)
class Setting:
    """A text: the glyphs of each line; filled: they are shapes, not lines to follow.

    missing: characters without a glyph, each once, in the order met; blank: those that should be seen and whose glyph
    has nothing to paint.
    """

    lines: tuple[tuple[Placed, ...], ...]
    filled: bool
    missing: tuple[str, ...] = ()
    notices: tuple[Notice, ...] = ()
    blank: tuple[str, ...] = ()


def is_seen(character: str) -> bool:
    """Whether there should be ink: of letters, figures, punctuation and symbols, but fillers and Braille's blank."""
    return unicodedata.category(character)[0] in "LNPS" and character not in "\u115f\u1160\u2800\u3164\uffa0"


def find_script(characters: str) -> str:
    """Return how characters are written: the script of the first one that is not written as Latin letters are."""
    names = (unicodedata.name(each, "").split(" ")[0] for each in characters)
    return next((_SCRIPTS[name] for name in names if name in _SCRIPTS), "latin")
