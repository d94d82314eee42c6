"""Plan a drawing: read it, find its strokes, limit their widths, compensate them."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ... import _core, read
from ...comparison.corrections import apply_corrections
from ...errors import Error
from ...machine.job_program import Job
from ...machine.limits.move_extents import ROUNDING_MM
from ...machine.limits.speeds import check_painting_speed
from ...machine.paint_reload import fetched_mm, split_into_loads
from ...machine.preflight import check_job, report_other_brush
from ...model.library import brush_names, find_brush
from ...model.unknown_keys import mistyped_keys
from ...planning.press_deeper import press_deeper
from ...planning.refinement import refine_where_better
from ...read import layout
from ...read.design import Design, Notice
from ...strokes.corners import lifted_at_corners
from ...strokes.extraction import strokes as strokes_of
from ...strokes.joining import join_lines, report_unjoined_lines
from ...strokes.stroke_search import search_strokes
from ...strokes.uncovered_areas import notices_of_areas, uncovered_areas
from ...strokes.wide_shapes import find_wide_lines, within_reach
from ...suggestions import did_you_mean
from ..json_files import read_plan
from ..options import DEFAULT_BRUSH, DEFAULTS, Options
from ..prepared_drawing import KnownSimulation, PreparedDrawing
from .colours import select_colour
from .compensated import fit_ends_to_machine, make_compensation
from .margin_strokes import add_margin_strokes
from .paint_astray import find_off_middle_line, find_paint_outside
from .thin_outlines import remove_thin_outlines
from .width_advice import add_width_advice

if TYPE_CHECKING:
    Source = read.Source | Design | _core.Plan


def prepare(
    source: Source,
    options: Options = DEFAULTS,
    stage: Callable[[str], object] = lambda text: None,
    partly: bool = False,
) -> PreparedDrawing:
    """Read a drawing or plan.json and plan the path of the TCP.

    source: a path, a Plan, a Design, or an open drawing as read_drawing accepts it.
    stage: called with words on the progress.
    partly: leave out strokes that are refused, instead of raising an error.

    Raises Error if the source cannot be read or painted.
    """
    work = _prepare_source(source, options, stage, partly)
    _refuse_invalid_colours(work.plan)
    return work if options.colour is None else select_colour(work, options.colour)


def _refuse_invalid_colours(plan) -> None:
    """Raise Error for the first pass whose colour is not "#rrggbb". Readers of drawings write no other colours."""
    for a_pass in plan.passes:
        if a_pass.colour and not re.fullmatch("#[0-9a-fA-F]{6}", a_pass.colour):
            raise Error(
                f"colour {a_pass.colour[:24]!r} is not written as #rrggbb", a_pass.stroke, code="colour-invalid"
            )


def _prepare_source(source: Source, options: Options, stage: Callable[[str], object], partly: bool) -> PreparedDrawing:
    if isinstance(source, _core.Plan):
        _core.write_plan(source)  # raises Error for a plan that is not valid as a file
        return _prepare_plan(source, options)
    if isinstance(source, str | os.PathLike) and Path(source).suffix.lower() == ".json":
        return _prepare_plan(read_plan(source), options)
    stage("reading")
    brush = options.brush or find_brush(DEFAULT_BRUSH)
    _check_speed(brush, options)
    design = layout.arrange(_read_design(source, options.reading), options.layout)
    notices = [*mistyped_keys(brush), *design.notices]
    try:
        return _plan_design(design, brush, options, stage, partly, notices)
    except Error as refusal:
        refusal.notices = tuple(notices)
        raise


def _plan_design(
    design: Design, brush, options: Options, stage, partly: bool, notices: list[Notice]
) -> PreparedDrawing:
    """Plan the strokes of a drawing that was read; notices: the drawing's warnings, extended here."""
    stage("finding strokes")
    on_cell = limit_depth(brush, options)
    found_strokes, stroke_notices = _find_strokes(design, on_cell, options)
    notices += stroke_notices
    if not partly:
        _refuse_wide_lines(found_strokes, on_cell)
    strokes = _limit_widths(found_strokes, on_cell, options, partly)
    compensated = make_compensation(brush, design.sheet_mm, options, stage)
    strokes, compensation = _compensate(strokes, compensated, partly)
    if _leads_paint(options):
        strokes, compensation = _search_strokes(strokes, compensation, on_cell, compensated, options)
    notices += strokes.notices
    planned = _refine(
        _plan_strokes(strokes, compensation, brush, compensated, options, stage), brush, compensated, options
    )
    strokes = _drop_left_out(strokes, planned)
    planned.plan = _set_requested_speed(_set_drawn_speeds(planned.plan, strokes.targets), options)
    tried_compensation = compensated if options.layout.width_mm is None else None
    line_elements = {stroke.origin.element for stroke in found_strokes if not stroke.target_mm}
    unreached, missed, outside = _find_stray_paint(strokes, planned, brush, options)
    notices += (
        *planned.notices,
        *add_width_advice(planned.painted, planned.done, on_cell, tried_compensation, line_elements),
        *_report_other_brushes(strokes.targets, brush),
        *notices_of_areas(unreached),
        *notices_of_areas(missed),
        *(outside if _leads_paint(options) else []),
    )
    work = PreparedDrawing(
        design.title,
        brush,
        planned.plan,
        strokes.targets,
        tuple(planned.tracking_errors),
        options,
        tuple(notices),
        tuple(strokes.refused),
        tuple(strokes.left_out),
        tuple(strokes.drawn),
        tuple(unreached),
        tuple(missed),
        tuple(notice.where for notice in outside),
        planned.known,
    )
    work = add_margin_strokes(work)
    return replace(work, plan=apply_corrections(work.plan, options.corrections, brush))


def _leads_paint(options: Options) -> bool:
    """Return whether the tool leads the paint, instead of following the drawn lines."""
    return options.compensation in ("closed", "refined")


def limit_depth(brush, options: Options):
    """Return the brush as the cell can press it: no deeper than its lowest height, and the end of its servo's table.

    A cell with a pen draws at one height. The brush is returned as it is, because no other width helps there.
    """
    cell = options.cell
    if cell is None or cell.pen or not brush.width_follows_depth():
        return brush
    lowest_mm = cell.heights.lowest_mm
    if cell.servo:
        lowest_mm = max(lowest_mm, min(height for height, _ in cell.servo.table) - options.z_offset_mm)
    least_mm, greatest_mm = brush.depth_range_mm
    if not least_mm + ROUNDING_MM < -lowest_mm < greatest_mm:
        return brush
    limited = copy(brush)
    limited.depth_range_mm = (least_mm, -lowest_mm - ROUNDING_MM)
    limited.name = f"{brush.name} on cell {cell.name}"  # for messages about widths
    return limited


@dataclass(frozen=True)
class _StrokeSet:
    """The strokes of a drawing at three stages, and what was refused or added.

    drawn: as found in the drawing.
    painted: as the brush will paint them.
    targets: the target of each painted stroke.
    notices: warnings on the strokes.
    refused, left_out: notices on the refused strokes, and the targets of these.
    added: ids of the strokes that the search added.
    """

    drawn: list
    painted: list
    targets: list
    notices: list[Notice]
    refused: list[Notice]
    left_out: list
    added: frozenset[str] = frozenset()


@dataclass
class _PlannedStrokes:
    """Strokes with their plan.

    painted, targets: as in _StrokeSet, but pressed deeper where paint runs out.
    done: the result of the compensation.
    moved: for each stroke whether refinement moved it.
    """

    painted: list
    targets: list
    done: _core.Compensated
    plan: _core.Plan
    tracking_errors: list
    moved: list[bool]
    notices: list[Notice]
    known: KnownSimulation | None


def _find_strokes(design: Design, brush, options: Options) -> tuple[list, list[Notice]]:
    """Return a design's strokes, joined and lifted at their corners as requested, and warnings."""
    outline_notices: list[Notice] = []
    if options.paths_as is None:
        design, outline_notices = remove_thin_outlines(design, brush)
    strokes, notices = strokes_of(design, options.paths_as, options.script)
    notices += outline_notices
    if options.join:
        strokes, joint_notices = join_lines(strokes)
        notices += joint_notices
    else:
        notices += report_unjoined_lines(strokes)
    if options.corners == "auto" and _leads_paint(options):
        strokes = lifted_at_corners(strokes, brush)
    return strokes, notices


def _fills_corners(options: Options) -> bool:
    """Return whether ends and turns may be chosen to fill the corners of a shape."""
    return (options.start, options.end, options.corners) == ("auto", "auto", "auto")


def _limit_widths(drawn: list, brush, options: Options, partly: bool) -> _StrokeSet:
    """Make strokes no wider than the brush."""
    strokes, refused, left_out = drawn, [], []
    if partly:
        strokes, _, refused, left_out = _separate_refused(
            strokes, strokes, lambda one: _refuse_wide_strokes(one, brush, options)
        )
    painted, targets, notices = within_reach(strokes, brush, options.wide, _leads_paint(options))
    return _StrokeSet(list(drawn), painted, targets, notices, refused, left_out)


def _search_strokes(
    lines: _StrokeSet, compensation, brush, compensated, options: Options
) -> tuple[_StrokeSet, _core.Compensated]:
    """Improve the strokes by a search, which also adds strokes."""
    search = search_strokes(
        lines.drawn,
        lines.painted,
        lines.targets,
        compensated,
        brush,
        options.detail,
        _fills_corners(options),
        options.wide != "clamp",
        compensation,
    )
    lines = replace(lines, drawn=search.drawn, painted=search.painted, targets=search.targets, added=search.added)
    return lines, search.done


def _compensate(lines: _StrokeSet, compensated, partly: bool) -> tuple[_StrokeSet, _core.Compensated]:
    try:
        return lines, compensated(lines.painted)
    except Error:
        if not partly:
            raise
    painted, targets, refused, left_out = _separate_refused(lines.painted, lines.targets, compensated)
    lines = replace(
        lines,
        painted=painted,
        targets=targets,
        refused=lines.refused + refused,
        left_out=lines.left_out + left_out,
    )
    return lines, compensated(lines.painted)


def _plan_strokes(lines: _StrokeSet, compensation, brush, compensated, options: Options, stage) -> _PlannedStrokes:
    """Choose ends that the machine can run, and press deeper as paint runs out."""
    painted, targets, notices, simulation, cell = lines.painted, lines.targets, [], None, options.cell
    if cell is not None and _leads_paint(options):
        fitting, simulation = fit_ends_to_machine(
            painted, brush, compensation.plan, compensated, options, stage, lines.added
        )
        if fitting is not painted:
            kept_ids = {stroke.id for stroke in fitting}
            targets = [target for target, stroke in zip(targets, painted, strict=True) if stroke.id in kept_ids]
            painted, compensation = fitting, compensated(fitting)
    if brush.paint and brush.width_follows_depth() and _leads_paint(options):

        def fetched(plan):
            return fetched_mm(plan, brush, cell)

        on_cell = limit_depth(brush, options)
        pressed = press_deeper(painted, targets, on_cell, compensation, compensated, fetched)
        painted, targets, compensation = pressed.painted, pressed.targets, pressed.done
        notices = pressed.notices
    return _PlannedStrokes(
        painted,
        targets,
        compensation,
        compensation.plan,
        compensation.tracking_errors,
        [False] * len(painted),
        notices,
        simulation,
    )


def _drop_left_out(lines: _StrokeSet, planned: _PlannedStrokes) -> _StrokeSet:
    """Remove added strokes for which the cell has no room."""
    left_out = lines.added - {stroke.id for stroke in planned.painted}
    drawn, targets = (
        [each for each in selected if each.id not in left_out] for selected in (lines.drawn, lines.targets)
    )
    return replace(lines, drawn=drawn, targets=targets)


def _refine(planned: _PlannedStrokes, brush, compensated, options: Options) -> _PlannedStrokes:
    """Refine the planned strokes if requested, so that marks are closer to targets."""
    if options.compensation != "refined":
        return planned
    forbidden = _make_limit_check(brush, options)
    refinement = refine_where_better(planned.painted, planned.targets, brush, planned.done, compensated, forbidden)
    planned.plan.passes = refinement.passes
    unmoved = refinement.nothing_moved()
    return replace(
        planned,
        tracking_errors=refinement.tracking_errors,
        moved=refinement.moved,
        notices=[*planned.notices, *([unmoved] if unmoved else [])],
    )


def _find_stray_paint(
    lines: _StrokeSet, planned: _PlannedStrokes, brush, options: Options
) -> tuple[list, list, list[Notice]]:
    """Find unpainted parts of shapes, and strokes with paint outside of the drawing.

    Returns the parts that no stroke reaches, and the parts that strokes reach and their marks do not. The third
    value has notices on strokes whose paint is outside of the drawing.
    """
    refused = {notice.where for notice in lines.refused}
    accepted = [stroke for stroke in lines.drawn if stroke.id not in refused]
    areas = uncovered_areas(accepted, planned.painted, list(planned.plan.passes), brush)
    unreached = [each for each in areas if not each.is_reached]
    missed = [each for each in areas if each.is_reached and _leads_paint(options)]
    return unreached, missed, _find_paint_outside(planned, brush, options)


def _refuse_wide_strokes(strokes: list, brush, options: Options) -> None:
    """Raise Error for the widest line beyond the brush, and for the first such shape with --wide refuse."""
    _refuse_wide_lines(strokes, brush)
    if options.wide == "refuse":
        within_reach(strokes, brush, options.wide)


def _refuse_wide_lines(strokes: list, brush) -> None:
    """Raise Error for the widest line beyond the brush, whose advice is enough for all lines.

    Lines come before filled shapes, which need more time.
    """
    wide_lines = find_wide_lines([stroke for stroke in strokes if not stroke.target_mm], brush)
    if wide_lines:
        stroke, half_mm = max(wide_lines, key=lambda line: line[1])
        brush.depth_for_half_width(half_mm, stroke.id)


def _read_design(source, reading: read.ReadOptions) -> Design:
    if not isinstance(source, Design):
        return read.read_drawing(source, reading)
    if reading.units or reading.select:
        sentence = "units and select are options for reading a file, and a Design was already read"
        raise Error(sentence, code="options-contradict")
    return source if reading.sheet_mm is None else replace(source, sheet_mm=reading.sheet_mm)


def _make_limit_check(brush, options: Options):
    """Return a function from a plan to notices on why the cell cannot run it, or None without a cell."""
    if options.cell is None:
        return None
    cell, job = options.cell, Job(options.z_offset_mm)

    def sentences(plan) -> list:
        loads, marks = split_into_loads(plan, brush, cell), _core.simulate(plan, brush)
        return check_job(loads, brush, marks, cell, options.tolerance_mm, job, with_advice=False).problems

    return sentences


def _separate_refused(painted, targets, step):
    """Try a step on each stroke alone, and separate the strokes that it refuses.

    Returns the accepted strokes, their targets, notices on the refused strokes, and the targets of these.
    """
    accepted, refused, left_out = [], [], []
    for pair in zip(painted, targets, strict=True):
        try:
            step(pair[:1])
        except Error as error:
            refused.append(error.notice(pair[0].id))
            left_out.append(pair[1])
        else:
            accepted.append(pair)
    return [stroke for stroke, _ in accepted], [stroke for _, stroke in accepted], refused, left_out


def _set_drawn_speeds(plan, strokes):
    """Set the speeds of a plan that the settings of the drawing request."""
    speeds = [stroke.settings.speed_mm_s for stroke in strokes]
    if any(speeds):
        for a_pass, speed in zip(plan.passes, speeds, strict=True):
            a_pass.speed_mm_s = speed or a_pass.speed_mm_s
    return plan


def _check_speed(brush, options: Options) -> None:
    """Raise Error if the requested speed is outside the limits of the brush or cell."""
    if options.speed_of_all_mm_s is not None:
        for notice in check_painting_speed(options.speed_of_all_mm_s, brush, options.cell):
            raise Error(notice.sentence, code=notice.code)


def _set_requested_speed(plan, options: Options):
    """Set the speed of all passes of a plan, if one was requested."""
    if options.speed_of_all_mm_s is not None:
        for a_pass in plan.passes:
            a_pass.speed_mm_s = options.speed_of_all_mm_s
    return plan


def _report_other_brushes(strokes, brush) -> list[Notice]:
    brushes = ((stroke.id, stroke.settings.brush or brush.name) for stroke in strokes)
    return [
        Notice(
            name,
            f"the drawing asks for brush {other}, all is painted with {brush.name}",
            code="brush-asked-for",
        )
        for name, other in brushes
        if other != brush.name
    ]


def _find_paint_outside(planned: _PlannedStrokes, brush, options: Options) -> list[Notice]:
    """Report strokes whose paint is outside of the drawing.

    The paint is judged where a stroke has no drawn middle line, as in a shape, and where refinement leaves the
    middle line on purpose. Other strokes are judged by their tracking errors.
    """
    shapes = {stroke.origin.element for stroke in planned.targets if stroke.target_mm}
    by_paint = [
        is_moved or stroke.origin.element in shapes
        for stroke, is_moved in zip(planned.targets, planned.moved, strict=True)
    ]
    lines = [None if is_by_paint else stroke for stroke, is_by_paint in zip(planned.painted, by_paint, strict=True)]
    is_off_tolerance = [
        is_by_paint and not error.within_tolerance
        for is_by_paint, error in zip(by_paint, planned.tracking_errors, strict=True)
    ]
    runs = [run if is_off else None for run, is_off in zip(planned.plan.passes, is_off_tolerance, strict=True)]
    return [
        *find_off_middle_line(lines, planned.tracking_errors, brush, options.tolerance_mm),
        *find_paint_outside(planned.targets, runs, brush),
    ]


def _prepare_plan(plan, options: Options) -> PreparedDrawing:
    if not options.brush and plan.brush not in brush_names() and not plan.brush.endswith(".json"):
        names = brush_names()
        sentence = (
            f"the plan was made for brush {plan.brush!r}, whose file is not known{did_you_mean(plan.brush, names)} "
            f"Known are {', '.join(names)}"
        )
        raise Error(sentence, "brush", code="brush-unknown", advice="give --brush FILE")
    brush = options.brush or find_brush(plan.brush)
    notices = mistyped_keys(brush) + report_other_brush(plan, brush)
    _check_speed(brush, options)
    plan = _set_requested_speed(copy(plan), options)  # a Plan that was made in Python belongs to its caller
    return PreparedDrawing(
        "", brush, apply_corrections(plan, options.corrections, brush), None, (), options, tuple(notices)
    )
