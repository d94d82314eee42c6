"""A picture of a drawing, and of its paint without and with compensation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .. import _core
from ..machine.realised.arc_chords import with_chords
from ..model.describe import one_line
from ..show.evaluation import figures
from ..show.panels_png import Panel, panels_png
from ..show.picture_colours import MIDDLE_LINE
from .prepared_drawing import PreparedDrawing

TITLES = {"none": "Tool follows the drawing", "closed": "With compensation"}


def comparison_png(
    works: Mapping[str, PreparedDrawing], marks: Mapping[str, _core.Marks], totals: Mapping[str, figures.Figures]
) -> bytes:
    """Draw a drawing, its paint without compensation and with it, as a PNG.

    Each argument has the keys of TITLES, which are ways of compensation.
    """
    work = works["closed"]
    strokes = work.strokes or []
    target = figures.target_rings(strokes)
    middle = [_core.flatten(stroke, 0.01)[:, :2] for stroke in strokes]
    width_mm, height_mm = np.ptp(np.vstack(target), axis=0)
    drawn = ("middle lines and their widths,", f"{width_mm:.0f} x {height_mm:.0f} mm")
    count = (str(len(strokes)), "strokes")
    panels = [Panel("What was drawn", count, drawn, target, [], middle, MIDDLE_LINE)]
    for how, title in TITLES.items():
        total = totals[how]
        score = (f"{total.overlap:.2f}", "overlap with the drawing")
        off = f"{total.centre_mean_mm:.2f} mm mean, {total.centre_largest_mm:.2f} mm at most"
        paths = [with_chords(a_pass).poses_mm[:, :2] for a_pass in works[how].plan.passes]
        panels.append(Panel(title, score, ("centre-line error", off), target, marks[how].outline_mm, paths))
    return panels_png(panels, work.title, f"with brush {work.brush.name}. {one_line(work.brush)}")
