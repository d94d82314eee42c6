"""A file to its plan: read, strokes found, brought within reach, compensated."""

from __future__ import annotations

import os
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .. import _core, drawing
from ..brush.library import find_brush, mistyped_keys
from ..drawing import layout
from ..drawing.design import Design, Notice
from ..errors import Error
from ..machine.cell import LEAST_SPEED_MM_S, Cell
from ..machine.paint_reload import PlanInLoads, fetched_mm, in_loads, is_later_part
from ..machine.preflight import DEFAULT_TOLERANCE_MM, as_exact_as, look, within_limits
from ..machine.program import POSES_KEPT, WHOLE_JOB, Job, Walked
from ..painted.corrections import Correction, beside_machine, corrected
from ..planning import travel_order
from ..planning.paint_running_out import pressed_deeper
from ..planning.refinement import refined
from ..strokes.corners import lifted_at_corners
from ..strokes.extraction import strokes as strokes_of
from ..strokes.joining import joined
from ..strokes.left_limbs import with_left_limbs
from ..strokes.outline_corners import squared_at_corners
from ..strokes.unreached import left_blank, missed, unreached
from ..strokes.unreached import notices as blank_notices
from ..strokes.wide_shapes import within_reach
from .json_files import read_plan
from .paint_astray import off_middle_line, outside

if TYPE_CHECKING:
    Source = drawing.Source | Design | _core.Plan

DEFAULT_BRUSH = "round-6"


@dataclass(frozen=True)
class Options:
    """What may be chosen. brush None: round-6, or the one a plan names; the rest has no effect on a plan."""

    brush: _core.Brush | None = None
    reading: drawing.ReadOptions = drawing.AS_DRAWN
    layout: layout.Layout = layout.AS_DRAWN
    compensation: str = "closed"
    lag_mm: float | None = None
    tolerance_mm: float = DEFAULT_TOLERANCE_MM
    speed_mm_s: float = 20.0  # of painting, where the drawing does not say; at most the brush's
    speed_of_all_mm_s: float | None = None  # whatever the drawing or the plan says
    start: str = "auto"  # of strokes, where the drawing does not say: "exposed", "hidden", "squared", "auto"
    end: str = "auto"  # the same: "lifted", "squared", "auto"
    paths_as: str | None = None  # "stroke", "outline": what every path is, whatever the drawing says
    wide: str = "auto"  # outlines wider than the brush: "auto", "clamp", "passes", "refuse"
    corners: str = "auto"  # "auto": lifted at sharp corners where the mark is better; "turn": never
    join: bool = False  # lines that meet end to end are one stroke
    cell: Cell | None = None  # whose limits no refined stroke breaks, unless its closed form does
    z_offset_mm: float = 0.0  # of the paper, against the cell's
    corrections: tuple[Correction, ...] = ()  # by which a painted sheet showed that strokes lie elsewhere

    def __post_init__(self):
        if self.cell is not None:  # from here on it is as exact as the plan
            object.__setattr__(self, "cell", as_exact_as(self.cell, self.tolerance_mm))
        left = beside_machine(self.corrections, self.cell.machine if self.cell else None)
        object.__setattr__(self, "corrections", left)


@dataclass(frozen=True)
class Known:
    """What was found of a plan as it then was, a copy: its marks, without outlines and freshly dipped, and limits."""

    plan: _core.Plan
    marks: _core.Marks
    walk: Walked


@dataclass(frozen=True)
class Work:
    """A file understood: strokes is None where IN was a plan, which does not say what was wanted.

    plan: with corrections. tracking_errors: one per pass of the plan without them, () for a plan read from a file;
    refused: strokes that were left out.
    """

    title: str
    brush: _core.Brush
    plan: _core.Plan
    strokes: list[_core.Stroke] | None
    tracking_errors: tuple
    options: Options
    notices: tuple[Notice, ...]
    refused: tuple[Notice, ...] = ()
    left_out: tuple = ()  # the strokes that were refused, as they were wanted
    drawn: tuple = ()  # all strokes, before they were brought within the brush's reach
    unreached: tuple = ()  # pieces of filled shapes that no stroke reaches
    missed: tuple = ()  # pieces that strokes reach and the mark does not
    astray: tuple = ()  # names of strokes whose paint lies visibly elsewhere
    known: Known | None = None  # of the plan, or of what it was before something of it changed

    def marks(self) -> _core.Marks | None:
        """Of the plan, where they are known: not to be changed."""
        return self.known.marks if self._is_known() else None

    def walk(self, cell: Cell, job: Job = WHOLE_JOB) -> Walked | None:
        """The plan with the limits that it breaks, where these are known of such a job."""
        known = self.known.walk if self._is_known() else None
        return known if known and cell == self.options.cell and replace(known.job, visits=()) == job else None

    def _is_known(self) -> bool:
        return self.known is not None and not self.brush.paint and self.known.plan == self.plan


def prepare(
    source: Source,
    options: Options = Options(),
    stage: Callable[[str], object] = lambda text: None,
    partly: bool = False,
) -> Work:
    """Read a drawing or plan.json and lay out the TCP's path. source: the path of one, a Plan, a Design, or an open
    drawing as read_drawing takes it. Error when it cannot be read or painted; partly: strokes that are refused are left
    out."""
    if isinstance(source, _core.Plan):
        return _prepare_plan(source, options)
    if isinstance(source, str | os.PathLike) and Path(source).suffix.lower() == ".json":
        return _prepare_plan(read_plan(source), options)
    stage("reading")
    brush = options.brush or find_brush(DEFAULT_BRUSH)
    _check_speed(brush, options)
    design = layout.arrange(_design(source, options.reading), options.layout)
    stage("finding strokes")
    strokes, notices = strokes_of(design, options.paths_as)
    if options.join:
        strokes, joints = joined(strokes)
        notices += joints
    leads = options.compensation in ("closed", "refined")
    may_lift = options.corners == "auto" and leads
    fills_corners = may_lift and (options.start, options.end) == ("auto", "auto")
    if may_lift:
        strokes = lifted_at_corners(strokes, brush)
    if fills_corners:
        strokes = squared_at_corners(strokes, brush)
    refused, left_out, drawn = [], [], tuple(strokes)
    if partly and options.wide == "refuse":
        strokes, _, refused, left_out = _sorted_out(
            strokes, strokes, lambda some: within_reach(some, brush, options.wide)
        )
    painted, strokes, clamped = within_reach(strokes, brush, options.wide)
    notices += clamped
    if leads:
        drawn, painted, strokes = with_left_limbs(list(drawn), painted, strokes, brush, fills_corners)
    compensated = _way(brush, design.sheet_mm, options, stage)
    try:
        done = compensated(painted)
    except Error:
        if not partly:
            raise
        painted, strokes, why, which = _sorted_out(painted, strokes, compensated)
        refused += why
        left_out += which
        done = compensated(painted)
    known = None
    if options.cell is not None and leads:
        fitting, known = _begun_within_reach(painted, brush, done.plan, compensated, options, stage)
        if fitting is not painted:
            painted, done = fitting, compensated(fitting)
    asked = strokes
    if brush.paint and brush.width_follows_depth() and leads:
        cell = options.cell
        lowest_mm = cell.heights.lowest_mm if cell else -np.inf
        pressed = pressed_deeper(
            painted,
            strokes,
            brush,
            done,
            compensated,
            lambda plan: fetched_mm(plan, brush, cell),
            lowest_mm,
        )
        painted, asked, done = pressed.painted, pressed.wanted, pressed.done
        notices += pressed.told
    plan, tracking_errors, moved = done.plan, done.misses, [False] * len(painted)
    if options.compensation == "refined":
        better = refined(painted, asked, brush, done, compensated, _forbidden(brush, options))
        plan.passes, tracking_errors, moved = better.passes, better.tracking_errors, better.moved
        notices += [told] if (told := better.nothing_moved()) else []
    plan = _at_speed(_with_speeds(plan, strokes), options)
    told = _widths(painted, done, brush, compensated if options.layout.width_mm is None else None)
    notices = [*mistyped_keys(brush), *design.notices, *notices, *told]
    notices += _other_brushes(strokes, brush)
    without = {notice.where for notice in refused}
    planned = [stroke for stroke in drawn if stroke.id not in without]
    bare, blank = unreached(planned, painted, brush), []
    if leads and any(stroke.wanted_mm for stroke in planned):  # of shapes alone it is asked what stays blank
        traces = _core.simulate(plan, brush).passes
        bare = left_blank(bare, painted, traces, brush)
        blank = missed(planned, painted, traces, bare, brush)
    notices += blank_notices(bare)
    astray = _astray(painted, asked, plan, tracking_errors, moved, brush, options)
    if leads:
        notices += blank_notices(blank, is_reached=True) + astray
    return Work(
        design.title,
        brush,
        corrected(plan, options.corrections, brush),
        strokes,
        tuple(tracking_errors),
        options,
        tuple(notices),
        tuple(refused),
        tuple(left_out),
        tuple(drawn),
        tuple(bare),
        tuple(blank),
        tuple(notice.where for notice in astray),
        known,
    )


def _design(source, reading: drawing.ReadOptions) -> Design:
    if not isinstance(source, Design):
        return drawing.read_drawing(source, reading)
    if reading.units or reading.select:
        sentence = "units and select are for reading: a Design was read already"
        raise Error(sentence, code="options-contradict")
    return source if reading.sheet_mm is None else replace(source, sheet_mm=reading.sheet_mm)


def _way(brush, sheet_mm, options: Options, stage=lambda text: None):
    """What compensates strokes, by default as the options ask for, or in closed form where that is to be refined."""
    first = "closed" if options.compensation == "refined" else options.compensation

    def compensated(some, method=first):
        return _core.compensate(
            some,
            brush,
            sheet_mm,
            method,
            options.tolerance_mm,
            options.lag_mm,
            options.speed_mm_s,
            progress=lambda now, all_: stage(f"compensated {now} of {all_} strokes"),
            start=options.start,
            end=options.end,
        )

    return compensated


def _begun_within_reach(
    painted: list, brush, plan, compensated, options: Options, stage
) -> tuple[list, Known | None]:
    """The strokes, those plain that choose how they begin or end, cannot be run as they chose, and can plain: lifted,
    or hidden or exposed as well. A hidden beginning is landed on the far side, from where the tool may not be, and its
    round front may be wider than what is wanted; at a squared beginning or end the tool runs aside. The list itself
    where there are none. And what was found of the plan, where that was asked and is little enough to be kept.
    """

    def tried(of) -> Known:
        loads = in_loads(of, brush, options.cell)
        marks = _core.simulate(
            of, brush, progress=lambda now, all_: stage(f"simulated {now} of {all_} strokes")
        )
        walk = within_limits(loads, brush, marks, options.cell, Job(options.z_offset_mm))
        return Known(copy(of), marks, walk)

    def astray(of: Known) -> set[str]:
        return {problem.where for problem in of.walk.problems}

    choosing = [stroke for stroke in painted if "auto" in _ends(stroke, options)]
    if not choosing:
        return painted, None
    whole = tried(plan)
    left = {stroke.id for stroke in choosing} & astray(whole)
    found = {}
    lifted = {"end": "lifted"}
    for plain in (lifted, {"start": "hidden"}, {**lifted, "start": "hidden"}, {**lifted, "start": "exposed"}):
        some = {stroke.id: _plain(stroke, options, plain) for stroke in choosing if stroke.id in left}
        fits = some.keys() - astray(tried(compensated(list(some.values())).plan)) if some else set()
        found |= {name: some[name] for name in fits}
        left -= fits
    is_little = sum(len(run.poses_mm) for run in plan.passes) <= POSES_KEPT
    fitting = [found.get(stroke.id, stroke) for stroke in painted] if found else painted
    return fitting, whole if is_little and not found else None


def _ends(stroke, options: Options) -> tuple[str, str]:
    return stroke.settings.start or options.start, stroke.settings.end or options.end


def _plain(stroke, options: Options, plain: dict[str, str]):
    """The stroke as it is told to begin and end, where it would choose."""
    said = {name: getattr(stroke.settings, name) or getattr(options, name) for name in plain}
    chosen = {name: plain[name] for name, value in said.items() if value == "auto"}
    return stroke.replaced(settings=stroke.settings.replaced(**chosen))


def _forbidden(brush, options: Options):
    """What says of a plan why the cell may not run it, one sentence each; None without a cell."""
    if options.cell is None:
        return None
    cell, job = options.cell, Job(options.z_offset_mm)

    def sentences(plan) -> list:
        loads, marks = in_loads(plan, brush, cell), _core.simulate(plan, brush)
        return look(loads, brush, marks, cell, options.tolerance_mm, job).problems

    return sentences


def _sorted_out(painted, wanted, step):
    """Strokes that a step takes, with what they should become, why it refuses the others, and what those should become:
    each is tried alone."""
    sound, refused, left_out = [], [], []
    for pair in zip(painted, wanted, strict=True):
        try:
            step(pair[:1])
        except Error as error:
            refused.append(error.notice(pair[0].id))
            left_out.append(pair[1])
        else:
            sound.append(pair)
    return [stroke for stroke, _ in sound], [stroke for _, stroke in sound], refused, left_out


def _widths(painted, done, brush, compensated) -> list[Notice]:
    """What compensation warns of: of a stroke that its depths were not measured, of none that widths are ignored. Not
    where that is so at a stroke's ends alone: every brush is set down and lifted through less depth, and who draws a
    point can do nothing about it. compensated: tries what is advised, None where one width was asked for."""
    laws = (brush.lag, brush.tip_gap, brush.tip_to_widest, brush.half_width)
    ranges = [law.calibrated_mm for law in laws if law.calibrated_mm] if brush.width_follows_depth() else []
    measured = (max(low for low, _ in ranges), min(high for _, high in ranges)) if ranges else None
    pairs = zip(painted, done.plan.passes, strict=True)
    thin = {stroke.id for stroke, run in pairs if measured and _thins_out(stroke, run, brush, *measured)}
    off = {each.where for each in done.warnings if each.code == "depth-not-measured"} - thin
    advice, lines = "", []
    if compensated is not None and measured and measured[0] < measured[1]:
        lines = [stroke for stroke in painted if stroke.id in off and not stroke.wanted_mm]
        advice = _width_advice(lines[:1], brush, measured, compensated)
    advised = {stroke.id for stroke in lines}
    return [
        replace(each, advice=advice if each.where in advised else "")
        if each.code == "depth-not-measured"
        else each
        for each in done.warnings
        if each.code != "depth-not-measured" or each.where not in thin
    ]


def _width_advice(lines: list, brush, measured: tuple[float, float], compensated) -> str:
    """Which widths keep a line within the depths that were measured; "" where the middle one of them does not."""
    halves = [brush.half_width(depth) for depth in measured]
    same = [stroke.replaced(half_width=[(0.0, sum(halves) / 2)]) for stroke in lines]
    try:
        helps = bool(same) and not any(
            each.code == "depth-not-measured" for each in compensated(same).warnings
        )
    except Error:
        helps = False
    if not helps:
        return ""
    least, greatest = (2 * half for half in halves)
    return f"--width MM, from {least:.2g} to {greatest:.2g}, gives all strokes one width that was measured"


def _thins_out(stroke, run, brush, least_mm: float, greatest_mm: float) -> bool:
    """Whether a stroke is pressed less than was measured at its ends alone, no farther in than it is wide. run: its
    pass; a dot, which is turned round on the spot, is pressed less than a line as wide."""
    if -np.asarray(run.poses_mm)[:, 2].min() < least_mm:
        return False
    half = max(half for _, half in stroke.half_width)
    if stroke.closed or brush.depth_for_half_width(half, stroke.id) > greatest_mm:
        return False
    length_mm = _core.flatten(stroke, 0.1)[-1, 2]
    end = min(2 * half / max(length_mm, 1e-9), 0.5)
    inside = np.interp(np.linspace(end, 1 - end, 101), *np.array(stroke.half_width).T)
    return bool((inside >= brush.half_width(least_mm)).all())


def _with_speeds(plan, strokes):
    """The plan with the speeds that the drawing's settings ask for."""
    speeds = [stroke.settings.speed_mm_s for stroke in strokes]
    if any(speeds):
        for a_pass, speed in zip(plan.passes, speeds, strict=True):
            a_pass.speed_mm_s = speed or a_pass.speed_mm_s
    return plan


def _check_speed(brush, options: Options) -> None:
    """Error where all is to be painted at a speed that is not the brush's, or not the cell's."""
    speed, cell = options.speed_of_all_mm_s, options.cell
    if speed is None:
        return
    least = LEAST_SPEED_MM_S.get(cell.language, 0.001) if cell else 0.001
    most = min(brush.max_speed_mm_s, cell.speeds.paint_mm_s) if cell else brush.max_speed_mm_s
    whose = f"brush {brush.name}" if most == brush.max_speed_mm_s else f"cell {cell.name}"
    if not least <= speed <= most:
        sentence = f"speed {speed:.4g} mm/s is outside the range [{least:g}, {most:g}] mm/s of {whose}"
        raise Error(sentence, code="speed-out-of-range")


def _at_speed(plan, options: Options):
    """The plan with the one speed that all was asked to be painted at."""
    if options.speed_of_all_mm_s is not None:
        for a_pass in plan.passes:
            a_pass.speed_mm_s = options.speed_of_all_mm_s
    return plan


def _other_brushes(strokes, brush) -> list[Notice]:
    asked = ((stroke.id, stroke.settings.brush or brush.name) for stroke in strokes)
    return [
        Notice(
            name,
            f"the drawing asks for brush {other}, all is painted with {brush.name}",
            code="brush-asked-for",
        )
        for name, other in asked
        if other != brush.name
    ]


def _astray(painted, wanted, plan, tracking_errors, moved, brush, options: Options) -> list[Notice]:
    """Of strokes that lie where nobody wants them. Who drew a shape drew no middle line, and refinement leaves it on
    purpose: there the paint is judged."""
    shapes = {stroke.origin.element for stroke in wanted if stroke.wanted_mm}
    by_paint = [
        is_moved or stroke.origin.element in shapes for stroke, is_moved in zip(wanted, moved, strict=True)
    ]
    lines = [None if by else stroke for stroke, by in zip(painted, by_paint, strict=True)]
    off = [by and not miss.within_tolerance for by, miss in zip(by_paint, tracking_errors, strict=True)]
    runs = [run if is_off else None for run, is_off in zip(plan.passes, off, strict=True)]
    return [
        *off_middle_line(lines, tracking_errors, brush, options.tolerance_mm),
        *outside(wanted, runs, brush),
    ]


def _prepare_plan(plan, options: Options) -> Work:
    brush = options.brush or find_brush(plan.brush)
    notices = mistyped_keys(brush)
    if brush.name != plan.brush:
        notices.append(
            Notice(
                "brush",
                f"the plan was made for brush {plan.brush}, not for {brush.name}",
                code="plan-of-other-brush",
            )
        )
    elif plan.brush_sha256 and brush.sha256 and plan.brush_sha256 != brush.sha256:
        notices.append(
            Notice(
                "brush_sha256",
                f"the plan was made with another file of brush {brush.name}",
                code="plan-of-other-brush",
            )
        )
    _check_speed(brush, options)
    plan = _at_speed(plan, options)
    return Work("", brush, corrected(plan, options.corrections, brush), None, (), options, tuple(notices))


def whole_strokes(work: Work, loads: PlanInLoads) -> list:
    """For each of the work's loads the stroke that it paints whole; None for the parts of one."""
    whole, left = [], iter(work.strokes)
    for a_pass in loads.loads:
        if is_later_part(a_pass):
            whole[-1:] = [None, None]
        else:
            whole.append(next(left))
    return whole


def nearest_first(work: Work) -> Work:
    """The work with its strokes in the order of the shortest way from the end of one to the start of the next.

    Only strokes that follow each other in one layer change places; none is painted backwards.
    """
    passes = work.plan.passes
    order = travel_order.nearest_first(passes)
    was = work.plan
    plan = _core.Plan(was.brush, was.brush_sha256, was.sheet_mm, [passes[k] for k in order], was.extra)
    strokes = None if work.strokes is None else [work.strokes[k] for k in order]
    tracking_errors = tuple(work.tracking_errors[k] for k in order) if work.tracking_errors else ()
    return replace(work, plan=plan, strokes=strokes, tracking_errors=tracking_errors)
