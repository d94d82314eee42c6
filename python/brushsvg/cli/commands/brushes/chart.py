"""brushsvg chart: write the strokes that a brush is calibrated from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from .... import _core
from ....errors import Error, Notice
from ....jobs.conversion import estimate_output_time_s
from ....jobs.options import DEFAULT_BRUSH
from ....machine import preflight, writer
from ....machine.job_program import Job
from ....machine.leftover_programs import report_leftover_programs
from ....machine.paint_reload import split_into_loads
from ....model.library import find_brush
from ....model.unknown_keys import mistyped_keys
from ....notice_summary import summarize_notices
from ...arguments.values import EDGE_NOISE_MM
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import (
    apply_drawing_settings,
    load_brush,
    load_exact_cell,
    make_choices,
    warn_about_cell,
)
from ...steps.output_places import check_outputs, suffix_of, write_outputs


def _advise_smaller_sheet(problem: Notice) -> Notice:
    is_too_large = problem.code == "out-of-box" and problem.about != "z"
    return replace(problem, advice="--sheet WxH makes a smaller chart") if is_too_large else problem


def _adapt_to_paint_chart(notices: list[Notice]) -> list[Notice]:
    """Return the notices for a chart that is painted with one load, and measures how marks narrow."""
    advice = "--strokes few and a smaller --sheet make a shorter chart"
    return [
        replace(notice, advice=advice) if notice.code == "paint-runs-out" else notice
        for notice in notices
        if notice.code != "paint-unknown"
    ]


def chart_file(args) -> None:
    from ....calibration.chart.dabs import dab_chart_report
    from ....calibration.chart.expected import chart_report
    from ....calibration.chart.file import write_chart
    from ....calibration.chart.layout import chart
    from ....calibration.chart.page import chart_page

    check_outputs(args, args.output, args.page, args.chart)
    chosen = make_choices(args)
    if args.drawing:
        chosen = apply_drawing_settings(chosen, args.drawing, alone=True)
    brush = load_brush(chosen.brush) or find_brush(DEFAULT_BRUSH)
    suffix, cell = suffix_of(args.output), load_exact_cell(chosen.cell)
    with refuse_errors(args.output):
        if suffix != ".json":
            writer.post_for(suffix, cell)
        if cell.pen and not brush.is_rigid():
            sentence = (
                f"the pen of cell {cell.name} is up or down: it cannot press the brush to the several depths of a chart"
            )
            raise Error(sentence, code="pen-depth")
        stage("laying out the chart")
        laid_out = chart(brush, args.sheet, args.strokes, -cell.heights.lowest_mm, args.dabs, args.paint)
        loads, marks = split_into_loads(laid_out.plan, brush, cell), _core.simulate(laid_out.plan, brush)
        tolerance_mm = preflight.DEFAULT_TOLERANCE_MM
        walk = preflight.check_job(loads, brush, marks, cell, tolerance_mm, Job(args.z_offset))
        if walk.problems:
            raise RefusedError(args.output, summarize_notices([_advise_smaller_sheet(each) for each in walk.problems]))
        title = f"{'dabs' if args.dabs else 'calibration chart'} of brush {brush.name}"
        name = Path(args.output).stem
        files = writer.in_files(args.output, writer.encode_checked(suffix, laid_out.plan, walk, brush, title, (), name))
    if args.page:
        with refuse_errors(args.page):
            files[args.page] = chart_page(laid_out, suffix_of(args.page))
    if args.chart:
        files[args.chart] = write_chart(laid_out).encode()
    notices = writer.report_program(suffix, loads, brush, cell, name)
    warn(args.output, [*mistyped_keys(brush), *(_adapt_to_paint_chart(notices) if args.paint else notices)])
    warn_about_cell(args, cell)
    warn(args.output, report_leftover_programs(args.output, files))
    write_outputs(args, files, len(loads.loads), estimate_output_time_s(suffix, laid_out.plan, walk, brush, cell))
    print_text(
        dab_chart_report(laid_out, brush) if args.dabs else chart_report(laid_out, brush, args.noise or EDGE_NOISE_MM)
    )
