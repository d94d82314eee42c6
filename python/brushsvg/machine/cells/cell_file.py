"""Cells as TOML files: find, read, check and write them."""

from __future__ import annotations

import json
import math
import os
import textwrap
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

from ...errors import Error, as_listed, format_value, name_file_in_errors, require_type
from ...files import decode_text, find_file, names_in, read_bytes, toml_document
from ...suggestions import did_you_mean
from .cell import OPTIONAL_TABLES, TABLES, Cell, Entry, Station, entries_of, required_keys_of, tables_of
from .cell_check import check

SHIPPED = Path(__file__).parents[2] / "data" / "cells"
DEFAULT_CELL = "linuxcnc-3axis"
FORMAT, VERSION = "brushsvg/cell", 1


def cell_names() -> list[str]:
    """Return the names of the shipped cells in alphabetical order."""
    return names_in(SHIPPED, ".toml")


def own_name(name: str) -> str:
    """Return a name for a user's own cell that is not the name of a shipped cell.

    Programs contain the name of their cell, and would otherwise be taken for programs of the shipped cell.
    """
    return f"my-{name}" if name in cell_names() else name


def find_cell(name_or_path: str | os.PathLike[str] = DEFAULT_CELL) -> Cell:
    """Return the shipped cell with a name, or the cell in a .toml file.

    Raises Error for an unknown name, a file that cannot be read, and a cell that is refused. For the last two, `file`
    is the path of the file. For a refused cell, `where` is the key.
    """
    return read_cell(find_file("cell", SHIPPED, ".toml", name_or_path))


def read_cell(path: str | os.PathLike[str]) -> Cell:
    """Read the cell in a cell.toml.

    Raises Error if the cell is refused, with the path in `file` and the key in `where`.
    """
    text = decode_text(read_bytes(path), "a cell", "not-toml", os.fspath(path))
    with name_file_in_errors(path):
        return parse_cell(text)


def parse_cell(text: str) -> Cell:
    """Parse the TOML text of a cell.

    Raises Error that names the key if a key is missing, unknown or out of range.
    """
    document = toml_document(text, "cell", VERSION)
    parts = {name: document.pop(name) for name in TABLES if name in document}
    stations = document.pop("stations", [])
    if not isinstance(stations, list):
        raise Error("stations are written as [[stations]]", where="stations", code="wrong-type")
    own_values = _read_table(Cell, document, "", [*TABLES, "stations"])
    for name in TABLES:
        if name not in parts and name not in OPTIONAL_TABLES:
            raise Error("the cell file has no such table, but needs it", where=name, code="key-missing")
    cell = Cell(
        **own_values,
        **{name: TABLES[name](**_read_table(TABLES[name], part, name)) for name, part in parts.items()},
        stations=tuple(
            Station(**_read_table(Station, part, f"station {number}")) for number, part in enumerate(stations, 1)
        ),
    )
    check(cell)
    return cell


def write_cell(cell: Cell) -> str:
    """Return the cell as TOML for read_cell, each key with an explanation.

    Numbers are not checked. read_cell, convert and write_program refuse a cell that is not valid.
    """
    require_type(cell, Cell, "a cell")
    lines = [f"format = {json.dumps(FORMAT)}", f"version = {VERSION}", "", *_table_lines(cell)]
    for name, table in tables_of(cell).items():
        lines += ["", *_comment_lines(type(table).__doc__), f"[{name}]", *_table_lines(table)]
    for station in cell.stations:
        lines += ["", *_comment_lines(Station.__doc__), "[[stations]]", *_table_lines(station)]
    return "\n".join([*lines, ""])


MAX_ROWS = 1000  # largest number of rows of one key; no servo table and no workshop needs more


def _read_table(table, values, where: str, other_names: Sequence[str] = ()) -> dict:
    """Read the keys of a table; other_names: further names that the file may have there."""
    entries_by_key = entries_of(table)
    prefix = f"{where}." if where else ""
    if not isinstance(values, dict):
        raise Error("this must be a table", where=where, code="wrong-type")
    for key in values:
        if key not in entries_by_key:
            known = [*entries_by_key, *other_names]
            sentence = f"a cell has no such name{did_you_mean(key, known)} Known here are {', '.join(known)}"
            raise Error(sentence, where=prefix + key, code="key-unknown")
    for key in required_keys_of(table):
        if key not in values:
            raise Error("the cell file has no such key, but needs it", where=prefix + key, code="key-missing")
    return {key: _read_value(entries_by_key[key], value, prefix + key) for key, value in values.items()}


def _read_value(entry: Entry, value, where: str):
    if entry.kind == "text":
        return _read_text(value, where)
    if entry.kind == "texts":
        if not isinstance(value, list):
            raise Error(f"this must be a list of texts, not {str(value)[:40]}", where=where, code="wrong-type")
        return tuple(_read_text(item, where) for item in value)
    if entry.kind == "yes":
        if not isinstance(value, bool):
            raise Error(f"this must be true or false, not {str(value)[:40]}", where=where, code="wrong-type")
        return value
    if entry.kind in ("number", "whole"):
        return _read_number(entry, value, where)
    return _read_rows(entry, entry.kind, value, where)


def _read_text(value, where: str) -> str:
    if not isinstance(value, str) or not value.isprintable() or not value or len(value) > 200:
        raise Error("this must be one line of text", where=where, code="wrong-type")
    return value


def _read_number(entry: Entry, value, where: str):
    types = int if entry.kind == "whole" else int | float
    if isinstance(value, bool) or not isinstance(value, types) or value != value or abs(value) == math.inf:
        expected = "a whole number" if entry.kind == "whole" else "a finite number"
        raise Error(f"this must be {expected}, not {value!r:.40}", where=where, code="wrong-type")
    if not entry.least <= value <= entry.greatest:
        sentence = f"{format_value(value)} is outside the range [{entry.least:g}, {entry.greatest:g}]"
        raise Error(sentence, where=where, code="out-of-range")
    return value if entry.kind == "whole" else float(value)


def _read_rows(entry: Entry, shape: tuple, value, where: str) -> tuple:
    count = shape[0]
    if isinstance(value, list) and len(value) > MAX_ROWS:
        sentence = f"{len(value)} rows are more than {MAX_ROWS}"
        raise Error(sentence, where=where, code="out-of-range")
    if not isinstance(value, list) or (count is not None and len(value) != count):
        sentence = f"this must be {_shape_in_words(shape)}, not {value!r:.40}"
        raise Error(sentence, where=where, code="wrong-type")
    if len(shape) == 1:
        return tuple(_read_number(entry, item, where) for item in value)
    rows = enumerate(value)
    return tuple(_read_rows(entry, shape[1:], item, f"{where}[{number}]") for number, item in rows)


def _shape_in_words(shape: tuple) -> str:
    """Describe a shape in words; for example, (None, 2, 3) is a list of rows of 2 rows of 3 numbers."""
    if len(shape) == 1:
        return "a list of numbers" if shape[0] is None else f"{shape[0]} numbers"
    inner = _shape_in_words(shape[1:])
    return f"a list of rows of {inner}" if shape[0] is None else f"{shape[0]} rows of {inner}"


def _table_lines(table) -> list[str]:
    """Return the keys of a table as TOML lines. Keys with their default value are left out."""
    lines = []
    for item in fields(table):
        entry = item.metadata.get("entry")
        value = _without_numpy(getattr(table, item.name))
        if entry is None or value == item.default:
            continue
        text = f"{item.name} = {_to_toml(value)}"
        if len(text) + len(entry.help) <= 110:
            lines.append(f"{text}  # {entry.help}")
        else:
            lines += [*_comment_lines(entry.help), text]
    return lines


def _without_numpy(value):
    """Return the numbers and arrays of numpy, also within tuples and lists, as Python's numbers and tuples."""
    value = as_listed(value)
    return tuple(map(_without_numpy, value)) if isinstance(value, (tuple, list)) else value


def _comment_lines(text: str) -> list[str]:
    one_line = " ".join(text.split())  # a docstring of two lines has an indent in it
    return textwrap.wrap(one_line, 108, initial_indent="# ", subsequent_indent="# ")


def _to_toml(value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "[" + ", ".join(map(_to_toml, value)) + "]"
    # the escapes of JSON are valid in TOML, except those of characters beyond 16 bits
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else repr(value)
