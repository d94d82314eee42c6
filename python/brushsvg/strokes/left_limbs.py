"""Limbs of filled shapes too small beside their stem to be found as strokes, as the flag of a bold i: where marks leave
one blank, a short straight stroke runs out into it from the middle of the stroke beside it."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..errors import Error
from .trial_mark import outline_of, trial_mark, trial_marks
from .unreached import MISSED_SHARE, Blank, blank_of_mark, elements_with_blanks, finest, may_miss

# What of a shape a corner is at least that one sees, and in squares of the brush's greatest half width: smaller ones in
# each stroke of a character would take a third more strokes. What discs leave where a mark leaves as much as that.
_CORNER_SHARE, _CORNER, _BY_DISCS = 0.005, 0.2, 0.4
# Of a blank piece, what its stroke paints of the shape less what it paints beside it: else it is not worth its poses.
_WORTH = 0.4
# By how many full turns the outline of a mark may turn more for a piece that is a smaller share of its shape: a stroke
# into a knob along its stem makes a blob, which the eye minds more.
_CALM = (0.03, 0.7), (0.06, 0.9)
_MOST = 4  # strokes added to an element: a logo of one path may have many limbs
_ROUND = -0.85  # half width won per length where a limb ends round or square: there its line ends
_EVEN_MM = 0.1
_SMOOTHED = 0.03  # of the half width, as middle lines of shapes
_SWEPT_MM = 0.02


def with_left_limbs(
    drawn: list, painted: list, wanted: list, brush, are_corners_filled: bool
) -> tuple[list, list, list]:
    """All three lists, with a stroke more for each large blank piece that one paints: of more than 3 % of its shape, or
    0.5 % where corners are filled too and the brush is not too large for that. It comes behind those of its element,
    and is called as the stroke that it leaves, with a lane of its own.

    drawn: strokes as they were found; painted, wanted: as within_reach returns them, strokes to paint and what each
    should become.
    """
    corner_mm2 = _CORNER * brush.half_width_range_mm()[1] ** 2

    def least(shape: list[np.ndarray]) -> float:
        """The share of a shape from which on its pieces count."""
        share = max(_CORNER_SHARE, corner_mm2 / _core.area(shape))
        return min(share, MISSED_SHARE) if are_corners_filled else MISSED_SHARE

    for element in elements_with_blanks(drawn, painted, brush, lambda shape: _BY_DISCS * least(shape)):
        limbs = _limbs(element, drawn, painted, brush, least)
        if limbs:
            meant = [limb.replaced(wanted_mm=own_mm) for limb, own_mm, _ in limbs]
            limbs_mm = [ring for _, _, blank_mm in limbs for ring in blank_mm]
            wanted = [_without(stroke, element, limbs_mm) for stroke in wanted]
            painted = _behind([limb for limb, _, _ in limbs], painted)
            drawn, wanted = _behind(meant, drawn), _behind(meant, wanted)
    return drawn, painted, wanted


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


def _limbs(element: str, drawn: list, painted: list, brush, least) -> list:
    """Strokes into the blank pieces of an element from the least share on, each as often as its others are painted,
    with the rings of what it paints of the shape, its piece with it, and of the piece."""
    every = [stroke for stroke in painted if stroke.origin.element == element]
    own = [stroke for stroke in every if stroke.origin.repeat == 1]
    if not own:
        return []  # the brush is too small for it, which was refused
    shape = _core.unite(
        [ring for stroke in drawn if stroke.origin.element == element for ring in stroke.wanted_mm]
    )
    share = least(shape)
    try:
        marks = trial_marks(own, brush)
    except Error:
        return []  # which is told when the plan is made
    if not may_miss(shape, marks, brush, share):
        return []
    mark = outline_of(marks, brush)
    limbs: list = []
    refused: list[Blank] = []
    while len(limbs) + len(refused) < _MOST:
        known = [*mark, *(ring for piece in refused for ring in piece.rings)]
        piece = next(iter(blank_of_mark(element, shape, known, brush, share)), None)
        if piece is None:
            break
        ways = [
            _limb_towards(place, piece, [*own, *(each for each, _, _ in limbs)], shape, brush)
            for place in _places(piece, own)
        ]
        tried = [(_won(mark, limb, shape, brush), limb) for limb in ways if limb is not None]
        area_mm2 = _core.area(piece.rings)
        if calm := [turns for share, turns in _CALM if piece.share < share]:
            most = _core.excess_turning(mark, shape) + calm[0]
            tried = [each for each in tried if _core.excess_turning(each[0][2], shape) < most]
        nothing = (0.0, [], mark), None
        (won_mm2, own_mm, both_mm), limb = max(tried, key=lambda each: each[0][0], default=nothing)
        if won_mm2 > _WORTH * area_mm2:
            inside = _core.intersect(own_mm, shape)
            limbs.append((limb, _core.unite([*inside, *piece.rings]), piece.rings))
            mark = both_mm
        else:
            refused.append(piece)
    repeats = sorted({stroke.origin.repeat for stroke in every})
    return [
        (limb.replaced(id=_core.StrokeId(element, limb.origin.part, repeat, limb.origin.lane)), *rings)
        for limb, *rings in limbs
        for repeat in repeats
    ]


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


def _won(mark: list, limb, shape: list[np.ndarray], brush) -> tuple[float, list, list]:
    """What a limb paints of the shape less what it paints beside it, beyond the mark [mm2]; its own mark, and both."""
    try:
        own_mm = trial_mark([limb], brush)
    except Error:
        return 0.0, [], mark
    both = _core.unite([*mark, *own_mm])
    more = _core.area(both) - _core.area(mark)
    inside = _core.area(_core.intersect(both, shape)) - _core.area(_core.intersect(mark, shape))
    return 2 * inside - more, own_mm, both


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
    is_end = (halves < finest(brush)) | (is_out & (np.gradient(halves, at) < _ROUND))
    is_end |= is_out & (at + halves > reach_mm)
    count = int(is_end.argmax()) if is_end.any() else len(at)
    if count < 3:
        return None
    line = np.column_stack([places, np.minimum(halves, greatest)])[:count]
    cubics, half_width = _core.fit_curve(line, _SMOOTHED * float(line[:, 2].mean()), False)
    like, of = own[host], own[host].origin
    lanes = [each.origin.lane for each in own if each.origin.part == of.part]
    limb = like.replaced(
        id=_core.StrokeId(of.element, of.part, 1, max(lanes) + 1),
        middle_mm=cubics,
        closed=False,
        half_width=half_width,
        wanted_mm=[],
        settings=like.settings.replaced(start="exposed"),  # on what is painted already
    )
    swept = _core.wanted_outline(limb, _SWEPT_MM)
    return limb.replaced(wanted_mm=_core.unite([*_core.intersect(swept, shape), *piece.rings]))
