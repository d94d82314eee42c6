"""brushsvg setup border: move the tool around the job at safe height.

The border goes around all paint and the path of the tool.
"""

from __future__ import annotations

from dataclasses import replace

from ....jobs import outputs
from ....machine import header_lines, preflight, writer
from ....machine.motion import duration_s
from ....machine.program import Job
from ...console import refuse_errors
from ...steps.options import apply_drawing_settings, make_choices, warn_about_cell
from ...steps.output_places import check_outputs, suffix_of, write_outputs
from ...steps.prepared import prepare_and_simulate


def border_file(args) -> None:
    from ....machine.setup_programs import around, border

    check_outputs(args, args.output)
    prepared = prepare_and_simulate(apply_drawing_settings(make_choices(args), args.input), outlines=False)
    work, cell = prepared.work, prepared.work.options.cell
    with refuse_errors(args.output):
        post = writer.post_for(suffix_of(args.output), cell)
    with refuse_errors(args.input):
        around_mm = around(preflight.job_bounds_mm(work.plan, prepared.marks, work.brush))
        program = border(around_mm, work.brush, cell, work.plan.sheet_mm, args.z_offset)
        title, count = f"border of {work.title or 'untitled'}", len(work.plan.passes)
        job = Job(args.z_offset)
        header = header_lines.border_header(
            title,
            work.brush.name,
            count,
            work.plan.sheet_mm,
            outputs.header_lines(work),
            around_mm,
            program,
            job,
        )
        text = writer.text_of(post, replace(program, header=header), suffix_of(args.output))
    warn_about_cell(args, cell)
    write_outputs(args, {args.output: text}, seconds=duration_s(program))
