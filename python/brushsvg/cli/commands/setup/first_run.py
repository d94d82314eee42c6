"""brushsvg setup first-run: write a slow, careful program for a new machine."""

from __future__ import annotations

from dataclasses import replace

from ....jobs.options import DEFAULT_BRUSH
from ....machine import header_lines, writer
from ....machine.motion import duration_s
from ....model.library import find_brush
from ...console import refuse_errors, warn
from ...steps.options import load_brush, load_exact_cell, warn_about_cell
from ...steps.output_places import check_outputs, suffix_of, write_outputs

HEIGHTS_MM = (1.0, -1.0, 0.1)  # first, last, step: the defaults of the command height


def first_run_file(args) -> None:
    from ....machine.setup_programs import first_run, report_missing_air_run

    check_outputs(args, args.output)
    cell = load_exact_cell(args.input)
    brush = load_brush(args.brush) or find_brush(DEFAULT_BRUSH)
    with refuse_errors(args.output):
        post = writer.post_for(suffix_of(args.output), cell)
    with refuse_errors(cell.name):
        program = first_run(brush, cell, args.sheet, *HEIGHTS_MM)
        header = header_lines.first_header(brush.name, args.sheet, HEIGHTS_MM, program)
        text = writer.text_of(post, replace(program, header=header), suffix_of(args.output))
    warn_about_cell(args, cell)
    warn(cell.name, report_missing_air_run(cell, args.sheet))
    write_outputs(args, {args.output: text}, seconds=duration_s(program))
