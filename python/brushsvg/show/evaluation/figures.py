"""Figures of how well a plan paints the drawing, per stroke, per group of strokes that touch, and in total."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from ... import _core
from ...geometry.polylines import length
from .error_causes import RING_TOLERANCE_MM, find_cause, square_side_mm

MIN_DIFFERENCE_MM2 = 0.005  # a smaller difference is not reported


@dataclass(frozen=True)
class Figures:
    """The figures of one stroke, or of all strokes together.

    None means that the drawing is not known, or that nothing could be measured.

    overlap: area of intersection over area of union of predicted and drawn mark.
    centre_mean_mm, centre_largest_mm: distance of the widest point from the middle line over taut rows.
    width_error_mm: mean absolute difference of predicted and drawn width across the middle line.
    widths_out_of_reach: number of the stroke's half widths that the brush cannot paint.
    excess_turning: how much more the mark's outline turns than the drawn one's, in full turns; the mean over all.
    drawn_mm, painted_mm: length of the middle line, and of the TCP's path on the paper.
    """

    stroke: str
    overlap: float | None
    centre_mean_mm: float | None
    centre_largest_mm: float | None
    width_error_mm: float | None
    widths_out_of_reach: int | None
    drawn_mm: float | None
    painted_mm: float
    poses: int
    worst: Worst | None = None
    excess_turning: float | None = None


@dataclass(frozen=True)
class Worst:
    """The place where a stroke's paint differs most from the drawing.

    place_mm: (x, y); is_missing: drawn but not painted, else painted but not drawn; area_mm2: area of the difference
    near this place; reason: the cause in words; code: see error_causes.
    """

    place_mm: tuple[float, float]
    is_missing: bool
    area_mm2: float
    reason: str
    code: str = ""


@dataclass(frozen=True)
class Group:
    """Strokes that touch or cross, for example a letter.

    overlap: of all their paint with everything drawn of them, so that paint of one stroke on another is no error.
    """

    strokes: tuple[str, ...]
    overlap: float


class Bare(Protocol):
    """A piece of an element's shape that no stroke reaches.

    rings: its outlines [mm]; is_rim: it belongs to a stroke that is wider than the brush.
    """

    @property
    def element(self) -> str: ...
    @property
    def rings(self) -> list[np.ndarray]: ...
    @property
    def is_rim(self) -> bool: ...


def target_rings(strokes: Iterable[_core.Stroke]) -> list[np.ndarray]:
    """Return the outline of everything that was drawn."""
    return _core.unite([ring for s in strokes for ring in _core.target_outline(s, RING_TOLERANCE_MM)])


@dataclass(frozen=True)
class PaintedPlan:
    """A plan with its marks and its drawing.

    strokes: one per pass, or None if they are unknown; a pass that is a part of a stroke has None; drawn: everything
    that was drawn, None where it equals the strokes; unreached: pieces of shapes that no stroke reaches.
    """

    plan: _core.Plan
    marks: _core.Marks
    brush: _core.Brush
    strokes: Sequence[_core.Stroke | None] | None = None
    tolerance_mm: float = 0.05
    drawn: Sequence[_core.Stroke] | None = None
    compensation: str = "closed"
    unreached: Sequence[Bare] = ()

    def target(self) -> list[_core.Stroke] | None:
        """Return everything that the plan should paint, None if a pass paints an unknown part of a stroke."""
        if self.drawn is not None:
            return list(self.drawn)
        return None if self.strokes is None or None in self.strokes else list(self.strokes)


def measure_figures(painted: PaintedPlan) -> tuple[tuple[Figures, ...], Figures]:
    """Return the figures of each pass, and of all passes together."""
    plan, strokes, brush = painted.plan, painted.strokes, painted.brush
    if strokes is None:
        rows = tuple(_path_figures(a_pass) for a_pass in plan.passes)
        return rows, _total_figures(rows, None)
    passes, traces = plan.passes, painted.marks.passes
    known_passes = [k for k, stroke in enumerate(strokes) if stroke is not None]
    known_strokes = [strokes[k] for k in known_passes]
    stroke_scores = _core.score_strokes([traces[k] for k in known_passes], known_strokes, brush)
    tracking_errors = _core.tracking_errors_of(
        [passes[k] for k in known_passes], known_strokes, brush, painted.tolerance_mm
    )
    measured = iter(zip(stroke_scores, tracking_errors, strict=True))
    rows = tuple(
        _path_figures(a_pass) if stroke is None else _stroke_figures(painted, a_pass, stroke, *next(measured))
        for a_pass, stroke in zip(passes, strokes, strict=True)
    )
    target = painted.target()
    overlap = _core.common_area(traces, target, brush).overlap if rows and target is not None else None
    return rows, _total_figures(rows, overlap)


def _stroke_figures(painted: PaintedPlan, a_pass, stroke, verdict, tracking_error) -> Figures:
    line = _core.flatten(stroke, RING_TOLERANCE_MM)
    worst, place = None, verdict.worst
    if place.area_mm2 >= MIN_DIFFERENCE_MM2:
        size_mm = square_side_mm(line)
        why = find_cause(painted, stroke, line, place, size_mm, tracking_error)
        worst = Worst(tuple(place.at_mm), place.is_missing, place.area_mm2, why.words, why.code)
    return replace(
        _path_figures(a_pass),
        overlap=verdict.overlap,
        centre_mean_mm=tracking_error.mean_mm,
        centre_largest_mm=tracking_error.largest_mm,
        width_error_mm=verdict.width_error_mm,
        excess_turning=verdict.excess_turning,
        widths_out_of_reach=_out_of_reach(stroke, painted.brush),
        drawn_mm=float(line[-1, 2]),
        worst=worst,
    )


def group_touching_strokes(
    marks: _core.Marks, brush: _core.Brush, strokes: Sequence[_core.Stroke] | None
) -> tuple[Group, ...]:
    """Return groups of strokes that touch, so that each letter is judged as a whole.

    strokes: one per pass, None for a pass that is a part of a stroke.
    """
    known_pairs = [pair for pair in zip(marks.passes, strokes or (), strict=bool(strokes)) if pair[1] is not None]
    traces, targets = [trace for trace, _ in known_pairs], [stroke for _, stroke in known_pairs]
    touching = _core.group_touching(targets)
    areas = _core.common_areas(traces, targets, touching, brush)
    return tuple(
        Group(tuple(targets[k].id for k in members), area.overlap)
        for members, area in zip(touching, areas, strict=True)
    )


def _path_figures(a_pass) -> Figures:
    poses = np.asarray(a_pass.poses_mm, dtype=float).reshape(-1, 3)
    painted_mm = length(poses)
    return Figures(a_pass.stroke, None, None, None, None, None, None, painted_mm, len(poses))


def _total_figures(rows: tuple[Figures, ...], overlap: float | None) -> Figures:
    def combine_known(name, combine):
        values = [(getattr(row, name), row.drawn_mm or 0.0) for row in rows if getattr(row, name) is not None]
        return combine(*zip(*values, strict=True)) if values else None

    def mean(values, weights):
        return float(np.average(values, weights=weights)) if sum(weights) > 0 else float(np.mean(values))

    return Figures(
        stroke="all",
        overlap=overlap,
        centre_mean_mm=combine_known("centre_mean_mm", mean),
        centre_largest_mm=combine_known("centre_largest_mm", lambda values, _: max(values)),
        width_error_mm=combine_known("width_error_mm", mean),
        excess_turning=combine_known("excess_turning", lambda values, _: float(np.mean(values))),
        widths_out_of_reach=combine_known("widths_out_of_reach", lambda values, _: sum(values)),
        drawn_mm=combine_known("drawn_mm", lambda values, _: sum(values)),
        painted_mm=sum(row.painted_mm for row in rows),
        poses=sum(row.poses for row in rows),
    )


def _out_of_reach(stroke, brush) -> int:
    if not brush.width_follows_depth():
        return 0  # such a brush cannot vary its width
    least, greatest = brush.half_width_range_mm()
    return sum(not least - 1e-9 <= half_width <= greatest + 1e-9 for _, half_width in stroke.half_width)
