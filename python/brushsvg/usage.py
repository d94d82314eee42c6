"""What was typed, parsed and checked. Nothing heavy is imported: a typing error is told at once."""

from __future__ import annotations

import argparse
import os

from .console import say, tell
from .errors import Error
from .importers import READERS
from .posts import POSTS

DRAWINGS = (*READERS, ".json")
PROGRAMS = (".json", *dict.fromkeys(extension for post in POSTS.values() for extension in post.extensions))
PREDICTIONS = (".png", ".svg", ".json")
PREVIEWS = (".png", ".svg")
REPORTS = (".txt", ".json")
_SHEETS_MM = {"a3": (297.0, 420.0), "a4": (210.0, 297.0), "a5": (148.0, 210.0), "letter": (215.9, 279.4)}


def parse(argv: list[str] | None = None) -> argparse.Namespace:
    """The choices; `run` names a function of `commands`. SystemExit on --help, --version and wrong usage."""
    args = _parser().parse_args(argv)
    _check_operands(args)
    return args


class _Parser(argparse.ArgumentParser):
    def __init__(self, **settings):
        # A prefix of a flag is no flag: it would change its meaning as flags are added.
        super().__init__(allow_abbrev=False, **settings)

    def print_help(self, file=None) -> None:
        tell(self.format_help())

    def error(self, message: str):
        say(f"{message} (see {self.prog} --help)")
        raise SystemExit(2)


class _Version(argparse.Action):
    def __call__(self, parser, *_):
        from . import __version__

        tell(f"brushsvg {__version__}\n")
        parser.exit()


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="brushsvg", description="Vector lettering to brush strokes that a robot can paint.")
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    convert = commands.add_parser("convert", help="make a plan or robot program of a drawing or plan")
    _add_input(convert)
    convert.add_argument("output", metavar="OUT", help=_programs())
    _add_choices(convert)
    _add_job(convert)
    convert.add_argument("--preview", metavar="FILE", help="also write what will be painted (.png .svg)")
    convert.add_argument("--report", metavar="FILE", help="also write the figures (.txt .json)")
    convert.set_defaults(run="convert_file", parser=convert)

    border = commands.add_parser("border", help="make an air run round what will be painted, at safe height")
    _add_input(border)
    border.add_argument("output", metavar="OUT", help=_programs(plan=False))
    _add_choices(border)
    _add_z_offset(border)
    border.set_defaults(run="border_file", parser=border)

    height = commands.add_parser("height", help="make strokes that tell how high the paper lies")
    height.add_argument("output", metavar="OUT", help=_programs(plan=False))
    height.add_argument("--brush", metavar="NAME|FILE", help="default: round-6")
    height.add_argument("--cell", metavar="NAME|FILE", help="the machine; default: linuxcnc-3axis")
    height.add_argument("--sheet", metavar="WxH", type=_size, default=(200.0, 100.0), help="default: 200x100")
    height.add_argument("--from", metavar="MM", dest="highest", type=_height, default=1.0, help="default: 1")
    height.add_argument("--to", metavar="MM", dest="lowest", type=_height, default=-1.0, help="default: -1")
    height.add_argument("--step", metavar="MM", type=_step, default=0.1, help="default: 0.1")
    height.set_defaults(run="height_file", parser=height)

    predict = commands.add_parser("predict", help="show what the brush will paint")
    _add_input(predict)
    predict.add_argument("output", metavar="OUT", help="a picture (.png .svg) or marks (.json)")
    _add_choices(predict)
    predict.add_argument(
        "--band",
        action="store_true",
        help="also where the edges lie with 95 %%, as far as the brush is known",
    )
    predict.set_defaults(run="predict_file", parser=predict)

    animate = commands.add_parser("animate", help="make a page that plays tool and paint over time")
    _add_input(animate)
    animate.add_argument("output", metavar="OUT", help="a page for any browser, without network (.html)")
    _add_choices(animate)
    animate.add_argument(
        "--speed",
        metavar="FACTOR",
        type=_speed,
        default=1.0,
        help="how much faster than the robot; default: 1",
    )
    animate.set_defaults(run="animate_file", parser=animate)

    look = commands.add_parser("import", help="show what was understood of a drawing")
    look.add_argument("input", metavar="IN", help=f"a drawing ({' '.join(READERS)})")
    look.add_argument("output", metavar="OUT", help="a picture (.svg .png)")
    _add_layout(look)
    look.add_argument(
        "--editable",
        action="store_true",
        help="the strokes as lines with a width, to go on drawing with (.svg)",
    )
    look.set_defaults(run="import_file", parser=look, brush=None, lag=None)

    text = commands.add_parser("text", help="set a text in a font, as a drawing")
    text.add_argument("input", metavar="TEXT", help="what to write; \\n starts a line")
    text.add_argument("output", metavar="OUT", help="a drawing (.svg)")
    text.add_argument(
        "--font", metavar="FILE", required=True, help="an SVG font of single lines, or TrueType, OpenType"
    )
    text.add_argument("--size", metavar="MM", type=_width, default=20.0, help="of the em; default: 20")
    text.add_argument("--width", metavar="MM", type=_width, help="of the lines of an SVG font; default: 1")
    text.add_argument(
        "--sheet", metavar="WxH", type=_size, help="the sheet; default: the text and 20 mm around it"
    )
    text.set_defaults(run="text_file", parser=text)

    check = commands.add_parser(
        "check", help="read a program back, simulate it and hold it against a drawing"
    )
    check.add_argument("program", metavar="PROGRAM", help=_programs(plan=False))
    check.add_argument(
        "input", metavar="IN", nargs="?", help="the drawing, or plan (.json), that it should paint"
    )
    check.add_argument("--brush", metavar="NAME|FILE", help="default: the one that the program names")
    check.add_argument("--cell", metavar="NAME|FILE", help="default: the one that the program names")
    _add_layout(check)
    _add_wide(check)
    check.add_argument(
        "--z-offset", metavar="MM", type=_height, help="default: the one that the program names"
    )
    check.add_argument("--lenient", action="store_true", help="take what is sound of damaged geometry")
    check.add_argument("--preview", metavar="FILE", help="also write what will be painted (.png .svg)")
    check.add_argument("--json", action="store_true", help="figures as JSON")
    check.set_defaults(run="check_file", parser=check, lag=None, compensation=None, tolerance=None)

    report = commands.add_parser("report", help="say in figures how near the paint comes to the drawing")
    _add_input(report)
    _add_choices(report, several_brushes=True)
    report.add_argument("--all-brushes", action="store_true", help="one line for each brush, the best first")
    report.add_argument(
        "--preview", metavar="FILE", help="also draw where paint is missing or too much (.png .svg)"
    )
    report.add_argument("--json", action="store_true", help="as JSON")
    report.set_defaults(run="report_file", parser=report)

    chart = commands.add_parser("chart", help="make the strokes that a brush is calibrated from")
    chart.add_argument("output", metavar="OUT", help=_programs())
    chart.add_argument("--brush", metavar="NAME|FILE", help="the nearest that is known; default: round-6")
    chart.add_argument("--cell", metavar="NAME|FILE", help="the machine; default: linuxcnc-3axis")
    chart.add_argument(
        "--sheet",
        metavar="WxH",
        type=_sheet,
        default=_SHEETS_MM["a4"],
        help=f"or {', '.join(_SHEETS_MM)}; default: a4",
    )
    chart.add_argument(
        "--strokes", choices=("few", "normal", "many"), help="default: as many as the sheet has room for"
    )
    chart.add_argument(
        "--page", metavar="FILE", help="also write the page to print, markers and labels (.svg)"
    )
    chart.add_argument("--chart", metavar="FILE", help="also write what the painted chart is read by (.json)")
    _add_z_offset(chart)
    chart.set_defaults(run="chart_file", parser=chart)

    fit = commands.add_parser("calibrate", help="make a brush of what was measured")
    fit.add_argument("input", metavar="MEASUREMENTS", help="what was measured (.json .csv)")
    fit.add_argument("-o", metavar="FILE", dest="output", required=True, help="a brush (.json)")
    fit.add_argument(
        "--norm", choices=("squares", "absolute"), default="squares", help="what is least; default: squares"
    )
    fit.add_argument(
        "--total", action="store_true", help="total least squares for series of angles; else plain ones"
    )
    fit.add_argument("--plot", metavar="FILE", help="also draw laws, data and residuals (.png .svg)")
    fit.set_defaults(run="calibrate_file", parser=fit)

    install = commands.add_parser("install-plugin", help="put our extension where a drawing program looks")
    install.add_argument("plugin", metavar="inkscape", choices=("inkscape",), help="which one")
    install.add_argument(
        "zip", metavar="ZIP", nargs="?", help="brushsvg-inkscape.zip; not needed in a source tree"
    )
    install.set_defaults(run="install_plugin", parser=install)

    for kind, about, told, file in (
        ("brush", "look at brushes", "laws and ranges", "brush.json"),
        ("cell", "look at cells: machines and their limits", "heights, speeds and limits", "cell.toml"),
    ):
        whats = commands.add_parser(kind, help=about).add_subparsers(metavar="WHAT", required=True)
        whats.add_parser("list", help="name those that come along").set_defaults(run=f"{kind}_list")
        show = whats.add_parser("show", help=f"{told} of one")
        show.add_argument("input", metavar="NAME", help=f"a {kind} that comes along, or a {file}")
        show.set_defaults(run=f"{kind}_show")
        check = whats.add_parser("check", help=f"say whether a {kind} file can be used")
        check.add_argument("input", metavar="FILE", help=f"a {file}")
        check.set_defaults(run=f"{kind}_check")
        (_add_cell_new if kind == "cell" else _add_brush_new)(whats)
    return parser


def _add_brush_new(whats) -> None:
    new = whats.add_parser("new", help="write a brush file from a few numbers")
    new.add_argument("name", metavar="NAME", help="of the brush; writes NAME.json, or the path given")
    new.add_argument(
        "--lag", metavar="MM", type=_lag, required=True, help="how far it trails the tool; 0 for a pen"
    )
    new.add_argument(
        "--width-at",
        metavar="DEPTH=WIDTH",
        action="append",
        type=_width_at,
        default=[],
        help="how wide it paints when pressed so deep, in mm; as often as measured",
    )
    new.add_argument("--widths", metavar="FILE", help="the same as a table, depth_mm,width_mm (.csv)")
    new.add_argument("--depth-max", metavar="MM", type=_width, help="default: that of the deepest width")
    new.add_argument("--speed", metavar="MM/S", type=_speed, default=25.0, help="at most; default: 25")
    new.set_defaults(run="brush_new", parser=new)
    plot = whats.add_parser("plot", help="draw the laws, how sure they are, and the footprints")
    plot.add_argument("input", metavar="NAME", help="a brush that comes along, or a brush.json")
    plot.add_argument("output", metavar="OUT", help="a picture (.svg .png)")
    plot.set_defaults(run="brush_plot", parser=plot)


def _add_cell_new(whats) -> None:
    new = whats.add_parser("new", help="write a cell file of your own, to be edited")
    new.add_argument("output", metavar="FILE", help="a cell.toml")
    new.add_argument("--like", metavar="NAME|FILE", help="the cell to start from; default: linuxcnc-3axis")
    new.add_argument(
        "--taught",
        metavar="X,Y,Z",
        action="append",
        type=_point3,
        help="three or four times: the tip at the sheet's lower left corner, along its lower edge, along its "
        "left edge, and anywhere else on it, each just touching, in the robot's frame",
    )
    new.set_defaults(run="cell_new", parser=new)


def _programs(plan: bool = True) -> str:
    titles: dict[str, str] = {}
    for post in POSTS.values():  # the shortest title of those that share an extension
        name = " ".join(post.extensions)
        titles[name] = min(titles.get(name, post.title), post.title, key=len)
    return " or ".join(
        [*(["a plan (.json)"] if plan else []), *(f"{t} ({name})" for name, t in titles.items())]
    )


def _add_job(command: argparse.ArgumentParser) -> None:
    add = command.add_argument
    _add_z_offset(command)
    add("--from-stroke", metavar="N", type=_count, default=1, help="go on from this stroke of a program")
    add(
        "--order", choices=("drawn", "nearest"), default="drawn", help="of strokes in a layer; default: drawn"
    )


def _add_z_offset(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--z-offset",
        metavar="MM",
        type=_height,
        default=0.0,
        help="the paper lies so much higher than thought",
    )


def _add_input(command: argparse.ArgumentParser) -> None:
    command.add_argument("input", metavar="IN", help=f"a drawing ({' '.join(READERS)}) or plan (.json)")


def _add_choices(command: argparse.ArgumentParser, several_brushes: bool = False) -> None:
    add = command.add_argument
    default = "default: round-6; for a plan, the brush it names"
    if several_brushes:
        add("--brush", metavar="NAME|FILE", action="append", help=f"{default}; with --all-brushes any number")
    else:
        add("--brush", metavar="NAME|FILE", help=default)
    add("--cell", metavar="NAME|FILE", help="the machine; default: linuxcnc-3axis")
    _add_layout(command)
    _add_wide(command)
    add("--compensation", choices=("none", "constant", "closed", "refined"), help="default: closed")
    add("--lag", metavar="MM", type=_lag, help="for constant; default: that at the stroke's median depth")
    add("--tolerance", metavar="MM", type=_tolerance, help="of the painted middle line; default: 0.05")
    add("--lenient", action="store_true", help="take what is sound of damaged geometry")


def _add_wide(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--wide",
        choices=("clamp", "passes", "refuse"),
        help="filled outlines wider than the brush: its greatest width, several passes, or no; default: clamp",
    )


def _add_layout(command: argparse.ArgumentParser) -> None:
    add = command.add_argument
    add("--sheet", metavar="WxH", type=_size, help="the sheet in mm or with units; default: the drawing's")
    add("--units", choices=("mm", "in"), help="of a drawing that does not say them (DXF)")
    add(
        "--layer",
        metavar="NAME",
        action="append",
        type=_words,
        help="paint this layer; several: more than once",
    )
    add(
        "--select",
        metavar="CSS",
        type=_words,
        help="paint what this selector names and what lies in it (SVG)",
    )
    add("--width", metavar="MM", type=_width, help="of all strokes, whatever the drawing says")
    add(
        "--as",
        dest="paths_as",
        choices=("stroke", "outline"),
        help="paths are lines, fills count as none; or outlines of shapes, strokes count as none; default: as drawn",
    )
    size = command.add_mutually_exclusive_group()
    size.add_argument(
        "--fit", metavar="WxH", type=_size, help="scale the marks to this size, centred on the sheet"
    )
    size.add_argument("--scale", metavar="FACTOR", type=_scale, help="scale the drawing, widths too")
    add("--origin", metavar="X,Y", type=_point, help="where the lower left corner of the marks lies")


def _size(text: str) -> tuple[float, float]:
    from .units import size_mm

    return _read(size_mm, text)


def _sheet(text: str) -> tuple[float, float]:
    return _SHEETS_MM.get(text.lower()) or _size(text)


def _lag(text: str) -> float:
    return _length(text, 0.0, 1000.0)


def _tolerance(text: str) -> float:
    return _length(text, 1e-5, 10.0)  # a program is written to 1e-4 mm: less would only cost poses


def _words(text: str) -> str:
    if not text.strip():
        raise argparse.ArgumentTypeError("it is empty")
    return text


def _height(text: str) -> float:
    return _length(text, -20.0, 20.0)


def _step(text: str) -> float:
    return _length(text, 0.01, 5.0)


def _count(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text[:9]) < 10**8):
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a number from 1 on")
    return int(text)


def _width_at(text: str) -> tuple[float, float]:
    depth, equals, width = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(
            f"{text[:24]!r} is not a depth and its width; write for example 3=2.5"
        )
    return _width(depth), _width(width)


def _width(text: str) -> float:
    return _length(text, 0.001, 1000.0)


def _scale(text: str) -> float:
    from .units import number

    try:
        value = number(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except Error:
        raise argparse.ArgumentTypeError(
            f"{text[:24]!r} is not a factor; write for example 1.5 or 150%"
        ) from None
    if not 1e-4 <= value <= 1e4:
        raise argparse.ArgumentTypeError(f"{value:g} is outside the range [0.0001, 10000]")
    return value


def _speed(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a factor; write for example 5") from None
    if not 0.1 <= value <= 1000:
        raise argparse.ArgumentTypeError(f"{value:g} is outside the range [0.1, 1000]")
    return value


def _point(text: str) -> tuple[float, float]:
    from .units import length_mm

    parts = text.split(",")
    if len(parts) != 2:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a point; write for example 20,15 or 2cm,1in")
    x, y = (_read(length_mm, part) for part in parts)
    if not max(abs(x), abs(y)) <= 1e6:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} lies beyond 1e6 mm")
    return x, y


def _point3(text: str) -> tuple[float, float, float]:
    from .units import length_mm

    parts = text.split(",")
    if len(parts) != 3:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} is not a point; write for example 120.5,-300,42")
    x, y, z = (_read(length_mm, part) for part in parts)
    if not max(abs(x), abs(y), abs(z)) <= 1e5:
        raise argparse.ArgumentTypeError(f"{text[:24]!r} lies beyond 1e5 mm")
    return x, y, z


def _length(text: str, least: float, greatest: float) -> float:
    from .units import length_mm

    value = _read(length_mm, text)
    if not least <= value <= greatest:
        raise argparse.ArgumentTypeError(f"{value:g} mm is outside the range [{least:g}, {greatest:g}] mm")
    return value


def _read(reader, text: str):
    try:
        return reader(text)
    except Error as problem:
        raise argparse.ArgumentTypeError(str(problem)) from None


def _check_operands(args) -> None:
    """Wrong usage that argparse does not see: extensions, files named twice, flags that need another."""
    if args.run == "cell_new" and os.path.splitext(args.output)[1].lower() != ".toml":
        args.parser.error(f"{args.output} does not end in .toml")
    if args.run == "cell_new" and len(args.taught or ()) not in (0, 3, 4):
        args.parser.error(f"--taught is given {len(args.taught)} times, not three or four")
    if args.run == "brush_new" and not (args.width_at or args.widths):
        args.parser.error("give at least one width, as --width-at 4=5 or in a table, --widths FILE")
    if args.run == "calibrate_file":
        _check_extension(args, args.input, (".json", ".csv"))
        _check_extension(args, args.output, (".json",))
        if args.plot:
            _check_extension(args, args.plot, PREVIEWS)
        if len({os.path.realpath(path) for path in (args.input, args.output, args.plot or "/")}) < 3:
            args.parser.error("two of the files are the same")
        return
    if args.run == "brush_plot":
        _check_extension(args, args.output, PREVIEWS)
    if args.run == "chart_file":
        _check_extension(args, args.output, PROGRAMS)
        for path, suffix in ((args.page, ".svg"), (args.chart, ".json")):
            if path:
                _check_extension(args, path, (suffix,))
        named = [os.path.realpath(path) for path in (args.output, args.page, args.chart) if path]
        if len(set(named)) < len(named):
            args.parser.error("two of the files are the same")
        return
    if args.run.startswith(("brush_", "cell_", "install_")):
        return
    if args.run == "height_file":
        _check_extension(args, args.output, PROGRAMS[1:])
        return
    if args.run == "check_file":
        _check_extension(args, args.program, PROGRAMS[1:])
        if args.input is None:
            if args.preview:
                _check_extension(args, args.preview, PREVIEWS)
            return
    if args.run == "text_file":
        if os.path.splitext(args.output)[1].lower() != ".svg":
            args.parser.error(f"{args.output} does not end in .svg")
        if os.path.realpath(args.output) == os.path.realpath(args.font):
            args.parser.error(f"{args.output} cannot be two files at once")
        return
    drawing = os.path.splitext(args.input)[1].lower()
    if args.units and drawing in (".svg", ".svgz"):
        args.parser.error("--units is for drawings that do not say them; an SVG does")
    if args.select and drawing == ".dxf":
        args.parser.error("--select is for SVG; choose layers of a DXF with --layer")
    if getattr(args, "editable", False) and os.path.splitext(args.output)[1].lower() != ".svg":
        args.parser.error("--editable writes an SVG")
    if args.lag is not None and args.compensation != "constant":
        args.parser.error("--lag needs --compensation constant")
    if args.run == "predict_file" and args.band and os.path.splitext(args.output)[1].lower() == ".json":
        args.parser.error("--band is for pictures (.svg .png)")
    outputs = {
        "convert_file": lambda: [(args.output, PROGRAMS), (args.preview, PREVIEWS), (args.report, REPORTS)],
        "border_file": lambda: [(args.output, PROGRAMS[1:])],
        "animate_file": lambda: [(args.output, (".html",))],
        "check_file": lambda: [(args.preview, PREVIEWS)],
        "predict_file": lambda: [(args.output, PREDICTIONS)],
        "import_file": lambda: [(args.output, PREVIEWS)],
        "report_file": lambda: [(args.preview, PREVIEWS)],
    }[args.run]()
    inputs = tuple(READERS) if args.run == "import_file" else DRAWINGS
    brushes = args.brush if isinstance(args.brush, list) else [args.brush]
    if args.run == "report_file":
        _check_report(args, drawing)
    read = (args.input, *brushes, getattr(args, "program", None))
    taken = [os.path.realpath(path) for path in read if path]
    for path, suffixes in [(args.input, inputs), *outputs]:
        if path is None:
            continue
        _check_extension(args, path, suffixes)
        if path is not args.input:
            if os.path.realpath(path) in taken:
                args.parser.error(f"{path} cannot be two files at once")
            taken.append(os.path.realpath(path))


def _check_report(args, drawing: str) -> None:
    if len(args.brush or ()) > 1 and not args.all_brushes:
        args.parser.error("--brush is given more than once, which needs --all-brushes")
    if args.all_brushes and args.preview:
        args.parser.error("--preview shows one brush, not --all-brushes")
    if args.all_brushes and drawing == ".json":
        args.parser.error("--all-brushes needs a drawing: a plan is made for one brush")
    if args.preview and drawing == ".json":
        args.parser.error("--preview needs a drawing: a plan does not say what was wanted")


def _check_extension(args, path: str, suffixes: tuple[str, ...]) -> None:
    if os.path.splitext(path)[1].lower() not in suffixes:
        args.parser.error(f"{path} does not end in {' or '.join(suffixes)}")
