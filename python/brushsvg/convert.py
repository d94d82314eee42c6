"""The way from a file to a plan, its marks and its program, put together once."""

from __future__ import annotations

import itertools
import json
import os
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from . import _core, importers, layout, report, suit
from .animation import animation
from .brushes import find_brush
from .cell import Cell
from .design import Notice
from .documents import read_plan
from .errors import Error
from .machine import DEFAULT_TOLERANCE_MM, as_exact_as, problems, time_s, whole_program
from .paint import in_loads as in_loads_of
from .paint import is_later_part
from .program import Job
from .reach import within_reach
from .refining import refined
from .strokes import strokes as strokes_of
from .svg_marks import marks_svg, misses_svg
from .timeline import timeline
from .uncertainty import uncertainty

DEFAULT_BRUSH = "round-6"
SHOWN_MM = 0.02  # how exactly a page shows what was wanted: less cannot be seen


@dataclass(frozen=True)
class Options:
    """What may be chosen. brush None: round-6, or the one a plan names; the rest has no effect on a plan."""

    brush: object | None = None
    reading: importers.ReadOptions = importers.AS_DRAWN
    layout: layout.Layout = layout.AS_DRAWN
    compensation: str = "closed"
    lag_mm: float | None = None
    tolerance_mm: float = DEFAULT_TOLERANCE_MM
    speed_mm_s: float = 20.0  # of painting, where the drawing does not say; at most the brush's
    paths_as: str | None = None  # "stroke", "outline": what every path is, whatever the drawing says
    wide: str = "clamp"  # outlines wider than the brush: "clamp", "passes", "refuse"
    cell: Cell | None = None  # whose limits no refined stroke breaks, unless its closed form does
    z_offset_mm: float = 0.0  # of the paper, against the cell's


@dataclass(frozen=True)
class Work:
    """A file understood: strokes is None where IN was a plan, which does not say what was wanted.

    misses: one per pass of the plan, () for a plan read from a file; refused: strokes that were left out.
    """

    title: str
    brush: object
    plan: object
    strokes: list | None
    misses: tuple
    options: Options
    notices: tuple[Notice, ...]
    refused: tuple[Notice, ...] = ()
    left_out: tuple = ()  # the strokes that were refused, as they were wanted
    drawn: tuple = ()  # all strokes, before they were brought within the brush's reach


def prepare(
    path: str | os.PathLike, options: Options = Options(), stage=lambda text: None, partly: bool = False
) -> Work:
    """Read a drawing or plan.json and lay out the TCP's path. Error when it cannot be read or painted; partly: strokes
    that are refused are left out."""
    if Path(path).suffix.lower() == ".json":
        return _prepare_plan(path, options)
    stage("reading")
    brush = options.brush or find_brush(DEFAULT_BRUSH)
    design = layout.arrange(importers.read_drawing(path, options.reading), options.layout)
    stage("finding strokes")
    strokes, notices = strokes_of(design, options.paths_as)
    refused, left_out, drawn = [], [], tuple(strokes)
    if partly and options.wide == "refuse":
        strokes, _, refused, left_out = _sorted_out(
            strokes, strokes, lambda some: within_reach(some, brush, options.wide)
        )
    painted, strokes, clamped = within_reach(strokes, brush, options.wide)
    notices += clamped
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
    plan, misses, moved = done.plan, done.misses, [False] * len(painted)
    if options.compensation == "refined":
        better = refined(painted, strokes, brush, done, compensated, _forbidden(brush, options))
        plan.passes, misses, moved = better.passes, better.misses, better.moved
    plan = _with_speeds(plan, strokes)
    notices = [*design.notices, *notices, *_widths(done.warnings, options.layout.width_mm is None)]
    notices += _other_brushes(strokes, brush)
    if options.compensation in ("closed", "refined"):
        notices += _misses(painted, misses, moved, brush, options.tolerance_mm)
    return Work(
        design.title,
        brush,
        plan,
        strokes,
        tuple(misses),
        options,
        tuple(notices),
        tuple(refused),
        tuple(left_out),
        drawn,
    )


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
        )

    return compensated


def _forbidden(brush, options: Options):
    """What says of a plan why the cell may not run it, one sentence each; None without a cell."""
    if options.cell is None:
        return None
    cell, job = as_exact_as(options.cell, options.tolerance_mm), Job(options.z_offset_mm)

    def sentences(plan) -> list:
        return problems(plan, brush, _core.simulate(plan, brush), cell, options.tolerance_mm, job)

    return sentences


def _sorted_out(painted, wanted, step):
    """Strokes that a step takes, with what they should become, why it refuses the others, and what those should become:
    each is tried alone."""
    sound, refused, left_out = [], [], []
    for pair in zip(painted, wanted, strict=True):
        try:
            step(pair[:1])
        except Error as error:
            refused.append(Notice(pair[0].id, str(error)))
            left_out.append(pair[1])
        else:
            sound.append(pair)
    return [stroke for stroke, _ in sound], [stroke for _, stroke in sound], refused, left_out


def _widths(warnings, may_advise: bool) -> list[Notice]:
    advice = "; --width MM gives all strokes one width"
    return [
        Notice(where, said + advice * (may_advise and said.endswith("was measured")))
        for where, said in warnings
    ]


def _with_speeds(plan, strokes):
    """The plan with the speeds that the drawing's settings ask for."""
    speeds = [json.loads(stroke.settings).get("speed_mm_s") for stroke in strokes]
    if any(speeds):
        for a_pass, speed in zip(plan.passes, speeds, strict=True):
            a_pass.speed_mm_s = speed or a_pass.speed_mm_s
    return plan


def _other_brushes(strokes, brush) -> list[Notice]:
    asked = ((stroke.id, json.loads(stroke.settings).get("brush", brush.name)) for stroke in strokes)
    return [
        Notice(name, f"the drawing asks for brush {other}, all is painted with {brush.name}")
        for name, other in asked
        if other != brush.name
    ]


def _misses(painted, misses, moved, brush, tolerance_mm: float) -> list[Notice]:
    """Where a mark's middle is off its line: moved, as refinement does on purpose, where it is beside the stroke."""
    found = []
    for stroke, miss, is_moved in zip(painted, misses, moved, strict=True):
        half_mm = brush.half_width(brush.paint_depth_mm)
        if brush.width_follows_depth():
            half_mm = max(half for _, half in stroke.half_width)
        if miss.largest_mm <= half_mm if is_moved else miss.within_tolerance:
            continue
        bound = f"half its width {half_mm:.3g} mm" if is_moved else f"tolerance {tolerance_mm:g} mm"
        sentence = (
            f"the widest point stays up to {miss.largest_mm:.3g} mm off the middle line, {bound}, "
            f"near x {miss.at_mm[0]:.1f}, y {miss.at_mm[1]:.1f} mm"
        )
        turns = ": it turns too sharply there for the brush"
        found.append(Notice(stroke.id, sentence + turns * miss.has_turn_in_place))
    return found


def _prepare_plan(path: str | os.PathLike, options: Options) -> Work:
    plan = read_plan(path)
    brush = options.brush or find_brush(plan.brush)
    notices = []
    if brush.name != plan.brush:
        notices.append(Notice("brush", f"the plan was made for brush {plan.brush}, not for {brush.name}"))
    elif plan.brush_sha256 and brush.sha256 and plan.brush_sha256 != brush.sha256:
        notices.append(Notice("brush_sha256", f"the plan was made with another file of brush {brush.name}"))
    return Work("", brush, plan, None, (), options, tuple(notices))


def in_loads(work: Work, cell: Cell) -> Work:
    """The work as the cell paints it: strokes longer than a load of paint in parts. Fit to be looked at, not measured:
    strokes and misses are those of the whole drawing."""
    return replace(work, plan=in_loads_of(work.plan, work.brush, cell))


def whole_strokes(work: Work, loads) -> list:
    """For each pass of the work's plan in loads the stroke that it paints whole; None for the parts of one."""
    whole, left = [], iter(work.strokes)
    for a_pass in loads.passes:
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
    order = [int(k) for group in _groups(passes) for k in _nearest(passes, group)]
    plan = work.plan
    plan.passes = [passes[k] for k in order]
    strokes = None if work.strokes is None else [work.strokes[k] for k in order]
    misses = tuple(work.misses[k] for k in order) if work.misses else ()
    return replace(work, plan=plan, strokes=strokes, misses=misses)


def _groups(passes) -> list[list[int]]:
    """Numbers of passes that follow each other in one layer with the same wish for an order."""
    wishes = [(a_pass.layer, json.loads(a_pass.settings).get("order", 0)) for a_pass in passes]
    numbers = range(len(passes))
    return [list(group) for _, group in itertools.groupby(numbers, key=wishes.__getitem__)]


def _nearest(passes, group: list[int]) -> list[int]:
    starts = np.array([passes[k].poses_mm[0, :2] for k in group])
    ends = np.array([passes[k].poses_mm[-1, :2] for k in group])
    order, here = [0], ends[0]  # the first stays the first
    left = np.arange(1, len(group))
    while len(left):
        next_ = int(np.linalg.norm(starts[left] - here, axis=1).argmin())
        order.append(int(left[next_]))
        here = ends[left[next_]]
        left = np.delete(left, next_)
    return [group[k] for k in order]


def best_constant(work: Work, step_mm: float = 0.25) -> Work:
    """A drawing's work with the one lag for all strokes whose marks overlap most with it, to compare with.

    Lags from 0 to the brush's greatest are tried, step_mm apart, and compared by pixels. The best one is in
    options.lag_mm; notices stay those of the work.
    """
    window = (0.0, 0.0, *work.plan.sheet_mm)
    px_per_mm = min(
        4.0, 4000.0 / max(work.plan.sheet_mm)
    )  # overlaps to 2e-4, in a twentieth of the rings' time
    wanted = _core.wanted_coverage(work.strokes, window, px_per_mm)
    best, most = work, -1.0
    greatest_mm = max(work.brush.lag(depth) for depth in np.linspace(*work.brush.depth_range_mm, 101))
    for lag_mm in np.arange(0.0, greatest_mm + step_mm, step_mm).tolist():
        options = replace(work.options, compensation="constant", lag_mm=lag_mm)
        done = _core.compensate(
            within_reach(work.strokes, work.brush)[0],
            work.brush,
            work.plan.sheet_mm,
            "constant",
            options.tolerance_mm,
            lag_mm,
            options.speed_mm_s,
        )
        painted = _core.coverage(_core.simulate(done.plan, work.brush), work.brush, window, px_per_mm)
        overlap = np.minimum(painted, wanted).sum() / np.maximum(painted, wanted).sum()
        if overlap > most:
            best, most = replace(work, plan=done.plan, misses=tuple(done.misses), options=options), overlap
    return best


def predict(work: Work, outlines: bool = True, stage=lambda text: None, whole: bool = True):
    """The marks of the plan; outlines: trace their rings too, whole: those of all paint together as well."""

    progress = _counted(stage, "simulated")
    marks = _core.simulate(work.plan, work.brush, progress=progress)
    if not outlines:
        return marks
    return outlined(marks, work.brush, stage) if whole else _outlined_apart(marks, work.brush, stage)


def outlined(marks, brush, stage=lambda text: None):
    """The marks with their rings traced."""
    _core.trace_outlines(marks, brush, progress=_counted(stage, "outlined"))
    return marks


def _outlined_apart(marks, brush, stage):
    """The marks with the rings of each pass alone, which is all that a picture needs, on all processors."""
    from concurrent.futures import ThreadPoolExecutor

    def one(trace):
        alone = _core.Marks()
        alone.passes = [trace]
        _core.trace_outlines(alone, brush)
        return alone.passes[0]

    count = _counted(stage, "outlined")
    pool = ThreadPoolExecutor(os.cpu_count())
    try:
        done = []
        for trace in pool.map(one, marks.passes):
            done.append(trace)
            count(len(done), len(marks.passes))
    finally:
        pool.shutdown(cancel_futures=True)  # Ctrl-C waits for the strokes at hand, no longer
    marks.passes = done
    return marks


def _counted(stage, doing: str):
    return lambda now, all_: stage(f"{doing} {now} of {all_} strokes")


def notes(work: Work) -> tuple[str, ...]:
    """Lines for a program's header: how it was made, and how much there is to know about it."""
    options = work.options
    lag = f", lag {options.lag_mm:g} mm" if options.lag_mm is not None else ""
    made = f"compensation: {options.compensation}, tolerance {options.tolerance_mm:g} mm{lag}"
    damaged = sum(notice.damaged for notice in work.notices)
    count = f"warnings: {len(work.notices)}" + (f", {damaged} of them damaged geometry" if damaged else "")
    return (made, count) if work.strokes is not None else (count,)


def picture(suffix: str, work: Work, marks, band=None) -> bytes:
    """The marks as the bytes of a .png, .svg or .json (marks.json); the latter two need their outlines. band: an
    uncertainty.Band to draw around them."""
    if suffix == ".json":
        return _core.write_marks(marks).encode()
    colours = [a_pass.colour for a_pass in work.plan.passes]
    if suffix == ".svg":
        how = "" if work.strokes is None else f", {work.options.compensation}"
        made = f"{work.plan.brush}{how}"
        text = marks_svg(marks, work.plan.sheet_mm, colours, work.title, work.misses, made, band)
        return text.encode()
    from . import render  # brings OpenCV, which the others do not need

    return render.marks_png(marks, work.brush, work.plan.sheet_mm, colours, band)


def misses_picture(suffix: str, work: Work, marks) -> bytes:
    """Where paint is missing and where there is too much of it, as the bytes of a .png or an .svg; the latter needs
    outlines. Error for a plan, which does not say what was wanted."""
    if work.strokes is None:
        raise Error("a plan does not say what was wanted: give the drawing")
    if suffix == ".svg":
        wanted = report.wanted_rings(work.strokes)
        return misses_svg(wanted, marks.outline_mm, work.plan.sheet_mm, work.title).encode()
    from . import render

    px_per_mm = min(20.0, render.PNG_LONG_SIDE_PX / max(work.plan.sheet_mm))
    window = (0.0, 0.0, *work.plan.sheet_mm)
    wanted = _core.wanted_coverage(work.strokes, window, px_per_mm)
    return render.misses_png(wanted, _core.coverage(marks, work.brush, window, px_per_mm))


def advice(work: Work) -> str:
    """On the drawing's size, in words; none for a plan."""
    options = work.options
    if not work.drawn or options.layout.width_mm is not None:
        return ""
    made = _trial(work.brush, options)
    if options.wide == "passes":
        size = suit.best_letter_size(work.drawn, work.brush, made)
    else:
        size = suit.best_size(work.drawn, work.brush, made, _quick_trial(work.brush, options))
    scale = (options.layout.scale or 1.0) if options.layout.fit_mm is None else None
    return suit.advice(size, scale)


def _trial(brush, options: Options):
    """From strokes to (marks, what they should become), made as a drawing is, but on no sheet and for no machine."""
    compensated = _way(brush, (0.0, 0.0), options)

    def made(strokes):
        painted, wanted, _ = within_reach(strokes, brush, options.wide)
        done = compensated(painted)
        plan = done.plan
        if options.compensation == "refined":
            plan.passes = refined(painted, wanted, brush, done, compensated).passes
        return _core.simulate(plan, brush).passes, wanted

    return made


def _quick_trial(brush, options: Options):
    """A trial in a quarter of the time, or a tenth of refined: in closed form, with more poses than are needed."""
    if options.compensation not in ("closed", "refined"):
        return None

    def made(strokes):
        painted, wanted, _ = within_reach(strokes, brush, options.wide)
        done = _core.compensate(
            painted, brush, tolerance_mm=options.tolerance_mm, few_poses=False, sheet_mm=(0.0, 0.0)
        )
        return _core.simulate(done.plan, brush).passes, wanted

    return made


def suits(path: str | os.PathLike, options: Options, brushes, stage=lambda text: None) -> list[suit.Suit]:
    """How well each brush paints a drawing, the best first."""
    found = []
    for brush in brushes:
        work = prepare(path, replace(options, brush=brush), stage, partly=True)
        marks = predict(work, outlines=False, stage=stage)
        drawn = [*work.strokes, *work.left_out]
        rows, total = report.measure(
            work.plan, marks, brush, work.strokes, options.tolerance_mm, drawn, options.compensation
        )
        refused = [(notice.where, notice.sentence) for notice in work.refused]
        found.append(suit.suit(brush.name, rows, total.overlap if rows else 0.0, refused))
    return suit.best_first(found)


def played(work: Work, marks, cell: Cell, speed: float = 1.0) -> bytes:
    """An HTML page that plays tool and paint over time, speed times as fast at first. marks: with outlines."""
    moves = timeline(whole_program(work.plan, work.brush, cell), marks)
    wanted = [_core.wanted_outline(stroke, SHOWN_MM) for stroke in work.strokes or ()]
    return animation(moves, work.plan, work.brush, marks, wanted, cell.stations, work.title, speed)


def report_text(suffix: str, *measured, **told) -> str:
    """The report as text (.txt) or JSON (.json); the rest as for `reported`."""
    return report.as_text(suffix, reported(*measured, **told))


def reported(
    work: Work,
    marks,
    cell: Cell,
    warnings=None,
    forbidden=(),
    drawn=None,
    seconds=None,
    advice="",
) -> report.Report:
    """The figures of a work. warnings: (where, sentence), None for those of the work; forbidden:
    those of them for which no program would be written; drawn: see report.measure; seconds: how long it takes, where
    that is known better than from the plan; advice: on the size."""
    known = warnings if warnings is not None else [(n.where, n.sentence) for n in work.notices]
    is_drawing = work.strokes is not None
    rows, total = report.measure(
        work.plan,
        marks,
        work.brush,
        work.strokes,
        work.options.tolerance_mm,
        drawn,
        work.options.compensation,
    )
    return report.Report(
        title=work.title,
        brush=work.plan.brush,
        compensation=work.options.compensation if is_drawing else "",
        tolerance_mm=work.options.tolerance_mm if is_drawing else None,
        strokes=rows,
        total=total,
        time_s=time_s(work.plan, work.brush, cell) if seconds is None else seconds,
        warnings=tuple(known),
        refused=tuple((notice.where, notice.sentence) for notice in work.refused),
        forbidden=tuple(forbidden),
        sure=uncertainty(work.plan, work.brush, marks),
        groups=report.groups(marks, work.brush, work.strokes),
        advice=advice,
    )
