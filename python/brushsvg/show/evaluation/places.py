"""Find the places where the predicted paint differs most from the drawing, with causes and remedies."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ... import _core
from ...reporting.report_text import place_line
from .error_causes import RING_TOLERANCE_MM, Cause, find_cause, find_remedy, square_side_mm
from .figures import PaintedPlan

PX_PER_MM, MAX_PIXELS = 10.0, 8e6  # limits of the resolution and number of compared pixels
MARGIN_MM = 10.0  # around the drawing, where its paint can be
LINE_TOLERANCE_MM = 0.05  # tolerance of the polyline along a stroke


@dataclass(frozen=True)
class Place:
    """A place where paint and drawing differ.

    number: in the report and in the picture; place_mm: (x, y); missing_mm2: target without paint; outside_mm2: paint
    outside the target; tracking_error_mm: the largest tracking error of a drawn line, where it is above the tolerance;
    reason, code: see error_causes; remedy: the remedy, "" for none; size: these sizes in words.
    """

    number: int
    stroke: str
    place_mm: tuple[float, float]
    missing_mm2: float
    outside_mm2: float
    tracking_error_mm: float | None
    reason: str
    code: str
    remedy: str
    size: str

    @property
    def line(self) -> str:
        return place_line(self.number, self.stroke, self.place_mm, self.size, self.reason, self.remedy)

    def as_json(self) -> dict:
        keys = (
            "number",
            "stroke",
            "missing_mm2",
            "outside_mm2",
            "tracking_error_mm",
            "reason",
            "code",
            "remedy",
        )
        return {key: getattr(self, key) for key in keys} | {"place_mm": list(self.place_mm)}


def worst_places(painted: PaintedPlan) -> tuple[Place, ...]:
    """Return the places where paint differs most from the drawing.

    The largest difference comes first. There are none if the target of the plan is unknown.
    """
    pairs = zip(painted.plan.passes, painted.strokes or (), strict=bool(painted.strokes))
    whole = {stroke.id: (run, stroke) for run, stroke in pairs if stroke is not None}

    def why(name: str, area) -> tuple[Cause, float | None]:
        if name not in whole:
            return Cause("", ""), None
        run, stroke = whole[name]
        (error,) = _core.tracking_errors_of([run], [stroke], painted.brush, painted.tolerance_mm)
        line = _core.flatten(stroke, RING_TOLERANCE_MM)
        size_mm = max(square_side_mm(line), area.area_mm2**0.5)
        found_cause = find_cause(painted, stroke, line, area, size_mm, error)
        is_off = not (stroke.target_mm or error.within_tolerance or "tracking error" in found_cause.words)
        return found_cause, error.largest_mm if is_off else None

    return find_places(painted.marks, painted.brush, painted.target() or [], why, painted.compensation)


def find_places(
    marks: _core.Marks,
    brush: _core.Brush,
    drawn: Sequence[_core.Stroke],
    why: Callable[[str, object], tuple[Cause, float | None]],
    compensation: str,
) -> tuple[Place, ...]:
    """Return the five worst places, the largest first.

    drawn: the strokes that the marks should match; why: function of a stroke's id and a worst_areas.WorstArea that
    returns the cause and the tracking error [mm]; compensation: how the marks were planned.
    """
    if not drawn or not marks.passes:
        return ()
    from ...reporting.worst_areas import worst_areas  # loads OpenCV, which a verdict does not need

    lines = [_core.flatten(stroke, LINE_TOLERANCE_MM) for stroke in drawn]
    window, px_per_mm = _window_around(lines)
    target = _core.target_coverage(drawn, window, px_per_mm)
    painted = _core.coverage(marks, brush, window, px_per_mm)
    corner = (window[0], window[1] + window[3])
    areas = worst_areas(target, painted, corner, px_per_mm, [line[:, :2] for line in lines])
    return tuple(
        _describe_place(number, drawn[area.stroke], area, why, compensation) for number, area in enumerate(areas, 1)
    )


def _describe_place(number: int, stroke, area, why, compensation: str) -> Place:
    cause, error_mm = why(stroke.id, area)
    size = area.words
    if error_mm is not None:
        size += f", tracking error up to {error_mm:.2g} mm"
    at = (area.missing_mm2, area.outside_mm2, error_mm)
    remedy = find_remedy(cause.code, stroke, compensation)
    return Place(number, stroke.id, area.at_mm, *at, cause.words, cause.code, remedy, size)


def _window_around(lines: Iterable[np.ndarray]) -> tuple[tuple[float, float, float, float], float]:
    points = np.vstack([line[:, :2] for line in lines])
    half = max(float(line[:, 3].max()) for line in lines)
    low, high = points.min(axis=0) - half - MARGIN_MM, points.max(axis=0) + half + MARGIN_MM
    size = high - low
    return (*low.tolist(), *size.tolist()), min(PX_PER_MM, float(np.sqrt(MAX_PIXELS / size.prod())))
