"""Brushes fitted to strokes that robots painted, and how well they predict strokes they have not seen.

    real_paint.py FOLDER [--sets NAME ...] [--pictures DIR]

Each set is cleaned up to one blob per stroke; strokes with even numbers are fitted, odd ones scored by overlap
(intersection over union of pixels). `fixed`: one displacement for the set; `shift`: each stroke may move by up to
3 mm. Beside ours, on the same strokes: a disc of linear width that is dragged by no lag, by a constant one, by one
that is linear in depth.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize

from brushsvg import _core
from brushsvg.mark_calibrate import brush_of
from brushsvg.masks import mask_outlines

LEVEL = 70
FARTHEST_MM = 3.0
NEAR_MM = 8.0
SETS = ("round_v1", "small_16_20", "loops_constant_depth", "marker_control")


@dataclass
class Stroke:
    poses: np.ndarray  # x y z, mm, z = -depth
    mask: np.ndarray
    paint: np.ndarray
    window: tuple  # x y width height, mm
    px: float


def load(folder: Path, name: str) -> list[Stroke]:
    data = np.load(folder / f"{name}.npz")
    if "path" in data:
        return _loops(data)
    count = 30 if name == "round_v1" else 10
    t = np.linspace(0, 1, count)
    weights = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=1)
    deep = 1e3 * float(data["z_range_m"]) or 1.0  # a marker has none: its fraction counts as millimetres
    x0, x1 = -20.0, 70.0
    y0, y1 = -35.0, 35.0
    out = []
    for paint, ctrl in zip(data["intensity"], data["ctrl"], strict=True):
        xy = weights @ ctrl[:, :2] * 1e3
        depth = np.interp(t, np.linspace(0, 1, 4), ctrl[:, 2]) * deep
        poses = np.column_stack([xy, -np.maximum(depth, 0)])
        out.append(_stroke(poses, paint, (x0, y0, x1 - x0, y1 - y0), 0.25))
    return out


def _loops(data) -> list[Stroke]:
    width, height = 1e3 * float(data["canvas_w_m"]), 1e3 * float(data["canvas_h_m"])
    px = width / data["intensity"].shape[2]
    deep = 1e3 * float(data["z_range_m"])
    centre = np.array([636 * px, height - 500 * height / data["intensity"].shape[1]])
    out = []
    for paint, path in zip(data["intensity"], data["path"], strict=True):
        at = np.linspace(0, 3, 100)
        xy = CubicSpline(np.arange(4), path[:, :2].astype(float) * 1e3)(at) + centre
        depth = np.interp(at, np.arange(4), path[:, 2]) * deep
        near = np.zeros(paint.shape, np.uint8)
        pixels = np.column_stack([xy[:, 0] / px, (height - xy[:, 1]) / px])
        cv2.polylines(near, [np.round(pixels).astype(np.int32)], False, 255, round(2 * NEAR_MM / px))
        # a window round the path, in whole pixels
        left, top = np.maximum(np.floor(pixels.min(axis=0) - 60).astype(int), 0)
        right, bottom = np.minimum(np.ceil(pixels.max(axis=0) + 60).astype(int), paint.shape[::-1])
        part = np.where(near > 0, paint, 0)[top:bottom, left:right]
        window = (left * px, height - bottom * px, (right - left) * px, (bottom - top) * px)
        out.append(_stroke(np.column_stack([xy, -depth]), part, window, px))
    return out


def _stroke(poses, paint, window, px) -> Stroke:
    """One blob: the largest, and what lies within 1.5 mm of it (a stroke that broke off where paint ran out)."""
    above = np.uint8(paint > LEVEL)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(above, connectivity=8)
    mask = np.zeros(paint.shape, bool)
    if count > 1:
        best = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
        mask = labels == best
    return Stroke(poses, mask, np.where(mask, paint, 0), window, px)


# Scores ---------------------------------------------------------------------------------------------


def overlap(a, b) -> float:
    both = np.logical_or(a, b).sum()
    return float(np.logical_and(a, b).sum() / both) if both else 1.0


def best_shift(predicted, mask, px) -> tuple[float, np.ndarray]:
    """Largest overlap when the prediction moves by whole pixels up to FARTHEST_MM; where to [mm], y up."""
    reach = int(FARTHEST_MM / px)
    grown = cv2.copyMakeBorder(np.float32(mask), reach, reach, reach, reach, cv2.BORDER_CONSTANT, value=0)
    found = cv2.matchTemplate(grown, np.float32(predicted), cv2.TM_CCORR)
    total = predicted.sum() + mask.sum()
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    score = np.where(x**2 + y**2 <= reach**2, found / np.maximum(total - found, 1e-9), 0)
    k = np.unravel_index(int(score.argmax()), score.shape)
    return float(score[k]), np.array([x[k], -y[k]]) * px


def scores(strokes, predicted) -> tuple[np.ndarray, np.ndarray, list]:
    fixed = np.array([overlap(p, s.mask) for p, s in zip(predicted, strokes, strict=True)])
    moved = [best_shift(p, s.mask, s.px) for p, s in zip(predicted, strokes, strict=True)]
    return fixed, np.array([m[0] for m in moved]), [m[1] for m in moved]


# The throw-away models ------------------------------------------------------------------------------


def disc_marks(strokes, x, lag_terms) -> list[np.ndarray]:
    """x: radius at depth 0 and at the deepest [mm], displacement x y, lag at depth 0, and what is added at the
    deepest. The patch is pulled to within r of the TCP."""
    deep = max(-s.poses[:, 2].min() for s in strokes) or 1.0
    out = []
    for stroke in strokes:
        at = np.linspace(0, len(stroke.poses) - 1, 120)
        q = np.column_stack(
            [np.interp(at, np.arange(len(stroke.poses)), stroke.poses[:, i]) for i in range(3)]
        )
        share = -q[:, 2] / deep
        r = np.zeros(len(q)) if lag_terms == 0 else x[4] + (x[5] * share if lag_terms == 2 else 0)
        p, z = np.empty(len(q), complex), q[:, 0] + 1j * q[:, 1]
        p[0] = z[0]
        for k in range(1, len(q)):
            reach = z[k] - p[k - 1]
            size = abs(reach)
            p[k] = p[k - 1] if size <= r[k] else z[k] - reach / size * max(r[k], 0)
        radius = np.maximum(x[0] + x[1] * share, 0.05)
        image = np.zeros(stroke.mask.shape, np.uint8)
        left, bottom, _, height = stroke.window
        cx = (p.real + x[2] - left) / stroke.px - 0.5
        cy = (bottom + height - p.imag - x[3]) / stroke.px - 0.5
        rows = np.round(np.column_stack([cx, cy, radius / stroke.px]) * 16).astype(int)
        for a, b, c in rows:
            cv2.circle(image, (int(a), int(b)), max(1, int(c) - 8), 255, -1, cv2.LINE_8, 4)
        out.append(image > 0)
    return out


def fit_disc(strokes, lag_terms) -> np.ndarray:
    """Largest mean overlap on the strokes, one displacement for all."""

    def loss(x):
        if np.any(x[4:] < -20) or x[0] < 0:
            return 1.0
        return 1 - np.mean(
            [overlap(p, s.mask) for p, s in zip(disc_marks(strokes, x, lag_terms), strokes, strict=True)]
        )

    best = None
    for lag in (0.0,) if lag_terms == 0 else (2.0, 5.0, 8.0):
        x = np.array([1.0, 2.0, 0.0, 0.0, *([lag] if lag_terms else []), *([2.0] if lag_terms == 2 else [])])
        simplex = np.vstack([x, *(x + d for d in np.diag(np.full(len(x), 1.0)))])
        found = minimize(loss, x, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": 60})
        best = found if best is None or found.fun < best.fun else best
    return minimize(
        loss, best.x, method="Nelder-Mead", options={"maxfev": 150, "xatol": 0.01, "fatol": 1e-4}
    ).x


# Ours -----------------------------------------------------------------------------------------------


def fit_ours(strokes, name):
    painted = []
    for k, stroke in enumerate(strokes):
        left, bottom, _, height = stroke.window
        rings = mask_outlines(stroke.paint, LEVEL, stroke.px, (left, bottom + height))
        if rings:
            painted.append(_core.PaintedMark(str(k), stroke.poses, rings))
    options = _core.MarkOptions()
    depths = np.concatenate([s.poses[:, 2] for s in strokes])
    options.deepest_mm = float(-depths.min()) or 1.0
    one = float(np.ptp(depths)) < 0.05
    options.lag_terms, options.tip_gap_terms, options.half_width_terms = (1, 1, 1) if one else (2, 1, 2)
    options.height_mm = _core.Prior(0.0, 0.0 if one else 1.0)
    options.placement_mm, options.turn_rad, options.displacement_mm = 5.0, 0.0, 2.0
    return _core.fit_marks(painted, None, options), options


def our_marks(strokes, fit, options) -> list[np.ndarray]:
    reach = options.deepest_mm + max(0.0, fit.height_mm)
    brush = brush_of(fit.laws, "fitted", (0.0, reach))
    passes = []
    for k, stroke in enumerate(strokes):
        poses = np.array(stroke.poses)
        poses[:, :2] += fit.shift_mm
        poses[:, 2] = np.minimum(poses[:, 2] - fit.height_mm, 0.0)
        passes.append(_core.Pass(str(k), poses))
    plan = _core.Plan("fitted", "", (1.0, 1.0), passes)
    out = []
    for one, stroke in zip(passes, strokes, strict=True):
        plan.passes = [one]
        marks = _core.simulate(plan, brush)
        out.append(_core.coverage(marks, brush, stroke.window, 1 / stroke.px) > 0.5)
    return out


def picture(strokes, predicted, shifts, score, path: Path) -> None:
    """Best, median and worst strokes: paint grey, prediction moved to its best place as a red line, TCP blue."""
    order = np.argsort(-score)
    chosen = [*order[:3], *order[len(order) // 2 - 1 : len(order) // 2 + 2], *order[-3:]]
    tiles = []
    for k in chosen:
        stroke = strokes[k]
        image = cv2.cvtColor(255 - np.uint8(stroke.mask) * 90, cv2.COLOR_GRAY2BGR)
        image = cv2.resize(image, None, fx=2, fy=2, interpolation=cv2.INTER_NEAREST)
        dx, dy = shifts[k] / stroke.px * [2, -2]
        edge, _ = cv2.findContours(
            cv2.resize(np.uint8(predicted[k]), None, fx=2, fy=2, interpolation=cv2.INTER_NEAREST),
            cv2.RETR_LIST,
            cv2.CHAIN_APPROX_NONE,
        )
        for ring in edge:
            cv2.polylines(
                image, [np.round([*ring, dx, dy]).astype(np.int32)], True, (40, 40, 220), 1, cv2.LINE_AA
            )
        left, bottom, _, height = stroke.window
        way = (
            np.column_stack([stroke.poses[:, 0] - left, bottom + height - stroke.poses[:, 1]]) / stroke.px * 2
        )
        cv2.polylines(image, [np.round(way).astype(np.int32)], False, (200, 90, 20), 1, cv2.LINE_AA)
        cv2.circle(image, tuple(int(v) for v in way[0]), 4, (200, 90, 20), -1, cv2.LINE_AA)
        cv2.putText(image, f"{2 * k + 1}: {score[k]:.3f}", (8, 20), 0, 0.6, (0, 0, 0), 1, cv2.LINE_AA)
        tiles.append(cv2.resize(image, (480, 374)))
    rows = [np.hstack(tiles[k : k + 3]) for k in (0, 3, 6)]
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), np.vstack(rows))


def residual_words(strokes, fit) -> list[str]:
    """What the distances that stay are made of: width of the whole mark, its place, its shape."""
    width, whole, place = [], [], []
    for miss in fit.marks:
        d = np.array(miss.distance_mm)
        d = d[np.abs(d) < 5 * fit.noise_mm]
        if len(d) > 20:
            width.append(d.mean())
            whole.append(d.std())
        place.append(np.hypot(*miss.displacement_mm))
    total = np.sqrt(np.mean(np.square(width)) + np.mean(np.square(whole)))
    return [
        f"edges lie {total:.2f} mm off (rms, {100 * fit.left_aside:.0f} % of the points left aside as wild)",
        f"  of it {np.std(width):.2f} mm: whole marks wider or narrower than their depth says (paint load, bristles)",
        f"  of it {np.sqrt(np.mean(np.square(whole))):.2f} mm: along each mark (hairs, shape, depth)",
        f"  displacements found: {np.sqrt(np.mean(np.square(place))):.2f} mm (rms); without them they would add to it",
    ]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--sets", nargs="*", default=SETS)
    arguments.add_argument("--pictures", type=Path)
    arguments.add_argument("--no-peers", action="store_true")
    args = arguments.parse_args()
    for name in args.sets:
        strokes = load(args.folder, name)
        seen, unseen = strokes[::2], strokes[1::2]
        print(f"\n{name}: {len(seen)} strokes fitted, {len(unseen)} scored")
        if not args.no_peers:
            for terms, what in ((0, "disc, no lag"), (1, "disc, constant r"), (2, "disc, r0 + r1 depth")):
                x = fit_disc(seen, terms)
                fixed, moved, _ = scores(unseen, disc_marks(unseen, x, terms))
                lag = ", ".join(f"{v:.2f}" for v in x[4:])
                print(f"  {what:22s} fixed {fixed.mean():.3f}  shift {moved.mean():.3f}  r {lag}", flush=True)
        begin = time.perf_counter()
        fit, options = fit_ours(seen, name)
        took = time.perf_counter() - begin
        predicted = our_marks(unseen, fit, options)
        fixed, moved, shifts = scores(unseen, predicted)
        print(
            f"  {'ours':22s} fixed {fixed.mean():.3f}  shift {moved.mean():.3f}  ({took:.1f} s, "
            f"{fit.iterations} iterations{'' if fit.converged else ', not converged'})"
        )
        laws = fit.laws
        for law in ("lag", "tip_gap", "half_width"):
            print(f"    {law} = " + " ".join(f"{c:+.3f} d^{k}" for k, c in enumerate(getattr(laws, law))))
        print(
            f"    widest {laws.widest_per_half:.2f} h, front {laws.front_per_half:.2f} h, paper {fit.height_mm:+.2f}"
            f" mm, sheet {fit.shift_mm[0]:+.2f} {fit.shift_mm[1]:+.2f} mm; a shift for each fitted stroke"
        )
        for line in [*residual_words(seen, fit), *fit.remarks]:
            print(f"    {line}")
        if args.pictures:
            picture(unseen, predicted, shifts, moved, args.pictures / f"{name}.png")


if __name__ == "__main__":
    main()
