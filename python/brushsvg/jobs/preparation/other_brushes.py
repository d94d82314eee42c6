"""Rank other brushes by how well they would paint the same drawing."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace

from ...show.evaluation.figures import PaintedPlan, measure_figures
from ..options import Options
from ..prediction import predict
from .preparation import prepare


@dataclass(frozen=True)
class BrushRating:
    """How well one brush paints a drawing.

    overlap: with all that was drawn, including strokes that the brush cannot paint.
    worst, worst_overlap: the stroke with the smallest overlap, and that overlap; None if the brush paints no
        stroke.
    refused, strokes: numbers of strokes.
    """

    brush: str
    overlap: float | None
    worst: str | None
    worst_overlap: float | None
    refused: int
    strokes: int
    why: str = ""  # the first refused stroke, and the reason


def rank_brushes(path: str | os.PathLike[str], options: Options, brushes, stage=lambda text: None) -> list[BrushRating]:
    """Return how well each brush paints a drawing, the best brush first."""
    results = []
    for brush in brushes:
        work = prepare(path, replace(options, brush=brush), stage, partly=True)
        marks = predict(work, outlines=False, stage=stage)
        drawn = [*work.strokes, *work.left_out]
        rows, total = measure_figures(
            PaintedPlan(work.plan, marks, brush, work.strokes, options.tolerance_mm, drawn, options.compensation)
        )
        results.append(rate_brush(brush.name, rows, total.overlap if rows else 0.0, work.refused))
    return sort_best_first(results)


def rate_brush(brush: str, rows, overlap: float | None, refused) -> BrushRating:
    """Return how well a brush paints a drawing, from the rows of a report.

    refused: notices on the strokes that the brush cannot paint.
    """
    measured = [row for row in rows if row.overlap is not None]
    worst = min(measured, key=lambda row: row.overlap, default=None)
    return BrushRating(
        brush,
        overlap,
        worst and worst.stroke,
        worst and worst.overlap,
        len(refused),
        len(rows) + len(refused),
        f"{refused[0].where}: {refused[0].text}" if refused else "",
    )


def sort_best_first(ratings: list[BrushRating]) -> list[BrushRating]:
    return sorted(ratings, key=lambda each: (-(each.overlap or 0.0), each.brush))
