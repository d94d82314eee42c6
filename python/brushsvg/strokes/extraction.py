"""Design to strokes: lines as they are drawn, filled shapes as a brush would paint them."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..errors import Error, need, need_one_of
from ..read import SCRIPTS
from ..read.design import Design, Element, Notice, SubPath
from .corners import begun_amid_a_side

if TYPE_CHECKING:
    from .._core import Stroke

WAYS = ("stroke", "outline")
# Share of its area that a fill must show next to the stroke along it, to make a shape of a line.
_SHOWS = 0.01


@dataclass(frozen=True)
class _Line:
    """One stroke to be: cubics (n, 4, 2), half widths [(fraction, mm)], rings of the outline it came from, if any."""

    cubics: object
    half_width: list[tuple[float, float]]
    closed: bool
    wanted_mm: list
    covered: tuple[bool, bool] = (False, False)


def strokes(
    design: Design, paths_as: str | None = None, script: str = "auto"
) -> tuple[list[Stroke], list[Notice]]:
    """Strokes in document order, [mm], paper frame, and what was noticed on the way.

    A path with a stroke alone is the line drawn, in its direction. A filled path is a shape, with a stroke around it
    a shape grown by half of that: its strokes are found, in the direction and order of writing, and carry their part of
    the shape. Where the stroke has a colour of its own, the shape is painted as far as it is filled, and then the line.
    paths_as: "stroke", fills count as none; "outline", strokes count as none and every path is the outline
    of a shape; None: as drawn.
    script: "auto", "latin", "arabic", "devanagari" or "cjk": how filled shapes are written, where an element does not
    say so itself.

    A stroke is called by its element's id, id/1, id/2 ... if there are several, strokeN if there is no id, N counting
    the elements without one from 1. The setting `order` moves strokes, smaller ones first; `passes` repeats a stroke as
    id#2, id#3 ...

    Error if nothing is left to paint.
    """
    need(design, Design, "a drawing, as read_drawing returns it")
    need_one_of(paths_as, ("stroke", "outline", None), "what paths are painted as")
    need_one_of(script, SCRIPTS, "script")
    found, empty, notices = [], [], []
    for element in (part for each in design.elements for part in _in_colours(each, paths_as)):
        try:
            lines = _lines(element, paths_as, script)
        except Error as beyond:
            notices.append(Notice(element.id or "filled", f"{beyond}: left out", code=beyond.code))
            continue
        if lines:
            found.append((element, lines))
        else:
            empty.append(element)
    notices += _left_out(empty, paths_as)
    if not found:
        where, sentence = (notices[-1].where, notices[-1].text) if notices else ("", "it is empty")
        sentence = f"there is nothing to paint: {sentence}"
        if notice := next(iter(design.notices), None):
            sentence += f"; for example {notice.where}: {notice.sentence}"
        raise Error(sentence, where=where, code="nothing-to-paint")
    names, renamed = _names([(element, len(lines)) for element, lines in found])
    made = [
        (element.settings.get("order", 0), stroke)
        for (element, lines), own in zip(found, names, strict=True)
        for stroke in _of_element(element, own, lines)
    ]
    return [stroke for _, stroke in sorted(made, key=lambda pair: pair[0])], [*renamed, *notices]


def _left_out(elements: list[Element], paths_as: str | None) -> list[Notice]:
    if not elements:
        return []
    first = next((element.id for element in elements if element.id), "filled")
    what = "has no stroke" if paths_as == "stroke" else "holds no area"
    others = (
        f", nor do {len(elements) - 1} others"
        if len(elements) > 2
        else ", nor does another" * (len(elements) - 1)
    )
    for_lines = "lines need a stroke instead of a fill; brushsvg text sets single-line fonts as lines"
    advice = "--as stroke counts fills as none" if paths_as == "stroke" else for_lines
    return [Notice(first, f"its outline {what}{others}: left out", code="outline-empty", advice=advice)]


def _in_colours(element: Element, paths_as: str | None) -> tuple[Element, ...]:
    """Return the painted parts of an element, each with its colour."""
    if not element.fill_colour or paths_as == "stroke":
        return (element,)
    if paths_as == "outline":
        return (replace(element, colour=element.fill_colour),)
    shape, line = element.by_colour()
    return (replace(line, id=element.id),) if _grown(element) is None else (shape, line)


def _lines(element: Element, paths_as: str | None, script: str) -> list[_Line]:
    """What becomes of an element; nothing if it leaves no mark."""
    if paths_as == "stroke" and not element.is_stroked:
        return []
    if paths_as == "stroke" or (paths_as is None and not element.fill_rule):
        return [_drawn(element, subpath) for subpath in element.subpaths]
    lines = _of_shape(element, paths_as is None, element.settings.get("script", script))
    return [_drawn(element, subpath) for subpath in element.subpaths] if lines is None else lines


def _of_shape(element: Element, grown: bool, script: str) -> list[_Line] | None:
    """Lines of a filled shape; None where its stroke alone shows."""
    from .skeleton import filled, outline_strokes

    rings = _grown(element) if grown and element.is_stroked else filled(element)
    if rings is None:
        return None
    return [
        _Line(each.middle_mm, each.half_width, each.closed, each.wanted_mm, each.covered)
        for each in outline_strokes(rings, script)
    ]


def _grown(element: Element) -> list | None:
    """Rings of a filled shape with the stroke around it; None where the stroke alone shows."""
    from .. import _core
    from .skeleton import filled

    drawn = [_drawn(element, subpath) for subpath in element.subpaths]
    marks = [
        _core.wanted_outline(
            _core.Stroke(middle_mm=line.cubics.reshape(-1, 8), half_width=line.half_width), 0.02
        )
        for line in drawn
    ]
    own = _core.unite([ring for mark in marks for ring in mark])
    both = _core.unite([*own, *filled(element)])
    shows = _core.area(both) - _core.area(own) > _SHOWS * _core.area(own)
    return both if shows else None


def _drawn(element: Element, subpath: SubPath) -> _Line:
    if subpath.widths is None:
        half_width = [(0.0, element.stroke_width_mm / 2)]
    else:
        half_width = [(at, width / 2) for at, width in subpath.widths.tolist()]
    cubics = subpath.cubics
    if subpath.closed:
        cubics, half_width = begun_amid_a_side(cubics, half_width)
    return _Line(cubics, half_width, subpath.closed, [])


def _of_element(element: Element, name: str, lines: list[_Line]):
    from .._core import Settings, Stroke, StrokeId

    settings = Settings(**{name: value for name, value in element.settings.items() if name != "script"})
    for part, line in zip(_parts(len(lines)), lines, strict=True):
        for repeat in range(1, element.settings.get("passes", 1) + 1):
            stroke = Stroke(
                id=StrokeId(name, part, repeat),
                middle_mm=line.cubics.reshape(-1, 8),
                closed=line.closed,
                half_width=line.half_width,
                layer=element.layer,
                colour=element.colour,
                settings=settings,
            )
            stroke.wanted_mm = line.wanted_mm
            stroke.start_covered, stroke.end_covered = line.covered
            yield stroke


def _names(elements: list[tuple[Element, int]]) -> tuple[list[str], list[Notice]]:
    """What each element is called, given with the number of its strokes: no two strokes have one name, nor would if
    they were painted in lanes or loads, and the first to claim one keeps it."""
    nominal, anonymous = [], 0
    for element, _ in elements:
        anonymous += not element.id
        nominal.append(element.id or f"stroke{anonymous}")
    reserved = set(nominal)
    whole = {
        each
        for (element, count), base in zip(elements, nominal, strict=True)
        for each in _all_names(element, base, count)
    }
    taken: set[str] = set()
    taken_of: set[str] = set()  # the names whose lanes' names are taken
    last_suffix: dict[str, int] = {}
    result: list[str] = []
    notices: list[Notice] = []
    for (element, count), base in zip(elements, nominal, strict=True):
        name, names = base, _all_names(element, base, count)
        suffix = last_suffix.get(base, 1)
        part_of = next((of for each in names if (of := _of_which(each)) and of in whole), "")
        while (
            not taken.isdisjoint((name, *names))
            or not taken_of.isdisjoint(names)
            or (name == base and part_of)
            or (name != base and name in reserved)
        ):
            suffix += 1
            name = f"{base}-{suffix}"
            names = _all_names(element, name, count)
        if name != base:
            last_suffix[base] = suffix
            why = f"that of a part of {part_of!r}" if part_of else "taken"
            notices.append(
                Notice(base, f"the name {base!r} is {why}: this one is called {name!r}", code="name-taken")
            )
        taken.update((name, *names))
        taken_of.update(filter(None, map(_of_which, names)))
        whole.update(names)
        result.append(name)
    return result, notices


def _of_which(name: str) -> str:
    """The stroke whose lane has this name; none for one that cannot be such."""
    found = re.fullmatch(r"(.+?)~[0-9]+(\+[0-9]+)?", name, re.DOTALL)
    return found[1] if found else ""


def _all_names(element: Element, name: str, count: int) -> list[str]:
    from .._core import StrokeId

    repeats = range(1, element.settings.get("passes", 1) + 1)
    return [StrokeId(name, part, repeat).name for part in _parts(count) for repeat in repeats]


def _parts(count: int) -> range:
    """Numbers of an element's strokes: 0 for the only one."""
    return range(1) if count == 1 else range(1, count + 1)
