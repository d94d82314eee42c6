"""Make a brush from dabs.

It has the outlines of the dabs, and laws of width, widest section and tip gap that agree with them. Dabs do not show
the lag. The brush keeps the lag of the brush for which the chart of dabs was made.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ...model.confidence import places
from ...model.extra_keys import read_extra_keys
from ...model.laws.fitted import need_fits
from .dab_outlines import MAX_SMOOTHING_MM, Dab, Outlines, Shape, average_dabs, widths_at

# A law has enough terms if it is this close to the mean of each depth, in mm or in standard errors of the mean.
GOOD_MISFIT_MM, GOOD_MISFIT_ERRORS = 0.03, 2.0
MAX_MISFIT_MM = 0.4  # largest distance of a law from an outline; with more, the brush would be refused
MAX_TERMS = 5
BROAD_WIDTH_SHARE = 0.85  # dabs are compared by the part that is wider than this share of the greatest width
MAX_HALF_WIDTH_FALL_MM = 0.1  # deeper dabs may be narrower by this much; with more, paint ran out
MAX_LAG_DIFFERENCE = 0.2  # largest relative difference between the lag and the run of the tool
LAWS = ("half_width", "tip_to_widest", "tip_gap")


@dataclass(frozen=True)
class DabCalibration:
    """A brush made from dabs.

    before: the brush whose lag was used. values: for each law, (n, 2) depths and measured values [mm].
    """

    brush: _core.Brush
    before: _core.Brush
    outlines: Outlines
    values: dict[str, np.ndarray]
    edge_mm: float
    remarks: tuple[Notice, ...]


def calibrate_dabs(
    dabs: list[Dab], before: _core.Brush, name: str, edge_mm: float = 0.0, joined: tuple[str, ...] = ()
) -> DabCalibration:
    """Fit a brush to dabs.

    before: the brush for whose lag the chart of dabs was made. edge_mm: standard deviation of a common outward shift of
    all edges. joined: names of dabs that touch others.

    Raises Error if the dabs do not determine an outline, and if the brush cannot be used.
    """
    need_fits()
    _refuse_other_lag(dabs, before)

    def dragged_mm(dab: Dab) -> float:
        return dab.run_mm - before.lag.extrapolated(dab.depth_mm)

    outlines = average_dabs(dabs, set(joined), dragged_mm)
    shapes = outlines.shapes
    _refuse_falling(shapes)
    values = {law: np.vstack([_values_of_law(law, shape) for shape in shapes]) for law in LAWS}
    brush = _with_outlines(before, name, outlines)
    fits = {law: _fit_law(law, values[law], brush.depth_range_mm) for law in LAWS}
    for law in LAWS:
        setattr(brush, law, _make_profile(fits[law].law, shapes, fits[law].law.half_interval_95))
    covariance = _covariance(before, brush, fits, values, edge_mm)
    if covariance is not None:
        brush.covariance = covariance.tolist()
        for law in LAWS:
            variance = np.diag(covariance)[places(brush)[law]]
            half = _core.interval_factor_95(fits[law].law.degrees_of_freedom) * np.sqrt(variance)
            setattr(brush, law, _make_profile(fits[law].law, shapes, half.tolist()))
    _core.check(brush)
    return DabCalibration(brush, before, outlines, values, edge_mm, outlines.remarks)


def _refuse_other_lag(dabs: list[Dab], before: _core.Brush) -> None:
    least, deepest = before.depth_range_mm
    for dab in dabs:
        if not least <= dab.depth_mm <= deepest + 1e-6:
            sentence = (
                f"the dab was pressed {dab.depth_mm:g} mm deep, but brush {before.name} may be pressed only {least:g} "
                f"to {deepest:g} mm"
            )
            raise Error(sentence, dab.name, dab.depth_mm, code="depth-out-of-range")
    lag_differences = {
        dab.name: dab.run_mm / before.lag.extrapolated(dab.depth_mm) - 1
        for dab in dabs
        if before.lag.extrapolated(dab.depth_mm) > 0
    }
    worst = max(lag_differences, key=lambda name: abs(lag_differences[name]), default=None)
    if worst is None or abs(lag_differences[worst]) > MAX_LAG_DIFFERENCE:
        dab = next(dab for dab in dabs if worst in (None, dab.name))
        sentence = (
            f"the tool moved {dab.run_mm:.1f} mm while it was pressed, but brush {before.name} lags "
            f"{before.lag.extrapolated(dab.depth_mm):.1f} mm at this depth; they may differ by "
            f"{100 * MAX_LAG_DIFFERENCE:g} % at most. Make the page of dabs with `brushsvg chart --dabs --brush` and "
            "this brush, and paint it"
        )
        raise Error(sentence, dab.name, dab.run_mm, code="dabs-of-another-brush")


def _refuse_falling(shapes: tuple[Shape, ...]) -> None:
    half = [_greatest_half_width(shape) for shape in shapes]
    for k in range(1, len(half)):
        if half[k] < half[k - 1] - MAX_HALF_WIDTH_FALL_MM:
            sentence = (
                f"dabs at depth {shapes[k].depth_mm:g} mm are {2 * half[k]:.2f} mm wide, narrower than dabs at "
                f"{shapes[k - 1].depth_mm:g} mm ({2 * half[k - 1]:.2f} mm). A brush that is pressed deeper does not "
                "get narrower: paint the page again with enough paint for all dabs"
            )
            raise Error(sentence, f"{shapes[k].depth_mm:g} mm", 2 * half[k], code="width-falls")


def _greatest_half_width(shape: Shape) -> float:
    return float(widths_at(shape.outline_mm)[1].max() / 2)


def _values_of_law(law: str, shape: Shape) -> np.ndarray:
    """Return depths and values of a law, one row for each dab."""
    depth = shape.depth_mm
    if law == "tip_to_widest":
        tops = np.array([_broad_middle(patch_dab.outline_mm) for patch_dab in shape.seen])
        return np.column_stack([np.full(len(tops), depth), _widest_place(shape.outline_mm) + tops - tops.mean()])
    if law == "tip_gap":
        # A dab that is displaced forward has its tip nearer to the place where it was set down.
        return np.array([[depth, shape.tip_gap_mm - patch_dab.displacement_mm[0]] for patch_dab in shape.seen])
    spans = np.array([_breadth(patch_dab.outline_mm) for patch_dab in shape.seen])
    return np.column_stack([np.full(len(spans), depth), _greatest_half_width(shape) + (spans - spans.mean()) / 2])


def _breadth(outline: np.ndarray) -> float:
    """Return the width between means of the outermost points; noise does not increase a distance of means."""
    y = np.sort(outline[:, 1])
    count = max(1, len(y) // 10)
    return float(y[-count:].mean() - y[:count].mean())


def _widest_place(outline: np.ndarray) -> float:
    """Return the middle of the sections that are the widest, within the error."""
    x, wide = widths_at(outline)
    top = x[wide >= wide.max() - 0.004]
    return float((top[0] + top[-1]) / 2)


def _broad_middle(outline: np.ndarray) -> float:
    """Return the middle of an outline's broad part, by a parabola: the single broadest point is chance."""
    x, wide = widths_at(np.roll(outline, -int(outline[:, 0].argmin()), axis=0))
    broad = wide >= BROAD_WIDTH_SHARE * wide.max()
    bend, slope, _ = np.polyfit(x[broad], wide[broad], 2)
    return float(np.clip(-slope / (2 * bend), x[0], x[-1])) if bend < 0 else float(x[broad].mean())


def _fit_law(law: str, values: np.ndarray, range_mm, terms: int = 0):
    """Fit the law with `terms` terms, or with the fewest that come close to the mean of each depth."""
    depths, counts = np.unique(values[:, 0], return_counts=True)
    means = np.array([values[values[:, 0] == depth, 1].mean() for depth in depths])
    spread = values[:, 1] - means[np.searchsorted(depths, values[:, 0])]
    error = np.sqrt(np.sum(spread**2) / max(1, len(values) - len(depths)) / counts)
    tolerance = np.maximum(GOOD_MISFIT_MM, GOOD_MISFIT_ERRORS * error)
    max_terms = min(MAX_TERMS, len(depths))
    for count in [terms] if terms else range(1, max_terms + 1):
        shape = _core.LawShape(
            tuple(range_mm),
            count,
            through_zero=True,
            positive=law != "half_width",
            rising=law == "half_width",
        )
        fit = _core.fit_law(values[:, 0].tolist(), values[:, 1].tolist(), shape)
        misfits = [float(np.mean(np.array(fit.residual_mm)[values[:, 0] == depth])) for depth in depths]
        worst = int(np.argmax(np.abs(misfits)))
        if (np.abs(misfits) <= tolerance).all():
            break
    if abs(misfits[worst]) > MAX_MISFIT_MM:
        sentence = (
            f"no smooth {law.replace('_', ' ')} over depth fits the dabs to {MAX_MISFIT_MM:g} mm: at depth "
            f"{depths[worst]:g} mm it is {misfits[worst]:.2f} mm off. Check the outlines (--marks-picture)"
        )
        raise Error(sentence, law, misfits[worst], code="law-undetermined")
    return fit


def _with_outlines(before: _core.Brush, name: str, outlines: Outlines) -> _core.Brush:
    shapes = outlines.shapes
    brush = _core.Brush()
    brush.name, brush.kind, brush.lag = name, before.kind, before.lag
    brush.depth_range_mm = (before.depth_range_mm[0], shapes[-1].depth_mm)
    brush.max_speed_mm_s, brush.paint = before.max_speed_mm_s, before.paint
    brush.paint_depth_mm = min(before.paint_depth_mm, shapes[-1].depth_mm)
    brush.footprints = _core.FootprintTable(
        [_core.Footprint(shape.depth_mm, shape.outline_mm.round(4) + 0.0) for shape in shapes]
    )
    count = sum(len(shape.seen) for shape in shapes)
    source = (
        f"Measured: {count} dabs at {len(shapes)} depths, averaged for each depth and smoothed by "
        f"{MAX_SMOOTHING_MM:g} mm at most. A brush that is dragged may have other outlines."
    )
    unsure = max(shape.unsure_mm for shape in shapes)
    extra = read_extra_keys(before.extra) | {
        "footprints": {"source": source, "assumed": False, "standard_error_mm": round(unsure, 3)}
    }
    brush.extra = json.dumps(extra)
    return brush


def _make_profile(law: _core.Profile, shapes: tuple[Shape, ...], half_interval_95) -> _core.Profile:
    return _core.Profile(
        law.coefficients,
        calibrated_mm=(shapes[0].depth_mm, shapes[-1].depth_mm),
        source=f"Fitted to the outlines of {sum(len(shape.seen) for shape in shapes)} dabs.",
        half_interval_95=half_interval_95,
        rmse_mm=law.rmse_mm,
        degrees_of_freedom=law.degrees_of_freedom,
    )


def _covariance(before, brush, fits, values, edge_mm: float) -> np.ndarray | None:
    """Return the covariance of the unchanged lag and the new laws, with a common shift of all edges."""
    if any(not np.size(fit.covariance) for fit in fits.values()):
        return None
    at = places(brush)
    out = np.zeros((at["half_width"].stop, at["half_width"].stop))
    if len(before.covariance):
        lag = places(before)["lag"]
        out[at["lag"], at["lag"]] = np.array(before.covariance)[lag, lag]
    change = np.zeros(len(out))
    for law, fit in fits.items():
        out[at[law], at[law]] = fit.covariance
        wider = values[law] + [0.0, edge_mm]
        shifted_fit = _fit_law(law, wider, brush.depth_range_mm, len(fit.law.coefficients) - 1)
        change[at[law]] = np.array(shifted_fit.law.coefficients) - fit.law.coefficients
    return out + np.outer(change, change)
