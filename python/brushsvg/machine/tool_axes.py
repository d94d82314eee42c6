"""Tilted tool axes: the brush turns about its tip, the shortest way."""

from __future__ import annotations

import numpy as np

# Largest lean of an upright axis. No program has a smaller lean, and plans are rounded to 1e-7.
MAX_UPRIGHT_LEAN = 1e-6


def axes_of(a_pass) -> np.ndarray | None:
    """Return the unit vectors (n, 3) of a pass, from the tip up along the brush.

    Returns None if the whole pass is upright.
    """
    axes = np.asarray(a_pass.tool_axes, dtype=float).reshape(-1, 3)
    if not len(axes) or is_axis_upright(axes).all():
        return None
    return normalize(axes)


def is_tilted(a_pass) -> bool:
    """Return whether the brush leans anywhere on a pass."""
    return axes_of(a_pass) is not None


def normalize(axes: np.ndarray) -> np.ndarray:
    return axes / np.linalg.norm(axes, axis=-1, keepdims=True)


def is_axis_upright(axes: np.ndarray) -> np.ndarray:
    """Return which axes (..., 3) in the paper's frame are upright, (...)."""
    return np.hypot(axes[..., 0], axes[..., 1]) < MAX_UPRIGHT_LEAN


def is_parallel(axes: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return which axes (..., 3) are parallel to the paper's normal (3,), (...)."""
    return between_deg(axes, normal) < np.degrees(MAX_UPRIGHT_LEAN)


def turned_to(axes: np.ndarray, upright: np.ndarray) -> np.ndarray:
    """Return the rotations (..., 3, 3) of the tool along axes (..., 3).

    The tool's z axis points against the axis. The tool is turned the shortest way from its upright rotation (3, 3),
    about the line across both directions. It therefore turns as little as possible about its own axis.

    Rodrigues: with the upright axis n, the axis a, v = n x a and c = n . a, R = I + [v] + [v]^2 / (1 + c).
    The axis a must not be -n.
    """
    normal = -upright[:, 2]
    cross = np.cross(normal, axes)
    x, y, z = np.moveaxis(cross, -1, 0)
    zeros = np.zeros_like(x)
    skew = np.stack([zeros, -z, y, z, zeros, -x, -y, x, zeros], axis=-1).reshape(*x.shape, 3, 3)
    cosine = np.asarray(axes @ normal)[..., None, None]
    return (np.eye(3) + skew + skew @ skew / (1 + cosine)) @ upright


def between_deg(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the angles [degrees] between unit vectors (..., 3). Small angles are exact, too."""
    return np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)))


def rotation_axes(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the axes (..., 3) of the shortest turns between unit vectors (..., 3). The axis is 0 for equal vectors."""
    normals = np.cross(a, b)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    return np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)


def turned_on(a: np.ndarray, b: np.ndarray, fraction: float) -> np.ndarray:
    """Turn a unit vector (3,) by a fraction of the angle to another unit vector."""
    angle_rad = np.radians(between_deg(a, b))
    if angle_rad < 1e-9:
        return b
    return (np.sin((1 - fraction) * angle_rad) * a + np.sin(fraction * angle_rad) * b) / np.sin(angle_rad)


def tilts_deg(axes: np.ndarray) -> np.ndarray:
    """Return the angles [degrees] of axes (..., 3) to the paper's normal."""
    return np.degrees(np.arctan2(np.hypot(axes[..., 0], axes[..., 1]), axes[..., 2]))


def interpolate_axes(axes: np.ndarray, row_positions: np.ndarray) -> np.ndarray:
    """Interpolate axes (n, 3) at fractional rows (m,).

    The lean for each mm upwards is interpolated, as in predictions.
    """
    leans = axes[:, :2] / axes[:, 2:]
    rows = np.arange(len(axes))
    mixed_leans = np.column_stack([np.interp(row_positions, rows, leans[:, k]) for k in (0, 1)])
    return normalize(np.column_stack([mixed_leans, np.ones(len(mixed_leans))]))
