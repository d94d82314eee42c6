"""What a notebook draws of a value: a brush's laws and footprints, a plan's ways, painted marks, a drawing as read.

Importing this gives the classes their pictures; the package does so where IPython runs. None where there is nothing to
draw: then the notebook shows repr.
"""

from __future__ import annotations

import numpy as np

from . import _core
from .errors import Error
from .machine.realised.arc_chords import with_chords
from .model.plot import brush_picture
from .read.design import Design
from .show.import_picture import overview
from .show.marks_svg import known_colour, marks_svg
from .strokes.extraction import strokes

MOST_POINTS = 300_000  # of a picture: a browser that holds more is slow
ROOM_MM = 5.0  # round marks: they know no sheet


def brush_svg(brush: _core.Brush) -> str | None:
    """Laws and footprints; None without matplotlib, and for a brush that cannot be used."""
    try:
        _core.check(brush)
        return brush_picture(brush, ".svg").decode()
    except Error:
        return None


def plan_svg(plan: _core.Plan) -> str | None:
    """The TCP's way over the sheet, each pass in its colour; None without a sheet, or where there is too much."""
    width, height = plan.sheet_mm
    if (
        not (0 < width <= 1e6 and 0 < height <= 1e6)
        or sum(len(p.poses_mm) for p in plan.passes) > MOST_POINTS
    ):
        return None
    size = f'width="{width:g}mm" height="{height:g}mm" viewBox="0 0 {width:g} {height:g}"'
    wide = max(width, height) / 500
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" {size}>']
    for a_pass in plan.passes:
        if not np.isfinite(a_pass.poses_mm).all():
            return None
        try:
            places = with_chords(a_pass).poses_mm[:, :2]
        except Error:  # arcs that none are
            return None
        points = " ".join(f"{x:.3f},{height - y:.3f}" for x, y in places)
        colour = known_colour(a_pass.colour)
        lines.append(f'<polyline fill="none" stroke="{colour}" stroke-width="{wide:g}" points="{points}"/>')
    return "\n".join([*lines, "</svg>"])


def marks_picture(marks: _core.Marks) -> str | None:
    """The paint, as far as trace_outlines found it; None before that, or where there is too much."""
    rings = [ring for one in marks.passes for ring in one.outline_mm]
    if not rings or sum(map(len, rings)) > MOST_POINTS:
        return None
    right, top = np.vstack(rings).max(axis=0) + ROOM_MM
    try:
        return marks_svg(marks, (float(right), float(top)), ["#22252b"] * len(marks.passes))
    except Error:  # off any sheet
        return None


def design_svg(design: Design) -> str | None:
    """The drawing as understood: strokes numbered, with direction and width, and what was noticed."""
    try:
        made, renamed = strokes(design)
        return overview(".svg", design, made, [*design.notices, *renamed]).decode()
    except Error:
        return None


_core.Brush._repr_svg_ = brush_svg
_core.Plan._repr_svg_ = plan_svg
_core.Marks._repr_svg_ = marks_picture
Design._repr_svg_ = design_svg
