"""SVG to Design: a walk over the tree in document order. What is not read is named in a notice."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..design import Design, Element, Notice, SubPath, extremes
from ..errors import Error
from ..units import MM_PER, length_px
from . import AS_DRAWN, ReadOptions, svg_shapes
from .svg_frame import (
    Matrix,
    Page,
    about_origin,
    multiply,
    nested_viewport,
    parse_transform,
    read_page,
    scales,
)
from .svg_path_effect import INKSCAPE, drawn_line, with_widths
from .svg_rules import Rules, selected
from .svg_settings import own_settings
from .svg_style import INITIAL, Style, cascade, is_zero, paint, unread, unread_own
from .svg_trace import LARGEST_MM, trace
from .svg_xml import Document, parse_xml

_SVG = "{http://www.w3.org/2000/svg}"
_XLINK = "{http://www.w3.org/1999/xlink}"
# Never painted by themselves.
_DEFINITIONS = "defs symbol marker mask pattern clipPath filter linearGradient radialGradient"
_DESCRIPTIONS = "title desc metadata view font font-face color-profile style script"
_SILENT = frozenset(f"{_DEFINITIONS} {_DESCRIPTIONS}".split())
_WITH_MARKERS = frozenset(("path", "line", "polyline", "polygon"))
_TEXT = (
    "text is not read: turn it into paths first, for example with "
    "inkscape --export-text-to-path --export-plain-svg -o out.svg in.svg"
)
_UNEVEN = 1.05  # below it, the width along and across differs by less than a brush's own scatter
# A page of text has a hundredth of each.
_MOST_USED = 100_000  # elements that use may copy
_MOST_DASHES = 100_000
_MOST_DATA = 10_000_000  # characters of path data


def read_svg(data: bytes, options: ReadOptions = AS_DRAWN) -> Design:
    """The drawing, its elements in document order, in mm with y up.

    A sheet given replaces the viewport's size; the drawing keeps its scale and its upper left corner.

    Error if it is not SVG, has no size, has nothing to paint, or copies itself beyond all bounds.
    """
    try:
        return _read(parse_xml(data), options)
    except RecursionError:
        raise Error("its CSS is nested too deeply", where="style") from None


def _read(document: Document, options: ReadOptions) -> Design:
    root = document.root
    if root.tag not in (_SVG + "svg", "svg"):
        raise Error(f"the root element is <{_local(root)[:40]}>, not <svg>")
    page = read_page(root.attrib, options.sheet_mm)
    walk = _Walk(root, page, selected(root, options.select) if options.select else None)
    if "xml-stylesheet" in document.instructions:
        walk.notices.append(
            Notice("xml-stylesheet", "CSS in another file is not read: what it says is missing")
        )
    if any("Adobe Illustrator" in comment for comment in document.comments) and page.in_px:
        w, h = page.sheet_mm
        sentence = (
            "written by Adobe Illustrator, which counts 72 px to the inch: if it has "
            f"{w * 96 / 72:.4g} x {h * 96 / 72:.4g} mm there, give its svg "
            f'width="{w / MM_PER["px"]:.6g}pt" height="{h / MM_PER["px"]:.6g}pt"'
        )
        walk.notices.append(Notice("svg", sentence))
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


class _Context(NamedTuple):
    """What an element takes from where it stands. viewport: (w, h) in user units; window_mm: (x0, y0, x1, y1) outside
    of which a nested viewport shows nothing; prefix: ids of the uses that led here; size: width and height that a use
    asks of a symbol or svg right below it.
    """

    matrix: Matrix
    style: Style
    layer: str
    settings: dict
    viewport: tuple[float, float]
    window_mm: tuple[float, float, float, float] | None
    prefix: str
    chosen: bool
    used: bool = False
    size: tuple[str | None, str | None] | None = None

    @property
    def diagonal(self) -> float:
        return math.hypot(*self.viewport) / math.sqrt(2)


class _Walk:
    def __init__(self, root: ET.Element, page: Page, chosen: set[ET.Element] | None):
        self.root = root
        self.namespace = _SVG if root.tag.startswith(_SVG) else ""
        self.page = page
        self.chosen = chosen
        self.rules = Rules(root)
        self.by_id: dict[str, ET.Element] = {}
        for node in root.iter():
            self.by_id.setdefault(node.get("id", ""), node)
        self.elements: list[Element] = []
        self.notices: list[Notice] = [*page.notices, *self.rules.notices]
        self.ordinals: dict[ET.Element, int] = {}
        self.waiting: list[tuple[ET.Element, Iterator[ET.Element], _Context]] = []
        self.entered: set[ET.Element] = set()
        self.copies = self.nameless = self.data = 0
        self.dashes_left = _MOST_DASHES

    def run(self) -> None:
        page = self.page
        chosen = self.chosen is None
        top = _Context(page.paper_from_user, INITIAL, "", {}, page.viewport, None, "", chosen)
        self._visit(self.root, top)
        while self.waiting:
            parent, nodes, context = self.waiting[-1]
            node = next(nodes, None)
            if node is None:
                self.waiting.pop()
                self.entered.discard(parent)
            else:
                self._visit(node, context)

    def _enter(self, node: ET.Element, nodes: Iterator[ET.Element], context: _Context) -> None:
        self.waiting.append((node, nodes, context))
        self.entered.add(node)

    def _visit(self, node: ET.Element, context: _Context) -> None:
        tag = _local(node)
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
                raise Error(f"use copies more than {_MOST_USED} elements", where=self._label(node))
        style, problems = cascade(context.style, node.attrib, self.rules.of(node), context.diagonal)
        if style.own["display"] == "none":
            return
        if self.chosen is not None and node in self.chosen:
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
        elif style.inherited["visibility"] != "visible" or not context.chosen:
            return
        elif tag in svg_shapes.TAGS:
            if not inner.settings.get("skip"):
                self._shape(node, tag, inner)
        else:
            sentence = _TEXT if tag == "text" else f"{tag[:40]} is not read: left out"
            self._note(node, inner, sentence)

    def _inside(self, node: ET.Element, context: _Context, style: Style, problems) -> _Context | None:
        """What a node hands to what it holds; None if nothing of it can be painted."""
        layer = context.layer
        if node.get(INKSCAPE + "groupmode") == "layer":
            label = _one_line(node.get(INKSCAPE + "label") or node.get("id", ""))
            layer = f"{layer}/{label}" if layer else label
        settings, invalid = own_settings(node.attrib)
        context = context._replace(
            style=style, layer=layer, settings={**context.settings, **settings}, size=None
        )
        if is_zero(style.own["opacity"]):
            self._note(node, context, "it is fully transparent: left out")
            return None
        for sentence, damaged in [*problems, *((sentence, True) for sentence in invalid)]:
            self._note(node, context, sentence, damaged)
        for sentence in unread_own(style.own):
            self._note(node, context, sentence)
        text = style.geometry.get("transform", node.get("transform"))
        if text is None:
            return context
        try:
            matrix = parse_transform(text)
            if origin := style.geometry.get("transform-origin", node.get("transform-origin")):
                matrix = about_origin(matrix, origin, context.viewport)
            context = context._replace(matrix=multiply(context.matrix, matrix))
        except Error as error:
            self._note(node, context, f"{error}; it counts as none", damaged=True)
        if not all(map(math.isfinite, context.matrix)):
            self._note(node, context, "its transforms lead beyond all numbers: left out", damaged=True)
            return None
        return context

    def _viewport(self, node: ET.Element, context: _Context) -> None:
        """An svg inside the drawing, or a symbol that is used."""
        attributes = {**node.attrib, **context.style.geometry}
        try:
            found = nested_viewport(attributes, context.viewport, context.size or (None, None))
        except Error as error:
            self._note(node, context, f"{error}: left out", damaged=True)
            return
        if found is None:
            return
        inner, viewport, corners, notices = found
        for notice in notices:
            self._note(node, context, notice.sentence)
        window = context.window_mm
        if context.style.own["overflow"] not in ("visible", "auto"):
            window = _overlap(window, _box(context.matrix, corners))
        matrix = multiply(context.matrix, inner)
        self._enter(
            node, iter(node), context._replace(matrix=matrix, viewport=viewport, window_mm=window, size=None)
        )

    def _use(self, node: ET.Element, context: _Context) -> None:
        reference = (node.get("href") or node.get(_XLINK + "href") or "").strip()
        target = self.by_id.get(reference[1:]) if len(reference) > 1 and reference.startswith("#") else None
        if target is None:
            if context.style.inherited["visibility"] != "visible":
                return
            if not reference:
                self._note(node, context, "it has no href, so it uses nothing: left out")
                return
            shown = repr(reference[:40])
            lacking = (
                "is nowhere in the drawing" if reference.startswith("#") else "lies outside of the drawing"
            )
            self._note(node, context, f"what it uses, {shown}, {lacking}: left out")
            return
        if target in self.entered or target is node:
            self._note(
                node, context, f"it uses {reference[:40]}, in which it lies itself: left out", damaged=True
            )
            return
        attributes = {**node.attrib, **context.style.geometry}
        try:
            x, y = (
                length_px(attributes.get(name, "0"), context.viewport[axis])
                for axis, name in enumerate(("x", "y"))
            )
        except Error as error:
            self._note(node, context, f"{error}: left out", damaged=True)
            return
        prefix = "/".join(filter(None, (context.prefix, _one_line(node.get("id", "")))))
        inner = context._replace(
            matrix=multiply(context.matrix, (1.0, 0.0, 0.0, 1.0, x, y)),
            prefix=prefix,
            used=True,
            size=(attributes.get("width"), attributes.get("height")),
        )
        self._enter(node, iter((target,)), inner)

    def _shape(self, node: ET.Element, tag: str, context: _Context) -> None:
        properties, own = context.style.inherited, context.style.own
        stroke, stroke_problem = paint(properties, "stroke", self.by_id)
        fill, fill_problem = paint(properties, "fill", self.by_id) if tag != "line" else ("none", None)
        attributes = {**node.attrib, **context.style.geometry} if context.style.geometry else node.attrib
        power, sentences = drawn_line(node, self.by_id) if tag == "path" else (None, [])
        greatest, least = scales(context.matrix)
        if least <= 1e-12 * greatest:
            self._note(node, context, "its transforms flatten it to nothing: left out")
            return
        mm_per_user = math.sqrt(greatest * least)
        width_mm = length_px(properties["stroke-width"], context.diagonal) * mm_per_user
        if own["vector-effect"] == "non-scaling-stroke":
            width_mm *= MM_PER["px"] / mm_per_user
        if power:
            attributes = {**attributes, "d": power.d}
            stroke, stroke_problem = (fill, fill_problem) if fill != "none" else (stroke, stroke_problem)
            fill, fill_problem = "none", None
        if "width_mm" in context.settings:
            width_mm, power = context.settings["width_mm"], None
            if stroke == "none" and fill == "none":  # a shape stays a shape
                stroke = properties["color"]
        if power is None and width_mm == 0:
            stroke = "none"
        if stroke == "none" and fill == "none":
            self._note(node, context, "it has neither stroke nor fill: left out")
            return
        if not width_mm <= LARGEST_MM:
            sentence = f"its stroke-width {width_mm:.6g} mm is beyond 1e6 mm: left out"
            self._note(node, context, sentence, damaged=True)
            return
        told = len(self.notices)
        subpaths = self._subpaths(node, tag, attributes, context, greatest)
        if power:
            subpaths = with_widths(power, subpaths, mm_per_user)
        if stroke != "none":
            subpaths = self._dashed(node, context, subpaths, mm_per_user)
        subpaths = self._shown(node, context, subpaths)
        if not subpaths:
            return
        of = "fill" if stroke == "none" else "stroke"
        if of == "stroke" and greatest > _UNEVEN * least and "width_mm" not in context.settings:
            sentence = f"its transforms stretch it unevenly: its width counts as {width_mm:.4g} mm, the mean"
            self._note(node, context, sentence)
        problem = fill_problem if of == "fill" else stroke_problem
        for sentence in [problem] * bool(problem) + sentences + unread(properties, of, tag in _WITH_MARKERS):
            self._note(node, context, sentence)
        name = "/".join(filter(None, (context.prefix, _one_line(node.get("id", "")))))
        if not name:
            self.nameless += 1
            name = f"stroke{self.nameless}"
            if len(self.notices) > told:
                label = f"{name} ({self._label(node)})"
                self.notices[told:] = [replace(notice, where=label) for notice in self.notices[told:]]
        self.elements.append(
            Element(
                id=name,
                subpaths=subpaths,
                stroke_width_mm=0.0 if stroke == "none" else width_mm,
                colour=fill if stroke == "none" else stroke,
                layer=context.layer,
                settings=context.settings,
                fill_rule="" if fill == "none" else properties["fill-rule"],
            )
        )

    def _subpaths(
        self, node, tag: str, attributes, context: _Context, greatest: float
    ) -> tuple[SubPath, ...]:
        """An element's geometry on paper, as far as it is sound."""
        self.data += len(attributes.get("d", "")) + len(attributes.get("points", ""))
        if self.data > _MOST_DATA:
            raise Error(
                f"the drawing has more than {_MOST_DATA} characters of path data", where=self._label(node)
            )
        try:
            commands = svg_shapes.commands_of(tag, attributes, context.viewport)
            if not commands:
                self._note(node, context, "it has no geometry: left out")
        except svg_shapes.DamageError as damage:
            self._note(node, context, str(damage), damaged=True)
            commands = damage.commands
        line = trace(commands, context.matrix, greatest)
        if line.beyond is not None:
            self._note(node, context, _beyond(attributes, tag, line.beyond), damaged=True)
        if line.lone_movetos:
            count = "a moveto" if line.lone_movetos == 1 else f"{line.lone_movetos} movetos"
            self._note(node, context, f"{count} without a line to follow: skipped")
        return line.subpaths

    def _dashed(self, node, context: _Context, subpaths, mm_per_user: float) -> tuple[SubPath, ...]:
        properties = context.style.inherited
        if properties["stroke-dasharray"] == "none" or not subpaths:
            return subpaths
        from .svg_dashes import dashed

        words = properties["stroke-dasharray"].replace(",", " ").split()
        try:
            pattern = [length_px(word, context.diagonal) * mm_per_user for word in words]
            offset = length_px(properties["stroke-dashoffset"], context.diagonal) * mm_per_user
        except Error as error:
            self._note(node, context, f"stroke-dasharray: {error}: the line counts as solid")
            return subpaths
        if min(pattern, default=0.0) < 0:
            self._note(node, context, "stroke-dasharray has a negative length: the line counts as solid")
            return subpaths
        if sum(pattern) == 0:
            return subpaths
        if subpaths[0].widths is not None:
            self._note(node, context, "its dashes are not read: its width varies")
            return subpaths
        pieces: list[SubPath] = []
        try:
            for subpath in subpaths:
                pieces += dashed(subpath, pattern, offset, self.dashes_left - len(pieces))
        except Error as error:
            raise Error(str(error), where=self._label(node)) from None
        self.dashes_left -= len(pieces)
        self._note(node, context, f"it is dashed: {len(pieces)} strokes, one for each dash")
        return tuple(pieces)

    def _shown(self, node, context: _Context, subpaths) -> tuple[SubPath, ...]:
        """What a nested viewport shows of it: all, or nothing. A line is not cut."""
        window = context.window_mm
        if window is None or not subpaths:
            return subpaths
        points = np.concatenate([extremes(subpath.cubics) for subpath in subpaths])
        (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
        if x0 > window[2] or x1 < window[0] or y0 > window[3] or y1 < window[1]:
            self._note(node, context, "it lies outside of the viewport that would show it: left out")
            return ()
        slack = 1e-6
        if (
            x0 < window[0] - slack
            or y0 < window[1] - slack
            or x1 > window[2] + slack
            or y1 > window[3] + slack
        ):
            self._note(node, context, "its viewport cuts it off in the drawing: painted whole")
        return subpaths

    def _note(self, node: ET.Element, context: _Context, sentence: str, damaged: bool = False) -> None:
        if context.chosen or node is self.root:
            self.notices.append(Notice(self._label(node), _one_line(sentence), damaged, context.layer))

    def _label(self, node: ET.Element) -> str:
        if name := _one_line(node.get("id", "")):
            return name
        if not self.ordinals:
            counts: dict[str, int] = {}
            for each in self.root.iter():
                counts[each.tag] = self.ordinals[each] = counts.get(each.tag, 0) + 1
        return _local(node) if node is self.root else f"{_local(node)} {self.ordinals[node]}"


def _applies(node: ET.Element) -> bool:
    """Conditional processing: no extension is known, English is spoken."""
    if "requiredExtensions" in node.attrib:
        return False
    languages = node.get("systemLanguage")
    return languages is None or any(
        word.strip().lower().split("-")[0] == "en" for word in languages.split(",")
    )


def _beyond(attributes, tag: str, place: int) -> str:
    name = {"path": "d", "polyline": "points", "polygon": "points"}.get(tag)
    if name is None:
        return "its geometry lies beyond 1e6 mm: left out"
    found = svg_shapes.snippet(attributes[name], place)
    return f"{name} leads beyond 1e6 mm at character {place + 1}: found {found}; read up to there"


Box = tuple[float, float, float, float]


def _box(matrix: Matrix, corners: tuple[float, float, float, float]) -> Box:
    """Bounds [mm] of a rectangle (x, y, width, height) in user units."""
    a, b, c, d, e, f = matrix
    x, y, width, height = corners
    points = [(a * u + c * v + e, b * u + d * v + f) for u in (x, x + width) for v in (y, y + height)]
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def _overlap(one: Box | None, other: Box) -> Box:
    if one is None:
        return other
    return max(one[0], other[0]), max(one[1], other[1]), min(one[2], other[2]), min(one[3], other[3])
