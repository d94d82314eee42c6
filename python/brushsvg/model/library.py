"""Brush files: shipped ones, a user's own, and writing them."""

from __future__ import annotations

import copy
import hashlib
import json
import os
from pathlib import Path

from .. import _core
from ..errors import Error, name_file_in_errors, require_type
from ..files import find_file, names_in, read_bytes, write_files
from .confidence import LAWS, LEARNED
from .extra_keys import read_extra_keys

SHIPPED = Path(__file__).parents[1] / "data" / "brushes"


def brush_names() -> list[str]:
    """Return the names of the shipped brushes in alphabetical order."""
    return names_in(SHIPPED, ".json")


def find_brush(name_or_path: str | os.PathLike[str]) -> _core.Brush:
    """Return the shipped brush of a name, or the brush in a .json file.

    The brush is read and checked, and has the sha256 of its bytes. Raises Error for an unknown name, a file that
    cannot be read and a brush that is refused. The latter two have the file in `file`, the last the key in `where`.
    """
    path = find_file("brush", SHIPPED, ".json", name_or_path)
    with name_file_in_errors(path):
        return parse_brush(read_bytes(path))


def parse_brush(data: bytes) -> _core.Brush:
    """Return the brush that a file holds, checked and with its sha256."""
    brush = _core.read_brush(data)
    _core.check(brush)
    brush.sha256 = hashlib.sha256(data).hexdigest()
    return brush


def brush_like(name: str, like: _core.Brush) -> _core.Brush:
    """Return a brush of another name with the laws and outlines of a known one.

    All laws and outlines are marked as assumed: nobody measured this brush, and the confidence in the other one's
    numbers does not apply to it. like: a Brush [mm], which stays as it is. Raises Error where it is refused.
    """
    require_type(name, str, "the name of a brush")
    require_type(like, _core.Brush, "a brush")
    _core.check(like)
    brush = copy.copy(like)
    brush.name, brush.sha256, brush.covariance = name, "", []
    for law in LAWS:
        known = getattr(like, law)
        assumed_law = _core.Profile(
            known.coefficients,
            floor=known.floor,
            floor_slope=known.floor_slope,
            calibrated_mm=known.calibrated_mm,
            source=f"Taken from brush {like.name}: {known.source}",
            assumed=True,
        )
        setattr(brush, law, assumed_law)
    if like.paint:
        known = like.paint
        brush.paint = _core.Paint(
            known.narrows_per_m,
            lasts_mm=known.lasts_mm,
            calibrated_mm=known.calibrated_mm,
            source=f"Taken from brush {like.name}: {known.source}",
            assumed=True,
        )
    entries = read_extra_keys(like.extra)
    entries.pop(LEARNED, None)  # the new brush learned from no photograph
    outlines = entries.get("footprints") if isinstance(entries.get("footprints"), dict) else {}
    outlines = {key: value for key, value in outlines.items() if key != "standard_error_mm"}
    source = f"Taken from brush {like.name}: {outlines.get('source', '')}".strip()
    entries["footprints"] = outlines | {"source": source, "assumed": True}
    entries["about"] = f"Like {like.name}, until it is measured."
    brush.extra = json.dumps(entries)
    return brush


def save_brush(brush: _core.Brush, path: str | os.PathLike[str]) -> None:
    """Write a brush as .json, completely or not at all.

    path: ends in .json. Raises Error when the brush is refused or the place cannot be written.
    """
    require_type(brush, _core.Brush, "a brush")
    require_type(path, (str, os.PathLike), "a path")
    if Path(path).suffix.lower() != ".json":
        raise Error(f"{str(path)[:80]!r} must end in .json, like all brush files", code="brush-format")
    _core.check(brush)
    write_files({path: _core.write_brush(brush)})
