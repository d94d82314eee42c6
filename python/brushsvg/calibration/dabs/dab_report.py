"""Report a calibration from dabs, in words and as a picture.

The report has outlines, laws, omissions and limits.
"""

from __future__ import annotations

import math

import numpy as np

from ... import _core
from ...model.plot import INK, brush_picture_on, encoded, new_figure
from ...reporting.report_text import Report, plural, verdict
from ..law_text import HALF_95, evaluate_law, format_coefficients, law_table, name_and_depths
from .dab_outlines import MAX_SMOOTHING_MM, Shape

LIMITS_OF_DABS = (
    "Dabs do not show the lag. It was taken from brush {before}.",
    "A dab shows everything that the standing brush touched down to its depth. The bristles of a dragged brush are a "
    "little closer together.",
)
# A front that is not this much further ahead than the front of a shallower dab may have been painted at that depth.
MIN_FRONT_ADVANCE_MM = 0.05
DAB_COLOUR, BEFORE_COLOUR = "#3f8fd9", "#c0392b"


def report(calibration) -> Report:
    """Return the report that `brushsvg calibrate` prints.

    calibration: a from_dabs.DabCalibration.
    """
    brush, outlines, shapes = calibration.brush, calibration.outlines, calibration.outlines.shapes
    count = sum(len(shape.seen) for shape in shapes)
    shift, turn = outlines.shift_mm, math.degrees(outlines.turn_rad)
    hidden = _find_hidden_fronts(brush)
    reservations = [f"the front of the footprint is uncertain at {plural(len(hidden), 'depth')}"] if hidden else []
    lines = [
        f"{name_and_depths(brush)}: outlines from {count} dabs at {len(shapes)} depths, lag from brush "
        f"{calibration.before.name}",
        f"the sheet is displaced by {shift[0]:+.2f}, {shift[1]:+.2f} mm and turned by {turn:+.2f} degrees; "
        f"{describe_heading_difference(outlines.turned_mm)}",
        *([_describe_hidden_fronts(hidden)] if hidden else []),
        *(text.format(before=calibration.before.name) for text in LIMITS_OF_DABS),
    ]
    depths = np.array([shape.depth_mm for shape in shapes])
    counts = [str(len(shape.seen)) for shape in shapes]
    repeats = [f"{shape.repeat_mm:.3f}" for shape in shapes]
    columns = [("dabs", counts), ("rms distance from the mean", repeats)]
    details = law_table(depths, [*columns, *((law, evaluate_law(brush, law, depths)) for law in _MEASURED_LAWS)])
    edges = (
        f"; it includes a common shift of all edges by {calibration.edge_mm:.2f} mm" if calibration.edge_mm > 0 else ""
    )
    sides = "both sides are equal" if outlines.is_even else "one side is larger than the other, by more than chance"
    details += [f"{HALF_95}{edges}", f"outlines: {sides}; they are smoothed by {MAX_SMOOTHING_MM:g} mm at most"]
    return Report(verdict([], reservations), tuple(lines), (*details, "", *format_coefficients(brush)))


def describe_heading_difference(difference_mm: float) -> str:
    """Return by how much dabs of different headings differ (rms). The digits do not show less than 0.005 mm."""
    shown = f"{difference_mm:.2f}"
    if float(shown) == 0:
        return "dabs of different headings have equal outlines, to 0.01 mm (rms)"
    return f"dabs of different headings differ by {shown} mm (rms)"


_MEASURED_LAWS = ("tip_gap", "tip_to_widest", "half_width")


def _find_hidden_fronts(brush: _core.Brush) -> list[float]:
    """Return the depths at which a lesser depth may have painted the front."""
    shapes = brush.footprints.dragged
    fronts = [float(shape.outline_mm[:, 0].max()) - brush.tip_gap(shape.depth_mm) for shape in shapes]
    return [
        shape.depth_mm for k, shape in enumerate(shapes) if k and fronts[k] < max(fronts[:k]) + MIN_FRONT_ADVANCE_MM
    ]


def _describe_hidden_fronts(depths: list[float]) -> str:
    listed = ", ".join(f"{depth:g}" for depth in depths)
    return (
        f"At depth {listed} mm the front of the dab may have been painted at a smaller depth, while the brush went "
        "down. The footprint may be shorter there."
    )


def report_picture(calibration, suffix: str) -> bytes:
    """Draw laws and footprints with the data, and the dabs of each depth.

    Dabs are drawn with their mean and with the outline before.
    """
    shapes = calibration.outlines.shapes
    figure = new_figure((11, 10))
    upper, lower = figure.subfigures(2, 1, height_ratios=(1.7, 1))
    brush_picture_on(upper, calibration.brush, calibration.values)
    columns = math.ceil(len(shapes) / 2) if len(shapes) > 4 else len(shapes)
    axes = lower.subplots(math.ceil(len(shapes) / columns), columns, squeeze=False).ravel()
    for panel, shape in zip(axes, shapes, strict=False):
        _draw_depth(panel, shape, calibration.before)
    for panel in axes[len(shapes) :]:
        panel.set_axis_off()
    lower.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    return encoded(figure, suffix)


def _draw_depth(axes, shape: Shape, before: _core.Brush) -> None:
    tip = np.array([-shape.tip_gap_mm, 0.0])
    label = "dabs"
    for patch_dab in shape.seen:
        axes.plot(*_close_ring(patch_dab.outline_mm - tip), color=DAB_COLOUR, linewidth=0.6, alpha=0.7, label=label)
        label = None
    assumed = _core.footprint_at(before.footprints, shape.depth_mm, 1.0)
    axes.plot(
        *_close_ring(assumed),
        color=BEFORE_COLOUR,
        linewidth=0.9,
        linestyle="--",
        label=f"before: brush {before.name}",
    )
    axes.plot(*_close_ring(shape.outline_mm), color=INK, linewidth=1.3, label="mean, smoothed: the new outline")
    axes.set_aspect("equal")
    axes.set_title(f"{shape.depth_mm:g} mm", fontsize=8)
    axes.tick_params(labelsize=6)


def _close_ring(ring) -> np.ndarray:
    ring = np.asarray(ring)
    return np.vstack([ring, ring[:1]]).T
