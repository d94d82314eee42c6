"""brushsvg preview -o FILE.html: a page that plays the job in a browser."""

from __future__ import annotations

from ....jobs import outputs
from ...console import about
from ...steps.options import settled, typed
from ...steps.output_places import check_places, write
from ...steps.prepared import look


def preview_animation(args) -> None:
    check_places(args, args.output)
    looked = look(settled(typed(args), args.input), outlines=True, at_loads=True)
    work, loads, cell = looked.work, looked.loads, looked.work.options.cell
    with about(args.input):
        page = outputs.played(work, loads, looked.marks, cell, args.playback or 1.0)
    write(args, {args.output: page}, len(loads.loads), looked.seconds())
