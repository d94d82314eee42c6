"""Find elements beyond the page: scratch work next to it, or further pages of the file."""

from __future__ import annotations

from collections.abc import Sequence

from .design import Design, Element, Notice
from .layout import bounds_mm

_NAMED = 5  # elements in a sentence


def on_page(
    elements: Sequence[Element], sheet_mm: tuple[float, float]
) -> tuple[tuple[Element, ...], list[Notice]]:
    """The elements of which any part is on the page, with a notice for the others. A drawing of which nothing is on the
    page is kept: it can still be moved there with --fit or --origin."""
    is_on = [_touches(element, sheet_mm) for element in elements]
    if all(is_on) or not any(is_on):
        return tuple(elements), []
    on = [element for element, inside in zip(elements, is_on, strict=True) if inside]
    off = [element.id for element, inside in zip(elements, is_on, strict=True) if not inside]
    names = ", ".join(off[:_NAMED]) + (f" and {len(off) - _NAMED} more" if len(off) > _NAMED else "")
    count = "1 element is" if len(off) == 1 else f"{len(off)} elements are"
    sentence = f"{count} off the page and left out: {names}"
    advice = "move them onto the page to paint them, or make the page larger"
    return tuple(on), [Notice("svg", sentence, code="off-page", advice=advice)]


def _touches(element: Element, sheet_mm: tuple[float, float]) -> bool:
    x0, y0, x1, y1 = bounds_mm(Design(sheet_mm, (element,)))
    return not (x1 < 0 or y1 < 0 or x0 > sheet_mm[0] or y0 > sheet_mm[1])
