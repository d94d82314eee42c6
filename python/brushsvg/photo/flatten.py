"""A photograph as if the sheet were flat under a scanner: in mm of the sheet, as fine as the photograph is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from .markers import View

COARSE = 32  # px: between places so far apart a view is as good as straight
MOST_PX_PER_MM = 25.0  # finer says nothing of a brush, and takes minutes


@dataclass(frozen=True)
class Flat:
    """pixels (rows, columns, 3), row 0 at the sheet's upper edge, whose upper left corner is that of the first one."""

    pixels: np.ndarray
    px_per_mm: float
    sheet_mm: tuple[float, float]

    def to_px(self, mm: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the sheet, (0, 0) the middle of the upper left pixel."""
        return (np.asarray(mm) * [1, -1] + [0, self.sheet_mm[1]]) * self.px_per_mm - 0.5


def flatten(
    pixels: np.ndarray, view: View, sheet_mm: tuple[float, float], px_per_mm: float | None = None
) -> Flat:
    """As fine as the photograph is unless a resolution is given."""
    fine = px_per_mm or min(view.px_per_mm, MOST_PX_PER_MM)
    columns, rows = (round(side * fine) for side in sheet_mm)
    across, down = (math.ceil(count / COARSE) + 2 for count in (columns, rows))
    # nodes are where resizing puts the middles of coarse pixels
    x = ((np.arange(across) - 0.5) * COARSE) / fine
    y = sheet_mm[1] - ((np.arange(down) - 0.5) * COARSE) / fine
    nodes = view.to_px(np.column_stack([np.tile(x, down), np.repeat(y, across)])).astype(np.float32)
    size = (across * COARSE, down * COARSE)
    inside = (slice(COARSE, COARSE + rows), slice(COARSE, COARSE + columns))
    maps = [
        cv2.resize(nodes[:, k].reshape(down, across), size, interpolation=cv2.INTER_LINEAR)[inside]
        for k in (0, 1)
    ]
    seen = cv2.remap(pixels, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return Flat(seen, fine, sheet_mm)
