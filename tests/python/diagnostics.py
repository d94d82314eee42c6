"""Compare warnings and refusals by code, numbers and names, not by wording."""

import json
import re
import shlex
from contextlib import contextmanager

import pytest

from brushsvg.cli import main
from brushsvg.errors import Error, Notice


def agrees(reported: Error | Notice, expected: str, where: str | None = None) -> bool:
    """Return whether a notice or an error has the expected code, numbers and names.

    `expected` is a code, followed by numbers and names. The element or the sentence must contain each of them
    as a whole word. A part that contains blanks stands in quotes. `where` is the element that the notice must
    be about.
    """
    code, *parts = shlex.split(expected)
    text = f"{reported.where}: {reported if isinstance(reported, Error) else reported.text}"
    return reported.code == code and where in (None, reported.where) and all(_found(part, text) for part in parts)


def is_reported(reported, expected: str, where: str | None = None) -> bool:
    """Return whether one of the notices agrees.

    `reported` holds notices, alone or paired with their files as `in_json` returns them.
    """
    notices = (each[1] if isinstance(each, tuple) else each for each in reported)
    return any(agrees(each, expected, where) for each in notices)


def are_reported(reported, *expected: str) -> bool:
    """Return whether exactly the expected notices were reported, in this order."""
    return len(reported) == len(expected) and all(map(agrees, reported, expected))


def gives(text: str, *parts: str) -> bool:
    """Return whether a text contains these numbers and names in this order.

    Each part must be a whole word. The text between the parts does not matter.
    """
    for part in parts:
        found = _found(part, text)
        if found is None:
            return False
        text = text[found.end() :]
    return True


def _found(part: str, text: str) -> re.Match | None:
    before = r"(?<![\w.-])" if part[0].isalnum() else ""
    after = r"(?!\w|\.\d)" if part[-1].isalnum() else ""
    return re.search(before + re.escape(part) + after, text)


@contextmanager
def refused(expected: str, where: str | None = None):
    """Expect a refusal that agrees, about the element `where` if it is given."""
    with pytest.raises(Error) as caught:
        yield caught
    reported = caught.value
    assert agrees(reported, expected, where), (expected, reported.code, reported.where, str(reported))


def in_json(capsys, *words) -> tuple[int, str, list[tuple[str, Notice]]]:
    """Return the exit status, standard output, and each notice with its file."""
    status = main(["--messages", "json", *map(str, words)])
    output, errors = capsys.readouterr()
    return status, output, heard(errors.splitlines())


def heard(lines) -> list[tuple[str, Notice]]:
    """Return the notices that `--messages json` printed, each with its file."""
    reported = [json.loads(line) for line in lines if line.startswith("{")]
    return [(each.pop("file"), read(each)) for each in reported]


def read(reported: dict) -> Notice:
    """Return a notice from an object of `--messages json` or of a JSON report."""
    sentence = reported["sentence"].removesuffix(f"; {reported['advice']}")
    return Notice(**(reported | {"sentence": sentence}))
