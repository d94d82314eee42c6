"""What tests ask of warnings and refusals: the code, and the numbers and names in the sentence, but not its words."""

import json
import re
import shlex
from contextlib import contextmanager

import pytest

from brushsvg.cli import main
from brushsvg.errors import Error, Notice


def agrees(told: Error | Notice, expected: str) -> bool:
    """expected: a code, then numbers and names that the element or the sentence gives, each as a whole word; with
    blanks in it, in quotes."""
    code, *parts = shlex.split(expected)
    text = f"{told.where}: {told if isinstance(told, Error) else told.told}"
    return told.code == code and all(_stands_in(part, text) for part in parts)


def _stands_in(part: str, text: str) -> bool:
    before = r"(?<![\w.-])" if part[0].isalnum() else ""
    after = r"(?!\w|\.\d)" if part[-1].isalnum() else ""
    return re.search(before + re.escape(part) + after, text) is not None


@contextmanager
def refused(expected: str, where: str | None = None):
    """For a refusal that agrees, of this element if that is given."""
    with pytest.raises(Error) as caught:
        yield caught
    told = caught.value
    assert agrees(told, expected), (expected, told.code, told.where, str(told))
    assert where is None or told.where == where


def in_json(capsys, *words) -> tuple[int, str, list[tuple[str, Notice]]]:
    """Exit status, standard output, and what was told with the file that it is about."""
    status = main(["--messages", "json", *map(str, words)])
    output, errors = capsys.readouterr()
    told = [json.loads(line) for line in errors.splitlines() if line.startswith("{")]
    return status, output, [(each.pop("file"), _notice(each)) for each in told]


def _notice(told: dict) -> Notice:
    sentence = told["sentence"].removesuffix(f"; {told['advice']}")
    return Notice(**(told | {"sentence": sentence}))
