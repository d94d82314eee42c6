"""The walk over an SVG tree in document order: what is painted, where, with which style. No recursion: files nest."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator

from ..design import Element, Notice
from ..errors import Error
from . import svg_shapes
from .svg_context import Context, Notes, local
from .svg_element import Painted
from .svg_frame import Page, box_of, nested_viewport, overlap
from .svg_layers import layer_names
from .svg_paint import UNSEEN, Paints
from .svg_rules import Rules
from .svg_settings import own_settings
from .svg_style import INITIAL, Style, cascade, unread_own
from .svg_transform import Matrix, about_origin, multiply, parse_transform

SVG = "{http://www.w3.org/2000/svg}"
_XLINK = "{http://www.w3.org/1999/xlink}"
# Never painted by themselves.
_DEFINITIONS = "defs symbol marker mask pattern clipPath filter linearGradient radialGradient"
_DESCRIPTIONS = "title desc metadata view font font-face color-profile style script"
_SILENT = frozenset(f"{_DEFINITIONS} {_DESCRIPTIONS}".split())
_TEXT = (
    "text is not read: turn it into paths first, in Inkscape with Path > Object to Path, or with "
    "inkscape --export-text-to-path --export-plain-svg -o out.svg in.svg"
)
_MOST_USED = 100_000  # elements that use may copy: a page of text has a hundredth


class Walk:
    """elements, notices and layers (name -> why it is not painted, "" if it is) of the drawing, once run."""

    def __init__(self, root: ET.Element, page: Page, chosen: set[ET.Element] | None, notices: list[Notice]):
        self.root = root
        self.namespace = SVG if root.tag.startswith(SVG) else ""
        self.page = page
        self.chosen = chosen
        self.rules = Rules(root)
        self.by_id: dict[str, ET.Element] = {}
        for node in root.iter():
            self.by_id.setdefault(node.get("id", ""), node)
        self.notes = Notes(root, [*page.notices, *self.rules.notices, *notices])
        self.painted = Painted(self.by_id, self.notes, Paints(self.by_id, self.rules.of))
        self.layer_names = layer_names(root)
        self.layers = dict.fromkeys(self.layer_names.values(), "it is hidden in the drawing")
        self.left_out: dict[str, int] = {}  # without a notice, by reason
        self.waiting: list[tuple[ET.Element, Iterator[ET.Element], Context]] = []
        self.entered: set[ET.Element] = set()
        self.copies = 0

    @property
    def elements(self) -> list[Element]:
        return self.painted.elements

    @property
    def notices(self) -> list[Notice]:
        return self.notes.notices

    def run(self) -> None:
        page = self.page
        chosen = self.chosen is None
        top = Context(page.paper_from_user, INITIAL, "", {}, page.viewport, None, "", chosen)
        self._visit(self.root, top)
        while self.waiting:
            parent, nodes, context = self.waiting[-1]
            node = next(nodes, None)
            if node is None:
                self.waiting.pop()
                self.entered.discard(parent)
            else:
                self._visit(node, context)

    def _enter(self, node: ET.Element, nodes: Iterator[ET.Element], context: Context) -> None:
        self.waiting.append((node, nodes, context))
        self.entered.add(node)

    def _visit(self, node: ET.Element, context: Context) -> None:
        tag = local(node)
        is_target = context.size is not None
        if (
            not node.tag.startswith(self.namespace)
            or "}" in node.tag[len(self.namespace) :]
            or not _applies(node)
        ):
            return
        if tag in _SILENT and not (tag == "symbol" and is_target):
            return
        if context.used:
            self.copies += 1
            if self.copies > _MOST_USED:
                raise Error(f"use copies more than {_MOST_USED} elements", where=self.notes.label(node))
        style, problems = cascade(context.style, node.attrib, self.rules.of(node), context.diagonal)
        if node in self.layer_names and not context.used:
            context = context._replace(layer=self.layer_names[node])
            if style.own["display"] != "none" and style.inherited["visibility"] == "visible":
                self.layers[context.layer] = ""
        if style.own["display"] == "none":
            self._leave_out("hidden")
            return
        if self.chosen is not None and node in self.chosen and not context.used:  # a copy is its use's
            context = context._replace(chosen=True)
        inner = self._inside(node, context, style, problems)
        if inner is None:
            return
        if tag in ("g", "a"):
            self._enter(node, iter(node), inner)
        elif tag == "switch":
            self._enter(node, iter([child for child in node if _applies(child)][:1]), inner)
        elif tag in ("svg", "symbol"):
            if node is self.root and not is_target:
                self._enter(node, iter(node), inner)
            else:
                self._viewport(node, inner._replace(size=context.size))
        elif tag == "use":
            self._use(node, inner)
        elif style.inherited["visibility"] != "visible":
            self._leave_out("hidden")
        elif not context.chosen:
            return
        elif inner.settings.get("skip"):
            self._leave_out("to be skipped, by data-brushsvg-skip")
        elif tag not in svg_shapes.TAGS:
            self.notes.add(node, inner, _TEXT if tag == "text" else f"{tag[:40]} is not read: left out")
        else:
            self.painted.add(node, tag, inner)

    def _leave_out(self, why: str) -> None:
        self.left_out[why] = self.left_out.get(why, 0) + 1

    def _inside(self, node: ET.Element, context: Context, style: Style, problems) -> Context | None:
        """What a node hands to what it holds; None if nothing of it can be painted."""
        settings, invalid = own_settings(node.attrib, node is self.root)
        context = context._replace(style=style, settings={**context.settings, **settings}, size=None)
        if float(style.own["opacity"]) < UNSEEN:
            self.notes.add(node, context, "it is fully transparent: left out")
            return None
        for sentence, damaged in [*problems, *((sentence, True) for sentence in invalid)]:
            self.notes.add(node, context, sentence, damaged)
        for sentence in unread_own(style.own):
            self.notes.add(node, context, sentence)
        if matrix := self._transform(node, context):
            context = context._replace(matrix=multiply(context.matrix, matrix))
        if not all(map(math.isfinite, context.matrix)):
            self.notes.add(node, context, "its transforms lead beyond all numbers: left out", damaged=True)
            return None
        return context

    def _transform(self, node: ET.Element, context: Context) -> Matrix | None:
        """The property's if it makes sense, else the attribute's."""
        geometry = context.style.geometry
        for text in (geometry.get("transform"), node.get("transform")):
            if text is None:
                continue
            try:
                matrix = parse_transform(text)
                if origin := geometry.get("transform-origin", node.get("transform-origin")):
                    matrix = about_origin(matrix, origin, context.viewport, context.em_px)
                return matrix
            except Error as error:
                self.notes.add(node, context, f"{error}; it counts as none", damaged=True)
        return None

    def _viewport(self, node: ET.Element, context: Context) -> None:
        """An svg inside the drawing, or a symbol that is used."""
        attributes = {**node.attrib, **context.style.geometry}
        try:
            found = nested_viewport(attributes, context.viewport, context.size or (None, None), context.em_px)
        except Error as error:
            self.notes.add(node, context, f"{error}: left out", damaged=True)
            return
        if found is None:
            return
        inner, viewport, corners, notices = found
        for notice in notices:
            self.notes.add(node, context, notice.sentence)
        window = context.window_mm
        if context.style.own["overflow"] not in ("visible", "auto"):
            window = overlap(window, box_of(context.matrix, corners))
        matrix = multiply(context.matrix, inner)
        self._enter(
            node, iter(node), context._replace(matrix=matrix, viewport=viewport, window_mm=window, size=None)
        )

    def _use(self, node: ET.Element, context: Context) -> None:
        reference = (node.get("href") or node.get(_XLINK + "href") or "").strip()
        target = self.by_id.get(reference[1:]) if len(reference) > 1 and reference.startswith("#") else None
        if target is None:
            if context.style.inherited["visibility"] != "visible":
                return
            if not reference:
                self.notes.add(node, context, "it has no href, so it uses nothing: left out")
                return
            shown = repr(reference[:40])
            lacking = (
                "is nowhere in the drawing" if reference.startswith("#") else "lies outside of the drawing"
            )
            self.notes.add(node, context, f"what it uses, {shown}, {lacking}: left out")
            return
        if target in self.entered or target is node:
            sentence = f"it uses {reference[:40]}, in which it lies itself: left out"
            self.notes.add(node, context, sentence, damaged=True)
            return
        attributes = {**node.attrib, **context.style.geometry}
        try:
            x, y = (
                context.length(attributes.get(name, "0"), context.viewport[axis])
                for axis, name in enumerate(("x", "y"))
            )
        except Error as error:
            self.notes.add(node, context, f"{error}: left out", damaged=True)
            return
        inner = context._replace(
            matrix=multiply(context.matrix, (1.0, 0.0, 0.0, 1.0, x, y)),
            prefix=context.name(node),
            used=True,
            size=(attributes.get("width"), attributes.get("height")),
        )
        self._enter(node, iter((target,)), inner)


def _applies(node: ET.Element) -> bool:
    """Conditional processing: no extension is known, English is spoken."""
    if "requiredExtensions" in node.attrib:
        return False
    languages = node.get("systemLanguage")
    return languages is None or any(
        word.strip().lower().split("-")[0] == "en" for word in languages.split(",")
    )
