"""Find where paint and drawing differ most: connected areas that are thick enough to be seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

MAX_AREAS = 5
MIN_THICKNESS_MM = 0.2  # thinner slivers along an edge are hard to see
MIN_AREA_MM2 = 0.1
JOIN_MM = 0.25  # areas of one stroke with a smaller gap are one place


@dataclass(frozen=True)
class WorstArea:
    """An area near one stroke where paint and drawing differ.

    stroke: number of the stroke; at_mm: the thickest place of the area; missing_mm2: target without paint; outside_mm2:
    paint outside the target.
    """

    stroke: int
    at_mm: tuple[float, float]
    missing_mm2: float
    outside_mm2: float

    @property
    def area_mm2(self) -> float:
        return self.missing_mm2 + self.outside_mm2

    @property
    def is_missing(self) -> bool:
        """Whether most of the area is target without paint."""
        return self.missing_mm2 >= self.outside_mm2

    @property
    def words(self) -> str:
        """The size of the area in words. For example, "1.2 mm^2 unpainted, 0.3 mm^2 painted outside"."""
        parts = (self.missing_mm2, "unpainted"), (self.outside_mm2, "painted outside")
        named = [f"{mm2:.{1 if mm2 < 10 else 0}f} mm^2 {what}" for mm2, what in parts if mm2 >= MIN_AREA_MM2 / 2]
        return ", ".join(named if self.is_missing else named[::-1])


def worst_areas(
    target: np.ndarray,
    painted: np.ndarray,
    corner_mm: tuple[float, float],
    px_per_mm: float,
    lines_mm: Sequence[np.ndarray],
    most: int = MAX_AREAS,
) -> list[WorstArea]:
    """Return the largest differences first.

    target, painted: (rows, columns) covered share of each pixel; corner_mm: the upper left corner of the picture, y up;
    lines_mm: a line (n, 2) along each stroke. Each difference belongs to the nearest line.
    """
    differences = target - painted
    size = max(2, round(MIN_THICKNESS_MM * px_per_mm))
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    missing, outside = (
        cv2.morphologyEx((sign * differences > 0.5).astype(np.uint8), cv2.MORPH_OPEN, kernel) for sign in (1, -1)
    )
    differs = missing | outside
    rows, columns = np.nonzero(differs)
    if not len(rows) or not lines_mm:
        return []
    join = max(3, round(2 * JOIN_MM * px_per_mm) | 1)
    joined = cv2.dilate(differs, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (join, join)))
    _, components = cv2.connectedComponents(joined, connectivity=8)
    nearest = _nearest_line(differs.shape, corner_mm, px_per_mm, lines_mm)
    keys = components[rows, columns].astype(np.int64) * len(lines_mm) + nearest[rows, columns]
    _, group = np.unique(keys, return_inverse=True)
    sums = [np.bincount(group, weights=mask[rows, columns]) / px_per_mm**2 for mask in (missing, outside)]
    thickness = np.maximum(*(cv2.distanceTransform(mask, cv2.DIST_L2, 3) for mask in (missing, outside)))
    areas = []
    for k in np.argsort(-(sums[0] + sums[1]), kind="stable")[:most]:
        missing_mm2, outside_mm2 = (float(values[k]) for values in sums)
        if missing_mm2 + outside_mm2 < MIN_AREA_MM2:
            break
        mask = missing if missing_mm2 >= outside_mm2 else outside
        area_px = np.flatnonzero((group == k) & (mask[rows, columns] > 0))
        at = area_px[thickness[rows[area_px], columns[area_px]].argmax()]
        x = corner_mm[0] + (columns[at] + 0.5) / px_per_mm
        y = corner_mm[1] - (rows[at] + 0.5) / px_per_mm
        stroke = int(nearest[rows[at], columns[at]])
        areas.append(WorstArea(stroke, (float(x), float(y)), missing_mm2, outside_mm2))
    return areas


def _nearest_line(shape, corner_mm, px_per_mm: float, lines_mm) -> np.ndarray:
    """Return the number of the nearest line for each pixel."""
    drawn = np.zeros(shape, np.int32)
    for number, line in enumerate(lines_mm):
        at = (np.asarray(line, float)[:, :2] - corner_mm) * (px_per_mm, -px_per_mm) - 0.5
        pixels = np.round(np.vstack([at, at[-1:]])).astype(np.int32)  # of one point alone, nothing would be drawn
        cv2.polylines(drawn, [pixels.reshape(-1, 1, 2)], False, number + 1)
    is_line = drawn > 0
    if not is_line.any():
        return np.zeros(shape, np.int32)
    _, labels = cv2.distanceTransformWithLabels(
        (~is_line).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    numbers = np.zeros(labels.max() + 1, np.int32)
    numbers[labels[is_line]] = drawn[is_line] - 1
    return numbers[labels]
