"""Design to strokes: one for each sub-path, with its width and a name of its own."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from .design import Design, Element, Notice, SubPath

if TYPE_CHECKING:
    from ._core import Stroke


def strokes(design: Design) -> tuple[list[Stroke], list[Notice]]:
    """Strokes in document order and direction, [mm], paper frame, and what was noticed about their names.

    A stroke is called by its element's id, id/1, id/2 ... if there are several sub-paths, strokeN if there is
    no id, N counting the elements without one from 1.
    """
    from ._core import Stroke

    result: list[Stroke] = []
    names, notices = _names(design.elements)
    for element, own in zip(design.elements, names, strict=True):
        settings = json.dumps(element.settings, sort_keys=True)
        for name, subpath in zip(own, element.subpaths, strict=True):
            result.append(
                Stroke(
                    id=name,
                    middle_mm=subpath.cubics.reshape(-1, 8),
                    closed=subpath.closed,
                    half_width=_half_width(element, subpath),
                    layer=element.layer,
                    colour=element.colour,
                    settings=settings,
                )
            )
    return result, notices


def _half_width(element: Element, subpath: SubPath) -> list[tuple[float, float]]:
    if subpath.widths is None:
        return [(0.0, element.stroke_width_mm / 2)]
    return [(at, width / 2) for at, width in subpath.widths.tolist()]


def _names(elements: tuple[Element, ...]) -> tuple[list[list[str]], list[Notice]]:
    """Names of each element's strokes, no two alike; the first to claim a name keeps it."""
    nominal, anonymous = [], 0
    for element in elements:
        anonymous += not element.id
        nominal.append(element.id or f"stroke{anonymous}")
    reserved = set(nominal)
    taken: set[str] = set()
    last_suffix: dict[str, int] = {}
    result: list[list[str]] = []
    notices: list[Notice] = []
    for element, base in zip(elements, nominal, strict=True):
        name, names = base, _with_numbers(base, len(element.subpaths))
        suffix = last_suffix.get(base, 1)
        while not taken.isdisjoint((name, *names)) or (name != base and name in reserved):
            suffix += 1
            name = f"{base}-{suffix}"
            names = _with_numbers(name, len(element.subpaths))
        if name != base:
            last_suffix[base] = suffix
            notices.append(Notice(base, f"the name {base!r} is taken: this one is called {name!r}"))
        taken.update((name, *names))
        result.append(names)
    return result, notices


def _with_numbers(name: str, count: int) -> list[str]:
    return [name] if count == 1 else [f"{name}/{k}" for k in range(1, count + 1)]
