"""Arcs with more poses on them: for who runs, or draws, the chords from pose to pose."""

from __future__ import annotations

from itertools import pairwise
from math import acos, atan2, ceil, cos, hypot, inf, pi, sin

import numpy as np

from ... import _core
from .retimed import on_way

# a chord turns by no more, and is no further from its circle: what the mark's edge shows of a polygon is less
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


def cut_at_extremes(a_pass: _core.Pass, turned_rad: float) -> _core.Pass:
    """The same pass, its arcs cut where they turn back in x or y of a frame in which the paper is turned so far: on
    each of them both axes of a machine go one way."""
    if not len(a_pass.arcs):
        return a_pass
    poses = np.asarray(a_pass.poses_mm)
    more, cuts = {}, {}
    for number, arc in enumerate(a_pass.arcs):
        cuts[number], last = [], inf
        for row in range(arc.first, arc.last):
            places = [poses[row], *_extremes(arc, poses[row], poses[row + 1], turned_rad)]
            more[row] = np.array(places[1:]).reshape(-1, 3)
            quarter = _extreme(arc, poses[row], turned_rad)
            is_cut = arc.first < row and quarter not in (None, last)
            last = quarter if quarter is not None else last
            cuts[number] += [(row, 0)] * is_cut + [(row, k) for k in range(1, len(places))]
    counts = [1 + len(more.get(row, ())) for row in range(len(poses))]
    at = np.concatenate([[0], np.cumsum(counts)]).tolist()
    dense = np.vstack([np.vstack([pose[None], more.get(row, poses[:0])]) for row, pose in enumerate(poses)])
    arcs = []
    for number, arc in enumerate(a_pass.arcs):
        ends = [at[arc.first], *(at[row] + k for row, k in cuts[number]), at[arc.last]]
        arcs += [_core.Arc(first, last, arc.centre_mm, arc.direction) for first, last in pairwise(ends)]
    return on_way(a_pass, dense, arcs)


OVER_MM = 1e-4  # by which an arc may go beyond where it turns back: no machine shows it, and no tiny arc is left behind


def _quarters(arc, pose: np.ndarray, turned_rad: float) -> float:
    """The angle of a pose on its circle, in quarters of a turn."""
    x, y = pose[:2] - arc.centre_mm
    return (atan2(y, x) + turned_rad) / (pi / 2)


def _near_quarters(arc, pose: np.ndarray) -> float:
    """How far from where it turns back a circle has gone beyond it by OVER_MM, in quarters of a turn."""
    return min(0.5, acos(max(0.0, 1 - OVER_MM / hypot(*(pose[:2] - arc.centre_mm)))) / (pi / 2))


def _extreme(arc, pose: np.ndarray, turned_rad: float) -> int | None:
    """Where a pose is one at which its circle turns back, in quarters of a turn."""
    quarters = _quarters(arc, pose, turned_rad)
    return round(quarters) % 4 if abs(quarters - round(quarters)) < _near_quarters(arc, pose) else None


def _extremes(arc, begin: np.ndarray, end: np.ndarray, turned_rad: float) -> list[np.ndarray]:
    """Places between two poses of a circle where it turns back in x or y."""
    first, last = (_quarters(arc, pose, turned_rad) for pose in (begin, end))
    sweep, near = (last - first) * arc.direction % 4, _near_quarters(arc, begin)
    if sweep > 2.0:  # poses of a circle are less than half a turn apart: rounding turned it back
        return []
    radius = hypot(*(begin[:2] - arc.centre_mm))
    begins = first * arc.direction
    whole = range(ceil(begins + near), ceil(begins + sweep - near))
    angles = [quarter * arc.direction * pi / 2 - turned_rad for quarter in whole]
    return [np.array([*(arc.centre_mm + radius * np.array([cos(a), sin(a)])), begin[2]]) for a in angles]


def _rows(poses: np.ndarray, arcs) -> list[np.ndarray]:
    """For each pose it and those up to the next one."""
    more = {row: points for arc in arcs for row, points in _between(arc, poses)}
    return [np.vstack([pose[None], more.get(row, poses[:0])]) for row, pose in enumerate(poses)]


def _between(arc, poses: np.ndarray):
    """Return the poses to add after each pose of an arc, with its row."""
    for row, next_row in pairwise(range(arc.first, arc.last + 1)):
        a, b = (poses[k, :2] - arc.centre_mm for k in (row, next_row))
        turn = atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))
        radius = hypot(*a)
        least = min(TURN_RAD, 2 * acos(max(0.0, 1 - OFF_MM / radius)))
        angles = turn * np.arange(1, n := ceil(abs(turn) / least)) / n
        cos, sin = np.cos(angles), np.sin(angles)
        points = np.column_stack([a[0] * cos - a[1] * sin, a[0] * sin + a[1] * cos]) + arc.centre_mm
        yield row, np.column_stack([points, np.full(len(points), poses[row, 2])])
