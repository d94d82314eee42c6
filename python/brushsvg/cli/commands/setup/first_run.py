"""brushsvg setup first-run: write a slow, careful program for a new machine."""

from __future__ import annotations

from ....jobs.choices import Choices
from ....jobs.setting_up import make_first_run
from ....machine.writer import in_files
from ...console import refuse_errors, warn
from ...steps.leftover_programs import warn_about_leftover_programs
from ...steps.output_places import check_outputs, write_outputs


def first_run_file(args) -> None:
    check_outputs(args, args.output)
    with refuse_errors(""):  # errors name their file themselves
        made = make_first_run(Choices(cell=args.input, brush=args.brush, sheet=args.sheet), args.output, warn)
    files = in_files(args.output, made.text)
    warn_about_leftover_programs(args.output, files)
    write_outputs(args, files, seconds=made.time_s)
