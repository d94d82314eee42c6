"""Locate a mark in a picture of paint: shifted, turned and wider than predicted, by least squares of its pixels."""

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

BLURS_MM = (1.2, 0.5, 0.2)  # coarse to fine: a mark is found from as far as the first is wide
ROUNDS = (
    20  # at each; most marks rest after 6, those of hairy strokes that are unlike their prediction after 15
)
MOST_GROWN_MM = 1.0  # in one step
TURN_WEIGHT = 3000.0  # of no turn, against what pixels say: rings and dots show none
MOST_MM = 8.0  # a step goes no further: beyond, nothing was found


@dataclass(frozen=True)
class Placed:
    """The place of a mark relative to its prediction: shift_mm of its middle, turn_rad about it, counter-clockwise,
    wider_mm: by how much each edge is further from the middle line. found: whether least squares came to rest within
    reach."""

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
    """Pixels over a window of the sheet: left, bottom, right, top [mm], row 0 on top."""

    window_mm: tuple[float, float, float, float]
    px_per_mm: float

    @property
    def shape(self) -> tuple[int, int]:
        left, bottom, right, top = self.window_mm
        return round((top - bottom) * self.px_per_mm), round((right - left) * self.px_per_mm)

    def filled(self, rings: list[np.ndarray]) -> np.ndarray:
        """Share of each pixel that rings cover together, holes (clockwise) left out."""
        rows, columns = self.shape
        left, _, _, top = self.window_mm
        window = (left, top - rows / self.px_per_mm, columns / self.px_per_mm, rows / self.px_per_mm)
        return np.asarray(_core.coverage(rings, window, self.px_per_mm), np.float32)

    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """x (columns,) and y (rows,) of the middles of pixels."""
        rows, columns = self.shape
        left, _, _, top = self.window_mm
        x = left + (np.arange(columns) + 0.5) / self.px_per_mm
        return x, top - (np.arange(rows) + 0.5) / self.px_per_mm


def grown(rings: list[np.ndarray], by_mm: float) -> list[np.ndarray]:
    """Return rings with their edges moved out by so much; none where nothing is left."""
    if abs(by_mm) < 1e-6:
        return rings
    outer = [Polygon(ring).buffer(0) for ring in rings if signed_area(ring) > 0]
    holes = [Polygon(ring).buffer(0) for ring in rings if signed_area(ring) < 0]
    shape = unary_union(outer).difference(unary_union(holes)).buffer(by_mm)
    parts = [part for part in getattr(shape, "geoms", [shape]) if not part.is_empty]
    around = [np.array(orient(part).exterior.coords)[:-1] for part in parts]
    return around + [np.array(hole.coords)[:-1] for part in parts for hole in orient(part).interiors]


def place(
    paint: np.ndarray, free: np.ndarray, rings: list[np.ndarray], canvas: Canvas, turns: bool = True
) -> Placed:
    """paint: share of paint of each pixel of the canvas; free: pixels in which other marks have no say.

    Gauss-Newton on redrawn rings: a shift changes a picture by its slope, growing edges by the slope's size.
    """
    middle = centroid(rings)
    x, y = canvas.places()
    now = np.zeros(4)
    settled = False
    for blur_mm in BLURS_MM:
        sigma = blur_mm * canvas.px_per_mm
        seen = cv2.GaussianBlur(np.clip(paint, 0, 1), None, sigma)
        weight = free.astype(np.float32)
        for _ in range(ROUNDS):
            placed = Placed((now[0], now[1]), now[2], now[3], True)
            moved = [placed.moved(ring, middle) for ring in grown(rings, now[3])]
            shown = cv2.GaussianBlur(canvas.filled(moved), None, sigma)
            slope_x = cv2.Sobel(shown, cv2.CV_32F, 1, 0, scale=1 / 8) * canvas.px_per_mm
            slope_y = -cv2.Sobel(shown, cv2.CV_32F, 0, 1, scale=1 / 8) * canvas.px_per_mm
            size = np.hypot(slope_x, slope_y)
            here = (size > 1e-3) & (weight > 0)
            if here.sum() < 20:
                return NOWHERE
            left, up = np.meshgrid(x - middle[0] - now[0], y - middle[1] - now[1])
            columns = [-slope_x, -slope_y, slope_x * up - slope_y * left, size]
            if not turns:
                columns[2] = np.zeros_like(size)
            slopes = np.column_stack([column[here] for column in columns])
            off = (seen - shown)[here]
            prior = np.array([0.0, 0.0, TURN_WEIGHT, 0.0])
            normal = slopes.T @ slopes + np.diag(prior + 1e-6)
            step = np.linalg.lstsq(normal, slopes.T @ off - prior * now, rcond=None)[0]
            length = float(np.hypot(*step[:2]))
            step[:3] *= min(1.0, 1.5 * blur_mm / max(length, 1e-9))
            now = now + np.append(step[:3], np.clip(step[3], -MOST_GROWN_MM, MOST_GROWN_MM))
            if np.hypot(*now[:2]) > MOST_MM or not grown(rings, now[3]):
                return NOWHERE
            settled = length < 0.01 and abs(step[3]) < 0.02
            if length < 0.003 and abs(step[3]) < 0.003:
                break
    return Placed((float(now[0]), float(now[1])), float(now[2]), float(now[3]), bool(settled))
