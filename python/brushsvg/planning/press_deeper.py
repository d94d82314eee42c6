"""Press deeper as paint runs out: wider targets for strokes.

With them, the marks come out as wide as drawn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import Notice
from ..geometry import arc_length
from ..geometry.cubics import split
from ..geometry.polylines import lengths

# Greatest change of the width share between two knots; a straight line in between is off by far less.
MAX_SHARE_CHANGE = 2e-3
# Share of a stroke's length over which it becomes wide again after paint was fetched.
REFILL_STEP = 1e-4
STEP_MM = 0.5  # distance between points of outlines that move out
# A wider end would reach further. The line is shortened by this share of that distance. An end that paint made slim
# covers most of a round one if it reaches a little too far; with 0.5 or 1, half as much again of the end is lost.
SHORTENING = 0.85
MAX_SHORTENING = 0.9  # share of a stroke, at both ends together
MIN_LENGTH_MM = 1e-3  # least length of a line; a shorter one is a dab
# Rounds of planning. Deeper landings are longer, which needs more paint; three or four rounds are usual.
MAX_ROUNDS = 8


@dataclass(frozen=True)
class Pressed:
    """The result of pressing a brush deeper as paint runs out.

    painted, targets: strokes to compensate and their targets; done: the compensation of painted; notices: where the
    brush would have to be pressed deeper than it may be.
    """

    painted: list
    targets: list
    done: object
    notices: list[Notice]


def press_deeper(
    painted: list,
    targets: list,
    brush: _core.Brush,
    done,
    compensated: Callable,
    fetched_mm: Callable[[_core.Plan], list[list[float]]],
) -> Pressed:
    """Widen strokes by as much as their marks narrow since the last dip.

    A brush with `paint` is pressed deeper for it. It stays within its depth range and the depths that were measured.

    painted, targets: strokes and their targets; done: the compensation of the strokes as they are painted freshly
    dipped; compensated: compensates strokes; fetched_mm: gives the places of a plan at which paint is fetched.
    """
    deepest_mm, half_mm = _find_greatest_depth(brush)
    shares = None
    for _ in range(MAX_ROUNDS):
        marks = _core.simulate(done.plan, brush)
        _core.narrow(marks, brush.paint, fetched_mm(done.plan))
        before, shares = shares, [_measure_width_shares(trace, brush) for trace in marks.passes]
        if before and all(_are_shares_similar(*pair) for pair in zip(before, shares, strict=True)):
            break
        widened = [_widen_stroke(*pair, half_mm) for pair in zip(painted, shares, strict=True)]
        done = compensated(widened)
    shortages = [_measure_shortage(*pair, half_mm) for pair in zip(painted, shares, strict=True)]
    wider_targets = [_widen_stroke(*pair, np.inf) for pair in zip(targets, shares, strict=True)]
    return Pressed(widened, wider_targets, done, _warn_of_shortage(shortages, brush, deepest_mm))


def _are_shares_similar(before: np.ndarray, shares: np.ndarray) -> bool:
    """Return whether rounds leave similar shares of the width; dips move along by little and may differ."""
    off = np.interp(shares[:, 0], *before.T) / shares[:, 1] - 1
    return float(np.median(np.abs(off))) < MAX_SHARE_CHANGE


def _find_greatest_depth(brush) -> tuple[float, float]:
    """Return the greatest measured depth that is allowed, and half the width there."""
    measured = [law.calibrated_mm[1] for law in (brush.lag, brush.half_width) if law.calibrated_mm]
    deepest = min([brush.depth_range_mm[1], *measured])
    return deepest, brush.half_width(max(deepest, 0.0))


def _measure_width_shares(trace, brush) -> np.ndarray:
    """Return rows of place (widest section's share of its way, ascending) and share of width left there."""
    down = np.flatnonzero(np.asarray(trace.depth_mm) >= 0)
    if not len(down):
        return np.array([[0.0, 1.0]])
    at = lengths(_core.widest_points(trace, brush)[down])
    at = at / max(float(at[-1]), 1e-9)
    share = np.asarray(trace.width_share)[down]
    rows = [0]
    for k in range(1, len(at)):
        if abs(share[k] / share[rows[-1]] - 1) > MAX_SHARE_CHANGE or k == len(at) - 1:
            rows += [k - 1] if k - 1 > rows[-1] and share[k] > share[k - 1] else []
            rows.append(k)
    at, share = at[rows].copy(), share[rows]
    for k in range(1, len(at)):
        at[k] = max(at[k], at[k - 1] + REFILL_STEP)
    return np.column_stack([at, share])


def _widen_stroke(stroke: _core.Stroke, shares: np.ndarray, most_mm: float) -> _core.Stroke:
    """Return the stroke with its half widths and outline widened by the shares.

    No half width becomes larger than most_mm. shares: rows as from _measure_width_shares.
    """
    whole_mm = arc_length.knots(np.asarray(stroke.middle_mm).reshape(-1, 4, 2))[:, -1].sum()
    # A dab is as wide as the patch is long.
    if shares[:, 1].min() > 1 - MAX_SHARE_CHANGE / 2 or whole_mm < MIN_LENGTH_MM:
        return stroke
    own_knots = np.array(stroke.half_width)
    knots = [(at, half) for at, half in stroke.half_width]
    new_places = [at for at in np.clip(shares[:, 0], 0, 1) if not np.isin(at, own_knots[:, 0])]
    knots += [(at, float(np.interp(at, *own_knots.T))) for at in new_places]
    knots.sort(key=lambda knot: knot[0])
    widened = [(at, max(half, min(half / float(np.interp(at, *shares.T)), most_mm))) for at, half in knots]
    outlines = [_widen_ring(np.asarray(ring), stroke, shares) for ring in stroke.target_mm]
    growth = [widened[k][1] - half for k, (_, half) in zip((0, -1), (knots[0], knots[-1]), strict=True)]
    line = stroke.replaced(half_width=widened, target_mm=outlines)
    return line if stroke.closed else _shorten_stroke(line, *growth)


def _shorten_stroke(stroke, first_mm: float, last_mm: float):
    """Shorten a widened stroke so that its rounder ends reach no further.

    Paint that runs out takes away width, not length.
    """
    cubics = np.asarray(stroke.middle_mm).reshape(-1, 4, 2)
    known = arc_length.knots(cubics)
    whole_mm = float(known[:, -1].sum())
    share = min(SHORTENING, MAX_SHORTENING * whole_mm / max(first_mm + last_mm, 1e-9))
    from_mm, to_mm = share * first_mm, whole_mm - share * last_mm
    if to_mm - from_mm < MIN_LENGTH_MM:
        return stroke
    (i, k), (t0, t1) = arc_length.parameters_at(cubics, known, np.array([from_mm, to_mm]))
    left = [*cubics[:k], split(cubics[k], t1)[0]]
    if i == k:
        t0 = t0 / t1
    remaining = np.array([split(left[i], t0)[1], *left[i + 1 :]])
    at = [(np.clip((at * whole_mm - from_mm) / (to_mm - from_mm), 0, 1), h) for at, h in stroke.half_width]
    return stroke.replaced(middle_mm=remaining.reshape(-1, 8), half_width=at)


def _widen_ring(ring: np.ndarray, stroke, shares: np.ndarray) -> np.ndarray:
    """Move a ring out across, not along, the middle line by as much as paint will take away."""
    closed = np.vstack([ring, ring[:1]])
    at = lengths(closed)
    at = np.union1d(at, np.arange(0.0, at[-1], STEP_MM))[:-1]
    points = np.column_stack([np.interp(at, lengths(closed), column) for column in closed.T])
    line = _core.flatten(stroke, 0.02)
    if len(line) < 2:
        return ring
    fine = np.union1d(line[:, 2], np.arange(0.0, line[-1, 2], STEP_MM))
    middle = np.column_stack([np.interp(fine, line[:, 2], column) for column in line[:, :2].T])
    along = np.gradient(middle, axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-12)[:, None]
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    row = np.concatenate(
        [
            ((part[:, None] - middle) ** 2).sum(axis=2).argmin(axis=1)
            for part in np.array_split(points, len(points) // 256 + 1)
        ]
    )
    across = ((points - middle[row]) * normal[row]).sum(axis=1)
    growth = 1 / np.interp(fine[row] / fine[-1], *shares.T) - 1
    return points + (growth * across)[:, None] * normal[row]


def _measure_shortage(stroke, shares: np.ndarray, most_mm: float) -> float:
    """Return the share by which a stroke is narrower than drawn at its worst place."""
    own_knots = np.array(stroke.half_width)
    half = np.interp(shares[:, 0], *own_knots.T)
    painted_half = np.maximum(half, np.minimum(half / shares[:, 1], most_mm)) * shares[:, 1]
    return float(1 - (painted_half / np.maximum(half, 1e-9)).min())


MIN_REPORTED_SHORTAGE = 0.01  # share of the width


def _warn_of_shortage(short: list[float], brush, deepest_mm: float) -> list[Notice]:
    count = sum(each > MIN_REPORTED_SHORTAGE for each in short)
    if not count:
        return []
    strokes = "1 stroke comes" if count == 1 else f"{count} strokes come"
    sentence = (
        f"{strokes} out up to {100 * max(short):.0f} % narrower than drawn as paint runs out: brush {brush.name} "
        f"cannot be pressed deeper than {deepest_mm:.4g} mm to make up for it"
    )
    return [Notice("", sentence, code="paint-runs-out")]
