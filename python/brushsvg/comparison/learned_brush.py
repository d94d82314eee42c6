"""Update a known brush from photographs of a job that it painted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import _core
from ..calibration.chart.photograph import EDGE_PX
from ..calibration.prior.from_prior import UpdatedBrush, marks_with_prior, update_brush
from ..errors import Error, Notice
from .job_marks import MAX_MISSING_FOR_OUTLINE, PAINT_A_CHART, JobMarks, job_marks
from .job_page import job_page
from .photographs import Comparison, TargetStroke, compare_photos

# Marks that are displaced from the prior's prediction may be found where the updated brush predicts them.
MAX_ROUNDS = 2


@dataclass(frozen=True)
class LearnedBrush:
    """A brush that was updated from a job, and notices about strokes that were left out."""

    updated: UpdatedBrush
    notices: tuple[Notice, ...]


def learn_brush(
    plan,
    brush: _core.Brush,
    photos: list[tuple[str, bytes]],
    name: str,
    machine: tuple[str, ...] = (),
    displacement_mm: float | None = None,
) -> LearnedBrush:
    """Update a brush from photographs of one painted sheet of a job.

    plan: as painted, including corrections; brush: as known without this job; photos: names and contents of the files;
    name: name of the new brush; machine, displacement_mm: see `update_brush`. Raises Error where the photographs are
    not of this job, or show no stroke that is separate from the others.
    """
    page, predicted, best = job_page(plan), brush, None
    for _ in range(MAX_ROUNDS):
        strokes = _predict_strokes(plan, predicted)
        found = compare_photos(page, strokes, photos)
        marks = job_marks(found, page, strokes)
        if best and len(marks.rings) <= len(best[1].rings):
            break
        if not marks.rings:
            raise _uninformative_error(marks, photos[0][0])
        edge_mm = EDGE_PX / found.view.px_per_mm
        updated = update_brush(_painted_marks(plan, marks), brush, name, edge_mm, machine, displacement_mm)
        best, predicted = (updated, marks, found), updated.brush
        if not (marks.touching or marks.dry):
            break
    updated, marks, found = best
    return LearnedBrush(updated, (*_left_out_notices(found, marks, strokes),))


def _predict_strokes(plan, brush: _core.Brush) -> list[TargetStroke]:
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    return [TargetStroke(each.stroke, None, [np.array(ring) for ring in each.outline_mm]) for each in marks.passes]


def _painted_marks(plan, marks: JobMarks):
    passes = plan.passes
    return marks_with_prior(
        [
            _core.PaintedMark(passes[k].stroke, np.array(passes[k].poses_mm), rings, passes[k].arcs)
            for k, rings in marks.rings.items()
        ]
    )


def _uninformative_error(marks: JobMarks, name: str) -> Error:
    touching, dry = len(marks.touching), len(marks.dry)
    sentence = (
        f"the brush cannot be updated, because no stroke of this job is separate and completely painted: of "
        f"{touching + dry} strokes, {touching} touch others, and {dry} are not found or lack more than "
        f"{100 * MAX_MISSING_FOR_OUTLINE:g} % of their paint"
    )
    return Error(sentence, file=name, code="marks-touch", advice=PAINT_A_CHART)


def _left_out_notices(found: Comparison, marks: JobMarks, strokes: list[TargetStroke]):
    """Yield the notices of the comparison, and why each stroke was left out."""
    touching = "this stroke is left out, because its paint touches the paint of other strokes"
    dry = (
        "this stroke is left out, because its mark was not found or lacks more than "
        f"{100 * MAX_MISSING_FOR_OUTLINE:g} % of its paint"
    )
    yield from found.notices
    yield from (Notice(strokes[k].stroke, touching, code="marks-touch") for k in marks.touching)
    yield from (Notice(strokes[k].stroke, dry, code="mark-dry") for k in marks.dry)
