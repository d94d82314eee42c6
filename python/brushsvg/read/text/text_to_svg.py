"""Convert text in a font to an SVG document in mm, with one path per glyph."""

from __future__ import annotations

import re
import unicodedata

from ...errors import Error, as_number, missing_packages_error, need_numbers, need_one_of, require_type
from .. import SCRIPTS, SIZE_MM
from ..design import Notice
from . import svg_font
from .page import svg_document

_MAX_CHARACTERS = 100_000  # forty pages; a longer text is a mistake
# First bytes of outline fonts.
_OUTLINE_FONT_STARTS = (b"\0\1\0\0", b"OTTO", b"true", b"ttcf", b"wOFF", b"wOF2")
_MAX_NAMED_CHARACTERS = 12  # characters without a glyph that a sentence names
_LINE_ENDS = re.compile("\r\n|[\r\v\f\x85\u2028\u2029]")  # how texts of other programs end lines
_DIRECTION_MARKS = ("LRE", "RLE", "LRO", "RLO", "LRI", "RLI", "FSI")  # bidirectional classes


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
    """Return the SVG document of a text, and notices about the text and the font.

    A newline starts a line. All lines from left to right begin at the same x, as do those from right to left. The first
    letter of a line decides about its direction.

    font: the content of a font file. The lines of an SVG font are stroked with width_mm. The outlines of a TrueType
    or OpenType font are filled.
    size_mm: the em of the font.
    width_mm: width of the strokes, 1 mm if None.
    sheet_mm: (width, height), None for the bounding box of the ink plus a margin of 20 mm.
    line_spacing: distance of the lines in ems.
    script: the writing system: "latin", "arabic", "devanagari", "cjk", or "auto" to find it from the characters.

    Raises Error if a number is out of range, the font cannot be read, or nothing of the text can be painted.
    """
    require_type(text, str, "a text")
    require_type(font, bytes, "the content of a font file, as bytes")
    need_one_of(script, SCRIPTS, "script")
    size_mm = _checked("size", size_mm, 1000, " mm")
    width_mm = None if width_mm is None else _checked("width", width_mm, 1000, " mm")
    line_spacing = _checked("line spacing", line_spacing, 100)
    sheet_mm = None if sheet_mm is None else need_numbers(sheet_mm, "sheet_mm", 2, *SIZE_MM)
    if not text:
        raise Error("the text is empty", "text", code="text-empty")
    if len(text) > _MAX_CHARACTERS:
        sentence = f"the text has {len(text)} characters, beyond the limit of {_MAX_CHARACTERS}"
        raise Error(sentence, "text", len(text), (1, _MAX_CHARACTERS), code="text-too-long")
    text, notices = _remove_controls(text)
    font_module = _find_font_module(font)
    typeset = font_module.set_lines(font, text.split("\n"), size_mm)
    notices += typeset.notices
    if typeset.missing:
        notices.append(
            Notice(
                "text",
                f"the font has no glyph for {_list_characters(typeset.missing)}: left out",
                code="glyph-missing",
            )
        )
    if typeset.blank:
        sentence = f"the font has no outline for {_list_characters(typeset.blank)}: left out"
        notices.append(Notice("text", sentence, code="glyph-missing"))
    notices += _direction_notices(text, font_module is not svg_font)
    if not any(typeset.lines):
        reasons = "; ".join(notice.sentence for notice in notices if notice.where != "font")
        raise Error(
            "the text has nothing to paint" + (f": {reasons}" if reasons else ""),
            "text",
            code="nothing-to-paint",
        )
    if typeset.filled and width_mm is not None:
        sentence = f"the width {width_mm:g} mm has no effect: the font has outlines, not single lines"
        notices.append(Notice("font", sentence, code="width-without-effect"))
    stroke_mm = 0.0 if typeset.filled else width_mm or 1.0
    return svg_document(typeset, text, size_mm, line_spacing, stroke_mm, sheet_mm, script), notices


def _checked(name: str, value: float, maximum: float, unit: str = "") -> float:
    number = as_number(value, "a number", name)
    if not 0 < number <= maximum:
        sentence = f"{name} {number:g}{unit} is outside the range (0, {maximum:g}]{unit}"
        raise Error(sentence, "", number, (0, maximum), code="out-of-range")
    return number


def _remove_controls(text: str) -> tuple[str, list[Notice]]:
    """Return a text with newlines and blanks as its only controls, and a notice about the characters left out."""
    text = _LINE_ENDS.sub("\n", text).replace("\t", " ")
    kept = "".join(character for character in text if character == "\n" or not _is_control(character))
    if kept == text:
        return text, []
    dropped = dict.fromkeys(character for character in text if character != "\n" and _is_control(character))
    return kept, [
        Notice(
            "text",
            f"control characters are not painted: {_list_characters(tuple(dropped))} left out",
            code="control-characters",
        )
    ]


def _direction_notices(text: str, is_outline_font: bool) -> list[Notice]:
    """Return notices about lines whose writing directions are not read."""
    notices = []
    for number, line in enumerate(text.split("\n"), 1):
        directions = {unicodedata.bidirectional(character) for character in line}
        if not is_outline_font:
            if directions & {"R", "AL"}:
                sentence = f"line {number} is set from left to right, as SVG fonts are"
                advice = "use a TrueType or OpenType font"
                notices.append(Notice("text", sentence, code="text-direction", advice=advice))
            continue
        marks = dict.fromkeys(c for c in line if unicodedata.bidirectional(c) in _DIRECTION_MARKS)
        if marks:
            sentence = f"line {number} has marks of direction that are not read, {_list_characters(tuple(marks))}"
            advice = "check the order of its words, or remove the marks"
            notices.append(Notice("text", sentence, code="text-direction", advice=advice))
    return notices


def _is_control(character: str) -> bool:
    """Whether XML does not allow a character: control characters, surrogate halves and two others."""
    return unicodedata.category(character) in ("Cc", "Cs") or character in "\ufffe\uffff"


def _list_characters(characters: tuple[str, ...]) -> str:
    named = [
        f"U+{ord(letter):04X}" + (f" {letter}" if letter.isprintable() and not letter.isspace() else "")
        for letter in characters[:_MAX_NAMED_CHARACTERS]
    ]
    more = len(characters) - len(named)
    return ", ".join(named) + (f" and {more} more" if more else "")


def _find_font_module(font: bytes):
    if not font.strip():
        raise Error("the font file is empty", code="file-empty")
    if font.startswith(_OUTLINE_FONT_STARTS):
        try:
            from . import outline_font
        except ImportError:
            raise missing_packages_error("outline fonts need", "fonttools", "uharfbuzz") from None
        return outline_font
    if font.lstrip(b"\xef\xbb\xbf\xff\xfe\0 \t\r\n").startswith(b"<"):
        return svg_font
    sentence = "this is not a font that can be read: known are SVG fonts (.svg), TrueType and OpenType"
    raise Error(sentence, code="font-unknown")
