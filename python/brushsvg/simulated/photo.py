"""Render a photograph of a job that no machine painted, with a printed notice that says so."""

from __future__ import annotations

import math

import cv2
import numpy as np

from ..calibration.chart.page import bar_rings, label_box, marker_rings
from ..comparison.job_page import JobPage
from ..errors import Error
from .camera import BLUE, INK, Camera, Sheet, corners_seen, encoded, exposed
from .paint_with_errors import PaintedStroke
from .studio_errors import Lens, Studio

NOTICE = "SIMULATED PHOTOGRAPH, painted by no machine (brushsvg simulate-photo)"
# Limits of the texels on the whole sheet and per mm. Below the minimum per mm, the sheet's edges would be blurred.
MAX_TEXELS, MAX_TEXELS_PER_MM, MIN_TEXELS_PER_MM = 40e6, 20.0, 3.0
LABEL_COLOUR = np.array([0.46, 0.46, 0.46])  # reflected light of printed letters
# Shares of the picture that the page fills. The first share that shows the whole page is used.
PAGE_FILLS = (0.88, 0.84, 0.8, 0.75, 0.7)
NOTICE_HEIGHT_SHARE = 0.032  # of the picture's height, covered by the notice
DRYING_SHARE = 0.6  # of the distance that the paint lasts: over this distance the paint runs out completely


def simulated_photo(page: JobPage, strokes: list[PaintedStroke], studio: Studio, seed: int) -> bytes:
    """Return the photograph of a painted page as a JPEG.

    Raises Error where the page is too large, or where the camera cannot see all of it.
    """
    camera = place_camera(studio.camera, page.size_mm)
    width, height = page.size_mm
    texels = min(MAX_TEXELS_PER_MM, math.sqrt(MAX_TEXELS / (width * height)))
    if texels < MIN_TEXELS_PER_MM:
        most = MAX_TEXELS / MIN_TEXELS_PER_MM**2 / 1e6
        sentence = (
            f"the area of the page, {width:g} x {height:g} mm, is outside the range [0, {most:.1f}] m^2 of a photograph"
        )
        raise Error(sentence, code="out-of-range")
    sheet = Sheet(page.size_mm, seed, texels)
    _print_page(sheet, page)
    for number, stroke in enumerate(strokes):
        opacity = _opacity_along_stroke(stroke, page.frame_mm, studio.paint.lasts_mm, seed + number)
        sheet.paint([ring + page.frame_mm for ring in stroke.rings], BLUE, opacity)
    pixels = exposed(sheet, camera, seed)
    _write_notice(pixels)
    return encoded(pixels, camera.quality)


def place_camera(lens: Lens, page_mm) -> Camera:
    """Return a camera that is high enough to see the whole page.

    Raises Error where it would have to be too far from the page.
    """
    for fill in PAGE_FILLS:
        camera = _camera_with_fill(lens, page_mm, fill)
        width, height = page_mm
        at = corners_seen(camera, page_mm, [(0, 0), (width, 0), (width, height), (0, height)])
        if (at > 0).all() and (at < (camera.size_px[0], camera.size_px[1] * (1 - NOTICE_HEIGHT_SHARE))).all():
            return camera
    across, up = lens.tilt_deg
    sentence = (
        f"the camera does not see the whole page if it is tilted by {across:g} and {up:g} degrees and turned by "
        f"{lens.turn_deg:g} degrees: tilt or turn it less"
    )
    raise Error(sentence, "camera", code="out-of-range")


def _camera_with_fill(lens: Lens, page_mm, fill: float) -> Camera:
    long = max(page_mm)
    size = tuple(round(lens.long_side_px * side / long) for side in page_mm)
    return Camera(
        size,
        lens.focal,
        lens.tilt_deg,
        lens.turn_deg,
        lens.bend,
        fill=fill,
        displacement_mm=(0.004 * long, 0.0),
        blur_px=lens.blur_px,
        noise=lens.noise,
        shadow=lens.shadow,
        quality=round(lens.quality),
    )


def _print_page(sheet: Sheet, page: JobPage) -> None:
    printed = page.printed
    for marker in printed.markers:
        sheet.paint(marker_rings(marker, printed.dictionary), INK)
    if printed.bar:
        sheet.paint(bar_rings(printed.bar), INK)
    for tick in page.ticks:
        sheet.paint([tick], INK)
    for label in printed.labels:
        left, _, right, _ = label_box(label)
        (text_width, text_height), descent = cv2.getTextSize(label.text, cv2.FONT_HERSHEY_SIMPLEX, 1.0, 1)
        width_px = (right - left) * sheet.texels
        scale = width_px / text_width
        thickness = round(1.5 * scale)
        # Thick letters are wider than thin ones.
        scale *= width_px / cv2.getTextSize(label.text, cv2.FONT_HERSHEY_SIMPLEX, scale, thickness)[0][0]
        size = math.ceil((text_height + descent) * scale) + 4, math.ceil(1.3 * text_width * scale) + 4
        at = 2, math.ceil(text_height * scale) + 2
        letters = np.zeros(size, np.uint8)
        cv2.putText(letters, label.text, at, cv2.FONT_HERSHEY_SIMPLEX, scale, 255, thickness, cv2.LINE_AA)
        row = round((page.size_mm[1] - label.at_mm[1]) * sheet.texels) - at[1]
        column = round(left * sheet.texels) - at[0]
        window = sheet.shown[row : row + size[0], column : column + size[1]]
        share = letters[: window.shape[0], : window.shape[1], None] / np.float32(255)
        window += share * (LABEL_COLOUR - window).astype(np.float32)


def _opacity_along_stroke(stroke: PaintedStroke, frame_mm: float, lasts_mm: float, seed: int):
    """Return the opacity of a stroke whose paint may run out.

    The opacity is a number, or a function of x and y where the paint runs out. Beyond lasts_mm, fewer and fewer
    bristles still paint. Returns a constant for a stroke that is shorter, or where lasts_mm is 0.
    """
    if not lasts_mm or not len(stroke.way) or stroke.way[-1, 2] <= lasts_mm:
        return 0.97
    way = stroke.way + np.array([frame_mm, frame_mm, 0.0])

    def opacity(x, y):
        rows, columns = len(y), len(x)
        step = (x[1] - x[0]) if columns > 1 else 1.0
        row = np.clip(np.round((y[0] - way[:, 1]) / step).astype(int), 0, rows - 1)
        column = np.clip(np.round((way[:, 0] - x[0]) / step).astype(int), 0, columns - 1)
        seeds, travelled_mm = np.ones((rows, columns), np.uint8), np.zeros(rows * columns + 1)
        seeds[row, column] = 0
        _, label = cv2.distanceTransformWithLabels(seeds, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
        travelled_mm[label[row, column]] = way[:, 2]
        paint_left = np.clip(1 - (travelled_mm[label] - lasts_mm) / (DRYING_SHARE * lasts_mm), 0, 1)
        grain = np.random.default_rng(seed).normal(size=(rows, columns)).astype(np.float32)
        grain = cv2.GaussianBlur(grain, None, 0.25 / step)
        rank = 0.5 * (1 + np.tanh(grain / max(float(grain.std()), 1e-9)))
        return 0.97 * np.clip((1.15 * paint_left - rank) / 0.15, 0, 1)

    return opacity


def _write_notice(pixels: np.ndarray) -> None:
    rows, columns = pixels.shape[:2]
    strip_height = round(NOTICE_HEIGHT_SHARE * rows)
    pixels[rows - strip_height :] = (120, 0, 0)
    (text_width, text_height), _ = cv2.getTextSize(NOTICE, cv2.FONT_HERSHEY_SIMPLEX, 1.0, 2)
    scale = min(0.7 * strip_height / text_height, 0.9 * columns / text_width)
    at = (
        round((columns - scale * text_width) / 2),
        round(rows - 0.5 * strip_height + 0.5 * scale * text_height),
    )
    cv2.putText(
        pixels,
        NOTICE,
        at,
        cv2.FONT_HERSHEY_SIMPLEX,
        scale,
        (255, 255, 255),
        max(1, round(2 * scale)),
        cv2.LINE_AA,
    )
