"""The boxes on the sheet in which the marks of strokes are expected."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .flatten import Flat

# A part of the paint with this share and area in the box of another stroke is a mark of that stroke as well.
MIN_SPLIT_SHARE, MIN_SPLIT_MM2 = 0.15, 3.0


@dataclass(frozen=True)
class StrokeBox:
    """The box in which the mark of a stroke is expected.

    box_mm: left, bottom, right, top on the sheet; depth_mm: depth of the brush, which displaces the mark where the tool
    leans. With 0, no displacement is estimated.
    """

    stroke: str
    box_mm: tuple[float, float, float, float]
    depth_mm: float = 0.0


def box_pixels(flat: Flat, box_mm, beyond_mm: float) -> tuple[int, int, int, int]:
    """Return the pixel columns and rows of an enlarged box: left, top, right, bottom."""
    left, bottom, right, top = box_mm
    rows, columns = flat.pixels.shape[:2]
    (c0, r0), (c1, r1) = flat.to_px([[left - beyond_mm, top + beyond_mm], [right + beyond_mm, bottom - beyond_mm]])
    return (
        int(np.clip(np.floor(c0), 0, columns)),
        int(np.clip(np.floor(r0), 0, rows)),
        int(np.clip(np.ceil(c1), 0, columns)),
        int(np.clip(np.ceil(r1), 0, rows)),
    )
