"""The same drawing painted with other brushes, the best first."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace

from ...show.evaluation import report
from ..options import Options
from ..prediction import predict
from .preparation import prepare


@dataclass(frozen=True)
class Suit:
    """One brush and a drawing. overlap: of all that was drawn, strokes that it cannot paint included; worst: the
    stroke it paints worst, with its overlap; None where it paints none."""

    brush: str
    overlap: float | None
    worst: str | None
    worst_overlap: float | None
    refused: int
    strokes: int
    why: str = ""  # the first stroke that is refused, and why


def suits(path: str | os.PathLike[str], options: Options, brushes, stage=lambda text: None) -> list[Suit]:
    """How well each brush paints a drawing, the best first."""
    found = []
    for brush in brushes:
        work = prepare(path, replace(options, brush=brush), stage, partly=True)
        marks = predict(work, outlines=False, stage=stage)
        drawn = [*work.strokes, *work.left_out]
        rows, total = report.measure(
            report.PaintedPlan(
                work.plan, marks, brush, work.strokes, options.tolerance_mm, drawn, options.compensation
            )
        )
        found.append(suit(brush.name, rows, total.overlap if rows else 0.0, work.refused))
    return best_first(found)


def suit(brush: str, rows, overlap: float | None, refused) -> Suit:
    """From the figures of a report; refused: notices of strokes."""
    known = [row for row in rows if row.overlap is not None]
    worst = min(known, key=lambda row: row.overlap, default=None)
    return Suit(
        brush,
        overlap,
        worst and worst.stroke,
        worst and worst.overlap,
        len(refused),
        len(rows) + len(refused),
        f"{refused[0].where}: {refused[0].text}" if refused else "",
    )


def best_first(suits: list[Suit]) -> list[Suit]:
    return sorted(suits, key=lambda each: (-(each.overlap or 0.0), each.brush))
