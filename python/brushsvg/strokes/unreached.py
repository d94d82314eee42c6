"""What of a filled shape stays blank: limbs that got no stroke, what a brush too narrow leaves, and what a mark misses
of its stroke, as at blunt ends, where it begins pointed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..drawing.design import Notice

LEAST_SHARE = 0.01  # of its shape
# Besides, in squares of the brush's greatest half width: what a disc leaves of a corner of 60 degrees. Smaller pieces
# are told where they are limbs, and not where they are corners.
_CORNER = 0.69
_LIMB_SHARE = 0.8  # of a disc in it, beyond: see shape_to_strokes.LEAST_SHARE
MISSED_SHARE = 0.03  # of its shape, beside which strokes run: pointed beginnings leave some of every letter
_STILL_BLANK = 0.5  # of a piece: what is left of a corner beside the mark in it is less
_EDGE_MM = 0.3  # a mark's edge lies beside the shape's by about as much: a thinner sliver is none
_SWEPT_MM = 0.05
# For a first look: what is as wide as the finest line, or as twice _EDGE_MM, is several pixels wide.
_PX_PER_MM, _PX_OF_FINEST, _SIDE_PX = 6.0, 2.5, 4000
_SEEN = 0.8  # of a piece in pixels, at least


@dataclass(frozen=True)
class Blank:
    """A connected piece of an element's shape: at_mm (x, y) lies in it; share of the shape; rings [mm]; is_rim: of a
    stroke that is wider than the brush."""

    element: str
    at_mm: tuple[float, float]
    share: float
    rings: list[np.ndarray]
    is_rim: bool = False


def unreached(drawn: list, painted: list, brush) -> list[Blank]:
    """Pieces that discs of the painted strokes' widths leave of the shapes that were drawn, the largest of each element
    first. Elements filled in several passes are left out: their notice says what is left.

    drawn: strokes as they were found, those with wanted_mm are of shapes; painted: as the brush will paint them.
    """
    found_as = {stroke.id: stroke for stroke in drawn}
    return [
        piece
        for element, rings, strokes in _shapes(drawn, painted, brush)
        for piece in told_rims(
            _pieces(element, rings, strokes, brush),
            [found_as[stroke.id] for stroke in strokes if stroke.id in found_as],
        )
    ]


def elements_with_blanks(drawn: list, painted: list, brush, share) -> list[str]:
    """The elements of whose shapes discs leave a piece, in a corner too, of more than the share that it makes of their
    rings."""
    return [
        element
        for element, rings, strokes in _shapes(drawn, painted, brush)
        if _left_by_discs(rings, strokes, share(rings) * _core.area(rings), finest(brush))
    ]


def blank_of_mark(
    element: str, rings: list[np.ndarray], mark: list[np.ndarray], brush, share: float
) -> list[Blank]:
    """Pieces of more than such a share of a shape that a mark leaves, the largest first."""
    whole = _core.area(rings)
    return [_blank(element, piece, whole) for piece in _left(rings, mark, share * whole, finest(brush))]


def _shapes(drawn: list, painted: list, brush):
    """Elements of shapes not filled in passes: name, rings, the strokes that paint it."""
    if not brush.width_follows_depth():
        return  # its one width is not that of any shape
    parts: dict[str, list[np.ndarray]] = {}
    for stroke in drawn:
        if stroke.origin.repeat == 1 and stroke.wanted_mm:
            parts.setdefault(stroke.origin.element, []).extend(stroke.wanted_mm)
    paint: dict[str, list] = {element: [] for element in parts}
    for stroke in painted:
        if stroke.origin.element in paint:
            paint[stroke.origin.element].append(stroke)
    for element, rings in parts.items():
        if all(stroke.wanted_mm for stroke in paint[element]):  # else filled in passes
            yield element, _core.unite(rings), paint[element]


def told_rims(pieces: list[Blank], strokes: list) -> list[Blank]:
    """The pieces; those of which most is reached by discs of the strokes as they were found are rims."""
    if not pieces:
        return []
    discs = _discs(strokes)
    return [
        replace(piece, is_rim=_core.area(_core.intersect(piece.rings, discs)) > 0.5 * _core.area(piece.rings))
        for piece in pieces
    ]


def _discs(strokes: list) -> list[np.ndarray]:
    bare = [stroke.replaced(wanted_mm=[]) for stroke in strokes]
    return _core.unite([ring for stroke in bare for ring in _core.wanted_outline(stroke, _SWEPT_MM)])


def _pieces(element: str, rings: list[np.ndarray], strokes: list, brush) -> list[Blank]:
    """Of one element."""
    whole = _core.area(rings)
    least_half, greatest = finest(brush), brush.half_width_range_mm()[1]
    limbs = None
    found = []
    least = max(LEAST_SHARE * whole, np.pi / 4 * least_half**2)
    for piece in _left_by_discs(rings, strokes, least, least_half):
        if piece.area <= _CORNER * greatest**2:
            import shapely

            limbs = _limbs(rings) if limbs is None else limbs
            if not shapely.intersects_xy(piece, *limbs.T).any():
                continue
        found.append(_blank(element, piece, whole))
    return found


def _left_by_discs(rings: list[np.ndarray], strokes: list, least: float, least_half: float) -> list:
    """Large pieces of a shape that discs of strokes leave."""
    bare = [stroke.replaced(wanted_mm=[]) for stroke in strokes]
    if not _may_leave(rings, lambda *window: _core.wanted_coverage(bare, *window), least, least_half):
        return []
    return _left(rings, _discs(strokes), least, least_half)


def _left(rings: list[np.ndarray], covered: list[np.ndarray], least: float, least_half: float) -> list:
    """Large pieces of a shape that other rings leave; without shapely where they leave too little."""
    if _core.area(rings) - _core.area(_core.intersect(rings, covered)) < least:
        return []
    import shapely

    from .swept_areas import region

    left = shapely.difference(region(rings), region(covered)).buffer(-_EDGE_MM).buffer(_EDGE_MM)
    return _large(left, least, least_half)


def left_blank(found: list[Blank], painted: list, traces: list, brush) -> list[Blank]:
    """Of pieces that no stroke's discs reach, those that its mark does not paint either: the way of a squared end runs
    into corners.

    painted, traces: as for `missed`.
    """
    if not found:
        return []
    marks = {piece.element: _core.Marks() for piece in found}
    for element, of in marks.items():
        pairs = zip(painted, traces, strict=True)
        of.passes = [trace for stroke, trace in pairs if stroke.origin.element == element]
        _core.trace_outlines(of, brush)
    blank = [_core.area(piece.rings) for piece in found]
    bare = [
        area - _core.area(_core.intersect(piece.rings, marks[piece.element].outline_mm))
        for piece, area in zip(found, blank, strict=True)
    ]
    rows = zip(found, blank, bare, strict=True)
    return [piece for piece, area, left in rows if left > _STILL_BLANK * area]


def missed(drawn: list, painted: list, traces: list, known: list[Blank], brush) -> list[Blank]:
    """Pieces of shapes that strokes reach and their marks do not, the largest of each element first.

    drawn: as for `unreached`, which found the known pieces; traces: marks of the painted strokes, of each one.
    """
    shapes: dict[str, list] = {}
    for stroke in drawn:
        if stroke.origin.repeat == 1 and stroke.wanted_mm:
            shapes.setdefault(stroke.origin.element, []).append(stroke)
    on_shapes: dict[str, list] = {element: [] for element in shapes}
    for stroke, trace in zip(painted, traces, strict=True):
        if stroke.origin.element in on_shapes:
            on_shapes[stroke.origin.element].append(trace)
    found = []
    for element, strokes in shapes.items():
        marks = _core.Marks()
        marks.passes = on_shapes[element]
        shape = _core.unite([ring for stroke in strokes for ring in stroke.wanted_mm])
        told = [piece.rings for piece in known if piece.element == element]
        if may_miss(shape, marks, brush, MISSED_SHARE, told):
            found += _missed(element, shape, marks, told, brush)
    return found


def may_miss(rings: list[np.ndarray], marks, brush, share: float, known: list[list[np.ndarray]] = ()) -> bool:
    """Whether `blank_of_mark` may find anything, beside pieces whose rings are known: a look in pixels, which takes a
    tenth of the time of outlines."""
    least = share * _core.area(rings)
    return _may_leave(
        rings, lambda *window: _core.coverage(marks, brush, *window), least, finest(brush), known
    )


def _may_leave(rings: list[np.ndarray], coverage, least: float, least_half: float, known=()) -> bool:
    """Whether `_left` may find anything. coverage: makes of a window and px/mm what covers the shape."""
    points = np.vstack(rings)
    low, size = points.min(axis=0), np.ptp(points, axis=0) + 1.0
    seen_mm = max(least_half, _EDGE_MM)  # `_left` leaves out what is thinner
    fine, most = max(_PX_PER_MM, _PX_OF_FINEST / seen_mm), _SIDE_PX / size.max()
    window = (*low, *size), min(fine, most)
    blank = (_core.coverage(rings, *window) > 0.5) & (coverage(*window) < 0.5)
    for piece in known:
        blank &= _core.coverage(piece, *window) < 0.5
    if fine <= most:
        blank = _all_or_any(_all_or_any(blank, np.logical_and), np.logical_or)
    return blank.sum() > _SEEN * least * window[1] ** 2


def _all_or_any(mask: np.ndarray, rule) -> np.ndarray:
    """Of each pixel and its eight neighbours, all or any."""
    for axis in (0, 1):
        mask = rule(rule(mask, np.roll(mask, 1, axis)), np.roll(mask, -1, axis))
    return mask


def _missed(
    element: str, rings: list[np.ndarray], marks, known: list[list[np.ndarray]], brush
) -> list[Blank]:
    import shapely

    from .swept_areas import region

    _core.trace_outlines(marks, brush)
    shape = region(rings)
    left = shapely.difference(shape, shapely.union_all([region(marks.outline_mm), *map(region, known)]))
    left = left.buffer(-_EDGE_MM).buffer(_EDGE_MM)
    large = _large(left, MISSED_SHARE * shape.area, finest(brush))
    return [_blank(element, piece, shape.area) for piece in large]


def _large(left, least: float, least_half: float) -> list:
    """Pieces that are large enough to be told, the largest first."""
    import shapely

    return [
        piece
        for piece in sorted(shapely.get_parts(left), key=lambda piece: -piece.area)
        if piece.area > least and shapely.maximum_inscribed_circle(piece, 0.02).length >= least_half
    ]


def _blank(element: str, piece, whole_mm2: float) -> Blank:
    import shapely

    x, y = shapely.maximum_inscribed_circle(piece, 0.02).coords[0]
    outlines = [
        np.array(ring.coords)[:-1]
        for one in shapely.get_parts(shapely.orient_polygons(piece))
        for ring in (one.exterior, *one.interiors)
    ]
    return Blank(element, (x, y), piece.area / whole_mm2, outlines)


def notices(found: list[Blank], is_reached: bool = False) -> list[Notice]:
    """One for each element, and one for its rims: where its largest piece lies, and the share of all of them.
    is_reached: by a stroke."""
    by_element: dict[tuple[str, bool], list[Blank]] = {}
    for piece in found:
        by_element.setdefault((piece.element, piece.is_rim), []).append(piece)
    told = []
    for (element, _), pieces in by_element.items():
        x, y = pieces[0].at_mm
        share = 100 * sum(piece.share for piece in pieces)
        where = f"near x {x:.1f}, y {y:.1f} mm"
        if len(pieces) > 1:
            where = f"in {len(pieces)} pieces, the largest {where}"
        if is_reached:
            said = f"the mark leaves at least {share:.2g} % of its shape blank, {where}"
            told.append(Notice(element, said, code="mark-misses"))
        elif pieces[0].is_rim:
            said = f"the brush is too narrow for {share:.2g} % of its shape, {where}"
            told.append(Notice(element, said, code="unreached"))
        else:
            said = f"no stroke reaches {share:.2g} % of its shape, {where}"
            told.append(Notice(element, said, code="unreached"))
    return told


def _limbs(rings: list[np.ndarray]) -> np.ndarray:
    """Places (n, 2) on the middle lines of a shape and of all of its limbs; none lies in a blunt corner."""
    _, branches = _core.medial_axis(rings, _LIMB_SHARE, 0.0)
    return np.vstack([np.empty((0, 2)), *(branch.line[:, :2] for branch in branches)])


def finest(brush) -> float:
    """Half the width of the finest line that the brush paints, as far as it was measured; 0 for a brush that begins to
    paint with no width."""
    measured = brush.lag.calibrated_mm
    least = brush.half_width_range_mm()[0]
    return max(least, brush.half_width(measured[0])) if measured else least
