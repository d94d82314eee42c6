"""Drawings in, Design out: one format per file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ..design import Design
from ..errors import Error
from .svg import read_svg

READERS = {".svg": read_svg}  # by extension; each takes (bytes, sheet_mm or None)


def read_drawing(path: str | Path, sheet_mm: tuple[float, float] | None = None) -> Design:
    """The drawing in a file, its format chosen by extension; sheet_mm (w, h) replaces the drawing's own.

    Error if the file cannot be read, is of no known format, or has nothing to paint.
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        known = ", ".join(READERS)
        raise Error(f"{path.suffix or 'no extension'} is not a drawing format that is read; known: {known}")
    if not path.exists():
        raise Error("there is no such file")
    if path.is_dir():
        raise Error("this is a directory, not a drawing")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise Error(f"the file cannot be read: {error.strerror}") from None
    design = reader(data, sheet_mm)
    return design if design.title else replace(design, title=path.stem)
