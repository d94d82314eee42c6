"""SVG to Design: a walk over the tree in document order. What is not read yet is named in a notice."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

from ..design import Design, Element, Notice
from ..errors import Error
from ..units import length_px
from . import AS_DRAWN, ReadOptions, svg_shapes
from .svg_frame import Matrix, Page, multiply, parse_transform, read_page, scales
from .svg_style import INHERITED, cascade, is_zero, stroke_colour, unread, unread_own
from .svg_trace import LARGEST_MM, trace
from .svg_xml import parse_xml

_SVG = "{http://www.w3.org/2000/svg}"
_INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
_GROUPS = frozenset(("svg", "g", "a"))
# Never painted by themselves.
_DEFINITIONS = "defs symbol marker mask pattern clipPath filter linearGradient radialGradient"
_DESCRIPTIONS = "title desc metadata view font font-face color-profile"
_SILENT = frozenset(f"{_DEFINITIONS} {_DESCRIPTIONS}".split())
_WITH_MARKERS = frozenset(("path", "line", "polyline", "polygon"))
_UNREAD = {
    "text": "text is not read: turn it into paths first, for example with "
    "inkscape --export-text-to-path --export-plain-svg -o out.svg in.svg",
    "svg": "a nested svg is not read yet: left out",
    "style": "CSS rules are not read yet: what they say about strokes is missing",
}
_UNEVEN = 1.05  # below it, the width along and across differs by less than a brush's own scatter


def read_svg(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """The drawing, its strokes in document order, in mm with y up.

    A sheet given replaces the viewport's size; the drawing keeps its scale and its upper left corner.

    Error if it is not SVG, has no size, or has nothing to paint.
    """
    root, instructions = parse_xml(data)
    if root.tag not in (_SVG + "svg", "svg"):
        raise Error(f"the root element is <{_local(root)[:40]}>, not <svg>")
    page = read_page(root.attrib, options.sheet_mm)
    walk = _Walk(root, page)
    if "xml-stylesheet" in instructions:
        walk.notices.append(Notice("xml-stylesheet", _UNREAD["style"]))
        walk.has_rules = True
    walk.run()
    if not walk.elements:
        sentence = "the drawing holds nothing to paint"
        if walk.notices:
            first = next((notice for notice in walk.notices if notice.damaged), walk.notices[-1])
            sentence += f"; for example {first.where}: {first.sentence}"
        raise Error(sentence)
    title = root.find(_SVG + "title" if root.tag.startswith("{") else "title")
    name = "" if title is None else _one_line("".join(title.itertext()))
    return Design(page.sheet_mm, tuple(walk.elements), tuple(walk.notices), name)


def _local(node: ET.Element) -> str:
    return node.tag.rpartition("}")[2]


def _one_line(text: str) -> str:
    text = " ".join(text.split())
    return text if text.isprintable() else "".join(c if c.isprintable() else "?" for c in text)


class _Walk:
    def __init__(self, root: ET.Element, page: Page):
        self.root = root
        self.page = page
        self.diagonal = math.hypot(*page.viewport) / math.sqrt(2)
        self.elements: list[Element] = []
        self.notices: list[Notice] = list(page.notices)
        self.has_rules = False
        self.classed: list[Notice] = []  # of no account in a drawing without CSS rules
        self.ordinals: dict[ET.Element, int] = {}

    def run(self) -> None:
        top = self._enter(self.root, "svg", self.page.paper_from_user, INHERITED, "")
        waiting = [top] if top else []
        while waiting:
            nodes, matrix, properties, layer = waiting[-1]
            node = next(nodes, None)
            if node is None:
                waiting.pop()
                continue
            tag = _local(node)
            if tag in _SILENT or not (node.tag.startswith(_SVG) or "}" not in node.tag):
                continue
            if tag in _GROUPS and tag != "svg":
                if inner := self._enter(node, tag, matrix, properties, layer):
                    waiting.append(inner)
            elif tag in svg_shapes.TAGS:
                self._shape(node, tag, matrix, properties, layer)
            else:
                self._unread(node, tag, properties)
        if self.has_rules:
            return
        harmless = set(map(id, self.classed))
        self.notices = [notice for notice in self.notices if id(notice) not in harmless]

    def _enter(self, node: ET.Element, tag: str, matrix: Matrix, parent: dict[str, str], layer: str):
        """A group: its children, matrix, inherited properties and layer; None if nothing of it is painted."""
        properties, own, problems = cascade(parent, node.attrib, self.diagonal)
        if own["display"] == "none":
            return None
        matrix = self._common(node, matrix, own, problems)
        if matrix is None:
            return None
        if node.get(_INKSCAPE + "groupmode") == "layer":
            layer = _one_line(node.get(_INKSCAPE + "label") or node.get("id", ""))
        return iter(node), matrix, properties, layer

    def _common(self, node: ET.Element, matrix: Matrix, own: dict[str, str], problems) -> Matrix | None:
        """What groups and shapes share: notices and the matrix; None if nothing of it can be painted."""
        if is_zero(own["opacity"]):
            self._note(node, "it is fully transparent: left out")
            return None
        for sentence, damaged in problems:
            self._note(node, sentence, damaged)
        for sentence in unread_own(own):
            self._note(node, sentence)
        if node.get("class", "").strip():
            self._note(node, "class is not read yet: CSS rules do not count")
            self.classed.append(self.notices[-1])
        if (text := node.get("transform")) is None:
            return matrix
        try:
            matrix = multiply(matrix, parse_transform(text))
        except Error as error:
            self._note(node, f"{error}; it counts as none", damaged=True)
        if not all(map(math.isfinite, matrix)):
            self._note(node, "its transforms lead beyond all numbers: left out", damaged=True)
            return None
        return matrix

    def _shape(self, node: ET.Element, tag: str, matrix: Matrix, parent: dict[str, str], layer: str) -> None:
        properties, own, problems = cascade(parent, node.attrib, self.diagonal)
        if own["display"] == "none" or properties["visibility"] != "visible":
            return
        matrix = self._common(node, matrix, own, problems)
        if matrix is None:
            return
        colour, gradient = stroke_colour(properties)
        width = length_px(properties["stroke-width"], self.diagonal)
        if colour == "none" or width == 0:
            if properties["fill"] != "none" and tag != "line":
                self._note(node, "filled outlines are not read yet: left out")
            else:
                self._note(node, "it has no stroke: left out" if width else "its stroke-width is 0: left out")
            return
        greatest, least = scales(matrix)
        width_mm = width * math.sqrt(greatest) * math.sqrt(least)
        if least <= 1e-12 * greatest:
            self._note(node, "its transforms flatten it to nothing: left out")
            return
        if not width_mm <= LARGEST_MM:
            self._note(node, f"its stroke-width {width_mm:.6g} mm is beyond 1e6 mm: left out", damaged=True)
            return
        try:
            commands = svg_shapes.commands_of(tag, node.attrib, self.page.viewport)
            if not commands:
                self._note(node, "it has no geometry: left out")
        except svg_shapes.DamageError as damage:
            self._note(node, str(damage), damaged=True)
            commands = damage.commands
        line = trace(commands, matrix, greatest)
        if line.beyond is not None:
            self._note(node, self._beyond(node, tag, line.beyond), damaged=True)
        if line.lone_movetos:
            count = "a moveto" if line.lone_movetos == 1 else f"{line.lone_movetos} movetos"
            self._note(node, f"{count} without a line to follow: skipped")
        if not line.subpaths:
            return
        if properties["fill"] not in ("", "none"):
            self._note(node, "its fill is not read yet, only its stroke is")
        if greatest > _UNEVEN * least:
            self._note(
                node, f"its transforms stretch it unevenly: its width counts as {width_mm:.4g} mm, the mean"
            )
        for sentence in ([gradient] if gradient else []) + unread(properties, own, tag in _WITH_MARKERS):
            self._note(node, sentence)
        self.elements.append(Element(_one_line(node.get("id", "")), line.subpaths, width_mm, colour, layer))

    def _beyond(self, node: ET.Element, tag: str, place: int) -> str:
        name = {"path": "d", "polyline": "points", "polygon": "points"}.get(tag)
        if name is None:
            return "its geometry lies beyond 1e6 mm: left out"
        found = svg_shapes.snippet(node.get(name), place)
        return f"{name} leads beyond 1e6 mm at character {place + 1}: found {found}; read up to there"

    def _unread(self, node: ET.Element, tag: str, parent: dict[str, str]) -> None:
        if tag == "style":
            if not "".join(node.itertext()).strip():
                return
            self.has_rules = True
        else:
            properties, own, _ = cascade(parent, node.attrib, self.diagonal)
            if own["display"] == "none" or properties["visibility"] != "visible":
                return
        self._note(node, _UNREAD.get(tag, f"{tag[:40]} is not read yet: left out"))

    def _note(self, node: ET.Element, sentence: str, damaged: bool = False) -> None:
        self.notices.append(Notice(self._label(node), _one_line(sentence), damaged))

    def _label(self, node: ET.Element) -> str:
        if name := _one_line(node.get("id", "")):
            return name
        if not self.ordinals:
            counts: dict[str, int] = {}
            for each in self.root.iter():
                counts[each.tag] = self.ordinals[each] = counts.get(each.tag, 0) + 1
        return _local(node) if node is self.root else f"{_local(node)} {self.ordinals[node]}"
