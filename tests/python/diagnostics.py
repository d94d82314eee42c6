"""What tests ask of warnings and refusals: the code, and the numbers and names in the sentence, but not its words."""

import json
import re
import shlex
from contextlib import contextmanager

import pytest

from brushsvg.cli import main
from brushsvg.errors import Error, Notice


def agrees(reported: Error | Notice, expected: str, where: str | None = None) -> bool:
    """expected: a code, then numbers and names that the element or the sentence gives, each as a whole word; with
    blanks in it, in quotes. where: the element it must be about."""
    code, *parts = shlex.split(expected)
    text = f"{reported.where}: {reported if isinstance(reported, Error) else reported.text}"
    return (
        reported.code == code
        and where in (None, reported.where)
        and all(_found(part, text) for part in parts)
    )


def is_reported(reported, expected: str, where: str | None = None) -> bool:
    """Whether one of these agrees; reported: notices, with their files as in_json gives them or without."""
    notices = (each[1] if isinstance(each, tuple) else each for each in reported)
    return any(agrees(each, expected, where) for each in notices)


def are_reported(reported, *expected: str) -> bool:
    """Whether it is these, in this order, and nothing else."""
    return len(reported) == len(expected) and all(map(agrees, reported, expected))


def gives(text: str, *parts: str) -> bool:
    """Whether a text gives these numbers and names in this order, each as a whole word; its words may be any."""
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
    """For a refusal that agrees, of this element if that is given."""
    with pytest.raises(Error) as caught:
        yield caught
    reported = caught.value
    assert agrees(reported, expected, where), (expected, reported.code, reported.where, str(reported))


def in_json(capsys, *words) -> tuple[int, str, list[tuple[str, Notice]]]:
    """Exit status, standard output, and what was reported with the file that it is about."""
    status = main(["--messages", "json", *map(str, words)])
    output, errors = capsys.readouterr()
    return status, output, heard(errors.splitlines())


def heard(lines) -> list[tuple[str, Notice]]:
    """What `--messages json` reported in these lines, each with the file that it is about."""
    reported = [json.loads(line) for line in lines if line.startswith("{")]
    return [(each.pop("file"), read(each)) for each in reported]


def read(reported: dict) -> Notice:
    """A notice of `--messages json`, or of a report in JSON."""
    sentence = reported["sentence"].removesuffix(f"; {reported['advice']}")
    return Notice(**(reported | {"sentence": sentence}))
