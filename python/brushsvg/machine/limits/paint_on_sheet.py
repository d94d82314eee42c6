"""The bounds of the paint, and whether it stays on the sheet."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ..realised.arc_chords import with_chords

# Largest ratio of the shift of a mark's edge to the shift of the tool. A lag grows by 3 mm per mm of depth.
_MAX_EDGE_SHIFT_RATIO = 5.0


def find_paint_off_sheet(
    marks: _core.Marks, brush: _core.Brush, sheet_mm, of_drawing: bool = True, rounded_mm: float = 0.0
) -> list[Notice]:
    """Report each edge of the sheet that the paint of a stroke crosses.

    sheet_mm: width and height of the sheet [mm].
    of_drawing: whether the plan was made from a drawing, which flags can move. Flags have no effect on a plan.
    rounded_mm: shift of the tool from its plan by rounding. It may move the edge of a mark further.
    """
    notices = []
    advice = (
        "move the drawing or make room with --origin X,Y, --sheet WxH or --fit WxH"
        if of_drawing
        else "make the plan again, from a drawing that is moved or has more room"
    )
    for trace in marks.passes:
        bounds_mm = _core.painted_bounds(trace, brush)
        if not np.isfinite(bounds_mm).all():
            continue  # nothing touches the paper
        notices += [
            Notice(
                trace.stroke,
                f"the mark reaches {beyond:.2f} mm beyond the {side} edge of the sheet",
                code="mark-off-sheet",
                about=side,
                advice=advice,
                excess=beyond,
            )
            for side, beyond in distances_beyond_edges(bounds_mm, sheet_mm).items()
            if beyond
            >= 0.005 + _MAX_EDGE_SHIFT_RATIO * rounded_mm  # a value that would print as 0.00 mm is rounding, not paint
        ]
    return notices


def bounds_mm(marks: _core.Marks, brush: _core.Brush) -> tuple[float, float, float, float]:
    """Return left, bottom, right and top of all paint [mm]. Raises Error if nothing touches the paper."""
    bounds = np.array([_core.painted_bounds(trace, brush) for trace in marks.passes]).reshape(-1, 4)
    bounds = bounds[np.isfinite(bounds).all(axis=1)]
    if not len(bounds):
        raise Error("nothing touches the paper: there is no border", code="nothing-painted")
    return (*bounds[:, :2].min(axis=0).tolist(), *bounds[:, 2:].max(axis=0).tolist())


def job_bounds_mm(plan: _core.Plan, marks: _core.Marks, brush: _core.Brush) -> tuple[float, float, float, float]:
    """Return left, bottom, right and top of all paint and of the tool's path [mm].

    The tool's path enters strokes from outside of them. Raises Error if nothing touches the paper.
    """
    left, bottom, right, top = bounds_mm(marks, brush)
    path_mm = np.vstack([with_chords(a_pass).poses_mm[:, :2] for a_pass in plan.passes])
    (x0, y0), (x1, y1) = path_mm.min(axis=0).tolist(), path_mm.max(axis=0).tolist()
    return (min(left, x0), min(bottom, y0), max(right, x1), max(top, y1))


def distances_beyond_edges(bounds_mm, sheet_mm) -> dict[str, float]:
    """Return how far [mm] bounds reach beyond each edge of the sheet.

    bounds_mm: left, bottom, right and top. The distances are negative inside the sheet.
    """
    left, bottom, right, top = bounds_mm
    width, height = sheet_mm
    return {"left": -left, "right": right - width, "lower": -bottom, "upper": top - height}
