"""The one error a user can cause; everything else is a bug."""

from __future__ import annotations

import sys


class Error(ValueError):
    """A refusal in one full sentence.

    sentence: what is wrong, with the number and the admissible range; str(error) is this sentence.
    where: the element, stroke or key it concerns, "" if none.
    value, range: the offending number and (least, greatest), None where there are none.
    file: the file it is about, None where only the caller knows.
    """

    def __init__(
        self,
        sentence: str,
        where: str = "",
        value: float | None = None,
        range: tuple[float, float] | None = None,
        file: str | None = None,
    ):
        super().__init__(sentence)
        self.sentence = sentence
        self.where = where
        self.value = value
        self.range = range
        self.file = file
        for name in (name for name in (file, where) if isinstance(name, str) and name):
            self.add_note(f"in {name}")  # for whoever meets it as a traceback


def need(value, kind: type | tuple[type, ...], what: str) -> None:
    """Error for a value of another Python type than what it should be, in words."""
    if not isinstance(value, kind):
        raise Error(f"{type(value).__name__} {str(value)[:40]!r} is not {what}")


def lacking(what: str, *packages: str) -> Error:
    """A refusal for want of packages of an extra, with what installs them where this runs."""
    names = " ".join(packages)
    return Error(f"{what} {' and '.join(packages)}: install with  {sys.executable} -m pip install {names}")
