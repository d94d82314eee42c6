"""chart.json: what a painted chart is read by. Markers, strokes and the plan itself, in mm on the sheet."""

from __future__ import annotations

import json
import math

from ... import _core
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
    try:
        content = json.loads(data.decode("utf-8-sig", "replace"))
    except (ValueError, RecursionError) as problem:
        raise Error(f"this is not valid JSON: {problem}", code="not-json") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise Error(f'the file does not say "format": "{FORMAT}"', "format", code="format-unknown")
    if content.get("version") != VERSION:
        raise Error(
            f"version {content.get('version')} of {FORMAT} is not known; known is {VERSION}",
            "version",
            code="version-unknown",
        )
    if content.get("dictionary") != DICTIONARY:
        raise Error(f"the markers must be of {DICTIONARY}", "dictionary", code="chart-markers")
    if not isinstance(content.get("plan"), dict):
        raise Error("the chart has no plan", "plan", code="key-missing")
    plan = _core.read_plan(json.dumps(content["plan"]))
    markers = tuple(_marker(row, f"markers[{i}]") for i, row in enumerate(_rows(content, "markers")))
    strokes = tuple(_stroke(row, f"strokes[{i}]") for i, row in enumerate(_rows(content, "strokes")))
    if [each.id for each in strokes] != [each.stroke for each in plan.passes]:
        raise Error("the strokes are not those of the plan, in its order", "strokes", code="chart-strokes")
    return Chart(plan, strokes, markers, ())


def _rows(content: dict, key: str) -> list[dict]:
    rows = content.get(key)
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise Error("this must be a list of objects", key, code="wrong-type")
    return rows


def _marker(row: dict, where: str) -> Marker:
    corners = row.get("corners_mm")
    if not isinstance(row.get("id"), int) or not isinstance(corners, list) or len(corners) != 4:
        raise Error("a marker needs an id and four corners_mm", where, code="wrong-type")
    return Marker(row["id"], tuple(_numbers(corner, 2, f"{where}.corners_mm") for corner in corners))


def _stroke(row: dict, where: str) -> Stroke:
    if not isinstance(row.get("id"), str) or not isinstance(row.get("kind"), str):
        raise Error("a stroke needs an id and a kind, in words", where, code="wrong-type")
    (depth,) = _numbers([row.get("depth_mm")], 1, f"{where}.depth_mm")
    return Stroke(row["id"], row["kind"], depth, _numbers(row.get("box_mm"), 4, f"{where}.box_mm"))


def _numbers(values, count: int, where: str) -> tuple[float, ...]:
    sound = isinstance(values, list) and len(values) == count
    if not sound or not all(isinstance(v, int | float) and math.isfinite(v) for v in values):
        raise Error(f"this must be {count} finite number{'s' * (count > 1)}", where, code="wrong-type")
    return tuple(float(v) for v in values)
