"""Define the vpype commands `brush` and `brushwrite`.

`brush` replaces lines by the marks that a brush will paint. `brushwrite` writes the robot program for the
marks.
"""

from __future__ import annotations

import re
from xml.sax.saxutils import quoteattr

import click
import numpy as np
import vpype
import vpype_cli

import brushsvg
from brushsvg.read import InMemory

MM_PER_PX = 25.4 / 96
# A polyline has a corner where it turns by more. vpype flattens curves to 0.1 mm: a circle of 1 mm then turns
# by 50 degrees, one of 2 mm by 36 degrees.
CORNER_RAD = np.radians(40)
MARGIN_MM = 20.0  # around the lines if there is no page
_ID = re.compile(r"layer(\d+)-")


def choices(command):
    """Add the options that both commands have."""
    for option in (
        click.option("--brush", "brush_name", default="round-6", metavar="NAME|FILE", help="default: round-6"),
        click.option("--compensation", type=click.Choice(("none", "constant", "closed", "refined")), default="closed"),
        click.option("--tolerance", type=click.FloatRange(1e-5, 10), default=0.05, help="mm; default: 0.05"),
        click.option("--start", type=click.Choice(("pointed", "round", "butt", "auto")), default="auto"),
        click.option("--end", type=click.Choice(("pointed", "round", "butt", "auto")), default="auto"),
        click.option("--width", type=vpype_cli.LengthType(), help="of all marks; default: the layers' pen widths"),
    ):
        command = option(command)
    return command


@click.command()
@choices
@vpype_cli.global_processor
def brush(document, brush_name, compensation, tolerance, start, end, width):
    """Replace lines by the outlines of the marks that a brush paints along them."""
    done = _convert(
        document,
        width,
        brush=brush_name,
        compensation=compensation,
        tolerance=tolerance,
        start=start,
        end=end,
    )
    found = brushsvg.find_brush(brush_name)
    marks = brushsvg.simulate(done.plan, found)
    brushsvg.trace_outlines(marks, found)
    height_mm = done.plan.sheet_mm[1]
    left, top = _origin_px(document)
    outlines: dict[int, list] = {layer: [] for layer in document.layers}
    for trace in marks.passes:
        for ring in trace.outline_mm:
            closed = np.vstack([ring, ring[:1]])
            x, y = closed[:, 0] / MM_PER_PX + left, (height_mm - closed[:, 1]) / MM_PER_PX + top
            outlines[int(_ID.match(trace.stroke)[1])].append(x + 1j * y)
    for layer, lines in outlines.items():
        document.layers[layer] = document.layers[layer].clone(lines)
    return document


@click.command()
@click.argument("output", type=click.Path(dir_okay=False))
@click.option("--cell", metavar="NAME|FILE", help="the machine; default: linuxcnc-3axis")
@choices
@vpype_cli.global_processor
def brushwrite(document, output, cell, brush_name, compensation, tolerance, start, end, width):
    """Write the robot program (or plan.json) with which a brush paints the lines."""
    _convert(
        document,
        width,
        out=output,
        cell=cell,
        brush=brush_name,
        compensation=compensation,
        tolerance=tolerance,
        start=start,
        end=end,
    )
    return document


def _convert(document, width_px, **choices) -> brushsvg.Conversion:
    """Convert the document's lines like `brushsvg convert`, with warnings on stderr."""
    drawing = InMemory(".svg", _svg(document, width_px).encode())
    try:
        done = brushsvg.convert(drawing, **choices)
    except brushsvg.Error as refused:
        raise _sentence(refused) from None
    for notice in done.notices:
        click.echo("brushsvg: " + ": ".join(filter(None, (notice.where, notice.sentence))), err=True)
    return done


def _sentence(refused: brushsvg.Error) -> click.ClickException:
    return click.ClickException(": ".join(filter(None, (refused.file, refused.where, str(refused)))))


def _origin_px(document) -> tuple[float, float]:
    if document.page_size:
        return 0.0, 0.0
    x0, y0, _, _ = document.bounds() or (0.0, 0.0, 0.0, 0.0)
    return x0 - MARGIN_MM / MM_PER_PX, y0 - MARGIN_MM / MM_PER_PX


def _svg(document, width_px: float | None) -> str:
    left, top = _origin_px(document)
    if document.page_size:
        width, height = document.page_size
    else:
        x0, y0, x1, y1 = document.bounds() or (0.0, 0.0, 0.0, 0.0)
        width, height = (b - a + 2 * MARGIN_MM / MM_PER_PX for a, b in ((x0, x1), (y0, y1)))
    parts = [
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
        f'width="{width * MM_PER_PX:.9g}mm" height="{height * MM_PER_PX:.9g}mm" '
        f'viewBox="{left:.9g} {top:.9g} {width:.9g} {height:.9g}" fill="none">'
    ]
    for number, lines in document.layers.items():
        parts += _layer(number, lines, width_px)
    return "\n".join([*parts, "</svg>"])


def _layer(number: int, lines, width_px: float | None) -> list[str]:
    pen_px = width_px or lines.property(vpype.METADATA_FIELD_PEN_WIDTH)
    if lines and not pen_px:
        raise click.ClickException(
            f"layer {number} has no pen width: give it one (penwidth --layer {number} 3mm), or all of them by --width"
        )
    name = lines.property(vpype.METADATA_FIELD_NAME) or f"layer{number}"
    colour = lines.property(vpype.METADATA_FIELD_COLOR)
    ink = f"#{colour.red:02x}{colour.green:02x}{colour.blue:02x}" if colour is not None else "#000000"
    return [
        f'<g inkscape:groupmode="layer" inkscape:label={quoteattr(str(name))} stroke="{ink}" '
        f'stroke-width="{pen_px or 0:.9g}">',
        *(f'<path id="layer{number}-{k}" d="{_path_data(line)}"/>' for k, line in enumerate(lines, 1)),
        "</g>",
    ]


def _path_data(line: np.ndarray) -> str:
    """Return cubics through the points of a polyline, smooth except at its corners."""
    points = line[np.append(True, np.abs(np.diff(line)) > 0)]
    text = f"M{points[0].real:.12g} {points[0].imag:.12g}"
    if len(points) < 2:
        return text + "h0"
    steps = np.diff(points)
    leaving, arriving = steps.copy(), steps.copy()  # tangents at the first and last point of each segment
    lengths = np.abs(steps)
    smooth = np.flatnonzero(np.abs(np.angle(steps[1:] / steps[:-1])) < CORNER_RAD)
    for k in smooth:  # as in the circle through three points: the longer segment turns less per length
        unit = steps[k] / lengths[k] * lengths[k + 1] + steps[k + 1] / lengths[k + 1] * lengths[k]
        unit /= abs(unit)
        arriving[k], leaving[k + 1] = unit * lengths[k], unit * lengths[k + 1]
    first, last = points[:-1] + leaving / 3, points[1:] - arriving / 3
    is_straight = (leaving == steps) & (arriving == steps)
    rows = np.column_stack([first.real, first.imag, last.real, last.imag, points[1:].real, points[1:].imag])
    return text + "".join(
        ("L" if straight else "C") + " ".join(f"{value:.12g}" for value in (row[4:] if straight else row))
        for row, straight in zip(rows, is_straight, strict=True)
    )
