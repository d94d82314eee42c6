"""brushsvg border and brushsvg height: what is run before the first stroke."""

from __future__ import annotations

from dataclasses import replace

from .. import convert, machine
from ..brushes import find_brush
from ..console import about
from ..program import Job
from .choices import brush_of, cell_of, settle, warn_of_example
from .outputs import check_places, suffix_of, write
from .work import look


def border_file(args) -> None:
    from ..jobs import border

    check_places(args.output)
    settle(args)
    cell = cell_of(args)
    work, marks, _ = look(args, cell, outlines=False)
    with about(args.input):
        post = machine.post_for(suffix_of(args.output), cell)
        made = border(machine.bounds_mm(marks, work.brush), work.brush, cell, args.z_offset)
        header = (f"title: border of {work.title or 'untitled'}", *machine.about(made, Job(args.z_offset)))
        text = machine.text_of(post, replace(made, header=header))
    warn_of_example(args, cell)
    write({args.output: text})


def height_file(args) -> None:
    from ..jobs import paper_height

    check_places(args.output)
    cell, brush = cell_of(args), brush_of(args) or find_brush(convert.DEFAULT_BRUSH)
    with about(cell.name):
        post = machine.post_for(suffix_of(args.output), cell)
        made = paper_height(brush, cell, args.sheet, args.highest, args.lowest, args.step)
        header = ("title: how high the paper lies", f"brush: {brush.name}", *machine.about(made))
        text = machine.text_of(post, replace(made, header=header))
    warn_of_example(args, cell)
    write({args.output: text})
