"""Print messages and progress on the terminal: one line for each problem."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from contextlib import contextmanager

from ..errors import Error, Notice
from ..notice_summary import summarize_notices


class RefusedError(Exception):
    """A command cannot go on.

    why: one notice for each reason.
    file: the file that the reasons concern.
    """

    def __init__(self, file: str, why: list[Notice]):
        super().__init__(file, why)
        self.file, self.why = file, why


@contextmanager
def refuse_errors(file: str):
    """Turn an Error inside into a RefusedError for this file.

    The file is ignored if the error names another file. Warnings of the error are printed first.
    """
    try:
        yield
    except Error as problem:
        warn(file, problem.notices)
        raise RefusedError(problem.file or file, [problem.notice()]) from None


def say(*parts: str) -> None:
    """Print one line on stderr.

    Unprintable characters are replaced, so that an id in a drawing can neither break the line nor control the
    terminal.
    """
    if sys.stderr is not None:
        text = ": ".join(part for part in ("brushsvg", *parts) if part)
        _write_line("".join(letter if letter.isprintable() else " " for letter in text))


def _write_line(text: str) -> None:
    clear_stage()
    try:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()
    except OSError:  # nothing reads stderr: the command still ends as usual
        discard_output(sys.stderr)


def discard_output(stream) -> None:
    """Discard what a stream still buffers, so that it causes no error at exit."""
    with open(os.devnull, "wb") as null_device:
        os.dup2(null_device.fileno(), stream.fileno())


def print_text(text: str) -> None:
    """Print the result of a command on stdout, unless --quiet."""
    if _is_quiet:
        return
    if sys.stdout is None:
        raise RefusedError("standard output", [Notice("", "it is closed", code="file-unwritable")])
    clear_stage()
    sys.stdout.write(text)


def warn(file: str, warnings: Iterable[Notice]) -> None:
    """Print warnings, with many warnings of one kind in one line."""
    for notice in summarize_notices(warnings):
        say_notice(file, notice)


def say_notice(file: str, notice: Notice) -> None:
    """Print a notice as one line of text, or of JSON with --messages json."""
    if not _in_json:
        say(file, notice.where, notice.text)
    elif sys.stderr is not None:
        _write_line(json.dumps({"file": file, **notice.as_json()}))


def set_output(json_messages: bool, quiet: bool) -> None:
    """Set whether warnings and refusals are printed as JSON from now on, and whether results are not printed."""
    global _in_json, _is_quiet
    _in_json, _is_quiet = json_messages, quiet


_in_json = _is_quiet = False


def stage(text: str) -> None:
    """Show what is being done on a terminal, until the next line replaces it."""
    _write_to_terminal(f"\r\x1b[K{text} ...")


def clear_stage() -> None:
    _write_to_terminal("\r\x1b[K")


def _write_to_terminal(text: str) -> None:
    if sys.stderr is not None and sys.stderr.isatty():
        sys.stderr.write(text)
        sys.stderr.flush()
