"""brushsvg simulate-photo: render the photograph of a painted job."""

from __future__ import annotations

from ....files import read_bytes
from ...console import print_text, refuse_errors, stage, warn
from ...steps.options import apply_drawing_settings, load_brush, make_choices
from ...steps.output_places import check_outputs, suffix_of, write_outputs
from ...steps.prepared import prepare


def simulate_photo_file(args) -> None:
    from ....comparison.job_page import JobPage, job_page
    from ....jobs.choices import choose_margin_strokes
    from ....machine.paint_reload import fetched_mm
    from ....simulated.painting import low_enough, painted
    from ....simulated.photo import simulated_photo
    from ....simulated.studio import random_studio, read_studio, write_studio

    check_outputs(args, args.output)
    if args.studio is not None:
        with refuse_errors(args.studio):
            studio = read_studio(read_bytes(args.studio))
    chart = _read_chart_if_any(args.input)
    work = prepare(
        choose_margin_strokes(apply_drawing_settings(make_choices(args), args.input)),
        plan=chart and chart.plan,
    )
    warn(args.input, work.notices)
    brush = load_brush(args.true_brush) or work.brush
    if args.studio is None:
        studio = random_studio(args.seed, work.plan.sheet_mm)
        studio = low_enough(studio, work.plan, brush, work.options.cell.machine)
    with refuse_errors(args.input):
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
        photograph = simulated_photo(page, strokes, studio, args.seed)
    write_outputs(args, {args.output: photograph}, len(strokes), more="simulated")
    if args.studio is None:
        print_text(write_studio(studio))


def _read_chart_if_any(path: str):
    """Return the chart that chart --chart wrote, or None for a drawing or a plan."""
    from ....calibration.chart.file import is_chart, read_chart

    if suffix_of(path) != ".json":
        return None
    with refuse_errors(path):
        data = read_bytes(path)
        return read_chart(data) if is_chart(data) else None
