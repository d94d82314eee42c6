"""Strokes pressed through depths that the brush was not measured at, and which widths would help."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from ...errors import Error
from ...read.design import Notice


def add_width_advice(painted, done, brush, compensated) -> list[Notice]:
    """What compensation warns of: of a stroke that its depths were not measured, of none that widths are ignored. Not
    where that is so at a stroke's ends alone: every brush is set down and lifted through less depth, and who draws a
    point can do nothing about it. compensated: tries what is advised, None where one width was requested."""
    laws = (brush.lag, brush.tip_gap, brush.tip_to_widest, brush.half_width)
    ranges = [law.calibrated_mm for law in laws if law.calibrated_mm] if brush.width_follows_depth() else []
    measured = (max(low for low, _ in ranges), min(high for _, high in ranges)) if ranges else None
    pairs = zip(painted, done.plan.passes, strict=True)
    thin = {
        stroke.id
        for stroke, run in pairs
        if measured and _is_shallow_only_at_ends(stroke, run, brush, *measured)
    }
    off = {each.where for each in done.warnings if each.code == "depth-not-measured"} - thin
    advice, lines = "", []
    if compensated is not None and measured and measured[0] < measured[1]:
        lines = [stroke for stroke in painted if stroke.id in off and not stroke.wanted_mm]
        advice = _make_width_advice(lines[:1], brush, measured, compensated)
    advised = {stroke.id for stroke in lines}
    return [
        replace(each, advice=advice if each.where in advised else "")
        if each.code == "depth-not-measured"
        else each
        for each in done.warnings
        if each.code != "depth-not-measured" or each.where not in thin
    ]


def _make_width_advice(lines: list, brush, measured: tuple[float, float], compensated) -> str:
    """Which widths keep a line within the depths that were measured; "" where the middle one of them does not."""
    halves = [brush.half_width(depth) for depth in measured]
    same = [stroke.replaced(half_width=[(0.0, sum(halves) / 2)]) for stroke in lines]
    try:
        helps = bool(same) and not any(
            each.code == "depth-not-measured" for each in compensated(same).warnings
        )
    except Error:
        helps = False
    if not helps:
        return ""
    least, greatest = (2 * half for half in halves)
    return f"--width MM, from {least:.2g} to {greatest:.2g}, gives all strokes one width that was measured"


def _is_shallow_only_at_ends(stroke, run, brush, least_mm: float, greatest_mm: float) -> bool:
    """Whether a stroke is pressed less than was measured at its ends alone, over no more than its width. run: its
    pass; a dot, which is turned round on the spot, is pressed less than a line as wide."""
    if -np.asarray(run.poses_mm)[:, 2].min() < least_mm:
        return False
    half = max(half for _, half in stroke.half_width)
    if stroke.closed or brush.depth_for_half_width(half, stroke.id) > greatest_mm:
        return False
    length_mm = _core.flatten(stroke, 0.1)[-1, 2]
    end = min(2 * half / max(length_mm, 1e-9), 0.5)
    inside = np.interp(np.linspace(end, 1 - end, 101), *np.array(stroke.half_width).T)
    return bool((inside >= brush.half_width(least_mm)).all())
