"""Widen the targets of strokes as paint runs out, so that the marks come out as wide as drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import Notice
from ..geometry import arc_length
from ..geometry.cubics import split
from ..geometry.polylines import lengths

SHARE = 2e-3  # of the width, between two knots: straight in between is off by far less
JUMP = 1e-4  # of a stroke's length, over which it is wide again once paint was fetched
STEP_MM = 0.5  # of outlines that move out
# Of what a wider end would reach further, by which its line is shorter: an end that paint made slim covers most of a
# round one if it reaches a little too far; with 0.5 or 1 half as much again of the end is lost
SHORTER = 0.85
MOST_SHORTER = 0.9  # of a stroke, at both ends together
LEAST_MM = 1e-3  # of a line; what is shorter is a dab
MOST_ROUNDS = 8  # of plans: deeper landings are longer, which takes more paint; three or four as a rule


@dataclass(frozen=True)
class Pressed:
    """painted, targets: strokes to compensate and their targets; done: the compensation of painted; notices: where the
    brush would have to be pressed deeper than it may be."""

    painted: list
    targets: list
    done: object
    notices: list[Notice]


def pressed_deeper(
    painted: list,
    targets: list,
    brush: _core.Brush,
    done,
    compensated: Callable,
    fetched_mm: Callable[[_core.Plan], list[list[float]]],
    lowest_mm: float,
) -> Pressed:
    """Half widths over the share that the way since the last dip leaves of them: a brush with `paint` is pressed as
    much deeper. Within the depths that were measured, down to lowest_mm.

    done: what compensates the strokes as they are painted freshly dipped; fetched_mm: of a plan, where paint is
    fetched.
    """
    deepest_mm, half_mm = _reach(brush, lowest_mm)
    shares = None
    for _ in range(MOST_ROUNDS):
        marks = _core.simulate(done.plan, brush)
        _core.narrow(marks, brush.paint, fetched_mm(done.plan))
        before, shares = shares, [_shares(trace, brush) for trace in marks.passes]
        if before and all(_is_like(*pair) for pair in zip(before, shares, strict=True)):
            break
        now = [wider(*pair, half_mm) for pair in zip(painted, shares, strict=True)]
        done = compensated(now)
    short = [_short(*pair, half_mm) for pair in zip(painted, shares, strict=True)]
    wider_targets = [wider(*pair, np.inf) for pair in zip(targets, shares, strict=True)]
    return Pressed(now, wider_targets, done, _warn_of_shortage(short, brush, deepest_mm))


def _is_like(before: np.ndarray, shares: np.ndarray) -> bool:
    """Whether two rounds leave shares that are the same but at the dips, which move along by little."""
    off = np.interp(shares[:, 0], *before.T) / shares[:, 1] - 1
    return float(np.median(np.abs(off))) < SHARE


def _reach(brush, lowest_mm: float) -> tuple[float, float]:
    """The greatest depth that was measured and may be taken, and half of the width there."""
    measured = [law.calibrated_mm[1] for law in (brush.lag, brush.half_width) if law.calibrated_mm]
    deepest = min([brush.depth_range_mm[1], -lowest_mm, *measured])
    return deepest, brush.half_width(max(deepest, 0.0))


def _shares(trace, brush) -> np.ndarray:
    """Rows: where the widest section is, as a share of its way, ascending; the share of the width that is left."""
    down = np.flatnonzero(np.asarray(trace.depth_mm) >= 0)
    if not len(down):
        return np.array([[0.0, 1.0]])
    at = lengths(_core.widest_points(trace, brush)[down])
    at = at / max(float(at[-1]), 1e-9)
    share = np.asarray(trace.width_share)[down]
    rows = [0]
    for k in range(1, len(at)):
        if abs(share[k] / share[rows[-1]] - 1) > SHARE or k == len(at) - 1:
            rows += [k - 1] if k - 1 > rows[-1] and share[k] > share[k - 1] else []
            rows.append(k)
    at, share = at[rows].copy(), share[rows]
    for k in range(1, len(at)):
        at[k] = max(at[k], at[k - 1] + JUMP)
    return np.column_stack([at, share])


def wider(stroke: _core.Stroke, shares: np.ndarray, most_mm: float) -> _core.Stroke:
    """The stroke with half widths, and an outline, as much wider, but no half width wider than most_mm for that."""
    whole_mm = arc_length.knots(np.asarray(stroke.middle_mm).reshape(-1, 4, 2))[:, -1].sum()
    if shares[:, 1].min() > 1 - SHARE / 2 or whole_mm < LEAST_MM:  # dabs are as wide as the patch is long
        return stroke
    own = np.array(stroke.half_width)
    knots = [(at, half) for at, half in stroke.half_width]
    new = [at for at in np.clip(shares[:, 0], 0, 1) if not np.isin(at, own[:, 0])]
    knots += [(at, float(np.interp(at, *own.T))) for at in new]
    knots.sort(key=lambda knot: knot[0])
    out = [(at, max(half, min(half / float(np.interp(at, *shares.T)), most_mm))) for at, half in knots]
    outlines = [_grow(np.asarray(ring), stroke, shares) for ring in stroke.wanted_mm]
    more = [out[k][1] - half for k, (_, half) in zip((0, -1), (knots[0], knots[-1]), strict=True)]
    line = stroke.replaced(half_width=out, wanted_mm=outlines)
    return line if stroke.closed else _shortened(line, *more)


def _shortened(stroke, first_mm: float, last_mm: float):
    """Paint takes of the width, not of the length: the rounder ends of a wider stroke are to reach no further."""
    cubics = np.asarray(stroke.middle_mm).reshape(-1, 4, 2)
    known = arc_length.knots(cubics)
    whole_mm = float(known[:, -1].sum())
    less = min(SHORTER, MOST_SHORTER * whole_mm / max(first_mm + last_mm, 1e-9))
    from_mm, to_mm = less * first_mm, whole_mm - less * last_mm
    if to_mm - from_mm < LEAST_MM:
        return stroke
    (i, k), (t0, t1) = arc_length.parameters_at(cubics, known, np.array([from_mm, to_mm]))
    left = [*cubics[:k], split(cubics[k], t1)[0]]
    if i == k:
        t0 = t0 / t1
    kept = np.array([split(left[i], t0)[1], *left[i + 1 :]])
    at = [(np.clip((at * whole_mm - from_mm) / (to_mm - from_mm), 0, 1), h) for at, h in stroke.half_width]
    return stroke.replaced(middle_mm=kept.reshape(-1, 8), half_width=at)


def _grow(ring: np.ndarray, stroke, shares: np.ndarray) -> np.ndarray:
    """Across the middle line by what the paint will take; along it as it was."""
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
    more = 1 / np.interp(fine[row] / fine[-1], *shares.T) - 1
    return points + (more * across)[:, None] * normal[row]


def _short(stroke, shares: np.ndarray, most_mm: float) -> float:
    """By which share of it the stroke comes out narrower than drawn at its worst place."""
    own = np.array(stroke.half_width)
    half = np.interp(shares[:, 0], *own.T)
    got = np.maximum(half, np.minimum(half / shares[:, 1], most_mm)) * shares[:, 1]
    return float(1 - (got / np.maximum(half, 1e-9)).min())


LEAST_REPORTED = 0.01  # of the width


def _warn_of_shortage(short: list[float], brush, deepest_mm: float) -> list[Notice]:
    count = sum(each > LEAST_REPORTED for each in short)
    if not count:
        return []
    strokes = "1 stroke comes" if count == 1 else f"{count} strokes come"
    sentence = (
        f"{strokes} out up to {100 * max(short):.0f} % narrower than drawn as paint runs out: brush {brush.name} is "
        f"pressed no deeper than {deepest_mm:.4g} mm for it"
    )
    return [Notice("", sentence, code="paint-runs-out")]
