"""What an SVG element takes from where it stands, and what is noticed about it."""

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
    """viewport: (w, h) in user units; clip: the region on paper that clip paths and
    nested viewports show, None for all; prefix: ids of the
    uses that enclose it; copied: the element that the innermost copies; size: width and height that it gives a symbol
    or svg right below it.
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
    def is_of_screen(self) -> bool:
        """Return whether widths and dashes count in px of the screen, under any transforms."""
        return self.style.own["vector-effect"] == "non-scaling-stroke"

    def length(self, text: str, percent_of: float) -> float:
        """A length in user units. Error if it is none."""
        return length_px(text, percent_of, self.em_px)

    def name(self, node: ET.Element) -> str:
        """Return the name of an element through the uses that copy it, "" without an id."""
        return "/".join(filter(None, (self.prefix, one_line(node.get("id", "")))))


class Notes:
    """The notices of a drawing, in the order met, and names for its elements in them."""

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
        """Say something of an element that is to be painted; of any other there is nothing to say."""
        if context.chosen or node is self.root:
            in_one_line = one_line(sentence)
            self.notices.append(
                Notice(self.label(node), in_one_line, damaged, context.layer, code, about, advice)
            )

    def label(self, node: ET.Element) -> str:
        """An element's id, or which one of its kind it is: "rect 3"."""
        if name := one_line(node.get("id", "")):
            return name
        if not self._ordinals:
            counts: dict[str, int] = {}
            for each in self.root.iter():
                counts[each.tag] = self._ordinals[each] = counts.get(each.tag, 0) + 1
        return local(node) if node is self.root else f"{local(node)} {self._ordinals[node]}"


def local(node: ET.Element) -> str:
    """An element's name without its namespace."""
    return node.tag.rpartition("}")[2]


def one_line(text: str) -> str:
    """Text of a drawing as it can stand in a name or a sentence."""
    text = " ".join(text.split())
    return text if text.isprintable() else "".join(c if c.isprintable() else "?" for c in text)
