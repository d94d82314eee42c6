"""A photograph of a chart with what was read from it, and what the brush that was found paints there, as a picture."""

from __future__ import annotations

import cv2
import numpy as np

from .. import _core
from .mark_report import on_sheet, predicted_marks

FOUND, PREDICTED, TEXT = (60, 160, 40), (40, 40, 220), (90, 60, 20)  # blue first
LETTER_MM, LINE_MM = 1.8, 0.15
SHARP = 16  # of polylines: fractions of a pixel


def read_picture(read, made=None) -> bytes:
    """PNG. read: chart.photograph.Read, its outlines in green; made: from_marks.MarkCalibration, the marks it predicts
    in red, with each stroke's overlap and displacement."""
    flat = read.flat
    picture = np.ascontiguousarray(flat.pixels)
    for rings in read.marks.outlines_mm.values():
        _draw(picture, flat, rings, FOUND)
    boxes = {stroke.id: stroke.box_mm for stroke in read.chart.strokes}
    for stroke, words in _compared(picture, read, made).items():
        _write(picture, flat, boxes[stroke], words)
    done, data = cv2.imencode(".png", picture)
    assert done
    return data.tobytes()


def _compared(picture, read, made) -> dict[str, list[str]]:
    """Predictions drawn where their marks lie; what is to be said of each stroke, the longest first."""
    if made is None:
        return {stroke: [stroke] for stroke in read.marks.outlines_mm}
    words = {}
    marks = made.painted.marks
    predicted = predicted_marks(made, list(range(len(marks))))
    for mark, miss, rings in zip(marks, made.fit.marks, predicted, strict=True):
        lying = on_sheet(made, [ring + np.array(miss.displacement_mm) for ring in rings])
        _draw(picture, read.flat, lying, PREDICTED)
        overlap = _core.overlap([np.array(ring) for ring in mark.outline_mm], lying)
        aside = np.hypot(*miss.displacement_mm)
        words[mark.stroke] = [
            f"{mark.stroke}: {overlap:.3f}, {aside:.2f} mm aside",
            f"{overlap:.3f}, {aside:.2f} mm",
            f"{overlap:.2f} {aside:.1f}",
        ]
    return words


def _write(picture, flat, box_mm, words: list[str]) -> None:
    """Above a box, the first that fits its width, within the picture."""
    size = LETTER_MM * flat.px_per_mm / 22  # letters of this font are 22 px tall
    thick = max(1, round(0.12 * flat.px_per_mm))
    widths = [cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, thick)[0][0] for text in words]
    room = (box_mm[2] - box_mm[0] + 1.0) * flat.px_per_mm
    text, width = next(
        (each for each in zip(words, widths, strict=True) if each[1] <= room), (words[-1], widths[-1])
    )
    x, y = flat.to_px([(box_mm[0], box_mm[3])])[0]
    x = min(max(x, 0.0), picture.shape[1] - width)
    y = max(y - 0.3 * flat.px_per_mm, LETTER_MM * flat.px_per_mm)
    cv2.putText(picture, text, (int(x), int(y)), cv2.FONT_HERSHEY_SIMPLEX, size, TEXT, thick, cv2.LINE_AA)


def _draw(picture, flat, rings, colour) -> None:
    points = [np.round(flat.to_px(ring) * SHARP).astype(np.int32)[:, None] for ring in rings]
    thick = max(1, round(LINE_MM * flat.px_per_mm))
    cv2.polylines(picture, points, True, colour, thick, cv2.LINE_AA, shift=4)
