"""Outer corners of a shape in which two of its strokes end, as the left ones of B and D: the corner is nearest to one
of them, or half to each, so that neither has a straight end in what it shall paint. It belongs to both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from .cut_ends import straight_cuts

# In half widths: how far from its end a line's cut may be, and the area of the corners that no disc reaches, in
# their squares; one corner of 90 degrees has 0.21.
NEAR, BARE = (0.75, 1.35), 0.12


def with_shared_corners(strokes: list, area: list[np.ndarray]) -> list:
    """Return the strokes of a shape, given by its rings, each with the corners next to its ends in its part of the
    shape."""
    ends = [(k, box) for k, stroke in enumerate(strokes) for box in _boxes(stroke, area)]
    if not ends:
        return strokes
    lines = [_core.wanted_outline(_drawn(stroke), 0.01) for stroke in strokes]
    out = list(strokes)
    for k, (box, half) in ends:
        corners = _core.intersect([box], area)
        covered = _core.unite([ring for line in lines for ring in _core.intersect(corners, line)])
        if _core.area(corners) - _core.area(covered) > BARE * half**2:
            out[k] = replace(out[k], wanted_mm=_core.unite([*out[k].wanted_mm, *corners]))
    return out


def _boxes(stroke, area) -> list[tuple[np.ndarray, float]]:
    """Return the area between each end of a stroke and the straight cut before it, (4, 2), with the half width
    there."""
    if stroke.closed:
        return []
    line = _core.flatten(_drawn(stroke), 0.01)
    boxes = []
    for way, half in ((line[::-1], stroke.half_width[0][1]), (line, stroke.half_width[-1][1])):
        along = np.abs(way[:, 2] - way[-1, 2])
        if not 0 < half < along[0]:
            continue
        back = np.array([np.interp(half, along[::-1], column[::-1]) for column in way[:, :2].T])
        here = way[-1, :2]
        ahead = (here - back) / np.hypot(*(here - back))
        left = np.array([-ahead[1], ahead[0]])
        to_cut_mm, slope = straight_cuts(here, ahead, half, area)
        if not NEAR[0] < to_cut_mm / (half * np.hypot(1, slope)) < NEAR[1]:  # nan: there is none
            continue
        to_cut = [to_cut_mm + slope * side * half for side in (1, -1)]
        box = [here + half * left, here - half * left]
        box += [here + to_cut[1] * ahead - half * left, here + to_cut[0] * ahead + half * left]
        boxes.append((np.array(box), half))
    return boxes


def _drawn(stroke):
    return _core.Stroke(middle_mm=stroke.middle_mm, half_width=stroke.half_width)
