"""Text of a DXF as outlines: TEXT and ATTRIB as one shape, MTEXT taken apart into such and lines."""

from __future__ import annotations

import math
import re
from collections import Counter

import numpy as np

from ...errors import Error
from ..design import Notice
from .curves import Curve
from .file import shown
from .fonts import Font, Fonts
from .library import ezdxf

_tools = ezdxf.tools.text

_MOST_LETTERS = 50_000  # a brush paints some hundred a day
_WIDEST = 10_000.0  # columns of MTEXT, in letters: ezdxf makes a tab stop for every fourth
_MOST_COLUMNS = 1000
_TAB = 4.0  # heights between the tab stops that ezdxf makes where a text has none of its own
_FRAME = 16  # of MTEXT's bg_fill; the others are paint behind the letters


class Letters:
    """notices: what fonts the text so far was drawn in, once its outlines or parts were asked for."""

    def __init__(self, document: ezdxf.document.Drawing):
        self._document = document
        self._fonts = Fonts(document.styles)
        self._faces: dict[str, object] = {}  # of the styles MTEXT is taken apart into
        self._left = _MOST_LETTERS
        self._drawn: dict[tuple[Font, str], tuple[str, str]] = {}
        self._count: Counter[tuple[Font, str]] = Counter()
        self._missing: dict[tuple[Font, str], dict[str, None]] = {}

    @property
    def notices(self) -> list[Notice]:
        found = []
        for (font, layer), (where, text) in self._drawn.items():
            more = self._count[font, layer] - 1
            said = f"text {shown(text, 40)!r}" + (f" and {more} more" if more else "")
            why = f": {font.why}" if font.why else ""
            found.append(
                Notice(
                    where,
                    f"{said} became the outlines of font {font.name}{why}",
                    layer=layer,
                    code="text-outlined",
                )
            )
        for (font, layer), letters in self._missing.items():
            listed = ", ".join(repr(c) for c in list(letters)[:5]) + (" ..." if len(letters) > 5 else "")
            where = self._drawn[font, layer][0]
            found.append(
                Notice(
                    where,
                    f"font {font.name} has no glyph for {listed}: left out",
                    layer=layer,
                    code="glyph-missing",
                )
            )
        return found

    def outlines(self, entity, name: str, layer: str) -> list[Curve]:
        """Of a TEXT or ATTRIB, in its own world. NoFontError if this machine has no font."""
        dxf = entity.dxf
        if not dxf.height > 0:
            raise ValueError(f"its height is {dxf.height}")
        text = " ".join(entity.plain_text().splitlines())
        if dxf.style not in self._faces:  # the letters of MTEXT were counted as such
            self._count_letters(text, name)
        if not text.strip():
            return []
        face = self._faces.get(dxf.style) or self._fonts.face(dxf.style)
        font = self._fonts.font(face)
        self._drawn.setdefault((font, layer), (name, text))
        self._count[font, layer] += 1
        if missing := font.missing(text):
            self._missing.setdefault((font, layer), {}).update(dict.fromkeys(missing))
        text = "".join(" " if c in missing or c.isspace() else c for c in text)
        drawn = font.drawn_at(1.0)
        path = drawn.text_path_ex(text, cap_height=dxf.height).to_path()
        if not len(path):
            return []
        placed = ezdxf.addons.text2path.alignment_transformation(
            drawn.measurements.scale_from_baseline(dxf.height),
            ezdxf.path.bbox([path], fast=True),
            entity.get_align_enum(),
            entity.fit_length(),
        )
        path = path.transform(placed * entity.wcs_transformation_matrix())
        return [Curve(_cubics(outline), True) for outline in path.sub_paths() if len(outline)]

    def parts(self, mtext, name: str) -> list:
        """An MTEXT as TEXT and LINE, in its own world. NoFontError if this machine has no font."""
        mtext = mtext.copy()
        mtext.doc = self._document
        self._count_letters(mtext.all_columns_raw_content(), name)
        columns = mtext.columns
        if columns is not None and not 0 <= columns.count <= _MOST_COLUMNS:
            raise ValueError(f"it has {columns.count} columns")
        for part in (mtext, *(columns.linked_columns if columns is not None else ())):
            part.text = _STACK.sub(r"\1^ ", part.text)
        mtext.dxf.bg_fill = mtext.dxf.get("bg_fill", 0) & _FRAME
        height = mtext.dxf.char_height
        if not 0 < height < math.inf:
            raise ValueError(f"its height is {height}")
        layout = ezdxf.layouts.VirtualLayout()
        apart = _Apart(layout, self._document, self._fonts, self._faces)
        width = mtext.dxf.get("width", 0.0)
        mtext.dxf.width = min(width if width > 1e-6 else apart.unbroken_width(mtext), _WIDEST * height)
        apart.explode(mtext, destroy=False)
        return list(layout)

    def _count_letters(self, text: str, name: str) -> None:
        self._left -= len(text)
        if self._left < 0:
            where = name.partition("/")[0]
            raise Error(
                f"the drawing's text unfolds to more than {_MOST_LETTERS} letters",
                where=where,
                code="drawing-too-large",
            )


# "^" between the two numbers of a stack, as CAD programs write it: ezdxf takes it and the letter behind it for a
# control character, unless that is a blank
_STACK = re.compile(r"((?<!\\)(?:\\\\)*\\S[^;^]*)\^(?! )")


class _Apart(ezdxf.addons.mtxpl.MTextExplode):
    """With fonts of ours, in styles that no document needs to know."""

    def __init__(self, layout, document, fonts: Fonts, faces: dict[str, object]):
        super().__init__(layout, document)
        self._fonts, self._faces = fonts, faces

    def get_font_face(self, mtext):
        return self._fonts.face(mtext.dxf.style)

    def get_font(self, ctx):
        return self._fonts.font(ctx.font_face).drawn_at(ctx.cap_height, ctx.width_factor)

    def unbroken_width(self, mtext) -> float:
        """Of its longest paragraph in one line; with tabs an upper bound."""
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
                line += max(self.space_width(context), _TAB * height)
            elif kind in (_tools.TokenType.SPACE, _tools.TokenType.NBSP):
                line += self.space_width(context)
            shape = context.paragraph
            indents = sum(max(0.0, each) for each in (shape.indent, shape.left, shape.right)) * height
            widest = max(widest, line + indents)
        return max((1 + 1e-9) * widest, height)

    def space_width(self, ctx) -> float:
        return super().space_width(ctx) * ctx.width_factor

    def mtext_exploded_text_style(self, font_face) -> str:
        name = f"\n{font_face}"  # no name in a DXF has more than one line
        self._faces[name] = font_face
        return name


def _cubics(path) -> np.ndarray:
    """(n, 4, 3) of an ezdxf Path without gaps."""
    begin, found = path.start, []
    for command in path.commands():
        end = command.end
        match command[1:]:
            case ():
                handles = begin.lerp(end, 1 / 3), begin.lerp(end, 2 / 3)
            case (handle,):
                handles = begin.lerp(handle, 2 / 3), end.lerp(handle, 2 / 3)
            case handles:
                pass
        found.append([point.xyz for point in (begin, *handles, end)])
        begin = end
    return np.array(found)
