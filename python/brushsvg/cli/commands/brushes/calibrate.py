"""brushsvg calibrate: calibrate a brush from measurements or photographs, or read the outlines of a chart."""

from __future__ import annotations

import os

from ...._core import remarks, write_brush
from ...console import print_text, refuse_errors, stage, warn
from ...steps.output_places import check_outputs, suffix_of, write_outputs


def calibrate_file(args) -> None:
    from ....jobs.calibrating import run_calibration

    check_outputs(args, args.output, args.picture, args.marks_picture, sources=[args.output])
    default_name = os.path.splitext(os.path.basename(args.output))[0]
    source = args.photos or args.input
    with refuse_errors(""):  # errors name their file themselves
        calibration = run_calibration(source, "", args.options, stage, warn, default_name)
        files = {args.output: write_brush(calibration.brush)}
        if args.picture:
            files[args.picture] = calibration.plot(suffix_of(args.picture))
        if args.marks_picture:
            files[args.marks_picture] = calibration.picture()
    warn(args.output, remarks(calibration.brush))
    write_outputs(args, files, more=calibration.reading, sources=[args.output])
    print_text(calibration.report.text(args.details, args.marks_picture or args.picture or ""))


def scan_file(args) -> None:
    from ....calibration.chart.photograph import describe_reading, write_measurements
    from ....calibration.marks.photo_report import read_picture
    from ....jobs.calibrating import read_chart_photographs

    check_outputs(args, args.output, args.marks_picture)
    with refuse_errors(""):  # errors name their file themselves
        read = read_chart_photographs([args.input], args.options, stage, warn)
    files = {args.output: write_measurements(read)}
    if args.marks_picture:
        files[args.marks_picture] = read_picture(read)
    write_outputs(args, files, more=describe_reading(read))
