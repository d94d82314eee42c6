"""brushsvg setup first-run: write a slow, careful first program for a new machine."""

from __future__ import annotations

from dataclasses import replace

from ....jobs.options import DEFAULT_BRUSH
from ....machine import header_lines, writer
from ....machine.motion import duration_s
from ....model.library import find_brush
from ...console import about
from ...steps.options import brush_of, exact_cell, warn_of_cell
from ...steps.output_places import check_places, suffix_of, write

HEIGHTS_MM = (1.0, -1.0, 0.1)  # the defaults of the command height


def first_run_file(args) -> None:
    from ....machine.setup_programs import first_run

    check_places(args, args.output)
    cell = exact_cell(args.input)
    brush = brush_of(args.brush) or find_brush(DEFAULT_BRUSH)
    with about(args.output):
        post = writer.post_for(suffix_of(args.output), cell)
    with about(cell.name):
        made = first_run(brush, cell, args.sheet, *HEIGHTS_MM)
        header = header_lines.first_header(brush.name, args.sheet, HEIGHTS_MM, made)
        text = writer.text_of(post, replace(made, header=header), suffix_of(args.output))
    warn_of_cell(args, cell)
    write(args, {args.output: text}, seconds=duration_s(made))
