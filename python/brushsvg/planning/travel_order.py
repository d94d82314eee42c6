"""Passes in the order of the shortest way from the end of one to the start of the next."""

from __future__ import annotations

import itertools

import numpy as np


def nearest_first(passes) -> list[int]:
    """Numbers of the passes in the order of the shortest way from the end of one to the start of the next.

    Only passes that follow each other in one layer change places; none is painted backwards.
    """
    return [int(k) for group in _groups(passes) for k in _nearest(passes, group)]


def _groups(passes) -> list[list[int]]:
    """Numbers of passes that follow each other in one layer with the same wish for an order."""
    wishes = [(a_pass.layer, a_pass.settings.order or 0) for a_pass in passes]
    numbers = range(len(passes))
    return [list(group) for _, group in itertools.groupby(numbers, key=wishes.__getitem__)]


def _nearest(passes, group: list[int]) -> list[int]:
    starts = np.array([passes[k].poses_mm[0, :2] for k in group])
    ends = np.array([passes[k].poses_mm[-1, :2] for k in group])
    order, here = [0], ends[0]  # the first stays the first
    left = np.arange(1, len(group))
    while len(left):
        next_ = int(np.linalg.norm(starts[left] - here, axis=1).argmin())
        order.append(int(left[next_]))
        here = ends[left[next_]]
        left = np.delete(left, next_)
    return [group[k] for k in order]
