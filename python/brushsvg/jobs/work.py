"""A file understood: the part of it that is painted, how, and the warnings about it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .. import _core
from ..errors import Error
from ..machine.cells.cell import Cell
from ..machine.paint_reload import PlanInLoads, is_later_part
from ..machine.program import WHOLE_JOB, Job, Walked
from ..planning import travel_order
from ..read.design import Notice
from .options import Options


@dataclass(frozen=True)
class KnownSimulation:
    """What was found of a plan as it then was, a copy: its marks, without outlines and freshly dipped, and limits."""

    plan: _core.Plan
    marks: _core.Marks
    walk: Walked


@dataclass(frozen=True)
class Work:
    """A file understood: strokes is None where IN was a plan, which does not hold its target.

    plan: with corrections. tracking_errors: one per pass of the plan without them, () for a plan read from a file;
    refused: strokes that were left out.
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
    drawn: tuple = ()  # all strokes, before they were brought within the brush's reach
    unreached: tuple = ()  # pieces of filled shapes that no stroke reaches
    missed: tuple = ()  # pieces that strokes reach and the mark does not
    astray: tuple = ()  # names of strokes whose paint is visibly elsewhere
    known: KnownSimulation | None = None  # of the plan, or of what it was before something of it changed

    def marks(self) -> _core.Marks | None:
        """Of the plan, where they are known: not to be changed."""
        return self.known.marks if self._is_known() else None

    def walk(self, cell: Cell, job: Job = WHOLE_JOB) -> Walked | None:
        """The plan with the limits that it breaks, where these are known of such a job."""
        known = self.known.walk if self._is_known() else None
        return known if known and cell == self.options.cell and replace(known.job, visits=()) == job else None

    def _is_known(self) -> bool:
        return self.known is not None and not self.brush.paint and self.known.plan == self.plan


def match_whole_strokes(work: Work, loads: PlanInLoads) -> list:
    """For each of the work's loads the stroke that it paints whole; None for the parts of one."""
    whole, left = [], iter(work.strokes)
    for a_pass in loads.loads:
        if is_later_part(a_pass):
            whole[-1:] = [None, None]
        else:
            whole.append(next(left))
    return whole


def list_colours(work: Work) -> list[str]:
    """Colours of the work's strokes, the lightest first: dark paint covers light, and rests of it spoil light paint."""

    def lightness(colour: str) -> float:  # luma of ITU-R BT.601
        red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
        return 0.299 * red + 0.587 * green + 0.114 * blue

    found = dict.fromkeys(each.colour for each in work.plan.passes if each.colour)
    return sorted(found, key=lightness, reverse=True)


def select_colour(work: Work, colour: str) -> Work:
    """The strokes of one colour; those without one are painted with the first. Error if there are none."""
    all_colours = list_colours(work)
    if colour not in all_colours:
        known = ", ".join(all_colours) or "none"
        sentence = f"nothing is painted in {colour}; colours of this drawing: {known}"
        raise Error(sentence, "colour", code="nothing-to-paint")
    without = {"", colour} if colour == all_colours[0] else {colour}
    return _select_rows(work, [k for k, each in enumerate(work.plan.passes) if each.colour in without])


def _select_rows(work: Work, rows: list[int]) -> Work:
    was = work.plan
    plan = _core.Plan(was.brush, was.brush_sha256, was.sheet_mm, [was.passes[k] for k in rows], was.extra)
    strokes = None if work.strokes is None else [work.strokes[k] for k in rows]
    tracking_errors = tuple(work.tracking_errors[k] for k in rows) if work.tracking_errors else ()
    return replace(work, plan=plan, strokes=strokes, tracking_errors=tracking_errors)


def order_nearest_first(work: Work) -> Work:
    """The work with its strokes in the order of the shortest way from the end of one to the start of the next.

    Only strokes that follow each other in one layer change places; none is painted backwards.
    """
    return _select_rows(work, travel_order.nearest_first(work.plan.passes))
