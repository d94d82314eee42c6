"""What photographs show of a job, stroke by stroke: overlap, displacement, width, what is missing or too much."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import chain

import cv2
import numpy as np

from ..calibration.chart.page import bar_rings, label_box
from ..errors import Error, Notice
from ..geometry.rings import centroid
from ..photo.edges import StrokeBox, paint_seen
from ..photo.flatten import Flat, flatten
from ..photo.markers import Printed, View, find_view
from ..photo.photo import read_photo, refuse_twice
from ..photo.whole_page import refuse_cropped, refuse_unsure
from .corrections import LEAST_MARKS
from .job_page import JobPage, box_ring
from .placing import NOWHERE, Canvas, Placed, grown, place

AROUND_MM = 6.0  # round a predicted mark, where its paint is looked for
BLUR_MM = 0.6  # beyond another mark its blurred edge still shows
BLOT_MM = 1.5  # beyond a mark, at its place, what is no edge any more
FINEST_PX_PER_MM = 12.0
LEAST_OVERLAP = 0.3  # of paint with its prediction, at its place: less is another job, or chance
PRINT_MM = 0.5  # round what is printed
COVERED, MOSTLY = (
    0.3,
    0.7,
)  # share of a mark, at its place, that is painted at least; without paint, it is missing
LEVEL = 0.5  # of the usual paint: an edge
DRIER = 0.1  # share of a mark without paint, beyond that of most: its middle is the painted part's
THING_MM2 = 100.0  # of one piece outside of all marks: a hand, a tool or a large blot
PALEST = 0.15  # of the usual paint, that of a stroke
ALIKE = 0.9  # overlap of the paint of two photographs of one sheet, at least


@dataclass(frozen=True)
class TargetStroke:
    """One stroke: rings on the sheet of the target (None where only a plan is known), and of the prediction. is_drawn:
    a stroke of the drawing; others, in the margin, count in no figure of the sheet."""

    stroke: str
    target: list[np.ndarray] | None
    predicted: list[np.ndarray]
    is_drawn: bool = True


@dataclass(frozen=True)
class Compared:
    """A stroke as it was painted. overlap_target (None without a drawing), overlap_predicted: intersection over union;
    placed: relative to the prediction, whose middle is at middle_mm; missing: share of the mark, at its place, without
    paint; like: overlap of the mark, at its place and width, with its paint."""

    stroke: str
    overlap_target: float | None
    overlap_predicted: float
    placed: Placed
    middle_mm: tuple[float, float]
    missing: float
    like: float


@dataclass(frozen=True)
class Comparison:
    """common: the pose of the sheet, by the places of all marks, about middle_mm; spread_mm: rms of what is left of
    their displacements, None of fewer than three marks; elsewhere_mm2: paint outside of all marks. overlaps: of all
    paint with the target (or, without a drawing, the prediction) as painted, once the sheet's place is put right, and
    once each stroke's is. paint: share of it on the page, painted: on the sheet, by the pixels of canvas.
    has_things: something on the sheet is no mark."""

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
    """photos: names and what their files hold, of one painted sheet; their paint is averaged. Error in one sentence,
    with the file, where a photograph cannot be read, is given twice or shows another job."""
    refuse_twice(photos)
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
    painted = [_on_sheet(each, flat, page, canvas) for _, _, each in reads]
    _refuse_other_sheets(painted, photos)
    mean = np.mean(painted, axis=0).astype(np.float32)
    return replace(compare_paint(strokes, mean, canvas, photos[0][0]), view=view, flat=flat, paint=paint)


def of_drawing(found: Comparison, strokes: list[TargetStroke]) -> tuple[Comparison, list[TargetStroke]]:
    """Leave out strokes that are not of the drawing."""
    drawn = [stroke for stroke in strokes if stroke.is_drawn]
    names = {stroke.stroke for stroke in drawn}
    return replace(found, strokes=tuple(row for row in found.strokes if row.stroke in names)), drawn


def compare_sheets(
    page: JobPage, strokes: list[TargetStroke], photos: list[tuple[str, bytes]]
) -> list[Comparison]:
    """Each photograph of another sheet. Error as for compare_photos."""
    refuse_twice(photos)
    return [compare_photos(page, strokes, [photo]) for photo in photos]


def compare_paint(strokes: list[TargetStroke], painted: np.ndarray, canvas: Canvas, name: str) -> Comparison:
    """painted: share of the usual paint of each pixel of the canvas, however it was seen; name: of the picture. Without
    view, flat and paint. Error for what cannot be the paint of this job."""
    if all(not stroke.predicted for stroke in strokes):
        raise Error("there is nothing to paint", code="nothing-to-paint")
    common, middle = _common(painted, strokes, canvas)
    return _compared(strokes, painted, common, middle, canvas, name)


def _refuse_other_sheets(painted: list[np.ndarray], photos: list[tuple[str, bytes]]) -> None:
    for (name, _), each in zip(photos[1:], painted[1:], strict=True):
        alike = _overlap(painted[0] > LEVEL, each > LEVEL)
        if alike < ALIKE:
            raise Error(
                f"its paint overlaps with that of {photos[0][0]} by {alike:.2f}, less than {ALIKE:g}: photographs of "
                "one sheet are averaged; compare each sheet by itself",
                file=name,
                value=alike,
                code="photos-differ",
            )


def _of_a_job(refusal: Error, name: str) -> Error:
    sentence, advice = refusal.sentence, refusal.advice
    if refusal.code == "photo-of-another-chart":
        sentence = "the picture shows the page of another job, or of another plan of this one"
        advice = "give the drawing with the flags that the page was made with, or the plan.json"
    return Error(
        sentence, refusal.where, refusal.value, refusal.range, name, code=refusal.code, advice=advice
    )


def _read(
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
    flat = flatten(pixels, view, page.size_mm, fine or min(view.px_per_mm, FINEST_PX_PER_MM))
    dark = [each.mean(axis=0) + (each - each.mean(axis=0)) * 1.4 for each in corners.values()]
    dark += bar_rings(printed.bar, beyond_mm=PRINT_MM)
    dark += [box_ring(*ring.min(axis=0) - PRINT_MM, *ring.max(axis=0) + PRINT_MM) for ring in page.ticks]
    dark += [box_ring(*label_box(label)) for label in printed.labels]
    print_ = np.zeros(flat.pixels.shape[:2], np.uint8)
    for ring in dark:
        cv2.fillPoly(print_, [np.round(flat.to_px(ring)).astype(np.int32)], 1)
    return flat, view, paint_seen(flat, print_, stroke_boxes)


def _on_sheet(paint, flat: Flat, page: JobPage, canvas: Canvas) -> np.ndarray:
    """Return the paint of the sheet's own pixels, 1 for the usual paint."""
    left, up = page.frame_mm, page.size_mm[1] - page.frame_mm
    matrix = np.array(
        [[1.0, 0.0, left * flat.px_per_mm], [0.0, 1.0, (flat.sheet_mm[1] - up) * flat.px_per_mm]]
    )
    rows, columns = canvas.shape
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    sheet = cv2.warpAffine(paint, matrix, (columns, rows), flags=flags)
    usual = float(np.median(sheet[sheet > 0.5])) if (sheet > 0.5).any() else 1.0
    return np.clip(sheet / usual, 0, 1.2)


def _common(painted, strokes: list[TargetStroke], canvas: Canvas) -> tuple[Placed, np.ndarray]:
    rings = [ring for stroke in strokes for ring in stroke.predicted]
    middle = centroid(rings)
    coarse = min(canvas.px_per_mm, 5.0)
    small = Canvas(canvas.window_mm, coarse)
    rows, columns = small.shape
    less = cv2.resize(painted, (columns, rows), interpolation=cv2.INTER_AREA)
    found = place(less, np.ones_like(less), rings, small)
    return replace(found, wider_mm=0.0) if found.found else NOWHERE, middle


@dataclass(frozen=True)
class _Seen:
    """A stroke that paints: its figures, and locate, which puts its rings where its mark is."""

    stroke: TargetStroke
    row: Compared
    locate: Callable[[list[np.ndarray]], list[np.ndarray]]


def _compared(strokes, painted, common, middle, canvas, name) -> Comparison:
    """Figures are of the drawing; strokes that are not of it have their rows."""
    moved = [[common.moved(ring, middle) for ring in stroke.predicted] for stroke in strokes]
    is_painted = painted > LEVEL
    every = []
    for k, stroke in enumerate(strokes):
        if stroke.predicted:
            others = [*chain(*moved[:k], *moved[k + 1 :])]
            every.append(_stroke(stroke, moved[k], others, painted, is_painted, common, middle, canvas))
    found = every
    if not all(stroke.is_drawn for stroke in strokes):
        drawn, others = (
            [rings for rings, stroke in zip(moved, strokes, strict=True) if stroke.is_drawn == is_drawn]
            for is_drawn in (True, False)
        )
        away, away_from_others = (
            _away(_any([*chain(*each)], canvas), canvas.px_per_mm) for each in (drawn, others)
        )
        is_painted, painted = (np.where(away <= away_from_others, each, 0) for each in (is_painted, painted))
        is_painted = is_painted.astype(bool)
        moved, found = drawn, [seen for seen in every if seen.stroke.is_drawn]
        strokes = [stroke for stroke in strokes if stroke.is_drawn]
    predicted = _overlap(_any([*chain(*(stroke.predicted for stroke in strokes))], canvas), is_painted)
    _refuse_other_job(max(predicted, _overlap(_any([*chain(*moved)], canvas), is_painted)), name)
    sheet, spread_mm = _sheet([seen.row for seen in found], common, middle)
    has_target = all(stroke.target is not None for stroke in strokes)
    whole = [*chain(*(stroke.target if has_target else stroke.predicted for stroke in strokes))]
    each = [seen.locate(seen.stroke.target if has_target else seen.stroke.predicted) for seen in found]
    as_painted, placed, each_placed = (
        _overlap(_any(rings, canvas), is_painted)
        for rings in (whole, [sheet.moved(ring, middle) for ring in whole], [*chain(*each)])
    )
    marks = _any([*chain(*(seen.locate(seen.stroke.predicted) for seen in found))], canvas)
    astray = is_painted & (_away(marks, canvas.px_per_mm) > BLOT_MM)
    things = _things(astray, canvas)
    near = _away(things, canvas.px_per_mm) < BLOT_MM + BLUR_MM
    return Comparison(
        tuple(_uncovered(seen, near, canvas) for seen in every),
        sheet,
        middle,
        spread_mm,
        float(astray.sum()) / canvas.px_per_mm**2,
        as_painted if has_target else None,
        predicted,
        (as_painted, placed, each_placed),
        painted,
        canvas,
        (*_missing(found), *_covered(things, canvas)),
        bool(things.any()),
    )


def _refuse_other_job(overlap: float, name: str) -> None:
    if overlap < LEAST_OVERLAP:
        raise Error(
            f"the paint overlaps with what was predicted by {overlap:.2f}, less than {LEAST_OVERLAP:g}: is this the "
            "painted page of this job?",
            file=name,
            value=overlap,
            code="photo-of-another-job",
        )


def _missing(found: list[_Seen]) -> list[Notice]:
    rows = [seen.row for seen in found if not seen.row.placed.found and seen.row.missing > MOSTLY]
    sentence = "no paint is found where its mark should be"
    return [Notice(row.stroke, sentence, code="mark-missing") for row in rows]


def _covered(things: np.ndarray, canvas: Canvas) -> list[Notice]:
    if not things.any():
        return []
    sentence = (
        f"{things.sum() / canvas.px_per_mm**2:.0f} mm^2 on the sheet are no mark, but a hand, a tool or a blot: "
        "strokes beneath or next to it are not reported, nor are causes of errors"
    )
    return [Notice("sheet", sentence, code="photo-covered")]


def without(found: Comparison, done: dict[str, Placed]) -> Comparison:
    """Return the comparison with marks at the places that they would have without the known displacements. Those of an
    unknown displacement are dropped."""
    rows = tuple(_undone(row, done.get(row.stroke, NOWHERE)) for row in found.strokes)
    sheet, spread_mm = _sheet(list(rows), found.common, found.middle_mm)
    return replace(found, strokes=rows, common=sheet, spread_mm=spread_mm)


def _undone(row: Compared, done: Placed) -> Compared:
    seen = row.placed
    if not (seen.found and done.found):
        return replace(row, placed=NOWHERE)
    x, y = np.subtract(seen.shift_mm, done.shift_mm).tolist()
    left = Placed((x, y), seen.turn_rad - done.turn_rad, seen.wider_mm - done.wider_mm, True)
    return replace(row, placed=left)


def _things(astray: np.ndarray, canvas: Canvas) -> np.ndarray:
    """Return pieces of paint outside of all marks that are too large for stray paint."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(np.uint8(astray), connectivity=8)
    large = stats[:, cv2.CC_STAT_AREA] > THING_MM2 * canvas.px_per_mm**2
    large[0] = False
    return large[labels]


def _uncovered(seen: _Seen, near: np.ndarray, canvas: Canvas) -> Compared:
    """Drop a stroke whose mark is near a thing: it is not found."""
    covered = near.any() and (_any(seen.locate(seen.stroke.predicted), canvas) & near).any()
    return replace(seen.row, placed=NOWHERE) if covered else seen.row


def _sheet(rows: list[Compared], common: Placed, middle: np.ndarray) -> tuple[Placed, float | None]:
    """Return the shift and turn that bring all predicted middles nearest to the marks (Kabsch), and the residuals.
    Marks that are much drier than the best ones are displaced, and are left out where enough others are."""
    known = [row for row in rows if row.placed.found]
    if len(known) < LEAST_MARKS:
        return common, None
    usual = float(np.quantile([row.missing for row in known], 0.25))
    whole = [row for row in known if row.missing <= usual + DRIER]
    known = whole if len(whole) >= LEAST_MARKS else known
    before = np.array([row.middle_mm for row in known]) - middle
    after = before + np.array([row.placed.shift_mm for row in known])
    here, there = before.mean(axis=0), after.mean(axis=0)
    a, b = before - here, after - there
    turn = float(np.arctan2(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), np.sum(a * b)))
    turned = Placed((0.0, 0.0), turn, 0.0, True)
    shift = there - turned.moved(here[None], np.zeros(2))[0]
    left = after - shift - turned.moved(before, np.zeros(2))
    spread_mm = float(np.sqrt(np.square(left).sum(axis=1).mean()))
    return Placed((float(shift[0]), float(shift[1])), turn, 0.0, True), spread_mm


def _any(rings: list[np.ndarray], canvas: Canvas) -> np.ndarray:
    return canvas.filled(rings) > 0.5 if rings else np.zeros(canvas.shape, bool)


def _overlap(one: np.ndarray, other: np.ndarray) -> float:
    union = float((one | other).sum())
    return float((one & other).sum()) / union if union else 1.0


def _stroke(
    stroke: TargetStroke, rings, others, painted, is_painted, common: Placed, middle, canvas: Canvas
) -> _Seen:
    """rings: its mark with the sheet's place put right, others: those of all other strokes. is_painted gets the part
    whose paint is paler than that of others."""
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
    mine = small.filled(rings) > 0.5
    their_away = _away(small.filled(near) > 0.5, fine)
    nearer = (_away(mine, fine) <= their_away) | mine
    strength = float(np.median(part[mine & (part > PALEST)])) if (mine & (part > PALEST)).any() else 1.0
    attributed = np.where(nearer, part / strength, 0.0)
    free = (their_away > BLUR_MM) & nearer
    found = place(attributed, free, rings, small)
    if not found.found:  # a dab has no direction
        found = place(attributed, free, rings, small, turns=False)
    inner = centroid(rings)

    def locate(each, at):
        return [at.moved(common.moved(ring, middle), inner) for ring in each]

    is_mine = attributed > LEVEL
    at_last = small.filled(locate(stroke.predicted, found)) > 0.5
    if not found.found or (at_last & is_mine).sum() < COVERED * at_last.sum():
        found, at_last = NOWHERE, mine
    is_painted[r0:r1, c0:c1] |= is_mine & (_away(at_last, fine) < BLOT_MM)
    start = centroid(stroke.predicted)
    shift = locate([start[None]], found)[0][0] - start
    whole = Placed(
        (float(shift[0]), float(shift[1])), common.turn_rad + found.turn_rad, found.wider_mm, found.found
    )
    row = Compared(
        stroke.stroke,
        _overlap(small.filled(stroke.target) > 0.5, is_mine) if stroke.target else None,
        _overlap(small.filled(stroke.predicted) > 0.5, is_mine),
        whole,
        (float(start[0]), float(start[1])),
        float((at_last & ~(part / strength > LEVEL)).sum()) / float(max(at_last.sum(), 1)),
        _overlap(small.filled(locate(grown(stroke.predicted, found.wider_mm), found)) > 0.5, is_mine),
    )
    return _Seen(stroke, row, lambda each: locate(each, found))


def _away(mask: np.ndarray, px_per_mm: float) -> np.ndarray:
    """mm from each pixel to the mask."""
    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    return cv2.distanceTransform(np.uint8(~mask), cv2.DIST_L2, 5) / px_per_mm
