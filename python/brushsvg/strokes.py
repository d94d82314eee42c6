"""Design to strokes: one for each sub-path, with its width and a name of its own."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

from .design import Design, Element, Notice, SubPath
from .errors import Error

if TYPE_CHECKING:
    from ._core import Stroke


def strokes(design: Design) -> tuple[list[Stroke], list[Notice]]:
    """Strokes in document order and direction, [mm], paper frame, and what was noticed about their names.

    A stroke is called by its element's id, id/1, id/2 ... if there are several sub-paths, strokeN if there is
    no id, N counting the elements without one from 1. The setting `order` moves strokes, smaller ones first;
    `passes` repeats a stroke as id#2, id#3 ...

    Error if nothing is left to paint.
    """
    lines = tuple(element for element in design.elements if element.is_stroked)
    names, notices = _names(lines)
    shapes = [element for element in design.elements if not element.is_stroked]
    if shapes:
        count = "a filled outline does" if len(shapes) == 1 else f"{len(shapes)} filled outlines do"
        first = next((element.id for element in shapes if element.id), "filled")
        notices.append(Notice(first, f"{count} not become strokes yet: left out"))
    if not lines:
        sentence = f"there is nothing to paint: {notices[-1].sentence}"
        if told := next(iter(design.notices), None):
            sentence += f"; for example {told.where}: {told.sentence}"
        raise Error(sentence, where=notices[-1].where)
    made = [
        (element.settings.get("order", 0), stroke)
        for element, own in zip(lines, names, strict=True)
        for stroke in _of_element(element, own)
    ]
    return [stroke for _, stroke in sorted(made, key=lambda pair: pair[0])], notices


def _of_element(element: Element, names: list[str]) -> Iterator[Stroke]:
    from ._core import Stroke

    settings = json.dumps(element.settings, sort_keys=True)
    for name, subpath in zip(names, element.subpaths, strict=True):
        for repeat in range(1, element.settings.get("passes", 1) + 1):
            yield Stroke(
                id=name if repeat == 1 else f"{name}#{repeat}",
                middle_mm=subpath.cubics.reshape(-1, 8),
                closed=subpath.closed,
                half_width=_half_width(element, subpath),
                layer=element.layer,
                colour=element.colour,
                settings=settings,
            )


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
        while not taken.isdisjoint((name, *_with_repeats(element, names))) or (
            name != base and name in reserved
        ):
            suffix += 1
            name = f"{base}-{suffix}"
            names = _with_numbers(name, len(element.subpaths))
        if name != base:
            last_suffix[base] = suffix
            notices.append(Notice(base, f"the name {base!r} is taken: this one is called {name!r}"))
        taken.update((name, *_with_repeats(element, names)))
        result.append(names)
    return result, notices


def _with_repeats(element: Element, names: list[str]) -> list[str]:
    passes = element.settings.get("passes", 1)
    return [*names, *(f"{name}#{k}" for name in names for k in range(2, passes + 1))]


def _with_numbers(name: str, count: int) -> list[str]:
    return [name] if count == 1 else [f"{name}/{k}" for k in range(1, count + 1)]
