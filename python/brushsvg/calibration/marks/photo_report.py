"""A photograph of a chart with what was read from it, and what the brush that was found paints there, as a picture."""

from __future__ import annotations

import cv2
import numpy as np

from ... import _core
from ...photo.flatten import Flat
from ...reporting.label_space import LabelSpace
from .mark_report import on_sheet, predicted_marks

# blue first
FOUND, PREDICTED, ASTRAY, TEXT = (60, 160, 40), (40, 40, 220), (0, 140, 255), (90, 60, 20)
LETTER_MM, FOUND_MM, PREDICTED_MM, HALO_MM = (
    2.0,
    0.2,
    0.08,
    0.3,
)  # letters, lines, and the white round letters
FONT, FONT_PX = cv2.FONT_HERSHEY_SIMPLEX, 22  # height of its letters at size 1
CELLS_PER_MM = 4.0  # by which labels keep clear of marks
DARK, AROUND_MM = 0.95, 25.0  # of the usual brightness around a place: darker is paint or print
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
    picture, outlines = flat.pixels, read.marks.outlines_mm
    space = _label_space(flat, outlines)
    for rings in outlines.values():
        _draw(picture, flat, rings, FOUND, FOUND_MM)
    for stroke, words in compared(picture, flat).items():
        points = np.vstack(outlines[stroke])
        _write(picture, flat, space, points[points[:, 1].argmax()], words)
    return cv2.imencode(".png", picture)[1].tobytes()


def _label_space(flat: Flat, outlines: dict) -> LabelSpace:
    """Return the free space around everything that was painted or printed."""
    size = tuple(round(side * CELLS_PER_MM) for side in flat.sheet_mm)
    grey = cv2.resize(cv2.cvtColor(flat.pixels, cv2.COLOR_BGR2GRAY), size, interpolation=cv2.INTER_AREA)
    around = cv2.medianBlur(grey, round(AROUND_MM * CELLS_PER_MM) | 1)
    marks = (grey < DARK * around).astype(np.uint8)
    step = CELLS_PER_MM / flat.px_per_mm
    for rings in outlines.values():
        cv2.fillPoly(marks, [np.round(flat.to_px(ring) * step).astype(np.int32) for ring in rings], 1)
    rows, columns = flat.pixels.shape[:2]
    return LabelSpace(marks > 0, 1 / step, (0, 0, columns, rows))


def _enlarged(flat: Flat) -> Flat:
    """A copy in which lines and letters have room."""
    size = max(1.0, LEAST_PX_PER_MM / flat.px_per_mm)
    columns, rows = (round(side * flat.px_per_mm * size) for side in flat.sheet_mm)
    return Flat(cv2.resize(flat.pixels, (columns, rows)), flat.px_per_mm * size, flat.sheet_mm)


def _compared(picture, flat, read, made) -> dict[str, list[str]]:
    """Draw the predictions on their marks, and return labels for each stroke, the longest first."""
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
            f"{mark.stroke}: overlap {overlap:.3f}, displaced {displaced:.2f} mm",
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
            label = f"{shape.depth_mm:g} mm deep, displaced {displaced:.2f} mm"
            words[name] = [f"{name}: {label}", label, f"{shape.depth_mm:g} mm", f"{shape.depth_mm:g}"]
    for name, rings in read.marks.outlines_mm.items():
        if name not in drawn:
            _draw(picture, flat, rings, ASTRAY, FOUND_MM)
            words[name] = [f"{name}: LEFT OUT", "LEFT OUT", "OUT"]
    return words


def _write(picture, flat, space: LabelSpace, at_mm, words: list[str]) -> None:
    """Write the first of the words that has room near a place."""
    size, edge = LETTER_MM * flat.px_per_mm / FONT_PX, HALO_MM * flat.px_per_mm
    thick = max(1, round(0.15 * flat.px_per_mm))
    texts = [cv2.getTextSize(text, FONT, size, thick) for text in words]
    below = max(lower for _, lower in texts)
    boxes = [(width + 2 * edge, height + below + 2 * edge) for (width, height), _ in texts]
    label = space.place(flat.to_px([at_mm])[0], boxes, towards=(0, -1))
    if label.leader:
        ends = [tuple(map(round, end)) for end in label.leader]
        cv2.line(picture, *ends, TEXT, thick, cv2.LINE_AA)
    left, top, right, bottom = map(round, label.box)
    behind = picture[max(top, 0) : bottom, max(left, 0) : right]
    behind[:] = 0.25 * behind + 0.75 * 255
    baseline = (round(label.left + edge), round(label.top + label.height - edge - below))
    cv2.putText(picture, words[label.choice], baseline, FONT, size, TEXT, thick, cv2.LINE_AA)


def _draw(picture, flat, rings, colour, wide_mm: float) -> None:
    points = [np.round(flat.to_px(ring) * SHARP).astype(np.int32)[:, None] for ring in rings]
    thick = max(1, round(wide_mm * flat.px_per_mm))
    cv2.polylines(picture, points, True, colour, thick, cv2.LINE_AA, shift=4)
