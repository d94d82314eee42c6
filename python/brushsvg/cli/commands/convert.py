"""brushsvg convert: a drawing to the program of a machine, with its picture and its figures."""

from __future__ import annotations

from dataclasses import replace

from ...evaluation import report
from ...machine import paint_reload, preflight, writer
from ...machine.program import Job
from ...pipeline import outputs, prediction, preparation
from ...text_summary import folded
from ..console import RefusedError, about, stage, warn
from .options import cell_of, settle, warn_of_example
from .outputs import check_places, suffix_of, write
from .prepare import prepare, seconds_of


def convert_file(args) -> None:
    check_places(args.output, args.preview, args.report)
    settle(args, args.input)
    cell = cell_of(args)
    work = prepare(args, cell)
    cell = preflight.as_exact_as(cell, work.options.tolerance_mm)
    damaged = [] if args.lenient else [notice for notice in work.notices if notice.damaged]
    warn(args.input, [notice for notice in work.notices if notice not in damaged])
    job = Job(args.z_offset, args.from_stroke)
    notes = outputs.notes(work)
    if args.order == "nearest":
        work, notes = preparation.nearest_first(work), (*notes, "order: nearest first")
    with about(args.input):
        if suffix_of(args.output) != ".json":
            writer.post_for(suffix_of(args.output), cell)
            preflight.check_rounding(cell, work.options.tolerance_mm)
        marks = prediction.predict(work, suffix_of(args.preview) == ".svg", stage)
        problems = preflight.problems(work.plan, work.brush, marks, cell, work.options.tolerance_mm, job)
        problems = folded([*problems, *damaged])
        if damaged:
            problems[-1] = replace(problems[-1], advice="--lenient draws what is sound")
        if problems:
            raise RefusedError(args.input, problems)
        program = writer.encode(suffix_of(args.output), work.plan, work.brush, work.title, notes, cell, job)
        files = {args.output: program}
        if args.preview:
            files[args.preview] = outputs.picture(suffix_of(args.preview), work, marks)
        overlap = None
        if args.report:
            figures = outputs.reported(work, marks, cell)
            files[args.report], overlap = (
                report.as_text(suffix_of(args.report), figures),
                figures.total.overlap,
            )
        too_long = paint_reload.too_long(preparation.in_loads(work, cell).plan, work.brush, cell)
    if suffix_of(args.output) != ".json":
        warn(args.input, too_long)
    warn_of_example(args, cell)
    write(args, files, len(work.plan.passes) - args.from_stroke + 1, seconds_of(work, cell, job), overlap)
