"""Brush files: those that come with brushsvg, a user's own, and writing them."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from .. import _core
from ..errors import Error, need
from ..files import find_file, names_in, read_bytes, write_files

SHIPPED = Path(__file__).parents[1] / "data" / "brushes"


def brush_names() -> list[str]:
    """Names of the brushes that come with brushsvg, in alphabetical order."""
    return names_in(SHIPPED, ".json")


def find_brush(name_or_path: str | os.PathLike) -> _core.Brush:
    """The shipped brush of a name, or the brush in a .json file; read, checked, with the sha256 of its bytes.

    Raises Error for an unknown name, a file that cannot be read and a brush that is refused; the latter two
    have the file in `file`, the last the key in `where`.
    """
    path = find_file("brush", SHIPPED, ".json", name_or_path)
    try:
        return parse_brush(read_bytes(path))
    except Error as refusal:
        refusal.file = str(path)
        raise


def parse_brush(data: bytes) -> _core.Brush:
    """The brush that a file holds, read, checked, with its sha256."""
    brush = _core.read_brush(data)
    _core.check(brush)
    brush.sha256 = hashlib.sha256(data).hexdigest()
    return brush


def save_brush(brush: _core.Brush, path: str | os.PathLike) -> None:
    """Write a brush as .json, whole or not at all.

    path: ends in .json. Raises Error when the brush is refused or the place cannot be written.
    """
    need(brush, _core.Brush, "a brush")
    need(path, (str, os.PathLike), "a path")
    if Path(path).suffix.lower() != ".json":
        raise Error(f"{str(path)[:80]!r} does not end in .json, as brush files do", code="brush-format")
    _core.check(brush)
    write_files({path: _core.write_brush(brush)})
