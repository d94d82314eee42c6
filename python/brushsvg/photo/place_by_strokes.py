"""Find a sheet without markers in a flatbed's scan from its strokes alone.

The scanner's resolution gives the scale, and there is no perspective: what is left is a turn and a shift. They are
first those at which most paint is along the strokes' ways, then those that bring each mark to the middle of its box.
"""

from __future__ import annotations

import cmath
import math

import cv2
import numpy as np

from ..errors import Error
from .edges import LEAST_LENGTH, SEEN, STRAY_MM, StrokeBox, paint_seen
from .flatten import Flat
from .markers import FEWEST, LEAST_PX_PER_MM, View, detected

MM_PER_INCH = 25.4
ENOUGH_PX_PER_MM = (
    12.0  # of 600 dpi half of the pixels each way: finer says nothing of a brush and takes gigabytes
)
COARSE_PX_PER_MM = 3.0  # in which marks are looked for
WAYS_MM, NEAR_MM = 3.0, 2.0  # how broad ways are drawn, and over how much both pictures are blurred
AROUND_MM = 10  # to which ways are broadened and blurred around them
ASKEW_DEG, STEP_DEG = 8, 1  # greatest turn of a sheet on the glass; tried in steps
# times as well that a mirrored scan fits mirrored ways: charts match 1.7 times, other pictures 1.01 either way
MIRRORED = 1.2
EXTENT = (0.8, 1.25)  # of what is painted against the chart's: beyond, it is another resolution
SCALE = 0.03  # by which a brush of another thickness moves marks apart: more is another resolution
FOUND = 0.6  # share of the strokes whose marks must be in their rooms
WITHIN = 0.7  # of a mark, in its room
SPECK_MM2 = 2.0
LEAST_MM = 20.0  # of a sheet


def find_scan_view(
    pixels: np.ndarray,
    dpi: float,
    sheet_mm,
    stroke_boxes: list[StrokeBox],
    ways_mm: list[np.ndarray],
    dictionary: str,
) -> tuple[np.ndarray, View]:
    """ways_mm: of the TCP, pressed, (n, 2) by room. The picture, made smaller where it is finer than is of use, and the
    view of the sheet in it, which has seen no markers. Error where it has some, is mirrored, of another resolution or
    of other strokes."""
    fine = dpi / MM_PER_INCH
    if fine < LEAST_PX_PER_MM:
        raise Error(
            f"{dpi:g} dpi are {fine:.1f} pixels per mm, at least {LEAST_PX_PER_MM:g} are needed: scan at 300 or more",
            value=dpi,
            code="photo-too-coarse",
        )
    if min(pixels.shape[:2]) < fine * LEAST_MM:
        height, width = (each / fine for each in pixels.shape[:2])
        raise Error(
            f"at {dpi:g} dpi the picture is {width:.2g} x {height:.2g} mm large: no sheet is",
            value=dpi,
            code="scan-resolution",
        )
    if len({number for number, _ in detected(pixels, dictionary)}) >= FEWEST:
        raise Error(
            "the scan shows a chart's printed markers, which give its place better than --dpi: leave --dpi out",
            code="scan-with-markers",
        )
    if fine > ENOUGH_PX_PER_MM:
        size = ENOUGH_PX_PER_MM / fine
        pixels = cv2.resize(pixels, None, fx=size, fy=size, interpolation=cv2.INTER_AREA)
        fine = ENOUGH_PX_PER_MM
    shrunk = COARSE_PX_PER_MM / fine
    coarse = cv2.resize(pixels, None, fx=shrunk, fy=shrunk, interpolation=cv2.INTER_AREA)
    paint = _painted(coarse)
    _refuse_another_size(paint, stroke_boxes, dpi)
    turn, shift = _along_ways(paint, ways_mm)
    unit, shift = _into_rooms(paint, sheet_mm, stroke_boxes, turn, shift, dpi)
    unit, shift = unit * fine, (shift * COARSE_PX_PER_MM + 0.5 * (1 + 1j)) / shrunk - 0.5 * (1 + 1j)
    homography = np.array(
        [[unit.real, unit.imag, shift.real], [unit.imag, -unit.real, shift.imag], [0.0, 0.0, 1.0]]
    )
    return pixels, View(homography, (), np.zeros(2), 1.0, fine)


def _painted(coarse: np.ndarray) -> np.ndarray:
    """Mask (rows, columns) of the marks, without what hangs on the picture's edge: lid and table."""
    rows, columns = coarse.shape[:2]
    sheet = (columns / COARSE_PX_PER_MM, rows / COARSE_PX_PER_MM)
    flat = Flat(coarse, COARSE_PX_PER_MM, sheet)
    seen = paint_seen(flat, np.zeros((rows, columns), np.uint8), [StrokeBox("", (0.0, 0.0, *sheet))])
    _, part, stats, _ = cv2.connectedComponentsWithStats(np.uint8(seen > SEEN), connectivity=8)
    kept = stats[:, cv2.CC_STAT_AREA] > SPECK_MM2 * COARSE_PX_PER_MM**2
    rim = max(1, round(3.0 * COARSE_PX_PER_MM))
    beyond = np.concatenate(
        [part[:rim].ravel(), part[-rim:].ravel(), part[:, :rim].ravel(), part[:, -rim:].ravel()]
    )
    kept[np.unique(beyond)] = False
    kept[0] = False
    return kept[part]


def _refuse_another_size(paint: np.ndarray, stroke_boxes: list[StrokeBox], dpi: float) -> None:
    boxes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    expected = sorted(boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0))
    rows, columns = np.flatnonzero(paint.any(axis=1)), np.flatnonzero(paint.any(axis=0))
    if not len(rows):
        raise Error(
            "no paint is found on the scan: is it the painted sheet, and clear of the glass's edges?",
            code="photo-without-paint",
        )
    found = sorted(np.array([np.ptp(rows) + 1, np.ptp(columns) + 1]) / COARSE_PX_PER_MM)
    size = math.sqrt(found[0] * found[1] / (expected[0] * expected[1]))
    if not EXTENT[0] < size < EXTENT[1]:
        raise Error(
            f"at {dpi:g} dpi the paint on the scan covers {found[1]:.0f} x {found[0]:.0f} mm, the strokes of the "
            f"chart over {expected[1]:.0f} x {expected[0]:.0f} mm: was it scanned at {_usual(dpi * size)} dpi, in one "
            "piece, and is it this chart?",
            value=dpi,
            code="scan-resolution",
        )


def _usual(dpi: float) -> str:
    """A resolution that scanners have, where one is near."""
    near = min((150, 200, 240, 300, 400, 600, 800, 1200, 2400), key=lambda each: abs(math.log(each / dpi)))
    return f"{near}" if abs(math.log(near / dpi)) < 0.02 else f"about {dpi:.0f}"


def _along_ways(paint: np.ndarray, ways_mm: list[np.ndarray]) -> tuple[float, complex]:
    """Turn [rad] and shift [mm, down], roughly: place in the scan = (x - iy) e^(i turn) + shift."""
    down = [way[:, 0] - 1j * way[:, 1] for way in ways_mm]
    seen, shape = spectrum(paint, down)
    best = {}
    for is_mirrored in (False, True):
        ways = [-way.conj() for way in down] if is_mirrored else down
        turns = [
            math.radians(quarter + askew)
            for quarter in (0, 90, 180, 270)
            for askew in range(-ASKEW_DEG, ASKEW_DEG + 1, STEP_DEG)
        ]
        tried = [
            (*match_ways(seen, shape, [way * cmath.exp(1j * turn) for way in ways]), turn) for turn in turns
        ]
        best[is_mirrored] = max(tried, key=lambda each: each[0])
    if best[True][0] > MIRRORED * best[False][0]:
        raise Error(
            "the scan is mirrored: turn off the mirroring of the scanner's program, or flip the picture back",
            code="photo-mirrored",
        )
    _, shift, turn = best[False]
    return turn, shift


def spectrum(paint: np.ndarray, ways: list[np.ndarray]) -> tuple[np.ndarray, tuple[int, int]]:
    """Spectrum of a coarse picture of paint, with so much room around it that ways fit next to it; the picture's shape
    at a pixel per mm."""
    small = cv2.resize(
        paint.astype(np.float32),
        None,
        fx=1 / COARSE_PX_PER_MM,
        fy=1 / COARSE_PX_PER_MM,
        interpolation=cv2.INTER_AREA,
    )
    # both next to each other, with the blur around the ways: one end must not wrap round to the other
    every = np.concatenate(ways)
    reach = math.ceil(math.hypot(np.ptp(every.real), np.ptp(every.imag))) + 2 * AROUND_MM + max(small.shape)
    size = cv2.getOptimalDFTSize(reach)
    return np.fft.rfft2(cv2.GaussianBlur(small, None, NEAR_MM), (size, size)), small.shape


def match_ways(seen: np.ndarray, shape: tuple[int, int], ways: list[np.ndarray]) -> tuple[float, complex]:
    """Return how much paint is along the ways (x - iy) at the best shift, and that shift. seen, shape: of `spectrum`;
    shifts beyond the picture are those up and to the left."""
    size = len(seen)
    every = np.concatenate(ways)
    corner = complex(math.floor(every.real.min()), math.floor(every.imag.min())) - AROUND_MM * (1 + 1j)
    drawn = np.zeros((size, size), np.float32)
    for way in ways:
        points = np.column_stack([(way - corner).real, (way - corner).imag])
        cv2.polylines(drawn, [np.round(points).astype(np.int32)[:, None]], False, 1.0, round(WAYS_MM))
    drawn = cv2.GaussianBlur(drawn, None, NEAR_MM)
    match = np.fft.irfft2(seen * np.conj(np.fft.rfft2(drawn)), (size, size))
    row, column = np.unravel_index(int(match.argmax()), match.shape)
    row, column = (k - size if k >= end else k for k, end in zip((row, column), shape, strict=True))
    return float(match.max() / np.linalg.norm(drawn)), complex(column, row) - corner


def _into_rooms(
    paint: np.ndarray, sheet_mm, stroke_boxes: list[StrokeBox], turn: float, shift: complex, dpi: float
) -> tuple[complex, complex]:
    """e^(i turn) and shift, finer: the middles of marks' boxes on the middles of their rooms, by least squares."""
    fine = COARSE_PX_PER_MM
    columns, rows = (math.ceil(side * fine) for side in sheet_mm)
    boxes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    middles = 0.5 * (boxes[:, :2] + boxes[:, 2:]) @ [1, -1j]
    unit = cmath.exp(1j * turn)
    for _ in range(4):
        start = (-1j * sheet_mm[1] * unit + shift) * fine  # the sheet's upper left corner
        to_scan = np.array([[unit.real, -unit.imag, start.real], [unit.imag, unit.real, start.imag]])
        aligned = cv2.warpAffine(
            np.uint8(paint), to_scan, (columns, rows), flags=cv2.WARP_INVERSE_MAP | cv2.INTER_NEAREST
        )
        of, places = marks_in(aligned, sheet_mm, stroke_boxes)
        if len(of) < max(FEWEST, FOUND * len(stroke_boxes)):
            raise Error(
                f"only {len(of)} of the {len(stroke_boxes)} strokes of this chart are where they should be on the "
                f"scan, at least {math.ceil(FOUND * len(stroke_boxes))} are needed: is it this chart, painted once, "
                f"scanned in one piece at {dpi:g} dpi?",
                value=len(of),
                code="photo-paint-elsewhere",
            )
        change, moved = similar(middles[of], places)
        size = abs(change)
        shift += unit * moved
        unit *= change / size
    if abs(size - 1) > SCALE:
        raise Error(
            f"the strokes are {size:.3f} times as far from each other as on the chart: was the sheet scanned at "
            f"{_usual(dpi * size)} instead of {dpi:g} dpi?",
            value=dpi,
            code="scan-resolution",
        )
    return unit, shift


def marks_in(aligned: np.ndarray, sheet_mm, stroke_boxes: list[StrokeBox]) -> tuple[list[int], np.ndarray]:
    """Numbers of the rooms that hold one mark, and the middles of those marks' boxes, down."""
    fine = COARSE_PX_PER_MM
    count, part, stats, _ = cv2.connectedComponentsWithStats(aligned, connectivity=8)
    of, places = [], []
    for number, stroke_box in enumerate(stroke_boxes):
        left, bottom, right, top = stroke_box.box_mm
        c0, c1 = (round(max(x, 0.0) * fine) for x in (left - STRAY_MM / 2, right + STRAY_MM / 2))
        r0, r1 = (
            round(max(sheet_mm[1] - y, 0.0) * fine) for y in (top + STRAY_MM / 2, bottom - STRAY_MM / 2)
        )
        here = np.bincount(part[r0:r1, c0:c1].ravel(), minlength=count)
        here[0] = 0
        main = int(here.argmax())
        x, y, wide, tall, area = stats[main]
        is_whole = main and here[main] > WITHIN * area
        if is_whole and max(wide, tall) > LEAST_LENGTH * fine * max(right - left, top - bottom):
            of.append(number)
            places.append(complex((x + wide / 2) / fine, (y + tall / 2) / fine - sheet_mm[1]))
    return of, np.array(places)


def similar(middles: np.ndarray, places: np.ndarray) -> tuple[complex, complex]:
    """Fit (a, b) of places = a middles + b, without outliers."""
    kept = np.ones(len(middles), bool)
    for _ in range(4):
        columns = np.column_stack([middles[kept], np.ones(kept.sum())])
        (a, b), *_ = np.linalg.lstsq(columns, places[kept], rcond=None)
        off = np.abs(a * middles + b - places)
        kept = off <= max(2.5 * float(np.median(off)), 0.3)
    return complex(a), complex(b)
