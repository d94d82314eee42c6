"""The commands about brushsvg itself: demo, doctor, install-plugin."""

from __future__ import annotations

from .flags import add_writes
from .usage_checks import check_files

DEMO_PICTURE = "brushsvg-demo.png"


def add_demo(commands) -> None:
    demo = commands.add_parser("demo", help="paint a word that comes with brushsvg, and show the picture")
    demo.add_argument(
        "output",
        metavar="OUT",
        nargs="?",
        default=DEMO_PICTURE,
        help=f"the picture (.png); default: {DEMO_PICTURE}",
    )
    demo.add_argument("--no-open", action="store_true", help="do not open the picture in a viewer")
    add_writes(demo)
    demo.set_defaults(run="demo_picture", parser=demo, check=_check_demo)


def _check_demo(args) -> None:
    check_files(args, [], [(args.output, (".png",))])


def add_doctor(commands) -> None:
    doctor = commands.add_parser(
        "doctor", help="list versions, extras, fonts and Inkscape, and what is missing"
    )
    doctor.set_defaults(run="list_installation", parser=doctor)


def add_install_plugin(commands) -> None:
    install = commands.add_parser("install-plugin", help="install the extension for Inkscape")
    install.add_argument("plugin", metavar="inkscape", choices=("inkscape",), help="which one")
    install.add_argument(
        "zip", metavar="ZIP", nargs="?", help="brushsvg-inkscape.zip; not needed in a source tree"
    )
    install.add_argument("--remove", action="store_true", help="remove the extension again")
    install.set_defaults(run="install_plugin", parser=install, check=_check_install_plugin)


def _check_install_plugin(args) -> None:
    if args.remove and args.zip is not None:
        args.parser.error("--remove needs no zip: leave it out")
