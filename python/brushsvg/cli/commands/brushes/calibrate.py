"""brushsvg calibrate: measurements or photographs to a brush."""

from __future__ import annotations

import os

from ...._core import remarks, write_brush
from ...console import about, print_text, stage, warn
from ...steps.output_places import check_places, suffix_of, write


def calibrate_file(args) -> None:
    from ....jobs.calibrating import calibrated

    check_places(args, args.output, args.picture, args.marks_picture, sources=[args.output])
    name = os.path.splitext(os.path.basename(args.output))[0]
    source = args.photos or args.input
    with about(""):  # errors name their file
        made = calibrated(source, name, args.options, stage, warn)
        files = {args.output: write_brush(made.brush)}
        if args.picture:
            files[args.picture] = made.plot(suffix_of(args.picture))
        if args.marks_picture:
            files[args.marks_picture] = made.picture()
    warn(args.output, remarks(made.brush))
    write(args, files, more=made.reading, sources=[args.output])
    print_text(made.report.text(args.details, args.marks_picture or args.picture or ""))
