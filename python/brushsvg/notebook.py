"""Draw values in notebooks: brushes, toolpaths of plans, painted marks, drawings.

Importing this module gives the classes their pictures; the package imports it when IPython is loaded. A
picture is None if there is nothing to draw. The notebook then shows repr.
"""

from __future__ import annotations

import numpy as np

from . import _core
from .errors import Error
from .machine.realised.arc_chords import with_chords
from .model.plot import brush_picture
from .read.design import Design
from .show.import_picture import draw_import_picture
from .show.marks_svg import known_colour, marks_svg
from .strokes.extraction import strokes

MOST_POINTS = 300_000  # in one picture: more of them make the browser slow
ROOM_MM = 5.0  # margin above and right of the marks, which do not know their sheet


def brush_svg(brush: _core.Brush) -> str | None:
    """Draw the laws and footprints of a brush. Returns None without matplotlib, and for a brush that cannot be used."""
    try:
        _core.check(brush)
        return brush_picture(brush, ".svg").decode()
    except Error:
        return None


def plan_svg(plan: _core.Plan) -> str | None:
    """Draw the path of the TCP over the sheet, each pass in its colour.

    Returns None if the plan has no sheet, too many points, poses that are not finite, or invalid arcs.
    """
    width, height = plan.sheet_mm
    if not (0 < width <= 1e6 and 0 < height <= 1e6) or sum(len(p.poses_mm) for p in plan.passes) > MOST_POINTS:
        return None
    size = f'width="{width:g}mm" height="{height:g}mm" viewBox="0 0 {width:g} {height:g}"'
    wide = max(width, height) / 500
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" {size}>']
    for a_pass in plan.passes:
        if not np.isfinite(a_pass.poses_mm).all():
            return None
        try:
            places = with_chords(a_pass).poses_mm[:, :2]
        except Error:  # invalid arcs
            return None
        points = " ".join(f"{x:.3f},{height - y:.3f}" for x, y in places)
        colour = known_colour(a_pass.colour)
        lines.append(f'<polyline fill="none" stroke="{colour}" stroke-width="{wide:g}" points="{points}"/>')
    return "\n".join([*lines, "</svg>"])


def marks_picture(marks: _core.Marks) -> str | None:
    """Draw the outlines of the marks.

    Returns None before trace_outlines has found outlines, and if they have too many points.
    """
    rings = [ring for one in marks.passes for ring in one.outline_mm]
    if not rings or sum(map(len, rings)) > MOST_POINTS:
        return None
    right, top = np.vstack(rings).max(axis=0) + ROOM_MM
    try:
        return marks_svg(marks, (float(right), float(top)), ["#22252b"] * len(marks.passes))
    except Error:  # marks beyond any sheet
        return None


def design_svg(design: Design) -> str | None:
    """Draw the strokes of a drawing as brushsvg reads them, with notices.

    The strokes are numbered and show their direction and width.
    """
    try:
        made, renamed = strokes(design)
        return draw_import_picture(".svg", design, made, [*design.notices, *renamed]).decode()
    except Error:
        return None


_core.Brush._repr_svg_ = brush_svg
_core.Plan._repr_svg_ = plan_svg
_core.Marks._repr_svg_ = marks_picture
Design._repr_svg_ = design_svg
