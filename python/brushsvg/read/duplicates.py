"""Elements drawn more than once in the same place, as exports and pasted copies leave them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .design import Design, Element, Notice, SubPath

SAME_MM = 1e-3  # places that differ by less are the same; no robot places a brush as finely


def without_duplicates(design: Design) -> Design:
    """The drawing with each element once. A line drawn backwards is the same line; another colour, width, layer or
    setting makes another element. A notice names what was left out."""
    seen: dict[tuple, str] = {}
    kept, twins = [], []
    for element in design.elements:
        key = _key(element)
        if key in seen:
            twins.append(f"{element.id} (like {seen[key]})")
            continue
        seen[key] = element.id
        kept.append(element)
    if not twins:
        return design
    count = "1 element is" if len(twins) == 1 else f"{len(twins)} elements are"
    named = ", ".join(twins[:3]) + (f" and {len(twins) - 3} more" if len(twins) > 3 else "")
    sentence = f"{count} exactly on another and would be painted twice: left out, {named}"
    notice = Notice("drawing", sentence, code="drawn-twice")
    return replace(design, elements=tuple(kept), notices=(*design.notices, notice))


def _key(element: Element) -> tuple:
    return (
        frozenset(map(_path_key, element.subpaths)),
        len(element.subpaths),
        round(element.stroke_width_mm / SAME_MM),
        element.colour,
        element.layer,
        element.fill_rule,
        element.fill_colour,
        repr(sorted(element.settings.items())),
    )


def _path_key(path: SubPath) -> tuple[bytes, bytes]:
    ways = [path.cubics, path.cubics[::-1, ::-1]]
    widths = [np.empty(0)] * 2 if path.widths is None else [path.widths, path.widths[::-1] * (-1, 1) + (1, 0)]
    keys = [(_rounded(way), _rounded(width)) for way, width in zip(ways, widths, strict=True)]
    return min(keys)


def _rounded(values: np.ndarray) -> bytes:
    return (np.round(values / SAME_MM) + 0.0).astype(np.int64).tobytes()
