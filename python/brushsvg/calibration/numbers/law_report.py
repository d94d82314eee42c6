"""Report a calibration of measured numbers, in words and as a picture.

The report has a verdict, the laws and the next measurement.
"""

from __future__ import annotations

import numpy as np

from ..._core import remarks
from ...model.confidence import law_band
from ...model.plot import brush_picture
from ...reporting.report_text import Report, plural, verdict
from ..law_text import format_coefficients, laws_table, name_and_depths, summarize_laws


def report(calibration) -> Report:
    """Return the report that `brushsvg calibrate` prints.

    calibration: a from_measurements.Calibration.
    """
    brush = calibration.brush
    outlier_count = sum(len(fitted.list_outliers()) for fitted in calibration.laws)
    assumed = [fitted.name for fitted in calibration.laws if fitted.fit is None]
    without_interval = [
        fitted.name for fitted in calibration.laws if fitted.fit and getattr(brush, fitted.name).rmse_mm is None
    ]
    scattered = [
        f"the values of {name} contradict each other: they scatter by {getattr(brush, name).rmse_mm:.2f} mm (RMSE)"
        for name in _scattered_laws(brush)
    ]
    reservations = [
        f"{' and '.join(assumed)} {'is' if len(assumed) == 1 else 'are'} assumed, not measured" if assumed else "",
        f"{plural(outlier_count, 'value')} should be measured again" if outlier_count else "",
        f"{' and '.join(without_interval)} {'has' if len(without_interval) == 1 else 'have'} too few values for a "
        "confidence interval"
        if without_interval
        else "",
        *(notice.sentence for notice in calibration.doubts),
    ]
    lines = [
        f"{name_and_depths(brush)}: {summarize_laws(brush)}",
        *(_describe_fit(brush, fitted) for fitted in calibration.laws),
    ]
    for fitted in calibration.laws:
        lines += [f"{fitted.name}: {remark}" for remark in (*fitted.list_outliers(), *fitted.remarks)]
    details = [
        *laws_table(brush),
        *calibration.remarks,
        "",
        *format_coefficients(brush),
    ]
    return Report(verdict(scattered, reservations), (*lines, *_suggest_next(calibration)), tuple(details))


def _scattered_laws(brush) -> list[str]:
    """Name the laws with contradicting values; only lag and width matter, the others may scatter unseen."""
    scattered = {notice.where for notice in remarks(brush) if notice.code == "law-scatters"}
    return [name for name in ("lag", "half_width") if name in scattered]


def _describe_fit(brush, fitted) -> str:
    law = getattr(brush, fitted.name)
    if fitted.fit is None:
        return f"{fitted.name}: not measured. {law.source}"
    depths = [point.depth_mm for point in fitted.points]
    known = f"{fitted.name}: {len(depths)} values at depths {min(depths):g} to {max(depths):g} mm"
    if law.rmse_mm is None:
        return f"{known}, too few for a confidence interval"
    return f"{known}, R^2 {fitted.fit.r_squared:.3f}, RMSE {law.rmse_mm:.2f} mm"


def _suggest_next(calibration) -> list[str]:
    """Suggest to measure the law with the largest relative interval, at the depth where it is widest."""
    brush = calibration.brush
    if scattered := _scattered_laws(brush):
        return [f"next: measure {' and '.join(scattered)} again, because the values contradict each other"]
    if assumed := [fitted.name for fitted in calibration.laws if fitted.fit is None]:
        return [f"next: measure {' and '.join(assumed)}, which so far {'is' if len(assumed) == 1 else 'are'} assumed"]
    depths = np.linspace(*brush.depth_range_mm, 101)[1:]
    worst = (0.0, "", 0.0, 0.0)
    for fitted in calibration.laws:
        band = law_band(brush, fitted.name, depths)
        if not band:
            return [f"next: measure {fitted.name} at more depths, or once more at the measured depths"]
        values = np.array([getattr(brush, fitted.name)(depth) for depth in depths])
        share = band[0] / max(values.max(), 1e-9)
        i = int(np.argmax(share))
        worst = max(worst, (float(share[i]), fitted.name, float(depths[i]), float(band[0][i])))
    _, name, depth, half = worst
    widest = f"where its confidence interval is widest, +- {half:.2f} mm"
    return [f"next: measure {name} near depth {depth:.1f} mm, {widest}"]


def report_picture(calibration, suffix: str) -> bytes:
    """Draw the laws with bands, the footprints and the data. suffix: .svg or .png. Needs the extra plot."""
    data = {
        fitted.name: np.array([(p.depth_mm, p.value_mm) for p in fitted.points]).reshape(-1, 2)
        for fitted in calibration.laws
        if fitted.points
    }
    return brush_picture(calibration.brush, suffix, data)
