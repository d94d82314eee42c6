"""The robot's side of the table: how high, how fast and how far it may go. Read from a TOML file."""

from __future__ import annotations

import math
import os
import tomllib
from dataclasses import dataclass, fields
from pathlib import Path

from .errors import Error
from .files import find_file, names_in, read_bytes


@dataclass(frozen=True)
class Cell:
    """A machine and its limits; its frame is the paper frame. Lengths in mm, speeds in mm/s."""

    name: str
    description: str
    language: str
    safe_height_mm: float
    clearance_mm: float
    z_range_mm: tuple[float, float]
    workspace_margin_mm: float
    travel_mm_s: float
    approach_mm_s: float
    press_mm_s: float
    max_paint_mm_s: float
    path_tolerance_mm: float
    decimals: int


SHIPPED = Path(__file__).parent / "data" / "cells"
DEFAULT_CELL = "linuxcnc-3axis"


def cell_names() -> list[str]:
    """Names of the cells that come with the package, in alphabetical order."""
    return names_in(SHIPPED, ".toml")


def find_cell(name_or_path: str | os.PathLike = DEFAULT_CELL) -> Cell:
    """The shipped cell of a name, or the cell in a .toml file.

    Error for an unknown name, a file that cannot be read and a cell that is refused; the latter two have the
    file in `file`, the last the key in `where`.
    """
    path = find_file("cell", SHIPPED, ".toml", name_or_path)
    data = read_bytes(path)
    try:
        return read_cell(data.decode("utf-8"))
    except UnicodeDecodeError:
        raise Error("the file is not a cell: it is not text in UTF-8", file=str(path)) from None
    except Error as refusal:
        refusal.file = str(path)
        raise


def read_cell(text: str) -> Cell:
    """The cell that a TOML text describes. Error naming the key that is missing, unknown or out of range."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        raise Error(f"the cell file is not TOML: {problem}") from None
    known = {field.name: field.type for field in fields(Cell)}
    for key in table:
        if key not in known:
            raise Error(f"a cell has no key {key}", where=key)
    for key in known:
        if key not in table:
            raise Error(f"the cell file lacks the key {key}", where=key)
    cell = Cell(**{key: _value(key, kind, table[key]) for key, kind in known.items()})
    _check(cell)
    return cell


def _value(key: str, kind: str, value):
    if kind == "str" and isinstance(value, str):
        return value
    if kind == "int" and isinstance(value, int) and not isinstance(value, bool):
        return value
    if kind == "float" and _is_number(value):
        return float(value)
    if (
        kind.startswith("tuple")
        and isinstance(value, list)
        and [_is_number(v) for v in value] == [True, True]
    ):
        return (float(value[0]), float(value[1]))
    wanted = {"str": "a text", "int": "a whole number", "float": "a finite number"}.get(kind, "two numbers")
    raise Error(f"{key} must be {wanted}, not {value!r}", where=key)


def _is_number(value) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _check(cell: Cell) -> None:
    lowest, highest = cell.z_range_mm
    if not lowest < 0 < highest:
        raise Error(f"z_range_mm [{lowest}, {highest}] must hold the paper at 0", where="z_range_mm")
    if not 0 < cell.clearance_mm <= cell.safe_height_mm <= highest:
        raise Error(
            f"clearance_mm {cell.clearance_mm} and safe_height_mm {cell.safe_height_mm} must ascend "
            f"within (0, {highest}] mm",
            where="safe_height_mm",
        )
    for key, least, greatest in (
        ("travel_mm_s", 0.01, 10_000),
        ("approach_mm_s", 0.01, 10_000),
        ("press_mm_s", 0.01, 10_000),
        ("max_paint_mm_s", 0.01, 10_000),
        ("path_tolerance_mm", 0.0001, 10),
        ("workspace_margin_mm", 0, 10_000),
        ("safe_height_mm", 0, 10_000),
    ):
        value = getattr(cell, key)
        if not least <= value <= greatest:
            raise Error(f"{key} {value} is outside the range [{least}, {greatest}]", where=key)
    for key in ("name", "description", "language"):
        if not getattr(cell, key).isprintable() or not getattr(cell, key):
            raise Error(f"{key} must be one line of text", where=key)
    if not 1 <= cell.decimals <= 6:
        raise Error(f"decimals {cell.decimals} is outside the range [1, 6]", where="decimals")
