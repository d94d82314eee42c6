"""What a calibration of measured numbers found: a verdict, its laws, what to measure next; and as a picture."""

from __future__ import annotations

import numpy as np

from ...model.confidence import law_band
from ...model.plot import brush_picture
from ...reporting.report_text import Report, plural, verdict
from ..law_text import coefficients, in_short, laws_table, name_and_depths


def report(made) -> Report:
    """What `brushsvg calibrate` prints. made: a from_measurements.Calibration."""
    brush = made.brush
    odd = sum(len(fitted.list_outliers()) for fitted in made.laws)
    assumed = [fitted.name for fitted in made.laws if fitted.fit is None]
    unsure = [
        fitted.name for fitted in made.laws if fitted.fit and getattr(brush, fitted.name).rmse_mm is None
    ]
    but = [
        f"{' and '.join(assumed)} {'is' if len(assumed) == 1 else 'are'} assumed, not measured"
        if assumed
        else "",
        f"{plural(odd, 'value')} should be measured again" if odd else "",
        f"{' and '.join(unsure)} has too few values for a confidence interval" if unsure else "",
        *(notice.sentence for notice in made.doubts),
    ]
    lines = [
        f"{name_and_depths(brush)}: {in_short(brush)}",
        *(_how_known(brush, fitted) for fitted in made.laws),
    ]
    for fitted in made.laws:
        lines += [f"{fitted.name}: {remark}" for remark in (*fitted.list_outliers(), *fitted.remarks)]
    details = [
        *laws_table(brush),
        *made.remarks,
        "",
        *coefficients(brush),
    ]
    return Report(verdict([], but), (*lines, *_next(made)), tuple(details))


def _how_known(brush, fitted) -> str:
    law = getattr(brush, fitted.name)
    if fitted.fit is None:
        return f"{fitted.name}: assumed: {law.source}"
    depths = [point.depth_mm for point in fitted.points]
    known = f"{fitted.name}: {len(depths)} values at depths {min(depths):g} to {max(depths):g} mm"
    if law.rmse_mm is None:
        return f"{known}, no degree of freedom left: no confidence interval"
    return f"{known}, R^2 {fitted.fit.r_squared:.3f}, RMSE {law.rmse_mm:.2f} mm"


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
