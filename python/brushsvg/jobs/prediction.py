"""Predict the marks that a plan will paint."""

from __future__ import annotations

import os
from collections.abc import Callable

from .. import _core
from ..machine.cells.cell import Cell
from ..machine.paint_reload import fetched_mm
from .prepared_drawing import PreparedDrawing


def predict(
    work: PreparedDrawing, outlines: bool = True, stage: Callable[[str], object] = lambda text: None, whole: bool = True
) -> _core.Marks:
    """Return the marks that the plan of a work will paint.

    outlines: also trace the outlines of the marks.
    whole: with outlines, also trace the outlines of all paint together.
    """
    known_marks = None if outlines else work.marks()
    if known_marks is not None:
        return known_marks
    return predict_plan_marks(work.plan, work.brush, outlines, stage, whole, work.options.cell)


def predict_plan_marks(
    plan: _core.Plan,
    brush: _core.Brush,
    outlines: bool = True,
    stage: Callable[[str], object] = lambda text: None,
    whole: bool = True,
    cell: Cell | None = None,
) -> _core.Marks:
    """Return the marks that a plan will paint.

    cell: the cell that fetches paint, for a brush whose marks narrow as paint runs out. Without paint stations,
        every stroke begins freshly dipped, except strokes that are painted without a fetch (`reload`).
    """
    marks = _core.simulate(plan, brush, progress=_make_counter(stage, "simulated"))
    if brush.paint:
        _core.narrow(marks, brush.paint, fetched_mm(plan, brush, cell))
    if not outlines:
        return marks
    return trace_mark_outlines(marks, brush, stage) if whole else _trace_each_pass(marks, brush, stage)


def trace_mark_outlines(
    marks: _core.Marks, brush: _core.Brush, stage: Callable[[str], object] = lambda text: None
) -> _core.Marks:
    """Trace the outlines of the marks, and return the marks."""
    _core.trace_outlines(marks, brush, progress=_make_counter(stage, "outlined"))
    return marks


def _trace_each_pass(marks, brush, stage):
    """Trace each pass alone, on all processors; a picture needs no outlines of all paint together."""
    from concurrent.futures import ThreadPoolExecutor

    def trace_alone(trace):
        alone = _core.Marks()
        alone.passes = [trace]
        _core.trace_outlines(alone, brush)
        return alone.passes[0]

    count = _make_counter(stage, "outlined")
    pool = ThreadPoolExecutor(os.cpu_count())
    try:
        traced = []
        for trace in pool.map(trace_alone, marks.passes):
            traced.append(trace)
            count(len(traced), len(marks.passes))
    finally:
        pool.shutdown(cancel_futures=True)  # Ctrl-C waits only for the strokes that are being traced
    marks.passes = traced
    return marks


def _make_counter(stage, doing: str):
    return lambda now, all_: stage(f"{doing} {now} of {all_} strokes")
