"""Draw the photographed paint over the drawing and the prediction.

The worst places are numbered.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from ..reporting.label_space import LabelSpace
from ..reporting.worst_areas import WorstArea
from .attribution.faults import Faults
from .job_page import JobPage
from .photographs import EDGE_LEVEL, Comparison, TargetStroke

LONG_SIDE_PX = 2400
# Colours as (blue, green, red).
TARGET_COLOUR, PREDICTED_COLOUR, TEXT_COLOUR = (190, 190, 190), (40, 40, 220), (30, 30, 30)
FONT, LETTER_PX, LINE_PX = (cv2.FONT_HERSHEY_SIMPLEX, 22, 2)  # font, height of its letters at size 1, line width
NUMBER_SIZE, RING_PX = 1.3, 18  # font size of the numbers, radius of the rings around places
MARGIN_PX = 90
ROW_PX = 40


def comparison_png(
    page: JobPage,
    strokes: list[TargetStroke],
    found: Comparison,
    title: str,
    places: Sequence[tuple[str, WorstArea]],
    faults: Faults | None,
) -> bytes:
    """Draw the comparison as the bytes of a PNG file.

    places: worst places of the report, numbered from 1; faults: None leaves out the bars of gains.
    """
    left, bottom, right, top = _window_mm(strokes, found)
    px_per_mm = min(LONG_SIDE_PX / max(right - left, top - bottom), 2 * found.flat.px_per_mm)
    corner = found.flat.to_px(np.array([[left, top]]) + page.frame_mm)[0]
    size = round((right - left) * px_per_mm), round((top - bottom) * px_per_mm)
    step = found.flat.px_per_mm / px_per_mm
    matrix = np.array([[step, 0, corner[0]], [0, step, corner[1]]])
    image = cv2.warpAffine(
        found.flat.pixels,
        matrix,
        size,
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )

    def lines(rings):
        return [np.round((ring - [left, top]) * [1, -1] * px_per_mm * 16).astype(np.int32) for ring in rings]

    grey = image.copy()
    for stroke in strokes:
        cv2.fillPoly(grey, lines(stroke.target or ()), TARGET_COLOUR, cv2.LINE_AA, 4)
    image = cv2.min(image, grey)
    for stroke in strokes:
        cv2.polylines(image, lines(stroke.predicted), True, PREDICTED_COLOUR, 2, cv2.LINE_AA, 4)
    marks = np.zeros(image.shape[:2], np.uint8)
    for stroke in strokes:
        cv2.fillPoly(marks, lines([*stroke.predicted, *(stroke.target or ())]), 1, cv2.LINE_8, 4)
    marks |= cv2.warpAffine(
        (found.painted > EDGE_LEVEL).astype(np.uint8),
        _canvas_from_picture(found.canvas, left, top, px_per_mm),
        size,
        flags=cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP,
    )
    _draw_numbers(image, marks > 0, [(np.array(area.at_mm) - [left, top]) * [1, -1] * px_per_mm for _, area in places])
    out = np.full((image.shape[0] + MARGIN_PX, max(image.shape[1], 900), 3), 255, np.uint8)
    out[MARGIN_PX:, : image.shape[1]] = image
    _write_text(out, title[:60], (16, 34), TEXT_COLOUR)
    _write_text(
        out,
        "photograph of the paint; grey: drawn; red line: predicted; numbers: the worst places",
        (16, 72),
        (30, 30, 30),
        0.75,
    )
    if faults is not None:
        out = np.vstack([out, _draw_gains(faults, out.shape[1])])
    return cv2.imencode(".png", out)[1].tobytes()


def _canvas_from_picture(canvas, left: float, top: float, px_per_mm: float) -> np.ndarray:
    """Return the matrix (2, 3) from pixels of the picture to pixels of the canvas."""
    step = canvas.px_per_mm / px_per_mm
    x, y = (left - canvas.window_mm[0]) * canvas.px_per_mm, (canvas.window_mm[3] - top) * canvas.px_per_mm
    return np.array([[step, 0, x], [0, step, y]])


def _draw_numbers(image, marks: np.ndarray, places: list[np.ndarray]) -> None:
    """Draw a ring around each place, with its number next to it, clear of paint and drawing."""
    space = LabelSpace(marks, anchors=places, radius=RING_PX)
    height = LETTER_PX * NUMBER_SIZE
    for number, at in enumerate(places, 1):
        (width, _), _ = cv2.getTextSize(str(number), FONT, NUMBER_SIZE, LINE_PX)
        label = space.place(at, [(width, height)])
        for colour, thick in (((255, 255, 255), 3 * LINE_PX), (TEXT_COLOUR, LINE_PX)):
            cv2.circle(image, tuple(np.round(at).astype(int).tolist()), RING_PX, colour, thick, cv2.LINE_AA)
            if label.leader:
                ends = [tuple(map(round, end)) for end in label.leader]
                cv2.line(image, *ends, colour, thick, cv2.LINE_AA)
        _write_text(image, str(number), (round(label.left), round(label.top + height)), TEXT_COLOUR, NUMBER_SIZE)


def _draw_gains(faults: Faults, width: int) -> np.ndarray:
    """Draw the gain from fixing each cause alone, as bars with intervals."""
    shares = sorted(faults.shares, key=lambda one: -one.gain)
    out = np.full((80 + ROW_PX * len(shares), width, 3), 255, np.uint8)
    _write_text(out, "gain in overlap if only this cause is fixed (line: 95 %)", (16, 50), TEXT_COLOUR, 0.75)
    left = min(760, round(0.55 * width))
    most = max(0.02, *(share.high for share in shares))
    per_px = (width - left - 40) / most
    for row, share in enumerate(shares):
        y = 80 + ROW_PX * row
        _write_text(out, f"{share.gain + 0.0:+.3f}  {share.cause}", (16, y + 26), TEXT_COLOUR, 0.75)
        ends = [left + round(max(value, 0.0) * per_px) for value in (share.gain, share.low, share.high)]
        cv2.rectangle(out, (left, y + 4), (ends[0], y + 28), TARGET_COLOUR if row else PREDICTED_COLOUR, -1)
        cv2.line(out, (ends[1], y + 16), (ends[2], y + 16), TEXT_COLOUR, 2, cv2.LINE_AA)
    return out


def _window_mm(strokes: list[TargetStroke], found: Comparison):
    points = np.vstack([ring for stroke in strokes for ring in (*stroke.predicted, *(stroke.target or ()))])
    low = np.maximum(points.min(axis=0) - 8, found.canvas.window_mm[:2])
    high = np.minimum(points.max(axis=0) + 8, found.canvas.window_mm[2:])
    return *low, *high


def _write_text(image, words: str, at, colour, size: float = 0.9) -> None:
    cv2.putText(image, words, at, cv2.FONT_HERSHEY_SIMPLEX, size, (255, 255, 255), 6, cv2.LINE_AA)
    cv2.putText(image, words, at, cv2.FONT_HERSHEY_SIMPLEX, size, colour, 2, cv2.LINE_AA)
