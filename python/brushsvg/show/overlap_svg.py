"""Where paint is missing and where there is too much of it, as an SVG; and the colours of such pictures."""

from __future__ import annotations

from html import escape

from .svg_text import path_data, printable

BOTH, MISSING, SPILT = "#b4b8c0", "#d1431f", "#2f6fd0"
OVERLAP_COLOURS = (
    (BOTH, "painted as wanted"),
    (MISSING, "wanted, not painted"),
    (SPILT, "painted, not wanted"),
)


def overlap_svg(target: list, painted: list, sheet_mm: tuple[float, float], title: str = "") -> str:
    """Where paint is missing and where there is too much of it, in OVERLAP_COLOURS, in millimetres of the sheet.

    wanted, painted: rings of all that was drawn, and of all paint.
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
