"""Remove elements that are drawn more than once in the same place.

Exports and pasted copies leave such elements.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .design import Design, Element, Notice, SubPath

SAME_PLACE_MM = 1e-3  # places that differ by less are the same; no robot places a brush this precisely


def remove_duplicates(design: Design) -> Design:
    """Return the drawing with each element once.

    A notice names the removed elements. A line drawn backwards is the same line. An element with another colour,
    width, layer or setting is kept.
    """
    id_by_key: dict[tuple, str] = {}
    kept, duplicates = [], []
    for element in design.elements:
        key = _element_key(element)
        if key in id_by_key:
            duplicates.append(f"{element.id} (like {id_by_key[key]})")
            continue
        id_by_key[key] = element.id
        kept.append(element)
    if not duplicates:
        return design
    count = "1 element is" if len(duplicates) == 1 else f"{len(duplicates)} elements are"
    named = ", ".join(duplicates[:3]) + (f" and {len(duplicates) - 3} more" if len(duplicates) > 3 else "")
    sentence = f"{count} exactly on another and would be painted twice: left out, {named}"
    notice = Notice("drawing", sentence, code="drawn-twice")
    return replace(design, elements=tuple(kept), notices=(*design.notices, notice))


def _element_key(element: Element) -> tuple:
    return (
        frozenset(map(_path_key, element.subpaths)),
        len(element.subpaths),
        round(element.stroke_width_mm / SAME_PLACE_MM),
        element.colour,
        element.layer,
        element.fill_rule,
        element.fill_colour,
        repr(sorted(element.settings.items())),
    )


def _path_key(path: SubPath) -> tuple[bytes, bytes]:
    directions = [path.cubics, path.cubics[::-1, ::-1]]
    widths = [np.empty(0)] * 2 if path.widths is None else [path.widths, path.widths[::-1] * (-1, 1) + (1, 0)]
    keys = [(_rounded_bytes(cubics), _rounded_bytes(width)) for cubics, width in zip(directions, widths, strict=True)]
    return min(keys)


def _rounded_bytes(values: np.ndarray) -> bytes:
    return (np.round(values / SAME_PLACE_MM) + 0.0).astype(np.int64).tobytes()
