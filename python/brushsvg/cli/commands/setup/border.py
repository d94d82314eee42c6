"""brushsvg setup border: move the tool around the job at safe height."""

from __future__ import annotations

from ....jobs.setting_up import make_border
from ....machine.writer import in_files
from ...console import refuse_errors, stage, warn
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, write_outputs


def border_file(args) -> None:
    check_outputs(args, args.output)
    with refuse_errors(""):  # errors name their file themselves
        made = make_border(make_choices(args), args.output, stage, warn)
    write_outputs(args, in_files(args.output, made.text), seconds=made.time_s)
