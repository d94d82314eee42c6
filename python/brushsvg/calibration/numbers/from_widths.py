"""Make a brush from a few typed numbers.

Laws that nobody measured are assumed, and the brush says so.
"""

from __future__ import annotations

import json

from ... import _core
from ...errors import Error, as_listed, as_number, list_first, need_number, require_type
from ...model import footprint_shapes
from ...model.laws.fitted import need_fits
from . import plausibility

# Shape of a round brush's footprint in half widths, close to the article's brush at depths of 4 to 10 mm.
WIDEST_PER_HALF = 1.8  # from the tip to the widest section
GAP_PER_HALF = 1.2  # from the tip to the centre of friction
# Distance of a law of half width from the typed numbers. Above the first limit, a law that bends more is tried; above
# the second, the numbers are refused. A ruler is read to a tenth of a millimetre. Beyond half a millimetre the check
# of the brush file would complain.
GOOD_HALF_WIDTH_MISFIT_MM, MAX_HALF_WIDTH_MISFIT_MM = 0.05, 0.5
# The corresponding limits of a lag. The start of a mark is visible to some tenths of a millimetre. A law that bends to
# come closer also bends where nobody measured.
GOOD_LAG_MISFIT_MM, MAX_LAG_MISFIT_MM = 0.3, 1.0
LAG_DEGREES = (1, 2, 3)
# Weight of a law's curvature against the data: small, so it only decides what the data leave open.
CURVATURE_WEIGHT = 1e-3
OUTLINE_COUNT = 10  # number of outlines, evenly spaced in depth
MAX_LENGTH_MM = 1000.0
MAX_NUMBER = 1e9  # a larger number is a mistake; the closer limits are those of brushes


def new_brush(
    name: str,
    lag_mm: float | list[tuple[float, float]],
    widths_mm: list[tuple[float, float]],
    depth_max_mm: float | None = None,
    speed_mm_s: float = 25.0,
) -> _core.Brush:
    """Make a brush with the given lag whose marks have the given widths.

    lag_mm: one lag for all depths, or (depth, lag) pairs in any order. A lag of 0 makes a pen with a round nib.
    widths_mm: (depth, width) pairs in any order. depth_max_mm: how deep the brush may be pressed; by default the depth
    of the deepest width. speed_mm_s: the greatest speed of the brush.

    Raises Error for numbers that no brush can have.
    """
    need_fits()
    require_type(name, str, "the name of a brush")
    lag_mm, widths_mm = as_listed(lag_mm), as_listed(widths_mm)
    lags = []
    if isinstance(lag_mm, (list, tuple)):
        lags = sorted(_need_pairs(lag_mm, "lag", "one is needed, for example 6 mm at depth 4 mm", may_touch=True))
    lag_mm = 0.0 if lags else need_number(lag_mm, "the lag [mm]", -MAX_NUMBER, MAX_NUMBER)
    is_pen = not lags and lag_mm == 0
    speed_mm_s = need_number(speed_mm_s, "the speed [mm/s]", -MAX_NUMBER, MAX_NUMBER)
    if depth_max_mm is not None:
        depth_max_mm = need_number(depth_max_mm, "the greatest depth [mm]", -MAX_NUMBER, MAX_NUMBER)
    require_type(widths_mm, (list, tuple), "a list of (depth, width)")
    needed = "at least one is needed, for example 5 mm at depth 4 mm"
    widths = sorted(_need_pairs(widths_mm, "width", needed, may_touch=False))
    if not is_pen:
        plausibility.refuse_width(*widths[-1])
    deepest = widths[-1][0] if depth_max_mm is None else depth_max_mm
    if not widths[-1][0] <= deepest <= MAX_LENGTH_MM:
        sentence = f"the greatest depth {deepest:g} mm is outside the range [{widths[-1][0]:g}, {MAX_LENGTH_MM:g}] mm"
        raise Error(
            f"{sentence} from the deepest width to the longest brush: give a greater one, or leave deeper widths out",
            "depth",
            deepest,
            code="depth-out-of-range",
        )
    brush = _core.Brush()
    brush.name, brush.kind = name, "pen" if is_pen else "round"
    brush.depth_range_mm = (0.0, deepest)
    brush.max_speed_mm_s = speed_mm_s
    brush.paint_depth_mm = deepest / 2
    brush.half_width = (
        _constant_half_width(widths[0]) if is_pen and len(widths) == 1 else _fit_half_width(widths, deepest)
    )
    brush.lag = _fit_lag(lags, deepest) if len(lags) > 1 else _constant_lag(lags[0][1] if lags else lag_mm)
    if not is_pen:
        brush.tip_gap = _assumed_profile(brush.half_width, GAP_PER_HALF, "The centre of friction")
        brush.tip_to_widest = _assumed_profile(brush.half_width, WIDEST_PER_HALF, "The widest section")
    else:
        brush.tip_gap = brush.tip_to_widest = _assumed_profile(brush.half_width, 1.0, "The middle of a round nib")
    brush.footprints = _core.FootprintTable(
        [_assumed_footprint(brush, deepest * k / OUTLINE_COUNT) for k in range(1, OUTLINE_COUNT + 1)]
    )
    what = "Discs" if is_pen else "Drops"
    brush.extra = outlines_assumed(f"{what} with the width of half_width, also when pressed straight down.")
    _core.check(brush)
    return brush


def lag_of_turn(turn_mm: float, width_mm: float) -> float:
    """Return the lag of a brush [mm] from the place where its mark turns.

    turn_mm: how far before the tool's second line the mark turns, for a turn of 90 degrees. width_mm: width of the
    mark.
    The middle of the mark follows the widest section, which is assumed to be in front of the centre of friction.
    """
    return turn_mm + (WIDEST_PER_HALF - GAP_PER_HALF) * width_mm / 2


def outlines_assumed(source: str) -> str:
    """Return the JSON that marks the outlines of a brush as assumed."""
    return json.dumps({"footprints": {"source": f"Assumed: {source}", "assumed": True}})


def _need_pairs(pairs, what: str, needed: str, may_touch: bool) -> list[tuple[float, float]]:
    """Return (depth, value) pairs as floats; raise Error for pairs that no brush can have.

    needed: words for the error if there is no pair. may_touch: whether a depth may be 0, where the brush just touches.
    """
    checked = []
    for pair in pairs:
        if not isinstance(pair, (list, tuple)) or len(pair) != 2:
            raise Error(f"{str(pair)[:40]} is not a pair (depth, {what}) in mm", what, code="wrong-type")
        depth, value = (as_number(number, f"a depth or a {what} in mm") for number in pair)
        checked.append((depth, value))
    if not checked:
        raise Error(f"there is no {what}: {needed}", what, code="measurement-missing")
    for depth, value in checked:
        if not 0 <= depth <= MAX_LENGTH_MM or (depth == 0 and not may_touch):
            depths = f"{'[' if may_touch else '('}0, {MAX_LENGTH_MM:g}] mm"
            sentence = f"the depth {depth:g} mm of a {what} is outside the range {depths}"
            raise Error(sentence, what, depth, code="depth-out-of-range")
        if not 0 < value <= MAX_LENGTH_MM:
            place = f" at depth {depth:g} mm" if may_touch else ""
            sentence = f"the {what} {value:g} mm{place} is outside the range (0, {MAX_LENGTH_MM:g}] mm"
            raise Error(sentence, what, value, code="out-of-range")
    return checked


def _constant_lag(lag_mm: float) -> _core.Profile:
    source = f"{lag_mm:g} mm as typed in; assumed to be equal at every depth."
    return _core.Profile([lag_mm], source=source, assumed=True)


def _fit_lag(lags: list[tuple[float, float]], deepest: float) -> _core.Profile:
    """Fit the law of lag of the lowest degree that comes close enough and is never negative."""
    depths, values = [depth for depth, _ in lags], [lag for _, lag in lags]
    depth_count = len(set(depths))
    if lags[-1][0] > deepest:
        sentence = (
            f"the depth {lags[-1][0]:g} mm of a lag is outside the range [0, {deepest:g}] mm of the widths: give the "
            "greatest depth, or a width at this depth"
        )
        raise Error(sentence, "lag", lags[-1][0], code="depth-out-of-range")
    if depth_count > 1:
        plausibility.refuse_falling("lag", depths, values, "lag")
    shapes = [
        # A degree equal to the number of depths is only needed if a line would be negative at first touch.
        _core.LawShape(
            (0.0, deepest), degree, positive=True, smoothing=CURVATURE_WEIGHT if degree == depth_count else 0.0
        )
        for degree in (LAG_DEGREES if depth_count > 1 else (0,))
        if degree <= depth_count
    ]
    fit, worst, misfit_mm = _fit_simplest_law(depths, values, shapes, GOOD_LAG_MISFIT_MM)
    if misfit_mm > MAX_LAG_MISFIT_MM:
        sentence = (
            f"no brush fits these lags: the best curve over depth differs by {misfit_mm:.1f} mm from the lag "
            f"{values[worst]:g} mm at depth {depths[worst]:g} mm, outside the range "
            f"[0, {MAX_LAG_MISFIT_MM:g}] mm. Check the order of the values"
        )
        raise Error(sentence, "lag", values[worst], code="law-undetermined")
    source = f"Lags as typed in: {_list_pairs(lags)}; fitted to {misfit_mm:.2f} mm."
    return _profile_of_fit(fit, source, depth_count)


def _constant_half_width(width: tuple[float, float]) -> _core.Profile:
    source = f"Width as typed in: {width[1]:g} mm at depth {width[0]:g} mm; assumed to be equal at every depth."
    return _core.Profile([width[1] / 2], source=source, assumed=True)


def _fit_half_width(widths: list[tuple[float, float]], deepest: float) -> _core.Profile:
    """Fit the simplest law of half width that comes close enough, is 0 at depth 0 and never falls."""
    depths, halves = [depth for depth, _ in widths], [width / 2 for _, width in widths]
    depth_count = len(set(depths))
    shapes = [
        _core.LawShape(
            (0.0, deepest),
            degree,
            through_zero=True,
            rising=True,
            smoothing=CURVATURE_WEIGHT if degree > 3 else 0.0,
        )
        for degree in ((2, 3, 8) if depth_count > 1 else (1,))
        if degree > 3 or degree <= depth_count
    ]
    fit, worst, misfit_mm = _fit_simplest_law(depths, halves, shapes, GOOD_HALF_WIDTH_MISFIT_MM)
    if misfit_mm > MAX_HALF_WIDTH_MISFIT_MM:
        sentence = (
            f"no brush fits these widths: the best rising curve differs by {2 * misfit_mm:.2f} mm from the width "
            f"{2 * halves[worst]:g} mm at depth {depths[worst]:g} mm, outside the range "
            f"[0, {2 * MAX_HALF_WIDTH_MISFIT_MM:g}] mm. Check the order of the values"
        )
        raise Error(sentence, "width", 2 * halves[worst], code="width-falls")
    if depth_count > 1:
        plausibility.refuse_falling("width", depths, [2 * half for half in halves], "width")
    source = f"Widths as typed in: {_list_pairs(widths)}; fitted to {2 * misfit_mm:.2f} mm."
    return _profile_of_fit(fit, f"{source} The width at depth 0 is assumed to be 0.", depth_count)


def _fit_simplest_law(depths: list[float], values: list[float], shapes, good_misfit_mm: float):
    """Return the first fit of the shapes with a good misfit, or the last, its worst value and misfit [mm]."""
    for shape in shapes:
        fit = _core.fit_law(depths, values, shape)
        misfits_mm = [abs(residual) for residual in fit.residual_mm]
        if max(misfits_mm) <= good_misfit_mm:
            break
    return fit, misfits_mm.index(max(misfits_mm)), max(misfits_mm)


def _list_pairs(pairs: list[tuple[float, float]]) -> str:
    return list_first([f"{value:g} mm at depth {depth:g} mm" for depth, value in pairs], 4)


def _profile_of_fit(fit, source: str, depth_count: int) -> _core.Profile:
    return _core.Profile(
        fit.law.coefficients,
        calibrated_mm=fit.law.calibrated_mm,
        source=source,
        assumed=depth_count == 1,
        half_interval_95=fit.law.half_interval_95,
        rmse_mm=fit.law.rmse_mm,
        degrees_of_freedom=fit.law.degrees_of_freedom,
    )


def _assumed_profile(half_width: _core.Profile, share: float, what: str) -> _core.Profile:
    return _core.Profile(
        [share * c for c in half_width.coefficients],
        source=f"{what} is assumed to be {share:g} half widths from the tip.",
        assumed=True,
    )


def _assumed_footprint(brush: _core.Brush, depth: float) -> _core.Footprint:
    half = brush.half_width(depth)
    if brush.is_rigid():
        return _core.Footprint(depth, footprint_shapes.disc(half))
    return _core.Footprint(depth, footprint_shapes.drop(half, brush.tip_to_widest(depth), half))
