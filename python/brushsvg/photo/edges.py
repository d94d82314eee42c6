"""Find the marks on a flattened sheet: the paint in each pixel, and outlines half way between paper and paint."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ..errors import Error
from ..geometry.polylines import lengths
from ..geometry.rings import signed_area
from .flatten import Flat
from .mask_contours import mask_outlines
from .photo import LIGHT, grey_light, refuse_grainy
from .photo_checks import refuse_covered, refuse_displaced, refuse_elsewhere
from .stroke_boxes import MIN_SPLIT_MM2, MIN_SPLIT_SHARE, StrokeBox, box_pixels

MAX_PAINT_WIDTH_MM = 31  # a darker area that is narrower than this is paint; a wider one is uneven light
MIN_BARE_LIGHT_RATIO = 0.92  # of the surrounding light: a darker pixel is not bare paper
# Distance over which the light may change. If shorter, the light would follow the stain around wet paint.
LIGHT_SMOOTHING_MM = 8.0
LABEL_MARGIN_MM = 0.5  # distance from the box of a label within which letters or their blur may be
MAX_STRAY_MM = 6.0  # greatest distance of a mark from its box
MIN_CONTRAST = 0.12  # smallest share of the light that paint absorbs
MIN_CONTRAST_TO_NOISE = 6.0  # smallest contrast of paint, in standard deviations of the paper's noise
SEEN = 0.3  # of the usual paint: a pixel with more is part of a mark; each mark's edge has its own level
# Share of the distance that a shift leaves, below which the marks are on a page of another scale: 0.98 where they are
# not, 0.63 to 0.82 at 3 %.
MAX_SCALED_SHARE = 0.9
MAX_LEAN_MM_PER_MM = 1.5  # displacement per depth of a leaning tool, with the same limit as in a cell
MAX_MISSING_SHARE = 0.5  # of the strokes
MIN_PART_MM2 = 0.5
MIN_PART_SHARE = 0.03  # of a mark's area: smaller parts are splashes
SHEET_RIM_MM = 2.0  # width of the rim along the sheet's edges, where the table and shadows show
# Of a side: a part that runs along more of it is the table around paper that is smaller than the printed page.
MAX_RIM_SHARE = 0.3
MIN_LENGTH_SHARE = 0.3  # of its box's length: a shorter mark is a splash where a stroke is missing
BLUR_MARGIN_MM = 0.5  # distance inside a mark's edge beyond which blur does not reduce its paint
MAX_BLUR_FACTOR = 1.3  # largest ratio of a narrow mark's real paint to the paint that the photograph shows
EDGE_MM = 0.8  # distance from a mark within which its edge is searched
# Distance between the points of an outline, and the length over which each is averaged to remove pixel steps.
OUTLINE_STEP_MM, OUTLINE_MEAN_MM = 0.1, 0.2


@dataclass(frozen=True)
class Marks:
    """The marks that were found on a sheet.

    outlines_mm: rings by stroke; missing: strokes without paint; joined: pairs of strokes whose marks touch, and which
    are cut between their boxes; paint: (rows, columns), 0 is paper, 1 is the usual paint.
    """

    outlines_mm: dict[str, list[np.ndarray]]
    missing: list[str]
    joined: list[tuple[str, str]]
    paint: np.ndarray


def find_marks(flat: Flat, stroke_boxes: list[StrokeBox], printed_mm: list[np.ndarray], labels_mm: list) -> Marks:
    """Find the marks of the strokes on a flattened sheet.

    printed_mm: rings around markers and everything printed as dark as paint; labels_mm: boxes of pale text, which a
    mark may cover or touch. Raises Error where there is no paint.
    """
    is_printed = printed_pixels(flat, printed_mm)
    try:
        paint = paint_seen(flat, is_printed, stroke_boxes, labels_mm)
        return assign_marks(paint, flat, stroke_boxes)
    except Error:
        refuse_grainy(grey_light(flat.pixels), "the strokes cannot be distinguished")
        raise


def printed_pixels(flat: Flat, printed_mm) -> np.ndarray:
    """Return the mask (rows, columns) of the printed area, inside the rings."""
    is_printed = np.zeros(flat.pixels.shape[:2], np.uint8)
    for ring in printed_mm:
        cv2.fillPoly(is_printed, [np.round(flat.to_px(ring)).astype(np.int32)], 1)
    return is_printed


def paint_seen(flat: Flat, is_printed: np.ndarray, stroke_boxes: list[StrokeBox], labels_mm=()) -> np.ndarray:
    """Return the amount of paint in each pixel: 0 is paper, 1 is the usual paint.

    The amount (rows, columns) is measured along the colour that best separates paint from paper, relative to the light
    that bare paper would reflect at the same place. Paint may be darker or lighter than paper. is_printed: mask (rows,
    columns) of pixels that do not count; labels_mm: boxes of print that does not count as bare paper or as paint.
    """
    light = cv2.LUT(flat.pixels, LIGHT)
    is_label = np.zeros_like(is_printed)
    for box in labels_mm:
        _fill_box(is_label, flat, box, LABEL_MARGIN_MM)
    printed = is_printed | is_label
    paper, is_lighter = _estimate_paper_light(light, printed, flat.px_per_mm)
    absorbed = 1.0 - light / np.maximum(paper, 1e-3)
    if is_lighter:
        absorbed = -absorbed
    inside = np.zeros_like(is_printed)
    for stroke_box in stroke_boxes:
        _fill_box(inside, flat, stroke_box.box_mm, 0.0)
    sample = absorbed[::3, ::3][(inside[::3, ::3] == 1) & (is_printed[::3, ::3] == 0)]
    weights = _paint_weights(sample)
    paint = cv2.transform(absorbed, weights[None])
    if len(labels_mm):
        letters = _letters_without_paint(absorbed, paint, flat, stroke_boxes, labels_mm)
        weights = _paint_weights(sample, letters)
        on_label = absorbed[is_label == 1] @ weights
        is_print = on_label <= (letters @ weights).max()
        paint[is_label == 1] = np.where(is_print, 0.0, np.minimum(paint[is_label == 1], on_label))
    paint[is_printed == 1] = 0.0
    rim_px = _rim_px(flat)
    paint[:rim_px] = paint[-rim_px:] = paint[:, :rim_px] = paint[:, -rim_px:] = 0.0
    return paint


def _fill_box(mask: np.ndarray, flat: Flat, box_mm, beyond_mm: float) -> None:
    c0, r0, c1, r1 = box_pixels(flat, box_mm, beyond_mm)
    mask[r0:r1, c0:c1] = 1


def _letters_without_paint(absorbed, paint, flat: Flat, stroke_boxes: list[StrokeBox], labels_mm) -> np.ndarray:
    """Return the absorbed shares (n, 3) of the light in the box of a label without paint.

    It is the palest label that no mark can reach, because an object may cover the others. Where marks can reach all
    labels, it is the palest of all. The shares are 0 where no label is on the sheet.
    """
    strokes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    found = []
    for box in labels_mm:
        c0, r0, c1, r1 = box_pixels(flat, box, LABEL_MARGIN_MM)
        if r0 < r1 and c0 < c1:
            gaps_mm = np.maximum(strokes[:, :2] - box[2:], box[:2] - strokes[:, 2:]).max(axis=1)
            window = slice(r0, r1), slice(c0, c1)
            found.append((gaps_mm.min() <= MAX_STRAY_MM, float(paint[window].max()), window))
    if not found:
        return np.zeros((1, 3), np.float32)
    _, _, window = min(found, key=lambda each: each[:2])
    return absorbed[window].reshape(-1, 3)


def _rim_px(flat: Flat) -> int:
    return max(1, round(SHEET_RIM_MM * flat.px_per_mm))


def _estimate_paper_light(light: np.ndarray, is_printed: np.ndarray, px_per_mm: float) -> tuple[np.ndarray, bool]:
    """Return the light of bare paper at every pixel.

    Returns also whether paint is lighter than paper. The light is smoothed from the bare paper around, at one pixel per
    mm. Most of the surroundings of a pixel are taken to be paper.
    """
    rows, columns = light.shape[:2]
    size = (max(8, round(columns / px_per_mm)), max(8, round(rows / px_per_mm)))
    coarse = cv2.resize(light, size, interpolation=cv2.INTER_AREA)
    is_covered = cv2.resize(is_printed.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (MAX_PAINT_WIDTH_MM, MAX_PAINT_WIDTH_MM))
    is_lighter = _is_paint_lighter(coarse, is_covered)
    if is_lighter:
        no_print = np.where(is_covered[..., None], np.float32(1.0), coarse)
        around = cv2.morphologyEx(no_print, cv2.MORPH_OPEN, kernel, borderType=cv2.BORDER_REPLICATE)
        share = around / np.maximum(coarse, 1e-3)
    else:
        around = cv2.morphologyEx(coarse, cv2.MORPH_CLOSE, kernel, borderType=cv2.BORDER_REPLICATE)
        share = coarse / np.maximum(around, 1e-3)
    bare = (share.min(axis=2) > MIN_BARE_LIGHT_RATIO) & ~is_covered
    weight = cv2.GaussianBlur(bare.astype(np.float32), None, LIGHT_SMOOTHING_MM)
    mean = cv2.GaussianBlur(coarse * bare[..., None].astype(np.float32), None, LIGHT_SMOOTHING_MM)
    is_lit = weight[..., None] > 0.02
    smoothed = np.where(is_lit, mean / np.maximum(weight[..., None], 1e-6), around).astype(np.float32)
    return cv2.resize(smoothed, (columns, rows), interpolation=cv2.INTER_LINEAR), is_lighter


def _is_paint_lighter(coarse: np.ndarray, is_covered: np.ndarray) -> bool:
    """Return whether paint is lighter than paper: more pixels are lighter than around, at 1 px per mm."""
    levels = np.uint8(np.round(255 * np.sqrt(np.clip(coarse, 0, 1))))  # a median over so many pixels needs 8 bits
    surroundings = np.dstack([cv2.medianBlur(channel, MAX_PAINT_WIDTH_MM) for channel in cv2.split(levels)])
    ratio = (levels + 1.0) / (surroundings + 1.0)
    darker, lighter = (
        (channel > 1 / np.sqrt(MIN_BARE_LIGHT_RATIO)).any(axis=2) & ~is_covered for channel in (1 / ratio, ratio)
    )
    return int(lighter.sum()) > int(darker.sum())


def _paint_weights(absorbed: np.ndarray, letters: np.ndarray | None = None) -> np.ndarray:
    """Return colour weights (3,) that map paint to 1 and paper to 0.

    With these weights, noise is smallest. This is Fisher's linear discriminant. absorbed: (n, 3) absorbed shares of the
    light; letters: (m, 3) of print and the paper around it, which count as noise of the paper. Raises Error where paint
    and paper cannot be separated.
    """
    strength = np.linalg.norm(np.maximum(absorbed, 0.0), axis=1) / np.sqrt(3)
    threshold, _ = cv2.threshold(
        np.uint8(np.clip(strength * 255, 0, 255))[:, None], 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU
    )
    painted = strength > threshold / 255
    if not 10 < painted.sum() < 0.99 * len(strength):
        raise Error(NO_PAINT_MESSAGE, code="photo-without-paint")
    paper, paint = absorbed[~painted], np.median(absorbed[painted], axis=0)
    paper_median = np.median(paper, axis=0)
    noise = 1.4826 * np.median(np.abs(paper - paper_median), axis=0)
    if np.abs(paint - paper_median).max() < max(MIN_CONTRAST, MIN_CONTRAST_TO_NOISE * float(noise.max())):
        raise Error(NO_PAINT_MESSAGE, code="photo-without-paint")
    bare = paper[(np.abs(paper - paper_median) < 4 * noise + 1e-3).all(axis=1)]
    spread = np.cov(bare, rowvar=False) + 0.02**2 * np.eye(3)
    if letters is not None:
        spread += (letters - paper_median).T @ (letters - paper_median) / len(letters)
    weights = np.linalg.solve(spread, paint - paper_median)
    return weights / (weights @ (paint - paper_median))


NO_PAINT_MESSAGE = (
    "no paint was found where the strokes should be: check that this is the painted page, and that the colour of the "
    "paint differs from the paper"
)


def _number_nearest_boxes(flat: Flat, stroke_boxes: list[StrokeBox]) -> np.ndarray:
    """Return the number, from 1, of the box nearest to each pixel (rows, columns).

    Where several boxes contain a pixel, the box whose edge is farthest is chosen. Pixels more than MAX_STRAY_MM away
    from all boxes get 0.
    """
    rows, columns = flat.pixels.shape[:2]
    step = max(1, round(flat.px_per_mm / 2))
    x = (np.arange(0, columns, step) + 0.5) / flat.px_per_mm
    y = flat.sheet_mm[1] - (np.arange(0, rows, step) + 0.5) / flat.px_per_mm
    nearest, owner = np.full((len(y), len(x)), MAX_STRAY_MM), np.zeros((len(y), len(x)), np.uint16)
    for number, stroke_box in enumerate(stroke_boxes, 1):
        left, bottom, right, top = stroke_box.box_mm
        across = np.maximum(left - x, x - right)[None]
        above = np.maximum(bottom - y, y - top)[:, None]
        distance = np.hypot(np.maximum(across, 0.0), np.maximum(above, 0.0)) + np.minimum(
            np.maximum(across, above), 0.0
        )
        closer = distance < nearest
        nearest[closer], owner[closer] = distance[closer], number
    return np.repeat(np.repeat(owner, step, axis=0), step, axis=1)[:rows, :columns]


def assign_marks(paint: np.ndarray, flat: Flat, stroke_boxes: list[StrokeBox]) -> Marks:
    """Assign each piece of paint to the stroke whose box holds most of it.

    Where marks are in the boxes of other strokes, as with a leaning tool or a displaced sheet, the boxes are moved
    with them first.
    paint: from paint_seen, or a mean over several pictures.
    """
    try:
        marks = _assign_marks_once(paint, flat, stroke_boxes)
    except Error as refusal:
        if refusal.code != "photo-paint-elsewhere":
            raise
        moved_boxes = _move_boxes_to_paint(paint, flat, stroke_boxes)
        if moved_boxes is None:
            raise
        try:
            return _assign_marks_once(paint, flat, moved_boxes)
        except Error:
            raise refusal from None
    if (marks.joined or marks.missing) and (moved_boxes := _move_boxes_to_paint(paint, flat, stroke_boxes)) is not None:
        with contextlib.suppress(Error):
            retried = _assign_marks_once(paint, flat, moved_boxes)
            if len(retried.joined) + len(retried.missing) < len(marks.joined) + len(marks.missing):
                return retried
    return marks


def _move_boxes_to_paint(paint: np.ndarray, flat: Flat, stroke_boxes: list[StrokeBox]) -> list[StrokeBox] | None:
    """Move the boxes so that their middles match most parts of the paint.

    They move in proportion to depth, as with a leaning tool, or all by one shift, as on a displaced sheet, whichever
    fits better. Returns None where no depth is known, where the shift exceeds MAX_STRAY_MM, and where the page
    seems to have another scale.
    """
    depths = np.array([stroke_box.depth_mm for stroke_box in stroke_boxes])
    if not depths.any():
        return None
    _, _, stats, _ = cv2.connectedComponentsWithStats(np.uint8(paint > SEEN), connectivity=8)
    px_per_mm = flat.px_per_mm
    parts = stats[1:][stats[1:, cv2.CC_STAT_AREA] > MIN_SPLIT_MM2 * px_per_mm**2] / px_per_mm
    size = parts[:, 2:4]
    middle = np.column_stack([0, flat.sheet_mm[1]]) + (parts[:, :2] + 0.5 * size) * (1, -1)
    boxes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    size_differences = size[:, None] - (boxes[:, 2:] - boxes[:, :2])
    offsets = middle[:, None] - 0.5 * (boxes[:, :2] + boxes[:, 2:])

    def fit_boxes(by: np.ndarray, after_mm: np.ndarray | float = 0.0) -> tuple[float, np.ndarray]:
        """Fit the factors (2,) by which boxes move, and return the distance left.

        The distance is the smallest total distance of the parts from boxes. The boxes move by the factors times `by`
        (boxes, 1 or 2), and by after_mm. The factors are at most MAX_LEAN_MM_PER_MM.
        """

        def total_distance_mm(factors) -> float:
            away = offsets - (by * factors + after_mm)
            distances = np.linalg.norm(np.dstack([away, 0.5 * size_differences]), axis=2)
            return float(np.minimum(distances.min(axis=1), MAX_STRAY_MM).sum())

        factors, reach = np.zeros(2), MAX_LEAN_MM_PER_MM
        for _ in range(2):
            steps = np.linspace(-reach, reach, 31)
            factors = min((factors + np.array([x, y]) for x in steps for y in steps), key=total_distance_mm)
            reach /= 10
        return total_distance_mm(factors), factors

    by = depths[:, None]
    everywhere = np.full_like(by, depths.max())
    (lean_distance_mm, factors), (shift_distance_mm, shift) = fit_boxes(by), fit_boxes(everywhere)
    if shift_distance_mm < lean_distance_mm:
        by, factors = everywhere, shift
        from_middle = 0.5 * (boxes[:, :2] + boxes[:, 2:])
        from_middle -= from_middle.mean(axis=0)
        from_middle *= MAX_STRAY_MM / MAX_LEAN_MM_PER_MM / np.abs(from_middle).max()
        is_scaled = fit_boxes(from_middle, by * factors)[0] < MAX_SCALED_SHARE * shift_distance_mm
        if is_scaled or np.hypot(*(by[0] * factors)) > MAX_STRAY_MM:
            return None
    moved = boxes + np.tile(by * factors, 2)
    return [
        replace(stroke_box, box_mm=tuple(box)) for stroke_box, box in zip(stroke_boxes, moved.tolist(), strict=True)
    ]


def _assign_marks_once(paint: np.ndarray, flat: Flat, stroke_boxes: list[StrokeBox]) -> Marks:
    px_per_mm = flat.px_per_mm
    count, part, stats, _ = cv2.connectedComponentsWithStats(np.uint8(paint > SEEN), connectivity=8)
    owner = _number_nearest_boxes(flat, stroke_boxes)
    painted_px = np.flatnonzero(part)
    pairs_of_numbers = part.ravel()[painted_px].astype(np.int64) * (len(stroke_boxes) + 1) + owner.ravel()[painted_px]
    areas_in_boxes = np.bincount(pairs_of_numbers, minlength=count * (len(stroke_boxes) + 1)).reshape(count, -1)
    areas = stats[:, cv2.CC_STAT_AREA].astype(float)
    is_kept = areas > 0.5 * MIN_PART_MM2 * px_per_mm**2
    is_kept[0] = False
    is_kept &= ~_is_along_rim(part, count, _rim_px(flat))
    own_box = areas_in_boxes[:, 1:].argmax(axis=1) + 1
    own_box[areas_in_boxes[:, 1:].max(axis=1) == 0] = 0
    second = np.sort(areas_in_boxes[:, 1:], axis=1)[:, -2] if len(stroke_boxes) > 1 else np.zeros(count)
    is_reaching = is_kept & _is_separate_mark(second, areas, px_per_mm)
    is_cut = is_reaching & _is_separate_mark(
        _largest_area_elsewhere(areas_in_boxes, areas, own_box, is_kept), areas, px_per_mm
    )
    refuse_covered(areas_in_boxes, areas, is_reaching, stroke_boxes, px_per_mm)
    refuse_elsewhere(is_kept[part], flat, stroke_boxes)
    refuse_displaced(areas_in_boxes, is_reaching, stroke_boxes)
    usual = float(np.median(paint[paint > SEEN])) if (paint > SEEN).any() else 1.0
    outlines, missing, joined = {}, [], []
    for number, stroke_box in enumerate(stroke_boxes, 1):
        is_own = is_kept & np.where(is_cut, areas_in_boxes[:, number] > MIN_PART_MM2 * px_per_mm**2, own_box == number)
        rings = _outlines_of_stroke(
            paint, part, owner, is_own, is_cut, number, stats, px_per_mm, flat.sheet_mm[1], usual
        )
        if rings and _longest_side(rings) > MIN_LENGTH_SHARE * _longest_side([np.reshape(stroke_box.box_mm, (2, 2))]):
            outlines[stroke_box.stroke] = rings
        else:
            missing.append(stroke_box.stroke)
        for number_of_part in np.flatnonzero(is_own & is_cut):
            other = [k for k in np.argsort(areas_in_boxes[number_of_part, 1:])[::-1][:2] + 1 if k != number]
            pair = tuple(sorted((stroke_box.stroke, stroke_boxes[other[0] - 1].stroke)))
            if pair not in joined:
                joined.append(pair)
    if len(missing) > MAX_MISSING_SHARE * len(stroke_boxes):
        raise Error(
            f"no paint of {len(missing)} of the {len(stroke_boxes)} strokes was found, at most "
            f"{int(MAX_MISSING_SHARE * len(stroke_boxes))} may be missing: check that this chart was painted, and that "
            "the page was at its place and not turned",
            value=len(missing),
            code="mark-missing",
        )
    return Marks(outlines, missing, joined, paint)


def _is_along_rim(part: np.ndarray, count: int, rim: int) -> np.ndarray:
    """Return which parts (count,) run along a side of the sheet."""
    sides = (part[rim], part[-rim - 1], part[:, rim], part[:, -rim - 1])
    return np.any([np.bincount(side, minlength=count) > MAX_RIM_SHARE * len(side) for side in sides], axis=0)


def _is_separate_mark(other, areas, px_per_mm: float) -> np.ndarray:
    """Return whether each part is a separate mark in another box.

    other: area of each part in another box [px]; areas: whole area [px].
    """
    return (other > MIN_SPLIT_SHARE * areas) & (other > MIN_SPLIT_MM2 * px_per_mm**2)


def _largest_area_elsewhere(areas_in_boxes, areas, own_box, is_kept) -> np.ndarray:
    """Return the largest area of each part in a box of another stroke.

    Only boxes of strokes without a larger mark count. A part that reaches into the box of a stroke with a larger mark
    is displaced, not joined.
    """
    largest_marks = np.zeros(areas_in_boxes.shape[1])
    np.maximum.at(largest_marks, own_box[is_kept], areas[is_kept])
    foreign = areas_in_boxes * (np.arange(areas_in_boxes.shape[1]) != own_box[:, None])
    foreign[:, 0] = 0
    foreign[foreign < largest_marks] = 0
    return foreign.max(axis=1)


def _outlines_of_stroke(
    paint, part, owner, is_own_part, is_cut, number: int, stats, px_per_mm: float, height_mm: float, usual
) -> list:
    parts = np.flatnonzero(is_own_part)
    if not len(parts):
        return []
    margin = int(np.ceil(EDGE_MM * px_per_mm)) + 2
    left, top = stats[parts, :2].min(axis=0) - margin
    right, bottom = (stats[parts, :2] + stats[parts, 2:4]).max(axis=0) + margin
    rows = slice(max(top, 0), min(bottom, part.shape[0]))
    columns = slice(max(left, 0), min(right, part.shape[1]))
    part_numbers, is_in_box = part[rows, columns], owner[rows, columns] == number
    is_own = is_own_part[part_numbers] & (is_in_box | ~is_cut[part_numbers])
    corner = columns.start / px_per_mm, height_mm - rows.start / px_per_mm
    return outlines_of(paint[rows, columns], is_own, (part_numbers > 0) & ~is_own, usual, px_per_mm, corner)


def outlines_of(amount, is_own, is_foreign, usual: float, px_per_mm: float, left_top_mm) -> list[np.ndarray]:
    """Return rings [mm] around one mark, half way between paper and its paint.

    amount: (rows, columns) of paint; is_own, is_foreign: masks of pixels that certainly belong to the mark, and to
    other marks; usual: amount of paint of a typical mark; left_top_mm: corner of this part of the sheet.
    """
    level = 0.5 * _full_paint(amount, is_own, usual, px_per_mm)
    reach = max(1, round(EDGE_MM * px_per_mm))
    ellipse = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    near = cv2.dilate(np.uint8(is_own), ellipse) == 1
    amount = np.where(near & ~is_foreign, amount, 0.0)
    rings = mask_outlines(amount, level, 1.0 / px_per_mm, left_top_mm, MIN_PART_MM2)
    sizes = [signed_area(ring) for ring in rings]
    least = MIN_PART_SHARE * max(sizes, default=0.0)
    return [_smooth_ring(ring) for ring, size in zip(rings, sizes, strict=True) if size >= least or size < 0]


def _full_paint(amount: np.ndarray, is_own: np.ndarray, usual: float, px_per_mm: float) -> float:
    """Return how much paint a mark has where blur does not reduce it.

    A narrow mark has no such place. It gets the usual amount, limited to MAX_BLUR_FACTOR times its own, because half
    of a smaller amount would be outside its edge.
    """
    inner = cv2.erode(np.uint8(is_own), None, iterations=max(1, round(BLUR_MARGIN_MM * px_per_mm))) == 1
    if inner.sum() > 0.1 * is_own.sum():
        return float(np.median(amount[inner]))
    core = cv2.erode(np.uint8(is_own), None, iterations=1) == 1
    own_paint = float(np.quantile(amount[core if core.any() else is_own], 0.8))
    return float(np.clip(usual, own_paint, MAX_BLUR_FACTOR * own_paint))


def _longest_side(rings: list[np.ndarray]) -> float:
    return float(np.ptp(np.vstack(rings), axis=0).max())


def _smooth_ring(ring: np.ndarray) -> np.ndarray:
    """Resample a ring every OUTLINE_STEP_MM, each point averaged over OUTLINE_MEAN_MM of the outline."""
    closed = np.vstack([ring, ring[:1]])
    at = lengths(closed)
    oversampling = 4
    count = max(12, round(at[-1] / OUTLINE_STEP_MM)) * oversampling
    places = np.arange(count) * at[-1] / count
    points = np.column_stack([np.interp(places, at, closed[:, k]) for k in (0, 1)])
    kernel_size = 2 * (round(OUTLINE_MEAN_MM / OUTLINE_STEP_MM * oversampling) // 2) + 1
    around = np.arange(-(kernel_size // 2), count + kernel_size // 2) % count
    kernel = np.full(kernel_size, 1.0 / kernel_size)
    smooth = np.column_stack([np.convolve(points[around, k], kernel, "valid") for k in (0, 1)])
    return smooth[::oversampling]
