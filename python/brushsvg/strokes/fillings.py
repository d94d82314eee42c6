"""Shapes wider than the brush filled in several passes: beside the middle lines where that covers them, else along
their outlines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from .. import _core
from .contour_fill import contour_passes
from .offset_passes import Line, clamped, offset_passes
from .swept_areas import painted, region, rings_of, unpainted

_MOST_STROKES = 500
_SLIT_MM = 0.01  # half as wide as slits between parts may be


@dataclass(frozen=True)
class Filling:
    """What fills one shape. passes: for the number of each stroke that is wider than the brush, the lines to paint in
    its place, none where those of another do; meant: of what they become, the first's line and rings; rings: of the
    shape; narrow: its strokes that are not filled."""

    passes: dict[int, list[Line]]
    meant: dict[int, tuple[Line, list[np.ndarray]]]
    rings: list[np.ndarray]
    narrow: list

    @property
    def count(self) -> int:
        return sum(map(len, self.passes.values()))


def fillings(strokes: list, wider: list[int], least: float, greatest: float) -> list[list[Filling]]:
    """The ways to fill each of the shapes that strokes wider than the brush, given by their numbers, are of: beside the
    middle lines first, then along the outline. Shapes that no lettering has are left out."""
    found, beyond = [], set(wider)
    for shape, members in _shapes(strokes, wider):
        if len(members) > _MOST_STROKES:
            continue
        wide = {k: strokes[k] for k in members if k in beyond}
        narrow = [strokes[k] for k in members if k not in beyond]
        found.append(_ways(shape, wide, narrow, least, greatest))
    return found


def _ways(shape, wide: dict[int, object], narrow: list, least: float, greatest: float) -> list[Filling]:
    beside = {
        k: [clamped(stroke, least, greatest), *offset_passes(stroke, greatest)] for k, stroke in wide.items()
    }
    meant = {k: (Line(s.middle_mm, s.half_width, s.closed), s.wanted_mm) for k, s in wide.items()}
    rings = rings_of(shape)
    ways = [Filling(beside, meant, rings, narrow)]
    first, *others = wide
    part = _core.unite([ring for stroke in wide.values() for ring in stroke.wanted_mm])
    for lines in contour_passes(shape, least, greatest):
        passes = {first: lines, **{k: [] for k in others}}
        ways.append(Filling(passes, {first: (lines[0], _first_share(part, lines))}, rings, narrow))
    return ways


def _first_share(part: list[np.ndarray], lines: list[Line]) -> list[np.ndarray]:
    """What the first of the lines is meant to paint of a part: its own discs, and what those of all lines leave."""
    whole = region(part)
    share = shapely.union(shapely.intersection(painted(lines[:1]), whole), unpainted(whole, lines))
    return rings_of(share)


def _shapes(strokes: list, wider: list[int]) -> list[tuple]:
    """Shapes with strokes that are wider than the brush, and the numbers of all of their strokes."""
    elements: dict[tuple, list[int]] = {}
    for k, stroke in enumerate(strokes):
        if stroke.wanted_mm:
            elements.setdefault(_element(stroke), []).append(k)
    found = []
    wide = set(wider)
    for element in dict.fromkeys(_element(strokes[k]) for k in wider):
        numbers = elements[element]
        shapes = shapely.get_parts(region(_core.unite([r for k in numbers for r in strokes[k].wanted_mm])))
        shapes = np.array([_without_slits(shape) for shape in shapes])
        members: list[list[int]] = [[] for _ in shapes]
        for k, home in zip(numbers, _homes(shapes, [strokes[k] for k in numbers]), strict=True):
            members[home].append(k)
        if all(members):  # else a stroke paints in two of them
            found += [pair for pair in zip(shapes, members, strict=True) if not wide.isdisjoint(pair[1])]
    return found


def _without_slits(shape):
    """A shape without the slits that are left where the parts of its strokes meet: rings would lead round them."""
    closed = shape.buffer(_SLIT_MM, join_style="mitre").buffer(-_SLIT_MM, join_style="mitre")
    return closed if closed.geom_type == "Polygon" else shape


def _homes(shapes, strokes: list) -> list[int]:
    """For each stroke the shape that has most of its part: shapes may meet where strokes begin."""
    if len(shapes) == 1:
        return [0] * len(strokes)
    tree, homes = shapely.STRtree(shapes), []
    for stroke in strokes:
        part = region(_core.unite(stroke.wanted_mm))
        near = tree.query(part)
        homes.append(int(near[np.argmax(shapely.area(shapely.intersection(shapes[near], part)))]))
    return homes


def _element(stroke) -> tuple[str, int]:
    """What strokes that share a shape have in common: their element, and which of the times that it is painted."""
    return stroke.origin.element, stroke.origin.repeat
