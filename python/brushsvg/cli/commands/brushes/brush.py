"""brushsvg brush: list, show, check, new, plot."""

from __future__ import annotations

import os

from ...._core import remarks, write_brush
from ....errors import Error
from ....files import read_bytes
from ....model.describe import LAWS, describe_brush, describe_ranges, one_line
from ....model.library import brush_like, brush_names, find_brush
from ....model.unknown_keys import unknown_keys
from ...console import print_text, refuse_errors, warn
from ...steps.ask_measurements import ask_measurements, warn_of_few_depths
from ...steps.output_places import check_outputs, print_list, suffix_of, write_outputs


def brush_list(_args) -> None:
    print_list(brush_names(), lambda name: one_line(find_brush(name)))


def brush_show(args) -> None:
    with refuse_errors(args.input):
        print_text(describe_brush(find_brush(args.input)) + "\n")


def brush_check(args) -> None:
    with refuse_errors(args.input):
        brush = find_brush(args.input)
        notices = [*unknown_keys(brush), *remarks(brush)]
    warn(args.input, notices)
    print_text(f"{args.input}: brush {brush.name} can be used\n")


def brush_new(args) -> None:
    from ....calibration.numbers.from_widths import new_brush
    from ....calibration.numbers.measurements import read_widths

    path = args.output
    name = os.path.splitext(os.path.basename(path))[0]
    check_outputs(args, path, sources=[path])
    if args.like is None and args.lag is None and not (args.lag_at or args.width_at or args.widths):
        args.lag_at, args.width_at = ask_measurements(path)
    widths = list(args.width_at)
    if args.widths:
        with refuse_errors(args.widths):
            widths += read_widths(read_bytes(args.widths).decode("utf-8", "replace"))
    with refuse_errors(path):
        if name in brush_names():
            raise Error(f"a shipped brush has the name {name}: give yours another name", "name", code="name-taken")
        if args.like is not None:
            brush = brush_like(name, find_brush(args.like))
            brush.max_speed_mm_s = args.speed or brush.max_speed_mm_s
        else:
            brush = new_brush(name, args.lag_at or args.lag, widths, args.depth_max, args.speed or 25.0)
        text = write_brush(brush)
    warn(path, warn_of_few_depths(args, widths))
    write_outputs(args, {path: text}, sources=[path])
    print_text(f"{path}: {describe_ranges(brush)}\n")
    if args.like is not None:
        print_text(f"assumed: all laws, copied from {args.like}; see brushsvg brush show {path}\n")
        return
    assumed = [law for law, _ in LAWS if getattr(brush, law).assumed]
    deepest_mm, measured = brush.depth_range_mm[1], max(depth for depth, _ in widths)
    if deepest_mm > measured and "half_width" not in assumed:
        assumed.append(
            f"widths beyond {measured:g} mm of depth ({2 * brush.half_width(deepest_mm):.1f} mm at {deepest_mm:g} mm)"
        )
    lag_measured_mm = max((depth for depth, _ in args.lag_at), default=deepest_mm)
    if deepest_mm > lag_measured_mm and "lag" not in assumed:
        assumed.append(
            f"lags beyond {lag_measured_mm:g} mm of depth ({brush.lag(deepest_mm):.1f} mm at {deepest_mm:g} mm)"
        )
    print_text(f"assumed: {', '.join(assumed)} and the footprints; see brushsvg brush show {path}\n")


def brush_plot(args) -> None:
    from ....model.plot import brush_picture

    check_outputs(args, args.output)
    with refuse_errors(args.input):
        picture = brush_picture(find_brush(args.input), suffix_of(args.output))
    write_outputs(args, {args.output: picture})
