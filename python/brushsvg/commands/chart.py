"""brushsvg chart: the strokes that a brush is calibrated from."""

from __future__ import annotations

from .. import _core, convert, machine
from ..brushes import find_brush
from ..console import RefusedError, about, stage, tell
from ..fold import folded
from ..program import Job
from .choices import brush_of, cell_of, settle, warn_of_example
from .outputs import check_places, suffix_of, write


def chart_file(args) -> None:
    from ..chart import chart
    from ..chart_json import write_chart
    from ..chart_page import chart_page
    from ..chart_report import chart_report

    check_places(args.output, args.page, args.chart)
    if args.drawing:
        settle(args, args.drawing, alone=True)
    brush = brush_of(args) or find_brush(convert.DEFAULT_BRUSH)
    cell = machine.as_exact_as(cell_of(args), machine.DEFAULT_TOLERANCE_MM)
    with about(args.output):
        if suffix_of(args.output) != ".json":
            machine.post_for(suffix_of(args.output), cell)
        stage("laying out the chart")
        made = chart(brush, args.sheet, args.strokes, -cell.heights.lowest_mm)
        job = Job(args.z_offset)
        marks = _core.simulate(made.plan, brush)
        problems = machine.problems(made.plan, brush, marks, cell, machine.DEFAULT_TOLERANCE_MM, job)
        if problems:
            raise RefusedError([(args.output, *problem) for problem in folded(problems)])
        title = f"calibration chart of brush {brush.name}"
        files = {args.output: machine.encode(suffix_of(args.output), made.plan, brush, title, (), cell, job)}
    if args.page:
        files[args.page] = chart_page(made).encode()
    if args.chart:
        files[args.chart] = write_chart(made).encode()
    warn_of_example(args, cell)
    write(args, files, len(made.plan.passes), machine.time_s(made.plan, brush, cell, job))
    tell(chart_report(made, brush, args.noise))
