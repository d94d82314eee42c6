"""Add poses on arcs, so that chords from pose to pose can stand for the arcs."""

from __future__ import annotations

from itertools import pairwise
from math import acos, atan2, ceil, cos, hypot, inf, pi, sin

import numpy as np

from ... import _core
from .pass_on_path import move_pass_to_path

# Largest turn of a chord and its largest distance from the circle. The mark's edge shows less of the polygon than that.
MAX_CHORD_TURN_RAD = 0.12
OFF_MM = 0.01


def points_with_chords(poses: np.ndarray, arcs) -> np.ndarray:
    """Return poses (n, 3) with more poses on the arcs."""
    return np.vstack(_dense_rows(poses, arcs))


def with_chords(a_pass: _core.Pass) -> _core.Pass:
    """Return a pass with poses so dense on its arcs that chords can replace the arcs."""
    if not len(a_pass.arcs):
        return a_pass
    return move_pass_to_path(a_pass, *add_chords(np.asarray(a_pass.poses_mm), a_pass.arcs, a_pass.arcs))


def add_chords(poses: np.ndarray, dense, arcs) -> tuple[np.ndarray, list]:
    """Add poses to poses (n, 3) on the arcs `dense`.

    Returns the poses, and `arcs` with the new numbers of their first and last poses.
    """
    if not dense:
        return poses, list(arcs)
    rows = _dense_rows(poses, dense)
    new_rows = np.concatenate([[0], np.cumsum([len(points) for points in rows])]).tolist()
    moved_arcs = [_core.Arc(new_rows[arc.first], new_rows[arc.last], arc.centre_mm, arc.direction) for arc in arcs]
    return np.vstack(rows), moved_arcs


def split_arcs_at_extremes(a_pass: _core.Pass, turned_rad: float) -> _core.Pass:
    """Split the arcs of a pass where they turn back in x or y of the machine.

    On each part, both axes of the machine keep their directions.

    turned_rad: angle by which the paper is turned in the machine's frame.
    """
    if not len(a_pass.arcs):
        return a_pass
    poses = np.asarray(a_pass.poses_mm)
    extremes_after, cuts = {}, {}
    for number, arc in enumerate(a_pass.arcs):
        cuts[number], last_quarter = [], inf
        for row in range(arc.first, arc.last):
            places = [poses[row], *_extremes_between(arc, poses[row], poses[row + 1], turned_rad)]
            extremes_after[row] = np.array(places[1:]).reshape(-1, 3)
            quarter = _extreme_at_pose(arc, poses[row], turned_rad)
            is_cut = arc.first < row and quarter not in (None, last_quarter)
            last_quarter = quarter if quarter is not None else last_quarter
            cuts[number] += [(row, 0)] * is_cut + [(row, k) for k in range(1, len(places))]
    counts = [1 + len(extremes_after.get(row, ())) for row in range(len(poses))]
    new_rows = np.concatenate([[0], np.cumsum(counts)]).tolist()
    dense = np.vstack([np.vstack([pose[None], extremes_after.get(row, poses[:0])]) for row, pose in enumerate(poses)])
    arcs = []
    for number, arc in enumerate(a_pass.arcs):
        ends = [new_rows[arc.first], *(new_rows[row] + k for row, k in cuts[number]), new_rows[arc.last]]
        arcs += [_core.Arc(first, last_quarter, arc.centre_mm, arc.direction) for first, last_quarter in pairwise(ends)]
    return move_pass_to_path(a_pass, dense, arcs)


# Largest distance that an arc may go beyond its turning point. It is not visible, and it avoids tiny arcs.
OVER_MM = 1e-4


def _angle_in_quarters(arc, pose: np.ndarray, turned_rad: float) -> float:
    """Return the angle of a pose on its circle, in quarters of a turn."""
    x, y = pose[:2] - arc.centre_mm
    return (atan2(y, x) + turned_rad) / (pi / 2)


def _overshoot_in_quarters(arc, pose: np.ndarray) -> float:
    """Return the angle of an overshoot of OVER_MM, in quarters of a turn.

    The circle has then gone OVER_MM beyond its turning point.
    """
    return min(0.5, acos(max(0.0, 1 - OVER_MM / hypot(*(pose[:2] - arc.centre_mm)))) / (pi / 2))


def _extreme_at_pose(arc, pose: np.ndarray, turned_rad: float) -> int | None:
    """Return the quarter at which a circle turns back at a pose, else None."""
    quarters = _angle_in_quarters(arc, pose, turned_rad)
    return round(quarters) % 4 if abs(quarters - round(quarters)) < _overshoot_in_quarters(arc, pose) else None


def _extremes_between(arc, begin: np.ndarray, end: np.ndarray, turned_rad: float) -> list[np.ndarray]:
    """Return the places between two poses of a circle where it turns back in x or y."""
    first, last = (_angle_in_quarters(arc, pose, turned_rad) for pose in (begin, end))
    sweep, margin = (last - first) * arc.direction % 4, _overshoot_in_quarters(arc, begin)
    if sweep > 2.0:  # poses of a circle are less than half a turn apart, so rounding has reversed the circle
        return []
    radius = hypot(*(begin[:2] - arc.centre_mm))
    begins = first * arc.direction
    quarters = range(ceil(begins + margin), ceil(begins + sweep - margin))
    angles = [quarter * arc.direction * pi / 2 - turned_rad for quarter in quarters]
    return [np.array([*(arc.centre_mm + radius * np.array([cos(a), sin(a)])), begin[2]]) for a in angles]


def _dense_rows(poses: np.ndarray, arcs) -> list[np.ndarray]:
    """Return for each pose the pose itself and the added poses before the next one."""
    points_after = {row: points for arc in arcs for row, points in _points_between(arc, poses)}
    return [np.vstack([pose[None], points_after.get(row, poses[:0])]) for row, pose in enumerate(poses)]


def _points_between(arc, poses: np.ndarray):
    """Yield the row of each pose of an arc, and the poses to add after it."""
    for row, next_row in pairwise(range(arc.first, arc.last + 1)):
        a, b = (poses[k, :2] - arc.centre_mm for k in (row, next_row))
        turn = atan2(a[0] * b[1] - a[1] * b[0], float(a @ b))
        radius = hypot(*a)
        max_turn_rad = min(MAX_CHORD_TURN_RAD, 2 * acos(max(0.0, 1 - OFF_MM / radius)))
        angles = turn * np.arange(1, n := ceil(abs(turn) / max_turn_rad)) / n
        cos, sin = np.cos(angles), np.sin(angles)
        points = np.column_stack([a[0] * cos - a[1] * sin, a[0] * sin + a[1] * cos]) + arc.centre_mm
        yield row, np.column_stack([points, np.full(len(points), poses[row, 2])])
