"""Read measurements of a brush from JSON or a table.

The formats are described in docs/reference/measurements.md. Lengths are in mm, angles in degrees.
"""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass, field

from ... import json_fields
from ...errors import Error

FORMAT = "brushsvg/measurements"
MAX_LENGTH_MM = 1000.0  # larger lengths and depths are refused: they are hardly millimetres
SPEED_RANGE_MM_S = (0.01, 10000.0)
MAX_ANGLE_DEG = 360.0
MIN_GREATEST_DEPTH_MM = 0.2  # if no depth is greater, the depths are hardly millimetres
# Kind -> the numbers of one row in addition to depth_mm. Kinds with value_mm alone can also be given in a table.
KINDS = {
    "lag": ("value_mm",),
    "tip_gap": ("value_mm",),
    "tip_to_widest": ("value_mm",),
    "half_width": ("value_mm",),
    "width": ("value_mm",),
    "angular": ("value_mm",),
    "side_view": ("value_mm",),
    "straight": ("path_mm", "distance_mm"),
    "angles": ("alpha0_deg",),
    "centre_line": (),
    "video": (),
}
_ANGLE_SERIES_KEYS = ("s_mm", "alpha_deg", "beta_deg")
_CENTRE_LINE_KEYS = ("points_mm", "picture", "mm_per_px", "corner_px", "towards")
TOWARDS = ("right", "left", "up", "down")
MIN_LINE_POINTS = 6  # points of a centre line, which determine two lengths
_TABLE_KINDS = tuple(kind for kind, names in KINDS.items() if names == ("value_mm",))
_GENERAL_KEYS = ("format", "version", "name", "depth_range_mm", "max_speed_mm_s", "about", *KINDS)
_MARK_KEYS = ("plan", "marks", "expected")  # keys of whole painted marks: see mark_input.read_painted
# Expected errors of a sheet and its marks, as standard deviations that a person can estimate.
EXPECTED_KEYS = ("placement_mm", "turn_deg", "displacement_mm", "height_mm")


@dataclass(frozen=True)
class Row:
    """One measurement at a depth.

    where: its place in the file, for messages. numbers: the numbers by key; a series is a tuple.
    """

    kind: str
    where: str
    depth_mm: float
    numbers: dict


@dataclass(frozen=True)
class Measurements:
    """The contents of a measurement file.

    rows: by kind. name, depth_range_mm, max_speed_mm_s: if the file gives them.
    """

    rows: dict[str, list[Row]]
    name: str = ""
    depth_range_mm: tuple[float, float] | None = None
    max_speed_mm_s: float = 25.0
    depths_mm: list[float] = field(default_factory=list)
    plan: str | dict | None = None  # plan of the marks: a path, or the contents of a plan.json
    marks: str | list | None = None
    expected: dict = field(default_factory=dict)


def read_measurements(data: bytes, suffix: str) -> Measurements:
    """Read a measurement file.

    data: the bytes of the file. suffix: .json or .csv. Raises Error, which names the row or key.
    """
    text = data.decode("utf-8-sig", "replace")
    measurements = _read_table(text) if suffix == ".csv" else _read_json(text)
    if measurements.marks is not None:
        return measurements
    depths = sorted({row.depth_mm for rows in measurements.rows.values() for row in rows})
    if not depths:
        sentence = "the file has no measurements: add rows of lag and of width, at two depths or more, better five"
        raise Error(sentence, code="measurement-missing")
    if depths[-1] <= MIN_GREATEST_DEPTH_MM:
        sentence = f"the greatest depth is only {depths[-1]:g} mm: write depths and values in millimetres"
        raise Error(sentence, "depth_mm", code="depth-out-of-range")
    measurements.depths_mm.extend(depths)
    return measurements


def read_widths(text: str) -> list[tuple[float, float]]:
    """Read (depth, width) pairs [mm] from a table.

    Its columns are depth_mm and width_mm.

    Raises Error, which names the line.
    """
    pairs = []
    for where, row in _read_table_rows(text, ("depth_mm", "width_mm"), numbers=("depth_mm", "width_mm")):
        for name, value in row.items():
            if not 0 < value <= MAX_LENGTH_MM:
                sentence = f"{value:g} mm is outside the range (0, {MAX_LENGTH_MM:g}] mm"
                raise Error(sentence, f"{where}, {name}", value, code="out-of-range")
        pairs.append((row["depth_mm"], row["width_mm"]))
    return pairs


def _read_table(text: str) -> Measurements:
    rows: dict[str, list[Row]] = {}
    for where, row in _read_table_rows(text, ("kind", "depth_mm", "value_mm"), numbers=("depth_mm", "value_mm")):
        kind = row.pop("kind")
        if kind not in _TABLE_KINDS:
            other = "; it has several numbers per row: write a JSON file" if kind in KINDS or kind in _READERS else ""
            sentence = f"{kind!r} is not a kind of measurement for a table; known: {', '.join(_TABLE_KINDS)}{other}"
            raise Error(sentence, where, code="measurement-kind")
        rows.setdefault(kind, []).extend(_read_row(kind, row, where))
    return Measurements(rows)


def _read_table_rows(
    text: str, columns: tuple[str, ...], numbers: tuple[str, ...]
) -> list[tuple[str, dict[str, str | float]]]:
    """Read the given columns of a table as (line, cells by column).

    numbers: the columns that are converted to numbers. The first line of the table names its columns. Cells are
    separated by commas, semicolons or tabs; numbers have decimal points or commas. Raises Error for anything
    ambiguous.
    """
    try:
        table = _open_table(text.removeprefix("\ufeff"), columns)
        rows = []
        for line in table:
            where = f"line {table.line_num}"
            _refuse_surplus(line, where, table.reader.dialect.delimiter)
            _refuse_row_in_other_unit(line, where)
            if any((line[name] or "").strip() for name in table.fieldnames):
                rows.append((where, {name: (line[name] or "").strip() for name in columns}))
    except csv.Error:
        raise Error(
            "this is not a table: a value contains a line break, or its quotation mark is not closed",
            code="not-a-table",
        ) from None
    cells = [(f"{where}, {name}", row[name]) for where, row in rows for name in numbers]
    for where, cell in cells:
        if not _NUMBER.fullmatch(cell):
            advice = "write a number of mm, without its unit" if _NUMBER.match(cell) else "write a number of mm"
            raise Error(f"{cell!r} is not a number: {advice}", where, code="not-a-number")
    points, commas = ([cell for cell in cells if mark in cell[1]] for mark in ".,")
    if points and commas:
        raise Error(
            f"{commas[0][1]!r} has a decimal comma, but {points[0][1]!r} in {points[0][0]} has a decimal point: write "
            "all numbers with a point",
            commas[0][0],
            code="table-separators",
        )
    return [(where, row | {name: float(row[name].replace(",", ".")) for name in numbers}) for where, row in rows]


# Thousands have no separator. Lengths are at most 1000 mm, so 1,234 and 1.234 can only mean little more than 1.
_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:[.,][0-9]*)?|[.,][0-9]+)(?:[eE][+-]?[0-9]+)?|(?i:nan|[+-]?inf)")
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs"}


def _open_table(text: str, columns: tuple[str, ...]) -> csv.DictReader:
    """Return a reader of the table with the separator that finds these columns in the first line."""
    tables = [csv.DictReader(io.StringIO(text), delimiter=separator) for separator in _SEPARATORS]
    for table in tables:
        table.fieldnames = [name.strip() for name in table.fieldnames or ()]
        _refuse_columns_in_other_units(table.fieldnames)
    missing = [[name for name in columns if name not in table.fieldnames] for table in tables]
    fewest_missing = min(missing, key=len)
    if fewest_missing:
        raise Error(
            f"the first line of the table lacks {' and '.join(fewest_missing)}: it must be {','.join(columns)}, "
            "separated by commas, semicolons or tabs",
            code="table-columns",
        )
    complete = [table for table, lacks in zip(tables, missing, strict=True) if not lacks]
    if len(complete) > 1:
        both = " and by ".join(_SEPARATORS[table.reader.dialect.delimiter] for table in complete)
        sentence = f"the columns could be separated by {both}: use only one of them"
        raise Error(sentence, "line 1", code="table-separators")
    names = complete[0].fieldnames
    if twice := [name for name in names if name and names.count(name) > 1]:
        raise Error(f"column {twice[0][:40]!r} is given twice", "line 1", code="key-twice")
    return complete[0]


_LENGTH_WITH_OTHER_UNIT = re.compile(
    r"(?P<what>\w*?(?:depth|value|width|lag))(?:[ _]*[(\[]|[ _]+)(?P<unit>in|inch|inches|cm|m|um|\")[)\]]?",
    re.I,
)


def _refuse_columns_in_other_units(names: list[str]) -> None:
    """Raise Error for a column whose name gives a unit other than mm."""
    for name in names:
        if found := _LENGTH_WITH_OTHER_UNIT.fullmatch(name):
            raise Error(
                f"the column {name[:40]!r} is not in millimetres: name it {found['what'].lower()}_mm and convert its "
                "values (1 inch is 25.4 mm)",
                "line 1",
                code="not-millimetres",
            )


def _refuse_row_in_other_unit(line: dict, where: str) -> None:
    """Raise Error for a row whose cell in a column of units is not mm."""
    for name, cell in line.items():
        if name and name.lower() in ("unit", "units") and (cell or "").strip() not in ("", "mm"):
            sentence = f"the unit {cell.strip()[:20]!r} is not mm: write all lengths in mm (1 inch is 25.4 mm)"
            raise Error(sentence, where, code="not-millimetres")


def _refuse_surplus(line: dict, where: str, separator: str) -> None:
    """Raise Error for a row with more cells than the first line names: 4,6 for 4.6 would be read as 4."""
    if surplus := [cell for cell in line.get(None, []) if cell.strip()]:
        advice = "write numbers with a decimal point, as in 4.6, or separate columns by semicolons"
        raise Error(
            f"{surplus[0]!r} has no column in the first line" + (f": {advice}" if separator == "," else ""),
            where,
            code="table-columns",
        )


def _read_json(text: str) -> Measurements:
    content = json_fields.document(text, FORMAT)
    json_fields.refuse_unknown(content, (*_GENERAL_KEYS, *_MARK_KEYS), listed=(*KINDS, "marks"))
    rows = {}
    for kind in KINDS:
        if listed := json_fields.objects(content.get(kind, []), kind):
            read = _READERS.get(kind, _read_row)
            rows[kind] = [read_row for i, row in enumerate(listed) for read_row in read(kind, row, f"{kind}[{i}]")]
    name = content.get("name", "")
    for key in ("name", "about"):
        if not isinstance(content.get(key, ""), str):
            raise Error("this must be a text", key, code="wrong-type")
    depth_range = content.get("depth_range_mm")
    if depth_range is not None:
        depth_range = json_fields.numbers(depth_range, "depth_range_mm", 2)
        if not 0 <= depth_range[0] < depth_range[1] <= MAX_LENGTH_MM:
            sentence = (
                f"[{depth_range[0]:g}, {depth_range[1]:g}] mm must be two rising depths within [0, "
                f"{MAX_LENGTH_MM:g}] mm"
            )
            raise Error(sentence, "depth_range_mm", code="depth-out-of-range")
    speed = json_fields.number(content.get("max_speed_mm_s", 25.0), "max_speed_mm_s")
    if not SPEED_RANGE_MM_S[0] <= speed <= SPEED_RANGE_MM_S[1]:
        slowest, fastest = SPEED_RANGE_MM_S
        sentence = f"{speed:g} mm/s is outside the range [{slowest:g}, {fastest:g}] mm/s"
        raise Error(sentence, "max_speed_mm_s", speed, code="out-of-range")
    if "marks" not in content:
        if misplaced := [key for key in _MARK_KEYS if key in content]:
            raise Error(
                "this key is for painted marks, but there are no marks", misplaced[0], code="measurements-mixed"
            )
        return Measurements(rows, name, depth_range, speed)
    if rows:
        raise Error(
            "painted marks cannot be combined with other measurements: remove one of them, or make two files",
            next(iter(rows)),
            code="measurements-mixed",
        )
    plan, marks = content.get("plan"), content["marks"]
    return Measurements(rows, name, depth_range, speed, [], plan, marks, _read_expected(content.get("expected", {})))


def _read_expected(given) -> dict:
    if not isinstance(given, dict):
        raise Error("this must be an object", "expected", code="wrong-type")
    json_fields.refuse_unknown(given, EXPECTED_KEYS, "expected")
    return {key: json_fields.number(value, f"expected.{key}", 0, 30) for key, value in given.items()}


def _read_row(kind: str, row: dict, where: str) -> list[Row]:
    names = ("depth_mm", *KINDS[kind])
    series = _ANGLE_SERIES_KEYS if kind == "angles" else ()
    json_fields.refuse_unknown(row, (*names, *series, "note"), where)
    numbers = {}
    for name in names:
        if name not in row:
            raise Error(f"the key {name} is missing", where, code="key-missing")
        numbers[name] = json_fields.number(row[name], f"{where}.{name}")
    for name in series:
        values = row.get(name, [] if name == "beta_deg" else None)
        numbers[name] = json_fields.numbers(values, f"{where}.{name}")
    depth = numbers.pop("depth_mm")
    _refuse_depth(depth, where)
    for name, value in numbers.items():
        limit, unit = (MAX_LENGTH_MM, "mm") if name.endswith("_mm") else (MAX_ANGLE_DEG, "degrees")
        for i, number in enumerate(value if isinstance(value, tuple) else (value,)):
            at = f"{where}.{name}[{i}]" if isinstance(value, tuple) else f"{where}.{name}"
            if abs(number) > limit:
                sentence = (
                    f"{number:g} {unit} is more than {limit:g} {unit}: write lengths in millimetres and angles in "
                    "degrees"
                )
                raise Error(sentence, at, number, code="out-of-range")
            if name == "s_mm" and number < 0:
                sentence = f"{number:g} mm is outside the range [0, {limit:g}] mm: measure s from the first reading"
                raise Error(sentence, at, number, code="out-of-range")
    return [Row(kind, where, depth, numbers)]


def _refuse_depth(depth_mm: float, where: str) -> None:
    if not 0 < depth_mm <= MAX_LENGTH_MM:
        sentence = (
            f"the depth {depth_mm:g} mm is outside the range (0, {MAX_LENGTH_MM:g}] mm: measure depths down from first "
            "contact, in millimetres"
        )
        raise Error(sentence, where, depth_mm, code="depth-out-of-range")


def _read_points(values, where: str) -> tuple[tuple[float, ...], ...]:
    """Read a list of points [[x, y], ...] in mm."""
    if not isinstance(values, list):
        raise Error("this must be a list of [x, y] in mm", where, code="wrong-type")
    points = tuple(json_fields.numbers(xy, f"{where}[{i}]", 2) for i, xy in enumerate(values))
    for i, xy in enumerate(points):
        if max(map(abs, xy)) > MAX_LENGTH_MM:
            sentence = f"({xy[0]:g}, {xy[1]:g}) mm is outside the range [-{MAX_LENGTH_MM:g}, {MAX_LENGTH_MM:g}] mm"
            raise Error(sentence, f"{where}[{i}]", code="out-of-range")
    return points


def _read_centre_line(kind: str, row: dict, where: str) -> list[Row]:
    """Read the middle line of an angular stroke's mark, from points or from a picture of the mark."""
    json_fields.refuse_unknown(row, ("depth_mm", *_CENTRE_LINE_KEYS, "note"), where)
    missing = [name for name in ("depth_mm",) if name not in row]
    if "points_mm" not in row:
        missing += [name for name in ("picture", "mm_per_px", "corner_px") if name not in row]
        if "picture" in missing:
            raise Error("one of the keys points_mm and picture is needed", where, code="key-missing")
    if missing:
        raise Error(f"the key {missing[0]} is missing", where, code="key-missing")
    depth = json_fields.number(row["depth_mm"], f"{where}.depth_mm")
    _refuse_depth(depth, where)
    if "points_mm" in row:
        if "picture" in row:
            raise Error("give either points_mm or picture, not both", where, code="options-contradict")
        points = _read_points(row["points_mm"], f"{where}.points_mm")
        if len(points) < MIN_LINE_POINTS:
            sentence = f"a centre line of {len(points)} points shows no turn: give {MIN_LINE_POINTS} or more"
            raise Error(sentence, f"{where}.points_mm", len(points), code="measurement-missing")
        return [Row(kind, where, depth, {"points_mm": points})]
    if not isinstance(row["picture"], str):
        raise Error("this must be the path of a picture", f"{where}.picture", code="wrong-type")
    towards = row.get("towards", TOWARDS[0])
    if towards not in TOWARDS:
        raise Error(f"this must be one of {', '.join(TOWARDS)}", f"{where}.towards", code="choice-unknown")
    picture_numbers = {
        "picture": row["picture"],
        "mm_per_px": json_fields.number(row["mm_per_px"], f"{where}.mm_per_px", 1e-3, 10.0),
        "corner_px": json_fields.numbers(row["corner_px"], f"{where}.corner_px", 2),
        "towards": towards,
    }
    return [Row(kind, where, depth, picture_numbers)]


def _read_video(kind: str, row: dict, where: str) -> list[Row]:
    """Convert positions of ferrule and tip in video frames to side views (section 2.5).

    The depth is z_i = z_f0 - z_fi. The value is d_i = |x_fi - x_ti| minus d_i at first touch. Equation (18) prints
    z_i with x and the other sign.
    """
    json_fields.refuse_unknown(row, ("ferrule_mm", "tip_mm", "touch", "note"), where)
    for name in ("ferrule_mm", "tip_mm"):
        if name not in row:
            raise Error(f"the key {name} is missing", where, code="key-missing")
    ferrule, tip = (_read_points(row[name], f"{where}.{name}") for name in ("ferrule_mm", "tip_mm"))
    if len(ferrule) != len(tip) or len(ferrule) < 2:
        raise Error(
            f"there are {len(ferrule)} places of the ferrule and {len(tip)} of the tip: give both for each frame, and "
            "at least two frames",
            where,
            code="sizes-differ",
        )
    touch = json_fields.number(row.get("touch", 0), f"{where}.touch", 0, len(ferrule) - 2)
    if touch != int(touch):
        raise Error("this must be the number of a frame; the first is 0", f"{where}.touch", code="wrong-type")
    touch = int(touch)
    apart = [f[0] - t[0] for f, t in zip(ferrule, tip, strict=True)]
    at_touch = apart[touch]
    sign = 1.0 if apart[-1] >= at_touch else -1.0  # -1 if the brush sweeps to the left, where the ferrule leads
    rows = []
    for i in range(touch + 1, len(ferrule)):
        depth = ferrule[touch][1] - ferrule[i][1]
        if depth > 0:
            rows.append(Row(kind, f"{where}, frame {i}", depth, {"value_mm": sign * (apart[i] - at_touch)}))
    if not rows:
        sentence = "the ferrule is never lower than at first touch: give z upwards, in mm"
        raise Error(sentence, f"{where}.ferrule_mm", code="measurement-missing")
    return rows


_READERS = {"centre_line": _read_centre_line, "video": _read_video}
