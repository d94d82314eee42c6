"""Compare photographs of a painted job with its target and prediction.

For each stroke, it measures overlap, displacement, width and missing paint. It also finds paint outside of all marks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import chain

import cv2
import numpy as np

from ..calibration.chart.page import bar_rings, label_box
from ..errors import Error, Notice
from ..geometry.rings import centroid
from ..photo.edges import paint_seen, printed_pixels
from ..photo.flatten import Flat, flatten
from ..photo.markers import Printed, View, find_view
from ..photo.photo import read_photo, refuse_twice
from ..photo.photo_checks import refuse_cropped, refuse_unsure
from ..photo.stroke_boxes import StrokeBox
from .corrections import MIN_MARKS
from .job_page import JobPage, box_ring
from .placing import NOWHERE, Canvas, Placed, grow_rings, locate_mark

SEARCH_MARGIN_MM = 6.0  # distance around a predicted mark within which its paint is searched
EDGE_BLUR_MM = 0.6  # distance from another mark within which its blurred edge still shows
MAX_EDGE_DISTANCE_MM = 1.5  # distance from a located mark beyond which paint is not part of its edge
MAX_PX_PER_MM = 12.0
MIN_OVERLAP = 0.3  # overlap of paint with its prediction, at its place: less is another job, or chance
PRINT_MARGIN_MM = 0.5  # margin around printed lines
# Smallest painted share of a located mark; share without paint above which a mark is missing.
MIN_PAINTED_SHARE, MISSING_MARK_SHARE = 0.3, 0.7
EDGE_LEVEL = 0.5  # share of the usual paint at which paint has its edge
# Share of a mark without paint, beyond the share of most marks. Above it, a mark's middle is that of its painted part.
MAX_EXCESS_MISSING_SHARE = 0.1
MIN_THING_AREA_MM2 = 100.0  # area of one piece of paint outside of all marks: a hand, a tool or a large blot
PALEST_PAINT_SHARE = 0.15  # share of the usual paint that the palest stroke has
MIN_SAME_SHEET_OVERLAP = 0.9  # smallest overlap of the paint in two photographs of one sheet


@dataclass(frozen=True)
class TargetStroke:
    """One stroke with its target and its predicted mark.

    Both are rings (n, 2) on the sheet [mm]. The target is None where only a plan is known. is_drawn: whether the stroke
    is part of the drawing; strokes in the margin count in no figure of the sheet.
    """

    stroke: str
    target: list[np.ndarray] | None
    predicted: list[np.ndarray]
    is_drawn: bool = True


@dataclass(frozen=True)
class Compared:
    """A stroke as it was painted.

    overlap_target (None without a drawing), overlap_predicted: intersection over union; placed: place relative to the
    prediction, whose middle is at middle_mm; missing: share of the located mark without paint; like: overlap of the
    mark, at its place and width, with its paint.
    """

    stroke: str
    overlap_target: float | None
    overlap_predicted: float
    placed: Placed
    middle_mm: tuple[float, float]
    missing: float
    like: float


@dataclass(frozen=True)
class Comparison:
    """Result of the comparison of a painted sheet with its job.

    common: pose of the sheet about middle_mm, from the places of all marks; spread_mm: rms of the displacements beyond
    this pose, None for fewer than three marks; elsewhere_mm2: area of paint outside of all marks. overlaps: overlap of
    all paint with the target (without a drawing: with the prediction), as painted, with the sheet's place corrected,
    and with the place of each stroke corrected. paint: share of paint on the page; painted: share of paint on the
    sheet, by the pixels of canvas. has_things: something on the sheet is not a mark.
    """

    strokes: tuple[Compared, ...]
    common: Placed
    middle_mm: np.ndarray
    spread_mm: float | None
    elsewhere_mm2: float
    overlap_target: float | None
    overlap_predicted: float
    overlaps: tuple[float, float, float]
    painted: np.ndarray
    canvas: Canvas
    notices: tuple[Notice, ...]
    has_things: bool = False
    view: View | None = None
    flat: Flat | None = None
    paint: np.ndarray | None = None


def compare_photos(page: JobPage, strokes: list[TargetStroke], photos: list[tuple[str, bytes]]) -> Comparison:
    """Compare photographs of one painted sheet with its job; their paint is averaged.

    photos: names and contents of the files. Raises Error with the file where a photograph cannot be read, is given
    twice or shows another job.
    """
    refuse_twice(photos)
    reads = []
    for name, data in photos:
        try:
            reads.append(_read_photo(page, strokes, data, reads[0][0].px_per_mm if reads else None))
        except Error as refusal:
            raise _as_job_error(refusal, name) from None
    flat, view, _ = max(reads, key=lambda each: each[1].residual_mm)
    paint = np.mean([each[2] for each in reads], axis=0).astype(np.float32)
    sheet = (page.size_mm[0] - 2 * page.frame_mm, page.size_mm[1] - 2 * page.frame_mm)
    canvas = Canvas((0.0, 0.0, *sheet), flat.px_per_mm)
    painted = [_sheet_paint(each, flat, page, canvas) for _, _, each in reads]
    _refuse_other_sheets(painted, photos)
    mean = np.mean(painted, axis=0).astype(np.float32)
    return replace(compare_paint(strokes, mean, canvas, photos[0][0]), view=view, flat=flat, paint=paint)


def select_drawn_strokes(found: Comparison, strokes: list[TargetStroke]) -> tuple[Comparison, list[TargetStroke]]:
    """Return the comparison and the strokes without strokes in the margin."""
    drawn = [stroke for stroke in strokes if stroke.is_drawn]
    names = {stroke.stroke for stroke in drawn}
    return replace(found, strokes=tuple(row for row in found.strokes if row.stroke in names)), drawn


def compare_sheets(page: JobPage, strokes: list[TargetStroke], photos: list[tuple[str, bytes]]) -> list[Comparison]:
    """Compare photographs that each show another sheet. Raises the errors of `compare_photos`."""
    refuse_twice(photos)
    return [compare_photos(page, strokes, [photo]) for photo in photos]


def compare_paint(strokes: list[TargetStroke], painted: np.ndarray, canvas: Canvas, name: str) -> Comparison:
    """Compare paint from any source with a job.

    The result has no view, flat or paint. painted: for each pixel of the canvas, the share of the usual paint; name:
    name of the picture, for errors. Raises Error for paint that cannot be of this job.
    """
    if all(not stroke.predicted for stroke in strokes):
        raise Error("there is nothing to paint", code="nothing-to-paint")
    common, middle = _locate_sheet(painted, strokes, canvas)
    return _compare(strokes, painted, common, middle, canvas, name)


def _refuse_other_sheets(painted: list[np.ndarray], photos: list[tuple[str, bytes]]) -> None:
    for (name, _), each in zip(photos[1:], painted[1:], strict=True):
        overlap = overlap_of_masks(painted[0] > EDGE_LEVEL, each > EDGE_LEVEL)
        if overlap < MIN_SAME_SHEET_OVERLAP:
            sentence = (
                f"its paint overlaps with the paint in {photos[0][0]} by only {overlap:.2f}, less than "
                f"{MIN_SAME_SHEET_OVERLAP:g}: pass only photographs of one sheet, and use one command for each sheet"
            )
            raise Error(sentence, file=name, value=overlap, code="photos-differ")


def _as_job_error(refusal: Error, name: str) -> Error:
    sentence, advice = refusal.sentence, refusal.advice
    if refusal.code == "photo-of-another-chart":
        sentence = "the picture shows the page of another job, or of another plan of this job"
        advice = "give the drawing with the flags that the page was made with, or the plan.json"
    return Error(sentence, refusal.where, refusal.value, refusal.range, name, code=refusal.code, advice=advice)


def _read_photo(
    page: JobPage, strokes: list[TargetStroke], data: bytes, fine: float | None
) -> tuple[Flat, View, np.ndarray]:
    printed = page.printed
    corners = {marker.id: np.array(marker.corners_mm) for marker in printed.markers}
    pixels = read_photo(data)
    view = find_view(pixels, Printed(page.size_mm, corners, printed.dictionary, printed.id))
    stroke_boxes = []
    for stroke in strokes:
        if stroke.predicted:
            points = np.vstack(stroke.predicted) + page.frame_mm
            stroke_boxes.append(StrokeBox(stroke.stroke, (*points.min(axis=0), *points.max(axis=0))))
    refuse_cropped(pixels, view, stroke_boxes)
    refuse_unsure(pixels, view, corners)
    flat = flatten(pixels, view, page.size_mm, fine or min(view.px_per_mm, MAX_PX_PER_MM))
    printed_rings = [each.mean(axis=0) + (each - each.mean(axis=0)) * 1.4 for each in corners.values()]
    printed_rings += bar_rings(printed.bar, beyond_mm=PRINT_MARGIN_MM)
    printed_rings += [
        box_ring(*ring.min(axis=0) - PRINT_MARGIN_MM, *ring.max(axis=0) + PRINT_MARGIN_MM) for ring in page.ticks
    ]
    printed_rings += [box_ring(*label_box(label)) for label in printed.labels]
    return flat, view, paint_seen(flat, printed_pixels(flat, printed_rings), stroke_boxes)


def _sheet_paint(paint, flat: Flat, page: JobPage, canvas: Canvas) -> np.ndarray:
    """Return the paint of the sheet's own pixels, 1 for the usual paint."""
    left, up = page.frame_mm, page.size_mm[1] - page.frame_mm
    matrix = np.array([[1.0, 0.0, left * flat.px_per_mm], [0.0, 1.0, (flat.sheet_mm[1] - up) * flat.px_per_mm]])
    rows, columns = canvas.shape
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    sheet = cv2.warpAffine(paint, matrix, (columns, rows), flags=flags)
    usual = float(np.median(sheet[sheet > 0.5])) if (sheet > 0.5).any() else 1.0
    return np.clip(sheet / usual, 0, 1.2)


def _locate_sheet(painted, strokes: list[TargetStroke], canvas: Canvas) -> tuple[Placed, np.ndarray]:
    rings = [ring for stroke in strokes for ring in stroke.predicted]
    middle = centroid(rings)
    coarse = min(canvas.px_per_mm, 5.0)
    small = Canvas(canvas.window_mm, coarse)
    rows, columns = small.shape
    less = cv2.resize(painted, (columns, rows), interpolation=cv2.INTER_AREA)
    found = locate_mark(less, np.ones_like(less), rings, small)
    return replace(found, wider_mm=0.0) if found.found else NOWHERE, middle


@dataclass(frozen=True)
class _LocatedStroke:
    """A stroke that paints, with its figures.

    locate: moves rings to the place of its mark.
    """

    stroke: TargetStroke
    row: Compared
    locate: Callable[[list[np.ndarray]], list[np.ndarray]]


def _compare(strokes, painted, common, middle, canvas, name) -> Comparison:
    """Compute the comparison; all strokes have rows, but only those of the drawing count for the sheet."""
    moved = [[common.moved(ring, middle) for ring in stroke.predicted] for stroke in strokes]
    is_painted = painted > EDGE_LEVEL
    located = []
    for k, stroke in enumerate(strokes):
        if stroke.predicted:
            others = [*chain(*moved[:k], *moved[k + 1 :])]
            located.append(_locate_stroke(stroke, moved[k], others, painted, is_painted, common, middle, canvas))
    found = located
    if not all(stroke.is_drawn for stroke in strokes):
        drawn, others = (
            [rings for rings, stroke in zip(moved, strokes, strict=True) if stroke.is_drawn == is_drawn]
            for is_drawn in (True, False)
        )
        away, away_from_others = (
            _distance_mm(_mask([*chain(*each)], canvas), canvas.px_per_mm) for each in (drawn, others)
        )
        is_painted, painted = (np.where(away <= away_from_others, each, 0) for each in (is_painted, painted))
        is_painted = is_painted.astype(bool)
        moved, found = drawn, [stroke_found for stroke_found in located if stroke_found.stroke.is_drawn]
        strokes = [stroke for stroke in strokes if stroke.is_drawn]
    predicted = overlap_of_masks(_mask([*chain(*(stroke.predicted for stroke in strokes))], canvas), is_painted)
    _refuse_other_job(max(predicted, overlap_of_masks(_mask([*chain(*moved)], canvas), is_painted)), name)
    sheet, spread_mm = _fit_sheet_pose([stroke_found.row for stroke_found in found], common, middle)
    has_target = all(stroke.target is not None for stroke in strokes)
    target_rings = [*chain(*(stroke.target if has_target else stroke.predicted for stroke in strokes))]
    each = [
        stroke_found.locate(stroke_found.stroke.target if has_target else stroke_found.stroke.predicted)
        for stroke_found in found
    ]
    as_painted, placed, each_placed = (
        overlap_of_masks(_mask(rings, canvas), is_painted)
        for rings in (target_rings, [sheet.moved(ring, middle) for ring in target_rings], [*chain(*each)])
    )
    marks = _mask([*chain(*(stroke_found.locate(stroke_found.stroke.predicted) for stroke_found in found))], canvas)
    astray = is_painted & (_distance_mm(marks, canvas.px_per_mm) > MAX_EDGE_DISTANCE_MM)
    things = _find_things(astray, canvas)
    near = _distance_mm(things, canvas.px_per_mm) < MAX_EDGE_DISTANCE_MM + EDGE_BLUR_MM
    return Comparison(
        tuple(_unless_covered(stroke_found, near, canvas) for stroke_found in located),
        sheet,
        middle,
        spread_mm,
        float(astray.sum()) / canvas.px_per_mm**2,
        as_painted if has_target else None,
        predicted,
        (as_painted, placed, each_placed),
        painted,
        canvas,
        (*_missing_mark_notices(found), *_thing_notices(things, canvas)),
        bool(things.any()),
    )


def _refuse_other_job(overlap: float, name: str) -> None:
    if overlap < MIN_OVERLAP:
        sentence = (
            f"the paint overlaps with the prediction by only {overlap:.2f}, less than {MIN_OVERLAP:g}: check that "
            "this is the painted page of this job"
        )
        raise Error(sentence, file=name, value=overlap, code="photo-of-another-job")


def _missing_mark_notices(found: list[_LocatedStroke]) -> list[Notice]:
    rows = [seen.row for seen in found if not seen.row.placed.found and seen.row.missing > MISSING_MARK_SHARE]
    sentence = "no paint was found where the mark of this stroke should be"
    return [Notice(row.stroke, sentence, code="mark-missing") for row in rows]


def _thing_notices(things: np.ndarray, canvas: Canvas) -> list[Notice]:
    if not things.any():
        return []
    sentence = (
        f"a hand, a tool or a blot covers {things.sum() / canvas.px_per_mm**2:.0f} mm^2 of the sheet: strokes under "
        "or near it are not reported, and causes of errors are not estimated. Photograph the sheet without it"
    )
    return [Notice("sheet", sentence, code="photo-covered")]


def subtract_displacements(found: Comparison, done: dict[str, Placed]) -> Comparison:
    """Return the comparison without known displacements of marks.

    done: displacements by stroke. A mark whose displacement is unknown counts as not found.
    """
    rows = tuple(_subtract_displacement(row, done.get(row.stroke, NOWHERE)) for row in found.strokes)
    sheet, spread_mm = _fit_sheet_pose(list(rows), found.common, found.middle_mm)
    return replace(found, strokes=rows, common=sheet, spread_mm=spread_mm)


def _subtract_displacement(row: Compared, done: Placed) -> Compared:
    seen = row.placed
    if not (seen.found and done.found):
        return replace(row, placed=NOWHERE)
    x, y = np.subtract(seen.shift_mm, done.shift_mm).tolist()
    left = Placed((x, y), seen.turn_rad - done.turn_rad, seen.wider_mm - done.wider_mm, True)
    return replace(row, placed=left)


def _find_things(astray: np.ndarray, canvas: Canvas) -> np.ndarray:
    """Return a mask of pieces of paint outside of all marks that are too large for stray paint."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(np.uint8(astray), connectivity=8)
    large = stats[:, cv2.CC_STAT_AREA] > MIN_THING_AREA_MM2 * canvas.px_per_mm**2
    large[0] = False
    return large[labels]


def _unless_covered(seen: _LocatedStroke, near: np.ndarray, canvas: Canvas) -> Compared:
    """Return the figures of a stroke, as not found if a thing covers its mark.

    A thing near the mark counts as covering it.
    """
    covered = near.any() and (_mask(seen.locate(seen.stroke.predicted), canvas) & near).any()
    return replace(seen.row, placed=NOWHERE) if covered else seen.row


def _fit_sheet_pose(rows: list[Compared], common: Placed, middle: np.ndarray) -> tuple[Placed, float | None]:
    """Return the pose of the sheet, and the rms residual [mm].

    The pose brings all predicted middles nearest to the marks (Kabsch). Marks that are much drier than the best ones
    seem displaced, and are left out where enough others remain.
    """
    known = [row for row in rows if row.placed.found]
    if len(known) < MIN_MARKS:
        return common, None
    usual = float(np.quantile([row.missing for row in known], 0.25))
    well_painted = [row for row in known if row.missing <= usual + MAX_EXCESS_MISSING_SHARE]
    known = well_painted if len(well_painted) >= MIN_MARKS else known
    before = np.array([row.middle_mm for row in known]) - middle
    after = before + np.array([row.placed.shift_mm for row in known])
    here, there = before.mean(axis=0), after.mean(axis=0)
    a, b = before - here, after - there
    turn = float(np.arctan2(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), np.sum(a * b)))
    turned = Placed((0.0, 0.0), turn, 0.0, True)
    shift = there - turned.moved(here[None], np.zeros(2))[0]
    residual = after - shift - turned.moved(before, np.zeros(2))
    spread_mm = float(np.sqrt(np.square(residual).sum(axis=1).mean()))
    return Placed((float(shift[0]), float(shift[1])), turn, 0.0, True), spread_mm


def _mask(rings: list[np.ndarray], canvas: Canvas) -> np.ndarray:
    return canvas.filled(rings) > 0.5 if rings else np.zeros(canvas.shape, bool)


def overlap_of_masks(mask_a: np.ndarray, mask_b: np.ndarray) -> float:
    """Return the intersection over union of two masks, 1 if both are empty."""
    union = float((mask_a | mask_b).sum())
    return float((mask_a & mask_b).sum()) / union if union else 1.0


def _locate_stroke(
    stroke: TargetStroke, rings, others, painted, is_painted, common: Placed, middle, canvas: Canvas
) -> _LocatedStroke:
    """Locate the mark of one stroke and compute its figures.

    rings: predicted mark with the sheet's place corrected; others: rings of all other strokes. Adds to `is_painted` the
    paint of this stroke that is paler than the usual paint.
    """
    points = np.vstack(rings)
    low = np.maximum(points.min(axis=0) - SEARCH_MARGIN_MM, canvas.window_mm[:2])
    high = np.minimum(points.max(axis=0) + SEARCH_MARGIN_MM, canvas.window_mm[2:])
    fine = canvas.px_per_mm
    c0, r0 = int(low[0] * fine), int((canvas.window_mm[3] - high[1]) * fine)
    c1, r1 = int(np.ceil(high[0] * fine)), int(np.ceil((canvas.window_mm[3] - low[1]) * fine))
    window_paint = painted[r0:r1, c0:c1]
    window = (c0 / fine, canvas.window_mm[3] - r0 / fine - window_paint.shape[0] / fine)
    local_canvas = Canvas(
        (*window, window[0] + window_paint.shape[1] / fine, window[1] + window_paint.shape[0] / fine), fine
    )
    nearby_rings = [ring for ring in others if (ring.max(axis=0) > low).all() and (ring.min(axis=0) < high).all()]
    mark = local_canvas.filled(rings) > 0.5
    their_away = _distance_mm(local_canvas.filled(nearby_rings) > 0.5, fine)
    nearer = (_distance_mm(mark, fine) <= their_away) | mark
    strength = (
        float(np.median(window_paint[mark & (window_paint > PALEST_PAINT_SHARE)]))
        if (mark & (window_paint > PALEST_PAINT_SHARE)).any()
        else 1.0
    )
    attributed = np.where(nearer, window_paint / strength, 0.0)
    free = (their_away > EDGE_BLUR_MM) & nearer
    found = locate_mark(attributed, free, rings, local_canvas)
    if not found.found:  # a dab has no direction
        found = locate_mark(attributed, free, rings, local_canvas, turns=False)
    inner = centroid(rings)

    def locate(each, at):
        return [at.moved(common.moved(ring, middle), inner) for ring in each]

    is_mine = attributed > EDGE_LEVEL
    at_last = local_canvas.filled(locate(stroke.predicted, found)) > 0.5
    if not found.found or (at_last & is_mine).sum() < MIN_PAINTED_SHARE * at_last.sum():
        found, at_last = NOWHERE, mark
    is_painted[r0:r1, c0:c1] |= is_mine & (_distance_mm(at_last, fine) < MAX_EDGE_DISTANCE_MM)
    start = centroid(stroke.predicted)
    shift = locate([start[None]], found)[0][0] - start
    whole = Placed((float(shift[0]), float(shift[1])), common.turn_rad + found.turn_rad, found.wider_mm, found.found)
    row = Compared(
        stroke.stroke,
        overlap_of_masks(local_canvas.filled(stroke.target) > 0.5, is_mine) if stroke.target else None,
        overlap_of_masks(local_canvas.filled(stroke.predicted) > 0.5, is_mine),
        whole,
        (float(start[0]), float(start[1])),
        float((at_last & ~(window_paint / strength > EDGE_LEVEL)).sum()) / float(max(at_last.sum(), 1)),
        overlap_of_masks(
            local_canvas.filled(locate(grow_rings(stroke.predicted, found.wider_mm), found)) > 0.5, is_mine
        ),
    )
    return _LocatedStroke(stroke, row, lambda each: locate(each, found))


def _distance_mm(mask: np.ndarray, px_per_mm: float) -> np.ndarray:
    """Return the distance [mm] of each pixel from the mask; inf for an empty mask."""
    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    return cv2.distanceTransform(np.uint8(~mask), cv2.DIST_L2, 5) / px_per_mm
