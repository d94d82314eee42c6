"""What photographs show of a job, stroke by stroke: overlap, displacement, width, what is missing or too much."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from ..calibration.chart.page import bar_rings, label_box
from ..errors import Error, Notice
from ..scan.edges import Room, paint_seen
from ..scan.flatten import Flat, flatten
from ..scan.markers import Printed, View, find_view
from ..scan.photo import read_photo
from .job_page import JobPage, box_ring
from .placing import NOWHERE, Canvas, Placed, place

AROUND_MM = 6.0  # round a predicted mark, where its paint is looked for
BESIDE_MM = 0.6  # beyond another mark its blurred edge still shows
BLOT_MM = 1.5  # beyond a mark, as it lies, what is no edge any more
FINEST_PX_PER_MM = 12.0
LEAST_OVERLAP = 0.3  # of paint with its prediction, where it lies: less is another job, or chance
PRINT_MM = 0.5  # round what is printed
COVERED = 0.15  # share of a mark that is painted at least, or it is not there


@dataclass(frozen=True)
class Wanted:
    """One stroke: rings on the sheet of what was wanted (None where only a plan is known), and predicted."""

    stroke: str
    wanted: list[np.ndarray] | None
    predicted: list[np.ndarray]


@dataclass(frozen=True)
class Compared:
    """A stroke as it was painted. overlap_wanted (None without a drawing), overlap_predicted: intersection over union;
    placed: against the prediction; missing, extra: shares of the predicted area, once the mark lies where it is."""

    stroke: str
    overlap_wanted: float | None
    overlap_predicted: float
    placed: Placed
    missing: float
    extra: float


@dataclass(frozen=True)
class Comparison:
    """common: how all marks together lie against their predictions. overlaps: of all paint with what was wanted (or,
    without a drawing, predicted) as it lies, once the sheet's place is put right, and once each stroke's is."""

    strokes: tuple[Compared, ...]
    common: Placed
    middle_mm: np.ndarray
    overlap_wanted: float | None
    overlap_predicted: float
    overlaps: tuple[float, float, float]
    view: View
    flat: Flat
    paint: np.ndarray
    canvas: Canvas
    notices: tuple[Notice, ...]


def compare_photos(page: JobPage, strokes: list[Wanted], photos: list[tuple[str, bytes]]) -> Comparison:
    """photos: names and what their files hold, of one painted sheet; their paint is averaged. Error in one sentence,
    with the file, where a photograph cannot be read or shows another job."""
    reads = []
    for name, data in photos:
        try:
            reads.append(_read(page, strokes, data, reads[0][0].px_per_mm if reads else None))
        except Error as refusal:
            raise _of_a_job(refusal, name) from None
    flat, view, _ = max(reads, key=lambda each: each[1].residual_mm)
    paint = np.mean([each[2] for each in reads], axis=0).astype(np.float32)
    sheet = (page.size_mm[0] - 2 * page.frame_mm, page.size_mm[1] - 2 * page.frame_mm)
    canvas = Canvas((0.0, 0.0, *sheet), flat.px_per_mm)
    painted, level = _on_sheet(paint, flat, page, canvas)
    if all(not stroke.predicted for stroke in strokes):
        raise Error("there is nothing to paint", code="nothing-to-paint")
    shown = [canvas.filled(stroke.predicted) for stroke in strokes]
    common, middle = _common(painted, strokes, canvas)
    return _compared(
        strokes, shown, painted, level, common, middle, canvas, (view, flat, paint), photos[0][0]
    )


def _of_a_job(refusal: Error, name: str) -> Error:
    sentence, advice = refusal.sentence, refusal.advice
    if refusal.code == "photo-of-another-chart":
        sentence = (
            "the picture shows the page of another job, or of another plan of this one: give the drawing with the "
            "flags that the page was made with, or the plan.json"
        )
    return Error(
        sentence, refusal.where, refusal.value, refusal.range, name, code=refusal.code, advice=advice
    )


def _read(
    page: JobPage, strokes: list[Wanted], data: bytes, fine: float | None
) -> tuple[Flat, View, np.ndarray]:
    printed = page.printed
    corners = {marker.id: np.array(marker.corners_mm) for marker in printed.markers}
    pixels = read_photo(data)
    view = find_view(pixels, Printed(page.size_mm, corners, printed.dictionary, printed.id))
    flat = flatten(pixels, view, page.size_mm, fine or min(view.px_per_mm, FINEST_PX_PER_MM))
    dark = [each.mean(axis=0) + (each - each.mean(axis=0)) * 1.4 for each in corners.values()]
    dark += bar_rings(printed.bar, beyond_mm=PRINT_MM)
    dark += [box_ring(*ring.min(axis=0) - PRINT_MM, *ring.max(axis=0) + PRINT_MM) for ring in page.ticks]
    dark += [box_ring(*label_box(label)) for label in printed.labels]
    print_ = np.zeros(flat.pixels.shape[:2], np.uint8)
    for ring in dark:
        cv2.fillPoly(print_, [np.round(flat.to_px(ring)).astype(np.int32)], 1)
    rooms = []
    for stroke in strokes:
        if stroke.predicted:
            points = np.vstack(stroke.predicted) + page.frame_mm
            rooms.append(Room(stroke.stroke, (*points.min(axis=0), *points.max(axis=0))))
    return flat, view, paint_seen(flat, print_, rooms)


def _on_sheet(paint, flat: Flat, page: JobPage, canvas: Canvas) -> tuple[np.ndarray, float]:
    """Paint of the sheet's own pixels, 1 where the usual paint lies, and the level of an edge."""
    left, up = page.frame_mm, page.size_mm[1] - page.frame_mm
    matrix = np.array(
        [[1.0, 0.0, left * flat.px_per_mm], [0.0, 1.0, (flat.sheet_mm[1] - up) * flat.px_per_mm]]
    )
    rows, columns = canvas.shape
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    sheet = cv2.warpAffine(paint, matrix, (columns, rows), flags=flags)
    usual = float(np.median(sheet[sheet > 0.5])) if (sheet > 0.5).any() else 1.0
    return np.clip(sheet / usual, 0, 1.2), 0.5


def _common(painted, strokes: list[Wanted], canvas: Canvas) -> tuple[Placed, np.ndarray]:
    rings = [ring for stroke in strokes for ring in stroke.predicted]
    middle = np.vstack(rings).mean(axis=0)
    coarse = min(canvas.px_per_mm, 5.0)
    small = Canvas(canvas.window_mm, coarse)
    rows, columns = small.shape
    less = cv2.resize(painted, (columns, rows), interpolation=cv2.INTER_AREA)
    found = place(less, np.ones_like(less), rings, small)
    return replace(found, wider_mm=0.0) if found.found else NOWHERE, middle


def _compared(strokes, shown, painted, level, common, middle, canvas, photo, name) -> Comparison:
    is_painted = painted > level
    every = np.sum([np.uint8(each > 0.5) for each in shown], axis=0)
    moved = [[common.moved(ring, middle) for ring in stroke.predicted] for stroke in strokes]
    rows, notices, own = [], [], []
    for stroke, rings in zip(strokes, moved, strict=True):
        others = [
            ring
            for other, theirs in zip(strokes, moved, strict=True)
            if other is not stroke
            for ring in theirs
        ]
        row, placed = _stroke(stroke, rings, others, painted, level, common, middle, canvas)
        rows.append(row)
        own.append(placed)
        if row is not None and not row.placed.found:
            sentence = "no paint is found where its mark should be, or it cannot be told from its neighbours"
            notices.append(Notice(stroke.stroke, sentence, code="mark-missing"))
    has_wanted = all(stroke.wanted is not None for stroke in strokes)
    target = [stroke.wanted if has_wanted else stroke.predicted for stroke in strokes]
    predicted = _overlap(every > 0, is_painted)
    whole = [ring for rings in target for ring in rings]
    as_it_lies = _overlap(_any(whole, canvas), is_painted)
    placed = _overlap(_any([common.moved(ring, middle) for ring in whole], canvas), is_painted)
    each = _overlap(
        _any([ring for rings, at in zip(target, own, strict=True) for ring in at(rings)], canvas), is_painted
    )
    view, flat, paint = photo
    best = max(predicted, _overlap(_any([ring for rings in moved for ring in rings], canvas), is_painted))
    if best < LEAST_OVERLAP:
        raise Error(
            f"the paint overlaps with what was predicted by {best:.2f}, less than {LEAST_OVERLAP:g}: is this the "
            "painted page of this job?",
            file=name,
            value=best,
            code="photo-of-another-job",
        )
    return Comparison(
        tuple(row for row in rows if row is not None),
        common,
        middle,
        as_it_lies if has_wanted else None,
        predicted,
        (as_it_lies, placed, each),
        view,
        flat,
        paint,
        canvas,
        tuple(notices),
    )


def _any(rings: list[np.ndarray], canvas: Canvas) -> np.ndarray:
    return canvas.filled(rings) > 0.5 if rings else np.zeros(canvas.shape, bool)


def _overlap(one: np.ndarray, other: np.ndarray) -> float:
    union = float((one | other).sum())
    return float((one & other).sum()) / union if union else 1.0


def _stroke(stroke: Wanted, rings, others, painted, level, common: Placed, middle, canvas: Canvas):
    """The figures of one stroke, and a function that puts rings of it where its mark lies."""
    if not rings:
        return None, lambda each: each
    points = np.vstack(rings)
    low = np.maximum(points.min(axis=0) - AROUND_MM, canvas.window_mm[:2])
    high = np.minimum(points.max(axis=0) + AROUND_MM, canvas.window_mm[2:])
    fine = canvas.px_per_mm
    c0, r0 = int(low[0] * fine), int((canvas.window_mm[3] - high[1]) * fine)
    c1, r1 = int(np.ceil(high[0] * fine)), int(np.ceil((canvas.window_mm[3] - low[1]) * fine))
    part = painted[r0:r1, c0:c1]
    window = (c0 / fine, canvas.window_mm[3] - r0 / fine - part.shape[0] / fine)
    small = Canvas((*window, window[0] + part.shape[1] / fine, window[1] + part.shape[0] / fine), fine)
    near = [ring for ring in others if (ring.max(axis=0) > low).all() and (ring.min(axis=0) < high).all()]
    theirs = small.filled(near)
    mine = small.filled(rings)
    away = _away(mine > 0.5, fine)
    their_away = _away(theirs > 0.5, fine)
    nearer = (away <= their_away) | (mine > 0.5)
    attributed = np.where(nearer, part, 0.0)
    free = (their_away > BESIDE_MM) & nearer
    found = place(attributed, free, rings, small)
    found = (
        found if found.found else place(attributed, free, rings, small, turns=False)
    )  # a dab has no direction
    inner = np.vstack(rings).mean(axis=0)
    is_there = float(((attributed > level) & (mine > 0.5)).sum()) > COVERED * float((mine > 0.5).sum())
    found = found if found.found and is_there else replace(NOWHERE, found=is_there and found.found)

    def lies(each):
        return [found.moved(common.moved(ring, middle), inner) for ring in each]

    is_mine = (attributed > level) & nearer
    at_last = small.filled(lies(stroke.predicted)) > 0.5
    area = float(max(at_last.sum(), 1))
    beyond = (_away(at_last, fine) > BLOT_MM) & is_mine
    wanted = None
    if stroke.wanted:
        wanted = _overlap(small.filled(stroke.wanted) > 0.5, is_mine)
    inside = small.filled(stroke.predicted) > 0.5
    start = np.vstack(stroke.predicted).mean(axis=0)
    shift = lies([start[None]])[0][0] - start
    whole = Placed(
        (float(shift[0]), float(shift[1])), common.turn_rad + found.turn_rad, found.wider_mm, found.found
    )
    missing = float((at_last & ~(part > level)).sum()) / area
    row = Compared(
        stroke.stroke, wanted, _overlap(inside, is_mine), whole, missing, float(beyond.sum()) / area
    )
    return row, lies


def _away(mask: np.ndarray, px_per_mm: float) -> np.ndarray:
    """mm from each pixel to the mask."""
    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    return cv2.distanceTransform(np.uint8(~mask), cv2.DIST_L2, 5) / px_per_mm
