"""brushsvg chart: the strokes that a brush is calibrated from."""

from __future__ import annotations

from dataclasses import replace

from .... import _core
from ....errors import Notice
from ....jobs.conversion import time_written_s
from ....jobs.options import DEFAULT_BRUSH
from ....machine import preflight, writer
from ....machine.paint_reload import in_loads
from ....machine.program import Job
from ....model.library import find_brush
from ....text_summary import summarized
from ...arguments.values import EDGE_NOISE_MM
from ...console import RefusedError, about, print_text, stage
from ...steps.options import brush_of, exact_cell, settled, typed, warn_of_cell
from ...steps.output_places import check_places, suffix_of, write


def _with_sheet(problem: Notice) -> Notice:
    is_too_large = problem.code == "out-of-box" and problem.about != "z"
    return replace(problem, advice="--sheet WxH makes a smaller chart") if is_too_large else problem


def chart_file(args) -> None:
    from ....calibration.chart.dabs import dab_chart_report
    from ....calibration.chart.expected import chart_report
    from ....calibration.chart.file import write_chart
    from ....calibration.chart.layout import chart
    from ....calibration.chart.page import chart_page, chart_pdf

    check_places(args, args.output, args.page, args.chart)
    chosen = typed(args)
    if args.drawing:
        chosen = settled(chosen, args.drawing, alone=True)
    brush = brush_of(chosen.brush) or find_brush(DEFAULT_BRUSH)
    suffix, cell = suffix_of(args.output), exact_cell(chosen.cell)
    with about(args.output):
        if suffix != ".json":
            writer.post_for(suffix, cell)
        stage("laying out the chart")
        made = chart(brush, args.sheet, args.strokes, -cell.heights.lowest_mm, args.dabs, args.paint)
        loads, marks = in_loads(made.plan, brush, cell), _core.simulate(made.plan, brush)
        tolerance_mm = preflight.DEFAULT_TOLERANCE_MM
        walk = preflight.look(loads, brush, marks, cell, tolerance_mm, Job(args.z_offset))
        if walk.problems:
            raise RefusedError(args.output, summarized([_with_sheet(each) for each in walk.problems]))
        title = f"{'dabs' if args.dabs else 'calibration chart'} of brush {brush.name}"
        files = writer.in_files(args.output, writer.encoded(suffix, made.plan, walk, brush, title))
    if args.page:
        pdf = suffix_of(args.page) == ".pdf"
        with about(args.page):
            files[args.page] = chart_pdf(made) if pdf else chart_page(made).encode()
    if args.chart:
        files[args.chart] = write_chart(made).encode()
    warn_of_cell(args, cell)
    write(args, files, len(loads.loads), time_written_s(suffix, made.plan, walk, brush, cell))
    print_text(
        dab_chart_report(made, brush) if args.dabs else chart_report(made, brush, args.noise or EDGE_NOISE_MM)
    )
