"""Convert text of a DXF to outlines.

TEXT and ATTRIB become one shape each. MTEXT is exploded into TEXT and LINE entities.
"""

from __future__ import annotations

import math
import re
from collections import Counter

import numpy as np

from ...errors import Error
from ..design import Notice
from ..text.setting import needs_shaping
from .entity_curves import Curve
from .ezdxf_import import ezdxf
from .file import printable
from .fonts import Font, Fonts

_tools, _boxes = ezdxf.tools.text, ezdxf.tools.text_layout

_MAX_LETTERS = 50_000  # a brush paints a few hundred letters a day
_MAX_COLUMN_HEIGHTS = 10_000.0  # width of MTEXT columns in letter heights; ezdxf makes a tab stop every 4 heights
_MAX_COLUMNS = 1000
_TAB_HEIGHTS = 4.0  # distance in letter heights of the tab stops that ezdxf makes if a text has no tab stops
_FRAME_BIT = 16  # bit of MTEXT's bg_fill for a frame; the other bits are paint behind the letters
_EXACT_SPACING = 2  # value of MTEXT's line_spacing_style
_VERTICAL_FLOW = 3  # value of MTEXT's flow_direction
_STACKED_BIT = 4  # bit of a style's flags: letters one below the other
_CHARACTER_CODE = re.compile(r"(?<!%)%%(\d{3})")  # a character of TEXT by its number
_LINE_CODE = re.compile(r"(?<!%)%%[kou]", re.IGNORECASE)  # codes for lines along TEXT


class TextConverter:
    """A converter of the text entities of a document.

    notices: about the fonts of the text converted so far, and about the parts of the text that are not read.
    """

    def __init__(self, document: ezdxf.document.Drawing):
        self._document = document
        self._fonts = Fonts(document.styles)
        self._faces: dict[str, object] = {}  # font faces of the styles that exploded MTEXT uses
        self._letters_left = _MAX_LETTERS
        self._first_use: dict[tuple[Font, str], tuple[str, str]] = {}
        self._use_counts: Counter[tuple[Font, str]] = Counter()
        self._missing_letters: dict[tuple[Font, str], dict[str, None]] = {}
        self._unread: list[Notice] = []

    @property
    def notices(self) -> list[Notice]:
        notices = list(self._unread)
        for (font, layer), (where, text) in self._first_use.items():
            more = self._use_counts[font, layer] - 1
            text_name = f"text {printable(text, 40)!r}" + (f" and {more} more" if more else "")
            why = f": {font.why}" if font.why else ""
            notices.append(
                Notice(
                    where,
                    f"{text_name} became the outlines of font {font.name}{why}",
                    layer=layer,
                    code="text-outlined",
                )
            )
        for (font, layer), letters in self._missing_letters.items():
            listed_letters = ", ".join(repr(c) for c in list(letters)[:5]) + (" ..." if len(letters) > 5 else "")
            where = self._first_use[font, layer][0]
            notices.append(
                Notice(
                    where,
                    f"font {font.name} has no glyph for {listed_letters}: left out",
                    layer=layer,
                    code="glyph-missing",
                )
            )
        return notices

    def outlines(self, entity, name: str, layer: str) -> list[Curve]:
        """Return the outlines of a TEXT or ATTRIB, in its own world.

        Raises NoFontError if the machine has no font.
        """
        dxf = entity.dxf
        _check_height(dxf.get("height"))
        written = _CHARACTER_CODE.sub(lambda found: chr(int(found[1])), dxf.text)
        text = " ".join(_tools.plain_text(written).splitlines())
        if dxf.style not in self._faces:  # the letters of exploded MTEXT are counted already
            self._count_letters(text, name)
        if not text.strip():
            return []
        face = self._faces.get(dxf.style) or self._fonts.face(dxf.style)
        font = self._fonts.font(face)
        self._first_use.setdefault((font, layer), (name, text))
        self._use_counts[font, layer] += 1
        if missing := font.missing_glyphs(text):
            self._missing_letters.setdefault((font, layer), {}).update(dict.fromkeys(missing))
        text = "".join(" " if c in missing or c.isspace() else c for c in text)
        drawn = font.ezdxf_font(1.0)
        path = drawn.text_path_ex(text, cap_height=dxf.height).to_path()
        if not len(path):
            return []
        if _LINE_CODE.search(written):
            self._note_unread(name, "its lines along the letters (%%u, %%o, %%k) are not read: left out", layer)
        if self._is_stacked(dxf.style):
            self._note_unread(name, _STACKED_SENTENCE, layer)
        if any(map(needs_shaping, text)):
            advice = "explode the text into lines in your CAD program"
            self._note_unread(name, "it is set letter by letter from left to right, unlike its script", layer, advice)
        length = drawn.text_width_ex(text, cap_height=dxf.height)  # includes blanks at the ends
        placed = ezdxf.addons.text2path.alignment_transformation(
            drawn.measurements.scale_from_baseline(dxf.height),
            ezdxf.math.BoundingBox([(0, 0), (length, dxf.height)]),
            entity.get_align_enum(),
            entity.fit_length(),
        )
        path = path.transform(placed * entity.wcs_transformation_matrix())
        return [Curve(_path_to_cubics(outline), True) for outline in path.sub_paths() if len(outline)]

    def parts(self, mtext, name: str, layer: str) -> list:
        """Explode an MTEXT into TEXT and LINE entities, in its own world.

        Raises NoFontError if the machine has no font.
        """
        mtext = mtext.copy()
        mtext.doc = self._document
        self._count_letters(mtext.all_columns_raw_content(), name)
        columns = mtext.columns
        if columns is not None and not 0 <= columns.count <= _MAX_COLUMNS:
            raise ValueError(f"it has {columns.count} columns")
        for part in (mtext, *(columns.linked_columns if columns is not None else ())):
            part.text = _STACK.sub(r"\1^ ", part.text)
        background = mtext.dxf.get("bg_fill", 0)
        mtext.dxf.bg_fill = background & _FRAME_BIT
        height = _check_height(mtext.dxf.get("char_height"))
        layout = ezdxf.layouts.VirtualLayout()
        exploder = _MTextExploder(layout, self._document, self._fonts, self._faces)
        width = mtext.dxf.get("width", 0.0)
        mtext.dxf.width = min(width if width > 1e-6 else exploder.unbroken_width(mtext), _MAX_COLUMN_HEIGHTS * height)
        exploder.explode(mtext)
        if background & ~_FRAME_BIT:
            self._note_unread(name, "its background is not painted, and covers nothing", layer)
        if exploder.spread:
            self._note_unread(name, "the distances between its letters (\\T) are not read: they count as 1", layer)
        if exploder.uneven and mtext.dxf.get("line_spacing_style", 1) == _EXACT_SPACING:
            self._note_unread(name, "its lines are set as far apart as their tallest letters ask for", layer)
        if mtext.dxf.get("flow_direction", 1) == _VERTICAL_FLOW or self._is_stacked(mtext.dxf.style):
            self._note_unread(name, _STACKED_SENTENCE, layer)
        return list(layout)

    def _is_stacked(self, style: str) -> bool:
        return style in self._document.styles and bool(
            self._document.styles.get(style).dxf.get("flags", 0) & _STACKED_BIT
        )

    def _note_unread(self, name: str, sentence: str, layer: str, advice: str = "") -> None:
        self._unread.append(Notice(name, sentence, layer=layer, code="text-unread", advice=advice))

    def _count_letters(self, text: str, name: str) -> None:
        self._letters_left -= len(text)
        if self._letters_left < 0:
            where = name.partition("/")[0]
            sentence = f"the drawing's text unfolds to more than {_MAX_LETTERS} letters"
            raise Error(sentence, where=where, code="drawing-too-large")


_STACKED_SENTENCE = "its letters one below the other are not read: they are set in a line"


def _check_height(height: float | None) -> float:
    if height is None:
        raise ValueError("it has no height")
    if not 0 < height < math.inf:
        raise ValueError(f"its height is {height}")
    return height


# CAD programs write "^" between the two numbers of a stack. ezdxf reads "^" and the next letter as a control
# character, unless this letter is a blank.
_STACK = re.compile(r"((?<!\\)(?:\\\\)*\\S[^;^]*)\^(?! )")


class _MTextExploder(ezdxf.addons.mtxpl.MTextExplode):
    """An exploder of MTEXT that uses our fonts.

    The resulting entities have styles that the document does not contain.

    uneven: whether the letters have several heights; spread: whether the distance of the letters differs from the
    font's distance.
    """

    def __init__(self, layout, document, fonts: Fonts, faces: dict[str, object]):
        super().__init__(layout, document)
        self._fonts, self._faces = fonts, faces
        self._heights: set[float] = set()
        self.spread = False

    @property
    def uneven(self) -> bool:
        return len(self._heights) > 1

    def explode(self, mtext) -> None:
        layout = self.layout_engine(mtext)
        layout.place(align=_boxes.LayoutAlignment(mtext.dxf.attachment_point))
        for column in layout:
            for paragraph in column:
                if isinstance(paragraph, _boxes.Paragraph):
                    for line in paragraph:
                        _align_baselines(line)
        layout.render(mtext.ucs().matrix)

    def word(self, text: str, ctx):
        self._heights.add(_check_height(ctx.cap_height))
        self.spread |= ctx.char_tracking_factor != 1
        return super().word(text, ctx)

    def fraction(self, data: tuple, ctx):
        cell = super().fraction(data, ctx)
        if isinstance(cell, _boxes.Fraction):  # the line of a fraction has the colour of its numbers
            attributes = self.current_base_attribs | ezdxf.addons.mtxpl.get_color_attribs(ctx)
            cell.renderer = ezdxf.addons.mtxpl.FrameRenderer(attributes, self.layout)
        return cell

    def make_bg_renderer(self, mtext):
        frame = super().make_bg_renderer(mtext)
        if mtext.rgb is not None:
            frame.line_attribs["true_color"] = ezdxf.colors.rgb2int(mtext.rgb)
        return frame

    def get_font_face(self, mtext):
        return self._fonts.face(mtext.dxf.style)

    def get_font(self, ctx):
        return self._fonts.font(ctx.font_face).ezdxf_font(ctx.cap_height, ctx.width_factor)

    def unbroken_width(self, mtext) -> float:
        """Return the width of the longest paragraph in one line.

        For a paragraph with tabs the width is an upper bound.
        """
        context = self.make_mtext_context(mtext)
        height = context.cap_height
        widest = line = 0.0
        for token in _tools.MTextParser(mtext.all_columns_raw_content(), context):
            kind, context = token.type, token.ctx
            if kind in (_tools.TokenType.NEW_PARAGRAPH, _tools.TokenType.NEW_COLUMN):
                line = 0.0
            elif kind == _tools.TokenType.WORD:
                line += self.get_font(context).text_width(token.data)
            elif kind == _tools.TokenType.STACK:
                line += self.fraction(token.data, context).total_width
            elif kind == _tools.TokenType.TABULATOR:
                line += max(self.space_width(context), _TAB_HEIGHTS * height)
            elif kind in (_tools.TokenType.SPACE, _tools.TokenType.NBSP):
                line += self.space_width(context)
            shape = context.paragraph
            indents = sum(max(0.0, indent) for indent in (shape.indent, shape.left, shape.right)) * height
            widest = max(widest, line + indents)
        return max((1 + 1e-9) * widest, height)

    def space_width(self, ctx) -> float:
        return super().space_width(ctx) * ctx.width_factor

    def mtext_exploded_text_style(self, font_face) -> str:
        name = f"\n{font_face}"  # no name in a DXF has more than one line
        self._faces[name] = font_face
        return name


def _align_baselines(line) -> None:
    """Put a word's letters of several heights on one baseline; ezdxf aligns tops of unbreakable lines."""
    for group in line.cells():
        if isinstance(group, _boxes.RigidConnection):
            for cell in group:
                if isinstance(cell, _boxes.ContentCell):
                    x, y = cell.final_location()
                    cell.place(x, y + _boxes.vertical_cell_shift(cell, group.total_height))


def _path_to_cubics(path) -> np.ndarray:
    """Return a Path of ezdxf without gaps as cubics (n, 4, 3)."""
    begin, control_points = path.start, []
    for command in path.commands():
        end = command.end
        match command[1:]:
            case ():
                handles = begin.lerp(end, 1 / 3), begin.lerp(end, 2 / 3)
            case (handle,):
                handles = begin.lerp(handle, 2 / 3), end.lerp(handle, 2 / 3)
            case handles:
                pass
        control_points.append([point.xyz for point in (begin, *handles, end)])
        begin = end
    return np.array(control_points)
