"""On the printed page of a job, nothing crosses anything else."""

import numpy as np
import pytest

from brushsvg import Pass, Plan
from brushsvg.calibration.chart.page import MAX_TEXT_MM
from brushsvg.comparison.job_page import job_page

LETTER_MM = 0.6 * MAX_TEXT_MM


def boxes_of(page):
    """Return (left, bottom, right, top) of each label and of each tick."""
    labels = [
        (x, y, x + min(LETTER_MM * len(label.text), label.width_mm), y + MAX_TEXT_MM)
        for label in page.printed.labels
        for x, y in [label.at_mm]
    ]
    ticks = [(*np.min(ring, axis=0), *np.max(ring, axis=0)) for ring in page.ticks]
    return labels, ticks


@pytest.mark.parametrize("sheet_mm", [(200, 105), (140, 100), (80, 60), (400, 300), (100, 200)])
def test_no_label_crosses_a_tick(sheet_mm):
    plan = Plan("round-6", passes=[Pass("s", [[20, 20, -2], [40, 30, -2]])], sheet_mm=sheet_mm)
    labels, ticks = boxes_of(job_page(plan, "Title"))
    assert labels and len(ticks) == 8
    for left, bottom, right, top in labels:
        for x0, y0, x1, y1 in ticks:
            assert x1 < left or right < x0 or y1 < bottom or top < y0
