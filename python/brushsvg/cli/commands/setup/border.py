"""brushsvg setup border: move the tool around the job at safe height."""

from __future__ import annotations

from ....jobs.setting_up import make_border
from ....machine.writer import in_files
from ...console import refuse_errors, stage, warn
from ...steps.leftover_programs import warn_about_leftover_programs
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, write_outputs


def border_file(args) -> None:
    check_outputs(args, args.output)
    with refuse_errors(""):  # errors name their file themselves
        made = make_border(make_choices(args), args.output, stage, warn)
    files = in_files(args.output, made.text)
    warn_about_leftover_programs(args.output, files)
    write_outputs(args, files, seconds=made.time_s)
