"""Would the drawing be painted better at another size? Some are tried on a few strokes."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import Error

SCALES = (0.35, 0.5, 0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0, 2.8)
COARSE = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8)  # looked at first
TRIED, FEW = 16, 6  # strokes of a drawing, and of these for a first look: bounds the time to half a second
# A letter filled in several passes takes as long as twenty strokes, and the larger the longer, for a better fit always.
LETTER_SCALES, LETTERS = (0.5, 0.7, 1.0, 1.4), 3
WORTH = 0.01  # of overlap: less is not worth another size
ALIKE = 0.005  # sizes that differ by less are as good, and the nearest to the drawing's is named


@dataclass(frozen=True)
class Size:
    """What a drawing would come to at other sizes. overlaps: by the factor, of a few strokes, refused ones painted as
    nothing; best: the factor to be advised, 1 where none is noticeably better; tried: of so many strokes; what: was
    tried; reach: least and greatest factor that was looked at."""

    overlaps: dict[float, float]
    best: float
    tried: int
    strokes: int
    what: str = "single strokes"
    reach: tuple[float, float] = (SCALES[0], SCALES[-1])


def best_size(strokes, brush, made, quick=None) -> Size:
    """Tries scales on strokes chosen evenly from all, alone each: letters and neighbours do not count.

    made: from strokes to (marks, strokes they should become), as the drawing is made; quick: the same with less effort,
    for a first look at fewer strokes, thin and wide ones: only sizes that look better there are made.
    """
    units = [[stroke] for stroke in strokes]
    some = _evenly(units, TRIED)
    few = _evenly(sorted(some, key=_half_width), FEW)
    look = {factor: _overlap_at(factor, few, brush, quick or made) for factor in COARSE}
    at = SCALES.index(max(look, key=look.get))
    for factor in SCALES[max(at - 1, 0) : at + 2]:
        if factor not in look:
            look[factor] = _overlap_at(factor, few, brush, quick or made)
    promising = {_nearest(look), max(look, key=look.get)}
    if _nearest(look) == 1.0:
        return Size(look, 1.0, len(few), len(strokes))
    found = {factor: _overlap_at(factor, some, brush, made) for factor in sorted({1.0, *promising})}
    return Size(found, _nearest(found), len(some), len(strokes))


def best_letter_size(strokes, brush, made) -> Size:
    """The same, tried on whole letters, strokes that touch, and on fewer scales: for shapes filled in passes."""
    groups = _core.touching(strokes)
    alone = set(range(len(strokes))).difference(*groups)
    letters = sorted([*groups, *([k] for k in alone)])
    some = [[strokes[k] for k in letter] for letter in _evenly(letters, LETTERS)]
    found = {1.0: _overlap_at(1.0, some, brush, made)}
    if found[1.0] + WORTH < 1:  # else no size is noticeably better
        found |= {factor: _overlap_at(factor, some, brush, made) for factor in LETTER_SCALES if factor != 1.0}
    reach = LETTER_SCALES[0], LETTER_SCALES[-1]
    return Size(found, _nearest(found), sum(map(len, some)), len(strokes), "whole letters", reach)


def _nearest(overlaps: dict[float, float]) -> float:
    """The factor nearest to 1 that is as good as the best; 1 where that is noticeably no better."""
    most = max(overlaps.values())
    if most <= overlaps[1.0] + WORTH:
        return 1.0
    return min((f for f in overlaps if overlaps[f] > most - ALIKE), key=lambda f: abs(np.log(f)))


def _evenly(units: list, count: int) -> list:
    return [units[k] for k in np.unique(np.linspace(0, len(units) - 1, count).round().astype(int))]


def _half_width(unit) -> float:
    return max(half for stroke in unit for _, half in stroke.half_width)


def advice(size: Size, scale: float | None = 1.0) -> str:
    """Return a sentence for people, "" where no size can be painted. scale: the value of --scale; None where the size
    is given in another way."""
    if not any(size.overlaps.values()):
        return ""
    sample = f"tried on {size.tried} of {size.strokes} strokes" if size.tried < size.strokes else "tried"
    if size.best == 1.0:
        return f"Size: none from {size.reach[0]:g} to {size.reach[1]:g} times this one is noticeably better ({sample})."
    flag = f"; --scale {size.best * scale:.4g}" if scale is not None else ""
    return (
        f"Size: the overlap of {size.what} would be about {size.overlaps[size.best]:.2f} at {size.best:g} times this "
        f"size, in place of {size.overlaps[1.0]:.2f} ({sample}{flag})."
    )


def _overlap_at(factor: float, units, brush, made) -> float:
    def area(unit):
        larger = [scaled(stroke, factor) for stroke in unit]
        try:
            marks, targets = made(larger)
        except Error:  # not to be painted at this size: all of it is missing
            marks, targets = [], larger
        return _core.common_area(marks, targets, brush)

    pool = ThreadPoolExecutor(os.cpu_count())
    try:
        found = list(pool.map(area, units))
    finally:
        pool.shutdown(cancel_futures=True)  # Ctrl-C waits for the strokes at hand, no longer
    together = sum(each.together_mm2 for each in found)
    return sum(each.common_mm2 for each in found) / together if together > 0 else 1.0


def scaled(stroke, factor: float):
    """The stroke so many times as large, widths too."""
    half_width = [(at, half * factor) for at, half in stroke.half_width]
    rings = [ring * factor for ring in stroke.wanted_mm]
    return stroke.replaced(middle_mm=stroke.middle_mm * factor, half_width=half_width, wanted_mm=rings)
