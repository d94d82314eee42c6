"""Photographs as a camera or a scanner writes them: read upright, in light instead of a screen's numbers."""

from __future__ import annotations

import cv2
import numpy as np

from ..errors import Error

PHOTOS = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".webp")
HEIC = (b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1", b"avif")  # brands of such files
LARGEST_PX = 200_000_000
# sRGB to light, of each of its 256 values: half way between paint and paper is half of the light, not of the number
_NUMBERS = np.arange(256) / 255
LIGHT = np.where(
    _NUMBERS <= 0.04045, _NUMBERS / 12.92, ((np.maximum(_NUMBERS, 0.04045) + 0.055) / 1.055) ** 2.4
).astype(np.float32)


def read_photo(data: bytes) -> np.ndarray:
    """Pixels (rows, columns, 3) of 8 bits, blue first, turned upright as the camera was held."""
    if data[4:8] == b"ftyp" and data[8:12] in HEIC:
        raise Error(
            "this is a HEIC picture, which is not read: export it as JPEG, or let the phone take JPEGs (iPhone: "
            "Settings, Camera, Formats, Most Compatible)",
            code="photo-format",
        )
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
    except cv2.error:  # larger than OpenCV reads, or broken
        pixels = None
    if pixels is None:
        raise Error(f"this is no picture that can be read; known are {' '.join(PHOTOS)}", code="photo-format")
    if pixels.shape[0] * pixels.shape[1] > LARGEST_PX:
        raise Error(
            f"the picture has {pixels.shape[1]} x {pixels.shape[0]} pixels, more than {LARGEST_PX:.0f}: scale it down",
            code="photo-too-large",
        )
    return pixels


def grey_light(pixels: np.ndarray) -> np.ndarray:
    """How much light a pixel shows, 0 to 1."""
    return cv2.LUT(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY), LIGHT)
