"""Areas of filled shapes that stay without paint."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..read.design import Notice

# Shares of a shape from which on an area without paint is reported. The first holds for an area that no stroke
# reaches, the second for one that strokes reach and their marks do not. A mark that begins pointed leaves some of
# every letter.
MIN_UNREACHED_SHARE, MIN_MISSED_SHARE = 0.01, 0.03
_DISC_TOLERANCE_MM = 0.05  # tolerance of the outline of a stroke's discs


@dataclass(frozen=True)
class UncoveredArea:
    """A connected area of an element's shape without paint.

    at_mm: (x, y), a point in it; share: of the shape; rings: in mm; is_rim: whether it belongs to a stroke that is
    wider than the brush; is_reached: whether a stroke reaches it whose mark does not.
    """

    element: str
    at_mm: tuple[float, float]
    share: float
    rings: list[np.ndarray]
    is_rim: bool = False
    is_reached: bool = False


def uncovered_areas(drawn: list, painted: list, passes: list, brush) -> list[UncoveredArea]:
    """Find areas of drawn shapes that the marks of passes do not cover.

    drawn: strokes as they were found; strokes with target_mm are of shapes; painted: as the brush paints them, one
    for each pass. The largest area of each element comes first.
    """
    if not brush.width_follows_depth():
        return []  # a brush of one width is not expected to cover a shape
    strokes_of, paint = defaultdict(list), defaultdict(list)
    for stroke in drawn:
        if stroke.origin.repeat == 1 and stroke.target_mm:
            strokes_of[stroke.origin.element].append(stroke)
    for stroke, a_pass in zip(painted, passes, strict=True):
        if stroke.origin.element in strokes_of:
            paint[stroke.origin.element].append((stroke, a_pass))
    shapes = [
        (
            _core.unite([ring for stroke in strokes for ring in stroke.target_mm]),
            [stroke for stroke, _ in paint[element]],
            [a_pass for _, a_pass in paint[element]],
        )
        for element, strokes in strokes_of.items()
    ]
    areas = _core.uncovered_areas(shapes, brush, MIN_UNREACHED_SHARE)
    rows = zip(strokes_of.items(), shapes, areas, strict=True)
    return [
        area
        for (element, strokes), (rings, of_shape, _), left in rows
        for area in _find_element_areas(element, left, _core.area(rings), strokes, of_shape, brush)
    ]


def _find_element_areas(element: str, left: list, whole_mm2: float, found: list, painted: list, brush):
    if not left:
        return
    by_strokes, by_found = swept_discs(painted), swept_discs(found)
    dab_mm2 = np.pi * finest_half_width_mm(brush) ** 2
    for rings, at_mm, mm2 in left:
        rings = [np.asarray(ring) for ring in rings]
        is_reached = is_mostly_within(rings, by_strokes)
        if mm2 < dab_mm2 or (is_reached and mm2 < MIN_MISSED_SHARE * whole_mm2):
            continue
        is_rim = not is_reached and is_mostly_within(rings, by_found)
        yield UncoveredArea(element, tuple(at_mm), mm2 / whole_mm2, rings, is_rim, is_reached)


def swept_discs(strokes: list) -> list[np.ndarray]:
    """Return rings of the area that discs of their widths cover along strokes."""
    bare = [stroke.replaced(target_mm=[]) for stroke in strokes]
    return _core.unite([ring for stroke in bare for ring in _core.target_outline(stroke, _DISC_TOLERANCE_MM)])


def is_mostly_within(rings: list[np.ndarray], within: list[np.ndarray]) -> bool:
    """Return whether more than half of an area is within others."""
    return _core.area(_core.intersect(rings, within)) > 0.5 * _core.area(rings)


def notices_of_areas(found: list[UncoveredArea]) -> list[Notice]:
    """Return a notice for each element and kind of area.

    It names the place of the largest area, and the share of all of them.
    """
    by_kind: dict[tuple[str, bool, bool], list[UncoveredArea]] = {}
    for piece in found:
        by_kind.setdefault((piece.element, piece.is_reached, piece.is_rim), []).append(piece)
    reports = []
    for (element, is_reached, is_rim), pieces in by_kind.items():
        x, y = pieces[0].at_mm
        share = 100 * sum(piece.share for piece in pieces)
        where = f"near x {x:.1f}, y {y:.1f} mm"
        if len(pieces) > 1:
            where = f"in {len(pieces)} pieces, the largest {where}"
        if is_reached:
            sentence = f"the mark leaves at least {share:.2g} % of its shape blank, {where}"
        elif is_rim:
            sentence = f"the brush is too narrow for {share:.2g} % of its shape, {where}"
        else:
            sentence = f"no stroke reaches {share:.2g} % of its shape, {where}"
        reports.append(Notice(element, sentence, code="mark-misses" if is_reached else "unreached"))
    return reports


def finest_half_width_mm(brush) -> float:
    """Return half the width of the finest line that the brush paints.

    Lines that are finer than the measured ones do not count. Returns 0 for a brush that begins to paint with no
    width.
    """
    measured = brush.lag.calibrated_mm
    least = brush.half_width_range_mm()[0]
    return max(least, brush.half_width(measured[0])) if measured else least
