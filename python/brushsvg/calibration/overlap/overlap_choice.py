"""Choose by cross-validation which numbers of a brush the overlap search changes.

The more numbers a search may change, the more its result overlaps with the marks to which it was fitted. It may not
predict other marks better. The marks are therefore divided into parts, and each part is predicted by the others,
including the fit by edges. The kind of search with the largest overlap of the left-out parts wins. As in the search,
half of the score is the overlap in place, and half is the overlap if each mark may move.
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
    MachineOffsets,
    Search,
    SearchStart,
    Target,
    choose_subset,
    find_best_vector,
    mean_place,
    refine_with_all,
    search_each_kind,
)

# From this number of marks on, two parts are enough. Fewer marks are divided into three, so that each fit has enough.
MIN_MARKS_FOR_TWO_PARTS = 30
MIN_MARKS = 9  # least number of marks; with fewer, the edges of the parts do not determine the laws
PROGRESS_INTERVAL = 20  # evaluations between two reports of the progress


@dataclass(frozen=True, eq=False)
class BestPrediction:
    """The brush with the largest overlap.

    laws: in the form of a fit of marks. height_mm: of the paper. shift_mm: displacement of all marks. offsets:
    additional errors of the machine. before, overlap: mean overlap by edges, and now. numbers: how many numbers were
    changed. kind: one of KINDS. parts: number of parts for the choice of the kind, 0 if there are too few marks.
    left_out: for each kind, the overlaps of the marks that were left out, in place and if each may move.
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


def find_best_prediction(
    marks: list[_core.PaintedMark],
    targets: list[Target],
    begin: SearchStart,
    options: _core.MarkOptions,
    progress: Callable[[int], object] = lambda evaluations: None,
) -> BestPrediction:
    """Find the brush that predicts further marks best.

    marks: the marks of the targets, in the same frame. begin: the fit of all marks by edges. progress: receives the
    number of evaluated overlaps.
    """
    evaluations = 0

    def count_evaluation() -> None:
        nonlocal evaluations
        evaluations += 1
        if evaluations % PROGRESS_INTERVAL == 0:
            progress(evaluations)

    results = _search_without_parts(marks, targets, begin.laws.round_tail, options, count_evaluation)
    if not results:
        return largest_overlap(targets, begin, options, count_evaluation)
    left_out = {kind: np.vstack([result.overlaps for result in results[kind]]).mean(axis=0) for kind in results}
    kind = max(left_out, key=lambda name: left_out[name].sum())
    search = Search(begin, options, targets, mean_place(targets))
    starts = [result.x for result in results[kind] if len(result.x) == len(search.begin)]
    if starts:
        x = find_best_vector(search, kind, starts, choose_subset(targets), count_evaluation)
    else:  # the parts have fewer marks, which determine fewer numbers of a law
        kind, x = _search_subset(search, targets, count_evaluation, kind)
    best = _finish_search(search, kind, x, targets, count_evaluation)
    means = {name: (float(in_place), float(moved)) for name, (in_place, moved) in left_out.items()}
    return replace(best, parts=len(results["edges"]), left_out=means)


def largest_overlap(
    targets: list[Target],
    begin: SearchStart,
    options: _core.MarkOptions,
    count_evaluation: Callable[[], None] = lambda: None,
) -> BestPrediction:
    """Find the largest overlap with the least restricted kind of search."""
    search = Search(begin, options, targets, mean_place(targets))
    return _finish_search(search, *_search_subset(search, targets, count_evaluation), targets, count_evaluation)


def _search_subset(
    search: Search, targets: list[Target], count_evaluation, last: str | None = None
) -> tuple[str, np.ndarray]:
    """Search with a subset of the marks up to the kind `last`, and return the last kind and its vector."""
    kind, x = "edges", search.begin
    for kind, x in search_each_kind(search, choose_subset(targets), count_evaluation):  # noqa: B007
        if kind == last:
            break
    return kind, x


def _finish_search(search: Search, kind: str, x, targets: list[Target], count_evaluation) -> BestPrediction:
    x = refine_with_all(search, kind, x, targets, count_evaluation)
    before, now = (float(search.overlaps(vector, targets)[:, 0].mean()) for vector in (search.begin, x))
    return BestPrediction(*search.read(x), before, now, search.count_changed(kind), kind, 0, {})


@dataclass(frozen=True, eq=False)
class _PartResult:
    """The result of a search without a part of the marks.

    overlaps: the overlaps (n, 2) of that part with the result.
    """

    x: np.ndarray
    overlaps: np.ndarray


def _search_without_parts(
    marks, targets: list[Target], round_tail: bool, options, count_evaluation
) -> dict[str, list[_PartResult]]:
    """Run each kind of search without each part of the marks, {} if there are too few marks."""
    parts = 2 if len(marks) >= MIN_MARKS_FOR_TWO_PARTS else 3
    if len(marks) < MIN_MARKS:
        return {}
    edges = _edge_options(options, round_tail)
    part = np.arange(len(marks)) % parts
    middle = mean_place(targets)
    by_kind: dict[str, list[_PartResult]] = {}
    for k in range(parts):
        kept_targets = [item for item, at in zip(targets, part, strict=True) if at != k]
        left_out_targets = [item for item, at in zip(targets, part, strict=True) if at == k]
        try:
            kept_marks = [item for item, at in zip(marks, part, strict=True) if at != k]
            fit = _core.fit_marks(kept_marks, None, edges)
        except Error:
            return {}
        search = Search(SearchStart(fit.laws, fit.height_mm, fit.shift_mm), options, kept_targets, middle)
        for kind, x in search_each_kind(search, choose_subset(kept_targets), count_evaluation):
            by_kind.setdefault(kind, []).append(_PartResult(x, search.overlaps(x, left_out_targets)))
    return {kind: results for kind, results in by_kind.items() if len(results) == parts}


def _edge_options(options: _core.MarkOptions, round_tail: bool) -> _core.MarkOptions:
    """Return the options for a fit by edges of a part of the marks.

    The paths of these marks already include the errors of the machine, and the turn of the sheet is already undone.
    """
    edges = copy(options)
    for key, _ in PARTS.values():
        setattr(edges, key, 0.0)
    edges.turn_rad, edges.departing = 0.0, False
    if round_tail:
        edges.round_tail, edges.widest_per_half = True, _core.Prior(*ROUND_TAIL)
    return edges
