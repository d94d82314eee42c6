"""Prepare and simulate a drawing or plan, and print the warnings."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

from ...errors import Error, Notice
from ...jobs import prediction
from ...jobs.choices.choices import Choices
from ...jobs.choices.ineffective_flags import report_ineffective_flags
from ...jobs.preparation import preparation
from ...jobs.prepared_drawing import PreparedDrawing
from ...machine import preflight
from ...machine.cells.cell import Cell
from ...machine.dry_brush import report_long_strokes
from ...machine.job_program import CheckedProgram
from ...machine.limits.paint_on_sheet import find_paint_off_sheet
from ...machine.moves import duration_s
from ...machine.paint_reload import PlanInLoads, list_station_visits, split_into_loads
from ..console import refuse_errors, stage, warn
from .options import make_options


def prepare(chosen: Choices, cell: Cell | None = None, brush=None, partly: bool = False) -> PreparedDrawing:
    """Prepare a drawing or plan, and print warnings about flags without effect."""
    warn(chosen.input, report_ineffective_flags(chosen))
    options = make_options(chosen, cell, brush)
    with refuse_errors(chosen.input):
        return preparation.prepare(chosen.input, options, stage, partly)


@dataclass(frozen=True)
class PreparedPaint:
    """A prepared and simulated input.

    marks: marks of the strokes, or of the loads if these were simulated.
    walk: the program of the loads; None if no stroke is left.
    forbidden: the warnings that forbid running a program. For a preview they are only warnings.
    """

    work: PreparedDrawing
    loads: PlanInLoads
    marks: object
    walk: CheckedProgram | None
    warnings: list[Notice]
    forbidden: list[Notice]

    def seconds(self) -> float | None:
        """Return how long the machine takes, or None if it cannot paint the plan.

        A picture does not require that the machine can paint the plan.
        """
        with suppress(Error):
            # Raises Error for a colour that no station serves: the program then lacks the visits to paint stations.
            list_station_visits(self.loads, self.work.options.cell)
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
    """Prepare an input, simulate it, and print the warnings.

    outlines, whole: as for prediction.predict.
    at_loads: simulate the loads of paint instead of the strokes.
    partly: leave out strokes that are refused.
    tilted: also accept a tilted brush, which no cell can paint. There is a warning, and there are no loads.
    """
    work = prepare(chosen, partly=partly)
    brush, cell, is_drawing = work.brush, work.options.cell, work.strokes is not None
    with refuse_errors(chosen.input):
        tilt_notices = []
        try:
            loads = split_into_loads(work.plan, brush, cell)
        except Error as refusal:
            if not tilted or refusal.code != "tilt-unsupported":
                raise
            tilt_notices = [replace(refusal.notice(), refused=True)]
            loads = PlanInLoads(tuple(work.plan.sheet_mm), ())
        if at_loads:
            marks = prediction.predict_plan_marks(loads.as_plan(), brush, outlines, stage, whole, cell)
        else:
            marks = prediction.predict(work, outlines, stage, whole)
        walk = None
        if not tilt_notices and (work.plan.passes or not work.refused):
            known_walk = None if at_loads else work.walk(cell)
            tolerance_mm = work.options.tolerance_mm
            walk = preflight.check_job(loads, brush, marks, cell, tolerance_mm, walk=known_walk, of_drawing=is_drawing)
        forbidden = [replace(problem, refused=True) for problem in walk.problems] if walk else []
        sheet_mm = work.plan.sheet_mm
        off_sheet_notices = find_paint_off_sheet(marks, brush, sheet_mm, is_drawing) if tilt_notices else []
        warnings = [*work.notices, *forbidden, *off_sheet_notices, *tilt_notices]
        warnings += report_long_strokes(loads, brush, cell) if at_loads else []
    warn(chosen.input, warnings)
    return PreparedPaint(work, loads, marks, walk, warnings, forbidden)
