"""Complete commands in the shell, with argcomplete.

This module is imported only when a shell requests completions.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

SHIPPED = Path(__file__).parents[2] / "data"
SUFFIXES = {"brush": ".json", "cell": ".toml"}
# What an option with this dest names.
KIND_BY_DEST = {"brush": "brush", "true_brush": "brush", "prior": "brush", "cell": "cell"}


def complete(parser: argparse.ArgumentParser) -> None:
    """Print the completions for the shell, and exit. Exit silently if argcomplete is not installed."""
    try:
        import argcomplete
    except ImportError:
        sys.exit(1)
    files = argcomplete.FilesCompleter()
    for command in _iterate_commands(parser):
        for action in command._actions:
            if kind := _find_kind(command, action):
                action.completer = _make_completer(kind, files)
    argcomplete.autocomplete(parser, always_complete_options="long")


def _iterate_commands(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """Yield a parser and those of all its commands."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from _iterate_commands(command)


def _find_kind(command: argparse.ArgumentParser, action: argparse.Action) -> str:
    """Return "brush" or "cell" for an option or operand that names one, otherwise ""."""
    if action.option_strings and action.dest in KIND_BY_DEST:
        return KIND_BY_DEST[action.dest]
    names = command.prog.split()
    if action.metavar in ("NAME", "NAME|FILE", "BRUSH") and action.dest in ("input", "like"):
        return next((kind for kind in SUFFIXES if kind in names), "cell" if "first-run" in names else "")
    return ""


def _make_completer(kind: str, files) -> Callable[..., list[str]]:
    def completer(prefix: str, **others) -> list[str]:
        folder = SHIPPED / ("brushes" if kind == "brush" else "cells")
        names = sorted(path.stem for path in folder.glob(f"*{SUFFIXES[kind]}"))
        matching_names = [name for name in names if name.startswith(prefix)]
        matching_paths = (path for path in files(prefix, **others) if path.endswith((SUFFIXES[kind], os.sep, "/")))
        return matching_names + sorted(matching_paths)

    return completer
