"""Lines of widths that a brush has, along the middle line of a stroke that is wider, and beside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import _core

FITTED = 0.03  # of a pass's half width, off its curve at most: as much lies outside of the shape
_SHARE = 0.9  # of a pass's width, the next one's middle line at most beside it: they overlap by the rest
_FLAT_MM = 0.02
_MOST_ROWS = 400  # beside the middle line; more is no stroke of a brush


@dataclass(frozen=True)
class Line:
    """middle_mm: cubics (n, 8); half_width: [(fraction of arc length, mm)]."""

    middle_mm: np.ndarray
    half_width: list[tuple[float, float]]
    closed: bool = False


def clamped(stroke, least: float, greatest: float) -> Line:
    """The stroke's line with its widths cut to the range, a knot where they leave it."""
    at, half = np.array(stroke.half_width).T
    knots = [(at[0], half[0])]
    for a0, h0, a1, h1 in zip(at[:-1], half[:-1], at[1:], half[1:], strict=True):
        cuts = [(bound - h0) / (h1 - h0) for bound in (least, greatest) if (h0 - bound) * (h1 - bound) < 0]
        knots += [(a0 + cut * (a1 - a0), h0 + cut * (h1 - h0)) for cut in sorted(cuts)]
        knots.append((a1, h1))
    cut = [(float(a), float(np.clip(h, least, greatest))) for a, h in knots]
    return Line(stroke.middle_mm, cut, stroke.closed)


def offset_passes(stroke, greatest: float) -> list[Line]:
    """Passes of the greatest width left and right of the middle line, wherever the stroke is wider; none where that
    would be hundreds."""
    widest = max(half for _, half in stroke.half_width)
    if widest - greatest > _MOST_ROWS * 2 * _SHARE * greatest:
        return []
    line = _core.flatten(stroke, _FLAT_MM)
    if line[-1, 2] == 0:
        return _round_about(line[0], greatest)
    even_mm = np.linspace(0, line[-1, 2], min(int(4 * line[-1, 2] / greatest) + 8, 5000))
    line = np.column_stack([np.interp(even_mm, line[:, 2], line[:, k]) for k in range(4)])
    line[:, 3] = np.interp(even_mm / even_mm[-1], *np.array(stroke.half_width).T)
    wider = np.concatenate([[0], (line[:, 3] > greatest + 1e-9).astype(int), [0]])
    starts, ends = np.flatnonzero(np.diff(wider) == 1), np.flatnonzero(np.diff(wider) == -1)
    found = []
    for first, last in zip(starts.tolist(), ends.tolist(), strict=True):
        stretch = line[first:last]
        if len(stretch) < 2:
            continue
        beyond = stretch[:, 3] - greatest
        rows = int(np.ceil(beyond.max() / (2 * _SHARE * greatest)))
        along = np.gradient(stretch[:, :2], axis=0)
        along /= np.maximum(np.hypot(*along.T), 1e-12)[:, None]
        across = np.column_stack([-along[:, 1], along[:, 0]])
        round_ends = (first == 0 and not stroke.closed, last == len(line) and not stroke.closed)
        for row in range(1, rows + 1):
            for side in (1, -1):
                points = _offset(stretch[:, :2], along, side * across, beyond * row / rows, round_ends)
                if points is not None:
                    found.append(np.column_stack([points, np.full(len(points), greatest)]))
    return [Line(*_core.fit_curve(points, FITTED * greatest)) for points in found]


def _offset(points, along, across, away, round_ends) -> np.ndarray | None:
    """Points moved sideways, those left out that a bend would send back; at ends round about them."""
    moved = points + away[:, None] * across
    onward = np.concatenate([[True], (np.diff(moved, axis=0) * along[1:]).sum(axis=1) > 0])
    rows = [moved[onward]]
    quarter = np.linspace(0, np.pi / 2, 8)[:-1, None]
    if round_ends[0]:
        rows.insert(0, points[0] + away[0] * (np.sin(quarter) * across[0] - np.cos(quarter) * along[0]))
    if round_ends[1]:
        rows.append(
            (points[-1] + away[-1] * (np.sin(quarter) * across[-1] + np.cos(quarter) * along[-1]))[::-1]
        )
    return np.vstack(rows) if len(rows[0]) + len(rows[-1]) > 3 else None


def _round_about(place, greatest: float) -> list[Line]:
    """Rings about a dab wider than the brush."""
    beyond = place[3] - greatest
    rows = int(np.ceil(beyond / (2 * _SHARE * greatest)))
    angle = np.linspace(0, 2 * np.pi, 33)[:, None]
    circle = np.hstack([-np.sin(angle), np.cos(angle)])
    made = []
    for row in range(1, rows + 1):
        points = np.column_stack([place[:2] + beyond * row / rows * circle, np.full(len(circle), greatest)])
        made.append(Line(*_core.fit_curve(points, 0.02 * greatest, True), closed=True))
    return made
