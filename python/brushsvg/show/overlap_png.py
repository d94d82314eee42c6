"""Where paint is missing and where there is too much of it, as a PNG."""

from __future__ import annotations

import numpy as np

from .overlap_svg import BOTH, MISSING, OVERLAP_COLOURS, SPILT
from .png_canvas import TEXT, bgr, canvas, encoded, write


def overlap_png(target: np.ndarray, painted: np.ndarray, legend: bool = True) -> bytes:
    """Where paint is missing and where there is too much of it. wanted, painted: shares of the same pixels."""
    common = np.minimum(target, painted)
    rows, columns = common.shape
    size = max(14, round(0.016 * max(rows, columns)))
    image = canvas((rows + 2 * size * legend, columns), "#ffffff")
    shares = ((common, BOTH), (target - common, MISSING), (painted - common, SPILT))
    page = np.full((rows, columns, 3), 255.0)
    for share, colour in shares:  # side by side in a pixel, not over each other
        page -= share[..., None] * (255.0 - np.array(bgr(colour)))
    image[:rows] = np.round(page).clip(0, 255).astype(np.uint8)
    if legend:
        write_legend(image, size, rows + size // 2, size)
    return encoded(image)


def write_legend(image: np.ndarray, x: int, y: int, size: int) -> None:
    """What the colours mean, from x, y (px) on, in letters of that size."""
    for colour, words in OVERLAP_COLOURS:
        image[y : y + size, x : x + size] = bgr(colour)
        x = write(image, words, (x + 3 * size // 2, y + 7 * size // 8), size, 400, TEXT) + 2 * size
