"""brushsvg preview --show strokes: draw the strokes that are read from a drawing."""

from __future__ import annotations

from ....errors import Error
from ....jobs.choices import layout_of, reading_of, without_effect
from ....read import read_drawing
from ....read.layout import arrange
from ....strokes.extraction import strokes as strokes_of
from ...console import about, stage, warn
from ...steps.options import typed
from ...steps.output_places import check_places, suffix_of, write


def preview_strokes(args) -> None:
    check_places(args, args.output)
    chosen = typed(args)
    warn(args.input, without_effect(chosen))
    with about(args.input):
        stage("reading")
        design = arrange(read_drawing(args.input, reading_of(chosen)), layout_of(chosen))
        try:
            strokes, notices = strokes_of(design, args.paths_as, args.script or "auto")
        except Error as nothing:  # a drawing with nothing to paint is worth looking at, too
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
    write(args, {args.output: picture}, len(strokes))
