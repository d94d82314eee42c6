"""Strokes as a search makes them, for tests of the ways to fill a shape."""

from brushsvg import _core
from brushsvg.strokes.stroke_search import search_strokes
from brushsvg.strokes.wide_shapes import within_reach


def passes_of(strokes, brush):
    """The strokes that fill shapes, those that the search adds among them."""
    painted, target, _ = within_reach(strokes, brush, "passes")

    def compensated(some):
        return _core.compensate(some, brush, None, start="auto", end="auto")

    return search_strokes(strokes, painted, target, compensated, brush).painted


def mark_of(strokes, brush):
    """Rings of what the brush paints of them."""
    plan = _core.compensate(strokes, brush, None, start="auto", end="auto").plan
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    return marks.outline_mm
