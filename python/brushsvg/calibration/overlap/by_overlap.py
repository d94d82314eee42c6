"""Change a fitted brush to the one that predicts further marks best.

The best prediction has the largest overlap.

Edges determine the usual mark. The overlap (intersection over union of painted and predicted area) determines the best
prediction if marks vary and are displaced. overlap_search changes few numbers of the fit by edges. overlap_choice
chooses which numbers.
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
from ...model.confidence import LAWS
from ..marks.from_marks import MarkCalibration, brush_of
from .lag_by_outlines import Placed, PlacedMark
from .overlap_choice import BestPrediction, find_best_prediction
from .overlap_search import SearchStart, Target

# Size of a pixel in half widths of the deepest mark, and margin of a picture around path and paint.
PIXEL_HALF_WIDTHS, MARGIN_MM = 1 / 6, 8.0


@dataclass(frozen=True, eq=False, repr=False)
class OverlapCalibration(ArrayValue):
    """The brush that predicts best, and the fit by edges from which it was made.

    mark_calibration: the marks with the brush that predicts best; their places are Placed. by_edges: the fit by edges,
    whose brush has intervals. found: the changes.
    """

    mark_calibration: MarkCalibration
    by_edges: MarkCalibration
    found: BestPrediction

    @property
    def brush(self) -> _core.Brush:
        """Brush that predicts best.

        It has no intervals unless it is the brush of the fit by edges, whose intervals are valid.
        """
        return self.mark_calibration.brush

    def __repr__(self) -> str:
        return f"<OverlapCalibration of {self.brush!r} from {len(self.mark_calibration.painted.marks)} marks>"


def maximize_overlap(
    calibration: MarkCalibration, progress: Callable[[str], object] = lambda text: None
) -> OverlapCalibration:
    """Change a fit by edges to the brush with the largest overlap.

    calibration: the fit of the marks by edges. Marks that are outliers of that fit are left out. progress: receives the
    progress in words.
    """
    fit, options = calibration.fit, copy(calibration.expected)
    options.deepest_mm = calibration.brush.depth_range_mm[1]
    marks = [
        _to_plan_frame(mark, residual, calibration)
        for mark, residual in zip(calibration.painted.marks, fit.marks, strict=True)
        if not residual.outlier
    ]
    targets = [_make_target(mark, calibration) for mark in marks]
    best = find_best_prediction(
        marks,
        targets,
        SearchStart(fit.laws, fit.height_mm),
        options,
        lambda count: progress(f"compared {count} candidate brushes with the marks"),
    )
    return _make_calibration(calibration, best)


def _make_calibration(calibration: MarkCalibration, found: BestPrediction) -> OverlapCalibration:
    """Make the calibration from the search; if edges are chosen, with their brush and its intervals."""
    if found.kind == "edges":
        return OverlapCalibration(calibration, calibration, found)
    fit, count = calibration.fit, sum(not residual.outlier for residual in calibration.fit.marks)
    brush = brush_of(found.laws, calibration.brush.name, calibration.brush.depth_range_mm)
    brush.max_speed_mm_s = calibration.brush.max_speed_mm_s
    for law in LAWS:
        law_of_brush = getattr(brush, law)
        profile = _core.Profile(
            law_of_brush.coefficients,
            calibrated_mm=(0.0, calibration.painted.deepest_mm),
            source=f"Fitted to {count} painted marks for the largest overlap. It has no confidence intervals.",
            floor=law_of_brush.floor,
            floor_slope=law_of_brush.floor_slope,
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
                found.offsets.displace_path(np.array(residual.way_mm), found.height_mm),
                tuple((residual.displacement_mm - found.shift_mm).tolist()),
            )
            for residual in fit.marks
        ),
    )
    return OverlapCalibration(replace(calibration, brush=brush, fit=placed, covariance=None), calibration, found)


def _to_plan_frame(mark, residual, calibration: MarkCalibration) -> _core.PaintedMark:
    """Return a painted mark in the frame of the plan, with the path that the machine executed."""
    fit = calibration.fit
    centre, back = np.array(fit.centre_mm), rotation(-fit.turn_rad)
    rings = [(np.array(ring) - fit.shift_mm - centre) @ back + centre for ring in mark.outline_mm]
    return _core.PaintedMark(mark.stroke, np.array(residual.way_mm), rings)


def _make_target(mark: _core.PaintedMark, calibration: MarkCalibration) -> Target:
    poses = np.array(mark.poses_mm)
    pixel = PIXEL_HALF_WIDTHS * polyval(calibration.brush.depth_range_mm[1], calibration.fit.laws.half_width)
    points = np.vstack([poses[:, :2], *mark.outline_mm])
    low, high = points.min(axis=0) - MARGIN_MM, points.max(axis=0) + MARGIN_MM
    size = np.ceil((high - low) / pixel) * pixel
    window = (*low.tolist(), *size.tolist())
    return Target(poses, _core.coverage(mark.outline_mm, window, 1 / pixel), window, 1 / pixel)
