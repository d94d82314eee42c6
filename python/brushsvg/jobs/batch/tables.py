"""The figures of a batch as one table, a row for each drawing."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import asdict, fields

from ...errors import lacking
from .manifest import Row
from .one import Figures

FIGURES = tuple(field.name for field in fields(Figures))
WORDS = ("name", "source", "code", "where", "sentence")


def columns(rows: Iterable[Row]) -> dict[str, list]:
    """Values by the names of columns; None where a drawing was refused. Lengths and times to 1e-6."""
    rows = list(rows)
    found: dict[str, list] = {name: [getattr(row, name) for row in rows] for name in WORDS[:2]}
    said = [asdict(row.figures) if row.figures else {} for row in rows]
    for name in FIGURES:
        values = [each.get(name) for each in said]
        found[name] = [round(value, 6) if isinstance(value, float) else value for value in values]
    return found | {name: [getattr(row, name) for row in rows] for name in WORDS[2:]}


def as_csv(rows: Iterable[Row]) -> str:
    found = columns(rows)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(found)
    writer.writerows(zip(*found.values(), strict=True))
    return text.getvalue()


def need_parquet() -> None:
    """Error where the library that writes Parquet is not installed."""
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise lacking("Parquet needs", "pyarrow") from None


def as_parquet(rows: Iterable[Row]) -> bytes:
    import pyarrow
    from pyarrow import parquet

    whole = ("strokes", "poses", "widths_out_of_reach", "warnings")
    kinds = {name: pyarrow.int64() if name in whole else pyarrow.float64() for name in FIGURES}
    schema = pyarrow.schema((name, kinds.get(name, pyarrow.string())) for name in columns([]))
    stream = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(columns(rows), schema=schema), stream)
    return stream.getvalue().to_pybytes()
