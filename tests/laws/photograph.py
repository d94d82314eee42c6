"""Photographs of painted charts and jobs, by the package's renderer, which knows nothing of the reader. What is printed
on them is drawn here, marker by marker from its bits. Lengths in mm, sheets with y up.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np

from brushsvg.simulated.camera import (
    BLUE,
    INK,
    TEXELS,
    Camera,
    Sheet,
    _blurred,
    box,
    coded,
    corners_seen,
    encoded,
    exposed,
    photograph,
)

TEXT = np.array([0.46, 0.46, 0.46])


def page(made, seed=0):
    """The printed chart: markers by their bits, the bar, and bars in place of letters. Its paint is the caller's."""
    return deepcopy(_printed(made.plan.sheet_mm, made.dictionary, made.markers, made.bar, made.labels, seed))


@lru_cache(maxsize=1)  # tests of a file paint on the same page, which is of a hundred megabytes
def _printed(sheet_mm, dictionary_name, markers, bar, labels, seed):
    sheet = Sheet(sheet_mm, seed)
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary_name))
    bits = dictionary.markerSize + 2
    for marker in markers:
        black = cv2.aruco.generateImageMarker(dictionary, marker.id, bits) == 0
        corners = np.array(marker.corners_mm)
        right, down = (corners[1] - corners[0]) / bits, (corners[3] - corners[0]) / bits
        for row, column in np.argwhere(black):
            at = corners[0] + column * right + row * down
            sheet.paint([np.array([at, at + right, at + right + down, at + down])], INK)
    if bar:
        (x, y), length = bar.at_mm, bar.length_mm
        sheet.paint([box(x, y - 0.15, x + length, y + 0.15)], INK)
    for label in labels:
        x, y = label.at_mm
        size = min(2.3, label.width_mm / (0.6 * len(label.text)))
        for k in range(len(label.text)):
            at = x + 0.6 * size * k
            sheet.paint([box(at + 0.1, y, at + 0.3, y + 0.7 * size)], TEXT)
            sheet.paint([box(at + 0.1, y, at + 0.45 * size, y + 0.2)], TEXT)
    return sheet


def with_turn(jpeg, orientation):
    """A JPEG whose EXIF says how the camera was held."""
    tiff = b"MM\x00*\x00\x00\x00\x08\x00\x01\x01\x12\x00\x03\x00\x00\x00\x01\x00" + bytes([orientation]) + b"\x00" * 6
    body = b"Exif\x00\x00" + tiff
    return jpeg[:2] + b"\xff\xe1" + (len(body) + 2).to_bytes(2, "big") + body + jpeg[2:]


__all__ = [
    "BLUE",
    "INK",
    "TEXELS",
    "Camera",
    "Sheet",
    "_blurred",
    "box",
    "coded",
    "corners_seen",
    "encoded",
    "exposed",
    "page",
    "photograph",
    "replace",
    "with_turn",
]
