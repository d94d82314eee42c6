"""What of a brush the largest overlap is to change, chosen by marks that had no part in it.

The more numbers a search may change, the more marks overlap with what it was fitted to; whether they predict others is
another matter. So the marks are parted, each part is predicted by what the others told, edges included, and the kind of
search is chosen with which the parts left out overlap most (cross-validation): half where they lie, half where each may
move, as in the search.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import Error
from .from_marks import ROUND_TAIL
from .machine_found import PARTS
from .overlap_search import KINDS, Begin, Led, Search, Target, each_kind, few_of, polished

HALVES = (
    30  # marks from which on two parts do; fewer are parted in three, so that each fit has enough of them
)
LEAST = 9  # marks; the edges of fewer, parted, leave laws open
EVERY = 20  # looks between two words on how far it is


@dataclass(frozen=True, eq=False)
class Predicting:
    """What overlaps most: laws as a fit of marks has them, height of the paper, displacement of all marks, what the
    machine does besides; the overlap by edges and now, and how many numbers were changed.

    kind: one of KINDS; parts: into how many the marks were parted to choose it, 0 where they are too few; left_out: of
    each kind the overlaps of marks left out, where they lie and where each may move.
    """

    laws: _core.MarkLaws
    height_mm: float
    shift_mm: np.ndarray
    led: Led
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
    """marks: in the frame of the targets, which they are; begin: what edges told of all of them. progress: is told how
    many overlaps were looked at."""
    looks = 0

    def look() -> None:
        nonlocal looks
        looks += 1
        if looks % EVERY == 0:
            progress(looks)

    parts, left_out = _left_out(marks, targets, begin.laws.round_tail, options, look)
    kind = max(left_out, key=lambda one: sum(left_out[one])) if left_out else None
    return largest_overlap(targets, begin, options, kind, look, parts, left_out)


def largest_overlap(
    targets: list[Target],
    begin: Begin,
    options: _core.MarkOptions,
    kind: str | None = None,
    look: Callable[[], None] = lambda: None,
    parts: int = 0,
    left_out: dict[str, tuple[float, float]] | None = None,
) -> Predicting:
    """By one kind of search; None: by the one that may change most."""
    search = Search(begin, options, targets)
    found, x = "edges", search.begin
    for found, x in each_kind(search, few_of(targets), look):  # noqa: B007
        if found == kind:
            break
    x = polished(search, found, x, targets, look)
    before, now = (search.overlaps(each, targets)[:, 0].mean() for each in (search.begin, x))
    return Predicting(
        *search.read(x), float(before), float(now), search.changed(found), found, parts, left_out or {}
    )


def _left_out(marks, targets, round_tail: bool, options, look) -> tuple[int, dict[str, tuple[float, float]]]:
    """In how many parts, and the overlaps of marks left out by kind."""
    parts = 2 if len(marks) >= HALVES else 3
    if len(marks) < LEAST:
        return 0, {}
    edges, part = _of_edges(options, round_tail), np.arange(len(marks)) % parts
    found: dict[str, list[np.ndarray]] = {}
    for k in range(parts):
        taught = [one for one, at in zip(targets, part, strict=True) if at != k]
        out = [one for one, at in zip(targets, part, strict=True) if at == k]
        try:
            of_others = [one for one, at in zip(marks, part, strict=True) if at != k]
            fit = _core.fit_marks(of_others, None, edges)
        except Error:
            return 0, {}
        search = Search(Begin(fit.laws, fit.height_mm, fit.shift_mm), options, taught)
        for kind, x in each_kind(search, few_of(taught), look):
            found.setdefault(kind, []).append(search.overlaps(x, out))
    means = {kind: np.vstack(found[kind]).mean(axis=0) for kind in KINDS if kind in found}
    return parts, {kind: (float(lying), float(moved)) for kind, (lying, moved) in means.items()}


def _of_edges(options: _core.MarkOptions, round_tail: bool) -> _core.MarkOptions:
    """For a part of the marks, whose ways are as the machine ran them and whose sheet is turned back."""
    edges = copy(options)
    for key, _ in PARTS.values():
        setattr(edges, key, 0.0)
    edges.turn_rad, edges.departing = 0.0, False
    if round_tail:
        edges.round_tail, edges.widest_per_half = True, _core.Prior(*ROUND_TAIL)
    return edges
