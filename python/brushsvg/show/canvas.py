"""Draw areas, lines and text once, and write them as SVG or PNG."""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.sax.saxutils import escape

import numpy as np

from ..read.text.text_runs import LEFT_TO_RIGHT_MARK
from .picture_colours import TEXT, WHITE

FONT_PX = 20


@dataclass
class Canvas:
    """The items to draw, in order, in px with y down.

    An item is ("area", rings, colour, opacity), ("line", points, colour, width, class in an SVG) or
    ("text", (x, y), words, colour, size). px_per_mm: the scale at which an SVG is shown; None for one px per px.
    """

    width: float
    height: float = 0.0
    background: str = WHITE
    px_per_mm: float | None = None
    items: list[tuple] = field(default_factory=list)

    def area(self, rings, colour: str, opacity: float = 1.0) -> None:
        if rings:
            self.items.append(("area", rings, colour, opacity))

    def line(self, points: np.ndarray, colour: str, width: float, name: str = "") -> None:
        self.items.append(("line", points, colour, width, name))

    def dot(self, centre, radius: float, colour: str) -> None:
        angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
        self.area([centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])], colour)

    def text(self, x: float, y: float, words: str, colour: str = TEXT, size: int = FONT_PX) -> None:
        words = "".join(letter if letter.isprintable() or letter == LEFT_TO_RIGHT_MARK else " " for letter in words)
        self.items.append(("text", (x, y), words, colour, size))


def draw_canvas(suffix: str, canvas: Canvas) -> bytes:
    """Return the bytes of an .svg or a .png."""
    return _write_svg(canvas).encode() if suffix == ".svg" else _write_png(canvas)


def _write_svg(canvas: Canvas) -> str:
    w, h = f"{canvas.width:.0f}", f"{canvas.height:.0f}"
    size = f'width="{w}" height="{h}"'
    if canvas.px_per_mm:
        size = f'width="{canvas.width / canvas.px_per_mm:.6g}mm" height="{canvas.height / canvas.px_per_mm:.6g}mm"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="0 0 {w} {h}">',
        f'<rect width="100%" height="100%" fill="{canvas.background}"/>',
    ]
    for kind, *item in canvas.items:
        if kind == "area":
            rings, colour, opacity = item
            data = "".join(_path_data(ring) + "Z" for ring in rings)
            lines.append(f'<path d="{data}" fill="{colour}" fill-opacity="{opacity:g}"/>')
        elif kind == "line":
            points, colour, width, name = item
            named = f'class="{name}" ' * bool(name)
            lines.append(
                f'<path {named}d="{_path_data(points)}" fill="none" stroke="{colour}" stroke-width="{width:g}"/>'
            )
        else:
            (x, y), words, colour, size = item
            style = f'font-family="sans-serif" font-size="{size}" fill="{colour}" xml:space="preserve"'
            lines.append(f'<text x="{x:.1f}" y="{y:.1f}" {style}>{escape(words)}</text>')
    return "\n".join([*lines, "</svg>", ""])


def _path_data(points: np.ndarray) -> str:
    flat = (np.round(points, 2) + 0.0).ravel().tolist()
    return ("M" + "L".join(["%.2f,%.2f"] * len(points))) % tuple(flat)


def _write_png(canvas: Canvas) -> bytes:
    import cv2  # takes a tenth of a second, and an SVG does not need it

    from .png_canvas import SUB_PIXEL_BITS, bgr, blank_canvas, encode_png, write_text

    image = blank_canvas((round(canvas.height), round(canvas.width)), canvas.background)
    for kind, *item in canvas.items:
        if kind == "area":
            _fill_area(image, *item)
        elif kind == "line":
            points, colour, width, _ = item
            fixed = np.round((points - 0.5) * 2**SUB_PIXEL_BITS).astype(np.int32).reshape(-1, 1, 2)
            cv2.polylines(image, [fixed], False, bgr(colour), max(1, round(width)), cv2.LINE_AA, SUB_PIXEL_BITS)
        else:
            (x, y), words, colour, size = item
            write_text(image, words, (round(x), round(y)), size, 400, colour)
    return encode_png(image)


def _fill_area(image: np.ndarray, rings, colour: str, opacity: float) -> None:
    import cv2

    from .png_canvas import SUB_PIXEL_BITS, blend

    points = np.vstack(rings)
    height, width = image.shape[:2]
    x0, y0 = np.clip(np.floor(points.min(axis=0)), 0, (width - 1, height - 1)).astype(int)
    x1, y1 = np.clip(np.ceil(points.max(axis=0)) + 1, (x0 + 1, y0 + 1), (width, height)).astype(int)
    mask = np.zeros((y1 - y0, x1 - x0), np.uint8)
    fixed = [np.round((ring - (x0 + 0.5, y0 + 0.5)) * 2**SUB_PIXEL_BITS).astype(np.int32) for ring in rings]
    cv2.fillPoly(mask, fixed, 255, cv2.LINE_AA, SUB_PIXEL_BITS)
    blend(image[y0:y1, x0:x1], mask / 255.0 * opacity, colour)
