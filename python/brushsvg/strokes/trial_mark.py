"""Trial marks: what a brush would paint of a few strokes with default settings."""

from __future__ import annotations

import numpy as np

from .. import _core

_HUGE_SHEET_MM = (1e6, 1e6)
# Paint that is further outside of a shape is a bulge, a blank that is further inside a notch.
MIN_VISIBLE_MM = 0.15
_TOLERANCE_MM = 0.05  # as plans have by default: a coarser one blurs the look of corners


def trial_overlap(strokes: list, rings: list[np.ndarray], brush) -> float:
    """Return how much the mark of strokes overlaps with a shape.

    It is measured in pixels: outlines take ten times as long.
    """
    shape = _core.Stroke(middle_mm=np.tile(rings[0][0], 4)[None], half_width=[(0.0, 1.0)])
    shape.target_mm = rings
    return _core.common_area(trial_marks(strokes, brush, few_poses=False).passes, [shape], brush).overlap


def misplaced_mm2(marks, rings: list[np.ndarray], brush) -> float:
    """Return the area of the missing and of the surplus paint."""
    _core.trace_outlines(marks, brush)
    mark = marks.outline_mm
    return _core.area(mark) + _core.area(rings) - 2 * _core.area(_core.intersect(mark, rings))


def trial_marks(strokes: list, brush, few_poses: bool = True):
    """Simulate strokes that are compensated in closed form.

    Each begins as suits it. few_poses: whether there are as few poses as in a plan; more are made faster.
    """
    plan = _core.compensate(
        strokes, brush, _HUGE_SHEET_MM, "closed", _TOLERANCE_MM, few_poses=few_poses, start="auto", end="auto"
    ).plan
    return _core.simulate(plan, brush)
