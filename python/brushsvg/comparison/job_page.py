"""The page that a job is painted on.

It has markers in a frame around the sheet, and ticks at the sheet's corners for the robot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..calibration.chart.layout import (
    EDGE_MM,
    GROUP_COUNT,
    MARKER_SIDE_RANGE_MM,
    MARKERS_PER_CHART,
    MIN_SIDES_FOR_MIDDLE_MARKER,
    QUIET_ZONE_SHARE,
    Bar,
    Chart,
    Label,
    Marker,
    chart_id,
)

TICK_MM = 4.0
TICK_WIDTH_MM = 0.3
LABEL_GAP_MM = 1.5
MIN_LABEL_MM = 25.0


@dataclass(frozen=True)
class JobPage:
    """The page of a job.

    printed: the page, in its own frame; frame_mm: distance of its lower left corner from that of the sheet, to the left
    and downward; ticks: rings (4, 2) [mm] in the page's frame.
    """

    printed: Chart
    frame_mm: float
    ticks: tuple[np.ndarray, ...]

    @property
    def size_mm(self) -> tuple[float, float]:
        return self.printed.plan.sheet_mm


def job_page(plan, title: str = "") -> JobPage:
    """Compose the page of a job.

    The markers, from the chart's dictionary, identify the plan, so that the page of another job is not mistaken for
    this one. Raises Error for a tilted brush: what is learnt from photographs of a job holds only for an upright brush.
    """
    _core.refuse_tilted(plan.passes, "the comparison with photographs needs an upright brush")
    sheet = plan.sheet_mm
    side = min(max(min(sheet) / 14, MARKER_SIDE_RANGE_MM[0]), MARKER_SIDE_RANGE_MM[1])
    frame = math.ceil(EDGE_MM + (1 + 2 * QUIET_ZONE_SHARE) * side)
    page = (sheet[0] + 2 * frame, sheet[1] + 2 * frame)
    passes = sorted(plan.passes, key=lambda each: each.stroke)  # the order of painting does not matter
    mark = chart_id(_core.Plan(plan.brush, plan.brush_sha256, plan.sheet_mm, passes))
    base = MARKERS_PER_CHART * (int(mark, 16) % GROUP_COUNT)
    markers = tuple(
        Marker(base + k, ((x, y), (x + side, y), (x + side, y - side), (x, y - side)))
        for k, (x, y) in _marker_places(page, side)
    )
    bar = _place_bar(page, side)
    y = bar.at_mm[1]
    x = frame + LABEL_GAP_MM  # the lower left tick ends above the bar
    room_mm = bar.at_mm[0] + bar.length_mm - x
    labels = (
        Label(f"brushsvg job {mark}", (x, y - 5.0), room_mm),
        Label(f"bar: {bar.length_mm:g} mm, print at 100 %", (x, y + 2.0), room_mm),
        Label(title or "untitled", (page[0] / 2 + side, y), page[0] / 2 - 3 * side),
    )
    labels = tuple(label for label in labels if label.width_mm >= MIN_LABEL_MM)  # smaller labels are unreadable
    empty = _core.Plan(brush=plan.brush, brush_sha256=plan.brush_sha256, sheet_mm=page)
    ticks = tuple(box_ring(*corners) for corners in _tick_boxes(sheet, frame))
    return JobPage(Chart(empty, (), markers, labels, mark, bar), float(frame), ticks)


def _marker_places(page, side: float) -> list[tuple[int, tuple[float, float]]]:
    """Return markers and upper left corners [mm]: at the corners, clockwise, and amid the long edges."""
    left, right, top, bottom = EDGE_MM, page[0] - EDGE_MM - side, page[1] - EDGE_MM, EDGE_MM + side
    across, up = (page[0] - side) / 2, (page[1] + side) / 2
    places = [(0, (left, top)), (1, (right, top)), (2, (right, bottom)), (3, (left, bottom))]
    if page[0] >= MIN_SIDES_FOR_MIDDLE_MARKER * side:
        places += [(4, (across, top)), (6, (across, bottom))]
    if page[1] >= MIN_SIDES_FOR_MIDDLE_MARKER * side:
        places += [(5, (right, up)), (7, (left, up))]
    return sorted(places)


def _place_bar(page, side: float) -> Bar:
    """Place the bar in the lower part of the frame, between two markers."""
    room = page[0] / 2 - EDGE_MM - (1.5 + 2 * QUIET_ZONE_SHARE) * side
    length = 10.0 * math.floor(room / 10) if room >= 10 else math.floor(room)
    return Bar((EDGE_MM + (1 + QUIET_ZONE_SHARE) * side, EDGE_MM + side / 2), float(max(length, 5)))


def _tick_boxes(sheet, frame: float):
    """Yield boxes of lines that end at the sheet's corners; the lower left two meet at the origin."""
    half = TICK_WIDTH_MM / 2
    for x, out_x in ((frame, -1), (frame + sheet[0], 1)):
        for y, out_y in ((frame, -1), (frame + sheet[1], 1)):
            yield min(x, x + out_x * TICK_MM), y - half, max(x, x + out_x * TICK_MM), y + half
            yield x - half, min(y, y + out_y * TICK_MM), x + half, max(y, y + out_y * TICK_MM)


def box_ring(left: float, bottom: float, right: float, top: float) -> np.ndarray:
    return np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
