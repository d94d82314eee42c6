"""The middle line of an angular stroke's mark, point by point, to two lengths: r - e where it begins to turn, and r
from how it decays."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...errors import Error

# Where points of the line are placed between the chords that points are held against, in lags from the corner: chords
# are off it by 1e-4 lags. Before the corner and 12 lags beyond it is straight.
PLACES = np.concatenate([np.arange(0.0, 4.0, 0.03), np.arange(4.0, 12.1, 0.25)])
MOST_POINTS = 500  # of one line that count: one in so many, evenly
UNSURE = 0.5  # share of the lag: less is known of it by a line that ends too early
CLEARLY = 16.0  # times the variance by which one sign of e must fit better, or the other is possible as well
# Noise of standard deviation 1 in x and y, averaged exactly up to the third power (the rule of 2 n points), turned.
SHAKES = math.sqrt(2.0) * np.array([(math.cos(a), math.sin(a)) for a in np.arange(8) * math.pi / 4.0])
OFF = 0.15  # of the lag: lines with a larger mean distance are no turns


@dataclass(frozen=True)
class Turn:
    """Lag r and r - e [mm], e the lever from centre of friction to widest section, their covariance (2, 2) [mm^2] by
    the points of this line alone, how far these are off, root mean square [mm], and the number of values to spare.

    other: the reading with the other sign of e, where the points allow both; this one then is that of e > 0."""

    lag_mm: float
    turning_mm: float
    covariance_mm2: np.ndarray
    rmse_mm: float
    freedom: int
    other: Turn | None = None


def middle_of_turn(lag_mm: float, turning_mm: float, s_mm: np.ndarray) -> np.ndarray:
    """Middle of the mark (n, 2) when the handle has gone s >= 0 along +x from the corner, to which it came along +y:
    m = q - (r - e) u, u by (7) from 90 degrees. At s = 0 it has a corner as well: there u is across the motion."""
    after = s_mm / lag_mm
    return np.column_stack([s_mm - turning_mm * np.tanh(after), -turning_mm / np.cosh(after)])


def _nearest(line: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The piece of a polyline (k, 2) that is nearest to each point (n, 2), and at which share of it."""
    start, along = line[:-1], np.diff(line, axis=0)
    apart = points[:, None] - start
    share = np.clip((apart * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-30), 0.0, 1.0)
    best = np.argmin(((apart - share[..., None] * along) ** 2).sum(axis=2), axis=1)
    return best, share[np.arange(len(points)), best]


def _at(values: np.ndarray, piece: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Values of the corners of a polyline (k, 2), interpolated (n, 2)."""
    return values[piece] + share[:, None] * (values[piece + 1] - values[piece])


def _below_second_line(points_mm) -> np.ndarray:
    """At most MOST_POINTS of them, below the handle's second line."""
    points = np.array(points_mm, float)
    points = points[:: -(-len(points) // MOST_POINTS)]
    return points * [1.0, -1.0] if points[:, 1].sum() > 0 else points


def _off(points: np.ndarray, lag_mm: float, turning_mm: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points less their nearest place of the middle of a turn (n, 2); the piece of it, and the share of that piece."""
    line = middle_of_turn(lag_mm, turning_mm, lag_mm * PLACES)
    before = [0.0, min(float(points[:, 1].min()), -turning_mm) - 1.0]
    beyond = [max(float(points[:, 0].max()), line[-1, 0]) + 1.0, 0.0]
    line = np.vstack([before, line, beyond])
    piece, share = _nearest(line, points)
    return points - _at(line, piece, share), piece, share


def read_turn_near(points_mm, lag_mm: float, turning_mm: float) -> Turn:
    """The same points as read_turn's, read by one Gauss-Newton step from lengths that are about right.

    Near e = 0 the lengths of smallest distance scatter more than the points say, and r - e is too small: the
    distance hardly depends on e there. A step from the laws of all measurements does neither, and repeated it ends at
    the least squares of all points of all lines. Points scattered about a bent line are nearest to its inside on
    average; what that adds to the step is taken off, as noise of the size that is found adds it to points on the line.
    """
    points = _below_second_line(points_mm)
    off, gradient, normal = _normal_equations(points, lag_mm, turning_mm)
    freedom = len(points) - 2
    variance = float((off**2).sum()) / freedom
    shaken = (points - off)[:, None] + math.sqrt(variance) * SHAKES
    by_noise = _normal_equations(shaken.reshape(-1, 2), lag_mm, turning_mm)[1] / len(SHAKES)
    inverse = np.linalg.pinv(normal)
    lag, turning = np.array([lag_mm, turning_mm]) - inverse @ (gradient - by_noise)
    return Turn(float(lag), float(turning), variance * inverse, math.sqrt(variance), freedom)


def _normal_equations(points: np.ndarray, lag_mm: float, turning_mm: float):
    """Points less their nearest place (n, 2); J d and J J^T, J the derivatives of their distance d by lag and r - e."""
    off, piece, share = _off(points, lag_mm, turning_mm)
    zero, decay = np.zeros_like(PLACES), 1.0 / np.cosh(PLACES)
    far = np.zeros((1, 2))  # the straight lines before and beyond: nothing moves across them
    by_lag = np.vstack([far, np.column_stack([PLACES, zero]), far])
    by_turning = np.vstack([far, -np.column_stack([np.tanh(PLACES), decay]), far])
    distance = np.sqrt((off**2).sum(axis=1))
    across = off / np.maximum(distance, 1e-12)[:, None]
    slopes = -np.stack([(across * _at(by, piece, share)).sum(axis=1) for by in (by_lag, by_turning)])
    return off, slopes @ distance, slopes @ slopes.T


def read_turn(points_mm, where: str = "") -> Turn:
    """points_mm (n, 2): of the middle of the mark, the handle's corner at the origin, its second line along +x; the
    mark is on one side of that line.

    Least squares of the distances from the line of `middle_of_turn`. Raises Error for points that are no such turn.
    """
    from scipy.optimize import least_squares

    points = _below_second_line(points_mm)
    reach = float(-points[:, 1].min())
    if not reach > 0.0 or points[:, 0].max() <= 0.0:
        raise Error(
            "the points are not along the handle's second line: that line is y = 0, x counts along it from the "
            "corner",
            where,
            code="not-a-turn",
        )

    def off(lengths):
        return _off(points, lengths[0], lengths[0] * lengths[1])[0].ravel()

    def fitted(shares, least, most):
        """Of lag and (r - e) / r, the latter within these."""
        tried = [(y / share, share) for y in np.linspace(0.2, 1.0, 9) * reach for share in shares]
        start = min(tried, key=lambda lengths: float(np.square(off(lengths)).sum()))
        bounds = ((0.02 * reach, least), (20.0 * reach, most))
        return least_squares(off, start, bounds=bounds, x_scale="jac", diff_step=1e-5)

    # Far from the corner r - e shows as (r - e) exp(-(r - e)/r) alone, which one length below r has and one above: the
    # points by the corner decide. In noise of 0.1 mm they often do not; e > 0 but for the shallowest strokes.
    freedom = len(points) - 2
    below, above = fitted((0.55, 0.75, 0.95), 0.1, 1.0), fitted((1.05, 1.3, 1.6), 1.0, 2.0)
    least = min(below.cost, above.cost)
    both = abs(below.cost - above.cost) <= CLEARLY * least / freedom
    best = below if both or below.cost == least else above
    lag, share = map(float, best.x)
    turning = share * lag
    covariance, rmse = _spread(best, freedom)
    if rmse > OFF * lag:
        raise Error(
            f"the points are {rmse:.2g} mm off any brush's turn, which would have a lag of {lag:.3g} mm: the corner of "
            "the handle is (0, 0), its second line goes along x",
            where,
            rmse,
            code="not-a-turn",
        )
    if np.sqrt(covariance[0, 0]) > UNSURE * lag or lag > 15.0 * reach:
        raise Error(
            f"the points leave the lag open, {lag:.2g} +- {np.sqrt(covariance[0, 0]):.2g} mm: follow the line farther "
            "beyond the corner, over twice the lag",
            where,
            code="law-undetermined",
        )
    other = (
        Turn(float(above.x[0]), float(above.x.prod()), *_spread(above, freedom), freedom) if both else None
    )
    return Turn(lag, turning, covariance, rmse, freedom, other)


def _spread(fit, freedom: int) -> tuple[np.ndarray, float]:
    """Return the covariance of lag and r - e, and the residual of the points; of a fit of lag and (r - e) / r."""
    lag, share = fit.x
    variance = 2.0 * fit.cost / freedom
    to_lengths = np.array([[1.0, 0.0], [share, lag]])
    return variance * to_lengths @ np.linalg.pinv(fit.jac.T @ fit.jac) @ to_lengths.T, float(
        np.sqrt(variance)
    )
