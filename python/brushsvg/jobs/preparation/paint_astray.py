"""Find strokes whose paint is visibly outside of the drawing.

Paint counts as outside if it is off by more than the error of the brush.
"""

from __future__ import annotations

import numpy as np

from ... import _core
from ...model.confidence import unseen_mm
from ...read.design import Notice

# As a fraction of half the width. Paint further outside of the drawing is visible as a bulge or a thorn.
MIN_OVERSPILL_RATIO = 0.5
_OUTLINE_TOLERANCE_MM = 0.05


def find_off_middle_line(painted, tracking_errors, brush, tolerance_mm: float) -> list[Notice]:
    """Report visible tracking errors above the tolerance.

    An error is visible if it exceeds the uncertainty of the brush.

    painted: strokes; None for strokes that leave their middle lines on purpose.
    tolerance_mm: the largest tracking error that is not reported.
    """
    notices = []
    for stroke, error in zip(painted, tracking_errors, strict=True):
        if stroke is None or error.within_tolerance:
            continue
        if error.largest_mm <= unseen_mm(brush, _find_mean_depth_mm(stroke, brush)):
            continue
        sentence = (
            f"tracking error {error.largest_mm:.3g} mm near {_format_place(error.at_mm)}, above the tolerance of "
            f"{tolerance_mm:g} mm"
        )
        cause = ": it turns too sharply there for the brush"
        notices.append(Notice(stroke.id, sentence + cause * error.has_turn_in_place, code="off-middle-line"))
    return notices


def find_paint_outside(targets, passes, brush) -> list[Notice]:
    """Report passes whose paint is outside of all that was drawn.

    These passes leave their middle lines on purpose, so that only their paint can be judged.

    targets: the target strokes.
    passes: one for each target; None for passes that are not checked.
    """
    checked = [(stroke, run) for stroke, run in zip(targets, passes, strict=True) if run is not None]
    if not checked:
        return []
    import shapely

    from ...strokes.swept_areas import region

    marks = _core.simulate(_core.Plan(sheet_mm=(1.0, 1.0), passes=[run for _, run in checked]), brush)
    _core.trace_outlines(marks, brush)
    shapes = [region(_core.unite(_core.target_outline(stroke, _OUTLINE_TOLERANCE_MM))) for stroke in targets]
    tree = shapely.STRtree(shapes)
    notices = []
    for (stroke, _), trace in zip(checked, marks.passes, strict=True):
        paint = region(_core.unite(list(trace.outline_mm)))
        drawn = shapely.union_all([shapes[k] for k in tree.query(paint)])
        half_mm = max(half for _, half in stroke.half_width)
        seen_mm = max(MIN_OVERSPILL_RATIO * half_mm, unseen_mm(brush, _find_mean_depth_mm(stroke, brush)))
        corners = shapely.points(shapely.get_coordinates(shapely.difference(paint, drawn)))
        away_mm = shapely.distance(corners, drawn) if len(corners) else np.zeros(1)
        if away_mm.max() > seen_mm:
            place = _format_place(shapely.get_coordinates(corners[away_mm.argmax()])[0])
            sentence = f"its paint is up to {away_mm.max():.2g} mm outside of what was drawn, near {place}"
            notices.append(Notice(stroke.id, sentence, code="paint-outside"))
    return notices


def _find_mean_depth_mm(stroke, brush) -> float:
    if not brush.width_follows_depth():
        return brush.paint_depth_mm
    half_mm = float(np.mean([half for _, half in stroke.half_width]))
    return brush.depth_for_half_width(float(np.clip(half_mm, *brush.half_width_range_mm())), stroke.id)


def _format_place(at_mm) -> str:
    return f"x {at_mm[0]:.1f}, y {at_mm[1]:.1f} mm"
