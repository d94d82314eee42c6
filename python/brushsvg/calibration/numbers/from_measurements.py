"""Measurements to a brush: each law fitted to what speaks of it, with its covariance, and a report in words."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ...model import footprint_shapes
from ...model.confidence import half_interval_mm
from ...model.laws.fitted import need_fits
from . import plausibility
from .angle_series import read_series, scatter_of_series
from .centre_lines import Turn, read_turn, read_turn_near
from .from_widths import GAP_PER_HALF, WIDEST_PER_HALF, outlines_assumed
from .joint_fit import EXACT_MM, LEAST_MM, Reading, Together, fit_together
from .measurements import Measurements, Row

LAWS = ("lag", "tip_gap", "tip_to_widest", "half_width")
# The article's laws: r quartic, b linear through 0, x_w cubic with floor 0; the width, of which it prints none, rises
# from 0 as a parabola.
DEGREES = {"lag": 4, "tip_gap": 1, "tip_to_widest": 3, "half_width": 2}
FROM_ZERO = ("tip_gap", "half_width")
# What is assumed of a round brush where nothing was measured, in half widths from the tip.
ASSUMED = {
    "tip_gap": (GAP_PER_HALF, "The centre of friction"),
    "tip_to_widest": (WIDEST_PER_HALF, "The widest section"),
}
FLOOR_PER_HALF = 0.3  # nearer to the tip the widest section is not drawn: the flanks would fold into a line
SUMS = ("angular", "straight", "side_view", "video")  # these say how long r + b is, and nothing of either
FROM_TOUCH = ("side_view", "video")  # counted from first touch
OUTLINES = 10
TURN = ({"lag": 1}, {"lag": 1, "tip_gap": 1, "tip_to_widest": -1})  # the lengths of Turn: r, and r - e
MOST_CHANGES = 5  # of the signs that centre lines are read with
MOST_STEPS = 20  # of Gauss and Newton
READ_TO_MM = 0.01  # nobody reads points finer: lines that fit better than this are equally certain
OPEN_SHARE = 0.025  # a reading less likely than this is left out of 95 % intervals


@dataclass(frozen=True)
class Point:
    """A law's value at a depth [mm], and the measurement it comes from.

    scatter: its standard deviation by that of others of its kind."""

    where: str
    depth_mm: float
    value_mm: float
    scatter: float = 1.0


@dataclass(frozen=True)
class Fitted:
    """One law: its points and fit, None where it is assumed; remarks in sentences; outliers by index of their point."""

    name: str
    points: tuple[Point, ...]
    fit: _core.LawFit | None
    remarks: tuple[str, ...] = ()
    outliers: dict[int, plausibility.Outlier] = field(default_factory=dict)

    def list_outliers(self) -> list[str]:
        """A sentence for each outlier, the farthest first."""
        return [
            f"{self.points[k].where} is an outlier: {found.off_mm:+.2f} mm off the law of the others, studentized "
            f"residual {found.size:.1f}, bound {plausibility.OUTLYING:g}: measure it again"
            for k, found in sorted(self.outliers.items(), key=lambda item: -abs(item[1].off_mm))
        ]


@dataclass(frozen=True, repr=False)
class Calibration:
    """A brush that can be used, and how each law came about. doubts: notices of what may be, but seldom is."""

    brush: _core.Brush
    laws: tuple[Fitted, ...]
    remarks: tuple[str, ...]
    doubts: tuple[Notice, ...] = ()

    def __repr__(self) -> str:
        return f"<Calibration of {self.brush!r}, {len(self.remarks)} remarks>"


def calibrate(measured: Measurements, name: str, absolute: bool = False, total: bool = False) -> Calibration:
    """Fit a brush. absolute: least absolute residuals; total: total least squares for angle series.

    Raises Error where the measurements leave a law open, or give a brush that cannot be used.
    """
    need_fits()
    plausibility.refuse_halves_as_widths(measured.rows)
    turns = {
        row.where: read_turn(row.numbers["points_mm"], row.where)
        for row in measured.rows.get("centre_line", [])
    }
    maker = _Maker(measured, absolute, turns)
    points, remarks = _direct(measured, total, turns)
    maker.fit("half_width", points)
    if "half_width" not in maker.done:
        raise Error(
            "no width was measured: add half_width or width, one row per depth",
            "half_width",
            code="measurement-missing",
        )
    maker.fit("tip_to_widest", points)
    maker.fit("tip_gap", points)
    maker.fit("lag", points)
    if measured.rows.get("angles"):
        maker.weigh_angles(points, total)
    maker.fit_sums(points)
    if "lag" not in maker.done:
        raise Error(
            "no lag was measured: add lag, centre_line, angles or angular, one row per depth",
            "lag",
            code="measurement-missing",
        )
    brush = maker.brush(name or measured.name or "measured")
    laws = tuple(maker.done.get(law, Fitted(law, (), None)) for law in LAWS)
    plausibility.refuse_brush(brush)
    for law in ("lag", "half_width"):  # the laws that matter for a plan
        plausibility.refuse_open(brush, maker.done[law])
    return Calibration(brush, laws, (*remarks, *maker.remarks), tuple(plausibility.odd(brush, laws)))


def _direct(
    measured: Measurements, total: bool, turns: dict[str, Turn]
) -> tuple[dict[str, list[Point]], list[str]]:
    """Values of single laws, those of angle series and of the decay of turns included."""
    points: dict[str, list[Point]] = {law: [] for law in LAWS}
    remarks = []
    for law in LAWS:
        points[law] = [Point(r.where, r.depth_mm, r.numbers["value_mm"]) for r in measured.rows.get(law, [])]
    for row in measured.rows.get("width", []):
        points["half_width"].append(Point(row.where, row.depth_mm, row.numbers["value_mm"] / 2))
    for row in measured.rows.get("centre_line", []):
        points["lag"].append(Point(row.where, row.depth_mm, turns[row.where].lag_mm))
    for row in measured.rows.get("angles", []):
        found = read_series(row, total)
        points["lag"].append(Point(row.where, row.depth_mm, found["lag_mm"]))
        if math.isfinite(found["tip_gap_mm"]):
            points["tip_gap"].append(Point(row.where, row.depth_mm, found["tip_gap_mm"]))
        if found["left_out"]:
            sentence = (
                f"{found['left_out']} readings left out: their angle is not between 0 and the first one"
            )
            remarks.append(f"{row.where}: {sentence}")
    return points, remarks


def _degree(law: str, depths_mm: list[float]) -> tuple[int, list[str]]:
    """Of a law that so many values speak of, and a remark where it is less than usual."""
    different = plausibility.different(depths_mm)
    # two values for each coefficient, or the law would follow their noise
    coefficients = min(different, max(2, math.ceil(len(depths_mm) / 2)))
    degree = min(DEGREES[law], coefficients if law in FROM_ZERO else coefficients - 1)
    if degree == DEGREES[law]:
        return degree, []
    few = f"{different} depths" if coefficients == different else f"{len(depths_mm)} values"
    return degree, [f"of degree {degree} instead of {DEGREES[law]}, for there are {few}"]


class _Maker:
    def __init__(self, measured: Measurements, absolute: bool, turns: dict[str, Turn]):
        self.measured = measured
        self.range_mm = measured.depth_range_mm or (0.0, measured.depths_mm[-1])
        self.norm = _core.Norm.absolute if absolute else _core.Norm.squares
        self.done: dict[str, Fitted] = {}
        self.remarks: list[str] = []
        self.turns = turns
        self.joint: Together | None = None

    def fit(self, law: str, points: dict[str, list[Point]]) -> None:
        if points[law]:
            self._fit(law, points[law])

    def weigh_angles(self, points: dict[str, list[Point]], total: bool) -> None:
        """Fit lag and tip gap of angle series anew, each series weighted by what its angles say of it.

        The noise of an angle displaces both in proportion to the lag, so it grows with depth.
        """
        laws = {law: self.done[law].fit.law for law in ("lag", "tip_gap") if law in self.done}
        scatters: dict[str, dict[str, float]] = {law: {} for law in laws}
        for row in self.measured.rows["angles"]:
            lengths = [max(law(row.depth_mm), LEAST_MM) for law in laws.values()]
            found = scatter_of_series(row, lengths[0], lengths[1] if len(lengths) > 1 else 0.0, total)
            for law, scatter in zip(laws, found, strict=False):
                if math.isfinite(scatter):
                    scatters[law][row.where] = scatter
        for law, of in scatters.items():
            if of:
                usual = math.sqrt(np.mean(np.square(list(of.values()))))
                points[law] = [replace(p, scatter=of.get(p.where, usual) / usual) for p in points[law]]
                self.fit(law, points)

    def fit_sums(self, points: dict[str, list[Point]]) -> None:
        """Lag, tip gap and widest section anew, in one fit to all that speaks of them, where sums do."""
        rows = [row for kind in SUMS for row in self.measured.rows.get(kind, [])]
        lines = self.measured.rows.get("centre_line", [])
        if "tip_to_widest" in self.done:
            rows += lines
        elif unsure := [row.where for row in lines if self.turns[row.where].other]:
            self.remarks.append(
                f"{', '.join(unsure)} can be read in two ways; read as if the widest section of the footprint were in "
                "front of the centre of friction. Add rows of tip_to_widest, which decide"
            )
        if not rows:
            return
        if "tip_gap" not in self.done and "lag" not in self.done:
            raise Error(
                "angular, straight, side_view and video all measure the sum of lag and tip gap, so the two cannot be "
                "separated: add centre_line, angles, or rows of lag or tip_gap",
                next(kind for kind in SUMS if kind in self.measured.rows),
                code="law-undetermined",
            )
        for law in ("lag", "tip_gap"):
            if law not in self.done:  # to start from: the sums less the other
                other = self.done["tip_gap" if law == "lag" else "lag"].fit.law
                self._refuse_no_touch(law)
                less = [self._sum(row) - other(row.depth_mm) for row in rows]
                left = [Point(r.where, r.depth_mm, v) for r, v in zip(rows, less, strict=True)]
                self._fit(law, left, to_start_from=True)
        widest = any(row.kind not in FROM_TOUCH for row in rows)
        laws = ("lag", "tip_gap", "tip_to_widest") if widest else ("lag", "tip_gap")
        absolute = self.norm == _core.Norm.absolute
        readings = self._readings(laws, points, rows)
        start = {law: self._to_start_from(law, readings) for law in laws}

        def fit(without: Row | None = None) -> Together:
            kept = self._readings(laws, points, [row for row in rows if row is not without])
            return fit_together(kept, start, self.range_mm, absolute)

        likely = self._choose_turns(fit) if widest else {}
        self.joint = fit()
        if widest and lines:
            self._read_turns_near(lines, fit)
        for where, share in likely.items():
            if share > OPEN_SHARE:
                self._allow_other_sign(where, share, fit)
        readings = self._readings(laws, points, rows)
        self._take(readings, shown="tip_gap" if points["lag"] else "lag")

    def _read_turns_near(self, lines: list[Row], fit) -> None:
        """Read all centre lines from where the laws of all measurements are, until these stay."""
        for _ in range(MOST_STEPS):
            moved = 0.0
            for row in lines:
                (lag, turning), _ = self.joint.predict(row.depth_mm, TURN)
                if min(lag, turning) < LEAST_MM:
                    continue
                before = self.turns[row.where]
                after = read_turn_near(row.numbers["points_mm"], lag, turning)
                self.turns[row.where] = replace(after, other=before.other)
                moved = max(
                    moved, abs(after.lag_mm - before.lag_mm), abs(after.turning_mm - before.turning_mm)
                )
            self.joint = fit()
            if moved < READ_TO_MM / 10:
                break

    def _choose_turns(self, fit) -> dict[str, float]:
        """Read each centre line that allows both signs of e with the one that all other measurements agree with.

        A law that was fitted to a wrong reading agrees with it, so each line is compared with the laws of the others.
        Returns how likely the other sign is, for each line.
        """
        lines = [row for row in self.measured.rows.get("centre_line", []) if self.turns[row.where].other]
        likely: dict[str, float] = {}
        for _ in range(MOST_CHANGES):
            changed = False
            for row in lines:
                turn = self.turns[row.where]
                others = fit(without=row)
                worse = [self._misfit(row, each, others) for each in (turn, turn.other)]
                likely[row.where] = 1.0 / (1.0 + math.exp(min(0.5 * (worse[1] - worse[0]), 700.0)))
                if worse[1] < worse[0]:
                    self.turns[row.where] = replace(turn.other, other=replace(turn, other=None))
                    likely[row.where] = 1.0 - likely[row.where]
                    changed = True
            if not changed:
                break
        return likely

    def _allow_other_sign(self, where: str, share: float, fit) -> None:
        """Widen the intervals of all laws by what the other reading of a centre line, so likely, would change."""
        turn = self.turns[where]
        self.turns[where] = turn.other
        self.joint = self.joint.widened(fit(), share)
        self.turns[where] = turn
        depth = next(row.depth_mm for row in self.measured.rows["centre_line"] if row.where == where)
        self.remarks.append(
            f"{where} can be read in two ways (lag {turn.lag_mm:.2f} or {turn.other.lag_mm:.2f} mm), and the other "
            f"measurements do not decide which; the confidence intervals allow for both. Measure tip_to_widest at "
            f"depth {depth:g} mm"
        )

    def _misfit(self, row: Row, turn: Turn, others: Together) -> float:
        """-2 ln of the likelihood of a reading of a centre line, by its own points and by the laws of all others."""
        predicted, covariance = others.predict(row.depth_mm, TURN)
        own = np.array(turn.covariance_mm2)
        for kind in others.kinds:  # lines scatter by more than their points do
            if kind.name == row.kind:
                more = np.maximum(kind.weight_scatter, 1.0)
                own = own * np.outer(more, more)
        covariance = covariance + own + EXACT_MM**2 * np.eye(2)
        off = np.array([turn.lag_mm, turn.turning_mm]) - predicted
        by_others = off @ np.linalg.solve(covariance, off) + np.linalg.slogdet(covariance)[1]
        return float(by_others) + turn.freedom * 2.0 * math.log(max(turn.rmse_mm, EXACT_MM))

    def _to_start_from(self, law: str, readings: list[Reading]) -> _core.Profile:
        """The law that was found alone, of the degree that all that speaks of it allows."""
        alone = self.done[law]
        depths = [reading.depth_mm for reading in readings if any(law in of for of in reading.sums)]
        degree, remarks = _degree(law, depths)
        self.done[law] = Fitted(law, alone.points, alone.fit, tuple(remarks))
        found = alone.fit.law
        more = [0.0] * (degree + 1 - len(found.coefficients))
        return _core.Profile([*found.coefficients, *more], floor=found.floor)

    def _refuse_negative(self, law: str, points: tuple[Point, ...], fit: _core.LawFit) -> None:
        """Raise Error for values below 0 on the whole, by more than the law's interval."""
        mean = float(np.mean([point.value_mm for point in points]))
        depths = np.array([point.depth_mm for point in points])
        half = half_interval_mm(fit.covariance, np.array([depths.mean()]), fit.law.degrees_of_freedom)[0]
        if law in ("lag", "tip_gap") and fit.held and mean < -half:
            raise Error(
                f"the {law} is {mean:.3g} mm on the mean of {len(points)} values, the others taken away; it cannot be "
                "negative",
                points[0].where,
                mean,
                code="law-negative",
            )

    def _refuse_no_touch(self, law: str) -> None:
        kind = next((kind for kind in FROM_TOUCH if self.measured.rows.get(kind)), None)
        if law == "lag" and kind:
            raise Error(
                f"{kind} needs the lag at depth 0: add rows of lag, angles or centre_line",
                kind,
                code="measurement-missing",
            )

    def _sum(self, row: Row) -> float:
        """r + b at a depth. The middle of the mark, which angular and centre_line read, is e = x_w - b nearer to the
        TCP's second line than the centre of friction; straight: (17) with the lag it lacks; side_view, video: (18),
        counted from first touch.
        """
        if row.kind in FROM_TOUCH:
            return row.numbers["value_mm"] + self.done["lag"].fit.law(0.0)
        if "tip_to_widest" not in self.done:
            sentence = "this needs the widest section of the footprint: add rows of tip_to_widest"
            raise Error(sentence, row.where, code="law-undetermined")
        widest = self.done["tip_to_widest"].fit.law(row.depth_mm)  # as it was measured, not as it is drawn
        return self._reading(row) + widest

    def _reading(self, row: Row) -> float:
        """The same less the widest section, as it was read."""
        if row.kind == "centre_line":
            return self.turns[row.where].turning_mm
        if row.kind == "straight":
            return row.numbers["path_mm"] - row.numbers["distance_mm"]
        return row.numbers["value_mm"]

    def _readings(self, laws, points: dict[str, list[Point]], rows: list[Row]) -> list[Reading]:
        alone = {
            row.where for row in rows if row.kind == "centre_line"
        }  # these come with what they say of the sum
        out = []
        for law in laws:
            for point in points[law]:
                if point.where not in alone:
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
            touch = row.kind in FROM_TOUCH
            values, sums = (self._reading(row),), (both if touch else both | {"tip_to_widest": -1},)
            own = None
            if row.kind == "centre_line":
                turn = self.turns[row.where]
                values, sums = (turn.lag_mm, *values), ({"lag": 1}, *sums)
                own = turn.covariance_mm2 + READ_TO_MM**2 * np.eye(2)
            out.append(
                Reading(row.kind, row.where, row.depth_mm, values, sums, touch, own_covariance_mm2=own)
            )
        return out

    def _take(self, readings: list[Reading], shown: str) -> None:
        """What was found together: each value is shown at the law that it is of, sums at this one, less the others."""
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
            outliers = plausibility.outliers_of_kinds(left, spare, np.array(scatter), np.array(freedoms))
            self._refuse_negative(law, points, fit)
            self.done[law] = Fitted(law, points, fit, self.done[law].remarks, outliers)
        listed = ", ".join(
            f"{kind.name} ({kind.count}, scatter {' and '.join(f'{mm:.2f}' for mm in kind.scatter_mm)} mm)"
            for kind in found.kinds
        )
        self.remarks.append(f"lag, tip gap and what they are read with were fitted together: {listed}")
        if found.held:
            self.remarks.append(
                "fitted with a constraint: without it the lag or the tip gap is not positive somewhere in the depth "
                "range"
            )

    def _fit(self, law: str, points: list[Point], to_start_from: bool = False) -> None:
        depths, values = [p.depth_mm for p in points], [p.value_mm for p in points]
        worst = min(points, key=lambda point: point.value_mm)
        # a short tip gap may come out below 0 once by its noise, not on the whole
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
        different = plausibility.different(depths)
        if different < 2:
            raise Error(
                f"{law} was measured at depth {depths[0]:g} mm alone: measure it at two depths or more, better five",
                points[0].where,
                code="depths-too-few",
            )
        plausibility.refuse_range(law, max(depths), self.range_mm, points[0].where)
        if law == "lag":
            plausibility.refuse_no_lag(points)
        if law in ("lag", "half_width"):
            plausibility.refuse_falling(law, points)
        degree, remarks = _degree(law, depths)
        widest = law == "tip_to_widest"
        shape = _core.LawShape(
            self.range_mm,
            degree,
            through_zero=law in FROM_ZERO,
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
            what = "falls" if law == "half_width" else "is not positive"
            remarks.append(
                f"fitted with a constraint: without it the law {what} somewhere in the depth range"
            )
        first = int(law in FROM_ZERO)
        if widest:
            outliers = plausibility.outliers_above_floor(depths, values, self.range_mm, degree)
        else:
            free = len(fit.law.coefficients) - first
            outliers = plausibility.outliers(depths, fit.residual_mm, free, first, scatter)
        self.done[law] = Fitted(law, tuple(points), fit, tuple(remarks), outliers)

    def covariance(self) -> np.ndarray | None:
        """Over all coefficients in the order of the laws; None where a fitted law has no value to spare."""
        sizes = [len(self._law(law).coefficients) for law in LAWS]
        ends = np.cumsum([0, *sizes]).tolist()
        place = {law: slice(a, b) for law, a, b in zip(LAWS, ends[:-1], ends[1:], strict=True)}
        out = np.zeros((ends[-1], ends[-1]))
        for law, fitted in self.done.items():
            block = np.array(fitted.fit.covariance)
            if not block.size:
                return None
            out[place[law], place[law]] = block
        if self.joint:
            for a, b in itertools.product(self.joint.places, repeat=2):
                out[place[a], place[b]] = self.joint.covariance[self.joint.places[a], self.joint.places[b]]
        return out

    def _law(self, law: str) -> _core.Profile:
        half = self.done["half_width"].fit.law
        if law not in self.done:
            share, what = ASSUMED[law]
            source = f"{what} is assumed to be {share:g} half widths from the tip."
            return _core.Profile([share * c for c in half.coefficients], source=source, assumed=True)
        points, fitted = self.done[law].points, self.done[law].fit.law
        kinds = sorted({point.where.split("[")[0] for point in points})
        read = "a table" if kinds[0].startswith("line") else " and ".join(kinds)
        deepest = self.range_mm[1]
        return _core.Profile(
            fitted.coefficients,
            floor=fitted.floor,
            floor_slope=FLOOR_PER_HALF * half(deepest) / deepest if law == "tip_to_widest" else 0.0,
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
            setattr(brush, law, self._law(law))
        covariance = self.covariance()
        if covariance is not None:
            brush.covariance = covariance.tolist()
        depths = [least + (deepest - least) * k / OUTLINES for k in range(1, OUTLINES + 1)]
        brush.footprints = _core.FootprintTable([_outline(brush, depth) for depth in depths])
        brush.extra = outlines_assumed("drops whose widest section and width are those of the laws.")
        _core.check(brush)
        return brush


def _outline(brush: _core.Brush, depth: float) -> _core.Footprint:
    half = brush.half_width(depth)
    return _core.Footprint(depth, footprint_shapes.drop(half, brush.tip_to_widest(depth), half))
