"""Read lengths such as "0.5in", "10mm", "5" or "25%", and write times in words.

No other module reads lengths that people or drawing programs wrote.
"""

from __future__ import annotations

import math
import re
from functools import lru_cache

from .errors import Error

MM_PER = {"mm": 1.0, "cm": 10.0, "q": 0.25, "in": 25.4, "pt": 25.4 / 72, "pc": 25.4 / 6, "px": 25.4 / 96}
PX_PER = {"mm": 96 / 25.4, "cm": 960 / 25.4, "q": 24 / 25.4, "in": 96.0, "pt": 96 / 72, "pc": 16.0, "px": 1.0}
PAPERS_MM = {
    "a2": (420.0, 594.0),
    "a3": (297.0, 420.0),
    "a4": (210.0, 297.0),
    "a5": (148.0, 210.0),
    "letter": (215.9, 279.4),
}
FONT_PX = 16.0  # size of a font if none is given
_OF_FONT = {"em": 1.0, "ex": 0.5, "rem": 1.0}

# Digits are spelled out because \d and float() also read the digits of other alphabets. Possessive
# quantifiers follow single characters only: after a group, Python before 3.11.5 keeps the text that a failed
# attempt consumed.
NUMBER = r"[+-]?(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]++)(?:[eE][+-]?[0-9]++)?"
_NUMBER = re.compile(NUMBER)
_LENGTH = re.compile(rf"({NUMBER})\s*([a-zA-Z]+|%|)")
_SIZE = re.compile(rf"({NUMBER}) ?(mm|cm|in|pt|pc|px|q|) ?x ?({NUMBER}) ?([a-z]*)")


def _shown(text: str) -> str:
    text = text.strip()
    return repr(text if len(text) <= 24 else text[:21] + "...")


@lru_cache
def _parts(text: str) -> tuple[float, str]:
    found = _LENGTH.fullmatch(text.strip())
    if not found:
        raise Error(f"{_shown(text)} is not a length; write for example 5mm, 0.2in or 14pt", code="not-a-length")
    value, unit = float(found[1]), found[2].lower()
    if not math.isfinite(value):
        raise Error(f"{_shown(text)} is too large to be a length", code="not-a-length")
    if unit not in MM_PER and unit not in ("", "%", *_OF_FONT):
        raise Error(f"{_shown(text)} has a unit that is not read; use one of mm cm in pt pc px Q", code="not-a-length")
    return value, unit


def number(text: str) -> float:
    """Read a finite number in SVG's notation; raise Error for any other text."""
    value = float(text) if _NUMBER.fullmatch(text := text.strip()) else math.nan
    if not math.isfinite(value):
        raise Error(f"{_shown(text)} is not a number", code="not-a-number")
    return value


def length_mm(text: str, default_unit: str = "mm") -> float:
    """Read a length in mm; a number without a unit is in default_unit.

    Raises Error if the text is not a length, is a percentage, or is relative to the size of a font.
    """
    value, unit = _parts(text)
    if unit == "%":
        raise Error(f"{_shown(text)} is a percentage, but there is nothing to take it of", code="not-a-length")
    if unit in _OF_FONT:
        sentence = f"{_shown(text)} is in sizes of a font, but there is no font; use one of mm cm in pt pc px Q"
        raise Error(sentence, code="not-a-length")
    unit = unit or default_unit
    length = value * MM_PER[unit]
    # 8.5in are 215.9 mm, not 215.89999999999998.
    return float(f"{length:.15g}") if unit in ("in", "pt", "pc") else length


def length_px(text: str, percent_of: float, em_px: float = FONT_PX) -> float:
    """Read a length in px, the user unit of SVG (96 per inch).

    percent_of: the length [px] of 100 %. em_px: the size of the font for em and ex.
    """
    value, unit = _parts(text)
    if unit and not text.rstrip()[-len(unit) - 1].strip():  # people write "5 mm", but browsers do not read it
        raise Error(f"{_shown(text)} has a blank before its unit", code="not-a-length")
    if unit in _OF_FONT:
        return value * (FONT_PX if unit == "rem" else em_px * _OF_FONT[unit])
    return value * percent_of / 100 if unit == "%" else value * PX_PER[unit or "px"]


def size_mm(text: str) -> tuple[float, float]:
    """Read a width and a height in mm from "210x297", "8.5x11in" or "210mm x 297mm".

    A unit at the end applies to both numbers.
    """
    found = _SIZE.fullmatch(" ".join(text.lower().split()))
    if not found:
        raise Error(f"{_shown(text)} is not a size; write for example 210x297mm or 8.5x11in", code="not-a-size")
    height_unit = found[4]
    size = length_mm(found[1] + (found[2] or height_unit)), length_mm(found[3] + height_unit)
    for value in size:
        if not 0 < value <= 1e6:
            sentence = f"{value} mm in the size {_shown(text)} is outside the range (0, 1000000] mm"
            raise Error(sentence, value=value, range=(0.0, 1e6), code="out-of-range")
    return size


def paper_mm(text: str) -> tuple[float, float]:
    """Read a paper's name or size as width and height in mm. Raises Error if the text is neither."""
    return PAPERS_MM.get(text.strip().lower()) or size_mm(text)


def clock(seconds: float) -> str:
    """Format a time for people, for example "1 min 19 s"."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"
