"""What a brush would paint of a few strokes, before anybody chooses how they are painted."""

from __future__ import annotations

import numpy as np

from .. import _core

_ANY_SHEET_MM = (1e6, 1e6)
_BESIDE_MM = 5.0  # of a shape: no paint lies farther out
_PX_PER_MM, _SIDE_PX = 6.0, 2000
_TOLERANCE_MM = 0.05  # as plans have by default: a coarser one blurs what corners look like


def trial_mark(strokes: list, brush) -> list[np.ndarray]:
    """Rings of the mark of strokes in closed form, each begun as suits it; Error where they cannot be painted."""
    marks = _marks(strokes, brush)
    _core.trace_outlines(marks, brush)
    return marks.outline_mm


def trial_overlap(strokes: list, rings: list[np.ndarray], brush) -> float:
    """How much that mark overlaps with a shape, to 0.002, in pixels: its outline takes ten times as long."""
    marks = _marks(strokes, brush)
    points = np.vstack(rings)
    low, size = points.min(axis=0) - _BESIDE_MM, np.ptp(points, axis=0) + 2 * _BESIDE_MM
    window, px_per_mm = (*low, *size), min(_PX_PER_MM, _SIDE_PX / size.max())
    shape = strokes[0].replaced(wanted_mm=rings)
    wanted = _core.wanted_coverage([shape], window, px_per_mm)
    painted = _core.coverage(marks, brush, window, px_per_mm)
    return float(np.minimum(wanted, painted).sum() / np.maximum(wanted, painted).sum())


def _marks(strokes: list, brush):
    plan = _core.compensate(
        strokes, brush, _ANY_SHEET_MM, "closed", _TOLERANCE_MM, start="auto", end="auto"
    ).plan
    return _core.simulate(plan, brush)
