"""Leave out elements off the page: scratch work, or further pages of the file."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import list_first
from .design import Element, Notice
from .layout import bounds_mm

_MAX_NAMED_ELEMENTS = 5  # elements that a sentence names


def keep_on_page(
    elements: Sequence[Element], page_mm: tuple[float, float], top_mm: float
) -> tuple[tuple[Element, ...], list[Notice]]:
    """Return the elements that touch the page, and a notice about the others.

    If no element touches the page, all are kept: --fit or --origin can still move them onto it.

    page_mm: (width, height) of the drawing's own page; top_mm: y of its upper left corner, which is the sheet's.
    """
    is_on = [_touches_page(element, page_mm, top_mm) for element in elements]
    if all(is_on) or not any(is_on):
        return tuple(elements), []
    kept = [element for element, inside in zip(elements, is_on, strict=True) if inside]
    removed = [element.id for element, inside in zip(elements, is_on, strict=True) if not inside]
    count = "1 element is" if len(removed) == 1 else f"{len(removed)} elements are"
    sentence = f"{count} off the page and left out: {list_first(removed, _MAX_NAMED_ELEMENTS)}"
    advice = "move them onto the page to paint them, or make the page larger"
    return tuple(kept), [Notice("svg", sentence, code="off-page", advice=advice)]


def _touches_page(element: Element, page_mm: tuple[float, float], top_mm: float) -> bool:
    x0, y0, x1, y1 = bounds_mm([element])
    return not (x1 < 0 or y1 < top_mm - page_mm[1] or x0 > page_mm[0] or y0 > top_mm)
