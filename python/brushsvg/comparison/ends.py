"""Find where the paint of a stroke begins and ends, relative to the target."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from ..geometry.cubics import flattened
from .edge_offsets import polygon_of
from .photographs import EDGE_BLUR_MM, Comparison, TargetStroke

SEARCH_MM = 6.0  # search distance before and beyond the end of a middle line
PROFILE_STEP_MM = 0.05
# Half width of a strip around the middle line: single hairs next to the strip are no end.
STRIP_HALF_WIDTH_MM = 0.4
FLATTENING_TOLERANCE_MM = 0.02
DIRECTION_LENGTH_MM = 1.5  # length of the middle line that gives the direction at its end
EDGE_LEVEL = 0.5


@dataclass(frozen=True)
class Ends:
    """How much later than its target the paint of a stroke begins and ends [mm].

    Later is further along the stroke's path. Negative values are earlier; None where the paint runs into other paint,
    or where no paint is found. first_mm, last_mm: the ends (x, y) of the middle line.
    """

    began_mm: float | None
    ended_mm: float | None
    first_mm: tuple[float, float] = (0.0, 0.0)
    last_mm: tuple[float, float] = (0.0, 0.0)

    def near(self, place_mm: tuple[float, float]) -> dict[str, float]:
        """Return the values of "began" and "ended" near a place.

        Only known values are returned, for ends within reach of the place.
        """
        ends = (("began", self.began_mm, self.first_mm), ("ended", self.ended_mm, self.last_mm))
        return {what: mm for what, mm, at in ends if mm is not None and math.dist(at, place_mm) <= SEARCH_MM}


UNKNOWN_ENDS = Ends(None, None)


def measure_ends(found: Comparison, strokes: list[TargetStroke], drawn) -> dict[str, Ends]:
    """Return where the paint of each stroke begins and ends.

    Rings and dabs have no ends and are left out. drawn: strokes with their middle lines, empty for a plan without its
    drawing. The pose of the sheet is corrected by the places of its marks.
    """
    lines_mm = {
        each.id: flattened(each.middle_mm.reshape(-1, 4, 2), FLATTENING_TOLERANCE_MM)
        for each in drawn
        if not each.closed
    }
    shapes = {stroke.stroke: polygon_of(stroke.predicted) for stroke in strokes if stroke.predicted}
    seen = {row.stroke for row in found.strokes if row.placed.found}
    ends = {}
    for stroke in strokes:
        name = stroke.stroke
        if name not in shapes or name not in lines_mm or not stroke.target:
            continue
        others = shapely.unary_union([shape for other, shape in shapes.items() if other != name])
        target = polygon_of(stroke.target)
        overshoots = (
            _overshoot_mm(found, _end_and_direction(way), target, others)
            for way in (lines_mm[name][::-1], lines_mm[name])
        )
        before, behind = overshoots if name in seen else (None, None)
        first, last = (tuple(lines_mm[name][k, :2].tolist()) for k in (0, -1))
        ends[name] = Ends(None if before is None else -before, behind, first, last)
    return ends


def _end_and_direction(way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the end of a path (n, 2), and the direction in which it ends."""
    travelled_mm = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
    back = np.array(
        [np.interp(max(travelled_mm[-1] - DIRECTION_LENGTH_MM, 0.0), travelled_mm, way[:, k]) for k in (0, 1)]
    )
    ahead = way[-1] - back
    return way[-1], ahead / max(float(np.hypot(*ahead)), 1e-9)


def _overshoot_mm(found: Comparison, ray: tuple[np.ndarray, np.ndarray], target, others) -> float | None:
    """Return how far along a ray the paint ends beyond the target's edge [mm]. Returns None where that is unknown."""
    end, ahead = ray
    if not ahead.any():  # a dab has no direction
        return None
    across = np.array([-ahead[1], ahead[0]])
    t = np.arange(-SEARCH_MM, SEARCH_MM, PROFILE_STEP_MM)
    strip = np.linspace(-STRIP_HALF_WIDTH_MM, STRIP_HALF_WIDTH_MM, 5)
    places = end + t[:, None, None] * ahead + strip[:, None] * across
    inside = shapely.contains_xy(target, places[..., 0], places[..., 1]).mean(axis=1)
    flat = places.reshape(-1, 2)
    painted = _paint_at(found, found.common.moved(flat, found.middle_mm)).reshape(inside.shape[0], -1).mean(axis=1)
    drawn_end, is_painted = _find_fall(inside, t), _find_fall(painted, t)
    if drawn_end is None or is_painted is None:
        return None
    until = end + max(drawn_end, is_painted) * ahead
    if shapely.distance(shapely.Point(until), others) < EDGE_BLUR_MM:
        return None
    return is_painted - drawn_end


def _find_fall(share: np.ndarray, t: np.ndarray) -> float | None:
    """Return the place nearest to 0 of t (n,) [mm] where a profile falls below EDGE_LEVEL, or None."""
    falls = np.flatnonzero((share[:-1] >= EDGE_LEVEL) & (share[1:] < EDGE_LEVEL))
    if not len(falls):
        return None
    nearest = falls[np.abs(t[falls]).argmin()]
    part = (share[nearest] - EDGE_LEVEL) / max(share[nearest] - share[nearest + 1], 1e-6)
    return float(t[nearest] + part * PROFILE_STEP_MM)


def _paint_at(found: Comparison, places_mm: np.ndarray) -> np.ndarray:
    """Return the share of paint at places (n, 2) of the sheet, 0 outside the sheet."""
    fine, (left, _, _, top) = found.canvas.px_per_mm, found.canvas.window_mm
    column = np.floor((places_mm[:, 0] - left) * fine).astype(int)
    row = np.floor((top - places_mm[:, 1]) * fine).astype(int)
    on = (column >= 0) & (row >= 0) & (row < found.painted.shape[0]) & (column < found.painted.shape[1])
    return np.where(on, found.painted[np.where(on, row, 0), np.where(on, column, 0)], 0.0)
