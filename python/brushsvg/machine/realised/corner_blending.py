"""Corner blending: a machine cuts corners instead of stopping there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..cells.cell import Blending

MAX_BLEND_TURN_RAD = np.radians(100.0)  # a robot that blends cannot reverse, and stops at sharper corners
MAX_VERTICAL_SIDEWAYS_MM = 1e-6  # largest sideways part of a vertical step
MIN_CUT_MM = 1e-4  # corners that are cut by less stay unchanged


@dataclass(frozen=True)
class _MoveGeometry:
    """Geometry of the moves between n poses.

    leaving, reaching: (n - 1, 3) unit directions in which each move leaves one pose and reaches the next.
    lengths: (n - 1,) length of each move [mm].
    bends: (n - 1,) signed curvature of each move, turn / radius [1/mm]; 0 for a straight move.
    """

    leaving: np.ndarray
    reaching: np.ndarray
    lengths: np.ndarray
    bends: np.ndarray


def _move_geometry(poses_mm: np.ndarray, arcs) -> _MoveGeometry:
    steps = np.diff(poses_mm, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    along = np.divide(steps, lengths[:, None], out=np.zeros_like(steps), where=lengths[:, None] > 0)
    bends = np.zeros(len(steps))
    if not len(arcs):
        return _MoveGeometry(along, along, lengths, bends)
    on = np.concatenate([np.arange(arc.first, arc.last) for arc in arcs])
    counts = [arc.last - arc.first for arc in arcs]
    centres = np.repeat([arc.centre_mm for arc in arcs], counts, axis=0)
    turns = np.repeat([arc.direction for arc in arcs], counts)
    leaving, reaching = along, along.copy()
    for directions, poses in ((leaving, poses_mm[on]), (reaching, poses_mm[on + 1])):
        spokes = poses[:, :2] - centres
        radii = np.linalg.norm(spokes, axis=1)
        directions[on, :2] = (turns / radii)[:, None] * np.column_stack([-spokes[:, 1], spokes[:, 0]])
    bends[on] = turns / radii
    lengths[on] = 2 * radii * np.arcsin(np.clip(lengths[on] / (2 * radii), 0, 1))
    return _MoveGeometry(leaving, reaching, lengths, bends)


def _corner_angles(moves: _MoveGeometry) -> np.ndarray:
    """Return the angles [rad] between the moves that meet at each pose, (n,). They are 0 at the ends."""
    before, after = moves.reaching[:-1], moves.leaving[1:]
    # atan2 of the half angle is exact both for straight on and for straight back
    across, along = np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1)
    return np.concatenate([[0.0], 2 * np.arctan2(across, along), [0.0]])[: len(moves.lengths) + 1]


def blend_radii(poses_mm: np.ndarray, blending: Blending, arcs=()) -> np.ndarray:
    """Return how far [mm] from each pose the path may leave its moves, (n,).

    The distance holds before and after the pose. A circle that touches both moves at distance R passes the corner at R
    tan(angle / 4), which must be at most the tolerance. Blends never meet. Robots stop where they turn back, where the
    brush is pressed on the spot, and at the ends of circles. The distance is 0 there.
    """
    return blend_radii_and_angles(poses_mm, blending, arcs)[0]


def blend_radii_and_angles(poses_mm: np.ndarray, blending: Blending, arcs=()) -> tuple[np.ndarray, np.ndarray]:
    """Return the results of blend_radii, and the angle [rad] between the moves at each pose, (n,)."""
    radii = np.zeros(len(poses_mm))
    moves = _move_geometry(poses_mm, arcs)
    all_turns = _corner_angles(moves)
    if len(poses_mm) < 3 or not blending.tolerance_mm:
        return radii, all_turns
    turns = all_turns[1:-1]
    quarter = np.tan(turns / 4)
    max_radii = np.divide(blending.tolerance_mm, quarter, out=np.full_like(quarter, np.inf), where=quarter > 0)
    if len(arcs):  # on a circle, only as far as its tangent is close enough
        bends = np.abs(moves.bends)
        curvature = np.maximum(bends[:-1], bends[1:])
        max_squared_radii = np.divide(
            blending.tolerance_mm, curvature, out=np.full_like(curvature, np.inf), where=curvature > 0
        )
        max_radii = np.minimum(max_radii, np.sqrt(max_squared_radii))
    radii[1:-1] = np.minimum(0.45 * np.minimum(moves.lengths[:-1], moves.lengths[1:]), max_radii)
    if blending.radius_mm:
        still = find_vertical_steps(np.diff(poses_mm, axis=0)) | (moves.bends != 0)
        radii[1:-1][(turns > MAX_BLEND_TURN_RAD) | still[:-1] | still[1:]] = 0.0
        radii = np.minimum(radii, blending.radius_mm)
    return radii, all_turns


def find_vertical_steps(steps_mm: np.ndarray, sideways_mm: float = MAX_VERTICAL_SIDEWAYS_MM) -> np.ndarray:
    """Return which steps (n, 3) [mm] go straight up or down, (n,).

    sideways_mm: a vertical step is less than this sideways and more than this up or down.
    """
    sideways = np.abs(steps_mm[:, :2]).max(axis=1, initial=0.0)
    return (sideways < sideways_mm) & (np.abs(steps_mm[:, 2]) > sideways_mm)


def cut_corners(poses_mm: np.ndarray, radii_mm: np.ndarray, arcs=()) -> tuple[np.ndarray, ...]:
    """Cut the corners of a path.

    Each cut corner is replaced by three points of the touching circle.

    Returns the path (m, 3), the poses to which its points belong as fractional indices (m,), and the first and last
    point of each pose (n, 2).
    """
    indices = np.arange(len(poses_mm))
    unchanged = poses_mm, indices.astype(float), np.column_stack([indices, indices])
    if len(poses_mm) < 3:
        return unchanged
    moves = _move_geometry(poses_mm, arcs)
    cut_mm = radii_mm * np.tan(_corner_angles(moves) / 4)
    still = moves.lengths == 0  # a program that was edited by hand may have such moves
    cut_mm[:-1][still] = cut_mm[1:][still] = 0.0
    corners = np.flatnonzero(cut_mm > MIN_CUT_MM)
    if not len(corners):
        return unchanged
    radii, corner_poses = radii_mm[corners], poses_mm[corners]
    before, after = moves.reaching[corners - 1], moves.leaving[corners]
    middle = after - before
    size = np.linalg.norm(middle, axis=1, keepdims=True)
    middle = np.divide(middle, size, out=-before, where=size > 1e-12)
    counts = np.ones(len(poses_mm), dtype=int)
    counts[corners] = 3
    path, pose_indices = np.repeat(poses_mm, counts, axis=0), np.repeat(unchanged[1], counts)
    last_points = np.cumsum(counts) - 1
    first_points = last_points - counts + 1
    path[first_points[corners]] += _travel_along(before, -radii, moves.bends[corners - 1])
    path[first_points[corners] + 1] = corner_poses + cut_mm[corners, None] * middle
    path[last_points[corners]] += _travel_along(after, radii, moves.bends[corners])
    pose_indices[first_points[corners]] -= radii / moves.lengths[corners - 1]
    pose_indices[last_points[corners]] += radii / moves.lengths[corners]
    return path, pose_indices, np.column_stack([first_points, last_points])


def _travel_along(along: np.ndarray, length_mm: np.ndarray, bends: np.ndarray) -> np.ndarray:
    """Return the displacement (k, 3) after a length on lines and circles.

    A negative length goes backwards.

    along: (k, 3) directions in which they begin.
    """
    half = length_mm * bends / 2
    chord = (length_mm * np.sinc(half / np.pi))[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(along))])
    return chord * (np.cos(half)[:, None] * along + np.sin(half)[:, None] * across)
