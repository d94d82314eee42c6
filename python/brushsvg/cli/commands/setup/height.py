"""brushsvg setup height: write strokes that show how high the paper is."""

from __future__ import annotations

from ....jobs.choices import Choices
from ....jobs.setting_up import make_height
from ....machine.writer import in_files
from ...console import refuse_errors, warn
from ...steps.leftover_programs import warn_about_leftover_programs
from ...steps.output_places import check_outputs, write_outputs


def height_file(args) -> None:
    check_outputs(args, args.output)
    heights_mm = (args.highest, args.lowest, args.step)
    with refuse_errors(""):  # errors name their file themselves
        made = make_height(Choices(cell=args.cell, brush=args.brush, sheet=args.sheet), heights_mm, args.output, warn)
    files = in_files(args.output, made.text)
    warn_about_leftover_programs(args.output, files)
    write_outputs(args, files, made.stroke_count, made.time_s)
