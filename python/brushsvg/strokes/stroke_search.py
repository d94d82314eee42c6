"""Search for other and further strokes of filled shapes, where their marks cost less."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from .. import _core
from .trial_mark import SEEN_MM
from .uncovered_areas import MISSED_SHARE, discs, is_mostly

_SWEPT_MM = 0.02


@dataclass(frozen=True)
class _Added:
    """A stroke into a bare area, and rings of the area; is_rim: that is part of a found stroke's own discs."""

    stroke: object
    own_mm: list[np.ndarray]
    area_mm: list[np.ndarray]
    is_rim: bool


@dataclass(frozen=True)
class Searched:
    """The result of a search: drawn, painted and target strokes, added ones behind the others of their element;
    done: what compensation says of the painted ones; added: ids of the strokes that the search added."""

    drawn: list
    painted: list
    targets: list
    done: _core.Compensated
    added: frozenset[str] = frozenset()


def searched(
    drawn: list,
    painted: list,
    targets: list,
    compensated: Callable[[list], _core.Compensated],
    brush,
    detail: str = "normal",
    are_corners_filled: bool = True,
    are_sides_painted: bool = True,
    done: _core.Compensated | None = None,
) -> Searched:
    """The strokes by which the marks of filled shapes cost least.

    drawn: strokes as they were found; painted: as the brush paints them; targets: what each should become; compensated:
    makes a plan of strokes; done: that of the painted ones, where it is there already. detail: how small an area gets a
    stroke of its own: "draft", "normal", "fine". are_corners_filled: else only limbs without a stroke get one.
    are_sides_painted: along what a stroke of the brush's greatest width leaves of a wider one, too.
    """
    done = compensated(painted) if done is None else done
    shapes = _shapes(drawn, painted, list(done.plan.passes), brush)
    are_free = are_corners_filled and brush.width_follows_depth()  # what a pen fills has exact edges
    found = _core.search_strokes(
        [(each.rings, each.strokes, each.passes) for each in shapes], brush, detail, are_free
    )
    rows = [(stroke, target, k) for k, (stroke, target) in enumerate(zip(painted, targets, strict=True))]
    lanes = [_lanes(shape.strokes) for shape in shapes]
    wide = _drawn_wider(drawn, brush)
    every: list[_Added] = []
    for shape, (strokes, changed, added), following in zip(shapes, found, lanes, strict=True):
        rows = _replace_paths(rows, shape, strokes, changed, following)
        every += _named(shape, added, following, are_corners_filled)
    if not are_sides_painted:  # nothing next to a stroke that was drawn wider
        every = [each for each in every if not each.is_rim and _part(each.stroke) not in wide]
    for shape in shapes:
        some = [each for each in every if each.stroke.origin.element == shape.element]
        if some:
            drawn, rows = _with_added(drawn, rows, shape, some)
    if all(k is not None for _, _, k in rows) and len(rows) == len(painted):
        return Searched(drawn, painted, targets, done)
    new = compensated([stroke for stroke, _, k in rows if k is None])
    numbers = iter(range(len(rows)))
    done = done.spliced(new, [(True, next(numbers)) if k is None else (False, k) for _, _, k in rows])
    added = frozenset(
        _repeated(each.stroke, repeat).id
        for shape in shapes
        for each in every
        if each.stroke.origin.element == shape.element
        for repeat in shape.repeats
    )
    return Searched(drawn, [row[0] for row in rows], [row[1] for row in rows], done, added)


def _drawn_wider(drawn: list, brush) -> set[tuple[str, int]]:
    """The parts of elements that were drawn wider than the brush."""
    greatest = brush.half_width_range_mm()[1]
    return {
        (stroke.origin.element, stroke.origin.part)
        for stroke in drawn
        if max(half for _, half in stroke.half_width) > greatest + SEEN_MM
    }


def _with_added(
    drawn: list, rows: list[tuple], shape: _Shape, added: list[_Added]
) -> tuple[list, list[tuple]]:
    """The strokes that were found, and the rows, with strokes added to a shape as often as it is painted."""
    copies = [(_repeated(each.stroke, repeat), each) for each in added for repeat in shape.repeats]
    copy_targets = [stroke.replaced(wanted_mm=each.own_mm) for stroke, each in copies]
    if not shape.is_filled:
        areas_mm = [ring for each in added for ring in each.area_mm]
        rows = [(stroke, _without(of, shape.element, areas_mm), k) for stroke, of, k in rows]
        drawn = _behind(copy_targets, drawn, lambda stroke: stroke)
    more = [(stroke, of, None) for (stroke, _), of in zip(copies, copy_targets, strict=True)]
    return drawn, _behind(more, rows, lambda row: row[0])


@dataclass(frozen=True)
class _Shape:
    """An element's shape: its strokes as they were found, its rings, the strokes that paint it once and their passes;
    which times it is painted; is_filled: in passes."""

    element: str
    found: list
    rings: list[np.ndarray]
    strokes: list
    passes: list
    repeats: list[int]

    @property
    def is_filled(self) -> bool:
        return not all(stroke.wanted_mm for stroke in self.strokes)


def _shapes(drawn: list, painted: list, passes: list, brush) -> list[_Shape]:
    """Elements of filled shapes; for a brush of one width those alone that it fills in passes."""
    found, paint, repeats = defaultdict(list), defaultdict(list), defaultdict(set)
    for stroke in drawn:
        if stroke.origin.repeat == 1 and stroke.wanted_mm:
            found[stroke.origin.element].append(stroke)
    for stroke, one in zip(painted, passes, strict=True):
        element = stroke.origin.element
        if element in found:
            repeats[element].add(stroke.origin.repeat)
            if stroke.origin.repeat == 1:
                paint[element].append((stroke, one))
    return [
        _Shape(
            element,
            strokes,
            _core.unite([ring for stroke in strokes for ring in stroke.wanted_mm]),
            *map(list, zip(*paint[element], strict=True)),
            sorted(repeats[element]),
        )
        for element, strokes in found.items()
        if paint[element]
        and (brush.width_follows_depth() or not all(stroke.wanted_mm for stroke, _ in paint[element]))
    ]


def _replace_paths(
    rows: list[tuple], shape: _Shape, strokes: list, changed: list[bool], following
) -> list[tuple]:
    """The rows of strokes, what they should become and their numbers, those of a shape as a search leads them."""
    paths = {
        (stroke.origin.part, stroke.origin.lane): made
        for stroke, made, is_changed in zip(shape.strokes, strokes, changed, strict=True)
        if is_changed
    }
    lanes = {
        (part, lane): [lane, *(following(part) for _ in made[1:])] for (part, lane), made in paths.items()
    }
    out = []
    for row in rows:
        of = row[0].origin
        key = of.part, of.lane
        if of.element != shape.element or key not in paths:
            out.append(row)
            continue
        parts = [
            made.replaced(id=_core.StrokeId(of.element, of.part, of.repeat, lane))
            for made, lane in zip(
                paths[key], lanes[key], strict=False
            )  # none is left of a stroke that is left out
        ]
        out += [(part, target, None) for part, target in _shared_out(parts, row[1])]
    return out


def _shared_out(parts: list, target) -> list[tuple]:
    """The parts of a stroke with what each should become: a later one its own discs, the first all the rest."""
    if len(parts) < 2:
        return [(part, target) for part in parts]
    if not target.wanted_mm:
        return [(part, part) for part in parts]
    left, pairs = target, []
    for part in parts[:0:-1]:
        own_mm = _core.intersect(
            _core.wanted_outline(part.replaced(wanted_mm=[]), _SWEPT_MM), target.wanted_mm
        )
        left = _without(left, target.origin.element, own_mm)
        pairs.append((part, part.replaced(wanted_mm=own_mm)))
    return [(parts[0], parts[0].replaced(wanted_mm=left.wanted_mm)), *pairs[::-1]]


def _lanes(strokes: list):
    """What gives the next lane of a part that none of the strokes has."""
    last: dict[int, int] = defaultdict(int)
    for stroke in strokes:
        last[stroke.origin.part] = max(last[stroke.origin.part], stroke.origin.lane)

    def following(part: int) -> int:
        last[part] += 1
        return last[part]

    return following


def _named(shape: _Shape, added: list, following, are_corners_filled: bool) -> Iterator[_Added]:
    """Added strokes, each called as the one that it runs next to, with a lane of its own. A stroke whose ends the
    artist set gets none, except along sides that are wider than the brush."""
    element, rings = shape.element, shape.rings
    whole_mm2 = _core.area(rings)
    hosts = list(shape.strokes)
    by_found = discs(shape.found) if added and not shape.is_filled else []
    by_painted = discs(shape.strokes) if added and not shape.is_filled else []
    for made, neighbour, area_mm, mark_mm in added:
        like = hosts[neighbour]
        hosts.append(like)
        stroke = like.replaced(
            middle_mm=made.middle_mm,
            closed=False,
            half_width=made.half_width,
            wanted_mm=[],
            start_covered=shape.is_filled,
            end_covered=shape.is_filled,
            settings=like.settings.replaced(start=made.settings.start, end=made.settings.end),
        )
        are_filled = are_corners_filled and not any(map(_is_set, (like.settings.start, like.settings.end)))
        is_rim = not shape.is_filled and is_mostly(area_mm, by_found)
        share = _core.area(area_mm) / whole_mm2
        is_corner = share < MISSED_SHARE or (is_rim and is_mostly(area_mm, by_painted))
        if is_corner and not are_filled:
            continue
        own_mm = []
        if not shape.is_filled:
            own_mm = _core.unite([*_core.intersect(mark_mm, rings), *_core.intersect(area_mm, rings)])
        part = like.origin.part
        stroke = stroke.replaced(id=_core.StrokeId(element, part, 1, following(part)), wanted_mm=own_mm)
        yield _Added(stroke, own_mm, area_mm, is_rim)


def _part(stroke) -> tuple[str, int]:
    return stroke.origin.element, stroke.origin.part


def _is_set(end: str | None) -> bool:
    return end not in (None, "auto")


def _repeated(stroke, repeat: int):
    of = stroke.origin
    return stroke.replaced(id=_core.StrokeId(of.element, of.part, repeat, of.lane))


def _behind(added: list, rows: list, stroke_of) -> list:
    element = stroke_of(added[0]).origin.element
    last = max(k for k, each in enumerate(rows) if stroke_of(each).origin.element == element)
    return [*rows[: last + 1], *added, *rows[last + 1 :]]


def _without(stroke, element: str, areas_mm: list[np.ndarray]):
    """Return a stroke of the element without the target areas that others paint."""
    if stroke.origin.element != element or not _core.intersect(stroke.wanted_mm, areas_mm):
        return stroke
    import shapely

    from .swept_areas import region, rings_of

    left = shapely.difference(region(stroke.wanted_mm), region(areas_mm))
    return stroke.replaced(wanted_mm=rings_of(left)) if left.area > 0 else stroke
