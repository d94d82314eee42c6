"""How marks narrow by the way since the last dip, found along with the brush from a sheet painted with one load."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...errors import Error
from ...geometry.polylines import lengths
from ...geometry.rotation import rotation
from .from_marks import MarkCalibration, brush_of, calibrate_marks, expected_fit, simulated
from .ink_depletion import ran_dry
from .mark_input import Painted, painted_of, ways_before_mm
from .mark_report import predicted_marks

ROUNDS = 8
SETTLED = 0.3  # of the standard deviation: added in squares 4 % of it; fits of like marks differ by up to 0.2
# Share of the growth of the way that depth must not explain: with less its interval is 1.5 times as wide, and a width
# law that is not of the family passes for paint
LEAST_OWN = 0.45
OUTLYING = 4.0  # standard deviations of the edges
ACROSS = (0.5, 1.5)  # half widths from the middle: flanks, not what ends and crossings paint
STEP_MM = 0.5
APART = 3.0  # standard deviations between two rates that show the effect of a rate on the fit
LEAST_KEPT = 0.2
MOST_WIDER = (
    0.1  # per metre that marks may seem to widen by: strokes of other shapes, early and late, feign some
)
FEWEST = 3  # marks more than there are numbers to find


def calibrate_paint(painted: Painted, name: str, *args, **kwargs) -> MarkCalibration:
    """calibrate_marks() of marks that get narrower from the first stroke of their plan to the last, since paint was
    fetched before the first one only; its brush is the freshly dipped one, and says by how much marks narrow.

    What the marks would be freshly dipped is what the fit is given: each edge as much further from the middle line as
    the paint took. By how much it took is what makes the edges' residuals depend on the way no more. Intervals of the
    laws hold what the other number leaves open. Where the last strokes of the plan are missing or broken, the brush
    says that hairs are wet up to the last whole mark. Marks that seem to widen a little do not narrow. Error where the
    way grows with the depth so that narrower and shallower marks are alike, where marks get much wider, and where the
    number does not settle.
    """
    rate, fresh, tried = 0.0, painted, []
    for _ in range(ROUNDS):
        made = calibrate_marks(fresh, name, *args, **kwargs)
        change, sigma, freedom = _left(made)
        tried.append((rate, change))
        rate += change
        fresh = freshly_dipped(painted, made, rate)
        if abs(change) < SETTLED * sigma:
            break
    else:
        sentence = f"how marks narrow does not settle, the last change was {change:.2g} per metre"
        raise Error(sentence, "paint", change, code="paint-undetermined")
    if abs(tried[-1][0] - tried[0][0]) < APART * sigma:
        other = tried[-1][0] + APART * sigma
        off = calibrate_marks(freshly_dipped(painted, made, other), name, *args, **kwargs)
        tried = [(other, _left(off)[0]), tried[-1]]
    sigma /= _kept(tried[0], tried[-1])
    deviations = _core.deviations_of_95(freedom)
    if rate < -MOST_WIDER and rate + deviations * sigma < 0:
        raise Error(
            f"marks get wider by {-rate:.2g} +- {deviations * sigma:.2g} per metre along the job: was paint fetched in "
            "between?",
            "paint",
            rate,
            code="paint-undetermined",
        )
    if rate < 0:  # marks do not narrow, which the interval has to hold
        sigma, rate, fresh = max(sigma, -rate / deviations), 0.0, painted
    made = calibrate_marks(fresh, name, *args, **kwargs, off=freshly_dipped(painted, made, rate + sigma))
    last_mm = max(painted.before_mm[mark.stroke] + _lengths(mark)[-1] for mark in made.painted.marks)
    dry = ran_dry(fresh, predicted_marks(made, fresh.marks))
    made.brush.paint = _core.Paint(
        rate,
        lasts_mm=dry.whole_mm if dry else None,
        calibrated_mm=(0.0, last_mm),
        source=f"Fitted to {len(made.painted.marks)} marks painted with one load.",
        covariance=[[sigma**2, 0.0], [0.0, dry.variance_mm2]] if dry else [[sigma**2]],
        degrees_of_freedom=freedom,
    )
    made = replace(made, painted=replace(made.painted, before_mm=painted.before_mm))
    return replace(made, paint_bends=_bends(made), dry=dry)


def _kept(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Of a rate that is off, the share that the fit leaves in the edges' residuals, by two rates and what each left;
    the rest goes into its laws."""
    return float(np.clip((one[1] - other[1]) / (other[0] - one[0]), LEAST_KEPT, 1.0))


def freshly_dipped(painted: Painted, made: MarkCalibration, rate_per_m: float) -> list:
    """The marks as a brush would have painted them that was dipped at every place: edges further from where the widest
    section ran by what the paint took of it."""
    brush, traces = simulated(made, painted.marks)
    fit, turned = made.fit, rotation(made.fit.turn_rad)
    centre = np.array(fit.centre_mm)
    residuals = dict(zip((each.stroke for each in made.painted.marks), fit.marks, strict=True))
    paint = _core.Paint(abs(rate_per_m))
    marks = []
    for mark, trace in zip(painted.marks, traces, strict=True):
        moved = np.array(residuals[mark.stroke].displacement_mm) if mark.stroke in residuals else np.zeros(2)
        side = Sides(brush, trace, painted.before_mm[mark.stroke])
        rings = []
        for ring in map(np.asarray, mark.outline_mm):
            at = side.locate((ring - fit.shift_mm - centre) @ turned.T + centre - moved)
            shares = np.array([paint.width_share(way) for way in at.way_mm])
            more = 1 / shares - 1 if rate_per_m > 0 else shares - 1
            rings.append(ring + (more * at.across_mm)[:, None] * (at.normal @ turned))
        marks.append(_core.PaintedMark(mark.stroke, np.array(mark.poses_mm), rings, mark.arcs))
    return replace(painted, marks=marks)


@dataclass(frozen=True)
class NearestSections:
    """Of each point: depth and way of the brush where its widest section was nearest, the distance to the left of it,
    the direction of that, and the way of the section up to there, or from there on, the lesser of both."""

    depth_mm: np.ndarray
    way_mm: np.ndarray
    across_mm: np.ndarray
    normal: np.ndarray
    ends_mm: np.ndarray


class Sides:
    """Locates points relative to the way of the widest section."""

    def __init__(self, brush, trace, before_mm: float) -> None:
        down = np.flatnonzero(np.asarray(trace.depth_mm) >= 0)
        widest = _core.widest_points(trace, brush)[down]
        heading = np.unwrap(np.asarray(trace.heading_rad)[down])
        at = lengths(widest)
        fine = np.union1d(at, np.arange(0.0, at[-1], STEP_MM))  # straight lines have rows at their ends only

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
class Expected:
    """What marks will say of how they narrow: half the 95 % interval of the rate per metre, the share of how the way
    grows that the depth explains, and the way in mm that one load has to last."""

    half_per_m: float
    explained_by_depth: float
    way_mm: float

    @property
    def is_refused(self) -> bool:
        return 1 - self.explained_by_depth < LEAST_OWN


def expected_paint(plan: _core.Plan, brush: _core.Brush, noise_mm: float, painted: list) -> Expected:
    """Of a plan painted with one load, before anyone paints it; painted: expected_marks(plan, brush)."""
    options = _core.MarkOptions()
    fit = expected_fit(painted, plan, brush, noise_mm, 1.0, options)
    before_mm, _ = ways_before_mm({one.stroke: one for one in plan.passes})
    complete = replace(painted_of(painted), before_mm=before_mm)
    made = MarkCalibration(brush_of(fit.laws, brush.name, brush.depth_range_mm), fit, complete, options)
    flanks = _flanks(made)
    own = flanks.own()
    kept = np.exp(-options.spacing_mm / 1.0)  # neighbouring points are correlated, over 1 mm
    sigma = noise_mm * np.sqrt((1 + kept) / (1 - kept) / float(own @ own))
    half = _core.deviations_of_95(flanks.freedom) * sigma
    last_mm = max(complete.before_mm[mark.stroke] + _lengths(mark)[-1] for mark in complete.marks)
    return Expected(float(half), flanks.explained_by_depth(), float(last_mm))


@dataclass(frozen=True)
class Flanks:
    """Points of the edges along the middle line, row by row: by how much a narrowing of 1 per metre moves the edge
    out, the half width, powers of the depth, how far off the edge is (all mm), and of which mark the point is."""

    moved: np.ndarray
    half_mm: np.ndarray
    powers: np.ndarray
    off_mm: np.ndarray
    of_mark: np.ndarray

    @property
    def freedom(self) -> float:
        return float(len(np.unique(self.of_mark)) - self.powers.shape[1] - 1)

    def marks(self) -> list[np.ndarray]:
        """Which points are of each mark."""
        return [self.of_mark == one for one in np.unique(self.of_mark)]

    def own(self) -> np.ndarray:
        """Return the part of moved that no width law and no height of the paper explains."""
        return residual_of_powers(self.moved, self.powers)

    def explained_by_depth(self) -> float:
        """Of how moved differs from what one way for all points would make of it."""
        way = float(self.moved @ self.half_mm) / float(self.half_mm @ self.half_mm)
        about, own = self.moved - way * self.half_mm, self.own()
        return 1 - float(own @ own) / max(float(about @ about), 1e-12)


def residual_of_powers(values: np.ndarray, powers: np.ndarray) -> np.ndarray:
    return values - powers @ np.linalg.lstsq(powers, values, rcond=None)[0]


def _flanks(made: MarkCalibration) -> Flanks:
    brush, traces = simulated(made, made.painted.marks)
    astray = {each.mark.stroke for each in made.strays}
    found = []
    for number, (residual, trace) in enumerate(zip(made.fit.marks, traces, strict=True)):
        if trace.stroke in astray or residual.outlier:
            continue
        at = Sides(brush, trace, made.painted.before_mm[trace.stroke]).locate(np.asarray(residual.point_mm))
        half = np.array([brush.half_width(d) for d in at.depth_mm])
        long = np.array([brush.tip_to_widest(d) for d in at.depth_mm]) + half
        share = np.abs(at.across_mm) / np.maximum(half, 1e-6)
        distance = np.asarray(residual.distance_mm)
        is_flank = (share > ACROSS[0]) & (share < ACROSS[1]) & (at.ends_mm > long)
        is_flank &= np.abs(distance) < OUTLYING * made.fit.noise_mm
        powers = at.depth_mm[:, None] ** np.arange(3 if made.painted.depths > 1 else 1)
        rows = np.column_stack([-1e-3 * half * at.way_mm, half, distance, np.full(len(half), number), powers])
        found.append(rows[is_flank])
    rows = np.vstack(found) if found else np.empty((0, 5))
    marks = len(np.unique(rows[:, 3]))
    if marks < FEWEST + 4:
        sentence = f"{marks} marks show their flanks, at least {FEWEST + 4} are needed"
        raise Error(sentence, "paint", code="paint-undetermined")
    return Flanks(rows[:, 0], rows[:, 1], rows[:, 4:], rows[:, 2], rows[:, 3])


def _left(made: MarkCalibration) -> tuple[float, float, float]:
    """By how much the rate is off that the marks were made fresh with, per metre, by the edges' residuals: least
    squares of the effect of narrowing next to powers of the depth; its standard deviation by whole marks, whose points
    know of each other, each as far off as its residuals say times what the rate is without it: the residuals of the few
    that decide are smaller than their errors (HC2 of MacKinnon and White, 1985, by marks); and marks beyond what is
    found."""
    flanks = _flanks(made)
    explained = flanks.explained_by_depth()
    if 1 - explained < LEAST_OWN:
        raise Error(
            f"{100 * explained:.0f} % of how the way since the dip grows is explained by the depth alone, so narrower "
            "and shallower marks are alike: paint strokes of one depth early and late, as `brushsvg chart --paint` "
            "does",
            "paint",
            code="paint-undetermined",
        )
    columns, own = np.column_stack([flanks.moved, flanks.powers]), flanks.own()
    rate = _first_number(columns, flanks.off_mm)
    others = residual_of_powers(flanks.off_mm, flanks.powers) - rate * own
    says = np.array([float((own * others)[mark].sum()) for mark in flanks.marks()]) / float(own @ own)
    without = _without_each(columns, flanks)
    return rate, float(np.sqrt(max(says @ (rate - without), 0.0))), flanks.freedom


def _bends(made: MarkCalibration) -> float:
    """Return the dependence of the residuals on the square of the way, in addition to the way, in its standard
    deviations by leaving out marks one by one."""
    flanks = _flanks(made)
    ways = -1e3 * flanks.moved / np.maximum(flanks.half_mm, 1e-9)
    columns = np.column_stack([flanks.moved * ways, flanks.moved, flanks.powers])
    bend, without = _first_number(columns, flanks.off_mm), _without_each(columns, flanks)
    return abs(bend) / max(float(np.sqrt((len(without) - 1) * without.var())), 1e-15)


def _without_each(columns: np.ndarray, flanks: Flanks) -> np.ndarray:
    """(m,) the first number, each of the marks left out in turn."""
    return np.array([_first_number(columns[~mark], flanks.off_mm[~mark]) for mark in flanks.marks()])


def _first_number(columns: np.ndarray, values: np.ndarray) -> float:
    return float(np.linalg.lstsq(columns, values, rcond=None)[0][0])


def _lengths(mark) -> np.ndarray:
    return lengths(np.asarray(mark.poses_mm)[:, :2])
