"""chart.json: what a painted chart is read by. Markers, strokes and the plan itself, in mm on the sheet."""

from __future__ import annotations

import json
import math

from ... import _core
from ...errors import Error
from .layout import DICTIONARY, Bar, Chart, Label, Marker, Stroke, chart_id

FORMAT, VERSION = "brushsvg/chart", 1
DICTIONARIES = ("DICT_4X4_50", DICTIONARY)  # the first: of charts without an id


def write_chart(chart: Chart) -> str:
    """Lengths to 1e-4 mm, as in a program. The same chart gives the same bytes."""

    def mm(values):
        return [round(float(value), 4) for value in values]

    content = {
        "format": FORMAT,
        "version": VERSION,
        "id": chart.id,
        "brush": chart.plan.brush,
        "sheet_mm": mm(chart.plan.sheet_mm),
        "bar": chart.bar and {"at_mm": mm(chart.bar.at_mm), "length_mm": chart.bar.length_mm},
        "dictionary": chart.dictionary,
        "markers": [{"id": each.id, "corners_mm": list(map(mm, each.corners_mm))} for each in chart.markers],
        "strokes": [
            {"id": each.id, "kind": each.kind, "depth_mm": round(each.depth_mm, 4), "box_mm": mm(each.box_mm)}
            for each in chart.strokes
        ],
        "labels": [
            {"text": each.text, "at_mm": mm(each.at_mm), "width_mm": round(each.width_mm, 4)}
            for each in chart.labels
        ],
    }
    lines = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in content.items() if value]
    lines.append(f' "plan": {_core.write_plan(chart.plan).strip()}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def read_chart(data: bytes) -> Chart:
    """Error names the key. Charts of before have no id, no bar and no labels."""
    try:
        content = json.loads(data.decode("utf-8-sig", "replace"))
    except (ValueError, RecursionError) as problem:
        raise Error(f"this is not valid JSON: {problem}") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise Error(f'the file does not say "format": "{FORMAT}"', "format")
    if content.get("version") != VERSION:
        raise Error(
            f"version {content.get('version')} of {FORMAT} is not known; known is {VERSION}", "version"
        )
    if content.get("dictionary") not in DICTIONARIES:
        raise Error(f"the markers must be of {' or '.join(DICTIONARIES)}", "dictionary")
    if not isinstance(content.get("plan"), dict):
        raise Error("the chart has no plan", "plan")
    plan = _core.read_plan(json.dumps(content["plan"]))
    markers = tuple(_marker(row, f"markers[{i}]") for i, row in enumerate(_rows(content, "markers")))
    strokes = tuple(_stroke(row, f"strokes[{i}]") for i, row in enumerate(_rows(content, "strokes")))
    if [each.id for each in strokes] != [each.stroke for each in plan.passes]:
        raise Error("the strokes are not those of the plan, in its order", "strokes")
    if len({each.id for each in markers}) < len(markers):
        raise Error("two markers have the same id", "markers")
    labels = tuple(
        _label(row, f"labels[{i}]") for i, row in enumerate(_rows({"labels": []} | content, "labels"))
    )
    mark = content.get("id", "")
    if mark and mark != chart_id(plan):
        raise Error(f"the plan is not that of chart {str(mark)[:20]}: it was changed since", "plan")
    bar = _bar(content["bar"]) if content.get("bar") else None
    return Chart(plan, strokes, markers, labels, mark, bar, content["dictionary"])


def _rows(content: dict, key: str) -> list[dict]:
    rows = content.get(key)
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise Error("this must be a list of objects", key)
    return rows


def _marker(row: dict, where: str) -> Marker:
    corners = row.get("corners_mm")
    if not isinstance(row.get("id"), int) or not isinstance(corners, list) or len(corners) != 4:
        raise Error("a marker needs an id and four corners_mm", where)
    return Marker(row["id"], tuple(_numbers(corner, 2, f"{where}.corners_mm") for corner in corners))


def _bar(row) -> Bar:
    row = row if isinstance(row, dict) else {}
    (length,) = _numbers([row.get("length_mm")], 1, "bar.length_mm")
    if not length > 0:
        raise Error(f"the bar is {length:g} mm long, it must be longer than 0", "bar.length_mm", length)
    return Bar(_numbers(row.get("at_mm"), 2, "bar.at_mm"), length)


def _label(row: dict, where: str) -> Label:
    if not isinstance(row.get("text"), str):
        raise Error("a label needs a text", where)
    (width,) = _numbers([row.get("width_mm")], 1, f"{where}.width_mm")
    return Label(row["text"], _numbers(row.get("at_mm"), 2, f"{where}.at_mm"), width)


def _stroke(row: dict, where: str) -> Stroke:
    if not isinstance(row.get("id"), str) or not isinstance(row.get("kind"), str):
        raise Error("a stroke needs an id and a kind, in words", where)
    (depth,) = _numbers([row.get("depth_mm")], 1, f"{where}.depth_mm")
    return Stroke(row["id"], row["kind"], depth, _numbers(row.get("box_mm"), 4, f"{where}.box_mm"))


def _numbers(values, count: int, where: str) -> tuple[float, ...]:
    sound = isinstance(values, list) and len(values) == count
    if not sound or not all(isinstance(v, int | float) and math.isfinite(v) for v in values):
        raise Error(f"this must be {count} finite number{'s' * (count > 1)}", where)
    return tuple(float(v) for v in values)
