"""Painted and wanted marks laid over each other as shares of pixels: what they have in common, and who touches whom.

Pixels and not rings: the union of a page's rings takes a minute, its pixels two seconds, and overlaps agree to 1e-3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from . import _core

PX_PER_MM = 8.0
MOST_PX = 4e6  # of one picture: bounds the memory
TILE_PX = 1000
MOST_TILES_PX = 6e7  # of all the tiles of a sheet: bounds the time
OUTLINE_MM = 0.01
BESIDE_MM = 0.3  # round a box: what lies on its edge is seen whole


@dataclass(frozen=True)
class Meant:
    """A stroke as it was drawn: its outline where it has one (rings), else convex pieces of its path with its width;
    boxes: left, bottom, right, top, of the pieces and of all."""

    stroke: object
    rings: list
    pieces: list
    piece_boxes_mm: np.ndarray
    box_mm: np.ndarray


def meant(stroke) -> Meant:
    rings = list(stroke.wanted_mm)
    pieces = [] if rings else _core.wanted_pieces(stroke, OUTLINE_MM)
    parts = rings or pieces or [np.asarray(stroke.middle_mm).reshape(-1, 2)]
    points, starts = np.vstack(parts), np.cumsum([0, *map(len, parts)])[:-1]
    boxes = np.hstack([np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)])
    return Meant(stroke, rings, pieces, boxes, joint(boxes))


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


def areas_of_sheet(traces, wanted: list[Meant], brush):
    """What all paint and all that was drawn have in common, whatever the size of the sheet: a CommonArea, tile by tile
    where it takes several."""
    boxes = np.array([box_of_paint(trace, brush) for trace in traces]).reshape(-1, 4)
    drawn = np.array([each.box_mm for each in wanted]).reshape(-1, 4)
    left, bottom, right, top = joint([*boxes, *drawn])
    width, height = max(right - left, 1e-3), max(top - bottom, 1e-3)
    px = min(PX_PER_MM, float(np.sqrt(MOST_TILES_PX / (width * height))))
    if width * height * PX_PER_MM**2 < MOST_PX:
        return _core.common_area(list(traces), [each.stroke for each in wanted], brush)
    side = TILE_PX / px
    total = np.zeros(2)
    for x in np.arange(left, right, side):
        for y in np.arange(bottom, top, side):
            window = (float(x), float(y), side, side)
            here = [t for t, at in zip(traces, _meet(boxes, window), strict=True) if at]
            there = [w for w, at in zip(wanted, _meet(drawn, window), strict=True) if at]
            if here or there:
                painted, drawn_ = painted_pixels(here, brush, window, px), wanted_pixels(there, window, px)
                total += [pick(drawn_, painted).sum(dtype=float) for pick in (np.minimum, np.maximum)]
    return _core.CommonArea(*(total / px**2).tolist())


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
    px = min(PX_PER_MM, float(np.sqrt(MOST_PX / size.prod())))
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
