"""brushsvg preview -o FILE.html: a page that plays the job in a browser."""

from __future__ import annotations

from ....jobs import outputs
from ...console import refuse_errors
from ...steps.options import apply_drawing_settings, make_choices
from ...steps.output_places import check_outputs, write_outputs
from ...steps.prepared import prepare_and_simulate


def preview_animation(args) -> None:
    check_outputs(args, args.output)
    looked = prepare_and_simulate(
        apply_drawing_settings(make_choices(args), args.input), outlines=True, at_loads=True
    )
    work, loads, cell = looked.work, looked.loads, looked.work.options.cell
    with refuse_errors(args.input):
        page = outputs.played(work, loads, looked.marks, cell, args.playback or 1.0)
    write_outputs(args, {args.output: page}, len(loads.loads), looked.seconds())
