"""A photograph of a chart that an unknown brush painted, by the slow simulator of tests/laws."""

from __future__ import annotations

import numpy as np
import painter
import photograph

from brushsvg.calibration.chart.file import read_chart

TRUTH = painter.TrueBrush(
    10.0, np.array([2.6, 1.3, 0.1, -0.009]), np.array([0.0, 0.45]), np.array([0.0, 0.5, -0.005]), 1.6, 0.9
)
FAULTS = painter.Faults(noise=0.05, noise_length=0.5, displacement=0.2, placement=0.8, turn=0.008, height=0.1)
CAMERA = photograph.Camera(size_px=(1800, 2500), tilt_deg=(5.0, -4.0), turn_deg=3.0, fill=0.9, shadow=0.3)


def photo_of(chart_json: bytes) -> bytes:
    """A JPEG of the chart, painted by TRUTH."""
    made = read_chart(chart_json)
    ways = [(one.stroke, np.array(one.poses_mm)) for one in made.plan.passes]
    sheet = photograph.page(made)
    for _, _, rings in painter.paint(np.random.default_rng(11), TRUTH, ways, FAULTS).marks:
        sheet.paint(rings, photograph.BLUE)
    return photograph.photograph(sheet, CAMERA)
