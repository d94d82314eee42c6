"""Lines of a filling whose marks stick out of the shape led otherwise, where that gives a cleaner edge."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from .. import _core
from ..errors import Error
from .offset_passes import FITTED, Line
from .swept_areas import region, rings_of
from .trial_mark import BESIDE_MM, PX_PER_MM, SIDE_PX, trial_marks

# Paint farther outside of a shape, and blank farther inside, are seen as a bulge and a notch; they count so many times.
SEEN_MM, _UGLY = 0.15, 10.0
_STICKS_OUT_MM2 = 0.03  # of a line's mark beyond SEEN_MM; less is a pixel's noise
_WORTH_MM2 = 0.05  # and won by another line, at least
_CUTS = (0.4, 0.8, 1.5)  # off an end, in half widths
_THINNER = (0.95, 0.88)
_MOST_LINES = 40  # of one shape that are led otherwise


class Edge:
    """A shape in pixels, so that paint beside it and blank in it can be weighed, seen ones _UGLY times."""

    def __init__(self, rings: list[np.ndarray]) -> None:
        points = np.vstack(rings)
        low, size = points.min(axis=0) - BESIDE_MM, np.ptp(points, axis=0) + 2 * BESIDE_MM
        self.window, self.px_per_mm = (*low, *size), min(PX_PER_MM, SIDE_PX / size.max())
        shape = region(rings)
        self._at, self._grown, self._shrunk = (
            _core.coverage(some, self.window, self.px_per_mm)
            for some in (rings, rings_of(shape.buffer(SEEN_MM)), rings_of(shape.buffer(-SEEN_MM)))
        )

    def painted(self, passes: list, brush) -> np.ndarray:
        marks = _core.Marks()
        marks.passes = passes
        return _core.coverage(marks, brush, self.window, self.px_per_mm)

    def outside_mm2(self, painted: np.ndarray) -> float:
        """Area of paint farther outside than SEEN_MM."""
        return float(np.maximum(painted - self._grown, 0).sum()) / self.px_per_mm**2

    def faults_mm2(self, painted: np.ndarray) -> float:
        """Area that is painted and not wanted, or wanted and not painted, seen faults _UGLY times."""
        seen = np.maximum(painted - self._grown, 0) + np.maximum(self._shrunk - painted, 0)
        return float(np.abs(painted - self._at).sum() + _UGLY * seen.sum()) / self.px_per_mm**2


def mended(
    lines: list[Line], narrow: list, rings: list[np.ndarray], brush, as_stroke: Callable[[int, Line], object]
) -> list[Line | None]:
    """The lines, those that stick out of a shape begun elsewhere, led back, cut short or made thinner, or None in place
    of one that is best left out, where marks and shape then differ by less; the first line stays one.

    narrow: strokes that are painted with them; rings: of the shape; as_stroke: what a line is as a stroke, by its number.
    """
    edge = Edge(rings)
    passes = trial_marks([*(as_stroke(k, line) for k, line in enumerate(lines)), *narrow], brush).passes
    paint = [edge.painted([one], brush) for one in passes]
    beyond = np.array([edge.outside_mm2(each) for each in paint[: len(lines)]])
    made: list[Line | None] = list(lines)
    for k in np.argsort(-beyond)[:_MOST_LINES].tolist():
        if beyond[k] < _STICKS_OUT_MM2:
            break
        rest = np.max([each for n, each in enumerate(paint) if n != k] or [np.zeros_like(paint[k])], axis=0)
        tried = [(made[k], paint[k])]
        for line in _otherwise(lines[k], brush.half_width_range_mm()):
            try:
                (one,) = trial_marks([as_stroke(k, line)], brush).passes
            except Error:
                continue
            tried.append((line, edge.painted([one], brush)))
        if k > 0:
            tried.append((None, np.zeros_like(rest)))
        faults = [edge.faults_mm2(np.maximum(rest, each)) for _, each in tried]
        best = int(np.argmin(faults))
        if faults[best] < faults[0] - _WORTH_MM2:
            made[k], paint[k] = tried[best]
    return made


def _otherwise(line: Line, range_mm: tuple[float, float]) -> list[Line]:
    """The line the other way round, without square ends, shorter, thinner."""
    stroke = _core.Stroke(middle_mm=line.middle_mm, half_width=line.half_width, closed=line.closed)
    rows = _core.flatten(stroke, 0.01)
    made = [_turned(line)]
    round_ends = replace(line, wanted_mm=())
    if line.wanted_mm:
        made += [round_ends, _turned(round_ends)]
    least, half = range_mm[0], max(h for _, h in line.half_width)
    made += [
        replace(round_ends, half_width=[(at, max(least, share * h)) for at, h in line.half_width])
        for share in _THINNER
    ]
    if line.closed:
        return made
    for cut in _CUTS:
        for first, last in ((cut, 0.0), (0.0, cut), (cut, cut)):
            part = _between(rows, first * half, rows[-1, 2] - last * half)
            if part is not None:
                made += [part, _turned(part)]
    return made


def _turned(line: Line) -> Line:
    back = line.middle_mm[::-1].reshape(-1, 4, 2)[:, ::-1].reshape(-1, 8)
    return replace(line, middle_mm=back, half_width=[(1 - at, h) for at, h in line.half_width[::-1]])


def _between(rows: np.ndarray, first_mm: float, last_mm: float) -> Line | None:
    """A part of a flattened line (x, y, arc length, half width); None of one that is shorter than wide."""
    if last_mm - first_mm < rows[:, 3].max():
        return None
    at = rows[:, 2]
    inner = at[(at > first_mm) & (at < last_mm)]
    places = np.array([first_mm, *inner, last_mm])
    some = np.column_stack([np.interp(places, at, rows[:, k]) for k in (0, 1, 3)])
    return Line(*_core.fit_curve(some, max(0.5 * FITTED * float(some[:, 2].mean()), 1e-3)))
