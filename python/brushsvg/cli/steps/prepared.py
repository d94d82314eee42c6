"""A drawing or plan prepared and simulated, with what is to be warned of."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

from ...errors import Error, Notice
from ...jobs import prediction
from ...jobs.choices import Choices, report_ineffective_flags
from ...jobs.preparation import preparation
from ...jobs.work import Work
from ...machine import preflight
from ...machine.cells.cell import Cell
from ...machine.motion import duration_s
from ...machine.paint_reload import PlanInLoads, in_loads, too_long, visits
from ...machine.program import Walked
from ..console import refuse_errors, stage, warn
from .options import make_options


def prepare(chosen: Choices, cell: Cell | None = None, brush=None, partly: bool = False, plan=None) -> Work:
    """plan: what the input holds, where that is a file of another kind."""
    warn(chosen.input, report_ineffective_flags(chosen))
    options = make_options(chosen, cell, brush)
    with refuse_errors(chosen.input):
        return preparation.prepare(plan or chosen.input, options, stage, partly)


@dataclass(frozen=True)
class PreparedPaint:
    """marks: of the strokes, or of the loads where those are looked at; walk: of the loads, None where no stroke is
    left; forbidden: which of the warnings forbid to run a program: to someone who looks they only warn."""

    work: Work
    loads: PlanInLoads
    marks: object
    walk: Walked | None
    warnings: list[Notice]
    forbidden: list[Notice]

    def seconds(self) -> float | None:
        """How long the machine takes; None where it cannot paint this, which a picture does not ask."""
        with suppress(Error):
            visits(self.loads, self.work.options.cell)  # else they are not in what was gone through
            return duration_s(self.walk.made) if self.walk else None
        return None


def prepare_and_simulate(
    chosen: Choices,
    outlines: bool,
    at_loads: bool = False,
    partly: bool = False,
    whole: bool = True,
    tilted: bool = False,
) -> PreparedPaint:
    """tilted: look at the marks of a tilted brush, too, which no cell can paint: it is warned of, and there are no
    loads."""
    work = prepare(chosen, partly=partly)
    brush, cell, of_drawing = work.brush, work.options.cell, work.strokes is not None
    with refuse_errors(chosen.input):
        held_upright = []
        try:
            loads = in_loads(work.plan, brush, cell)
        except Error as refusal:
            if not tilted or refusal.code != "tilt-unsupported":
                raise
            held_upright, loads = (
                [replace(refusal.notice(), refused=True)],
                PlanInLoads(tuple(work.plan.sheet_mm), ()),
            )
        if at_loads:
            marks = prediction.marks_of(loads.as_plan(), brush, outlines, stage, whole, cell)
        else:
            marks = prediction.predict(work, outlines, stage, whole)
        walk = None
        if not held_upright and (work.plan.passes or not work.refused):
            known = None if at_loads else work.walk(cell)
            tolerance_mm = work.options.tolerance_mm
            walk = preflight.look(loads, brush, marks, cell, tolerance_mm, walk=known, of_drawing=of_drawing)
        forbidden = [replace(problem, refused=True) for problem in walk.problems] if walk else []
        sheet_mm = work.plan.sheet_mm
        astray = preflight.off_sheet(marks, brush, sheet_mm, of_drawing) if held_upright else []
        warnings = [*work.notices, *forbidden, *astray, *held_upright]
        warnings += too_long(loads, brush, cell) if at_loads else []
    warn(chosen.input, warnings)
    return PreparedPaint(work, loads, marks, walk, warnings, forbidden)
