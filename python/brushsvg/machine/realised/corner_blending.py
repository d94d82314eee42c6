"""What a machine makes of the joint of two moves: it cuts the corner, so as not to stand still there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..cells.cell import Blending

SHARP_RAD = np.radians(100.0)  # a robot that blends cannot reverse: here it stops
ON_THE_SPOT_MM = 1e-6
SEEN_MM = 1e-4  # corners that are cut by less are left as they are


@dataclass(frozen=True)
class _Moves:
    """The moves between n poses: unit directions (n - 1, 3) in which each move leaves one and reaches the next, how
    long it is (n - 1,) [mm], and how it bends: the turn of its circle over the radius [1/mm], 0 for a straight one."""

    leaving: np.ndarray
    reaching: np.ndarray
    lengths: np.ndarray
    bends: np.ndarray


def _moves(poses_mm: np.ndarray, arcs) -> _Moves:
    steps = np.diff(poses_mm, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    along = np.divide(steps, lengths[:, None], out=np.zeros_like(steps), where=lengths[:, None] > 0)
    bends = np.zeros(len(steps))
    if not len(arcs):
        return _Moves(along, along, lengths, bends)
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
    return _Moves(leaving, reaching, lengths, bends)


def turns_rad(poses_mm: np.ndarray, arcs=()) -> np.ndarray:
    """(n,) angle between the moves that meet at each pose, 0 at the ends."""
    return _turns(_moves(poses_mm, arcs))


def _turns(moves: _Moves) -> np.ndarray:
    before, after = moves.reaching[:-1], moves.leaving[1:]
    # atan2 of the half angle: exact for straight on and for straight back
    across, on = np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1)
    return np.concatenate([[0.0], 2 * np.arctan2(across, on), [0.0]])[: len(moves.lengths) + 1]


def blend_radii(poses_mm: np.ndarray, blending: Blending, arcs=()) -> np.ndarray:
    """(n,) how far before and after each pose the path may leave its moves [mm]: a circle that touches both at
    distance R passes the corner at R tan(angle / 4), at most the tolerance; blends never meet. Robots stop where
    they turn back, where the brush is pressed on the spot and at the ends of circles: there it is 0."""
    return blends(poses_mm, blending, arcs)[0]


def blends(poses_mm: np.ndarray, blending: Blending, arcs=()) -> tuple[np.ndarray, np.ndarray]:
    """The same, and turns_rad."""
    radii = np.zeros(len(poses_mm))
    moves = _moves(poses_mm, arcs)
    all_turns = _turns(moves)
    if len(poses_mm) < 3 or not blending.tolerance_mm:
        return radii, all_turns
    turns = all_turns[1:-1]
    quarter = np.tan(turns / 4)
    most = np.divide(blending.tolerance_mm, quarter, out=np.full_like(quarter, np.inf), where=quarter > 0)
    if len(arcs):  # on a circle no further than its tangent shows the way
        bends = np.abs(moves.bends)
        bend = np.maximum(bends[:-1], bends[1:])
        least = np.divide(blending.tolerance_mm, bend, out=np.full_like(bend, np.inf), where=bend > 0)
        most = np.minimum(most, np.sqrt(least))
    radii[1:-1] = np.minimum(0.45 * np.minimum(moves.lengths[:-1], moves.lengths[1:]), most)
    if blending.radius_mm:
        still = on_the_spot(np.diff(poses_mm, axis=0)) | (moves.bends != 0)
        radii[1:-1][(turns > SHARP_RAD) | still[:-1] | still[1:]] = 0.0
        radii = np.minimum(radii, blending.radius_mm)
    return radii, all_turns


def on_the_spot(steps_mm: np.ndarray, sideways_mm: float = ON_THE_SPOT_MM) -> np.ndarray:
    """(n,) which steps (n, 3) go straight up or down: less than so far sideways, and further than that."""
    sideways = np.abs(steps_mm[:, :2]).max(axis=1, initial=0.0)
    return (sideways < sideways_mm) & (np.abs(steps_mm[:, 2]) > sideways_mm)


def blended(poses_mm: np.ndarray, radii_mm: np.ndarray, arcs=()) -> tuple[np.ndarray, ...]:
    """(m, 3) the path with its corners cut, three points of the touching circle instead of each corner's one; (m,)
    the poses that its points belong to, as fractional indices; and (n, 2) the first and last point of each pose."""
    indices = np.arange(len(poses_mm))
    whole = poses_mm, indices.astype(float), np.column_stack([indices, indices])
    if len(poses_mm) < 3:
        return whole
    moves = _moves(poses_mm, arcs)
    cut_mm = radii_mm * np.tan(_turns(moves) / 4)
    still = moves.lengths == 0  # as a program that was changed by hand may have it
    cut_mm[:-1][still] = cut_mm[1:][still] = 0.0
    corners = np.flatnonzero(cut_mm > SEEN_MM)
    if not len(corners):
        return whole
    radii, here = radii_mm[corners], poses_mm[corners]
    before, after = moves.reaching[corners - 1], moves.leaving[corners]
    middle = after - before
    size = np.linalg.norm(middle, axis=1, keepdims=True)
    middle = np.divide(middle, size, out=-before, where=size > 1e-12)
    counts = np.ones(len(poses_mm), dtype=int)
    counts[corners] = 3
    path, at = np.repeat(poses_mm, counts, axis=0), np.repeat(whole[1], counts)
    last = np.cumsum(counts) - 1
    first = last - counts + 1
    path[first[corners]] += _way(before, -radii, moves.bends[corners - 1])
    path[first[corners] + 1] = here + cut_mm[corners, None] * middle
    path[last[corners]] += _way(after, radii, moves.bends[corners])
    at[first[corners]] -= radii / moves.lengths[corners - 1]
    at[last[corners]] += radii / moves.lengths[corners]
    return path, at, np.column_stack([first, last])


def _way(along: np.ndarray, length_mm: np.ndarray, bends: np.ndarray) -> np.ndarray:
    """(k, 3) how far one comes on lines and circles that begin in a direction; back, for a negative length."""
    half = length_mm * bends / 2
    chord = (length_mm * np.sinc(half / np.pi))[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(along))])
    return chord * (np.cos(half)[:, None] * along + np.sin(half)[:, None] * across)
