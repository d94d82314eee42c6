"""Walk over an SVG tree in document order and collect the painted elements.

The walk does not use recursion, because files can be nested deeply.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from functools import cache

from ...errors import Error
from ..design import Element, Notice
from .clip_paths import ClipPaths
from .context import Context, NoticeList, local_name
from .css.cascade import INITIAL, Style, cascade, list_unread_properties
from .css.style_sheets import StyleSheets
from .css.transform import ReferenceBox, about_point, css_transform, individual_transform, transform_origin
from .element import PaintedElements
from .layers import is_notes_layer, layer_names
from .paint_servers import INVISIBLE_OPACITY, PaintServers
from .paths import shapes
from .paths.path_to_cubics import MAX_COORDINATE_MM
from .paths.power_stroke import find_elements_in_group_effects
from .references import find_referenced, href
from .settings import own_settings
from .transform import IDENTITY, Matrix, multiply, parse_transform
from .viewport import Page, nested_viewport, rectangle_corners

SVG = "{http://www.w3.org/2000/svg}"
# Elements that are never painted themselves.
_DEFINITIONS = "defs symbol marker mask pattern clipPath filter linearGradient radialGradient"
_DESCRIPTIONS = "title desc metadata view font font-face color-profile style script"
_ANIMATIONS = frozenset("animate set animateTransform animateMotion animateColor".split())
_SILENT = frozenset(f"{_DEFINITIONS} {_DESCRIPTIONS}".split()) | _ANIMATIONS
_TEXT_ADVICE = (
    "turn it into paths first, in Inkscape with Path > Object to Path, or with "
    "inkscape --export-text-to-path --export-plain-svg -o out.svg in.svg"
)
_COPY_SENTENCE = (
    "a selector depends on the elements around the original, as Inkscape shows the copy, and browsers do not: "
    "read as browsers do"
)
_TRANSFORMS = frozenset(("transform", "translate", "rotate", "scale"))
_MAX_COPIES = 100_000  # elements that use may copy; a page of text has a hundredth of this


class TreeWalk:
    """The walk over a drawing. Call run, then use the attributes.

    elements: the painted elements, in document order.
    notices: about the drawing, in the order of reading.
    layers: for each layer name the reason why the layer is not painted, "" if it is painted.
    left_out: number of elements that were left out without a notice, by reason.
    """

    def __init__(self, root: ET.Element, page: Page, chosen: set[ET.Element] | None, notices: list[Notice]):
        self.root = root
        self.namespace = SVG if root.tag.startswith(SVG) else ""
        self.page = page
        self.chosen = chosen
        self.rules = StyleSheets(root)
        self.by_id: dict[str, ET.Element] = {}
        animations = 0
        for node in root.iter():
            self.by_id.setdefault(node.get("id", ""), node)
            animations += local_name(node) in _ANIMATIONS
        if animations:
            sentence = f"animations are not read: {animations} left out, elements are read as if they were not animated"
            notices = [*notices, Notice("svg", sentence, code="animations-unread")]
        self.notes = NoticeList(root, [*page.notices, *self.rules.notices, *notices])
        paints = PaintServers(self.by_id, self.rules.declarations_for)
        self.clip_paths = ClipPaths(root, self.by_id, self.rules)
        self.painted = PaintedElements(self.by_id, self.notes, paints, find_elements_in_group_effects(root))
        self.layer_names = layer_names(root)
        self.layers = dict.fromkeys(self.layer_names.values(), "it is hidden in the drawing")
        self.left_out: dict[str, int] = {}
        self.stack: list[tuple[ET.Element, Iterator[ET.Element], Context]] = []
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
        while self.stack:
            parent, nodes, context = self.stack[-1]
            node = next(nodes, None)
            if node is None:
                self.stack.pop()
                self.entered.discard(parent)
            else:
                self._visit(node, context)

    def _enter(self, node: ET.Element, nodes: Iterator[ET.Element], context: Context) -> None:
        self.stack.append((node, nodes, context))
        self.entered.add(node)

    def _visit(self, node: ET.Element, context: Context) -> None:
        tag = local_name(node)
        is_target = context.size is not None
        if not node.tag.startswith(self.namespace) or "}" in node.tag[len(self.namespace) :] or not _is_shown(node):
            return
        if tag in _SILENT and not (tag == "symbol" and is_target):
            return
        if context.copied is not None:
            self.copies += 1
            if self.copies > _MAX_COPIES:
                sentence = f"use copies more than {_MAX_COPIES} elements"
                raise Error(sentence, where=self.notes.label(node), code="drawing-too-large")
        rules = self.rules.declarations_for(node, context.copied)
        style, problems = cascade(context.style, node.attrib, rules, context.diagonal)
        if tag in shapes.TAGS and style.inherited["stroke"] == "none":  # ezdxf writes stroke-width: none next to it
            problems = [problem for problem in problems if problem.code != "stroke-width-invalid"]
        if context.copied is not None and rules != self.rules.declarations_for(node):
            problems.append(Notice("", _COPY_SENTENCE, code="css-of-copies"))
        if node in self.layer_names and context.copied is None:
            context = context._replace(layer=self.layer_names[node])
            if is_notes_layer(context.layer):
                self._leave_documentation_out(node, context)
                return
            if style.own["display"] != "none" and style.inherited["visibility"] == "visible":
                self.layers[context.layer] = ""
        if style.own["display"] == "none" or (style.own["display"] == "contents" and tag in shapes.TAGS):
            self._leave_out("hidden")
            return
        # A copy belongs to its use: it is chosen if the use is chosen.
        if self.chosen is not None and node in self.chosen and context.copied is None:
            context = context._replace(chosen=True)
        inner = self._inner_context(node, context, style, problems)
        if inner is None:
            return
        if tag in ("g", "a"):
            self._enter(node, iter(node), inner)
        elif tag == "switch":
            self._enter(node, iter([child for child in node if _is_shown(child)][:1]), inner)
        elif tag in ("svg", "symbol"):
            if node is self.root and not is_target:
                self._enter(node, iter(node), inner)
            else:
                self._enter_viewport(node, inner._replace(size=context.size))
        elif tag == "use":
            self._enter_use(node, inner)
        elif style.inherited["visibility"] != "visible":
            self._leave_out("hidden")
        elif not context.chosen:
            return
        elif inner.settings.get("skip"):
            self._leave_out("to be skipped, by data-brushsvg-skip")
        elif tag not in shapes.TAGS:
            if tag == "text":
                self.notes.add(node, inner, "text is not read", code="text-unread", advice=_TEXT_ADVICE)
            else:
                self.notes.add(node, inner, f"{tag[:40]} is not read: left out", code="element-unread", about=tag)
        else:
            self.painted.add(node, tag, inner)

    def _leave_documentation_out(self, node: ET.Element, context: Context) -> None:
        sentence = f"layer {context.layer!r} is left out: a name that starts with % marks notes that are not painted"
        self.layers[context.layer] = "a name that starts with % marks notes, as in AxiDraw's software; rename it"
        self.notes.add(node, context, sentence, code="layer-of-notes", advice="rename it to paint it")

    def _leave_out(self, why: str) -> None:
        self.left_out[why] = self.left_out.get(why, 0) + 1

    def _inner_context(self, node: ET.Element, context: Context, style: Style, problems) -> Context | None:
        """Return the context for the content of a node. The result is None if nothing of the node can be painted."""
        settings, invalid = own_settings(node.attrib, node is self.root)
        context = context._replace(style=style, settings={**context.settings, **settings}, size=None)
        if float(style.own["opacity"]) < INVISIBLE_OPACITY:
            self.notes.add(node, context, "it is fully transparent: left out", code="transparent")
            return None
        for problem in problems:
            self.notes.add(node, context, problem.sentence, problem.damaged, code=problem.code, about=problem.about)
        for sentence in invalid:
            self.notes.add(node, context, sentence, damaged=True, code="setting-invalid")
        for name, sentence in list_unread_properties(style.own):
            self.notes.add(node, context, sentence, code="css-unread", about=name)
        if matrix := self._transform(node, context):
            context = context._replace(matrix=multiply(context.matrix, matrix))
        if (value := style.own["clip-path"]) != "none":
            context = self._clip(node, context, self.clip_paths.region, value)
        if (value := style.own["mask"]) != "none":
            context = self._clip(node, context, self.clip_paths.mask_region, value)
        if not all(map(math.isfinite, context.matrix)):
            self.notes.add(
                node,
                context,
                "its transforms give numbers that are not finite: left out",
                damaged=True,
                code="geometry-out-of-range",
            )
            return None
        return context

    def _clip(self, node: ET.Element, context: Context, region_of: Callable, value: str) -> Context:
        """Return the context with the visible region of a clip path or mask of the node."""
        is_shape = local_name(node) in shapes.TAGS
        try:
            inner = context
            if local_name(node) == "use":
                attributes = {**node.attrib, **context.style.geometry}
                inner = context._replace(matrix=_matrix_of_use(attributes, context))
            region = region_of(value, inner, lambda: self.painted.bounds(node, context) if is_shape else None)
        except Error as unread:
            self.notes.add(node, context, str(unread), code="clipping-unread", about=region_of.__name__)
            return context
        if region is None:
            return context
        return context._replace(clip=region if context.clip is None else context.clip.intersection(region))

    def _transform(self, node: ET.Element, context: Context) -> Matrix | None:
        """Return the transform of a node about its transform-origin.

        The result is None without a transform. The CSS properties count as far as they are valid, otherwise the
        attribute.
        """
        properties, em_px = context.style.geometry, context.em_px
        written = (node.get("transform") or "").strip()
        if not written and _TRANSFORMS.isdisjoint(properties):
            return None
        if node is self.root and context.copied is None:
            sentence = "programs disagree on a transform of the drawing itself, so it is ignored: put it on a group"
            sentence += " around all that is drawn"
            self.notes.add(node, context, sentence, damaged=True, code="transform-unread")
            return None

        @cache  # one transform can need the box a thousand times
        def box() -> ReferenceBox:
            return self._reference_box(node, context)

        matrix: Matrix = IDENTITY
        for name in ("translate", "rotate", "scale"):
            if name in properties:
                found = self._try_read(node, context, individual_transform, name, properties[name], box, em_px)
                matrix = multiply(matrix, found or IDENTITY)
        own_transform = None
        if "transform" in properties:
            own_transform = self._try_read(node, context, css_transform, properties["transform"], box, em_px)
        if own_transform is None and written:
            own_transform = self._try_read(node, context, parse_transform, written)
        matrix = multiply(matrix, own_transform or IDENTITY)
        point = None
        if "transform-origin" in properties:
            point = self._try_read(node, context, transform_origin, properties["transform-origin"], True, box, em_px)
        if point is None and (attribute := (node.get("transform-origin") or "").strip()):
            point = self._try_read(node, context, transform_origin, attribute, False, box, em_px)
        return about_point(point or box()[:2], matrix)

    def _try_read(self, node: ET.Element, context: Context, read: Callable, *words):
        """Return the result of a reader function, None with a notice if it raises Error."""
        try:
            return read(*words)
        except Error as error:
            self.notes.add(node, context, f"{error}; it has no effect", damaged=True, code="transform-unread")
            return None

    def _reference_box(self, node: ET.Element, context: Context) -> ReferenceBox:
        """Return the box of transform-box: the viewport, or the bounds of the shape."""
        kind = context.style.geometry.get("transform-box", "view-box").lower()
        if kind not in ("fill-box", "content-box", "stroke-box", "border-box"):
            return (0.0, 0.0, *context.viewport)
        bounds = self.painted.bounds(node, context) if local_name(node) in shapes.TAGS else None
        if bounds is None or kind in ("stroke-box", "border-box"):
            sentence = f"transform-box {kind} is not read on {local_name(node)[:40]}: it counts as view-box"
            self.notes.add(node, context, sentence, damaged=True, code="transform-unread")
            return (0.0, 0.0, *context.viewport)
        return bounds

    def _enter_viewport(self, node: ET.Element, context: Context) -> None:
        """Enter an svg inside the drawing, or a symbol that is used."""
        attributes = {**node.attrib, **context.style.geometry}
        try:
            found = nested_viewport(attributes, context.viewport, context.size or (None, None), context.em_px)
        except Error as error:
            self.notes.add(node, context, f"{error}: left out", damaged=True, code=error.code)
            return
        if found is None:
            return
        inner, viewport, corners, notices = found
        for notice in notices:
            self.notes.add(node, context, notice.sentence, code=notice.code)
        clip = context.clip
        if context.style.own["overflow"] not in ("visible", "auto"):
            corners_mm = rectangle_corners(context.matrix, corners)
            if not all(abs(mm) <= MAX_COORDINATE_MM for corner in corners_mm for mm in corner):
                sentence = "its viewport reaches beyond 1e6 mm: left out"
                self.notes.add(node, context, sentence, damaged=True, code="geometry-out-of-range")
                return
            clip = _clip_to_corners(clip, corners_mm)
        matrix = multiply(context.matrix, inner)
        self._enter(node, iter(node), context._replace(matrix=matrix, viewport=viewport, clip=clip, size=None))

    def _enter_use(self, node: ET.Element, context: Context) -> None:
        reference = href(node)
        target = find_referenced(reference, self.by_id)
        if target is None:
            if context.style.inherited["visibility"] != "visible":
                return
            if not reference:
                self.notes.add(node, context, "it has no href, so it shows nothing: left out", code="use-of-nothing")
                return
            reason = _explain_missing_target(reference, self.by_id)
            sentence = f"what it uses, {reference[:40]!r}, {reason}: left out"
            self.notes.add(node, context, sentence, code="use-of-nothing")
            return
        if target in self.entered or target is node:
            sentence = f"it uses {reference[:40]}, which contains it: left out"
            self.notes.add(node, context, sentence, damaged=True, code="use-of-itself")
            return
        attributes = {**node.attrib, **context.style.geometry}
        try:
            matrix = _matrix_of_use(attributes, context)
        except Error as error:
            self.notes.add(node, context, f"{error}: left out", damaged=True, code=error.code)
            return
        inner = context._replace(
            matrix=matrix,
            prefix=context.name(node),
            copied=target,
            size=(attributes.get("width"), attributes.get("height")),
        )
        self._enter(node, iter((target,)), inner)


def _matrix_of_use(attributes: dict[str, str], context: Context) -> Matrix:
    """Return the context's matrix, moved by x and y of a use. A clip path of the use moves along."""
    x, y = (
        context.length(attributes.get(name, "").strip() or "0", context.viewport[axis])
        for axis, name in enumerate(("x", "y"))
    )
    return multiply(context.matrix, (1.0, 0.0, 0.0, 1.0, x, y))


def _clip_to_corners(clip, corners: list[tuple[float, float]]):
    """Return the part of a region within a quadrilateral."""
    import shapely  # imported here because only drawings with clipping need it

    window = shapely.Polygon(corners)
    return window if clip is None else clip.intersection(window)


def _explain_missing_target(reference: str, by_id: dict[str, ET.Element]) -> str:
    if find_referenced(reference.strip(), by_id) is not None:
        return "has blanks around it and so refers to nothing, as in browsers"
    return "is nowhere in the drawing" if reference.startswith("#") else "is outside of the drawing"


def _is_shown(node: ET.Element) -> bool:
    """Whether conditional processing shows a node: no extensions, in English."""
    if "requiredExtensions" in node.attrib:
        return False
    languages = node.get("systemLanguage")
    return languages is None or any(word.strip().lower().split("-")[0] == "en" for word in languages.split(","))
