"""Descriptions of a brush in words and numbers."""

from __future__ import annotations

import math
import textwrap

from .. import _core
from .confidence import paint_interval_per_m
from .extra_keys import read_extra_keys

LAWS = (
    ("lag", "lever from the centre of friction to the TCP"),
    ("tip_gap", "from the tip of the mark to the centre of friction"),
    ("tip_to_widest", "from the tip to the widest section"),
    ("half_width", "half of the greatest width"),
)


def one_line(brush: _core.Brush) -> str:
    """Return one line about a brush for a list: the key `about` of its file, or a summary of its laws."""
    about = read_extra_keys(brush.extra).get("about")
    return about if isinstance(about, str) and about else describe_ranges(brush)


def describe_ranges(brush: _core.Brush) -> str:
    """Return kind, depth, line width and lag of a brush in words."""
    least, greatest = brush.depth_range_mm
    trail = "no lag" if brush.is_rigid() else f"lag {brush.lag(least):.1f} to {brush.lag(greatest):.1f} mm"
    return f"{brush.kind or 'brush'}, {_describe_lines(brush)}, depth {least:g} to {greatest:g} mm, {trail}"


def _describe_lines(brush) -> str:
    least, greatest = (2 * half for half in brush.half_width_range_mm())
    if not brush.width_follows_depth():
        return f"lines {greatest:g} mm wide"
    return f"lines {least:.1f} to {greatest:.1f} mm wide"


def describe_brush(brush: _core.Brush) -> str:
    """Return a full description of a brush.

    It has limits, laws with their source, footprints and a table of values.
    """
    least, greatest = brush.depth_range_mm
    lines = [
        f"{brush.name}: {one_line(brush)}",
        *([] if one_line(brush) == describe_ranges(brush) else [describe_ranges(brush)]),
        f"at most {brush.max_speed_mm_s:g} mm/s",
        "",
        "laws, mm against depth d in mm",
    ]
    for name, meaning in LAWS:
        lines += _describe_law(name, meaning, getattr(brush, name))
    lines += _describe_paint(brush.paint) if brush.paint else []
    lines += ["", *_describe_footprints(brush), "", *_tabulate_laws(brush, least, greatest)]
    return "\n".join(lines)


def _describe_law(name: str, meaning: str, law) -> list[str]:
    formula = polynomial(law.coefficients)
    if math.isfinite(law.floor):
        formula = f"max({polynomial([law.floor, law.floor_slope])}, {formula})"
    known = ["assumed"] if law.assumed else []
    if law.calibrated_mm and not law.assumed:
        known.append("measured at depths {:g} to {:g} mm".format(*law.calibrated_mm))
    if law.rmse_mm is not None:
        known.append(f"RMSE {law.rmse_mm:g} mm")
    return [f"  {name}: {meaning}", f"      {formula}", *_wrap_caption(known, law.source)]


def _wrap_caption(known: list[str], source: str) -> list[str]:
    caption = ". ".join(part for part in (", ".join(known), source) if part)
    return textwrap.wrap(caption, 100, initial_indent=" " * 6, subsequent_indent=" " * 6)


PAINT = "width of the mark after painting a length s (mm) since the last dip"


def _describe_paint(paint) -> list[str]:
    known = ["assumed"] if paint.assumed else []
    if paint.calibrated_mm:
        known.append("measured at lengths of {:g} to {:g} mm".format(*paint.calibrated_mm))
    if paint.covariance:
        half = paint_interval_per_m(paint)
        known.append(f"narrows by {paint.narrows_per_m:g} +- {half:.2g} per metre (95 %)")
    formula = f"width exp(-{paint.narrows_per_m:g} s / 1000)" if paint.narrows_per_m else "width as dipped"
    lasts = f"; hairs run dry after {paint.lasts_mm:g} mm" if paint.lasts_mm else ""
    return [f"  paint: {PAINT}", f"      {formula}{lasts}", *_wrap_caption(known, paint.source)]


def polynomial(coefficients) -> str:
    """Return a polynomial of d, the press depth, as text: 3.1 + 0.86 d."""
    text = ""
    for power, c in enumerate(coefficients):
        if c == 0:
            continue
        factor = f"{abs(c):g}" + ("" if power == 0 else " d" if power == 1 else f" d^{power}")
        text += (" - " if c < 0 else " + ") + factor if text else ("-" if c < 0 else "") + factor
    return text or "0"


def _describe_footprints(brush) -> list[str]:
    def depths(shapes):
        return ", ".join(f"{shape.depth_mm:g}" for shape in shapes)

    dragged, pressed = brush.footprints.dragged, brush.footprints.pressed
    count = len(dragged[0].outline_mm)
    straight_down = f"at depths {depths(pressed)} mm" if pressed else "equal to the dragged footprints"
    return [
        f"footprints of {count} points, dragged: at depths {depths(dragged)} mm",
        f"pressed straight down: {straight_down}",
    ]


def _tabulate_laws(brush, least: float, greatest: float) -> list[str]:
    lines = ["depth".rjust(7) + "".join(name.rjust(15) for name, _ in LAWS)]
    for step in range(6):
        depth = least + (greatest - least) * step / 5
        values = (getattr(brush, name)(depth) for name, _ in LAWS)
        lines.append(f"{depth:7.2f}" + "".join(f"{value:15.2f}" for value in values))
    return lines
