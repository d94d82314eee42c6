"""Measurements that no brush can have: other units, rows in a wrong order, values that say nothing. Each refusal says
what to do."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...errors import Error, Notice
from ...model.confidence import law_band

LEAST_ALPHA0_DEG = (
    5.0  # a series that starts nearer to the motion cannot be read; in radians 90 degrees are 1.57
)
UNTURNED_DEG = 5.0  # by so much may an angle grow through its noise
READ_TO_DEG = 6.0  # as the article read its own
NOT_FROM_START = 0.5  # in lags: a series may seem to begin by so much earlier or later
OPEN_PART = 0.25  # of the depths, at which a law may be nothing at all
OUTLYING = 4.0  # standard deviations of normal noise: one in ten thousand
SPREAD = 0.02  # of the greatest depth: depths that differ by less count as one
# Lag over half width: 3 to 10 with round-6, 40 with a liner of 20 mm; outside, units have been mixed up.
LAG_PER_HALF, ODD_LAG_PER_HALF = (0.02, 200.0), (0.3, 60.0)
APART = 0.15  # share of their size by which half widths and widths contradict each other
MISTAKEN = 3.0  # times closer they go together if one was taken for the other
# 0.42 with round-6, 0.2 with a liner; read in inches 25.4 times less, or of depths in inches as much more
HALF_PER_DEPTH, ODD_HALF_PER_DEPTH = (0.01, 20.0), (0.05, 5.0)
FALLEN = 0.1  # of a lag: read to half a millimetre one that rises falls by so much once in fifty times
SEEN_MM = 0.3  # where a mark begins is seen to some tenths: lags that differ by less may be one
BEYOND = 1.5  # of the deepest measurement: a law of fourth degree says nothing there
SMALL_MM = 1.0  # a brush that is not pressed deeper may have been measured in inches


def different(depths_mm: list[float]) -> int:
    """How many depths there are, taking those for one that hardly differ."""
    ordered = np.unique(depths_mm)
    count, at = 0, 0
    while at < len(ordered):
        count += 1
        at = int(np.searchsorted(ordered, ordered[at] + SPREAD * ordered[-1], "right"))
    return count


def refuse_series(where: str, alpha0_deg: float, s_mm, alpha_deg) -> None:
    """Angles at distances of a drag, as they were read."""
    if alpha0_deg < LEAST_ALPHA0_DEG:
        raise Error(
            f"the series starts {alpha0_deg:g} degrees from the motion, less than the {LEAST_ALPHA0_DEG:g} that can be "
            "read: turn by 90 degrees before the drag; are these radians?",
            where,
            alpha0_deg,
            code="angles-in-radians",
        )
    if alpha_deg and max(alpha_deg) < math.pi:
        raise Error(
            f"no angle after the first is greater than {max(alpha_deg):.3g} degrees, which nobody can read: are these "
            "radians?",
            where,
            max(alpha_deg),
            code="angles-in-radians",
        )
    if len(s_mm) == len(alpha_deg) and len(s_mm) > 1:
        first, last = int(np.argmin(s_mm)), int(np.argmax(s_mm))
        if alpha_deg[last] > alpha_deg[first] + UNTURNED_DEG:
            raise Error(
                f"the angle grows from {alpha_deg[first]:g} degrees after {s_mm[first]:g} mm to {alpha_deg[last]:g} "
                f"after {s_mm[last]:g} mm, but a dragged brush turns towards its motion: are the rows in the right "
                "order?",
                where,
                code="angles-grow",
            )


def refuse_other_start(where: str, alpha0_deg: float, s_mm, alpha_deg) -> None:
    """Angles that fall as a drag's do, but do not begin with the first one at 0 mm: ln tan(alpha/2), which falls by
    1 per lag, is fitted with a beginning of its own, each reading weighed by what it is sure of."""
    series = [(s, a) for s, a in zip(s_mm, alpha_deg, strict=True) if s > 0 and 0 < a < alpha0_deg]
    s, alpha = np.array(series).reshape(-1, 2).T * [[1.0], [math.pi / 180]]
    if len(np.unique(s)) < 2:
        return
    fallen = np.log(np.tan(alpha / 2) / math.tan(math.radians(alpha0_deg) / 2))
    columns = np.column_stack([np.ones_like(s), s]) * np.sin(alpha)[:, None]
    found, *_ = np.linalg.lstsq(columns, fallen * np.sin(alpha), rcond=None)
    left = columns @ found - fallen * np.sin(alpha)
    noise = max(math.sqrt(left @ left / max(len(s) - 2, 1)), math.radians(READ_TO_DEG))
    error = noise * math.sqrt(np.linalg.inv(columns.T @ columns)[0, 0])
    if abs(found[0]) > max(NOT_FROM_START, OUTLYING * error):
        raise Error(
            f"the angles fall as if the drag had begun {abs(found[0]):.2g} lags "
            f"{'before' if found[0] < 0 else 'after'} s_mm = 0, where it was {alpha0_deg:g} degrees: count s_mm from "
            "where that drag begins, and all angles in degrees",
            where,
            code="angles-from-elsewhere",
        )


@dataclass(frozen=True)
class Outlier:
    """size: the studentized residual, as the size of a normal value as unlikely; off_mm: from the law of the others."""

    size: float
    off_mm: float


def outliers(
    depths_mm: list[float], residual_mm, free: int, powers_from: int, scatter=1.0
) -> dict[int, Outlier]:
    """Values that do not belong to the others, by index.

    free: coefficients that were fitted, the least power powers_from; scatter: of each value, by that of the others. By
    studentized residuals of least squares, each against the noise without it, where as unlikely as a normal value
    beyond OUTLYING.
    """
    unit = np.broadcast_to(scatter, len(residual_mm))
    left, depths = np.array(residual_mm) / unit, np.array(depths_mm)
    spare = len(left) - free - 1
    if spare < 1:
        return {}
    columns = np.vander(depths / depths.max(), powers_from + free, increasing=True)[:, powers_from:]
    columns = columns / unit[:, None]
    apart = 1.0 - np.sum(np.linalg.qr(columns)[0] ** 2, axis=1)
    apart = np.maximum(apart, 1e-9)
    others = np.maximum((left @ left - left**2 / apart) / spare, 1e-18)
    size = _core.as_normal(left / np.sqrt(apart * others), spare)
    return {
        int(k): Outlier(float(size[k]), float(unit[k] * left[k] / apart[k]))
        for k in np.flatnonzero(size > OUTLYING)
    }


def outliers_of_kinds(
    residual_mm: np.ndarray, spare: np.ndarray, scatter_mm: np.ndarray, freedom: np.ndarray
) -> dict[int, Outlier]:
    """The same for values of several kinds in one fit: each against the scatter of its kind without it.

    All (n,): spare, the share of a value that the others do not fix; scatter_mm, of its kind with it, from so many
    values to spare.
    """
    apart = np.maximum(spare, 1e-9)
    inside = residual_mm / (
        scatter_mm * np.sqrt(apart)
    )  # its square is never more than freedom in least squares
    found = {}
    for k, (t, many) in enumerate(zip(inside, freedom, strict=True)):
        if many < 3.0:
            continue
        outside = abs(t) * math.sqrt((many - 1.0) / max(many - t**2, 1e-6))
        size = float(_core.as_normal(outside, many - 1.0))
        if size > OUTLYING:
            found[k] = Outlier(size, float(residual_mm[k] / apart[k]))
    return found


def outliers_above_floor(
    depths_mm, values_mm, range_mm: tuple[float, float], degree: int
) -> dict[int, Outlier]:
    """The same for a law that is a polynomial or 0, whichever is greater."""
    return {
        k: Outlier(size, off)
        for k, (size, off) in off_the_others(depths_mm, values_mm, range_mm, degree).items()
        if size > OUTLYING
    }


def off_the_others(
    depths_mm, values_mm, range_mm: tuple[float, float], degree: int
) -> dict[int, tuple[float, float]]:
    """Return how unlikely each value is given the law with floor 0 of the others, as the size of a normal value, and
    its distance from that law [mm].

    The law of the others has a polynomial p at this depth, known to s, and a noise n about it. The value y is as
    unlikely as the likeliest truth leaves it: the polynomial is above the floor, t^2 = (y - p)^2 / (n^2 + s^2),
    or not, t^2 = y^2 / n^2 + max(0, p)^2 / s^2. Values whose law the others leave open are left out.
    """
    depths, values = np.array(depths_mm, float), np.array(values_mm, float)
    shape = _core.LawShape(range_mm, degree, floor=0.0)
    found = {}
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
        size = float(_core.as_normal(math.sqrt(squared), others.degrees_of_freedom))
        found[k] = (size, value - others.law(depth))
    return found


def refuse_range(law: str, deepest_mm: float, range_mm: tuple[float, float], where: str) -> None:
    """A law is not followed far beyond what was measured."""
    if range_mm[1] > BEYOND * deepest_mm:
        raise Error(
            f"{law} was measured to a depth of {deepest_mm:g} mm, the brush is to be pressed {range_mm[1]:g} mm: "
            f'measure it deeper, or give "depth_range_mm": [{range_mm[0]:g}, {deepest_mm:g}]',
            where,
            code="depth-not-measured",
        )


def refuse_no_lag(points) -> None:
    """A pen is not calibrated."""
    if not any(point.value_mm for point in points):
        raise Error(
            "the lag is 0 mm at every depth: such a pen is made by brushsvg brush new -o with.json --lag 0",
            points[0].where,
            code="pen-without-lag",
        )


def refuse_halves_as_widths(rows: dict) -> None:
    """Widths that stand as half widths, or half widths as widths: with the half widths halved a law through 0 meets all
    rows far closer. rows: kind to measurements.Row."""
    halves, widths = rows.get("half_width", []), rows.get("width", [])
    if min(len(halves), len(widths)) < 2 or len(halves) + len(widths) < 5:
        return
    depths = np.array([row.depth_mm for row in [*halves, *widths]])
    columns = np.column_stack([depths, depths**2])

    def off(times: float) -> float:
        """As a share of the values."""
        values = [times * row.numbers["value_mm"] for row in halves]
        values = np.array([*values, *(row.numbers["value_mm"] / 2 for row in widths)])
        found, *_ = np.linalg.lstsq(columns, values, rcond=None)
        return float(np.linalg.norm(columns @ found - values) / max(np.linalg.norm(values), 1e-12))

    if off(1.0) > max(APART, MISTAKEN * off(0.5)):
        raise Error(
            "these rows are twice what those of width say: half_width counts from the middle to one edge, width from "
            "edge to edge",
            halves[0].where,
            code="half-width-doubled",
        )


def refuse_falling(law: str, points) -> None:
    """A brush that is pressed deeper paints no narrower and trails no less."""
    depths = np.array([point.depth_mm for point in points])
    values = np.array([point.value_mm for point in points])
    slope, middle = np.polyfit(depths - depths.mean(), values, 1)
    left = values - middle - slope * (depths - depths.mean())
    freedom = max(len(values) - 2, 1)
    error = math.sqrt(left @ left / freedom / ((depths - depths.mean()) @ (depths - depths.mean())))
    drop = -slope * (depths.max() - depths.min())
    if slope < -3 * error and drop > 0.3 * abs(middle):
        raise Error(
            f"the {law} falls by {drop:.3g} mm from depth {depths.min():g} to {depths.max():g} mm, but a brush that is "
            "pressed deeper paints wider and trails more: are the rows in the right order, and depths counted from "
            "first contact down?",
            points[0].where,
            code="law-falls",
        )


def refuse_unexplained(law: str, points, fit) -> None:
    """Widths that rise with depth in no way: through 0 and rising they are missed by what they differ among each
    other."""
    values = np.array([point.value_mm for point in points])
    if np.ptp(values) <= 0.05 * abs(values.mean()):
        raise Error(
            f"the {law} is {values.mean():.3g} mm at every depth: such a pen is made by brushsvg brush new, with "
            "--lag 0 if it does not trail",
            points[0].where,
            code="pen-without-lag",
        )
    if len(values) > 3 and fit.r_squared < 0.5:
        raise Error(
            f"the {law} hardly follows the depth, R^2 {fit.r_squared:.2f}: are the rows in the right order, and all of "
            "one brush?",
            points[0].where,
            code="law-scatters",
        )


def refuse_width(depth_mm: float, width_mm: float) -> None:
    """Of the deepest mark."""
    if not HALF_PER_DEPTH[0] <= width_mm / 2 / depth_mm <= HALF_PER_DEPTH[1]:
        raise Error(
            f"the width is {width_mm:.3g} mm at depth {depth_mm:g} mm: depths and widths both count in millimetres",
            "half_width",
            width_mm / 2,
            code="not-millimetres",
        )


def refuse_brush(brush) -> None:
    """Laws that do not go together: most of them are units mixed up."""
    depth = brush.depth_range_mm[1]
    lag, gap, widest, half = (
        law(depth) for law in (brush.lag, brush.tip_gap, brush.tip_to_widest, brush.half_width)
    )
    refuse_width(depth, 2 * half)
    if not LAG_PER_HALF[0] <= lag / half <= LAG_PER_HALF[1]:
        raise Error(
            f"the lag is {lag:.3g} mm and the width {2 * half:.3g} mm at depth {depth:g} mm: all lengths count in "
            "millimetres; for a pen that does not trail take brushsvg brush new --lag 0",
            "lag",
            lag,
            code="not-millimetres",
        )
    if not brush.tip_to_widest.assumed and widest > lag + gap:
        raise Error(
            f"the widest section is {widest:.3g} mm from the tip at depth {depth:g} mm, further than the tool, "
            f"{lag + gap:.3g} mm: measure it from the tip of the footprint, in millimetres",
            "tip_to_widest",
            widest,
            code="not-millimetres",
        )
    length = float(np.max(brush.footprints.dragged[-1].outline_mm[:, 0]))
    if not brush.tip_gap.assumed and gap > 1.5 * length:
        raise Error(
            f"the tip gap is {gap:.3g} mm at depth {depth:g} mm, the footprint {length:.3g} mm long: the centre of "
            "friction must be in it; measure the gap from the tip of the footprint, in millimetres",
            "tip_gap",
            gap,
            code="not-millimetres",
        )


def refuse_open(brush, fitted) -> None:
    """A law whose 95 % interval holds 0 over much of its depths; fitted: a calibrate.Fitted."""
    if not len(brush.covariance):
        return
    depths = np.linspace(*brush.depth_range_mm, 41)[1:]
    half, _ = law_band(brush, fitted.name, depths)
    values = getattr(brush, fitted.name)(depths)
    if np.mean(half > values) <= OPEN_PART:
        return
    worst = int(np.argmax(half / np.maximum(values, 1e-9)))
    todo = next(iter(fitted.list_outliers()), "measure it at more depths, from shallow to the deepest")
    raise Error(
        f"these values do not determine the {fitted.name}: {values[worst]:.1f} +- {half[worst]:.1f} mm (95 %) at "
        f"depth {depths[worst]:.3g} mm: {todo}",
        fitted.name,
        code="law-undetermined",
    )


def odd(brush, laws) -> list[Notice]:
    """On what may be, but seldom is. laws: calibrate.Fitted of each."""
    depth = brush.depth_range_mm[1]
    lag, half = brush.lag(depth), brush.half_width(depth)
    said = []
    if depth < SMALL_MM:
        said.append(
            Notice(
                "depth_mm",
                f"the brush is pressed {depth:.3g} mm at most: were depths and values read in millimetres?",
                code="not-millimetres",
            )
        )
    elif not ODD_HALF_PER_DEPTH[0] <= half / depth <= ODD_HALF_PER_DEPTH[1]:
        what = "widths" if half < depth else "depths"
        said.append(
            Notice(
                "half_width",
                f"the width is {2 * half:.3g} mm at depth {depth:g} mm, which is odd: were {what} read in inches? All "
                "lengths count in millimetres",
                code="not-millimetres",
            )
        )
    if not ODD_LAG_PER_HALF[0] <= lag / half <= ODD_LAG_PER_HALF[1]:
        said.append(
            Notice(
                "lag",
                f"the lag is {lag / half:.2g} half widths at depth {depth:g} mm, which is odd: was one of them read in "
                "inches? All lengths count in millimetres",
                code="not-millimetres",
            )
        )
    fitted = next(each for each in laws if each.name == "lag")
    return said + _odd_lags(fitted) if fitted.fit is not None else said


def _odd_lags(fitted) -> list[Notice]:
    """Of lags as they were read, which scatter or fall with depth."""
    said = []
    mean, rmse = np.mean([point.value_mm for point in fitted.points]), fitted.fit.law.rmse_mm
    if len(fitted.points) >= 4 and not fitted.outliers and rmse is not None and rmse > 0.25 * mean:
        sentence = f"the lag scatters by {rmse:.2g} mm round a mean of {mean:.2g} mm: are the rows in the right order?"
        said.append(Notice("lag", sentence, code="law-scatters"))
    scatter_mm = 1.48 * float(
        np.median(np.abs(fitted.fit.residual_mm))
    )  # of what one bad reading hardly moves
    depths = sorted({point.depth_mm for point in fitted.points})
    read = [
        np.mean([point.value_mm for point in fitted.points if point.depth_mm == depth]) for depth in depths
    ]
    for k in range(len(depths) - 1):
        # few values are followed badly: then the scatter is that of the law
        if read[k] - read[k + 1] > max(SEEN_MM, min(2 * scatter_mm, FALLEN * read[k])):
            sentence = (
                f"the lag was measured {read[k]:.3g} mm at depth {depths[k]:g} mm and {read[k + 1]:.3g} mm at "
                f"{depths[k + 1]:g} mm, but bristles that are pressed deeper trail farther: measure both again"
            )
            said.append(Notice("lag", sentence, code="law-falls"))
    return said
