"""Remove white backgrounds: shapes that come first and cover the page."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..geometry.cubics import extremes, flattened
from ..geometry.rings import signed_area
from .design import Design, Element, Notice

MIN_LIGHT_CHANNEL = 0xF0  # lowest value of each channel of a light colour; tracing programs write #fdfdfd for white
MIN_COVERED_SHARE = 0.99  # a background fills at least this share of the page and of its own bounding box


def remove_background(design: Design, page_mm: tuple[float, float]) -> Design:
    """Return the drawing without the white shapes that come first and cover the page.

    One notice names the shapes. A line around such a shape stays if it has another colour. A drawing that consists
    of backgrounds alone is returned unchanged.

    page_mm: (width, height) of the drawing's own page, at the upper left corner of the sheet.
    """
    count = 0
    while count < len(design.elements) and _is_background(design.elements[count], design.sheet_mm[1], page_mm):
        count += 1
    if not 0 < count < len(design.elements):
        return design
    backgrounds = design.elements[:count]
    frames = tuple(
        replace(shape.by_colour()[1], is_under_fill=False)
        for shape in backgrounds
        if shape.fill_colour and not is_light(shape.colour)
    )
    left_out = [shape.id for shape in backgrounds]
    sentence = f"white background is left out: {', '.join(left_out)}"
    notice = Notice("svg", sentence, code="background", advice="--background keep paints it")
    others = [other for other in design.notices if other.where.partition(" (")[0] not in left_out]
    return replace(design, elements=frames + design.elements[count:], notices=(*others, notice))


def _is_background(element: Element, top_mm: float, page_mm: tuple[float, float]) -> bool:
    if not element.fill_rule or not is_light(element.fill_colour or element.colour):
        return False
    points = extremes(np.concatenate([subpath.cubics for subpath in element.subpaths]))
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    (width, height), (w, h) = (x1 - x0, y1 - y0), page_mm
    shown = max(min(x1, w) - max(x0, 0.0), 0.0) * max(min(y1, top_mm) - max(y0, top_mm - h), 0.0)
    area = abs(sum(signed_area(flattened(subpath.cubics, 0.05)) for subpath in element.subpaths))
    return bool(shown >= MIN_COVERED_SHARE * w * h and area >= MIN_COVERED_SHARE * width * height)


def is_light(colour: str) -> bool:
    return min(int(colour[k : k + 2], 16) for k in (1, 3, 5)) >= MIN_LIGHT_CHANNEL
