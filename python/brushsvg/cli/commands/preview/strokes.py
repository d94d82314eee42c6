"""brushsvg preview --show strokes: draw the strokes that are read from a drawing."""

from __future__ import annotations

from ....errors import Error, Notice
from ....jobs.choices.ineffective_flags import PLANNING_FLAGS, report_flags_without_effect, report_ineffective_flags
from ....jobs.options import DEFAULT_BRUSH, make_layout, make_read_options
from ....jobs.preparation.preparation import limit_depth
from ....model.library import find_brush
from ....read import read_drawing, settings_in
from ....read.layout import arrange
from ....strokes.extraction import strokes as strokes_of
from ....strokes.wide_shapes import find_wide_lines
from ...console import refuse_errors, stage, warn
from ...steps.options import apply_drawing_settings, make_choices, make_options
from ...steps.output_places import check_outputs, suffix_of, write_outputs

# Flags that change strokes after they are read.
LATER_FLAGS = ("colour", "speed", *(flag for flag in PLANNING_FLAGS if flag != "script"))


def preview_strokes(args) -> None:
    check_outputs(args, args.output)
    chosen = make_choices(args)
    later_flags = report_flags_without_effect(chosen, LATER_FLAGS, "the strokes as they are read")
    warn(args.input, [*report_ineffective_flags(chosen), *later_flags])
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
        if args.editable:
            options = make_options(apply_drawing_settings(chosen, args.input))
            brush = options.brush or find_brush(DEFAULT_BRUSH)
            notices += _report_wide_strokes(strokes, limit_depth(brush, options))
        warn(args.input, notices)
        if args.editable:
            from ....show.editable_svg import lines_svg

            picture = lines_svg(strokes, design.sheet_mm, design.title, settings_in(args.input)).encode()
        else:
            from ....show.import_picture import draw_import_picture

            picture = draw_import_picture(suffix_of(args.output), design, strokes, notices)
    write_outputs(args, {args.output: picture}, len(strokes))


def _report_wide_strokes(strokes, brush) -> list[Notice]:
    """Report strokes that become lines wider than the brush: it fills wide shapes, but convert refuses such lines."""
    least, greatest = brush.half_width_range_mm()
    return [
        Notice(
            stroke.id,
            f"its line is {2 * half:.3g} mm wide, outside the range [{2 * least:.3g}, {2 * greatest:.3g}] mm of "
            f"brush {brush.name}, and convert will refuse it: draw narrower lines instead",
            code="width-out-of-reach",
            excess=2 * (half - greatest),
        )
        for stroke, half in find_wide_lines(strokes, brush)
    ]
