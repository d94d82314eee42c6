"""What was typed, parsed and checked. Nothing heavy is imported: a typing error is told at once."""

from __future__ import annotations

import argparse
import os

from .console import say, tell
from .errors import Error
from .importers import READERS
from .posts import POSTS

DRAWINGS = (*READERS, ".json")
PROGRAMS = (".json", *dict.fromkeys(post.extension for post in POSTS.values()))
PREDICTIONS = (".png", ".svg", ".json")
PREVIEWS = (".png", ".svg")
REPORTS = (".txt", ".json")


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
    convert.add_argument("--preview", metavar="FILE", help="also write what will be painted (.png .svg)")
    convert.add_argument("--report", metavar="FILE", help="also write the figures (.txt .json)")
    convert.set_defaults(run="convert_file", parser=convert)

    predict = commands.add_parser("predict", help="show what the brush will paint")
    _add_input(predict)
    predict.add_argument("output", metavar="OUT", help="a picture (.png .svg) or marks (.json)")
    _add_choices(predict)
    predict.set_defaults(run="predict_file", parser=predict)

    look = commands.add_parser("import", help="show what was understood of a drawing")
    look.add_argument("input", metavar="IN", help=f"a drawing ({' '.join(READERS)})")
    look.add_argument("output", metavar="OUT", help="a picture (.svg .png)")
    _add_layout(look)
    look.set_defaults(run="import_file", parser=look, brush=None, lag=None)

    text = commands.add_parser("text", help="set a text in a font, as a drawing")
    text.add_argument("input", metavar="TEXT", help="what to write; \\n starts a line")
    text.add_argument("output", metavar="OUT", help="a drawing (.svg)")
    text.add_argument(
        "--font", metavar="FILE", required=True, help="an SVG font of single lines, or TrueType, OpenType"
    )
    text.add_argument("--size", metavar="MM", type=_width, default=20.0, help="of the em; default: 20")
    text.add_argument(
        "--width", metavar="MM", type=_width, default=1.0, help="of the lines of an SVG font; default: 1"
    )
    text.add_argument(
        "--sheet", metavar="WxH", type=_size, help="the sheet; default: the text and 20 mm around it"
    )
    text.set_defaults(run="text_file", parser=text)

    report = commands.add_parser("report", help="say in figures how near the paint comes to the drawing")
    _add_input(report)
    _add_choices(report)
    report.add_argument("--json", action="store_true", help="as JSON")
    report.set_defaults(run="report_file", parser=report)

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
    return parser


def _programs() -> str:
    return " or ".join(["a plan (.json)", *(f"{post.title} ({post.extension})" for post in POSTS.values())])


def _add_input(command: argparse.ArgumentParser) -> None:
    command.add_argument("input", metavar="IN", help=f"a drawing ({' '.join(READERS)}) or plan (.json)")


def _add_choices(command: argparse.ArgumentParser) -> None:
    add = command.add_argument
    add("--brush", metavar="NAME|FILE", help="default: round-6; for a plan, the brush it names")
    add("--cell", metavar="NAME|FILE", help="the machine; default: linuxcnc-3axis")
    _add_layout(command)
    add(
        "--wide",
        choices=("clamp", "passes", "refuse"),
        help="filled outlines wider than the brush: its greatest width, several passes, or no; default: clamp",
    )
    add("--compensation", choices=("none", "constant", "closed"), help="default: closed")
    add("--lag", metavar="MM", type=_lag, help="for constant; default: that at the stroke's median depth")
    add("--tolerance", metavar="MM", type=_tolerance, help="of the painted middle line; default: 0.05")
    add("--lenient", action="store_true", help="take what is sound of damaged geometry")


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


def _lag(text: str) -> float:
    return _length(text, 0.0, 1000.0)


def _tolerance(text: str) -> float:
    return _length(text, 1e-5, 10.0)  # a program is written to 1e-4 mm: less would only cost poses


def _words(text: str) -> str:
    if not text.strip():
        raise argparse.ArgumentTypeError("it is empty")
    return text


def _width(text: str) -> float:
    return _length(text, 0.001, 1000.0)


def _scale(text: str) -> float:
    try:
        value = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text[:24]!r} is not a factor; write for example 1.5 or 150%"
        ) from None
    if not 1e-4 <= value <= 1e4:
        raise argparse.ArgumentTypeError(f"{value:g} is outside the range [0.0001, 10000]")
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
    if args.run.startswith(("brush_", "cell_")):
        return
    if args.run == "text_file":
        if os.path.splitext(args.output)[1].lower() != ".svg":
            args.parser.error(f"{args.output} does not end in .svg")
        if os.path.realpath(args.output) == os.path.realpath(args.font):
            args.parser.error(f"{args.output} cannot be two files at once")
        return
    drawing = os.path.splitext(args.input)[1].lower()
    if args.units and drawing == ".svg":
        args.parser.error("--units is for drawings that do not say them; an SVG does")
    if args.select and drawing == ".dxf":
        args.parser.error("--select is for SVG; choose layers of a DXF with --layer")
    if args.lag is not None and args.compensation != "constant":
        args.parser.error("--lag needs --compensation constant")
    outputs = {
        "convert_file": lambda: [(args.output, PROGRAMS), (args.preview, PREVIEWS), (args.report, REPORTS)],
        "predict_file": lambda: [(args.output, PREDICTIONS)],
        "import_file": lambda: [(args.output, PREVIEWS)],
        "report_file": lambda: [],
    }[args.run]()
    inputs = tuple(READERS) if args.run == "import_file" else DRAWINGS
    taken = [os.path.realpath(path) for path in (args.input, args.brush) if path]
    for path, suffixes in [(args.input, inputs), *outputs]:
        if path is None:
            continue
        if os.path.splitext(path)[1].lower() not in suffixes:
            args.parser.error(f"{path} does not end in {' or '.join(suffixes)}")
        if path is not args.input:
            if os.path.realpath(path) in taken:
                args.parser.error(f"{path} cannot be two files at once")
            taken.append(os.path.realpath(path))
