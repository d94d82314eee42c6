"""Where paint is missing and where there is too much of it, as an SVG; and the colours of such pictures."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from .. import _core
from ..reporting.label_space import LabelSpace
from .svg_text import path_data, printable

BOTH, MISSING, SPILT = "#b4b8c0", "#d1431f", "#2f6fd0"
OVERLAP_COLOURS = (
    (BOTH, "painted as drawn"),
    (MISSING, "drawn, not painted"),
    (SPILT, "painted, not drawn"),
)


CELLS = 1000  # of the longer side, by which labels keep clear of marks
SEEN = 0.05  # share of a cell, below which rounding leaves some
RING = 0.6  # radius of the ring around a place, in letter heights
LETTER = 0.65  # width of a figure, in letter heights


def overlap_svg(
    target: list,
    painted: list,
    sheet_mm: tuple[float, float],
    title: str = "",
    places: Mapping[int, tuple[float, float]] | None = None,
) -> str:
    """Draw where paint is missing and where there is too much of it, in millimetres of the sheet, and number places.

    target, painted: rings of all that was drawn, and of all paint. places: number -> (x, y) on the sheet.
    """
    width, height = sheet_mm
    size = max(2.0, 0.018 * max(width, height))
    data = {
        name: "".join(path_data(ring, height) for ring in rings)
        for name, rings in (("wanted", target), ("painted", painted))
    }
    foot = height + 2.5 * size
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{foot:g}mm" '
        f'viewBox="0 0 {width:g} {foot:g}">',
        f"<title>{escape(printable(title), quote=False)}</title>",
        f'<clipPath id="wanted"><path d="{data["wanted"]}"/></clipPath>',
        f'<rect width="{width:g}" height="{foot:g}" fill="#ffffff"/>',
        f'<path fill="{MISSING}" d="{data["wanted"]}"/>',
        f'<path fill="{SPILT}" d="{data["painted"]}"/>',
        f'<path fill="{BOTH}" clip-path="url(#wanted)" d="{data["painted"]}"/>',
    ]
    lines += _numbers([*target, *painted], sheet_mm, places, size) if places else []
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


def _numbers(rings: list, sheet_mm, places: Mapping[int, tuple[float, float]], size: float) -> list[str]:
    """A ring around each place, and its number next to it."""
    width, height = sheet_mm
    cells = CELLS / max(width, height)
    marks = _core.coverage(rings, (0.0, 0.0, width, height), cells) > SEEN
    down = {number: (x, height - y) for number, (x, y) in places.items()}
    bounds = (0.0, 0.0, width, height)
    space = LabelSpace(marks, 1 / cells, bounds, [*down.values()], RING * size)
    lines = [f'<g class="places" stroke="#22252b" stroke-width="{size / 12:.3g}" fill="none">']
    texts = []
    for number, (x, y) in down.items():
        lines.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{RING * size:.3g}"/>')
        label = space.place((x, y), [(LETTER * size * len(str(number)), size)])
        if label.leader:
            lines.append(
                '<path d="M{:.2f},{:.2f}L{:.2f},{:.2f}"/>'.format(*label.leader[0], *label.leader[1])
            )
        at = f'x="{label.left:.2f}" y="{label.top + 0.86 * size:.2f}"'
        texts.append(
            f'<text {at} font-family="sans-serif" font-weight="bold" font-size="{size:g}">{number}</text>'
        )
    return [*lines, "</g>", *texts]
