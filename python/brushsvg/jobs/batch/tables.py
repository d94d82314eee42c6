"""The figures of a batch as a table with one row for each drawing."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import asdict, fields

from ...errors import missing_packages_error
from .manifest import Row
from .one import Figures

FIGURE_COLUMNS = tuple(field.name for field in fields(Figures))
TEXT_COLUMNS = ("name", "source", "code", "where", "sentence")


def make_columns(rows: Iterable[Row]) -> dict[str, list]:
    """Return the values of each column, by the name of the column.

    Figures are None where a drawing was refused. Lengths and times are rounded to 1e-6.
    """
    rows = list(rows)
    columns: dict[str, list] = {name: [getattr(row, name) for row in rows] for name in TEXT_COLUMNS[:2]}
    figures = [asdict(row.figures) if row.figures else {} for row in rows]
    for name in FIGURE_COLUMNS:
        values = [each.get(name) for each in figures]
        columns[name] = [round(value, 6) if isinstance(value, float) else value for value in values]
    return columns | {name: [getattr(row, name) for row in rows] for name in TEXT_COLUMNS[2:]}


def format_csv(rows: Iterable[Row]) -> str:
    columns = make_columns(rows)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return stream.getvalue()


def need_parquet() -> None:
    """Raise Error if the library that writes Parquet is not installed."""
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise missing_packages_error("Parquet needs", "pyarrow") from None


def format_parquet(rows: Iterable[Row]) -> bytes:
    import pyarrow
    from pyarrow import parquet

    integer_columns = ("strokes", "poses", "widths_out_of_reach", "warnings")
    kinds = {name: pyarrow.int64() if name in integer_columns else pyarrow.float64() for name in FIGURE_COLUMNS}
    schema = pyarrow.schema((name, kinds.get(name, pyarrow.string())) for name in make_columns([]))
    stream = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(make_columns(rows), schema=schema), stream)
    return stream.getvalue().to_pybytes()
