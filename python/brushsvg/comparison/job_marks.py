"""Outlines of the marks of a painted job, each of one stroke alone."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ..photo.edges import EDGE_MM, SEEN, outlines_of
from .job_page import JobPage
from .photographs import Comparison, TargetStroke
from .placing import Canvas

PART = 0.15  # of a mark: a piece of paint that holds so much of it is, or has part in, its paint
WITHIN = 0.5  # of a piece of paint that is in a mark: then it is of that one
DRY = 0.3  # share of a mark without paint, beyond which its edges are not the brush's
PAINT_A_CHART = "paint a chart, whose strokes do not touch: brushsvg chart, then calibrate --chart"


@dataclass(frozen=True)
class JobMarks:
    """rings: by the number of the stroke, in the frame of the sheet; touching, dry: numbers of those that were left
    out, since their paint is one with others', or much of it is missing or nowhere near."""

    rings: dict[int, list[np.ndarray]]
    touching: list[int]
    dry: list[int]


def job_marks(found: Comparison, page: JobPage, strokes: list[TargetStroke]) -> JobMarks:
    """strokes: those that were compared."""
    painting = [number for number, stroke in enumerate(strokes) if stroke.predicted]
    rows = dict(zip(painting, found.strokes, strict=True))
    dry = [number for number, row in rows.items() if not row.placed.found or row.missing > DRY]
    fine = found.flat.px_per_mm
    canvas = Canvas((0.0, 0.0, *page.size_mm), fine)
    count, part = cv2.connectedComponents(np.uint8(found.paint > SEEN), connectivity=8)
    sizes = np.bincount(part.ravel(), minlength=count)
    owners: list[list[int]] = [[] for _ in range(count)]
    for number, row in rows.items():
        middle = np.array(row.middle_mm)
        rings = [row.placed.moved(ring, middle) + page.frame_mm for ring in strokes[number].predicted]
        mark = canvas.filled(rings)[: part.shape[0], : part.shape[1]] > 0.5
        shared = np.bincount(part[: mark.shape[0], : mark.shape[1]][mark], minlength=count)
        has_part = (shared > PART * mark.sum()) | (shared > WITHIN * sizes)
        for each in np.flatnonzero(has_part[1:]) + 1:
            owners[each].append(number)
    together = {number for numbers in owners if len(numbers) > 1 for number in numbers}
    usual = float(np.median(found.paint[found.paint > SEEN]))
    rings = {}
    for number in painting:
        own = [each for each, numbers in enumerate(owners) if numbers == [number]]
        if number in together or number in dry or not own:
            continue
        rings[number] = [ring - page.frame_mm for ring in _rings(found, part, own, usual)]
    touching = sorted(together)
    left = set(painting) - set(rings) - together
    return JobMarks({k: v for k, v in rings.items() if v}, touching, sorted(left))


def _rings(found: Comparison, part, own: list[int], usual: float) -> list[np.ndarray]:
    fine = found.flat.px_per_mm
    mine = np.isin(part, own)
    rows, columns = (np.flatnonzero(mine.any(axis=axis)) for axis in (1, 0))
    margin = int(np.ceil(EDGE_MM * fine)) + 2
    top, left = max(rows[0] - margin, 0), max(columns[0] - margin, 0)
    window = slice(top, rows[-1] + margin + 1), slice(left, columns[-1] + margin + 1)
    foreign = (part[window] > 0) & ~mine[window]
    corner = left / fine, found.flat.sheet_mm[1] - top / fine
    return outlines_of(found.paint[window], mine[window], foreign, usual, fine, corner)
