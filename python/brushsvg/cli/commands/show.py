"""brushsvg predict, animate and import: what will be painted, and what was understood."""

from __future__ import annotations

from ...drawing import read_drawing
from ...drawing.layout import arrange
from ...errors import Error
from ...pipeline import outputs
from ...strokes.extraction import strokes as strokes_of
from ..console import about, say, stage, warn
from .options import layout_of, reading_of, settled, typed
from .outputs import check_places, suffix_of, write
from .prepare import look, seconds_of


def predict_file(args) -> None:
    check_places(args.output)
    suffix = suffix_of(args.output)
    outlines = suffix != ".png" or args.band
    looked = look(settled(typed(args), args.input), outlines=outlines, whole=suffix == ".json")
    work, marks = looked.work, looked.marks
    with about(args.input):
        band = None
        if args.band:
            from ...evaluation.uncertainty import band as band_of

            stage("finding the confidence band")
            band = band_of(work.plan, work.brush, marks)
            if not any(band.rings):
                say(work.brush.name, band.words)
        picture = outputs.picture(suffix, work, marks, band)
    seconds = seconds_of(looked.loads, work.brush, work.options.cell)
    write(args, {args.output: picture}, len(work.plan.passes), seconds)


def animate_file(args) -> None:
    check_places(args.output)
    looked = look(settled(typed(args), args.input), outlines=True, at_loads=True)
    work, loads, cell = looked.work, looked.loads, looked.work.options.cell
    with about(args.input):
        page = outputs.played(work, loads, looked.marks, cell, args.speed)
    write(args, {args.output: page}, len(loads.loads), seconds_of(loads, work.brush, cell))


def import_file(args) -> None:
    check_places(args.output)
    chosen = typed(args)
    with about(args.input):
        stage("reading")
        design = arrange(read_drawing(args.input, reading_of(chosen)), layout_of(chosen))
        try:
            strokes, notices = strokes_of(design, args.paths_as)
        except Error as nothing:  # a drawing with nothing to paint is worth looking at, too
            if args.editable:
                raise
            strokes, notices = [], [nothing.notice()]
        notices = [*design.notices, *notices]
        warn(args.input, notices)
        if args.editable:
            from ...pictures.editable_svg import lines_svg

            picture = lines_svg(strokes, design.sheet_mm, design.title).encode()
        else:
            from ...pictures.overview import overview

            picture = overview(suffix_of(args.output), design, strokes, notices)
    write(args, {args.output: picture}, len(strokes))
