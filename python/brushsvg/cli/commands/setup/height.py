"""brushsvg setup height: write dabs that show how high the paper is."""

from __future__ import annotations

from dataclasses import replace

from ....jobs.options import DEFAULT_BRUSH
from ....machine import header_lines, writer
from ....machine.motion import duration_s
from ....model.library import find_brush
from ...console import about
from ...steps.options import brush_of, exact_cell, warn_of_cell
from ...steps.output_places import check_places, suffix_of, write


def height_file(args) -> None:
    from ....machine.setup_programs import paper_height

    check_places(args, args.output)
    cell = exact_cell(args.cell)
    brush = brush_of(args.brush) or find_brush(DEFAULT_BRUSH)
    with about(args.output):
        post = writer.post_for(suffix_of(args.output), cell)
    with about(cell.name):
        made = paper_height(brush, cell, args.sheet, args.highest, args.lowest, args.step)
        heights_mm = (args.highest, args.lowest, args.step)
        header = header_lines.height_header(brush.name, args.sheet, heights_mm, made)
        text = writer.text_of(post, replace(made, header=header), suffix_of(args.output))
    warn_of_cell(args, cell)
    write(args, {args.output: text}, sum(1 for _ in made.sections()), duration_s(made))
