"""A brush from a few numbers: what was typed in becomes laws, what nobody measured is assumed and says so."""

from __future__ import annotations

import json
import math
from numbers import Real

from ... import _core
from ...errors import Error, as_listed, need, need_number
from ...model import footprint_shapes
from ...model.laws.fitted import need_fits
from . import plausibility

# The shape of a round brush's footprint in half widths, near what the article's brush has at depths 4 to 10 mm.
WIDEST_PER_HALF = 1.8  # from the tip to the widest section
GAP_PER_HALF = 1.2  # from the tip to the centre of friction
# How far a law may stay from the numbers that were typed in before a law that bends more is tried, and before it is
# given up: a ruler is read to a tenth; beyond half a millimetre the file's own check would complain.
CLOSE_MM, FAR_MM = 0.05, 0.5
# The same of a lag: where a mark begins is seen to some tenths. A law that bends to meet them closer bends on, too,
# where nobody measured.
LAG_CLOSE_MM, LAG_FAR_MM = 0.3, 1.0
LAG_DEGREES = (1, 2, 3)
BENDS = 1e-3  # weight of a law's bends against the data: small, it only decides where the data leave it open
DEPTHS = 10  # outlines, evenly spaced
LONGEST_MM = 1000.0
MOST = 1e9  # a larger number is damage; closer bounds are those of brushes


def new_brush(
    name: str,
    lag_mm: float | list[tuple[float, float]],
    widths_mm: list[tuple[float, float]],
    depth_max_mm: float | None = None,
    speed_mm_s: float = 25.0,
) -> _core.Brush:
    """A brush of such a lag whose marks have the given widths.

    lag_mm: the same at every depth, or (depth, lag) pairs, in any order; widths_mm: (depth, width) pairs, in any order;
    depth_max_mm: how deep it may be pressed, the deepest width by default. A lag of 0 makes a pen with a round nib.
    Raises Error for numbers that no brush can have.
    """
    need_fits()
    need(name, str, "the name of a brush")
    lag_mm, widths_mm = as_listed(lag_mm), as_listed(widths_mm)
    lags = sorted(_lags(lag_mm)) if isinstance(lag_mm, (list, tuple)) else []
    is_pen = not lags and need_number(lag_mm, "the lag [mm]", -MOST, MOST) == 0
    speed_mm_s = need_number(speed_mm_s, "the speed [mm/s]", -MOST, MOST)
    if depth_max_mm is not None:
        depth_max_mm = need_number(depth_max_mm, "the greatest depth [mm]", -MOST, MOST)
    widths = _sound(widths_mm)
    if not is_pen:
        plausibility.refuse_width(*widths[-1])
    deepest = widths[-1][0] if depth_max_mm is None else depth_max_mm
    if not widths[-1][0] <= deepest <= LONGEST_MM:
        sentence = (
            f"the greatest depth {deepest:g} mm is outside the range [{widths[-1][0]:g}, {LONGEST_MM:g}] mm"
        )
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
    brush.half_width = _nib(widths[0]) if is_pen and len(widths) == 1 else _half_width(widths, deepest)
    brush.lag = _lag(lags, deepest) if len(lags) > 1 else _same_lag(lags[0][1] if lags else lag_mm)
    if not is_pen:
        brush.tip_gap = _share(brush.half_width, GAP_PER_HALF, "The centre of friction")
        brush.tip_to_widest = _share(brush.half_width, WIDEST_PER_HALF, "The widest section")
    else:
        brush.tip_gap = brush.tip_to_widest = _share(brush.half_width, 1.0, "The middle of a round nib")
    brush.footprints = _core.FootprintTable(
        [_outline(brush, deepest * k / DEPTHS) for k in range(1, DEPTHS + 1)]
    )
    what = "Discs" if is_pen else "Drops"
    brush.extra = outlines_assumed(f"{what} as wide as half_width says; the same when pressed straight down.")
    _core.check(brush)
    return brush


def lag_of_turn(turn_mm: float, width_mm: float) -> float:
    """Return the lag of a brush by where its mark turns: so far before the tool's second line, after 90 degrees.

    The middle of the mark follows the widest section, which is assumed to be in front of the centre of friction.
    """
    return turn_mm + (WIDEST_PER_HALF - GAP_PER_HALF) * width_mm / 2


def outlines_assumed(source: str) -> str:
    """Return the contents of a brush file next to its laws when nobody measured its outlines, as JSON."""
    return json.dumps({"footprints": {"source": f"Assumed: {source}", "assumed": True}})


def _sound(widths_mm: list[tuple[float, float]]) -> list[tuple[float, float]]:
    need(widths_mm, (list, tuple), "a list of (depth, width)")
    _need_pairs(widths_mm, "width")
    if not widths_mm:
        raise Error(
            "there is no width: at least one is needed, for example 5 mm at depth 4 mm",
            "width",
            code="measurement-missing",
        )
    for depth, width in widths_mm:
        if not (math.isfinite(depth) and 0 < depth <= LONGEST_MM):
            raise Error(
                f"the depth {depth:g} mm of a width is outside the range (0, {LONGEST_MM:g}] mm",
                "width",
                depth,
                code="depth-out-of-range",
            )
        if not (math.isfinite(width) and 0 < width <= LONGEST_MM):
            raise Error(
                f"the width {width:g} mm is outside the range (0, {LONGEST_MM:g}] mm",
                "width",
                width,
                code="out-of-range",
            )
    return sorted(widths_mm)


def _need_pairs(pairs, what: str) -> None:
    for pair in pairs:
        if not isinstance(pair, (list, tuple)) or len(pair) != 2:
            raise Error(f"{str(pair)[:40]} is no (depth, {what}) in mm", what, code="wrong-type")
        for number in pair:
            need(number, Real, f"a depth or a {what} in mm")


def _lags(pairs) -> list[tuple[float, float]]:
    _need_pairs(pairs, "lag")
    if not pairs:
        raise Error(
            "there is no lag: one is needed, for example 6 mm at depth 4 mm",
            "lag",
            code="measurement-missing",
        )
    for depth, lag in pairs:
        if not (math.isfinite(depth) and 0 <= depth <= LONGEST_MM):
            sentence = f"the depth {depth:g} mm of a lag is outside the range [0, {LONGEST_MM:g}] mm"
            raise Error(sentence, "lag", depth, code="depth-out-of-range")
        if not (math.isfinite(lag) and 0 < lag <= LONGEST_MM):
            sentence = f"the lag {lag:g} mm at depth {depth:g} mm is outside the range (0, {LONGEST_MM:g}] mm"
            raise Error(sentence, "lag", lag, code="out-of-range")
    return list(pairs)


def _same_lag(lag_mm: float) -> _core.Profile:
    source = f"{lag_mm:g} mm as typed in; that it is the same at every depth is assumed."
    return _core.Profile([lag_mm], source=source, assumed=True)


def _lag(lags: list[tuple[float, float]], deepest: float) -> _core.Profile:
    """A straight line over depth, or the least bent law that comes close enough; never negative."""
    depths, values = [depth for depth, _ in lags], [lag for _, lag in lags]
    places = len(set(depths))
    if lags[-1][0] > deepest:
        raise Error(
            f"the depth {lags[-1][0]:g} mm of a lag is outside the range [0, {deepest:g}] mm of the widths: give the "
            "greatest depth, or a width there",
            "lag",
            lags[-1][0],
            code="depth-out-of-range",
        )
    for degree in LAG_DEGREES if places > 1 else (0,):
        if degree > places:
            continue
        # as many bends as places only where a line would be negative at the touch
        smoothing = BENDS if degree == places else 0.0
        shape = _core.LawShape((0.0, deepest), degree, positive=True, smoothing=smoothing)
        fit = _core.fit_law(depths, values, shape)
        worst = max(range(len(depths)), key=lambda i: abs(fit.residual_mm[i]))
        off_mm = abs(fit.residual_mm[worst])
        if off_mm <= LAG_CLOSE_MM:
            break
    if off_mm > LAG_FAR_MM:
        raise Error(
            f"no brush fits these lags: a law over depth differs by {off_mm:.1f} mm from the lag "
            f"{values[worst]:g} mm at depth {depths[worst]:g} mm, outside the range "
            f"[0, {LAG_FAR_MM:g}] mm: are they in the right order?",
            "lag",
            values[worst],
            code="law-undetermined",
        )
    listed = ", ".join(f"{lag:g} mm at depth {depth:g} mm" for depth, lag in lags[:4])
    more = f" and {len(lags) - 4} more" if len(lags) > 4 else ""
    return _core.Profile(
        fit.law.coefficients,
        calibrated_mm=fit.law.calibrated_mm,
        source=f"Lags as typed in: {listed}{more}; met to {off_mm:.2f} mm.",
        assumed=places == 1,
        half_interval_95=fit.law.half_interval_95,
        rmse_mm=fit.law.rmse_mm,
        degrees_of_freedom=fit.law.degrees_of_freedom,
    )


def _nib(width: tuple[float, float]) -> _core.Profile:
    source = (
        f"Width as typed in: {width[1]:g} mm at depth {width[0]:g} mm; that it is the same at all is assumed."
    )
    return _core.Profile([width[1] / 2], source=source, assumed=True)


def _half_width(widths: list[tuple[float, float]], deepest: float) -> _core.Profile:
    """Nothing at depth 0, never falling, through the widths: the simplest law that comes close enough."""
    depths, halves = [depth for depth, _ in widths], [width / 2 for _, width in widths]
    places = len(set(depths))
    for degree in (2, 3, 8) if places > 1 else (1,):
        if degree <= 3 and degree > places:
            continue
        shape = _core.LawShape(
            (0.0, deepest), degree, through_zero=True, rising=True, smoothing=BENDS if degree > 3 else 0.0
        )
        fit = _core.fit_law(depths, halves, shape)
        worst = max(range(len(depths)), key=lambda i: abs(fit.residual_mm[i]))
        off_mm = abs(fit.residual_mm[worst])
        if off_mm <= CLOSE_MM:
            break
    if off_mm > FAR_MM:
        raise Error(
            f"no brush fits these widths: a law that never falls differs by {2 * off_mm:.2f} mm from the width "
            f"{2 * halves[worst]:g} mm at depth {depths[worst]:g} mm, outside the range [0, {2 * FAR_MM:g}] mm: are "
            "they in the right order?",
            "width",
            2 * halves[worst],
            code="width-falls",
        )
    listed = ", ".join(f"{width:g} mm at depth {depth:g} mm" for depth, width in widths[:4])
    more = f" and {len(widths) - 4} more" if len(widths) > 4 else ""
    return _core.Profile(
        fit.law.coefficients,
        calibrated_mm=fit.law.calibrated_mm,
        source=f"Widths as typed in: {listed}{more}; met to {2 * off_mm:.2f} mm. That the brush touches with no width "
        "at depth 0 is assumed.",
        assumed=places == 1,
        half_interval_95=fit.law.half_interval_95,
        rmse_mm=fit.law.rmse_mm,
        degrees_of_freedom=fit.law.degrees_of_freedom,
    )


def _share(half_width: _core.Profile, share: float, what: str) -> _core.Profile:
    return _core.Profile(
        [share * c for c in half_width.coefficients],
        source=f"{what} is assumed to be {share:g} half widths from the tip.",
        assumed=True,
    )


def _outline(brush: _core.Brush, depth: float) -> _core.Footprint:
    half = brush.half_width(depth)
    if brush.is_rigid():
        return _core.Footprint(depth, footprint_shapes.disc(half))
    return _core.Footprint(depth, footprint_shapes.drop(half, brush.tip_to_widest(depth), half))
