"""brushsvg calibrate --scan: read the outlines of a photographed chart, in mm."""

from __future__ import annotations

from ...console import about, stage, warn
from ...steps.output_places import check_places, write


def scan_file(args) -> None:
    from ....calibration.chart.photograph import describe_reading, write_marks
    from ....calibration.marks.photo_report import read_picture
    from ....jobs.calibrating import read_photographs

    check_places(args, args.output, args.marks_picture)
    with about(""):  # errors name their file
        read = read_photographs([args.input], args.options, stage, warn)
    files = {args.output: write_marks(read)}
    if args.marks_picture:
        files[args.marks_picture] = read_picture(read)
    write(args, files, more=describe_reading(read))
