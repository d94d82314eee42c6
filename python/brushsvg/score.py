"""Painted and wanted marks laid over each other as shares of pixels: what they have in common, and where they differ.

Pixels and not rings: the union of a page's rings takes a minute, its pixels two seconds, and overlaps agree to 1e-3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from . import _core

PX_PER_MM = (8.0, 40.0)  # coarse ones are quick, fine ones are for hairlines and dots
ACROSS_PX = 6.0  # of the thinnest half width, where that many can be had
MOST_PX = 4e6  # of one picture: bounds the memory
TILE_PX = 1000
MOST_TILES_PX = 6e7  # of all the tiles of a sheet: bounds the time
OUTLINE_MM = 0.01
SPACING_MM = 0.5  # of the places where widths are measured
BLOCKS = 5  # the worst place is looked for in steps of a fifth of its size
BESIDE_MM = 0.3  # round a box: what lies on its edge is seen whole


@dataclass(frozen=True)
class Meant:
    """A stroke as it was drawn: its outline where it has one (rings), else convex pieces of its path with its width;
    boxes: left, bottom, right, top, of the pieces and of all; finest_mm: its least half width that is one."""

    stroke: object
    rings: list
    pieces: list
    piece_boxes_mm: np.ndarray
    box_mm: np.ndarray
    finest_mm: float


def meant(stroke) -> Meant:
    rings = list(stroke.wanted_mm)
    pieces = [] if rings else _core.wanted_pieces(stroke, OUTLINE_MM)
    parts = rings or pieces or [np.asarray(stroke.middle_mm).reshape(-1, 2)]
    points, starts = np.vstack(parts), np.cumsum([0, *map(len, parts)])[:-1]
    boxes = np.hstack([np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)])
    finest = min((half for _, half in stroke.half_width if half > 0), default=1.0)
    return Meant(stroke, rings, pieces, boxes, joint(boxes), finest)


@dataclass(frozen=True)
class View:
    """A part of the paper. window_mm: x, y of its lower left corner, width, height; wanted, painted: shares of its
    pixels, row 0 at the top."""

    window_mm: tuple[float, float, float, float]
    px_per_mm: float
    wanted: np.ndarray
    painted: np.ndarray

    def place_mm(self, row: float, column: float) -> tuple[float, float]:
        """Where on the paper the middle of a pixel lies."""
        x, y, _, height = self.window_mm
        return x + (column + 0.5) / self.px_per_mm, y + height - (row + 0.5) / self.px_per_mm


@dataclass(frozen=True)
class Areas:
    """Of paint and wanted mark [mm^2]."""

    common: float
    together: float

    @property
    def overlap(self) -> float:
        """Area of the intersection over area of the union; 1 when both are empty."""
        return self.common / self.together if self.together > 0 else 1.0


def view(traces, wanted: list[Meant], brush) -> View:
    """What passes of marks and strokes cover, with some paper round it."""
    box = joint([box_of_paint(trace, brush) for trace in traces] + [each.box_mm for each in wanted])
    width, height = np.maximum(np.subtract(box[2:], box[:2]) + 2 * BESIDE_MM, 1e-3)
    asked = float(np.clip(ACROSS_PX / min((each.finest_mm for each in wanted), default=1.0), *PX_PER_MM))
    px = min(asked, float(np.sqrt(MOST_PX / (width * height))))
    window = (float(box[0] - BESIDE_MM), float(box[1] - BESIDE_MM), float(width), float(height))
    return View(window, px, wanted_pixels(wanted, window, px), painted_pixels(traces, brush, window, px))


def wanted_pixels(wanted: list[Meant], window, px_per_mm: float) -> np.ndarray:
    """What strokes together cover."""
    shapes = [ring for each in wanted for ring in each.rings]
    pieces = [piece for each in wanted for piece in each.pieces]
    if not shapes:
        return _core.coverage_of_pieces(pieces, window, px_per_mm)
    covered = _core.coverage(shapes, window, px_per_mm)
    return np.maximum(covered, _core.coverage_of_pieces(pieces, window, px_per_mm)) if pieces else covered


def painted_pixels(traces, brush, window, px_per_mm: float) -> np.ndarray:
    marks = _core.Marks()
    marks.passes = list(traces)
    return _core.coverage(marks, brush, window, px_per_mm)


def areas(seen: View) -> Areas:
    common = np.minimum(seen.wanted, seen.painted).sum(dtype=float)
    together = np.maximum(seen.wanted, seen.painted).sum(dtype=float)
    return Areas(float(common) / seen.px_per_mm**2, float(together) / seen.px_per_mm**2)


def areas_of_sheet(traces, wanted: list[Meant], brush) -> Areas:
    """Areas of all paint and of all that was drawn, whatever the size of the sheet: tile by tile."""
    boxes = np.array([box_of_paint(trace, brush) for trace in traces]).reshape(-1, 4)
    drawn = np.array([each.box_mm for each in wanted]).reshape(-1, 4)
    left, bottom, right, top = joint([*boxes, *drawn])
    width, height = max(right - left, 1e-3), max(top - bottom, 1e-3)
    px = min(PX_PER_MM[0], float(np.sqrt(MOST_TILES_PX / (width * height))))
    if width * height * PX_PER_MM[0] ** 2 < MOST_PX:
        return areas(view(traces, wanted, brush))
    side = TILE_PX / px
    total = np.zeros(2)
    for x in np.arange(left, right, side):
        for y in np.arange(bottom, top, side):
            window = (float(x), float(y), side, side)
            here = [t for t, at in zip(traces, _meet(boxes, window), strict=True) if at]
            there = [w for w, at in zip(wanted, _meet(drawn, window), strict=True) if at]
            if here or there:
                painted = painted_pixels(here, brush, window, px)
                found = areas(View(window, px, wanted_pixels(there, window, px), painted))
                total += found.common, found.together
    return Areas(*total.tolist())


def _meet(boxes: np.ndarray, window) -> np.ndarray:
    x, y, width, height = window
    return (boxes[:, 0] <= x + width) & (boxes[:, 2] >= x) & (boxes[:, 1] <= y + height) & (boxes[:, 3] >= y)


def box_of_paint(trace, brush) -> np.ndarray:
    return np.array(_core.painted_bounds(trace, brush))  # nothing painted: infinities, which meet nothing


def joint(boxes) -> np.ndarray:
    """The box round boxes; those of nothing do not count."""
    boxes = np.array(boxes, dtype=float).reshape(-1, 4)
    boxes = boxes[np.isfinite(boxes).all(axis=1)]
    if not len(boxes):
        return np.zeros(4)
    return np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)])


def worst_place(seen: View, size_mm: float) -> tuple[tuple[float, float], bool, float]:
    """Where a square of the size differs most: its middle [mm], whether paint is missing there (else too much), and
    how much of it [mm^2]."""
    common = np.minimum(seen.wanted, seen.painted)
    block = max(1, round(size_mm * seen.px_per_mm / BLOCKS))
    size = max(1, min(round(size_mm * seen.px_per_mm / block), *(n // block for n in common.shape)))
    missing, spilt = (_sums(_in_blocks(each - common, block), size) for each in (seen.wanted, seen.painted))
    is_missing = bool(missing.max() >= spilt.max())
    sums = missing if is_missing else spilt
    row, column = np.unravel_index(int(sums.argmax()), sums.shape)
    middle = seen.place_mm(*((first + size / 2) * block - 0.5 for first in (row, column)))
    return (float(middle[0]), float(middle[1])), is_missing, float(sums[row, column]) / seen.px_per_mm**2


def _in_blocks(values: np.ndarray, block: int) -> np.ndarray:
    """Sums of block x block px; what is left over at the edges is paper."""
    rows, columns = (n // block for n in values.shape)
    if block == 1 or not rows or not columns:
        return values
    whole = values[: rows * block, : columns * block]
    # numpy's own sum takes six times as long on short axes
    across = sum(whole[k::block] for k in range(block))
    return sum(across[:, k::block] for k in range(block))


def _sums(values: np.ndarray, size: int) -> np.ndarray:
    """Of all squares of that size."""
    up = np.zeros((values.shape[0] + 1, values.shape[1] + 1))
    up[1:, 1:] = values.cumsum(axis=0, dtype=float).cumsum(axis=1)
    return up[size:, size:] - up[:-size, size:] - up[size:, :-size] + up[:-size, :-size]


def touching(wanted: list[Meant]) -> list[list[int]]:
    """Numbers of strokes whose wanted marks touch, directly or through others: the parts of letters. Those that stand
    alone are not named."""
    group = list(range(len(wanted)))

    def root(k: int) -> int:
        while group[k] != k:
            group[k] = group[group[k]]
            k = group[k]
        return k

    boxes = np.array([each.box_mm for each in wanted]).reshape(-1, 4)
    order = np.argsort(boxes[:, 0], kind="stable")
    lefts = boxes[order, 0]
    for at, i in enumerate(order.tolist()):
        last = np.searchsorted(lefts, boxes[i, 2], side="right")
        near = order[at + 1 : last]
        near = near[(boxes[near, 1] <= boxes[i, 3]) & (boxes[near, 3] >= boxes[i, 1])]
        for j in near.tolist():
            if root(i) != root(j) and _touch(wanted[i], wanted[j]):
                group[root(j)] = root(i)
    found: dict[int, list[int]] = {}
    for k in range(len(wanted)):
        found.setdefault(root(k), []).append(k)
    return [members for members in found.values() if len(members) > 1]


def _touch(a: Meant, b: Meant) -> bool:
    corner = np.maximum(a.box_mm[:2], b.box_mm[:2]) - BESIDE_MM
    size = np.minimum(a.box_mm[2:], b.box_mm[2:]) + BESIDE_MM - corner
    px = min(PX_PER_MM[0], float(np.sqrt(MOST_PX / size.prod())))
    window = (*corner.tolist(), *size.tolist())
    both = [wanted_pixels([_near(each, window)], window, px) for each in (a, b)]
    # side by side in one pixel is touching, too: the shares of a letter's outline meet at their borders
    return bool(((both[0] > 0) & (both[1] > 0) & (both[0] + both[1] > 0.8)).any())


def _near(each: Meant, window) -> Meant:
    """With the pieces alone that the window shows."""
    if not each.pieces:
        return each
    shown = _meet(each.piece_boxes_mm, window)
    return replace(each, pieces=[p for p, is_shown in zip(each.pieces, shown, strict=True) if is_shown])


def width_error(line: np.ndarray, seen: View) -> float | None:
    """Mean absolute difference [mm] of both marks' widths, measured across the middle line.

    line: (n, 4) rows x, y, arc length, half width. Places where the wanted mark is not as wide as the line
    says (its ends, where it crosses or touches itself) tell nothing of the brush's width and are left out.
    None when nothing is left.
    """
    length_mm = line[-1, 2]
    if length_mm <= 0:
        return None
    at_mm = (np.arange(max(1, round(length_mm / SPACING_MM))) + 0.5) * SPACING_MM
    at_mm = at_mm[at_mm < length_mm]
    xy = np.column_stack([np.interp(at_mm, line[:, 2], line[:, k]) for k in (0, 1)])
    segment = np.clip(np.searchsorted(line[:, 2], at_mm, side="right") - 1, 0, len(line) - 2)
    along = np.diff(line[:, :2], axis=0)[segment]
    lengths = np.hypot(along[:, 0], along[:, 1])
    half_mm = np.interp(at_mm, line[:, 2], line[:, 3])
    usable = (lengths > 0) & (half_mm > 0)
    if not usable.any():
        return None
    xy, half_mm, along = xy[usable], half_mm[usable], along[usable] / lengths[usable, None]
    reach_mm = 2.0 * float(half_mm.max()) + 4.0 / seen.px_per_mm
    wanted_mm = widths_across(xy, along, seen.wanted, seen, reach_mm)
    usable = np.abs(wanted_mm - 2 * half_mm) < 0.1 * half_mm + 0.05
    if not usable.any():
        return None
    painted_mm = widths_across(xy[usable], along[usable], seen.painted, seen, reach_mm)
    return float(np.abs(painted_mm - wanted_mm[usable]).mean())


def widths_across(xy, along, pixels: np.ndarray, seen: View, reach_mm: float) -> np.ndarray:
    """Width [mm] of what pixels show across each line: of the piece that holds the point, else of the nearest one that
    begins within reach_mm of it, else 0. xy, along (unit directions of the line): (n, 2)."""
    count = int(np.ceil(reach_mm * seen.px_per_mm))
    away_mm = np.arange(-count, count + 1) * (1.0 / seen.px_per_mm)
    x = xy[:, :1] - along[:, 1:] * away_mm
    y = xy[:, 1:] + along[:, :1] * away_mm
    values = _between(pixels, seen, x, y)
    inside = values > 0.5
    number = np.arange(2 * count + 1)
    apart = np.where(inside, np.abs(number - count), 4 * count)
    start = apart.argmin(axis=1)[:, None]
    there = np.take_along_axis(inside, start, axis=1)[:, 0]
    after = np.where(inside | (number <= start), 2 * count, number).min(axis=1)  # the first that is out again
    before = np.where(inside | (number >= start), 0, number).max(axis=1)
    rows = np.arange(len(xy))

    def edge(
        out, inner
    ):  # where the share passes one half, between a sample outside and its neighbour inside
        v_in, v_out = values[rows, inner], values[rows, out]
        return inner + (out - inner) * np.clip((v_in - 0.5) / np.maximum(v_in - v_out, 1e-9), 0.0, 1.0)

    high, low = edge(after, np.maximum(after - 1, 0)), edge(before, np.minimum(before + 1, 2 * count))
    return np.where(there, (high - low) / seen.px_per_mm, 0.0)


def _between(pixels: np.ndarray, seen: View, x_mm, y_mm) -> np.ndarray:
    """Shares at places between the middles of pixels, linear in both directions; 0 outside."""
    left, bottom, _, height = seen.window_mm
    column = (x_mm - left) * seen.px_per_mm - 0.5
    row = (bottom + height - y_mm) * seen.px_per_mm - 0.5
    within = (column >= 0) & (column < pixels.shape[1] - 1) & (row >= 0) & (row < pixels.shape[0] - 1)
    column, row = np.where(within, column, 0.0), np.where(within, row, 0.0)
    c, r = column.astype(np.intp), row.astype(np.intp)
    fc, fr = column - c, row - r
    flat = pixels.ravel()
    i = r * pixels.shape[1] + c
    upper = flat[i] * (1 - fc) + flat[np.minimum(i + 1, flat.size - 1)] * fc
    i = np.minimum(i + pixels.shape[1], flat.size - 2)
    lower = flat[i] * (1 - fc) + flat[i + 1] * fc
    return np.where(within, upper * (1 - fr) + lower * fr, 0.0)
