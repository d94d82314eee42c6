"""Read plan.json and marks.json. The core parses their contents."""

from __future__ import annotations

import os

from .. import _core
from ..errors import Error
from ..files import read_bytes


def read_plan(path: str | os.PathLike[str]) -> _core.Plan:
    """Read the plan in a plan.json.

    path: the path of the file, or its text, which begins with "{".

    Raises Error, with the path in `file` and the key in `where`, if it cannot be read.
    """
    return _read_json_file(_core.read_plan, "a plan", path)


def read_marks(path: str | os.PathLike[str]) -> _core.Marks:
    """Read the marks in a marks.json. Path and errors are as for read_plan."""
    return _read_json_file(_core.read_marks, "marks", path)


def _read_json_file(parse, contents_name: str, path: str | os.PathLike[str]):
    if isinstance(path, str) and path.lstrip().startswith("{"):
        return parse(path)
    try:
        return parse(read_bytes(path).decode("utf-8"))
    except UnicodeDecodeError:
        raise Error(
            f"the file is not {contents_name}: it is not text in UTF-8", file=os.fspath(path), code="not-json"
        ) from None
    except Error as refusal:
        refusal.file = os.fspath(path)
        raise
