"""Text in a font to a drawing: an SVG document in mm, one path a glyph."""

from __future__ import annotations

import math
import unicodedata

from ...errors import Error, lacking, need, need_one_of
from .. import SCRIPTS
from ..design import Notice
from . import svg_font
from .page import document

_CHARACTERS = 100_000  # forty pages: more is a mistake
_OUTLINES = (b"\0\1\0\0", b"OTTO", b"true", b"ttcf", b"wOFF", b"wOF2")  # how such font files begin
_NAMED = 12  # characters without a glyph that a sentence names


def text_svg(
    text: str,
    font: bytes,
    *,
    size_mm: float = 20.0,
    width_mm: float | None = None,
    sheet_mm: tuple[float, float] | None = None,
    line_spacing: float = 1.4,
    script: str = "auto",
) -> tuple[str, list[Notice]]:
    """The SVG document of a text and what was noticed while setting it.

    font: what a font file holds, an SVG font (its lines are stroked with width_mm, 1 if None) or TrueType or OpenType
    (outlines, filled); size_mm: its em; sheet_mm: (w, h), None for the ink and 20 mm around it;
    line_spacing: from line to line, in ems; script: how the letters are written, "latin", "arabic", "devanagari",
    "cjk", or "auto": as their characters say. A newline starts a line; lines begin at the same x.

    Error if a number is out of range, the font cannot be read, or nothing of the text can be painted.
    """
    need(text, str, "a text")
    need(font, bytes, "what a font file holds, as bytes")
    need_one_of(script, SCRIPTS, "script")
    _in_range("size", size_mm, 1000, " mm")
    _in_range("width", 1.0 if width_mm is None else width_mm, 1000, " mm")
    _in_range("line spacing", line_spacing, 100)
    for side_mm in sheet_mm or ():
        _in_range("a side of the sheet", side_mm, 1e6, " mm")
    if not text:
        raise Error("the text is empty", "text", code="text-empty")
    if len(text) > _CHARACTERS:
        sentence = f"the text has {len(text)} characters, beyond the limit of {_CHARACTERS}"
        raise Error(sentence, "text", len(text), (1, _CHARACTERS), code="text-too-long")
    text, notices = _without_controls(text)
    setter = _setter(font)
    setting = setter.set_lines(font, text.split("\n"), size_mm)
    notices += setting.notices
    if setting.missing:
        notices.append(
            Notice(
                "text",
                f"the font has no glyph for {_listed(setting.missing)}: left out",
                code="glyph-missing",
            )
        )
    if setting.blank:
        sentence = f"the font has no outline for {_listed(setting.blank)}: left out"
        notices.append(Notice("text", sentence, code="glyph-missing"))
    notices += _directions(text, setting.filled)
    if not any(setting.lines):
        said = "; ".join(notice.sentence for notice in notices if notice.where != "font")
        raise Error(
            "the text leaves nothing to paint" + (f": {said}" if said else ""),
            "text",
            code="nothing-to-paint",
        )
    if setting.filled and width_mm is not None:
        sentence = f"the width {width_mm:g} mm has no effect: the font has outlines, not single lines"
        notices.append(Notice("font", sentence, code="width-without-effect"))
    stroke_mm = 0.0 if setting.filled else width_mm or 1.0
    return document(setting, text, line_spacing * size_mm, stroke_mm, sheet_mm, script), notices


def _in_range(name: str, value: float, most: float, unit: str = "") -> None:
    if not (math.isfinite(value) and 0 < value <= most):
        raise Error(
            f"{name} {value:g}{unit} is outside the range (0, {most:g}]{unit}",
            "",
            value,
            (0, most),
            code="out-of-range",
        )


def _without_controls(text: str) -> tuple[str, list[Notice]]:
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    kept = "".join(each for each in text if each == "\n" or not _is_control(each))
    if kept == text:
        return text, []
    dropped = dict.fromkeys(each for each in text if each != "\n" and _is_control(each))
    return kept, [
        Notice(
            "text",
            f"control characters are not painted: {_listed(tuple(dropped))} left out",
            code="control-characters",
        )
    ]


def _directions(text: str, shaped: bool) -> list[Notice]:
    """Lines that need an order of runs, which nobody here finds: a wrong order looks like a right one."""
    notices = []
    for number, line in enumerate(text.split("\n"), 1):
        kinds = {unicodedata.bidirectional(each) for each in line}
        if not kinds & {"R", "AL"}:
            continue
        if not shaped:
            notices.append(
                Notice(
                    "text",
                    f"line {number} is set from left to right, as SVG fonts are",
                    code="text-direction",
                )
            )
        elif kinds & {"L", "EN", "AN"}:
            sentence = f"line {number} holds writing in two directions and is set in one: check its order"
            notices.append(Notice("text", sentence, code="text-direction"))
    return notices


def _is_control(character: str) -> bool:
    """Also what XML cannot say: halves of surrogate pairs and two numbers that are no characters."""
    return unicodedata.category(character) in ("Cc", "Cs") or character in "\ufffe\uffff"


def _listed(characters: tuple[str, ...]) -> str:
    named = [
        f"U+{ord(each):04X}" + (f" {each}" if each.isprintable() and not each.isspace() else "")
        for each in characters[:_NAMED]
    ]
    more = len(characters) - len(named)
    return ", ".join(named) + (f" and {more} more" if more else "")


def _setter(font: bytes):
    if not font.strip():
        raise Error("the font file is empty", code="file-empty")
    if font.startswith(_OUTLINES):
        try:
            from . import outline_font
        except ImportError:
            raise lacking("outline fonts need", "fonttools", "uharfbuzz") from None
        return outline_font
    if font.lstrip(b"\xef\xbb\xbf\xff\xfe\0 \t\r\n").startswith(b"<"):
        return svg_font
    raise Error(
        "this is not a font that can be read: known are SVG fonts (.svg), TrueType and OpenType",
        code="font-unknown",
    )
