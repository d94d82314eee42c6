"""One constant lag for all strokes of a drawing, for comparison."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from ...strokes.wide_shapes import within_reach
from ..prepared_drawing import PreparedDrawing


def find_best_constant_lag(work: PreparedDrawing, step_mm: float = 0.25) -> PreparedDrawing:
    """Return the work compensated with the constant lag of largest overlap.

    Lags from 0 to the greatest lag of the brush are tried, step_mm apart, and compared by pixels. The best lag is
    in options.lag_mm. The notices are those of the given work.
    """
    window = (0.0, 0.0, *work.plan.sheet_mm)
    # This resolution gives overlaps to 2e-4, in a twentieth of the time that outlines need.
    px_per_mm = min(4.0, 4000.0 / max(work.plan.sheet_mm))
    target = _core.target_coverage(work.strokes, window, px_per_mm)
    best_work, best_overlap = work, -1.0
    greatest_mm = max(work.brush.lag(depth) for depth in np.linspace(*work.brush.depth_range_mm, 101))
    for lag_mm in np.arange(0.0, greatest_mm + step_mm, step_mm).tolist():
        options = replace(work.options, compensation="constant", lag_mm=lag_mm)
        compensated = _core.compensate(
            within_reach(work.strokes, work.brush, "clamp")[0],
            work.brush,
            work.plan.sheet_mm,
            "constant",
            options.tolerance_mm,
            lag_mm,
            options.speed_mm_s,
        )
        painted = _core.coverage(_core.simulate(compensated.plan, work.brush), work.brush, window, px_per_mm)
        overlap = np.minimum(painted, target).sum() / np.maximum(painted, target).sum()
        if overlap > best_overlap:
            best_work, best_overlap = (
                replace(
                    work,
                    plan=compensated.plan,
                    tracking_errors=tuple(compensated.tracking_errors),
                    options=options,
                ),
                overlap,
            )
    return best_work
