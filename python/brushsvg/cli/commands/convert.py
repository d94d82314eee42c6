"""brushsvg convert: a drawing to the program of a machine, with its picture and its figures."""

from __future__ import annotations

from ...evaluation import report
from ...machine.paint_reload import has_pens, may_pause, pens_changed
from ...machine.program import Job
from ...pipeline import conversion, outputs
from ...pipeline.choices import on_a_page
from ...pipeline.margin_strokes import expected_in_words
from ..console import RefusedError, about, stage, tell, warn
from ..steps.options import settled, typed, warn_of_cell
from ..steps.output_places import check_places, suffix_of, write
from ..steps.prepared import prepare


def convert_file(args) -> None:
    check_places(args, args.output, args.preview, args.report, args.page)
    chosen = settled(typed(args), args.input)
    work = prepare(on_a_page(chosen) if args.page else chosen)
    suffix, job = suffix_of(args.output), Job(args.z_offset, args.from_stroke)
    warn(args.input, [notice for notice in work.notices if args.lenient or not notice.damaged])
    files = {}
    if args.page:
        with about(args.page):
            files[args.page] = outputs.page(suffix_of(args.page), work)
    with about(args.input):
        rings = suffix_of(args.preview) == ".svg"
        one = conversion.tried(work, suffix, job, args.order, args.lenient, rings, stage, path=args.output)
        if one.problems:
            raise RefusedError(args.input, one.problems)
        files = one.encoded(args.output) | files
        if args.preview:
            files[args.preview] = outputs.picture(suffix_of(args.preview), one.work, one.marks)
        overlap = None
        if args.report:
            figures = outputs.reported(one.work, one.marks, work.options.cell)
            files[args.report] = report.as_text(suffix_of(args.report), figures)
            overlap = figures.total.overlap
    warn(args.input, one.remarks())
    warn_of_cell(args, one.cell)
    stops = (
        pens_changed(one.loads, one.cell, job.first_stroke) if one.is_program and may_pause(one.cell) else 0
    )
    times = "once" if stops == 1 else f"{stops} times"
    more = f"takes another pen {times}" if has_pens(one.cell) else f"stops {times} for another pen"
    write(
        args, files, len(one.loads.loads) - job.first_stroke + 1, one.time_s(), overlap, more if stops else ""
    )
    if not args.quiet and (words := expected_in_words(work)):
        tell(f"{words}\n")
