"""Make dabs: press the brush down, bent in one direction, and lift it again.

A brush that is pressed straight down bends in an unknown direction. The tool therefore runs forward by nearly the lag
while it goes down, and back while it comes up. It is never further from the patch than the lag, so the patch rests
where it was set down. At the depth of the dab the bristles are nearly taut, as in a dragged brush.
"""

from __future__ import annotations

import math

import numpy as np

from ... import _core
from ...errors import Error
from ..dabs.dab_outlines import Dab
from ..marks.mark_input import DAB as KIND

# Effects of the sheet or the tool, which are equal for all headings, can be separated from the footprint.
HEADINGS_DEG = (0.0, 180.0, 90.0, 270.0)
MIN_DEPTH_SHARE = 0.2  # least depth as a share of the greatest; below it, outlines shrink in proportion to depth
MIN_HALF_WIDTH_MM = 0.5  # least half width of the shallowest dab; narrower dabs look like splashes
# Length of the run as a share of the lag. With a larger share, a brush that trails a little less than expected is
# dragged, and its dab gets longer.
RUN_PER_LAG = 0.95
RUN_STEPS = 8  # steps of a run that is not a straight line


def dab_depths(brush, count: int, deepest_mm: float) -> list[float]:
    """Return evenly spaced depths, from the shallowest dab that can be read.

    Raises Error for a brush whose dabs are all too small.
    """
    deepest = min(brush.depth_range_mm[1], deepest_mm)
    if not brush.half_width(deepest) > 1.2 * MIN_HALF_WIDTH_MM:
        sentence = (
            f"dabs of brush {brush.name} are only {2 * brush.half_width(deepest):.2g} mm wide at depth {deepest:g} mm; "
            f"outlines can be read of dabs wider than {2.4 * MIN_HALF_WIDTH_MM:g} mm"
        )
        raise Error(sentence, "brush", 2 * brush.half_width(deepest), code="out-of-range")
    least = max(brush.depth_range_mm[0], MIN_DEPTH_SHARE * deepest)
    if brush.half_width(least) < MIN_HALF_WIDTH_MM:
        least = brush.depth_for_half_width(MIN_HALF_WIDTH_MM)
    depths = np.linspace(least, deepest, count).round(2)
    return np.minimum(depths, deepest).tolist()


def dab_poses(brush, depth: float, heading_deg: float) -> np.ndarray:
    """Return the poses (n, 3) of a dab at the origin.

    The run follows the lag. On a straight line, the patch would be dragged if the lag is below the line.
    """
    depths = depth * np.arange(1, RUN_STEPS + 1) / RUN_STEPS
    lag = RUN_PER_LAG * np.array([brush.lag(one_depth) for one_depth in depths])
    run = np.minimum(lag, lag[-1] * depths / depth)
    if np.allclose(run, lag[-1] * depths / depth):
        depths, run = depths[-1:], run[-1:]
    down = np.vstack([[0.0, 0.0], np.column_stack([run, depths])])
    run, depths = np.vstack([down, down[-2::-1]]).T
    along = math.radians(heading_deg)
    return np.column_stack([run * math.cos(along), run * math.sin(along), -depths])


def read_dab_landing(poses_mm: np.ndarray) -> tuple[np.ndarray, float, float, float]:
    """Return the place, the heading [rad], the run [mm] and the depth [mm] of a dab.

    Raises Error for poses that are not a dab.
    """
    poses = np.asarray(poses_mm, float)
    away = poses[:, :2] - poses[0, :2]
    distances = np.hypot(*away.T)
    deepest = int(distances.argmax())
    if not distances[deepest] > 0 or distances[-1] > 1e-3 or poses[deepest, 2] > poses[:, 2].min() + 1e-6:
        sentence = "this stroke is not a dab: a dab moves in one direction while it goes down, and back while it lifts"
        raise Error(sentence, code="chart-strokes")
    return (
        poses[0, :2],
        math.atan2(away[deepest, 1], away[deepest, 0]),
        float(distances[deepest]),
        float(-poses[:, 2].min()),
    )


def is_of_dabs(chart) -> bool:
    return bool(chart.strokes) and all(stroke.kind == KIND for stroke in chart.strokes)


def dabs_of(read) -> list[Dab]:
    """Return the dabs of a photograph; dabs without paint have no rings. read: a photograph.Read."""
    dabs = []
    for dab_pass in read.chart.plan.passes:
        try:
            place, heading, run, depth = read_dab_landing(dab_pass.poses_mm)
        except Error as refusal:
            raise Error(refusal.sentence, dab_pass.stroke, code=refusal.code) from None
        rings = read.marks.outlines_mm.get(dab_pass.stroke, [])
        dabs.append(Dab(dab_pass.stroke, round(depth, 4), place, heading, run, tuple(rings)))
    return dabs


def dab_chart_report(chart, brush: _core.Brush) -> str:
    depths = sorted({stroke.depth_mm for stroke in chart.strokes})
    width, height = chart.plan.sheet_mm
    lines = [
        f"{len(chart.strokes)} dabs on {width:g} x {height:g} mm, {len(chart.strokes) // len(depths)} at each of the "
        f"depths {', '.join(f'{depth:g}' for depth in depths)} mm",
        f"This page is for brush {brush.name} with a lag of {brush.lag(depths[0]):.1f} to "
        f"{brush.lag(depths[-1]):.1f} mm. Calibrate the lag first, because dabs do not show it",
    ]
    return "\n".join([*lines, ""])
