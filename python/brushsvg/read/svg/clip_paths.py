"""Clip paths and masks of SVG: the visible region of an element (CSS Masking 1)."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING

from ...errors import Error
from ...units import length_px
from .context import Context, local_name
from .css.cascade import INITIAL, Style, cascade
from .css.style_sheets import StyleSheets
from .paint_servers import URL
from .paths import shapes
from .paths.path_to_cubics import trace
from .references import find_referenced, href
from .transform import Matrix, multiply, parse_transform, scales
from .viewport import rectangle_corners

if TYPE_CHECKING:
    import shapely

_CSS_TRANSFORMS = frozenset(("transform", "translate", "rotate", "scale"))
# The rectangle of a mask that does not define one.
DEFAULT_MASK_RECTANGLE = {"x": "-10%", "y": "-10%", "width": "120%", "height": "120%"}
_MAX_DEPTH = 20  # nesting depth of clip paths and uses
_TOO_DEEP = "its clip paths or masks refer to each other, or are nested too deep: painted whole"
_MASK_UNREAD = "its mask is not made of filled white and black shapes alone, which is not read: painted whole"


class ClipPathError(Error):
    """A clip path or mask that cannot be read. The element is painted whole."""


def _refuse_css_transform(style: Style) -> None:
    """Raise ClipPathError if CSS transforms a clip path.

    Only transform attributes are read here. Without this check the clip path would be in the wrong place.
    """
    if not _CSS_TRANSFORMS.isdisjoint(style.geometry):
        sentence = "its clip path has a transform in CSS, which is not read: painted whole"
        raise ClipPathError(sentence, code="clipping-unread")


class ClipPaths:
    """The clip paths and masks of a drawing.

    by_id: the elements of the drawing; rules: its style sheets.
    """

    def __init__(self, root: ET.Element, by_id: dict[str, ET.Element], rules: StyleSheets):
        self._root = root
        self._by_id = by_id
        self._rules = rules

    @cached_property
    def _parents(self) -> dict[ET.Element, ET.Element]:
        return {child: parent for parent in self._root.iter() for child in parent}

    def _style_of(self, node: ET.Element, diagonal: float) -> Style:
        """Return the style of an element, inherited from all elements around it."""
        parent = self._parents.get(node)
        above = INITIAL if parent is None else self._style_of(parent, diagonal)
        return cascade(above, node.attrib, self._rules.declarations_for(node), diagonal)[0]

    def region(
        self, value: str, context: Context, bounds: Callable[[], tuple[float, float, float, float] | None]
    ) -> shapely.Geometry | None:
        """Return the region of a clip-path property on paper.

        The result is None if the property refers to nothing, which clips nothing.

        context: its matrix maps user units to paper; bounds: returns (x, y, width, height) of the element.
        Raises ClipPathError if the clip path cannot be read.
        """
        url = URL.match(value)
        if not url:
            raise ClipPathError("clip-path: only url(#...) is read: painted whole", code="clipping-unread")
        target = find_referenced(url[1].strip().strip("\"'"), self._by_id)
        if target is None or local_name(target) != "clipPath":
            return None
        return self._region(target, context, bounds, 0)

    def _region(self, node: ET.Element, context: Context, bounds, depth: int) -> shapely.Geometry:
        import shapely

        if depth > _MAX_DEPTH:
            raise ClipPathError(_TOO_DEEP, code="clipping-unread")
        matrix = context.matrix
        if node.get("transform"):
            matrix = multiply(matrix, parse_transform(node.get("transform", "")))
        if node.get("clipPathUnits") == "objectBoundingBox":
            matrix = multiply(matrix, _matrix_from_bounds(bounds()))
        style = self._style_of(node, context.diagonal)
        _refuse_css_transform(style)
        parts = self._shapes(node, context._replace(matrix=matrix), style, depth, "clip-rule")
        region = shapely.union_all([region for _, region in parts])
        return self._clip_by_own_path(style, context, region, depth)

    def mask_region(
        self, value: str, context: Context, bounds: Callable[[], tuple[float, float, float, float] | None]
    ) -> shapely.Geometry | None:
        """Return the visible region of a mask of white and black shapes, or of opaque ones if its alpha counts.

        The parameters, None and ClipPathError are as for region.
        """
        import shapely

        url = URL.match(value)
        target = find_referenced(url[1].strip().strip("\"'"), self._by_id) if url else None
        if url and (target is None or local_name(target) != "mask"):
            return None
        if not url:
            raise ClipPathError(_MASK_UNREAD, code="clipping-unread")
        matrix = context.matrix
        if target.get("maskContentUnits") == "objectBoundingBox":
            matrix = multiply(matrix, _matrix_from_bounds(bounds()))
        rectangle_region = self._mask_rectangle(target, context, bounds)
        visible = shapely.Polygon()
        inner = context._replace(matrix=matrix)
        style = self._style_of(target, context.diagonal)
        is_alpha = style.own["mask-type"].lower() == "alpha"
        for shape_style, region in self._shapes(target, inner, style, 0, "fill-rule"):
            is_visible = _is_white(shape_style, is_alpha)
            visible = visible.union(region) if is_visible else visible.difference(region)
        if rectangle_region is not None:
            visible = visible.intersection(rectangle_region)
        return self._clip_by_own_path(style, context, visible, 0)

    def _mask_rectangle(self, mask: ET.Element, context: Context, bounds) -> shapely.Geometry | None:
        """Return the rectangle outside of which a mask hides everything.

        The result is None for the default rectangle of a group, which is larger than the group, and of a horizontal or
        vertical line, whose bounds have no area. Any other rectangle in the size of such bounds is empty.
        """
        import shapely

        sides = {name: mask.get(name, default).strip() for name, default in DEFAULT_MASK_RECTANGLE.items()}
        if mask.get("maskUnits") == "userSpaceOnUse":
            matrix = context.matrix
            rectangle = [
                context.length(text, context.viewport[name in ("y", "height")]) for name, text in sides.items()
            ]
        else:
            box = bounds()
            has_area = box is not None and box[2] * box[3] > 0
            if not has_area and sides == DEFAULT_MASK_RECTANGLE:
                return None
            if box is not None and not has_area:
                return shapely.Polygon()
            matrix = multiply(context.matrix, _matrix_from_bounds(box))
            rectangle = [length_px(text, 1.0, context.em_px) for text in sides.values()]
        return shapely.Polygon(rectangle_corners(matrix, tuple(rectangle)))

    def _clip_by_own_path(self, style: Style, context: Context, region, depth: int) -> shapely.Geometry:
        """Return the part of a region inside the clip path of its own style."""
        if (value := style.own["clip-path"]) == "none" or not (url := URL.match(value)):
            return region
        target = find_referenced(url[1].strip().strip("\"'"), self._by_id)
        if target is None:
            return region
        return region.intersection(self._region(target, context, lambda: None, depth + 1))

    def _shapes(
        self, node: ET.Element, context: Context, parent: Style, depth: int, rule: str
    ) -> Iterator[tuple[Style, shapely.Geometry]]:
        """Yield the shapes in a clip path or mask, with their style.

        rule: "clip-rule" for a clip path, "fill-rule" for a mask. Groups are read in masks only.
        """
        from ..clipping import fill_region, flatten_subpaths

        for child in node:
            tag = local_name(child)
            style, _ = cascade(parent, child.attrib, self._rules.declarations_for(child), context.diagonal)
            if style.own["display"] == "none" or style.inherited["visibility"] != "visible":
                continue
            _refuse_css_transform(style)
            matrix: Matrix = context.matrix
            if child.get("transform"):
                matrix = multiply(matrix, parse_transform(child.get("transform", "")))
            here = context._replace(matrix=matrix)
            is_group = tag in ("g", "a") and rule == "fill-rule"
            if tag == "use" or is_group:
                if rule == "fill-rule":
                    _refuse_effects(style)
                if depth > _MAX_DEPTH:
                    raise ClipPathError(_TOO_DEEP, code="clipping-unread")
                inside = self._shapes(child, here, style, depth + 1, rule)
                for shape_style, region in inside if is_group else self._use_shapes(child, here, style, depth, rule):
                    yield shape_style, self._clip_by_own_path(style, here, region, depth)
            elif tag == "text":
                raise ClipPathError("its clip path is text, which is not read: painted whole", code="clipping-unread")
            elif tag in shapes.TAGS:
                attributes = {**child.attrib, **style.geometry}
                try:
                    commands = shapes.shape_commands(tag, attributes, here.viewport, here.em_px)
                except shapes.DamageError as damage:
                    commands = damage.commands
                line = trace(commands, matrix, scales(matrix)[0])
                region = fill_region(flatten_subpaths(line.subpaths), style.inherited[rule])
                yield style, self._clip_by_own_path(style, here, region, depth)
            elif tag in ("image", "svg", "symbol", "switch", "foreignObject") and rule == "fill-rule":
                raise ClipPathError(_MASK_UNREAD, code="clipping-unread")

    def _use_shapes(
        self, use: ET.Element, context: Context, style: Style, depth: int, rule: str
    ) -> Iterator[tuple[Style, shapely.Geometry]]:
        target = find_referenced(href(use), self._by_id)
        if target is None:
            return
        if depth > _MAX_DEPTH:
            raise ClipPathError(_TOO_DEEP, code="clipping-unread")
        x, y = (context.length(use.get(name, "").strip() or "0", context.viewport[k]) for k, name in enumerate("xy"))
        moved = context._replace(matrix=multiply(context.matrix, (1.0, 0.0, 0.0, 1.0, x, y)))
        wrapper = ET.Element("clipPath")
        wrapper.append(target)
        yield from self._shapes(wrapper, moved, style, depth + 1, rule)


def _matrix_from_bounds(box: tuple[float, float, float, float] | None) -> Matrix:
    """Return the matrix from fractions of bounds (x, y, width, height) to user units."""
    if box is None:
        sentence = "its clip path or mask counts in the size of a group, which is not read: painted whole"
        raise ClipPathError(sentence, code="clipping-unread")
    return (box[2], 0.0, 0.0, box[3], box[0], box[1])


def _refuse_effects(style: Style) -> None:
    """Raise ClipPathError for effects that can make a shape of a mask grey.

    Such effects are opacity, a filter, or a mask inside the mask.
    """
    own = style.own
    if own["opacity"] != "1" or own["mask"] != "none" or own["filter"] != "none":
        raise ClipPathError(_MASK_UNREAD, code="clipping-unread")


def _is_white(style: Style, is_alpha: bool) -> bool:
    """Whether a shape of a mask is white, so that the element is visible there.

    is_alpha: whether the alpha of the mask counts in place of its luminance, so that every opaque colour is as white.
    Raises ClipPathError for a shape that is neither white nor black.
    """
    _refuse_effects(style)
    fill, is_opaque = style.inherited["fill"] or "#000000", style.inherited["fill-opacity"] == "1"
    if fill == "currentcolor":
        fill = style.inherited["color"]
    if is_alpha and fill.startswith("#") and len(fill) == len("#rrggbb"):
        fill = "#ffffff"
    if not is_opaque or fill not in ("#ffffff", "#000000") or style.inherited["stroke"] != "none":
        raise ClipPathError(_MASK_UNREAD, code="clipping-unread")
    return fill == "#ffffff"
