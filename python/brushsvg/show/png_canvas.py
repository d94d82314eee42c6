"""Draw on a picture of pixels: paper, paint blended over it, text; encode the picture as PNG."""

from __future__ import annotations

import unicodedata

import cv2
import numpy as np

from ..read.text.text_runs import sort_letters_from_the_left

PNG_LONG_SIDE_PX = 2400
SUB_PIXEL_BITS = 4  # cv2 draws lines at 1/16 px


def blank_canvas(shape: tuple[int, int], colour: str) -> np.ndarray:
    return np.full((*shape, 3), bgr(colour), np.uint8)


def blend(image: np.ndarray, coverage: np.ndarray, colour: str) -> None:
    painted = coverage > 0  # most of a page is blank
    share = coverage[painted][:, None]
    image[painted] = np.round(image[painted] * (1 - share) + np.array(bgr(colour)) * share).astype(np.uint8)


def bgr(colour: str) -> tuple[int, int, int]:
    return int(colour[5:7], 16), int(colour[3:5], 16), int(colour[1:3], 16)


def write_text(image, text: str, baseline: tuple[int, int], size: int, weight: int, colour: str) -> int:
    """Write text in OpenCV's own font; return the x [px] where the text ends."""
    text = _arrange_letters(text)
    end, _ = cv2.putText(image, text, baseline, bgr(colour), cv2.FontFace("sans"), size, weight)
    return int(end[0])


def text_width(text: str, size: int, weight: int) -> int:
    """Return how far a text reaches to the right of its start [px]."""
    text = _arrange_letters(text)
    (x, _, width, _) = cv2.getTextSize((10000, 100), text, (0, 0), cv2.FontFace("sans"), size, weight)
    return x + width


def _arrange_letters(text: str) -> str:
    """Return a text as OpenCV can write it.

    Letters and accents are composed, because OpenCV leaves out accents that stand alone, as in names from macOS.
    OpenCV writes all letters from left to right: the letters of Hebrew and Arabic words are in that order.
    """
    text = unicodedata.normalize("NFC", text)
    return text if text.isascii() else sort_letters_from_the_left(text)


def encode_png(image: np.ndarray) -> bytes:
    return cv2.imencode(".png", image)[1].tobytes()
