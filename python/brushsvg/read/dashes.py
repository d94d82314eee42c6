"""Cut a line into its dashes."""

from __future__ import annotations

import numpy as np

from ..errors import Error
from ..geometry.arc_length import knots, parameters_at
from ..geometry.cubics import between
from .design import SubPath

# Share of the length of the line. A dash that begins closer to the end is a rounding error and would paint a dab.
_MIN_DASH_START_SHARE = 1e-9


def find_smallest_gap_mm(pattern_mm: list[float]) -> float:
    """Return the smallest gap of a pattern that is not 0, or 0 if there is none.

    A gap of 0 leaves the line as it is. In a pattern with an odd count, each length is once a gap.
    """
    gaps_mm = pattern_mm[1::2] if len(pattern_mm) % 2 == 0 else pattern_mm
    return min((gap for gap in gaps_mm if gap > 0), default=0.0)


def cut_into_dashes(subpath: SubPath, pattern_mm: list[float], offset_mm: float, limit: int) -> list[SubPath]:
    """Return the dashes of a sub-path, in order.

    pattern_mm: lengths; entries 0, 2, 4 ... are painted. A pattern with an odd count is repeated once, as in SVG.
    offset_mm: the place in the pattern at which the line begins.

    The last and the first dash of a closed line are joined if they meet. A sub-path without length stays as it is.
    Raises Error if there are more dashes than the limit.
    """
    pattern = np.array(pattern_mm if len(pattern_mm) % 2 == 0 else 2 * pattern_mm)
    period = float(pattern.sum())
    knot_table = knots(subpath.cubics)
    total = float(knot_table[:, -1].sum())
    if total == 0:
        return [subpath]
    count = total / period * len(pattern) / 2
    if count > limit:
        raise Error(
            f"its dashes of {period:.4g} mm would make {count:.3g} strokes, but only {limit} are left of the "
            "drawing's limit",
            code="drawing-too-large",
        )
    ends = np.cumsum(pattern)
    first = -(offset_mm % period)
    periods = np.arange(int(np.ceil((total - first) / period)) + 1) * period + first
    spans = np.stack(
        [(periods[:, None] + ends[0::2] - pattern[0::2]).ravel(), (periods[:, None] + ends[0::2]).ravel()],
        axis=1,
    )
    spans = spans[
        (spans[:, 1] > 0) & (spans[:, 0] < total * (1 - _MIN_DASH_START_SHARE))
        | ((spans[:, 0] == spans[:, 1]) & (spans[:, 0] == 0))
    ]
    spans = np.clip(spans, 0.0, total)
    if not len(spans):
        return []
    if (spans[0] == (0.0, total)).all():
        return [subpath]
    number, t = parameters_at(subpath.cubics, knot_table, spans.ravel())
    places = list(zip(number.tolist(), t.tolist(), strict=True))
    pieces = [between(subpath.cubics, *ends) for ends in zip(places[0::2], places[1::2], strict=True)]
    if subpath.closed and len(pieces) > 1 and spans[0, 0] == 0 and spans[-1, 1] == total:
        pieces[0] = np.concatenate([pieces.pop(), pieces[0]])
    return [SubPath(piece) for piece in pieces]
