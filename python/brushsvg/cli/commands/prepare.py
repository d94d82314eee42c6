"""A drawing or plan prepared and simulated, with what is to be warned of."""

from __future__ import annotations

from contextlib import suppress

from ...errors import Error, Notice
from ...machine import paint_reload, preflight, writer
from ...machine.cell import Cell
from ...machine.program import WHOLE_JOB, Job
from ...pipeline import prediction, preparation
from ..console import about, stage, warn
from .options import options_of
from .outputs import suffix_of

LAYOUT_FLAGS = ("sheet", "units", "select", "layer", "width", "fit", "scale", "origin", "as")


def prepare(args, cell: Cell, brush=None, partly: bool = False) -> preparation.Work:
    if suffix_of(args.input) == ".json":
        for flag in (*LAYOUT_FLAGS, "wide", "compensation", "lag", "tolerance"):
            if getattr(args, {"as": "paths_as"}.get(flag, flag)) is not None:
                sentence = f"--{flag} has no effect on a plan, whose poses are fixed"
                warn(args.input, [Notice("", sentence, code="flag-without-effect", about=flag)])
    with about(args.input):
        return preparation.prepare(args.input, options_of(args, cell, brush), stage, partly)


def seconds_of(work: preparation.Work, cell: Cell, job: Job = WHOLE_JOB) -> float | None:
    """How long the machine takes; None where it cannot paint this, which a plan or a picture does not ask."""
    with suppress(Error):
        return writer.time_s(work.plan, work.brush, cell, job)
    return None


def look(args, cell: Cell, outlines: bool, in_loads: bool = False, partly: bool = False, whole: bool = True):
    """Work, marks, warnings, and which of these forbid to run a program: to someone who looks they only warn."""
    work = prepare(args, cell, partly=partly)
    with about(args.input):
        cell = preflight.as_exact_as(cell, work.options.tolerance_mm)
        if in_loads:
            work = preparation.in_loads(work, cell)
            too_long = paint_reload.too_long(work.plan, work.brush, cell)
        marks = prediction.predict(work, outlines, stage, whole)
        warnings, forbidden = [*work.notices], []
        if work.plan.passes or not work.refused:
            forbidden = preflight.problems(work.plan, work.brush, marks, cell, work.options.tolerance_mm)
        warnings += forbidden
        warnings += too_long if in_loads else []
    warn(args.input, warnings)
    return work, marks, warnings, forbidden
