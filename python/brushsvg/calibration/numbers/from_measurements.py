"""Fit a brush to measured numbers.

Each law is fitted to the values that determine it, with its covariance and remarks.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ...model import footprint_shapes
from ...model.confidence import LAWS, half_interval_mm
from ...model.laws.fitted import need_fits
from . import plausibility
from .angle_series import read_series, scatter_of_series
from .centre_lines import Turn, read_turn, read_turn_near
from .from_widths import GAP_PER_HALF, WIDEST_PER_HALF, outlines_assumed
from .joint_fit import MIN_LAG_MM, ROUNDING_MM, JointFit, Reading, fit_together
from .measurements import Measurements, Row

# Degrees of the article's laws: r is quartic, b is linear through 0, x_w is cubic with floor 0. The article prints no
# law of the width; it is a parabola that rises from 0.
LAW_DEGREES = {"lag": 4, "tip_gap": 1, "tip_to_widest": 3, "half_width": 2}
LAWS_THROUGH_ZERO = ("tip_gap", "half_width")
# Positions assumed for a round brush where nothing was measured, in half widths from the tip.
ASSUMED_SHARES = {
    "tip_gap": (GAP_PER_HALF, "The centre of friction"),
    "tip_to_widest": (WIDEST_PER_HALF, "The widest section"),
}
# Least distance of the widest section from the tip, in half widths. Nearer to the tip the flanks of the footprint
# would fold into a line.
MIN_WIDEST_PER_HALF_WIDTH = 0.3
SUM_KINDS = ("angular", "straight", "side_view", "video")  # these measure r + b and neither length alone
KINDS_FROM_TOUCH = ("side_view", "video")  # these count from first touch
OUTLINE_COUNT = 10  # number of footprint outlines, evenly spaced in depth
TURN_SUMS = ({"lag": 1}, {"lag": 1, "tip_gap": 1, "tip_to_widest": -1})  # the two lengths of a Turn: r and r - e
MAX_SIGN_ROUNDS = 5  # rounds in which the signs of e may change for centre lines
MAX_GAUSS_NEWTON_STEPS = 20  # Gauss-Newton steps
READING_ERROR_MM = 0.01  # nobody reads points more exactly, so lines that fit better than this are equally certain
MIN_OTHER_PROBABILITY = 0.025  # 95 % intervals ignore a reading that is less likely than this


@dataclass(frozen=True)
class Point:
    """A value of a law at a depth [mm], and the measurement that it comes from.

    scatter: standard deviation of the value, relative to other values of its kind.
    """

    where: str
    depth_mm: float
    value_mm: float
    scatter: float = 1.0


@dataclass(frozen=True)
class Fitted:
    """One fitted law.

    points: the values that it was fitted to. fit: None if the law is assumed. remarks: sentences for the report.
    outliers: by the index of their point.
    """

    name: str
    points: tuple[Point, ...]
    fit: _core.LawFit | None
    remarks: tuple[str, ...] = ()
    outliers: dict[int, plausibility.Outlier] = field(default_factory=dict)

    def list_outliers(self) -> list[str]:
        """Return one sentence per outlier, the largest deviation first."""
        return [
            f"{self.points[k].where} is an outlier, {outlier.off_mm:+.2f} mm from the fit to the other values "
            f"(studentized residual {outlier.size:.1f}, limit {plausibility.MIN_OUTLIER_SIGMAS:g}): measure it again"
            for k, outlier in sorted(self.outliers.items(), key=lambda item: -abs(item[1].off_mm))
        ]


@dataclass(frozen=True, repr=False)
class Calibration:
    """A brush that is ready to use, and the fit of each law.

    remarks: sentences for the report. doubts: notices about values that are possible but rare.
    """

    brush: _core.Brush
    laws: tuple[Fitted, ...]
    remarks: tuple[str, ...]
    doubts: tuple[Notice, ...] = ()

    def __repr__(self) -> str:
        return f"<Calibration of {self.brush!r}, {len(self.remarks)} remarks>"


def calibrate(measured: Measurements, name: str, absolute: bool = False, total: bool = False) -> Calibration:
    """Fit a brush to measured numbers.

    measured: the rows of a measurement file. name: the name of the brush; by default the name in the file. absolute:
    minimise absolute residuals instead of squares. total: use total least squares for angle series.

    Raises Error if the measurements do not determine a law, or if the brush cannot be used.
    """
    need_fits()
    plausibility.refuse_halves_as_widths(measured.rows)
    turns = {row.where: read_turn(row.numbers["points_mm"], row.where) for row in measured.rows.get("centre_line", [])}
    fitter = _LawFitter(measured, absolute, turns)
    points, remarks = _collect_points(measured, total, turns)
    fitter.fit("half_width", points)
    if "half_width" not in fitter.fitted:
        sentence = "no width was measured: add half_width or width, one row per depth"
        raise Error(sentence, "half_width", code="measurement-missing")
    fitter.fit("tip_to_widest", points)
    fitter.fit("tip_gap", points)
    fitter.fit("lag", points)
    if measured.rows.get("angles"):
        fitter.weigh_angles(points, total)
    fitter.fit_sums(points)
    if "lag" not in fitter.fitted:
        sentence = "no lag was measured: add lag, centre_line, angles or angular, one row per depth"
        raise Error(sentence, "lag", code="measurement-missing")
    brush = fitter.brush(name or measured.name or "measured")
    laws = tuple(fitter.fitted.get(law, Fitted(law, (), None)) for law in LAWS)
    plausibility.refuse_inconsistent_laws(brush)
    for law in ("lag", "half_width"):  # a plan only depends on these laws
        plausibility.refuse_undetermined_law(brush, fitter.fitted[law])
    return Calibration(brush, laws, (*remarks, *fitter.remarks), tuple(plausibility.find_odd_values(brush, laws)))


def _collect_points(
    measured: Measurements, total: bool, turns: dict[str, Turn]
) -> tuple[dict[str, list[Point]], list[str]]:
    """Return the points of each law, also from angle series and turns, and remarks on readings left out."""
    points: dict[str, list[Point]] = {law: [] for law in LAWS}
    remarks = []
    for law in LAWS:
        points[law] = [Point(r.where, r.depth_mm, r.numbers["value_mm"]) for r in measured.rows.get(law, [])]
    for row in measured.rows.get("width", []):
        points["half_width"].append(Point(row.where, row.depth_mm, row.numbers["value_mm"] / 2))
    for row in measured.rows.get("centre_line", []):
        points["lag"].append(Point(row.where, row.depth_mm, turns[row.where].lag_mm))
    for row in measured.rows.get("angles", []):
        series = read_series(row, total)
        points["lag"].append(Point(row.where, row.depth_mm, series["lag_mm"]))
        if math.isfinite(series["tip_gap_mm"]):
            points["tip_gap"].append(Point(row.where, row.depth_mm, series["tip_gap_mm"]))
        if series["left_out"]:
            sentence = (
                f"{series['left_out']} readings are left out because their angle is not between 0 and the first angle"
            )
            remarks.append(f"{row.where}: {sentence}")
    return points, remarks


def _choose_degree(law: str, depths_mm: list[float]) -> tuple[int, list[str]]:
    """Return the degree that values at these depths allow, and a remark if it is lower than usual."""
    different = plausibility.count_distinct_depths(depths_mm)
    # Each coefficient needs two values; with fewer, the law would follow their noise.
    coefficients = min(different, max(2, math.ceil(len(depths_mm) / 2)))
    degree = min(LAW_DEGREES[law], coefficients if law in LAWS_THROUGH_ZERO else coefficients - 1)
    if degree == LAW_DEGREES[law]:
        return degree, []
    count = f"{different} depths" if coefficients == different else f"{len(depths_mm)} values"
    return degree, [f"the law has degree {degree} instead of {LAW_DEGREES[law]}, because there are only {count}"]


class _LawFitter:
    """Fits the laws one after the other and assembles the brush.

    fitted: the laws fitted so far. joint: the joint fit of lag, tip gap and widest section, if there was one.
    """

    def __init__(self, measured: Measurements, absolute: bool, turns: dict[str, Turn]):
        self.measured = measured
        self.range_mm = measured.depth_range_mm or (0.0, measured.depths_mm[-1])
        self.norm = _core.Norm.absolute if absolute else _core.Norm.squares
        self.fitted: dict[str, Fitted] = {}
        self.remarks: list[str] = []
        self.turns = turns
        self.joint: JointFit | None = None

    def fit(self, law: str, points: dict[str, list[Point]]) -> None:
        if points[law]:
            self._fit_law(law, points[law])

    def weigh_angles(self, points: dict[str, list[Point]], total: bool) -> None:
        """Fit lag and tip gap again with weighted angle series.

        The weight of a series comes from the scatter that its angles imply.

        The noise of an angle displaces both lengths in proportion to the lag, so their scatter grows with depth.
        """
        laws = {law: self.fitted[law].fit.law for law in ("lag", "tip_gap") if law in self.fitted}
        scatters: dict[str, dict[str, float]] = {law: {} for law in laws}
        for row in self.measured.rows["angles"]:
            lengths = [max(law(row.depth_mm), MIN_LAG_MM) for law in laws.values()]
            series_scatters = scatter_of_series(row, lengths[0], lengths[1] if len(lengths) > 1 else 0.0, total)
            for law, scatter in zip(laws, series_scatters, strict=False):
                if math.isfinite(scatter):
                    scatters[law][row.where] = scatter
        for law, by_row in scatters.items():
            if by_row:
                typical = math.sqrt(np.mean(np.square(list(by_row.values()))))
                points[law] = [replace(p, scatter=by_row.get(p.where, typical) / typical) for p in points[law]]
                self.fit(law, points)

    def fit_sums(self, points: dict[str, list[Point]]) -> None:
        """Fit lag, tip gap and widest section again in one joint fit.

        This needs rows that measure sums of these laws.

        Raises Error if the rows measure only sums, so that lag and tip gap cannot be separated.
        """
        rows = [row for kind in SUM_KINDS for row in self.measured.rows.get(kind, [])]
        lines = self.measured.rows.get("centre_line", [])
        if "tip_to_widest" in self.fitted:
            rows += lines
        elif unclear := [row.where for row in lines if self.turns[row.where].other]:
            self.remarks.append(
                f"{', '.join(unclear)} can be read in two ways. The reading with the widest section of the footprint "
                "in front of the centre of friction is used. Add rows of tip_to_widest to decide"
            )
        if not rows:
            return
        if "tip_gap" not in self.fitted and "lag" not in self.fitted:
            raise Error(
                "angular, straight, side_view and video all measure the sum of lag and tip gap, so the two cannot be "
                "separated: add centre_line, angles, or rows of lag or tip_gap",
                next(kind for kind in SUM_KINDS if kind in self.measured.rows),
                code="law-undetermined",
            )
        for law in ("lag", "tip_gap"):
            if law not in self.fitted:  # start from the measured sums minus the other law
                other_law = self.fitted["tip_gap" if law == "lag" else "lag"].fit.law
                self._refuse_lag_from_touch(law)
                differences = [self._sum(row) - other_law(row.depth_mm) for row in rows]
                remaining_points = [Point(r.where, r.depth_mm, v) for r, v in zip(rows, differences, strict=True)]
                self._fit_law(law, remaining_points, to_start_from=True)
        widest = any(row.kind not in KINDS_FROM_TOUCH for row in rows)
        laws = ("lag", "tip_gap", "tip_to_widest") if widest else ("lag", "tip_gap")
        absolute = self.norm == _core.Norm.absolute
        readings = self._build_readings(laws, points, rows)
        start = {law: self._starting_law(law, readings) for law in laws}

        def fit(without: Row | None = None) -> JointFit:
            kept = self._build_readings(laws, points, [row for row in rows if row is not without])
            return fit_together(kept, start, self.range_mm, absolute)

        other_probabilities = self._choose_turns(fit) if widest else {}
        self.joint = fit()
        if widest and lines:
            self._read_turns_near(lines, fit)
        for where, share in other_probabilities.items():
            if share > MIN_OTHER_PROBABILITY:
                self._allow_other_sign(where, share, fit)
        readings = self._build_readings(laws, points, rows)
        self._store_joint_fit(readings, shown="tip_gap" if points["lag"] else "lag")

    def _read_turns_near(self, lines: list[Row], fit) -> None:
        """Read all centre lines again, first from the joint laws, until the laws stop moving."""
        for _ in range(MAX_GAUSS_NEWTON_STEPS):
            moved = 0.0
            for row in lines:
                (lag, turning), _ = self.joint.predict(row.depth_mm, TURN_SUMS)
                if min(lag, turning) < MIN_LAG_MM:
                    continue
                before = self.turns[row.where]
                after = read_turn_near(row.numbers["points_mm"], lag, turning)
                self.turns[row.where] = replace(after, other=before.other)
                moved = max(moved, abs(after.lag_mm - before.lag_mm), abs(after.turning_mm - before.turning_mm))
            self.joint = fit()
            if moved < READING_ERROR_MM / 10:
                break

    def _choose_turns(self, fit) -> dict[str, float]:
        """Choose the sign of e for each centre line that allows both.

        The chosen sign fits the other measurements.

        A law that was fitted to a wrong reading agrees with that reading. Each line is therefore compared with laws
        that were fitted without it. Return the probability of the rejected sign for each line.
        """
        lines = [row for row in self.measured.rows.get("centre_line", []) if self.turns[row.where].other]
        other_probabilities: dict[str, float] = {}
        for _ in range(MAX_SIGN_ROUNDS):
            changed = False
            for row in lines:
                turn = self.turns[row.where]
                others = fit(without=row)
                misfits = [self._misfit(row, reading, others) for reading in (turn, turn.other)]
                other_probabilities[row.where] = 1.0 / (1.0 + math.exp(min(0.5 * (misfits[1] - misfits[0]), 700.0)))
                if misfits[1] < misfits[0]:
                    self.turns[row.where] = replace(turn.other, other=replace(turn, other=None))
                    other_probabilities[row.where] = 1.0 - other_probabilities[row.where]
                    changed = True
            if not changed:
                break
        return other_probabilities

    def _allow_other_sign(self, where: str, share: float, fit) -> None:
        """Widen all laws' intervals for the other reading of a centre line, which has the probability `share`."""
        turn = self.turns[where]
        self.turns[where] = turn.other
        self.joint = self.joint.widened(fit(), share)
        self.turns[where] = turn
        depth = next(row.depth_mm for row in self.measured.rows["centre_line"] if row.where == where)
        self.remarks.append(
            f"{where} can be read in two ways (lag {turn.lag_mm:.2f} or {turn.other.lag_mm:.2f} mm), and the other "
            f"measurements do not show which is right. The confidence intervals include both. Measure tip_to_widest at "
            f"depth {depth:g} mm"
        )

    def _misfit(self, row: Row, turn: Turn, others: JointFit) -> float:
        """Return -2 ln of the likelihood of a centre line's reading, by its points and the others' laws."""
        predicted, covariance = others.predict(row.depth_mm, TURN_SUMS)
        own_covariance = np.array(turn.covariance_mm2)
        for kind in others.kinds:  # lines scatter more than their points predict
            if kind.name == row.kind:
                factor = np.maximum(kind.weight_scatter, 1.0)
                own_covariance = own_covariance * np.outer(factor, factor)
        covariance = covariance + own_covariance + ROUNDING_MM**2 * np.eye(2)
        deviation = np.array([turn.lag_mm, turn.turning_mm]) - predicted
        by_others = deviation @ np.linalg.solve(covariance, deviation) + np.linalg.slogdet(covariance)[1]
        return float(by_others) + turn.freedom * 2.0 * math.log(max(turn.rmse_mm, ROUNDING_MM))

    def _starting_law(self, law: str, readings: list[Reading]) -> _core.Profile:
        """Return the law fitted alone, raised to the degree that all its readings allow, to start the joint fit."""
        single_fit = self.fitted[law]
        depths = [reading.depth_mm for reading in readings if any(law in law_signs for law_signs in reading.sums)]
        degree, remarks = _choose_degree(law, depths)
        self.fitted[law] = Fitted(law, single_fit.points, single_fit.fit, tuple(remarks))
        profile = single_fit.fit.law
        added = [0.0] * (degree + 1 - len(profile.coefficients))
        return _core.Profile([*profile.coefficients, *added], floor=profile.floor)

    def _refuse_negative(self, law: str, points: tuple[Point, ...], fit: _core.LawFit) -> None:
        """Raise Error if the mean of the values is below 0 by more than half the law's interval."""
        mean = float(np.mean([point.value_mm for point in points]))
        depths = np.array([point.depth_mm for point in points])
        half = half_interval_mm(fit.covariance, np.array([depths.mean()]), fit.law.degrees_of_freedom)[0]
        if law in ("lag", "tip_gap") and fit.held and mean < -half:
            sentence = (
                f"the {law} is {mean:.3g} mm, as a mean of {len(points)} values minus the other lengths, but cannot be "
                "negative: check the signs and units of these values and of the other lengths"
            )
            raise Error(sentence, points[0].where, mean, code="law-negative")

    def _refuse_lag_from_touch(self, law: str) -> None:
        kind = next((kind for kind in KINDS_FROM_TOUCH if self.measured.rows.get(kind)), None)
        if law == "lag" and kind:
            sentence = f"{kind} needs the lag at depth 0: add rows of lag, angles or centre_line"
            raise Error(sentence, kind, code="measurement-missing")

    def _sum(self, row: Row) -> float:
        """Return r + b [mm] at the depth of a row.

        Rows of angular and centre_line read the middle of the mark. It is e = x_w - b nearer to the second line of
        the TCP than the centre of friction. Rows of straight use (17) with the lag that it lacks. Rows of side_view
        and video use (18) and count from first touch.
        """
        if row.kind in KINDS_FROM_TOUCH:
            return row.numbers["value_mm"] + self.fitted["lag"].fit.law(0.0)
        if "tip_to_widest" not in self.fitted:
            sentence = "this needs the widest section of the footprint: add rows of tip_to_widest"
            raise Error(sentence, row.where, code="law-undetermined")
        widest = self.fitted["tip_to_widest"].fit.law(row.depth_mm)  # as measured, not as drawn
        return self._length_of_row(row) + widest

    def _length_of_row(self, row: Row) -> float:
        """Return r + b - x_w [mm], as the row measured it."""
        if row.kind == "centre_line":
            return self.turns[row.where].turning_mm
        if row.kind == "straight":
            return row.numbers["path_mm"] - row.numbers["distance_mm"]
        return row.numbers["value_mm"]

    def _build_readings(self, laws, points: dict[str, list[Point]], rows: list[Row]) -> list[Reading]:
        # Their lag is added below, together with their sum.
        line_rows = {row.where for row in rows if row.kind == "centre_line"}
        out = []
        for law in laws:
            for point in points[law]:
                if point.where not in line_rows:
                    of = point.where.split("[")[0]
                    kind = f"{law} of {of}" if of in ("angles", "centre_line") else law
                    out.append(
                        Reading(
                            kind,
                            point.where,
                            point.depth_mm,
                            (point.value_mm,),
                            ({law: 1},),
                            scatter=point.scatter,
                        )
                    )
        both = {"lag": 1, "tip_gap": 1}
        for row in rows:
            touch = row.kind in KINDS_FROM_TOUCH
            values, sums = (self._length_of_row(row),), (both if touch else both | {"tip_to_widest": -1},)
            own_covariance_mm2 = None
            if row.kind == "centre_line":
                turn = self.turns[row.where]
                values, sums = (turn.lag_mm, *values), ({"lag": 1}, *sums)
                own_covariance_mm2 = turn.covariance_mm2 + READING_ERROR_MM**2 * np.eye(2)
            out.append(
                Reading(
                    row.kind,
                    row.where,
                    row.depth_mm,
                    values,
                    sums,
                    touch,
                    own_covariance_mm2=own_covariance_mm2,
                )
            )
        return out

    def _store_joint_fit(self, readings: list[Reading], shown: str) -> None:
        """Store the joint fit as one Fitted per law.

        A value of a single law becomes a point of that law. A sum becomes a point of the law `shown`, minus the
        other laws.
        """
        found, at = self.joint, 0
        shown_at: dict[str, list] = {law: [] for law in found.laws}
        freedom = {kind.name: kind.freedom for kind in found.kinds}
        for reading in readings:
            for of in reading.sums:
                law = next(iter(of)) if len(of) == 1 else shown
                left, spare = float(found.residual_mm[at]), float(found.spare[at])
                point = Point(reading.where, reading.depth_mm, found.laws[law](reading.depth_mm) + left)
                spread = (freedom[reading.kind], float(found.scatter_mm[at]))
                shown_at[law].append((point, left, spare, *spread))
                at += 1
        for law, rows in shown_at.items():
            points, left, spare, freedoms, scatter = zip(*rows, strict=True)
            left, spare = np.array(left), np.array(spare)
            profile = found.laws[law]
            spread = np.array([point.value_mm for point in points])
            total = float(((spread - spread.mean()) ** 2).sum())
            place = found.places[law]
            fit = _core.LawFit(
                law=_core.Profile(
                    profile.coefficients,
                    floor=profile.floor,
                    calibrated_mm=profile.calibrated_mm,
                    half_interval_95=profile.half_interval_95,
                    rmse_mm=float(np.sqrt(left @ left / max(spare.sum(), 1e-9))),
                    degrees_of_freedom=profile.degrees_of_freedom,
                ),
                covariance=found.covariance[place, place].tolist(),
                residual_mm=left.tolist(),
                r_squared=1.0 - float(left @ left) / total if total > 0.0 else 1.0,
                degrees_of_freedom=profile.degrees_of_freedom,
                held=found.held,
            )
            outliers = plausibility.find_outliers_of_kinds(left, spare, np.array(scatter), np.array(freedoms))
            self._refuse_negative(law, points, fit)
            self.fitted[law] = Fitted(law, points, fit, self.fitted[law].remarks, outliers)
        listed = ", ".join(
            f"{kind.name} ({kind.count}, scatter {' and '.join(f'{mm:.2f}' for mm in kind.scatter_mm)} mm)"
            for kind in found.kinds
        )
        self.remarks.append(f"lag and tip gap were fitted together with other lengths, to these values: {listed}")
        if found.held:
            self.remarks.append(
                "the fit needed a constraint, because the lag or the tip gap would not be positive in the whole depth "
                "range"
            )

    def _fit_law(self, law: str, points: list[Point], to_start_from: bool = False) -> None:
        depths, values = [p.depth_mm for p in points], [p.value_mm for p in points]
        worst = min(points, key=lambda point: point.value_mm)
        # Noise may make a single short tip gap negative, but not the mean of all values.
        if (
            worst.value_mm < 0
            and not to_start_from
            and (law in ("lag", "half_width") or (law == "tip_gap" and np.mean(values) < 0))
        ):
            sentence = (
                f"the {law} is {worst.value_mm:.3g} mm at depth {worst.depth_mm:g} mm; it cannot be negative: "
                "write the length without a sign, or leave the row out"
            )
            raise Error(sentence, worst.where, worst.value_mm, code="law-negative")
        different = plausibility.count_distinct_depths(depths)
        if different < 2:
            raise Error(
                f"{law} was measured only at depth {depths[0]:g} mm: measure it at two depths or more, better five",
                points[0].where,
                code="depths-too-few",
            )
        plausibility.refuse_extrapolation(law, max(depths), self.range_mm, points[0].where)
        if law == "lag":
            plausibility.refuse_no_lag(points)
        if law in ("lag", "half_width"):
            plausibility.refuse_falling(law, depths, [point.value_mm for point in points], points[0].where)
        degree, remarks = _choose_degree(law, depths)
        widest = law == "tip_to_widest"
        shape = _core.LawShape(
            self.range_mm,
            degree,
            through_zero=law in LAWS_THROUGH_ZERO,
            positive=law in ("lag", "tip_gap"),
            rising=law == "half_width",
            norm=self.norm,
            **({"floor": 0.0} if widest else {}),
        )
        scatter = [p.scatter for p in points]
        fit = _core.fit_law(depths, values, shape, scatter)
        if law == "half_width":
            plausibility.refuse_unexplained(law, points, fit)
        if fit.held:
            problem = "fall" if law == "half_width" else "not be positive"
            remarks.append(f"the fit needed a constraint, because the law would {problem} somewhere in the depth range")
        first = int(law in LAWS_THROUGH_ZERO)
        if widest:
            outliers = plausibility.find_outliers_above_floor(depths, values, self.range_mm, degree)
        else:
            free = len(fit.law.coefficients) - first
            outliers = plausibility.find_outliers(depths, fit.residual_mm, free, first, scatter)
        self.fitted[law] = Fitted(law, tuple(points), fit, tuple(remarks), outliers)

    def covariance(self) -> np.ndarray | None:
        """Return the covariance of all coefficients in the order of LAWS.

        Return None if a fitted law has no degree of freedom left.
        """
        sizes = [len(self._build_profile(law).coefficients) for law in LAWS]
        ends = np.cumsum([0, *sizes]).tolist()
        place = {law: slice(a, b) for law, a, b in zip(LAWS, ends[:-1], ends[1:], strict=True)}
        out = np.zeros((ends[-1], ends[-1]))
        for law, fitted in self.fitted.items():
            block = np.array(fitted.fit.covariance)
            if not block.size:
                return None
            out[place[law], place[law]] = block
        if self.joint:
            for a, b in itertools.product(self.joint.places, repeat=2):
                out[place[a], place[b]] = self.joint.covariance[self.joint.places[a], self.joint.places[b]]
        return out

    def _build_profile(self, law: str) -> _core.Profile:
        half = self.fitted["half_width"].fit.law
        if law not in self.fitted:
            share, what = ASSUMED_SHARES[law]
            source = f"{what} is assumed to be {share:g} half widths from the tip."
            return _core.Profile([share * c for c in half.coefficients], source=source, assumed=True)
        points, fitted = self.fitted[law].points, self.fitted[law].fit.law
        kinds = sorted({point.where.split("[")[0] for point in points})
        read = "a table" if kinds[0].startswith("line") else " and ".join(kinds)
        least, deepest = self.range_mm
        # The fitted lag is positive in the depth range. When it is set down, the brush also passes smaller depths.
        has_floor = law == "lag" and least > 0
        return _core.Profile(
            fitted.coefficients,
            floor=0.0 if has_floor else fitted.floor,
            floor_slope=MIN_WIDEST_PER_HALF_WIDTH * half(deepest) / deepest if law == "tip_to_widest" else 0.0,
            calibrated_mm=fitted.calibrated_mm,
            source=f"Fitted to {len(points)} values from {read}.",
            half_interval_95=fitted.half_interval_95,
            rmse_mm=fitted.rmse_mm,
            degrees_of_freedom=fitted.degrees_of_freedom,
        )

    def brush(self, name: str) -> _core.Brush:
        brush = _core.Brush()
        brush.name, brush.kind = name, "round"
        brush.depth_range_mm = self.range_mm
        brush.max_speed_mm_s = self.measured.max_speed_mm_s
        least, deepest = self.range_mm
        brush.paint_depth_mm = (least + deepest) / 2
        for law in LAWS:
            setattr(brush, law, self._build_profile(law))
        covariance = self.covariance()
        if covariance is not None:
            brush.covariance = covariance.tolist()
        depths = [least + (deepest - least) * k / OUTLINE_COUNT for k in range(1, OUTLINE_COUNT + 1)]
        brush.footprints = _core.FootprintTable([_drop_footprint(brush, depth) for depth in depths])
        brush.extra = outlines_assumed("drops with the width and the widest section of the laws.")
        _core.check(brush)
        return brush


def _drop_footprint(brush: _core.Brush, depth: float) -> _core.Footprint:
    half = brush.half_width(depth)
    return _core.Footprint(depth, footprint_shapes.drop(half, brush.tip_to_widest(depth), half))
