"""Compare results of `brushsvg compare` and real_paint.py for strokes of robots.

    compare_real_paint.py FOLDER [--sets NAME ...] [--every N]

FOLDER is the folder of real_paint.py. Each stroke is a separate picture without markers, and the data give
the places of its pixels. Strokes with even numbers are fitted by their edges. Strokes with odd numbers are
predicted and compared. `compare` finds displacement, width and overlap by least squares of pixels, where a
mark may also turn and grow. A search finds the shift by whole pixels with the largest overlap. At this shift
it moves the edges of the mark out or in, in steps of 0.05 mm, and keeps the largest overlap. A second search
shifts, turns and grows a mark until its overlap is largest, as `compare` does.

The program prints in how many of 100 strokes the results agree within 0.25 mm (displacement, width) and 0.01
(overlap with the unchanged prediction). A stroke that `compare` does not find agrees in nothing.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np
import real_paint
from real_paint import LEVEL
from scipy.optimize import minimize

from brushsvg import _core
from brushsvg.comparison.photographs import TargetStroke, compare_paint
from brushsvg.comparison.placing import Canvas
from brushsvg.errors import Error
from brushsvg.geometry.rings import centroid

WITHIN_MM, WITHIN_OVERLAP = 0.25, 0.01
GROWN_MM = np.arange(-2.0, 2.001, 0.05)
ROWS = (
    ("displacement, of marks that are shifted alone, mm", WITHIN_MM),
    ("width of an edge there, mm", WITHIN_MM),
    ("overlap with the prediction", WITHIN_OVERLAP),
    ("displacement, of marks that are shifted, turned and grown, mm", WITHIN_MM),
    ("width of an edge there, mm", WITHIN_MM),
)
SETS = ("round_v1", "small_16_20", "marker_control")


def predicted_rings(strokes, fit, options) -> list[list[np.ndarray]]:
    brush = real_paint.brush_for(strokes, fit, options)
    plan, out = _core.Plan("fitted", "", (1.0, 1.0), []), []
    for stroke in strokes:
        plan.passes = [real_paint._moved(stroke, fit)]
        marks = _core.simulate(plan, brush)
        _core.trace_outlines(marks, brush)
        out.append([np.array(ring) for ring in marks.passes[0].outline_mm])
    return out


def compared(stroke, rings):
    """Return displacement (2,), wider and overlap by compare.

    If compare finds no mark, return the reason.
    """
    left, bottom, wide, high = stroke.window
    canvas = Canvas((0.0, 0.0, wide, high), 1 / stroke.px)  # a sheet begins at its corner
    rings = [ring - (left, bottom) for ring in rings]
    share = np.clip(np.float32(stroke.paint) / (2 * LEVEL), 0, 1)  # LEVEL is half of the usual paint
    try:
        found = compare_paint([TargetStroke("stroke", None, rings)], share, canvas, "stroke")
    except Error as refusal:
        return refusal.code
    (row,) = found.strokes
    if not row.placed.found:
        return "not found"
    return np.array(row.placed.shift_mm), row.placed.wider_mm, row.overlap_predicted


def away_mm(mask, px: float) -> np.ndarray:
    """Return each pixel's distance from the mask's edge, below 0 inside."""
    out, inside = (cv2.distanceTransform(np.uint8(side), cv2.DIST_L2, 5) for side in (mask == 0, mask > 0))
    return np.where(mask > 0, 0.5 - inside, out - 0.5).astype(np.float32) * px


def searched(stroke, predicted):
    """Return displacement, wider and overlap by a search."""
    shift = real_paint.best_shift(predicted, stroke.mask, stroke.px, real_paint.FARTHEST_MM)[1]
    columns, rows = np.round(shift / stroke.px * [1, -1]).astype(int)
    moved = cv2.warpAffine(np.uint8(predicted), np.float32([[1, 0, columns], [0, 1, rows]]), predicted.shape[::-1])
    away = away_mm(moved, stroke.px)
    by = [real_paint.overlap(away < grown, stroke.mask) for grown in GROWN_MM]
    return shift, float(GROWN_MM[int(np.argmax(by))]), real_paint.overlap(predicted, stroke.mask)


def fully_searched(stroke, predicted, middle_mm, start_mm):
    """Return shift (2,) and wider of the mark with the largest overlap.

    A simplex shifts, turns and grows the mark.
    """
    left, bottom, _, high = stroke.window
    middle = ((middle_mm[0] - left) / stroke.px - 0.5, (bottom + high - middle_mm[1]) / stroke.px - 0.5)
    away, mask = away_mm(predicted, stroke.px), np.float32(stroke.mask)

    def missing(x):
        matrix = cv2.getRotationMatrix2D(middle, np.degrees(x[2]), 1.0)
        matrix[:, 2] += (x[0] / stroke.px, -x[1] / stroke.px)
        placed = cv2.warpAffine(away, matrix, away.shape[::-1], flags=cv2.INTER_LINEAR, borderValue=99.0)
        return 1 - real_paint.soft_overlap(mask, np.clip(0.5 + (x[3] - placed) / stroke.px, 0, 1))

    steps, found = np.diag([0.5, 0.5, 0.05, 0.2]), []
    for start in (np.array([*start_mm, 0, 0]), np.zeros(4)):
        simplex = {"initial_simplex": np.vstack([start, start + steps]), "maxfev": 160, "xatol": 0.01}
        found.append(minimize(missing, start, method="Nelder-Mead", options=simplex))
    best = min(found, key=lambda one: one.fun).x
    return best[:2], float(best[3])


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--sets", nargs="*", default=SETS)
    arguments.add_argument("--every", type=int, default=1, help="of the strokes that are compared")
    args = arguments.parse_args()
    for name in args.sets:
        strokes = real_paint.load(args.folder, name)
        fit, options = real_paint.fit_ours(strokes[::2], name)
        strokes = strokes[1 :: 2 * args.every]
        pictures = real_paint.our_marks(strokes, fit, options)
        rows, refused = [], []
        for k, rings in enumerate(predicted_rings(strokes, fit, options)):
            ours = compared(strokes[k], rings)
            if isinstance(ours, str):
                refused.append(f"{1 + 2 * args.every * k} {ours}")
                continue
            shift, wider, overlap = searched(strokes[k], pictures[k])
            full_shift, full_wider = fully_searched(strokes[k], pictures[k], centroid(rings), shift)
            rows.append(
                (
                    np.hypot(*(ours[0] - shift)),
                    ours[1] - wider,
                    ours[2] - overlap,
                    np.hypot(*(ours[0] - full_shift)),
                    ours[1] - full_wider,
                )
            )
        print(f"\n{name}: {len(strokes)} strokes, {len(refused)} not found: {', '.join(refused)}")
        for column, (what, within) in enumerate(ROWS):
            off = np.abs([row[column] for row in rows])
            print(
                f"  {what}: within {within:g} in {100 * np.sum(off <= within) / len(strokes):.0f} of 100, median "
                f"{np.median(off):.3f}, 95th percentile {np.quantile(off, 0.95):.3f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
