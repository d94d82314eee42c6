"""Test whether marks are displaced by their place on the sheet, with those that predict best so far."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .overlap_search import Search, Target, apply_to_moved, best_shift
from .sheet_field import SheetField, sheet_field

FIFTHS = 5
FEWEST = 30  # marks: of 15 real ones even the left-out ones gained by a field that further ones did not have


@dataclass(frozen=True, eq=False)
class FoundField:
    """field: None where it wins nothing, or marks are too few; won: overlap of marks that had no part in it, each fifth
    predicted from the others, and its standard error over marks; None where they are too few."""

    field: SheetField | None
    won: float | None = None
    error: float | None = None


def found_field(search: Search, x, targets: list[Target], order: np.ndarray) -> FoundField:
    """Of marks that the numbers x predict, which stay as they are; order: as in sheet_field()."""

    def placed(target: Target, picture) -> np.ndarray:
        return best_shift(picture, target.paint, 1 / target.px_per_mm, search.farthest_mm)[1]

    if len(targets) < FEWEST:
        return FoundField(None)
    places = np.array(apply_to_moved(search, x, targets, placed))
    part = np.arange(len(targets)) % FIFTHS
    displacement = np.zeros((len(targets), 2))
    for k in np.unique(part):
        taught = part != k
        displacement[~taught] = sheet_field(order[taught], places[taught]).at(order[~taught])
    won = search.overlaps(x, moved(targets, displacement))[:, 0] - search.overlaps(x, targets)[:, 0]
    field = sheet_field(order, places) if won.mean() > 0 else None
    return FoundField(field, float(won.mean()), float(won.std() / np.sqrt(len(won))))


def moved(targets: list[Target], displacements_mm: np.ndarray) -> list[Target]:
    return [
        replace(one, poses_mm=one.poses_mm + np.append(displacement, 0.0))
        for one, displacement in zip(targets, displacements_mm, strict=True)
    ]
