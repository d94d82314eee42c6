"""brushsvg simulate-photo: the photograph of a job that nobody painted."""

from __future__ import annotations

from ....files import read_bytes
from ...console import about, print_text, stage, warn
from ...steps.options import brush_of, settled, typed
from ...steps.output_places import check_places, suffix_of, write
from ...steps.prepared import prepare


def simulate_photo_file(args) -> None:
    from ....comparison.job_page import JobPage, job_page
    from ....jobs.choices import on_a_page
    from ....machine.paint_reload import fetched_mm
    from ....simulated.painting import low_enough, painted
    from ....simulated.photo import simulated_photo
    from ....simulated.studio import random_studio, read_studio, write_studio

    check_places(args, args.output)
    if args.studio is not None:
        with about(args.studio):
            studio = read_studio(read_bytes(args.studio))
    chart = _chart(args.input)
    work = prepare(on_a_page(settled(typed(args), args.input)), plan=chart and chart.plan)
    warn(args.input, work.notices)
    brush = brush_of(args.true_brush) or work.brush
    if args.studio is None:
        studio = random_studio(args.seed, work.plan.sheet_mm)
        studio = low_enough(studio, work.plan, brush, work.options.cell.machine)
    with about(args.input):
        stage("painting")
        strokes = painted(
            work.plan,
            brush,
            studio,
            work.options.cell.machine,
            args.seed,
            fetched_mm(work.plan, brush, work.options.cell),
        )
        stage("photographing")
        page = JobPage(chart, 0.0, ()) if chart else job_page(work.plan, work.title)
        made = simulated_photo(page, strokes, studio, args.seed)
    write(args, {args.output: made}, len(strokes), more="simulated")
    if args.studio is None:
        print_text(write_studio(studio))


def _chart(path: str):
    """The chart that chart --chart wrote; None for a drawing or a plan."""
    from ....calibration.chart.file import is_chart, read_chart

    if suffix_of(path) != ".json":
        return None
    with about(path):
        data = read_bytes(path)
        return read_chart(data) if is_chart(data) else None
