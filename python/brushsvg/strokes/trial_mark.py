"""What a brush would paint of a few strokes, before anybody chooses how they are painted."""

from __future__ import annotations

import numpy as np

from .. import _core

_ANY_SHEET_MM = (1e6, 1e6)
_TOLERANCE_MM = 0.05  # as plans have by default: a coarser one blurs what corners look like


def trial_mark(strokes: list, brush) -> list[np.ndarray]:
    """Rings of the mark of strokes in closed form, each begun as suits it; Error where they cannot be painted."""
    plan = _core.compensate(
        strokes, brush, _ANY_SHEET_MM, "closed", _TOLERANCE_MM, start="auto", end="auto"
    ).plan
    marks = _core.simulate(plan, brush)
    _core.trace_outlines(marks, brush)
    return marks.outline_mm
