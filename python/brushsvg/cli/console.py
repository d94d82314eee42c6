"""What a person at a terminal reads: one line per problem, and where the work is."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager

from ..errors import Error
from ..text_summary import folded


class RefusedError(Exception):
    """lines: (file, element, sentence), one for each thing that forbids to go on."""

    def __init__(self, lines: list[tuple[str, str, str]]):
        super().__init__(lines)
        self.lines = lines


@contextmanager
def about(file: str):
    """Lets a user's error inside be reported as one of this file, unless the error names another."""
    try:
        yield
    except Error as problem:
        raise RefusedError([(problem.file or file, problem.where, str(problem))]) from None


def say(*parts: str) -> None:
    """One line on stderr: what a drawing puts into an id can neither break it nor steer the terminal."""
    if sys.stderr is not None:
        text = ": ".join(part for part in ("brushsvg", *parts) if part)
        clear_stage()
        try:
            sys.stderr.write("".join(letter if letter.isprintable() else " " for letter in text) + "\n")
            sys.stderr.flush()
        except OSError:  # nobody reads: what was asked for is done or refused all the same
            let_go(sys.stderr)


def let_go(stream) -> None:
    """What is still buffered goes nowhere, without another complaint at exit."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), stream.fileno())


def tell(text: str) -> None:
    """What was asked for, on stdout."""
    if sys.stdout is None:
        raise RefusedError([("standard output", "", "it is closed")])
    clear_stage()
    sys.stdout.write(text)


def warn(file: str, warnings) -> None:
    """warnings: (element, sentence); many of a kind become one line."""
    for where, sentence in folded(warnings):
        say(file, where, sentence)


def stage(text: str) -> None:
    """What is being done, for a terminal only, until the next line replaces it."""
    _to_terminal(f"\r\x1b[K{text} ...")


def clear_stage() -> None:
    _to_terminal("\r\x1b[K")


def _to_terminal(text: str) -> None:
    if sys.stderr is not None and sys.stderr.isatty():
        sys.stderr.write(text)
        sys.stderr.flush()
