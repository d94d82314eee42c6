"""The order in which strokes are painted: by the setting `order`, then as drawn or nearest first (--order nearest)."""

from __future__ import annotations

import itertools
from collections.abc import Iterable

import numpy as np


def sort_by_order(strokes: Iterable) -> list:
    """Return strokes sorted by their setting `order`, smaller first.

    Strokes of the same order stay in the order of the drawing.
    """
    return sorted(strokes, key=_order_of)


def _order_of(stroke) -> int:
    """Return the setting `order` of a stroke or pass, 0 without one."""
    return stroke.settings.order or 0


def list_nearest_first(passes) -> list[int]:
    """Return the numbers of the passes, each followed by the one that starts nearest.

    Only passes of one colour that follow each other in one layer change places, and none is painted backwards. The
    loads of one stroke stay together.
    """
    return [int(k) for group in _group_sortable(passes) for k in _order_nearest(passes, group)]


def _group_sortable(passes) -> list[list[int]]:
    """Return the numbers of consecutive passes with the same layer, `order` and colour.

    Each change of colour needs another brush or a wash, and where colours cross, the later one is on top.
    """
    keys = [(a_pass.layer, _order_of(a_pass), a_pass.colour) for a_pass in passes]
    numbers = range(len(passes))
    return [list(group) for _, group in itertools.groupby(numbers, key=keys.__getitem__)]


def _order_nearest(passes, group: list[int]) -> list[int]:
    strokes: list[list[int]] = []
    for k in group:
        if strokes and passes[k].load > 1:
            strokes[-1].append(k)
        else:
            strokes.append([k])
    starts = np.array([passes[stroke[0]].poses_mm[0, :2] for stroke in strokes])
    ends = np.array([passes[stroke[-1]].poses_mm[-1, :2] for stroke in strokes])
    order, here = [0], ends[0]  # the first stroke remains the first
    left = np.arange(1, len(strokes))
    while len(left):
        next_ = int(np.linalg.norm(starts[left] - here, axis=1).argmin())
        order.append(int(left[next_]))
        here = ends[left[next_]]
        left = np.delete(left, next_)
    return [k for number in order for k in strokes[number]]
