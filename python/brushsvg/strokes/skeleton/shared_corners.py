"""Outer corners of a shape in which two of its strokes end, as in B and D.

Such a corner, like the left ones of B and D, is nearest to one of the strokes, or half to each. Neither stroke
would then have a straight end in its target area, so the corner belongs to both.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from .cut_ends import find_straight_cuts

# How far the cut may be from the end of a line, in half widths, least and most. And the area of the corners that no
# disc reaches, in squared half widths: one corner of 90 degrees has 0.21.
CUT_DISTANCE_RANGE, MIN_BARE_CORNERS = (0.75, 1.35), 0.12


def with_shared_corners(strokes: list, area: list[np.ndarray]) -> list:
    """Return the strokes of a shape with the corners next to their ends added.

    strokes: of one shape; area: its rings. Each corner is added to the stroke's part of the shape.
    """
    ends = [(k, box) for k, stroke in enumerate(strokes) for box in _find_end_boxes(stroke, area)]
    if not ends:
        return strokes
    lines = [_core.target_outline(_as_plain_stroke(stroke), 0.01) for stroke in strokes]
    changed = list(strokes)
    for k, (box, half) in ends:
        corners = _core.intersect([box], area)
        covered = _core.unite([ring for line in lines for ring in _core.intersect(corners, line)])
        if _core.area(corners) - _core.area(covered) > MIN_BARE_CORNERS * half**2:
            changed[k] = replace(changed[k], target_mm=_core.unite([*changed[k].target_mm, *corners]))
    return changed


def _find_end_boxes(stroke, area) -> list[tuple[np.ndarray, float]]:
    """Return the areas between the ends of a stroke and the straight cuts ahead.

    Each is a box (4, 2), together with the half width at the end.
    """
    if stroke.closed:
        return []
    line = _core.flatten(_as_plain_stroke(stroke), 0.01)
    boxes = []
    for way, half in ((line[::-1], stroke.half_width[0][1]), (line, stroke.half_width[-1][1])):
        along = np.abs(way[:, 2] - way[-1, 2])
        if not 0 < half < along[0]:
            continue
        back = np.array([np.interp(half, along[::-1], column[::-1]) for column in way[:, :2].T])
        here = way[-1, :2]
        ahead = (here - back) / np.hypot(*(here - back))
        left = np.array([-ahead[1], ahead[0]])
        to_cut_mm, slope = find_straight_cuts(here, ahead, half, area)
        # nan where there is no cut.
        if not CUT_DISTANCE_RANGE[0] < to_cut_mm / (half * np.hypot(1, slope)) < CUT_DISTANCE_RANGE[1]:
            continue
        to_cut = [to_cut_mm + slope * side * half for side in (1, -1)]
        box = [here + half * left, here - half * left]
        box += [here + to_cut[1] * ahead - half * left, here + to_cut[0] * ahead + half * left]
        boxes.append((np.array(box), half))
    return boxes


def _as_plain_stroke(stroke):
    return _core.Stroke(middle_mm=stroke.middle_mm, half_width=stroke.half_width)
