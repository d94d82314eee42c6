"""Warn of depths at which the brush was not measured, and advise on widths."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from ...errors import Error
from ...read.design import Notice


def add_width_advice(painted, compensation, brush, compensated, line_elements: set[str]) -> list[Notice]:
    """Return the warnings of the compensation, with advice on widths.

    The warning on depths that were not measured names a stroke. It is dropped where only the ends of the stroke
    have such depths. Every brush is set down and lifted through smaller depths, and a user who draws a pointed end
    cannot avoid them. The warning that widths are ignored names no stroke.

    compensated: compensates strokes, to try the advised width; None if one width was requested.
    line_elements: names of the elements that are drawn lines. A filled shape has no single width, and the search adds
    strokes to shapes that have no outline of their own.
    """
    laws = (brush.lag, brush.tip_gap, brush.tip_to_widest, brush.half_width)
    ranges = [law.calibrated_mm for law in laws if law.calibrated_mm] if brush.width_follows_depth() else []
    deepest_mm = brush.depth_range_mm[1]
    measured = (max(low for low, _ in ranges), min(deepest_mm, *(high for _, high in ranges))) if ranges else None
    strokes_and_passes = zip(painted, compensation.plan.passes, strict=True)
    shallow_at_ends = {
        stroke.id
        for stroke, run in strokes_and_passes
        if measured and _is_shallow_only_at_ends(stroke, run, brush, *measured)
    }
    unmeasured = {each.where for each in compensation.warnings if each.code == "depth-not-measured"} - shallow_at_ends
    advice, advisable = "", []
    if compensated is not None and measured and measured[0] < measured[1]:
        advisable = [stroke for stroke in painted if stroke.id in unmeasured and stroke.origin.element in line_elements]
        advice = _make_width_advice(advisable[:1], brush, measured, compensated)
    advised = {stroke.id for stroke in advisable}
    return [
        replace(each, advice=advice if each.where in advised else "") if each.code == "depth-not-measured" else each
        for each in compensation.warnings
        if each.code != "depth-not-measured" or each.where not in shallow_at_ends
    ]


def _make_width_advice(lines: list, brush, measured: tuple[float, float], compensated) -> str:
    """Return advice on widths that keep a line in the measured depths, "" if their middle one does not."""
    halves = [brush.half_width(depth) for depth in measured]
    equal_width = [stroke.replaced(half_width=[(0.0, sum(halves) / 2)]) for stroke in lines]
    try:
        helps = bool(equal_width) and not any(
            each.code == "depth-not-measured" for each in compensated(equal_width).warnings
        )
    except Error:
        helps = False
    if not helps:
        return ""
    min_width_mm, max_width_mm = (2 * half for half in halves)
    return f"--width MM, from {min_width_mm:.2g} to {max_width_mm:.2g}, gives all lines one width in the measured range"


def _is_shallow_only_at_ends(stroke, run, brush, least_mm: float, greatest_mm: float) -> bool:
    """Return whether only the ends of a stroke are shallower than was measured.

    Each end may be as long as the stroke is wide. A dot is turned on the spot, and so is pressed less than a line
    of the same width.

    run: the pass of the stroke.
    """
    if -np.asarray(run.poses_mm)[:, 2].min() < least_mm:
        return False
    half_width = max(half_width for _, half_width in stroke.half_width)
    if stroke.closed or brush.depth_for_half_width(half_width, stroke.id) > greatest_mm:
        return False
    length_mm = _core.flatten(stroke, 0.1)[-1, 2]
    end_share = min(2 * half_width / max(length_mm, 1e-9), 0.5)
    inner_half_widths = np.interp(np.linspace(end_share, 1 - end_share, 101), *np.array(stroke.half_width).T)
    return bool((inner_half_widths >= brush.half_width(least_mm)).all())
