"""Draw how well a studio repeats.

The picture shows all sheets in one, displacements of marks, and effects of the approach. It follows figure 18 of the
article, in which one inscription was painted four times. As in that figure, the axis of counts is logarithmic.
"""

from __future__ import annotations

import numpy as np

from ..model.plot import BAND, INK, QUIET, encoded, new_figure, note, shortened
from .edge_offsets import EDGE_LEVEL
from .photographs import Comparison, TargetStroke
from .placing import NOWHERE
from .repeats import Repeats, bins_of

PREDICTED_COLOUR = "#c0392b"
PAINT_PX_PER_MM = 4.0  # resolution of the drawn paint
# Place of a legend below its axes, clear of the bars.
LEGEND_BELOW = {"fontsize": 7, "loc": "upper center", "bbox_to_anchor": (0.5, -0.1), "ncols": 3}
MAX_BARS = 30  # largest number of strokes; of more, those with the largest spread are drawn


def repeats_png(title: str, found: Repeats, sheets: list[Comparison], strokes: list[TargetStroke]) -> bytes:
    """Draw the repeatability as the bytes of a PNG file.

    sheets: the comparisons behind `found`; strokes: the strokes that were compared. Raises Error where matplotlib is
    missing.
    """
    figure = new_figure((12, 11))
    upper, lower = figure.subfigures(2, 1, height_ratios=(1.2, 1))
    upper.suptitle(shortened(title, 60))
    _draw_sheets(upper.subplots(), sheets, strokes)
    spread, histogram, approach = lower.subplots(1, 3, width_ratios=(1.1, 1, 1))
    _draw_spread(spread, found)
    _draw_histogram(histogram, found)
    _draw_hysteresis(approach, found)
    return encoded(figure, ".png")


def _draw_sheets(axes, sheets: list[Comparison], strokes: list[TargetStroke]) -> None:
    """Draw the outlines of all paint, with the place of each sheet corrected."""
    for number, sheet in enumerate(sheets):
        step = max(1, round(sheet.canvas.px_per_mm / PAINT_PX_PER_MM))
        x, y = (axis[::step] for axis in sheet.canvas.places())
        at = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        placement = sheet.common if sheet.spread_mm is not None else NOWHERE
        back = _undo_placement(at, placement, sheet.middle_mm).reshape(len(y), len(x), 2)
        colour = f"C{number % 10}"
        axes.contour(back[..., 0], back[..., 1], sheet.painted[::step, ::step], [EDGE_LEVEL], colors=[colour])
        axes.plot([], [], color=colour, label=f"sheet {number + 1}")
    for number, stroke in enumerate(strokes):
        for ring in stroke.predicted:
            line = np.vstack([ring, ring[:1]])
            axes.plot(*line.T, color=PREDICTED_COLOUR, linewidth=0.6, label="" if number else "predicted")
    axes.set_aspect("equal")
    axes.set_title("paint of all sheets, moved to one place (mm)", fontsize=9, color=INK)
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes.tick_params(labelsize=7)


def _undo_placement(points: np.ndarray, placement, middle_mm: np.ndarray) -> np.ndarray:
    """Return points moved by the inverse of `Placed.moved`."""
    c, s = np.cos(placement.turn_rad), np.sin(placement.turn_rad)
    return (points - middle_mm - placement.shift_mm) @ np.array([[c, -s], [s, c]]) + middle_mm


def _draw_spread(axes, found: Repeats) -> None:
    rows = sorted(found.rows, key=lambda row: -row.spread_mm)[:MAX_BARS][::-1]
    places = np.arange(len(rows))
    axes.barh(places, [row.spread_mm for row in rows], color=BAND, alpha=0.6, label="spread in x and in y")
    axes.plot([row.farthest_mm for row in rows], places, "o", color=INK, markersize=4, label="farthest from mean")
    axes.set_yticks(places, [shortened(row.stroke, 18) for row in rows], fontsize=7)
    axes.axvline(found.displacement_mm, color=PREDICTED_COLOUR, linewidth=1, label="all strokes")
    left_out = len(found.rows) - len(rows)
    what = f"of each stroke (mm){f'; {left_out} with less spread are not shown' if left_out else ''}"
    axes.set_title(what, fontsize=9, color=INK)
    axes.legend(**LEGEND_BELOW)
    axes.tick_params(axis="x", labelsize=7)


def _draw_histogram(axes, found: Repeats) -> None:
    """Draw the counts next to those of a normal spread in x and in y (Rayleigh's)."""
    edges, counts = bins_of(found)
    axes.bar(edges[:-1], counts, np.diff(edges), align="edge", color=BAND, alpha=0.6, edgecolor="white")
    at = np.linspace(0, edges[-1], 200)
    # Places are compared with their own mean, which is nearer to them than the true mean.
    sigma = float(np.sqrt(np.mean(found.away_mm**2) / 2))
    normal = len(found.away_mm) * (edges[1] - edges[0]) * at / sigma**2 * np.exp(-((at / sigma) ** 2) / 2)
    axes.plot(at, normal, color=INK, linewidth=1, label="normal distribution")
    axes.set_yscale("log")
    axes.set_ylim(0.5, 2 * max(counts.max(), 1))
    axes.set_xlabel("distance from the mean of the stroke, mm", fontsize=8, color=QUIET)
    axes.set_title(f"displacement, {len(found.away_mm)} marks (count)", fontsize=9, color=INK)
    axes.legend(**LEGEND_BELOW)
    axes.tick_params(labelsize=7)


def _draw_hysteresis(axes, found: Repeats) -> None:
    """Draw each stroke's mean along an axis, by direction of approach."""
    labels = []
    for number, approach in enumerate(found.approaches):
        for side, values in enumerate((approach.minus_mm, approach.plus_mm)):
            place = 2 * number + side
            labels.append(f"towards {'+' if side else '-'}{approach.axis}")
            if len(values):
                axes.plot(np.full(len(values), place), values, "o", color=BAND, markersize=4, alpha=0.7)
                axes.plot([place - 0.25, place + 0.25], [np.mean(values)] * 2, color=INK, linewidth=2)
        if approach.value_mm is not None:
            words = f"{approach.value_mm:+.2f} $\\pm$ {approach.half_mm:.2f} mm"
            middle = (np.mean(approach.minus_mm) + np.mean(approach.plus_mm)) / 2
            note(axes, (2 * number + 0.5, middle), words, fontsize=7)
    axes.axhline(0.0, color=QUIET, linewidth=0.6)
    axes.set_xticks(range(len(labels)), labels, fontsize=7)
    axes.margins(x=0.15, y=0.2)
    axes.set_title("hysteresis: mean of each stroke (mm)", fontsize=9, color=INK)
    axes.tick_params(axis="y", labelsize=7)
