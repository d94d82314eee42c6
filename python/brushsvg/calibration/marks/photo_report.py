"""Draw the outlines read from a photograph and the predicted outlines."""

from __future__ import annotations

import cv2
import numpy as np

from ... import _core
from ...photo.flatten import Flat
from ...reporting.label_space import LabelSpace
from ...reporting.report_text import format_overlap
from .mark_report import predict_outlines, to_sheet_frame

# Colours as blue, green, red.
FOUND_COLOUR = (60, 160, 40)
PREDICTED_COLOUR = (40, 40, 220)
STRAY_COLOUR = (0, 140, 255)
TEXT_COLOUR = (90, 60, 20)
# Height of letters, widths of found and predicted lines, and width of the white border around letters.
LETTER_MM, FOUND_MM, PREDICTED_MM, HALO_MM = 2.0, 0.2, 0.08, 0.3
FONT, FONT_PX = cv2.FONT_HERSHEY_SIMPLEX, 22  # the font, and the height of its letters at size 1
CELLS_PER_MM = 4.0  # resolution of the grid that keeps labels clear of marks
# A place darker than this share of the median brightness around it is paint or print.
MAX_BRIGHTNESS_SHARE, BRIGHTNESS_WINDOW_MM = (0.95, 25.0)
# Least resolution of the drawn picture. In a coarser one, letters are illegible and two lines merge.
MIN_PX_PER_MM = 14.0
PIXEL_FRACTIONS = 16  # fractions of a pixel in the coordinates of polylines


def read_picture(read, calibration=None) -> bytes:
    """Draw the marks of a photograph and their predictions as a PNG.

    read: a chart.photograph.Read, whose outlines are green. calibration: a from_marks.MarkCalibration, whose
    predictions are red, with the overlap and displacement of each stroke. Marks that were left out are orange.
    """
    return _draw_picture(read, lambda picture, flat: _draw_predictions(picture, flat, read, calibration))


def dabs_picture(read, calibration) -> bytes:
    """Draw the dabs of a photograph and the outlines of their depths as a PNG.

    Dabs are green, outlines are red.

    calibration: a from_dabs.DabCalibration. Each dab is labelled with its depth and, if there is space, its
    displacement. Dabs that were left out are orange.
    """
    return _draw_picture(read, lambda picture, flat: _draw_dab_predictions(picture, flat, read, calibration.outlines))


def _draw_picture(read, compared) -> bytes:
    """Draw outlines, comparison and labels; compared: draws on (picture, flat), returns labels by stroke."""
    flat = _enlarge(read.flat)
    picture, outlines = flat.pixels, read.marks.outlines_mm
    space = _label_space(flat, outlines)
    for rings in outlines.values():
        _draw_rings(picture, flat, rings, FOUND_COLOUR, FOUND_MM)
    for stroke, words in compared(picture, flat).items():
        points = np.vstack(outlines[stroke])
        _write_label(picture, flat, space, points[points[:, 1].argmax()], words)
    return cv2.imencode(".png", picture)[1].tobytes()


def _label_space(flat: Flat, outlines: dict) -> LabelSpace:
    """Return the free space for labels around everything that was painted or printed."""
    size = tuple(round(side * CELLS_PER_MM) for side in flat.sheet_mm)
    grey = cv2.resize(cv2.cvtColor(flat.pixels, cv2.COLOR_BGR2GRAY), size, interpolation=cv2.INTER_AREA)
    around = cv2.medianBlur(grey, round(BRIGHTNESS_WINDOW_MM * CELLS_PER_MM) | 1)
    marks = (grey < MAX_BRIGHTNESS_SHARE * around).astype(np.uint8)
    step = CELLS_PER_MM / flat.px_per_mm
    for rings in outlines.values():
        cv2.fillPoly(marks, [np.round(flat.to_px(ring) * step).astype(np.int32) for ring in rings], 1)
    rows, columns = flat.pixels.shape[:2]
    return LabelSpace(marks > 0, 1 / step, (0, 0, columns, rows))


def _enlarge(flat: Flat) -> Flat:
    """Return a copy that is large enough for lines and letters."""
    size = max(1.0, MIN_PX_PER_MM / flat.px_per_mm)
    columns, rows = (round(side * flat.px_per_mm * size) for side in flat.sheet_mm)
    return Flat(cv2.resize(flat.pixels, (columns, rows)), flat.px_per_mm * size, flat.sheet_mm)


def _draw_predictions(picture, flat, read, calibration) -> dict[str, list[str]]:
    """Draw the predictions on their marks, and return the labels of each stroke, the longest first."""
    if calibration is None:
        return {stroke: [stroke] for stroke in read.marks.outlines_mm}
    words = {}
    for stray in calibration.strays:
        (rings,) = predict_outlines(calibration, [stray.mark])
        _draw_rings(picture, flat, to_sheet_frame(calibration, rings), PREDICTED_COLOUR, PREDICTED_MM)
        _draw_rings(picture, flat, stray.mark.outline_mm, STRAY_COLOUR, FOUND_MM)
        words[stray.mark.stroke] = [f"{stray.mark.stroke}: LEFT OUT", "LEFT OUT", "OUT"]
    marks = calibration.painted.marks
    predicted = predict_outlines(calibration, marks)
    for mark, residual, rings in zip(marks, calibration.fit.marks, predicted, strict=True):
        drawn = to_sheet_frame(calibration, [ring + np.array(residual.displacement_mm) for ring in rings])
        _draw_rings(picture, flat, drawn, PREDICTED_COLOUR, PREDICTED_MM)
        overlap = _core.overlap([np.array(ring) for ring in mark.outline_mm], drawn)
        displaced = np.hypot(*residual.displacement_mm)
        words[mark.stroke] = [
            f"{mark.stroke}: overlap {format_overlap(overlap)}, displaced {displaced:.2f} mm",
            f"{mark.stroke}: {format_overlap(overlap)}, {displaced:.2f} mm",
            f"{format_overlap(overlap)}, {displaced:.2f} mm",
            f"{overlap:.2f}, {displaced:.1f}",
        ]
    return words


def _draw_dab_predictions(picture, flat, read, outlines) -> dict[str, list[str]]:
    drawn, words = outlines.predicted_mm(), {}
    for shape in outlines.shapes:
        for name, displaced in ((patch_dab.dab.name, np.hypot(*patch_dab.displacement_mm)) for patch_dab in shape.seen):
            _draw_rings(picture, flat, [drawn[name]], PREDICTED_COLOUR, PREDICTED_MM)
            label = f"{shape.depth_mm:g} mm deep, displaced {displaced:.2f} mm"
            words[name] = [f"{name}: {label}", label, f"{shape.depth_mm:g} mm", f"{shape.depth_mm:g}"]
    for name, rings in read.marks.outlines_mm.items():
        if name not in drawn:
            _draw_rings(picture, flat, rings, STRAY_COLOUR, FOUND_MM)
            words[name] = [f"{name}: LEFT OUT", "LEFT OUT", "OUT"]
    return words


def _write_label(picture, flat, space: LabelSpace, at_mm, words: list[str]) -> None:
    """Write the first of the labels that fits near a place."""
    size, edge = LETTER_MM * flat.px_per_mm / FONT_PX, HALO_MM * flat.px_per_mm
    thick = max(1, round(0.15 * flat.px_per_mm))
    texts = [cv2.getTextSize(text, FONT, size, thick) for text in words]
    below = max(lower for _, lower in texts)
    boxes = [(width + 2 * edge, height + below + 2 * edge) for (width, height), _ in texts]
    label = space.place(flat.to_px([at_mm])[0], boxes, towards=(0, -1))
    if label.leader:
        ends = [tuple(map(round, end)) for end in label.leader]
        cv2.line(picture, *ends, TEXT_COLOUR, thick, cv2.LINE_AA)
    left, top, right, bottom = map(round, label.box)
    behind = picture[max(top, 0) : bottom, max(left, 0) : right]
    behind[:] = 0.25 * behind + 0.75 * 255
    baseline = (round(label.left + edge), round(label.top + label.height - edge - below))
    cv2.putText(picture, words[label.choice], baseline, FONT, size, TEXT_COLOUR, thick, cv2.LINE_AA)


def _draw_rings(picture, flat, rings, colour, wide_mm: float) -> None:
    points = [np.round(flat.to_px(ring) * PIXEL_FRACTIONS).astype(np.int32)[:, None] for ring in rings]
    thick = max(1, round(wide_mm * flat.px_per_mm))
    cv2.polylines(picture, points, True, colour, thick, cv2.LINE_AA, shift=4)
