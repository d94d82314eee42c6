"""Read plan.json and marks.json. The core parses their contents."""

from __future__ import annotations

import os

from .. import _core
from ..errors import name_file_in_errors
from ..files import decode_text, read_bytes


def read_plan(path: str | bytes | os.PathLike[str]) -> _core.Plan:
    """Read the plan in a plan.json.

    path: the path of the file, its bytes, or its text, which begins with "{".

    Raises Error, with the path in `file` and the key in `where`, if it cannot be read.
    """
    return _read_json_file(_core.read_plan, "a plan", path)


def read_marks(path: str | bytes | os.PathLike[str]) -> _core.Marks:
    """Read the marks in a marks.json. Path and errors are as for read_plan."""
    return _read_json_file(_core.read_marks, "marks", path)


def _read_json_file(parse, contents_name: str, path: str | bytes | os.PathLike[str]):
    if isinstance(path, bytes):
        return parse(decode_text(path, contents_name, "not-json"))
    if isinstance(path, str) and path.lstrip().startswith("{"):
        return parse(path)
    text = decode_text(read_bytes(path), contents_name, "not-json", os.fspath(path))
    with name_file_in_errors(path):
        return parse(text)
