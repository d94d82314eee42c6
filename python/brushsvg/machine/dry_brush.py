"""Report where the brush has no paint left."""

from __future__ import annotations

from .. import _core
from ..errors import Notice
from .cells.cell import Cell
from .paint_reload import PlanInLoads, list_station_visits, load_length_mm, painted_mm


def report_missing_paint(brush: _core.Brush, cell: Cell) -> list[Notice]:
    """Report that a limit of narrowing has no effect.

    The cell has the limit, but the brush does not say how its marks narrow.
    """
    if not cell.reload or not cell.reload.narrower_percent or brush.paint:
        return []
    sentence = f"brush {brush.name} does not say how its marks narrow: narrower_percent of the cell has no effect"
    return [Notice("", sentence, code="paint-unknown", advice='measure it: "paint" of a brush file')]


def report_long_strokes(loads: PlanInLoads, brush: _core.Brush, cell: Cell) -> list[Notice]:
    """Report strokes with parts that are longer than a load of paint lasts.

    Strokes that must not be split are not reported.
    """
    if not cell.reload or cell.reload.when != "length":
        return []
    every_mm, deepest_mm = load_length_mm(brush, cell), brush.depth_range_mm[1]
    last_mm = every_mm + brush.lag(deepest_mm) + deepest_mm  # the brush lifts over its own mark
    sentence = "mm are painted without a place where the brush could be lifted, outside the range [0,"
    return [
        Notice(
            a_pass.stroke,
            f"{length_mm:.0f} {sentence} {every_mm:.4g}] mm that a load of paint lasts",
            code="load-too-long",
        )
        for a_pass in loads.loads
        if (length_mm := painted_mm(a_pass)) > last_mm and a_pass.settings.reload is not False
    ]


def report_dry_brush(loads: PlanInLoads, brush: _core.Brush, cell: Cell, first_stroke: int = 1) -> list[Notice]:
    """Report that the hairs run dry before the program fetches paint.

    A cell that counts the painted length fetches paint in time.
    """
    if not brush.paint or not brush.paint.lasts_mm or (cell.reload and cell.reload.when == "length"):
        return []
    visits_of_loads = list_station_visits(loads, cell, first_stroke) or ((),) * len(loads.loads)
    used_mm, longest_mm = 0.0, 0.0
    for a_pass, visits in list(zip(loads.loads, visits_of_loads, strict=True))[first_stroke - 1 :]:
        used_mm = painted_mm(a_pass) + (0.0 if visits else used_mm)
        longest_mm = max(longest_mm, used_mm)
    if longest_mm <= brush.paint.lasts_mm:
        return []
    sentence = (
        f"{longest_mm:.0f} mm are painted without fetching paint, outside the range [0, "
        f"{brush.paint.lasts_mm:.4g}] mm, after which brush {brush.name} runs dry"
    )
    advice = 'fetch paint in time: [reload] of the cell with when = "length", and [[stations]]'
    return [Notice("", sentence, code="paint-runs-out", advice=advice)]
