"""Remove elements that are drawn more than once in the same place.

Exports and pasted copies leave such elements.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import list_first
from .design import Design, Element, Notice, SubPath

SAME_PLACE_MM = 1e-3  # places that differ by less are the same; no robot places a brush this precisely


def remove_duplicates(design: Design) -> Design:
    """Return the drawing with each element once.

    A notice names the removed elements. A line drawn backwards is the same line, and a ring that begins at another
    of its points is the same ring. An element with another colour, width, layer or setting is kept.
    """
    id_by_key: dict[tuple, str] = {}
    kept, duplicates = [], []
    for element in design.elements:
        key = _element_key(element)
        if key in id_by_key:
            first = id_by_key[key]
            duplicates.append(f"{element.id} (drawn again)" if first == element.id else f"{element.id} (like {first})")
            continue
        id_by_key[key] = element.id
        kept.append(element)
    if not duplicates:
        return design
    count = "1 element is" if len(duplicates) == 1 else f"{len(duplicates)} elements are"
    sentence = f"{count} exactly on another and would be painted twice: left out, {list_first(duplicates, 3)}"
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
    if path.widths is None:
        return min((_rounded_bytes(_begin_ring_at_least_point(cubics)), b"") for cubics in directions)
    widths = [path.widths, path.widths[::-1] * (-1, 1) + (1, 0)]
    return min(
        (_rounded_bytes(cubics), _rounded_bytes(width)) for cubics, width in zip(directions, widths, strict=True)
    )


def _begin_ring_at_least_point(cubics: np.ndarray) -> np.ndarray:
    """Return the cubics of a ring from the point with the least x and y on; other lines are returned as they are."""
    points = np.round(cubics[:, 0] / SAME_PLACE_MM)
    if not np.array_equal(np.round(cubics[-1, 3] / SAME_PLACE_MM), points[0]):
        return cubics
    return np.roll(cubics, -int(np.lexsort(points.T[::-1])[0]), axis=0)


def _rounded_bytes(values: np.ndarray) -> bytes:
    return (np.round(values / SAME_PLACE_MM) + 0.0).astype(np.int64).tobytes()
