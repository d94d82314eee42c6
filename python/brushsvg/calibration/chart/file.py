"""Read and write chart.json, with which a painted chart is read.

It has the markers, the strokes and the plan, in mm on the sheet.
"""

from __future__ import annotations

import json

import numpy as np

from ... import _core, json_fields
from ...errors import Error, require_type
from .layout import DICTIONARY, Bar, Chart, Label, Marker, Stroke, chart_id

FORMAT, VERSION = "brushsvg/chart", 1
# ArUco dictionaries, with their names in OpenCV, and their numbers of markers. The first is for charts without an id.
DICTIONARIES = {"DICT_4X4_50": 50, DICTIONARY: 1000}
MAX_SHEET_SIDE_MM, MAX_DEPTH_MM = 1e6, 1000.0


def write_chart(chart: Chart) -> str:
    """Return the chart.json with which a painted chart is read. Equal charts give equal bytes.

    Lengths are rounded to 1e-4 mm, as in a program.
    """
    require_type(chart, Chart, "a chart")

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
            {"text": each.text, "at_mm": mm(each.at_mm), "width_mm": round(each.width_mm, 4)} for each in chart.labels
        ],
    }
    lines = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in content.items() if value]
    lines.append(f' "plan": {_core.write_plan(chart.plan).strip()}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def is_chart(data: bytes) -> bool:
    """Return whether a file says that it is a chart.json, complete or not."""
    try:
        content = json.loads(data)
    except (ValueError, RecursionError):
        return False
    return isinstance(content, dict) and content.get("format") == FORMAT


def read_chart(data: bytes) -> Chart:
    """Read a chart.json. Older charts have no id, no bar and no labels.

    Raises Error, which names the key.
    """
    try:
        content = json_fields.document(data, FORMAT, VERSION)
    except Error as refusal:
        if refusal.code != "format-unknown":
            raise
        sentence = f"{refusal.sentence}: give the chart file that brushsvg chart wrote with --chart FILE"
        raise Error(sentence, refusal.where, code=refusal.code) from None
    dictionary = content.get("dictionary")
    if not isinstance(dictionary, str) or dictionary not in DICTIONARIES:
        raise Error(f"the dictionary must be {' or '.join(DICTIONARIES)}", "dictionary", code="chart-markers")
    if not isinstance(content.get("plan"), dict):
        raise Error("the chart has no plan", "plan", code="key-missing")
    try:
        plan = _core.read_plan(json.dumps(content["plan"]))
    except Error as refusal:
        raise Error(str(refusal), f"plan.{refusal.where}", refusal.value, code=refusal.code) from None
    _core.refuse_tilted(plan.passes, "charts are painted with the brush upright")
    sheet_mm = _read_lengths(content.get("sheet_mm"), "sheet_mm", 2, MAX_SHEET_SIDE_MM)
    if not np.allclose(sheet_mm, plan.sheet_mm, atol=1e-3):
        sentence = f"{sheet_mm[0]:g} x {sheet_mm[1]:g} mm differs from the sheet of the plan"
        raise Error(sentence, "sheet_mm", code="chart-strokes")
    rows, most_mm = json_fields.objects, max(sheet_mm)
    markers = [
        _read_marker(row, f"markers[{i}]", most_mm, DICTIONARIES[dictionary])
        for i, row in enumerate(rows(content.get("markers"), "markers"))
    ]
    strokes = [
        _read_stroke(row, f"strokes[{i}]", most_mm) for i, row in enumerate(rows(content.get("strokes"), "strokes"))
    ]
    if [each.id for each in strokes] != [each.stroke for each in plan.passes]:
        raise Error("the strokes must be the strokes of the plan, in its order", "strokes", code="chart-strokes")
    if len({each.id for each in markers}) < len(markers):
        raise Error("two markers have the same id", "markers", code="chart-markers")
    labels = [
        _read_label(row, f"labels[{i}]", most_mm) for i, row in enumerate(rows(content.get("labels", []), "labels"))
    ]
    mark = content.get("id", "")
    if mark and mark != chart_id(plan):
        sentence = f"the plan was changed after chart {str(mark)[:20]} was written"
        raise Error(sentence, "plan", code="chart-strokes")
    bar = _read_bar(content["bar"], most_mm) if content.get("bar") else None
    return Chart(plan, tuple(strokes), tuple(markers), tuple(labels), mark, bar, dictionary)


def _read_marker(row: dict, where: str, most_mm: float, marker_count: int) -> Marker:
    number, corners = row.get("id"), row.get("corners_mm")
    if type(number) is not int or not isinstance(corners, list) or len(corners) != 4:
        raise Error("a marker needs an id and four corners_mm", where, code="wrong-type")
    if not 0 <= number < marker_count:
        sentence = f"{number!r:.24} is outside the range [0, {marker_count - 1}]"
        raise Error(sentence, f"{where}.id", code="out-of-range")
    at = f"{where}.corners_mm"
    return Marker(number, tuple(_read_lengths(each, f"{at}[{i}]", 2, most_mm) for i, each in enumerate(corners)))


def _read_bar(row, most_mm: float) -> Bar:
    if not isinstance(row, dict):
        raise Error("this must be an object", "bar", code="wrong-type")
    length_mm = json_fields.number(row.get("length_mm"), "bar.length_mm", greatest=most_mm)
    if not length_mm > 0:
        sentence = f"the bar is {length_mm:g} mm long, but it must be longer than 0"
        raise Error(sentence, "bar.length_mm", length_mm, code="out-of-range")
    return Bar(_read_lengths(row.get("at_mm"), "bar.at_mm", 2, most_mm), length_mm)


def _read_label(row: dict, where: str, most_mm: float) -> Label:
    if not isinstance(row.get("text"), str) or not row["text"]:
        raise Error("a label needs a text", where, code="wrong-type")
    at_mm = _read_lengths(row.get("at_mm"), f"{where}.at_mm", 2, most_mm)
    return Label(row["text"], at_mm, json_fields.number(row.get("width_mm"), f"{where}.width_mm", 0, most_mm))


def _read_stroke(row: dict, where: str, most_mm: float) -> Stroke:
    if not isinstance(row.get("id"), str) or not isinstance(row.get("kind"), str):
        raise Error("a stroke needs an id and a kind, both texts", where, code="wrong-type")
    depth_mm = json_fields.number(row.get("depth_mm"), f"{where}.depth_mm", 0, MAX_DEPTH_MM)
    return Stroke(row["id"], row["kind"], depth_mm, _read_lengths(row.get("box_mm"), f"{where}.box_mm", 4, most_mm))


def _read_lengths(values, where: str, count: int, most_mm: float) -> tuple[float, ...]:
    numbers = json_fields.numbers(values, where, count)
    return tuple(json_fields.number(number, where, 0, most_mm) for number in numbers)
