"""Find a sheet without markers in a flatbed's scan from its strokes alone.

The scanner's resolution gives the scale, and there is no perspective, so that only a turn and a shift are unknown.
They are chosen in two steps: first most paint must be along the strokes' paths, then each mark must be in the middle
of its box.
"""

from __future__ import annotations

import cmath
import math

import cv2
import numpy as np

from ..errors import Error
from .edges import MAX_STRAY_MM, MIN_LENGTH_SHARE, SEEN, paint_seen
from .flatten import Flat
from .markers import MIN_MARKERS, MIN_PX_PER_MM, View, detect_markers
from .stroke_boxes import StrokeBox

MM_PER_INCH = 25.4
# Half of the pixels of a 600 dpi scan in each direction. More adds nothing about a brush, and needs gigabytes.
MAX_PX_PER_MM = 12.0
COARSE_PX_PER_MM = 3.0  # resolution at which marks are searched
PATH_WIDTH_MM, BLUR_MM = 3.0, 2.0  # width of the drawn paths, and blur of both pictures that are compared
MARGIN_MM = 10  # around the drawn paths, for their width and blur
# Greatest turn of a sheet on the glass, and the step in which turns are tried.
MAX_SKEW_DEG, TURN_STEP_DEG = 8, 1
# Ratio of the fit of mirrored paths to that of unmirrored ones. Mirrored charts have 1.7, other pictures about 1.01.
MIN_MIRRORED_RATIO = 1.2
SIZE_RANGE = (0.8, 1.25)  # size of the painted area relative to the chart's: beyond, the resolution is wrong
MAX_SCALE_ERROR = 0.03  # a brush of another thickness moves marks apart by less; more is another resolution
MIN_FOUND_SHARE = 0.6  # share of the strokes whose marks must be in their boxes
MIN_SHARE_IN_BOX = 0.7  # share of a mark that must be in its box
MIN_MARK_MM2 = 2.0
MIN_SHEET_MM = 20.0


def find_scan_view(
    pixels: np.ndarray,
    dpi: float,
    sheet_mm,
    stroke_boxes: list[StrokeBox],
    paths_mm: list[np.ndarray],
    dictionary: str,
) -> tuple[np.ndarray, View]:
    """Find the view of a sheet without markers in a scan.

    paths_mm: paths (n, 2) of the TCP while it paints, one per box. Returns the picture, reduced where its resolution
    is higher than useful, and the view of the sheet in it. Raises Error where the scan shows markers, is mirrored, has
    another resolution or shows other strokes.
    """
    px_per_mm = dpi / MM_PER_INCH
    if px_per_mm < MIN_PX_PER_MM:
        raise Error(
            f"{dpi:g} dpi are only {px_per_mm:.1f} pixels per mm, at least {MIN_PX_PER_MM:g} are needed: scan at 300 "
            "dpi or more",
            value=dpi,
            code="photo-too-coarse",
        )
    if min(pixels.shape[:2]) < px_per_mm * MIN_SHEET_MM:
        height, width = (side_px / px_per_mm for side_px in pixels.shape[:2])
        sentence = (
            f"at {dpi:g} dpi the picture is only {width:.2g} x {height:.2g} mm large, smaller than any sheet: check "
            "the resolution of the scan"
        )
        raise Error(sentence, value=dpi, code="scan-resolution")
    if len({number for number, _ in detect_markers(pixels, dictionary)}) >= MIN_MARKERS:
        sentence = "the scan shows printed markers, which are more exact than --dpi: remove --dpi"
        raise Error(sentence, code="scan-with-markers")
    if px_per_mm > MAX_PX_PER_MM:
        size = MAX_PX_PER_MM / px_per_mm
        pixels = cv2.resize(pixels, None, fx=size, fy=size, interpolation=cv2.INTER_AREA)
        px_per_mm = MAX_PX_PER_MM
    shrunk = COARSE_PX_PER_MM / px_per_mm
    coarse = cv2.resize(pixels, None, fx=shrunk, fy=shrunk, interpolation=cv2.INTER_AREA)
    paint = _find_paint_mask(coarse)
    _refuse_another_size(paint, stroke_boxes, dpi)
    turn, shift = _match_turn_and_shift(paint, paths_mm)
    unit, shift = _refine_by_boxes(paint, sheet_mm, stroke_boxes, turn, shift, dpi)
    unit, shift = unit * px_per_mm, (shift * COARSE_PX_PER_MM + 0.5 * (1 + 1j)) / shrunk - 0.5 * (1 + 1j)
    homography = np.array([[unit.real, unit.imag, shift.real], [unit.imag, -unit.real, shift.imag], [0.0, 0.0, 1.0]])
    return pixels, View(homography, (), np.zeros(2), 1.0, px_per_mm)


def _find_paint_mask(coarse: np.ndarray) -> np.ndarray:
    """Return the mask (rows, columns) of marks, without parts at the edge such as lid and table."""
    rows, columns = coarse.shape[:2]
    sheet = (columns / COARSE_PX_PER_MM, rows / COARSE_PX_PER_MM)
    flat = Flat(coarse, COARSE_PX_PER_MM, sheet)
    amount = paint_seen(flat, np.zeros((rows, columns), np.uint8), [StrokeBox("", (0.0, 0.0, *sheet))])
    _, part, stats, _ = cv2.connectedComponentsWithStats(np.uint8(amount > SEEN), connectivity=8)
    is_kept = stats[:, cv2.CC_STAT_AREA] > MIN_MARK_MM2 * COARSE_PX_PER_MM**2
    rim = max(1, round(3.0 * COARSE_PX_PER_MM))
    edge_parts = np.concatenate(
        [part[:rim].ravel(), part[-rim:].ravel(), part[:, :rim].ravel(), part[:, -rim:].ravel()]
    )
    is_kept[np.unique(edge_parts)] = False
    is_kept[0] = False
    return is_kept[part]


def _refuse_another_size(paint: np.ndarray, stroke_boxes: list[StrokeBox], dpi: float) -> None:
    boxes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    expected = sorted(boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0))
    rows, columns = np.flatnonzero(paint.any(axis=1)), np.flatnonzero(paint.any(axis=0))
    if not len(rows):
        sentence = (
            "no paint was found on the scan: check that it shows the painted sheet, clear of the edges of the glass"
        )
        raise Error(sentence, code="photo-without-paint")
    painted_mm = sorted(np.array([np.ptp(rows) + 1, np.ptp(columns) + 1]) / COARSE_PX_PER_MM)
    size = math.sqrt(painted_mm[0] * painted_mm[1] / (expected[0] * expected[1]))
    if not SIZE_RANGE[0] < size < SIZE_RANGE[1]:
        raise Error(
            f"at {dpi:g} dpi the paint on the scan covers {painted_mm[1]:.0f} x {painted_mm[0]:.0f} mm, but the "
            f"strokes of the chart cover {expected[1]:.0f} x {expected[0]:.0f} mm. Check whether it was scanned at "
            f"{_name_resolution(dpi * size)} dpi, that it is in one piece, and that it is this chart",
            value=dpi,
            code="scan-resolution",
        )


def _name_resolution(dpi: float) -> str:
    """Return the nearest usual resolution of scanners, or "about" and the number if none is near."""
    nearest_dpi = min(
        (150, 200, 240, 300, 400, 600, 800, 1200, 2400), key=lambda candidate: abs(math.log(candidate / dpi))
    )
    return f"{nearest_dpi}" if abs(math.log(nearest_dpi / dpi)) < 0.02 else f"about {dpi:.0f}"


def _match_turn_and_shift(paint: np.ndarray, paths_mm: list[np.ndarray]) -> tuple[float, complex]:
    """Return the rough turn [rad] and shift [mm]; in the scan: (x - iy) e^(i turn) + shift, y down."""
    down = [path[:, 0] - 1j * path[:, 1] for path in paths_mm]
    spectrum, shape = paint_spectrum(paint, down)
    best = {}
    for is_mirrored in (False, True):
        paths = [-path.conj() for path in down] if is_mirrored else down
        turns = [
            math.radians(quarter + askew)
            for quarter in (0, 90, 180, 270)
            for askew in range(-MAX_SKEW_DEG, MAX_SKEW_DEG + 1, TURN_STEP_DEG)
        ]
        tried = [
            (*match_paths(spectrum, shape, [path * cmath.exp(1j * turn) for path in paths]), turn) for turn in turns
        ]
        best[is_mirrored] = max(tried, key=lambda each: each[0])
    if best[True][0] > MIN_MIRRORED_RATIO * best[False][0]:
        sentence = "the scan is mirrored: turn off the mirroring of the scanner's program, or flip the picture back"
        raise Error(sentence, code="photo-mirrored")
    _, shift, turn = best[False]
    return turn, shift


def paint_spectrum(paint: np.ndarray, paths: list[np.ndarray]) -> tuple[np.ndarray, tuple[int, int]]:
    """Return the spectrum of a coarse picture of paint.

    Returns also the picture's shape at one pixel per mm. The picture is padded so that the paths fit next to it.
    """
    small = cv2.resize(
        paint.astype(np.float32),
        None,
        fx=1 / COARSE_PX_PER_MM,
        fy=1 / COARSE_PX_PER_MM,
        interpolation=cv2.INTER_AREA,
    )
    # The picture and the blurred paths fit next to each other, so that neither wraps around to the other.
    all_points = np.concatenate(paths)
    reach = math.ceil(math.hypot(np.ptp(all_points.real), np.ptp(all_points.imag))) + 2 * MARGIN_MM + max(small.shape)
    size = cv2.getOptimalDFTSize(reach)
    return np.fft.rfft2(cv2.GaussianBlur(small, None, BLUR_MM), (size, size)), small.shape


def match_paths(spectrum: np.ndarray, shape: tuple[int, int], paths: list[np.ndarray]) -> tuple[float, complex]:
    """Return how much paint is along the paths at the best shift.

    Returns also this shift. Paths are given as x - iy. spectrum, shape: from `paint_spectrum`. Shifts beyond the
    picture's shape are negative: up and to the left.
    """
    size = len(spectrum)
    all_points = np.concatenate(paths)
    corner = complex(math.floor(all_points.real.min()), math.floor(all_points.imag.min())) - MARGIN_MM * (1 + 1j)
    drawn = np.zeros((size, size), np.float32)
    for path in paths:
        points = np.column_stack([(path - corner).real, (path - corner).imag])
        cv2.polylines(drawn, [np.round(points).astype(np.int32)[:, None]], False, 1.0, round(PATH_WIDTH_MM))
    drawn = cv2.GaussianBlur(drawn, None, BLUR_MM)
    match = np.fft.irfft2(spectrum * np.conj(np.fft.rfft2(drawn)), (size, size))
    row, column = np.unravel_index(int(match.argmax()), match.shape)
    row, column = (k - size if k >= end else k for k, end in zip((row, column), shape, strict=True))
    return float(match.max() / np.linalg.norm(drawn)), complex(column, row) - corner


def _refine_by_boxes(
    paint: np.ndarray, sheet_mm, stroke_boxes: list[StrokeBox], turn: float, shift: complex, dpi: float
) -> tuple[complex, complex]:
    """Refine e^(i turn) and shift: the marks' middles fit those of the boxes by least squares."""
    px_per_mm = COARSE_PX_PER_MM
    columns, rows = (math.ceil(side * px_per_mm) for side in sheet_mm)
    boxes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    middles = 0.5 * (boxes[:, :2] + boxes[:, 2:]) @ [1, -1j]
    unit = cmath.exp(1j * turn)
    for _ in range(4):
        start = (-1j * sheet_mm[1] * unit + shift) * px_per_mm  # the sheet's upper left corner
        to_scan = np.array([[unit.real, -unit.imag, start.real], [unit.imag, unit.real, start.imag]])
        aligned = cv2.warpAffine(
            np.uint8(paint), to_scan, (columns, rows), flags=cv2.WARP_INVERSE_MAP | cv2.INTER_NEAREST
        )
        numbers, places = find_marks_in_boxes(aligned, sheet_mm, stroke_boxes)
        if len(numbers) < max(MIN_MARKERS, MIN_FOUND_SHARE * len(stroke_boxes)):
            raise Error(
                f"only {len(numbers)} of the {len(stroke_boxes)} strokes of this chart are where they should be on the "
                f"scan, at least {math.ceil(MIN_FOUND_SHARE * len(stroke_boxes))} are needed. Check that it is this "
                f"chart, painted once, and scanned in one piece at {dpi:g} dpi",
                value=len(numbers),
                code="photo-paint-elsewhere",
            )
        change, moved = fit_similarity(middles[numbers], places)
        size = abs(change)
        shift += unit * moved
        unit *= change / size
    if abs(size - 1) > MAX_SCALE_ERROR:
        raise Error(
            f"the strokes are {size:.3f} times as far from each other as on the chart: check whether the sheet was "
            f"scanned at {_name_resolution(dpi * size)} dpi instead of {dpi:g} dpi",
            value=dpi,
            code="scan-resolution",
        )
    return unit, shift


def find_marks_in_boxes(aligned: np.ndarray, sheet_mm, stroke_boxes: list[StrokeBox]) -> tuple[list[int], np.ndarray]:
    """Return the numbers of the boxes that hold one mark, and the marks' places.

    The places are the middles of the marks, as x - iy [mm]. aligned: mask (rows, columns) of the paint, at
    COARSE_PX_PER_MM.
    """
    px_per_mm = COARSE_PX_PER_MM
    count, part, stats, _ = cv2.connectedComponentsWithStats(aligned, connectivity=8)
    numbers, places = [], []
    for number, stroke_box in enumerate(stroke_boxes):
        left, bottom, right, top = stroke_box.box_mm
        c0, c1 = (round(max(x, 0.0) * px_per_mm) for x in (left - MAX_STRAY_MM / 2, right + MAX_STRAY_MM / 2))
        r0, r1 = (
            round(max(sheet_mm[1] - y, 0.0) * px_per_mm) for y in (top + MAX_STRAY_MM / 2, bottom - MAX_STRAY_MM / 2)
        )
        areas_in_box = np.bincount(part[r0:r1, c0:c1].ravel(), minlength=count)
        areas_in_box[0] = 0
        main = int(areas_in_box.argmax())
        x, y, width, height, area = stats[main]
        is_whole = main and areas_in_box[main] > MIN_SHARE_IN_BOX * area
        if is_whole and max(width, height) > MIN_LENGTH_SHARE * px_per_mm * max(right - left, top - bottom):
            numbers.append(number)
            places.append(complex((x + width / 2) / px_per_mm, (y + height / 2) / px_per_mm - sheet_mm[1]))
    return numbers, np.array(places)


def fit_similarity(middles: np.ndarray, places: np.ndarray) -> tuple[complex, complex]:
    """Fit a and b of places = a middles + b without outliers, all complex."""
    is_inlier = np.ones(len(middles), bool)
    for _ in range(4):
        columns = np.column_stack([middles[is_inlier], np.ones(is_inlier.sum())])
        (a, b), *_ = np.linalg.lstsq(columns, places[is_inlier], rcond=None)
        distances = np.abs(a * middles + b - places)
        is_inlier = distances <= max(2.5 * float(np.median(distances)), 0.3)
    return complex(a), complex(b)
