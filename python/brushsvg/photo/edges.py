"""Marks on a flattened sheet: how much paint each pixel shows, and outlines half way between paper and paint."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace

import cv2
import numpy as np

from ..errors import Error
from .flatten import Flat
from .mask_contours import mask_outlines
from .photo import LIGHT, grey_light, refuse_grainy

BROADEST_MM = 31  # paint is narrower: what is darker over less than this is not the light
PAPER = 0.92  # of the light round about: darker is paint
SMOOTH_MM = 8.0  # over which the light changes; shorter, and it would follow the stain round wet paint
STRAY_MM = 6.0  # greatest distance of a mark from its box
FAINTEST = 0.12  # share of the light that paint takes away at least
CERTAIN = 6.0  # times the paper's noise
SEEN = 0.3  # of the usual paint: more is a mark, the edge is found for each by itself
SPLIT, SPLIT_MM2 = 0.15, 3.0  # share and area of a part in another stroke's box from which it is another mark
MOST_JOINED = 2  # strokes that one piece of paint covers: more, and it is a shadow or a thing on the page
MOST_TOUCHING = 0.25  # share of the strokes: more, and it is not one painting of this chart
TURNED = 0.1  # of the paint: so much more would be in the boxes of strokes if the page were turned
IN_STROKE_BOX = 0.7  # of the paint at least: the rest strays
MOST_LEAN = 1.5  # mm of displacement for each mm of depth, as for a cell
MOST_MISSING = 0.5  # share of the strokes
LEAST_MM2 = 0.5
BLOT = 0.03  # of a mark's area: smaller parts are splashes
RIM_MM = 2.0  # along the sheet's edges, where the table and shadows show
ALONG_RIM = (
    0.3  # of a side: what goes along it so far is the table round paper that is smaller than the page's print
)
LEAST_LENGTH = 0.3  # of its box, that a mark is long at least: less is a splash where a stroke is missing
CLEAR_MM = 0.5  # within a mark's edge, from where on blur takes nothing away
MOST_BLURRED = 1.3  # times as much paint a narrow mark may have as it shows
EDGE_MM = 0.8  # next to a mark, where its edge is searched
STEP_MM, OVER_MM = 0.1, 0.2  # points of an outline, and over how much of it each is a mean: pixels make steps


@dataclass(frozen=True)
class StrokeBox:
    """Where the mark of a stroke is expected: left, bottom, right, top in mm on the sheet. depth_mm: how deep it is
    pressed, which displaces it where the tool leans; 0: no such displacement is estimated."""

    stroke: str
    box_mm: tuple[float, float, float, float]
    depth_mm: float = 0.0


@dataclass(frozen=True)
class Marks:
    """outlines_mm: rings by stroke; missing: strokes without paint; joined: pairs that touch, cut between their boxes.

    paint (rows, columns): 0 paper, 1 the usual paint.
    """

    outlines_mm: dict[str, list[np.ndarray]]
    missing: list[str]
    joined: list[tuple[str, str]]
    paint: np.ndarray


def find_marks(
    flat: Flat, stroke_boxes: list[StrokeBox], printed_mm: list[np.ndarray], labels_mm: list
) -> Marks:
    """printed_mm: rings round markers and all that is as dark as paint; labels_mm: boxes of pale text, which a mark may
    cover. Error where there is no paint."""
    print_ = printed_pixels(flat, printed_mm)
    try:
        paint = paint_seen(flat, print_, stroke_boxes, labels_mm)
        return assign_marks(paint, flat, stroke_boxes, labels_mm)
    except Error:
        refuse_grainy(grey_light(flat.pixels), "the strokes cannot be distinguished")
        raise


def printed_pixels(flat: Flat, printed_mm) -> np.ndarray:
    """Mask (rows, columns) of rings round what is printed."""
    print_ = np.zeros(flat.pixels.shape[:2], np.uint8)
    for ring in printed_mm:
        cv2.fillPoly(print_, [np.round(flat.to_px(ring)).astype(np.int32)], 1)
    return print_


def paint_seen(flat: Flat, print_: np.ndarray, stroke_boxes: list[StrokeBox], labels_mm=()) -> np.ndarray:
    """Return the paint along the colour that separates it best from paper, from the light that paper next to it would
    throw back; paint is darker than paper, or lighter."""
    light = cv2.LUT(flat.pixels, LIGHT)
    printed = print_.copy()
    for box in labels_mm:
        c0, r0, c1, r1 = _window(flat, box, 0.5)
        printed[r0:r1, c0:c1] = 1
    paper, is_lighter = _paper(light, printed, flat.px_per_mm)
    taken = 1.0 - light / np.maximum(paper, 1e-3)
    if is_lighter:
        taken = -taken
    inside = np.zeros_like(print_)
    for stroke_box in stroke_boxes:
        c0, r0, c1, r1 = _window(flat, stroke_box.box_mm, 0.0)
        inside[r0:r1, c0:c1] = 1
    sample = taken[::3, ::3][(inside[::3, ::3] == 1) & (print_[::3, ::3] == 0)]
    weights = _contrast(sample)
    paint = cv2.transform(taken, weights[None])
    paint[print_ == 1] = 0.0
    rim = _rim_px(flat)
    paint[:rim] = paint[-rim:] = paint[:, :rim] = paint[:, -rim:] = 0.0
    return paint


def _rim_px(flat: Flat) -> int:
    return max(1, round(RIM_MM * flat.px_per_mm))


def _paper(light: np.ndarray, print_: np.ndarray, px_per_mm: float) -> tuple[np.ndarray, bool]:
    """What bare paper would show at every pixel: the light of the paper round about, at a pixel per mm; and whether
    paint is lighter than it: paper is what most of the surroundings are."""
    rows, columns = light.shape[:2]
    size = (max(8, round(columns / px_per_mm)), max(8, round(rows / px_per_mm)))
    coarse = cv2.resize(light, size, interpolation=cv2.INTER_AREA)
    covered = cv2.resize(print_.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (BROADEST_MM, BROADEST_MM))
    is_lighter = _is_lighter(coarse, covered)
    if is_lighter:
        no_print = np.where(covered[..., None], np.float32(1.0), coarse)
        around = cv2.morphologyEx(no_print, cv2.MORPH_OPEN, kernel, borderType=cv2.BORDER_REPLICATE)
        share = around / np.maximum(coarse, 1e-3)
    else:
        around = cv2.morphologyEx(coarse, cv2.MORPH_CLOSE, kernel, borderType=cv2.BORDER_REPLICATE)
        share = coarse / np.maximum(around, 1e-3)
    bare = (share.min(axis=2) > PAPER) & ~covered
    weight = cv2.GaussianBlur(bare.astype(np.float32), None, SMOOTH_MM)
    mean = cv2.GaussianBlur(coarse * bare[..., None].astype(np.float32), None, SMOOTH_MM)
    is_lit = weight[..., None] > 0.02
    even = np.where(is_lit, mean / np.maximum(weight[..., None], 1e-6), around).astype(np.float32)
    return cv2.resize(even, (columns, rows), interpolation=cv2.INTER_LINEAR), is_lighter


def _is_lighter(coarse: np.ndarray, covered: np.ndarray) -> bool:
    """Whether what is lighter than most of its surroundings covers more than what is darker, by a pixel per mm."""
    numbers = np.uint8(np.round(255 * np.sqrt(np.clip(coarse, 0, 1))))  # a median of so many takes 8 bits
    usual = np.dstack([cv2.medianBlur(each, BROADEST_MM) for each in cv2.split(numbers)])
    ratio = (numbers + 1.0) / (usual + 1.0)
    darker, lighter = ((each > 1 / np.sqrt(PAPER)).any(axis=2) & ~covered for each in (1 / ratio, ratio))
    return int(lighter.sum()) > int(darker.sum())


def _contrast(taken: np.ndarray) -> np.ndarray:
    """Weights of the colours by which paint comes out as 1, paper as 0, and noise least: Fisher's discriminant."""
    size = np.linalg.norm(np.maximum(taken, 0.0), axis=1) / np.sqrt(3)
    level, _ = cv2.threshold(
        np.uint8(np.clip(size * 255, 0, 255))[:, None], 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU
    )
    painted = size > level / 255
    if not 10 < painted.sum() < 0.99 * len(size):
        raise Error(_NO_PAINT, code="photo-without-paint")
    paper, paint = taken[~painted], np.median(taken[painted], axis=0)
    ground = np.median(paper, axis=0)
    noise = 1.4826 * np.median(np.abs(paper - ground), axis=0)
    if np.abs(paint - ground).max() < max(FAINTEST, CERTAIN * float(noise.max())):
        raise Error(_NO_PAINT, code="photo-without-paint")
    bare = paper[(np.abs(paper - ground) < 4 * noise + 1e-3).all(axis=1)]
    spread = np.cov(bare, rowvar=False) + 0.02**2 * np.eye(3)
    weights = np.linalg.solve(spread, paint - ground)
    return weights / (weights @ (paint - ground))


_NO_PAINT = (
    "no paint is found where the strokes should be: is this the painted page, "
    "and does its paint differ from the paper?"
)


def _window(flat: Flat, box_mm, beyond_mm: float) -> tuple[int, int, int, int]:
    """Columns and rows of pixels, left, top, right, bottom."""
    left, bottom, right, top = box_mm
    rows, columns = flat.pixels.shape[:2]
    (c0, r0), (c1, r1) = flat.to_px(
        [[left - beyond_mm, top + beyond_mm], [right + beyond_mm, bottom - beyond_mm]]
    )
    return (
        int(np.clip(np.floor(c0), 0, columns)),
        int(np.clip(np.floor(r0), 0, rows)),
        int(np.clip(np.ceil(c1), 0, columns)),
        int(np.clip(np.ceil(r1), 0, rows)),
    )


def _nearest_box(flat: Flat, stroke_boxes: list[StrokeBox]) -> np.ndarray:
    """Number from 1 on of the box that is nearest to each pixel, of several round it the one whose edge is farthest;
    0 beyond STRAY_MM of all."""
    rows, columns = flat.pixels.shape[:2]
    step = max(1, round(flat.px_per_mm / 2))
    x = (np.arange(0, columns, step) + 0.5) / flat.px_per_mm
    y = flat.sheet_mm[1] - (np.arange(0, rows, step) + 0.5) / flat.px_per_mm
    nearest, owner = np.full((len(y), len(x)), STRAY_MM), np.zeros((len(y), len(x)), np.uint16)
    for number, stroke_box in enumerate(stroke_boxes, 1):
        left, bottom, right, top = stroke_box.box_mm
        across = np.maximum(left - x, x - right)[None]
        up = np.maximum(bottom - y, y - top)[:, None]
        away = np.hypot(np.maximum(across, 0.0), np.maximum(up, 0.0)) + np.minimum(
            np.maximum(across, up), 0.0
        )
        closer = away < nearest
        nearest[closer], owner[closer] = away[closer], number
    return np.repeat(np.repeat(owner, step, axis=0), step, axis=1)[:rows, :columns]


def assign_marks(paint: np.ndarray, flat: Flat, stroke_boxes: list[StrokeBox], labels_mm: list) -> Marks:
    """Return the marks, each by the box that holds most of it; where marks are in the boxes of others, as with a
    leaning tool, by boxes that lean as they do. paint: as paint_seen gives it, or a mean over several pictures."""
    try:
        found = _assign_marks_once(paint, flat, stroke_boxes, labels_mm)
    except Error as refusal:
        if refusal.code != "photo-paint-elsewhere":
            raise
        leaning = _leaning(paint, flat, stroke_boxes)
        if leaning is None:
            raise
        try:
            return _assign_marks_once(paint, flat, leaning, labels_mm)
        except Error:
            raise refusal from None
    if (found.joined or found.missing) and (leaning := _leaning(paint, flat, stroke_boxes)) is not None:
        with contextlib.suppress(Error):
            again = _assign_marks_once(paint, flat, leaning, labels_mm)
            if len(again.joined) + len(again.missing) < len(found.joined) + len(found.missing):
                return again
    return found


def _leaning(paint: np.ndarray, flat: Flat, stroke_boxes: list[StrokeBox]) -> list[StrokeBox] | None:
    """Return the boxes moved in proportion to depth, to where the middles of most parts of paint are in those of their
    boxes.
    None where no depth is known, and where the same shift of all does better: the sheet was not at its place."""
    depths = np.array([stroke_box.depth_mm for stroke_box in stroke_boxes])
    if not depths.any():
        return None
    _, _, stats, _ = cv2.connectedComponentsWithStats(np.uint8(paint > SEEN), connectivity=8)
    fine = flat.px_per_mm
    parts = stats[1:][stats[1:, cv2.CC_STAT_AREA] > SPLIT_MM2 * fine**2] / fine
    size = parts[:, 2:4]
    middle = np.column_stack([0, flat.sheet_mm[1]]) + (parts[:, :2] + 0.5 * size) * (1, -1)
    boxes = np.array([stroke_box.box_mm for stroke_box in stroke_boxes])
    unlike = size[:, None] - (boxes[:, 2:] - boxes[:, :2])
    offsets = middle[:, None] - 0.5 * (boxes[:, :2] + boxes[:, 2:])

    def nearest(by: np.ndarray) -> tuple[float, np.ndarray]:
        """How far parts stay off at least where rooms move by up to MOST_LEAN times `by` (rooms,), and by how much."""

        def off(times) -> float:
            away = np.linalg.norm(np.dstack([offsets - np.outer(by, times), 0.5 * unlike]), axis=2)
            return float(np.minimum(away.min(axis=1), STRAY_MM).sum())

        times, reach = np.zeros(2), MOST_LEAN
        for _ in range(2):
            steps = np.linspace(-reach, reach, 31)
            times = min((times + np.array([x, y]) for x in steps for y in steps), key=off)
            reach /= 10
        return off(times), times

    off, lean = nearest(depths)
    is_shifted = nearest(np.full(len(depths), depths.max()))[0] < off
    if is_shifted:
        return None
    moved = boxes + np.outer(depths, np.tile(lean, 2))
    return [
        replace(stroke_box, box_mm=tuple(box))
        for stroke_box, box in zip(stroke_boxes, moved.tolist(), strict=True)
    ]


def _assign_marks_once(
    paint: np.ndarray, flat: Flat, stroke_boxes: list[StrokeBox], labels_mm: list
) -> Marks:
    fine = flat.px_per_mm
    count, part, stats, _ = cv2.connectedComponentsWithStats(np.uint8(paint > SEEN), connectivity=8)
    owner = _nearest_box(flat, stroke_boxes)
    where = np.flatnonzero(part)
    both = part.ravel()[where].astype(np.int64) * (len(stroke_boxes) + 1) + owner.ravel()[where]
    shares = np.bincount(both, minlength=count * (len(stroke_boxes) + 1)).reshape(count, -1)
    areas = stats[:, cv2.CC_STAT_AREA].astype(float)
    text = np.zeros(part.shape, bool)
    for box in labels_mm:
        c0, r0, c1, r1 = _window(flat, box, 0.2)
        text[r0:r1, c0:c1] = True
    of_text = np.bincount(part[text], minlength=count)
    kept = (areas > 0.5 * LEAST_MM2 * fine**2) & (of_text < 0.7 * areas)
    kept[0] = False
    kept &= ~_along_rim(part, count, _rim_px(flat))
    home = shares[:, 1:].argmax(axis=1) + 1
    home[shares[:, 1:].max(axis=1) == 0] = 0
    second = np.sort(shares[:, 1:], axis=1)[:, -2] if len(stroke_boxes) > 1 else np.zeros(count)
    reaching = kept & _reaches(second, areas, fine)
    cut = reaching & _reaches(_largest_foreign(shares, areas, home, kept), areas, fine)
    _refuse_covered(shares, areas, reaching, stroke_boxes, fine)
    _refuse_elsewhere(kept[part], flat, stroke_boxes)
    _refuse_displaced(shares, reaching, stroke_boxes)
    usual = float(np.median(paint[paint > SEEN])) if (paint > SEEN).any() else 1.0
    outlines, missing, joined = {}, [], []
    for number, stroke_box in enumerate(stroke_boxes, 1):
        own = kept & np.where(cut, shares[:, number] > LEAST_MM2 * fine**2, home == number)
        rings = _outlines(paint, part, owner, own, cut, number, stats, fine, flat.sheet_mm[1], usual)
        if rings and _long(rings) > LEAST_LENGTH * _long([np.reshape(stroke_box.box_mm, (2, 2))]):
            outlines[stroke_box.stroke] = rings
        else:
            missing.append(stroke_box.stroke)
        for each in np.flatnonzero(own & cut):
            other = [k for k in np.argsort(shares[each, 1:])[::-1][:2] + 1 if k != number]
            pair = tuple(sorted((stroke_box.stroke, stroke_boxes[other[0] - 1].stroke)))
            if pair not in joined:
                joined.append(pair)
    if len(missing) > MOST_MISSING * len(stroke_boxes):
        raise Error(
            f"no paint is found of {len(missing)} of the {len(stroke_boxes)} strokes, the range is "
            f"[0, {int(MOST_MISSING * len(stroke_boxes))}]: is this chart painted, at its place and the right way "
            "round?",
            value=len(missing),
            code="mark-missing",
        )
    return Marks(outlines, missing, joined, paint)


def _along_rim(part: np.ndarray, count: int, rim: int) -> np.ndarray:
    """Which parts go along a side of the sheet."""
    sides = (part[rim], part[-rim - 1], part[:, rim], part[:, -rim - 1])
    return np.any([np.bincount(side, minlength=count) > ALONG_RIM * len(side) for side in sides], axis=0)


def _reaches(other, areas, fine: float) -> np.ndarray:
    """Whether so much of each part (pixels) in another room than its own is a mark of its own."""
    return (other > SPLIT * areas) & (other > SPLIT_MM2 * fine**2)


def _largest_foreign(shares, areas, home, kept) -> np.ndarray:
    """Return the share of each part in the box of a stroke that has no larger mark: a part that reaches into the box of
    a stroke with a larger mark is displaced."""
    own = np.zeros(shares.shape[1])
    np.maximum.at(own, home[kept], areas[kept])
    foreign = shares * (np.arange(shares.shape[1]) != home[:, None])
    foreign[:, 0] = 0
    foreign[foreign < own] = 0
    return foreign.max(axis=1)


def _refuse_displaced(shares, reaching: np.ndarray, stroke_boxes: list[StrokeBox]) -> None:
    """reaching: which parts are in the boxes of more strokes than one."""
    touching = np.unique(np.argsort(shares[reaching, 1:], axis=1)[:, -2:])
    if len(touching) > MOST_TOUCHING * len(stroke_boxes):
        raise Error(
            f"the marks of {len(touching)} of {len(stroke_boxes)} strokes touch each other, or reach where the next "
            f"one should be, the range is [0, {int(MOST_TOUCHING * len(stroke_boxes))}]: was this chart painted on "
            "this page, once, and was the page at its stop? Or the page was not printed at 100 % (measure its bar), or "
            "the brush is wider than the chart has room for",
            value=len(touching),
            code="photo-paint-elsewhere",
        )


def _refuse_covered(shares, areas, several, stroke_boxes: list[StrokeBox], fine: float) -> None:
    """several: which parts are in the boxes of more strokes than one."""
    widest = max(
        (stroke_box.box_mm[2] - stroke_box.box_mm[0]) * (stroke_box.box_mm[3] - stroke_box.box_mm[1])
        for stroke_box in stroke_boxes
    )
    for each in np.flatnonzero(several):
        large = np.flatnonzero(shares[each, 1:] > np.maximum(0.5 * SPLIT * areas[each], SPLIT_MM2 * fine**2))
        if len(large) > MOST_JOINED and areas[each] > widest * fine**2:
            names = ", ".join(stroke_boxes[k].stroke for k in large)
            raise Error(
                f"something dark of {areas[each] / fine**2 / 100:.0f} cm^2 covers the room of {len(large)} strokes "
                f"({names}): a shadow with a hard edge, a thing on the page, or paint that was smeared; take it away, "
                "and photograph in even light",
                value=len(large),
                code="photo-covered",
            )


def _refuse_elsewhere(painted: np.ndarray, flat: Flat, stroke_boxes: list[StrokeBox]) -> None:
    """Refuse paint outside of the strokes' boxes. painted (rows, columns): what counts as paint."""
    stroke_box = np.zeros(painted.shape, bool)
    for each in stroke_boxes:
        c0, r0, c1, r1 = _window(flat, each.box_mm, 0.5)
        stroke_box[r0:r1, c0:c1] = True
    total = max(int(painted.sum()), 1)
    here, turned = ((painted & there).sum() / total for there in (stroke_box, stroke_box[::-1, ::-1]))
    if turned > here + TURNED:
        raise Error(
            f"{100 * turned:.0f} % of the paint is where the strokes would be if the page were turned by 180 degrees, "
            f"{100 * here:.0f} % where they should be: turn the page round for the machine",
            value=turned,
            code="photo-paint-elsewhere",
        )
    if here < IN_STROKE_BOX:
        raise Error(
            f"only {100 * here:.0f} % of the paint is where strokes of this chart should be, at least "
            f"{100 * IN_STROKE_BOX:.0f} % must be: was this chart painted on this page, once, was the page at its "
            "stop, and was it printed at 100 % (measure its bar)?",
            value=here,
            code="photo-paint-elsewhere",
        )


def _outlines(paint, part, owner, own, cut, number: int, stats, fine: float, height_mm: float, usual) -> list:
    parts = np.flatnonzero(own)
    if not len(parts):
        return []
    margin = int(np.ceil(EDGE_MM * fine)) + 2
    left, top = stats[parts, :2].min(axis=0) - margin
    right, bottom = (stats[parts, :2] + stats[parts, 2:4]).max(axis=0) + margin
    rows = slice(max(top, 0), min(bottom, part.shape[0]))
    columns = slice(max(left, 0), min(right, part.shape[1]))
    seen, here = part[rows, columns], owner[rows, columns] == number
    mine = own[seen] & (here | ~cut[seen])
    corner = columns.start / fine, height_mm - rows.start / fine
    return outlines_of(paint[rows, columns], mine, (seen > 0) & ~mine, usual, fine, corner)


def outlines_of(amount, mine, foreign, usual: float, fine: float, left_top_mm) -> list[np.ndarray]:
    """Rings round one mark, half way between paper and its paint. amount (rows, columns): of paint; mine, foreign:
    where it certainly is, and where that of others is; usual: paint of a mark; left_top_mm: of the part of the
    sheet."""
    level = 0.5 * _amount_of(amount, mine, usual, fine)
    reach = max(1, round(EDGE_MM * fine))
    ellipse = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    near = cv2.dilate(np.uint8(mine), ellipse) == 1
    amount = np.where(near & ~foreign, amount, 0.0)
    rings = mask_outlines(amount, level, 1.0 / fine, left_top_mm, LEAST_MM2)
    sizes = [_area(ring) for ring in rings]
    least = BLOT * max(sizes, default=0.0)
    return [_even(ring) for ring, size in zip(rings, sizes, strict=True) if size >= least or size < 0]


def _amount_of(amount: np.ndarray, mine: np.ndarray, usual: float, fine: float) -> float:
    """Return how much paint a mark has where blur removes none of it; for a narrow one, without such a place, the usual
    amount as far as that is possible: half of less is outside of its edge."""
    broad = cv2.erode(np.uint8(mine), None, iterations=max(1, round(CLEAR_MM * fine))) == 1
    if broad.sum() > 0.1 * mine.sum():
        return float(np.median(amount[broad]))
    core = cv2.erode(np.uint8(mine), None, iterations=1) == 1
    own = float(np.quantile(amount[core if core.any() else mine], 0.8))
    return float(np.clip(usual, own, MOST_BLURRED * own))


def _long(rings: list[np.ndarray]) -> float:
    return float(np.ptp(np.vstack(rings), axis=0).max())


def _area(ring: np.ndarray) -> float:
    x, y = ring.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _even(ring: np.ndarray) -> np.ndarray:
    """Points STEP_MM apart, each a mean over OVER_MM of the outline."""
    closed = np.vstack([ring, ring[:1]])
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    finer = 4
    count = max(12, round(at[-1] / STEP_MM)) * finer
    places = np.arange(count) * at[-1] / count
    points = np.column_stack([np.interp(places, at, closed[:, k]) for k in (0, 1)])
    wide = 2 * (round(OVER_MM / STEP_MM * finer) // 2) + 1
    around = np.arange(-(wide // 2), count + wide // 2) % count
    kernel = np.full(wide, 1.0 / wide)
    even = np.column_stack([np.convolve(points[around, k], kernel, "valid") for k in (0, 1)])
    return even[::finer]
