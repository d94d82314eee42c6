"""brushsvg setup border: move the tool around all paint and the path of the tool, at safe height."""

from __future__ import annotations

from dataclasses import replace

from ....jobs import outputs
from ....machine import header_lines, preflight, writer
from ....machine.motion import duration_s
from ....machine.program import Job
from ...console import about
from ...steps.options import settled, typed, warn_of_cell
from ...steps.output_places import check_places, suffix_of, write
from ...steps.prepared import look


def border_file(args) -> None:
    from ....machine.setup_programs import around, border

    check_places(args, args.output)
    looked = look(settled(typed(args), args.input), outlines=False)
    work, cell = looked.work, looked.work.options.cell
    with about(args.output):
        post = writer.post_for(suffix_of(args.output), cell)
    with about(args.input):
        around_mm = around(preflight.job_bounds_mm(work.plan, looked.marks, work.brush))
        made = border(around_mm, work.brush, cell, work.plan.sheet_mm, args.z_offset)
        title, count = f"border of {work.title or 'untitled'}", len(work.plan.passes)
        job = Job(args.z_offset)
        header = header_lines.border_header(
            title, work.brush.name, count, work.plan.sheet_mm, outputs.notes(work), around_mm, made, job
        )
        text = writer.text_of(post, replace(made, header=header), suffix_of(args.output))
    warn_of_cell(args, cell)
    write(args, {args.output: text}, seconds=duration_s(made))
