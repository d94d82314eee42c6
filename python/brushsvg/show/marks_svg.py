"""Marks -> SVG. Apart from the other pictures: a preview in a drawing program has no time to load OpenCV."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Sequence
from html import escape
from numbers import Real
from typing import Protocol

import numpy as np

from .. import _core
from ..errors import Error, need
from .overlap_svg import MISSING
from .svg_text import path_data, printable, quoted

BAND = "#e0862b"  # where an edge lies with 95 %
EDGE = 0.002  # of the sheet, how wide the line round what stays blank is


class Band(Protocol):
    """Where the edge of each mark lies with 95 %: rings [mm], and in words where that is known from."""

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
) -> str:
    """One path per pass in its colour, in millimetres of the sheet.

    marks: with outlines; tracking_errors: of the passes, if known; made: how, in words; band: where their edges lie,
    with a legend; blank: rings of what of shapes stays blank, outlined; astray: names of strokes that are marked, since
    their paint lies elsewhere.
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
            f"a sheet of {sheet_mm} mm cannot be drawn: both sides must lie within (0, 1e6] mm",
            code="out-of-range",
        )
    if len(colours) != len(marks.passes):
        raise Error(
            f"a colour is needed for each of {len(marks.passes)} passes, not {len(colours)}",
            code="wrong-type",
        )


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
