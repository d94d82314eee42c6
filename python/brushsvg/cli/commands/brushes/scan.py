"""brushsvg calibrate --scan: read the outlines of a photographed chart, in mm."""

from __future__ import annotations

from ...console import refuse_errors, stage, warn
from ...steps.output_places import check_outputs, write_outputs


def scan_file(args) -> None:
    from ....calibration.chart.photograph import describe_reading, write_marks
    from ....calibration.marks.photo_report import read_picture
    from ....jobs.calibrating import read_chart_photographs

    check_outputs(args, args.output, args.marks_picture)
    with refuse_errors(""):  # errors name their file themselves
        read = read_chart_photographs([args.input], args.options, stage, warn)
    files = {args.output: write_marks(read)}
    if args.marks_picture:
        files[args.marks_picture] = read_picture(read)
    write_outputs(args, files, more=describe_reading(read))
