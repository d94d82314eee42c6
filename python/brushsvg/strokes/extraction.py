"""Strokes of a design.

Lines are painted as they are drawn, filled shapes as a brush would paint them.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Error, need_one_of, require_type
from ..planning.painting_order import sort_by_order
from ..read import SCRIPTS
from ..read.design import Design, Element, Notice, SubPath
from .corners import begin_amid_side

if TYPE_CHECKING:
    from .._core import Stroke

# Least share of the area of a line's stroke that its fill must add. With less, the path is a line; with more, a
# shape.
_MIN_FILL_SHARE = 0.01
# Largest difference of equal shapes. Drawings and programs round coordinates to 1e-3 mm.
_EQUAL_MM = 2e-3


@dataclass(frozen=True)
class _Line:
    """A stroke to be.

    cubics: (n, 4, 2); half_width: [(fraction, mm)]; target_mm: rings of the outline that the line came from, if
    any; covered: whether its start and its end are covered by others.
    """

    cubics: object
    half_width: list[tuple[float, float]]
    closed: bool
    target_mm: list
    covered: tuple[bool, bool] = (False, False)

    def moved(self, by_mm: np.ndarray) -> _Line:
        cubics = self.cubics + np.tile(by_mm, 4)
        return replace(self, cubics=cubics, target_mm=[ring + by_mm for ring in self.target_mm])


def strokes(design: Design, paths_as: str | None = None, script: str = "auto") -> tuple[list[Stroke], list[Notice]]:
    """Return the strokes of a design in document order, and notices about it.

    Strokes are in mm, in the paper frame. A path with a stroke alone is the drawn line, in its direction. A filled
    path is a shape; with a stroke around it, a shape that is larger by half of the stroke. Its strokes are found in
    the direction and order of writing, and each has its part of the shape. Where the stroke has a colour of its
    own, the shape is painted as far as it is filled, and then the line.

    paths_as: "stroke" ignores fills; "outline" ignores strokes, and every path is the outline of a shape; lines
    without a fill that meet end to end are one outline, and an outline inside another is its hole; None takes paths
    as they are drawn. script: "auto", "latin", "arabic", "devanagari" or "cjk", how filled shapes are
    written unless an element says so itself. "arabic" also orders the filled shapes of a line of text from the right.

    A stroke has the id of its element, or id/1, id/2 ... if there are several. Without an id it is strokeN, where N
    counts the elements without one from 1. The setting `order` moves strokes, smaller ones first; `passes` repeats
    a stroke as id#2, id#3 ...

    Raises Error if nothing is left to paint.
    """
    require_type(design, Design, "a drawing, as read_drawing returns it")
    need_one_of(paths_as, ("stroke", "outline", None), "what paths are painted as")
    need_one_of(script, SCRIPTS, "script")
    painted_elements, empty, notices, known_shapes = [], [], [], _KnownShapes()
    elements = design.elements
    if paths_as == "outline":
        from .shape_outlines import assemble_outlines

        elements = assemble_outlines(elements)
    for element in (part for each in elements for part in _split_by_colour(each, paths_as)):
        try:
            lines = _find_lines(element, paths_as, script, known_shapes)
        except Error as beyond:
            notices.append(Notice(element.id or "filled", f"{beyond}: left out", code=beyond.code))
            continue
        if lines:
            painted_elements.append((element, lines))
            if paths_as is None and element.is_under_fill:
                sentence = "paint-order is not read: it is painted on top of the fill"
                notices.append(
                    Notice(element.id, sentence, layer=element.layer, code="css-unread", about="paint-order")
                )
        else:
            empty.append(element)
    notices += _report_left_out(empty, paths_as)
    if not painted_elements:
        where, sentence = (notices[-1].where, notices[-1].text) if notices else ("", "it is empty")
        sentence = f"there is nothing to paint: {sentence}"
        if notice := next((notice for notice in design.notices if notice.where), None):
            sentence += f"; for example {notice.where}: {notice.sentence}"
        raise Error(sentence, where=where, code="nothing-to-paint")
    names, renamed = _name_elements([(element, len(lines)) for element, lines in painted_elements])
    named_elements = [(*each, own) for each, own in zip(painted_elements, names, strict=True)]
    if script == "arabic":
        named_elements = _order_letters_from_right(named_elements)
    drawn = [stroke for element, lines, own in named_elements for stroke in _make_strokes(element, own, lines)]
    return sort_by_order(drawn), [*renamed, *notices]


def _order_letters_from_right(
    named_elements: list[tuple[Element, list[_Line], str]],
) -> list[tuple[Element, list[_Line], str]]:
    """Return elements with the filled letters from right to left, bodies before dots.

    Other programs write each glyph as a path of its own, from the left. Elements that say their script, as those of
    `brushsvg text` do, are in the order of writing already. Letters keep their place among lines and layers.
    """
    from .skeleton.reading_order import group_areas

    def run_of(named_element) -> tuple:
        element, lines, _ = named_element
        is_letter = "script" not in element.settings and all(line.target_mm for line in lines)
        return is_letter, element.layer, element.colour, element.settings.get("order", 0)

    ordered = []
    for (is_letter, *_), group in groupby(named_elements, run_of):
        run = list(group)
        if is_letter:
            rings = [np.vstack([ring for line in lines for ring in line.target_mm]) for _, lines, _ in run]
            boxes = np.array([[*each.min(axis=0), *each.max(axis=0)] for each in rings])
            run = [run[k] for areas in group_areas(boxes, "arabic") for k in areas]
        ordered += run
    return ordered


def _report_left_out(elements: list[Element], paths_as: str | None) -> list[Notice]:
    if not elements:
        return []
    first = next((element.id for element in elements if element.id), "filled")
    reason = "has no stroke" if paths_as == "stroke" else "holds no area"
    others = f", nor do {len(elements) - 1} others" if len(elements) > 2 else ", nor does another" * (len(elements) - 1)
    for_lines = "lines need a stroke instead of a fill; brushsvg text sets single-line fonts as lines"
    advice = "--as stroke counts fills as none" if paths_as == "stroke" else for_lines
    return [Notice(first, f"its outline {reason}{others}: left out", code="outline-empty", advice=advice)]


def _split_by_colour(element: Element, paths_as: str | None) -> tuple[Element, ...]:
    """Return the painted parts of an element, each with its colour."""
    if not element.fill_colour or paths_as == "stroke":
        return (element,)
    if paths_as == "outline":
        return (replace(element, colour=element.fill_colour),)
    shape, line = element.by_colour()
    is_line = _grow_by_stroke(element) is None
    return (replace(line, id=element.id, is_under_fill=False),) if is_line else (shape, line)


class _KnownShapes:
    """Filled shapes whose lines are known. A text repeats its letters, and each one is found once."""

    def __init__(self):
        self._lines_of: dict[tuple, list[tuple[list[np.ndarray], list[_Line]]]] = defaultdict(list)

    def find_lines(self, rings: list[np.ndarray], script: str) -> list[_Line]:
        """Return the lines of a shape, moved from an equal shape if there is one."""
        from .skeleton import outline_strokes

        if not rings:
            return []
        size_mm = np.ptp(rings[0], axis=0).round(1)  # few shapes of one size are compared with each other
        known = self._lines_of[script, *size_mm, *map(len, rings)]
        for original, lines in known:
            by_mm = (rings[0] - original[0]).mean(axis=0)
            if all(np.abs(ring - each - by_mm).max() < _EQUAL_MM for ring, each in zip(rings, original, strict=True)):
                return [line.moved(by_mm) for line in lines]
        lines = [
            _Line(each.middle_mm, each.half_width, each.closed, each.target_mm, each.covered)
            for each in outline_strokes(rings, script)
        ]
        known.append((rings, lines))
        return lines


def _find_lines(element: Element, paths_as: str | None, script: str, known_shapes: _KnownShapes) -> list[_Line]:
    """Return the lines of an element; none if it leaves no mark."""
    from .skeleton import filled_rings

    if paths_as == "stroke" and not element.is_stroked:
        return []
    if paths_as == "stroke" or (paths_as is None and not element.fill_rule):
        return [_make_line(element, subpath) for subpath in element.subpaths]
    rings = _grow_by_stroke(element) if paths_as is None and element.is_stroked else filled_rings(element)
    if rings is None:  # only its stroke shows
        return [_make_line(element, subpath) for subpath in element.subpaths]
    return known_shapes.find_lines(rings, element.settings.get("script", script))


def _grow_by_stroke(element: Element) -> list | None:
    """Return the rings of a filled shape with the stroke around it.

    Returns None where only the stroke shows.
    """
    from .. import _core
    from .skeleton import filled_rings

    drawn = [_make_line(element, subpath) for subpath in element.subpaths]
    marks = [
        _core.target_outline(_core.Stroke(middle_mm=line.cubics.reshape(-1, 8), half_width=line.half_width), 0.02)
        for line in drawn
    ]
    stroke_rings = _core.unite([ring for mark in marks for ring in mark])
    both = _core.unite([*stroke_rings, *filled_rings(element)])
    shows = _core.area(both) - _core.area(stroke_rings) > _MIN_FILL_SHARE * _core.area(stroke_rings)
    return both if shows else None


def _make_line(element: Element, subpath: SubPath) -> _Line:
    if subpath.widths is None:
        half_width = [(0.0, element.stroke_width_mm / 2)]
    else:
        half_width = [(at, width / 2) for at, width in subpath.widths.tolist()]
    cubics = subpath.cubics
    if subpath.closed:
        cubics, half_width = begin_amid_side(cubics, half_width)
    return _Line(cubics, half_width, subpath.closed, [])


def _make_strokes(element: Element, name: str, lines: list[_Line]):
    from .._core import Settings, Stroke, StrokeId

    settings = Settings(**{name: value for name, value in element.settings.items() if name != "script"})
    for part, line in zip(_number_parts(len(lines)), lines, strict=True):
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
            stroke.target_mm = line.target_mm
            stroke.start_covered, stroke.end_covered = line.covered
            yield stroke


def _name_elements(elements: list[tuple[Element, int]]) -> tuple[list[str], list[Notice]]:
    """Return the name of each element, and notices about changed names.

    elements: each with the number of its strokes. No two strokes have the same name, even if they are painted in
    lanes or loads. The first element to claim a name keeps it.
    """
    nominal, anonymous = [], 0
    for element, _ in elements:
        anonymous += not element.id
        nominal.append(element.id or f"stroke{anonymous}")
    reserved = set(nominal)
    whole = {
        each
        for (element, count), base in zip(elements, nominal, strict=True)
        for each in _list_names(element, base, count)
    }
    taken: set[str] = set()
    taken_of: set[str] = set()  # names of strokes that have a lane with a taken name
    last_suffix: dict[str, int] = {}
    result: list[str] = []
    notices: list[Notice] = []
    for (element, count), base in zip(elements, nominal, strict=True):
        name, names = base, _list_names(element, base, count)
        suffix = last_suffix.get(base, 1)
        part_of = next((of for each in names if (of := _find_lane_owner(each)) and of in whole), "")
        while (
            not taken.isdisjoint((name, *names))
            or not taken_of.isdisjoint(names)
            or (name == base and part_of)
            or (name != base and name in reserved)
        ):
            suffix += 1
            name = f"{base}-{suffix}"
            names = _list_names(element, name, count)
        if name != base:
            last_suffix[base] = suffix
            why = f"that of a part of {part_of!r}" if part_of else "taken"
            notices.append(Notice(base, f"the name {base!r} is {why}: this one is called {name!r}", code="name-taken"))
        taken.update((name, *names))
        taken_of.update(filter(None, map(_find_lane_owner, names)))
        whole.update(names)
        result.append(name)
    return result, notices


def _find_lane_owner(name: str) -> str:
    """Return the stroke to whose lane a name belongs, or "" if to none."""
    match = re.fullmatch(r"(.+?)~[0-9]+(\+[0-9]+)?", name, re.DOTALL)
    return match[1] if match else ""


def _list_names(element: Element, name: str, count: int) -> list[str]:
    from .._core import StrokeId

    repeats = range(1, element.settings.get("passes", 1) + 1)
    return [StrokeId(name, part, repeat).name for part in _number_parts(count) for repeat in repeats]


def _number_parts(count: int) -> range:
    """Return the numbers of an element's strokes: 0 for the only one."""
    return range(1) if count == 1 else range(1, count + 1)
