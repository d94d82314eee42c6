"""Description of a cell in words and numbers."""

from __future__ import annotations

import itertools

from .cell import entries_of

KEY_BY_KEY = ("machine", "arm", "robodk")  # tables that are shown under the names of their keys


def cell_page(cell) -> str:
    """Describe a cell, one fact per line."""
    heights, speeds, workspace, blending = cell.heights, cell.speeds, cell.workspace, cell.blending
    rows = [
        ("language", cell.language),
        ("paper", _paper_text(cell.paper)),
        ("travels at", f"{heights.safe_mm:g} mm above the paper, {speeds.travel_mm_s:g} mm/s"),
        (
            "comes down at",
            f"{speeds.approach_mm_s:g} mm/s, the last {heights.clearance_mm:g} mm at {speeds.press_mm_s:g} mm/s",
        ),
        ("paints at", f"at most {speeds.paint_mm_s:g} mm/s, heights from {heights.lowest_mm:g} to 0 mm"),
        ("accelerates by", f"{speeds.acceleration_mm_s2:g} mm/s2"),
        ("workspace", f"the sheet and {workspace.margin_mm:g} mm around it"),
    ]
    if workspace.box_mm:
        rows.append(("", _box_text(*workspace.box_mm)))
    if workspace.reach_mm:
        rows.append(("", "{:g} to {:g} mm from the robot's origin".format(*workspace.reach_mm)))
    rows += [("", f"not in {_box_text(*corners)}") for corners in workspace.keep_out_mm]
    joints = f"cut by at most {blending.tolerance_mm:g} mm" if blending.tolerance_mm else "exact"
    rows.append(("corners", joints))
    if cell.tool:
        rows.append(("tool", f"tip at {_point_text(cell.tool.tcp_mm)} mm from the flange{_turn_text(cell.tool)}"))
        if cell.tool.spin_deg:
            rows.append(("", f"turned about the brush by {cell.tool.spin_deg:g} degrees"))
    if cell.servo:
        ends = (cell.servo.table[0], cell.servo.table[-1])
        rows.append(("servo", " to ".join(f"{value:g} at {height:g} mm" for height, value in ends)))
    if cell.motors:
        steps = " and ".join(f"{x:g} x {y:+g} y" for x, y in cell.motors.steps_per_mm)
        rows.append(("motors", f"{steps} steps for mm, servo on RP{cell.motors.servo_pin}"))
    if cell.pen:
        pens = f", pens of {', '.join(cell.pen.colours)}" if cell.pen.colours else ""
        rows.append(("pen", f"up or at {cell.pen.down_mm:g} mm{pens}"))
    if cell.contact:
        limit_text = f"more than {cell.contact.force_n:g} N" if cell.contact.force_n else "a collision"
        rows.append(("contact", f"{limit_text} ends the program"))
    if cell.reload:
        rows.append(("fetches paint", _reload_text(cell.reload)))
    for name in KEY_BY_KEY:
        if table := getattr(cell, name):
            rows += zip(itertools.chain([name], itertools.repeat("")), _table_facts(table), strict=False)
    rows += [("station", f"{station.name} at {_point_text(station.place_mm)} mm") for station in cell.stations]
    width = max(len(name) for name, _ in rows)
    lines = [f"{cell.name}: {cell.description}", *(f"{name.ljust(width)}  {text}" for name, text in rows)]
    return "\n".join(lines)


def _box_text(low, high) -> str:
    sides = itertools.chain(*zip(low, high, strict=True))
    return "x {:g} to {:g}, y {:g} to {:g}, z {:g} to {:g} mm".format(*sides)


def _paper_text(paper) -> str:
    if paper.taught_mm:
        return f"taught by {len(paper.taught_mm)} points, the first at {_point_text(paper.taught_mm[0])} mm"
    example = " (an example: teach yours)" if paper.example else ""
    return f"lower left corner at {_point_text(paper.origin_mm)} mm of the robot's frame{_turn_text(paper)}{example}"


def _turn_text(posed) -> str:
    return f", turned by {_point_text(posed.rotation_deg)} degrees" if any(posed.rotation_deg) else ""


def _reload_text(reload) -> str:
    when = {
        "length": f"every {reload.every_mm:g} mm",
        "stroke": "before every stroke",
        "layer": "before every layer",
    }
    narrower = f", or where marks would be {reload.narrower_percent:g} % narrower" if reload.narrower_percent else ""
    return when[reload.when] + (narrower if reload.when == "length" else "")


def _table_facts(table) -> list[str]:
    """Return the keys of a table that differ from their defaults, each with its value."""
    values = {key: getattr(table, key) for key in entries_of(table)}
    return [f"{key}: {_value_text(value)}" for key, value in values.items() if value != getattr(type(table), key, None)]


def _value_text(value) -> str:
    if not isinstance(value, tuple):
        return value if isinstance(value, str) else f"{value:g}"
    return "; ".join(map(_point_text, value)) if value and isinstance(value[0], tuple) else _point_text(value)


def _point_text(values) -> str:
    return ", ".join(f"{value:g}" for value in values)
