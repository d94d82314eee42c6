"""brushsvg convert: a drawing to the program of a machine, with its picture and its figures."""

from __future__ import annotations

from .. import convert, machine, paint, report
from ..console import RefusedError, about, stage, warn
from ..fold import folded
from ..program import Job
from .choices import cell_of, settle, warn_of_example
from .outputs import check_places, suffix_of, write
from .work import prepare, seconds_of


def convert_file(args) -> None:
    check_places(args.output, args.preview, args.report)
    settle(args, args.input)
    cell = cell_of(args)
    work = prepare(args, cell)
    cell = machine.as_exact_as(cell, work.options.tolerance_mm)
    damaged = [] if args.lenient else [notice for notice in work.notices if notice.damaged]
    warn(args.input, [(n.where, n.sentence) for n in work.notices if n not in damaged])
    job = Job(args.z_offset, args.from_stroke)
    notes = convert.notes(work)
    if args.order == "nearest":
        work, notes = convert.nearest_first(work), (*notes, "order: nearest first")
    with about(args.input):
        if suffix_of(args.output) != ".json":
            machine.post_for(suffix_of(args.output), cell)
            machine.check_rounding(cell, work.options.tolerance_mm)
        marks = convert.predict(work, suffix_of(args.preview) == ".svg", stage)
        problems = machine.problems(work.plan, work.brush, marks, cell, work.options.tolerance_mm, job)
        problems = folded([*problems, *((n.where, n.sentence) for n in damaged)])
        if damaged:
            where, sentence = problems[-1]
            problems[-1] = (where, f"{sentence} (--lenient draws what is sound)")
        if problems:
            raise RefusedError([(args.input, *problem) for problem in problems])
        program = machine.encode(suffix_of(args.output), work.plan, work.brush, work.title, notes, cell, job)
        files = {args.output: program}
        if args.preview:
            files[args.preview] = convert.picture(suffix_of(args.preview), work, marks)
        overlap = None
        if args.report:
            figures = convert.reported(work, marks, cell)
            files[args.report], overlap = (
                report.as_text(suffix_of(args.report), figures),
                figures.total.overlap,
            )
        too_long = paint.too_long(convert.in_loads(work, cell).plan, work.brush, cell)
    if suffix_of(args.output) != ".json":
        warn(args.input, too_long)
    warn_of_example(args, cell)
    write(args, files, len(work.plan.passes) - args.from_stroke + 1, seconds_of(work, cell, job), overlap)
