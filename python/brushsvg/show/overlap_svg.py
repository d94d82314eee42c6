"""Draw where paint is missing and where there is too much paint, as SVG."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from .. import _core
from ..reporting.label_space import LabelSpace
from .picture_colours import BOTH, MISSING, OVERLAP_COLOURS, OVERSPILL, TEXT, WHITE
from .svg_text import path_data, printable

LABEL_GRID_CELLS = 1000  # along the longer side, for labels to keep clear of marks
MIN_COVERAGE = 0.05  # share of a cell: less is a rounding error
RING_RADIUS = 0.6  # of the ring around a place, in letter heights
DIGIT_WIDTH = 0.65  # in letter heights


def overlap_svg(
    target: list,
    painted: list,
    sheet_mm: tuple[float, float],
    title: str = "",
    places: Mapping[int, tuple[float, float]] | None = None,
) -> str:
    """Draw where paint is missing and where there is too much paint.

    Lengths are millimetres of the sheet, and the picture is at least as wide as its legend. target, painted: rings of
    everything that was drawn, and of all paint; places: number -> (x, y) on the sheet, shown with rings and numbers.
    """
    width, height = sheet_mm
    size = max(2.0, 0.018 * max(width, height))
    data = {
        name: "".join(path_data(ring, height) for ring in rings)
        for name, rings in (("wanted", target), ("painted", painted))
    }
    foot = height + 2.5 * size
    entry_widths = [size * (3.0 + 0.55 * len(words)) for _, words in OVERLAP_COLOURS]
    across = max(width, sum(entry_widths))
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{across:g}mm" height="{foot:g}mm" '
        f'viewBox="0 0 {across:g} {foot:g}">',
        f"<title>{escape(printable(title), quote=False)}</title>",
        f'<clipPath id="wanted"><path d="{data["wanted"]}"/></clipPath>',
        f'<rect width="{across:g}" height="{foot:g}" fill="{WHITE}"/>',
        f'<path fill="{MISSING}" d="{data["wanted"]}"/>',
        f'<path fill="{OVERSPILL}" d="{data["painted"]}"/>',
        f'<path fill="{BOTH}" clip-path="url(#wanted)" d="{data["painted"]}"/>',
    ]
    lines += _number_places([*target, *painted], sheet_mm, places, size) if places else []
    x = size
    for (colour, words), entry_width in zip(OVERLAP_COLOURS, entry_widths, strict=True):
        lines.append(f'<rect x="{x:g}" y="{height + size:g}" width="{size:g}" height="{size:g}" fill="{colour}"/>')
        lines.append(
            f'<text x="{x + 1.5 * size:g}" y="{height + 1.85 * size:g}" font-family="sans-serif" '
            f'font-size="{size:g}" fill="{TEXT}">{words}</text>'
        )
        x += entry_width
    return "\n".join([*lines, "</svg>", ""])


def _number_places(rings: list, sheet_mm, places: Mapping[int, tuple[float, float]], size: float) -> list[str]:
    """Return the SVG elements of a ring and a number at each place."""
    width, height = sheet_mm
    cells = LABEL_GRID_CELLS / max(width, height)
    marks = _core.coverage(rings, (0.0, 0.0, width, height), cells) > MIN_COVERAGE
    down = {number: (x, height - y) for number, (x, y) in places.items()}
    bounds = (0.0, 0.0, width, height)
    space = LabelSpace(marks, 1 / cells, bounds, [*down.values()], RING_RADIUS * size)
    lines = [f'<g class="places" stroke="{TEXT}" stroke-width="{size / 12:.3g}" fill="none">']
    texts = []
    for number, (x, y) in down.items():
        lines.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{RING_RADIUS * size:.3g}"/>')
        label = space.place((x, y), [(DIGIT_WIDTH * size * len(str(number)), size)])
        if label.leader:
            lines.append('<path d="M{:.2f},{:.2f}L{:.2f},{:.2f}"/>'.format(*label.leader[0], *label.leader[1]))
        at = f'x="{label.left:.2f}" y="{label.top + 0.86 * size:.2f}"'
        texts.append(f'<text {at} font-family="sans-serif" font-weight="bold" font-size="{size:g}">{number}</text>')
    return [*lines, "</g>", *texts]
