"""A prepared drawing or plan: its strokes, its plan, and the warnings about it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .. import _core
from ..machine.cells.cell import Cell
from ..machine.job_program import WHOLE_JOB, CheckedProgram, Job
from ..machine.paint_reload import PlanInLoads, is_later_part
from ..planning import painting_order
from ..read.design import Notice
from .options import Options


@dataclass(frozen=True)
class KnownSimulation:
    """A simulation of a plan as it was at that time.

    plan: a copy of the plan.
    marks: the marks of the plan, without outlines and freshly dipped.
    walk: the program of the plan with the limits that it breaks.
    """

    plan: _core.Plan
    marks: _core.Marks
    walk: CheckedProgram


@dataclass(frozen=True)
class PreparedDrawing:
    """A prepared drawing or plan.

    plan: the plan, with corrections.
    strokes: the target strokes; None for an input plan, which does not hold its target.
    tracking_errors: one for each pass of the plan without corrections; () for a plan that was read from a file.
    refused: notices on the strokes that were left out.
    """

    title: str
    brush: _core.Brush
    plan: _core.Plan
    strokes: list[_core.Stroke] | None
    tracking_errors: tuple
    options: Options
    notices: tuple[Notice, ...]
    refused: tuple[Notice, ...] = ()
    left_out: tuple = ()  # the targets of strokes that were refused
    drawn: tuple = ()  # all strokes, before their widths were limited to the brush
    unreached: tuple = ()  # pieces of filled shapes that no stroke reaches
    missed: tuple = ()  # pieces of filled shapes that strokes reach and the mark does not
    astray: tuple = ()  # names of strokes whose paint is visibly elsewhere
    known: KnownSimulation | None = None  # simulation of the plan, or of the plan before it was changed

    def marks(self) -> _core.Marks | None:
        """Return the marks of the plan if they are known. Do not change them."""
        return self.known.marks if self._is_known() else None

    def walk(self, cell: Cell, job: Job = WHOLE_JOB) -> CheckedProgram | None:
        """Return the program of the plan with the limits it breaks, if known.

        It is known only for the cell of the options and for the job that was simulated.
        """
        known_walk = self.known.walk if self._is_known() else None
        return (
            known_walk
            if known_walk and cell == self.options.cell and replace(known_walk.job, visits=()) == job
            else None
        )

    def _is_known(self) -> bool:
        return self.known is not None and not self.brush.paint and self.known.plan == self.plan


def match_whole_strokes(work: PreparedDrawing, loads: PlanInLoads) -> list:
    """Return the stroke that each load paints whole, None for a part of a stroke."""
    matched, remaining = [], iter(work.strokes)
    for a_pass in loads.loads:
        if is_later_part(a_pass):
            matched[-1:] = [None, None]
        else:
            matched.append(next(remaining))
    return matched


def list_strokes_from(work: PreparedDrawing, loads: PlanInLoads, first_load: int) -> list | None:
    """Return the strokes that the loads from number first_load on paint, counted from 1.

    None if that load continues a stroke: nothing says where in the stroke it begins.
    """
    painted, rest = loads.loads[: first_load - 1], loads.left(first_load).loads
    if rest and is_later_part(rest[0]):
        return None
    return work.strokes[sum(not is_later_part(a_pass) for a_pass in painted) :]


def select_passes(work: PreparedDrawing, rows: list[int]) -> PreparedDrawing:
    """Return the work with only these passes of its plan, in this order."""
    old_plan = work.plan
    plan = _core.Plan(
        old_plan.brush,
        old_plan.brush_sha256,
        old_plan.sheet_mm,
        [old_plan.passes[k] for k in rows],
        old_plan.extra,
    )
    strokes = None if work.strokes is None else [work.strokes[k] for k in rows]
    tracking_errors = tuple(work.tracking_errors[k] for k in rows) if work.tracking_errors else ()
    return replace(work, plan=plan, strokes=strokes, tracking_errors=tracking_errors)


def order_nearest_first(work: PreparedDrawing) -> PreparedDrawing:
    """Return the work with its strokes in the order of the shortest travel.

    Travel goes from the end of one stroke to the start of the next. Only consecutive strokes of one layer and
    colour change places, and no stroke is painted backwards.
    """
    return select_passes(work, painting_order.list_nearest_first(work.plan.passes))
