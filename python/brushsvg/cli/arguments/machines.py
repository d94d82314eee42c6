"""Arguments of the commands for machines: setup, check, cell."""

from __future__ import annotations

from . import flags, values
from .usage_checks import DRAWINGS, PICTURES, PROGRAMS, check_drawing, check_extension, check_files


def add_setup(commands) -> None:
    about = "write programs to set up a machine, and install the Inkscape extension"
    subcommands = commands.add_parser("setup", help=about).add_subparsers(metavar="WHAT", required=True)
    _add_first_run(subcommands)
    _add_height(subcommands)
    _add_border(subcommands)
    _add_inkscape(subcommands)


def _add_first_run(commands) -> None:
    first = commands.add_parser("first-run", help="write a safe first program for a new machine")
    first.add_argument("input", metavar="NAME", help="a shipped cell, or a cell.toml")
    flags.add_output(first, flags.PROGRAM_HELP)
    first.add_argument("--brush", metavar="NAME|FILE", help="the brush; default: round-6")
    first.add_argument("--sheet", metavar="WxH", type=values.sheet, help="the sheet; default: 200x100")
    flags.add_explain(first, None)
    flags.add_write_options(first)
    first.set_defaults(run="first_run_file", parser=first, check=_check_first_run)


def _check_first_run(args) -> None:
    check_files(args, [(args.brush, None)], [(args.output, PROGRAMS)])


def _add_border(commands) -> None:
    border = commands.add_parser("border", help="write a program that goes around the job in the air, at safe height")
    flags.add_input(border)
    flags.add_output(border, flags.PROGRAM_HELP)
    flags.add_choices(border)
    flags.add_z_offset(border)
    flags.add_margin_strokes(border)
    flags.add_write_options(border)
    border.set_defaults(run="border_file", parser=border, check=_check_border)


def _check_border(args) -> None:
    check_drawing(args)
    check_files(args, [(args.input, DRAWINGS), (args.brush, None)], [(args.output, PROGRAMS)])


def _add_height(commands) -> None:
    height = commands.add_parser("height", help="write a program whose strokes show how high the paper is")
    flags.add_output(height, flags.PROGRAM_HELP)
    height.add_argument("--brush", metavar="NAME|FILE", help="the brush; default: round-6")
    height.add_argument("--cell", metavar="NAME|FILE", help="the machine; default: linuxcnc-3axis")
    height.add_argument("--sheet", metavar="WxH", type=values.sheet, help="the sheet; default: 200x100")
    height.add_argument(
        "--from",
        metavar="MM",
        dest="highest",
        type=values.height,
        default=1.0,
        help="height of the first stroke; default: 1",
    )
    height.add_argument(
        "--to",
        metavar="MM",
        dest="lowest",
        type=values.height,
        default=-1.0,
        help="height of the last stroke; default: -1",
    )
    height.add_argument(
        "--step",
        metavar="MM",
        type=values.step,
        default=0.1,
        help="the difference in height between two strokes; default: 0.1",
    )
    flags.add_explain(height, None)
    flags.add_write_options(height)
    height.set_defaults(run="height_file", parser=height, check=_check_height)


def _check_height(args) -> None:
    check_files(args, [(args.brush, None)], [(args.output, PROGRAMS)])


def _add_inkscape(commands) -> None:
    install = commands.add_parser("inkscape", help="install the extension for Inkscape")
    install.add_argument("zip", metavar="ZIP", nargs="?", help="brushsvg-inkscape.zip; not needed in a source tree")
    install.add_argument("--remove", action="store_true", help="remove the extension again")
    install.set_defaults(run="install_plugin", parser=install, check=_check_inkscape)


def _check_inkscape(args) -> None:
    if args.remove and args.zip is not None:
        args.parser.error("--remove needs no zip: leave it out")


def add_check(commands) -> None:
    check = commands.add_parser("check", help="read a program back, simulate it, and compare it with its drawing")
    check.add_argument("program", metavar="PROGRAM", help=flags.PROGRAM_HELP)
    check.add_argument("input", metavar="IN", nargs="?", help="the drawing, or plan (.json), that it should paint")
    check.add_argument("--brush", metavar="NAME|FILE", help="the brush; default: the one that the program names")
    check.add_argument("--cell", metavar="NAME|FILE", help="the machine; default: the one that the program names")
    flags.add_layout(check)
    flags.add_stroke_choices(check)
    flags.add_speed(check)
    flags.add_corrections(check)
    check.add_argument(
        "--z-offset",
        metavar="MM",
        type=values.height,
        help="how much higher the paper is than the cell says; default: as in the program",
    )
    check.add_argument("--lenient", action="store_true", help="paint the undamaged part of damaged geometry")
    flags.add_picture(check, "what will be painted")
    flags.add_explain(check)
    flags.add_report(check)
    flags.add_write_options(check)
    check.set_defaults(
        run="check_file",
        parser=check,
        check=_check_check,
        lag=None,
        compensation=None,
        tolerance=None,
        start=None,
        end=None,
    )


def _check_check(args) -> None:
    if args.input is not None:
        check_drawing(args)
    elif args.corrections is not None:
        args.parser.error("--corrections needs the drawing that they belong to")
    read = [
        (args.program, PROGRAMS),
        (args.input, DRAWINGS),
        (args.brush, None),
        (args.corrections, (".json",)),
    ]
    check_files(args, read, [(args.picture, PICTURES)])


def add_cell(commands) -> None:
    about = "list, show, check and create cells: machines with their limits"
    subcommands = flags.add_list_show_check(commands, "cell", about, "heights, speeds and limits", "cell.toml")
    new = subcommands.add_parser("new", help="write a cell file for you to edit")
    flags.add_output(new, "a cell file (.toml); its name becomes the cell's name")
    new.add_argument("--like", metavar="NAME|FILE", help="the cell to start from; default: linuxcnc-3axis")
    new.add_argument(
        "--taught",
        metavar="X,Y,Z",
        action="append",
        type=values.point3,
        help="a point in the robot's frame where the tip just touches the sheet; give it three or four times: at the "
        "lower left corner, on the lower edge, on the left edge, and anywhere else, in this order",
    )
    flags.add_write_options(new)
    new.set_defaults(run="cell_new", parser=new, check=_check_cell_new)
    _add_cell_place(subcommands)


def _add_cell_place(subcommands) -> None:
    place = subcommands.add_parser("place", help="find where to put the paper so that an arm reaches the drawing")
    place.add_argument("input", metavar="NAME", help="a shipped cell, or a cell.toml, with an arm")
    place.add_argument("drawing", metavar="IN", nargs="?", help="the drawing to paint; default: the whole sheet")
    flags.add_output(place, "a picture of the table (.png .svg)", False)
    place.add_argument("--brush", metavar="NAME|FILE", help="the brush; default: round-6")
    flags.add_layout(place)
    flags.add_wide(place)
    flags.add_explain(place, "drawing")
    flags.add_write_options(place)
    place.set_defaults(run="cell_place", parser=place, check=_check_cell_place)


def _check_cell_place(args) -> None:
    read = [(args.drawing, DRAWINGS), (args.brush, None)]
    check_files(args, read, [(args.output, PICTURES)])


def _check_cell_new(args) -> None:
    check_extension(args, args.output, (".toml",))
    if len(args.taught or ()) not in (0, 3, 4):
        args.parser.error(f"--taught is given {len(args.taught)} times, not three or four")
