"""What of a filled shape no stroke reaches: limbs that got none, and what a brush too narrow leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import _core
from ..drawing.design import Notice

LEAST_SHARE = 0.01  # of its shape
# Besides, in squares of the brush's greatest half width: what a disc leaves of a corner of 60 degrees. Smaller pieces
# are told where they are limbs, and not where they are corners.
_CORNER = 0.69
_LIMB_SHARE = 0.8  # of a disc in it, beyond: see skeleton.LEAST_SHARE
_EDGE_MM = 0.3  # a mark's edge lies beside the shape's by about as much: a thinner sliver is none
_SWEPT_MM = 0.05


@dataclass(frozen=True)
class Unreached:
    """A connected piece of an element's shape: at_mm (x, y) lies in it; share of the shape; rings [mm]."""

    element: str
    at_mm: tuple[float, float]
    share: float
    rings: list[np.ndarray]


def unreached(drawn: list, painted: list, brush) -> list[Unreached]:
    """Pieces that discs of the painted strokes' widths leave of the shapes that were drawn, the largest of each element
    first. Elements filled in several passes are left out: their notice says what is left.

    drawn: strokes as they were found, those with wanted_mm are of shapes; painted: as the brush will paint them.
    """
    if not brush.width_follows_depth():
        return []  # its one width is not that of any shape
    parts: dict[str, list[np.ndarray]] = {}
    for stroke in drawn:
        if stroke.origin.repeat == 1 and stroke.wanted_mm:
            parts.setdefault(stroke.origin.element, []).extend(stroke.wanted_mm)
    paint: dict[str, list] = {element: [] for element in parts}
    for stroke in painted:
        if stroke.origin.element in paint:
            paint[stroke.origin.element].append(stroke)
    return [
        piece
        for element, rings in parts.items()
        if all(stroke.origin.lane == 1 for stroke in paint[element])
        for piece in _pieces(element, _core.unite(rings), paint[element], brush)
    ]


def _pieces(element: str, rings: list[np.ndarray], strokes: list, brush) -> list[Unreached]:
    """Of one element; without shapely where the strokes leave too little."""
    discs = _core.unite(
        [ring for stroke in strokes for ring in _core.wanted_outline(_bare(stroke), _SWEPT_MM)]
    )
    whole = _core.area(rings)
    finest, greatest = _finest(brush), brush.half_width_range_mm()[1]
    least = max(LEAST_SHARE * whole, np.pi / 4 * finest**2)
    if whole - _core.area(_core.intersect(rings, discs)) < least:
        return []
    import shapely

    from .contour_fill import region

    left = shapely.difference(region(rings), region(discs)).buffer(-_EDGE_MM).buffer(_EDGE_MM)
    limbs = None
    found = []
    for piece in sorted(shapely.get_parts(left), key=lambda piece: -piece.area):
        if piece.area <= least or shapely.maximum_inscribed_circle(piece, 0.02).length < finest:
            continue
        if piece.area <= _CORNER * greatest**2:
            limbs = _limbs(rings) if limbs is None else limbs
            if not shapely.intersects_xy(piece, *limbs.T).any():
                continue
        x, y = shapely.maximum_inscribed_circle(piece, 0.02).coords[0]
        outlines = [
            np.array(ring.coords)[:-1]
            for one in shapely.get_parts(shapely.orient_polygons(piece))
            for ring in (one.exterior, *one.interiors)
        ]
        found.append(Unreached(element, (x, y), piece.area / whole, outlines))
    return found


def notices(found: list[Unreached]) -> list[Notice]:
    """One for each element: where its largest piece lies, and the share of all of them."""
    by_element: dict[str, list[Unreached]] = {}
    for piece in found:
        by_element.setdefault(piece.element, []).append(piece)
    told = []
    for element, pieces in by_element.items():
        x, y = pieces[0].at_mm
        share = 100 * sum(piece.share for piece in pieces)
        where = f"near x {x:.1f}, y {y:.1f} mm"
        if len(pieces) > 1:
            where = f"in {len(pieces)} pieces, the largest {where}"
        sentence = f"no stroke reaches {share:.2g} % of its shape, {where}"
        told.append(Notice(element, sentence, code="unreached"))
    return told


def _limbs(rings: list[np.ndarray]) -> np.ndarray:
    """Places (n, 2) on the middle lines of a shape and of all of its limbs; none lies in a blunt corner."""
    _, branches = _core.medial_axis(rings, _LIMB_SHARE, 0.0)
    return np.vstack([np.empty((0, 2)), *(branch.line[:, :2] for branch in branches)])


def _finest(brush) -> float:
    """Half the width of the finest line that the brush paints, as far as it was measured."""
    measured = brush.lag.calibrated_mm
    least = brush.half_width_range_mm()[0]
    return max(least, brush.half_width(measured[0])) if measured else least


def _bare(stroke):
    return _core.Stroke(middle_mm=stroke.middle_mm, half_width=stroke.half_width, closed=stroke.closed)
