"""Measure a scan of real strokes in a printed grid.

    real_scan.py SCAN [--picture FILE]

The scale comes from the printed bar of two inches, places from the grid, and outlines are read as by `calibrate
--scan`. Grid and bar are those of the sheets of github.com/Ardibid/ArtisticStyleRoboticPainting: square cells with
one stroke each, and a bar of two inches below. The program prints how far the grid's crossings are from even ones, and
the size of the cells. For each stroke it prints the area, the number of parts and holes, and the raggedness. The
picture shows the result.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np

from brushsvg.geometry.rings import signed_area
from brushsvg.photo.edges import find_marks
from brushsvg.photo.flatten import Flat
from brushsvg.photo.photo import read_photo
from brushsvg.photo.stroke_boxes import StrokeBox

BAR_MM = 50.8
SHRUNK = 4  # factor by which the picture is reduced for the search of the grid
THICK_PX, LONG_PX = 7, 120  # in the reduced picture: lines are thinner, and their pieces between strokes are longer
PX_PER_MM = 8.0
EDGE_MM = 1.2  # margin inside a cell's lines
NUMBER_MM = (6.5, 4.5)  # area of the cell's number, lower right


def lines(grey: np.ndarray, is_level: bool) -> list[tuple[float, float]]:
    """Return straight lines (slope, place at the picture's middle) [px] in order."""
    dark = np.uint8(grey < 170)
    thin = cv2.subtract(dark, cv2.morphologyEx(dark, cv2.MORPH_OPEN, np.ones((THICK_PX, THICK_PX), np.uint8)))
    if not is_level:
        thin = thin.T.copy()
    thin = cv2.dilate(thin, np.ones((3, 1), np.uint8))
    kept = cv2.morphologyEx(thin, cv2.MORPH_OPEN, np.ones((1, LONG_PX), np.uint8))
    count, part, stats, _ = cv2.connectedComponentsWithStats(kept)
    middle, found = thin.shape[1] / 2, []
    for k in range(1, count):
        rows, columns = np.nonzero(part == k)
        slope, place = np.polyfit(columns - middle, rows, 1)
        if abs(slope) < 0.03:
            found.append((float(slope), float(place), int(stats[k, cv2.CC_STAT_WIDTH])))
    usual = float(np.median([slope for slope, _, wide in found if wide > 2 * LONG_PX] or [0.0]))
    together: list[list[tuple[float, float, int]]] = []
    for one in sorted(found, key=lambda each: each[1]):
        if together and abs(one[1] - together[-1][-1][1]) < 12:
            together[-1].append(one)
        else:
            together.append([one])
    whole = [group for group in together if sum(wide for *_, wide in group) > 0.3 * thin.shape[1]]
    return [
        (usual, float(np.average([place for _, place, _ in group], weights=[wide for *_, wide in group])))
        for group in whole
    ]


def crossings(grey: np.ndarray) -> np.ndarray:
    """Return the crossings (rows, columns, 2) of the grid in px of the whole picture."""
    level, upright = lines(grey, True), lines(grey, False)
    rows, columns = grey.shape
    out = np.zeros((len(level), len(upright), 2))
    for i, (slope, y) in enumerate(level):
        for j, (lean, x) in enumerate(upright):
            across, down = x, y
            for _ in range(4):
                across, down = x + lean * (down - rows / 2), y + slope * (across - columns / 2)
            out[i, j] = across, down
    return out * SHRUNK


def bar_px(grey: np.ndarray, below: float) -> float:
    """Return the length of the widest dark object below the grid."""
    start = int(below) + 15
    _, _, stats, _ = cv2.connectedComponentsWithStats(np.uint8(grey[start:] < 110))
    wide = stats[1:, cv2.CC_STAT_WIDTH]
    flat = stats[1:, cv2.CC_STAT_HEIGHT] < 0.1 * wide
    return float(wide[flat].max())


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("scan", type=Path)
    arguments.add_argument("--picture", type=Path)
    args = arguments.parse_args()
    pixels = read_photo(args.scan.read_bytes())
    whole = cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
    grey = cv2.resize(whole, None, fx=1 / SHRUNK, fy=1 / SHRUNK, interpolation=cv2.INTER_AREA)
    grid = crossings(grey)
    rows, columns = (count - 1 for count in grid.shape[:2])
    fine = bar_px(whole, grid[-1, :, 1].max()) / BAR_MM
    cell_mm = float(np.mean(np.hypot(*np.diff(grid, axis=1).reshape(-1, 2).T))) / fine
    at = np.stack(np.meshgrid(np.arange(columns + 1), np.arange(rows + 1)), axis=-1).reshape(-1, 2) * cell_mm
    to_scan, _ = cv2.findHomography(at, grid.reshape(-1, 2))
    off = cv2.perspectiveTransform(at[None], to_scan)[0] - grid.reshape(-1, 2)
    print(
        f"{columns} x {rows} cells of {cell_mm:.2f} mm, {fine:.2f} pixels per mm ({25.4 * fine:.0f} dpi); crossings "
        f"{np.sqrt(np.mean(np.sum(off**2, axis=1))) / fine:.3f} mm (rms) from even ones"
    )
    sheet = (columns * cell_mm, rows * cell_mm)
    size = (round(sheet[0] * PX_PER_MM), round(sheet[1] * PX_PER_MM))
    shrink = np.diag([1 / PX_PER_MM, 1 / PX_PER_MM, 1.0])
    flattened = cv2.warpPerspective(
        pixels,
        to_scan @ shrink,
        size,
        flags=cv2.INTER_AREA | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REPLICATE,
    )
    flat = Flat(flattened, PX_PER_MM, sheet)
    rooms, printed = [], []
    for k in range(rows * columns):
        left, top = k % columns * cell_mm, sheet[1] - k // columns * cell_mm
        right, bottom = left + cell_mm, top - cell_mm
        inset = (left + EDGE_MM, bottom + EDGE_MM, right - EDGE_MM, top - EDGE_MM)
        rooms.append(StrokeBox(f"{k + 1:02d}", inset))
        printed.append(box(right - NUMBER_MM[0], bottom, right, bottom + NUMBER_MM[1]))
    for j in range(columns + 1):
        printed.append(box(j * cell_mm - 0.6, 0, j * cell_mm + 0.6, sheet[1]))
    for i in range(rows + 1):
        printed.append(box(0, i * cell_mm - 0.6, sheet[0], i * cell_mm + 0.6))
    marks = find_marks(flat, rooms, printed, [])
    for room in rooms:
        rings = marks.outlines_mm.get(room.stroke, [])
        areas = np.array([signed_area(ring) for ring in rings])
        if not len(areas):
            print(f"  {room.stroke}: no paint")
            continue
        hull = cv2.contourArea(cv2.convexHull(np.float32(np.vstack(rings))))
        print(
            f"  {room.stroke}: {areas.sum():6.1f} mm^2, {np.sum(areas > 0)} parts, {np.sum(areas < 0)} holes, "
            f"{100 * (1 - areas.sum() / hull):.0f} % of its hull bare"
        )
    if args.picture:
        picture = flattened.copy()
        for rings in marks.outlines_mm.values():
            for ring in rings:
                points = np.round(flat.to_px(ring) * 16).astype(np.int32)[:, None]
                cv2.polylines(picture, [points], True, (60, 200, 40), 1, cv2.LINE_AA, shift=4)
        cv2.imwrite(str(args.picture), picture)


def box(left, bottom, right, top) -> np.ndarray:
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)], float)


if __name__ == "__main__":
    main()
