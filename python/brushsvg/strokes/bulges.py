"""Lines of a filling whose marks stick out of the shape led otherwise, where that gives a cleaner edge."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .. import _core
from ..errors import Error
from .offset_passes import FITTED, Line
from .trial_mark import Wanted, trial_marks

# Bulges and notches count so many times: an edge's raggedness shows more than its being a little off.
_BULGE, _NOTCH = 80.0, 20.0
_FILLED = 2.0  # a notch where a line along the edge may fill it
_NARROW = 0.27  # of a brush's greatest half width, lines along the edge
_STICKS_OUT_MM2 = 0.008  # of a line's mark; less is a pixel's noise
_WORTH_MM2 = 0.2  # of faults so counted, won by another way
_NARROWING = -1.0
_NARROWED, _NARROWS = 0.5, 1.5  # to so much of its width, over so many half widths
_ENDS = (0.1, 0.4, 0.8, 1.5, _NARROWING)
_MARKS = (
    (True, False, 1.0),
    (True, False, 0.95),
    (False, False, 1.0),
    (False, True, 1.0),
    (False, False, 0.95),
    (False, False, 0.88),
)
_BESIDE = 3.0  # a line, in half widths: no way to lead it paints farther out
_MOST_LINES = 40  # of one shape, that are led otherwise


class _Way(NamedTuple):
    """How a line is led: the other way round, to square ends, beginning pointed, so wide, and by so many half widths
    cut off its ends, or narrowing towards them."""

    turned: bool = False
    square: bool = True
    exposed: bool = False
    width: float = 1.0
    first: float = 0.0
    last: float = 0.0


def mended(
    lines: list[Line], narrow: list, rings: list[np.ndarray], brush, as_stroke: Callable[[int, Line], object]
) -> tuple[list[Line | None], np.ndarray, Wanted]:
    """The lines, those that stick out of a shape led back, cut short, narrowing or made thinner, or None in place of
    one that is best left out, where marks and shape then differ by less, the first line stays one; how much of each
    pixel is painted then, narrow strokes too, and the shape in these pixels.

    narrow: strokes that are painted with them; rings: of the shape; as_stroke: a line as a stroke, by its number.
    """
    wanted = Wanted(rings)
    passes = trial_marks([*(as_stroke(k, line) for k, line in enumerate(lines)), *narrow], brush).passes
    paint = [wanted.painted([one], brush) for one in passes]
    beyond = np.array([wanted.bulge_mm2(each) for each in paint[: len(lines)]])
    least, greatest = brush.half_width_range_mm()
    notches = _FILLED if least <= _NARROW * greatest else _NOTCH
    made: list[Line | None] = list(lines)
    for k in np.argsort(-beyond)[:_MOST_LINES].tolist():
        if beyond[k] < _STICKS_OUT_MM2:
            break
        where = wanted.pixels_about(
            lines[k].middle_mm.reshape(-1, 2), _BESIDE * max(h for _, h in lines[k].half_width)
        )
        here, own = wanted.only(where), paint[k][where]
        rest = np.max([each[where] for n, each in enumerate(paint) if n != k] or [np.zeros_like(own)], axis=0)
        as_is = _Way(square=bool(lines[k].wanted_mm))
        tried = {as_is: (faults_mm2(here, np.maximum(rest, own), notches), lines[k], own)}

        def faults(way: _Way, k=k, rest=rest, tried=tried, here=here) -> float:
            if way not in tried:
                line = _led(lines[k], way, least)
                painted = painted_by(as_stroke(k, line), here, brush) if line else None
                by = math.inf if painted is None else faults_mm2(here, np.maximum(rest, painted), notches)
                tried[way] = (by, line, painted)
            return tried[way][0]

        best = _best(lines[k], faults)
        if faults(best) > faults(as_is) - _WORTH_MM2:
            best = as_is
        _, made[k], painted = tried[best]
        if k > 0 and faults_mm2(here, rest, notches) < faults(best) - _WORTH_MM2:
            made[k], painted = None, np.zeros_like(rest)
        if painted is not own:
            paint[k] = np.zeros_like(paint[k])
            paint[k][where] = painted
    return made, np.max(paint, axis=0), wanted


def painted_by(stroke, wanted: Wanted, brush) -> np.ndarray | None:
    """What the brush paints of it; None where it cannot."""
    try:
        return wanted.painted(list(trial_marks([stroke], brush).passes), brush)
    except Error:
        return None


def faults_mm2(wanted: Wanted, painted: np.ndarray, notches: float = _NOTCH) -> float:
    """Area out of place, bulges and notches as often as an eye counts them."""
    return (
        wanted.misplaced_mm2(painted)
        + _BULGE * wanted.bulge_mm2(painted)
        + notches * wanted.notch_mm2(painted)
    )


def _best(line: Line, faults: Callable[[_Way], float]) -> _Way:
    """The way with the fewest faults of those that begin or end otherwise than it, each end by itself. Square ends are
    not cut, a ring has none."""
    marks = [each for each in _MARKS if line.wanted_mm or not each[0]]
    best = min((_Way(turned, *each) for turned in (False, True) for each in marks), key=faults)
    if line.closed:
        return best
    for end in ("first", "last"):
        ways = [best._replace(square=square, **{end: by}) for by in _ENDS for square in {best.square, False}]
        best = min([best, *ways], key=faults)
    return best


def _led(line: Line, way: _Way, least: float) -> Line | None:
    """The line led so; None where less is left of it than it is wide."""
    made: Line | None = replace(line, wanted_mm=())
    if way.first or way.last:
        made = _with_ends(line, way.first, way.last, least)
    if made and way.square:
        made = replace(made, wanted_mm=line.wanted_mm)
    if made and way.width < 1:
        made = replace(made, half_width=[(at, max(least, way.width * h)) for at, h in made.half_width])
    if made and way.exposed:
        made = replace(made, start="exposed")
    return _turned(made) if made and way.turned else made


def _turned(line: Line) -> Line:
    back = line.middle_mm[::-1].reshape(-1, 4, 2)[:, ::-1].reshape(-1, 8)
    return replace(line, middle_mm=back, half_width=[(1 - at, h) for at, h in line.half_width[::-1]])


def _with_ends(line: Line, first: float, last: float, least: float) -> Line | None:
    """The line cut at both ends, by so many of its half widths, or narrowing towards them beside the edge on its
    right."""
    stroke = _core.Stroke(middle_mm=line.middle_mm, half_width=line.half_width)
    rows = _core.flatten(stroke, 0.01)
    half = rows[:, 3].max()
    ends = max(first, 0.0) * half, rows[-1, 2] - max(last, 0.0) * half
    if ends[1] - ends[0] < 0.8 * half:
        return None
    at = np.union1d(
        rows[(rows[:, 2] > ends[0]) & (rows[:, 2] < ends[1]), 2],
        np.linspace(*ends, 2 + int(rows[-1, 2] / 0.3)),
    )
    part = np.column_stack([np.interp(at, rows[:, 2], rows[:, k]) for k in (0, 1, 3)])
    along = np.gradient(part[:, :2], axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    for is_narrowed, off in ((first == _NARROWING, at - at[0]), (last == _NARROWING, at[-1] - at)):
        if is_narrowed:
            widths = np.maximum(
                part[:, 2] * (1 - (1 - _NARROWED) * np.clip(1 - off / (_NARROWS * half), 0, 1)), least
            )
            part[:, :2] += (part[:, 2] - widths)[:, None] * along[:, ::-1] * (1, -1)
            part[:, 2] = widths
    return Line(*_core.fit_curve(part, max(0.5 * FITTED * float(part[:, 2].mean()), 1e-3)))
