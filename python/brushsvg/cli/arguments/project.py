"""Arguments of the command for the project file: init."""

from __future__ import annotations

import os

from ...jobs.project import NAME
from ...units import PAPERS_MM
from . import flags, values


def add_init(commands) -> None:
    init = commands.add_parser("init", help=f"write {NAME}, the settings for all drawings in a folder")
    init.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        default=NAME,
        help=f"where to write it; its name must be {NAME}; default: in the current folder",
    )
    init.add_argument("--cell", metavar="NAME|FILE", help="the machine; default: brushsvg asks")
    init.add_argument(
        "--brush", metavar="NAME|FILE", help="the brush, or none if it is not measured yet; default: brushsvg asks"
    )
    init.add_argument(
        "--sheet",
        metavar="WxH",
        type=_check_sheet,
        help=f"the paper: {', '.join(PAPERS_MM)}, or its size; default: brushsvg asks",
    )
    flags.add_speed(init)
    flags.add_write_options(init)
    init.set_defaults(run="init_project", parser=init, check=_check_init)


def _check_sheet(text: str) -> str:
    values.sheet(text)
    return text


def _check_init(args) -> None:
    if os.path.basename(args.output) != NAME:
        args.parser.error(f"{args.output} is not found by other commands: its name must be {NAME}")
    if args.cell is None:
        from ..steps.ask_measurements import can_answer

        if not can_answer(args):
            args.parser.error(
                "nobody can answer questions here: give --cell NAME|FILE, and as needed --brush, --sheet and --speed"
            )
