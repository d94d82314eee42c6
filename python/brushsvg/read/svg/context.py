"""The context that an SVG element inherits, and the notices of a drawing."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, NamedTuple

from ...units import length_px
from ..design import Notice
from .css.cascade import Style
from .transform import Matrix

if TYPE_CHECKING:
    import shapely


class Context(NamedTuple):
    """The state that an element inherits from the elements around it.

    matrix: user units to paper.
    style: the style of the element around it.
    layer: "" outside of any layer.
    settings: the settings for brushsvg, inherited.
    viewport: (width, height) in user units.
    clip: the region on paper that clip paths, masks and nested viewports show; None for all.
    prefix: ids of the use elements around it, separated by "/".
    chosen: whether the user's selection includes it.
    copied: the element that the innermost use copies, None outside of uses.
    size: width and height that the use gives to a symbol or svg directly below it.
    """

    matrix: Matrix
    style: Style
    layer: str
    settings: dict
    viewport: tuple[float, float]
    clip: shapely.Geometry | None
    prefix: str
    chosen: bool
    copied: ET.Element | None = None
    size: tuple[str | None, str | None] | None = None

    @property
    def diagonal(self) -> float:
        return math.hypot(*self.viewport) / math.sqrt(2)

    @property
    def em_px(self) -> float:
        return float(self.style.inherited["font-size"])

    @property
    def counts_in_screen_px(self) -> bool:
        """Whether widths and dashes count in px of the screen and ignore transforms."""
        return self.style.own["vector-effect"] == "non-scaling-stroke"

    def length(self, text: str, percent_of: float) -> float:
        """Return a length in user units. Raises Error if the text is not a length."""
        return length_px(text, percent_of, self.em_px)

    def name(self, node: ET.Element) -> str:
        """Return the id of an element with the ids of the uses that copy it.

        Without an id, the result is the ids of the uses alone, or "" outside of uses.
        """
        return "/".join(filter(None, (self.prefix, printable_line(node.get("id", "")))))


class NoticeList:
    """The notices of a drawing in the order of reading, with names for its elements."""

    def __init__(self, root: ET.Element, notices: list[Notice]):
        self.root = root
        self.notices = notices
        self._ordinals: dict[ET.Element, int] = {}

    def add(
        self,
        node: ET.Element,
        context: Context,
        sentence: str,
        damaged: bool = False,
        *,
        code: str,
        about: str = "",
        advice: str = "",
    ) -> None:
        """Add a notice about an element, if the element is chosen or the root."""
        if context.chosen or node is self.root:
            in_one_line = printable_line(sentence)
            self.notices.append(Notice(self.label(node), in_one_line, damaged, context.layer, code, about, advice))

    def label(self, node: ET.Element) -> str:
        """Return the id of an element, or its type and number: "rect 3"."""
        if name := printable_line(node.get("id", "")):
            return name
        if not self._ordinals:
            counts: dict[str, int] = {}
            for element in self.root.iter():
                counts[element.tag] = self._ordinals[element] = counts.get(element.tag, 0) + 1
        return local_name(node) if node is self.root else f"{local_name(node)} {self._ordinals[node]}"


def local_name(node: ET.Element) -> str:
    """Return the tag of an element without its namespace."""
    return node.tag.rpartition("}")[2]


def printable_line(text: str) -> str:
    """Return text of a drawing for use in a name or a sentence: one printable line."""
    text = " ".join(text.split())
    return text if text.isprintable() else "".join(c if c.isprintable() else "?" for c in text)
