"""Trace the outlines of paint in a picture, as rings in mm."""

from __future__ import annotations

import cv2
import numpy as np

from ..geometry.rings import signed_area

UPSAMPLING = 4  # enlargement of the picture, to place edges between pixels by their brightness


def mask_outlines(paint: np.ndarray, level: float, mm_per_px: float, left_top_mm, least_mm2: float = 0.5) -> list:
    """Return rings (n, 2) [mm] around the areas above a level, y up.

    Outer rings are counter-clockwise, holes clockwise. paint: (rows, columns) amount of paint in each pixel, row 0 at
    the top; left_top_mm: the picture's upper left corner, which is a corner of a pixel and not its centre; least_mm2:
    parts and holes with a smaller area are left out.
    """
    border = cv2.copyMakeBorder(np.float32(paint), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0.0)
    fine = cv2.resize(border, None, fx=UPSAMPLING, fy=UPSAMPLING, interpolation=cv2.INTER_LINEAR)
    above = np.uint8(fine > level)
    contours, tree = cv2.findContours(above, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    rings = []
    for points, (_, _, _, parent) in zip(contours, tree[0] if tree is not None else [], strict=True):
        ring = points[:, 0, :].astype(float)
        if len(ring) < 3 * UPSAMPLING:
            continue
        # The contour runs through the centres of the outermost painted pixels, for a hole of those around the hole.
        # It is moved by half a pixel to their outer edges.
        before, after = np.roll(ring, 2, axis=0), np.roll(ring, -2, axis=0)
        along = after - before
        along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
        ring = ring + 0.5 * np.column_stack([-along[:, 1], along[:, 0]]) * _outward_sign(ring, parent < 0)
        mm = ((ring + 0.5) / UPSAMPLING - 1.0) * mm_per_px * [1, -1] + np.asarray(left_top_mm, float)
        area = signed_area(mm)
        if abs(area) < least_mm2:
            continue
        rings.append(mm if (area > 0) == (parent < 0) else mm[::-1])
    return rings


def _outward_sign(ring: np.ndarray, outer: bool) -> float:
    """Return the sign of the normal that points away from the paint.

    The normal of a direction (x, y) along the ring is (-y, x).
    """
    return (-1.0 if signed_area(ring) > 0 else 1.0) * (1.0 if outer else -1.0)
