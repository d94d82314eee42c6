"""Leave out outlines that are finer than the brush can paint.

This concerns outlines in another colour than their fill. The filled shape is painted without them.
"""

from __future__ import annotations

from dataclasses import replace

from ...read.design import Design, Element, Notice
from ...strokes.uncovered_areas import finest_half_width_mm


def remove_thin_outlines(design: Design, brush) -> tuple[Design, list[Notice]]:
    """Remove outlines that are finer than the finest line of the brush.

    Only outlines in another colour than their fill are removed, each with a notice. If they were painted, they
    would be wider and would hide the shape that they go around.
    """
    least_mm = 2 * finest_half_width_mm(brush)
    elements, notices = [], []
    for element in design.elements:
        if element.fill_colour and 0 < element.stroke_width_mm < least_mm:
            notices.append(_report_left_out(element, least_mm))
            element = element.by_colour()[0]
        elements.append(element)
    return (replace(design, elements=tuple(elements)), notices) if notices else (design, [])


def _report_left_out(element: Element, least_mm: float) -> Notice:
    sentence = (
        f"its outline in {element.colour} is {element.stroke_width_mm:.2g} mm wide, finer than the brush's finest line "
        f"of {least_mm:.2g} mm: the outline is left out, and the shape is painted in {element.fill_colour}"
    )
    return Notice(element.id, sentence, layer=element.layer, code="outline-too-fine")
