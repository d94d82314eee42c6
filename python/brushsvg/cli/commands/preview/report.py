"""brushsvg preview without -o, and --show errors: report on the paint.

The report says how close the paint comes to the drawing.
"""

from __future__ import annotations

from ....jobs import outputs
from ....jobs.choices.ineffective_flags import report_ineffective_flags
from ....jobs.options import DEFAULT_BRUSH, make_layout, make_read_options
from ....jobs.preparation import other_brushes, other_sizes
from ....model.library import brush_names, find_brush
from ....notice_summary import summarize_notices
from ....read import read_drawing
from ....read.layout import arrange
from ....show.evaluation import report
from ...console import RefusedError, print_text, refuse_errors, stage, warn
from ...steps.options import apply_drawing_settings, make_choices, make_options
from ...steps.output_places import check_outputs, suffix_of, write_outputs
from ...steps.prepared import prepare_and_simulate


def preview_report(args) -> None:
    check_outputs(args, args.output)
    if args.all_brushes:
        return _report_all_brushes(args)
    chosen = apply_drawing_settings(make_choices(args), args.input)
    prepared = prepare_and_simulate(chosen, outlines=suffix_of(args.output) == ".svg", partly=True)
    work, marks = prepared.work, prepared.marks
    with refuse_errors(args.input):
        stage("trying other sizes")
        advice = other_sizes.advise_on_size(work)
        figures = outputs.make_report(
            work,
            marks,
            work.options.cell,
            prepared.warnings,
            prepared.forbidden,
            seconds=prepared.seconds(),
            advice=advice,
        )
        text = report.as_text(".json" if args.json else ".txt", figures, args.details, args.output or "")
        if args.output:
            picture = outputs.overlap_picture(suffix_of(args.output), work, marks, places=figures.places)
            write_outputs(args, {args.output: picture}, len(figures.strokes), figures.time_s, figures.total.overlap)
    if work.plan.passes or args.json:
        print_text(text)
    elif advice:
        print_text(advice + "\n")
    if work.refused:
        raise RefusedError(args.input, summarize_notices(work.refused))


def _report_all_brushes(args) -> None:
    # The default brush takes the place of the brush that the drawing names.
    chosen = apply_drawing_settings(make_choices(args, brush=DEFAULT_BRUSH), args.input)
    warn(args.input, report_ineffective_flags(chosen))
    names = [*brush_names(), *(name for name in args.brush or () if name not in brush_names())]
    brushes = []
    for name in names:
        with refuse_errors(name):
            brushes.append(find_brush(name))
    options = make_options(chosen)
    with refuse_errors(args.input):
        suits = other_brushes.rank_brushes(args.input, options, brushes, stage)
        title = arrange(read_drawing(args.input, make_read_options(chosen)), make_layout(chosen)).title
        print_text(report.brushes_json(title, suits) if args.json else report.brushes_text(title, suits))
