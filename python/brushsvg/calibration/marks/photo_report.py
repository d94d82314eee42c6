"""A photograph of a chart with what was read from it, and what the brush that was found paints there, as a picture."""

from __future__ import annotations

import cv2
import numpy as np

from ... import _core
from ...photo.flatten import Flat
from .mark_report import on_sheet, predicted_marks

# blue first
FOUND, PREDICTED, ASTRAY, TEXT = (60, 160, 40), (40, 40, 220), (0, 140, 255), (90, 60, 20)
LETTER_MM, FOUND_MM, PREDICTED_MM, HALO_MM = (
    2.0,
    0.2,
    0.08,
    0.5,
)  # letters, lines, and the white round letters
LEAST_PX_PER_MM = 14.0  # of the picture that is drawn: coarser, letters cannot be read and two lines are one
SHARP = 16  # of polylines: fractions of a pixel


def read_picture(read, made=None) -> bytes:
    """PNG. read: chart.photograph.Read, its outlines in green; made: from_marks.MarkCalibration, the marks it predicts
    in red, with each stroke's overlap and displacement; what was left out in orange."""
    return _drawn(read, lambda picture, flat: _compared(picture, flat, read, made))


def dabs_picture(read, made) -> bytes:
    """PNG. made: from_dabs.DabCalibration: over each dab in green the outline of its depth in red, with its depth and,
    where there is room, its displacement; what was left out in orange."""
    return _drawn(read, lambda picture, flat: _dabs_compared(picture, flat, read, made.outlines))


def _drawn(read, compared) -> bytes:
    """compared: draws on (picture, flat), and gives what is to be said of each stroke, the longest first."""
    flat = _enlarged(read.flat)
    picture = flat.pixels
    for rings in read.marks.outlines_mm.values():
        _draw(picture, flat, rings, FOUND, FOUND_MM)
    boxes = {stroke.id: stroke.box_mm for stroke in read.chart.strokes}
    for stroke, words in compared(picture, flat).items():
        _write(picture, flat, boxes[stroke], words)
    return cv2.imencode(".png", picture)[1].tobytes()


def _enlarged(flat: Flat) -> Flat:
    """A copy in which lines and letters have room."""
    size = max(1.0, LEAST_PX_PER_MM / flat.px_per_mm)
    columns, rows = (round(side * flat.px_per_mm * size) for side in flat.sheet_mm)
    return Flat(cv2.resize(flat.pixels, (columns, rows)), flat.px_per_mm * size, flat.sheet_mm)


def _compared(picture, flat, read, made) -> dict[str, list[str]]:
    """Predictions drawn where their marks lie; what is to be said of each stroke, the longest first."""
    if made is None:
        return {stroke: [stroke] for stroke in read.marks.outlines_mm}
    words = {}
    for stray in made.strays:
        (rings,) = predicted_marks(made, [stray.mark])
        _draw(picture, flat, on_sheet(made, rings), PREDICTED, PREDICTED_MM)
        _draw(picture, flat, stray.mark.outline_mm, ASTRAY, FOUND_MM)
        words[stray.mark.stroke] = [f"{stray.mark.stroke}: LEFT OUT", "LEFT OUT", "OUT"]
    marks = made.painted.marks
    predicted = predicted_marks(made, marks)
    for mark, residual, rings in zip(marks, made.fit.marks, predicted, strict=True):
        drawn = on_sheet(made, [ring + np.array(residual.displacement_mm) for ring in rings])
        _draw(picture, flat, drawn, PREDICTED, PREDICTED_MM)
        overlap = _core.overlap([np.array(ring) for ring in mark.outline_mm], drawn)
        displaced = np.hypot(*residual.displacement_mm)
        words[mark.stroke] = [
            f"{mark.stroke}: overlap {overlap:.3f}, {displaced:.2f} mm aside",
            f"{mark.stroke}: {overlap:.3f}, {displaced:.2f} mm",
            f"{overlap:.3f}, {displaced:.2f} mm",
            f"{overlap:.2f}, {displaced:.1f}",
        ]
    return words


def _dabs_compared(picture, flat, read, outlines) -> dict[str, list[str]]:
    drawn, words = outlines.predicted_mm(), {}
    for shape in outlines.shapes:
        for name, displaced in ((each.dab.name, np.hypot(*each.displacement_mm)) for each in shape.seen):
            _draw(picture, flat, [drawn[name]], PREDICTED, PREDICTED_MM)
            label = f"{shape.depth_mm:g} mm deep, {displaced:.2f} mm aside"
            words[name] = [f"{name}: {label}", label, f"{shape.depth_mm:g} mm", f"{shape.depth_mm:g}"]
    for name, rings in read.marks.outlines_mm.items():
        if name not in drawn:
            _draw(picture, flat, rings, ASTRAY, FOUND_MM)
            words[name] = [f"{name}: LEFT OUT", "LEFT OUT", "OUT"]
    return words


def _write(picture, flat, box_mm, words: list[str]) -> None:
    """Above a box, the first that fits its width, within the picture."""
    size = LETTER_MM * flat.px_per_mm / 22  # letters of this font are 22 px tall
    thick = max(1, round(0.15 * flat.px_per_mm))
    widths = [cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, thick)[0][0] for text in words]
    room = (box_mm[2] - box_mm[0] + 1.0) * flat.px_per_mm
    text, width = next(
        (each for each in zip(words, widths, strict=True) if each[1] <= room), (words[-1], widths[-1])
    )
    x, y = flat.to_px([(box_mm[0], box_mm[3])])[0]
    x = min(max(x, 0.0), picture.shape[1] - width)
    y = max(y - 0.3 * flat.px_per_mm, LETTER_MM * flat.px_per_mm)
    edge, tall = round(HALO_MM * flat.px_per_mm), round(LETTER_MM * flat.px_per_mm)
    behind = picture[
        max(int(y) - tall - edge, 0) : int(y) + 2 * edge, max(int(x) - edge, 0) : int(x) + width + edge
    ]
    behind[:] = 0.25 * behind + 0.75 * 255
    cv2.putText(picture, text, (int(x), int(y)), cv2.FONT_HERSHEY_SIMPLEX, size, TEXT, thick, cv2.LINE_AA)


def _draw(picture, flat, rings, colour, wide_mm: float) -> None:
    points = [np.round(flat.to_px(ring) * SHARP).astype(np.int32)[:, None] for ring in rings]
    thick = max(1, round(wide_mm * flat.px_per_mm))
    cv2.polylines(picture, points, True, colour, thick, cv2.LINE_AA, shift=4)
