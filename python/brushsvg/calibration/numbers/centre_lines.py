"""Read two lengths from the middle line of an angular stroke's mark.

The place where the line begins to turn gives r - e, and its decay gives r.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...errors import Error

# Corners of the polyline that stands for the middle line, in lags from the corner of the handle. The chords are within
# 1e-4 lags of the line. Before the corner, and from 12 lags beyond it, the line is straight.
LINE_PLACES_LAGS = np.concatenate([np.arange(0.0, 4.0, 0.03), np.arange(4.0, 12.1, 0.25)])
MAX_LINE_POINTS = 500  # points used of one line, evenly chosen
# Largest standard deviation of the lag, relative to the lag; a line that ends too early exceeds it.
MAX_LAG_UNCERTAINTY = 0.5
MIN_SIGN_EVIDENCE = 16.0  # times the variance by which one sign of e must fit better to exclude the other
# Cubature points for noise of standard deviation 1 in x and y: the rule of 2 n points, plus the same points turned by
# 45 degrees. Averages are exact up to the third power.
NOISE_POINTS = math.sqrt(2.0) * np.array([(math.cos(a), math.sin(a)) for a in np.arange(8) * math.pi / 4.0])
MAX_MISFIT_PER_LAG = 0.15  # times the lag: lines with a larger mean distance are not turns


@dataclass(frozen=True)
class Turn:
    """The two lengths read from a turn.

    lag_mm, turning_mm: lag r and r - e [mm], where e is the lever from the centre of friction to the widest section.
    covariance_mm2: their covariance (2, 2) from the points of this line alone. rmse_mm: root mean square distance of
    the points. freedom: degrees of freedom. other: the reading with the other sign of e if the points allow both; then
    this reading is the one with e > 0.
    """

    lag_mm: float
    turning_mm: float
    covariance_mm2: np.ndarray
    rmse_mm: float
    freedom: int
    other: Turn | None = None


def middle_of_turn(lag_mm: float, turning_mm: float, s_mm: np.ndarray) -> np.ndarray:
    """Return the middle (n, 2) of the mark of an angular stroke [mm].

    s_mm >= 0: how far the handle has gone along +x from its corner.

    The handle came to the corner along +y. The middle is m = q - (r - e) u, with u from (7) starting at 90 degrees.
    The middle also has a corner at s = 0, where u is perpendicular to the motion.
    """
    after = s_mm / lag_mm
    return np.column_stack([s_mm - turning_mm * np.tanh(after), -turning_mm / np.cosh(after)])


def _find_nearest_segment(line: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the nearest segment of a polyline (k, 2) for each point (n, 2), and the share of it."""
    start, along = line[:-1], np.diff(line, axis=0)
    to_points = points[:, None] - start
    share = np.clip((to_points * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-30), 0.0, 1.0)
    best = np.argmin(((to_points - share[..., None] * along) ** 2).sum(axis=2), axis=1)
    return best, share[np.arange(len(points)), best]


def _interpolate(values: np.ndarray, piece: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Interpolate values of a polyline's corners (k, 2) on its segments (n, 2)."""
    return values[piece] + share[:, None] * (values[piece + 1] - values[piece])


def _place_below_second_line(points_mm) -> np.ndarray:
    """Return at most MAX_LINE_POINTS points, below the handle's second line. Points above the line are mirrored."""
    points = np.array(points_mm, float)
    points = points[:: -(-len(points) // MAX_LINE_POINTS)]
    return points * [1.0, -1.0] if points[:, 1].sum() > 0 else points


def _vectors_to_points(
    points: np.ndarray, lag_mm: float, turning_mm: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return vectors from a turn's middle to points (n, 2), the nearest segments, and the shares of them."""
    line = middle_of_turn(lag_mm, turning_mm, lag_mm * LINE_PLACES_LAGS)
    start = [0.0, min(float(points[:, 1].min()), -turning_mm) - 1.0]
    end = [max(float(points[:, 0].max()), line[-1, 0]) + 1.0, 0.0]
    line = np.vstack([start, line, end])
    piece, share = _find_nearest_segment(line, points)
    return points - _interpolate(line, piece, share), piece, share


def read_turn_near(points_mm, lag_mm: float, turning_mm: float) -> Turn:
    """Read a turn by one Gauss-Newton step from lengths that are approximately right.

    points_mm: as in read_turn. Near e = 0 the distance hardly depends on e. Lengths that minimise it there scatter
    more than the points predict, and r - e is too small. A step that starts from the laws of all measurements avoids
    both. Repeated steps end at the least squares of all points of all lines.

    Points that scatter about a bent line are nearest to its inside on average, which biases the step. The bias is
    computed by adding noise of the estimated size to points on the line, and is subtracted.
    """
    points = _place_below_second_line(points_mm)
    off, gradient, normal = _normal_equations(points, lag_mm, turning_mm)
    freedom = len(points) - 2
    variance = float((off**2).sum()) / freedom
    noisy = (points - off)[:, None] + math.sqrt(variance) * NOISE_POINTS
    bias = _normal_equations(noisy.reshape(-1, 2), lag_mm, turning_mm)[1] / len(NOISE_POINTS)
    inverse = np.linalg.pinv(normal)
    lag, turning = np.array([lag_mm, turning_mm]) - inverse @ (gradient - bias)
    return Turn(float(lag), float(turning), variance * inverse, math.sqrt(variance), freedom)


def _normal_equations(points: np.ndarray, lag_mm: float, turning_mm: float):
    """Return the vectors to the points (n, 2), J d and J J^T; J = derivatives of distances d by lag and r - e."""
    off, piece, share = _vectors_to_points(points, lag_mm, turning_mm)
    zero, decay = np.zeros_like(LINE_PLACES_LAGS), 1.0 / np.cosh(LINE_PLACES_LAGS)
    fixed = np.zeros((1, 2))  # the straight parts before and beyond the turn do not move sideways
    by_lag = np.vstack([fixed, np.column_stack([LINE_PLACES_LAGS, zero]), fixed])
    by_turning = np.vstack([fixed, -np.column_stack([np.tanh(LINE_PLACES_LAGS), decay]), fixed])
    distance = np.sqrt((off**2).sum(axis=1))
    across = off / np.maximum(distance, 1e-12)[:, None]
    slopes = -np.stack([(across * _interpolate(by, piece, share)).sum(axis=1) for by in (by_lag, by_turning)])
    return off, slopes @ distance, slopes @ slopes.T


def read_turn(points_mm, where: str = "") -> Turn:
    """Read lag and r - e from the middle line of an angular stroke's mark.

    points_mm (n, 2): points of the middle line. The handle's corner is the origin and its second line runs along +x.
    The mark is on one side of that line. where: the place in the file, for messages.

    The fit minimises the squared distances from the line of `middle_of_turn`. Raises Error for points that are not
    such a turn.
    """
    from scipy.optimize import least_squares

    points = _place_below_second_line(points_mm)
    reach = float(-points[:, 1].min())
    if not reach > 0.0 or points[:, 0].max() <= 0.0:
        raise Error(
            "the points are not along the handle's second line: give x along that line from the corner, and y across",
            where,
            code="not-a-turn",
        )

    def residuals(lengths):
        return _vectors_to_points(points, lengths[0], lengths[0] * lengths[1])[0].ravel()

    def fit_within(shares, least, most):
        """Fit lag and (r - e) / r, with the latter between least and most."""
        candidates = [(y / share, share) for y in np.linspace(0.2, 1.0, 9) * reach for share in shares]
        start = min(candidates, key=lambda lengths: float(np.square(residuals(lengths)).sum()))
        bounds = ((0.02 * reach, least), (20.0 * reach, most))
        return least_squares(residuals, start, bounds=bounds, x_scale="jac", diff_step=1e-5)

    # Far from the corner only (r - e) exp(-(r - e)/r) is visible. One r - e below r and one above r give the same
    # value, so the points near the corner must decide. With noise of 0.1 mm they often cannot. e > 0 except for the
    # shallowest strokes.
    freedom = len(points) - 2
    smaller, larger = fit_within((0.55, 0.75, 0.95), 0.1, 1.0), fit_within((1.05, 1.3, 1.6), 1.0, 2.0)
    least = min(smaller.cost, larger.cost)
    ambiguous = abs(smaller.cost - larger.cost) <= MIN_SIGN_EVIDENCE * least / freedom
    best = smaller if ambiguous or smaller.cost == least else larger
    lag, share = map(float, best.x)
    turning = share * lag
    covariance, rmse = _covariance_and_rmse(best, freedom)
    if rmse > MAX_MISFIT_PER_LAG * lag:
        sentence = (
            f"the points are {rmse:.2g} mm from the nearest turn of any brush, which has a lag of {lag:.3g} mm: put "
            "the corner of the handle at (0, 0) and its second line along x"
        )
        raise Error(sentence, where, rmse, code="not-a-turn")
    if np.sqrt(covariance[0, 0]) > MAX_LAG_UNCERTAINTY * lag or lag > 15.0 * reach:
        raise Error(
            f"the points do not determine the lag ({lag:.2g} +- {np.sqrt(covariance[0, 0]):.2g} mm): give points to "
            "more than two lags beyond the corner",
            where,
            code="law-undetermined",
        )
    other = (
        Turn(float(larger.x[0]), float(larger.x.prod()), *_covariance_and_rmse(larger, freedom), freedom)
        if ambiguous
        else None
    )
    return Turn(lag, turning, covariance, rmse, freedom, other)


def _covariance_and_rmse(fit, freedom: int) -> tuple[np.ndarray, float]:
    """Return the covariance of lag and r - e, and the residual of the points. fit: a fit of lag and (r - e) / r."""
    lag, share = fit.x
    variance = 2.0 * fit.cost / freedom
    to_lengths = np.array([[1.0, 0.0], [share, lag]])
    return variance * to_lengths @ np.linalg.pinv(fit.jac.T @ fit.jac) @ to_lengths.T, float(np.sqrt(variance))
