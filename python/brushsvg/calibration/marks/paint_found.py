"""Fit how marks narrow along the path since the last dip.

The rate is fitted together with the brush, to a sheet that was painted with one load.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...errors import Error
from ...geometry.polylines import lengths
from ...geometry.rotation import rotation
from .from_marks import MarkCalibration, brush_of, calibrate_marks, expected_fit, simulate_fitted_brush
from .ink_depletion import find_ink_depletion
from .mark_input import Painted, measure_paths_before_mm, to_painted
from .mark_report import predict_outlines

MAX_ROUNDS = 8  # rounds of correcting the rate
# The rate has settled if its change is below this share of its standard deviation. The variance then grows by 4 %.
# Fits of equal marks differ by up to 0.2.
SETTLED_SIGMAS = 0.3
# Least share of the growth of the path that depth does not explain. With less, the interval is 1.5 times as wide, and a
# width law outside the family looks like paint that runs out.
MIN_UNEXPLAINED_SHARE = 0.45
MAX_RESIDUAL_SIGMAS = 4.0  # standard deviations of the edges
FLANK_RANGE_HALF_WIDTHS = (0.5, 1.5)  # half widths from the middle: flanks, without the paint of ends and crossings
STEP_MM = 0.5  # spacing of the places along a stroke
RATE_STEP_SIGMAS = 3.0  # standard deviations between two rates whose effects on the fit are compared
MIN_KEPT_SHARE = 0.2  # least share of a rate error that the fit leaves in the residuals
# Rate per metre by which marks may seem to widen. Strokes whose shapes differ early and late cause some of it.
MAX_WIDENING_PER_M = 0.1
MIN_SPARE_MARKS = 3  # least number of marks in addition to the number of unknowns


def calibrate_paint(painted: Painted, name: str, *args, **kwargs) -> MarkCalibration:
    """Fit a brush to marks that narrow because of a single load of paint.

    painted, name and the other arguments: as for calibrate_marks(). The laws of the brush are those of the freshly
    dipped brush, and its paint gives the rate at which marks narrow.

    The fit gets the marks as a freshly dipped brush would have painted them: each edge is moved outwards by the width
    that is lost. The rate is right when the residuals of the edges no longer depend on the path. The intervals of the
    laws include the uncertainty of the rate. If the last strokes of the plan are missing or broken, the paint lasts up
    to the last whole mark. If marks seem to widen a little, the rate is 0.

    Raises Error if path and depth grow together, so that narrower and shallower marks look alike; if marks get much
    wider; and if the rate does not settle.
    """
    rate, fresh, rate_errors = 0.0, painted, []
    for _ in range(MAX_ROUNDS):
        calibration = calibrate_marks(fresh, name, *args, **kwargs)
        change, sigma, freedom = _estimate_rate_error(calibration)
        rate_errors.append((rate, change))
        rate += change
        fresh = restore_fresh_marks(painted, calibration, rate)
        if abs(change) < SETTLED_SIGMAS * sigma:
            break
    else:
        sentence = f"the fit of how fast marks narrow did not converge, the last change was {change:.2g} per metre"
        raise Error(sentence, "paint", change, code="paint-undetermined")
    if abs(rate_errors[-1][0] - rate_errors[0][0]) < RATE_STEP_SIGMAS * sigma:
        other_rate = rate_errors[-1][0] + RATE_STEP_SIGMAS * sigma
        fit_with_other = calibrate_marks(restore_fresh_marks(painted, calibration, other_rate), name, *args, **kwargs)
        rate_errors = [(other_rate, _estimate_rate_error(fit_with_other)[0]), rate_errors[-1]]
    sigma /= _share_in_residuals(rate_errors[0], rate_errors[-1])
    deviations = _core.interval_factor_95(freedom)
    if rate < -MAX_WIDENING_PER_M and rate + deviations * sigma < 0:
        sentence = (
            f"marks get wider by {-rate:.2g} +- {deviations * sigma:.2g} per metre along the job: paint the chart with "
            "one load, without dips in between"
        )
        raise Error(sentence, "paint", rate, code="paint-undetermined")
    if rate < 0:  # the marks do not narrow, so the interval must include 0
        sigma, rate, fresh = max(sigma, -rate / deviations), 0.0, painted
    calibration = calibrate_marks(
        fresh, name, *args, **kwargs, off=restore_fresh_marks(painted, calibration, rate + sigma)
    )
    last_mm = max(painted.before_mm[mark.stroke] + _path_lengths(mark)[-1] for mark in calibration.painted.marks)
    dry = find_ink_depletion(fresh, predict_outlines(calibration, fresh.marks))
    calibration.brush.paint = _core.Paint(
        rate,
        lasts_mm=dry.whole_mm if dry else None,
        calibrated_mm=(0.0, last_mm),
        source=f"Fitted to {len(calibration.painted.marks)} marks painted with one load.",
        covariance=[[sigma**2, 0.0], [0.0, dry.variance_mm2]] if dry else [[sigma**2]],
        degrees_of_freedom=freedom,
    )
    calibration = replace(calibration, painted=replace(calibration.painted, before_mm=painted.before_mm))
    return replace(calibration, paint_bends=_measure_curvature(calibration), dry=dry)


def _share_in_residuals(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Return the share of a rate error that stays in the residuals.

    The rest of the error changes the laws.

    one, other: two pairs of a rate and the error of the rate that remained with it.
    """
    return float(np.clip((one[1] - other[1]) / (other[0] - one[0]), MIN_KEPT_SHARE, 1.0))


def restore_fresh_marks(painted: Painted, calibration: MarkCalibration, rate_per_m: float) -> Painted:
    """Return the marks of a brush that is freshly dipped everywhere.

    Edges are moved away from the path of the widest section by the width that is lost.
    """
    brush, traces = simulate_fitted_brush(calibration, painted.marks)
    fit, turned = calibration.fit, rotation(calibration.fit.turn_rad)
    centre = np.array(fit.centre_mm)
    residuals = dict(zip((original.stroke for original in calibration.painted.marks), fit.marks, strict=True))
    paint = _core.Paint(abs(rate_per_m))
    marks = []
    for mark, trace in zip(painted.marks, traces, strict=True):
        displacement = np.array(residuals[mark.stroke].displacement_mm) if mark.stroke in residuals else np.zeros(2)
        locator = SectionLocator(brush, trace, painted.before_mm[mark.stroke])
        rings = []
        for ring in map(np.asarray, mark.outline_mm):
            at = locator.locate((ring - fit.shift_mm - centre) @ turned.T + centre - displacement)
            shares = np.array([paint.width_share(way) for way in at.way_mm])
            growth = 1 / shares - 1 if rate_per_m > 0 else shares - 1
            rings.append(ring + (growth * at.across_mm)[:, None] * (at.normal @ turned))
        marks.append(_core.PaintedMark(mark.stroke, np.array(mark.poses_mm), rings, mark.arcs))
    return replace(painted, marks=marks)


@dataclass(frozen=True)
class NearestSections:
    """The place of the widest section that is nearest to each point.

    depth_mm, way_mm: depth of the brush and path length there. across_mm: distance of the point to the left of the
    section. normal: unit vector to the left. ends_mm: path length to the nearer end of the stroke.
    """

    depth_mm: np.ndarray
    way_mm: np.ndarray
    across_mm: np.ndarray
    normal: np.ndarray
    ends_mm: np.ndarray


class SectionLocator:
    """Locates points relative to the path of the widest section."""

    def __init__(self, brush, trace, before_mm: float) -> None:
        down = np.flatnonzero(np.asarray(trace.depth_mm) >= 0)
        widest = _core.widest_points(trace, brush)[down]
        heading = np.unwrap(np.asarray(trace.heading_rad)[down])
        at = lengths(widest)
        fine = np.union1d(at, np.arange(0.0, at[-1], STEP_MM))  # straight lines only have rows at their ends

        def between(values):
            return np.interp(fine, at, values)

        heading, self.depth_mm = between(heading), between(np.asarray(trace.depth_mm)[down])
        self.widest_mm = np.column_stack([between(column) for column in widest.T])
        self.normals = np.column_stack([-np.sin(heading), np.cos(heading)])
        self.ways_mm = before_mm + between(lengths(np.asarray(trace.tcp_mm)[down]))
        self.along_mm = fine

    def locate(self, points: np.ndarray) -> NearestSections:
        row = np.concatenate(
            [
                ((part[:, None] - self.widest_mm) ** 2).sum(axis=2).argmin(axis=1)
                for part in np.array_split(points, len(points) // 256 + 1)
            ]
        )
        normal = self.normals[row]
        across = ((points - self.widest_mm[row]) * normal).sum(axis=1)
        ends = np.minimum(self.along_mm[row], self.along_mm[-1] - self.along_mm[row])
        return NearestSections(self.depth_mm[row], self.ways_mm[row], across, normal, ends)


@dataclass(frozen=True)
class ExpectedPaint:
    """The expected accuracy of the rate at which marks narrow.

    half_per_m: half the 95 % interval of the rate per metre. explained_by_depth: share of the growth of the path that
    the depth explains. way_mm: path length that one load must last.
    """

    half_per_m: float
    explained_by_depth: float
    way_mm: float

    @property
    def is_refused(self) -> bool:
        return 1 - self.explained_by_depth < MIN_UNEXPLAINED_SHARE


def expected_paint(plan: _core.Plan, brush: _core.Brush, noise_mm: float, painted: list) -> ExpectedPaint:
    """Predict how well a plan will determine the rate, before it is painted.

    The plan is painted with one load.

    painted: the result of expected_marks(plan, brush).
    """
    options = _core.MarkOptions()
    fit = expected_fit(painted, plan, brush, noise_mm, options)
    before_mm, _ = measure_paths_before_mm({plan_pass.stroke: plan_pass for plan_pass in plan.passes})
    complete = replace(to_painted(painted), before_mm=before_mm)
    calibration = MarkCalibration(brush_of(fit.laws, brush.name, brush.depth_range_mm), fit, complete, options)
    flanks = _collect_flanks(calibration)
    own = flanks.own()
    correlation = np.exp(-options.spacing_mm / 1.0)  # neighbouring points are correlated, over 1 mm
    sigma = noise_mm * np.sqrt((1 + correlation) / (1 - correlation) / float(own @ own))
    half = _core.interval_factor_95(flanks.freedom) * sigma
    last_mm = max(complete.before_mm[mark.stroke] + _path_lengths(mark)[-1] for mark in complete.marks)
    return ExpectedPaint(float(half), flanks.explained_by_depth(), float(last_mm))


@dataclass(frozen=True)
class Flanks:
    """Points of the edges along the middle line, one per row.

    moved: outward shift of the edge [mm] for a narrowing of 1 per metre. half_mm: half width. powers: powers of the
    depth. off_mm: residual of the edge. of_mark: number of the mark of the point.
    """

    moved: np.ndarray
    half_mm: np.ndarray
    powers: np.ndarray
    off_mm: np.ndarray
    of_mark: np.ndarray

    @property
    def freedom(self) -> float:
        return float(len(np.unique(self.of_mark)) - self.powers.shape[1] - 1)

    def marks(self) -> list[np.ndarray]:
        """Return one mask per mark that selects its points."""
        return [self.of_mark == number for number in np.unique(self.of_mark)]

    def own(self) -> np.ndarray:
        """Return the part of `moved` that neither width laws nor height explain."""
        return remove_powers(self.moved, self.powers)

    def explained_by_depth(self) -> float:
        """Return the share of the variation of `moved` that the depth explains.

        The variation is the difference from the shift that a single path length for all points would cause.
        """
        way = float(self.moved @ self.half_mm) / float(self.half_mm @ self.half_mm)
        about, own = self.moved - way * self.half_mm, self.own()
        return 1 - float(own @ own) / max(float(about @ about), 1e-12)


def remove_powers(values: np.ndarray, powers: np.ndarray) -> np.ndarray:
    return values - powers @ np.linalg.lstsq(powers, values, rcond=None)[0]


def _collect_flanks(calibration: MarkCalibration) -> Flanks:
    brush, traces = simulate_fitted_brush(calibration, calibration.painted.marks)
    astray = {stray.mark.stroke for stray in calibration.strays}
    blocks = []
    for number, (residual, trace) in enumerate(zip(calibration.fit.marks, traces, strict=True)):
        if trace.stroke in astray or residual.outlier:
            continue
        at = SectionLocator(brush, trace, calibration.painted.before_mm[trace.stroke]).locate(
            np.asarray(residual.point_mm)
        )
        half = np.array([brush.half_width(d) for d in at.depth_mm])
        end_zone_mm = np.array([brush.tip_to_widest(d) for d in at.depth_mm]) + half
        share = np.abs(at.across_mm) / np.maximum(half, 1e-6)
        distance = np.asarray(residual.distance_mm)
        is_flank = (
            (share > FLANK_RANGE_HALF_WIDTHS[0]) & (share < FLANK_RANGE_HALF_WIDTHS[1]) & (at.ends_mm > end_zone_mm)
        )
        is_flank &= np.abs(distance) < MAX_RESIDUAL_SIGMAS * calibration.fit.noise_mm
        powers = at.depth_mm[:, None] ** np.arange(3 if calibration.painted.depths > 1 else 1)
        rows = np.column_stack([-1e-3 * half * at.way_mm, half, distance, np.full(len(half), number), powers])
        blocks.append(rows[is_flank])
    rows = np.vstack(blocks) if blocks else np.empty((0, 5))
    marks = len(np.unique(rows[:, 3]))
    if marks < MIN_SPARE_MARKS + 4:
        sentence = f"only {marks} marks show both edges clear of ends, at least {MIN_SPARE_MARKS + 4} are needed"
        raise Error(sentence, "paint", code="paint-undetermined")
    return Flanks(rows[:, 0], rows[:, 1], rows[:, 4:], rows[:, 2], rows[:, 3])


def _estimate_rate_error(calibration: MarkCalibration) -> tuple[float, float, float]:
    """Estimate the error of the rate from the residuals of the edges.

    The marks were restored with this rate.

    The error per metre is fitted by least squares as the effect of narrowing, together with powers of the depth. Its
    standard deviation is estimated by whole marks, because the points of a mark are correlated. The contribution of
    each mark is multiplied by the change of the rate without it, because the residuals of the few decisive marks are
    smaller than their errors (HC2 of MacKinnon and White, 1985, by marks).

    Return the error of the rate, its standard deviation and the degrees of freedom.
    """
    flanks = _collect_flanks(calibration)
    explained = flanks.explained_by_depth()
    if 1 - explained < MIN_UNEXPLAINED_SHARE:
        raise Error(
            f"depth explains {100 * explained:.0f} % of how far each stroke is from the dip, so less paint looks like "
            "less depth: paint strokes of each depth both early and late, as `brushsvg chart --paint` does",
            "paint",
            code="paint-undetermined",
        )
    columns, own = np.column_stack([flanks.moved, flanks.powers]), flanks.own()
    rate = _fit_first_number(columns, flanks.off_mm)
    residuals = remove_powers(flanks.off_mm, flanks.powers) - rate * own
    contributions = np.array([float((own * residuals)[mark].sum()) for mark in flanks.marks()]) / float(own @ own)
    rates_without = _refit_without_each(columns, flanks)
    return rate, float(np.sqrt(max(contributions @ (rate - rates_without), 0.0))), flanks.freedom


def _measure_curvature(calibration: MarkCalibration) -> float:
    """Return how strongly the residuals depend on the square of the path.

    The dependence is in addition to the path itself.

    The unit is its standard deviation, from leaving out marks one by one.
    """
    flanks = _collect_flanks(calibration)
    ways = -1e3 * flanks.moved / np.maximum(flanks.half_mm, 1e-9)
    columns = np.column_stack([flanks.moved * ways, flanks.moved, flanks.powers])
    bend, without = _fit_first_number(columns, flanks.off_mm), _refit_without_each(columns, flanks)
    return abs(bend) / max(float(np.sqrt((len(without) - 1) * without.var())), 1e-15)


def _refit_without_each(columns: np.ndarray, flanks: Flanks) -> np.ndarray:
    """Return the first fitted number (m,) with each of the m marks left out in turn."""
    return np.array([_fit_first_number(columns[~mark], flanks.off_mm[~mark]) for mark in flanks.marks()])


def _fit_first_number(columns: np.ndarray, values: np.ndarray) -> float:
    return float(np.linalg.lstsq(columns, values, rcond=None)[0][0])


def _path_lengths(mark) -> np.ndarray:
    return lengths(np.asarray(mark.poses_mm)[:, :2])
