"""brushsvg preview: draw the paint of a drawing or plan, or write a page that plays the job in a browser."""

from __future__ import annotations

from ....jobs import outputs
from ...console import refuse_errors, say, stage
from ...steps.options import apply_drawing_settings, make_choices
from ...steps.output_places import check_outputs, suffix_of, write_outputs
from ...steps.prepared import prepare_and_simulate


def preview_paint(args) -> None:
    check_outputs(args, args.output)
    suffix = suffix_of(args.output)
    outlines = suffix != ".png" or args.band
    prepared = prepare_and_simulate(
        apply_drawing_settings(make_choices(args), args.input),
        outlines=outlines,
        whole=suffix == ".json",
        tilted=True,
    )
    work, marks = prepared.work, prepared.marks
    with refuse_errors(args.input):
        band = None
        if args.band:
            from ....show.evaluation.uncertainty import make_band

            stage("finding the confidence band")
            band = make_band(work.plan, work.brush, marks)
            if not any(band.rings):
                say(work.brush.name, band.words)
        picture = outputs.make_picture(suffix, work, marks, band, with_toolpath=args.show == "toolpath")
    write_outputs(args, {args.output: picture}, len(work.plan.passes), prepared.seconds())


def preview_animation(args) -> None:
    check_outputs(args, args.output)
    prepared = prepare_and_simulate(
        apply_drawing_settings(make_choices(args), args.input), outlines=True, at_loads=True
    )
    work, loads, cell = prepared.work, prepared.loads, prepared.work.options.cell
    with refuse_errors(args.input):
        page = outputs.make_animation(work, loads, prepared.marks, cell, args.playback or 1.0)
    write_outputs(args, {args.output: page}, len(loads.loads), prepared.seconds())
