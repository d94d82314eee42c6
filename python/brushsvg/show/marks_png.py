"""Draw marks as PNG: a page of predicted paint."""

from __future__ import annotations

from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from ..errors import Error, require_type
from .marks_svg import LINE_WIDTH_SHARE, Band, band_letter_height, check_lines, check_picture, known_colour, travels
from .picture_colours import INTERVAL_BAND, MISSING, TEXT, TOOLPATH, WHITE
from .png_canvas import PNG_LONG_SIDE_PX, SUB_PIXEL_BITS, bgr, blank_canvas, blend, encode_png, write_text


def marks_png(
    marks: _core.Marks,
    brush: _core.Brush,
    sheet_mm: tuple[float, float],
    colours: list[str],
    band: Band | None = None,
    blank: Iterable[ArrayLike] = (),
    toolpath_mm: Iterable[ArrayLike] = (),
) -> bytes:
    """Draw the sheet with its paint, anti-aliased.

    Later colours cover earlier ones. band: the 95 % band of the marks' edges, drawn with a legend; blank: rings of the
    unpainted parts of shapes, outlined; toolpath_mm: the tool's positions (n, 2) or (n, 3) in each pass, drawn over the
    paint, thinner where the tool travels in the air. Raises Error where there is nothing to draw.
    """
    sheet_mm = check_picture(marks, sheet_mm, colours, band)
    blank, toolpath_mm = check_lines(blank, "blank"), check_lines(toolpath_mm, "toolpath_mm")
    require_type(brush, _core.Brush, "a brush")
    px_per_mm = min(20.0, PNG_LONG_SIDE_PX / max(sheet_mm))
    window = (0.0, 0.0, *sheet_mm)
    image = None
    first = 0
    for last in range(1, len(colours) + 1):
        if last < len(colours) and colours[last] == colours[first]:
            continue
        run = _core.Marks()
        run.passes = list(marks.passes[first:last])
        paint = _core.coverage(run, brush, window, px_per_mm)
        image = blank_canvas(paint.shape, WHITE) if image is None else image
        blend(image, paint, known_colour(colours[first]))
        first = last
    if image is None:
        raise Error("there is nothing to draw", code="nothing-to-show")
    thick = max(round(LINE_WIDTH_SHARE * max(image.shape[:2])), 1)

    def draw_line(points_mm, is_closed: bool, colour: str, thick_px: int) -> None:
        at = (np.asarray(points_mm)[:, :2] * (1, -1) + (0, sheet_mm[1])) * px_per_mm - 0.5
        fixed = np.round(at * 2**SUB_PIXEL_BITS).astype(np.int32).reshape(-1, 1, 2)
        cv2.polylines(image, [fixed], is_closed, bgr(colour), thick_px, cv2.LINE_AA, SUB_PIXEL_BITS)

    for ring in blank:
        draw_line(ring, True, MISSING, thick)
    for line in travels(toolpath_mm):
        draw_line(line, False, TOOLPATH, 1)
    for line in toolpath_mm:
        draw_line(line, False, TOOLPATH, thick)
    if band is not None:
        _draw_band(image, band, window, px_per_mm)
    return encode_png(image)


def _draw_band(image, band, window, px_per_mm: float) -> None:
    rows, columns = image.shape[:2]
    size = max(12, round(band_letter_height(band.words, columns, rows)))
    left, low = size, image.shape[0] - size
    for rings in filter(None, band.rings):
        blend(image, 0.45 * _core.coverage(rings, window, px_per_mm), INTERVAL_BAND)
    if any(band.rings):
        box = np.zeros(image.shape[:2])
        box[low - size : low, left : left + 2 * size] = 0.45
        blend(image, box, INTERVAL_BAND)
        left += round(2.5 * size)
    write_text(image, band.words, (left, low - round(0.15 * size)), size, 400, TEXT)
