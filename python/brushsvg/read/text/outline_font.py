"""Typeset text in a TrueType or OpenType font.

HarfBuzz shapes and draws the glyphs. fontTools unpacks fonts and makes cubics. Only this module and text_runs import
them, so only outline fonts need the extra `text`.
"""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import uharfbuzz as hb
from fontTools.pens.basePen import BasePen
from fontTools.ttLib import TTFont

from ...errors import Error
from ...geometry.rings import signed_area
from ..design import Notice, SubPath
from .setting import PlacedGlyph, TypesetText, find_script, needs_shaping, should_have_ink
from .text_runs import TextRun, sort_from_the_left, split_runs, starts_at_the_right

_MAX_UNPACKED_BYTES = 200_000_000  # bytes; the largest fonts, with all Chinese characters, have a fifth of this size
_UNITS_PER_EM_RANGE = (16, 16384)  # units per em that the format allows
_COLOUR_TABLES = ("COLR", "CBDT", "sbix", "SVG ")  # tables of glyphs in colours or as pictures
_STRAIGHT_LETTERS = "AEFHIKLMNTVWXYZilt"  # straight letters: in a single-line font, contours of many have no area
_SINGLE_LINE_SENTENCE = "it is a single-line font: its contours are read as lines"
_CONTEXT_CHARACTERS = 5  # characters next to a run by which HarfBuzz joins its letters
_JOINED_SCRIPTS = ("arabic", "devanagari")  # scripts in which a word is one shape
# Cubics of a contour. With fewer cubics, the last one always counts as the edge that closes the contour, as in a V.
# From this number on, a short last cubic belongs to the drawn line, as in an O.
_MIN_CLOSED_CUBICS = 8


def set_lines(data: bytes, lines: list[str], size_mm: float) -> TypesetText:
    """Typeset lines of text, kerned and joined as the font prescribes.

    Each script is shaped by its own rules, and lines may have two writing directions.
    A collection is read as its first font, a variable font as its default instance.

    data: the font file; size_mm: the em of the font. Raises Error if the font cannot be read.
    """
    unpacked = _unpack(data)
    setter = _Typesetter(unpacked, size_mm)
    placed = _align_lines(lines, list(map(setter.place, lines)))
    is_filled = not setter.is_single_line_font()
    notices: tuple[Notice, ...] = tuple(_unused_part_notices(unpacked, setter.face))
    if _has_only_graphite_rules(setter.face) and any(map(needs_shaping, "".join(lines))):
        sentence = "the font joins its letters with Graphite rules, which are not read: letters are set one by one"
        advice = "use a font with OpenType rules"
        notices += (Notice("text", sentence, code="font-rules-unread", advice=advice),)
    if not is_filled:
        notices = Notice("font", _SINGLE_LINE_SENTENCE, code="font-of-lines"), *notices
        placed = tuple(
            tuple(replace(glyph, subpaths=contours_to_lines(glyph.subpaths)) for glyph in line) for line in placed
        )
    return TypesetText(placed, is_filled, tuple(setter.missing), notices, tuple(setter.blank))


def _unused_part_notices(data: bytes, face: hb.Face) -> Iterator[Notice]:
    """Yield notices about unused parts of a font: other fonts, instances, colours."""
    if data.startswith(b"ttcf") and (count := int.from_bytes(data[8:12], "big")) > 1:
        yield Notice(
            "font",
            f"it is a collection of {count} fonts, of which the first is used",
            code="font-of-choices",
            advice="extract another one first, for example with fonttools ttLib -y 1 -o second.ttf FILE",
        )
    if axes := _axes(face.reference_table("fvar").data or b""):
        named = ", ".join(f"{tag} {default:g}" for tag, default in axes)
        tag, default = axes[0]
        yield Notice(
            "font",
            f"it is a variable font, used at its default: {named}",
            code="font-of-choices",
            advice=f"make another instance first, for example with fonttools varLib.instancer FILE {tag}={default:g}",
        )
    if any(face.reference_table(tag).data for tag in _COLOUR_TABLES):
        sentence = "it is a colour font: its colours are not read, and plain outlines of its letters are painted"
        yield Notice("font", sentence, code="font-of-colours")


def _has_only_graphite_rules(face: hb.Face) -> bool:
    return bool(face.reference_table("Silf").data) and not face.reference_table("GSUB").data


def _axes(fvar: bytes) -> list[tuple[str, float]]:
    """Return (tag, default) of each axis of a variable font."""
    if len(fvar) < 16:
        return []
    first, _, count, size = struct.unpack(">4H", fvar[4:12])
    axes = (fvar[first + k * size :][:12] for k in range(count))
    return [
        (axis[:4].decode("latin-1"), int.from_bytes(axis[8:12], "big", signed=True) / 65536)
        for axis in axes
        if len(axis) == 12
    ]


class _Typesetter:
    def __init__(self, data: bytes, size_mm: float):
        face = hb.Face(data)
        if not face.glyph_count:
            raise Error("this is a damaged font: it holds no glyphs that can be read", code="font-damaged")
        _refuse_undefined_sizes(face)
        self.face, self.font = face, hb.Font(face)
        self.mm_per_unit = size_mm / face.upem
        self.shapes: dict[int, tuple[SubPath, ...]] = {}
        self.missing: dict[str, None] = {}
        self.blank: dict[str, None] = {}

    def place(self, line: str) -> tuple[tuple[PlacedGlyph, ...], float]:
        """Return the glyphs of a line in the order of reading, and the length of the line [mm]."""
        runs = split_runs(line)
        glyphs_of_runs = {}
        inked: set[int] = set()
        x = y = 0
        for run in sort_from_the_left(runs):
            shaped = self._shape_run(line, run)
            clusters = sorted({cluster for cluster, _, _ in shaped})
            ends = dict(zip(clusters, [*clusters[1:], run.end], strict=True))
            glyphs = []
            for cluster, glyph_index, position in shaped:
                characters = line[cluster : ends[cluster]]
                if glyph_index == 0:
                    inked.add(cluster)  # this cluster is reported as missing, not as blank
                    without_glyph = [
                        character for character in characters if not self.font.get_nominal_glyph(ord(character))
                    ]
                    self.missing.update(dict.fromkeys(without_glyph or characters))
                    continue
                if subpaths := self._shape(glyph_index):
                    inked.add(cluster)
                    origin = x + position.x_offset, -(y + position.y_offset)
                    at_mm = (value * self.mm_per_unit for value in origin)
                    glyph = PlacedGlyph(characters, subpaths, *at_mm, find_script(characters))
                    glyphs.append((line[:cluster].count(" "), glyph))
                x, y = x + position.x_advance, y + position.y_advance
            for cluster in clusters:
                if cluster not in inked:
                    self.blank.update(dict.fromkeys(filter(should_have_ink, line[cluster : ends[cluster]])))
            glyphs_of_runs[run] = glyphs[::-1] if run.is_right_to_left else glyphs
        placed = [glyph for run in runs for glyph in glyphs_of_runs[run]]
        words = [word for word, _ in placed]
        return tuple(_join_words([glyph for _, glyph in placed], words, line.split(" "))), x * self.mm_per_unit

    def _shape_run(self, line: str, run: TextRun) -> list[tuple[int, int, hb.GlyphPosition]]:
        """Return (index of the first character in the line, glyph, position) of each glyph, from left to right."""
        first = max(0, run.start - _CONTEXT_CHARACTERS)
        around = line[first : run.end + _CONTEXT_CHARACTERS]
        buffer = hb.Buffer()
        buffer.add_codepoints([ord(character) for character in around], run.start - first, run.end - run.start)
        buffer.language = "und"  # some builds of HarfBuzz use the locale, so the output would depend on it
        buffer.direction = "rtl" if run.is_right_to_left else "ltr"
        buffer.script = run.script
        hb.shape(self.font, buffer)
        glyphs = zip(buffer.glyph_infos or (), buffer.glyph_positions or (), strict=True)
        return [(first + info.cluster, info.codepoint, position) for info, position in glyphs]

    def is_single_line_font(self) -> bool:
        """Whether the font is a single-line font.

        TrueType has no open lines. In a single-line font, a contour goes back along its line or has two points. Then
        at least a third of the straight letters have a contour without area. In other fonts, no letter has one.
        """
        glyphs = [self.font.get_nominal_glyph(ord(letter)) for letter in _STRAIGHT_LETTERS]
        shapes = [shape for glyph in glyphs if glyph and (shape := self._shape(glyph))]
        flat = sum(any(map(_is_flat, shape)) for shape in shapes)
        return bool(shapes) and 3 * flat >= len(shapes)

    def _shape(self, glyph: int) -> tuple[SubPath, ...]:
        if glyph not in self.shapes:
            pen = _CubicPen()
            self.font.draw_glyph_with_pen(glyph, pen)
            to_mm = np.array([self.mm_per_unit, -self.mm_per_unit])
            contours = (np.array(contour).reshape(-1, 4, 2) * to_mm for contour in pen.contours if contour)
            self.shapes[glyph] = tuple(SubPath(cubics, closed=True) for cubics in contours)
        return self.shapes[glyph]


def _align_lines(
    lines: list[str], placed: list[tuple[tuple[PlacedGlyph, ...], float]]
) -> tuple[tuple[PlacedGlyph, ...], ...]:
    """Return the glyphs of all lines.

    Lines from right to left begin at the right end of the longest line.

    placed: the glyphs and the length [mm] of each line.
    """
    longest_mm = max(length_mm for _, length_mm in placed)
    shifts_mm = (
        longest_mm - length_mm if starts_at_the_right(line) else 0
        for line, (_, length_mm) in zip(lines, placed, strict=True)
    )
    return tuple(
        tuple(replace(glyph, x_mm=glyph.x_mm + shift_mm) for glyph in glyphs)
        for (glyphs, _), shift_mm in zip(placed, shifts_mm, strict=True)
    )


def _join_words(placed: list[PlacedGlyph], words: list[int], texts: list[str]) -> list[PlacedGlyph]:
    """Return the glyphs of a line from the first word on, and join words.

    A word in a joined script becomes one shape, because one line runs through all its letters and the dots come last.

    words: the number of the word of each glyph; texts: the text of all words.
    """
    joined: dict[object, PlacedGlyph] = {}
    for k in sorted(range(len(placed)), key=words.__getitem__):
        glyph = placed[k]
        key = words[k] if glyph.script in _JOINED_SCRIPTS else -1 - k
        if key not in joined:
            joined[key] = glyph
            continue
        first = joined[key]
        shift = np.array([glyph.x_mm - first.x_mm, glyph.y_mm - first.y_mm])
        moved = tuple(SubPath(subpath.cubics + shift, subpath.closed) for subpath in glyph.subpaths)
        joined[key] = replace(first, label=texts[words[k]], subpaths=first.subpaths + moved)
    return list(joined.values())


def _is_flat(contour: SubPath) -> bool:
    ring = contour.cubics[:, :3].reshape(-1, 2)
    around = np.hypot(*np.diff(ring, axis=0, append=ring[:1]).T).sum()
    return abs(signed_area(ring)) < 1e-6 * around**2


def contours_to_lines(contours: tuple[SubPath, ...]) -> tuple[SubPath, ...]:
    """Return the lines of the contours of a single-line font.

    Parts that a contour draws twice are kept once. The edge that closes a contour is removed if the contour has few
    edges, but more than one, or if this edge is longer than the drawn edges.
    """
    lines = []
    for contour in contours:
        cubics, known, kept = contour.cubics, set(), []
        lengths = np.hypot(*(cubics[:, 3] - cubics[:, 0]).T)
        if 1 < len(cubics) < _MIN_CLOSED_CUBICS or lengths[-1] > 2 * np.median(lengths):
            cubics = cubics[:-1]
        for cubic in cubics:
            key = np.round(cubic, 6)
            if (key.tobytes() in known) or (key[::-1].tobytes() in known):
                continue
            known.add(key.tobytes())
            if kept and np.allclose(kept[-1][-1][3], cubic[0]):
                kept[-1].append(cubic)
            else:
                kept.append([cubic])
        lines += [SubPath(np.array(line)) for line in kept]
    return tuple(lines)


def _refuse_undefined_sizes(face: hb.Face) -> None:
    """Raise Error if a font lacks its em or glyph widths, for which HarfBuzz uses its own."""
    head, hhea, hmtx = (face.reference_table(tag).data or b"" for tag in ("head", "hhea", "hmtx"))
    units = int.from_bytes(head[18:20], "big") if len(head) >= 20 else None
    if units is None or not _UNITS_PER_EM_RANGE[0] <= units <= _UNITS_PER_EM_RANGE[1]:
        sentence = (
            f"this is a damaged font: units per em, {'missing' if units is None else units}, is outside the range "
            f"[{_UNITS_PER_EM_RANGE[0]}, {_UNITS_PER_EM_RANGE[1]}]"
        )
        raise Error(sentence, "head", units, _UNITS_PER_EM_RANGE, code="font-damaged")
    widths = int.from_bytes(hhea[34:36], "big") if len(hhea) >= 36 else 0
    if not 0 < 4 * widths <= len(hmtx):
        there, expected = min(widths, len(hmtx) // 4), widths or face.glyph_count
        sentence = f"this is a damaged font: it has the widths of {there} glyphs, and should have those of {expected}"
        raise Error(sentence, "hmtx", code="font-damaged")


class _CubicPen(BasePen):
    """A pen that collects contours as cubics of eight numbers.

    BasePen converts quadratic curves to cubics.
    """

    def __init__(self):
        super().__init__(None)
        self.contours: list[list[tuple[float, ...]]] = []

    def _moveTo(self, point):  # noqa: N802
        self.contours.append([])
        self.start = point

    def _lineTo(self, end):  # noqa: N802
        (x, y), (ex, ey) = self._getCurrentPoint(), end
        dx, dy = (ex - x) / 3, (ey - y) / 3
        self._curveToOne((x + dx, y + dy), (ex - dx, ey - dy), end)

    def _curveToOne(self, first, second, end):  # noqa: N802
        self.contours[-1].append((*self._getCurrentPoint(), *first, *second, *end))

    def _closePath(self):  # noqa: N802
        if self._getCurrentPoint() != self.start:
            self._lineTo(self.start)


def _unpack(data: bytes) -> bytes:
    """Return a font as HarfBuzz reads it: a WOFF font is decompressed."""
    if data.startswith(b"wOF2"):
        advice = "unpack it first: pip install brotli, then fonttools ttLib.woff2 decompress FILE"
        raise Error("WOFF2 is not read", code="font-unknown", advice=advice)
    if not data.startswith(b"wOFF"):
        return data
    try:
        font = TTFont(io.BytesIO(data), lazy=True, recalcBBoxes=False, recalcTimestamp=False)
        bytes_left = _MAX_UNPACKED_BYTES
        for table in font.reader.tables.values():
            bytes_left -= _inflated_length(data[table.offset : table.offset + table.length], bytes_left)
        font.flavor = None
        out = io.BytesIO()
        font.save(out, reorderTables=None)
    except Error:
        raise
    except Exception as error:  # fontTools raises anything on damaged tables
        reason = str(error).splitlines() or [type(error).__name__]
        raise Error(f"this is a damaged WOFF font: {reason[0][:120]}", code="font-damaged") from None
    return out.getvalue()


def _inflated_length(packed: bytes, limit: int) -> int:
    """Return a WOFF table's inflated length; refuse it before fontTools fills the memory."""
    try:
        length = len(zlib.decompressobj().decompress(packed, limit + 1))
    except zlib.error:
        return len(packed)  # WOFF stores a table uncompressed if compression would not shrink it
    if length > limit:
        sentence = f"the font unpacks to more than {_MAX_UNPACKED_BYTES} bytes"
        raise Error(sentence, "", length, (0, _MAX_UNPACKED_BYTES), code="file-too-large")
    return length
