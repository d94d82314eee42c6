"""What the commands do: call the steps in order, warn, refuse, write everything or nothing."""

from __future__ import annotations

import os

from . import convert
from ._core import remarks
from .brushes import brush_names, find_brush
from .cell import Cell, cell_names, find_cell
from .console import RefusedError, about, clear_stage, say, stage, tell, warn
from .describe import cell_page, one_line, page
from .design import Notice
from .errors import Error
from .files import read_bytes, write_files
from .importers import ReadOptions, read_drawing
from .layout import Layout, arrange
from .posts import POSTS
from .strokes import strokes as strokes_of


def convert_file(args) -> None:
    _check_places(args.output, args.preview, args.report)
    cell = _cell(args)
    work = _prepare(args, cell)
    damaged = [] if args.lenient else [notice for notice in work.notices if notice.damaged]
    warn(args.input, [(n.where, n.sentence) for n in work.notices if n not in damaged])
    with about(args.input):
        marks = convert.predict(work, bool(args.report or _suffix(args.preview) == ".svg"), stage)
        problems = convert.problems(work.plan, work.brush, marks, cell)
        problems += [(n.where, n.sentence) for n in damaged]
        if damaged:
            where, sentence = problems[-1]
            problems[-1] = (where, f"{sentence} (--lenient draws what is sound)")
        if problems:
            raise RefusedError([(args.input, *problem) for problem in problems])
        notes = convert.notes(work)
        program = convert.encode(_suffix(args.output), work.plan, work.brush, work.title, notes, cell)
        files = {args.output: program}
        if args.preview:
            files[args.preview] = convert.picture(_suffix(args.preview), work, marks)
        if args.report:
            files[args.report] = convert.report_text(_suffix(args.report), work, marks, cell)
    _write(files)


def predict_file(args) -> None:
    _check_places(args.output)
    work, marks, _ = _look(args, _cell(args), outlines=_suffix(args.output) != ".png")
    with about(args.input):
        picture = convert.picture(_suffix(args.output), work, marks)
    _write({args.output: picture})


def import_file(args) -> None:
    _check_places(args.output)
    with about(args.input):
        stage("reading")
        design = arrange(read_drawing(args.input, _reading(args)), _layout(args))
        try:
            strokes, notices = strokes_of(design, args.paths_as)
        except Error as nothing:  # a drawing with nothing to paint is worth looking at, too
            strokes, notices = [], [Notice(nothing.where, str(nothing))]
        notices = [*design.notices, *notices]
        warn(args.input, [(notice.where, notice.sentence) for notice in notices])
        from .overview import overview

        picture = overview(_suffix(args.output), design, strokes, notices)
    _write({args.output: picture})


def text_file(args) -> None:
    _check_places(args.output)
    from .text import text_svg

    with about(args.font):
        stage("setting the text")
        drawing, notices = text_svg(
            args.input.replace("\\n", "\n"),
            read_bytes(args.font),
            size_mm=args.size,
            width_mm=args.width,
            sheet_mm=args.sheet,
        )
    warn(args.font, [(notice.where, notice.sentence) for notice in notices])
    _write({args.output: drawing.encode()})


def report_file(args) -> None:
    cell = _cell(args)
    work, marks, warnings = _look(args, cell, outlines=True)
    with about(args.input):
        text = convert.report_text(".json" if args.json else ".txt", work, marks, cell, warnings)
    tell(text)


def _look(args, cell: Cell, outlines: bool):
    """Work, marks and warnings: what would forbid to run a program is only a warning to someone who looks."""
    work = _prepare(args, cell)
    with about(args.input):
        marks = convert.predict(work, outlines, stage)
        warnings = [(n.where, n.sentence) for n in work.notices]
        warnings += convert.problems(work.plan, work.brush, marks, cell)
    warn(args.input, warnings)
    return work, marks, warnings


def _prepare(args, cell: Cell) -> convert.Work:
    if _suffix(args.input) == ".json":
        for flag in (*LAYOUT_FLAGS, "wide", "compensation", "lag", "tolerance"):
            if getattr(args, {"as": "paths_as"}.get(flag, flag)) is not None:
                say(args.input, f"--{flag} has no effect on a plan, whose poses are fixed")
    with about(args.brush or ""):
        brush = find_brush(args.brush) if args.brush is not None else None
    options = convert.Options(
        brush=brush,
        reading=_reading(args),
        layout=_layout(args),
        compensation=args.compensation or convert.Options.compensation,
        lag_mm=args.lag,
        tolerance_mm=args.tolerance or convert.Options.tolerance_mm,
        paths_as=args.paths_as,
        wide=args.wide or convert.Options.wide,
        speed_mm_s=min(convert.Options.speed_mm_s, cell.max_paint_mm_s),
    )
    with about(args.input):
        return convert.prepare(args.input, options, stage)


LAYOUT_FLAGS = ("sheet", "units", "select", "layer", "width", "fit", "scale", "origin", "as")


def _cell(args) -> Cell:
    with about(args.cell or ""):
        return find_cell(args.cell) if args.cell is not None else find_cell()


def _reading(args) -> ReadOptions:
    return ReadOptions(args.sheet, args.units, args.select, lenient=True)  # damage is told with all the rest


def _layout(args) -> Layout:
    return Layout(tuple(args.layer or ()), args.width, args.fit, args.scale, args.origin)


def _suffix(path: str | None) -> str:
    return os.path.splitext(path or "")[1].lower()


def _check_places(*paths: str | None) -> None:
    """Whether the outputs can be written, as far as that can be said before any work is done."""
    for path in filter(None, paths):
        folder = os.path.dirname(os.path.realpath(path))
        reason = None
        if os.path.isdir(path):
            reason = "it is a directory"
        elif not os.path.isdir(folder):
            reason = "its directory does not exist"
        elif not os.access(folder, os.W_OK | os.X_OK):
            reason = "its directory is not writable"
        if reason:
            raise RefusedError([(path, "", f"the file cannot be written: {reason}")])


def _write(files) -> None:
    stage("writing")
    with about(""):  # the error names the file
        write_files(files)
    clear_stage()


def _tell_list(names: list[str], describe) -> None:
    width = max(map(len, names))
    for name in names:
        with about(name):
            tell(f"{name.ljust(width)}  {describe(name)}\n")


def brush_list(_args) -> None:
    _tell_list(brush_names(), lambda name: one_line(find_brush(name)))


def brush_show(args) -> None:
    with about(args.input):
        tell(page(find_brush(args.input)) + "\n")


def brush_check(args) -> None:
    with about(args.input):
        brush = find_brush(args.input)
        odd = remarks(brush)
    warn(args.input, odd)
    tell(f"{args.input}: brush {brush.name} can be used\n")


def cell_list(_args) -> None:
    _tell_list(cell_names(), lambda name: find_cell(name).description)


def cell_show(args) -> None:
    with about(args.input):
        tell(cell_page(find_cell(args.input)) + "\n")


def cell_check(args) -> None:
    with about(args.input):
        cell = find_cell(args.input)
        if cell.language not in POSTS:
            raise Error(
                f"language {cell.language!r} is not known; known: {', '.join(POSTS)}", where="language"
            )
    tell(f"{args.input}: cell {cell.name} can be used\n")
