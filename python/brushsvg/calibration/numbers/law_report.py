"""What a calibration found: laws, their confidence, what to measure next; in words and as a picture."""

from __future__ import annotations

import numpy as np

from ...model.confidence import law_band
from ...model.describe import polynomial
from ...model.plot import brush_picture

TABLE_ROWS = 6
EXACT = 1e-9  # an interval below comes from rounding


def report(made) -> str:
    """The text that `brushsvg calibrate` prints. made: a calibrate.Calibration."""
    brush = made.brush
    lines = [f"brush {brush.name}, depth {brush.depth_range_mm[0]:g} to {brush.depth_range_mm[1]:g} mm"]
    for fitted in made.laws:
        lines += ["", *_law(brush, fitted)]
    lines += ["", *_table(brush)]
    remarks = [*made.remarks, *_next(made)]
    return "\n".join([*lines, *([""] if remarks else []), *remarks, ""])


def _law(brush, fitted) -> list[str]:
    law = getattr(brush, fitted.name)
    lines = [f"{fitted.name} = {polynomial(law.coefficients)}"]
    if fitted.fit is None:
        return [*lines, f"  assumed: {law.source}"]
    depths = [point.depth_mm for point in fitted.points]
    known = f"{len(depths)} values at depths {min(depths):g} to {max(depths):g} mm"
    if law.rmse_mm is None:
        known += ", no degree of freedom left: no confidence interval"
    else:
        known += f", R^2 {fitted.fit.r_squared:.3f}, RMSE {law.rmse_mm:.2f} mm"
    lines.append(f"  {known}")
    if law.half_interval_95:
        lines.append(
            "  95 % confidence intervals +- "
            + ", ".join(f"{half if half > EXACT else 0:.2g}" for half in law.half_interval_95)
            + " (ascending powers)"
        )
    lines += [f"  {remark}" for remark in fitted.remarks]
    return [*lines, *(f"  {line}" for line in fitted.list_outliers())]


def _table(brush) -> list[str]:
    names = ("lag", "tip_gap", "tip_to_widest", "half_width")
    depths = np.linspace(*brush.depth_range_mm, TABLE_ROWS)
    lines = ["  depth" + "".join(name.rjust(18) for name in names)]
    bands = {name: law_band(brush, name, depths) for name in names}
    for i, depth in enumerate(depths):
        cells = []
        for name in names:
            value = f"{getattr(brush, name)(depth):.2f}"
            band = bands[name]
            cells.append(value + (f" +- {band[0][i]:.2f}" if band else ""))
        lines.append(f"{depth:7.2f}" + "".join(cell.rjust(18) for cell in cells))
    notes = {band[1] for band in bands.values() if band}
    return [*lines, *(f"  +-: {what}" for what in sorted(notes))]


def _next(made) -> list[str]:
    """Where one more measurement says most: the law that is least known for its size, at its widest place."""
    brush = made.brush
    if assumed := [fitted.name for fitted in made.laws if fitted.fit is None]:
        return [f"next: measure {' and '.join(assumed)}, so far assumed"]
    depths = np.linspace(*brush.depth_range_mm, 101)[1:]
    worst = (0.0, "", 0.0, 0.0)
    for fitted in made.laws:
        band = law_band(brush, fitted.name, depths)
        if not band:
            return [f"next: measure {fitted.name} at more depths, or again at the same ones"]
        values = np.array([getattr(brush, fitted.name)(depth) for depth in depths])
        share = band[0] / max(values.max(), 1e-9)
        i = int(np.argmax(share))
        worst = max(worst, (float(share[i]), fitted.name, float(depths[i]), float(band[0][i])))
    _, name, depth, half = worst
    widest = f"where its confidence interval is widest, +- {half:.2f} mm"
    return [f"next: measure {name} near depth {depth:.1f} mm, {widest}"]


def report_picture(made, suffix: str) -> bytes:
    """The laws with bands, footprints and the data; .svg or .png, needs the extra plot."""
    data = {
        fitted.name: np.array([(p.depth_mm, p.value_mm) for p in fitted.points]).reshape(-1, 2)
        for fitted in made.laws
        if fitted.points
    }
    return brush_picture(made.brush, suffix, data)
