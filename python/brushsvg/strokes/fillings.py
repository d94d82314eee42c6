"""Shapes wider than the brush, and ways to fill them along their outlines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from .. import _core
from .contour_fill import find_contour_passes
from .contour_rings import Line
from .swept_areas import painted_area, region, rings_of, unpainted_area

_MAX_STROKES = 500
_MAX_HALF_SLIT_MM = 0.01  # half the greatest width of slits between parts


@dataclass(frozen=True)
class WideShape:
    """A shape wider than the brush.

    wide: the numbers of its strokes that are wider; narrow: its other strokes; rings: of the shape; along: ways to
    fill it, each as lines; part: rings of the area that its wide strokes should paint.
    """

    wide: list[int]
    narrow: list
    rings: list[np.ndarray]
    along: list[list[Line]]
    part: list[np.ndarray]

    def first_share(self, first: list, lines: list) -> list[np.ndarray]:
        """Return the target of the first line. It is the line's own discs, and the area that all lines leave."""
        whole = region(self.part)
        share = shapely.union(shapely.intersection(painted_area(first), whole), unpainted_area(whole, lines))
        return rings_of(share)


def find_wide_shapes(strokes: list, wider: list[int], least: float, greatest: float) -> list[WideShape]:
    """Return the shapes to which strokes wider than the brush belong.

    wider: the numbers of the strokes; least, greatest: half widths of the brush [mm]. Shapes with more strokes than
    any lettering are left out.
    """
    wide_shapes, beyond = [], set(wider)
    for shape, members in _find_shapes_with_strokes(strokes, wider):
        if len(members) > _MAX_STROKES:
            continue
        wide = [k for k in members if k in beyond]
        narrow = [strokes[k] for k in members if k not in beyond]
        part = _core.unite([ring for k in wide for ring in strokes[k].target_mm])
        wide_shapes.append(WideShape(wide, narrow, rings_of(shape), find_contour_passes(shape, least, greatest), part))
    return wide_shapes


def _find_shapes_with_strokes(strokes: list, wider: list[int]) -> list[tuple]:
    """Return shapes with wide strokes, and the numbers of all of their strokes."""
    elements: dict[tuple, list[int]] = {}
    for k, stroke in enumerate(strokes):
        if stroke.target_mm:
            elements.setdefault(_shape_key(stroke), []).append(k)
    pairs = []
    wide = set(wider)
    for element in dict.fromkeys(_shape_key(strokes[k]) for k in wider):
        numbers = elements[element]
        shapes = shapely.get_parts(region(_core.unite([r for k in numbers for r in strokes[k].target_mm])))
        shapes = np.array([_without_slits(shape) for shape in shapes])
        members: list[list[int]] = [[] for _ in shapes]
        for k, home in zip(numbers, _find_shape_of_strokes(shapes, [strokes[k] for k in numbers]), strict=True):
            members[home].append(k)
        if all(members):  # otherwise a stroke paints in two of the shapes
            pairs += [pair for pair in zip(shapes, members, strict=True) if not wide.isdisjoint(pair[1])]
    return pairs


def _without_slits(shape):
    """Return a shape without the slits between the parts of its strokes. Rings would run round the slits."""
    closed = shape.buffer(_MAX_HALF_SLIT_MM, join_style="mitre").buffer(-_MAX_HALF_SLIT_MM, join_style="mitre")
    return closed if closed.geom_type == "Polygon" and closed.is_valid else shape


def _find_shape_of_strokes(shapes, strokes: list) -> list[int]:
    """Return for each stroke the shape that has most of its part. Shapes may meet where strokes begin."""
    if len(shapes) == 1:
        return [0] * len(strokes)
    tree, homes = shapely.STRtree(shapes), []
    for stroke in strokes:
        part = region(_core.unite(stroke.target_mm))
        near = tree.query(part)
        homes.append(int(near[np.argmax(shapely.area(shapely.intersection(shapes[near], part)))]))
    return homes


def _shape_key(stroke) -> tuple[str, int]:
    """Return a stroke's element and repeat, which strokes of one shape have in common."""
    return stroke.origin.element, stroke.origin.repeat
