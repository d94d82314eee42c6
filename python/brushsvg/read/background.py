"""White shapes that cover the page before anything else is drawn: paper, not paint."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..geometry.cubics import extremes, flattened
from ..geometry.rings import signed_area
from .design import Design, Element, Notice

LIGHT = 0xF0  # least value of each channel; tracers write #fdfdfd for white
COVERED = 0.99  # share of the page, and of its own bounding box, that a background fills at least


def without_background(design: Design, page_mm: tuple[float, float]) -> Design:
    """The drawing without the white shapes that come first and cover the page, and with one notice for them. A line
    around one, in a colour of its own, stays. A drawing of nothing else is kept. page_mm: (w, h) of the drawing's own
    page, at the upper left of the sheet."""
    count = 0
    while count < len(design.elements) and _is_background(
        design.elements[count], design.sheet_mm[1], page_mm
    ):
        count += 1
    if not 0 < count < len(design.elements):
        return design
    left = design.elements[:count]
    frames = tuple(each.by_colour()[1] for each in left if each.fill_colour and not is_light(each.colour))
    left_out = [element.id for element in left]
    sentence = f"white background is left out: {', '.join(left_out)}"
    notice = Notice("svg", sentence, code="background", advice="--background keep paints it")
    others = [each for each in design.notices if each.where.partition(" (")[0] not in left_out]
    return replace(design, elements=frames + design.elements[count:], notices=(*others, notice))


def _is_background(element: Element, top_mm: float, page_mm: tuple[float, float]) -> bool:
    if not element.fill_rule or not is_light(element.fill_colour or element.colour):
        return False
    points = extremes(np.concatenate([subpath.cubics for subpath in element.subpaths]))
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    (width, height), (w, h) = (x1 - x0, y1 - y0), page_mm
    shown = max(min(x1, w) - max(x0, 0.0), 0.0) * max(min(y1, top_mm) - max(y0, top_mm - h), 0.0)
    area = abs(sum(signed_area(flattened(subpath.cubics, 0.05)) for subpath in element.subpaths))
    return bool(shown >= COVERED * w * h and area >= COVERED * width * height)


def is_light(colour: str) -> bool:
    return min(int(colour[k : k + 2], 16) for k in (1, 3, 5)) >= LIGHT
