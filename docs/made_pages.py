"""Pages of the reference that are made from the code: commands, the public names of Python, the keys of a cell."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Iterator
from pathlib import Path

import brushsvg
from brushsvg.cli.arguments.parser import command_parser
from brushsvg.machine.cells.cell_file import find_cell, write_cell

COLUMNS = 100  # of help texts, whatever the terminal is


def write_pages(folder: Path) -> None:
    """commands.md, python.md and cells.md into folder; a page that would say the same is left alone."""
    folder.mkdir(exist_ok=True)
    for name, lines in (("commands", _commands()), ("python", _python()), ("cells", _cells())):
        page, text = folder / f"{name}.md", "\n".join([*lines, ""])
        if not page.is_file() or page.read_text() != text:
            page.write_text(text)


def _commands() -> Iterator[str]:
    parser = command_parser()
    yield "# Commands\n"
    yield "What `brushsvg COMMAND --help` prints, of every command.\n"
    for command, of_command in _of(parser).items():
        yield from _command(command, of_command, "##")


def _command(name: str, parser: argparse.ArgumentParser, heading: str) -> Iterator[str]:
    parser.formatter_class = lambda prog: argparse.HelpFormatter(prog, width=COLUMNS)
    yield f"{heading} {name}\n\n```text\n{parser.format_help().rstrip()}\n```\n"
    for below, of_below in _of(parser).items():
        yield from _command(f"{name} {below}", of_below, heading + "#")


def _of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            return action.choices
    return {}


def _python() -> Iterator[str]:
    yield "# Python\n"
    yield "`import brushsvg`: all public names. Lengths are in mm, angles in rad, times in s, y up.\n"
    yield "What is handed out is a value: it shows itself in a line, two with the same fields are equal, it can be"
    yield "pickled, and `copy.copy` shares nothing with what it was made from. Arrays of a value are read-only: set the"
    yield "field to another array instead. A notebook draws a Brush, a Plan, Marks and a Design.\n"
    for name in sorted(brushsvg.__all__, key=str.lower):
        if name.startswith("__"):
            continue
        named = getattr(brushsvg, name)
        kind = "module" if inspect.ismodule(named) else "class" if inspect.isclass(named) else "function"
        yield f"```{{eval-rst}}\n.. auto{kind}:: brushsvg.{name}"
        told = "" if kind == "function" else "   :members:\n"
        if kind == "module":  # what stands on this page by itself
            told += f"   :exclude-members: {', '.join(sorted(set(named.__all__) & set(brushsvg.__all__)))}\n"
        yield told + "```\n"


def _cells() -> Iterator[str]:
    yield "# The keys of a cell\n"
    yield "What `brushsvg cell new my.toml --like NAME` writes, of each cell that comes along. What a key is for stands"
    yield "beside it; [machines.md](../machines.md) says how to find your values.\n"
    for name in brushsvg.cell_names():
        yield f"## {name}\n\n```toml\n{write_cell(find_cell(name)).rstrip()}\n```\n"
