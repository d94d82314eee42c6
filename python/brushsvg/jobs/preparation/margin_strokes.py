"""A few strokes in the margin of a job's page: each sheet teaches the brush like a small chart.

They are in a strip that is added to the sheet above the drawing, so that every later step treats them as strokes of the
plan. Their tool path is set, not compensated. They are no part of the drawing: figures and corrections leave them out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from ...errors import Notice
from ...machine.paint_reload import in_loads
from ...machine.preflight import look
from ...machine.program import Job
from ...model.confidence import fitted_down_to_mm, law_band
from ...model.describe import LAWS
from ..work import Work

MARGIN_KIND = "margin"
DEPTH_COUNT = 3  # a straight stroke at the least, a corner at each of the others
# Room for a brush that nobody measured: it may trail and spread by half of it more or less.
LAG_FACTORS, WIDTH_FACTOR = (0.5, 1.0, 1.5), 1.5
EDGE_NOISE_MM = 0.1  # that edges are seen to in a photograph, for example of a chart
MIN_STROKE_WIDTH_MM = 0.02  # a stroke is as wide everywhere; where the brush just touches it paints nothing


def is_margin(one) -> bool:
    """Whether a stroke or a pass is one of the margin; None, for a part of a stroke, is not."""
    return one is not None and one.settings.kind == MARGIN_KIND


def is_calibrated(brush, deepest_mm: float) -> bool:
    """Whether lag and width were fitted to marks or measurements, down to this depth."""
    if brush.is_rigid() or not brush.width_follows_depth():
        return True  # there is no law to learn
    return all(deepest_mm <= fitted_down_to_mm(brush, law) for law in ("lag", "half_width"))


def add_margin_strokes(work: Work) -> Work:
    """Add margin strokes to the plan where they are requested, or where the brush is not calibrated.

    The work stays as it is, with a notice, where the sheet is too narrow or the cell cannot paint them.
    """
    requested, deepest_mm = work.options.margin_strokes, _find_deepest_mm(work.plan)
    if (
        requested == "off"
        or deepest_mm <= 0
        or (requested == "auto" and is_calibrated(work.brush, deepest_mm))
    ):
        return work
    if work.brush.is_rigid():
        return _warn_left_out(work, f"brush {work.brush.name} is a pen, which marks teach nothing")
    placed = _place_passes(work, deepest_mm)
    if placed is None:
        width = work.plan.sheet_mm[0]
        return _warn_left_out(work, f"the sheet is {width:g} mm wide, which is too narrow for them")
    passes, sheet_mm = placed
    was, brush = work.plan, work.brush
    alone = _core.Plan(was.brush, was.brush_sha256, sheet_mm, passes)
    if problems := _find_problems(alone, work):
        where, why = problems[0].where, problems[0].sentence
        return _warn_left_out(work, f"the cell cannot paint them: {where}: {why}")
    plan = _core.Plan(was.brush, was.brush_sha256, sheet_mm, [*was.passes, *passes], was.extra)
    drawn = _make_predicted_strokes(alone, brush)
    tracking_errors = _core.tracking_errors_of(passes, drawn, brush, work.options.tolerance_mm)
    return replace(
        work,
        plan=plan,
        strokes=[*work.strokes, *drawn],
        tracking_errors=(*work.tracking_errors, *tracking_errors),
    )


def remove_margin_strokes(work: Work, marks, as_run=None) -> tuple[Work, _core.Marks, _core.Plan | None]:
    """The same without strokes of the margin: the drawing's own. as_run: what the marks are of, where that differs."""
    if not any(map(is_margin, work.strokes or ())):
        return work, marks, as_run
    own = [k for k, stroke in enumerate(work.strokes) if not is_margin(stroke)]
    alone = _core.Marks()
    alone.passes = [marks.passes[k] for k in own]
    plans = [each and _replace_passes(each, [each.passes[k] for k in own]) for each in (work.plan, as_run)]
    errors = tuple(work.tracking_errors[k] for k in own) if work.tracking_errors else ()
    strokes = [work.strokes[k] for k in own]
    return replace(work, plan=plans[0], strokes=strokes, tracking_errors=errors), alone, plans[1]


def describe_expected_accuracy(work: Work) -> str:
    """Say how well lag and width will be known once the brush has learned from the margin strokes; "" without any."""
    from ...calibration.marks.from_marks import expected_brush

    passes = [each for each in work.plan.passes if is_margin(each)]
    if not passes or not hasattr(_core, "fit_marks"):
        return ""
    brush, _ = expected_brush(_replace_passes(work.plan, passes), work.brush, EDGE_NOISE_MM)
    depths = np.array([_find_deepest_mm(_replace_passes(work.plan, [each])) for each in passes])
    seconds = sum(
        np.hypot(*np.diff(each.poses_mm[:, :2], axis=0).T).sum() / each.speed_mm_s for each in passes
    )
    bands = {name: law_band(brush, name, depths)[0] for name, _ in LAWS}
    known = "; ".join(
        f"at {depth:.1f} mm depth lag +- {lag:.2f} mm and width +- {2 * half:.2f} mm"
        for depth, lag, half in zip(depths, bands["lag"], bands["half_width"], strict=True)
    )
    return (
        f"{len(passes)} margin strokes above the drawing take {seconds:.0f} s and teach brush {work.brush.name}. "
        "Paint the page, photograph it, and run brushsvg calibrate PHOTO --plan PLAN --prior BRUSH -o NEW.json. "
        f"Then you will know (95 %): {known}"
    )


def _replace_passes(plan, passes) -> _core.Plan:
    return _core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, passes, plan.extra)


def _find_deepest_mm(plan) -> float:
    return max((-float(np.min(each.poses_mm[:, 2])) for each in plan.passes), default=0.0)


def _warn_left_out(work: Work, why: str) -> Work:
    sentence = f"no strokes are added in the margin: {why}"
    advice = "--margin-strokes off leaves them out without this warning"
    notice = Notice("margin", sentence, code="margin-strokes-left-out", advice=advice)
    return replace(work, notices=(*work.notices, notice))


def _place_passes(work: Work, deepest_mm: float) -> tuple[list, tuple[float, float]] | None:
    """Passes in rows above the sheet, and the sheet with their strip; None where one is wider than the sheet."""
    from ...calibration.chart.layout import GAP_MM, angular, chart_depths, room_for, straight  # brings OpenCV

    brush, (width, height) = work.brush, work.plan.sheet_mm
    _, least, *deeper = chart_depths(
        brush, 1 + DEPTH_COUNT, deepest_mm
    )  # the shallowest mark is a hair that no photo shows
    drawn = [straight(brush, least), *(angular(brush, depth) for depth in deeper)]
    left, bottom, top, passes = 0.0, height + GAP_MM, height, []
    names, last = {each.stroke for each in work.plan.passes}, work.plan.passes[-1]
    free = (
        name for k in range(1, len(names) + DEPTH_COUNT + 1) if (name := f"{MARGIN_KIND}-{k}") not in names
    )
    speed = min(work.options.speed_of_all_mm_s or work.options.speed_mm_s, brush.max_speed_mm_s)
    for one, (x0, y0, x1, y1) in zip(drawn, room_for(brush, drawn, LAG_FACTORS, WIDTH_FACTOR), strict=True):
        if x1 - x0 > width:
            return None
        if left + x1 - x0 > width:
            left, bottom = 0.0, top + GAP_MM
        poses = one.poses_mm + np.array([left - x0, bottom - y0, 0.0])
        settings = _core.Settings(kind=MARGIN_KIND)
        passes.append(_core.Pass(next(free), poses, speed, last.layer, last.colour, settings))
        left, top = left + x1 - x0 + GAP_MM, max(top, bottom + y1 - y0)
    return passes, (width, float(np.ceil(top)))


def _find_problems(plan, work: Work) -> list[Notice]:
    if not (cell := work.options.cell):
        return []
    loads, marks = in_loads(plan, work.brush, cell), _core.simulate(plan, work.brush)
    return look(
        loads, work.brush, marks, cell, work.options.tolerance_mm, Job(work.options.z_offset_mm)
    ).problems


def _make_predicted_strokes(plan, brush) -> list:
    """What each pass is predicted to paint, as a stroke."""
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    strokes = []
    for a_pass, mark in zip(plan.passes, marks.passes, strict=True):
        widths = np.maximum(2 * brush.half_width(np.asarray(mark.depth_mm)), MIN_STROKE_WIDTH_MM)
        stroke = _core.Stroke.from_points(np.asarray(mark.contact_mm), widths, a_pass.stroke)
        stroke.wanted_mm, stroke.settings = mark.outline_mm, a_pass.settings
        stroke.layer, stroke.colour = a_pass.layer, a_pass.colour
        strokes.append(stroke)
    return strokes
