"""Find position and scale of the paint on a printed page: machines paint in true mm, printers often do not."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from .edges import SEEN, paint_seen
from .flatten import Flat
from .place_by_strokes import (
    COARSE_PX_PER_MM,
    MIN_FOUND_SHARE,
    find_marks_in_boxes,
    fit_similarity,
    match_paths,
    paint_spectrum,
)
from .stroke_boxes import StrokeBox

# Scales of the paint relative to its page. Printers' margins shrink pages by up to a tenth.
PAINT_SCALES = np.linspace(0.9, 1.1, 21)
REFINEMENT_ROUNDS = 4


@dataclass(frozen=True)
class PaintPlace:
    """The place of the paint on its page.

    The plan is scaled by `scale` about the sheet's middle, then moved by `shift_mm`.
    """

    scale: float
    shift_mm: tuple[float, float]


def find_paint(
    flat: Flat,
    is_printed: np.ndarray,
    stroke_boxes: list[StrokeBox],
    paths_mm: list[np.ndarray],
    scale: float | None = None,
) -> PaintPlace | None:
    """Find scale and shift of the paint from its strokes.

    is_printed: mask of the pixels of the flattened page that the printer made black; paths_mm: paths (n, 2) of the TCP
    while it paints, one per box; scale: the scale where it is known. Returns None where too few marks are in the
    scaled and moved boxes.
    """
    paint = np.float32(paint_seen(flat, is_printed, stroke_boxes) > SEEN)
    columns, rows = (round(side * COARSE_PX_PER_MM) for side in flat.sheet_mm)
    paint = cv2.resize(paint, (columns, rows), interpolation=cv2.INTER_AREA) > 0.5
    middle = np.array(flat.sheet_mm) / 2 @ [1, -1j]
    paths = [path @ [1, -1j] - middle for path in paths_mm]
    scales = PAINT_SCALES if scale is None else [scale]
    largest_paths = [path * max(scales) + middle for path in paths]
    spectrum, shape = paint_spectrum(paint, largest_paths)
    tried = [(match_paths(spectrum, shape, [path * s + middle for path in paths]), s) for s in scales]
    (_, shift), found_scale = max(tried, key=lambda each: each[0][0])
    shift -= 1j * flat.sheet_mm[1]  # from the sheet's lower left corner, like middles and places
    boxes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    middles = 0.5 * (boxes[:, :2] + boxes[:, 2:]) @ [1, -1j] - middle
    for _ in range(REFINEMENT_ROUNDS):
        corner = np.array([(middle + shift).real, -(middle + shift).imag])
        moved = (boxes - np.tile(np.array(flat.sheet_mm) / 2, 2)) * found_scale + np.tile(corner, 2)
        moved_boxes = [
            replace(stroke_box, box_mm=tuple(box)) for stroke_box, box in zip(stroke_boxes, moved.tolist(), strict=True)
        ]
        numbers, places = find_marks_in_boxes(np.uint8(paint), flat.sheet_mm, moved_boxes)
        if len(numbers) < MIN_FOUND_SHARE * len(stroke_boxes):
            return None
        if scale is None:
            turned, displaced = fit_similarity(middles[numbers], places - middle)
            found_scale, shift = abs(turned), displaced
        else:
            displaced = places - middle - scale * middles[numbers]
            shift = complex(np.median(displaced.real), np.median(displaced.imag))
    return PaintPlace(float(found_scale), (shift.real, -shift.imag))
