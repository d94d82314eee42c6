"""Corners of drawn lines.

Closed lines do not begin at corners. A brush that would leave a blot where it turns in place is lifted there.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .. import _core
from ..errors import Error, require_type
from ..geometry.arc_length import knots, parameters_at
from ..geometry.cubics import split

_MIN_CORNER_RAD = np.radians(20)
_MIN_SHARP_CORNER_RAD = np.radians(100)  # a turn by less leaves no blot that one sees
_MAX_SIMILAR_RAD = np.radians(5)
# How far control points of a straight side are off it, as a share of its length.
_MAX_SIDE_DEVIATION = 0.001
_MIN_LIFT_GAIN = 0.05  # misplaced paint that a lift must remove, in squares of the width


@dataclass(frozen=True)
class Line:
    """A line of cubics.

    cubics: (n, 4, 2), none without length; half_width: [(fraction of arc length, mm)].
    """

    cubics: np.ndarray
    half_width: list

    @property
    def at(self) -> np.ndarray:
        """The fractions of arc length at which the cubics begin, and 1."""
        lengths = knots(self.cubics)[:, -1]
        return np.append(np.cumsum(lengths) - lengths, lengths.sum()) / lengths.sum()

    def between(self, first: int, last: int) -> Line:
        """Return the part from the beginning of one cubic to the beginning of another."""
        begin, end = self.at[first], self.at[last]
        fractions, halves = np.array(self.half_width).T
        inside = (fractions > begin) & (fractions < end)
        at = np.concatenate([[begin], fractions[inside], [end]])
        cut = np.column_stack([(at - begin) / (end - begin), np.interp(at, fractions, halves)])
        widths = cut if np.ptp(cut[:, 1]) else cut[:1]
        return Line(self.cubics[first:last], [tuple(knot) for knot in widths.tolist()])

    def begun_at(self, first: int) -> Line:
        """Return a closed line that begins where a cubic begins."""
        head, tail = self.between(0, first), self.between(first, len(self.cubics))
        at = 1 - self.at[first]
        widths = [(f * at, half) for f, half in tail.half_width]
        widths += [(at + f * (1 - at), half) for f, half in head.half_width[1:]]
        return Line(np.concatenate([tail.cubics, head.cubics]), widths)

    def stretch(self, from_mm: float, to_mm: float) -> tuple[np.ndarray, list]:
        """Return cubics and half widths between two arc lengths."""
        known = knots(self.cubics)
        length_mm = known[:, -1].sum()
        (first, last), (t0, t1) = parameters_at(self.cubics, known, np.array([from_mm, to_mm]))
        cubics = self.cubics[first : last + 1].copy()
        cubics[-1] = split(cubics[-1], float(t1))[0]
        rest = t0 / t1 if first == last else t0
        cubics[0] = split(cubics[0], float(rest))[1]
        fractions, halves = np.array(self.half_width).T
        at_mm = fractions * length_mm
        inside = at_mm[(at_mm > from_mm) & (at_mm < to_mm)]
        at = np.concatenate([[from_mm], inside, [to_mm]])
        cut = np.column_stack([(at - from_mm) / (to_mm - from_mm), np.interp(at, at_mm, halves)])
        return cubics, [tuple(knot) for knot in cut.tolist()]

    def turn_rad(self, joint: int) -> float:
        """Return how far the line turns where a cubic begins; at 0, if it is closed."""
        back, onward = _tangent(self.cubics[joint - 1][::-1]), _tangent(self.cubics[joint])
        return abs(np.arctan2(back[1] * onward[0] - back[0] * onward[1], -(back @ onward)))


def begin_amid_side(cubics: np.ndarray, half_width: list) -> tuple[np.ndarray, list]:
    """Begin a closed line in the middle of its longest straight side.

    cubics: (n, 4, 2); half_width: [(fraction, mm)]. The line is returned unchanged if it does not begin at a
    corner, or has no straight side. A mark begins pointed, which shows at a corner.
    """
    line = drawn_line(cubics, half_width)
    sides = [k for k in range(len(line.cubics)) if _is_straight(line.cubics[k])]
    if not sides or line.turn_rad(0) < _MIN_CORNER_RAD:
        return cubics, half_width
    longest = max(sides, key=lambda k: round(line.at[k + 1] - line.at[k], 6))
    before, after = line.cubics[:longest], line.cubics[longest + 1 :]
    whole = Line(np.concatenate([before, split(line.cubics[longest], 0.5), after]), half_width)
    begun = whole.begun_at(longest + 1)
    return begun.cubics, begun.half_width


def lifted_at_corners(strokes: list[_core.Stroke], brush: _core.Brush) -> list[_core.Stroke]:
    """Return the strokes, with drawn lines cut where the brush has to be lifted.

    A line is cut at each sharp corner where two marks are nearer to the target than one mark with a turn in place:
    the area of missing and surplus paint is less by 0.05 squares of the width. The parts of stroke `id` are called
    id, id~2, id~3 ... A closed line then begins at such a corner.
    """
    require_type(brush, _core.Brush, "a brush")
    for stroke in strokes:
        require_type(stroke, _core.Stroke, "a stroke")
    return [part for stroke in strokes for part in _cut_at_corners(stroke, brush)]


def _cut_at_corners(stroke, brush) -> list:
    if stroke.target_mm or len(stroke.middle_mm) < 2 or not stroke.half_width:
        return [stroke]
    line = drawn_line(np.asarray(stroke.middle_mm).reshape(-1, 4, 2), stroke.half_width)
    if not len(line.cubics):
        return [stroke]
    sharp = [k for k in range(1, len(line.cubics)) if line.turn_rad(k) > _MIN_SHARP_CORNER_RAD]
    if not sharp:
        return [stroke]
    ends = [0, *sharp, len(line.cubics)]
    at_mm = line.at * knots(line.cubics)[:, -1].sum()
    width_mm = 2 * max(half for _, half in line.half_width)
    neighbours = [
        (before, at, after)
        for before, at, after in zip(ends, ends[1:], ends[2:], strict=False)
        if min(at_mm[at] - at_mm[before], at_mm[after] - at_mm[at])
        > width_mm  # otherwise the ends of the mark hide the corner
    ]
    neighbours.sort(key=lambda each: line.turn_rad(each[1]))
    better = next((each[1] for each in neighbours if _is_better_lifted(line, *each, brush)), None)
    if better is None:
        return [stroke]
    least_rad = line.turn_rad(better) - _MAX_SIMILAR_RAD
    # Similar corners should look alike.
    lifts = [at for at in sharp if line.turn_rad(at) >= least_rad]
    if stroke.closed:
        line = line.begun_at(lifts[0])
        lifts = [at - lifts[0] for at in lifts[1:]]
    ends = [0, *lifts, len(line.cubics)]
    return [line_stroke(line.between(*pair), stroke, lane) for lane, pair in enumerate(pairwise(ends), start=1)]


def _is_better_lifted(line: Line, before: int, corner: int, after: int, brush) -> bool:
    from .trial_mark import misplaced_mm2, trial_marks

    whole = line_stroke(line.between(before, after))
    parts = [line_stroke(line.between(before, corner)), line_stroke(line.between(corner, after))]
    target = _core.target_outline(whole, 0.01)
    try:
        single_mm2, lifted_mm2 = (misplaced_mm2(trial_marks(trial, brush), target, brush) for trial in ([whole], parts))
    except Error:
        return False
    return single_mm2 - lifted_mm2 > _MIN_LIFT_GAIN * (2 * max(half for _, half in whole.half_width)) ** 2


def drawn_line(cubics: np.ndarray, half_width: list) -> Line:
    return Line(cubics[knots(cubics)[:, -1] > 0], half_width)


def line_stroke(line: Line, like=None, lane: int = 1):
    stroke = _core.Stroke(middle_mm=line.cubics.reshape(-1, 8), half_width=line.half_width)
    if like is not None:
        origin = like.origin
        stroke.id = _core.StrokeId(origin.element, origin.part, origin.repeat, lane)
        stroke.layer, stroke.colour, stroke.settings = like.layer, like.colour, like.settings
    return stroke


def _is_straight(points: np.ndarray) -> bool:
    chord = points[3] - points[0]
    distance = np.abs((points[1:3] - points[0]) @ (-chord[1], chord[0]))
    return bool((distance <= _MAX_SIDE_DEVIATION * (chord @ chord)).all())


def _tangent(points: np.ndarray) -> np.ndarray:
    """Return the direction in which a cubic leaves its first point."""
    moves = points[1:] - points[0]
    return moves[(np.hypot(*moves.T) > 1e-9).argmax()]
