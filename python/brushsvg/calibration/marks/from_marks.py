"""Painted marks to a brush with its covariance; and what a sheet yet to be painted will say of a brush."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval

from ... import _core
from ...array_values import ArrayValue
from ...errors import Error
from ...model import footprint_shapes
from ...model.confidence import half_interval_mm, places
from ...model.laws.fitted import need_fits
from ..numbers.from_widths import outlines_assumed
from ..numbers.plausibility import MAX_DEPTH_PER_MEASURED
from .ink_depletion import RanDry
from .machine_found import PARTS, Number, ask_for, numbers
from .mark_input import UPRIGHT, Painted, depths_painted, middle
from .sheet_scale import SheetScale, refuse_scale, sheet_scale
from .stray_marks import MOST, OUTLYING, Stray, strays

LAG_TERMS, GAP_TERMS, HALF_TERMS = 4, 1, 2  # numbers per law, where the depths allow as many
OUTLINES = 10
LEAST_RATIO = 0.1  # of widest section and front to the half width, as the fit has it
ROUND_TAIL = (1.0, 0.4)  # of a footprint with a round tail: tip to widest section in half widths, sigma
FOREIGN = 0.2  # share of a mark's points beyond that where it says nothing of the tail
MIN_CHI_SQUARE = 4.0  # chi-square by which one tail must fit better than the other to be chosen
# A law with a 95 % interval of more than this share of it, and this long, over this part of the depths: no measurement
UNDETERMINED, UNDETERMINED_MM, UNDETERMINED_PART = 0.5, 0.5, 0.25


@dataclass(frozen=True, eq=False, repr=False)
class MarkCalibration(ArrayValue):
    """A brush that can be used, the fit it comes from, the marks, and what was expected of them.

    round_tail_gain: chi-square by which footprints with a round tail fit the marks better than pointed ones.
    edge_mm: the common shift of all edges (sigma), and covariance, of all that is fitted, with that in it.
    paint_bends: by how many standard deviations marks narrow by another law than the one of brush.paint; dry: between
    which strokes its load ran dry.
    strays: marks that are not like the others, which the fit had no part of where they were left out.
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
    dry: RanDry | None = None

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
    """Fit a brush to painted marks. Error where they leave a law open, or give a brush that cannot be used.

    edge_mm: standard deviation of a common outward shift of all edges: how a picture was blurred, where paint was
    separated from paper. No mark distinguishes it from a wider brush, so the intervals hold it.

    Footprints have a pointed tail, or a round one where that fits the marks better. options: sigmas of sheet,
    displacement and height; depths, numbers per law and the tail are set here. leave_out_strays: fit once more without
    marks that are not where or what the others say; Error where they are many. off: the marks as they would be if what
    was made of them were off by a standard deviation: the intervals hold it.
    """
    need_fits()
    least, deepest = depth_range_mm or (0.0, painted.deepest_mm)
    if painted.deepest_mm > deepest:
        raise Error(
            f"the plan goes {painted.deepest_mm:g} mm deep, beyond the depth range [{least:g}, {deepest:g}] mm",
            "depth_range_mm",
            code="depth-out-of-range",
        )
    if deepest > MAX_DEPTH_PER_MEASURED * painted.deepest_mm:
        raise Error(
            f"the strokes were painted to a depth of {painted.deepest_mm:g} mm, the brush is to be pressed {deepest:g} "
            f'mm: paint deeper ones, or give "depth_range_mm": [{least:g}, {painted.deepest_mm:g}]',
            "depth_range_mm",
            code="depth-not-measured",
        )
    options = options or _core.MarkOptions()
    options.deepest_mm = deepest
    options.lag_terms = min(LAG_TERMS, painted.depths)
    options.tip_gap_terms, options.half_width_terms = GAP_TERMS, min(HALF_TERMS, painted.depths)
    fit, gain = _likelier_tail(painted.marks, options)
    astray = tuple(strays(painted.marks, fit))
    if leave_out_strays and astray:
        refuse_many(astray, painted, _scale(fit, painted))
        gone = {each.mark.stroke for each in astray}
        painted = painted.without(gone)
        fit, gain = _likelier_tail(painted.marks, options, fit.laws)
    scale = _scale(fit, painted)
    refuse_scale(scale)
    refuse_unlike(fit, painted)
    covariance = np.array(fit.covariance)
    if edge_mm > 0:
        moved = _moved(fit, grow_outlines(painted.marks, edge_mm), options)
        covariance += np.outer(moved, moved)
        wetter = wetter_where_wider(fit, deepest, edge_mm)
        covariance += np.outer(wetter, wetter)
    if off:
        kept = {mark.stroke for mark in painted.marks}
        moved = _moved(fit, [mark for mark in off.marks if mark.stroke in kept], options)
        covariance += np.outer(moved, moved)
    brush = brush_of(fit.laws, name, (least, deepest), covariance)
    brush.max_speed_mm_s = max_speed_mm_s
    count = f"{len(painted.marks)} painted marks"
    for law in ("lag", "tip_gap", "tip_to_widest", "half_width"):
        found = getattr(brush, law)
        known = _core.Profile(
            found.coefficients,
            calibrated_mm=(0.0, painted.deepest_mm),
            source=f"Fitted to {count}.",
            half_interval_95=found.half_interval_95,
            floor=found.floor,
            floor_slope=found.floor_slope,
        )
        setattr(brush, law, known)
    _refuse_undetermined(brush, fit)
    _core.check(brush)
    return MarkCalibration(
        brush, fit, painted, options, scale, gain, edge_mm, covariance, astray, leave_out_strays
    )


def refuse_many(astray: tuple[Stray, ...], painted: Painted, scale: SheetScale | None = None) -> None:
    """scale: of the sheet, where another one may be what displaces marks."""
    most = math.floor(MOST * len(painted.marks))
    if len(astray) > most:
        refuse_scale(scale)
        raise Error(
            f"{len(astray)} of {len(painted.marks)} marks are not where or what the others say, the range is "
            f"[0, {most}]: {', '.join(each.mark.stroke for each in astray)}; is anything on the page, is the "
            "paint smeared, is it the page on which this chart was painted, and is its bar as long as it says?",
            "marks",
            len(astray),
            code="marks-outlying",
        )


def _moved(fit, marks: list, options: _core.MarkOptions) -> np.ndarray:
    """By how much all that is fitted changes with other marks, with the tail that was found."""
    usual = options.widest_per_half
    if fit.laws.round_tail:
        options.round_tail, options.widest_per_half = True, _core.Prior(*ROUND_TAIL)
    moved = moved_by(fit, marks, options)
    options.round_tail, options.widest_per_half = False, usual
    return moved


def moved_by(fit, marks: list, options: _core.MarkOptions) -> np.ndarray:
    """By how much all that is fitted changes with other marks, in the covariance's order."""
    moved = _core.fit_marks(marks, fit.laws, options)
    return _all_fitted(moved, fit, options.deepest_mm) - _all_fitted(fit, fit, options.deepest_mm)


def moved_by_edges(fit, marks: list, options: _core.MarkOptions, edge_mm: float) -> np.ndarray:
    """Return the marks grown by edge_mm at every edge."""
    return moved_by(fit, grow_outlines(marks, edge_mm), options)


def grow_outlines(marks: list, edge_mm: float) -> list:
    return [
        _core.PaintedMark(
            mark.stroke,
            np.array(mark.poses_mm),
            [_grow(ring, edge_mm) for ring in mark.outline_mm],
            mark.arcs,
        )
        for mark in marks
    ]


def wetter_where_wider(fit, deepest_mm: float, edge_mm: float) -> np.ndarray:
    """Return the marks grown the more the wider a mark is, by edge_mm at the greatest depth: more paint
    runs further. The fit would take a common shift of all edges for higher paper; these are wider marks."""
    half = np.array(fit.laws.half_width)
    shape = len(widest_ratio(fit.laws)) + len(front_ratio(fit.laws))
    moved, end = np.zeros(len(fit.covariance)), height_at(fit) - shape
    moved[end - len(half) + 1 : end] = half[1:] * edge_mm / polyval(deepest_mm, half)
    return moved


def _all_fitted(fit, like, deepest_mm: float) -> np.ndarray:
    """In the order of the covariance of `like`, with as many numbers a law."""
    laws, other = fit.laws, like.laws
    numbers = [
        _nearest(laws.lag, len(other.lag), 0, deepest_mm),
        _nearest(laws.tip_gap, len(other.tip_gap), 1, deepest_mm),
        _nearest(laws.half_width, len(other.half_width), 1, deepest_mm),
        _nearest(widest_ratio(laws), len(widest_ratio(other)), 0, deepest_mm),
        _nearest(front_ratio(laws), len(front_ratio(other)), 0, deepest_mm),
        [fit.height_mm, *fit.shift_mm, fit.turn_rad],
    ]
    all_fitted = np.concatenate(numbers)
    if len(like.covariance) == len(all_fitted):
        return all_fitted
    one = fit.machine
    return np.concatenate(
        [
            all_fitted,
            one.lean_mm_per_mm,
            one.scale,
            [one.skew],
            one.tilt_mm_per_mm,
            one.backlash_mm,
            *one.field_mm,
        ]
    )


def _nearest(coefficients, terms: int, first: int, deepest_mm: float) -> np.ndarray:
    """Coefficients from the power `first` on of the law with so many terms that is nearest over the depths."""
    if len(coefficients) <= terms:
        return np.pad(coefficients, (0, terms - len(coefficients)))[first:]
    share = np.linspace(0.0, 1.0, 41)[1:]
    powers = np.vander(share, terms, increasing=True)[:, first:]
    found = np.linalg.lstsq(powers, polyval(share * deepest_mm, coefficients), rcond=None)[0]
    return found / deepest_mm ** np.arange(first, terms)


def height_at(fit) -> int:
    """Where in a fit's covariance the height of the paper stands; shift x and y and turn follow."""
    laws = fit.laws
    ratios = len(widest_ratio(laws)) + len(front_ratio(laws))
    return len(laws.lag) + len(laws.tip_gap) - 1 + len(laws.half_width) - 1 + ratios


def _grow(ring: np.ndarray, by_mm: float) -> np.ndarray:
    """Return the ring with the paint on its left."""
    along = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    return ring + by_mm * np.column_stack([along[:, 1], -along[:, 0]])


def _likelier_tail(marks: list, options: _core.MarkOptions, start=None) -> tuple[object, float]:
    """The fit with the tail that fits better, and by how much the round one does. start: laws that are near.

    Both get laws that do not depart from their few numbers, which would make up for a wrong tail."""
    usual, departing = options.widest_per_half, options.departing
    options.round_tail = options.departing = False
    pointed = _core.fit_marks(marks, start, options)
    options.round_tail, options.widest_per_half = True, _core.Prior(*ROUND_TAIL)
    rounded = _core.fit_marks(marks, pointed.laws, options)
    noise = min(pointed.noise_mm, rounded.noise_mm)
    # points that count as one
    alike = max(fit.samples / max(fit.effective_samples, 1.0) for fit in (pointed, rounded))
    gain = 0.0
    for one, other in zip(pointed.marks, rounded.marks, strict=True):
        off = np.abs([one.distance_mm, other.distance_mm]) / noise
        if np.mean(off > OUTLYING) < FOREIGN:
            squares = np.minimum(off, OUTLYING) ** 2
            gain += float(squares[0].sum() - squares[1].sum()) / alike
    fit = rounded if gain > MIN_CHI_SQUARE else pointed
    if fit is pointed:
        options.round_tail, options.widest_per_half = False, usual
    options.departing = departing
    if departing:
        fit = _core.fit_marks(marks, fit.laws, options)
    options.round_tail, options.widest_per_half = False, usual
    return fit, gain


def simulated(made: MarkCalibration, marks: list):
    """The brush that was found, as deep as marks ask for, and its traces along their ways, in the frame of the plan."""
    brush = made.brush
    run = {
        mark.stroke: residual.way_mm
        for mark, residual in zip(made.painted.marks, made.fit.marks, strict=True)
    }
    ways = [np.array(run.get(mark.stroke, mark.poses_mm)) for mark in marks]
    reach = max(brush.depth_range_mm[1], max(-way[:, 2].min() for way in ways) + made.fit.height_mm)
    brush = _core.read_brush(_core.write_brush(brush))
    brush.depth_range_mm = (brush.depth_range_mm[0], reach)
    passes = []
    for mark, poses in zip(marks, ways, strict=True):
        poses[:, 2] = np.minimum(poses[:, 2] - made.fit.height_mm, 0.0)
        passes.append(_core.Pass(mark.stroke, poses))
    return brush, _core.simulate(_core.Plan(brush.name, "", (1.0, 1.0), passes), brush).passes


def options_for(expected: dict) -> _core.MarkOptions:
    """What a measurement file says of how far sheet and marks may be off, for the fit."""
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
    noise_length_mm: float = 1.0,
    options: _core.MarkOptions | None = None,
    painted: list[_core.PaintedMark] | None = None,
) -> tuple[_core.Brush, list[str]]:
    """What marks of this plan will say of such a brush, before anyone paints: the brush as the fit sees it, with
    the covariance and intervals to expect, and in words what the strokes cannot separate.

    noise_mm: standard deviation of a painted edge, which forgets itself over noise_length_mm along the outline.
    options: sigmas of sheet, displacement and height, as for calibrate_marks.
    painted: expected_marks(plan, brush), where it is at hand.
    """
    painted = painted or expected_marks(plan, brush)
    fit = expected_fit(painted, plan, brush, noise_mm, noise_length_mm, options or _core.MarkOptions())
    return brush_of(fit.laws, brush.name, brush.depth_range_mm, np.array(fit.covariance)), fit.remarks


def expected_machine(
    plan: _core.Plan,
    brush: _core.Brush,
    noise_mm: float = 0.1,
    parts: tuple[str, ...] = tuple(PARTS),
    painted: list[_core.PaintedMark] | None = None,
) -> list[Number]:
    """Return the numbers of a machine without errors that such marks will give, each with half its 95 % interval."""
    options = _core.MarkOptions()
    ask_for(options, parts)
    painted = painted or expected_marks(plan, brush)
    fit = expected_fit(painted, plan, brush, noise_mm, 1.0, options)
    return numbers(fit, np.array(fit.covariance), options)


def expected_marks(plan: _core.Plan, brush: _core.Brush) -> list[_core.PaintedMark]:
    """The marks of a plan by such a brush, as the fit sees it: outlines in mm of the paper, without noise."""
    need_fits()
    _core.refuse_tilted(plan.passes, UPRIGHT)
    seen = brush_of(laws_of(brush), brush.name, brush.depth_range_mm)
    marks = _core.simulate(plan, seen)
    _core.trace_outlines(marks, seen)
    painted = [
        _core.PaintedMark(one.stroke, one.poses_mm, mark.outline_mm, one.arcs)
        for one, mark in zip(plan.passes, marks.passes, strict=True)
        if mark.outline_mm
    ]
    if not painted:
        raise Error("the plan paints nothing", "plan", code="nothing-painted")
    return painted


def expected_fit(painted, plan, brush, noise_mm: float, noise_length_mm: float, options) -> _core.MarkFit:
    """The fit of such marks with edges so uncertain. options: depths and numbers per law are set here."""
    options.deepest_mm = brush.depth_range_mm[1]
    depths = max(1, depths_painted([np.array(one.poses_mm) for one in plan.passes]))
    options.lag_terms = min(LAG_TERMS, depths)
    options.tip_gap_terms, options.half_width_terms = GAP_TERMS, min(HALF_TERMS, depths)
    options.noise_mm, options.noise_length_mm = noise_mm, noise_length_mm
    return _core.fit_marks(painted, laws_of(brush, options.lag_terms, options.half_width_terms), options)


def laws_of(brush: _core.Brush, lag_terms: int = LAG_TERMS, half_terms: int = HALF_TERMS) -> _core.MarkLaws:
    """The laws of a brush with as many numbers as marks give, nearest over its depths."""
    depths = np.linspace(*brush.depth_range_mm, 41)[1:]

    def nearest(law, powers):
        values = np.array([law(d) for d in depths])
        columns = np.vander(depths, powers[-1] + 1, increasing=True)[:, powers]
        out = np.zeros(powers[-1] + 1)
        out[powers] = np.linalg.lstsq(columns, values, rcond=None)[0]
        return out.tolist()

    half = np.array([brush.half_width(d) for d in depths])
    widest = np.array([brush.tip_to_widest(d) for d in depths])
    ends = [(s.outline_mm[:, 0].max(), s.depth_mm) for s in brush.footprints.dragged]
    front = [(end - brush.tip_to_widest(d)) / max(brush.half_width(d), 1e-6) for end, d in ends]
    return _core.MarkLaws(
        nearest(brush.lag, list(range(lag_terms))),
        nearest(brush.tip_gap, list(range(1, GAP_TERMS + 1))),
        nearest(brush.half_width, list(range(1, half_terms + 1))),
        float(widest @ half / (half @ half)),
        float(np.clip(np.median(front), 0.2, 3.0)),
    )


def brush_of(laws, name: str, depth_range_mm, covariance: np.ndarray | None = None) -> _core.Brush:
    """A brush with these laws, drops for footprints, and intervals where the covariance of a fit is given."""
    brush = _core.Brush()
    brush.name, brush.kind, brush.depth_range_mm = name, "round", tuple(depth_range_mm)
    least, deepest = depth_range_mm
    brush.lag, brush.tip_gap = _core.Profile(laws.lag), _core.Profile(laws.tip_gap)
    brush.half_width = _core.Profile(laws.half_width)
    # no polymul: it drops powers whose coefficient is 0, and rows of the covariance would be those of other laws
    widest = np.convolve(widest_ratio(laws), laws.half_width)
    brush.tip_to_widest = _core.Profile(widest.tolist(), **_floor(laws, deepest))
    brush.paint_depth_mm = (least + deepest) / 2
    depths = [least + (deepest - least) * k / OUTLINES for k in range(1, OUTLINES + 1)]
    brush.footprints = _core.FootprintTable([_outline(brush, depth, laws) for depth in depths])
    shape = "eggs" if laws.round_tail else "drops"
    brush.extra = outlines_assumed(
        f"{shape} whose widest section and width are those of the laws, {laws.front_per_half:.2f} half widths long "
        "in front of it."
    )
    if covariance is not None:
        whole = over_brush(laws, covariance)
        brush.covariance = whole.tolist()
        half_intervals = _core.deviations_of_95() * np.sqrt(np.maximum(np.diag(whole), 0.0))
        for law, place in places(brush).items():
            coefficients = getattr(brush, law).coefficients
            floor = _floor(laws, deepest) if law == "tip_to_widest" else {}
            setattr(brush, law, _core.Profile(coefficients, half_interval_95=half_intervals[place], **floor))
    return brush


def over_brush(laws, covariance: np.ndarray) -> np.ndarray:
    """From the fit's unknowns to a brush's coefficients; x_w = ratio h."""
    lag, gap, half = len(laws.lag), len(laws.tip_gap) - 1, len(laws.half_width) - 1
    ratio, own = widest_ratio(laws), np.array(laws.half_width)
    rows = lag + gap + 1 + half + len(ratio) + half + 1
    to = np.zeros((rows, len(covariance)))
    to[:lag, :lag] = np.eye(lag)
    to[lag + 1 : lag + 1 + gap, lag : lag + gap] = np.eye(gap)
    widest, width = lag + gap + 1, lag + gap + 1 + half + len(ratio) + 1
    for power in range(half):
        to[widest + 1 + power : widest + 1 + power + len(ratio), lag + gap + power] = ratio
    for power in range(len(ratio)):
        to[widest + power : widest + power + half + 1, lag + gap + half + power] = own
    to[width : width + half, lag + gap : lag + gap + half] = np.eye(half)
    return to @ covariance @ to.T


def widest_ratio(laws) -> np.ndarray:
    """Of the widest section's place to the half width, ascending powers of depth."""
    return np.array(laws.widest_by_depth or [laws.widest_per_half])


def front_ratio(laws) -> np.ndarray:
    """Of the footprint's length in front of that to the half width, ascending powers of depth."""
    return np.array(laws.front_by_depth or [laws.front_per_half])


def _floor(laws, deepest: float) -> dict[str, float]:
    """Of the widest section, where its ratio would fall below the least that a footprint has."""
    depths = np.linspace(0.0, deepest, 41)
    if polyval(depths, widest_ratio(laws)).min() >= LEAST_RATIO:
        return {}
    return {"floor": 0.0, "floor_slope": LEAST_RATIO * float(polyval(deepest, laws.half_width)) / deepest}


def _outline(brush: _core.Brush, depth: float, laws) -> _core.Footprint:
    half = brush.half_width(depth)
    shape = footprint_shapes.egg if laws.round_tail else footprint_shapes.drop
    front = max(LEAST_RATIO, polyval(depth, front_ratio(laws)))
    return _core.Footprint(depth, shape(half, brush.tip_to_widest(depth), front * half))


def _scale(fit, painted: Painted) -> SheetScale | None:
    """Of the sheet, by the displacements of the marks that are any of this brush."""
    like = [
        (middle(np.array(mark.poses_mm)[:, :2]), residual.displacement_mm)
        for mark, residual in zip(painted.marks, fit.marks, strict=True)
        if not residual.outlier
    ]
    return sheet_scale(*map(np.array, zip(*like, strict=True))) if like else None


def refuse_unlike(fit, painted: Painted) -> None:
    outliers, marks = sum(found.outlier for found in fit.marks), len(painted.marks)
    if 2 * outliers > marks:
        raise Error(
            f"{outliers} of {marks} marks are outliers, outside the range [0, {marks // 2}]: are the marks in mm, y "
            "up, each with the id of its stroke?",
            "marks",
            code="marks-outlying",
        )


def _refuse_undetermined(brush: _core.Brush, fit) -> None:
    depths = np.linspace(*brush.depth_range_mm, 21)[1:]
    covariance, at = np.array(brush.covariance), places(brush)
    for law in ("lag", "half_width"):  # the others do not matter for a plan
        half = half_interval_mm(covariance[at[law], at[law]], depths, None)
        values = np.array([getattr(brush, law)(d) for d in depths])
        undetermined = (half > UNDETERMINED * values) & (half > UNDETERMINED_MM)
        if undetermined.mean() > UNDETERMINED_PART:
            worst = int(np.argmax(np.where(undetermined, half / np.maximum(values, 1e-9), 0.0)))
            todo = (
                fit.remarks[0] if fit.remarks else "paint curved strokes at more depths, at the deepest too"
            )
            raise Error(
                f"these marks do not determine the {law.replace('_', ' ')}: {values[worst]:.1f} +- {half[worst]:.1f} "
                f"mm (95 %) at depth {depths[worst]:g} mm: {todo}",
                law,
                code="law-undetermined",
            )
