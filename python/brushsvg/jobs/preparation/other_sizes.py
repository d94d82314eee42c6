"""Advice on the size at which a drawing would be painted better."""

from __future__ import annotations

from dataclasses import replace

from ... import _core
from ...planning import size_advice
from ...planning.refinement import refine_where_better
from ...strokes.stroke_search import Searched, search_strokes
from ...strokes.wide_shapes import within_reach
from ..options import Options
from ..prepared_drawing import PreparedDrawing
from .compensated import make_compensation
from .preparation import limit_depth


def advise_on_size(work: PreparedDrawing) -> str:
    """Return a sentence on a better size of the drawing; "" for a plan."""
    options = work.options
    if not work.drawn or options.layout.width_mm is not None:
        return ""
    outline_elements = {stroke.origin.element for stroke in work.drawn if stroke.target_mm}
    lane_elements = {each.origin.element for each in work.strokes if each.origin.lane > 1 and not each.target_mm}
    are_filled = options.wide == "passes" or not outline_elements.isdisjoint(lane_elements)
    if options.wide == "auto" and not are_filled:
        # Strokes are tried one at a time, but a shape is only filled as a whole.
        options = replace(options, wide="clamp")
    trial = _make_trial(work.brush, options)
    if are_filled:
        size = size_advice.find_best_letter_size(work.drawn, work.brush, trial)
    else:
        size = size_advice.find_best_size(work.drawn, work.brush, trial, _make_quick_trial(work.brush, options))
    scale = (options.layout.scale or 1.0) if options.layout.fit_mm is None else None
    return size_advice.advise_on_size(size, scale)


def _make_trial(brush, options: Options):
    """Return a function from strokes to their marks and targets, planned without a sheet and a machine."""
    compensated = make_compensation(brush, None, options)

    def run_trial(strokes):
        search = _search_strokes(strokes, brush, options, compensated)
        plan = search.done.plan
        if options.compensation == "refined":
            plan.passes = refine_where_better(search.painted, search.targets, brush, search.done, compensated).passes
        return _core.simulate(plan, brush).passes, search.targets

    return run_trial


def _make_quick_trial(brush, options: Options):
    """Return a faster trial, or None if the method has none.

    The trial needs a quarter of the time, or a tenth of the time with refinement: it uses the closed form and
    leaves more poses than are needed.
    """
    if options.compensation not in ("closed", "refined"):
        return None

    def compensated(strokes):
        return _core.compensate(
            strokes,
            brush,
            tolerance_mm=options.tolerance_mm,
            few_poses=False,
            sheet_mm=None,
            start=options.start,
            end=options.end,
        )

    def run_trial(strokes):
        search = _search_strokes(strokes, brush, options, compensated)
        return _core.simulate(search.done.plan, brush).passes, search.targets

    return run_trial


def _search_strokes(strokes: list, brush, options: Options, compensated) -> Searched:
    brush = limit_depth(brush, options)
    painted, targets, _ = within_reach(strokes, brush, options.wide)
    if options.compensation not in ("closed", "refined"):
        return Searched(strokes, painted, targets, compensated(painted))
    corners = (options.start, options.end, options.corners) == ("auto", "auto", "auto")
    sides = options.wide != "clamp"
    return search_strokes(strokes, painted, targets, compensated, brush, options.detail, corners, sides)
