"""Search for strokes of filled shapes whose marks fit the shapes better.

The search replaces the paths of strokes, and adds strokes into areas that stay without paint.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..geometry.rings import without_slivers
from .skeleton.shape_to_strokes import SLIVER_MM
from .trial_mark import MIN_VISIBLE_MM
from .uncovered_areas import MIN_MISSED_SHARE, is_mostly_within, swept_discs

_OUTLINE_TOLERANCE_MM = 0.02


@dataclass(frozen=True)
class _AddedStroke:
    """A stroke into an area without paint.

    own_mm: rings of the stroke's target area; area_mm: rings of the area without paint; is_rim: whether the area is
    within the discs of a stroke as it was found.
    """

    stroke: object
    own_mm: list[np.ndarray]
    area_mm: list[np.ndarray]
    is_rim: bool


@dataclass(frozen=True)
class Searched:
    """The result of a search.

    drawn, painted, targets: the strokes as in `searched`, with added ones behind the others of their element; done:
    the compensation of the painted strokes; added: ids of the strokes that the search added.
    """

    drawn: list
    painted: list
    targets: list
    done: _core.Compensated
    added: frozenset[str] = frozenset()


def search_strokes(
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
    """Return the strokes with which the marks of filled shapes cost least.

    drawn: strokes as they were found; painted: as the brush paints them; targets: what each should become;
    compensated: makes a plan of strokes; done: the compensation of `painted`, if it is known already. detail:
    "draft", "normal" or "fine", how small an area gets a stroke of its own. are_corners_filled: if False, only
    limbs without a stroke get one. are_sides_painted: whether strokes are also added along the sides that a stroke
    of the brush's greatest width leaves of a wider one.
    """
    done = compensated(painted) if done is None else done
    shapes = _collect_shapes(drawn, painted, list(done.plan.passes), brush)
    # Areas that a pen fills have exact edges.
    are_free = are_corners_filled and brush.width_follows_depth()
    changes = _core.search_strokes(
        [(each.rings, each.strokes, each.passes) for each in shapes], brush, detail, are_free
    )
    rows = [(stroke, target, k) for k, (stroke, target) in enumerate(zip(painted, targets, strict=True))]
    lanes = [_lane_counter(shape.strokes) for shape in shapes]
    wide = _find_drawn_wider(drawn, brush)
    added_strokes: list[_AddedStroke] = []
    for shape, (strokes, changed, added), following in zip(shapes, changes, lanes, strict=True):
        rows = _replace_paths(rows, shape, strokes, changed, following)
        added_strokes += _name_added(shape, added, following, are_corners_filled)
    if not are_sides_painted:  # no strokes next to one that was drawn wider than the brush
        added_strokes = [each for each in added_strokes if not each.is_rim and _part_key(each.stroke) not in wide]
    for shape in shapes:
        of_shape = [each for each in added_strokes if each.stroke.origin.element == shape.element]
        if of_shape:
            drawn, rows = _add_strokes(drawn, rows, shape, of_shape)
    if all(k is not None for _, _, k in rows) and len(rows) == len(painted):
        return Searched(drawn, painted, targets, done)
    added_done = compensated([stroke for stroke, _, k in rows if k is None])
    numbers = iter(range(len(rows)))
    done = done.spliced(added_done, [(True, next(numbers)) if k is None else (False, k) for _, _, k in rows])
    added = frozenset(
        _repeat_stroke(each.stroke, repeat).id
        for shape in shapes
        for each in added_strokes
        if each.stroke.origin.element == shape.element
        for repeat in shape.repeats
    )
    return Searched(drawn, [row[0] for row in rows], [row[1] for row in rows], done, added)


def _find_drawn_wider(drawn: list, brush) -> set[tuple[str, int]]:
    """Return the (element, part) of strokes that were drawn wider than the brush."""
    greatest = brush.half_width_range_mm()[1]
    return {
        (stroke.origin.element, stroke.origin.part)
        for stroke in drawn
        if max(half for _, half in stroke.half_width) > greatest + MIN_VISIBLE_MM
    }


def _add_strokes(drawn: list, rows: list[tuple], shape: _Shape, added: list[_AddedStroke]) -> tuple[list, list[tuple]]:
    """Add strokes to a shape, as often as it is painted.

    Returns the strokes as found, and the rows (stroke, target, number of its pass).
    """
    copies = [(_repeat_stroke(each.stroke, repeat), each) for each in added for repeat in shape.repeats]
    copy_targets = [stroke.replaced(target_mm=each.own_mm) for stroke, each in copies]
    if not shape.is_filled:
        areas_mm = [ring for each in added for ring in each.area_mm]
        rows = [(stroke, _remove_areas(of, shape.element, areas_mm), k) for stroke, of, k in rows]
        drawn = _insert_behind(copy_targets, drawn, lambda stroke: stroke)
    new_rows = [(stroke, of, None) for (stroke, _), of in zip(copies, copy_targets, strict=True)]
    return drawn, _insert_behind(new_rows, rows, lambda row: row[0])


@dataclass(frozen=True)
class _Shape:
    """The shape of an element.

    found: its strokes as they were found; rings: of the shape; strokes: those that paint it once; passes: their
    passes; repeats: numbers of the times that it is painted.
    """

    element: str
    found: list
    rings: list[np.ndarray]
    strokes: list
    passes: list
    repeats: list[int]

    @property
    def is_filled(self) -> bool:
        """Whether the shape is filled in passes."""
        return not all(stroke.target_mm for stroke in self.strokes)


def _collect_shapes(drawn: list, painted: list, passes: list, brush) -> list[_Shape]:
    """Return the shapes of elements with filled strokes; for a brush of one width, those filled in passes."""
    strokes_of, paint, repeats = defaultdict(list), defaultdict(list), defaultdict(set)
    for stroke in drawn:
        if stroke.origin.repeat == 1 and stroke.target_mm:
            strokes_of[stroke.origin.element].append(stroke)
    for stroke, a_pass in zip(painted, passes, strict=True):
        element = stroke.origin.element
        if element in strokes_of:
            repeats[element].add(stroke.origin.repeat)
            if stroke.origin.repeat == 1:
                paint[element].append((stroke, a_pass))
    return [
        _Shape(
            element,
            strokes,
            # Rounding leaves slits between the parts of a shape. Their mouths would be corners of its outline.
            [
                without_slivers(ring, SLIVER_MM)
                for ring in _core.unite([ring for stroke in strokes for ring in stroke.target_mm])
            ],
            *map(list, zip(*paint[element], strict=True)),
            sorted(repeats[element]),
        )
        for element, strokes in strokes_of.items()
        if paint[element] and (brush.width_follows_depth() or not all(stroke.target_mm for stroke, _ in paint[element]))
    ]


def _replace_paths(rows: list[tuple], shape: _Shape, strokes: list, changed: list[bool], following) -> list[tuple]:
    """Replace the paths of a shape's strokes by those that the search found.

    rows: (stroke, target, number of its pass); a replaced stroke has no pass yet. changed: which of the strokes
    were replaced; following: gives the next free lane of a part.
    """
    paths = {
        (stroke.origin.part, stroke.origin.lane): new_strokes
        for stroke, new_strokes, is_changed in zip(shape.strokes, strokes, changed, strict=True)
        if is_changed
    }
    lanes = {
        (part, lane): [lane, *(following(part) for _ in new_strokes[1:])] for (part, lane), new_strokes in paths.items()
    }
    new_rows = []
    for row in rows:
        of = row[0].origin
        key = of.part, of.lane
        if of.element != shape.element or key not in paths:
            new_rows.append(row)
            continue
        parts = [
            new_stroke.replaced(id=_core.StrokeId(of.element, of.part, of.repeat, lane))
            for new_stroke, lane in zip(paths[key], lanes[key], strict=False)  # a stroke that is left out has no parts
        ]
        new_rows += [(part, target, None) for part, target in _share_target(parts, row[1])]
    return new_rows


def _share_target(parts: list, target) -> list[tuple]:
    """Return the parts of a stroke, each with its target.

    Later parts have their own discs as target, the first has all the rest.
    """
    if len(parts) < 2:
        return [(part, target) for part in parts]
    if not target.target_mm:
        return [(part, part) for part in parts]
    rest, pairs = target, []
    for part in parts[:0:-1]:
        own_mm = _core.intersect(
            _core.target_outline(part.replaced(target_mm=[]), _OUTLINE_TOLERANCE_MM), target.target_mm
        )
        rest = _remove_areas(rest, target.origin.element, own_mm)
        pairs.append((part, part.replaced(target_mm=own_mm)))
    return [(parts[0], parts[0].replaced(target_mm=rest.target_mm)), *pairs[::-1]]


def _lane_counter(strokes: list):
    """Return a function that gives the next free lane of a part."""
    last: dict[int, int] = defaultdict(int)
    for stroke in strokes:
        last[stroke.origin.part] = max(last[stroke.origin.part], stroke.origin.lane)

    def following(part: int) -> int:
        last[part] += 1
        return last[part]

    return following


def _name_added(shape: _Shape, added: list, following, are_corners_filled: bool) -> Iterator[_AddedStroke]:
    """Yield the added strokes, each named after the stroke next to it.

    Each has a lane of its own. No stroke is added next to one whose ends the artist set, except along sides that
    are wider than the brush.
    """
    element, rings = shape.element, shape.rings
    whole_mm2 = _core.area(rings)
    hosts = list(shape.strokes)
    by_found = swept_discs(shape.found) if added and not shape.is_filled else []
    by_painted = swept_discs(shape.strokes) if added and not shape.is_filled else []
    for path_stroke, neighbour, area_mm, mark_mm in added:
        like = hosts[neighbour]
        hosts.append(like)
        stroke = like.replaced(
            middle_mm=path_stroke.middle_mm,
            closed=False,
            half_width=path_stroke.half_width,
            target_mm=[],
            start_covered=shape.is_filled,
            end_covered=shape.is_filled,
            settings=like.settings.replaced(start=path_stroke.settings.start, end=path_stroke.settings.end),
        )
        are_filled = are_corners_filled and {like.settings.start, like.settings.end} <= {None, "auto"}
        is_rim = not shape.is_filled and is_mostly_within(area_mm, by_found)
        share = _core.area(area_mm) / whole_mm2
        is_corner = share < MIN_MISSED_SHARE or (is_rim and is_mostly_within(area_mm, by_painted))
        if is_corner and not are_filled:
            continue
        own_mm = []
        if not shape.is_filled:
            own_mm = _core.unite([*_core.intersect(mark_mm, rings), *_core.intersect(area_mm, rings)])
        part = like.origin.part
        stroke = stroke.replaced(id=_core.StrokeId(element, part, 1, following(part)), target_mm=own_mm)
        yield _AddedStroke(stroke, own_mm, area_mm, is_rim)


def _part_key(stroke) -> tuple[str, int]:
    return stroke.origin.element, stroke.origin.part


def _repeat_stroke(stroke, repeat: int):
    origin = stroke.origin
    return stroke.replaced(id=_core.StrokeId(origin.element, origin.part, repeat, origin.lane))


def _insert_behind(added: list, rows: list, stroke_of) -> list:
    element = stroke_of(added[0]).origin.element
    last = max(k for k, each in enumerate(rows) if stroke_of(each).origin.element == element)
    return [*rows[: last + 1], *added, *rows[last + 1 :]]


def _remove_areas(stroke, element: str, areas_mm: list[np.ndarray]):
    """Return a stroke of the element without the target areas that others paint."""
    if stroke.origin.element != element or not _core.intersect(stroke.target_mm, areas_mm):
        return stroke
    import shapely

    from .swept_areas import region, rings_of

    rest = shapely.difference(region(stroke.target_mm), region(areas_mm))
    return stroke.replaced(target_mm=rings_of(rest)) if rest.area > 0 else stroke
