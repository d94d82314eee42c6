"""brushsvg preview: draw what will be painted."""

from __future__ import annotations

from ....jobs import outputs
from ...console import about, say, stage
from ...steps.options import settled, typed
from ...steps.output_places import check_places, suffix_of, write
from ...steps.prepared import look


def preview_paint(args) -> None:
    check_places(args, args.output)
    suffix = suffix_of(args.output)
    outlines = suffix != ".png" or args.band
    looked = look(settled(typed(args), args.input), outlines=outlines, whole=suffix == ".json", tilted=True)
    work, marks = looked.work, looked.marks
    with about(args.input):
        band = None
        if args.band:
            from ....show.evaluation.uncertainty import band as band_of

            stage("finding the confidence band")
            band = band_of(work.plan, work.brush, marks)
            if not any(band.rings):
                say(work.brush.name, band.words)
        picture = outputs.picture(suffix, work, marks, band, with_toolpath=args.show == "toolpath")
    write(args, {args.output: picture}, len(work.plan.passes), looked.seconds())
