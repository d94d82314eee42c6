"""How a tilted brush is held: turned about its tip, which stays where it is, the shortest way from upright."""

from __future__ import annotations

import numpy as np

# An axis that leans by less is upright: no program has less, and plans are rounded to 1e-7.
UPRIGHT = 1e-6


def axes_of(a_pass) -> np.ndarray | None:
    """(n, 3) unit vectors from the tip up along the brush; None where the pass is upright throughout."""
    axes = np.asarray(a_pass.tool_axes, dtype=float).reshape(-1, 3)
    if not len(axes) or is_upright(axes).all():
        return None
    return unit(axes)


def is_tilted(a_pass) -> bool:
    """Whether the brush leans anywhere on a pass."""
    return axes_of(a_pass) is not None


def unit(axes: np.ndarray) -> np.ndarray:
    return axes / np.linalg.norm(axes, axis=-1, keepdims=True)


def is_upright(axes: np.ndarray) -> np.ndarray:
    """(...) which of axes (..., 3) on the paper do not lean."""
    return np.hypot(axes[..., 0], axes[..., 1]) < UPRIGHT


def is_upright_on(axes: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(...) the same on paper with a normal (3,)."""
    return between_deg(axes, normal) < np.degrees(UPRIGHT)


def turned_to(axes: np.ndarray, upright: np.ndarray) -> np.ndarray:
    """(..., 3, 3) the tool, its z against axes (..., 3): turned from where it is upright (3, 3) the shortest way, about
    the line across both directions, so that it turns about its own axis no more than it must.

    Rodrigues: with n the axis upright, v = n x a and c = n . a, R = I + [v] + [v]^2 / (1 + c), for a not -n.
    """
    normal = -upright[:, 2]
    across = np.cross(normal, axes)
    x, y, z = np.moveaxis(across, -1, 0)
    none = np.zeros_like(x)
    skew = np.stack([none, -z, y, z, none, -x, -y, x, none], axis=-1).reshape(*x.shape, 3, 3)
    cosine = np.asarray(axes @ normal)[..., None, None]
    return (np.eye(3) + skew + skew @ skew / (1 + cosine)) @ upright


def between_deg(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(...) angle between unit vectors (..., 3), exact for small ones, too."""
    return np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)))


def across(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(..., 3) unit vectors about which unit vectors (..., 3) turn to others the shortest way; 0 where they do not."""
    found = np.cross(a, b)
    size = np.linalg.norm(found, axis=-1, keepdims=True)
    return np.divide(found, size, out=np.zeros_like(found), where=size > 0)


def turned_on(a: np.ndarray, b: np.ndarray, part: float) -> np.ndarray:
    """(3,) a unit vector that is turned by a part of the way to another one."""
    whole = np.radians(between_deg(a, b))
    if whole < 1e-9:
        return b
    return (np.sin((1 - part) * whole) * a + np.sin(part * whole) * b) / np.sin(whole)


def tilts_deg(axes: np.ndarray) -> np.ndarray:
    """(...) how far axes (..., 3) lean from the paper's normal."""
    return np.degrees(np.arctan2(np.hypot(axes[..., 0], axes[..., 1]), axes[..., 2]))


def mixed(axes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """(m, 3) axes at fractional rows (m,) of axes (n, 3), by what they lean for each mm up, as predictions have it."""
    leans = axes[:, :2] / axes[:, 2:]
    rows = np.arange(len(axes))
    lean = np.column_stack([np.interp(at, rows, leans[:, k]) for k in (0, 1)])
    return unit(np.column_stack([lean, np.ones(len(lean))]))
