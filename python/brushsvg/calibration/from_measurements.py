"""Measurements to a brush: each law fitted to what speaks of it, with its covariance, and a report in words."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from .. import _core
from ..brush import footprint_shapes
from ..brush.confidence import places
from ..errors import Error
from ..laws.fitted import need_fits
from . import plausibility
from .from_widths import GAP_PER_HALF, WIDEST_PER_HALF, outlines_assumed
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
SUMS = ("angular", "straight", "side_view")  # these say how long r + b is, and nothing of either
OUTLINES = 10


@dataclass(frozen=True)
class Point:
    """A law's value at a depth [mm], and the measurement it comes from."""

    where: str
    depth_mm: float
    value_mm: float


@dataclass(frozen=True)
class Fitted:
    """One law: its points and fit, None where it is assumed; remarks in sentences; outliers by index of their point."""

    name: str
    points: tuple[Point, ...]
    fit: object
    remarks: tuple[str, ...] = ()
    outliers: dict[int, plausibility.Outlier] = field(default_factory=dict)

    def outliers_told(self) -> list[str]:
        """A sentence for each outlier, the farthest first."""
        return [
            f"{self.points[k].where} is an outlier: {found.off_mm:+.2f} mm off the law of the others, studentized "
            f"residual {found.size:.1f}, bound {plausibility.OUTLYING:g}: measure it again"
            for k, found in sorted(self.outliers.items(), key=lambda item: -abs(item[1].off_mm))
        ]


@dataclass(frozen=True, repr=False)
class Calibration:
    """A brush that can be used, and how each law came about."""

    brush: _core.Brush
    laws: tuple[Fitted, ...]
    remarks: tuple[str, ...]

    def __repr__(self) -> str:
        return f"<Calibration of {self.brush!r}, {len(self.remarks)} remarks>"


def calibrate(measured: Measurements, name: str, absolute: bool = False, total: bool = False) -> Calibration:
    """Fit a brush. absolute: least absolute residuals; total: total least squares for angle series.

    Raises Error where the measurements leave a law open, or give a brush that cannot be used.
    """
    need_fits()
    plausibility.refuse_halves_as_widths(measured.rows)
    maker = _Maker(measured, absolute)
    points, remarks = _direct(measured, total)
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
    maker.fit_sums(points)
    if "lag" not in maker.done:
        raise Error(
            "no lag was measured: add lag, angles or angular, one row per depth",
            "lag",
            code="measurement-missing",
        )
    brush = maker.brush(name or measured.name or "measured")
    laws = tuple(maker.done.get(law, Fitted(law, (), None)) for law in LAWS)
    plausibility.refuse_brush(brush)
    for law in ("lag", "half_width"):  # what a plan is led by
        plausibility.refuse_open(brush, maker.done[law])
    return Calibration(brush, laws, tuple([*remarks, *maker.remarks, *plausibility.odd(brush, laws)]))


def _direct(measured: Measurements, total: bool) -> tuple[dict[str, list[Point]], list[str]]:
    """Values of single laws, those of angle series included."""
    points: dict[str, list[Point]] = {law: [] for law in LAWS}
    remarks = []
    for law in LAWS:
        points[law] = [Point(r.where, r.depth_mm, r.numbers["value_mm"]) for r in measured.rows.get(law, [])]
    for row in measured.rows.get("width", []):
        points["half_width"].append(Point(row.where, row.depth_mm, row.numbers["value_mm"] / 2))
    for row in measured.rows.get("angles", []):
        found = _of_angles(row, total)
        points["lag"].append(Point(row.where, row.depth_mm, found["lag_mm"]))
        if math.isfinite(found["tip_gap_mm"]):
            points["tip_gap"].append(Point(row.where, row.depth_mm, found["tip_gap_mm"]))
        if found["left_out"]:
            sentence = (
                f"{found['left_out']} readings left out: their angle is not between 0 and the first one"
            )
            remarks.append(f"{row.where}: {sentence}")
    return points, remarks


def _of_angles(row: Row, total: bool) -> dict:
    degrees = math.radians(1.0)
    series = [row.numbers[name] for name in ("alpha0_deg", "s_mm", "alpha_deg")]
    plausibility.refuse_series(row.where, *series)
    try:
        found = _core.from_angles(
            row.numbers["alpha0_deg"] * degrees,
            row.numbers["s_mm"],
            [a * degrees for a in row.numbers["alpha_deg"]],
            [b * degrees for b in row.numbers["beta_deg"]],
            _core.Lines.total if total else _core.Lines.plain,
        )
    except Error as refusal:
        raise Error(str(refusal), row.where, refusal.value, code=refusal.code) from None
    plausibility.refuse_other_start(row.where, *series)
    return found


class _Maker:
    def __init__(self, measured: Measurements, absolute: bool):
        self.measured = measured
        self.range_mm = measured.depth_range_mm or (0.0, measured.depths_mm[-1])
        self.norm = _core.Norm.absolute if absolute else _core.Norm.squares
        self.done: dict[str, Fitted] = {}
        self.remarks: list[str] = []
        self.corrected = ""  # the law that was found from sums
        self.pulls: dict[
            str, np.ndarray
        ] = {}  # law it was corrected by -> change of coefficients per change of those

    def fit(self, law: str, points: dict[str, list[Point]]) -> None:
        if points[law]:
            self._fit(law, points[law])

    def fit_sums(self, points: dict[str, list[Point]]) -> None:
        """r from r + b where b is known, else b from r + b where r is."""
        rows = [row for kind in SUMS for row in self.measured.rows.get(kind, [])]
        if not rows:
            return
        if "tip_gap" not in self.done and "lag" not in self.done:
            raise Error(
                "angular, straight and side_view all measure the sum of lag and tip gap, so the two cannot be told "
                "apart: add angles, or rows of lag or tip_gap",
                next(kind for kind in SUMS if kind in self.measured.rows),
                code="law-undetermined",
            )
        wanted, known = ("lag", "tip_gap") if "tip_gap" in self.done else ("tip_gap", "lag")
        if "lag" in self.done and "tip_gap" in self.done:
            self.remarks.append(
                "angular, straight and side_view are not used: lag and tip gap were measured each"
            )
            return
        law = self.done[known].fit.law
        if self.measured.rows.get("side_view") and wanted == "lag":
            raise Error(
                "side_view needs the lag at depth 0: add rows of lag or angles",
                "side_view",
                code="measurement-missing",
            )
        new = [Point(row.where, row.depth_mm, self._sum(row) - law(row.depth_mm)) for row in rows]
        self._fit(wanted, new)
        self._carry(wanted, known, rows)

    def _sum(self, row: Row) -> float:
        """r + b at a depth. angular reads the middle of the mark, which is e = x_w - b nearer to the TCP's second line
        than the centre of friction; straight: (17) with the lag it lacks; side_view: (18), counted from first touch.
        """
        if "value_mm" in row.numbers and row.kind == "side_view":
            return row.numbers["value_mm"] + self.done["lag"].fit.law(0.0)
        if "tip_to_widest" not in self.done:
            sentence = "this needs the widest section of the footprint: add rows of tip_to_widest"
            raise Error(sentence, row.where, code="law-undetermined")
        widest = self.done["tip_to_widest"].fit.law(row.depth_mm)  # as it was measured, not as it is drawn
        if "path_mm" in row.numbers:
            return row.numbers["path_mm"] - row.numbers["distance_mm"] + widest
        return row.numbers["value_mm"] + widest

    def _fit(self, law: str, points: list[Point]) -> None:
        depths, values = [p.depth_mm for p in points], [p.value_mm for p in points]
        worst = min(points, key=lambda point: point.value_mm)
        # a short tip gap may come out below 0 once by its noise, not on the whole
        if worst.value_mm < 0 and (
            law in ("lag", "half_width") or (law == "tip_gap" and np.mean(values) < 0)
        ):
            sentence = (
                f"the {law} is {worst.value_mm:.3g} mm at depth {worst.depth_mm:g} mm; it cannot be negative"
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
        # two values for each coefficient, or the law would follow their noise
        coefficients = min(different, max(2, math.ceil(len(points) / 2)))
        degree = min(DEGREES[law], coefficients if law in FROM_ZERO else coefficients - 1)
        remarks = []
        if degree < DEGREES[law]:
            few = f"{different} depths" if coefficients == different else f"{len(points)} values"
            remarks.append(f"of degree {degree} instead of {DEGREES[law]}, for there are {few}")
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
        fit = _core.fit_law(depths, values, shape)
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
            outliers = plausibility.outliers(depths, fit.residual_mm, free, first)
        self.done[law] = Fitted(law, tuple(points), fit, tuple(remarks), outliers)

    def _carry(self, wanted: str, known: str, rows: list[Row]) -> None:
        """What the law found from sums inherits from those it was corrected by: with sums y = S - K k + W w its
        coefficients P y, P = (X^T X)^-1 X^T, change by -P K per change of k and by P W per change of w."""
        depths = np.array([row.depth_mm for row in rows])
        size, first = len(self.done[wanted].fit.law.coefficients), int(wanted in FROM_ZERO)
        inverse = np.linalg.pinv(np.vander(depths, size, increasing=True)[:, first:])

        def pull(law: str, rate: np.ndarray) -> None:
            self.pulls[law] = np.zeros((size, rate.shape[1]))
            self.pulls[law][first:] = inverse @ rate

        seen_aside = np.array([row.kind == "side_view" for row in rows])
        rate = -np.vander(depths, len(self.done[known].fit.law.coefficients), increasing=True)
        rate[seen_aside, 0] = 0.0  # r(d) - r(0)
        self.corrected = wanted
        pull(known, rate)
        if "tip_to_widest" in self.done:
            law = self.done["tip_to_widest"].fit.law
            rate = np.vander(depths, len(law.coefficients), increasing=True)
            floored = rate @ law.coefficients < law.floor  # there the law does not move
            rate[seen_aside | floored] = 0.0
            pull("tip_to_widest", rate)

    def covariance(self) -> np.ndarray | None:
        """Over all coefficients in the order of the laws; None where a fitted law has no value to spare."""
        sizes = [len(self._law(law).coefficients) for law in LAWS]
        starts = dict(zip(LAWS, np.cumsum([0, *sizes]).tolist()[:-1], strict=True))
        out = np.zeros((sum(sizes), sum(sizes)))
        for law, fitted in self.done.items():
            block = np.array(fitted.fit.covariance)
            if not block.size:
                return None
            at = slice(starts[law], starts[law] + len(block))
            out[at, at] = block
        place = {law: slice(starts[law], starts[law] + size) for law, size in zip(LAWS, sizes, strict=True)}
        for law, pull in self.pulls.items():
            a, b = place[self.corrected], place[law]
            out[a, a] += pull @ out[b, b] @ pull.T
            out[a, b] = pull @ out[b, b]
            out[b, a] = out[a, b].T
        return out

    def _widened(self, brush: _core.Brush, covariance: np.ndarray) -> _core.Profile:
        """The law that was found from sums with intervals that hold what it inherits, by the fewest values to spare of
        all that it rests on: rather too wide."""
        law = getattr(brush, self.corrected)
        rests_on = [self.done[name].fit.law.degrees_of_freedom for name in (self.corrected, *self.pulls)]
        freedom = min(rests_on)
        half_intervals = _core.deviations_of_95(freedom) * np.sqrt(
            np.diag(covariance)[places(brush)[self.corrected]]
        )
        return _core.Profile(
            law.coefficients,
            floor=law.floor,
            floor_slope=law.floor_slope,
            calibrated_mm=law.calibrated_mm,
            source=law.source,
            half_interval_95=half_intervals,
            rmse_mm=law.rmse_mm,
            degrees_of_freedom=freedom,
        )

    def _law(self, law: str) -> _core.Profile:
        half = self.done["half_width"].fit.law
        if law not in self.done:
            share, what = ASSUMED[law]
            source = f"{what} is taken to lie {share:g} half widths from the tip."
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
            if self.corrected:
                setattr(brush, self.corrected, self._widened(brush, covariance))
        depths = [least + (deepest - least) * k / OUTLINES for k in range(1, OUTLINES + 1)]
        brush.footprints = _core.FootprintTable([_outline(brush, depth) for depth in depths])
        brush.extra = outlines_assumed("drops whose widest section and width are those of the laws.")
        _core.check(brush)
        return brush


def _outline(brush: _core.Brush, depth: float) -> _core.Footprint:
    half = brush.half_width(depth)
    return _core.Footprint(depth, footprint_shapes.drop(half, brush.tip_to_widest(depth), half))
