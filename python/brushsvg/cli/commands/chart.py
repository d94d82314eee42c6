"""brushsvg chart: the strokes that a brush is calibrated from."""

from __future__ import annotations

from ... import _core
from ...brush.library import find_brush
from ...machine import preflight, writer
from ...machine.program import Job
from ...pipeline import preparation
from ...text_summary import folded
from ..console import RefusedError, about, stage, tell
from .options import brush_of, cell_of, settle, warn_of_example
from .outputs import check_places, suffix_of, write


def chart_file(args) -> None:
    from ...calibration.chart.expected import chart_report
    from ...calibration.chart.file import write_chart
    from ...calibration.chart.layout import chart
    from ...calibration.chart.page import chart_page, chart_pdf

    check_places(args.output, args.page, args.chart)
    if args.drawing:
        settle(args, args.drawing, alone=True)
    brush = brush_of(args) or find_brush(preparation.DEFAULT_BRUSH)
    cell = preflight.as_exact_as(cell_of(args), preflight.DEFAULT_TOLERANCE_MM)
    with about(args.output):
        if suffix_of(args.output) != ".json":
            writer.post_for(suffix_of(args.output), cell)
        stage("laying out the chart")
        made = chart(brush, args.sheet, args.strokes, -cell.heights.lowest_mm)
        job = Job(args.z_offset)
        marks = _core.simulate(made.plan, brush)
        problems = preflight.problems(made.plan, brush, marks, cell, preflight.DEFAULT_TOLERANCE_MM, job)
        if problems:
            raise RefusedError([(args.output, *problem) for problem in folded(problems)])
        title = f"calibration chart of brush {brush.name}"
        files = {args.output: writer.encode(suffix_of(args.output), made.plan, brush, title, (), cell, job)}
    if args.page:
        pdf = suffix_of(args.page) == ".pdf"
        files[args.page] = chart_pdf(made) if pdf else chart_page(made).encode()
    if args.chart:
        files[args.chart] = write_chart(made).encode()
    warn_of_example(args, cell)
    write(args, files, len(made.plan.passes), writer.time_s(made.plan, brush, cell, job))
    tell(chart_report(made, brush, args.noise))
