"""brushsvg preview without -o, and --show errors: report how close the paint comes to the drawing."""

from __future__ import annotations

from ....jobs import outputs
from ....jobs.choices import layout_of, reading_of
from ....jobs.options import DEFAULT_BRUSH
from ....jobs.preparation import other_brushes, other_sizes
from ....model.library import brush_names, find_brush
from ....read import read_drawing
from ....read.layout import arrange
from ....show.evaluation import report
from ....text_summary import summarized
from ...console import RefusedError, about, print_text, stage
from ...steps.options import options_of, settled, typed
from ...steps.output_places import check_places, suffix_of, write
from ...steps.prepared import look


def preview_report(args) -> None:
    check_places(args, args.output)
    if args.all_brushes:
        return _all_brushes(args)
    chosen = settled(typed(args), args.input)
    looked = look(chosen, outlines=suffix_of(args.output) == ".svg", partly=True)
    work, marks = looked.work, looked.marks
    with about(args.input):
        stage("trying other sizes")
        advice = other_sizes.advice(work)
        figures = outputs.reported(
            work,
            marks,
            work.options.cell,
            looked.warnings,
            looked.forbidden,
            seconds=looked.seconds(),
            advice=advice,
        )
        text = report.as_text(".json" if args.json else ".txt", figures, args.details, args.output or "")
        if args.output:
            picture = outputs.overlap_picture(suffix_of(args.output), work, marks, places=figures.places)
            write(args, {args.output: picture}, len(figures.strokes), figures.time_s, figures.total.overlap)
    if work.plan.passes or args.json:
        print_text(text)
    elif advice:
        print_text(advice + "\n")
    if work.refused:
        raise RefusedError(args.input, summarized(work.refused))


def _all_brushes(args) -> None:
    # in place of the brush that the drawing names
    chosen = settled(typed(args, brush=DEFAULT_BRUSH), args.input)
    names = [*brush_names(), *(name for name in args.brush or () if name not in brush_names())]
    brushes = []
    for name in names:
        with about(name):
            brushes.append(find_brush(name))
    options = options_of(chosen)
    with about(args.input):
        suits = other_brushes.suits(args.input, options, brushes, stage)
        title = arrange(read_drawing(args.input, reading_of(chosen)), layout_of(chosen)).title
        print_text(report.brushes_json(title, suits) if args.json else report.brushes_text(title, suits))
