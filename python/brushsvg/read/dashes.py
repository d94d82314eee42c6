"""Dashes: a line cut into the pieces that are painted."""

from __future__ import annotations

import numpy as np

from ..errors import Error
from ..geometry.arc_length import knots, parameters_at
from ..geometry.cubics import between
from .design import SubPath

_ROUNDING = 1e-9  # of a length: a dash that begins nearer to the end would be a dab that nobody drew


def dashed(subpath: SubPath, pattern_mm: list[float], offset_mm: float, most: int) -> list[SubPath]:
    """The dashes of one sub-path, in order; the pattern's even entries are painted, an odd count repeats.

    On a closed line the last dash and the first are one where they meet. Error when there are more than `most`.
    """
    pattern = np.array(pattern_mm if len(pattern_mm) % 2 == 0 else 2 * pattern_mm)
    period = float(pattern.sum())
    known = knots(subpath.cubics)
    end = float(known[:, -1].sum())
    if end == 0:
        return [subpath]
    count = end / period * len(pattern) / 2
    if count > most:
        raise Error(
            f"its dashes of {period:.4g} mm would make {count:.3g} strokes where {most} are left of the drawing's "
            "limit",
            code="drawing-too-large",
        )
    ends = np.cumsum(pattern)
    first = -(offset_mm % period)
    periods = np.arange(int(np.ceil((end - first) / period)) + 1) * period + first
    spans = np.stack(
        [(periods[:, None] + ends[0::2] - pattern[0::2]).ravel(), (periods[:, None] + ends[0::2]).ravel()],
        axis=1,
    )
    spans = spans[
        (spans[:, 1] > 0) & (spans[:, 0] < end * (1 - _ROUNDING))
        | ((spans[:, 0] == spans[:, 1]) & (spans[:, 0] == 0))
    ]
    spans = np.clip(spans, 0.0, end)
    if not len(spans):
        return []
    if (spans[0] == (0.0, end)).all():
        return [subpath]
    number, t = parameters_at(subpath.cubics, known, spans.ravel())
    places = list(zip(number.tolist(), t.tolist(), strict=True))
    pieces = [between(subpath.cubics, *ends) for ends in zip(places[0::2], places[1::2], strict=True)]
    if subpath.closed and len(pieces) > 1 and spans[0, 0] == 0 and spans[-1, 1] == end:
        pieces[0] = np.concatenate([pieces.pop(), pieces[0]])
    return [SubPath(piece) for piece in pieces]
