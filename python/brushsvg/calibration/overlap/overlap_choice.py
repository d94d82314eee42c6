"""Choose which numbers of a brush the largest overlap is to change, by marks that had no part in it.

The more numbers a search may change, the more marks overlap with what it was fitted to; whether they predict others is
another matter. So the marks are parted, each part is predicted by the others, edges included, and the kind of
search is chosen with which the parts left out overlap most (cross-validation): half at their places, half where each
may move, as in the search.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from ... import _core
from ...errors import Error
from ..marks.from_marks import ROUND_TAIL
from ..marks.machine_found import PARTS
from .overlap_search import (
    Begin,
    MachineOffsets,
    Search,
    Target,
    best_from,
    each_kind,
    few_of,
    middle_of,
    polished,
)

HALVES = 30  # marks from which on two parts do; fewer are parted in three: each fit needs enough of them
LEAST = 9  # marks; the edges of fewer, parted, leave laws open
EVERY = 20  # looks between two words on how far it is


@dataclass(frozen=True, eq=False)
class Predicting:
    """What overlaps most: laws as a fit of marks has them, height of the paper, displacement of all marks, what the
    machine does in addition; the overlap by edges and now, and how many numbers were changed.

    kind: one of KINDS; parts: into how many the marks were parted to choose it, 0 where they are too few; left_out: of
    each kind the overlaps of marks left out, at their places and where each may move.
    """

    laws: _core.MarkLaws
    height_mm: float
    shift_mm: np.ndarray
    offsets: MachineOffsets
    before: float
    overlap: float
    numbers: int
    kind: str
    parts: int
    left_out: dict[str, tuple[float, float]]


def best_predicting(
    marks: list[_core.PaintedMark],
    targets: list[Target],
    begin: Begin,
    options: _core.MarkOptions,
    progress: Callable[[int], object] = lambda looks: None,
) -> Predicting:
    """marks: in the frame of the targets, which they are; begin: the fit of all of them by edges. progress: receives
    how many overlaps were looked at."""
    looks = 0

    def look() -> None:
        nonlocal looks
        looks += 1
        if looks % EVERY == 0:
            progress(looks)

    tried = _tried(marks, targets, begin.laws.round_tail, options, look)
    if not tried:
        return largest_overlap(targets, begin, options, look)
    left_out = {kind: np.vstack([one.overlaps for one in tried[kind]]).mean(axis=0) for kind in tried}
    kind = max(left_out, key=lambda one: left_out[one].sum())
    search = Search(begin, options, targets, middle_of(targets))
    starts = [one.x for one in tried[kind] if len(one.x) == len(search.begin)]
    if starts:
        x = best_from(search, kind, starts, few_of(targets), look)
    else:  # fewer marks determine fewer numbers of a law
        kind, x = _searched(search, targets, look, kind)
    found = _predicting(search, kind, x, targets, look)
    means = {one: (float(in_place), float(moved)) for one, (in_place, moved) in left_out.items()}
    return replace(found, parts=len(tried["edges"]), left_out=means)


def largest_overlap(
    targets: list[Target],
    begin: Begin,
    options: _core.MarkOptions,
    look: Callable[[], None] = lambda: None,
) -> Predicting:
    """By the kind of search that may change most."""
    search = Search(begin, options, targets, middle_of(targets))
    return _predicting(search, *_searched(search, targets, look), targets, look)


def _searched(search: Search, targets: list[Target], look, last: str | None = None) -> tuple[str, np.ndarray]:
    """The kind of search that may change most, or this one, and what it ends with on few marks."""
    kind, x = "edges", search.begin
    for kind, x in each_kind(search, few_of(targets), look):  # noqa: B007
        if kind == last:
            break
    return kind, x


def _predicting(search: Search, kind: str, x, targets: list[Target], look) -> Predicting:
    x = polished(search, kind, x, targets, look)
    before, now = (float(search.overlaps(each, targets)[:, 0].mean()) for each in (search.begin, x))
    return Predicting(*search.read(x), before, now, search.changed(kind), kind, 0, {})


@dataclass(frozen=True, eq=False)
class _Tried:
    """What a search without a part of the marks ended with, and how the marks of that part overlap with it (n, 2)."""

    x: np.ndarray
    overlaps: np.ndarray


def _tried(marks, targets: list[Target], round_tail: bool, options, look) -> dict[str, list[_Tried]]:
    """Each kind of search without each part of the marks; empty where they are too few."""
    parts = 2 if len(marks) >= HALVES else 3
    if len(marks) < LEAST:
        return {}
    edges, part, middle = _of_edges(options, round_tail), np.arange(len(marks)) % parts, middle_of(targets)
    found: dict[str, list[_Tried]] = {}
    for k in range(parts):
        taught = [one for one, at in zip(targets, part, strict=True) if at != k]
        out = [one for one, at in zip(targets, part, strict=True) if at == k]
        try:
            of_others = [one for one, at in zip(marks, part, strict=True) if at != k]
            fit = _core.fit_marks(of_others, None, edges)
        except Error:
            return {}
        search = Search(Begin(fit.laws, fit.height_mm, fit.shift_mm), options, taught, middle)
        for kind, x in each_kind(search, few_of(taught), look):
            found.setdefault(kind, []).append(_Tried(x, search.overlaps(x, out)))
    return {kind: each for kind, each in found.items() if len(each) == parts}


def _of_edges(options: _core.MarkOptions, round_tail: bool) -> _core.MarkOptions:
    """For a part of the marks, whose ways are as the machine ran them and whose sheet is turned back."""
    edges = copy(options)
    for key, _ in PARTS.values():
        setattr(edges, key, 0.0)
    edges.turn_rad, edges.departing = 0.0, False
    if round_tail:
        edges.round_tail, edges.widest_per_half = True, _core.Prior(*ROUND_TAIL)
    return edges
