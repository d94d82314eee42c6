"""The page that a chart is painted on: ArUco markers and labels as vectors in mm, white where strokes will be."""

from __future__ import annotations

from html import escape

import cv2
import numpy as np

from ... import _core
from . import file
from .layout import Chart, Label, Marker

MODULES = 6  # of a marker of 4 x 4 bits and its border
TEXT_MM = 2.3
WIDE = 0.6  # of a letter against its size, on average: sans serif
INK, QUIET = "#000000", "#8a8a8a"


def chart_page(chart: Chart) -> str:
    """An SVG to be printed at 100 %."""
    width, height = chart.plan.sheet_mm
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{height:g}mm" '
        f'viewBox="0 0 {width:g} {height:g}">',
        f"<title>{escape(chart.labels[-1].text if chart.labels else '')}</title>",
        f'<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>',
    ]
    lines += [_marker(marker, height) for marker in chart.markers]
    lines += [_label(label, height) for label in chart.labels]
    return "\n".join([*lines, "</svg>", ""])


def modules(marker_id: int) -> np.ndarray:
    """True where a marker is black, row 0 on top."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, file.DICTIONARY))
    return cv2.aruco.generateImageMarker(dictionary, marker_id, MODULES) == 0


def _marker(marker: Marker, height: float) -> str:
    """Black modules as one shape: single ones show seams."""
    (left, top), (right, _), *_ = marker.corners_mm
    step = (right - left) / MODULES
    corner = np.array([left, height - top])
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    squares = [
        corner + step * (corners + np.array([column, row]))
        for row, column in np.argwhere(modules(marker.id)).tolist()
    ]
    data = " ".join(
        "M" + " L".join(f"{x:.4f},{y:.4f}" for x, y in ring) + " Z" for ring in _core.unite(squares)
    )
    return f'<path data-marker="{marker.id}" fill="{INK}" d="{data}"/>'


def _label(label: Label, height: float) -> str:
    size = min(TEXT_MM, label.width_mm / (WIDE * len(label.text)))
    x, y = label.at_mm
    at = f'x="{x:.3f}" y="{height - y:.3f}" font-family="sans-serif" font-size="{size:.3f}"'
    return f'<text {at} fill="{QUIET}">{escape(label.text)}</text>'
