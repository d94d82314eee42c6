"""Marks -> SVG. Apart from the other pictures: a preview in a drawing program has no time to load OpenCV."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Sequence
from html import escape
from itertools import pairwise
from numbers import Real
from typing import Protocol

import numpy as np

from .. import _core
from ..errors import Error, need
from .overlap_svg import MISSING
from .svg_text import path_data, printable, quoted

BAND = "#e0862b"  # the 95 % band of an edge
TOOLPATH = "#2f6fd0"
EDGE = 0.002  # of the sheet, how wide the line round what stays blank is


class Band(Protocol):
    """The 95 % band of the edge of each mark: rings [mm], and its source in words."""

    @property
    def rings(self) -> Iterable[list[np.ndarray]]: ...
    @property
    def words(self) -> str: ...


def marks_svg(
    marks: _core.Marks,
    sheet_mm: tuple[float, float],
    colours: list[str],
    title: str = "",
    tracking_errors: Sequence[_core.TrackingError | None] = (),
    made: str = "",
    band: Band | None = None,
    blank: Iterable[np.ndarray] = (),
    astray: Container[str] = (),
    toolpath_mm: Sequence[np.ndarray] = (),
) -> str:
    """Draw one path per pass in its colour, in millimetres of the sheet.

    marks: with outlines; tracking_errors: of the passes, if known; made: how, in words; band: of their edges,
    drawn with a legend; blank: rings of the unpainted parts of shapes, outlined; astray: names of strokes that are
    marked, since their paint is displaced; toolpath_mm: of each pass the (n, 2) or (n, 3) positions of the tool,
    drawn over the paint, dashed where it travels in the air.
    """
    check_picture(marks, sheet_mm, colours)
    width, height = sheet_mm
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{height:g}mm" '
        f'viewBox="0 0 {width:g} {height:g}"' + (f" data-made={quoted(made)}" if made else "") + ">",
        f"<title>{escape(printable(title), quote=False)}</title>",
    ]
    tracking_errors = tracking_errors or [None] * len(colours)
    for trace, colour, error in zip(marks.passes, colours, tracking_errors, strict=True):
        if trace.outline_mm:
            stroke = quoted(trace.stroke)
            lines.append(
                f'<path data-stroke={stroke}{_missed(error, trace.stroke in astray)} fill="{known_colour(colour)}" d="'
            )
            lines += [path_data(ring, height) for ring in trace.outline_mm]
            lines[-1] += '"/>'
    if blank:
        data = "".join(path_data(ring, height) for ring in blank)
        wide = round(EDGE * max(width, height), 3)
        lines.append(
            f'<path class="blank" fill="none" stroke="{MISSING}" stroke-width="{wide:g}" d="{data}"/>'
        )
    if toolpath_mm:
        lines += _toolpath(toolpath_mm, width, height)
    if band is not None:
        lines += _band(band, width, height)
    return "\n".join([*lines, "</svg>", ""])


def check_picture(marks: _core.Marks, sheet_mm: tuple[float, float], colours: list[str]) -> None:
    """Error for a sheet that has no size, or where not every pass has a colour."""
    need(marks, _core.Marks, "marks, as simulate returns them")
    need(sheet_mm, (tuple, list), "a sheet's width and height")
    for side in sheet_mm:
        need(side, Real, "the side of a sheet")
    if len(sheet_mm) != 2 or not all(0 < side <= 1e6 for side in sheet_mm):
        raise Error(
            f"a sheet of {sheet_mm} mm cannot be drawn: both sides must be within (0, 1e6] mm",
            code="out-of-range",
        )
    if len(colours) != len(marks.passes):
        raise Error(
            f"a colour is needed for each of {len(marks.passes)} passes, not {len(colours)}",
            code="wrong-type",
        )


def travels(toolpath_mm: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return the moves in the air: from the end of each pass to the start of the next, each (2, 2) in mm."""
    return [np.stack((a[-1, :2], b[0, :2])) for a, b in pairwise(toolpath_mm)]


def _toolpath(toolpath_mm, width: float, height: float) -> list[str]:
    thick = round(EDGE * max(width, height), 3)
    style = f'fill="none" stroke="{TOOLPATH}" stroke-linejoin="round" stroke-width='
    in_air = "".join(_line_data(line, height) for line in travels(toolpath_mm))
    painting = "".join(_line_data(line, height) for line in toolpath_mm)
    return [
        f'<path class="travel" {style}"{0.6 * thick:g}" stroke-dasharray="{4 * thick:g}" d="{in_air}"/>',
        f'<path class="toolpath" {style}"{thick:g}" d="{painting}"/>',
    ]


def _line_data(points_mm: np.ndarray, height: float) -> str:
    """Return SVG path data of an open line; y points down there."""
    return "M" + "L".join(f"{x:.3f} {height - y:.3f}" for x, y in points_mm[:, :2])


def _band(band, width: float, height: float) -> list[str]:
    size = round(min(width, height) / 40, 3)
    lines = []
    for rings in filter(None, band.rings):
        data = " ".join(path_data(ring, height) for ring in rings)
        lines.append(f'<path class="band" fill="{BAND}" fill-opacity="0.45" d="{data}"/>')
    left, low = size, height - size
    if lines:
        box = f'x="{left:g}" y="{low - size:g}" width="{2 * size:g}" height="{size:g}"'
        lines.append(f'<rect {box} fill="{BAND}" fill-opacity="0.45"/>')
        left += 2.5 * size
    text = f'x="{left:g}" y="{low - 0.15 * size:g}" font-family="sans-serif" font-size="{size:g}"'
    return [*lines, f'<text {text} fill="#22252b">{escape(band.words)}</text>']


def _missed(error, is_astray: bool) -> str:
    if error is None:
        return ""
    return f' data-tracking-error-mm="{error.largest_mm:.3f}"' + ' data-off-line="yes"' * is_astray


def known_colour(colour: str) -> str:
    """A plan from elsewhere may say anything of its colours: what is not #rrggbb is drawn black."""
    return colour if re.fullmatch("#[0-9a-fA-F]{6}", colour) else "#000000"
