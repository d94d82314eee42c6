"""brushsvg border and brushsvg height: what is run before the first stroke."""

from __future__ import annotations

from dataclasses import replace

from ...brush.library import find_brush
from ...machine import header_lines, preflight, writer
from ...machine.motion import duration_s
from ...machine.program import Job
from ...pipeline import outputs, preparation
from ..console import about
from .options import brush_of, exact_cell, settled, typed, warn_of_example
from .outputs import check_places, suffix_of, write
from .prepare import look


def border_file(args) -> None:
    from ...machine.setup_programs import around, border

    check_places(args.output)
    looked = look(settled(typed(args), args.input), outlines=False)
    work, cell = looked.work, looked.work.options.cell
    with about(args.output):
        post = writer.post_for(suffix_of(args.output), cell)
    with about(args.input):
        around_mm = around(preflight.bounds_mm(looked.marks, work.brush))
        made = border(around_mm, work.brush, cell, work.plan.sheet_mm, args.z_offset)
        title, count = f"border of {work.title or 'untitled'}", len(work.plan.passes)
        job = Job(args.z_offset)
        header = header_lines.border_header(
            title, work.brush.name, count, work.plan.sheet_mm, outputs.notes(work), around_mm, made, job
        )
        text = writer.text_of(post, replace(made, header=header))
    warn_of_example(args, cell)
    write(args, {args.output: text}, seconds=duration_s(made))


def height_file(args) -> None:
    from ...machine.setup_programs import paper_height

    check_places(args.output)
    cell = exact_cell(args.cell)
    brush = brush_of(args.brush) or find_brush(preparation.DEFAULT_BRUSH)
    with about(args.output):
        post = writer.post_for(suffix_of(args.output), cell)
    with about(cell.name):
        made = paper_height(brush, cell, args.sheet, args.highest, args.lowest, args.step)
        heights_mm = (args.highest, args.lowest, args.step)
        header = header_lines.height_header(brush.name, args.sheet, heights_mm, made)
        text = writer.text_of(post, replace(made, header=header))
    warn_of_example(args, cell)
    write(args, {args.output: text}, sum(1 for _ in made.sections()), duration_s(made))
