"""What a brush would paint of a few strokes, before anybody chooses how they are painted."""

from __future__ import annotations

import numpy as np

from .. import _core

_ANY_SHEET_MM = (1e6, 1e6)
BESIDE_MM = 5.0  # of a shape: no paint lies farther out
PX_PER_MM, SIDE_PX = 6.0, 2000
_TOLERANCE_MM = 0.05  # as plans have by default: a coarser one blurs what corners look like


def trial_mark(strokes: list, brush) -> list[np.ndarray]:
    """Rings of the mark of strokes in closed form, each begun as suits it; Error where they cannot be painted."""
    return outline_of(trial_marks(strokes, brush), brush)


def outline_of(marks, brush) -> list[np.ndarray]:
    _core.trace_outlines(marks, brush)
    return marks.outline_mm


def trial_overlap(strokes: list, rings: list[np.ndarray], brush) -> float:
    """How much that mark overlaps with a shape, to 0.002, in pixels: its outline takes ten times as long."""
    common, both = _shared_px(trial_marks(strokes, brush), _Wanted(rings), brush)
    return common / both


def spoiling(strokes: list, tried: list[int], rings: list[np.ndarray], brush) -> tuple[set[int], float]:
    """Which of the strokes with these numbers paint more beside a shape than they add within it, the others given; the
    last one first; and how much the mark of the rest overlaps with the shape. In pixels."""
    marks, wanted, spoil = trial_marks(strokes, brush), _Wanted(rings), set()
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


def misplaced_seen_mm2(marks, rings: list[np.ndarray], brush) -> float:
    """The same in pixels."""
    wanted = _Wanted(rings)
    common, both = _shared_px(marks, wanted, brush)
    return (both - common) / wanted.px_per_mm**2


class _Wanted:
    """A shape in pixels, how much of each it covers, and the window that they fill."""

    def __init__(self, rings: list[np.ndarray]) -> None:
        points = np.vstack(rings)
        low, size = points.min(axis=0) - BESIDE_MM, np.ptp(points, axis=0) + 2 * BESIDE_MM
        self.window, self.px_per_mm = (*low, *size), min(PX_PER_MM, SIDE_PX / size.max())
        self.covered = _core.coverage(rings, self.window, self.px_per_mm)


def _shared_px(marks, wanted: _Wanted, brush) -> tuple[float, float]:
    """What marks and a shape have in common, and what both cover [px]."""
    painted = _core.coverage(marks, brush, wanted.window, wanted.px_per_mm)
    common = float(np.minimum(wanted.covered, painted).sum())
    return common, float(wanted.covered.sum() + painted.sum()) - common


def trial_marks(strokes: list, brush):
    """The same, not its outline yet."""
    plan = _core.compensate(
        strokes, brush, _ANY_SHEET_MM, "closed", _TOLERANCE_MM, start="auto", end="auto"
    ).plan
    return _core.simulate(plan, brush)
