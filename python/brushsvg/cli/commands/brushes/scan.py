"""brushsvg scan: a photograph of a painted chart to outlines in mm."""

from __future__ import annotations

from ....files import read_bytes
from ...console import about, stage, warn
from ...steps.output_places import check_places, write


def scan_file(args) -> None:
    from ....calibration.chart.photograph import told, write_marks
    from ....calibration.marks.photo_report import read_picture

    check_places(args, args.output, args.picture)
    read = read_photographs(args, [args.input])
    files = {args.output: write_marks(read)}
    if args.picture:
        files[args.picture] = read_picture(read)
    write(args, files, more=told(read))


def read_photographs(args, paths: list[str]):
    """What photographs of one sheet told, with warnings of strokes that are missing."""
    from ....calibration.chart.file import read_chart
    from ....calibration.chart.photograph import read_chart_photos, remarks

    with about(args.chart):
        chart = read_chart(read_bytes(args.chart))
    with about(paths[0]):
        stage("reading the photographs")
        read = read_chart_photos(
            chart, [(path, read_bytes(path)) for path in paths], args.bar, args.dpi, args.mirrored
        )
    warn(paths[0], remarks(read))
    return read
