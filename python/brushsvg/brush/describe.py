"""A brush and a cell in words and numbers."""

from __future__ import annotations

import itertools
import json
import math
import textwrap

LAWS = (
    ("lag", "lever from the centre of friction to the TCP"),
    ("tip_gap", "from the tip of the mark to the centre of friction"),
    ("tip_to_widest", "from the tip to the widest section"),
    ("half_width", "half of the greatest width"),
)


def one_line(brush) -> str:
    """For a list of brushes: what the file says about itself, else what follows from its laws."""
    about = json.loads(brush.extra).get("about")
    return about if isinstance(about, str) and about else reach(brush)


def reach(brush) -> str:
    """Kind, depth, what it paints and how far it trails."""
    least, greatest = brush.depth_range_mm
    trail = "no lag" if brush.is_rigid() else f"lag {brush.lag(least):.1f} to {brush.lag(greatest):.1f} mm"
    return f"{brush.kind or 'brush'}, {_lines(brush)}, depth {least:g} to {greatest:g} mm, {trail}"


def _lines(brush) -> str:
    least, greatest = (2 * half for half in brush.half_width_range_mm())
    if not brush.width_follows_depth():
        return f"lines {greatest:g} mm wide"
    return f"lines {least:.1f} to {greatest:.1f} mm wide"


def page(brush) -> str:
    """All there is to know of a brush: limits, laws with their source, footprints, a table of values."""
    least, greatest = brush.depth_range_mm
    lines = [
        f"{brush.name}: {one_line(brush)}",
        reach(brush),
        f"at most {brush.max_speed_mm_s:g} mm/s",
        "",
        "laws, mm against depth d in mm",
    ]
    for name, meaning in LAWS:
        lines += _law(name, meaning, getattr(brush, name))
    lines += ["", *_footprints(brush), "", *_table(brush, least, greatest)]
    return "\n".join(lines)


def _law(name: str, meaning: str, law) -> list[str]:
    formula = polynomial(law.coefficients)
    if math.isfinite(law.floor):
        formula = f"max({polynomial([law.floor, law.floor_slope])}, {formula})"
    known = ["assumed"] if law.assumed else []
    if law.calibrated_mm:
        known.append("measured at depths {:g} to {:g} mm".format(*law.calibrated_mm))
    if law.rmse_mm is not None:
        known.append(f"RMSE {law.rmse_mm:g} mm")
    source = ". ".join(part for part in (", ".join(known), law.source) if part)
    lines = [f"  {name}: {meaning}", f"      {formula}"]
    return lines + textwrap.wrap(source, 100, initial_indent=" " * 6, subsequent_indent=" " * 6)


def polynomial(coefficients) -> str:
    """In words of d, the press depth: 3.1 + 0.86 d."""
    text = ""
    for power, c in enumerate(coefficients):
        if c == 0:
            continue
        factor = f"{abs(c):g}" + ("" if power == 0 else " d" if power == 1 else f" d^{power}")
        text += (" - " if c < 0 else " + ") + factor if text else ("-" if c < 0 else "") + factor
    return text or "0"


def _footprints(brush) -> list[str]:
    def depths(shapes):
        return ", ".join(f"{shape.depth_mm:g}" for shape in shapes)

    dragged, pressed = brush.footprints.dragged, brush.footprints.pressed
    count = len(dragged[0].outline_mm)
    straight_down = f"at depths {depths(pressed)} mm" if pressed else "the same shapes"
    return [
        f"footprints of {count} points, dragged: at depths {depths(dragged)} mm",
        f"pressed straight down: {straight_down}",
    ]


def _table(brush, least: float, greatest: float) -> list[str]:
    lines = ["depth".rjust(7) + "".join(name.rjust(15) for name, _ in LAWS)]
    for step in range(6):
        depth = least + (greatest - least) * step / 5
        values = (getattr(brush, name)(depth) for name, _ in LAWS)
        lines.append(f"{depth:7.2f}" + "".join(f"{value:15.2f}" for value in values))
    return lines


def cell_page(cell) -> str:
    """All that a cell file says, one fact a line."""
    heights, speeds, workspace, blending = cell.heights, cell.speeds, cell.workspace, cell.blending
    rows = [
        ("language", cell.language),
        ("paper", _paper(cell.paper)),
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
        rows.append(("", _box(*workspace.box_mm)))
    if workspace.reach_mm:
        rows.append(("", "{:g} to {:g} mm from the robot's origin".format(*workspace.reach_mm)))
    rows += [("", f"not in {_box(*corners)}") for corners in workspace.keep_out_mm]
    joints = f"cut by at most {blending.tolerance_mm:g} mm" if blending.tolerance_mm else "exact"
    rows.append(("corners", joints))
    if cell.tool:
        rows.append(("tool", f"tip at {_point(cell.tool.tcp_mm)} mm from the flange"))
    if cell.servo:
        ends = (cell.servo.table[0], cell.servo.table[-1])
        rows.append(("servo", " to ".join(f"{value:g} at {height:g} mm" for height, value in ends)))
    if cell.reload:
        rows.append(("fetches paint", _reload(cell.reload)))
    rows += [("station", f"{each.name} at {_point(each.place_mm)} mm") for each in cell.stations]
    width = max(len(name) for name, _ in rows)
    lines = [f"{cell.name}: {cell.description}", *(f"{name.ljust(width)}  {text}" for name, text in rows)]
    return "\n".join(lines)


def _box(low, high) -> str:
    sides = itertools.chain(*zip(low, high, strict=True))
    return "x {:g} to {:g}, y {:g} to {:g}, z {:g} to {:g} mm".format(*sides)


def _paper(paper) -> str:
    if paper.taught_mm:
        return f"taught by {len(paper.taught_mm)} points, the first at {_point(paper.taught_mm[0])} mm"
    turned = f", turned by {_point(paper.rotation_deg)} degrees" if any(paper.rotation_deg) else ""
    example = " (an example: teach yours)" if paper.example else ""
    return f"lower left corner at {_point(paper.origin_mm)} mm of the robot's frame{turned}{example}"


def _reload(reload) -> str:
    when = {
        "length": f"every {reload.every_mm:g} mm",
        "stroke": "before every stroke",
        "layer": "before every layer",
    }
    return when[reload.when]


def _point(values) -> str:
    return ", ".join(f"{value:g}" for value in values)
