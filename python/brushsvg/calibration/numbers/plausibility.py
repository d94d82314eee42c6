"""Refuse measurements that no brush can have, and find outliers and unusual values.

Refused measurements have wrong units or a wrong order of rows, or they do not determine a law.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ...model.confidence import law_band

# Least first angle of a series. A series that starts nearer to the motion cannot be read. An angle of 90 degrees that
# was given in radians (1.57) is below it.
MIN_ALPHA0_DEG = 5.0
MAX_ANGLE_GROWTH_DEG = 5.0  # noise may let an angle grow by this much during a drag
ANGLE_READING_ERROR_DEG = 6.0  # error of a reading, as in the article
MAX_START_OFFSET_LAGS = 0.5  # in lags: a series may seem to begin this much earlier or later
MAX_UNDETERMINED_SHARE = 0.25  # share of the depths at which the interval of a law may include 0
MIN_OUTLIER_SIGMAS = 4.0  # standard deviations of normal noise: one value in ten thousand
DISTINCT_DEPTH_SHARE = 0.02  # share of the greatest depth: depths that differ by less count as one
# Lag / half width is 3 to 10 for round-6 and 40 for a liner of 20 mm. Outside of the first range, units are mixed up.
LAG_PER_HALF_WIDTH, USUAL_LAG_PER_HALF_WIDTH = (0.02, 200.0), (0.3, 60.0)
MIN_CONTRADICTION = 0.15  # relative misfit from which half widths and widths contradict each other
MIN_MISTAKE_RATIO = 3.0  # the misfit falls by this factor if one was mistaken for the other
# Half width / depth is 0.42 for round-6 and 0.2 for a liner. Widths in inches make it 25.4 times smaller, depths in
# inches 25.4 times larger.
HALF_WIDTH_PER_DEPTH, USUAL_HALF_WIDTH_PER_DEPTH = (0.01, 20.0), (0.05, 5.0)
# Share of a lag by which it may fall at the next depth. If lags are read to half a millimetre, a rising lag seems to
# fall this much once in fifty times.
MAX_LAG_FALL = 0.1
VISIBLE_MM = 0.3  # the start of a mark is visible to some tenths of a mm: lags that differ by less may be equal
MAX_DEPTH_PER_MEASURED = 1.5  # times the deepest measurement: deeper, a law of fourth degree is meaningless
MIN_USUAL_DEPTH_MM = 1.0  # a brush that is never pressed deeper may have been measured in inches


def count_distinct_depths(depths_mm: list[float]) -> int:
    """Count the depths, treating depths that hardly differ as one."""
    ordered = np.unique(depths_mm)
    count, at = 0, 0
    while at < len(ordered):
        count += 1
        at = int(np.searchsorted(ordered, ordered[at] + DISTINCT_DEPTH_SHARE * ordered[-1], "right"))
    return count


def refuse_series(where: str, alpha0_deg: float, s_mm, alpha_deg) -> None:
    """Raise Error for angles of a drag that are in radians or in the wrong order."""
    if alpha0_deg < MIN_ALPHA0_DEG:
        sentence = (
            f"the series starts {alpha0_deg:g} degrees from the motion, but at least {MIN_ALPHA0_DEG:g} degrees are "
            "needed: turn by 90 degrees before the drag, and write angles in degrees, not radians"
        )
        raise Error(sentence, where, alpha0_deg, code="angles-in-radians")
    if alpha_deg and max(alpha_deg) < math.pi:
        sentence = (
            f"no angle after the first is greater than {max(alpha_deg):.3g} degrees, which is too small to be read: "
            "write angles in degrees, not radians"
        )
        raise Error(sentence, where, max(alpha_deg), code="angles-in-radians")
    if len(s_mm) == len(alpha_deg) and len(s_mm) > 1:
        first, last = int(np.argmin(s_mm)), int(np.argmax(s_mm))
        if alpha_deg[last] > alpha_deg[first] + MAX_ANGLE_GROWTH_DEG:
            raise Error(
                f"the angle grows from {alpha_deg[first]:g} degrees after {s_mm[first]:g} mm to {alpha_deg[last]:g} "
                f"after {s_mm[last]:g} mm, but a dragged brush turns towards its motion: check the order of the rows",
                where,
                code="angles-grow",
            )


def refuse_displaced_start(where: str, alpha0_deg: float, s_mm, alpha_deg) -> None:
    """Raise Error if the first angle is not the angle at 0 mm.

    The other angles fall as in a drag.

    ln tan(alpha/2) falls by 1 per lag. A line with a free start is fitted to it, and each reading is weighted by its
    certainty.
    """
    series = [(s, a) for s, a in zip(s_mm, alpha_deg, strict=True) if s > 0 and 0 < a < alpha0_deg]
    s, alpha = np.array(series).reshape(-1, 2).T * [[1.0], [math.pi / 180]]
    if len(np.unique(s)) < 2:
        return
    log_ratio = np.log(np.tan(alpha / 2) / math.tan(math.radians(alpha0_deg) / 2))
    columns = np.column_stack([np.ones_like(s), s]) * np.sin(alpha)[:, None]
    line, *_ = np.linalg.lstsq(columns, log_ratio * np.sin(alpha), rcond=None)
    residuals = columns @ line - log_ratio * np.sin(alpha)
    noise = max(math.sqrt(residuals @ residuals / max(len(s) - 2, 1)), math.radians(ANGLE_READING_ERROR_DEG))
    error = noise * math.sqrt(np.linalg.inv(columns.T @ columns)[0, 0])
    if abs(line[0]) > max(MAX_START_OFFSET_LAGS, MIN_OUTLIER_SIGMAS * error):
        raise Error(
            f"the angles fall as if the drag had begun {abs(line[0]):.2g} lags "
            f"{'before' if line[0] < 0 else 'after'} s_mm = 0, where the angle was {alpha0_deg:g} degrees: measure "
            "s_mm from the place where the drag begins, and write all angles in degrees",
            where,
            code="angles-from-elsewhere",
        )


@dataclass(frozen=True)
class Outlier:
    """A value that does not belong to the others.

    size: the studentized residual, given as the size of an equally unlikely normal value. off_mm: distance from the
    law of the other values.
    """

    size: float
    off_mm: float


def find_outliers(depths_mm: list[float], residual_mm, free: int, powers_from: int, scatter=1.0) -> dict[int, Outlier]:
    """Find values that do not belong to the others, by index.

    free: number of fitted coefficients; the lowest power is powers_from. scatter: standard deviation of each value,
    relative to the others. The test uses studentized residuals of least squares, each compared with the noise without
    that value. An outlier is as unlikely as a normal value beyond MIN_OUTLIER_SIGMAS.
    """
    unit = np.broadcast_to(scatter, len(residual_mm))
    scaled_residuals, depths = np.array(residual_mm) / unit, np.array(depths_mm)
    spare = len(scaled_residuals) - free - 1
    if spare < 1:
        return {}
    columns = np.vander(depths / depths.max(), powers_from + free, increasing=True)[:, powers_from:]
    columns = columns / unit[:, None]
    free_share = 1.0 - np.sum(np.linalg.qr(columns)[0] ** 2, axis=1)
    free_share = np.maximum(free_share, 1e-9)
    other_variance = np.maximum((scaled_residuals @ scaled_residuals - scaled_residuals**2 / free_share) / spare, 1e-18)
    size = _core.normal_equivalent(scaled_residuals / np.sqrt(free_share * other_variance), spare)
    return {
        int(k): Outlier(float(size[k]), float(unit[k] * scaled_residuals[k] / free_share[k]))
        for k in np.flatnonzero(size > MIN_OUTLIER_SIGMAS)
    }


def find_outliers_of_kinds(
    residual_mm: np.ndarray, spare: np.ndarray, scatter_mm: np.ndarray, freedom: np.ndarray
) -> dict[int, Outlier]:
    """Find outliers among several kinds of values in one fit.

    Each value is compared with the scatter of its kind.

    All arrays are (n,). spare: 1 minus the leverage of the value. scatter_mm: scatter of its kind, with the value
    included. freedom: degrees of freedom of that scatter.
    """
    free_share = np.maximum(spare, 1e-9)
    # In least squares its square is at most the degrees of freedom.
    internal_residuals = residual_mm / (scatter_mm * np.sqrt(free_share))
    outliers = {}
    for k, (t, degrees) in enumerate(zip(internal_residuals, freedom, strict=True)):
        if degrees < 3.0:
            continue
        external_residual = abs(t) * math.sqrt((degrees - 1.0) / max(degrees - t**2, 1e-6))
        size = float(_core.normal_equivalent(external_residual, degrees - 1.0))
        if size > MIN_OUTLIER_SIGMAS:
            outliers[k] = Outlier(size, float(residual_mm[k] / free_share[k]))
    return outliers


def find_outliers_above_floor(depths_mm, values_mm, range_mm: tuple[float, float], degree: int) -> dict[int, Outlier]:
    """Find outliers of a law that is the greater of a polynomial and 0."""
    return {
        k: Outlier(size, off)
        for k, (size, off) in compare_with_other_points(depths_mm, values_mm, range_mm, degree).items()
        if size > MIN_OUTLIER_SIGMAS
    }


def compare_with_other_points(
    depths_mm, values_mm, range_mm: tuple[float, float], degree: int
) -> dict[int, tuple[float, float]]:
    """Compare each value with the law with floor 0 that is fitted to the other values.

    Return, by index, how unlikely the value is, as the size of an equally unlikely normal value, and its distance
    from the law [mm]. Values are omitted if the others do not determine a law.

    At the depth of the value y, the law of the others has the polynomial p with standard error s, and noise n. The
    more likely of two cases counts. If the polynomial is above the floor, t^2 = (y - p)^2 / (n^2 + s^2). If it is
    below the floor, t^2 = y^2 / n^2 + max(0, p)^2 / s^2.
    """
    depths, values = np.array(depths_mm, float), np.array(values_mm, float)
    shape = _core.LawShape(range_mm, degree, floor=0.0)
    comparisons = {}
    for k, (depth, value) in enumerate(zip(depths, values, strict=True)):
        if len(np.unique(np.delete(depths, k))) <= degree:
            continue
        others = _core.fit_law(np.delete(depths, k), np.delete(values, k), shape)
        if others.degrees_of_freedom < 1 or not others.covariance:
            continue
        powers = depth ** np.arange(degree + 1.0)
        polynomial = powers @ others.law.coefficients
        noise = max(others.law.rmse_mm, 1e-9) ** 2
        variance = max(powers @ np.array(others.covariance) @ powers, 1e-18)
        squared = value**2 / noise + max(0.0, polynomial) ** 2 / variance
        if polynomial + variance / (variance + noise) * (value - polynomial) >= 0.0:
            squared = min(squared, (value - polynomial) ** 2 / (noise + variance))
        size = float(_core.normal_equivalent(math.sqrt(squared), others.degrees_of_freedom))
        comparisons[k] = (size, value - others.law(depth))
    return comparisons


def refuse_extrapolation(law: str, deepest_mm: float, range_mm: tuple[float, float], where: str) -> None:
    """Raise Error if the brush may be pressed far deeper than the law was measured."""
    if range_mm[1] > MAX_DEPTH_PER_MEASURED * deepest_mm:
        raise Error(
            f"{law} was measured to a depth of {deepest_mm:g} mm, but the depth range goes to {range_mm[1]:g} mm: "
            f'measure it deeper, or give "depth_range_mm": [{range_mm[0]:g}, {deepest_mm:g}]',
            where,
            code="depth-not-measured",
        )


def refuse_no_lag(points) -> None:
    """Raise Error if all lags are 0: a pen needs no calibration."""
    if not any(point.value_mm for point in points):
        sentence = "the lag is 0 mm at every depth: make a pen with brushsvg brush new -o pen.json --lag 0"
        raise Error(sentence, points[0].where, code="pen-without-lag")


def refuse_halves_as_widths(rows: dict) -> None:
    """Raise Error for widths that were given as half widths.

    If the half widths are halved, a law through 0 then fits all rows much better. rows: kind -> list of
    measurements.Row.
    """
    halves, widths = rows.get("half_width", []), rows.get("width", [])
    if min(len(halves), len(widths)) < 2 or len(halves) + len(widths) < 5:
        return
    depths = np.array([row.depth_mm for row in [*halves, *widths]])
    columns = np.column_stack([depths, depths**2])

    def relative_misfit(times: float) -> float:
        """Return the relative misfit with the half widths multiplied by `times`."""
        values = [times * row.numbers["value_mm"] for row in halves]
        values = np.array([*values, *(row.numbers["value_mm"] / 2 for row in widths)])
        found, *_ = np.linalg.lstsq(columns, values, rcond=None)
        return float(np.linalg.norm(columns @ found - values) / max(np.linalg.norm(values), 1e-12))

    if relative_misfit(1.0) > max(MIN_CONTRADICTION, MIN_MISTAKE_RATIO * relative_misfit(0.5)):
        raise Error(
            "these half widths contradict the widths, they are about twice too large: half_width is measured from the "
            "middle to one edge, width from edge to edge",
            halves[0].where,
            code="half-width-doubled",
        )


def refuse_falling(law: str, depths_mm: list[float], values_mm: list[float], where: str) -> None:
    """Raise Error if a law falls with depth.

    A brush that is pressed deeper paints wider and trails more. The values are of two depths or more.
    """
    depths, values = np.array(depths_mm), np.array(values_mm)
    slope, middle = np.polyfit(depths - depths.mean(), values, 1)
    residuals = values - middle - slope * (depths - depths.mean())
    freedom = max(len(values) - 2, 1)
    error = math.sqrt(residuals @ residuals / freedom / ((depths - depths.mean()) @ (depths - depths.mean())))
    drop = -slope * (depths.max() - depths.min())
    if slope < -3 * error and drop > 0.3 * abs(middle):
        raise Error(
            f"the {law} falls by {drop:.3g} mm from depth {depths.min():g} to {depths.max():g} mm, but a brush that is "
            "pressed deeper paints wider and trails more: check the order of the values, and that depths are measured "
            "down from first contact",
            where,
            code="law-falls",
        )


def refuse_unexplained(law: str, points, fit) -> None:
    """Raise Error for values that do not rise with depth.

    A law that rises from 0 then misses them by as much as they differ from each other.
    """
    values = np.array([point.value_mm for point in points])
    if np.ptp(values) <= 0.05 * abs(values.mean()):
        raise Error(
            f"the {law} is {values.mean():.3g} mm at every depth: make a pen with brushsvg brush new, and add --lag 0 "
            "if it does not trail",
            points[0].where,
            code="pen-without-lag",
        )
    if len(values) > 3 and fit.r_squared < 0.5:
        raise Error(
            f"the {law} hardly depends on the depth (R^2 {fit.r_squared:.2f}): check the order of the rows, and that "
            "all are from one brush",
            points[0].where,
            code="law-scatters",
        )


def refuse_width(depth_mm: float, width_mm: float) -> None:
    """Raise Error if the width of the deepest mark is impossible for its depth."""
    if not HALF_WIDTH_PER_DEPTH[0] <= width_mm / 2 / depth_mm <= HALF_WIDTH_PER_DEPTH[1]:
        raise Error(
            f"the width is {width_mm:.3g} mm at depth {depth_mm:g} mm, which no brush has: write depths and widths in "
            "millimetres",
            "half_width",
            width_mm / 2,
            code="not-millimetres",
        )


def refuse_inconsistent_laws(brush) -> None:
    """Raise Error for laws that contradict each other.

    Most of them come from mixed units.
    """
    depth = brush.depth_range_mm[1]
    lag, gap, widest, half = (law(depth) for law in (brush.lag, brush.tip_gap, brush.tip_to_widest, brush.half_width))
    refuse_width(depth, 2 * half)
    if not LAG_PER_HALF_WIDTH[0] <= lag / half <= LAG_PER_HALF_WIDTH[1]:
        sentence = (
            f"the lag is {lag:.3g} mm and the width {2 * half:.3g} mm at depth {depth:g} mm, which no brush has: write "
            "all lengths in millimetres. For a pen that does not trail, use brushsvg brush new --lag 0"
        )
        raise Error(sentence, "lag", lag, code="not-millimetres")
    if not brush.tip_to_widest.assumed and widest > lag + gap:
        sentence = (
            f"the widest section is {widest:.3g} mm from the tip at depth {depth:g} mm, but the tool is only "
            f"{lag + gap:.3g} mm from the tip: measure both from the tip of the footprint, in millimetres"
        )
        raise Error(sentence, "tip_to_widest", widest, code="not-millimetres")
    length = float(np.max(brush.footprints.dragged[-1].outline_mm[:, 0]))
    if not brush.tip_gap.assumed and gap > 1.5 * length:
        sentence = (
            f"the tip gap is {gap:.3g} mm at depth {depth:g} mm, but the footprint is only {length:.3g} mm long: the "
            "centre of friction must be inside the footprint. Measure the gap from the tip, in millimetres"
        )
        raise Error(sentence, "tip_gap", gap, code="not-millimetres")


def refuse_undetermined_law(brush, fitted) -> None:
    """Raise Error if the 95 % interval of a law includes 0 at many depths.

    fitted: a from_measurements.Fitted.
    """
    if not len(brush.covariance):
        return
    depths = np.linspace(*brush.depth_range_mm, 41)[1:]
    half, _ = law_band(brush, fitted.name, depths)
    values = getattr(brush, fitted.name)(depths)
    if np.mean(half > values) <= MAX_UNDETERMINED_SHARE:
        return
    worst = int(np.argmax(half / np.maximum(values, 1e-9)))
    advice = next(iter(fitted.list_outliers()), "measure it at more depths, from the shallowest to the deepest")
    raise Error(
        f"these values do not determine the {fitted.name} ({values[worst]:.1f} +- {half[worst]:.1f} mm (95 %) at "
        f"depth {depths[worst]:.3g} mm): {advice}",
        fitted.name,
        code="law-undetermined",
    )


def find_odd_values(brush, laws) -> list[Notice]:
    """Return notices about values that are possible but rare.

    laws: from_measurements.Fitted of each law.
    """
    depth = brush.depth_range_mm[1]
    lag, half = brush.lag(depth), brush.half_width(depth)
    notices = []
    if depth < MIN_USUAL_DEPTH_MM:
        notices.append(
            Notice(
                "depth_mm",
                f"the greatest depth is only {depth:.3g} mm: check that depths and values are in millimetres",
                code="not-millimetres",
            )
        )
    elif not USUAL_HALF_WIDTH_PER_DEPTH[0] <= half / depth <= USUAL_HALF_WIDTH_PER_DEPTH[1]:
        what = "widths" if half < depth else "depths"
        notices.append(
            Notice(
                "half_width",
                f"the width of {2 * half:.3g} mm at depth {depth:g} mm is unusual: check that {what} are in "
                "millimetres, not inches",
                code="not-millimetres",
            )
        )
    if not USUAL_LAG_PER_HALF_WIDTH[0] <= lag / half <= USUAL_LAG_PER_HALF_WIDTH[1]:
        notices.append(
            Notice(
                "lag",
                f"the lag is {lag / half:.2g} half widths at depth {depth:g} mm, which is unusual: check that both are "
                "in millimetres, not inches",
                code="not-millimetres",
            )
        )
    fitted = next(law for law in laws if law.name == "lag")
    return notices + _find_odd_lags(fitted) if fitted.fit is not None else notices


def _find_odd_lags(fitted) -> list[Notice]:
    """Return notices about measured lags that scatter or fall with depth."""
    notices = []
    mean, rmse = np.mean([point.value_mm for point in fitted.points]), fitted.fit.law.rmse_mm
    if len(fitted.points) >= 4 and not fitted.outliers and rmse is not None and rmse > 0.25 * mean:
        sentence = f"the lag scatters by {rmse:.2g} mm about a mean of {mean:.2g} mm: check the order of the rows"
        notices.append(Notice("lag", sentence, code="law-scatters"))
    # A median, so one bad reading hardly changes it.
    scatter_mm = 1.48 * float(np.median(np.abs(fitted.fit.residual_mm)))
    depths = sorted({point.depth_mm for point in fitted.points})
    read = [np.mean([point.value_mm for point in fitted.points if point.depth_mm == depth]) for depth in depths]
    for k in range(len(depths) - 1):
        # A law follows few values badly; then the scatter is that of the law.
        if read[k] - read[k + 1] > max(VISIBLE_MM, min(2 * scatter_mm, MAX_LAG_FALL * read[k])):
            sentence = (
                f"the lag falls from {read[k]:.3g} mm at depth {depths[k]:g} mm to {read[k + 1]:.3g} mm at "
                f"{depths[k + 1]:g} mm, but a brush that is pressed deeper trails more: measure both again"
            )
            notices.append(Notice("lag", sentence, code="law-falls"))
    return notices
