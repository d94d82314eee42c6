"""What a brush would paint of a few strokes, before anybody chooses how they are painted."""

from __future__ import annotations

from copy import copy
from functools import cached_property

import numpy as np

from .. import _core

_ANY_SHEET_MM = (1e6, 1e6)
_BESIDE_MM = 5.0  # of a shape: no paint lies farther out
_PX_PER_MM, _SIDE_PX = 6.0, 2000
SEEN_MM = 0.15  # paint farther outside of a shape is a bulge, blank farther inside a notch
_TOLERANCE_MM = 0.05  # as plans have by default: a coarser one blurs what corners look like


def trial_mark(strokes: list, brush) -> list[np.ndarray]:
    """Rings of the mark of strokes in closed form, each begun as suits it; Error where they cannot be painted."""
    return outline_of(trial_marks(strokes, brush), brush)


def outline_of(marks, brush) -> list[np.ndarray]:
    _core.trace_outlines(marks, brush)
    return marks.outline_mm


def trial_overlap(strokes: list, rings: list[np.ndarray], brush) -> float:
    """How much that mark overlaps with a shape, to 0.002, in pixels: its outline takes ten times as long."""
    wanted = Wanted(rings)
    return wanted.overlap(wanted.painted(trial_marks(strokes, brush).passes, brush))


def spoiling(strokes: list, tried: list[int], rings: list[np.ndarray], brush) -> tuple[set[int], float]:
    """Which of the strokes with these numbers paint more beside a shape than they add within it, the others given; the
    last one first; and how much the mark of the rest overlaps with the shape. In pixels."""
    marks, wanted, spoil = trial_marks(strokes, brush), Wanted(rings), set()
    some = _core.Marks()

    def shared(but: set[int]) -> tuple[float, float]:
        some.passes = [one for k, one in enumerate(marks.passes) if k not in but]
        return _shared_px(some, wanted, brush)

    common, both = shared(spoil)
    for k in reversed(tried):
        fewer = shared({*spoil, k})
        if fewer[1] - fewer[0] <= both - common:
            spoil, (common, both) = {*spoil, k}, fewer
    return spoil, common / both


def misplaced_mm2(marks, rings: list[np.ndarray], brush) -> float:
    """Area of what is wanted and not painted, and of what is painted and not wanted."""
    mark = outline_of(marks, brush)
    return _core.area(mark) + _core.area(rings) - 2 * _core.area(_core.intersect(mark, rings))


class Wanted:
    """A shape in pixels, how much of each it covers, and the window that they fill."""

    def __init__(self, rings: list[np.ndarray]) -> None:
        points = np.vstack(rings)
        low, size = points.min(axis=0) - _BESIDE_MM, np.ptp(points, axis=0) + 2 * _BESIDE_MM
        self.window, self.px_per_mm = (*low, *size), min(_PX_PER_MM, _SIDE_PX / size.max())
        self.covered = _core.coverage(rings, self.window, self.px_per_mm)
        self.rings = rings

    def painted(self, passes: list, brush) -> np.ndarray:
        """How much of each pixel passes of marks cover."""
        marks = _core.Marks()
        marks.passes = passes
        return _core.coverage(marks, brush, self.window, self.px_per_mm)

    @cached_property
    def farther(self) -> np.ndarray:
        """How much of each the shape covers that is SEEN_MM larger."""
        return self._moved(SEEN_MM)

    @cached_property
    def nearer(self) -> np.ndarray:
        """The same, smaller."""
        return self._moved(-SEEN_MM)

    def _moved(self, by_mm: float) -> np.ndarray:
        from .swept_areas import region, rings_of  # with shapely, which is slow to load

        return _core.coverage(rings_of(region(self.rings).buffer(by_mm)), self.window, self.px_per_mm)

    def pixels_about(self, points: np.ndarray, beside_mm: float) -> tuple[slice, slice]:
        """Rows and columns of the pixels about places, so far beside them as well."""
        x, y, _, height = self.window
        low, high = points.min(axis=0) - beside_mm, points.max(axis=0) + beside_mm
        columns = np.clip((np.array([low[0], high[0]]) - x) * self.px_per_mm, 0, self.covered.shape[1] - 1)
        rows = np.clip(
            (y + height - np.array([high[1], low[1]])) * self.px_per_mm, 0, self.covered.shape[0] - 1
        )
        return tuple(slice(int(first), int(last) + 1) for first, last in (rows, columns))

    def only(self, where: tuple[slice, slice]) -> Wanted:
        """The same in some of the pixels alone."""
        rows, columns = where
        x, y, _, height = self.window
        some = copy(self)
        some.window = (
            x + columns.start / self.px_per_mm,
            y + height - rows.stop / self.px_per_mm,
            (columns.stop - columns.start) / self.px_per_mm,
            (rows.stop - rows.start) / self.px_per_mm,
        )
        some.covered, some.farther, some.nearer = (
            each[where] for each in (self.covered, self.farther, self.nearer)
        )
        return some

    def places(self, pixels: np.ndarray) -> np.ndarray:
        """The middles of pixels, given by row and column [mm]."""
        x, y, _, height = self.window
        return np.column_stack([x, y + height]) + (pixels[:, ::-1] + 0.5) / self.px_per_mm * (1, -1)

    def shared_px(self, painted: np.ndarray) -> tuple[float, float]:
        """What paint and the shape have in common, and what both cover [px]."""
        common = float(np.minimum(self.covered, painted).sum())
        return common, float(self.covered.sum() + painted.sum()) - common

    def overlap(self, painted: np.ndarray) -> float:
        common, both = self.shared_px(painted)
        return common / both

    def bulge_mm2(self, painted: np.ndarray) -> float:
        """Area of paint farther outside of the shape than SEEN_MM."""
        return float(np.maximum(painted - self.farther, 0).sum()) / self.px_per_mm**2

    def notch_mm2(self, painted: np.ndarray) -> float:
        """Blank area farther inside of it."""
        return float(np.maximum(self.nearer - painted, 0).sum()) / self.px_per_mm**2

    def misplaced_mm2(self, painted: np.ndarray) -> float:
        """Area that is painted and not wanted, or wanted and not painted."""
        return float(np.abs(painted - self.covered).sum()) / self.px_per_mm**2


def _shared_px(marks, wanted: Wanted, brush) -> tuple[float, float]:
    """What marks and a shape have in common, and what both cover [px]."""
    return wanted.shared_px(wanted.painted(marks.passes, brush))


def trial_marks(strokes: list, brush):
    """The same, not its outline yet."""
    return _core.simulate(trial_plan(strokes, brush), brush)


def trial_plan(strokes: list, brush):
    """The plan that it is painted by."""
    return _core.compensate(
        strokes, brush, _ANY_SHEET_MM, "closed", _TOLERANCE_MM, start="auto", end="auto"
    ).plan
