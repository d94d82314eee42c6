"""brushsvg border and brushsvg height: what is run before the first stroke."""

from __future__ import annotations

from dataclasses import replace

from .. import convert, machine
from ..brushes import find_brush
from ..console import about
from ..moves import duration_s
from ..program import Job
from .choices import brush_of, cell_of, settle, warn_of_example
from .outputs import check_places, suffix_of, write
from .work import look


def border_file(args) -> None:
    from ..jobs import around, border

    check_places(args.output)
    settle(args, args.input)
    cell = cell_of(args)
    work, marks, *_ = look(args, cell, outlines=False)
    cell = machine.as_exact_as(cell, work.options.tolerance_mm)
    with about(args.input):
        post = machine.post_for(suffix_of(args.output), cell)
        around_mm = around(machine.bounds_mm(marks, work.brush))
        made = border(around_mm, work.brush, cell, work.plan.sheet_mm, args.z_offset)
        title, count = f"border of {work.title or 'untitled'}", len(work.plan.passes)
        job = Job(args.z_offset)
        header = machine.border_header(
            title, work.brush.name, count, work.plan.sheet_mm, convert.notes(work), around_mm, made, job
        )
        text = machine.text_of(post, replace(made, header=header))
    warn_of_example(args, cell)
    write(args, {args.output: text}, seconds=duration_s(made))


def height_file(args) -> None:
    from ..jobs import paper_height

    check_places(args.output)
    cell = machine.as_exact_as(cell_of(args), machine.DEFAULT_TOLERANCE_MM)
    brush = brush_of(args) or find_brush(convert.DEFAULT_BRUSH)
    with about(cell.name):
        post = machine.post_for(suffix_of(args.output), cell)
        made = paper_height(brush, cell, args.sheet, args.highest, args.lowest, args.step)
        heights_mm = (args.highest, args.lowest, args.step)
        header = machine.height_header(brush.name, args.sheet, heights_mm, made)
        text = machine.text_of(post, replace(made, header=header))
    warn_of_example(args, cell)
    write(args, {args.output: text}, sum(1 for _ in made.sections()), duration_s(made))
