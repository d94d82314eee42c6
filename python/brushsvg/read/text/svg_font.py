"""Typeset text in an SVG 1.1 font.

Single-line fonts such as EMS and Hershey have this format.
"""

from __future__ import annotations

import math
import re
import unicodedata
import xml.etree.ElementTree as ET
from dataclasses import dataclass

from ...errors import Error
from ..design import Notice, SubPath
from ..svg.paths.path_data import parse_numbers, parse_path, snippet
from ..svg.paths.path_to_cubics import trace
from ..svg.xml import parse_xml
from .setting import PlacedGlyph, TypesetText, should_have_ink

# Characters of a ligature. No script joins more, and every length in the font is tried at each position of the text.
_MAX_LIGATURE = 32
# Units per em. Outside of this range, the numbers of a glyph cannot be distinguished from damage.
_UNITS_PER_EM_RANGE = (1, 1e6)
_RANGE = re.compile(r"[Uu]\+([0-9A-Fa-f]{0,6})(\?{0,6})(?:-([0-9A-Fa-f]{1,6}))?")


def set_lines(data: bytes, lines: list[str], size_mm: float) -> TypesetText:
    """Typeset lines of text.

    data: the font file; size_mm: the em of the font. Raises Error if the data is not an SVG font or contains an
    invalid number.
    """
    return _Typesetter(_read_font(data), size_mm).typeset(lines)


@dataclass(frozen=True)
class _Font:
    nodes: dict[str, ET.Element]  # glyphs by the characters that they stand for
    kerns: _Kerns
    units_per_em: float
    advance: str | None
    notices: tuple[Notice, ...]


def _read_font(data: bytes) -> _Font:
    root = parse_xml(data).root
    fonts = [node for node in root.iter() if _local_name(node) == "font"]
    if not fonts:
        raise Error(f"this is no font: <{_local_name(root)[:40]}> holds no <font>", code="font-unknown")
    font, notices = fonts[0], []
    if len(fonts) > 1:
        notices.append(
            Notice("font", f"the file holds {len(fonts)} fonts: the first one is used", code="fonts-in-file")
        )
    face = next((node for node in font if _local_name(node) == "font-face"), font)
    nodes: dict[str, ET.Element] = {}
    kerns = _Kerns()
    for node in font:
        if _local_name(node) == "glyph" and node.get("orientation") != "v":
            if 0 < len(characters := node.get("unicode", "")) <= _MAX_LIGATURE:
                nodes.setdefault(characters, node)
        elif _local_name(node) == "hkern":
            kerns.add(node)
    if not nodes:
        raise Error("the font has no glyph for any character", code="font-damaged")
    units = _number(face, "units-per-em", "1000")
    if not _UNITS_PER_EM_RANGE[0] <= units <= _UNITS_PER_EM_RANGE[1]:
        sentence = f"units-per-em {units:g} is outside the range [1, 1e6]"
        raise Error(sentence, _local_name(face), units, _UNITS_PER_EM_RANGE, code="font-damaged")
    return _Font(nodes, kerns, units, font.get("horiz-adv-x"), tuple(notices))


def _local_name(node: ET.Element) -> str:
    return node.tag.rpartition("}")[2]


def _number(node: ET.Element, name: str, default: str | None = None) -> float:
    text = node.get(name, default)
    values = parse_numbers(text.strip()) if text else None
    if values is None or len(values) != 1 or not math.isfinite(values[0]):
        problem = "is missing" if text is None else f"{snippet(text, 0)} is not a number"
        raise Error(f"{name} {problem}", _glyph_label(node), code="font-damaged")
    return values[0]


def _glyph_label(node: ET.Element) -> str:
    name = node.get("glyph-name") or node.get("unicode") or ""
    return f"{_local_name(node)} {name[:40]}".strip() if name.isprintable() else _local_name(node)


class _Typesetter:
    def __init__(self, font: _Font, size_mm: float):
        self.font = font
        self.mm_per_unit = size_mm / font.units_per_em
        self.lengths = sorted({len(characters) for characters in font.nodes}, reverse=True)
        self.shapes: dict[str, tuple[SubPath, ...]] = {}
        self.kerned: dict[tuple[str, str], float] = {}
        self.missing: dict[str, None] = {}
        self.blank: dict[str, None] = {}
        self.notices = list(font.notices)

    def typeset(self, lines: list[str]) -> TypesetText:
        placed = tuple(self._line(unicodedata.normalize("NFC", line)) for line in lines)
        drawn = [subpath for shape in self.shapes.values() for subpath in shape]
        if drawn and all(subpath.closed for subpath in drawn):
            sentence = "every line of these letters is closed; if they are outlines, the outlines are painted"
            self.notices.append(Notice("font", sentence, code="font-of-outlines"))
        return TypesetText(placed, False, tuple(self.missing), tuple(self.notices), tuple(self.blank))

    def _line(self, line: str) -> tuple[PlacedGlyph, ...]:
        placed = []
        x, position, previous = 0.0, 0, ""
        while position < len(line):
            characters = self._longest_match(line, position)
            if not characters:
                self.missing[line[position]] = None
                position, previous = position + 1, ""
                continue
            if previous:
                x -= self._kern(previous, characters)
            if shape := self._shape(characters):
                placed.append(PlacedGlyph(characters, shape, x * self.mm_per_unit))
            elif not self.font.nodes[characters].get("d") and not len(self.font.nodes[characters]):
                self.blank.update(dict.fromkeys(filter(should_have_ink, characters)))
            x += self._advance(characters)
            position, previous = position + len(characters), characters
        return tuple(placed)

    def _longest_match(self, line: str, at: int) -> str:
        return next((line[at : at + n] for n in self.lengths if line[at : at + n] in self.font.nodes), "")

    def _advance(self, characters: str) -> float:
        return _number(self.font.nodes[characters], "horiz-adv-x", self.font.advance)

    def _kern(self, first: str, second: str) -> float:
        pair = first, second
        if pair not in self.kerned:
            self.kerned[pair] = self.font.kerns.between(*((glyph, self.font.nodes[glyph]) for glyph in pair))
        return self.kerned[pair]

    def _shape(self, characters: str) -> tuple[SubPath, ...]:
        if characters not in self.shapes:
            self.shapes[characters] = self._draw(self.font.nodes[characters])
        return self.shapes[characters]

    def _draw(self, node: ET.Element) -> tuple[SubPath, ...]:
        d = node.get("d", "")
        if not d and len(node):
            self._skip(node, "it is drawn by elements inside it, which are not read", damaged=False)
            return ()
        commands, error = parse_path(d)
        if error is not None:
            self._skip(node, f"d is wrong at character {error + 1}: found {snippet(d, error)}")
            return ()
        line = trace(commands, (self.mm_per_unit, 0, 0, -self.mm_per_unit, 0, 0), self.mm_per_unit)
        if line.beyond is not None:
            self._skip(node, f"d goes beyond 1e6 mm at character {line.beyond + 1}")
            return ()
        if line.lone_movetos:
            count = "a moveto" if line.lone_movetos == 1 else f"{line.lone_movetos} movetos"
            self.notices.append(
                Notice(_glyph_label(node), f"{count} without a line to follow: skipped", code="moveto-alone")
            )
        return line.subpaths

    def _skip(self, node: ET.Element, sentence: str, damaged: bool = True) -> None:
        self.notices.append(Notice(_glyph_label(node), f"{sentence}; it is left out", damaged, code="glyph-damaged"))


class _Kerns:
    """The hkern elements of a font. The first element that fits a pair counts."""

    def __init__(self):
        self.rules: list[tuple[ET.Element, tuple]] = []
        self.by_first: dict[str, list[int]] = {}
        self.ranged: list[int] = []

    def add(self, node: ET.Element) -> None:
        first, second = (_parse_side(node, side) for side in "12")
        for key in first[0]:
            self.by_first.setdefault(key, []).append(len(self.rules))
        if first[1]:
            self.ranged.append(len(self.rules))
        self.rules.append((node, (first, second)))

    def between(self, first: tuple[str, ET.Element], second: tuple[str, ET.Element]) -> float:
        """Return how much closer [font units] the second glyph is to the first.

        first, second: (characters, element) of the glyphs.
        """
        near = {*self.ranged, *(rule for key in _keys(*first) for rule in self.by_first.get(key, ()))}
        for rule in sorted(near):
            node, sides = self.rules[rule]
            if all(_fits(side, *glyph) for side, glyph in zip(sides, (first, second), strict=True)):
                return _number(node, "k")
        return 0.0


def _keys(characters: str, node: ET.Element) -> list[str]:
    return ["u" + characters, *("g" + name.strip() for name in node.get("glyph-name", "").split(","))]


def _parse_side(node: ET.Element, side: str) -> tuple[frozenset[str], list[tuple[int, int]]]:
    """Return keys ("u" characters, "g" glyph) and code point ranges on one side of a kern."""
    keys, ranges = {"g" + name.strip() for name in node.get("g" + side, "").split(",") if name.strip()}, []
    listed = node.get("u" + side, "")
    for token in [listed] if listed == "," else listed.split(","):
        found = _RANGE.fullmatch(token.strip())
        if found and found[1] + found[2]:
            least = int(found[1] + found[2].replace("?", "0"), 16)
            ranges.append((least, int(found[3] or found[1] + found[2].replace("?", "F"), 16)))
        elif token:
            keys.add("u" + (token.strip() or token))
    return frozenset(keys), ranges


def _fits(side: tuple[frozenset[str], list[tuple[int, int]]], characters: str, node: ET.Element) -> bool:
    keys, ranges = side
    if any(key in keys for key in _keys(characters, node)):
        return True
    return len(characters) == 1 and any(least <= ord(characters) <= most for least, most in ranges)
