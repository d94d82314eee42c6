"""chart.json: what a painted chart is read by. Markers, strokes and the plan itself, in mm on the sheet."""

from __future__ import annotations

import json

from ... import _core, json_fields
from ...errors import Error
from .layout import Chart, Marker, Stroke

FORMAT, VERSION = "brushsvg/chart", 1
DICTIONARY = "DICT_4X4_50"  # of ArUco, as OpenCV names it


def write_chart(chart: Chart) -> str:
    """Lengths to 1e-4 mm, as in a program. The same chart gives the same bytes."""

    def mm(values):
        return [round(float(value), 4) for value in values]

    content = {
        "format": FORMAT,
        "version": VERSION,
        "brush": chart.plan.brush,
        "sheet_mm": mm(chart.plan.sheet_mm),
        "dictionary": DICTIONARY,
        "markers": [{"id": each.id, "corners_mm": list(map(mm, each.corners_mm))} for each in chart.markers],
        "strokes": [
            {"id": each.id, "kind": each.kind, "depth_mm": round(each.depth_mm, 4), "box_mm": mm(each.box_mm)}
            for each in chart.strokes
        ],
    }
    lines = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in content.items()]
    lines.append(f' "plan": {_core.write_plan(chart.plan).strip()}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def read_chart(data: bytes) -> Chart:
    """A chart without its labels. Error names the key."""
    content = json_fields.document(data, FORMAT, VERSION)
    if content.get("dictionary") != DICTIONARY:
        raise Error(f"the markers must be of {DICTIONARY}", "dictionary", code="chart-markers")
    if not isinstance(content.get("plan"), dict):
        raise Error("the chart has no plan", "plan", code="key-missing")
    plan = _core.read_plan(json.dumps(content["plan"]))
    rows = json_fields.objects
    markers = [_marker(row, f"markers[{i}]") for i, row in enumerate(rows(content.get("markers"), "markers"))]
    strokes = [_stroke(row, f"strokes[{i}]") for i, row in enumerate(rows(content.get("strokes"), "strokes"))]
    if [each.id for each in strokes] != [each.stroke for each in plan.passes]:
        raise Error("the strokes are not those of the plan, in its order", "strokes", code="chart-strokes")
    return Chart(plan, tuple(strokes), tuple(markers), ())


def _marker(row: dict, where: str) -> Marker:
    number, corners = row.get("id"), row.get("corners_mm")
    is_numbered = isinstance(number, int) and not isinstance(number, bool)
    if not is_numbered or not isinstance(corners, list) or len(corners) != 4:
        raise Error("a marker needs an id and four corners_mm", where, code="wrong-type")
    at = f"{where}.corners_mm"
    return Marker(number, tuple(json_fields.numbers(each, f"{at}[{i}]", 2) for i, each in enumerate(corners)))


def _stroke(row: dict, where: str) -> Stroke:
    if not isinstance(row.get("id"), str) or not isinstance(row.get("kind"), str):
        raise Error("a stroke needs an id and a kind, in words", where, code="wrong-type")
    depth_mm = json_fields.number(row.get("depth_mm"), f"{where}.depth_mm")
    return Stroke(
        row["id"], row["kind"], depth_mm, json_fields.numbers(row.get("box_mm"), f"{where}.box_mm", 4)
    )
