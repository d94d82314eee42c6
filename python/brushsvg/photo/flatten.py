"""Flatten a photograph to a picture of the sheet as from a scanner, at the photograph's own resolution."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from .markers import View

GRID_STEP_PX = 32  # between places this close, the view is practically straight
MAX_PX_PER_MM = 25.0  # more adds nothing about a brush, and takes minutes


@dataclass(frozen=True)
class Flat:
    """A flattened picture of a sheet.

    pixels: (rows, columns, 3), row 0 at the sheet's upper edge. The upper left corner of the first pixel is that of the
    sheet.
    """

    pixels: np.ndarray
    px_per_mm: float
    sheet_mm: tuple[float, float]

    def to_px(self, mm: np.ndarray) -> np.ndarray:
        """Map points (n, 2) of the sheet to pixels. (0, 0) is the middle of the upper left pixel."""
        return (np.asarray(mm) * [1, -1] + [0, self.sheet_mm[1]]) * self.px_per_mm - 0.5


def flatten(pixels: np.ndarray, view: View, sheet_mm: tuple[float, float], px_per_mm: float | None = None) -> Flat:
    """Flatten a photograph of a sheet.

    The resolution is that of the photograph unless px_per_mm is given.
    """
    resolution = px_per_mm or min(view.px_per_mm, MAX_PX_PER_MM)
    columns, rows = (round(side * resolution) for side in sheet_mm)
    across, down = (math.ceil(count / GRID_STEP_PX) + 2 for count in (columns, rows))
    # The nodes are where resizing places the middles of the coarse pixels.
    x = ((np.arange(across) - 0.5) * GRID_STEP_PX) / resolution
    y = sheet_mm[1] - ((np.arange(down) - 0.5) * GRID_STEP_PX) / resolution
    nodes = view.to_px(np.column_stack([np.tile(x, down), np.repeat(y, across)])).astype(np.float32)
    size = (across * GRID_STEP_PX, down * GRID_STEP_PX)
    inside = (slice(GRID_STEP_PX, GRID_STEP_PX + rows), slice(GRID_STEP_PX, GRID_STEP_PX + columns))
    maps = [cv2.resize(nodes[:, k].reshape(down, across), size, interpolation=cv2.INTER_LINEAR)[inside] for k in (0, 1)]
    flattened = cv2.remap(pixels, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return Flat(flattened, resolution, sheet_mm)
