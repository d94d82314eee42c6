"""Draw panels that compare painted marks with the drawing, as one PNG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from .. import _core
from .picture_colours import MUTED_TEXT, PANEL, PAPER, PREDICTED_INK, TARGET, TCP_LINE, TEXT
from .png_canvas import SUB_PIXEL_BITS, bgr, blank_canvas, blend, encode_png, write_text

MARGIN, TOP, BOTTOM, GAP, PAD = 56, 140, 84, 20, 28  # px
LABEL_W, LABEL_H = 480, 190


@dataclass(frozen=True)
class Panel:
    """One picture of the comparison. Rings and lines are in mm, in the paper frame.

    score: one figure in large letters, and its name; notes: lines of text below the score; lines: the TCP's paths or
    the middle lines, drawn in line_colour.
    """

    title: str
    score: tuple[str, str]
    notes: tuple[str, ...]
    target: Sequence[np.ndarray]
    painted: Sequence[np.ndarray]
    lines: Sequence[np.ndarray]
    line_colour: str = TCP_LINE


def panels_png(panels: list[Panel], heading: str, note: str, width_px: int = 2000) -> bytes:
    """Draw the panels at one scale.

    They are under each other for a wide drawing, else side by side.
    """
    x0, y0, x1, y1 = _panel_extent(panels)
    is_wide = x1 - x0 > 1.5 * (y1 - y0)
    across, down = (1, len(panels)) if is_wide else (len(panels), 1)
    card_w = (width_px - 2 * MARGIN - (across - 1) * GAP) // across
    text_w, text_h = (LABEL_W, 0) if is_wide else (0, LABEL_H)
    room_w, room_h = card_w - text_w - 2 * PAD, (366 if is_wide else 800)
    px_per_mm = min(room_w / (x1 - x0), room_h / (y1 - y0))
    picture_h = round((y1 - y0) * px_per_mm)
    card_h = max(picture_h + text_h, LABEL_H) + 2 * PAD
    slack_mm = room_w / px_per_mm - (x1 - x0)
    window = (x0 - slack_mm / 2, y0, x1 - x0 + slack_mm, y1 - y0)

    image = blank_canvas((TOP + down * (card_h + GAP) - GAP + BOTTOM, width_px), PAPER)
    write_text(image, heading, (MARGIN, 70), 44, 600, TEXT)
    write_text(image, note, (MARGIN, 110), 22, 400, MUTED_TEXT)
    for number, panel in enumerate(panels):
        left = MARGIN + (0 if is_wide else number * (card_w + GAP))
        upper = TOP + (number * (card_h + GAP) if is_wide else 0)
        image[upper : upper + card_h, left : left + card_w] = bgr(PANEL)
        label_y = upper + (card_h - LABEL_H) // 2 if is_wide else upper + PAD
        _write_label(image, panel, left + PAD + 8, label_y)
        corner = (left + text_w + PAD, upper + (card_h - picture_h + text_h) // 2)
        _draw_panel(image, panel, window, px_per_mm, corner)
    _draw_legend(image, MARGIN, image.shape[0] - 34)
    return encode_png(image)


def _write_label(image, panel: Panel, x: int, y: int) -> None:
    write_text(image, panel.title, (x, y + 30), 30, 600, TEXT)
    end = write_text(image, panel.score[0], (x - 3, y + 108), 68, 500, PREDICTED_INK)
    write_text(image, panel.score[1], (end + 14, y + 108), 24, 400, MUTED_TEXT)
    for line, text in enumerate(panel.notes):
        write_text(image, text, (x, y + 150 + 32 * line), 22, 400, MUTED_TEXT)


def _draw_panel(image, panel: Panel, window, px_per_mm: float, corner: tuple[int, int]) -> None:
    target = _core.coverage(panel.target, window, px_per_mm)
    part = image[corner[1] : corner[1] + target.shape[0], corner[0] : corner[0] + target.shape[1]]
    target = target[: part.shape[0], : part.shape[1]]
    blend(part, target, TARGET)
    if panel.painted:
        painted = _core.coverage(panel.painted, window, px_per_mm)[: part.shape[0], : part.shape[1]]
        blend(part, 0.86 * painted, PREDICTED_INK)
    for line in panel.lines:
        at_mm = np.column_stack([line[:, 0] - window[0], window[1] + window[3] - line[:, 1]])
        fixed = np.round((at_mm * px_per_mm - 0.5) * 2**SUB_PIXEL_BITS).astype(np.int32).reshape(-1, 1, 2)
        over = part.copy()
        cv2.polylines(over, [fixed], False, bgr(panel.line_colour), 2, cv2.LINE_AA, SUB_PIXEL_BITS)
        part[:] = over


def _draw_legend(image, x: int, y: int) -> None:
    signs = ((TARGET, "wanted", 18), (PREDICTED_INK, "painted, as predicted", 18), (TCP_LINE, "path of the tool", 4))
    for colour, word, height in signs:
        middle = y - 8
        image[middle - height // 2 : middle + height // 2, x : x + 34] = bgr(colour)
        x = write_text(image, word, (x + 46, y), 22, 400, MUTED_TEXT) + 48


def _panel_extent(panels: list[Panel]) -> tuple[float, float, float, float]:
    lines = [line for panel in panels for line in (*panel.target, *panel.painted, *panel.lines)]
    points = np.vstack([line[:, :2] for line in lines])
    (x0, y0), (x1, y1) = points.min(axis=0) - 1.0, points.max(axis=0) + 1.0
    return x0, y0, x1, y1
