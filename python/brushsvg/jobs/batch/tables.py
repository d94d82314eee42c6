"""The figures of a batch as one table, a row for each drawing."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import asdict, fields

from ...errors import lacking
from .manifest import Row
from .one import Figures

FIGURE_COLUMNS = tuple(field.name for field in fields(Figures))
TEXT_COLUMNS = ("name", "source", "code", "where", "sentence")


def make_columns(rows: Iterable[Row]) -> dict[str, list]:
    """Values by the names of columns; None where a drawing was refused. Lengths and times to 1e-6."""
    rows = list(rows)
    found: dict[str, list] = {name: [getattr(row, name) for row in rows] for name in TEXT_COLUMNS[:2]}
    said = [asdict(row.figures) if row.figures else {} for row in rows]
    for name in FIGURE_COLUMNS:
        values = [each.get(name) for each in said]
        found[name] = [round(value, 6) if isinstance(value, float) else value for value in values]
    return found | {name: [getattr(row, name) for row in rows] for name in TEXT_COLUMNS[2:]}


def format_csv(rows: Iterable[Row]) -> str:
    found = make_columns(rows)
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


def format_parquet(rows: Iterable[Row]) -> bytes:
    import pyarrow
    from pyarrow import parquet

    whole = ("strokes", "poses", "widths_out_of_reach", "warnings")
    kinds = {name: pyarrow.int64() if name in whole else pyarrow.float64() for name in FIGURE_COLUMNS}
    schema = pyarrow.schema((name, kinds.get(name, pyarrow.string())) for name in make_columns([]))
    stream = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(make_columns(rows), schema=schema), stream)
    return stream.getvalue().to_pybytes()
