"""Find the outlines of marks whose paint is separate from other paint."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ..photo.edges import EDGE_MM, SEEN, outlines_of
from .job_page import JobPage
from .photographs import Comparison, TargetStroke
from .placing import Canvas

# Share of a mark that a piece of paint covers, above which the piece belongs to the mark.
MIN_COVERED_SHARE = 0.15
MIN_INSIDE_SHARE = 0.5  # share of a piece of paint inside a mark, above which the piece belongs to the mark
MAX_MISSING_FOR_OUTLINE = 0.3  # share of a mark without paint, above which its edges are not those of the brush
PAINT_A_CHART = "paint a chart, where strokes do not touch: brushsvg chart, then calibrate --chart"


@dataclass(frozen=True)
class JobMarks:
    """Outlines of the marks of strokes, and the strokes that were left out.

    rings: rings of each stroke by its number, in the frame of the sheet [mm]; touching: numbers of strokes whose paint
    is connected with that of others; dry: numbers of strokes that lack much of their paint or were not found.
    """

    rings: dict[int, list[np.ndarray]]
    touching: list[int]
    dry: list[int]


def job_marks(found: Comparison, page: JobPage, strokes: list[TargetStroke]) -> JobMarks:
    """Find the outlines of the marks. strokes: the strokes that were compared."""
    painting = [number for number, stroke in enumerate(strokes) if stroke.predicted]
    rows = dict(zip(painting, found.strokes, strict=True))
    dry = [number for number, row in rows.items() if not row.placed.found or row.missing > MAX_MISSING_FOR_OUTLINE]
    fine = found.flat.px_per_mm
    canvas = Canvas((0.0, 0.0, *page.size_mm), fine)
    count, pieces = cv2.connectedComponents(np.uint8(found.paint > SEEN), connectivity=8)
    sizes = np.bincount(pieces.ravel(), minlength=count)
    owners: list[list[int]] = [[] for _ in range(count)]
    for number, row in rows.items():
        middle = np.array(row.middle_mm)
        rings = [row.placed.moved(ring, middle) + page.frame_mm for ring in strokes[number].predicted]
        mark = canvas.filled(rings)[: pieces.shape[0], : pieces.shape[1]] > 0.5
        shared = np.bincount(pieces[: mark.shape[0], : mark.shape[1]][mark], minlength=count)
        has_part = (shared > MIN_COVERED_SHARE * mark.sum()) | (shared > MIN_INSIDE_SHARE * sizes)
        for each in np.flatnonzero(has_part[1:]) + 1:
            owners[each].append(number)
    connected = {number for numbers in owners if len(numbers) > 1 for number in numbers}
    usual = float(np.median(found.paint[found.paint > SEEN]))
    rings = {}
    for number in painting:
        own = [each for each, numbers in enumerate(owners) if numbers == [number]]
        if number in connected or number in dry or not own:
            continue
        rings[number] = [ring - page.frame_mm for ring in _outline_rings(found, pieces, own, usual)]
    touching = sorted(connected)
    left_out = set(painting) - set(rings) - connected
    return JobMarks({k: v for k, v in rings.items() if v}, touching, sorted(left_out))


def _outline_rings(found: Comparison, part, own: list[int], usual: float) -> list[np.ndarray]:
    fine = found.flat.px_per_mm
    mine = np.isin(part, own)
    rows, columns = (np.flatnonzero(mine.any(axis=axis)) for axis in (1, 0))
    margin = int(np.ceil(EDGE_MM * fine)) + 2
    top, left = max(rows[0] - margin, 0), max(columns[0] - margin, 0)
    window = slice(top, rows[-1] + margin + 1), slice(left, columns[-1] + margin + 1)
    foreign = (part[window] > 0) & ~mine[window]
    corner = left / fine, found.flat.sheet_mm[1] - top / fine
    return outlines_of(found.paint[window], mine[window], foreign, usual, fine, corner)
