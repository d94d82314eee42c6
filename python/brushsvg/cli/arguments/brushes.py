"""Arguments of the commands for brushes: chart, calibrate, brush."""

from __future__ import annotations

from dataclasses import fields

from ...photo import PHOTOS
from ...read import READERS
from ...units import PAPERS_MM
from . import flags, values
from .usage_checks import PICTURES, PROGRAMS, check_extension, check_files, check_job, suffix_of


def add_chart(commands) -> None:
    chart = commands.add_parser("chart", help="write a chart: the strokes to calibrate a brush with")
    flags.add_output(chart, f"a plan (.json) or {flags.PROGRAM_HELP}")
    chart.add_argument("--brush", metavar="NAME|FILE", help="the known brush most like yours; default: round-6")
    chart.add_argument("--cell", metavar="NAME|FILE", help="the machine; default: linuxcnc-3axis")
    chart.add_argument(
        "--drawing", metavar="FILE", help="take the brush and the cell from this drawing, unless you give them"
    )
    chart.add_argument(
        "--sheet",
        metavar="WxH",
        type=values.sheet,
        default=PAPERS_MM["a4"],
        help=f"the sheet: {', '.join(PAPERS_MM)}, or its size; default: a4",
    )
    chart.add_argument(
        "--strokes",
        choices=("few", "normal", "many"),
        help="how many strokes; default: as many as the sheet has room for",
    )
    chart.add_argument(
        "--dabs",
        action="store_true",
        help="dabs instead of strokes, to measure the footprints of a brush whose lag is known; name it with --brush",
    )
    chart.add_argument(
        "--paint",
        action="store_true",
        help="strokes to paint with one load, each depth early and late; calibrate --paint finds from them how marks "
        "narrow as paint runs out",
    )
    chart.add_argument(
        "--page", metavar="FILE", help="also write the page to print, with markers and labels (.pdf .svg)"
    )
    chart.add_argument(
        "--chart",
        metavar="FILE",
        help="also write where markers and strokes are, which calibrate needs to read the painted chart (.json)",
    )
    chart.add_argument(
        "--noise",
        metavar="MM",
        type=values.noise,
        help="standard deviation of a digitized edge, to predict the confidence intervals of strokes; "
        f"default: {values.EDGE_NOISE_MM:g}",
    )
    flags.add_z_offset(chart)
    flags.add_explain(chart, "drawing")
    flags.add_write_options(chart)
    chart.set_defaults(run="chart_file", parser=chart, check=_check_chart)


def _check_chart(args) -> None:
    check_job(args)
    if args.dabs and args.noise is not None:
        args.parser.error("--noise predicts the confidence intervals of strokes: a chart of dabs has none")
    if args.dabs and args.paint:
        args.parser.error("--paint is for strokes: dabs do not show how marks narrow")
    written = [(args.output, (".json", *PROGRAMS)), (args.page, (".pdf", ".svg")), (args.chart, (".json",))]
    check_files(args, [(args.brush, None), (args.drawing, tuple(READERS))], written)


def add_calibrate(commands) -> None:
    calibrate = commands.add_parser("calibrate", help="turn measurements or photographs into a brush")
    calibrate.add_argument(
        "inputs",
        metavar="IN",
        nargs="+",
        help=f"measurements (.json .csv), or photographs of one painted chart or job ({' '.join(PHOTOS)})",
    )
    flags.add_output(calibrate, "a brush (.json); with --scan, outlines in mm (.json)")
    calibrate.add_argument(
        "--scan",
        action="store_true",
        help="only read the outlines of one photograph, for a later calibrate",
    )
    _add_photo_options(calibrate)
    calibrate.add_argument(
        "--plan",
        metavar="FILE",
        help="for photographs of a painted job (convert --page): the plan.json that was painted; needs --prior",
    )
    calibrate.add_argument(
        "--prior",
        metavar="NAME|FILE",
        help="with --plan: the brush that painted it, which calibrate then updates",
    )
    calibrate.add_argument(
        "--aim",
        choices=("edges", "overlap"),
        default="edges",
        help="for painted marks: fit their edges, or continue to the largest overlap if that predicts marks left out "
        "of the fit better; overlap gives no confidence intervals; default: edges",
    )
    calibrate.add_argument(
        "--norm",
        choices=("squares", "absolute"),
        default="squares",
        help="what the fit minimizes: squared or absolute residuals; default: squares",
    )
    calibrate.add_argument(
        "--total",
        action="store_true",
        help="fit series of angles by total least squares; default: by ordinary least squares",
    )
    calibrate.add_argument(
        "--machine",
        metavar="PARTS",
        type=values.machine_parts,
        default=(),
        help="also estimate these errors of the machine from painted marks: any of lean,axes,tilt,backlash,field",
    )
    calibrate.add_argument(
        "--cell",
        metavar="NAME|FILE",
        help="the machine that painted: with --machine, estimate only errors that its cell can correct",
    )
    calibrate.add_argument(
        "--paint",
        action="store_true",
        help="also find how marks narrow as paint runs out; needs marks painted in the order of their "
        "plan with one load",
    )
    calibrate.add_argument(
        "--brush",
        metavar="NAME|FILE",
        help="for a photograph of dabs (chart --dabs): the brush whose lag is known, which gets the outlines; for one "
        "of strokes: the brush whose outlines are known, which gets the lag",
    )
    calibrate.add_argument(
        "--spread",
        metavar="FILE",
        help="for photographs: how well the studio repeats, from compare --sheets (.json)",
    )
    calibrate.add_argument(
        "--height",
        metavar="MM",
        type=values.noise,
        help="for photographs of strokes: standard deviation of the paper's height; use 0.05 after brushsvg setup "
        "height; default: 0.3, for a height set by eye",
    )
    flags.add_picture(calibrate, "the brush laws, data and residuals")
    calibrate.add_argument("--details", action="store_true", help="print all tables of the report")
    flags.add_write_options(calibrate)
    calibrate.set_defaults(run="calibrate_file", parser=calibrate, check=_check_calibrate)


def _add_photo_options(command) -> None:
    command.add_argument("--chart", metavar="FILE", help="the chart.json of the page in the photograph")
    command.add_argument(
        "--bar",
        metavar="MM",
        type=values.width,
        help="length of the printed bar, measured with a ruler, if the page was not printed at 100 %%",
    )
    command.add_argument(
        "--dpi",
        metavar="DPI",
        type=values.resolution,
        help="resolution of a flatbed scan of a sheet without printed markers, whose strokes show how it is placed",
    )
    command.add_argument(
        "--mirrored",
        action="store_true",
        help="the photograph was taken from below, through glass and a clear sheet on which the page is printed",
    )
    command.add_argument(
        "--marks-picture",
        metavar="FILE",
        help="also draw the outlines found over the flattened photograph (.png)",
    )


def _check_calibrate(args) -> None:
    from ...jobs.calibration_options import find_contradiction

    args.input = args.inputs[0]
    args.options = _make_options(args)
    if args.scan:
        return _check_scan(args)
    args.photos = [path for path in args.inputs if suffix_of(path) in PHOTOS]
    _refuse_heic(args, args.inputs)
    if why := find_contradiction(args.inputs if len(args.inputs) > 1 else args.input, args.options):
        args.parser.error(why)
    for flag, value in (("--marks-picture", args.marks_picture), ("--picture", args.picture)):
        if value and args.plan:
            args.parser.error(f"{flag} is not for a job (--plan)")
    if args.marks_picture and not args.photos:
        args.parser.error(f"--marks-picture is for photographs ({' '.join(PHOTOS)})")
    read = [(path, PHOTOS if args.photos else (".json", ".csv")) for path in args.inputs]
    read += [(args.chart, (".json",)), (args.plan, (".json",)), (args.prior, None), (args.spread, (".json",))]
    written = [(args.output, (".json",)), (args.picture, PICTURES), (args.marks_picture, (".png",))]
    check_files(args, read, written)


def _make_options(args):
    from ...jobs.calibration_options import CalibrationOptions

    return CalibrationOptions(
        absolute=args.norm == "absolute",
        total=args.total,
        machine=args.machine,
        cell=args.cell,
        paint=args.paint,
        aim=args.aim,
        chart=args.chart,
        bar_mm=args.bar,
        dpi=args.dpi,
        mirrored=args.mirrored,
        height_mm=args.height,
        spread=args.spread,
        brush=args.brush,
        plan=args.plan,
        prior=args.prior,
    )


SCAN_OPTIONS = ("chart", "bar_mm", "dpi", "mirrored")  # options for reading a photograph


def _check_scan(args) -> None:
    from ...jobs.calibration_options import CalibrationOptions, find_contradiction

    args.run = "scan_file"
    if len(args.inputs) > 1:
        args.parser.error("--scan reads one photograph; without --scan, calibrate reads several of one sheet")
    _refuse_heic(args, args.inputs)
    given = [
        each.name
        for each in fields(CalibrationOptions)
        if each.name not in SCAN_OPTIONS and getattr(args.options, each.name) != each.default
    ]
    if given or args.picture:
        flag = "--norm" if given == ["absolute"] else f"--{(given or ['picture'])[0].removesuffix('_mm')}"
        args.parser.error(f"{flag} is for a fit: leave it or --scan out")
    if args.chart is None:
        args.parser.error("--scan needs --chart, the chart.json of the page in the photograph")
    read = [(args.input, PHOTOS), (args.chart, (".json",))]
    check_files(args, read, [(args.output, (".json",)), (args.marks_picture, (".png",))])
    if why := find_contradiction(args.input, args.options):
        args.parser.error(why)


def _refuse_heic(args, photos: list[str]) -> None:
    if any(suffix_of(path) in (".heic", ".heif") for path in photos):
        args.parser.error(
            "HEIC pictures are not read: export them as JPEG (iPhone: Settings, Camera, Formats, Most Compatible)"
        )


def add_brush(commands) -> None:
    subcommands = flags.add_list_show_check(
        commands, "brush", "list, show, check, draw and create brushes", "laws and ranges", "brush.json"
    )
    new = subcommands.add_parser(
        "new", help="write a brush file from a few numbers; brushsvg asks for them if you give none"
    )
    flags.add_output(new, "the brush file (.json); its name becomes the brush's name")
    new.add_argument(
        "--lag",
        metavar="MM",
        type=values.lag,
        help="how far the brush trails the tool, at every depth; 0 for a pen",
    )
    new.add_argument(
        "--lag-at",
        metavar="DEPTH=MM",
        action="append",
        type=values.lag_at,
        default=[],
        help="the lag at a press depth, if the lag grows with depth; give it once per measured depth",
    )
    new.add_argument(
        "--width-at",
        metavar="DEPTH=WIDTH",
        action="append",
        type=values.width_at,
        default=[],
        help="width painted at a press depth, in mm; give it once per measured depth",
    )
    new.add_argument("--widths", metavar="FILE", help="the widths as a table, depth_mm,width_mm (.csv)")
    new.add_argument(
        "--depth-max",
        metavar="MM",
        type=values.width,
        help="the largest press depth; default: the depth of the deepest width",
    )
    new.add_argument(
        "--like",
        metavar="BRUSH",
        help="copy all laws from this brush, a name or a brush.json, and mark them as assumed",
    )
    new.add_argument(
        "--speed",
        metavar="MM/S",
        type=values.paint_speed,
        help="the largest painting speed; default: 25, or the speed of --like",
    )
    flags.add_write_options(new)
    new.set_defaults(run="brush_new", parser=new, check=_check_brush_new)
    plot = subcommands.add_parser("plot", help="draw the brush laws with confidence bands, and the footprints")
    plot.add_argument("input", metavar="NAME", help="a shipped brush, or a brush.json")
    flags.add_output(plot, "a picture (.svg .png)")
    flags.add_write_options(plot)
    plot.set_defaults(run="brush_plot", parser=plot, check=_check_brush_plot)


def _check_brush_new(args) -> None:
    check_extension(args, args.output, (".json",))
    if args.like is not None:
        given = [("--lag", args.lag), ("--lag-at", args.lag_at or None), ("--widths", args.widths)]
        given += [("--width-at", args.width_at or None), ("--depth-max", args.depth_max)]
        for flag, value in given:
            if value is not None:
                args.parser.error(f"argument {flag}: --like takes it from the other brush")
        return
    is_empty = args.lag is None and not (args.lag_at or args.width_at or args.widths)
    if is_empty:
        from ..steps.ask_measurements import HOW_TO_MEASURE, MEASUREMENT_FLAGS, can_answer

        if not can_answer(args):
            args.parser.error(
                f"nothing was measured. {' '.join(HOW_TO_MEASURE)} Give {MEASUREMENT_FLAGS}; or --like BRUSH"
            )
        return
    if args.lag is None and not args.lag_at:
        args.parser.error("the following arguments are required: --lag or --lag-at, or --like BRUSH")
    if args.lag is not None and args.lag_at:
        args.parser.error("argument --lag: not allowed with --lag-at: --lag is the lag at every depth")
    if not (args.width_at or args.widths):
        args.parser.error("give at least one width, as --width-at 4=5 or in a table, --widths FILE")


def _check_brush_plot(args) -> None:
    check_files(args, [(args.input, None)], [(args.output, PICTURES)])
