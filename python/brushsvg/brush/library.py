"""Brush files: those that come with brushsvg, a user's own, and writing them."""

from __future__ import annotations

import copy
import hashlib
import json
import os
from pathlib import Path

from .. import _core
from ..errors import Error, need
from ..files import find_file, names_in, read_bytes, write_files

SHIPPED = Path(__file__).parents[1] / "data" / "brushes"


def brush_names() -> list[str]:
    """Names of the brushes that come with brushsvg, in alphabetical order."""
    return names_in(SHIPPED, ".json")


def find_brush(name_or_path: str | os.PathLike[str]) -> _core.Brush:
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


def brush_like(name: str, like: _core.Brush) -> _core.Brush:
    """A brush of another name with the laws and outlines of one that is known, all of them marked as assumed: nobody
    measured this one, and how sure the other's numbers are says nothing of it.

    like: a Brush [mm], which stays as it is. Raises Error where it is refused.
    """
    need(name, str, "the name of a brush")
    need(like, _core.Brush, "a brush")
    _core.check(like)
    brush = copy.copy(like)
    brush.name, brush.sha256, brush.covariance = name, "", []
    for law in ("lag", "tip_gap", "tip_to_widest", "half_width"):
        its = getattr(like, law)
        taken = _core.Profile(
            its.coefficients,
            floor=its.floor,
            floor_slope=its.floor_slope,
            calibrated_mm=its.calibrated_mm,
            source=f"Taken from brush {like.name}: {its.source}",
            assumed=True,
        )
        setattr(brush, law, taken)
    said = json.loads(like.extra)
    outlines = said.get("footprints") if isinstance(said.get("footprints"), dict) else {}
    outlines = {key: value for key, value in outlines.items() if key != "standard_error_mm"}
    source = f"Taken from brush {like.name}: {outlines.get('source', '')}".strip()
    said["footprints"] = outlines | {"source": source, "assumed": True}
    said["about"] = f"Like {like.name}, until it is measured."
    brush.extra = json.dumps(said)
    return brush


def save_brush(brush: _core.Brush, path: str | os.PathLike[str]) -> None:
    """Write a brush as .json, whole or not at all.

    path: ends in .json. Raises Error when the brush is refused or the place cannot be written.
    """
    need(brush, _core.Brush, "a brush")
    need(path, (str, os.PathLike), "a path")
    if Path(path).suffix.lower() != ".json":
        raise Error(f"{str(path)[:80]!r} does not end in .json, as brush files do", code="brush-format")
    _core.check(brush)
    write_files({path: _core.write_brush(brush)})
