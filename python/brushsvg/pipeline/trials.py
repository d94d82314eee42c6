"""Other lags, sizes and brushes tried on the same drawing."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np

from .. import _core
from ..evaluation import report
from ..planning import size_advice
from ..planning.refinement import refined
from ..strokes.wide_shapes import within_reach
from .prediction import predict
from .preparation import Options, Work, _way, prepare


def best_constant(work: Work, step_mm: float = 0.25) -> Work:
    """A drawing's work with the one lag for all strokes whose marks overlap most with it, to compare with.

    Lags from 0 to the brush's greatest are tried, step_mm apart, and compared by pixels. The best one is in
    options.lag_mm; notices stay those of the work.
    """
    window = (0.0, 0.0, *work.plan.sheet_mm)
    px_per_mm = min(
        4.0, 4000.0 / max(work.plan.sheet_mm)
    )  # overlaps to 2e-4, in a twentieth of the rings' time
    wanted = _core.wanted_coverage(work.strokes, window, px_per_mm)
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
        overlap = np.minimum(painted, wanted).sum() / np.maximum(painted, wanted).sum()
        if overlap > most:
            best, most = (
                replace(work, plan=done.plan, tracking_errors=tuple(done.misses), options=options),
                overlap,
            )
    return best


def advice(work: Work) -> str:
    """On the drawing's size, in words; none for a plan."""
    options = work.options
    if not work.drawn or options.layout.width_mm is not None:
        return ""
    outlines = {stroke.origin.element for stroke in work.drawn if stroke.wanted_mm}
    in_lanes = {stroke.origin.element for stroke in work.strokes if stroke.origin.lane > 1}
    is_filled = options.wide == "passes" or not outlines.isdisjoint(in_lanes)
    if options.wide == "auto" and not is_filled:
        options = replace(options, wide="clamp")  # strokes are tried alone, and shapes are filled whole
    made = _trial(work.brush, options)
    if is_filled:
        size = size_advice.best_letter_size(work.drawn, work.brush, made)
    else:
        size = size_advice.best_size(work.drawn, work.brush, made, _quick_trial(work.brush, options))
    scale = (options.layout.scale or 1.0) if options.layout.fit_mm is None else None
    return size_advice.advice(size, scale)


def _trial(brush, options: Options):
    """From strokes to (marks, what they should become), made as a drawing is, but on no sheet and for no machine."""
    compensated = _way(brush, None, options)

    def made(strokes):
        painted, wanted, _ = within_reach(strokes, brush, options.wide)
        done = compensated(painted)
        plan = done.plan
        if options.compensation == "refined":
            plan.passes = refined(painted, wanted, brush, done, compensated).passes
        return _core.simulate(plan, brush).passes, wanted

    return made


def _quick_trial(brush, options: Options):
    """A trial in a quarter of the time, or a tenth of refined: in closed form, with more poses than are needed."""
    if options.compensation not in ("closed", "refined"):
        return None

    def made(strokes):
        painted, wanted, _ = within_reach(strokes, brush, options.wide)
        done = _core.compensate(
            painted,
            brush,
            tolerance_mm=options.tolerance_mm,
            few_poses=False,
            sheet_mm=None,
            start=options.start,
            end=options.end,
        )
        return _core.simulate(done.plan, brush).passes, wanted

    return made


def suits(
    path: str | os.PathLike, options: Options, brushes, stage=lambda text: None
) -> list[size_advice.Suit]:
    """How well each brush paints a drawing, the best first."""
    found = []
    for brush in brushes:
        work = prepare(path, replace(options, brush=brush), stage, partly=True)
        marks = predict(work, outlines=False, stage=stage)
        drawn = [*work.strokes, *work.left_out]
        rows, total = report.measure(
            work.plan, marks, brush, work.strokes, options.tolerance_mm, drawn, options.compensation
        )
        found.append(size_advice.suit(brush.name, rows, total.overlap if rows else 0.0, work.refused))
    return size_advice.best_first(found)
