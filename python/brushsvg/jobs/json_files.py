"""plan.json and marks.json as files; what stands in them is read by the core."""

from __future__ import annotations

import os

from .. import _core
from ..errors import Error
from ..files import read_bytes


def read_plan(path: str | os.PathLike[str]) -> _core.Plan:
    """The plan in a plan.json. path: of the file; a text that begins with "{" is what would stand in it. Error, with
    the path in `file` and the key in `where`, when it cannot be read."""
    return _read_json_file(_core.read_plan, "a plan", path)


def read_marks(path: str | os.PathLike[str]) -> _core.Marks:
    """The marks in a marks.json, given and refused as a plan is."""
    return _read_json_file(_core.read_marks, "marks", path)


def _read_json_file(parse, what: str, path: str | os.PathLike[str]):
    if isinstance(path, str) and path.lstrip().startswith("{"):
        return parse(path)
    try:
        return parse(read_bytes(path).decode("utf-8"))
    except UnicodeDecodeError:
        raise Error(
            f"the file is not {what}: it is not text in UTF-8", file=os.fspath(path), code="not-json"
        ) from None
    except Error as refusal:
        refusal.file = os.fspath(path)
        raise
