"""Find areas of filled shapes that stay without paint."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..read.design import Notice

# Of its shape, from which on an area without paint is reported: one that no stroke reaches, and one that strokes reach
# and their marks do not. A mark that begins pointed leaves some of every letter.
LEAST_SHARE, MISSED_SHARE = 0.01, 0.03
_DISC_MM = 0.05  # to which the discs of a stroke's width are made


@dataclass(frozen=True)
class Blank:
    """A connected area of an element's shape: at_mm (x, y): a point in it; share of the shape; rings [mm]; is_rim: of a
    stroke that is wider than the brush; is_reached: by a stroke whose mark leaves it."""

    element: str
    at_mm: tuple[float, float]
    share: float
    rings: list[np.ndarray]
    is_rim: bool = False
    is_reached: bool = False


def uncovered_areas(drawn: list, painted: list, passes: list, brush) -> list[Blank]:
    """Areas that the marks of passes leave of the shapes that were drawn, the largest of each element first.

    drawn: strokes as they were found, those with wanted_mm are of shapes; painted: as the brush paints them, by passes.
    """
    if not brush.width_follows_depth():
        return []  # its one width is not that of any shape
    found, paint = defaultdict(list), defaultdict(list)
    for stroke in drawn:
        if stroke.origin.repeat == 1 and stroke.wanted_mm:
            found[stroke.origin.element].append(stroke)
    for stroke, one in zip(painted, passes, strict=True):
        if stroke.origin.element in found:
            paint[stroke.origin.element].append((stroke, one))
    shapes = [
        (
            _core.unite([ring for stroke in strokes for ring in stroke.wanted_mm]),
            [stroke for stroke, _ in paint[element]],
            [one for _, one in paint[element]],
        )
        for element, strokes in found.items()
    ]
    areas = _core.uncovered_areas(shapes, brush, LEAST_SHARE)
    rows = zip(found.items(), shapes, areas, strict=True)
    return [
        blank
        for (element, strokes), (rings, of_shape, _), left in rows
        for blank in _blanks(element, left, _core.area(rings), strokes, of_shape, brush)
    ]


def _blanks(element: str, left: list, whole_mm2: float, found: list, painted: list, brush):
    if not left:
        return
    by_strokes, by_found = discs(painted), discs(found)
    dab_mm2 = np.pi * finest(brush) ** 2
    for rings, at_mm, mm2 in left:
        rings = [np.asarray(ring) for ring in rings]
        is_reached = is_mostly(rings, by_strokes)
        if mm2 < dab_mm2 or (is_reached and mm2 < MISSED_SHARE * whole_mm2):
            continue
        is_rim = not is_reached and is_mostly(rings, by_found)
        yield Blank(element, tuple(at_mm), mm2 / whole_mm2, rings, is_rim, is_reached)


def discs(strokes: list) -> list[np.ndarray]:
    """Rings of what discs of their widths cover along strokes."""
    bare = [stroke.replaced(wanted_mm=[]) for stroke in strokes]
    return _core.unite([ring for stroke in bare for ring in _core.wanted_outline(stroke, _DISC_MM)])


def is_mostly(rings: list[np.ndarray], within: list[np.ndarray]) -> bool:
    """Whether more than half of an area is within others."""
    return _core.area(_core.intersect(rings, within)) > 0.5 * _core.area(rings)


def notices(found: list[Blank]) -> list[Notice]:
    """Return a notice for each element and kind of area: the place of the largest, and the share of all of them."""
    by_kind: dict[tuple[str, bool, bool], list[Blank]] = {}
    for piece in found:
        by_kind.setdefault((piece.element, piece.is_reached, piece.is_rim), []).append(piece)
    made = []
    for (element, is_reached, is_rim), pieces in by_kind.items():
        x, y = pieces[0].at_mm
        share = 100 * sum(piece.share for piece in pieces)
        where = f"near x {x:.1f}, y {y:.1f} mm"
        if len(pieces) > 1:
            where = f"in {len(pieces)} pieces, the largest {where}"
        if is_reached:
            said = f"the mark leaves at least {share:.2g} % of its shape blank, {where}"
        elif is_rim:
            said = f"the brush is too narrow for {share:.2g} % of its shape, {where}"
        else:
            said = f"no stroke reaches {share:.2g} % of its shape, {where}"
        made.append(Notice(element, said, code="mark-misses" if is_reached else "unreached"))
    return made


def finest(brush) -> float:
    """Half the width of the finest line that the brush paints, as far as it was measured; 0 for a brush that begins to
    paint with no width."""
    measured = brush.lag.calibrated_mm
    least = brush.half_width_range_mm()[0]
    return max(least, brush.half_width(measured[0])) if measured else least
