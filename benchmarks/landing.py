"""Test whether a landing of bristles to one side would predict real paint better.

    landing.py FOLDER [--sets NAME ...] [--aim edges|overlap] [--refit] [--planted FRAME ALONG ACROSS]

FOLDER, sets and the fit are those of real_paint.py. Strokes with even numbers are fitted, and strokes with
odd numbers are scored. The patch lands at d = (along, across) from the place under the tool; across points to
the left. It stays there until the lag law drags it on: the pass begins with a pose at that place. d is
limited to the lag, because a patch is never further away. The frames of d:

    paper     x and y of the sheet
    before    the heading of the patch at the end of the previous stroke of the file, as the fitted brush paints it.
              This is the direction in which the stroke left the bristles. The first stroke lands under the tool.
    stroke    the first motion of this stroke

The laws stay fixed. d is one of 49 (0, 1, 2 and 4 mm either way). For each d, also for 0, one displacement of
the set is fitted. Both are chosen by 5-fold cross-validation on even strokes: the displacement by four
fifths, then the d with the largest mean of `fixed` and `shift` on the remaining fifths. `left out` is the
gain there if the other four fifths choose d as well. Then the program prints `fixed` and `shift` on odd
strokes, their gains over landing under the tool, and the standard errors of the gains by a paired bootstrap
over strokes. `refitted` fits the laws again, with this d and without it.

--refit fits the laws again for each of a few d on one half of the even strokes, and scores them on the other
half, both ways. It prints the gain in the mean of `fixed` and `shift`. Only the best d, if it has a gain, is
scored on odd strokes.

--planted replaces all strokes by those that the fitted brush paints with this landing, each displaced as the
real stroke is. It shows whether the program would find the landing, and its gain.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from itertools import product
from pathlib import Path

import cv2
import numpy as np
import real_paint
from real_paint import FARTHEST_MM

from brushsvg import _core

FRAMES = ("paper", "before", "stroke")
STEPS_MM = (0.0, 1.0, -1.0, 2.0, -2.0, 4.0, -4.0)
OFFSETS = np.array(list(product(STEPS_MM, STEPS_MM)))  # the first offset is 0
FOLDS, RESAMPLED = 5, 4000
REFITTED = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)], float)


# Landings -------------------------------------------------------------------------------------------


def axes_of(strokes, fit, options) -> dict[str, np.ndarray]:
    """Return the unit vectors `along` (n, 2) by frame, 0 where there is none."""
    brush = real_paint.brush_for(strokes, fit, options)
    plan, ends, begins = _core.Plan("fitted", "", (1.0, 1.0), []), [], []
    for stroke in strokes:
        plan.passes = [real_paint._moved(stroke, fit)]
        end = _core.simulate(plan, brush).passes[0].heading_rad[-1]
        ends.append((np.cos(end), np.sin(end)))
        steps = np.diff(stroke.poses[:, :2], axis=0)
        step = steps[np.argmax(np.hypot(*steps.T) > 1e-6)]
        begins.append(step / max(1e-9, np.hypot(*step)))
    before = np.vstack([np.zeros(2), ends[:-1]])
    return {"paper": np.tile([1.0, 0.0], (len(strokes), 1)), "before": before, "stroke": np.array(begins)}


def reach_mm(stroke, brush, fit) -> float:
    """Return the lag where the stroke begins."""
    return float(brush.lag(max(0.0, fit.height_mm - stroke.poses[0, 2])))


def landed(stroke, along, offset_mm, brush, fit):
    """Return the stroke whose patch lands at an offset in the frame of `along`."""
    x, y = along
    displacement = np.array([[x, y], [-y, x]]).T @ offset_mm
    size = np.hypot(*displacement)
    if size == 0:
        return stroke
    share = min(1.0, reach_mm(stroke, brush, fit) / size)
    begin = stroke.poses[0] + np.append(displacement * share, 0.0)
    return replace(stroke, poses=np.vstack([begin, stroke.poses]))


def all_landed(strokes, axes, offset_mm, fit, options):
    brush = real_paint.brush_for(strokes, fit, options)
    return [landed(stroke, along, offset_mm, brush, fit) for stroke, along in zip(strokes, axes, strict=True)]


def by_displacement(strokes, fit, options) -> np.ndarray:
    """Return each stroke's overlap by displacement (n, rows, columns).

    The prediction moves by whole pixels up to FARTHEST_MM. Values beyond this distance are below 0.
    """
    out = []
    for picture, stroke in zip(real_paint.our_marks(strokes, fit, options), strokes, strict=True):
        reach = int(FARTHEST_MM / stroke.px)
        grown = cv2.copyMakeBorder(
            stroke.mask.astype(np.float32), reach, reach, reach, reach, cv2.BORDER_CONSTANT, value=0
        )
        both = cv2.matchTemplate(grown, picture.astype(np.float32), cv2.TM_CCORR)
        y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
        overlap = both / np.maximum(float(picture.sum()) + float(stroke.mask.sum()) - both, 1e-9)
        out.append(np.where(x**2 + y**2 <= reach**2, overlap, -1.0))
    return np.array(out)


# Choosing and scoring -------------------------------------------------------------------------------


def best_place(tables) -> tuple[int, int]:
    """Return the indices of the displacement with the largest overlap."""
    mean = tables.mean(axis=0)
    row, column = np.unravel_index(int(mean.argmax()), mean.shape)
    return int(row), int(column)


def fixed_and_shift(tables, place) -> np.ndarray:
    return np.column_stack([tables[(slice(None), *place)], tables.max(axis=(1, 2))])


def chosen(by_offset) -> tuple[int, np.ndarray]:
    """Choose an offset by cross-validation.

    by_offset has the shape (offsets, n, rows, columns). Also return each stroke's gain (n,) with the offset
    that the other folds alone choose.
    """
    fold = np.arange(by_offset.shape[1]) % FOLDS
    held, won = np.empty(by_offset.shape[:2]), np.empty(by_offset.shape[1])
    for k in range(FOLDS):
        taught, out = fold != k, fold == k
        places = [best_place(tables[taught]) for tables in by_offset]
        means = [fixed_and_shift(tables[taught], at).mean() for tables, at in zip(by_offset, places, strict=True)]
        for row, tables, at in zip(held, by_offset, places, strict=True):
            row[out] = fixed_and_shift(tables[out], at).mean(axis=1)
        won[out] = held[int(np.argmax(means)), out] - held[0, out]
    return int(held.mean(axis=1).argmax()), won


def error_of_mean(won) -> np.ndarray:
    """Return the standard error of the mean of won (n, ...) by resampling strokes."""
    rows = np.random.default_rng(1).integers(len(won), size=(RESAMPLED, len(won)))
    return won[rows].mean(axis=1).std(axis=0)


def gain_words(scored, base) -> str:
    won = scored - base
    rows = zip(("fixed", "shift"), scored.mean(axis=0), won.mean(axis=0), error_of_mean(won), strict=True)
    return "   ".join(f"{what} {mean:.3f} ({gain:+.4f} +- {error:.4f})" for what, mean, gain, error in rows)


def scored(seen, unseen, fit, options) -> np.ndarray:
    """Return fixed and shift (n, 2) of the unseen strokes.

    The displacement is the best one for the seen strokes.
    """
    place = best_place(by_displacement(seen, fit, options))
    return fixed_and_shift(by_displacement(unseen, fit, options), place)


def fitted(seen, name, aim):
    fit, options = real_paint.fit_ours(seen, name)
    return (real_paint.by_overlap(seen, fit, options)[0] if aim == "overlap" else fit), options


def planted(strokes, axes, offset_mm, fit, options):
    """Return strokes that the fitted brush paints with this landing.

    Each is displaced as the real stroke is.
    """
    there = all_landed(strokes, axes, offset_mm, fit, options)
    usual = real_paint.our_marks(strokes, fit, options)
    painted = real_paint.our_marks(there, fit, options)
    _, _, shifts = real_paint.scores(strokes, usual)
    out = []
    for stroke, mark, shift in zip(strokes, painted, shifts, strict=True):
        columns, rows = np.round(shift / stroke.px * [1, -1]).astype(int)
        moved = cv2.warpAffine(np.uint8(mark), np.float32([[1, 0, columns], [0, 1, rows]]), mark.shape[::-1])
        out.append(replace(stroke, mask=moved > 0, paint=moved * np.uint8(255)))
    return out


def tried(strokes, name, aim, plant):
    """Return the lines of the table of a set."""
    seen, unseen = strokes[::2], strokes[1::2]
    fit, options = fitted(seen, name, aim)
    axes = axes_of(strokes, fit, options)
    if plant is not None:
        frame, offset_mm = plant
        strokes = planted(strokes, axes[frame], offset_mm, fit, options)
        seen, unseen = strokes[::2], strokes[1::2]
    base = scored(seen, unseen, fit, options)
    reach = np.median([reach_mm(stroke, real_paint.brush_for(seen, fit, options), fit) for stroke in seen])
    yield (
        f"{'under the tool':16s} fixed {base[:, 0].mean():.3f}   shift {base[:, 1].mean():.3f}   (lag there "
        f"{reach:.2f} mm)"
    )
    for frame in FRAMES:
        even, odd = axes[frame][::2], axes[frame][1::2]
        by_offset = np.array(
            [by_displacement(all_landed(seen, even, offset, fit, options), fit, options) for offset in OFFSETS]
        )
        best, won = chosen(by_offset)
        offset = OFFSETS[best]
        head = f"{frame:8s} {offset[0]:+.0f} {offset[1]:+.0f} mm"
        yield f"{head:16s} left out {won.mean():+.4f} +- {error_of_mean(won):.4f}"
        if best == 0:
            continue
        there = [all_landed(side, along, offset, fit, options) for side, along in ((seen, even), (unseen, odd))]
        yield f"{'':16s} {gain_words(scored(*there, fit, options), base)}"
        if plant is None:
            again, fit_options = fitted(there[0], name, aim)
            yield f"{'  refitted':16s} {gain_words(scored(*there, again, fit_options), base)}"


def refitted(strokes, name, aim):
    """Return the lines of the table of a set, with laws fitted again for each d."""
    seen = strokes[::2]
    fit, options = fitted(seen, name, aim)
    axes = axes_of(strokes, fit, options)

    def left_out(frame, offset_mm) -> np.ndarray:
        there = all_landed(seen, axes[frame][::2], offset_mm, fit, options)
        out = np.empty(len(seen))
        for k in range(2):
            again, fit_options = fitted(there[1 - k :: 2], name, aim)
            marks = real_paint.our_marks(there[k::2], again, fit_options)
            fixed, moved, _ = real_paint.scores(there[k::2], marks)
            out[k::2] = (fixed + moved) / 2
        return out

    base = left_out(FRAMES[0], REFITTED[0])
    yield f"under the tool {base.mean():.3f}"
    most, best = 0.0, None
    for frame in FRAMES:
        words = []
        for offset in REFITTED[1:]:
            won = left_out(frame, offset) - base
            if won.mean() > most:
                most, best = won.mean(), (frame, offset)
            words.append(f"{offset[0]:+.0f} {offset[1]:+.0f} mm {won.mean():+.4f} +- {error_of_mean(won):.4f}")
        yield f"{frame:8s} {'   '.join(words)}"
    if best is None:
        yield "none wins"
        return
    frame, offset = best
    there = all_landed(strokes, axes[frame], offset, fit, options)
    again = fitted(there[::2], name, aim)
    gain = gain_words(scored(there[::2], there[1::2], *again), scored(seen, strokes[1::2], fit, options))
    yield f"odd strokes, {frame} {offset[0]:+.0f} {offset[1]:+.0f} mm: {gain}"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--sets", nargs="*", metavar="NAME")
    arguments.add_argument("--aim", choices=("edges", "overlap"), default="edges")
    arguments.add_argument("--refit", action="store_true")
    arguments.add_argument("--planted", nargs=3, metavar=("FRAME", "ALONG", "ACROSS"))
    args = arguments.parse_args()
    plant = None
    if args.planted:
        frame, *offset = args.planted
        if frame not in FRAMES:
            arguments.error(f"--planted: a frame is one of {', '.join(FRAMES)}, not {frame}")
        plant = frame, np.array(offset, float)
    for name in args.sets or sorted(path.stem for path in args.folder.glob("*.npz")):
        strokes = real_paint.load(args.folder, name)
        print(f"\n{name}: {len(strokes[::2])} strokes fitted, {len(strokes[1::2])} scored", flush=True)
        lines = refitted(strokes, name, args.aim) if args.refit else tried(strokes, name, args.aim, plant)
        for line in lines:
            print(f"  {line}", flush=True)


if __name__ == "__main__":
    main()
