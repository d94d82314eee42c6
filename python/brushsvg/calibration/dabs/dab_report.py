"""What dabs told of a brush: outlines, laws, what was left out, and what dabs do not say; in words and as a picture."""

from __future__ import annotations

import math

import numpy as np

from ... import _core
from ...model.confidence import law_band
from ...model.plot import INK, brush_picture_on, encoded, new_figure
from .dab_outlines import SMOOTHED_MM, Shape

NOT_SAID = (
    "Dabs do not say how far the brush lags: that is the lag of brush {before}.",
    "A dab shows all that was touched at its depth and above, by a brush that stands: bristles that are dragged along "
    "lie a little closer together.",
)
HIDDEN_MM = 0.05  # a front that lies no farther ahead than a shallower dab's may be that one's
FOUND, ASSUMED = "#3f8fd9", "#c0392b"


def report(made) -> str:
    """made: from_dabs.DabCalibration."""
    brush, shapes = made.brush, made.outlines.shapes
    count = sum(len(shape.seen) for shape in shapes)
    shift, turn = made.outlines.shift_mm, math.degrees(made.outlines.turn_rad)
    lines = [
        f"brush {brush.name}, depth {brush.depth_range_mm[0]:g} to {brush.depth_range_mm[1]:g} mm: outlines of {count} "
        f"dabs at {len(shapes)} depths, the lag of brush {made.before.name}",
        f"the sheet lay {shift[0]:+.2f}, {shift[1]:+.2f} mm aside, turned by {turn:+.2f} degrees; "
        f"dabs of different headings differ by {made.outlines.turned_mm:.2f} mm (rms)",
        "",
        "  depth   dabs   one dab from the mean, rms" + "".join(law.rjust(17) for law in _LAWS),
    ]
    bands = {law: law_band(brush, law, np.array([shape.depth_mm for shape in shapes])) for law in _LAWS}
    for k, shape in enumerate(shapes):
        cells = [_cell(getattr(brush, law)(shape.depth_mm), bands[law], k) for law in _LAWS]
        lines.append(
            f"{shape.depth_mm:7.2f}{len(shape.seen):7d}{shape.repeat_mm:29.3f}"
            + "".join(cell.rjust(17) for cell in cells)
        )
    lines += ["  +-: half the 95 % confidence interval of the law"]
    if made.edge_mm > 0:
        lines[-1] += f"; in it that all edges may lie {made.edge_mm:.2f} mm off together"
    sides = (
        "both sides alike" if made.outlines.is_even else "one side larger than the other, by more than chance"
    )
    lines += [f"outlines: {sides}; smoothed by {SMOOTHED_MM:g} mm at most", ""]
    lines += [_hidden(hidden)] if (hidden := _hidden_fronts(brush)) else []
    return "\n".join([*lines, *(text.format(before=made.before.name) for text in NOT_SAID), ""])


_LAWS = ("tip_gap", "tip_to_widest", "half_width")


def _cell(value: float, band, k: int) -> str:
    return f"{value:.2f}" + (f" +- {band[0][k]:.2f}" if band else "")


def _hidden_fronts(brush: _core.Brush) -> list[float]:
    """Depths at which what lies ahead may have been touched before the brush was so deep."""
    shapes = brush.footprints.dragged
    fronts = [float(shape.outline_mm[:, 0].max()) - brush.tip_gap(shape.depth_mm) for shape in shapes]
    return [shape.depth_mm for k, shape in enumerate(shapes) if k and fronts[k] < max(fronts[:k]) + HIDDEN_MM]


def _hidden(depths: list[float]) -> str:
    told = ", ".join(f"{depth:g}" for depth in depths)
    return (
        f"At depth {told} mm the front is no farther ahead than at a lesser depth, on the way to which it was touched: "
        "the footprint there may be shorter."
    )


def report_picture(made, suffix: str) -> bytes:
    """Laws and footprints with what was seen; below, each depth's dabs, their mean, and what was assumed before."""
    shapes = made.outlines.shapes
    figure = new_figure((11, 10))
    upper, lower = figure.subfigures(2, 1, height_ratios=(1.7, 1))
    brush_picture_on(upper, made.brush, made.values)
    columns = math.ceil(len(shapes) / 2) if len(shapes) > 4 else len(shapes)
    axes = lower.subplots(math.ceil(len(shapes) / columns), columns, squeeze=False).ravel()
    for one, shape in zip(axes, shapes, strict=False):
        _depth(one, shape, made.before)
    for one in axes[len(shapes) :]:
        one.set_axis_off()
    lower.legend(
        *axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8, frameon=False
    )
    return encoded(figure, suffix)


def _depth(axes, shape: Shape, before: _core.Brush) -> None:
    tip = np.array([-shape.tip_gap_mm, 0.0])
    label = "dabs"
    for seen in shape.seen:
        axes.plot(*_closed(seen.outline_mm - tip), color=FOUND, linewidth=0.6, alpha=0.7, label=label)
        label = None
    assumed = _core.footprint_at(before.footprints, shape.depth_mm, 1.0)
    axes.plot(
        *_closed(assumed), color=ASSUMED, linewidth=0.9, linestyle="--", label=f"before: brush {before.name}"
    )
    axes.plot(*_closed(shape.outline_mm), color=INK, linewidth=1.3, label="mean, smoothed: the new outline")
    axes.set_aspect("equal")
    axes.set_title(f"{shape.depth_mm:g} mm", fontsize=8)
    axes.tick_params(labelsize=6)


def _closed(ring) -> np.ndarray:
    ring = np.asarray(ring)
    return np.vstack([ring, ring[:1]]).T
