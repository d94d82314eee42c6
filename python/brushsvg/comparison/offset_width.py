"""Move the edges of a pass outward or inward, within the widths for which the brush was measured."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..errors import Error
from ..machine.realised.arc_chords import with_chords
from ..machine.realised.pass_on_path import move_pass_to_path

DEPTH_SAMPLES = 400  # number of depths at which the law of width is sampled to invert it


def offset_edges(a_pass, by_mm: float, brush):
    """Return the pass with its edges moved outward by by_mm.

    A negative by_mm moves them inward. The offset holds where the pass has its average width; elsewhere the width
    changes by the same share. The brush goes deeper, and the tool moves ahead by the additional lag, so that the brush
    drags along the same line. Raises Error where the brush cannot paint this width.
    """
    refuse_width(a_pass, by_mm, brush)
    a_pass = with_chords(a_pass)
    half_mm = _mean_half_width_mm(a_pass, brush)
    if half_mm <= 0:
        return a_pass  # it paints nothing, so it has no edges
    poses = np.array(a_pass.poses_mm, dtype=float)
    before = np.maximum(-poses[:, 2], 0.0)
    share = 1 + by_mm / half_mm
    _, deepest = measured_depths_mm(brush)
    depths = np.linspace(0.0, max(deepest, float(before.max())), DEPTH_SAMPLES)
    after = np.interp(share * brush.half_width(before), brush.half_width(depths), depths)
    after[before == 0] = 0.0
    heading = _headings_rad(a_pass, brush)
    ahead = brush.lag(after) - brush.lag(before)
    poses[:, :2] += ahead[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    poses[:, 2] = -after
    return move_pass_to_path(a_pass, poses, [])


def refuse_width(a_pass, by_mm: float, brush) -> None:
    """Raise Error where the brush cannot paint a stroke wider by by_mm per edge."""
    if not brush.width_follows_depth():
        sentence = f"the width is not corrected, because brush {brush.name} has one width at every depth"
        raise Error(sentence, a_pass.stroke, code="width-correction-refused")
    half_mm, (least, deepest) = _mean_half_width_mm(a_pass, brush), measured_depths_mm(brush)
    if half_mm <= 0:
        return
    low, high = 2 * float(brush.half_width(least)), 2 * float(brush.half_width(deepest))
    widest_mm = 2 * float(brush.half_width(-np.array(a_pass.poses_mm)[:, 2]).max())
    share = 1 + by_mm / half_mm
    target_mm = share * (widest_mm if by_mm > 0 else 2 * half_mm)
    if low <= target_mm <= high:
        return
    sentence = (
        f"the width is not corrected: a correction by {2 * by_mm:+.2f} mm needs a width of {target_mm:.2f} mm, outside "
        f"the range [{low:.2f}, {high:.2f}] mm in which brush {brush.name} was measured"
    )
    raise Error(sentence, a_pass.stroke, target_mm, (low, high), code="width-correction-refused")


def measured_depths_mm(brush) -> tuple[float, float]:
    """Return the depths [mm] in which the brush's lag and width were measured.

    The depths are a range (least, deepest). A law without a measured range does not limit the depths of the brush.
    """
    least, deepest = brush.depth_range_mm
    for law in (brush.lag, brush.half_width):
        if law.calibrated_mm:
            least, deepest = max(least, law.calibrated_mm[0]), min(deepest, law.calibrated_mm[1])
    return least, deepest


def _simulate_pass(a_pass, brush):
    return _core.simulate(_core.Plan("", "", (1.0, 1.0), [a_pass]), brush, for_outlines=False).passes[0]


def _mean_half_width_mm(a_pass, brush) -> float:
    """Return the half width of a pass [mm], averaged over its path on the paper."""
    trace = _simulate_pass(a_pass, brush)
    steps = np.hypot(*np.diff(np.asarray(trace.contact_mm), axis=0).T)
    halves = brush.half_width(np.asarray(trace.depth_mm))
    if not steps.sum():
        return float(np.max(halves))
    return float(np.average((halves[1:] + halves[:-1]) / 2, weights=steps))


def _headings_rad(a_pass, brush) -> np.ndarray:
    """Return (n,) the direction [rad] in which the brush points at each pose."""
    trace = _simulate_pass(a_pass, brush)
    heading = np.unwrap(np.asarray(trace.heading_rad))
    return np.interp(np.arange(len(a_pass.poses_mm)), np.asarray(trace.pose), heading)
