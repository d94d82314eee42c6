"""Find where the paint is on a printed page, and how large: machines paint in true mm, printers often do not."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from .edges import SEEN, StrokeBox, paint_seen
from .flatten import Flat
from .place_by_strokes import COARSE_PX_PER_MM, FOUND, marks_in, match_ways, similar, spectrum

SCALES = np.linspace(
    0.9, 1.1, 21
)  # of paint against its page: printers' margins shrink pages by up to a tenth
ROUNDS = 4


@dataclass(frozen=True)
class PaintPlace:
    """Where paint is on its page: `scale` times its planned place from the sheet's middle, then moved by `shift_mm`."""

    scale: float
    shift_mm: tuple[float, float]


def find_paint(
    flat: Flat,
    print_: np.ndarray,
    stroke_boxes: list[StrokeBox],
    ways_mm: list[np.ndarray],
    scale: float | None = None,
) -> PaintPlace | None:
    """Find scale and shift of the paint by its strokes.

    print_: pixels of the flattened page that the printer made black; ways_mm: of the TCP, pressed, (n, 2) by room;
    scale: where it is known. None where too few marks are found in rooms that are scaled and moved so.
    """
    paint = np.float32(paint_seen(flat, print_, stroke_boxes) > SEEN)
    columns, rows = (round(side * COARSE_PX_PER_MM) for side in flat.sheet_mm)
    paint = cv2.resize(paint, (columns, rows), interpolation=cv2.INTER_AREA) > 0.5
    middle = np.array(flat.sheet_mm) / 2 @ [1, -1j]
    ways = [way @ [1, -1j] - middle for way in ways_mm]
    scales = SCALES if scale is None else [scale]
    broad = [way * max(scales) + middle for way in ways]
    seen, shape = spectrum(paint, broad)
    tried = [(match_ways(seen, shape, [way * s + middle for way in ways]), s) for s in scales]
    (_, shift), found = max(tried, key=lambda each: each[0][0])
    shift -= 1j * flat.sheet_mm[1]  # from the sheet's lower left corner, as middles and places are
    boxes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    middles = 0.5 * (boxes[:, :2] + boxes[:, 2:]) @ [1, -1j] - middle
    for _ in range(ROUNDS):
        corner = np.array([(middle + shift).real, -(middle + shift).imag])
        moved = (boxes - np.tile(np.array(flat.sheet_mm) / 2, 2)) * found + np.tile(corner, 2)
        here = [
            replace(stroke_box, box_mm=tuple(box))
            for stroke_box, box in zip(stroke_boxes, moved.tolist(), strict=True)
        ]
        of, places = marks_in(np.uint8(paint), flat.sheet_mm, here)
        if len(of) < FOUND * len(stroke_boxes):
            return None
        if scale is None:
            turned, displaced = similar(middles[of], places - middle)
            found, shift = abs(turned), displaced
        else:
            displaced = places - middle - scale * middles[of]
            shift = complex(np.median(displaced.real), np.median(displaced.imag))
    return PaintPlace(float(found), (shift.real, -shift.imag))
