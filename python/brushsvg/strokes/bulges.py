"""Lines of a filling whose marks stick out of the shape led otherwise, where that gives a cleaner edge."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .. import _core
from ..errors import Error
from .offset_passes import FITTED, Line
from .trial_mark import Wanted, trial_marks

_UGLY = 20.0  # a bulge or a notch counts so many times: an edge's raggedness shows more than its being a little off
_STICKS_OUT_MM2 = 0.03  # of a line's mark; less is a pixel's noise
_WORTH_MM2 = 0.2  # of faults so counted, won by another way
_CUTS = (0.0, 0.4, 0.8, 1.5)  # off an end, in half widths
_THINNER = (0.95, 0.88)
_BESIDE = 3.0  # a line, in half widths: no way to lead it paints farther out
_MOST_LINES = 40  # of one shape, that are led otherwise


class _Way(NamedTuple):
    """How a line is led: the other way round, to square ends, so many half widths cut off its ends, so wide."""

    turned: bool = False
    square: bool = True
    first: float = 0.0
    last: float = 0.0
    width: float = 1.0


def mended(
    lines: list[Line], narrow: list, rings: list[np.ndarray], brush, as_stroke: Callable[[int, Line], object]
) -> tuple[list[Line | None], np.ndarray, Wanted]:
    """The lines, those that stick out of a shape led back, cut short or made thinner, or None in place of one that is
    best left out, where marks and shape then differ by less, the first line stays one; how much of each pixel is painted then, narrow strokes too, and
    the shape in these pixels.

    narrow: strokes that are painted with them; rings: of the shape; as_stroke: a line as a stroke, by its number.
    """
    wanted = Wanted(rings)
    passes = trial_marks([*(as_stroke(k, line) for k, line in enumerate(lines)), *narrow], brush).passes
    paint = [wanted.painted([one], brush) for one in passes]
    beyond = np.array([wanted.bulge_mm2(each) for each in paint[: len(lines)]])
    least = brush.half_width_range_mm()[0]
    made: list[Line | None] = list(lines)
    for k in np.argsort(-beyond)[:_MOST_LINES].tolist():
        if beyond[k] < _STICKS_OUT_MM2:
            break
        where = wanted.pixels_about(
            lines[k].middle_mm.reshape(-1, 2), _BESIDE * max(h for _, h in lines[k].half_width)
        )
        here, own = wanted.only(where), paint[k][where]
        rest = np.max([each[where] for n, each in enumerate(paint) if n != k] or [np.zeros_like(own)], axis=0)
        tried = {_Way(): (faults_mm2(here, np.maximum(rest, own)), lines[k], own)}

        def faults(way: _Way, k=k, rest=rest, tried=tried, here=here) -> float:
            if way not in tried:
                line = _led(lines[k], way, least)
                painted = painted_by(as_stroke(k, line), here, brush) if line else None
                by = math.inf if painted is None else faults_mm2(here, np.maximum(rest, painted))
                tried[way] = (by, line, painted)
            return tried[way][0]

        best = min(_ways(lines[k]), key=faults)
        if faults(best) > faults(_Way()) - _WORTH_MM2:
            best = _Way()
        _, made[k], painted = tried[best]
        if k > 0 and faults_mm2(here, rest) < faults(best) - _WORTH_MM2:
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


def faults_mm2(wanted: Wanted, painted: np.ndarray) -> float:
    """Area out of place, bulges and notches as often as an eye counts them."""
    return wanted.misplaced_mm2(painted) + _UGLY * (wanted.bulge_mm2(painted) + wanted.notch_mm2(painted))


def _ways(line: Line) -> list[_Way]:
    """Square ends are not cut, a ring has none."""
    made = [_Way()]
    if line.wanted_mm:
        made.append(_Way(square=False))
    made += [_Way(square=False, width=width) for width in _THINNER]
    if not line.closed:
        made += [_Way(False, False, *cut) for cut in itertools.product(_CUTS, _CUTS) if any(cut)]
    return [each._replace(turned=turned) for turned in (False, True) for each in made]


def _led(line: Line, way: _Way, least: float) -> Line | None:
    """The line led so; None where less is left of it than it is wide."""
    made: Line | None = line if way.square and line.wanted_mm else replace(line, wanted_mm=())
    if way.first or way.last:
        made = _without_ends(line, way.first, way.last)
    if made and way.width < 1:
        made = replace(made, half_width=[(at, max(least, way.width * h)) for at, h in made.half_width])
    return _turned(made) if made and way.turned else made


def _turned(line: Line) -> Line:
    back = line.middle_mm[::-1].reshape(-1, 4, 2)[:, ::-1].reshape(-1, 8)
    return replace(line, middle_mm=back, half_width=[(1 - at, h) for at, h in line.half_width[::-1]])


def _without_ends(line: Line, first: float, last: float) -> Line | None:
    """The line cut at both ends, by so many of its half widths."""
    stroke = _core.Stroke(middle_mm=line.middle_mm, half_width=line.half_width)
    rows = _core.flatten(stroke, 0.01)
    at, half = rows[:, 2], rows[:, 3].max()
    ends = first * half, at[-1] - last * half
    if ends[1] - ends[0] < half:
        return None
    places = np.array([ends[0], *at[(at > ends[0]) & (at < ends[1])], ends[1]])
    part = np.column_stack([np.interp(places, at, rows[:, k]) for k in (0, 1, 3)])
    return Line(*_core.fit_curve(part, max(0.5 * FITTED * float(part[:, 2].mean()), 1e-3)))
