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
    fine = flat.px_per_mm
    for rings in read.marks.outlines_mm.values():
        _draw(picture, flat, rings, FOUND)
    tops = {stroke.id: (stroke.box_mm[0], stroke.box_mm[3]) for stroke in read.chart.strokes}
    for stroke, words in _compared(picture, read, made).items():
        at = flat.to_px([tops[stroke]])[0]
        size = LETTER_MM * fine / 22  # letters of this font are 22 px tall
        place = (int(max(at[0], 0)), int(max(at[1] - 0.3 * fine, LETTER_MM * fine)))
        thick = max(1, round(0.12 * fine))
        cv2.putText(picture, words, place, cv2.FONT_HERSHEY_SIMPLEX, size, TEXT, thick, cv2.LINE_AA)
    done, data = cv2.imencode(".png", picture)
    assert done
    return data.tobytes()


def _compared(picture, read, made) -> dict[str, str]:
    """Predictions drawn where their marks lie; what is to be said of each stroke."""
    if made is None:
        return {stroke: stroke for stroke in read.marks.outlines_mm}
    words = {}
    marks = made.painted.marks
    for mark, miss, rings in zip(
        marks, made.fit.marks, predicted_marks(made, list(range(len(marks)))), strict=True
    ):
        lying = on_sheet(made, [ring + np.array(miss.displacement_mm) for ring in rings])
        _draw(picture, read.flat, lying, PREDICTED)
        overlap = _core.overlap([np.array(ring) for ring in mark.outline_mm], lying)
        aside = np.hypot(*miss.displacement_mm)
        words[mark.stroke] = f"{mark.stroke}: {overlap:.3f}, {aside:.2f} mm aside"
    return words


def _draw(picture, flat, rings, colour) -> None:
    points = [np.round(flat.to_px(ring) * SHARP).astype(np.int32)[:, None] for ring in rings]
    thick = max(1, round(LINE_MM * flat.px_per_mm))
    cv2.polylines(picture, points, True, colour, thick, cv2.LINE_AA, shift=4)
