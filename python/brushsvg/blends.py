"""What a machine makes of the joint of two moves: it cuts the corner, so as not to stand still there."""

from __future__ import annotations

import numpy as np

from .cell import Blending

SHARP_RAD = np.radians(100.0)  # a robot that blends cannot reverse: here it stops
ON_THE_SPOT_MM = 1e-6
SEEN_MM = 1e-4  # corners that are cut by less are left as they are


def turns_rad(poses_mm: np.ndarray) -> np.ndarray:
    """(n,) angle between the moves that meet at each pose, 0 at the ends."""
    steps = np.diff(poses_mm, axis=0)
    lengths = np.linalg.norm(steps, axis=1, keepdims=True)
    along = np.divide(steps, lengths, out=np.zeros_like(steps), where=lengths > 0)
    before, after = along[:-1], along[1:]
    turns = np.zeros(len(poses_mm))
    # atan2 of the half angle: exact for straight on and for straight back
    turns[1:-1] = 2 * np.arctan2(
        np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1)
    )
    return turns


def blend_radii(poses_mm: np.ndarray, blending: Blending) -> np.ndarray:
    """(n,) how far before and after each pose the path may leave its moves [mm]: a circle that touches both at
    distance R passes the corner at R tan(angle / 4), at most the tolerance; blends never meet. Robots stop where
    they turn back and where the brush is pressed on the spot: there it is 0."""
    radii = np.zeros(len(poses_mm))
    if len(poses_mm) < 3 or not blending.tolerance_mm:
        return radii
    steps = np.diff(poses_mm, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    turns = turns_rad(poses_mm)[1:-1]
    quarter = np.tan(turns / 4)
    by_tolerance = np.divide(
        blending.tolerance_mm, quarter, out=np.full_like(quarter, np.inf), where=quarter > 0
    )
    radii[1:-1] = np.minimum(0.45 * np.minimum(lengths[:-1], lengths[1:]), by_tolerance)
    if blending.radius_mm:
        still = on_the_spot(steps)
        radii[1:-1][(turns > SHARP_RAD) | still[:-1] | still[1:]] = 0.0
        return np.minimum(radii, blending.radius_mm)
    return radii


def on_the_spot(steps_mm: np.ndarray) -> np.ndarray:
    """(n,) which steps (n, 3) go straight up or down."""
    return (np.abs(steps_mm[:, :2]).max(axis=1, initial=0.0) < ON_THE_SPOT_MM) & (steps_mm[:, 2] != 0)


def blended(poses_mm: np.ndarray, radii_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(m, 3) the path with its corners cut, three points of the touching circle instead of each corner's one; and
    (m,) the poses that its points belong to, as fractional indices."""
    indices = np.arange(len(poses_mm), dtype=float)
    cut_mm = radii_mm * np.tan(turns_rad(poses_mm) / 4)
    still = ~np.diff(poses_mm, axis=0).any(axis=1)  # as a program that was changed by hand may have it
    cut_mm[:-1][still] = cut_mm[1:][still] = 0.0
    corners = np.flatnonzero(cut_mm > SEEN_MM)
    if not len(corners):
        return poses_mm, indices
    radii, here = radii_mm[corners, None], poses_mm[corners]
    before, after = poses_mm[corners - 1] - here, poses_mm[corners + 1] - here
    length_before, length_after = (np.linalg.norm(side, axis=1, keepdims=True) for side in (before, after))
    before, after = before / length_before, after / length_after
    middle = before + after
    size = np.linalg.norm(middle, axis=1, keepdims=True)
    middle = np.divide(middle, size, out=before.copy(), where=size > 1e-12)
    counts = np.ones(len(poses_mm), dtype=int)
    counts[corners] = 3
    path, at = np.repeat(poses_mm, counts, axis=0), np.repeat(indices, counts)
    first = (np.cumsum(counts) - counts)[corners]
    path[first] = here + radii * before
    path[first + 1] = here + cut_mm[corners, None] * middle
    path[first + 2] = here + radii * after
    at[first] -= (radii / length_before)[:, 0]
    at[first + 2] += (radii / length_after)[:, 0]
    return path, at
