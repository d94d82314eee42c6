"""Limbs of filled shapes too small beside their stem to be found as strokes, as the flag of a bold i: where marks leave
one blank, a stroke runs along the edge of the shape beside it, or a short straight one out into it from the middle of
the stroke beside it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import _core
from ..errors import Error
from .bulges import painted_by
from .trial_mark import SEEN_MM, Wanted, outline_of, trial_mark, trial_marks
from .unreached import MISSED_SHARE, Blank, blank_of_mark, elements_with_blanks, finest, may_miss, told_rims

# What of a shape a corner is at least that one sees, and in squares of the brush's greatest half width: smaller ones in
# each stroke of a character would take a third more strokes. What discs leave where a mark leaves as much as that.
_CORNER_SHARE, _CORNER, _BY_DISCS = 0.005, 0.2, 0.4
# Of a blank piece, what its stroke paints of the shape less what it paints beside it: else it is not worth its poses.
_WORTH = 0.4
# Of a piece's area, what a full turn more of the mark's outline counts: a stroke into a small knob along its stem makes
# a blob, which the eye minds more.
_TURN = 0.5
_BULGE = 6.0  # how many times what sticks out of the shape counts more, as in corners
# Half widths of lines along edges, in those of the brush and in how far a piece reaches into the shape; of how much of
# a piece's outline an edge is the nearest one at least.
_WIDTHS, _OF_DEPTH, _ON_EDGE = (0.27, 0.45, 0.7, 1.0), 0.7, 0.25
_LOOKED_AT = 4  # ways whose outlines are looked at, of those that paint most in pixels
_BESIDE = 3.0  # a stroke, in half widths: it paints no farther out
_SIDES = 0.7  # of what the brush is too narrow for: else some stems of a word would be painted wider, and others not
_MOST = 4  # strokes added to an element: a logo of one path may have many limbs
_ROUND = -0.85  # half width won per length where a limb ends round or square: there its line ends
_EVEN_MM = 0.1
_SMOOTHED = 0.03  # of the half width, as middle lines of shapes
_SWEPT_MM = 0.02


@dataclass(frozen=True)
class _Limb:
    """A stroke into a blank piece; rings of what it paints of the shape, the piece with it; how much it wins."""

    stroke: object
    own_mm: list[np.ndarray]
    piece: Blank
    won_mm2: float

    @property
    def is_side(self) -> bool:
        """Whether the brush is too narrow for what it paints, which were not lost without."""
        return self.piece.is_rim and self.piece.share < MISSED_SHARE


def with_left_limbs(
    drawn: list, painted: list, wanted: list, brush, are_corners_filled: bool, are_sides_painted: bool
) -> tuple[list, list, list, set[str]]:
    """All three lists, with a stroke more for each large blank piece that one paints: of more than 3 % of its shape, or
    0.5 % where corners are filled too and the brush is not too large for that. It comes behind those of its element,
    and is called as the stroke that it leaves, with a lane of its own. And the elements that are wider than the brush
    and painted there, too.

    drawn: strokes as they were found; painted, wanted: as within_reach returns them, strokes to paint and what each
    should become; are_sides_painted: along what a stroke of the brush's greatest width leaves of a wider one, too,
    where that makes most of such strokes as wide as they were drawn.
    """
    corner_mm2 = _CORNER * brush.half_width_range_mm()[1] ** 2

    def least(shape: list[np.ndarray]) -> float:
        """The share of a shape from which on its pieces count."""
        share = max(_CORNER_SHARE, corner_mm2 / _core.area(shape))
        return min(share, MISSED_SHARE) if are_corners_filled else MISSED_SHARE

    with_blanks = elements_with_blanks(drawn, painted, brush, lambda shape: _BY_DISCS * least(shape))
    every = [
        each
        for element in with_blanks
        for each in _limbs(element, drawn, painted, brush, least, are_sides_painted)
    ]
    sides_mm2 = sum(each.won_mm2 for each in every if each.is_side)
    if sides_mm2 < _SIDES * _sides_mm2(drawn, painted, brush):
        every = [each for each in every if not each.is_side]
    for element in with_blanks:
        limbs = [each for each in every if each.stroke.origin.element == element]
        if limbs:
            meant = [each.stroke.replaced(wanted_mm=each.own_mm) for each in limbs]
            limbs_mm = [ring for each in limbs for ring in each.piece.rings]
            wanted = [_without(stroke, element, limbs_mm) for stroke in wanted]
            painted = _behind([each.stroke for each in limbs], painted)
            drawn, wanted = _behind(meant, drawn), _behind(meant, wanted)
    return drawn, painted, wanted, {each.piece.element for each in every if each.piece.is_rim}


def _sides_mm2(drawn: list, painted: list, brush) -> float:
    """Area of what strokes of the brush's greatest width leave of those that were found wider, by more than is seen."""
    greatest, area_mm2 = brush.half_width_range_mm()[1], 0.0
    in_passes = {stroke.origin.element for stroke in painted if not stroke.wanted_mm}
    for stroke in drawn:
        at, half_mm = np.array(stroke.half_width).T
        if not stroke.wanted_mm or stroke.origin.element in in_passes or half_mm.max() < greatest + SEEN_MM:
            continue
        length_mm = _core.flatten(stroke, 0.1)[-1, 2]
        beyond_mm = np.interp(np.linspace(0, 1, 200), at, half_mm) - greatest
        area_mm2 += 2 * length_mm * float(np.mean(np.where(beyond_mm > SEEN_MM, beyond_mm, 0.0)))
    return area_mm2


def _behind(limbs: list, strokes: list) -> list:
    last = max(k for k, each in enumerate(strokes) if each.origin.element == limbs[0].origin.element)
    return [*strokes[: last + 1], *limbs, *strokes[last + 1 :]]


def _without(stroke, element: str, limbs_mm: list[np.ndarray]):
    """A stroke of the element, no longer asked for what its limbs paint."""
    if stroke.origin.element != element or not _core.intersect(stroke.wanted_mm, limbs_mm):
        return stroke
    import shapely

    from .swept_areas import region, rings_of

    left = shapely.difference(region(stroke.wanted_mm), region(limbs_mm))
    return stroke.replaced(wanted_mm=rings_of(left)) if left.area > 0 else stroke


def _limbs(element: str, drawn: list, painted: list, brush, least, are_sides_painted: bool) -> list[_Limb]:
    """Strokes into the blank pieces of an element from the least share on, each as often as its others are painted."""
    every = [stroke for stroke in painted if stroke.origin.element == element]
    own = [stroke for stroke in every if stroke.origin.repeat == 1]
    if not own:
        return []  # the brush is too small for it, which was refused
    found = [stroke for stroke in drawn if stroke.origin.element == element]
    shape = _core.unite([ring for stroke in found for ring in stroke.wanted_mm])
    share = least(shape)
    try:
        marks = trial_marks(own, brush)
    except Error:
        return []  # which is told when the plan is made
    if not may_miss(shape, marks, brush, share):
        return []
    mark, wanted = outline_of(marks, brush), Wanted(shape)
    paint = wanted.painted(marks.passes, brush)
    limbs: list[_Limb] = []
    refused: list[Blank] = []
    while len(limbs) + len(refused) < _MOST:
        known = [*mark, *(ring for piece in refused for ring in piece.rings)]
        piece = next(iter(blank_of_mark(element, shape, known, brush, share)), None)
        if piece is None:
            break
        hosts = [*own, *(each.stroke for each in limbs)]
        ways = _into(piece, hosts, shape, brush)
        (piece,) = told_rims([piece], found)
        if are_sides_painted or not piece.is_rim:
            ways += _along_edges(piece, hosts, shape, brush)
        best = _best(ways, piece, mark, paint, wanted, brush)
        if best is None:
            refused.append(piece)
            continue
        limb, own_mm, mark, won_mm2 = best
        paint = np.maximum(paint, wanted.painted(trial_marks([limb], brush).passes, brush))
        meant = _core.unite([*_core.intersect(own_mm, shape), *piece.rings])
        limbs.append(_Limb(limb, meant, piece, won_mm2))
    repeats = sorted({stroke.origin.repeat for stroke in every})
    return [
        replace(each, stroke=each.stroke.replaced(id=_core.StrokeId(element, of.part, repeat, of.lane)))
        for each in limbs
        for of in (each.stroke.origin,)
        for repeat in repeats
    ]


def _best(ways: list, piece: Blank, mark: list, paint: np.ndarray, wanted: Wanted, brush) -> tuple | None:
    """The stroke that paints most of a piece and turns the mark's outline least, its own mark, and both, and what it
    wins [mm2]; None where none is worth it. Of a piece that were lost without, however much it turns.

    paint: the mark in the pixels of wanted, the shape.
    """
    area_mm2 = _core.area(piece.rings)
    won = [_won_mm2(limb, paint, wanted, brush) for limb in ways]
    likely = [k for k in np.argsort(won)[::-1][:_LOOKED_AT] if won[k] > _WORTH * area_mm2]
    turned = _core.excess_turning(mark, wanted.rings) if likely else 0.0
    is_lost = piece.share > MISSED_SHARE
    found, most_mm2 = None, -np.inf
    for k in likely:
        own_mm = trial_mark([ways[k]], brush)
        both_mm = _core.unite([*mark, *own_mm])
        more = max(_core.excess_turning(both_mm, wanted.rings) - turned, 0.0)
        counted_mm2 = won[k] - _TURN * area_mm2 * more
        if counted_mm2 > most_mm2 and (is_lost or counted_mm2 > _WORTH * area_mm2):
            found, most_mm2 = (ways[k], own_mm, both_mm, won[k]), counted_mm2
    return found


def _won_mm2(limb, paint: np.ndarray, wanted: Wanted, brush) -> float:
    """What a stroke paints of the shape less what it paints beside it, beyond the mark, bulges counted more."""
    where = wanted.pixels_about(
        np.reshape(limb.middle_mm, (-1, 2)), _BESIDE * max(half for _, half in limb.half_width)
    )
    here, before = wanted.only(where), paint[where]
    painted = painted_by(limb, here, brush)
    if painted is None:
        return 0.0
    both = np.maximum(before, painted)
    more = _BULGE * (here.bulge_mm2(both) - here.bulge_mm2(before))
    return here.misplaced_mm2(before) - here.misplaced_mm2(both) - more


def _into(piece: Blank, own: list, shape: list[np.ndarray], brush) -> list:
    """Straight strokes into a piece."""
    ways = (_limb_towards(place, piece, own, shape, brush) for place in _places(piece, own))
    return [limb for limb in ways if limb is not None]


def _along_edges(piece: Blank, own: list, shape: list[np.ndarray], brush) -> list:
    """Strokes along the edges of the shape that a piece lies beside, each so wide that it may cover the piece."""
    import shapely

    from .along_edges import EVEN_MM, lines_along, runs_of, sides_of
    from .swept_areas import region

    area = region(shape)
    edge = area.boundary
    places = shapely.get_coordinates(shapely.segmentize(region(piece.rings).boundary, EVEN_MM))
    beside = shapely.distance(_middle_lines(own), shapely.Point(piece.at_mm))
    host = own[int(beside.argmin())]
    least, greatest = brush.half_width_range_mm()
    limbs = []
    for side in sides_of(places, runs_of(area)[0]):
        if side.share < _ON_EDGE:
            continue
        for width in sorted({_OF_DEPTH * side.deep_mm, *(share * greatest for share in _WIDTHS)}):
            if least <= width <= greatest and side.deep_mm < 2 * width:
                limbs += [
                    _limb(line.middle_mm, line.half_width, host, piece, own, shape)
                    for line in lines_along(side, width, edge)
                ]
    return limbs


def _places(piece: Blank, own: list) -> list[np.ndarray]:
    """Where a stroke may lead: to the middle of a piece, and to where it sticks out farthest."""
    import shapely

    points = np.vstack(piece.rings)
    away = shapely.distance(shapely.multilinestrings(_middle_lines(own)), shapely.points(points))
    return [np.array(piece.at_mm), points[away.argmax()]]


def _middle_lines(strokes: list) -> np.ndarray:
    import shapely

    lines = [_core.flatten(stroke, 0.1)[:, :2] for stroke in strokes]  # of a dot one place
    return np.array([shapely.linestrings(np.vstack([line[:1], line])) for line in lines])


def _limb_towards(place: np.ndarray, piece: Blank, own: list, shape: list[np.ndarray], brush):
    """A stroke from the nearest place on a middle line through a place in a piece, as wide as the shape has room beside
    it; None where it has none."""
    import shapely

    from .swept_areas import region

    lines, there = _middle_lines(own), shapely.Point(place)
    host = int(shapely.distance(lines, there).argmin())
    nearest = shapely.line_interpolate_point(lines[host], shapely.line_locate_point(lines[host], there))
    root = shapely.get_coordinates(nearest)[0]
    onward = place - root
    to_place = float(np.hypot(*onward))
    if to_place < _EVEN_MM:
        return None  # a stroke runs there, and its mark leaves it
    greatest = brush.half_width_range_mm()[1]
    at = np.arange(0.0, to_place + 4 * greatest, _EVEN_MM)
    places = root + at[:, None] * onward / to_place
    points = shapely.points(places)
    area = region(shape)
    halves = np.where(shapely.intersects(area, points), shapely.distance(area.boundary, points), 0.0)
    is_out = at > np.hypot(*(np.array(piece.at_mm) - root))
    reach_mm = ((np.vstack(piece.rings) - root) @ onward).max() / to_place  # beyond, others have painted
    is_end = (halves <= finest(brush)) | (is_out & (np.gradient(halves, at) < _ROUND))
    is_end |= is_out & (at + halves > reach_mm)
    count = int(is_end.argmax()) if is_end.any() else len(at)
    if count < 3:
        return None
    line = np.column_stack([places, np.minimum(halves, greatest)])[:count]
    cubics, half_width = _core.fit_curve(line, _SMOOTHED * float(line[:, 2].mean()), False)
    return _limb(cubics, half_width, own[host], piece, own, shape)


def _limb(middle_mm, half_width, like, piece: Blank, own: list, shape: list[np.ndarray]):
    """A stroke into a piece, called as the one that it is like, with a lane of its own."""
    of = like.origin
    lanes = [each.origin.lane for each in own if each.origin.part == of.part]
    limb = like.replaced(
        id=_core.StrokeId(of.element, of.part, 1, max(lanes) + 1),
        middle_mm=middle_mm,
        closed=False,
        half_width=half_width,
        wanted_mm=[],
        settings=like.settings.replaced(start="exposed"),  # on what is painted already
    )
    swept = _core.wanted_outline(limb, _SWEPT_MM)
    return limb.replaced(wanted_mm=_core.unite([*_core.intersect(swept, shape), *piece.rings]))
