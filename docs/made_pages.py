"""Write the reference pages that come from the code: commands, public names of Python, shipped cells."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Iterator
from pathlib import Path

import brushsvg
from brushsvg.cli.arguments.help_text import command_text
from brushsvg.cli.arguments.parser import command_parser
from brushsvg.machine.cells.cell_file import find_cell, write_cell

COLUMNS = 100  # of help texts, whatever the terminal is


def write_pages(folder: Path) -> None:
    """Write commands.md, python.md and cells.md into folder; an unchanged page keeps its time."""
    folder.mkdir(exist_ok=True)
    for name, lines in (("commands", _commands()), ("python", _python()), ("cells", _cells())):
        page, text = folder / f"{name}.md", "\n".join([*lines, ""])
        if not page.is_file() or page.read_text() != text:
            page.write_text(text)


def _commands() -> Iterator[str]:
    parser = command_parser()
    yield "# Commands\n"
    yield "This page is for everyone who looks up an option: it has the `--help-all` of every command.\n"
    for command, of_command in _of(parser).items():
        yield from _command(command, of_command, "##")


def _command(name: str, parser: argparse.ArgumentParser, heading: str) -> Iterator[str]:
    parser.formatter_class = lambda prog: argparse.HelpFormatter(prog, width=COLUMNS)
    yield f"{heading} {name}\n\n```text\n{command_text(parser, is_whole=True).rstrip()}\n```\n"
    for below, of_below in _of(parser).items():
        yield from _command(f"{name} {below}", of_below, heading + "#")


def _of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            return action.choices
    return {}


def _python() -> Iterator[str]:
    yield "# Python\n"
    yield "This page is for everyone who programs with `import brushsvg`: it has all public names.\n"
    yield "Lengths are in mm, angles in rad, times in s, and y points up. Results are values: two with the same fields"
    yield "are equal, they can be pickled, and `copy.copy` shares nothing with the original. Arrays of a value are"
    yield "read-only: set the field to another array. A notebook draws a Brush, a Plan, Marks and a Design.\n"
    for name in sorted(brushsvg.__all__, key=str.lower):
        if name.startswith("__"):
            continue
        named = getattr(brushsvg, name)
        kind = "module" if inspect.ismodule(named) else "class" if inspect.isclass(named) else "function"
        yield f"```{{eval-rst}}\n.. auto{kind}:: brushsvg.{name}"
        options = "" if kind == "function" else "   :members:\n"
        if kind == "module":  # names that have their own entry
            options += f"   :exclude-members: {', '.join(sorted(set(named.__all__) & set(brushsvg.__all__)))}\n"
        yield options + "```\n"


def _cells() -> Iterator[str]:
    yield "# Shipped cells\n"
    yield "This page is for everyone who wants to read a cell before copying it: it has all shipped cells.\n"
    yield "`brushsvg cell new -o my.toml --like NAME` writes each of them. [Cell files](cell.md) explains the keys.\n"
    for name in brushsvg.cell_names():
        yield f"## {name}\n\n```toml\n{write_cell(find_cell(name)).rstrip()}\n```\n"
