"""Convert B-splines to cubics.

The cubics are exact up to degree 3 with equal weights, otherwise they keep a tolerance.
"""

from __future__ import annotations

import numpy as np

from .ezdxf_import import ezdxf

_MAX_DEGREE = 32  # CAD programs stop at 25; the work grows with the square of the degree
_MAX_FIT_POINTS = 2000  # ezdxf solves a full system of equations for the fit points
_MAX_HALVINGS = 12  # a piece that is 4096 times shorter and still does not fit has no tangent
_MAX_PIECES = 100_000
# A jump of the curve is larger than this many tolerances. Smaller gaps come from the digits of a file, and the brush is
# not lifted for them.
_MIN_JUMP_TOLERANCES = 100


def make_continuous(cubics: np.ndarray) -> np.ndarray:
    """Move the start of each cubic (n, 4, d) to the end of the previous cubic."""
    cubics = cubics.copy()
    cubics[1:, 0] = cubics[:-1, 3]
    return cubics


def fit_points_to_cubics(fit_points, tangents, tolerance: float) -> list[np.ndarray]:
    """Return lines of cubics (n, 4, 3) through fit points, as CAD programs draw them.

    tangents: (start, end), None where unknown. Raises ValueError if there are too many fit points.
    """
    if len(fit_points) > _MAX_FIT_POINTS:
        raise ValueError(f"{len(fit_points)} fit points without control points, {_MAX_FIT_POINTS} are read")
    locations = [tuple(point) for point in fit_points]
    fit_points = [point for before, point in zip([None, *locations], locations, strict=False) if point != before]
    end_tangents = None if any(tangent is None for tangent in tangents) else tangents
    tool = ezdxf.math.fit_points_to_cad_cv(fit_points, end_tangents)
    points = [point.xyz for point in tool.control_points]
    return b_spline_to_cubics(tool.degree, tool.knots(), points, tool.weights(), tolerance)


def b_spline_to_cubics(degree: int, knots, points, weights, tolerance: float) -> list[np.ndarray]:
    """Return a B-spline as lines of cubics (n, 4, 3).

    There is one line, unless the curve jumps at a knot of multiplicity degree + 1.

    knots: if empty, evenly spaced and clamped; points: (n, 3); weights: if empty, all equal.

    Raises ValueError if degree, knots, points and weights do not fit together.
    """
    points = np.array(points, dtype=float).reshape(-1, 3)
    knots, weights = np.array(knots, dtype=float), np.array(weights, dtype=float)
    if not 1 <= degree <= _MAX_DEGREE:
        raise ValueError(f"the degree {degree} is outside the range [1, {_MAX_DEGREE}]")
    if len(points) <= degree:
        raise ValueError(f"{len(points)} control points are too few for degree {degree}")
    if not len(knots):
        inner = np.arange(len(points) - degree + 1.0)
        knots = np.concatenate((np.zeros(degree), inner, np.full(degree, inner[-1])))
    if not len(weights):
        weights = np.ones(len(points))
    if len(knots) != len(points) + degree + 1:
        raise ValueError(f"{len(knots)} knots do not go with {len(points)} control points of degree {degree}")
    if not (np.diff(knots) >= 0).all():
        raise ValueError("the knots do not ascend")
    if len(weights) != len(points) or not ((weights > 0).all() or (weights < 0).all()):
        raise ValueError("each control point needs a weight, and all above 0 or all below")
    weights = weights / weights[np.abs(weights).argmax()]  # a common factor, its sign too, cancels out
    pieces = _split_into_beziers(np.column_stack((points * weights[:, None], weights)), knots, degree)
    is_exact = degree <= 3 and np.ptp(weights) == 0
    cubics = _elevate_to_cubics(pieces[..., :3]) if is_exact else _fit_cubics(pieces, tolerance)
    jumps = np.linalg.norm(cubics[1:, 0] - cubics[:-1, 3], axis=1) > _MIN_JUMP_TOLERANCES * tolerance
    return [make_continuous(line) for line in np.split(cubics, np.flatnonzero(jumps) + 1)]


def _split_into_beziers(points: np.ndarray, knots: np.ndarray, degree: int) -> np.ndarray:
    """Split a B-spline into Beziers of non-empty spans: polar forms (spans, degree + 1, 4) by de Boor."""
    tiny = 1e-10 * (knots[-1] - knots[0])
    spans = np.array([k for k in range(degree, len(points)) if knots[k + 1] - knots[k] > tiny], dtype=int)
    if not len(spans):
        raise ValueError("all knots coincide")
    begin, end = knots[spans], knots[spans + 1]
    pieces = []
    for from_end in range(degree + 1):
        d = [points[spans - degree + j] for j in range(degree + 1)]
        for r in range(1, degree + 1):
            at = end if r <= from_end else begin
            for j in range(degree, r - 1, -1):
                left, right = knots[spans + j - degree], knots[spans + j + 1 - r]
                part = ((at - left) / (right - left))[:, None]
                d[j] = (1 - part) * d[j - 1] + part * d[j]
        pieces.append(d[degree])
    return np.stack(pieces, axis=1)


def _elevate_to_cubics(pieces: np.ndarray) -> np.ndarray:
    while (degree := pieces.shape[1] - 1) < 3:
        part = (np.arange(1, degree + 1) / (degree + 1))[:, None]
        inner = part * pieces[:, :-1] + (1 - part) * pieces[:, 1:]
        pieces = np.concatenate((pieces[:, :1], inner, pieces[:, -1:]), axis=1)
    return pieces


def _fit_cubics(pieces: np.ndarray, tolerance: float) -> np.ndarray:
    """Return cubics for rational Beziers (n, degree + 1, 4), which are halved until cubics fit."""
    begin, length = np.arange(len(pieces), dtype=float), 1.0
    begins, fitted = [], []
    for halvings in range(_MAX_HALVINGS + 1):
        cubics, errors = _hermite_cubics(pieces)
        # False for nan, which the check of all geometry finds later.
        rough = (errors > 0.5 * tolerance) & (halvings < _MAX_HALVINGS)
        begins.append(begin[~rough])
        fitted.append(cubics[~rough])
        if not rough.any():
            break
        if rough.sum() > _MAX_PIECES:
            raise ValueError(f"more than {_MAX_PIECES} cubics are needed for it")
        length /= 2
        begin = np.concatenate((begin[rough], begin[rough] + length))
        pieces = np.concatenate(_split_at(pieces[rough], 0.5))
    return np.concatenate(fitted)[np.argsort(np.concatenate(begins))]


def _hermite_cubics(pieces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return cubics with the ends and tangents of the curves, and their deviation (n,) at three parameters."""
    degree = pieces.shape[1] - 1
    weights = pieces[..., 3:]
    p = pieces[..., :3] / weights
    first = degree * weights[:, 1] / weights[:, 0] * (p[:, 1] - p[:, 0])
    last = degree * weights[:, -2] / weights[:, -1] * (p[:, -1] - p[:, -2])
    cubics = np.stack((p[:, 0], p[:, 0] + first / 3, p[:, -1] - last / 3, p[:, -1]), axis=1)
    errors = np.zeros(len(pieces))
    for t in (0.25, 0.5, 0.75):
        true = _split_at(pieces, t)[1][:, 0]
        errors = np.maximum(errors, np.abs(true[:, :3] / true[:, 3:] - _split_at(cubics, t)[1][:, 0]).max(axis=1))
    return cubics, errors


def _split_at(points: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Split curves (n, degree + 1, d) at t into two by de Casteljau's algorithm."""
    left, right = [points[:, 0]], [points[:, -1]]
    while points.shape[1] > 1:
        points = (1 - t) * points[:, :-1] + t * points[:, 1:]
        left.append(points[:, 0])
        right.append(points[:, -1])
    return np.stack(left, axis=1), np.stack(right[::-1], axis=1)
