"""What `brushsvg compare` says of strokes that robots painted, beside what real_paint.py finds of the same strokes.

    compare_real_paint.py FOLDER [--sets NAME ...] [--pictures DIR]

FOLDER: as for real_paint.py. Each stroke is a picture of its own, without markers: its pixels lie where the data say.
Strokes with even numbers are fitted by their edges, those with odd ones are predicted and compared. Displacement, width
and overlap by `compare` (least squares of pixels, in which a mark may turn and grow as well) are held against a search:
of all shifts by whole pixels the one that overlaps most, and of all marks whose edges lie so much farther out or in, in
steps of 0.05 mm, the one that overlaps most where that shift has it.

Printed: in how many of 100 strokes they agree within 0.25 mm (displacement, width) and 0.01 (overlap with the
prediction as it lies), and the farthest apart.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np
import real_paint
from real_paint import LEVEL

from brushsvg import _core
from brushsvg.errors import Error
from brushsvg.painted.comparison import Wanted, compare_paint
from brushsvg.painted.placing import Canvas

WITHIN_MM, WITHIN_OVERLAP = 0.25, 0.01
GROWN_MM = np.arange(-2.0, 2.001, 0.05)
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
    """By compare: displacement (2,), wider, overlap; None where it finds no mark."""
    left, bottom, wide, high = stroke.window
    canvas = Canvas((0.0, 0.0, wide, high), 1 / stroke.px)  # a sheet begins at its corner
    rings = [ring - (left, bottom) for ring in rings]
    share = np.clip(stroke.paint.astype(np.float32) / (2 * LEVEL), 0, 1)  # half the usual paint: LEVEL
    try:
        found = compare_paint([Wanted("stroke", None, rings)], share, canvas, "stroke")
    except Error as refusal:
        return refusal.code
    (row,) = found.strokes
    if not row.placed.found:
        return "not found"
    return np.array(row.placed.shift_mm), row.placed.wider_mm, row.overlap_predicted


def searched(stroke, predicted):
    """The same by searching."""
    shift = real_paint.best_shift(predicted, stroke.mask, stroke.px)[1]
    columns, rows = np.round(shift / stroke.px * [1, -1]).astype(int)
    moved = cv2.warpAffine(
        np.uint8(predicted), np.float32([[1, 0, columns], [0, 1, rows]]), predicted.shape[::-1]
    )
    out = (cv2.distanceTransform(np.uint8(moved == 0), cv2.DIST_L2, 5) - 0.5) * stroke.px
    inside = (cv2.distanceTransform(np.uint8(moved > 0), cv2.DIST_L2, 5) - 0.5) * stroke.px
    away = np.where(moved > 0, -inside, out)
    by = [real_paint.overlap(away < grown, stroke.mask) for grown in GROWN_MM]
    return shift, float(GROWN_MM[int(np.argmax(by))]), real_paint.overlap(predicted, stroke.mask)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--sets", nargs="*", default=SETS)
    args = arguments.parse_args()
    for name in args.sets:
        strokes = real_paint.load(args.folder, name)
        fit, options = real_paint.fit_ours(strokes[::2], name)
        strokes = strokes[1::2]
        pairs, refused = [], []
        rings_of = predicted_rings(strokes, fit, options)
        for k, (stroke, rings, picture) in enumerate(
            zip(strokes, rings_of, real_paint.our_marks(strokes, fit, options), strict=True)
        ):
            ours = compared(stroke, rings)
            if isinstance(ours, str):
                refused.append((2 * k + 1, ours))
                continue
            theirs = searched(stroke, picture)
            pairs.append(
                (
                    2 * k + 1,
                    np.hypot(*(ours[0] - theirs[0])),
                    ours[1] - theirs[1],
                    ours[2] - theirs[2],
                    ours,
                    theirs,
                )
            )
        print(f"\n{name}: {len(strokes)} strokes, {len(refused)} not compared: {refused[:8]}")
        for column, what, within in (
            (1, "displacement, mm", WITHIN_MM),
            (2, "width of an edge, mm", WITHIN_MM),
            (3, "overlap", WITHIN_OVERLAP),
        ):
            off = np.abs([pair[column] for pair in pairs])
            order = np.argsort(-off)[:4]
            worst = ", ".join(f"{pairs[i][0]}: {pairs[i][column]:+.3f}" for i in order)
            print(
                f"  {what}: within {within:g} in {100 * np.sum(off <= within) / len(strokes):.0f} of 100; median {np.median(off):.3f}; farthest {worst}",
                flush=True,
            )


if __name__ == "__main__":
    main()
