"""brushsvg setup height: write dabs that show how high the paper is."""

from __future__ import annotations

from dataclasses import replace

from ....jobs.options import DEFAULT_BRUSH
from ....machine import header_lines, writer
from ....machine.motion import duration_s
from ....model.library import find_brush
from ...console import refuse_errors
from ...steps.options import load_brush, load_exact_cell, warn_about_cell
from ...steps.output_places import check_outputs, suffix_of, write_outputs


def height_file(args) -> None:
    from ....machine.setup_programs import paper_height

    check_outputs(args, args.output)
    cell = load_exact_cell(args.cell)
    brush = load_brush(args.brush) or find_brush(DEFAULT_BRUSH)
    with refuse_errors(args.output):
        post = writer.post_for(suffix_of(args.output), cell)
    with refuse_errors(cell.name):
        program = paper_height(brush, cell, args.sheet, args.highest, args.lowest, args.step)
        heights_mm = (args.highest, args.lowest, args.step)
        header = header_lines.height_header(brush.name, args.sheet, heights_mm, program)
        text = writer.text_of(post, replace(program, header=header), suffix_of(args.output))
    warn_about_cell(args, cell)
    write_outputs(args, {args.output: text}, sum(1 for _ in program.sections()), duration_s(program))
