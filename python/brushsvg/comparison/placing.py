"""Locate a mark in a picture of paint, by least squares of its pixels.

A mark may be shifted, turned and wider relative to its prediction.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from shapely.geometry import Polygon
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from .. import _core
from ..geometry.rings import centroid, signed_area
from ..geometry.rotation import rotation

# Widths of blur from coarse to fine: the first one is how far away a mark can be found.
BLURS_MM = (1.2, 0.5, 0.2)
# Most marks converge after 6 steps. Marks of hairy strokes that are unlike their prediction converge after 15.
MAX_STEPS_PER_BLUR = 20
MAX_WIDER_STEP_MM = 1.0  # largest change of wider_mm in one step
TURN_WEIGHT = 3000.0  # weight of the prior turn of 0 against the pixels: rings and dots do not show their turn
MAX_SHIFT_MM = 8.0  # largest shift: beyond it, the mark counts as not found


@dataclass(frozen=True)
class Placed:
    """The place of a mark relative to its prediction.

    shift_mm: shift of its middle; turn_rad: counter-clockwise turn about its middle; wider_mm: how much further each
    edge is from the middle line; found: whether least squares converged within reach.
    """

    shift_mm: tuple[float, float]
    turn_rad: float
    wider_mm: float
    found: bool

    def moved(self, points_mm: np.ndarray, middle_mm: np.ndarray) -> np.ndarray:
        """Return (n, 2) points of the prediction, at their true places."""
        return (points_mm - middle_mm) @ rotation(self.turn_rad) + middle_mm + self.shift_mm


NOWHERE = Placed((0.0, 0.0), 0.0, 0.0, False)


@dataclass(frozen=True)
class Canvas:
    """Pixels over a window of the sheet, with row 0 at the top.

    window_mm: left, bottom, right and top [mm].
    """

    window_mm: tuple[float, float, float, float]
    px_per_mm: float

    @property
    def shape(self) -> tuple[int, int]:
        left, bottom, right, top = self.window_mm
        return round((top - bottom) * self.px_per_mm), round((right - left) * self.px_per_mm)

    def filled(self, rings: list[np.ndarray]) -> np.ndarray:
        """Return the share of each pixel that the rings cover together. Clockwise rings are holes."""
        rows, columns = self.shape
        left, _, _, top = self.window_mm
        window = (left, top - rows / self.px_per_mm, columns / self.px_per_mm, rows / self.px_per_mm)
        return np.asarray(_core.coverage(rings, window, self.px_per_mm), np.float32)

    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """Return x (columns,) and y (rows,) of the middles of pixels [mm]."""
        rows, columns = self.shape
        left, _, _, top = self.window_mm
        x = left + (np.arange(columns) + 0.5) / self.px_per_mm
        return x, top - (np.arange(rows) + 0.5) / self.px_per_mm


def grow_rings(rings: list[np.ndarray], by_mm: float) -> list[np.ndarray]:
    """Return rings with their edges moved outward by by_mm. The list is empty where nothing remains."""
    if abs(by_mm) < 1e-6:
        return rings
    outer = [Polygon(ring).buffer(0) for ring in rings if signed_area(ring) > 0]
    holes = [Polygon(ring).buffer(0) for ring in rings if signed_area(ring) < 0]
    shape = unary_union(outer).difference(unary_union(holes)).buffer(by_mm)
    parts = [part for part in getattr(shape, "geoms", [shape]) if not part.is_empty]
    around = [np.array(orient(part).exterior.coords)[:-1] for part in parts]
    return around + [np.array(hole.coords)[:-1] for part in parts for hole in orient(part).interiors]


def locate_mark(
    paint: np.ndarray, free: np.ndarray, rings: list[np.ndarray], canvas: Canvas, turns: bool = True
) -> Placed:
    """Locate the mark of predicted rings in a picture of paint.

    paint: share of paint of each pixel of the canvas; free: pixels that other marks do not affect; turns: whether the
    mark may be turned. Gauss-Newton on redrawn rings: a shift changes a picture by its gradient, and growing edges
    change it by the magnitude of the gradient.
    """
    middle = centroid(rings)
    x, y = canvas.places()
    estimate = np.zeros(4)
    settled = False
    for blur_mm in BLURS_MM:
        sigma = blur_mm * canvas.px_per_mm
        blurred_paint = cv2.GaussianBlur(np.clip(paint, 0, 1), None, sigma)
        weight = free.astype(np.float32)
        for _ in range(MAX_STEPS_PER_BLUR):
            placed = Placed((estimate[0], estimate[1]), estimate[2], estimate[3], True)
            moved = [placed.moved(ring, middle) for ring in grow_rings(rings, estimate[3])]
            blurred_mark = cv2.GaussianBlur(canvas.filled(moved), None, sigma)
            slope_x = cv2.Sobel(blurred_mark, cv2.CV_32F, 1, 0, scale=1 / 8) * canvas.px_per_mm
            slope_y = -cv2.Sobel(blurred_mark, cv2.CV_32F, 0, 1, scale=1 / 8) * canvas.px_per_mm
            size = np.hypot(slope_x, slope_y)
            used = (size > 1e-3) & (weight > 0)
            if used.sum() < 20:
                return NOWHERE
            left, up = np.meshgrid(x - middle[0] - estimate[0], y - middle[1] - estimate[1])
            columns = [-slope_x, -slope_y, slope_x * up - slope_y * left, size]
            if not turns:
                columns[2] = np.zeros_like(size)
            slopes = np.column_stack([column[used] for column in columns])
            difference = (blurred_paint - blurred_mark)[used]
            prior = np.array([0.0, 0.0, TURN_WEIGHT, 0.0])
            normal = slopes.T @ slopes + np.diag(prior + 1e-6)
            step = np.linalg.lstsq(normal, slopes.T @ difference - prior * estimate, rcond=None)[0]
            length = float(np.hypot(*step[:2]))
            step[:3] *= min(1.0, 1.5 * blur_mm / max(length, 1e-9))
            estimate = estimate + np.append(step[:3], np.clip(step[3], -MAX_WIDER_STEP_MM, MAX_WIDER_STEP_MM))
            if np.hypot(*estimate[:2]) > MAX_SHIFT_MM or not grow_rings(rings, estimate[3]):
                return NOWHERE
            settled = length < 0.01 and abs(step[3]) < 0.02
            if length < 0.003 and abs(step[3]) < 0.003:
                break
    return Placed((float(estimate[0]), float(estimate[1])), float(estimate[2]), float(estimate[3]), bool(settled))
