"""Strokes found in outlines, made such that a brush can paint them: wider or narrower than it, they are not."""

from __future__ import annotations

import numpy as np

from . import _core
from .design import Notice
from .errors import Error

WIDE = ("clamp", "passes", "refuse")
_SHARE = 0.9  # of a pass's width, the next one's middle line at most beside it: they overlap by the rest
_FITTED = 0.03  # of a pass's half width, off its curve at most: as much lies outside of the shape
_FLAT_MM = 0.02


def within_reach(strokes: list, brush, wide: str = "clamp") -> tuple[list, list, list[Notice]]:
    """What to paint, stroke by stroke, and what each should become: (strokes to paint, strokes wanted, notices).

    Only strokes that carry an outline are changed: widths that were drawn as such are refused when the plan is made.
    wide: "clamp", the nearest width; "passes", also passes beside the middle line where the brush is too narrow, called
    id~2, id~3 ..., which cover the shape and stay in it; "refuse", Error naming stroke, width and range.
    """
    if not brush.width_follows_depth():
        return strokes, strokes, []
    least, greatest = brush.half_width_range_mm()
    painted, wanted, notices = [], [], []
    for stroke in strokes:
        halves = np.array([half for _, half in stroke.half_width])
        off = (halves < least - 1e-9) | (halves > greatest + 1e-9)
        if not stroke.wanted_mm or not off.any():
            painted.append(stroke)
            wanted.append(stroke)
            continue
        worst = halves.max() if halves.max() > greatest + 1e-9 else halves.min()
        reach = f"[{2 * least:.3g}, {2 * greatest:.3g}] mm of brush {brush.name}"
        if wide == "refuse":
            sentence = f"width {2 * worst:.3g} mm of its outline is outside the range {reach}"
            raise Error(sentence, where=stroke.id, value=2 * worst, range=(2 * least, 2 * greatest))
        beside = _beside(stroke, greatest) if wide == "passes" and worst > greatest else []
        how = f"painted in {1 + len(beside)} passes" if beside else "painted at the nearest"
        count = (
            f"{off.sum()} of {len(off)} widths of its outline, up to"
            if len(off) > 1
            else "the width of its outline,"
        )
        notices.append(Notice(stroke.id, f"{count} {2 * worst:.3g} mm, outside the range {reach}: {how}"))
        painted += [_clamped(stroke, least, greatest), *beside]
        wanted += [stroke, *beside]
    return painted, wanted, notices


def _like(stroke, name: str, middle_mm, half_width, closed: bool = False):
    return _core.Stroke(name, middle_mm, closed, half_width, stroke.layer, stroke.colour, stroke.settings)


def _clamped(stroke, least: float, greatest: float):
    """The stroke with its widths cut to the range, a knot where they leave it."""
    at, half = np.array(stroke.half_width).T
    knots = [(at[0], half[0])]
    for a0, h0, a1, h1 in zip(at[:-1], half[:-1], at[1:], half[1:], strict=True):
        cuts = [(bound - h0) / (h1 - h0) for bound in (least, greatest) if (h0 - bound) * (h1 - bound) < 0]
        knots += [(a0 + cut * (a1 - a0), h0 + cut * (h1 - h0)) for cut in sorted(cuts)]
        knots.append((a1, h1))
    cut = [(float(a), float(np.clip(h, least, greatest))) for a, h in knots]
    made = _like(stroke, stroke.id, stroke.middle_mm, cut, stroke.closed)
    made.wanted_mm = stroke.wanted_mm
    return made


def _beside(stroke, greatest: float) -> list:
    """Passes of the greatest width left and right of the middle line, wherever the stroke is wider."""
    line = _core.flatten(stroke, _FLAT_MM)
    if line[-1, 2] == 0:
        return _round_about(stroke, line[0], greatest)
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
    fitted = [_core.fit_curve(points, _FITTED * greatest) for points in found]
    return [
        _like(stroke, f"{stroke.id}~{number}", middle, knots)
        for number, (middle, knots) in enumerate(fitted, start=2)
    ]


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


def _round_about(stroke, place, greatest: float) -> list:
    """Rings about a dab wider than the brush."""
    beyond = place[3] - greatest
    rows = int(np.ceil(beyond / (2 * _SHARE * greatest)))
    angle = np.linspace(0, 2 * np.pi, 33)[:, None]
    circle = np.hstack([-np.sin(angle), np.cos(angle)])
    made = []
    for row in range(1, rows + 1):
        points = np.column_stack([place[:2] + beyond * row / rows * circle, np.full(len(circle), greatest)])
        middle, knots = _core.fit_curve(points, 0.02 * greatest, True)
        made.append(_like(stroke, f"{stroke.id}~{row + 1}", middle, knots, True))
    return made
