"""brushsvg convert: a drawing to the program of a machine, with its picture and its figures."""

from __future__ import annotations

from dataclasses import replace

from ...evaluation import report
from ...machine import preflight, writer
from ...machine.paint_reload import has_pens, in_loads, may_pause, pens_changed, too_long, with_one_pen
from ...machine.program import Job
from ...pipeline import outputs, prediction, preparation
from ...text_summary import summarized
from ..console import RefusedError, about, stage, warn
from ..steps.options import settled, typed, warn_of_cell
from ..steps.output_places import check_places, suffix_of, write
from ..steps.prepared import prepare, seconds_written


def convert_file(args) -> None:
    check_places(args.output, args.preview, args.report, args.page)
    work = prepare(settled(typed(args), args.input))
    suffix, brush, tolerance_mm = suffix_of(args.output), work.brush, work.options.tolerance_mm
    is_program = suffix != ".json"
    cell = writer.painting_cell(suffix, work.options.cell)
    damaged = [] if args.lenient else [notice for notice in work.notices if notice.damaged]
    warn(args.input, [notice for notice in work.notices if notice not in damaged])
    job = Job(args.z_offset, args.from_stroke)
    notes = outputs.notes(work)
    page = job_page_of(args.page, work) if args.page else None
    if args.order == "nearest":
        work, notes = preparation.nearest_first(work), (*notes, "order: nearest first")
    if is_program:
        with about(args.output):
            writer.post_for(suffix, cell)
    with about(args.input):
        if is_program:
            preflight.check_rounding(cell, tolerance_mm)
        marks = prediction.predict(work, suffix_of(args.preview) == ".svg", stage)
        loads = in_loads(work.plan, brush, cell)
        walk = preflight.look(loads, brush, marks, cell, tolerance_mm, job)
        problems = summarized([*walk.problems, *damaged])
        if damaged:
            problems[-1] = replace(problems[-1], advice="--lenient draws what is sound")
        if problems:
            raise RefusedError(args.input, problems)
        made = writer.encoded(suffix, work.plan, walk, brush, work.title, notes)
        files = writer.in_files(args.output, made)
        if page:
            files[args.page] = page
        if args.preview:
            files[args.preview] = outputs.picture(suffix_of(args.preview), work, marks)
        overlap = None
        if args.report:
            figures = outputs.reported(work, marks, work.options.cell)
            files[args.report], overlap = (
                report.as_text(suffix_of(args.report), figures),
                figures.total.overlap,
            )
    warn(args.input, too_long(loads, brush, cell))
    if is_program:
        warn(args.input, with_one_pen(loads, cell, job.first_stroke))
    warn_of_cell(args, cell)
    seconds = seconds_written(suffix, work.plan, walk, brush, work.options.cell)
    stops = pens_changed(loads, cell, job.first_stroke) if is_program and may_pause(cell) else 0
    times = "once" if stops == 1 else f"{stops} times"
    more = f"takes another pen {times}" if has_pens(cell) else f"stops {times} for another pen"
    write(args, files, len(loads.loads) - job.first_stroke + 1, seconds, overlap, more if stops else "")


def job_page_of(path: str, work) -> bytes:
    """The page that is printed for a job, before strokes change their order."""
    from ...calibration.chart.page import chart_page, chart_pdf
    from ...painted.job_page import job_page

    with about(path):
        page = job_page(work.plan, work.title)
        if suffix_of(path) == ".pdf":
            return chart_pdf(page.printed, page.ticks)
        return chart_page(page.printed, page.ticks).encode()
