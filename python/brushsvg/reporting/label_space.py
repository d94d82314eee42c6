"""Find places for labels in a picture: they cover no marks and no other labels, and stay inside."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LABEL_GAP = 0.3  # between an anchor and its label, in label heights
# Distances from the anchor, in label heights. Within each distance, longer texts are tried first.
SEARCH_RINGS = (1.0, 2.0, 4.0, 8.0, 16.0)
DIRECTIONS = 16  # around an anchor
LEADER_SAMPLES = 16  # places along a leader that must not be on other labels
CHUNK = 64  # boxes whose leaders are compared at a time
LABEL_WEIGHT = 1e3  # cost of an area on other labels, relative to an area on marks
UP_RIGHT = (1.0, -1.0)


@dataclass(frozen=True)
class PlacedLabel:
    """The box of a label, in the units of the picture, y down.

    choice: index of the chosen size; leader: a line from the anchor to the box, None next to the anchor; is_free: the
    label covers neither marks nor other labels, and its leader crosses no label; covers_labels: it covers other labels.
    """

    left: float
    top: float
    width: float
    height: float
    choice: int
    leader: tuple[tuple[float, float], tuple[float, float]] | None
    is_free: bool
    covers_labels: bool

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Return left, top, right, bottom."""
        return self.left, self.top, self.left + self.width, self.top + self.height


class LabelSpace:
    """The free space for labels in one picture.

    marks: (rows, columns) of booleans, true where labels would cover something; cell: side of one element of marks in
    the units of the picture, pixels or millimetres; bounds: left, top, right, bottom that labels stay within, by
    default all of marks; anchors: (n, 2) places that labels keep free, with a disc of radius around them.
    """

    def __init__(self, marks: np.ndarray, cell: float = 1.0, bounds=None, anchors: Sequence = (), radius: float = 0.0):
        rows, columns = marks.shape
        self.cell, self.radius = cell, radius
        self.bounds = np.array(bounds if bounds is not None else (0, 0, columns * cell, rows * cell), float)
        self._sums = np.zeros((rows + 1, columns + 1), np.int64)
        self._sums[1:, 1:] = np.asarray(marks, bool).cumsum(axis=0, dtype=np.int32).cumsum(axis=1)
        self._anchors = np.array(anchors, float).reshape(-1, 2)
        self._boxes, self._leaders = np.zeros((0, 4)), np.zeros((0, 2))

    def place(
        self, anchor, sizes, towards=UP_RIGHT, reach: float = math.inf, may_cover: bool = True
    ) -> PlacedLabel | None:
        """Place one label at the first free candidate, else where it covers least.

        anchor: (x, y); sizes: (width, height) of the texts to choose from, the best first, although a short text near
        the anchor is preferred to a longer one far from it; towards: direction of the first candidate; reach: largest
        distance of the label from its anchor; may_cover: place it even where it covers other labels, else return None.
        """
        anchor = np.asarray(anchor, float)
        best = None
        for limit in dict.fromkeys(min(reach, times * sizes[0][1]) for times in (*SEARCH_RINGS, math.inf)):
            for choice, size in enumerate(sizes):
                boxes = self._candidates(anchor, np.asarray(size, float), towards, limit)
                cost, first, on_labels = self._find_cheapest(boxes, anchor, math.inf if best is None else best[0])
                if best is None or cost < best[0]:
                    best = cost, boxes[first], choice, on_labels
                if cost == 0:
                    break
            if best[0] == 0:
                break
        cost, box, choice, on_labels = best
        if on_labels > 0 and not may_cover:
            return None
        left, top, right, bottom = box.tolist()
        leader = self._leader(anchor, box)
        self._boxes = np.vstack([self._boxes, box])
        if leader:
            along = np.linspace(*leader, LEADER_SAMPLES)
            self._leaders = np.vstack([self._leaders, along])
        return PlacedLabel(left, top, right - left, bottom - top, choice, leader, cost == 0, on_labels > 0)

    def _candidates(self, anchor, size, towards, reach: float) -> np.ndarray:
        """Return boxes (n, 4) around the anchor, in rings of growing distance. The boxes are moved into the picture."""
        low, high = self.bounds[:2], self.bounds[2:]
        farthest = min(reach, float(np.hypot(*(high - low))))
        nearest = self.radius + LABEL_GAP * size[1]
        away = nearest + np.arange(0.0, max(farthest - nearest, 0.0) + 1e-9, size[1] / 2)
        turns = 2 * np.pi / DIRECTIONS * np.array([(k + 1) // 2 * (-1) ** k for k in range(DIRECTIONS)])
        angles = math.atan2(towards[1], towards[0]) + turns
        aim = np.column_stack([np.cos(angles), np.sin(angles)])
        # On a square, so that boxes in all directions are equally far.
        aim /= np.abs(aim).max(axis=1, keepdims=True)
        middles = anchor + aim * size / 2 + (aim / np.hypot(*aim.T)[:, None]) * away[:, None, None]
        corners = middles.reshape(-1, 2) - size / 2
        corners = np.clip(corners, low, np.maximum(high - size, low))
        return np.hstack([corners, corners + size])

    def _find_cheapest(self, boxes: np.ndarray, anchor, limit: float) -> tuple[float, int, float]:
        """Return the least cost of what a box covers, the first box with it, and its area on other labels.

        The cost is 0 for a free box. Crossings of leaders take long to find, so they are looked for only at boxes that
        can still cost less than `limit` and than all others. If there are none, the cost is infinite.
        """
        low = np.minimum(boxes[:, :2].min(axis=0), anchor) - self.radius
        high = np.maximum(boxes[:, 2:].max(axis=0), anchor) + self.radius
        taken = self._boxes[((self._boxes[:, 2:] > low) & (self._boxes[:, :2] < high)).all(axis=1)]
        crossed = self._leaders[((self._leaders > low) & (self._leaders < high)).all(axis=1)]
        near = self._anchors[((self._anchors >= low) & (self._anchors <= high)).all(axis=1)]
        rows, columns = np.array(self._sums.shape) - 1
        left, top = np.floor(boxes[:, :2] / self.cell + 1e-9).astype(int).clip(0, (columns, rows)).T
        right, bottom = np.ceil(boxes[:, 2:] / self.cell - 1e-9).astype(int).clip(0, (columns, rows)).T
        sums = self._sums
        marks = sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left]
        width = np.minimum(boxes[:, None, 2], taken[:, 2]) - np.maximum(boxes[:, None, 0], taken[:, 0])
        height = np.minimum(boxes[:, None, 3], taken[:, 3]) - np.maximum(boxes[:, None, 1], taken[:, 1])
        labels = (np.maximum(width, 0) * np.maximum(height, 0)).sum(axis=1)
        anchors = np.vstack([near, anchor])
        nearest = np.clip(anchors, boxes[:, None, :2], boxes[:, None, 2:])
        covered = (np.hypot(*np.moveaxis(nearest - anchors, -1, 0)) <= self.radius).sum(axis=1)
        areas = (boxes[:, 2:] - boxes[:, :2]).prod(axis=1)
        covered_areas = marks * self.cell**2 + LABEL_WEIGHT * labels
        least = covered_areas + covered * areas
        best, first = math.inf, 0
        for some in np.split(order := np.argsort(least, kind="stable"), range(CHUNK, len(order), CHUNK)):
            if best == 0 or least[some[0]] > best or least[some[0]] >= limit:
                break
            crossings = _are_points_inside(crossed, boxes[some]).any(axis=0).astype(int)
            ends = np.clip(anchor, boxes[some, :2], boxes[some, 2:])
            leaders = np.linspace(np.broadcast_to(anchor, ends.shape), ends, LEADER_SAMPLES)
            crossings += _are_points_inside(leaders[:, :, None], taken).any(axis=(0, 2))
            cost = covered_areas[some] + (covered[some] + crossings) * areas[some]
            best, first = min((best, first), *zip(cost.tolist(), some.tolist(), strict=True))
        return best, first, float(labels[first])

    def _leader(self, anchor, box):
        """Return a line from an anchor to its label, None where they are close."""
        end = np.clip(anchor, box[:2], box[2:])
        away = float(np.hypot(*(end - anchor)))
        if away <= self.radius + 2 * LABEL_GAP * (box[3] - box[1]):
            return None
        start = anchor + (end - anchor) * self.radius / away
        return tuple(start.tolist()), tuple(end.tolist())


def _are_points_inside(points, boxes) -> np.ndarray:
    """Return which points (..., 2) are inside which boxes (n, 4), as (..., n)."""
    x, y = (points[..., None, k] if points.ndim == 2 else points[..., k] for k in range(2))
    return (x > boxes[:, 0]) & (x < boxes[:, 2]) & (y > boxes[:, 1]) & (y < boxes[:, 3])
