"""The way from a file to a plan, its marks and its program, put together once."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from . import _core, importers, layout, report
from .brushes import find_brush
from .cell import Cell, find_cell
from .design import Notice
from .errors import Error
from .files import read_bytes, write_files
from .posts import POSTS
from .program import beyond_edges, broken_limits, duration_s, program
from .reach import within_reach
from .strokes import strokes as strokes_of

DEFAULT_BRUSH = "round-6"


@dataclass(frozen=True)
class Options:
    """What may be chosen. brush None: round-6, or the one a plan names; the rest has no effect on a plan."""

    brush: object | None = None
    reading: importers.ReadOptions = importers.AS_DRAWN
    layout: layout.Layout = layout.AS_DRAWN
    compensation: str = "closed"
    lag_mm: float | None = None
    tolerance_mm: float = 0.05
    speed_mm_s: float = 20.0  # of painting, where the drawing does not say; at most the brush's
    paths_as: str | None = None  # "stroke", "outline": what every path is, whatever the drawing says
    wide: str = "clamp"  # outlines wider than the brush: "clamp", "passes", "refuse"


@dataclass(frozen=True)
class Work:
    """A file understood: strokes is None where IN was a plan, which does not say what was wanted.

    misses: one per pass of the plan, () for a plan read from a file.
    """

    title: str
    brush: object
    plan: object
    strokes: list | None
    misses: tuple
    options: Options
    notices: tuple[Notice, ...]


def prepare(path: str | os.PathLike, options: Options = Options(), stage=lambda text: None) -> Work:
    """Read a drawing or plan.json and lay out the TCP's path. Error when it cannot be read or painted."""
    if Path(path).suffix.lower() == ".json":
        return _prepare_plan(path, options)
    stage("reading")
    brush = options.brush or find_brush(DEFAULT_BRUSH)
    design = layout.arrange(importers.read_drawing(path, options.reading), options.layout)
    stage("finding strokes")
    strokes, notices = strokes_of(design, options.paths_as)
    painted, strokes, clamped = within_reach(strokes, brush, options.wide)
    notices += clamped
    done = _core.compensate(
        painted,
        brush,
        design.sheet_mm,
        options.compensation,
        options.tolerance_mm,
        options.lag_mm,
        options.speed_mm_s,
        progress=lambda now, all_: stage(f"compensated {now} of {all_} strokes"),
    )
    plan = _with_speeds(done.plan, strokes)
    notices = [*design.notices, *notices, *(Notice(where, sentence) for where, sentence in done.warnings)]
    notices += _other_brushes(strokes, brush)
    if options.compensation == "closed":
        notices += _misses(strokes, done.misses, options.tolerance_mm)
    return Work(design.title, brush, plan, strokes, tuple(done.misses), options, tuple(notices))


def _with_speeds(plan, strokes):
    """The plan with the speeds that the drawing's settings ask for."""
    speeds = [json.loads(stroke.settings).get("speed_mm_s") for stroke in strokes]
    if any(speeds):
        passes = plan.passes
        for a_pass, speed in zip(passes, speeds, strict=True):
            a_pass.speed_mm_s = speed or a_pass.speed_mm_s
        plan.passes = passes
    return plan


def _other_brushes(strokes, brush) -> list[Notice]:
    asked = ((stroke.id, json.loads(stroke.settings).get("brush", brush.name)) for stroke in strokes)
    return [
        Notice(name, f"the drawing asks for brush {other}, all is painted with {brush.name}")
        for name, other in asked
        if other != brush.name
    ]


def _misses(strokes, misses, tolerance_mm: float) -> list[Notice]:
    return [
        Notice(
            stroke.id,
            f"the widest point stays up to {miss.largest_mm:.3g} mm off the middle line, tolerance "
            f"{tolerance_mm:g} mm, near x {miss.at_mm[0]:.1f}, y {miss.at_mm[1]:.1f} mm"
            + (": it turns too sharply there for the brush" if miss.has_turn_in_place else ""),
        )
        for stroke, miss in zip(strokes, misses, strict=True)
        if not miss.within_tolerance
    ]


def _prepare_plan(path: str | os.PathLike, options: Options) -> Work:
    try:
        text = read_bytes(path).decode("utf-8")
    except UnicodeDecodeError:
        raise Error("the file is not a plan: it is not text in UTF-8") from None
    plan = _core.read_plan(text)
    brush = options.brush or find_brush(plan.brush)
    notices = []
    if brush.name != plan.brush:
        notices.append(Notice("brush", f"the plan was made for brush {plan.brush}, not for {brush.name}"))
    elif plan.brush_sha256 and brush.sha256 and plan.brush_sha256 != brush.sha256:
        notices.append(Notice("brush_sha256", f"the plan was made with another file of brush {brush.name}"))
    return Work("", brush, plan, None, (), options, tuple(notices))


def best_constant(work: Work, step_mm: float = 0.25) -> Work:
    """A drawing's work with the one lag for all strokes whose marks overlap most with it, to compare with.

    Lags from 0 to the brush's greatest are tried, step_mm apart, and compared by pixels. The best one is in
    options.lag_mm; notices stay those of the work.
    """
    window = (0.0, 0.0, *work.plan.sheet_mm)
    px_per_mm = min(
        4.0, 4000.0 / max(work.plan.sheet_mm)
    )  # overlaps to 2e-4, in a twentieth of the rings' time
    wanted = _core.coverage(report.wanted_rings(work.strokes), window, px_per_mm)
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


def predict(work: Work, outlines: bool = True, stage=lambda text: None):
    """The marks of the plan; outlines: trace their rings too."""

    def progress(doing: str):
        return lambda now, all_: stage(f"{doing} {now} of {all_} strokes")

    marks = _core.simulate(work.plan, work.brush, progress=progress("simulated"))
    if outlines:
        _core.trace_outlines(marks, work.brush, progress=progress("outlined"))
    return marks


def problems(plan, brush, marks, cell: Cell) -> list[tuple[str, str]]:
    """(stroke, sentence) for everything that forbids to run the plan on the robot; empty when all is well."""
    return broken_limits(plan, brush, cell) + off_sheet(marks, brush, plan.sheet_mm)


def off_sheet(marks, brush, sheet_mm) -> list[tuple[str, str]]:
    """(stroke, sentence) for each side of the sheet [mm] that a stroke's paint crosses."""
    found = []
    for trace in marks.passes:
        bounds_mm = _core.painted_bounds(trace, brush)
        if not np.isfinite(bounds_mm).all():
            continue  # nothing touches the paper
        found += [
            (trace.stroke, f"the mark reaches {beyond:.2f} mm beyond the {side} edge of the sheet")
            for side, beyond in beyond_edges(bounds_mm, sheet_mm).items()
            if beyond >= 0.005  # what would print as 0.00 mm is rounding, not paint
        ]
    return found


def encode(suffix: str, plan, brush, title: str, notes=(), cell: Cell | None = None) -> bytes:
    """The plan as the bytes of a plan.json or of a program in the cell's language, by the file's extension.

    Error for any other extension, and for a program where a limit of brush or cell is broken.
    """
    if suffix == ".json":
        return _core.write_plan(plan).encode()
    cell = cell or find_cell()
    post = POSTS.get(cell.language)
    if post is None:
        known = ", ".join(POSTS)
        raise Error(
            f"language {cell.language!r} of cell {cell.name} is not known; known: {known}", where="language"
        )
    if suffix != post.extension:
        raise Error(
            f"the extension {suffix!r} is neither .json, for a plan, nor {post.extension}, for {post.title}, "
            f"which cell {cell.name} speaks"
        )
    header = (
        f"title: {title or 'untitled'}",
        f"brush: {plan.brush}, {len(plan.passes)} strokes",
        *notes,
        "frame: origin at the lower left corner of the sheet, mm; z 0: the brush just touches",
    )
    return post.write(program(plan, brush, cell, header)).encode("ascii")


def notes(work: Work) -> tuple[str, ...]:
    """Lines for a program's header: how it was made, and how much there is to know about it."""
    options = work.options
    made = f"compensation: {options.compensation}, tolerance {options.tolerance_mm:g} mm"
    damaged = sum(notice.damaged for notice in work.notices)
    count = f"warnings: {len(work.notices)}" + (f", {damaged} of them damaged geometry" if damaged else "")
    return (made, count) if work.strokes is not None else (count,)


def write_program(path: str | os.PathLike, plan, brush, title: str = "", cell: Cell | None = None) -> None:
    """Write a plan as plan.json or G-code, by the extension of path, after checking every limit.

    Error, and nothing written, when paint leaves the sheet or a limit of brush or cell is broken.
    """
    cell = cell or find_cell()
    for where, sentence in problems(plan, brush, _core.simulate(plan, brush), cell):
        raise Error(sentence, where=where)
    write_files({path: encode(Path(path).suffix.lower(), plan, brush, title, cell=cell)})


def picture(suffix: str, work: Work, marks) -> bytes:
    """The marks as the bytes of a .png, .svg or .json (marks.json); the latter two need their outlines."""
    if suffix == ".json":
        return _core.write_marks(marks).encode()
    from . import render  # brings OpenCV, which a program does not need

    colours = [a_pass.colour for a_pass in work.plan.passes]
    if suffix == ".svg":
        return render.marks_svg(marks, work.plan.sheet_mm, colours, work.title).encode()
    return render.marks_png(marks, work.brush, work.plan.sheet_mm, colours)


def report_text(suffix: str, work: Work, marks, cell: Cell, warnings=None) -> str:
    """The report as text (.txt) or JSON (.json). warnings: (where, sentence), None for those of the work."""
    known = warnings if warnings is not None else [(n.where, n.sentence) for n in work.notices]
    drawn = work.strokes is not None
    rows, total = report.measure(work.plan, marks, work.brush, work.strokes, work.options.tolerance_mm)
    result = report.Report(
        title=work.title,
        brush=work.plan.brush,
        compensation=work.options.compensation if drawn else "",
        tolerance_mm=work.options.tolerance_mm if drawn else None,
        strokes=rows,
        total=total,
        time_s=duration_s(work.plan, work.brush, cell),
        warnings=tuple(known),
    )
    return report.to_json(result) if suffix == ".json" else report.to_text(result)
