"""Corners of strokes found in outlines, as of L and E: one line that turns there is as round outside as it is wide; a
line that ends square in the corner, and one that begins on what that painted, fill it."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np

from ..errors import need
from ..geometry.arc_length import knots, parameters_at
from ..geometry.cubics import split
from .corners import Line, drawn_line, line_stroke
from .trial_mark import Wanted, misplaced_mm2, trial_marks

# Turns of less are bends, of more a way back over what was painted. Beyond SHARP_RAD two legs lie side by side: a first
# one that runs square into the corner would stick out of the shape there, so the second begins square.
LEAST_RAD, SHARP_RAD, MOST_RAD = np.radians(40), np.radians(120), np.radians(150)
# In half widths: how far from its corner a line is as straight as its leg, and how long a leg is at least, in which
# a square end has room.
AWAY, FARTHER, CLOSE, LEG = 1.2, 2.4, 0.5, 2.0
STUB = 0.2  # and of how little of a leg its direction is known
# A first leg so much thinner than the second hides no pointed beginning of that; but a squared one its end.
THIN = 0.65
REACH = 5.0  # half widths of the wider leg: no corner lies farther on
LIKE, OFF = 0.25, 0.1  # of an outline, to be a leg's edge: its slope at most, and how far off, in half widths
ROOM = 0.95  # of a half width: edges are not quite straight
WORTH = 0.15  # two strokes for one, in squares of the half width: the outer corner of 90 degrees has 0.21
BULGES = 6.0  # how many times what sticks out of the shape counts more: the eye minds it more
HOPELESS = -0.25  # what legs along their axes lose more of is not won along edges (73 corners of characters)
PLAIN = 0.04  # beside that, what is won is plain in pixels: they are off by 0.013 at most (257 corners of characters)
# A bend in which a line becomes so many times as wide within so many of its half widths, as of a thin serif into its
# stem: a brush that is pressed there while it turns bulges out of the shape. Cut where the mark does so by so much, in
# squares of the half width, if at most half of that is left.
NECK, WITHIN, SWOLLEN, SWELLS = 2.0, 1.5, 0.02, 0.5
EVEN_MM = 0.1
HARDLY_WIDER = 1.05  # than the brush: what is wider yet may be painted in passes


def squared_at_corners(strokes: list, brush) -> list:
    """The strokes, those of outlines cut at each corner of 40 to 150 degrees, and where they widen in a bend and bulge
    out of the shape, where two marks lie nearer to it by 0.15 squares of the half width, in paint missing and too much.
    The parts of `id` are called id, id~2, id~3 ...; the later ones begin pointed, on what those before painted."""
    from .. import _core

    need(brush, _core.Brush, "a brush")
    widest: dict = defaultdict(float)
    for stroke in strokes:
        need(stroke, _core.Stroke, "a stroke")
        widest[stroke.origin.element] = max(
            [widest[stroke.origin.element], *(half for _, half in stroke.half_width)]
        )
    if not brush.width_follows_depth():
        return strokes
    greatest = brush.half_width_range_mm()[1]

    def may_be_filled(stroke) -> bool:
        own = max(half for _, half in stroke.half_width)
        return own > greatest and widest[stroke.origin.element] > HARDLY_WIDER * greatest

    return [
        part for stroke in strokes for part in ([stroke] if may_be_filled(stroke) else _parts(stroke, brush))
    ]


def _parts(stroke, brush) -> list:
    if not stroke.wanted_mm or stroke.closed:
        return [stroke]
    line = drawn_line(np.asarray(stroke.middle_mm).reshape(-1, 4, 2), stroke.half_width)
    length_mm = knots(line.cubics)[:, -1].sum()
    turning_mm = [
        line.at[k] * length_mm for k in range(1, len(line.cubics)) if LEAST_RAD < line.turn_rad(k) < MOST_RAD
    ]
    necks = _necks(line, length_mm, turning_mm)
    spots_mm = sorted([*turning_mm, *necks])
    ends_mm = [0.0, *spots_mm, length_mm]
    last = len(spots_mm) - 1
    ways = [
        [
            way
            for away in (CLOSE, AWAY, FARTHER)
            if (way := _corner(line, *ends, away, (k > 0, k < last), necks.get(ends[1])))
        ]
        for k, ends in enumerate(zip(ends_mm, ends_mm[1:], ends_mm[2:], strict=False))
    ]
    if not any(ways):
        return [stroke]
    wanted = Wanted(stroke.wanted_mm)
    better: list[_Corner] = []
    best = _seen([stroke], wanted, brush)
    for corners in filter(None, ways):
        is_neck = corners[0].at_mm in necks
        if is_neck and best.bulge_mm2 < SWOLLEN * max(corners[0].legs_mm) ** 2:
            continue

        def won(corner: _Corner, than: _Seen = best, is_neck=is_neck) -> tuple[float, _Corner, _Seen]:
            parts = _cut(stroke, line, [*better, corner])
            if not parts:
                return 0.0, corner, than
            seen = _seen(parts, wanted, brush)
            if is_neck and seen.bulge_mm2 > SWELLS * than.bulge_mm2:
                return 0.0, corner, than
            return _won(than, seen, stroke.wanted_mm, brush, max(corner.legs_mm)), corner, seen

        along_axes = [won(each) for each in corners]
        if max(each[0] for each in along_axes) < HOPELESS:
            continue
        tried = [
            each for first in along_axes for each in (first, *map(won, _on_edges(stroke, line, first[1])))
        ]
        highest = max(each[0] for each in tried)
        most = next(each for each in tried if each[0] >= highest - PLAIN)  # what is tried first strays least
        squared = won(replace(most[1], begins="auto")) if most[0] > 0 else most
        if squared[0] > most[0] + PLAIN:
            most = squared
        if most[0] > WORTH:
            better.append(most[1])
            best = most[2]
    return _cut(stroke, line, better) or [stroke] if better else [stroke]


def _necks(line: Line, length_mm: float, corners_mm: list[float]) -> dict[float, float]:
    """Arc lengths at which a line that bends there becomes NECK times as wide or thin, none beside its corners, and
    half the width of its wide part."""
    at_mm = np.arange(0.0, length_mm, EVEN_MM)
    if len(at_mm) < 3:
        return {}
    half = np.interp(at_mm / length_mm, *np.array(line.half_width).T)
    if half.max() < NECK * half.min():
        return {}
    slope = np.abs(np.gradient(half, at_mm))
    found: dict[float, float] = {}
    for side in (-1, 1):
        reach_mm = at_mm + side * WITHIN * half
        (wide,) = np.nonzero(NECK * np.interp(reach_mm, at_mm, half) < half)
        for run in np.split(wide, np.flatnonzero(np.diff(wide) > 1) + 1) if len(wide) else []:
            first, last = sorted((reach_mm[run[0 if side < 0 else -1]], at_mm[run[-1 if side < 0 else 0]]))
            rises = (at_mm >= first) & (at_mm <= last)
            spot, widest = float(at_mm[rises][slope[rises].argmax()]), float(half[run].max())
            beside_mm = np.clip([spot - widest, spot + widest], EVEN_MM, length_mm - EVEN_MM)
            (_, before), (_, after) = (_at(line, each) for each in beside_mm)
            is_free = all(abs(each - spot) > WITHIN * widest for each in [*corners_mm, *found])
            if is_free and before @ after < np.cos(LEAST_RAD):
                found[spot] = widest
    return found


@dataclass(frozen=True)
class _Seen:
    """A mark, and how much of it is out of place and bulges out of its shape, in pixels [mm2]."""

    marks: object
    misplaced_mm2: float
    bulge_mm2: float


def _seen(parts: list, wanted: Wanted, brush) -> _Seen:
    marks = trial_marks([_paintable(part, brush) for part in parts], brush)
    painted = wanted.painted(marks.passes, brush)
    return _Seen(marks, wanted.misplaced_mm2(painted), wanted.bulge_mm2(painted))


def _won(whole: _Seen, cut: _Seen, wanted_mm: list, brush, half_mm: float) -> float:
    """What a mark of parts is nearer to a shape than one of the whole, in squares of the half width; less what it
    bulges out of it more."""
    more = BULGES * (cut.bulge_mm2 - whole.bulge_mm2)
    won = (whole.misplaced_mm2 - cut.misplaced_mm2 - more) / half_mm**2
    if abs(won - WORTH) > PLAIN:
        return won
    exactly = misplaced_mm2(whole.marks, wanted_mm, brush) - misplaced_mm2(cut.marks, wanted_mm, brush)
    return (exactly - more) / half_mm**2


@dataclass(frozen=True)
class _Corner:
    """Arc lengths of a corner, and before and after it, where the line is as straight as its legs; half their widths
    there; how the leg after it begins, where the one before hides that; whether either leg runs on along the outline's
    edge, and not along its axis."""

    at_mm: float
    away_mm: tuple[float, float]
    legs_mm: tuple[float, float]
    begins: str = "exposed"
    on_edge: tuple[bool, bool] = (False, False)

    def ways_on_edge(self) -> list[tuple[bool, bool]]:
        """On that of the thinner leg, whose axis bends all along where it is short, and on both."""
        thinner = self.legs_mm[0] < self.legs_mm[1]
        return [(thinner, not thinner), (True, True)]


def _corner(
    line: Line,
    before_mm: float,
    at_mm: float,
    after_mm: float,
    away: float,
    are_shared: tuple[bool, bool],
    half_mm: float | None,
) -> _Corner | None:
    """A corner, half so wide, or as the line is there, with its legs, up to the next ones, straight from so many half
    widths beside it on, of a leg that is shared with the next corner no farther than its middle; none where one of them
    has no room."""
    lengths = at_mm - before_mm, after_mm - at_mm
    whole_mm = knots(line.cubics)[:, -1].sum()
    here = half_mm or _halves(line, at_mm / whole_mm)[0]
    looked_at = [min(LEG * here, length_mm / 2) for length_mm in lengths]
    legs = _halves(line, (at_mm - looked_at[0]) / whole_mm, (at_mm + looked_at[1]) / whole_mm)
    away_mm = []
    for length_mm, half, other, is_shared in zip(lengths, legs, legs[::-1], are_shared, strict=True):
        if length_mm < LEG * half:
            return None
        # the thinner one bends towards a corner as far from it as the other is wide
        away_mm.append(min(away * max(here, other), (length_mm - STUB * half) / (1 + is_shared)))
    return _Corner(at_mm, (at_mm - away_mm[0], at_mm + away_mm[1]), (legs[0], legs[1]))


def _paintable(stroke, brush):
    from .offset_passes import clamped

    return stroke.replaced(half_width=clamped(stroke, *brush.half_width_range_mm()).half_width)


def _cut(stroke, line: Line, corners: list[_Corner]) -> list:
    """The stroke in parts, cut at corners; empty where its shape does not fall into two at each."""
    import shapely

    from .swept_areas import region

    length_mm = knots(line.cubics)[:, -1].sum()
    legs, left, tip = [], region(stroke.wanted_mm), None
    begin_mm, begun = 0.0, ""
    for each in corners:
        halves = _halves(line, *(beside_mm / length_mm for beside_mm in each.away_mm))
        first, second = _beside(stroke, line, each, halves)
        corner = _meet(first, second)
        if corner is None:
            return []
        sides = _sides(left, corner, first, second, halves, line, (begin_mm, each.at_mm, length_mm))
        if sides is None:
            return []
        done, left, shared = sides
        is_sharp = first[1] @ second[1] < np.cos(SHARP_RAD)
        shape, reach_mm = region(stroke.wanted_mm), REACH * max(halves)
        end = (_room if is_sharp else _end)(shape, first, halves[0], reach_mm)
        start = _end(shape, (second[0], -second[1]), halves[1], reach_mm)
        if end is None or start is None:
            return []
        hides_none = is_sharp or halves[0] < THIN * halves[1]
        ways = begun, "lifted" if hides_none else ""
        legs.append((begin_mm, each.away_mm[0], tip, end, shapely.union(done, shared), ways))
        left, tip, begin_mm = shapely.union(left, shared), start, each.away_mm[1]
        begun = "auto" if hides_none else each.begins
    legs.append((begin_mm, length_mm, tip, None, left, (begun, "")))
    return [_leg(stroke, line, number, *leg) for number, leg in enumerate(legs, start=1)]


def _on_edges(stroke, line: Line, corner: _Corner) -> list[_Corner]:
    """The corner with legs that run along the outline's edge, where that differs from their axis."""
    halves = _halves(line, *(beside_mm / knots(line.cubics)[:, -1].sum() for beside_mm in corner.away_mm))
    known, found = [np.vstack(_beside(stroke, line, corner, halves))], []
    for on_edge in corner.ways_on_edge():
        moved = replace(corner, on_edge=on_edge)
        legs = np.vstack(_beside(stroke, line, moved, halves))
        if not any(np.array_equal(legs, each) for each in known):
            known.append(legs)
            found.append(moved)
    return found


def _beside(stroke, line: Line, corner: _Corner, halves: list[float]) -> tuple:
    """Place and direction of the leg before a corner, and of the one after it; half their widths there are given."""
    first, second = (_at(line, beside_mm) for beside_mm in corner.away_mm)
    outside = np.sign(second[1][0] * first[1][1] - second[1][1] * first[1][0])
    return tuple(
        _along_edge(*leg, half, outside, stroke.wanted_mm) if is_on_edge else leg
        for leg, half, is_on_edge in zip((first, second), halves, corner.on_edge, strict=True)
    )


def _halves(line: Line, *fractions: float) -> list[float]:
    return [float(np.interp(at, *np.array(line.half_width).T)) for at in fractions]


def _at(line: Line, at_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Place and direction at an arc length."""
    known = knots(line.cubics)
    (cubic,), (t,) = parameters_at(line.cubics, known, np.array([at_mm]))
    p = line.cubics[cubic]
    first, second = split(p, float(t))
    step = second[1] - second[0] if t < 0.5 else first[3] - first[2]
    return second[0], step / np.hypot(*step)


def _along_edge(at_mm, along, half_mm: float, side: float, rings: list) -> tuple[np.ndarray, np.ndarray]:
    """The same place, and the direction of the outline on that side of it, left being 1, where that differs little: the
    axis of a short leg bends all along."""
    from .. import _core

    left = side * np.array([-along[1], along[0]])
    ways_mm = np.array([-0.5, 0.5]) * half_mm
    places = at_mm + ways_mm[:, None] * along
    before_mm, after_mm = _core.first_crossings(rings, places, np.tile(left, (2, 1)))
    slope = (after_mm - before_mm) / half_mm
    if not abs(slope) < LIKE or abs(before_mm + after_mm - 2 * half_mm) > 2 * OFF * half_mm:
        return at_mm, along
    way = along + slope * left
    return at_mm, way / np.hypot(*way)


def _meet(first, second) -> np.ndarray | None:
    """Where a straight line on from one place meets one back from another."""
    (a, along), (b, onward) = first, second
    cross = along[0] * onward[1] - along[1] * onward[0]
    if abs(cross) < 0.5:
        return None
    off = b - a
    return a + along * (off[0] * onward[1] - off[1] * onward[0]) / cross


def _swept(line: Line, from_mm: float, to_mm: float):
    """What discs as wide as the line cover between two arc lengths."""
    from .. import _core
    from .swept_areas import region

    return region(_core.wanted_outline(line_stroke(Line(*line.stretch(from_mm, to_mm))), 0.01))


def _sides(shape, corner, first, second, halves, line: Line, at_mm: tuple[float, float, float]):
    """A shape cut from its inner to its outer corner: what lies before, what after, and what both legs have. Where the
    second leg runs back to the first, as of P, the cut leaves one piece: that is shared out by what the legs cover.

    first, second: places and directions beside the corner; at_mm: where the line's leg before begins, the corner lies,
    the leg after ends."""
    import shapely
    import shapely.ops

    (before, along), (_, onward) = first, second
    half = max(halves)
    inwards = (onward - along) / np.hypot(*(onward - along))
    knife = shapely.LineString([corner - 2.2 * half * inwards, corner + 2.2 * half * inwards])
    parts = shapely.get_parts(shapely.ops.split(shape, knife)) if shape.geom_type == "Polygon" else []
    if len(parts) == 1:
        begin_mm, corner_mm, end_mm = at_mm
        legs = _shared_out(shape, _swept(line, begin_mm, corner_mm), _swept(line, corner_mm, end_mm))
    elif len(parts) == 2:
        legs = sorted(parts, key=lambda part: shapely.distance(part, shapely.Point(before)))
    else:
        return None
    sine = abs(along[0] * onward[1] - along[1] * onward[0])
    a, b = 1.05 * halves[1] / sine * along, 1.05 * halves[0] / sine * onward
    both = shapely.intersection(
        shape, shapely.Polygon([corner + a + b, corner + a - b, corner - a - b, corner - a + b])
    )
    return *legs, both


def _shared_out(shape, before, after) -> list:
    """What of a shape goes with the leg before, and what with the one after; they cover what is told of them."""
    import shapely

    rest = shapely.difference(shape, before)
    ours = [part for part in shapely.get_parts(rest) if shapely.area(shapely.intersection(part, after)) > 0]
    second = shapely.union_all(ours)
    return [shapely.difference(shape, second), second]


def _end(shape, place, half_mm: float, reach_mm: float) -> np.ndarray | None:
    """Where a line that goes straight on from a place ends, half a width before the shape does."""
    import shapely

    at, along = place
    ray = shapely.LineString([at, at + 1.2 * reach_mm * along])
    inside = shapely.get_parts(shapely.intersection(ray, shape))
    near = [part for part in inside if shapely.distance(part, shapely.Point(at)) < 1e-6]
    if not near or not half_mm < near[0].length < reach_mm:
        return None
    return at + (near[0].length - half_mm) * along


def _room(shape, place, half_mm: float, reach_mm: float) -> np.ndarray | None:
    """The last place straight on from one at which the shape has room for a disc nearly as wide as the line."""
    import shapely

    at, along = place
    ways = at + np.linspace(0, reach_mm, 101)[:, None] * along
    rooms = shapely.distance(shape.boundary, shapely.points(ways))
    count = int(np.logical_and.accumulate(rooms >= ROOM * half_mm).sum())
    return ways[count - 1] if count > 1 else None


def _leg(stroke, line: Line, lane: int, from_mm: float, to_mm: float, tip, end, shape, ways: tuple[str, str]):
    from .swept_areas import rings_of

    cubics, halves = line.stretch(from_mm, to_mm)
    length_mm = knots(cubics)[:, -1].sum()
    knots_mm = [(at * length_mm, half) for at, half in halves]
    if tip is not None:
        cubics = np.concatenate([[np.linspace(tip, cubics[0, 0], 4)], cubics])
        on = np.hypot(*(tip - cubics[0, 3]))
        knots_mm = [(0.0, knots_mm[0][1]), *((on + at, half) for at, half in knots_mm)]
        length_mm += on
    if end is not None:
        on = np.hypot(*(end - cubics[-1, 3]))
        cubics = np.concatenate([cubics, [np.linspace(cubics[-1, 3], end, 4)]])
        length_mm += on
        knots_mm = [*knots_mm, (length_mm, knots_mm[-1][1])]
    made = line_stroke(Line(cubics, [(at / length_mm, half) for at, half in knots_mm]), stroke, lane)
    made.wanted_mm = rings_of(shape)
    begun, ended = ways
    if begun and made.settings.start in (None, "auto"):
        made.settings = made.settings.replaced(start=begun)
    if ended and made.settings.end in (None, "auto"):
        made.settings = made.settings.replaced(end=ended)
    return made
