"""Parse and check the command line.

Nothing heavy is imported here, so that a typing error is reported at once.
"""

from __future__ import annotations

import argparse
import functools
import os
import re
from collections.abc import Iterator

from ...suggestions import did_you_mean
from ..console import print_text, say
from . import brushes, drawings, help_text, installation, machines, project


def parse(argv: list[str] | None = None) -> argparse.Namespace:
    """Parse the command line; `run` of the result names a function of `commands`.

    Raises SystemExit on --help, --version and wrong usage.
    """
    parser = command_parser()
    if "_ARGCOMPLETE" in os.environ:  # a shell asks for completions
        from .completion import complete

        complete(parser)
    args = parser.parse_args(argv)
    if "check" in args:
        args.check(args)
    return args


class _Parser(argparse.ArgumentParser):
    def __init__(self, **settings):
        # A prefix of a flag is not accepted, because its meaning would change when flags are added.
        super().__init__(allow_abbrev=False, **settings)
        # argparse accepts -5 as a value, but reads -5,-5 and -5mm as flags.
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def _get_values(self, action, arg_strings):
        # argparse drops "--" anywhere, so that --width=-- would become an empty list.
        if action.option_strings and "--" in arg_strings:
            raise argparse.ArgumentError(action, "'--' is not a value")
        return super()._get_values(action, arg_strings)

    def _check_value(self, action, value):
        if action.choices is not None and value not in action.choices:
            choices = [str(choice) for choice in action.choices]
            sentence = f"{value!r} is not known{did_you_mean(str(value), choices)} Known are {', '.join(choices)}"
            raise argparse.ArgumentError(action, sentence)

    def parse_known_args(self, args=None, namespace=None):
        """Refuse unknown arguments, and suggest a similar flag of this parser."""
        parsed, unknown = super().parse_known_args(args, namespace)
        if unknown:
            flag = unknown[0].partition("=")[0]
            flags = [name for action in self._actions for name in action.option_strings]
            hint = did_you_mean(flag, flags) if flag.startswith("-") else "."
            if flag == "--messages":
                hint = ": it stands before the command, as in brushsvg --messages json convert"
            self.error(f"unrecognized arguments: {' '.join(unknown)}{hint.removesuffix('.')}")
        return parsed, unknown

    def format_help(self) -> str:
        commands = next((each for each in self._actions if isinstance(each, argparse._SubParsersAction)), None)
        if commands is not None and commands.metavar == "COMMAND":
            return help_text.commands_text(self, commands)
        return help_text.command_text(self, is_whole=False)

    def print_help(self, file=None) -> None:
        print_text(self.format_help())

    def error(self, message: str):
        say(f"{message} (see {self.prog} --help)")
        raise SystemExit(2)


class _HelpAll(argparse.Action):
    def __call__(self, parser, *_):
        print_text(help_text.command_text(parser, is_whole=True))
        parser.exit()


class _Version(argparse.Action):
    def __call__(self, parser, *_):
        from ... import __version__

        print_text(f"brushsvg {__version__}\n")
        parser.exit()


@functools.cache  # adding the flags of all commands needs more time than a short command
def command_parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="brushsvg", description="Turn vector lettering into brush strokes that a robot can paint.")
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    parser.add_argument(
        "--messages",
        choices=("text", "json"),
        default="text",
        help="warnings and refusals as lines of text, or of JSON with their codes; default: text",
    )
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    installation.add_demo(commands)
    project.add_init(commands)
    drawings.add_text(commands)
    drawings.add_preview(commands)
    drawings.add_convert(commands)
    machines.add_check(commands)
    drawings.add_batch(commands)
    machines.add_cell(commands)
    machines.add_setup(commands)
    brushes.add_chart(commands)
    brushes.add_calibrate(commands)
    brushes.add_brush(commands)
    drawings.add_compare(commands)
    drawings.add_simulate_photo(commands)
    installation.add_doctor(commands)
    for command in _iterate_parsers(commands):
        help_text.group_options(command)
        command.add_argument(help_text.HELP_ALL, action=_HelpAll, nargs=0, help="show all options and exit")
    return parser


def _iterate_parsers(commands: argparse._SubParsersAction) -> Iterator[argparse.ArgumentParser]:
    """Yield the parsers of commands and of their subcommands, such as `cell place`."""
    for command in commands.choices.values():
        yield command
        for action in command._actions:
            if isinstance(action, argparse._SubParsersAction):
                yield from _iterate_parsers(action)
