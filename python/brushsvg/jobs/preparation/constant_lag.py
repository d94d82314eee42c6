"""The same drawing with one lag for all strokes, to compare with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from ...strokes.wide_shapes import within_reach
from ..work import Work


def best_constant(work: Work, step_mm: float = 0.25) -> Work:
    """A drawing's work with the one lag for all strokes whose marks overlap most with it, to compare with.

    Lags from 0 to the brush's greatest are tried, step_mm apart, and compared by pixels. The best one is in
    options.lag_mm; notices stay those of the work.
    """
    window = (0.0, 0.0, *work.plan.sheet_mm)
    px_per_mm = min(
        4.0, 4000.0 / max(work.plan.sheet_mm)
    )  # overlaps to 2e-4, in a twentieth of the rings' time
    target = _core.wanted_coverage(work.strokes, window, px_per_mm)
    best, most = work, -1.0
    greatest_mm = max(work.brush.lag(depth) for depth in np.linspace(*work.brush.depth_range_mm, 101))
    for lag_mm in np.arange(0.0, greatest_mm + step_mm, step_mm).tolist():
        options = replace(work.options, compensation="constant", lag_mm=lag_mm)
        done = _core.compensate(
            within_reach(work.strokes, work.brush, "clamp")[0],
            work.brush,
            work.plan.sheet_mm,
            "constant",
            options.tolerance_mm,
            lag_mm,
            options.speed_mm_s,
        )
        painted = _core.coverage(_core.simulate(done.plan, work.brush), work.brush, window, px_per_mm)
        overlap = np.minimum(painted, target).sum() / np.maximum(painted, target).sum()
        if overlap > most:
            best, most = (
                replace(work, plan=done.plan, tracking_errors=tuple(done.tracking_errors), options=options),
                overlap,
            )
    return best
