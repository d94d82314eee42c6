"""Advice on the size of a drawing, from trials of a few strokes at other sizes."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import Error

SCALES = (0.35, 0.5, 0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0, 2.8)
COARSE_SCALES = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8)  # tried first
# Strokes of a drawing that are tried, and those for a first look. They bound the time to half a second.
MAX_TRIED_STROKES, MAX_FIRST_STROKES = 16, 6
# A letter that is filled in several passes needs as long as twenty strokes. Larger letters need longer, and always
# fit better.
LETTER_SCALES, MAX_TRIED_LETTERS = (0.5, 0.7, 1.0, 1.4), 3
MIN_OVERLAP_GAIN = 0.01  # least gain of overlap for which another size is advised
# Sizes whose overlaps differ by less are equally good, and the one nearest to the drawing's size is advised.
MAX_EQUAL_DIFFERENCE = 0.005


@dataclass(frozen=True)
class SizeAdvice:
    """The overlaps of a drawing at other sizes.

    overlaps: by factor, of a few strokes; refused strokes count as painting nothing; best: the factor to be
    advised, 1 where none is noticeably better; tried: how many strokes were tried, of how many strokes; what: the
    kind of thing that was tried; reach: least and greatest factor that was tried.
    """

    overlaps: dict[float, float]
    best: float
    tried: int
    strokes: int
    what: str = "single strokes"
    reach: tuple[float, float] = (SCALES[0], SCALES[-1])


def find_best_size(strokes, brush, made, quick=None) -> SizeAdvice:
    """Try scales on strokes chosen evenly from all, each stroke alone.

    Letters and neighbours do not count. made: from strokes to (marks, strokes they should become), as the drawing
    is made; quick: the same with less effort, for a first look at fewer strokes, thin and wide ones. Only sizes
    that look better there are made in full.
    """
    units = [[stroke] for stroke in strokes]
    tried_units = _pick_evenly(units, MAX_TRIED_STROKES)
    first_units = _pick_evenly(sorted(tried_units, key=_half_width), MAX_FIRST_STROKES)
    first_overlaps = {factor: _overlap_at(factor, first_units, brush, quick or made) for factor in COARSE_SCALES}
    at = SCALES.index(max(first_overlaps, key=first_overlaps.get))
    for factor in SCALES[max(at - 1, 0) : at + 2]:
        if factor not in first_overlaps:
            first_overlaps[factor] = _overlap_at(factor, first_units, brush, quick or made)
    promising = {_choose_factor(first_overlaps), max(first_overlaps, key=first_overlaps.get)}
    if _choose_factor(first_overlaps) == 1.0:
        return SizeAdvice(first_overlaps, 1.0, len(first_units), len(strokes))
    overlaps = {factor: _overlap_at(factor, tried_units, brush, made) for factor in sorted({1.0, *promising})}
    return SizeAdvice(overlaps, _choose_factor(overlaps), len(tried_units), len(strokes))


def find_best_letter_size(strokes, brush, made) -> SizeAdvice:
    """Try fewer scales on whole letters, for shapes filled in passes.

    Letters are strokes that touch. Otherwise this works as find_best_size does.
    """
    groups = _core.group_touching(strokes)
    alone = set(range(len(strokes))).difference(*groups)
    letters = sorted([*groups, *([k] for k in alone)])
    tried_letters = [[strokes[k] for k in letter] for letter in _pick_evenly(letters, MAX_TRIED_LETTERS)]
    overlaps = {1.0: _overlap_at(1.0, tried_letters, brush, made)}
    if overlaps[1.0] + MIN_OVERLAP_GAIN < 1:  # otherwise no size can be noticeably better
        overlaps |= {
            factor: _overlap_at(factor, tried_letters, brush, made) for factor in LETTER_SCALES if factor != 1.0
        }
    reach = LETTER_SCALES[0], LETTER_SCALES[-1]
    return SizeAdvice(
        overlaps, _choose_factor(overlaps), sum(map(len, tried_letters)), len(strokes), "whole letters", reach
    )


def _choose_factor(overlaps: dict[float, float]) -> float:
    """Return the factor nearest to 1 that is as good as the best, 1 if the best is hardly better."""
    most = max(overlaps.values())
    if most <= overlaps[1.0] + MIN_OVERLAP_GAIN:
        return 1.0
    return min((f for f in overlaps if overlaps[f] > most - MAX_EQUAL_DIFFERENCE), key=lambda f: abs(np.log(f)))


def _pick_evenly(units: list, count: int) -> list:
    return [units[k] for k in np.unique(np.linspace(0, len(units) - 1, count).round().astype(int))]


def _half_width(unit) -> float:
    return max(half for stroke in unit for _, half in stroke.half_width)


def advise_on_size(size: SizeAdvice, scale: float | None = 1.0) -> str:
    """Return a sentence of advice, or "" where no size can be painted.

    scale: the value of --scale; None where the size is given in another way.
    """
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
        larger = [scale_stroke(stroke, factor) for stroke in unit]
        try:
            marks, targets = made(larger)
        except Error:  # the stroke cannot be painted at this size, so all of it is missing
            marks, targets = [], larger
        return _core.common_area(marks, targets, brush)

    pool = ThreadPoolExecutor(os.cpu_count())
    try:
        areas = list(pool.map(area, units))
    finally:
        # Ctrl-C waits only for the strokes that are being painted.
        pool.shutdown(cancel_futures=True)
    total_mm2 = sum(each.union_mm2 for each in areas)
    return sum(each.intersection_mm2 for each in areas) / total_mm2 if total_mm2 > 0 else 1.0


def scale_stroke(stroke, factor: float):
    """Return a stroke scaled by a factor, including its widths."""
    half_width = [(at, half * factor) for at, half in stroke.half_width]
    rings = [ring * factor for ring in stroke.target_mm]
    return stroke.replaced(middle_mm=stroke.middle_mm * factor, half_width=half_width, target_mm=rings)
