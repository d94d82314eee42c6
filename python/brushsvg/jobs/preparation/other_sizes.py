"""The same drawing at other sizes: which would be painted better, in words."""

from __future__ import annotations

from dataclasses import replace

from ... import _core
from ...planning import size_advice
from ...planning.refinement import refined
from ...strokes.stroke_search import Searched, searched
from ...strokes.wide_shapes import within_reach
from ..options import Options
from ..work import Work
from .compensated import make_compensation


def advise_on_size(work: Work) -> str:
    """On the drawing's size, in words; none for a plan."""
    options = work.options
    if not work.drawn or options.layout.width_mm is not None:
        return ""
    outlines = {stroke.origin.element for stroke in work.drawn if stroke.wanted_mm}
    in_lanes = {each.origin.element for each in work.strokes if each.origin.lane > 1 and not each.wanted_mm}
    is_filled = options.wide == "passes" or not outlines.isdisjoint(in_lanes)
    if options.wide == "auto" and not is_filled:
        options = replace(options, wide="clamp")  # strokes are tried alone, and shapes are filled whole
    made = _make_trial(work.brush, options)
    if is_filled:
        size = size_advice.best_letter_size(work.drawn, work.brush, made)
    else:
        size = size_advice.best_size(work.drawn, work.brush, made, _make_quick_trial(work.brush, options))
    scale = (options.layout.scale or 1.0) if options.layout.fit_mm is None else None
    return size_advice.advice(size, scale)


def _make_trial(brush, options: Options):
    """From strokes to (marks, what they should become), made as a drawing is, but on no sheet and for no machine."""
    compensated = make_compensation(brush, None, options)

    def made(strokes):
        found = _search_strokes(strokes, brush, options, compensated)
        plan = found.done.plan
        if options.compensation == "refined":
            plan.passes = refined(found.painted, found.targets, brush, found.done, compensated).passes
        return _core.simulate(plan, brush).passes, found.targets

    return made


def _make_quick_trial(brush, options: Options):
    """A trial in a quarter of the time, or a tenth of refined: in closed form, with more poses than are needed."""
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

    def made(strokes):
        found = _search_strokes(strokes, brush, options, compensated)
        return _core.simulate(found.done.plan, brush).passes, found.targets

    return made


def _search_strokes(strokes: list, brush, options: Options, compensated) -> Searched:
    painted, targets, _ = within_reach(strokes, brush, options.wide)
    if options.compensation not in ("closed", "refined"):
        return Searched(strokes, painted, targets, compensated(painted))
    corners = (options.start, options.end, options.corners) == ("auto", "auto", "auto")
    sides = options.wide != "clamp"
    return searched(strokes, painted, targets, compensated, brush, options.detail, corners, sides)
