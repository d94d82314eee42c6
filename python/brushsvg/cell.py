"""The robot's side of the table: how high, how fast and how far it may go. Read from a TOML file."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, fields
from importlib.resources import files

from .errors import Error


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


def load_cell(name: str = "linuxcnc-3axis") -> Cell:
    """A cell that comes with the package. Error when there is none of that name or its file is not sound."""
    file = files("brushsvg") / "data" / "cells" / f"{name}.toml"
    if not file.is_file():
        raise Error(f"there is no cell named {name}", where="cell")
    return read_cell(file.read_text(encoding="utf-8"))


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
    for key in ("travel_mm_s", "approach_mm_s", "press_mm_s", "max_paint_mm_s", "path_tolerance_mm"):
        if getattr(cell, key) <= 0:
            raise Error(f"{key} {getattr(cell, key)} must be above 0", where=key)
    if cell.workspace_margin_mm < 0:
        key = "workspace_margin_mm"
        raise Error(f"{key} {cell.workspace_margin_mm} must not be negative", where=key)
    if not 1 <= cell.decimals <= 6:
        raise Error(f"decimals {cell.decimals} is outside the range [1, 6]", where="decimals")
