"""Marks -> PNG: a page of predicted paint, and panels that hold it against what was wanted."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from .. import _core
from ..errors import Error
from .marks_svg import BAND, BOTH, EDGE, MISSING, OVERLAP_COLOURS, SPILT, check_picture, known_colour

PAPER = "#fdfcf9"
CARD = "#f3f1ec"
TEXT = "#22252b"
QUIET = "#767a82"
WANTED = "#b7b6b0"
INK = "#2b3a67"
TCP_LINE = "#3f8fd9"
MIDDLE_LINE = TEXT
MARGIN, TOP, BOTTOM, GAP, PAD = 56, 140, 84, 20, 28  # px, of the picture with panels
LABEL_W, LABEL_H = 480, 190
PNG_LONG_SIDE_PX = 2400
SUB_PIXEL_BITS = 4  # cv2 draws lines at 1/16 px


def marks_png(marks, brush, sheet_mm: tuple[float, float], colours: list[str], band=None, blank=()) -> bytes:
    """The sheet with its paint, anti-aliased, colours over each other in painting order. band: where the edges lie,
    with a legend; blank: rings of what of shapes stays blank, outlined."""
    check_picture(marks, sheet_mm, colours)
    px_per_mm = min(20.0, PNG_LONG_SIDE_PX / max(sheet_mm))
    window = (0.0, 0.0, *sheet_mm)
    image = None
    first = 0
    for last in range(1, len(colours) + 1):
        if last < len(colours) and colours[last] == colours[first]:
            continue
        run = _core.Marks()
        run.passes = list(marks.passes[first:last])
        paint = _core.coverage(run, brush, window, px_per_mm)
        image = _canvas(paint.shape, "#ffffff") if image is None else image
        _lay(image, paint, known_colour(colours[first]))
        first = last
    if image is None:
        raise Error("there is nothing to draw", code="nothing-to-show")
    for ring in blank:
        at = (np.asarray(ring) * (1, -1) + (0, sheet_mm[1])) * px_per_mm - 0.5
        fixed = np.round(at * 2**SUB_PIXEL_BITS).astype(np.int32).reshape(-1, 1, 2)
        thick = max(round(EDGE * max(image.shape[:2])), 1)
        cv2.polylines(image, [fixed], True, _bgr(MISSING), thick, cv2.LINE_AA, SUB_PIXEL_BITS)
    if band is not None:
        _draw_band(image, band, window, px_per_mm)
    return _png(image)


def _draw_band(image, band, window, px_per_mm: float) -> None:
    size = max(12, round(min(image.shape[:2]) / 40))
    left, low = size, image.shape[0] - size
    for rings in filter(None, band.rings):
        _lay(image, 0.45 * _core.coverage(rings, window, px_per_mm), BAND)
    if any(band.rings):
        box = np.zeros(image.shape[:2])
        box[low - size : low, left : left + 2 * size] = 0.45
        _lay(image, box, BAND)
        left += round(2.5 * size)
    _write(image, band.words, (left, low - round(0.15 * size)), size, 400, TEXT)


def overlap_png(wanted: np.ndarray, painted: np.ndarray) -> bytes:
    """Where paint is missing and where there is too much of it. wanted, painted: shares of the same pixels."""
    common = np.minimum(wanted, painted)
    rows, columns = common.shape
    size = max(14, round(0.016 * max(rows, columns)))
    image = _canvas((rows + 2 * size, columns), "#ffffff")
    shares = ((common, BOTH), (wanted - common, MISSING), (painted - common, SPILT))
    page = np.full((rows, columns, 3), 255.0)
    for share, colour in shares:  # side by side in a pixel, not over each other
        page -= share[..., None] * (255.0 - np.array(_bgr(colour)))
    image[:rows] = np.round(page).clip(0, 255).astype(np.uint8)
    x = size
    for colour, words in OVERLAP_COLOURS:
        image[rows + size // 2 : rows + 3 * size // 2, x : x + size] = _bgr(colour)
        x = _write(image, words, (x + 3 * size // 2, rows + 11 * size // 8), size, 400, TEXT) + 2 * size
    return _png(image)


@dataclass(frozen=True)
class Panel:
    """One picture of the comparison. Rings and lines in mm, paper frame.

    score: one figure to see from afar, and its name; notes: lines of text below it; lines: the TCP's paths or
    middle lines in line_colour.
    """

    title: str
    score: tuple[str, str]
    notes: tuple[str, ...]
    wanted: list
    painted: list
    lines: list
    line_colour: str = TCP_LINE


def panels_png(panels: list[Panel], heading: str, note: str, width_px: int = 2000) -> bytes:
    """The panels at one scale: under each other for a drawing that is wide, else side by side."""
    x0, y0, x1, y1 = _extent(panels)
    wide = x1 - x0 > 1.5 * (y1 - y0)
    across, down = (1, len(panels)) if wide else (len(panels), 1)
    card_w = (width_px - 2 * MARGIN - (across - 1) * GAP) // across
    text_w, text_h = (LABEL_W, 0) if wide else (0, LABEL_H)
    room_w, room_h = card_w - text_w - 2 * PAD, (366 if wide else 800)
    px_per_mm = min(room_w / (x1 - x0), room_h / (y1 - y0))
    picture_h = round((y1 - y0) * px_per_mm)
    card_h = max(picture_h + text_h, LABEL_H) + 2 * PAD
    slack_mm = room_w / px_per_mm - (x1 - x0)
    window = (x0 - slack_mm / 2, y0, x1 - x0 + slack_mm, y1 - y0)

    image = _canvas((TOP + down * (card_h + GAP) - GAP + BOTTOM, width_px), PAPER)
    _write(image, heading, (MARGIN, 70), 44, 600, TEXT)
    _write(image, note, (MARGIN, 110), 22, 400, QUIET)
    for number, panel in enumerate(panels):
        left = MARGIN + (0 if wide else number * (card_w + GAP))
        upper = TOP + (number * (card_h + GAP) if wide else 0)
        image[upper : upper + card_h, left : left + card_w] = _bgr(CARD)
        label_y = upper + (card_h - LABEL_H) // 2 if wide else upper + PAD
        _label(image, panel, left + PAD + 8, label_y)
        corner = (left + text_w + PAD, upper + (card_h - picture_h + text_h) // 2)
        _draw(image, panel, window, px_per_mm, corner)
    _legend(image, MARGIN, image.shape[0] - 34)
    return _png(image)


def _label(image, panel: Panel, x: int, y: int) -> None:
    _write(image, panel.title, (x, y + 30), 30, 600, TEXT)
    end = _write(image, panel.score[0], (x - 3, y + 108), 68, 500, INK)
    _write(image, panel.score[1], (end + 14, y + 108), 24, 400, QUIET)
    for line, text in enumerate(panel.notes):
        _write(image, text, (x, y + 150 + 32 * line), 22, 400, QUIET)


def _draw(image, panel: Panel, window, px_per_mm: float, corner: tuple[int, int]) -> None:
    wanted = _core.coverage(panel.wanted, window, px_per_mm)
    part = image[corner[1] : corner[1] + wanted.shape[0], corner[0] : corner[0] + wanted.shape[1]]
    wanted = wanted[: part.shape[0], : part.shape[1]]
    _lay(part, wanted, WANTED)
    if panel.painted:
        painted = _core.coverage(panel.painted, window, px_per_mm)[: part.shape[0], : part.shape[1]]
        _lay(part, 0.86 * painted, INK)
    for line in panel.lines:
        at_mm = np.column_stack([line[:, 0] - window[0], window[1] + window[3] - line[:, 1]])
        fixed = np.round((at_mm * px_per_mm - 0.5) * 2**SUB_PIXEL_BITS).astype(np.int32).reshape(-1, 1, 2)
        over = part.copy()
        cv2.polylines(over, [fixed], False, _bgr(panel.line_colour), 2, cv2.LINE_AA, SUB_PIXEL_BITS)
        part[:] = over


def _legend(image, x: int, y: int) -> None:
    signs = ((WANTED, "wanted", 18), (INK, "painted, as predicted", 18), (TCP_LINE, "path of the tool", 4))
    for colour, word, height in signs:
        middle = y - 8
        image[middle - height // 2 : middle + height // 2, x : x + 34] = _bgr(colour)
        x = _write(image, word, (x + 46, y), 22, 400, QUIET) + 48


def _extent(panels: list[Panel]) -> tuple[float, float, float, float]:
    lines = [line for panel in panels for line in (*panel.wanted, *panel.painted, *panel.lines)]
    points = np.vstack([line[:, :2] for line in lines])
    (x0, y0), (x1, y1) = points.min(axis=0) - 1.0, points.max(axis=0) + 1.0
    return x0, y0, x1, y1


def _canvas(shape: tuple[int, int], colour: str) -> np.ndarray:
    return np.full((*shape, 3), _bgr(colour), np.uint8)


def _lay(image: np.ndarray, coverage: np.ndarray, colour: str) -> None:
    share = coverage[..., None]
    image[:] = np.round(image * (1 - share) + np.array(_bgr(colour)) * share).astype(np.uint8)


def _bgr(colour: str) -> tuple[int, int, int]:
    return int(colour[5:7], 16), int(colour[3:5], 16), int(colour[1:3], 16)


def _write(image, text: str, baseline: tuple[int, int], size: int, weight: int, colour: str) -> int:
    """Text in OpenCV's own font; the x where it ends."""
    end, _ = cv2.putText(image, text, baseline, _bgr(colour), cv2.FontFace("sans"), size, weight)
    return int(end[0])


def _png(image: np.ndarray) -> bytes:
    return cv2.imencode(".png", image)[1].tobytes()
