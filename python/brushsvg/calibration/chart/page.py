"""Draw the page on which a chart is painted, as vectors in mm.

The page has ArUco markers, a bar to measure and labels. It is white where strokes will be painted.
"""

from __future__ import annotations

import io
from collections.abc import Iterable
from html import escape

import cv2
import numpy as np

from ... import _core
from ...errors import Error, missing_packages_error, need_one_of, require_type
from ...model.laws.numbers import numbers
from ...model.plot import allow_missing_letters, new_figure
from .layout import TICK_MM, Bar, Chart, Label, Marker

MAX_TEXT_MM = 2.3  # greatest size of letters
LETTER_WIDTH_PER_SIZE = 0.6  # mean width of a sans serif letter relative to its size
INK_COLOUR, LABEL_COLOUR = "#000000", "#b4b4b4"  # letters are too light to look like paint
LINE_MM = 0.3  # width of the line of the bar
INCH_MM = 25.4
PAGE_EXTENSIONS = (".pdf", ".svg")


def chart_page(chart: Chart, extension: str, rings: Iterable[np.ndarray] = ()) -> bytes:
    """Return the page with markers to print at 100 % and paint on, as PDF (".pdf") or SVG (".svg").

    chart: as `chart` returns it.
    rings: additional black rings, arrays (n, 2) [mm].

    Raises Error for another extension, for rings that are not such arrays, and for ".pdf" if matplotlib is missing.
    """
    require_type(chart, Chart, "a chart")
    need_one_of(extension, PAGE_EXTENSIONS, "the extension of a page")
    require_type(rings, Iterable, "a list of rings")
    rings = [numbers(ring, "a ring [mm]", -1e6, 1e6) for ring in rings]
    if not all(ring.ndim == 2 and ring.shape[1] == 2 for ring in rings):
        raise Error("each ring must be an array of points (n, 2) [mm]", "rings", code="wrong-type")
    return chart_pdf(chart, rings) if extension == ".pdf" else chart_svg(chart, rings).encode()


def chart_svg(chart: Chart, more=()) -> str:
    """Return the page of a chart as an SVG to print at 100 %.

    more: additional black rings.
    """
    width, height = chart.plan.sheet_mm
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{height:g}mm" '
        f'viewBox="0 0 {width:g} {height:g}">',
        f"<title>{escape(chart.labels[-1].text if chart.labels else '')}</title>",
        f'<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>',
    ]
    for marker in chart.markers:
        rings = marker_rings(marker, chart.dictionary)
        lines.append(f'<path data-marker="{marker.id}" fill="{INK_COLOUR}" d="{_path_data(rings, height)}"/>')
    if chart.bar:
        rings = bar_rings(chart.bar)
        lines.append(f'<path data-bar="{chart.bar.length_mm:g}" fill="{INK_COLOUR}" d="{_path_data(rings, height)}"/>')
    lines += [f'<path fill="{INK_COLOUR}" d="{_path_data([ring], height)}"/>' for ring in more]
    lines += [_label_svg(label, height) for label in chart.labels]
    return "\n".join([*lines, "</svg>", ""])


def chart_pdf(chart: Chart, more=()) -> bytes:
    """Return the page of a chart as a PDF of its size.

    more: additional black rings. Raises Error if matplotlib is missing.
    """
    try:
        import matplotlib
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path
    except ImportError:
        raise missing_packages_error("pages as PDF need", "matplotlib") from None
    width, height = chart.plan.sheet_mm
    figure = new_figure((width / INCH_MM, height / INCH_MM))
    figure.set_layout_engine("none")
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width), ylim=(0, height))
    axes.set_axis_off()
    shapes = [marker_rings(marker, chart.dictionary) for marker in chart.markers]
    shapes += [bar_rings(chart.bar)] if chart.bar else []
    shapes += [[ring] for ring in more]
    for rings in shapes:
        closed = [Path(np.vstack([ring, ring[:1]]), closed=True) for ring in rings]
        axes.add_patch(PathPatch(Path.make_compound_path(*closed), facecolor=INK_COLOUR, linewidth=0))
    for label in chart.labels:
        points = _text_size(label) * 72 / INCH_MM
        axes.text(*label.at_mm, label.text, fontsize=points, color=LABEL_COLOUR, parse_math=False)
    buffer = io.BytesIO()
    title = chart.labels[-1].text if chart.labels else ""
    with allow_missing_letters(), matplotlib.rc_context({"pdf.fonttype": 42}):
        figure.savefig(buffer, format="pdf", metadata={"CreationDate": None, "Title": title})
    return buffer.getvalue()


def marker_modules(marker_id: int, dictionary: str) -> np.ndarray:
    """Return the modules of a marker, True where it is black, row 0 at the top."""
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    return cv2.aruco.generateImageMarker(known, marker_id, known.markerSize + 2) == 0


def marker_rings(marker: Marker, dictionary: str) -> list[np.ndarray]:
    """Return the black modules of a marker as one shape [mm], because single modules would show seams."""
    black = marker_modules(marker.id, dictionary)
    (left, top), (right, _), *_ = marker.corners_mm
    step = (right - left) / len(black)
    corners = np.array([(0, 0), (0, -1), (1, -1), (1, 0)])
    squares = [
        np.array([left, top]) + step * (corners + np.array([column, -row]))
        for row, column in np.argwhere(black).tolist()
    ]
    return [np.array(ring) for ring in _core.unite(squares)]


def bar_rings(bar: Bar, beyond_mm: float = 0.0) -> list[np.ndarray]:
    """Return the shape of a bar, grown by beyond_mm: a line between two ticks.

    The outer edges of the ticks are as far apart as the bar is long.
    """
    (x, y), end = bar.at_mm, bar.at_mm[0] + bar.length_mm
    boxes = [
        (x, y - LINE_MM / 2, end, y + LINE_MM / 2),
        (x, y - TICK_MM / 2, x + LINE_MM, y + TICK_MM / 2),
        (end - LINE_MM, y - TICK_MM / 2, end, y + TICK_MM / 2),
    ]
    grown = [(a - beyond_mm, b - beyond_mm, c + beyond_mm, d + beyond_mm) for a, b, c, d in boxes]
    rings = [np.array([(a, b), (c, b), (c, d), (a, d)]) for a, b, c, d in grown]
    return [np.array(ring) for ring in _core.unite(rings)]


def label_box(label: Label) -> tuple[float, float, float, float]:
    """Return left, bottom, right and top of the letters of a label.

    The letters are assumed to have their mean width.
    """
    (x, y), size = label.at_mm, _text_size(label)
    return x, y - 0.25 * size, x + LETTER_WIDTH_PER_SIZE * size * len(label.text), y + size


def _path_data(rings: list[np.ndarray], height: float) -> str:
    return " ".join("M" + " L".join(f"{x:.4f},{height - y:.4f}" for x, y in ring) + " Z" for ring in rings)


def _text_size(label: Label) -> float:
    return min(MAX_TEXT_MM, label.width_mm / (LETTER_WIDTH_PER_SIZE * len(label.text)))


def _label_svg(label: Label, height: float) -> str:
    x, y = label.at_mm
    at = f'x="{x:.3f}" y="{height - y:.3f}" font-family="sans-serif" font-size="{_text_size(label):.3f}"'
    return f'<text {at} fill="{LABEL_COLOUR}">{escape(label.text)}</text>'
