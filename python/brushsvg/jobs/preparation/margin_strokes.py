"""Strokes in the margin of a job's page, from which the brush is calibrated.

Each painted sheet thus serves as a small chart. The strokes are in a strip that is added to the sheet above the
drawing. Every later step therefore treats them as strokes of the plan. Their tool path is set, not compensated.
They are no part of the drawing: figures and corrections leave them out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from ...errors import Notice
from ...machine.job_program import Job
from ...machine.paint_reload import split_into_loads
from ...machine.preflight import check_job
from ...model.confidence import fitted_down_to_mm, law_band
from ...model.describe import LAWS
from ..prepared_drawing import PreparedDrawing
from .colours import select_colour

MARGIN_KIND = "margin"
DEPTH_COUNT = 3  # a straight stroke at the smallest depth, and a corner at each of the other depths
# Room for a brush that was not measured: its lag and its width may be larger or smaller by half.
LAG_FACTORS, WIDTH_FACTOR = (0.5, 1.0, 1.5), 1.5
EDGE_NOISE_MM = 0.1  # standard deviation of an edge in a photograph, for example of a chart
# The width of a target stroke where the brush just touches and paints nothing: a stroke has a width everywhere.
MIN_STROKE_WIDTH_MM = 0.02


def is_margin(stroke) -> bool:
    """Return whether a stroke or pass is in the margin. None, which stands for a part of a stroke, is not."""
    return stroke is not None and stroke.settings.kind == MARGIN_KIND


def is_calibrated(brush, deepest_mm: float) -> bool:
    """Return whether lag and width were fitted to data down to this depth. The data are marks or measurements."""
    if brush.is_rigid() or not brush.width_follows_depth():
        return True  # there is no law to fit
    return all(deepest_mm <= fitted_down_to_mm(brush, law) for law in ("lag", "half_width"))


def add_margin_strokes(work: PreparedDrawing) -> PreparedDrawing:
    """Add margin strokes where they are requested or the brush is not calibrated.

    The work stays as it is, with a notice, where the sheet is too narrow or the cell cannot paint the strokes.
    """
    requested, colour = work.options.margin_strokes, work.options.colour
    # Only strokes of this colour stay in the job, so the margin strokes have this colour and its depths.
    painted_plan = work.plan if colour is None else select_colour(work, colour).plan
    deepest_mm = _find_deepest_mm(painted_plan)
    if requested == "off" or deepest_mm <= 0 or (requested == "auto" and is_calibrated(work.brush, deepest_mm)):
        return work
    if work.brush.is_rigid():
        return _warn_left_out(work, f"brush {work.brush.name} is a pen, and the strokes only help to calibrate a brush")
    placement = _place_passes(work, deepest_mm, painted_plan.passes[-1])
    if placement is None:
        width = work.plan.sheet_mm[0]
        return _warn_left_out(work, f"the sheet is {width:g} mm wide, too narrow for them")
    passes, sheet_mm = placement
    drawn_plan, brush = work.plan, work.brush
    margin_plan = _core.Plan(drawn_plan.brush, drawn_plan.brush_sha256, sheet_mm, passes)
    if problems := _find_problems(margin_plan, work):
        where, why = problems[0].where, problems[0].sentence
        return _warn_left_out(work, f"the cell cannot paint them: {where}: {why}")
    plan = _core.Plan(
        drawn_plan.brush, drawn_plan.brush_sha256, sheet_mm, [*drawn_plan.passes, *passes], drawn_plan.extra
    )
    margin_strokes = _make_predicted_strokes(margin_plan, brush)
    tracking_errors = _core.tracking_errors_of(passes, margin_strokes, brush, work.options.tolerance_mm)
    return replace(
        work,
        plan=plan,
        strokes=[*work.strokes, *margin_strokes],
        tracking_errors=(*work.tracking_errors, *tracking_errors),
    )


def remove_margin_strokes(
    work: PreparedDrawing, marks, as_run=None
) -> tuple[PreparedDrawing, _core.Marks, _core.Plan | None]:
    """Return work, marks and plan without the strokes of the margin.

    as_run: the plan that the marks belong to, where it differs from the plan of the work.
    """
    if not any(map(is_margin, work.strokes or ())):
        return work, marks, as_run
    drawn_rows = [k for k, stroke in enumerate(work.strokes) if not is_margin(stroke)]
    drawn_marks = _core.Marks()
    drawn_marks.passes = [marks.passes[k] for k in drawn_rows]
    plans = [each and _replace_passes(each, [each.passes[k] for k in drawn_rows]) for each in (work.plan, as_run)]
    errors = tuple(work.tracking_errors[k] for k in drawn_rows) if work.tracking_errors else ()
    strokes = [work.strokes[k] for k in drawn_rows]
    return replace(work, plan=plans[0], strokes=strokes, tracking_errors=errors), drawn_marks, plans[1]


def describe_expected_accuracy(work: PreparedDrawing) -> str:
    """Describe how well the margin strokes will determine lag and width.

    Returns "" if the work has no margin strokes.
    """
    from ...calibration.marks.from_marks import expected_brush

    passes = [each for each in work.plan.passes if is_margin(each)]
    if not passes or not hasattr(_core, "fit_marks"):
        return ""
    brush, _ = expected_brush(_replace_passes(work.plan, passes), work.brush, EDGE_NOISE_MM)
    depths = np.array([_find_deepest_mm(_replace_passes(work.plan, [each])) for each in passes])
    seconds = sum(np.hypot(*np.diff(each.poses_mm[:, :2], axis=0).T).sum() / each.speed_mm_s for each in passes)
    bands = {name: law_band(brush, name, depths)[0] for name, _ in LAWS}
    accuracies = "; ".join(
        f"at {depth:.1f} mm depth lag +- {lag:.2f} mm and width +- {2 * half_width:.2f} mm"
        for depth, lag, half_width in zip(depths, bands["lag"], bands["half_width"], strict=True)
    )
    return (
        f"{len(passes)} margin strokes above the drawing take {seconds:.0f} s and help to calibrate brush "
        f"{work.brush.name}. "
        "Paint the page, photograph it, and run brushsvg calibrate PHOTO --plan PLAN --prior BRUSH -o NEW.json. "
        f"Then you will know (95 %): {accuracies}"
    )


def _replace_passes(plan, passes) -> _core.Plan:
    return _core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, passes, plan.extra)


def _find_deepest_mm(plan) -> float:
    return max((-float(np.min(each.poses_mm[:, 2])) for each in plan.passes), default=0.0)


def _warn_left_out(work: PreparedDrawing, why: str) -> PreparedDrawing:
    sentence = f"no strokes are added in the margin: {why}"
    advice = "--margin-strokes off leaves them out without this warning"
    notice = Notice("margin", sentence, code="margin-strokes-left-out", advice=advice)
    return replace(work, notices=(*work.notices, notice))


def _place_passes(work: PreparedDrawing, deepest_mm: float, last_pass) -> tuple[list, tuple[float, float]] | None:
    """Place the passes in rows above the sheet.

    last_pass: the pass of the job before them, which gives them its layer and colour.

    Returns the passes and the size of the sheet with their strip, or None if a pass is wider than the sheet.
    """
    # The chart layout imports OpenCV, which is not needed without margin strokes.
    from ...calibration.chart.layout import (
        GAP_MM,
        chart_depths,
        find_mark_boxes,
        make_angular_stroke,
        make_straight_stroke,
    )

    brush, (width, height) = work.brush, work.plan.sheet_mm
    # The shallowest mark is too thin to be visible in a photograph.
    _, shallowest, *deeper = chart_depths(brush, 1 + DEPTH_COUNT, deepest_mm)
    charted = [make_straight_stroke(brush, shallowest), *(make_angular_stroke(brush, depth) for depth in deeper)]
    left, bottom, top, passes = 0.0, height + GAP_MM, height, []
    names = {each.stroke for each in work.plan.passes}
    free_names = (name for k in range(1, len(names) + DEPTH_COUNT + 1) if (name := f"{MARGIN_KIND}-{k}") not in names)
    speed = min(work.options.speed_of_all_mm_s or work.options.speed_mm_s, brush.max_speed_mm_s)
    for a_pass, (x0, y0, x1, y1) in zip(
        charted, find_mark_boxes(brush, charted, LAG_FACTORS, WIDTH_FACTOR), strict=True
    ):
        if x1 - x0 > width:
            return None
        if left + x1 - x0 > width:
            left, bottom = 0.0, top + GAP_MM
        poses = a_pass.poses_mm + np.array([left - x0, bottom - y0, 0.0])
        settings = _core.Settings(kind=MARGIN_KIND)
        passes.append(_core.Pass(next(free_names), poses, speed, last_pass.layer, last_pass.colour, settings))
        left, top = left + x1 - x0 + GAP_MM, max(top, bottom + y1 - y0)
    return passes, (width, float(np.ceil(top)))


def _find_problems(plan, work: PreparedDrawing) -> list[Notice]:
    if not (cell := work.options.cell):
        return []
    loads, marks = split_into_loads(plan, work.brush, cell), _core.simulate(plan, work.brush)
    return check_job(loads, work.brush, marks, cell, work.options.tolerance_mm, Job(work.options.z_offset_mm)).problems


def _make_predicted_strokes(plan, brush) -> list:
    """Return the predicted mark of each pass as a stroke."""
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    strokes = []
    for a_pass, mark in zip(plan.passes, marks.passes, strict=True):
        widths = np.maximum(2 * brush.half_width(np.asarray(mark.depth_mm)), MIN_STROKE_WIDTH_MM)
        stroke = _core.Stroke.from_points(np.asarray(mark.contact_mm), widths, a_pass.stroke)
        stroke.target_mm, stroke.settings = mark.outline_mm, a_pass.settings
        stroke.layer, stroke.colour = a_pass.layer, a_pass.colour
        strokes.append(stroke)
    return strokes
