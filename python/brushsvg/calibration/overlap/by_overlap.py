"""A brush fitted to painted marks, changed so that it predicts further marks best: to the largest overlap.

Edges say what the usual mark is; overlap (intersection over union of painted and predicted area) says what to predict
where marks vary and are displaced. overlap_search changes few numbers of the fit by edges, overlap_choice says which.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.polynomial import polyval

from ... import _core
from ...array_values import ArrayValue
from ...geometry.rotation import rotation
from ..marks.from_marks import MarkCalibration, brush_of
from .lag_by_outlines import Placed, PlacedMark
from .overlap_choice import Predicting, best_predicting
from .overlap_search import Begin, Target

PIXEL, MARGIN_MM = 1 / 6, 8.0  # of the pictures: half widths of the deepest mark, around way and paint


@dataclass(frozen=True, eq=False, repr=False)
class OverlapCalibration(ArrayValue):
    """made: the marks with the brush that predicts best, at their places by it (Placed); by_edges: what it was made
    of, the brush with intervals; found: what was changed."""

    made: MarkCalibration
    by_edges: MarkCalibration
    found: Predicting

    @property
    def brush(self) -> _core.Brush:
        """Without intervals where it is not that of the edges, since theirs are not its own."""
        return self.made.brush

    def __repr__(self) -> str:
        return f"<OverlapCalibration of {self.brush!r} from {len(self.made.painted.marks)} marks>"


def by_overlap(
    made: MarkCalibration, progress: Callable[[str], object] = lambda text: None
) -> OverlapCalibration:
    """made: the fit of the marks by edges. Its outliers as a whole are left out here, too. progress: receives the
    progress in words."""
    fit, options = made.fit, copy(made.expected)
    options.deepest_mm = made.brush.depth_range_mm[1]
    seen = [
        _seen(mark, residual, made)
        for mark, residual in zip(made.painted.marks, fit.marks, strict=True)
        if not residual.outlier
    ]
    targets = [_target(mark, made) for mark in seen]
    found = best_predicting(
        seen,
        targets,
        Begin(fit.laws, fit.height_mm),
        options,
        lambda looks: progress(f"looked at {looks} sets of overlaps"),
    )
    return _calibrated(made, found)


def _calibrated(made: MarkCalibration, found: Predicting) -> OverlapCalibration:
    """Where edges are chosen, their brush with its intervals."""
    if found.kind == "edges":
        return OverlapCalibration(made, made, found)
    fit, count = made.fit, sum(not residual.outlier for residual in made.fit.marks)
    brush = brush_of(found.laws, made.brush.name, made.brush.depth_range_mm)
    brush.max_speed_mm_s = made.brush.max_speed_mm_s
    for law in ("lag", "tip_gap", "tip_to_widest", "half_width"):
        was = getattr(brush, law)
        profile = _core.Profile(
            was.coefficients,
            calibrated_mm=(0.0, made.painted.deepest_mm),
            source=f"Fitted to {count} painted marks, to the largest overlap; without intervals.",
            floor=was.floor,
            floor_slope=was.floor_slope,
        )
        setattr(brush, law, profile)
    _core.check(brush)
    placed = Placed(
        fit.turn_rad,
        tuple((np.array(fit.shift_mm) + found.shift_mm @ rotation(fit.turn_rad)).tolist()),
        fit.centre_mm,
        found.height_mm,
        tuple(
            PlacedMark(
                found.offsets.way(np.array(residual.way_mm), found.height_mm),
                tuple((residual.displacement_mm - found.shift_mm).tolist()),
            )
            for residual in fit.marks
        ),
    )
    return OverlapCalibration(replace(made, brush=brush, fit=placed, covariance=None), made, found)


def _seen(mark, residual, made: MarkCalibration) -> _core.PaintedMark:
    """A painted mark in the plan's frame, of the way as the machine ran it."""
    fit = made.fit
    centre, back = np.array(fit.centre_mm), rotation(-fit.turn_rad)
    rings = [(np.array(ring) - fit.shift_mm - centre) @ back + centre for ring in mark.outline_mm]
    return _core.PaintedMark(mark.stroke, np.array(residual.way_mm), rings)


def _target(mark: _core.PaintedMark, made: MarkCalibration) -> Target:
    poses = np.array(mark.poses_mm)
    pixel = PIXEL * polyval(made.brush.depth_range_mm[1], made.fit.laws.half_width)
    seen = np.vstack([poses[:, :2], *mark.outline_mm])
    low, high = seen.min(axis=0) - MARGIN_MM, seen.max(axis=0) + MARGIN_MM
    size = np.ceil((high - low) / pixel) * pixel
    window = (*low.tolist(), *size.tolist())
    return Target(poses, _core.coverage(mark.outline_mm, window, 1 / pixel), window, 1 / pixel)
