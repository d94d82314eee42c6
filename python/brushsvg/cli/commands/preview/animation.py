"""brushsvg preview -o FILE.html: write a page that plays the job in a browser."""

from __future__ import annotations

from ....jobs import outputs
from ...console import refuse_errors
from ...steps.options import apply_drawing_settings, make_choices
from ...steps.output_places import check_outputs, write_outputs
from ...steps.prepared import prepare_and_simulate


def preview_animation(args) -> None:
    check_outputs(args, args.output)
    prepared = prepare_and_simulate(
        apply_drawing_settings(make_choices(args), args.input), outlines=True, at_loads=True
    )
    work, loads, cell = prepared.work, prepared.loads, prepared.work.options.cell
    with refuse_errors(args.input):
        page = outputs.make_animation(work, loads, prepared.marks, cell, args.playback or 1.0)
    write_outputs(args, {args.output: page}, len(loads.loads), prepared.seconds())
