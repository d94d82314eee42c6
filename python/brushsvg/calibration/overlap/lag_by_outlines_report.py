"""What painted marks told of the lag of a brush whose outlines are known, in words."""

from __future__ import annotations

import numpy as np

from ...model.confidence import law_band
from ...model.describe import polynomial
from ..marks.mark_report import TABLE_ROWS, overlaps


def report(found) -> str:
    """found: lag_by_outlines.LagByOutlines."""
    brush, own, count = found.brush, found.own, len(found.made.painted.marks)
    halves = ", ".join(f"{half:.2g}" for half in brush.lag.half_interval_95)
    lines = [
        f"brush {brush.name}, depth {brush.depth_range_mm[0]:g} to {brush.depth_range_mm[1]:g} mm: the lag of {count} "
        f"painted marks by the outlines of brush {own.name}; all else is that brush's",
        "",
        f"lag = {polynomial(brush.lag.coefficients)}",
        f"  95 % confidence intervals +- {halves} (ascending powers)",
        "",
        "  depth"
        + f"lag of {own.name}"[:19].rjust(20)
        + "by drops or eggs".rjust(20)
        + "by its outlines".rjust(20),
    ]
    depths = np.linspace(brush.depth_range_mm[0], found.made.painted.deepest_mm, TABLE_ROWS)
    cells = [_cells(each, depths) for each in (own, found.before.brush, brush)]
    lines += [f"{depth:7.2f}" + "".join(row) for depth, *row in zip(depths, *cells, strict=True)]
    lines += ["  +-: half the 95 % confidence interval of the law", ""]
    was, now = overlaps(found.before)[1], overlaps(found.made)[1]
    way = "higher" if found.height_mm >= 0 else "lower"
    lines += [
        f"the paper lies {abs(found.height_mm):.2f} mm {way} than the plan took it to be",
        f"residuals of the edges: standard deviation {found.noise_mm:.2f} mm",
        f"painted and predicted marks overlap by {now:.3f}, by the brush of drops or eggs {was:.3f} (mean of "
        "intersection over union, displacements taken away)",
    ]
    if now < was:
        lines.append(
            "note: these outlines predict the marks worse than drops or eggs: look at the dabs once more before use"
        )
    return "\n".join([*lines, ""])


def _cells(brush, depths: np.ndarray) -> list[str]:
    band = law_band(brush, "lag", depths)
    return [
        (f"{brush.lag(depth):.2f}" + (f" +- {band[0][k]:.2f}" if band else "")).rjust(20)
        for k, depth in enumerate(depths)
    ]
