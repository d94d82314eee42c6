"""Find where along its way the paint of a stroke begins and ends, relative to the target."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from ..geometry.cubics import flattened
from .edge_offsets import area
from .photographs import EDGE_BLUR_MM, Comparison, TargetStroke

REACH_MM = 6.0  # beyond the end of a middle line, or within it
ALONG_MM = 0.05
WIDE_MM = 0.4  # a strip about the middle line: hairs that stand out next to it are no end
FLAT_MM = 0.02
DIRECTION_MM = 1.5  # of the middle line, that gives its direction at its end
LEVEL = 0.5


@dataclass(frozen=True)
class Ends:
    """By how many mm later on its way than the target the paint of a stroke begins and ends; below 0: earlier. None
    where it runs into other paint, or none is found. first_mm, last_mm: the ends (x, y) of its middle line."""

    began_mm: float | None
    ended_mm: float | None
    first_mm: tuple[float, float] = (0.0, 0.0)
    last_mm: tuple[float, float] = (0.0, 0.0)

    def near(self, place_mm: tuple[float, float]) -> dict[str, float]:
        """Those of "began" and "ended" that are known and within reach of a place."""
        ends = (("began", self.began_mm, self.first_mm), ("ended", self.ended_mm, self.last_mm))
        return {what: mm for what, mm, at in ends if mm is not None and math.dist(at, place_mm) <= REACH_MM}


UNSEEN = Ends(None, None)


def ends_of(found: Comparison, strokes: list[TargetStroke], drawn) -> dict[str, Ends]:
    """By stroke; of rings and dabs, which have no ends, nothing is said. drawn: strokes with their middle lines, none
    of a plan without its drawing. The sheet is at the place of its marks."""
    lines_mm = {
        each.id: flattened(each.middle_mm.reshape(-1, 4, 2), FLAT_MM) for each in drawn if not each.closed
    }
    shapes = {stroke.stroke: area(stroke.predicted) for stroke in strokes if stroke.predicted}
    seen = {row.stroke for row in found.strokes if row.placed.found}
    made = {}
    for stroke in strokes:
        name = stroke.stroke
        if name not in shapes or name not in lines_mm or not stroke.target:
            continue
        others = shapely.unary_union([shape for other, shape in shapes.items() if other != name])
        target = area(stroke.target)
        away = (_beyond(found, _ray(way), target, others) for way in (lines_mm[name][::-1], lines_mm[name]))
        before, behind = away if name in seen else (None, None)
        first, last = (tuple(lines_mm[name][k, :2].tolist()) for k in (0, -1))
        made[name] = Ends(None if before is None else -before, behind, first, last)
    return made


def _ray(way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A place well within a way (n, 2) at its end, and the direction in which it ends."""
    come = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
    back = np.array([np.interp(max(come[-1] - DIRECTION_MM, 0.0), come, way[:, k]) for k in (0, 1)])
    ahead = way[-1] - back
    return way[-1], ahead / max(float(np.hypot(*ahead)), 1e-9)


def _beyond(found: Comparison, ray: tuple[np.ndarray, np.ndarray], target, others) -> float | None:
    """How far along a ray the paint ends beyond the target's edge."""
    end, ahead = ray
    if not ahead.any():  # a dab has no way
        return None
    across = np.array([-ahead[1], ahead[0]])
    t = np.arange(-REACH_MM, REACH_MM, ALONG_MM)
    strip = np.linspace(-WIDE_MM, WIDE_MM, 5)
    places = end + t[:, None, None] * ahead + strip[:, None] * across
    inside = shapely.contains_xy(target, places[..., 0], places[..., 1]).mean(axis=1)
    flat = places.reshape(-1, 2)
    painted = (
        _paint(found, found.common.moved(flat, found.middle_mm)).reshape(inside.shape[0], -1).mean(axis=1)
    )
    drawn_end, is_painted = _last(inside, t), _last(painted, t)
    if drawn_end is None or is_painted is None:
        return None
    until = end + max(drawn_end, is_painted) * ahead
    if shapely.distance(shapely.Point(until), others) < EDGE_BLUR_MM:
        return None
    return is_painted - drawn_end


def _last(share: np.ndarray, t: np.ndarray) -> float | None:
    """Where a profile that is inside near the end of a way first falls below half."""
    falls = np.flatnonzero((share[:-1] >= LEVEL) & (share[1:] < LEVEL))
    if not len(falls):
        return None
    nearest = falls[np.abs(t[falls]).argmin()]
    part = (share[nearest] - LEVEL) / max(share[nearest] - share[nearest + 1], 1e-6)
    return float(t[nearest] + part * ALONG_MM)


def _paint(found: Comparison, places_mm: np.ndarray) -> np.ndarray:
    """Share of paint at places (n, 2) of the sheet, 0 beyond it."""
    fine, (left, _, _, top) = found.canvas.px_per_mm, found.canvas.window_mm
    column = np.floor((places_mm[:, 0] - left) * fine).astype(int)
    row = np.floor((top - places_mm[:, 1]) * fine).astype(int)
    on = (column >= 0) & (row >= 0) & (row < found.painted.shape[0]) & (column < found.painted.shape[1])
    return np.where(on, found.painted[np.where(on, row, 0), np.where(on, column, 0)], 0.0)
