"""brushsvg preview --show strokes: draw the strokes that are read from a drawing."""

from __future__ import annotations

from ....errors import Error
from ....jobs.choices import make_layout, make_read_options, report_ineffective_flags
from ....read import read_drawing
from ....read.layout import arrange
from ....strokes.extraction import strokes as strokes_of
from ...console import refuse_errors, stage, warn
from ...steps.options import make_choices
from ...steps.output_places import check_outputs, suffix_of, write_outputs


def preview_strokes(args) -> None:
    check_outputs(args, args.output)
    chosen = make_choices(args)
    warn(args.input, report_ineffective_flags(chosen))
    with refuse_errors(args.input):
        stage("reading")
        design = arrange(read_drawing(args.input, make_read_options(chosen)), make_layout(chosen))
        try:
            strokes, notices = strokes_of(design, args.paths_as, args.script or "auto")
        except Error as nothing:  # a drawing with nothing to paint can be drawn as well
            if args.editable:
                raise
            strokes, notices = [], [nothing.notice()]
        notices = [*design.notices, *notices]
        warn(args.input, notices)
        if args.editable:
            from ....show.editable_svg import lines_svg

            picture = lines_svg(strokes, design.sheet_mm, design.title).encode()
        else:
            from ....show.import_picture import overview

            picture = overview(suffix_of(args.output), design, strokes, notices)
    write_outputs(args, {args.output: picture}, len(strokes))
