"""Fit brushes to strokes of robots, and score their predictions.

    real_paint.py FOLDER [--sets NAME ...] [--pictures DIR] [--machine lean,axes] [--ceilings]

A set is a file NAME.npz of FOLDER. --sets selects sets; otherwise all sets are used. A set has the arrays
`intensity` (strokes, rows, columns), where pixels above 70 are paint, and `z_range_m`. In addition it has one
of:

- `ctrl` (strokes, 4, 3 or more), control points of a cubic with x, y [m] and depth [shares of z_range_m], with
  `poses` (the number of places of the robot, otherwise 10), `x_range`, `y_range` [m] and `grid_m`.
- `path` (strokes, 4, 3 or more), places on a spline, with `canvas_w_m` and `canvas_h_m`.

Each set is cleaned to one blob per stroke. Strokes with even numbers are fitted. Strokes with odd numbers are
scored by overlap (intersection over union of pixels). `fixed` uses one displacement for the set. `shift` lets
each stroke move by up to 3 mm. For comparison, a disc of linear width is dragged along the strokes without
lag, with constant lag, and with lag that is linear in depth. Each disc is fitted to the largest `fixed`.

Two fits of ours are scored. `edges` is the fit of `brushsvg calibrate`. `overlap` is the fit of --aim
overlap: it starts from `edges` and changes the laws to the largest mean of `fixed` and `shift`. Footprints
stay round unless the strokes contradict this. Fitted numbers: lag 2, tip gap 1, half width 2, the footprint's
shape 2, height of the paper 1, the set's displacement 2. At one depth: lag 1, half width 1, no height.
`edges` also fits a shift for each stroke. --machine adds lean, 2, and axes, 3, for `edges`. `overlap` leaves
fitted strokes out in turn to choose its changes: nothing, a dragged disc, laws (at one depth lag 2), or laws
with lean, 2 (none at one depth), and a map of the ways, 4.

First the program prints the best possible overlap. Two strokes of nearly equal commands overlap less than 1.
A line in the distances of ways and depths extrapolates this overlap to equal commands. Both strokes share the
missing part. A model of the mean of many equal strokes would miss 1/sqrt(2) of it. --ceilings prints nothing
else.
"""

from __future__ import annotations

import argparse
import time
from copy import copy
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize

from brushsvg import _core
from brushsvg.calibration.marks import machine_found
from brushsvg.calibration.marks.from_marks import brush_of
from brushsvg.calibration.overlap.by_overlap_report import chosen_in_words
from brushsvg.calibration.overlap.overlap_choice import find_best_prediction
from brushsvg.calibration.overlap.overlap_search import (
    SearchStart,
    Target,
    best_shift,
    move_to_fitted_paper,
    predict_pictures,
    soft_overlap,
)
from brushsvg.cli.arguments import values
from brushsvg.photo.mask_contours import mask_outlines

LEVEL = 70
FARTHEST_MM = 3.0
NEAR_MM = 8.0
JOINED_MM = 1.5
MARGIN_MM = 8.0  # margin around way and paint during a search
DISCS = ((0, "disc, no lag"), (1, "disc, constant r"), (2, "disc, r0 + r1 depth"))
OWN_WIDTHS, OWN_LAGS = (0.7, 0.85, 1.0, 1.15, 1.3), (0.5, 0.75, 1.0, 1.25, 1.5)
LAWS = ("lag", "tip_gap", "half_width")
# Two commands are nearly equal if the sum of two shares is small. One is the rms distance of their ways as a share of
# the paint's width. The other is the rms distance of their depths as a share of the largest depth. For commands further
# apart, the missing overlap no longer grows along a line.
ALIKE_WIDTHS, ALIKE_DEPTH = 0.5, 0.3
FEWEST_PAIRS, TENTHS = 60, 10


@dataclass(eq=False)
class Stroke:
    poses: np.ndarray  # x y z, mm, z = -depth
    mask: np.ndarray
    paint: np.ndarray
    window: tuple  # x y width height, mm
    px: float


def load(folder: Path, name: str) -> list[Stroke]:
    data = np.load(folder / f"{name}.npz")
    return _loops(data) if "path" in data else _beziers(data)


def _beziers(data) -> list[Stroke]:
    count = int(data["poses"]) if "poses" in data else 10
    t = np.linspace(0, 1, count)
    weights = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=1)
    deep = 1e3 * float(data["z_range_m"])
    (x0, x1), (y0, y1), px = 1e3 * data["x_range"], 1e3 * data["y_range"], 1e3 * float(data["grid_m"])
    out = []
    for paint, ctrl in zip(data["intensity"], data["ctrl"], strict=True):
        xy = weights @ ctrl[:, :2] * 1e3
        # a marker has one depth, here called 1 mm
        depth = np.interp(t, np.linspace(0, 1, 4), ctrl[:, 2]) * deep if deep else np.ones(count)
        poses = np.column_stack([xy, -np.maximum(depth, 0)])
        out.append(_stroke(poses, paint, (x0, y0, x1 - x0, y1 - y0), px))
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
        # A window around the path, in whole pixels.
        left, top = np.maximum(np.floor(pixels.min(axis=0) - 60).astype(int), 0)
        right, bottom = np.minimum(np.ceil(pixels.max(axis=0) + 60).astype(int), paint.shape[::-1])
        part = np.where(near > 0, paint, 0)[top:bottom, left:right]
        window = (left * px, height - bottom * px, (right - left) * px, (bottom - top) * px)
        out.append(_stroke(np.column_stack([xy, -depth]), part, window, px, filled=False))
    return out


def _stroke(poses, paint, window, px, filled=True) -> Stroke:
    """Return the stroke as one blob.

    Parts less than twice JOINED_MM apart count as one part, and the largest part is the stroke. filled also
    paints the gaps between hairs. Strokes that return next to themselves must not be filled.
    """
    size = 2 * round(JOINED_MM / px) + 1
    near = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    closed = cv2.morphologyEx(np.uint8(paint > LEVEL), cv2.MORPH_CLOSE, near)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(closed, connectivity=8)
    mask = np.zeros(paint.shape, bool)
    if count > 1:
        best = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
        mask = (labels == best) & (filled | (paint > LEVEL))
    return Stroke(poses, mask, np.where(mask, np.maximum(paint, LEVEL + 1), 0), window, px)


# Scores ---------------------------------------------------------------------------------------------


def overlap(a, b) -> float:
    both = np.logical_or(a, b).sum()
    return float(np.logical_and(a, b).sum() / both) if both else 1.0


def scores(strokes, predicted) -> tuple[np.ndarray, np.ndarray, list]:
    fixed = np.array([overlap(p, s.mask) for p, s in zip(predicted, strokes, strict=True)])
    moved = [best_shift(p, s.mask, s.px, FARTHEST_MM) for p, s in zip(predicted, strokes, strict=True)]
    return fixed, np.array([m[0] for m in moved]), [m[1] for m in moved]


# The best overlap -----------------------------------------------------------------------------------


def ceiling(strokes) -> tuple[np.ndarray, np.ndarray, int] | None:
    """Return the overlap (fixed, shift) of two strokes of one command, with errors.

    The third value is the number of pairs of nearly equal commands. The result is None for too few pairs. The
    standard errors come from leaving out a tenth of the strokes in turn.
    """
    at = np.linspace(0, 1, 40)
    ways = np.array([_along(s.poses, at) for s in strokes])
    way_mm = np.sqrt(((ways[:, None, :, :2] - ways[None, :, :, :2]) ** 2).sum(-1).mean(-1))
    depth_mm = np.sqrt(((ways[:, None, :, 2] - ways[None, :, :, 2]) ** 2).mean(-1))
    alike_mm, deep_mm = ALIKE_WIDTHS * _paint_per_mm(strokes), max(1e-9, -ways[:, :, 2].min())
    apart = way_mm / alike_mm + depth_mm / (ALIKE_DEPTH * deep_mm)
    pairs = np.argwhere(np.triu(apart < 1, 1))
    if len(pairs) < FEWEST_PAIRS:
        return None
    terms = np.column_stack(
        [np.ones(len(pairs)), way_mm[tuple(pairs.T)] / alike_mm, depth_mm[tuple(pairs.T)] / deep_mm]
    )
    terms = terms[:, terms.any(axis=0)]
    missing = np.array([_missing(strokes[a], strokes[b]) for a, b in pairs])

    def at_equal(chosen):
        return np.linalg.lstsq(terms[chosen], missing[chosen], rcond=None)[0][0]

    kept = [(pairs % TENTHS != k).all(axis=1) for k in range(TENTHS)]
    without = np.array([at_equal(each) for each in kept])
    error = np.sqrt((TENTHS - 1) / TENTHS * ((without - without.mean(axis=0)) ** 2).sum(axis=0))
    return 1 - at_equal(np.ones(len(pairs), bool)), error, len(pairs)


def _along(poses, at) -> np.ndarray:
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    way = np.append(0, np.cumsum(steps)) / max(1e-9, steps.sum())
    return np.column_stack([np.interp(at, way, column) for column in poses.T])


def _missing(a: Stroke, b: Stroke) -> tuple[float, float]:
    return 1 - overlap(a.mask, b.mask), 1 - best_shift(a.mask, b.mask, a.px, FARTHEST_MM)[0]


def ceiling_words(strokes) -> str:
    if len({stroke.mask.shape for stroke in strokes}) > 1:
        return "its strokes are in different windows"
    found = ceiling(strokes)
    if found is None:
        return "what can be had: too few commands are nearly equal"
    same, error, pairs = found
    best, best_error = 1 - (1 - same) / np.sqrt(2), error / np.sqrt(2)
    return (
        f"{'what can be had':22s} fixed {best[0]:.3f}  shift {best[1]:.3f}  (+- {best_error[0]:.3f}, "
        f"{best_error[1]:.3f}; two strokes of one command {same[0]:.3f}, {same[1]:.3f}, from {pairs} pairs)"
    )


# The throw-away models ------------------------------------------------------------------------------


def disc_marks(strokes, x, lag_terms) -> list[np.ndarray]:
    """Return the marks of a disc that is pulled to within r of the TCP.

    x holds the radius at depth 0 and its increase to the largest depth [mm], the displacement in x and y, the
    lag r at depth 0, and the increase of the lag to the largest depth.
    """
    deep = max(-s.poses[:, 2].min() for s in strokes) or 1.0
    out = []
    for stroke in strokes:
        at = np.linspace(0, len(stroke.poses) - 1, 120)
        q = np.column_stack([np.interp(at, np.arange(len(stroke.poses)), stroke.poses[:, i]) for i in range(3)])
        share = -q[:, 2] / deep
        r = np.zeros(len(q)) if lag_terms == 0 else x[4] + (x[5] if lag_terms == 2 else 0) * share
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
    """Fit a disc to the largest mean overlap, with one displacement for all strokes."""

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
    return minimize(loss, best.x, method="Nelder-Mead", options={"maxfev": 150, "xatol": 0.01, "fatol": 1e-4}).x


# Ours -----------------------------------------------------------------------------------------------


def painted_marks(strokes, ways) -> list:
    """Return the marks for the fit; a stroke without paint has no outline."""
    out = []
    for k, (stroke, way) in enumerate(zip(strokes, ways, strict=True)):
        left, bottom, _, height = stroke.window
        rings = mask_outlines(stroke.paint, LEVEL, stroke.px, (left, bottom + height))
        if rings:
            out.append(_core.PaintedMark(str(k), way, rings))
    return out


def fit_ours(strokes, name, machine=()):
    painted = painted_marks(strokes, [stroke.poses for stroke in strokes])
    options = _core.MarkOptions()
    depths = np.concatenate([s.poses[:, 2] for s in strokes])
    options.deepest_mm = float(-depths.min()) or 1.0
    one = float(np.ptp(depths)) < 0.05
    options.lag_terms, options.tip_gap_terms, options.half_width_terms = (1, 1, 1) if one else (2, 1, 2)
    options.height_mm = _core.Prior(0.0, 0.0 if one else 1.0)
    options.placement_mm, options.turn_rad, options.displacement_mm = 5.0, 0.0, 1.5
    options.widest_per_half = _core.Prior(1.0, 0.4)
    options.round_tail, options.spacing_mm = True, 2.0
    options.departing = False  # the documented figures are of the fit with few numbers
    machine_found.request_machine_parts(options, machine)
    return _core.fit_marks(painted, None, options), options


def by_overlap(strokes, fit, options):
    """Refine the fit of the edges as `calibrate --aim overlap` does.

    Return a fit of the same kind and a text about it.
    """
    strokes = [stroke for stroke in strokes if stroke.mask.any()]
    targets = [_target(stroke, fit) for stroke in strokes]
    marks = painted_marks(strokes, [target.poses_mm for target in targets])
    options = copy(options)
    machine_found.request_machine_parts(options, ("lean", "axes"))
    begin = SearchStart(fit.laws, fit.height_mm, fit.shift_mm)
    found = find_best_prediction(marks, targets, begin, options)
    changed = {name: getattr(found, name) for name in ("laws", "height_mm", "shift_mm", "offsets")}
    return _like(fit, **changed), found


def _like(fit, **changed):
    names = ("laws", "height_mm", "shift_mm", "centre_mm", "machine")
    return SimpleNamespace(**{name: getattr(fit, name) for name in names} | changed)


def machine_of(fit) -> tuple[np.ndarray, np.ndarray]:
    """Return lean x and y, and the axes: scale x and y less 1, and skew."""
    machine = fit.machine
    return np.array(machine.lean_mm_per_mm), np.array([*np.subtract(machine.scale, 1), machine.skew])


@cache
def _coarse(stroke: Stroke) -> tuple[np.ndarray, tuple]:
    """Return the paint in pixels twice as large, and their window.

    The window is only as large as way and paint need.
    """
    x, y, _, tall = stroke.window
    way = np.column_stack([stroke.poses[:, 0] - x, y + tall - stroke.poses[:, 1]]) / stroke.px
    seen = np.vstack([way, np.argwhere(stroke.mask)[:, ::-1]])
    left, top = np.maximum(np.floor(seen.min(axis=0) - MARGIN_MM / stroke.px).astype(int), 0)
    right, bottom = np.ceil(seen.max(axis=0) + MARGIN_MM / stroke.px).astype(int)
    part = np.float32(stroke.mask[top:bottom, left:right])
    height, width = (n // 2 for n in part.shape)
    part = cv2.resize(part[: 2 * height, : 2 * width], (width, height), interpolation=cv2.INTER_AREA)
    size = np.array([width, height]) * 2 * stroke.px
    return part, (x + left * stroke.px, y + tall - top * stroke.px - size[1], *size)


def _target(stroke: Stroke, fit) -> Target:
    paint, window = _coarse(stroke)
    return Target(_as_run(stroke, fit), paint, window, 0.5 / stroke.px)


def brush_for(strokes, fit, options) -> _core.Brush:
    deepest = max(options.deepest_mm, *(-stroke.poses[:, 2].min() for stroke in strokes))
    return brush_of(fit.laws, "fitted", (0.0, deepest + max(0.0, fit.height_mm)))


def _as_run(stroke: Stroke, fit) -> np.ndarray:
    """Return the TCP's way as the machine ran it, on paper at its commanded height."""
    lean, axes = machine_of(fit)
    poses = np.array(stroke.poses)
    at, depth = poses[:, :2] - fit.centre_mm, np.maximum(fit.height_mm - poses[:, 2:], 0.0)
    poses[:, :2] += np.column_stack([axes[0] * at[:, 0] + axes[2] * at[:, 1], axes[1] * at[:, 1]])
    poses[:, :2] += depth * lean
    return fit.offsets.displace_path(poses, fit.height_mm) if hasattr(fit, "offsets") else poses


def _moved(stroke: Stroke, fit) -> _core.Pass:
    """Return the way of the TCP on the fitted paper and sheet."""
    return _core.Pass("stroke", move_to_fitted_paper(_as_run(stroke, fit), fit.height_mm, fit.shift_mm))


def our_marks(strokes, fit, options) -> list[np.ndarray]:
    brush = brush_for(strokes, fit, options)
    plan, out = _core.Plan("fitted", "", (1.0, 1.0), []), []
    for stroke in strokes:
        plan.passes = [_moved(stroke, fit)]
        marks = _core.simulate(plan, brush)
        out.append(_core.coverage(marks, brush, stroke.window, 1 / stroke.px) > 0.5)
    return out


def picture(strokes, predicted, shifts, score, path: Path) -> None:
    """Write a picture of the best, median and worst strokes.

    Paint is grey, the TCP is blue. A red line shows the prediction at its best place.
    """
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
                image,
                [np.round(np.add(ring, (dx, dy))).astype(np.int32)],
                True,
                (40, 40, 220),
                1,
                cv2.LINE_AA,
            )
        left, bottom, _, height = stroke.window
        way = np.column_stack([stroke.poses[:, 0] - left, bottom + height - stroke.poses[:, 1]]) / stroke.px * 2
        cv2.polylines(image, [np.round(way).astype(np.int32)], False, (200, 90, 20), 1, cv2.LINE_AA)
        cv2.circle(image, tuple(int(v) for v in way[0]), 4, (200, 90, 20), -1, cv2.LINE_AA)
        cv2.putText(image, f"{2 * k + 1}: {score[k]:.3f}", (8, 20), 0, 0.6, (0, 0, 0), 1, cv2.LINE_AA)
        tiles.append(cv2.resize(image, (480, 374)))
    rows = [np.hstack(tiles[k : k + 3]) for k in (0, 3, 6)]
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), np.vstack(rows))


def laws_in_words(fit) -> str:
    def digits(law):
        return " ".join(f"{c:+.3f} d^{k}" if k else f"{c:.3f}" for k, c in enumerate(law) if k == 0 or c)

    laws, (lean, axes) = fit.laws, machine_of(fit)
    return (
        "; ".join(f"{name} = {digits(getattr(laws, name))}" for name in LAWS)
        + f"; widest {laws.widest_per_half:.2f} h from the tip, front {laws.front_per_half:.2f} h; paper "
        f"{fit.height_mm:+.2f} mm; shift {fit.shift_mm[0]:+.2f} {fit.shift_mm[1]:+.2f} mm; lean {lean[0]:+.3f} "
        f"{lean[1]:+.3f} mm/mm; scale {1 + axes[0]:.4f} {1 + axes[1]:.4f}, skew {axes[2]:+.4f}"
        + (
            f"; next to it {np.round(fit.offsets.lean_mm_per_mm, 3)}, {np.round(fit.offsets.map, 4)}"
            if hasattr(fit, "offsets")
            else ""
        )
    )


def residual_words(strokes, fit, options) -> list[str]:
    """Return the causes of the missing overlap as text.

    The share of a cause is the overlap gained if each stroke may have its own place, width or lag.
    """
    laws, targets = fit.laws, [_target(stroke, fit) for stroke in strokes]

    def places(width, lag):
        tried = _core.MarkLaws(
            [lag * c for c in laws.lag],
            laws.tip_gap,
            [width * c for c in laws.half_width],
            laws.widest_per_half,
            laws.front_per_half,
            laws.round_tail,
        )
        out = []
        pictures = predict_pictures(targets, tried, fit.height_mm, fit.shift_mm, options.deepest_mm)
        for target, picture in zip(targets, pictures, strict=True):
            fixed = soft_overlap(target.paint, picture)
            out.append((fixed, max(fixed, best_shift(picture, target.paint, 1 / target.px_per_mm, FARTHEST_MM)[0])))
        return np.array(out)

    by = np.array([[places(width, lag) for lag in OWN_LAGS] for width in OWN_WIDTHS])
    usual = (OWN_WIDTHS.index(1.0), OWN_LAGS.index(1.0))
    fixed, place = by[usual][:, 0].mean(), by[usual][:, 1].mean()
    own_width = by[:, usual[1], :, 1].max(axis=0).mean()
    own_both = by[..., 1].max(axis=(0, 1)).mean()
    best = np.array(OWN_WIDTHS)[by[:, usual[1], :, 1].argmax(axis=0)]
    return [
        f"what is missing to 1: place {place - fixed:.3f}, width of the whole mark {own_width - place:.3f} (best "
        f"widths {100 * best.std():.0f} % apart, rms), lag of the whole mark {own_both - own_width:.3f}; left "
        f"{1 - own_both:.3f}: ends, hairs, gaps, blocks of the compressed pictures"
    ]


def _paint_per_mm(strokes) -> float:
    lengths = [np.hypot(*np.diff(s.poses[:, :2], axis=0).T).sum() for s in strokes]
    return float(np.median([s.mask.sum() * s.px**2 / n for s, n in zip(strokes, lengths, strict=True)]))


def _parts(text: str) -> tuple[str, ...]:
    """Return the parts of --machine. These sheets do not show tilt and backlash."""
    parts = values.machine_parts(text)
    if not {"lean", "axes"}.issuperset(parts):
        raise argparse.ArgumentTypeError("only lean and axes are looked for here")
    return parts


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--sets", nargs="*", metavar="NAME")
    arguments.add_argument("--ceilings", action="store_true")
    arguments.add_argument("--pictures", type=Path)
    arguments.add_argument("--no-peers", action="store_true")
    arguments.add_argument("--machine", metavar="PARTS", type=_parts, default=(), help="lean,axes")
    args = arguments.parse_args()
    for name in args.sets or sorted(path.stem for path in args.folder.glob("*.npz")):
        strokes = load(args.folder, name)
        seen, unseen = strokes[::2], strokes[1::2]
        print(
            f"\n{name}: {len(seen)} strokes fitted, {len(unseen)} scored; {_paint_per_mm(seen):.2f} and "
            f"{_paint_per_mm(unseen):.2f} mm^2 of paint per mm of way (median)"
        )
        print(f"  {ceiling_words(strokes)}", flush=True)
        if args.ceilings:
            continue
        if not args.no_peers:
            for terms, what in DISCS:
                x = fit_disc(seen, terms)
                fixed, moved, _ = scores(unseen, disc_marks(unseen, x, terms))
                lag = ", ".join(f"{v:.2f}" for v in x[4:])
                print(f"  {what:22s} fixed {fixed.mean():.3f}  shift {moved.mean():.3f}  r {lag}", flush=True)
        begin = time.perf_counter()
        fit, options = fit_ours(seen, name, args.machine)
        took = time.perf_counter() - begin
        edges = our_marks(unseen, fit, options)
        fixed, moved, _ = scores(unseen, edges)
        converged = "" if fit.converged else ", not converged"
        print(
            f"  {'ours, edges':22s} fixed {fixed.mean():.3f}  shift {moved.mean():.3f}  ({took:.1f} s, "
            f"{fit.iterations} iterations{converged})",
            flush=True,
        )
        best, found = by_overlap(seen, fit, options)
        took = time.perf_counter() - begin
        marks = our_marks(unseen, best, options)
        fixed, moved, shifts = scores(unseen, marks)
        print(
            f"  {'ours, overlap':22s} fixed {fixed.mean():.3f}  shift {moved.mean():.3f}  ({took:.1f} s; "
            f"{found.overlap:.3f} on the strokes fitted; {found.numbers} numbers)",
            flush=True,
        )
        print(f"    {chosen_in_words(found)}")
        for what, one in (("edges", fit), ("overlap", best)):
            print(f"    {what}: {laws_in_words(one)}")
        for line in [*residual_words(unseen, best, options), *fit.remarks]:
            print(f"    {line}")
        if args.pictures:
            picture(unseen, marks, shifts, moved, args.pictures / f"{name}.png")


if __name__ == "__main__":
    main()
