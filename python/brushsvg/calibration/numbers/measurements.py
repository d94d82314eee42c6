"""Measurements of a brush, from JSON or a table: docs/reference/measurements.md. Lengths in mm, angles in degrees."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass, field

from ... import json_fields
from ...errors import Error

FORMAT = "brushsvg/measurements"
LONGEST_MM = 1000.0
SPEEDS_MM_S = (0.01, 10000.0)
WHOLE_TURN_DEG = 360.0
SHALLOWEST_MM = 0.2  # if no depth is greater these are hardly millimetres
# Kind -> the numbers of one row, next to depth_mm. Those in _READINGS can stand in a table as value_mm.
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
_SERIES = ("s_mm", "alpha_deg", "beta_deg")
_OF_LINE = ("points_mm", "picture", "mm_per_px", "corner_px", "towards")
TOWARDS = ("right", "left", "up", "down")
LEAST_POINTS = 6  # of a centre line, from which two lengths are read
_TABLE = tuple(kind for kind, names in KINDS.items() if names == ("value_mm",))
_ABOUT = ("format", "version", "name", "kind", "depth_range_mm", "max_speed_mm_s", "about", *KINDS)
_PAINTED = ("plan", "marks", "expected")  # whole marks: see painted
# How far off a sheet and its marks may be, as standard deviations a person can say.
EXPECTED = ("placement_mm", "turn_deg", "displacement_mm", "height_mm")


@dataclass(frozen=True)
class Row:
    """One measurement at a depth: its numbers in a dictionary of names, series as tuples; its place in the file."""

    kind: str
    where: str
    depth_mm: float
    numbers: dict


@dataclass(frozen=True)
class Measurements:
    """What was measured, by kind; name, depth range and speed where the file says them."""

    rows: dict[str, list[Row]]
    name: str = ""
    about: str = ""
    depth_range_mm: tuple[float, float] | None = None
    max_speed_mm_s: float = 25.0
    depths_mm: list[float] = field(default_factory=list)
    plan: str | dict | None = None  # of the marks: a path, or what stands in a plan.json
    marks: str | list | None = None
    expected: dict = field(default_factory=dict)


def read_measurements(data: bytes, suffix: str) -> Measurements:
    """Error names the row or key. suffix: .json or .csv."""
    text = data.decode("utf-8-sig", "replace")
    found = _read_table(text) if suffix == ".csv" else _read_json(text)
    if found.marks is not None:
        return found
    depths = sorted({row.depth_mm for rows in found.rows.values() for row in rows})
    if not depths:
        sentence = (
            "there is no measurement in it: add rows of lag and of width, at two depths or more, better five"
        )
        raise Error(sentence, code="measurement-missing")
    if depths[-1] <= SHALLOWEST_MM:
        raise Error(
            f"the greatest depth is {depths[-1]:g} mm: depths and values count in millimetres",
            "depth_mm",
            code="depth-out-of-range",
        )
    found.depths_mm.extend(depths)
    return found


def read_widths(text: str) -> list[tuple[float, float]]:
    """(depth, width) pairs in mm of a table with the columns depth_mm and width_mm. Error names the line."""
    pairs = []
    for where, row in _table_rows(text, ("depth_mm", "width_mm"), numbers=("depth_mm", "width_mm")):
        for name, value in row.items():
            if not 0 < value <= LONGEST_MM:
                raise Error(
                    f"{value:g} mm is outside the range (0, {LONGEST_MM:g}] mm",
                    f"{where}, {name}",
                    value,
                    code="out-of-range",
                )
        pairs.append((row["depth_mm"], row["width_mm"]))
    return pairs


def _read_table(text: str) -> Measurements:
    rows: dict[str, list[Row]] = {}
    for where, row in _table_rows(text, ("kind", "depth_mm", "value_mm"), numbers=("depth_mm", "value_mm")):
        kind = row.pop("kind")
        if kind not in _TABLE:
            other = (
                "; it has several numbers a row, so write a JSON file"
                if kind in KINDS or kind in _READERS
                else ""
            )
            raise Error(
                f"{kind!r} is no kind of measurement for a table; known are {', '.join(_TABLE)}{other}",
                where,
                code="measurement-kind",
            )
        rows.setdefault(kind, []).extend(_row(kind, row, where))
    return Measurements(rows)


def _table_rows(
    text: str, columns: tuple[str, ...], numbers: tuple[str, ...]
) -> list[tuple[str, dict[str, str | float]]]:
    """(line, cells of these columns) of a table, some of them numbers, whose first line names its columns. Between
    cells stand commas, semicolons or tabs, in numbers points or commas. Error for anything that could be read in two
    ways.
    """
    try:
        table = _table(text.removeprefix("\ufeff"), columns)
        rows = []
        for line in table:
            where = f"line {table.line_num}"
            _refuse_surplus(line, where, table.reader.dialect.delimiter)
            _refuse_other_unit(line, where)
            if any((line[name] or "").strip() for name in table.fieldnames):
                rows.append((where, {name: (line[name] or "").strip() for name in columns}))
    except csv.Error:
        raise Error(
            "this is not a table: a line end stands amid a value, or a value has no end", code="not-a-table"
        ) from None
    cells = [(f"{where}, {name}", row[name]) for where, row in rows for name in numbers]
    for where, cell in cells:
        if not _NUMBER.fullmatch(cell):
            advice = (
                "write a number of mm, without its unit" if _NUMBER.match(cell) else "write a number of mm"
            )
            raise Error(f"{cell!r} is not a number: {advice}", where, code="not-a-number")
    points, commas = ([each for each in cells if mark in each[1]] for mark in ".,")
    if points and commas:
        raise Error(
            f"{commas[0][1]!r} has a comma for its decimals and {points[0][1]!r} in {points[0][0]} a point: write all "
            "numbers with a point",
            commas[0][0],
            code="table-separators",
        )
    return [
        (where, row | {name: float(row[name].replace(",", ".")) for name in numbers}) for where, row in rows
    ]


# No thousands: the range of lengths ends there, so 1,234 and 1.234 can only mean little more than 1.
_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:[.,][0-9]*)?|[.,][0-9]+)(?:[eE][+-]?[0-9]+)?|(?i:nan|[+-]?inf)")
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs"}


def _table(text: str, columns: tuple[str, ...]) -> csv.DictReader:
    """The table, read with the separator that finds these columns in the first line."""
    tables = [csv.DictReader(io.StringIO(text), delimiter=separator) for separator in _SEPARATORS]
    for table in tables:
        table.fieldnames = [name.strip() for name in table.fieldnames or ()]
        _refuse_other_units(table.fieldnames)
    missing = [[name for name in columns if name not in table.fieldnames] for table in tables]
    least = min(missing, key=len)
    if least:
        raise Error(
            f"the table needs a first line with {','.join(columns)}, or with semicolons or tabs for the commas; "
            f"it lacks {' and '.join(least)}",
            code="table-columns",
        )
    found = [table for table, lacks in zip(tables, missing, strict=True) if not lacks]
    if len(found) > 1:
        both = " and by ".join(_SEPARATORS[table.reader.dialect.delimiter] for table in found)
        raise Error(
            f"its columns could be separated by {both}: write one of them", "line 1", code="table-separators"
        )
    names = found[0].fieldnames
    if twice := [name for name in names if name and names.count(name) > 1]:
        raise Error(f"the column {twice[0]} stands twice", "line 1", code="key-twice")
    return found[0]


_OF_LENGTH = re.compile(
    r"(?P<what>\w*?(?:depth|value|width|lag))(?:[ _]*[(\[]|[ _]+)(?P<unit>in|inch|inches|cm|m|um|\")[)\]]?",
    re.I,
)


def _refuse_other_units(names: list[str]) -> None:
    """Error for a column that says it counts in something else than mm."""
    for name in names:
        if found := _OF_LENGTH.fullmatch(name):
            raise Error(
                f"the column {name[:40]!r} does not count in millimetres: write {found['what'].lower()}_mm, and "
                "an inch as 25.4",
                "line 1",
                code="not-millimetres",
            )


def _refuse_other_unit(line: dict, where: str) -> None:
    """The same for a row whose cell in a column of units is not mm."""
    for name, cell in line.items():
        if name and name.lower() in ("unit", "units") and (cell or "").strip() not in ("", "mm"):
            raise Error(
                f"the unit {cell.strip()[:20]!r} is not mm: write all lengths in mm, an inch as 25.4",
                where,
                code="not-millimetres",
            )


def _refuse_surplus(line: dict, where: str, separator: str) -> None:
    """Error for a row with more cells than the first line names: 4,6 for 4.6 would be read as 4."""
    if surplus := [cell for cell in line.get(None, []) if cell.strip()]:
        advice = "numbers are written with a point, as in 4.6, or semicolons stand between columns"
        raise Error(
            f"{surplus[0]!r} stands beyond the columns of the first line"
            + (f": {advice}" if separator == "," else ""),
            where,
            code="table-columns",
        )


def _read_json(text: str) -> Measurements:
    content = json_fields.document(text, FORMAT)
    json_fields.refuse_unknown(content, (*_ABOUT, *_PAINTED), listed=(*KINDS, "marks"))
    rows = {}
    for kind in KINDS:
        if listed := json_fields.objects(content.get(kind, []), kind):
            read = _READERS.get(kind, _row)
            rows[kind] = [one for i, row in enumerate(listed) for one in read(kind, row, f"{kind}[{i}]")]
    name, about = content.get("name", ""), content.get("about", "")
    if not isinstance(name, str) or not isinstance(about, str):
        raise Error("name and about must be text", "name", code="wrong-type")
    span = content.get("depth_range_mm")
    if span is not None:
        span = json_fields.numbers(span, "depth_range_mm", 2)
        if not 0 <= span[0] < span[1] <= LONGEST_MM:
            raise Error(
                f"[{span[0]:g}, {span[1]:g}] mm must rise within [0, {LONGEST_MM:g}] mm",
                "depth_range_mm",
                code="depth-out-of-range",
            )
    speed = json_fields.number(content.get("max_speed_mm_s", 25.0), "max_speed_mm_s")
    if not SPEEDS_MM_S[0] <= speed <= SPEEDS_MM_S[1]:
        slowest, fastest = SPEEDS_MM_S
        raise Error(
            f"{speed:g} mm/s is outside the range [{slowest:g}, {fastest:g}] mm/s",
            "max_speed_mm_s",
            speed,
            code="out-of-range",
        )
    if "marks" not in content:
        if lost := [key for key in _PAINTED if key in content]:
            raise Error(
                "this says something of marks, and there are none", lost[0], code="measurements-mixed"
            )
        return Measurements(rows, name, about, span, speed)
    if rows:
        raise Error(
            "marks contain what the other kinds measure, and are fitted alone: leave these out, or make two files",
            next(iter(rows)),
            code="measurements-mixed",
        )
    plan, marks = content.get("plan"), content["marks"]
    return Measurements(
        rows, name, about, span, speed, [], plan, marks, _expected(content.get("expected", {}))
    )


def _expected(given) -> dict:
    if not isinstance(given, dict):
        raise Error("this must be an object", "expected", code="wrong-type")
    json_fields.refuse_unknown(given, EXPECTED, "expected")
    return {key: json_fields.number(value, f"expected.{key}", 0, 30) for key, value in given.items()}


def _row(kind: str, row: dict, where: str) -> list[Row]:
    names = ("depth_mm", *KINDS[kind])
    series = _SERIES if kind == "angles" else ()
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
        most, unit = (LONGEST_MM, "mm") if name.endswith("_mm") else (WHOLE_TURN_DEG, "degrees")
        for i, each in enumerate(value if isinstance(value, tuple) else (value,)):
            at = f"{where}.{name}[{i}]" if isinstance(value, tuple) else f"{where}.{name}"
            if abs(each) > most:
                sentence = (
                    f"{each:g} {unit} is more than the {most:g} {unit} that are taken for true: lengths count in "
                    "millimetres, angles in degrees"
                )
                raise Error(sentence, at, each, code="out-of-range")
            if name == "s_mm" and each < 0:
                sentence = (
                    f"{each:g} mm is outside the range [0, {most:g}] mm: s counts from the first reading on"
                )
                raise Error(sentence, at, each, code="out-of-range")
    return [Row(kind, where, depth, numbers)]


def _refuse_depth(depth_mm: float, where: str) -> None:
    if not 0 < depth_mm <= LONGEST_MM:
        raise Error(
            f"the depth {depth_mm:g} mm is outside the range (0, {LONGEST_MM:g}] mm: depths count down from first "
            "contact, in millimetres",
            where,
            depth_mm,
            code="depth-out-of-range",
        )


def _places(values, where: str) -> tuple[tuple[float, ...], ...]:
    """[[x, y], ...] in mm."""
    if not isinstance(values, list):
        raise Error("this must be a list of [x, y] in mm", where, code="wrong-type")
    found = tuple(json_fields.numbers(place, f"{where}[{i}]", 2) for i, place in enumerate(values))
    for i, place in enumerate(found):
        if max(map(abs, place)) > LONGEST_MM:
            sentence = f"({place[0]:g}, {place[1]:g}) mm is further than the {LONGEST_MM:g} mm that are taken for true"
            raise Error(sentence, f"{where}[{i}]", code="out-of-range")
    return found


def _centre_line(kind: str, row: dict, where: str) -> list[Row]:
    """The middle of an angular stroke's mark: points, or a picture of it."""
    json_fields.refuse_unknown(row, ("depth_mm", *_OF_LINE, "note"), where)
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
            raise Error("points_mm and picture exclude each other", where, code="options-contradict")
        points = _places(row["points_mm"], f"{where}.points_mm")
        if len(points) < LEAST_POINTS:
            raise Error(
                f"a centre line of {len(points)} points shows no turn: give {LEAST_POINTS} or more",
                f"{where}.points_mm",
                len(points),
                code="measurement-missing",
            )
        return [Row(kind, where, depth, {"points_mm": points})]
    if not isinstance(row["picture"], str):
        raise Error("this must be the path of a picture", f"{where}.picture", code="wrong-type")
    towards = row.get("towards", TOWARDS[0])
    if towards not in TOWARDS:
        raise Error(f"this must be one of {', '.join(TOWARDS)}", f"{where}.towards", code="choice-unknown")
    seen = {
        "picture": row["picture"],
        "mm_per_px": json_fields.number(row["mm_per_px"], f"{where}.mm_per_px", 1e-3, 10.0),
        "corner_px": json_fields.numbers(row["corner_px"], f"{where}.corner_px", 2),
        "towards": towards,
    }
    return [Row(kind, where, depth, seen)]


def _video(kind: str, row: dict, where: str) -> list[Row]:
    """Section 2.5: places of ferrule and tip, frame by frame, to side views. Depth z_i = z_f0 - z_fi, value d_i =
    |x_fi - x_ti| less the same at first touch; (18) prints z_i with x and another sign."""
    json_fields.refuse_unknown(row, ("ferrule_mm", "tip_mm", "touch", "note"), where)
    for name in ("ferrule_mm", "tip_mm"):
        if name not in row:
            raise Error(f"the key {name} is missing", where, code="key-missing")
    ferrule, tip = (_places(row[name], f"{where}.{name}") for name in ("ferrule_mm", "tip_mm"))
    if len(ferrule) != len(tip) or len(ferrule) < 2:
        raise Error(
            f"there are {len(ferrule)} places of the ferrule and {len(tip)} of the tip; each frame needs both, and two "
            "frames are the least",
            where,
            code="sizes-differ",
        )
    touch = json_fields.number(row.get("touch", 0), f"{where}.touch", 0, len(ferrule) - 2)
    if touch != int(touch):
        raise Error("this is the number of a frame, the first being 0", f"{where}.touch", code="wrong-type")
    touch = int(touch)
    apart = [f[0] - t[0] for f, t in zip(ferrule, tip, strict=True)]
    at_touch = apart[touch]
    way = 1.0 if apart[-1] >= at_touch else -1.0  # swept to the left, the ferrule leads there
    found = []
    for i in range(touch + 1, len(ferrule)):
        depth = ferrule[touch][1] - ferrule[i][1]
        if depth > 0:
            found.append(Row(kind, f"{where}, frame {i}", depth, {"value_mm": way * (apart[i] - at_touch)}))
    if not found:
        raise Error(
            "the ferrule never comes lower than at first touch: z counts upwards, in mm",
            f"{where}.ferrule_mm",
            code="measurement-missing",
        )
    return found


_READERS = {"centre_line": _centre_line, "video": _video}
