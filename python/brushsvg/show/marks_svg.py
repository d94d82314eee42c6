"""Draw marks as SVG. This module does not load OpenCV, because a preview in a drawing program has to be fast."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from html import escape
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from ..errors import Error, need_numbers, require_type
from ..read.svg.colour import parse_colour
from .picture_colours import INTERVAL_BAND, MISSING, TEXT, TOOLPATH
from .svg_text import path_data, printable, quoted

LINE_WIDTH_SHARE = 0.002  # of the sheet's longer side, for outlines of unpainted parts and for the toolpath


class Band(Protocol):
    """The 95 % bands of the marks' edges.

    rings: rings [mm] per mark; words: their source in words.
    """

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
    blank: Iterable[ArrayLike] = (),
    astray: Container[str] = (),
    toolpath_mm: Iterable[ArrayLike] = (),
) -> str:
    """Draw one path per pass in its colour, in millimetres of the sheet.

    marks: with outlines; colours: one per pass, as in CSS; tracking_errors: one per pass, if known; made: how the marks
    were made, in words; band: the 95 % band of their edges, drawn with a legend; blank: rings of the unpainted parts of
    shapes, outlined; astray: names of strokes that are marked because their paint is displaced; toolpath_mm: the tool's
    positions (n, 2) or (n, 3) in each pass, drawn over the paint, dashed where the tool travels in the air.

    Raises Error for marks without outlines, and for arguments that cannot be drawn.
    """
    width, height = check_picture(marks, sheet_mm, colours, band)
    blank, toolpath_mm = check_lines(blank, "blank"), check_lines(toolpath_mm, "toolpath_mm")
    for text, what in ((title, "title"), (made, "made")):
        require_type(text, str, "a text", what)
    _need_outlines(marks)
    if tracking_errors and len(tracking_errors) != len(marks.passes):
        sentence = f"tracking_errors has {len(tracking_errors)} entries, not {len(marks.passes)}, one for each pass"
        raise Error(sentence, code="sizes-differ")
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
                f"<path data-stroke={stroke}{_error_attributes(error, trace.stroke in astray)} "
                f'fill="{known_colour(colour)}" d="'
            )
            lines += [path_data(ring, height) for ring in trace.outline_mm]
            lines[-1] += '"/>'
    if blank:
        data = "".join(path_data(ring, height) for ring in blank)
        line_width = round(LINE_WIDTH_SHARE * max(width, height), 3)
        lines.append(f'<path class="blank" fill="none" stroke="{MISSING}" stroke-width="{line_width:g}" d="{data}"/>')
    if toolpath_mm:
        lines += _toolpath_elements(toolpath_mm, width, height)
    if band is not None:
        lines += _band_elements(band, width, height)
    return "\n".join([*lines, "</svg>", ""])


def check_picture(
    marks: _core.Marks, sheet_mm: tuple[float, float], colours: list[str], band: Band | None
) -> tuple[float, float]:
    """Return the width and height of the sheet; raise Error for arguments that cannot be drawn.

    The sheet must have a size, and each pass a colour.
    """
    require_type(marks, _core.Marks, "marks, as simulate returns them")
    width, height = need_numbers(sheet_mm, "sheet_mm", 2, 0.0, 1e6)
    if not min(width, height) > 0:
        sentence = f"a sheet of {width:g} x {height:g} mm cannot be drawn: both sides must be within (0, 1e6] mm"
        raise Error(sentence, code="out-of-range")
    require_type(colours, (list, tuple), "a list of colours, one for each pass")
    for colour in colours:
        require_type(colour, str, "a colour, as #1a237e")
    if band is not None and not (hasattr(band, "rings") and hasattr(band, "words")):
        raise Error(f"{type(band).__name__} {str(band)[:40]!r} is not a band with rings and words", code="wrong-type")
    if len(colours) != len(marks.passes):
        sentence = f"a colour is needed for each of {len(marks.passes)} passes, not {len(colours)}"
        raise Error(sentence, code="wrong-type")
    return width, height


def check_lines(lines: Iterable[ArrayLike], what: str) -> list[np.ndarray]:
    """Return lines or rings as arrays of points (n, 2) or (n, 3), without the empty ones.

    Raises Error for anything else, and for points that are not finite.
    """
    try:
        arrays = [np.asarray(line, dtype=float) for line in lines]
    except (TypeError, ValueError, OverflowError):
        arrays = None
    if arrays is None or any(each.size and (each.ndim != 2 or each.shape[1] not in (2, 3)) for each in arrays):
        raise Error(f"{what} is not a list of lines, each an array of points (n, 2) or (n, 3)", code="wrong-type")
    if not all(np.isfinite(each).all() for each in arrays):
        raise Error(f"a point of {what} is infinite or not a number", code="not-finite")
    return [each for each in arrays if each.size]


def _need_outlines(marks: _core.Marks) -> None:
    if not any(trace.outline_mm for trace in marks.passes) and any(
        (trace.depth_mm > 0).any() for trace in marks.passes
    ):
        sentence = "the marks have no outlines that could be drawn: call trace_outlines(marks, brush) first"
        raise Error(sentence, "marks", code="nothing-to-show")


def travels(toolpath_mm: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return the moves in the air between passes, each (2, 2) in mm.

    They go from the end of each pass to the start of the next.
    """
    return [np.stack((a[-1, :2], b[0, :2])) for a, b in pairwise(toolpath_mm)]


def _toolpath_elements(toolpath_mm, width: float, height: float) -> list[str]:
    thick = round(LINE_WIDTH_SHARE * max(width, height), 3)
    style = f'fill="none" stroke="{TOOLPATH}" stroke-linejoin="round" stroke-width='
    in_air = "".join(_line_data(line, height) for line in travels(toolpath_mm))
    painting = "".join(_line_data(line, height) for line in toolpath_mm)
    return [
        f'<path class="travel" {style}"{0.6 * thick:g}" stroke-dasharray="{4 * thick:g}" d="{in_air}"/>',
        f'<path class="toolpath" {style}"{thick:g}" d="{painting}"/>',
    ]


def _line_data(points_mm: np.ndarray, height: float) -> str:
    """Return the SVG path data of an open line, where y points down."""
    return "M" + "L".join(f"{x:.3f} {height - y:.3f}" for x, y in points_mm[:, :2])


def _band_elements(band, width: float, height: float) -> list[str]:
    size = round(band_letter_height(band.words, width, height), 3)
    lines = []
    for rings in filter(None, band.rings):
        data = " ".join(path_data(ring, height) for ring in rings)
        lines.append(f'<path class="band" fill="{INTERVAL_BAND}" fill-opacity="0.45" d="{data}"/>')
    left, low = size, height - size
    if lines:
        box = f'x="{left:g}" y="{low - size:g}" width="{2 * size:g}" height="{size:g}"'
        lines.append(f'<rect {box} fill="{INTERVAL_BAND}" fill-opacity="0.45"/>')
        left += 2.5 * size
    text = f'x="{left:g}" y="{low - 0.15 * size:g}" font-family="sans-serif" font-size="{size:g}"'
    return [*lines, f'<text {text} fill="{TEXT}">{escape(band.words)}</text>']


def band_letter_height(words: str, width: float, height: float) -> float:
    """Return the height of the letters with which a band's legend fits a sheet, in the unit of the sheet's sides."""
    return min(min(width, height) / 40, width / (4.5 + 0.55 * len(words)))


def _error_attributes(error, is_astray: bool) -> str:
    if error is None:
        return ""
    return f' data-tracking-error-mm="{error.largest_mm:.3f}"' + ' data-off-line="yes"' * is_astray


def known_colour(colour: str) -> str:
    """Return a colour of CSS as #rrggbb, black where it is none. Plans from other programs may have any words."""
    parsed = parse_colour(colour.strip()) or ""
    return parsed[:7] if parsed.startswith("#") else "#000000"
