"""The lag of painted marks by a brush whose outlines were measured, in place of the drops or eggs that a fit assumes.

The fit of marks knows drops and eggs alone: where the true footprint is another it gives another lag. Here the
outlines are those of the brush, and the numbers that change until the edges of painted and predicted marks agree are
the lag, the height of the paper, and each mark's displacement. Least squares over distances by Gauss and Newton, under
Tukey's loss, from what the fit found on.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.polynomial.polynomial import polyval

from ... import _core
from ...errors import Error
from ...geometry.rings import signed_area
from ...model.confidence import LAWS, places
from ..marks.from_marks import LAG_TERMS, MarkCalibration
from ..marks.stray_marks import MAX_RESIDUAL_SIGMAS

ROUNDS = 8
SETTLED_MM = 0.01  # of the lag, at any depth
STEP_MM = 0.05  # by which the derivatives' lags, heights and places differ: less, and chords of outlines show
LEAST_NOISE_MM = 0.05  # of an edge, as the fit has it
FARTHEST = 0.3  # share of a lag that outlines may change: more, and they are of another brush


@dataclass(frozen=True)
class LagByOutlines:
    """made: the marks, and what they say of the brush by its own outlines, at their places by these (Placed);
    before: what the fit said of them by drops or eggs; own: the brush whose outlines and other laws stay; height_mm: of
    the paper above the taught one; noise_mm: residual of the edges (robust standard deviation)."""

    made: MarkCalibration
    before: MarkCalibration
    own: _core.Brush
    height_mm: float
    noise_mm: float

    @property
    def brush(self) -> _core.Brush:
        return self.made.brush


def lag_by_outlines(made: MarkCalibration, own: _core.Brush, name: str) -> LagByOutlines:
    """made: what was fitted to marks of strokes; own: whose outlines were measured. Error where they are assumed, do
    not reach as deep as the strokes, or where marks and outlines are not of one brush."""
    refuse_assumed(own)
    _refuse_shallow(own, made.painted.deepest_mm)
    edges = _Edges(made, own)
    fitted_lag = np.array(made.fit.laws.lag)
    depths = np.linspace(0.0, made.painted.deepest_mm, 21)[1:]
    terms = min(LAG_TERMS, made.painted.depths)
    # lags at so many depths, as coefficients
    at = np.linspace(0.0, made.painted.deepest_mm, terms + 1)[1:]
    to_law = np.linalg.inv(np.vander(at, terms, increasing=True))
    more = np.zeros(terms)
    height, displaced = (
        made.fit.height_mm,
        np.array([residual.displacement_mm for residual in made.fit.marks]),
    )
    for _ in range(ROUNDS):
        off, slopes = edges.looked_at(_raised(fitted_lag, to_law @ more), to_law, height, displaced)
        change, covariance, noise = edges.solved(off, slopes, height, displaced)
        more, height, displaced = (
            more + change[:terms],
            height + change[terms],
            displaced + change[terms + 1 :].reshape(-1, 2),
        )
        left = float(np.abs(polyval(depths, to_law @ change[:terms])).max())
        if left < SETTLED_MM:
            break
    else:
        raise Error(
            f"by the outlines of brush {own.name} the lag does not settle, its last change was {left:.2f} mm: are "
            "strokes and dabs of one brush?",
            "lag",
            left,
            code="law-undetermined",
        )
    # no shorter than the tip gap: what that is off, the lag is off the other way
    lag = _raised(_raised(fitted_lag, to_law @ more), np.zeros(len(own.tip_gap.coefficients)))
    _refuse_far(lag, fitted_lag, depths, own)
    brush = _with_lag(own, lag, name)
    block = _raised_covariance(made, to_law @ covariance[:terms, :terms] @ to_law.T)
    whole = _joined(own, brush, block)
    half = _core.deviations_of_95() * np.sqrt(np.diag(whole)[: len(lag)])
    brush.lag = _core.Profile(
        lag.tolist(),
        calibrated_mm=(0.0, made.painted.deepest_mm),
        source=f"Fitted to {len(made.painted.marks)} painted marks by the outlines of brush {own.name}.",
        half_interval_95=half.tolist(),
    )
    brush.covariance = whole.tolist()
    _core.check(brush)
    fit = made.fit
    marks = [
        PlacedMark(np.array(residual.way_mm), tuple(by.tolist()))
        for residual, by in zip(fit.marks, displaced, strict=True)
    ]
    placed = Placed(fit.turn_rad, fit.shift_mm, fit.centre_mm, float(height), tuple(marks))
    return LagByOutlines(replace(made, brush=brush, fit=placed), made, own, float(height), noise)


@dataclass(frozen=True)
class PlacedMark:
    """Return the way of a mark as the machine ran it, and the displacement of the mark."""

    way_mm: np.ndarray
    displacement_mm: tuple[float, float]


@dataclass(frozen=True)
class Placed:
    """Return the places of marks by the fit of drops or eggs: sheet, height of the paper, each mark."""

    turn_rad: float
    shift_mm: tuple[float, float]
    centre_mm: tuple[float, float]
    height_mm: float
    marks: tuple[PlacedMark, ...]


class _Edges:
    """Points of the painted outlines in the plan's frame, mark by mark, against what a brush would have painted."""

    def __init__(self, made: MarkCalibration, own: _core.Brush):
        self.made, self.own = made, own
        self.points = [
            np.array(residual.point_mm) + np.array(residual.displacement_mm) for residual in made.fit.marks
        ]
        self.of = np.repeat(np.arange(len(self.points)), [len(each) for each in self.points])

    def looked_at(self, lag, to_law, height, displaced) -> tuple[np.ndarray, np.ndarray]:
        """Distances (n,) outward from the predicted edges, and their slopes over lags, height and each displacement."""
        rings = self._painted(lag, height)
        off = self._off(rings, displaced)
        columns = [
            self._off(self._painted(_raised(lag, STEP_MM * row), height), displaced) for row in to_law.T
        ]
        columns.append(self._off(self._painted(lag, height + STEP_MM), displaced))
        slopes = np.zeros((len(off), len(columns) + 2 * len(self.points)))
        slopes[:, : len(columns)] = (np.column_stack(columns) - off[:, None]) / STEP_MM
        for axis, step in enumerate(STEP_MM * np.eye(2)):
            moved = (self._off(rings, displaced + step) - off) / STEP_MM
            slopes[np.arange(len(off)), len(columns) + 2 * self.of + axis] = moved
        return off, slopes

    def solved(self, off, slopes, height, displaced) -> tuple[np.ndarray, np.ndarray, float]:
        """The step, the covariance of what it ends at, and the noise. What is known beforehand: height and
        displacements, as in the fit; neighbouring points count for less than as many independent ones."""
        expected, fit = self.made.expected, self.made.fit
        noise = max(LEAST_NOISE_MM, 1.4826 * float(np.median(np.abs(off))))
        weight = np.clip(1 - (off / (MAX_RESIDUAL_SIGMAS * noise)) ** 2, 0.0, 1.0)  # the root of Tukey's
        alike = noise * np.sqrt(fit.samples / max(fit.effective_samples, 1.0))
        first = slopes.shape[1] - 1 - displaced.size
        known = np.zeros((1 + displaced.size, slopes.shape[1]))
        known[0, first] = 1 / expected.height_mm.sigma
        known[1:, first + 1 :] = np.eye(displaced.size) / expected.displacement_mm
        usual = np.append(
            (expected.height_mm.value - height) / expected.height_mm.sigma,
            -displaced.ravel() / expected.displacement_mm,
        )
        both = np.vstack([slopes * (weight / alike)[:, None], known])
        right_side = np.append(-off * weight / alike, usual)
        inverse = np.linalg.inv(both.T @ both)
        # common shift of all edges, painted or measured on dabs
        together = float(np.hypot(self.made.edge_mm, _unsure_mm(self.own)))
        moved = inverse @ both.T[:, : len(off)] @ (weight / alike * together)
        covariance = inverse + np.outer(moved, moved)
        return inverse @ both.T @ right_side, covariance, noise

    def _painted(self, lag, height: float) -> list:
        brush = _with_lag(self.own, lag, self.own.name)
        passes = []
        for mark, residual in zip(self.made.painted.marks, self.made.fit.marks, strict=True):
            poses = np.array(residual.way_mm)
            depth = np.clip(height - poses[:, 2], 0.0, brush.depth_range_mm[1])
            passes.append(_core.Pass(mark.stroke, np.column_stack([poses[:, :2], -depth])))
        painted = _core.simulate(_core.Plan(brush.name, "", (1.0, 1.0), passes), brush)
        _core.trace_outlines(painted, brush)
        return [[np.array(ring) for ring in one.outline_mm] for one in painted.passes]

    def _off(self, painted: list, displaced: np.ndarray) -> np.ndarray:
        return np.concatenate(
            [
                _outward(points - by, rings)
                for points, by, rings in zip(self.points, displaced, painted, strict=True)
            ]
        )


def _outward(points: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """Distances of points from a mark's edge, negative inside."""
    away = np.full(len(points), -np.inf)
    for is_hole in (False, True):
        for ring in rings:
            if (signed_area(ring) < 0) != is_hole:
                continue
            contour = ring.astype(np.float32)
            inside = np.array([cv2.pointPolygonTest(contour, (x, y), True) for x, y in points.tolist()])
            away = np.minimum(away, -inside) if is_hole else np.maximum(away, inside)
    return -away


def _raised(law, by) -> np.ndarray:
    """The sum of two polynomials."""
    out = np.zeros(max(len(law), len(by)))
    out[: len(law)] += law
    out[: len(by)] += by
    return out


def _raised_covariance(made: MarkCalibration, of_step: np.ndarray) -> np.ndarray:
    """Of the lag's coefficients: of what was found here, and where the fit has more of them, of that part of it which
    so few do not follow."""
    fitted = np.array(made.covariance)[: len(made.fit.laws.lag), : len(made.fit.laws.lag)]
    few, many = len(of_step), max(len(of_step), len(fitted))
    out = np.zeros((many, many))
    out[:few, :few] = of_step
    if many > few:
        share = np.linspace(0.0, made.expected.deepest_mm, 41)[1:]
        powers = np.vander(share, many, increasing=True)
        followed = np.zeros((many, many))
        followed[:few] = np.linalg.lstsq(powers[:, :few], powers, rcond=None)[0]
        rest = np.eye(many) - followed
        out += rest @ fitted @ rest.T
    return out


def _unsure_mm(own: _core.Brush) -> float:
    """Of the outlines, as their brush file says."""
    said = json.loads(own.extra or "{}").get("footprints", {}).get("standard_error_mm", 0.0)
    return float(said) if isinstance(said, (int, float)) and np.isfinite(said) else 0.0


def refuse_assumed(own: _core.Brush) -> None:
    if json.loads(own.extra or "{}").get("footprints", {}).get("assumed", True):
        raise Error(
            f"the outlines of brush {own.name} are assumed, not measured: measure them first, by a photograph of dabs",
            "footprints",
            code="footprints-assumed",
        )


def _refuse_shallow(own: _core.Brush, deepest_mm: float) -> None:
    least, deepest = own.depth_range_mm
    if deepest_mm > deepest + 1e-6:
        raise Error(
            f"the strokes were painted {deepest_mm:g} mm deep, brush {own.name} may be pressed {least:g} to "
            f"{deepest:g} mm: its dabs must be as deep as the strokes",
            "depth_range_mm",
            deepest_mm,
            code="depth-out-of-range",
        )


def _refuse_far(lag, fitted_lag, depths: np.ndarray, own: _core.Brush) -> None:
    usual, now = polyval(depths, fitted_lag), polyval(depths, lag)
    share = np.abs(now - usual) / np.maximum(usual, usual.max() / 4)
    worst = int(share.argmax())
    if share[worst] > FARTHEST or polyval(np.append(0.0, depths), lag).min() < 0:
        raise Error(
            f"by the outlines of brush {own.name} the lag at depth {depths[worst]:.3g} mm would be {now[worst]:.1f} mm "
            f"where it is {usual[worst]:.1f} mm by the marks alone, more than {100 * FARTHEST:g} % off: are strokes "
            "and dabs of one brush?",
            "lag",
            float(now[worst]),
            code="dabs-of-another-brush",
        )


def _with_lag(own: _core.Brush, lag, name: str) -> _core.Brush:
    brush = _core.read_brush(_core.write_brush(own))
    brush.name, brush.covariance = name, []
    brush.lag = _core.Profile(np.asarray(lag).tolist())
    return brush


def _joined(own: _core.Brush, brush: _core.Brush, of_lag: np.ndarray) -> np.ndarray:
    """Covariance over the coefficients of the brush: of the lag as it was found, of the others as they were. The lag
    was found from the places of tips, so it is off by what the tip gap is off, the other way."""
    at, was = places(brush), places(own)
    out = np.zeros((at[LAWS[-1]].stop,) * 2)
    out[: len(of_lag), : len(of_lag)] = of_lag
    known = np.array(own.covariance)
    if len(known):
        others = slice(at["lag"].stop, None)
        out[others, others] = known[was["lag"].stop :, was["lag"].stop :]
        gap = at["tip_gap"]
        powers = gap.stop - gap.start
        out[:powers, :powers] += out[gap, gap]
        out[:powers, others] -= out[gap, others]
        out[others, :powers] -= out[others, gap]
    return out
