"""Pictures of a brush: its laws with confidence bands, and its footprints.

The laws are drawn against depth. Needs the extra `plot`.
"""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from .. import _core
from ..errors import missing_packages_error
from ..reporting.label_space import LabelSpace
from .confidence import law_band, paint_interval_per_m
from .describe import LAWS

INK, QUIET, BAND = "#2b3a67", "#767a82", "#3f8fd9"
NOTE = "note"  # marks a text that `encoded` places
NOTE_MARGIN_PX = 4  # space around a note
# Greatest brightness of a pixel with something in it: grids and bands are brighter.
MAX_DRAWN_BRIGHTNESS = 215
FOOTPRINT_COLOURS = ("#b9c3de", "#2b3a67")  # colours of footprints, shallow to deep


def brush_picture(brush, suffix: str, data: dict | None = None) -> bytes:
    """Return a picture of a brush as .svg or .png.

    data: law -> (n, 2) depths and values [mm] to which it was fitted. Raises Error with the command to run where
    matplotlib is not installed.
    """
    figure = new_figure((11, 7.2))
    brush_picture_on(figure, brush, data)
    return encoded(figure, suffix)


def brush_picture_on(figure, brush, data: dict | None = None) -> None:
    """Draw the picture of a brush on a figure, or on a part of one."""
    grid = figure.add_gridspec(2, 3, width_ratios=(1, 1, 1.1))
    depths = np.linspace(*brush.depth_range_mm, 201)
    for number, (name, meaning) in enumerate(LAWS):
        axes = figure.add_subplot(grid[number // 2, number % 2])
        _draw_law(axes, depths, name, meaning, getattr(brush, name), law_band(brush, name, depths))
        if data and name in data:
            axes.plot(*data[name].T, "o", color=INK, markersize=3, alpha=0.6, label="measured")
    _draw_legend(figure)
    _draw_footprints(figure.add_subplot(grid[0, 2] if brush.paint else grid[:, 2]), brush)
    if brush.paint:
        _draw_paint(figure.add_subplot(grid[1, 2]), brush.paint)
    figure.suptitle(shortened(brush.name, 60))


def _draw_legend(figure) -> None:
    """Draw one legend for all laws below them: inside, it would cover a law."""
    named = {}
    for axes in figure.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            named.setdefault(label, handle)
    figure.legend(named.values(), named.keys(), loc="outside lower left", ncols=4, fontsize=8, frameon=False)


def fill_rings(axes, rings: list, colour: str) -> None:
    """Fill rings (n, 2) as one shape, holes clockwise."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    closed = [Path(np.vstack([ring, ring[:1]]), closed=True) for ring in rings]
    axes.add_patch(PathPatch(Path.make_compound_path(*closed), color=colour, linewidth=0))


def _draw_law(axes, depths, name, meaning, law, band) -> None:
    values = np.array([law(depth) for depth in depths])
    if band:
        half, what = band
        axes.fill_between(depths, values - half, values + half, color=BAND, alpha=0.25, linewidth=0, label=f"+- {what}")
    measured = (math.inf, -math.inf) if law.assumed else law.calibrated_mm or (-math.inf, math.inf)
    inside = (depths >= measured[0]) & (depths <= measured[1])
    axes.plot(
        depths,
        values,
        color=INK,
        linestyle=":",
        label=None if inside.all() else "assumed, or outside the measured depths",
    )
    if inside.any():
        axes.plot(depths, np.where(inside, values, np.nan), color=INK, label="law")
    axes.set_title(f"{name}{' (assumed)' if law.assumed else ''}\n{meaning}", fontsize=9)
    axes.set_xlabel("depth, mm", fontsize=8)
    axes.set_ylabel("mm", fontsize=8)
    axes.set_ylim(bottom=min(0.0, values.min()))
    axes.grid(color="#e4e2dc", linewidth=0.6)


def _draw_paint(axes, paint) -> None:
    """Draw the share of the width that is left as paint runs out.

    It ends where it was measured, where hairs run dry, or where a tenth of the width is gone.
    """
    ends = [paint.calibrated_mm[1] if paint.calibrated_mm else 0.0, 1.2 * (paint.lasts_mm or 0.0)]
    to_mm = max(ends) or min(paint.path_to_share_mm(0.9), 1000.0)
    ways = np.linspace(0.0, to_mm, 201)
    share = np.array([100 * paint.width_share(way) for way in ways])
    if paint.covariance:
        off = np.exp(1e-3 * paint_interval_per_m(paint) * ways)
        axes.fill_between(ways, share / off, np.minimum(share * off, 100.0), color=BAND, alpha=0.25, linewidth=0)
    axes.plot(ways, share, color=INK, linestyle=":" if paint.assumed else "-")
    if paint.lasts_mm:
        axes.axvline(paint.lasts_mm, color=QUIET, linewidth=1)
        note(axes, (paint.lasts_mm, 50.0), "hairs run dry", fontsize=8, color=QUIET)
    axes.set_title(f"paint{' (assumed)' if paint.assumed else ''}\nwidth left since the last dip", fontsize=9)
    axes.set_xlabel("painted length, mm", fontsize=8)
    axes.set_ylabel("%", fontsize=8)
    axes.set_ylim(0.0, 105.0)
    axes.grid(color="#e4e2dc", linewidth=0.6)


def _draw_footprints(axes, brush) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    shades = LinearSegmentedColormap.from_list("depth", FOOTPRINT_COLOURS)
    least, greatest = brush.depth_range_mm
    for shape in reversed(brush.footprints.dragged):
        depth = min(shape.depth_mm, greatest)
        outline = _core.footprint_at(brush.footprints, shape.depth_mm, 1.0)
        axes.fill(
            *outline.T,
            facecolor=shades((depth - least) / (greatest - least)),
            edgecolor="white",
            linewidth=0.5,
        )
    axes.set_aspect("equal")
    shown = [shape.depth_mm for shape in brush.footprints.dragged]
    title = f"footprints, dragged, at depths {min(shown):g} to {max(shown):g} mm\nthe tool is on the right"
    axes.set_title(title, fontsize=9)
    axes.set_xlabel("mm from the tip", fontsize=8)


def new_figure(size_in: tuple[float, float]):
    """Return a figure without a window or global state. Raises Error where matplotlib is missing."""
    try:
        import matplotlib.figure
    except ImportError:
        raise missing_packages_error("pictures of laws need", "matplotlib") from None
    return matplotlib.figure.Figure(figsize=size_in, layout="constrained", facecolor="white")


def note(axes, at, text: str, **style) -> None:
    """Add a text for a place of the data. `encoded` moves it to where it covers nothing."""
    axes.text(*at, text, gid=NOTE, ha="left", va="bottom", **style)


def encoded(figure, suffix: str) -> bytes:
    """Return a figure as the bytes of a file: the same figure gives the same bytes."""
    import matplotlib

    settings = {"svg.hashsalt": "brushsvg", "svg.fonttype": "none"}
    buffer = io.BytesIO()
    metadata = {"Date": None} if suffix == ".svg" else {"Software": None}
    with allow_missing_letters(), matplotlib.rc_context(settings):
        if notes := figure.findobj(lambda artist: artist.get_gid() == NOTE):
            _place_notes(figure, notes)
        figure.savefig(buffer, format=suffix[1:], dpi=140, metadata=metadata)
    return buffer.getvalue()


@contextmanager
def allow_missing_letters() -> Iterator[None]:
    """Let matplotlib draw a box for a letter that its font lacks, such as a Chinese one, without a Python warning."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from", category=UserWarning)
        yield


def _place_notes(figure, notes: list) -> None:
    """Move notes within their axes to where they cover nothing that is drawn."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.lines import Line2D

    canvas = FigureCanvasAgg(figure)
    for each in notes:
        each.set_visible(False)
    canvas.draw()
    figure.set_layout_engine("none")  # notes that are placed now must not move again
    marks = np.asarray(canvas.buffer_rgba())[..., :3].min(axis=2) < MAX_DRAWN_BRIGHTNESS
    height, width = marks.shape
    spaces: dict = {}
    for each in notes:
        each.set_visible(True)
        extent, frame = each.get_window_extent(canvas.get_renderer()), each.axes.bbox
        x, y = each.axes.transData.transform(each.get_position())
        bounds = (frame.x0 + 2, height - frame.y1 + 2, frame.x1 - 2, height - frame.y0 - 2)
        space = spaces.setdefault(each.axes, LabelSpace(marks, bounds=bounds))
        label = space.place((x, height - y), [(extent.width + 2 * NOTE_MARGIN_PX, extent.height + 2 * NOTE_MARGIN_PX)])
        left, bottom = label.left + NOTE_MARGIN_PX, label.top + label.height - NOTE_MARGIN_PX
        each.set_transform(figure.transFigure)
        each.set_position((left / width, 1 - bottom / height))
        if label.leader:
            xs, ys = np.array(label.leader).T
            line = Line2D(xs / width, 1 - ys / height, linewidth=0.6, color=QUIET, transform=figure.transFigure)
            figure.add_artist(line)


def shortened(text: str, most: int = 40) -> str:
    """Return a name that fits a picture and is no formula: matplotlib reads $...$."""
    return (text if len(text) <= most else text[: most - 3] + "...").replace("$", r"\$")
