"""Arcs with more poses on them: for who runs, or draws, the chords from pose to pose."""

from __future__ import annotations

from itertools import pairwise
from math import acos, atan2, ceil, hypot

import numpy as np

from .. import _core
from .pass_way import on_way

# a chord turns by no more, and lies no farther from its circle: what the mark's edge shows of a polygon is less
TURN_RAD = 0.12
OFF_MM = 0.01


def chords(poses: np.ndarray, arcs) -> np.ndarray:
    """Poses (n, 3) with more of them on the arcs."""
    return np.vstack(_rows(poses, arcs))


def with_chords(a_pass: _core.Pass) -> _core.Pass:
    """The same pass, with poses so close on its arcs that their chords do as well."""
    if not len(a_pass.arcs):
        return a_pass
    return on_way(a_pass, *with_chords_on(np.asarray(a_pass.poses_mm), a_pass.arcs, a_pass.arcs))


def with_chords_on(poses: np.ndarray, dense, arcs) -> tuple[np.ndarray, list]:
    """Poses (n, 3) with more of them on the arcs `dense`; and `arcs`, which begin and end where they did."""
    if not dense:
        return poses, list(arcs)
    rows = _rows(poses, dense)
    at = np.concatenate([[0], np.cumsum([len(each) for each in rows])]).tolist()
    moved = [_core.Arc(at[arc.first], at[arc.last], arc.centre_mm, arc.direction) for arc in arcs]
    return np.vstack(rows), moved


def _rows(poses: np.ndarray, arcs) -> list[np.ndarray]:
    """For each pose it and those up to the next one."""
    more = {row: points for arc in arcs for row, points in _between(arc, poses)}
    return [np.vstack([pose[None], more.get(row, poses[:0])]) for row, pose in enumerate(poses)]


def _between(arc, poses: np.ndarray):
    """Poses that are wanted after each pose of an arc, with its row."""
    for row, next_row in pairwise(range(arc.first, arc.last + 1)):
        a, b = (poses[k, :2] - arc.centre_mm for k in (row, next_row))
        turn = atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))
        radius = hypot(*a)
        least = min(TURN_RAD, 2 * acos(max(0.0, 1 - OFF_MM / radius)))
        angles = turn * np.arange(1, n := ceil(abs(turn) / least)) / n
        cos, sin = np.cos(angles), np.sin(angles)
        points = np.column_stack([a[0] * cos - a[1] * sin, a[0] * sin + a[1] * cos]) + arc.centre_mm
        yield row, np.column_stack([points, np.full(len(points), poses[row, 2])])
