"""Drawings in, Design out: one format per file. READERS names them all."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ..errors import Error
from ..files import read_bytes

if TYPE_CHECKING:
    from ..design import Design


def _svg(data: bytes, sheet_mm: tuple[float, float] | None) -> Design:
    from .svg import read_svg  # loaded for who reads, not for who only asks what can be read

    return read_svg(data, sheet_mm)


READERS = {".svg": _svg}  # by extension; each takes (bytes, sheet_mm or None)


def read_drawing(path: str | os.PathLike, sheet_mm: tuple[float, float] | None = None) -> Design:
    """The drawing in a file, its format chosen by extension; sheet_mm (w, h) replaces the drawing's own.

    Error if the file cannot be read, is of no known format, or has nothing to paint.
    """
    extension = os.path.splitext(path)[1]
    reader = READERS.get(extension.lower())
    if reader is None:
        known = ", ".join(READERS)
        raise Error(f"{extension or 'no extension'} is not a drawing format that is read; known: {known}")
    return reader(read_bytes(path), sheet_mm)
