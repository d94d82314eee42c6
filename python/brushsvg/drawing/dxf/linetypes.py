"""Lines of a DXF cut into the dashes of their line type."""

from __future__ import annotations

import math
from dataclasses import replace

from ...errors import Error
from ...geometry.arc_length import knots
from ..design import Element, Notice
from ..svg.dashes import dashed
from .lineweights import Pen

_MOST_DASHES = 100_000


class Dashes:
    """notices: on all that was cut so far, and on what was not."""

    def __init__(self):
        self.notices: list[Notice] = []
        self._left = _MOST_DASHES

    def cut(self, element: Element, pen: Pen) -> Element:
        """The element with each dash a sub-path. Error if there are too many."""
        if pen.line_type is None or element.fill_rule:
            return element
        pattern = [length * pen.line_scale for length in pen.line_type.pattern_mm]
        lengths = [float(knots(subpath.cubics)[:, -1].sum()) for subpath in element.subpaths]
        if not any(lengths):
            return element
        if not 0 < sum(pattern) < math.inf:
            unread = Notice(
                pen.line_type.name,
                "the line type is not read: its lines count as unbroken",
                code="dashes-unread",
            )
            if unread not in self.notices:
                self.notices.append(unread)
            return element
        if any(subpath.widths is not None for subpath in element.subpaths):
            self.notices.append(
                Notice(
                    element.id,
                    "its dashes are not read: its width varies",
                    layer=element.layer,
                    code="dashes-unread",
                )
            )
            return element
        pieces = []
        for subpath, length in zip(element.subpaths, lengths, strict=True):
            if length < sum(pattern):  # CAD programs draw it unbroken
                pieces.append(subpath)
                continue
            try:
                pieces += dashed(subpath, pattern, 0.0, self._left - len(pieces))
            except Error as error:
                raise Error(str(error), where=element.id, code=error.code) from None
        self._left -= len(pieces)
        if len(pieces) > len(element.subpaths):
            sentence = f"it is dashed: {len(pieces)} strokes, one for each dash"
            self.notices.append(Notice(element.id, sentence, layer=element.layer, code="dashed"))
        return replace(element, subpaths=tuple(pieces))
