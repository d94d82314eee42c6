"""Make strokes with the stroke search, for tests of filling a shape."""

from brushsvg import _core
from brushsvg.strokes.stroke_search import search_strokes
from brushsvg.strokes.wide_shapes import within_reach


def passes_of(strokes, brush):
    """Return the strokes that fill shapes, including those that the search adds."""
    painted, target, _ = within_reach(strokes, brush, "passes")

    def compensated(some):
        return _core.compensate(some, brush, None, start="auto", end="auto")

    return search_strokes(strokes, painted, target, compensated, brush).painted


def mark_of(strokes, brush):
    """Return the outlines of the marks that the brush paints."""
    plan = _core.compensate(strokes, brush, None, start="auto", end="auto").plan
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    return marks.outline_mm
