"""chart.json: what a painted chart is read by. Markers, strokes and the plan itself, in mm on the sheet."""

from __future__ import annotations

import json

import numpy as np

from ... import _core
from ...errors import Error
from .layout import Chart, Marker, Stroke

FORMAT, VERSION = "brushsvg/chart", 1
DICTIONARY, MARKERS_KNOWN = "DICT_4X4_50", 50  # of ArUco, as OpenCV names it
LARGEST_MM, DEEPEST_MM = 1e6, 1000.0


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
        raise Error(f"this is not valid JSON: {problem}") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise Error(f'the file does not say "format": "{FORMAT}"', "format")
    version = content.get("version")
    if version != VERSION or isinstance(version, bool):
        raise Error(f"version {version!r:.24} of {FORMAT} is not known; known is {VERSION}", "version")
    if content.get("dictionary") != DICTIONARY:
        raise Error(f"the markers must be of {DICTIONARY}", "dictionary")
    if not isinstance(content.get("plan"), dict):
        raise Error("the chart has no plan", "plan")
    try:
        plan = _core.read_plan(json.dumps(content["plan"]))
    except Error as refusal:
        raise Error(str(refusal), f"plan.{refusal.where}", refusal.value) from None
    sheet_mm = _numbers(content.get("sheet_mm"), 2, "sheet_mm", LARGEST_MM)
    if not np.allclose(sheet_mm, plan.sheet_mm, atol=1e-3):
        raise Error(f"{sheet_mm[0]:g} x {sheet_mm[1]:g} mm are not the sheet of the plan", "sheet_mm")
    markers = tuple(
        _marker(row, f"markers[{i}]", sheet_mm) for i, row in enumerate(_rows(content, "markers"))
    )
    strokes = tuple(
        _stroke(row, f"strokes[{i}]", sheet_mm) for i, row in enumerate(_rows(content, "strokes"))
    )
    if len({each.id for each in markers}) < len(markers):
        raise Error("two markers have one id", "markers")
    if [each.id for each in strokes] != [each.stroke for each in plan.passes]:
        raise Error("the strokes are not those of the plan, in its order", "strokes")
    return Chart(plan, strokes, markers, ())


def _rows(content: dict, key: str) -> list[dict]:
    rows = content.get(key)
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise Error("this must be a list of objects", key)
    return rows


def _marker(row: dict, where: str, sheet_mm: tuple[float, ...]) -> Marker:
    number, corners = row.get("id"), row.get("corners_mm")
    if type(number) is not int or not isinstance(corners, list) or len(corners) != 4:
        raise Error("a marker needs an id and four corners_mm", where)
    if not 0 <= number < MARKERS_KNOWN:
        raise Error(
            f"{number!r:.24} is outside the range [0, {MARKERS_KNOWN - 1}] of {DICTIONARY}", f"{where}.id"
        )
    return Marker(number, tuple(_numbers(each, 2, f"{where}.corners_mm", max(sheet_mm)) for each in corners))


def _stroke(row: dict, where: str, sheet_mm: tuple[float, ...]) -> Stroke:
    if not isinstance(row.get("id"), str) or not isinstance(row.get("kind"), str):
        raise Error("a stroke needs an id and a kind, in words", where)
    (depth,) = _numbers([row.get("depth_mm")], 1, f"{where}.depth_mm", DEEPEST_MM)
    box = _numbers(row.get("box_mm"), 4, f"{where}.box_mm", max(sheet_mm))
    return Stroke(row["id"], row["kind"], depth, box)


def _numbers(values, count: int, where: str, most: float) -> tuple[float, ...]:
    """So many numbers from 0 to `most`."""
    what = f"{count} finite numbers" if count > 1 else "1 finite number"
    if not isinstance(values, list) or len(values) != count:
        raise Error(f"this must be {what}", where)
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= most:
            raise Error(f"{value!r:.24} is outside the range [0, {most:g}] mm: this must be {what}", where)
    return tuple(float(value) for value in values)
