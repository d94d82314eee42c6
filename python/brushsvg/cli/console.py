"""What a person at a terminal reads: one line per problem, and where the work is."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from contextlib import contextmanager

from ..errors import Error, Notice
from ..text_summary import summarized


class RefusedError(Exception):
    """why: one for each thing that forbids to go on; file: the one that they are of."""

    def __init__(self, file: str, why: list[Notice]):
        super().__init__(file, why)
        self.file, self.why = file, why


@contextmanager
def refuse_errors(file: str):
    """Lets a user's error inside be reported as one of this file, unless the error names another, behind what is to be
    warned of."""
    try:
        yield
    except Error as problem:
        warn(file, problem.notices)
        raise RefusedError(problem.file or file, [problem.notice()]) from None


def say(*parts: str) -> None:
    """One line on stderr: what a drawing puts into an id can neither break it nor steer the terminal."""
    if sys.stderr is not None:
        text = ": ".join(part for part in ("brushsvg", *parts) if part)
        _write_line("".join(letter if letter.isprintable() else " " for letter in text))


def _write_line(text: str) -> None:
    clear_stage()
    try:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()
    except OSError:  # nobody reads: the command still ends as usual
        discard_output(sys.stderr)


def discard_output(stream) -> None:
    """What is still buffered goes nowhere, without another complaint at exit."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), stream.fileno())


def print_text(text: str) -> None:
    """Print the result of a command on stdout."""
    if sys.stdout is None:
        raise RefusedError("standard output", [Notice("", "it is closed", code="file-unwritable")])
    clear_stage()
    sys.stdout.write(text)


def warn(file: str, warnings: Iterable[Notice]) -> None:
    """Many warnings of a kind become one line."""
    for notice in summarized(warnings):
        say_notice(file, notice)


def say_notice(file: str, notice: Notice) -> None:
    """Print one line of text, or of JSON with --messages json."""
    if not _in_json:
        say(file, notice.where, notice.text)
    elif sys.stderr is not None:
        _write_line(json.dumps({"file": file, **notice.as_json()}))


def use_json_messages(is_on: bool) -> None:
    """Set whether warnings and refusals are printed as JSON from now on."""
    global _in_json
    _in_json = is_on


_in_json = False


def stage(text: str) -> None:
    """What is being done, for a terminal only, until the next line replaces it."""
    _write_to_terminal(f"\r\x1b[K{text} ...")


def clear_stage() -> None:
    _write_to_terminal("\r\x1b[K")


def _write_to_terminal(text: str) -> None:
    if sys.stderr is not None and sys.stderr.isatty():
        sys.stderr.write(text)
        sys.stderr.flush()
