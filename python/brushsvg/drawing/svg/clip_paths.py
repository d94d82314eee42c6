"""Clip paths of SVG: the region, on paper, that a clip-path leaves of an element (CSS Masking 1, chapter 7)."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from ...errors import Error
from . import shapes
from .context import Context, local
from .css_cascade import Style, cascade
from .paint_servers import URL
from .path_to_cubics import trace
from .references import href, referred
from .style_sheets import Rules
from .transform import Matrix, multiply, parse_transform, scales

if TYPE_CHECKING:
    import shapely

_CSS_TRANSFORMS = frozenset(("transform", "translate", "rotate", "scale"))
_DEEPEST = 20  # clip paths and uses in each other


class ClipPathError(Error):
    """A clip path that cannot be read: the element is painted whole."""


def _refuse_css_transform(style: Style) -> None:
    """Attributes are read; a transform that CSS says would be passed over, and the clip path be elsewhere."""
    if not _CSS_TRANSFORMS.isdisjoint(style.geometry):
        sentence = "its clip path has a transform in CSS, which is not read: painted whole"
        raise ClipPathError(sentence, code="clipping-unread")


class ClipPaths:
    """The clip paths of a drawing. by_id: its elements; rules: its style sheets."""

    def __init__(self, by_id: dict[str, ET.Element], rules: Rules):
        self._by_id = by_id
        self._rules = rules

    def region(
        self, value: str, context: Context, bounds: Callable[[], tuple[float, float, float, float] | None]
    ) -> shapely.Geometry | None:
        """The region of a clip-path property in the context's user units, on paper; None where it refers to nothing,
        which clips nothing. bounds: (x, y, width, height) of the element. ClipPathError for what is not read."""
        found = URL.match(value)
        if not found:
            raise ClipPathError("clip-path: only url(#...) is read: painted whole", code="clipping-unread")
        target = referred(found[1].strip().strip("\"'"), self._by_id)
        if target is None or local(target) != "clipPath":
            return None
        return self._region(target, context, bounds, 0)

    def _region(self, node: ET.Element, context: Context, bounds, depth: int) -> shapely.Geometry:
        import shapely

        if depth > _DEEPEST:
            raise ClipPathError("its clip paths refer to each other: painted whole", code="clipping-unread")
        matrix = context.matrix
        if node.get("transform"):
            matrix = multiply(matrix, parse_transform(node.get("transform", "")))
        if node.get("clipPathUnits") == "objectBoundingBox":
            box = bounds()
            if box is None:
                sentence = "its clip path counts in the size of a group, which is not read: painted whole"
                raise ClipPathError(sentence, code="clipping-unread")
            matrix = multiply(matrix, (box[2], 0.0, 0.0, box[3], box[0], box[1]))
        style, _ = cascade(context.style, node.attrib, self._rules.of(node), context.diagonal)
        _refuse_css_transform(style)
        parts = [*self._shapes(node, context._replace(matrix=matrix), context.style, depth)]
        region = shapely.union_all(parts)
        return self._own(style, context, region, depth)

    def _own(self, style: Style, context: Context, region, depth: int) -> shapely.Geometry:
        """The region as far as the clip path of its own leaves it."""
        if (value := style.own["clip-path"]) == "none" or not (found := URL.match(value)):
            return region
        target = referred(found[1].strip().strip("\"'"), self._by_id)
        if target is None:
            return region
        return region.intersection(self._region(target, context, lambda: None, depth + 1))

    def _shapes(
        self, node: ET.Element, context: Context, parent: Style, depth: int
    ) -> Iterator[shapely.Geometry]:
        from ..clipping import outlines_of, region_of

        for child in node:
            tag = local(child)
            style, _ = cascade(parent, child.attrib, self._rules.of(child), context.diagonal)
            if style.own["display"] == "none" or style.inherited["visibility"] != "visible":
                continue
            _refuse_css_transform(style)
            matrix: Matrix = context.matrix
            if child.get("transform"):
                matrix = multiply(matrix, parse_transform(child.get("transform", "")))
            here = context._replace(matrix=matrix)
            if tag == "use":
                yield from self._used(child, here, style, depth)
            elif tag == "text":
                raise ClipPathError(
                    "its clip path is text, which is not read: painted whole", code="clipping-unread"
                )
            elif tag in shapes.TAGS:
                attributes = {**child.attrib, **style.geometry}
                try:
                    commands = shapes.commands_of(tag, attributes, here.viewport, here.em_px)
                except shapes.DamageError as damage:
                    commands = damage.commands
                line = trace(commands, matrix, scales(matrix)[0])
                region = region_of(outlines_of(line.subpaths), style.inherited["clip-rule"])
                yield self._own(style, here, region, depth)

    def _used(
        self, use: ET.Element, context: Context, style: Style, depth: int
    ) -> Iterator[shapely.Geometry]:
        target = referred(href(use), self._by_id)
        if target is None:
            return
        if depth > _DEEPEST:
            raise ClipPathError("its clip paths refer to each other: painted whole", code="clipping-unread")
        x, y = (
            context.length(use.get(name, "").strip() or "0", context.viewport[k])
            for k, name in enumerate("xy")
        )
        moved = context._replace(matrix=multiply(context.matrix, (1.0, 0.0, 0.0, 1.0, x, y)))
        alone = ET.Element("clipPath")
        alone.append(target)
        yield from self._shapes(alone, moved, style, depth + 1)
