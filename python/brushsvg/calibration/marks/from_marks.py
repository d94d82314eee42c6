"""Fit a brush with its covariance to painted marks.

The same fit predicts how well a sheet will determine a brush.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval

from ... import _core
from ...array_values import ArrayValue
from ...errors import Error
from ...model import footprint_shapes
from ...model.confidence import LAWS, half_interval_mm, places
from ...model.laws.fitted import need_fits
from ..numbers.from_widths import outlines_assumed
from ..numbers.plausibility import MAX_DEPTH_PER_MEASURED
from .ink_depletion import InkDepletion
from .machine_found import (
    BIASING_PARTS,
    PARTS,
    Number,
    list_machine_numbers,
    list_requested_parts,
    request_machine_parts,
    select_visible_numbers,
)
from .mark_input import UPRIGHT, Painted, count_painted_depths, find_box_middle
from .sheet_scale import SheetScale, fit_sheet_scale, refuse_scale
from .stray_marks import MAX_RESIDUAL_SIGMAS, MAX_STRAY_SHARE, Stray, find_strays

LAG_TERMS, GAP_TERMS, HALF_TERMS = 4, 1, 2  # coefficients per law if the depths allow as many
OUTLINE_COUNT = 10  # number of footprint outlines, evenly spaced in depth
MIN_RATIO_TO_HALF_WIDTH = 0.1  # least ratio of widest section and front to the half width, as in the fit
ROUND_TAIL = (1.0, 0.4)  # distance from tip to widest section with a round tail, in half widths: mean and sigma
MAX_OUTLYING_SHARE = 0.2  # a mark with a larger share of outlying points does not count for the choice of the tail
MIN_CHI_SQUARE = 4.0  # chi-square by which one tail must fit better than the other to be chosen
# A law is undetermined if its 95 % interval exceeds this share of its value and this length [mm], at this share of
# the depths.
MAX_RELATIVE_INTERVAL, MAX_INTERVAL_MM, MAX_UNDETERMINED_SHARE = 0.5, 0.5, 0.25


@dataclass(frozen=True, eq=False, repr=False)
class MarkCalibration(ArrayValue):
    """A brush that is ready to use, with its fit, the marks and the expected errors.

    round_tail_gain: chi-square by which footprints with a round tail fit the marks better than pointed ones.
    edge_mm: standard deviation of the common shift of all edges. covariance: of all fitted numbers, including that
    shift. paint_bends: standard deviations by which the narrowing of the marks departs from the law of brush.paint.
    dry: the strokes between which the load ran dry. strays: marks that are unlike the others; the fit ignores them if
    strays_left_out is true.
    """

    brush: _core.Brush
    fit: _core.MarkFit
    painted: Painted
    expected: _core.MarkOptions
    scale: SheetScale | None = None
    round_tail_gain: float = 0.0
    edge_mm: float = 0.0
    covariance: np.ndarray | None = None
    strays: tuple[Stray, ...] = ()
    strays_left_out: bool = False
    paint_bends: float = 0.0
    dry: InkDepletion | None = None

    def __repr__(self) -> str:
        return f"<MarkCalibration of {self.brush!r} from {len(self.painted.marks)} marks>"


def calibrate_marks(
    painted: Painted,
    name: str,
    depth_range_mm: tuple[float, float] | None = None,
    max_speed_mm_s: float = 25.0,
    options: _core.MarkOptions | None = None,
    edge_mm: float = 0.0,
    leave_out_strays: bool = False,
    off: Painted | None = None,
) -> MarkCalibration:
    """Fit a brush to painted marks.

    options: sigmas of sheet, displacement and height. This function sets depths, coefficients per law and the tail.

    edge_mm: standard deviation of a common outward shift of all edges. It depends on the blur of a picture and on the
    threshold between paint and paper. No mark distinguishes it from a wider brush, so the intervals include it.

    leave_out_strays: fit once more without marks that do not fit the others.

    off: the marks as they would be if their processing was wrong by one standard deviation. The intervals include
    this error.

    Footprints have a pointed tail, or a round tail if it fits the marks better.

    Raises Error if the marks do not determine a law, if the brush cannot be used, or if there are many strays.
    """
    need_fits()
    least, deepest = depth_range_mm or (0.0, painted.deepest_mm)
    if painted.deepest_mm > deepest:
        sentence = f"the plan goes {painted.deepest_mm:g} mm deep, beyond the depth range [{least:g}, {deepest:g}] mm"
        raise Error(sentence, "depth_range_mm", code="depth-out-of-range")
    if deepest > MAX_DEPTH_PER_MEASURED * painted.deepest_mm:
        raise Error(
            f"the strokes were painted to a depth of {painted.deepest_mm:g} mm, but the depth range goes to "
            f'{deepest:g} mm: paint deeper strokes, or give "depth_range_mm": [{least:g}, {painted.deepest_mm:g}]',
            "depth_range_mm",
            code="depth-not-measured",
        )
    options = options or _core.MarkOptions()
    options.deepest_mm = deepest
    options.lag_terms = min(LAG_TERMS, painted.depths)
    options.tip_gap_terms, options.half_width_terms = GAP_TERMS, min(HALF_TERMS, painted.depths)
    fit, gain = _fit_better_tail(painted.marks, options)
    astray = tuple(find_strays(painted.marks, fit))
    if leave_out_strays and astray:
        refuse_many(astray, painted, _fit_scale(fit, painted))
        left_out = {stray.mark.stroke for stray in astray}
        painted = painted.without(left_out)
        fit, gain = _fit_better_tail(painted.marks, options, fit.laws)
    scale = _fit_scale(fit, painted)
    refuse_scale(scale)
    refuse_many_outliers(fit, painted)
    covariance = np.array(fit.covariance)
    if edge_mm > 0:
        change = _change_of_fit_with_tail(fit, grow_outlines(painted.marks, edge_mm), options)
        covariance += np.outer(change, change)
        change_by_paint = change_by_wetter_marks(fit, deepest, edge_mm)
        covariance += np.outer(change_by_paint, change_by_paint)
    if off:
        kept = {mark.stroke for mark in painted.marks}
        change = _change_of_fit_with_tail(fit, [mark for mark in off.marks if mark.stroke in kept], options)
        covariance += np.outer(change, change)
    brush = brush_of(fit.laws, name, (least, deepest), covariance)
    brush.max_speed_mm_s = max_speed_mm_s
    count = f"{len(painted.marks)} painted marks"
    for law in LAWS:
        law_of_brush = getattr(brush, law)
        profile = _core.Profile(
            law_of_brush.coefficients,
            calibrated_mm=(0.0, painted.deepest_mm),
            source=f"Fitted to {count}.",
            half_interval_95=law_of_brush.half_interval_95,
            floor=law_of_brush.floor,
            floor_slope=law_of_brush.floor_slope,
        )
        setattr(brush, law, profile)
    _refuse_undetermined(brush, fit)
    _core.check(brush)
    return MarkCalibration(brush, fit, painted, options, scale, gain, edge_mm, covariance, astray, leave_out_strays)


def refuse_many(astray: tuple[Stray, ...], painted: Painted, scale: SheetScale | None = None) -> None:
    """Raise Error if too many marks are strays.

    scale: the scale of the sheet. A wrong scale is reported first, because it displaces marks.
    """
    allowed = math.floor(MAX_STRAY_SHARE * len(painted.marks))
    if len(astray) > allowed:
        refuse_scale(scale)
        sentence = (
            f"{len(astray)} of {len(painted.marks)} marks do not fit the others, at most {allowed} may: "
            f"{', '.join(stray.mark.stroke for stray in astray)}. Check that nothing covers the page, that no paint is "
            "smeared, that this chart was painted on this page, and that the bar on the page has its printed length"
        )
        raise Error(sentence, "marks", len(astray), code="marks-outlying")


def _change_of_fit_with_tail(fit, marks: list, options: _core.MarkOptions) -> np.ndarray:
    """Return the change of the fit for other marks, with the chosen tail."""
    return change_of_fit(fit, marks, _options_with_tail(fit, options))


def _options_with_tail(fit, options: _core.MarkOptions) -> _core.MarkOptions:
    """Return a copy of the options that keeps the tail of a fit."""
    options = copy.copy(options)
    if fit.laws.round_tail:
        options.round_tail, options.widest_per_half = True, _core.Prior(*ROUND_TAIL)
    return options


def change_of_fit(fit, marks: list, options: _core.MarkOptions) -> np.ndarray:
    """Return the change of all fitted numbers for other marks. The order is the order of the covariance."""
    fit_with_marks = _core.fit_marks(marks, fit.laws, options)
    return _all_numbers(fit_with_marks, fit, options.deepest_mm) - _all_numbers(fit, fit, options.deepest_mm)


def find_ignored_errors(calibration: MarkCalibration, parts: tuple[str, ...] = BIASING_PARTS) -> list[Number]:
    """Return errors of the machine that the marks show, but that the fit was not requested to find.

    parts: the parts to look for. They are additional unknowns of one Gauss-Newton step from the solution, which takes a
    tenth of the time of a whole fit and finds errors within some percent of it.
    """
    fit, options = calibration.fit, _options_with_tail(calibration.fit, calibration.expected)
    ignored = [part for part in parts if part not in list_requested_parts(options)]
    if not ignored:
        return []
    request_machine_parts(options, tuple(ignored))
    options.max_iterations = 1
    step = _core.fit_marks(calibration.painted.marks, fit.laws, options)
    numbers = [each for each in list_machine_numbers(step, np.array(step.covariance), options) if each.part in ignored]
    ways = np.vstack([np.array(mark.poses_mm)[:, :2] for mark in calibration.painted.marks])
    reach_mm = float(np.abs(ways - fit.centre_mm).max())
    return select_visible_numbers(numbers, options.deepest_mm, reach_mm)


def change_by_edges(fit, marks: list, options: _core.MarkOptions, edge_mm: float) -> np.ndarray:
    """Return the change of all fitted numbers if every edge moves outwards by edge_mm."""
    return change_of_fit(fit, grow_outlines(marks, edge_mm), options)


def grow_outlines(marks: list, edge_mm: float) -> list:
    return [
        _core.PaintedMark(
            mark.stroke,
            np.array(mark.poses_mm),
            [_grow_ring(ring, edge_mm) for ring in mark.outline_mm],
            mark.arcs,
        )
        for mark in marks
    ]


def change_by_wetter_marks(fit, deepest_mm: float, edge_mm: float) -> np.ndarray:
    """Return the change of all fitted numbers if wider marks grow more.

    Marks of the greatest depth grow by edge_mm.

    More paint runs further. The fit would explain a common shift of all edges by higher paper, but wider marks that
    grow more change the half width.
    """
    half = np.array(fit.laws.half_width)
    shape = len(widest_ratio(fit.laws)) + len(front_ratio(fit.laws))
    change, end = np.zeros(len(fit.covariance)), height_at(fit) - shape
    change[end - len(half) + 1 : end] = half[1:] * edge_mm / polyval(deepest_mm, half)
    return change


def _all_numbers(fit, like, deepest_mm: float) -> np.ndarray:
    """Return all fitted numbers in the order of `like`'s covariance, with as many coefficients of each law."""
    laws, other = fit.laws, like.laws
    numbers = [
        _reduce_law(laws.lag, len(other.lag), 0, deepest_mm),
        _reduce_law(laws.tip_gap, len(other.tip_gap), 1, deepest_mm),
        _reduce_law(laws.half_width, len(other.half_width), 1, deepest_mm),
        _reduce_law(widest_ratio(laws), len(widest_ratio(other)), 0, deepest_mm),
        _reduce_law(front_ratio(laws), len(front_ratio(other)), 0, deepest_mm),
        [fit.height_mm, *fit.shift_mm, fit.turn_rad],
    ]
    values = np.concatenate(numbers)
    if len(like.covariance) == len(values):
        return values
    machine = fit.machine
    return np.concatenate(
        [
            values,
            machine.lean_mm_per_mm,
            machine.scale,
            [machine.skew],
            machine.tilt_mm_per_mm,
            machine.backlash_mm,
            *machine.field_mm,
        ]
    )


def _reduce_law(coefficients, terms: int, first: int, deepest_mm: float) -> np.ndarray:
    """Return the coefficients, from power `first` on, of the nearest law with fewer terms over the depths."""
    if len(coefficients) <= terms:
        return np.pad(coefficients, (0, terms - len(coefficients)))[first:]
    share = np.linspace(0.0, 1.0, 41)[1:]
    powers = np.vander(share, terms, increasing=True)[:, first:]
    solution = np.linalg.lstsq(powers, polyval(share * deepest_mm, coefficients), rcond=None)[0]
    return solution / deepest_mm ** np.arange(first, terms)


def height_at(fit) -> int:
    """Return the index of the paper height in the covariance of a fit. Shift x, shift y and turn follow."""
    laws = fit.laws
    ratios = len(widest_ratio(laws)) + len(front_ratio(laws))
    return len(laws.lag) + len(laws.tip_gap) - 1 + len(laws.half_width) - 1 + ratios


def _grow_ring(ring: np.ndarray, by_mm: float) -> np.ndarray:
    """Move a ring with the paint on its left outwards by by_mm."""
    along = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    return ring + by_mm * np.column_stack([along[:, 1], -along[:, 0]])


def _fit_better_tail(marks: list, options: _core.MarkOptions, start=None) -> tuple[object, float]:
    """Fit both tails and return the better fit.

    The chi-square gain of the round tail is returned as well.

    start: laws that are near the solution. Both fits use laws with the usual few coefficients, because additional
    coefficients would compensate for a wrong tail.
    """
    default_widest, departing = options.widest_per_half, options.departing
    options.round_tail = options.departing = False
    pointed = _core.fit_marks(marks, start, options)
    options.round_tail, options.widest_per_half = True, _core.Prior(*ROUND_TAIL)
    rounded = _core.fit_marks(marks, pointed.laws, options)
    noise = min(pointed.noise_mm, rounded.noise_mm)
    # number of correlated points that count as one
    points_per_sample = max(fit.samples / max(fit.effective_samples, 1.0) for fit in (pointed, rounded))
    gain = 0.0
    for pointed_mark, rounded_mark in zip(pointed.marks, rounded.marks, strict=True):
        deviations = np.abs([pointed_mark.distance_mm, rounded_mark.distance_mm]) / noise
        if np.mean(deviations > MAX_RESIDUAL_SIGMAS) < MAX_OUTLYING_SHARE:
            squares = np.minimum(deviations, MAX_RESIDUAL_SIGMAS) ** 2
            gain += float(squares[0].sum() - squares[1].sum()) / points_per_sample
    fit = rounded if gain > MIN_CHI_SQUARE else pointed
    if fit is pointed:
        options.round_tail, options.widest_per_half = False, default_widest
    options.departing = departing
    if departing:
        fit = _core.fit_marks(marks, fit.laws, options)
    options.round_tail, options.widest_per_half = False, default_widest
    return fit, gain


def simulate_fitted_brush(calibration: MarkCalibration, marks: list):
    """Simulate the fitted brush along the paths of marks.

    Return the brush, with a depth range extended to the marks, and its traces in the frame of the plan.
    """
    brush = calibration.brush
    executed = {
        mark.stroke: residual.way_mm
        for mark, residual in zip(calibration.painted.marks, calibration.fit.marks, strict=True)
    }
    ways = [np.array(executed.get(mark.stroke, mark.poses_mm)) for mark in marks]
    reach = max(brush.depth_range_mm[1], max(-way[:, 2].min() for way in ways) + calibration.fit.height_mm)
    brush = _core.read_brush(_core.write_brush(brush))
    brush.depth_range_mm = (brush.depth_range_mm[0], reach)
    passes = []
    for mark, poses in zip(marks, ways, strict=True):
        poses[:, 2] = np.minimum(poses[:, 2] - calibration.fit.height_mm, 0.0)
        passes.append(_core.Pass(mark.stroke, poses))
    return brush, _core.simulate(_core.Plan(brush.name, "", (1.0, 1.0), passes), brush).passes


def options_for(expected: dict) -> _core.MarkOptions:
    """Return the options of the fit for the expected errors of a measurement file."""
    need_fits()
    options = _core.MarkOptions()
    if "height_mm" in expected:
        options.height_mm = _core.Prior(0.0, expected["height_mm"])
    if "turn_deg" in expected:
        options.turn_rad = math.radians(expected["turn_deg"])
    options.placement_mm = expected.get("placement_mm", options.placement_mm)
    options.displacement_mm = expected.get("displacement_mm", options.displacement_mm)
    return options


def expected_brush(
    plan: _core.Plan,
    brush: _core.Brush,
    noise_mm: float = 0.1,
    painted: list[_core.PaintedMark] | None = None,
) -> tuple[_core.Brush, list[str]]:
    """Predict how well the marks of a plan will determine a brush.

    noise_mm: standard deviation of a painted edge. painted: the result of expected_marks(plan, brush), if it is
    already known.

    Return the brush as the fit sees it, with the expected covariance and intervals, and remarks on what the strokes
    cannot separate.
    """
    painted = painted or expected_marks(plan, brush)
    fit = expected_fit(painted, plan, brush, noise_mm, _core.MarkOptions())
    return brush_of(fit.laws, brush.name, brush.depth_range_mm, np.array(fit.covariance)), fit.remarks


def expected_machine(
    plan: _core.Plan,
    brush: _core.Brush,
    noise_mm: float = 0.1,
    painted: list[_core.PaintedMark] | None = None,
) -> list[Number]:
    """Predict the numbers of the machine that marks will determine.

    The machine has no errors. Each number has half its 95 % interval.
    """
    options = _core.MarkOptions()
    request_machine_parts(options, PARTS)
    painted = painted or expected_marks(plan, brush)
    fit = expected_fit(painted, plan, brush, noise_mm, options)
    return list_machine_numbers(fit, np.array(fit.covariance), options)


def expected_marks(plan: _core.Plan, brush: _core.Brush) -> list[_core.PaintedMark]:
    """Simulate the marks of a plan, with the brush as the fit sees it.

    The outlines [mm] are on the paper and have no noise.
    """
    need_fits()
    _core.refuse_tilted(plan.passes, UPRIGHT)
    fitted_brush = brush_of(laws_of(brush), brush.name, brush.depth_range_mm)
    marks = _core.simulate(plan, fitted_brush)
    _core.trace_outlines(marks, fitted_brush)
    painted = [
        _core.PaintedMark(stroke_pass.stroke, stroke_pass.poses_mm, mark.outline_mm, stroke_pass.arcs)
        for stroke_pass, mark in zip(plan.passes, marks.passes, strict=True)
        if mark.outline_mm
    ]
    if not painted:
        raise Error("the plan paints nothing", "plan", code="nothing-painted")
    return painted


def expected_fit(painted, plan, brush, noise_mm: float, options) -> _core.MarkFit:
    """Fit simulated marks with the given noise of their edges.

    options: depths and coefficients per law are set here.
    """
    options.deepest_mm = brush.depth_range_mm[1]
    depths = max(1, count_painted_depths([np.array(stroke_pass.poses_mm) for stroke_pass in plan.passes]))
    options.lag_terms = min(LAG_TERMS, depths)
    options.tip_gap_terms, options.half_width_terms = GAP_TERMS, min(HALF_TERMS, depths)
    options.noise_mm = noise_mm
    return _core.fit_marks(painted, laws_of(brush, options.lag_terms, options.half_width_terms), options)


def laws_of(brush: _core.Brush, lag_terms: int = LAG_TERMS, half_terms: int = HALF_TERMS) -> _core.MarkLaws:
    """Return the nearest laws to a brush over its depths.

    They have as many coefficients as marks determine.
    """
    depths = np.linspace(*brush.depth_range_mm, 41)[1:]

    def fit_nearest(law, powers):
        values = np.array([law(d) for d in depths])
        columns = np.vander(depths, powers[-1] + 1, increasing=True)[:, powers]
        out = np.zeros(powers[-1] + 1)
        out[powers] = np.linalg.lstsq(columns, values, rcond=None)[0]
        return out.tolist()

    half = np.array([brush.half_width(d) for d in depths])
    widest = np.array([brush.tip_to_widest(d) for d in depths])
    ends = [(s.outline_mm[:, 0].max(), s.depth_mm) for s in brush.footprints.dragged]
    # Outlines may be of greater depths than the brush may be pressed to.
    front = [
        (end - brush.tip_to_widest.extrapolated(d)) / max(brush.half_width.extrapolated(d), 1e-6) for end, d in ends
    ]
    lag = fit_nearest(brush.lag, list(range(lag_terms)))
    deepest = brush.depth_range_mm[1]
    if polyval(np.linspace(0.0, deepest, 41), lag).min() < 0:  # these laws have no floor
        shape = _core.LawShape((0.0, deepest), lag_terms - 1, positive=True)
        lag = _core.fit_law(depths, brush.lag(depths), shape).law.coefficients
    return _core.MarkLaws(
        lag,
        fit_nearest(brush.tip_gap, list(range(1, GAP_TERMS + 1))),
        fit_nearest(brush.half_width, list(range(1, half_terms + 1))),
        float(widest @ half / (half @ half)),
        float(np.clip(np.median(front), 0.2, 3.0)),
    )


def brush_of(laws, name: str, depth_range_mm, covariance: np.ndarray | None = None) -> _core.Brush:
    """Make a brush with these laws and drops or eggs as footprints.

    covariance: of a fit; if it is given, the laws get intervals.
    """
    brush = _core.Brush()
    brush.name, brush.kind, brush.depth_range_mm = name, "round", tuple(depth_range_mm)
    least, deepest = depth_range_mm
    brush.lag, brush.tip_gap = _core.Profile(laws.lag), _core.Profile(laws.tip_gap)
    brush.half_width = _core.Profile(laws.half_width)
    # polymul would drop powers whose coefficient is 0. Rows of the covariance would then belong to other laws.
    widest = np.convolve(widest_ratio(laws), laws.half_width)
    brush.tip_to_widest = _core.Profile(widest.tolist(), **_widest_floor(laws, deepest))
    brush.paint_depth_mm = (least + deepest) / 2
    depths = [least + (deepest - least) * k / OUTLINE_COUNT for k in range(1, OUTLINE_COUNT + 1)]
    brush.footprints = _core.FootprintTable([_footprint(brush, depth, laws) for depth in depths])
    shape = "eggs" if laws.round_tail else "drops"
    brush.extra = outlines_assumed(
        f"{shape} with the width and the widest section of the laws, and {laws.front_per_half:.2f} half widths in "
        "front of that section."
    )
    if covariance is not None:
        brush_covariance = to_brush_covariance(laws, covariance)
        brush.covariance = brush_covariance.tolist()
        half_intervals = _core.interval_factor_95() * np.sqrt(np.maximum(np.diag(brush_covariance), 0.0))
        for law, place in places(brush).items():
            coefficients = getattr(brush, law).coefficients
            floor = _widest_floor(laws, deepest) if law == "tip_to_widest" else {}
            setattr(brush, law, _core.Profile(coefficients, half_interval_95=half_intervals[place], **floor))
    return brush


def to_brush_covariance(laws, covariance: np.ndarray) -> np.ndarray:
    """Convert a covariance from the unknowns of the fit to a brush.

    The result is over the coefficients of the brush; x_w = ratio * h.
    """
    lag, gap, half = len(laws.lag), len(laws.tip_gap) - 1, len(laws.half_width) - 1
    ratio, half_width = widest_ratio(laws), np.array(laws.half_width)
    rows = lag + gap + 1 + half + len(ratio) + half + 1
    jacobian = np.zeros((rows, len(covariance)))
    jacobian[:lag, :lag] = np.eye(lag)
    jacobian[lag + 1 : lag + 1 + gap, lag : lag + gap] = np.eye(gap)
    widest, width = lag + gap + 1, lag + gap + 1 + half + len(ratio) + 1
    for power in range(half):
        jacobian[widest + 1 + power : widest + 1 + power + len(ratio), lag + gap + power] = ratio
    for power in range(len(ratio)):
        jacobian[widest + power : widest + power + half + 1, lag + gap + half + power] = half_width
    jacobian[width : width + half, lag + gap : lag + gap + half] = np.eye(half)
    return jacobian @ covariance @ jacobian.T


def widest_ratio(laws) -> np.ndarray:
    """Return the ratio of the widest section's position to the half width.

    Coefficients are in ascending powers of depth.
    """
    return np.array(laws.widest_by_depth or [laws.widest_per_half])


def front_ratio(laws) -> np.ndarray:
    """Return the ratio of the footprint's front to the half width.

    The front is the length in front of the widest section. Coefficients are in ascending powers of depth.
    """
    return np.array(laws.front_by_depth or [laws.front_per_half])


def _widest_floor(laws, deepest: float) -> dict[str, float]:
    """Return the floor of the widest section if its ratio would fall below the least ratio of a footprint."""
    depths = np.linspace(0.0, deepest, 41)
    if polyval(depths, widest_ratio(laws)).min() >= MIN_RATIO_TO_HALF_WIDTH:
        return {}
    return {
        "floor": 0.0,
        "floor_slope": MIN_RATIO_TO_HALF_WIDTH * float(polyval(deepest, laws.half_width)) / deepest,
    }


def _footprint(brush: _core.Brush, depth: float, laws) -> _core.Footprint:
    half = brush.half_width(depth)
    shape = footprint_shapes.egg if laws.round_tail else footprint_shapes.drop
    front = max(MIN_RATIO_TO_HALF_WIDTH, polyval(depth, front_ratio(laws)))
    return _core.Footprint(depth, shape(half, brush.tip_to_widest(depth), front * half))


def _fit_scale(fit, painted: Painted) -> SheetScale | None:
    """Fit the scale of the sheet to marks that are not outliers."""
    usable = [
        (find_box_middle(np.array(mark.poses_mm)[:, :2]), residual.displacement_mm)
        for mark, residual in zip(painted.marks, fit.marks, strict=True)
        if not residual.outlier
    ]
    return fit_sheet_scale(*map(np.array, zip(*usable, strict=True))) if usable else None


def refuse_many_outliers(fit, painted: Painted) -> None:
    outliers, marks = sum(residual.outlier for residual in fit.marks), len(painted.marks)
    if 2 * outliers > marks:
        raise Error(
            f"{outliers} of {marks} marks are outliers, outside the range [0, {marks // 2}]: check that the marks are "
            "in mm with y up, and that each has the id of its stroke",
            "marks",
            code="marks-outlying",
        )


def _refuse_undetermined(brush: _core.Brush, fit) -> None:
    for law, share, value in find_undetermined_laws(brush):
        if share > MAX_UNDETERMINED_SHARE:
            advice = fit.remarks[0] if fit.remarks else "paint curved strokes at more depths, including the deepest"
            sentence = f"these marks do not determine the {law.replace('_', ' ')} ({value}): {advice}"
            raise Error(sentence, law, code="law-undetermined")


def find_undetermined_laws(brush: _core.Brush) -> list[tuple[str, float, str]]:
    """Return the laws that the marks leave undetermined at some depths.

    Each has the share of these depths, and the worst value in words, with its interval and depth.
    """
    depths = np.linspace(*brush.depth_range_mm, 21)[1:]
    covariance, at = np.array(brush.covariance), places(brush)
    found = []
    for law in ("lag", "half_width"):  # the other laws do not matter for a plan
        half = half_interval_mm(covariance[at[law], at[law]], depths, None)
        values = np.array([getattr(brush, law)(d) for d in depths])
        undetermined = (half > MAX_RELATIVE_INTERVAL * values) & (half > MAX_INTERVAL_MM)
        if undetermined.any():
            worst = int(np.argmax(np.where(undetermined, half / np.maximum(values, 1e-9), 0.0)))
            value = f"{values[worst]:.1f} +- {half[worst]:.1f} mm (95 %) at depth {depths[worst]:.4g} mm"
            found.append((law, float(undetermined.mean()), value))
    return found
