"""Describe how well a chart will calibrate a brush, before anyone paints it."""

from __future__ import annotations

import numpy as np

from ... import _core
from ...errors import Error
from ...model.confidence import law_band
from ...model.describe import LAWS
from ..marks.from_marks import expected_brush, expected_machine, expected_marks
from ..marks.machine_found import PARTS
from ..marks.paint_found import expected_paint

TABLE_ROWS = 4  # depths in the table of laws


def chart_report(chart, brush, noise_mm: float) -> str:
    """Describe the strokes of a chart and the expected 95 % intervals.

    noise_mm: standard deviation of the edges of the marks.
    """
    depths = sorted({stroke.depth_mm for stroke in chart.strokes if stroke.kind == "angular"})
    width, height = chart.plan.sheet_mm
    lines = [
        f"{len(chart.strokes)} strokes on {width:g} x {height:g} mm, depths "
        + ", ".join(f"{depth:g}" for depth in depths)
        + " mm"
    ]
    if not hasattr(_core, "fit_marks"):
        return "\n".join([*lines, "no confidence intervals, because this brushsvg was built without fits", ""])
    painted = expected_marks(chart.plan, brush)
    expected, remarks = expected_brush(chart.plan, brush, noise_mm, painted=painted)
    at = np.linspace(depths[0], depths[-1], TABLE_ROWS)
    bands = {name: law_band(expected, name, at)[0] for name, _ in LAWS}
    lines += [
        "",
        f"Expected calibration of a brush like {brush.name}, if edges are read to {noise_mm:g} mm:",
        "  depth" + "".join(name.rjust(18) for name, _ in LAWS),
    ]
    for i, depth in enumerate(at):
        cells = [f"{getattr(expected, name)(depth):.2f} +- {bands[name][i]:.2f}" for name, _ in LAWS]
        lines.append(f"{depth:7.2f}" + "".join(cell.rjust(18) for cell in cells))
    lines += ["  +-: half the 95 % confidence interval of the law", *remarks]
    machine = expected_machine(chart.plan, brush, noise_mm, painted=painted)
    listed = [f"{number.name} +- {number.half:.2g}" for number in machine]
    lines += ["Errors of the machine, with calibrate --machine " + ",".join(PARTS) + ":", "  " + ", ".join(listed)]
    return "\n".join([*lines, *_describe_paint(chart, brush, noise_mm, painted), ""])


def _describe_paint(chart, brush, noise_mm: float, painted: list) -> list[str]:
    try:
        paint = expected_paint(chart.plan, brush, noise_mm, painted)
    except Error as error:  # the marks of the brush are as long as its strokes
        return [f"This chart cannot show whether marks narrow as paint runs out: {error}"]
    alike = f"depth explains {100 * paint.explained_by_depth:.0f} % of how far each stroke is from the dip"
    if paint.is_refused:
        return [
            "This chart cannot show whether marks narrow as paint runs out. Its strokes go from shallow to deep, so "
            f"less paint looks like less depth ({alike}). chart --paint paints them in another order"
        ]
    return [
        "Narrowing of marks as paint runs out, with calibrate --paint, if the chart is painted with one load:",
        f"  narrowing per metre +- {paint.half_per_m:.2g}; {alike}; one load must last for {paint.way_mm:.0f} mm",
    ]
