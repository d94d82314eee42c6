"""Shapes wider than the brush, and the ways to fill them in passes along their outlines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from .. import _core
from .contour_fill import contour_passes
from .contour_rings import Line
from .swept_areas import painted, region, rings_of, unpainted

_MOST_STROKES = 500
_SLIT_MM = 0.01  # half as wide as slits between parts may be


@dataclass(frozen=True)
class WideShape:
    """A shape wider than the brush. wide: the numbers of its strokes that are; narrow: its other strokes; rings: of the
    shape; along: ways to fill it, each as lines; part: what its wide strokes should paint."""

    wide: list[int]
    narrow: list
    rings: list[np.ndarray]
    along: list[list[Line]]
    part: list[np.ndarray]

    def first_share(self, first: list, lines: list) -> list[np.ndarray]:
        """Return the target of the first line: its own discs, and the area that all lines leave."""
        whole = region(self.part)
        share = shapely.union(shapely.intersection(painted(first), whole), unpainted(whole, lines))
        return rings_of(share)


def fillings(strokes: list, wider: list[int], least: float, greatest: float) -> list[WideShape]:
    """The shapes that strokes wider than the brush, given by their numbers, are of, but for those that no lettering
    has."""
    found, beyond = [], set(wider)
    for shape, members in _shapes(strokes, wider):
        if len(members) > _MOST_STROKES:
            continue
        wide = [k for k in members if k in beyond]
        narrow = [strokes[k] for k in members if k not in beyond]
        part = _core.unite([ring for k in wide for ring in strokes[k].wanted_mm])
        found.append(WideShape(wide, narrow, rings_of(shape), contour_passes(shape, least, greatest), part))
    return found


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
