"""Fit the lag to painted marks with measured outlines.

The usual fit only has drops and eggs as outlines, so a different footprint gives a different lag. Here the outlines of
the brush are fixed. The lag, the height of the paper and the displacement of each mark change until the edges of
painted and predicted marks agree. Distances are minimised by Gauss-Newton steps with Tukey's loss, starting at the
usual fit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.polynomial.polynomial import polyval

from ... import _core
from ...errors import Error
from ...geometry.rings import signed_area
from ...model.confidence import LAWS, places
from ...model.extra_keys import read_extra_keys
from ..marks.from_marks import LAG_TERMS, MarkCalibration
from ..marks.stray_marks import MAX_RESIDUAL_SIGMAS

MAX_ROUNDS = 8  # Gauss-Newton steps
SETTLED_MM = 0.01  # the fit has settled if the lag changes by less at any depth
DERIVATIVE_STEP_MM = 0.05  # step of the derivatives; with a smaller one, the chords of the outlines have an effect
MIN_NOISE_MM = 0.05  # least noise of an edge, as in the usual fit
MAX_LAG_CHANGE = 0.3  # largest relative change of a lag; with more, the outlines belong to another brush


@dataclass(frozen=True)
class LagByOutlines:
    """The lag of a brush with measured outlines.

    mark_calibration: the marks with the new brush; their places are Placed. before: the usual fit, with drops or eggs.
    outline_brush: the brush with the outlines and the other laws, which stay unchanged. height_mm: of the paper above
    the taught height. noise_mm: robust standard deviation of the residuals of the edges.
    """

    mark_calibration: MarkCalibration
    before: MarkCalibration
    outline_brush: _core.Brush
    height_mm: float
    noise_mm: float

    @property
    def brush(self) -> _core.Brush:
        return self.mark_calibration.brush


def lag_by_outlines(calibration: MarkCalibration, outline_brush: _core.Brush, name: str) -> LagByOutlines:
    """Fit the lag of a brush with measured outlines to painted marks.

    calibration: the usual fit to marks of strokes. outline_brush: the brush whose outlines were measured. name: the
    name of the result.

    Raises Error if the outlines are assumed, if they do not reach the depth of the strokes, and if marks and outlines
    do not belong to one brush.
    """
    refuse_assumed(outline_brush)
    _refuse_shallow(outline_brush, calibration.painted.deepest_mm)
    edges = _Edges(calibration, outline_brush)
    fitted_lag = np.array(calibration.fit.laws.lag)
    depths = np.linspace(0.0, calibration.painted.deepest_mm, 21)[1:]
    terms = min(LAG_TERMS, calibration.painted.depths)
    # Matrix from lags at `terms` depths to coefficients.
    at = np.linspace(0.0, calibration.painted.deepest_mm, terms + 1)[1:]
    to_law = np.linalg.inv(np.vander(at, terms, increasing=True))
    lag_changes = np.zeros(terms)
    height = calibration.fit.height_mm
    displaced = np.array([residual.displacement_mm for residual in calibration.fit.marks])
    for _ in range(MAX_ROUNDS):
        distances, slopes = edges.distances_and_slopes(
            _add_polynomials(fitted_lag, to_law @ lag_changes), to_law, height, displaced
        )
        change, covariance, noise = edges.solve_step(distances, slopes, height, displaced)
        lag_changes = lag_changes + change[:terms]
        height = height + change[terms]
        displaced = displaced + change[terms + 1 :].reshape(-1, 2)
        last_change = float(np.abs(polyval(depths, to_law @ change[:terms])).max())
        if last_change < SETTLED_MM:
            break
    else:
        sentence = (
            f"the fit of the lag with the outlines of brush {outline_brush.name} did not converge, its last change was "
            f"{last_change:.2f} mm: check that the same brush painted the strokes and the dabs"
        )
        raise Error(sentence, "lag", last_change, code="law-undetermined")
    # The lag has at least as many coefficients as the tip gap, because an error of the tip gap changes the lag by the
    # opposite amount.
    lag = _add_polynomials(
        _add_polynomials(fitted_lag, to_law @ lag_changes), np.zeros(len(outline_brush.tip_gap.coefficients))
    )
    _refuse_changed_lag(lag, fitted_lag, depths, outline_brush)
    brush = _with_lag(outline_brush, lag, name)
    lag_covariance = _lag_covariance(calibration, to_law @ covariance[:terms, :terms] @ to_law.T)
    brush_covariance = _join_covariance(outline_brush, brush, lag_covariance)
    half = _core.interval_factor_95() * np.sqrt(np.diag(brush_covariance)[: len(lag)])
    brush.lag = _core.Profile(
        lag.tolist(),
        calibrated_mm=(0.0, calibration.painted.deepest_mm),
        source=f"Fitted to {len(calibration.painted.marks)} painted marks with outlines of brush {outline_brush.name}.",
        half_interval_95=half.tolist(),
    )
    brush.covariance = brush_covariance.tolist()
    _core.check(brush)
    fit = calibration.fit
    marks = [
        PlacedMark(np.array(residual.way_mm), tuple(by.tolist()))
        for residual, by in zip(fit.marks, displaced, strict=True)
    ]
    placed = Placed(fit.turn_rad, fit.shift_mm, fit.centre_mm, float(height), tuple(marks))
    return LagByOutlines(
        replace(calibration, brush=brush, fit=placed), calibration, outline_brush, float(height), noise
    )


@dataclass(frozen=True)
class PlacedMark:
    """The path of a mark as the machine executed it, and the displacement of the mark."""

    way_mm: np.ndarray
    displacement_mm: tuple[float, float]


@dataclass(frozen=True)
class Placed:
    """The places of marks from the fit of drops or eggs.

    They have the pose of the sheet, the height of the paper and each mark.
    """

    turn_rad: float
    shift_mm: tuple[float, float]
    centre_mm: tuple[float, float]
    height_mm: float
    marks: tuple[PlacedMark, ...]


class _Edges:
    """Compares painted outlines with the marks that a brush would paint.

    The points are in the frame of the plan.
    """

    def __init__(self, calibration: MarkCalibration, outline_brush: _core.Brush):
        self.calibration, self.outline_brush = calibration, outline_brush
        self.points = [
            np.array(residual.point_mm) + np.array(residual.displacement_mm) for residual in calibration.fit.marks
        ]
        self.mark_of_point = np.repeat(np.arange(len(self.points)), [len(points) for points in self.points])

    def distances_and_slopes(self, lag, to_law, height, displaced) -> tuple[np.ndarray, np.ndarray]:
        """Return the distances (n,) from the predicted edges, and derivatives.

        Distances are positive outward.

        The derivatives are with respect to the lags, the height and the displacement of each mark.
        """
        rings = self._predict_rings(lag, height)
        off = self._distances(rings, displaced)
        columns = [
            self._distances(self._predict_rings(_add_polynomials(lag, DERIVATIVE_STEP_MM * row), height), displaced)
            for row in to_law.T
        ]
        columns.append(self._distances(self._predict_rings(lag, height + DERIVATIVE_STEP_MM), displaced))
        slopes = np.zeros((len(off), len(columns) + 2 * len(self.points)))
        slopes[:, : len(columns)] = (np.column_stack(columns) - off[:, None]) / DERIVATIVE_STEP_MM
        for axis, step in enumerate(DERIVATIVE_STEP_MM * np.eye(2)):
            moved = (self._distances(rings, displaced + step) - off) / DERIVATIVE_STEP_MM
            slopes[np.arange(len(off)), len(columns) + 2 * self.mark_of_point + axis] = moved
        return off, slopes

    def solve_step(self, distances, slopes, height, displaced) -> tuple[np.ndarray, np.ndarray, float]:
        """Return the Gauss-Newton step, the covariance of its result, and the noise.

        Height and displacements have the priors of the usual fit. Neighbouring points are correlated, so they count
        less than independent points.
        """
        expected, fit = self.calibration.expected, self.calibration.fit
        noise = max(MIN_NOISE_MM, 1.4826 * float(np.median(np.abs(distances))))
        # Square root of Tukey's weight.
        weight = np.clip(1 - (distances / (MAX_RESIDUAL_SIGMAS * noise)) ** 2, 0.0, 1.0)
        point_sigma = noise * np.sqrt(fit.samples / max(fit.effective_samples, 1.0))
        first = slopes.shape[1] - 1 - displaced.size
        prior_rows = np.zeros((1 + displaced.size, slopes.shape[1]))
        prior_rows[0, first] = 1 / expected.height_mm.sigma
        prior_rows[1:, first + 1 :] = np.eye(displaced.size) / expected.displacement_mm
        prior_values = np.append(
            (expected.height_mm.value - height) / expected.height_mm.sigma,
            -displaced.ravel() / expected.displacement_mm,
        )
        rows = np.vstack([slopes * (weight / point_sigma)[:, None], prior_rows])
        right_side = np.append(-distances * weight / point_sigma, prior_values)
        inverse = np.linalg.inv(rows.T @ rows)
        # Common shift of all edges, both of the painted marks and of the measured dabs.
        common_shift_mm = float(np.hypot(self.calibration.edge_mm, _outline_error_mm(self.outline_brush)))
        change = inverse @ rows.T[:, : len(distances)] @ (weight / point_sigma * common_shift_mm)
        covariance = inverse + np.outer(change, change)
        return inverse @ rows.T @ right_side, covariance, noise

    def _predict_rings(self, lag, height: float) -> list:
        brush = _with_lag(self.outline_brush, lag, self.outline_brush.name)
        passes = []
        for mark, residual in zip(self.calibration.painted.marks, self.calibration.fit.marks, strict=True):
            poses = np.array(residual.way_mm)
            depth = np.clip(height - poses[:, 2], 0.0, brush.depth_range_mm[1])
            passes.append(_core.Pass(mark.stroke, np.column_stack([poses[:, :2], -depth])))
        painted = _core.simulate(_core.Plan(brush.name, "", (1.0, 1.0), passes), brush)
        _core.trace_outlines(painted, brush)
        return [[np.array(ring) for ring in painted_pass.outline_mm] for painted_pass in painted.passes]

    def _distances(self, painted: list, displaced: np.ndarray) -> np.ndarray:
        return np.concatenate(
            [
                _outward_distances(points - by, rings)
                for points, by, rings in zip(self.points, displaced, painted, strict=True)
            ]
        )


def _outward_distances(points: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """Return the distances of points from the edge of a mark, negative inside."""
    away = np.full(len(points), -np.inf)
    for is_hole in (False, True):
        for ring in rings:
            if (signed_area(ring) < 0) != is_hole:
                continue
            contour = ring.astype(np.float32)
            inside = np.array([cv2.pointPolygonTest(contour, (x, y), True) for x, y in points.tolist()])
            away = np.minimum(away, -inside) if is_hole else np.maximum(away, inside)
    return -away


def _add_polynomials(law, by) -> np.ndarray:
    """Return the sum of two polynomials."""
    out = np.zeros(max(len(law), len(by)))
    out[: len(law)] += law
    out[: len(by)] += by
    return out


def _lag_covariance(calibration: MarkCalibration, of_step: np.ndarray) -> np.ndarray:
    """Return the covariance of all coefficients of the lag.

    It is the covariance of the step. If the usual fit has more coefficients, the covariance of the part that the fewer
    coefficients cannot follow is added.
    """
    fitted = np.array(calibration.covariance)[: len(calibration.fit.laws.lag), : len(calibration.fit.laws.lag)]
    few, many = len(of_step), max(len(of_step), len(fitted))
    out = np.zeros((many, many))
    out[:few, :few] = of_step
    if many > few:
        share = np.linspace(0.0, calibration.expected.deepest_mm, 41)[1:]
        powers = np.vander(share, many, increasing=True)
        followed = np.zeros((many, many))
        followed[:few] = np.linalg.lstsq(powers[:, :few], powers, rcond=None)[0]
        rest = np.eye(many) - followed
        out += rest @ fitted @ rest.T
    return out


def _keys_of_outlines(outline_brush: _core.Brush) -> dict:
    """Return the entries of a brush file about its outlines."""
    keys = read_extra_keys(outline_brush.extra).get("footprints")
    return keys if isinstance(keys, dict) else {}


def _outline_error_mm(outline_brush: _core.Brush) -> float:
    """Return the standard error of the outlines from the brush file [mm]."""
    error_mm = _keys_of_outlines(outline_brush).get("standard_error_mm", 0.0)
    return float(error_mm) if isinstance(error_mm, (int, float)) and np.isfinite(error_mm) else 0.0


def refuse_assumed(outline_brush: _core.Brush) -> None:
    if _keys_of_outlines(outline_brush).get("assumed", True):
        raise Error(
            f"the outlines of brush {outline_brush.name} are assumed, not measured: measure them first, with a "
            "photograph of dabs",
            "footprints",
            code="footprints-assumed",
        )


def _refuse_shallow(outline_brush: _core.Brush, deepest_mm: float) -> None:
    least, deepest = outline_brush.depth_range_mm
    if deepest_mm > deepest + 1e-6:
        sentence = (
            f"the strokes were painted {deepest_mm:g} mm deep, but brush {outline_brush.name} may be pressed only "
            f"{least:g} to {deepest:g} mm: measure dabs that are as deep as the strokes"
        )
        raise Error(sentence, "depth_range_mm", deepest_mm, code="depth-out-of-range")


def _refuse_changed_lag(lag, fitted_lag, depths: np.ndarray, outline_brush: _core.Brush) -> None:
    fitted, new = polyval(depths, fitted_lag), polyval(depths, lag)
    share = np.abs(new - fitted) / np.maximum(fitted, fitted.max() / 4)
    worst = int(share.argmax())
    if share[worst] > MAX_LAG_CHANGE or polyval(np.append(0.0, depths), lag).min() < 0:
        sentence = (
            f"the lag at depth {depths[worst]:.3g} mm would be {new[worst]:.1f} mm with the outlines of brush "
            f"{outline_brush.name}, but {fitted[worst]:.1f} mm without them; at most {100 * MAX_LAG_CHANGE:g} % is "
            "allowed: check that the same brush painted the strokes and the dabs"
        )
        raise Error(sentence, "lag", float(new[worst]), code="dabs-of-another-brush")


def _with_lag(outline_brush: _core.Brush, lag, name: str) -> _core.Brush:
    brush = _core.read_brush(_core.write_brush(outline_brush))
    brush.name, brush.covariance = name, []
    brush.lag = _core.Profile(np.asarray(lag).tolist())
    return brush


def _join_covariance(outline_brush: _core.Brush, brush: _core.Brush, of_lag: np.ndarray) -> np.ndarray:
    """Return the covariance of all coefficients of the brush.

    It joins the covariances of the fitted lag and of the unchanged other laws.

    The lag was found from the places of tips, so an error of the tip gap changes the lag by the opposite amount.
    """
    new_places, old_places = places(brush), places(outline_brush)
    covariance = np.zeros((new_places[LAWS[-1]].stop,) * 2)
    covariance[: len(of_lag), : len(of_lag)] = of_lag
    old_covariance = np.array(outline_brush.covariance)
    if len(old_covariance):
        others = slice(new_places["lag"].stop, None)
        covariance[others, others] = old_covariance[old_places["lag"].stop :, old_places["lag"].stop :]
        gap = new_places["tip_gap"]
        powers = gap.stop - gap.start
        covariance[:powers, :powers] += covariance[gap, gap]
        covariance[:powers, others] -= covariance[gap, others]
        covariance[others, :powers] -= covariance[others, gap]
    return covariance
