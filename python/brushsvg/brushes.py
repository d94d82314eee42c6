"""Brush files: those that come with brushsvg, a user's own, and writing them."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from . import _core
from .errors import Error
from .files import read_bytes, write_files

SHIPPED = Path(__file__).parent / "data" / "brushes"


def brush_names() -> list[str]:
    """Names of the brushes that come with brushsvg, in alphabetical order."""
    return sorted(path.stem for path in SHIPPED.glob("*.json"))


def find_brush(name_or_path: str | os.PathLike) -> _core.Brush:
    """The shipped brush of a name, or the brush in a .json file; read, checked, with the sha256 of its bytes.

    Raises Error for an unknown name, a file that cannot be read and a brush that is refused; the latter two
    have the file in `file`, the last the key in `where`.
    """
    path = _path_of(name_or_path)
    data = read_bytes(path)
    try:
        brush = _core.read_brush(data)
        _core.check(brush)
    except Error as refusal:
        refusal.file = str(path)
        raise
    brush.sha256 = hashlib.sha256(data).hexdigest()
    return brush


def save_brush(brush: _core.Brush, path: str | os.PathLike) -> None:
    """Write a brush as .json, whole or not at all.

    Raises Error when the brush is refused or the place cannot be written.
    """
    _core.check(brush)
    write_files({path: _core.write_brush(brush)})


def _path_of(name_or_path: str | os.PathLike) -> Path:
    if isinstance(name_or_path, os.PathLike):
        return Path(name_or_path)
    if name_or_path in brush_names():
        return SHIPPED / f"{name_or_path}.json"
    if name_or_path.endswith(".json") or "/" in name_or_path or os.sep in name_or_path:
        return Path(name_or_path)
    known = ", ".join(brush_names())
    raise Error(f"brush {name_or_path!r} is not known; known are {known}, and any file that ends in .json")
