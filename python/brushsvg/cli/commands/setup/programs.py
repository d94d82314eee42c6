"""brushsvg setup border, first-run and height: write the programs that are run before a job."""

from __future__ import annotations

from ....jobs.choices.choices import Choices
from ....jobs.setting_up import make_border, make_first_run, make_height
from ....machine.leftover_programs import report_leftover_programs
from ....machine.writer import in_files
from ...console import refuse_errors, stage, warn
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, write_outputs


def border_file(args) -> None:
    check_outputs(args, args.output)
    with refuse_errors(""):  # errors name their file themselves
        made = make_border(make_choices(args), args.output, stage, warn)
    _write(args, made)


def first_run_file(args) -> None:
    check_outputs(args, args.output)
    with refuse_errors(""):
        made = make_first_run(Choices(cell=args.input, brush=args.brush, sheet=args.sheet), args.output, warn)
    _write(args, made)


def height_file(args) -> None:
    check_outputs(args, args.output)
    heights_mm = (args.highest, args.lowest, args.step)
    with refuse_errors(""):
        made = make_height(Choices(cell=args.cell, brush=args.brush, sheet=args.sheet), heights_mm, args.output, warn)
    _write(args, made, made.stroke_count)


def _write(args, made, stroke_count: int | None = None) -> None:
    files = in_files(args.output, made.text)
    warn(args.output, report_leftover_programs(args.output, files))
    write_outputs(args, files, stroke_count, made.time_s)
