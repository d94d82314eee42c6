"""Operands and flags that several commands share."""

from __future__ import annotations

import argparse

from ...machine.posts import POSTS
from ...read import BACKGROUNDS, PENS, READERS, SCRIPTS
from . import values

TERMINALS = ("auto", "round", "butt", "pointed")


PROGRAM_HELP = "a program; its extension names the language (see convert --help)"


def list_output_formats() -> str:
    """Return the extensions of plans and programs, each with the language that it stands for."""
    titles: dict[str, str] = {}
    for post in POSTS.values():
        name = " ".join(post.extensions)
        # Languages that share an extension get the common part of their titles, as in: G-code for grbl.
        titles[name] = post.title.partition(" for ")[0] if name in titles else post.title
    *formats, last_format = (f"{title} ({name})" for name, title in titles.items())
    return f"{', '.join(['a plan (.json)', *formats])}, or {last_format}"


def add_output(command: argparse.ArgumentParser, what: str, is_needed: bool = True) -> None:
    """Add -o, the file or folder that a command writes."""
    command.add_argument("-o", "--output", metavar="OUT", required=is_needed, help=what)


def add_picture(command: argparse.ArgumentParser, what: str, kinds: str = ".png .svg") -> None:
    """Add --picture, a picture that a command writes in addition to its output."""
    command.add_argument("--picture", metavar="FILE", help=f"also draw {what} ({kinds})")


def add_report(command: argparse.ArgumentParser) -> None:
    """Add --details and --json: how much of a report is printed, and in which form."""
    command.add_argument("--details", action="store_true", help="print all tables of the report")
    command.add_argument("--json", action="store_true", help="print the report as JSON")


def add_list_show_check(commands, kind: str, about: str, shown: str, file: str):
    """Add the commands list, show and check for a kind, `brush` or `cell`.

    Returns the subparsers, to which further commands can be added.
    """
    subcommands = commands.add_parser(kind, help=about).add_subparsers(metavar="WHAT", required=True)
    subcommands.add_parser("list", help=f"list the shipped {kind} files").set_defaults(run=f"{kind}_list")
    show = subcommands.add_parser("show", help=f"show {shown} of one {kind}")
    show.add_argument("input", metavar="NAME", help=f"a shipped {kind}, or a {file}")
    show.set_defaults(run=f"{kind}_show")
    check = subcommands.add_parser("check", help=f"check whether a {kind} file is usable")
    check.add_argument("input", metavar="FILE", help=f"a {file}")
    check.set_defaults(run=f"{kind}_check")
    return subcommands


def add_job_options(command: argparse.ArgumentParser) -> None:
    add = command.add_argument
    add_z_offset(command)
    add("--from-stroke", metavar="N", type=values.count, default=1, help="resume a job at this stroke")
    add_order(command)


def add_order(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--order",
        choices=("drawn", "nearest"),
        default="drawn",
        help="order of the strokes of a layer and colour; default: drawn",
    )


def add_z_offset(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--z-offset",
        metavar="MM",
        type=values.height,
        default=0.0,
        help="how much higher the paper is than the cell says; default: 0",
    )


def add_corrections(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--corrections",
        metavar="FILE",
        help="corrections that compare found on a painted sheet: they displace strokes (.json)",
    )


def add_margin_strokes(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--margin-strokes",
        choices=("auto", "on", "off"),
        help="short strokes above the drawing, from which the brush learns; auto: on a page, for a "
        "brush that is not calibrated; default: auto",
    )


def add_quiet(command: argparse.ArgumentParser) -> None:
    has_report = any(action.dest == "json" for action in command._actions)
    only = "only warnings and the report of --json" if has_report else "warnings only"
    command.add_argument("--quiet", action="store_true", help=f"print {only}")


def add_write_options(command: argparse.ArgumentParser) -> None:
    """Add --force and --quiet, for a command that writes files with typed names."""
    command.add_argument(
        "--force",
        action="store_true",
        help="replace existing brushes, cells, corrections and drawings, and files edited since brushsvg wrote them",
    )
    add_quiet(command)


def add_explain(command: argparse.ArgumentParser, drawing: str | None = "input") -> None:
    """Add --explain, for a command that takes settings from a project file.

    drawing: the operand near which the project file is searched; None for the current folder.
    """
    command.add_argument(
        "--explain",
        action="store_true",
        help="also print where each setting comes from, for example brushsvg.toml",
    )
    command.set_defaults(project_near=drawing)


def add_input(command: argparse.ArgumentParser) -> None:
    command.add_argument("input", metavar="IN", help=f"a drawing ({' '.join(READERS)}) or plan (.json)")


def add_choices(command: argparse.ArgumentParser, several_brushes: bool = False) -> None:
    add = command.add_argument
    text = "the brush; default: round-6, or the plan's"
    if several_brushes:
        add(
            "--brush",
            metavar="NAME|FILE",
            action="append",
            help=f"{text}; with --all-brushes, repeat it for more brushes",
        )
    else:
        add("--brush", metavar="NAME|FILE", help=text)
    add("--cell", metavar="NAME|FILE", help="the machine; default: linuxcnc-3axis")
    add_layout(command)
    add_stroke_choices(command)
    add(
        "--compensation",
        choices=("none", "constant", "closed", "refined"),
        help="how to compensate the lag: not at all, with one lag for all strokes, in closed form, or refined; "
        "default: closed",
    )
    add(
        "--lag",
        metavar="MM",
        type=values.lag,
        help="the lag for --compensation constant; default: the lag at the stroke's median depth",
    )
    add(
        "--tolerance",
        metavar="MM",
        type=values.tolerance,
        help="largest tracking error of the painted middle line; default: 0.05",
    )
    add(
        "--terminals",
        choices=TERMINALS,
        help="both ends of all strokes: round, butt (cut straight), pointed, or the best for each; default: auto; "
        "needs --compensation closed or refined",
    )
    add("--start", choices=TERMINALS, help="the start of strokes, where it differs from --terminals")
    add("--end", choices=TERMINALS, help="the end of strokes, where it differs from --terminals")
    add("--lenient", action="store_true", help="paint the undamaged part of damaged geometry")
    add_explain(command)


def add_speed(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--speed",
        dest="paint_speed",
        metavar="MM/S",
        type=values.paint_speed,
        help="painting speed, within the limits of brush and cell; default: the drawing's, or 20",
    )


def add_stroke_choices(command: argparse.ArgumentParser) -> None:
    """Add the choices of strokes that depend on neither brush nor compensation."""
    add = command.add_argument
    add(
        "--colour",
        metavar="COLOUR",
        type=values.colour,
        help="paint only strokes of this colour, such as #1a237e or red",
    )
    add_wide(command)
    add(
        "--corners",
        choices=("auto", "turn"),
        help="at corners, turn the brush in place, or (auto) lift it where that is better; default: auto",
    )
    add(
        "--detail",
        choices=("draft", "normal", "fine"),
        help="filled shapes: how small a corner can be to get its own stroke; default: normal",
    )
    add_script(command)
    add(
        "--join",
        action="store_true",
        default=None,
        help="paint lines of one colour and width that meet end to end as one stroke",
    )


def add_wide(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--wide",
        choices=("auto", "clamp", "passes", "refuse"),
        help="shapes wider than the brush: fill them in passes, paint them as wide as it can, or refuse them; default: "
        "auto, which fills them, except that a pen draws their middle lines",
    )


def add_script(command: argparse.ArgumentParser, what: str = "filled shapes: how they are written") -> None:
    command.add_argument(
        "--script",
        choices=SCRIPTS,
        help=f"{what}; arabic: from right to left, bodies before dots; devanagari: the headline last; default: auto, "
        "from the characters of the text",
    )


def add_layout(command: argparse.ArgumentParser) -> None:
    add = command.add_argument
    add(
        "--sheet",
        metavar="WxH",
        type=values.sheet,
        help="the sheet: its size in mm or with units, a2 to a5, or letter; default: the drawing's",
    )
    add("--units", choices=("mm", "in"), help="the unit of a drawing that does not define it (DXF)")
    add(
        "--layer",
        metavar="NAME",
        action="append",
        type=values.words,
        help="paint this layer; repeat it for more layers",
    )
    add(
        "--select",
        metavar="CSS",
        type=values.words,
        help="paint the elements that this selector matches and all they contain (SVG)",
    )
    add(
        "--background",
        choices=BACKGROUNDS,
        help="paint a white shape that covers the page (keep), or leave it out (auto); default: auto (SVG)",
    )
    add("--pen", choices=PENS, help="what lifts the pen in G-code: Z, or a servo (M3); default: detected")
    add(
        "--paper-z",
        metavar="MM",
        type=values.paper_z,
        help="the height of the paper in G-code; lines at this height or beyond it are drawn",
    )
    add(
        "--skip-region",
        metavar="X0,Y0,X1,Y1",
        action="append",
        type=values.region,
        help="leave out strokes of G-code in this rectangle (mm), such as dips at a pot; repeat it for more",
    )
    add(
        "--skip-comment",
        metavar="TEXT",
        action="append",
        type=values.words,
        help="leave out strokes of G-code that follow a comment with this text; repeat it for more",
    )
    add(
        "--width",
        metavar="MM",
        type=values.width,
        help="width of all lines; default: as drawn; filled shapes keep their outline",
    )
    add(
        "--as",
        dest="paths_as",
        choices=("stroke", "outline"),
        help="read paths as lines and ignore fills (stroke), or as outlines and ignore strokes (outline); "
        "default: as drawn",
    )
    size = command.add_mutually_exclusive_group()
    size.add_argument(
        "--fit", metavar="WxH", type=values.size, help="scale the marks to this size, centred on the sheet"
    )
    size.add_argument(
        "--scale", metavar="FACTOR", type=values.scale, help="scale the drawing and its widths: 1.5 or 150%%"
    )
    add(
        "--origin",
        metavar="X,Y",
        type=values.point,
        help="the position of the lower left corner of the marks",
    )
