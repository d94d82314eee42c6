"""Draw where paint is missing and where there is too much paint, as PNG."""

from __future__ import annotations

from collections.abc import Mapping

import cv2
import numpy as np

from ..reporting.label_space import LabelSpace
from .overlap_svg import MIN_COVERAGE, RING_RADIUS
from .picture_colours import BOTH, MISSING, OVERLAP_COLOURS, OVERSPILL, TEXT, WHITE
from .png_canvas import bgr, blank_canvas, encode_png, text_width, write_text


def overlap_png(
    target: np.ndarray,
    painted: np.ndarray,
    legend: bool = True,
    places: Mapping[int, tuple[float, float]] | None = None,
) -> bytes:
    """Draw where paint is missing and where there is too much paint.

    The given places are numbered, and the picture is at least as wide as its legend. target, painted: (rows, columns)
    covered share of each pixel; places: number -> (x, y) px.
    """
    common = np.minimum(target, painted)
    rows, columns = common.shape
    size = max(14, round(0.016 * max(rows, columns)))
    foot, width = (2 * size, max(columns, _legend_width(size))) if legend else (0, columns)
    image = blank_canvas((rows + foot, width), WHITE)
    shares = ((common, BOTH), (target - common, MISSING), (painted - common, OVERSPILL))
    page = np.full((rows, columns, 3), 255.0)
    for share, colour in shares:  # the shares of a pixel add up; they do not cover each other
        page -= share[..., None] * (255.0 - np.array(bgr(colour)))
    image[:rows, :columns] = np.round(page).clip(0, 255).astype(np.uint8)
    _number_places(image, np.maximum(target, painted) > MIN_COVERAGE, places or {}, size)
    if legend:
        write_legend(image, size, rows + size // 2, size)
    return encode_png(image)


def _number_places(image: np.ndarray, marks: np.ndarray, places: Mapping[int, tuple[float, float]], size: int) -> None:
    """Draw a ring around each place, and its number next to the ring."""
    space = LabelSpace(marks, anchors=[*places.values()], radius=RING_RADIUS * size)
    for number, (x, y) in places.items():
        cv2.circle(image, (round(x), round(y)), round(RING_RADIUS * size), bgr(TEXT), max(1, size // 12), cv2.LINE_AA)
        label = space.place((x, y), [(text_width(str(number), size, 700), size)])
        if label.leader:
            ends = [tuple(map(round, end)) for end in label.leader]
            cv2.line(image, *ends, bgr(TEXT), max(1, size // 12), cv2.LINE_AA)
        write_text(image, str(number), (round(label.left), round(label.top + 0.86 * size)), size, 700, TEXT)


def _legend_width(size: int) -> int:
    """Return the width [px] of the legend with its margins.

    size: height of the letters (px).
    """
    return sum(text_width(words, size, 400) + 7 * size // 2 for _, words in OVERLAP_COLOURS)


def write_legend(image: np.ndarray, x: int, y: int, size: int) -> None:
    """Write the meaning of the colours from x, y (px) on.

    size: height of the letters (px).
    """
    for colour, words in OVERLAP_COLOURS:
        image[y : y + size, x : x + size] = bgr(colour)
        x = write_text(image, words, (x + 3 * size // 2, y + 7 * size // 8), size, 400, TEXT) + 2 * size
