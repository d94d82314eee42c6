"""Arguments of the commands for a start: demo, doctor."""

from __future__ import annotations

from . import flags
from .usage_checks import check_files

DEMO_PICTURE = "brushsvg-demo.png"


def add_demo(commands) -> None:
    demo = commands.add_parser("demo", help="paint a word that comes with brushsvg, and show the picture")
    flags.add_output(demo, f"the picture (.png); default: {DEMO_PICTURE}", False)
    demo.add_argument("--no-open", action="store_true", help="do not open the picture in a viewer")
    flags.add_write_options(demo)
    demo.set_defaults(run="demo_picture", parser=demo, check=_check_demo)


def _check_demo(args) -> None:
    args.output = args.output or DEMO_PICTURE
    check_files(args, [], [(args.output, (".png",))])


def add_doctor(commands) -> None:
    doctor = commands.add_parser("doctor", help="list versions, extras, fonts and Inkscape, and what is missing")
    doctor.set_defaults(run="list_installation", parser=doctor)
