"""A plan to the marks that it will paint."""

from __future__ import annotations

import os
from collections.abc import Callable

from .. import _core
from ..machine.cells.cell import Cell
from ..machine.paint_reload import fetched_mm
from .work import Work


def predict(
    work: Work, outlines: bool = True, stage: Callable[[str], object] = lambda text: None, whole: bool = True
) -> _core.Marks:
    """The marks of the plan; outlines: trace their rings too, whole: those of all paint together as well."""
    known = None if outlines else work.marks()
    if known is not None:
        return known
    return marks_of(work.plan, work.brush, outlines, stage, whole, work.options.cell)


def marks_of(
    plan: _core.Plan,
    brush: _core.Brush,
    outlines: bool = True,
    stage: Callable[[str], object] = lambda text: None,
    whole: bool = True,
    cell: Cell | None = None,
) -> _core.Marks:
    """The marks of any plan. cell: where it fetches paint, of a brush whose marks narrow until then; where none does
    every stroke is taken to begin freshly dipped, but those that are to be painted without (`reload`)."""
    marks = _core.simulate(plan, brush, progress=_make_counter(stage, "simulated"))
    if brush.paint:
        _core.narrow(marks, brush.paint, fetched_mm(plan, brush, cell))
    if not outlines:
        return marks
    return outlined(marks, brush, stage) if whole else _trace_each_pass(marks, brush, stage)


def outlined(
    marks: _core.Marks, brush: _core.Brush, stage: Callable[[str], object] = lambda text: None
) -> _core.Marks:
    """The marks with their rings traced."""
    _core.trace_outlines(marks, brush, progress=_make_counter(stage, "outlined"))
    return marks


def _trace_each_pass(marks, brush, stage):
    """The marks with the rings of each pass alone, which is all that a picture needs, on all processors."""
    from concurrent.futures import ThreadPoolExecutor

    def one(trace):
        alone = _core.Marks()
        alone.passes = [trace]
        _core.trace_outlines(alone, brush)
        return alone.passes[0]

    count = _make_counter(stage, "outlined")
    pool = ThreadPoolExecutor(os.cpu_count())
    try:
        done = []
        for trace in pool.map(one, marks.passes):
            done.append(trace)
            count(len(done), len(marks.passes))
    finally:
        pool.shutdown(cancel_futures=True)  # Ctrl-C waits for the strokes at hand, no longer
    marks.passes = done
    return marks


def _make_counter(stage, doing: str):
    return lambda now, all_: stage(f"{doing} {now} of {all_} strokes")
