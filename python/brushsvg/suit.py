"""Does this brush suit this drawing: other sizes tried on a few strokes, other brushes on all of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import _core
from .errors import Error
from .reach import within_reach

SCALES = (0.35, 0.5, 0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0, 2.8)
TRIED = 16  # strokes of a drawing: bounds the time to half a second
WORTH = 0.01  # of overlap: less is not worth another size
ALIKE = 0.005  # sizes that differ by less are as good, and the nearest to the drawing's is named


@dataclass(frozen=True)
class Size:
    """What a drawing would come to at other sizes. overlaps: by the factor, of a few strokes, refused ones painted as
    nothing; best: the factor to be advised, 1 where none is noticeably better."""

    overlaps: dict[float, float]
    best: float
    tried: int
    strokes: int


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


def best_size(strokes, brush, tolerance_mm: float = 0.05) -> Size:
    """Tries the scales on strokes chosen evenly from all, alone each: letters and neighbours do not count."""
    some = [strokes[k] for k in np.unique(np.linspace(0, len(strokes) - 1, TRIED).round().astype(int))]
    found = {factor: _overlap_at(factor, some, brush, tolerance_mm) for factor in SCALES}
    most = max(found.values())
    best = 1.0
    if most > found[1.0] + WORTH:
        best = min((f for f in found if found[f] > most - ALIKE), key=lambda f: abs(np.log(f)))
    return Size(found, best, len(some), len(strokes))


def advice(size: Size, scale: float | None = 1.0) -> str:
    """A sentence for people, "" where no size can be painted. scale: what was asked of --scale; None where the size is
    given in another way."""
    if not any(size.overlaps.values()):
        return ""
    sample = f"tried on {size.tried} of {size.strokes} strokes" if size.tried < size.strokes else "tried"
    if size.best == 1.0:
        return (
            f"Size: none from {SCALES[0]:g} to {SCALES[-1]:g} times this one is noticeably better ({sample})."
        )
    flag = f"; --scale {size.best * scale:.4g}" if scale is not None else ""
    return (
        f"Size: drawn {size.best:g} times as large the overlap of single strokes would be about "
        f"{size.overlaps[size.best]:.2f} in place of {size.overlaps[1.0]:.2f} ({sample}{flag})."
    )


def _overlap_at(factor: float, strokes, brush, tolerance_mm: float) -> float:
    common = together = 0.0
    for stroke in strokes:
        try:
            painted, wanted, _ = within_reach([scaled(stroke, factor)], brush)
            plan = _core.compensate(painted, brush, (1.0, 1.0), "closed", tolerance_mm).plan
            found = _core.common_area(_core.simulate(plan, brush).passes, wanted, brush)
        except Error:  # not to be painted at this size: all of it is missing
            found = _core.common_area([], [scaled(stroke, factor)], brush)
        common += found.common_mm2
        together += found.together_mm2
    return common / together if together > 0 else 1.0


def scaled(stroke, factor: float):
    """The stroke so many times as large, widths too."""
    half_width = [(at, half * factor) for at, half in stroke.half_width]
    made = _core.Stroke(stroke.id, np.asarray(stroke.middle_mm) * factor, stroke.closed, half_width)
    made.wanted_mm = [ring * factor for ring in stroke.wanted_mm]
    return made


def suit(brush: str, rows, overlap: float | None, refused) -> Suit:
    """From the figures of a report; refused: (stroke, why)."""
    known = [row for row in rows if row.overlap is not None]
    worst = min(known, key=lambda row: row.overlap, default=None)
    return Suit(
        brush,
        overlap,
        worst and worst.stroke,
        worst and worst.overlap,
        len(refused),
        len(rows) + len(refused),
        ": ".join(refused[0]) if refused else "",
    )


def best_first(suits: list[Suit]) -> list[Suit]:
    return sorted(suits, key=lambda each: (-(each.overlap or 0.0), each.brush))
