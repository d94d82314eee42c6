"""Dabs: the brush is set down over a place, bent one way while it is pressed, and taken back the same way.

Pressed straight down, a brush bends nobody knows where to. So the tool runs forward by nearly the lag while it goes
down, and back while it comes up: it is never further from the patch than the lag is long, the patch rests where it was
set down, and at the depth of the dab the bristles are nearly taut, as while the brush is dragged.
"""

from __future__ import annotations

import math

import numpy as np

from ... import _core
from ...errors import Error
from ..dabs.dab_outlines import Dab
from ..marks.mark_input import DAB as KIND

HEADINGS_DEG = (
    0.0,
    180.0,
    90.0,
    270.0,
)  # effects of the sheet or of the tool on all of them can be separated from the footprint
SHALLOWEST = 0.2  # of the greatest depth: below, outlines shrink in proportion to depth
LEAST_HALF_MM = 0.5  # of the shallowest: narrower dabs are taken for splashes
# of the lag: more, and a brush that trails a little less than thought is dragged, its dab longer
NEARLY = 0.95
STEPS = 8  # of a way that is not straight


def dab_depths(brush, count: int, deepest_mm: float) -> list[float]:
    """Even, from the shallowest dab that can be read. Error for a brush whose dabs are all too small."""
    deepest = min(brush.depth_range_mm[1], deepest_mm)
    if not brush.half_width(deepest) > 1.2 * LEAST_HALF_MM:
        raise Error(
            f"dabs of brush {brush.name} are {2 * brush.half_width(deepest):.2g} mm wide at depth {deepest:g} mm, "
            f"outlines can be read of those wider than {2.4 * LEAST_HALF_MM:g} mm",
            "brush",
            2 * brush.half_width(deepest),
            code="out-of-range",
        )
    least = max(brush.depth_range_mm[0], SHALLOWEST * deepest)
    if brush.half_width(least) < LEAST_HALF_MM:
        least = brush.depth_for_half_width(LEAST_HALF_MM)
    depths = np.linspace(least, deepest, count).round(2)
    return np.minimum(depths, deepest).tolist()


def dab_poses(brush, depth: float, heading_deg: float) -> np.ndarray:
    """Poses (n, 3) of a dab at the origin; on a straight way a patch whose lag bends the other way would be dragged."""
    depths = depth * np.arange(1, STEPS + 1) / STEPS
    lag = NEARLY * np.array([brush.lag(each) for each in depths])
    run = np.minimum(lag, lag[-1] * depths / depth)
    if np.allclose(run, lag[-1] * depths / depth):
        depths, run = depths[-1:], run[-1:]
    down = np.vstack([[0.0, 0.0], np.column_stack([run, depths])])
    run, depths = np.vstack([down, down[-2::-1]]).T
    along = math.radians(heading_deg)
    return np.column_stack([run * math.cos(along), run * math.sin(along), -depths])


def landing(poses_mm: np.ndarray) -> tuple[np.ndarray, float, float, float]:
    """Of a dab's poses: the place where it is set down, its heading [rad], how far it runs, and how deep it is pressed
    [mm]. Error where it is no dab."""
    poses = np.asarray(poses_mm, float)
    away = poses[:, :2] - poses[0, :2]
    far = np.hypot(*away.T)
    deepest = int(far.argmax())
    if not far[deepest] > 0 or far[-1] > 1e-3 or poses[deepest, 2] > poses[:, 2].min() + 1e-6:
        raise Error("this is no dab: it must go one way while it is pressed, and back", code="chart-strokes")
    return (
        poses[0, :2],
        math.atan2(away[deepest, 1], away[deepest, 0]),
        float(far[deepest]),
        float(-poses[:, 2].min()),
    )


def is_of_dabs(chart) -> bool:
    return bool(chart.strokes) and all(stroke.kind == KIND for stroke in chart.strokes)


def dabs_of(read) -> list[Dab]:
    """read: photograph.Read. Those without paint have no rings."""
    out = []
    for one in read.chart.plan.passes:
        try:
            place, heading, run, depth = landing(one.poses_mm)
        except Error as refusal:
            raise Error(refusal.sentence, one.stroke, code=refusal.code) from None
        rings = read.marks.outlines_mm.get(one.stroke, [])
        out.append(Dab(one.stroke, round(depth, 4), place, heading, run, tuple(rings)))
    return out


def dab_chart_report(chart, brush: _core.Brush) -> str:
    depths = sorted({stroke.depth_mm for stroke in chart.strokes})
    width, height = chart.plan.sheet_mm
    lines = [
        f"{len(chart.strokes)} dabs on {width:g} x {height:g} mm, {len(chart.strokes) // len(depths)} at each of the "
        f"depths {', '.join(f'{depth:g}' for depth in depths)} mm",
        f"Landed for brush {brush.name}, which lags {brush.lag(depths[0]):.1f} to {brush.lag(depths[-1]):.1f} mm: "
        "calibrate its lag first, dabs do not show it",
    ]
    return "\n".join([*lines, ""])
