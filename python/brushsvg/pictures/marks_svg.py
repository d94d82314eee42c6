"""Marks -> SVG. Apart from the other pictures: a preview in a drawing program has no time to load OpenCV."""

from __future__ import annotations

import re
from html import escape

import numpy as np

from .. import _core
from ..errors import Error, need

BAND = "#e0862b"  # where an edge lies with 95 %
EDGE = 0.002  # of the sheet, how wide the line round what stays blank is


def marks_svg(
    marks,
    sheet_mm: tuple[float, float],
    colours: list[str],
    title: str = "",
    tracking_errors=(),
    made: str = "",
    band=None,
    blank=(),
    seen_mm: float = 0.0,
) -> str:
    """One path per pass in its colour, in millimetres of the sheet.

    marks: with outlines; tracking_errors: of the passes, if known; made: how, in words; band: where their edges lie,
    with a legend; blank: rings of what of shapes stays blank, outlined; seen_mm: no stroke is marked for smaller
    errors, whatever the tolerance.
    """
    check_picture(marks, sheet_mm, colours)
    width, height = sheet_mm
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{height:g}mm" '
        f'viewBox="0 0 {width:g} {height:g}"' + (f" data-made={_quoted(made)}" if made else "") + ">",
        f"<title>{escape(_printable(title), quote=False)}</title>",
    ]
    tracking_errors = tracking_errors or [None] * len(colours)
    for trace, colour, miss in zip(marks.passes, colours, tracking_errors, strict=True):
        if trace.outline_mm:
            stroke = _quoted(trace.stroke)
            lines.append(
                f'<path data-stroke={stroke}{_missed(miss, seen_mm)} fill="{known_colour(colour)}" d="'
            )
            lines += [_path_data(ring, height) for ring in trace.outline_mm]
            lines[-1] += '"/>'
    if blank:
        data = "".join(_path_data(ring, height) for ring in blank)
        wide = round(EDGE * max(width, height), 3)
        lines.append(
            f'<path class="blank" fill="none" stroke="{MISSING}" stroke-width="{wide:g}" d="{data}"/>'
        )
    if band is not None:
        lines += _band(band, width, height)
    return "\n".join([*lines, "</svg>", ""])


def check_picture(marks, sheet_mm: tuple[float, float], colours: list[str]) -> None:
    """Error for a sheet that has no size, or where not every pass has a colour."""
    need(marks, _core.Marks, "marks, as simulate returns them")
    need(sheet_mm, (tuple, list), "a sheet's width and height")
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
        data = " ".join(_path_data(ring, height) for ring in rings)
        lines.append(f'<path class="band" fill="{BAND}" fill-opacity="0.45" d="{data}"/>')
    left, low = size, height - size
    if lines:
        box = f'x="{left:g}" y="{low - size:g}" width="{2 * size:g}" height="{size:g}"'
        lines.append(f'<rect {box} fill="{BAND}" fill-opacity="0.45"/>')
        left += 2.5 * size
    text = f'x="{left:g}" y="{low - 0.15 * size:g}" font-family="sans-serif" font-size="{size:g}"'
    return [*lines, f'<text {text} fill="#22252b">{escape(band.words)}</text>']


BOTH, MISSING, SPILT = "#b4b8c0", "#d1431f", "#2f6fd0"
OVERLAP_COLOURS = (
    (BOTH, "painted as wanted"),
    (MISSING, "wanted, not painted"),
    (SPILT, "painted, not wanted"),
)


def overlap_svg(wanted: list, painted: list, sheet_mm: tuple[float, float], title: str = "") -> str:
    """Where paint is missing and where there is too much of it, in OVERLAP_COLOURS, in millimetres of the sheet.

    wanted, painted: rings of all that was drawn, and of all paint.
    """
    width, height = sheet_mm
    size = max(2.0, 0.018 * max(width, height))
    data = {
        name: "".join(_path_data(ring, height) for ring in rings)
        for name, rings in (("wanted", wanted), ("painted", painted))
    }
    foot = height + 2.5 * size
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{foot:g}mm" '
        f'viewBox="0 0 {width:g} {foot:g}">',
        f"<title>{escape(_printable(title), quote=False)}</title>",
        f'<clipPath id="wanted"><path d="{data["wanted"]}"/></clipPath>',
        f'<rect width="{width:g}" height="{foot:g}" fill="#ffffff"/>',
        f'<path fill="{MISSING}" d="{data["wanted"]}"/>',
        f'<path fill="{SPILT}" d="{data["painted"]}"/>',
        f'<path fill="{BOTH}" clip-path="url(#wanted)" d="{data["painted"]}"/>',
    ]
    x = size
    for colour, words in OVERLAP_COLOURS:
        lines.append(
            f'<rect x="{x:g}" y="{height + size:g}" width="{size:g}" height="{size:g}" fill="{colour}"/>'
        )
        lines.append(
            f'<text x="{x + 1.5 * size:g}" y="{height + 1.85 * size:g}" font-family="sans-serif" '
            f'font-size="{size:g}" fill="#22252b">{words}</text>'
        )
        x += size * (3.0 + 0.55 * len(words))
    return "\n".join([*lines, "</svg>", ""])


def _missed(miss, seen_mm: float) -> str:
    if miss is None:
        return ""
    is_missed = not miss.within_tolerance and miss.largest_mm > seen_mm
    return f' data-miss-mm="{miss.largest_mm:.3f}"' + ' data-missed="yes"' * is_missed


def known_colour(colour: str) -> str:
    """A plan from elsewhere may say anything of its colours: what is not #rrggbb is drawn black."""
    return colour if re.fullmatch("#[0-9a-fA-F]{6}", colour) else "#000000"


def _path_data(ring: np.ndarray, height: float) -> str:
    points = np.round(np.column_stack([ring[:, 0], height - ring[:, 1]]), 3) + 0.0
    return ("M" + "L".join(["%.3f,%.3f"] * len(points)) + "Z") % tuple(points.ravel().tolist())


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in text)


def _quoted(text: str) -> str:
    return f'"{escape(_printable(text))}"'
