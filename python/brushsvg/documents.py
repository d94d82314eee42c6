"""plan.json and marks.json as files; what stands in them is read and written by the core."""

from __future__ import annotations

import os

from . import _core
from .errors import Error
from .files import read_bytes, write_files


def read_plan(path: str | os.PathLike) -> _core.Plan:
    """The plan in a plan.json. Error, with the path in `file` and the key in `where`, when it cannot be read."""
    return _read(_core.read_plan, "a plan", path)


def read_marks(path: str | os.PathLike) -> _core.Marks:
    """The marks in a marks.json. Error, with the path in `file` and the key in `where`, when they cannot be read."""
    return _read(_core.read_marks, "marks", path)


def write_plan(path: str | os.PathLike, plan: _core.Plan) -> None:
    """Write a plan.json, whole or not at all. Error when the place cannot be written."""
    write_files({path: _core.write_plan(plan)})


def write_marks(path: str | os.PathLike, marks: _core.Marks) -> None:
    """Write a marks.json, whole or not at all. Error when the place cannot be written."""
    write_files({path: _core.write_marks(marks)})


def _read(parse, what: str, path: str | os.PathLike):
    try:
        return parse(read_bytes(path).decode("utf-8"))
    except UnicodeDecodeError:
        raise Error(f"the file is not {what}: it is not text in UTF-8", file=os.fspath(path)) from None
    except Error as refusal:
        refusal.file = os.fspath(path)
        raise
