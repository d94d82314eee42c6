"""Compute the corrections of strokes for the next sheet from the places of marks."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..errors import Error, Notice
from ..geometry.rotation import rotation
from .corrections import MAX_SHIFT_MM, MAX_TURN_DEG, MAX_WIDER_MM, MIN_MARKS, Correction, way_of
from .offset_width import refuse_width
from .photographs import Compared, Comparison

# Of what was seen so much is taken back as repeats: a brush set down twice is assumed 0.1 mm elsewhere in x and in
# y (standard deviation). With half of it at least, strokes of machines that do no better were moved away as often as
# nearer; with less than 0.3, what is left of a machine that does better takes more than three sheets.
MOST_SHARE, LEAST_SHARE = 0.8, 0.3
AT_RANDOM_MM = 0.1
FARTHER_MM = 0.1  # what does not repeat displaces every other stroke a little more
LIKE = 0.6  # of a mark, at its place, with its paint: less may be any paint that is near
# that all edges of a mark may be misread by (standard deviation), with the part of it that does not repeat
EDGE_MM = 0.05
WIDTH_LIKE = 0.85  # of it: a mark that is less like its paint is dry or ragged, not narrow
UNSEEN = 0.3  # share of a mark without paint, beyond which its place is doubtful


def next_corrections(
    found: Comparison, plan, before: tuple[Correction, ...], brush
) -> tuple[dict[str, Correction], list[Notice]]:
    """By stroke. The sheet's own place is left out, which is another one on the next sheet; so nothing is said of fewer
    marks than determine it. plan: without corrections; before: those that were painted with. A stroke of which nothing
    certain was seen keeps its own, one that would be moved too far has none, with a notice; so has a width that the
    brush cannot paint, which stays as it was predicted."""
    passes = {a_pass.stroke: a_pass for a_pass in plan.passes}
    ways = {name: way_of(a_pass) for name, a_pass in passes.items()}
    made, notices = {each.stroke: _along(each, ways[each.stroke]) for each in before}, []
    if found.spread_mm is None:
        return made, notices
    for row in found.strokes:
        if not row.placed.found or row.missing > UNSEEN:
            continue
        if row.like < LIKE:
            sentence = (
                f"its paint overlaps with its mark, at its best place, by {row.like:.2f}, less than {LIKE:g}, which "
                "may be chance: it is not corrected"
            )
            notices.append(Notice(row.stroke, sentence, code="mark-unlike"))
            continue
        correction = _next(row, found, ways[row.stroke], made.get(row.stroke))
        try:
            if correction.wider_mm:
                refuse_width(passes[row.stroke], correction.wider_mm, brush)
        except Error as refused:
            notices.append(refused.notice())
            correction = replace(correction, wider_mm=0.0)
        far_mm, far_deg = math.hypot(*correction.shift_mm), abs(correction.turn_deg)
        if far_mm <= MAX_SHIFT_MM and far_deg <= MAX_TURN_DEG:
            made[row.stroke] = correction
            continue
        made.pop(row.stroke, None)
        sentence = (
            f"it would be moved {far_mm:.2f} mm and {far_deg:.1f} degrees, outside the ranges [0, {MAX_SHIFT_MM:g}] "
            f"mm and [0, {MAX_TURN_DEG:g}] degrees of a correction: look for what moves it so far"
        )
        notices.append(Notice(row.stroke, sentence, code="correction-too-far"))
    return made, notices


def displacement_mm(row: Compared, found: Comparison) -> np.ndarray:
    """Return (2,) the displacement of a stroke from its prediction beyond the pose of the sheet, in the sheet's own
    directions."""
    middle, sheet = np.array([row.middle_mm]), found.common
    beyond = middle + row.placed.shift_mm - sheet.moved(middle, found.middle_mm)
    return (beyond @ rotation(-sheet.turn_rad))[0]


def farther(found: Comparison, before: dict[str, float]) -> list[Notice]:
    """before: by stroke its displacement in mm on the sheet before. Returns a notice for each that is further now."""
    notices = []
    for row in found.strokes if found.spread_mm is not None else ():
        now_mm = float(np.hypot(*displacement_mm(row, found)))
        if row.placed.found and row.stroke in before and now_mm > before[row.stroke] + FARTHER_MM:
            sentence = (
                f"its mark is {now_mm:.2f} mm to the side, on the sheet before {before[row.stroke]:.2f} mm: the cause "
                "of that did not repeat"
            )
            notices.append(Notice(row.stroke, sentence, code="stroke-farther"))
    return notices


def _repeats(displacement_mm: np.ndarray, found: Comparison) -> float:
    """Return the share of a stroke's displacement that repeats: that of all strokes by their spread, more for one that
    is displaced more than chance does."""
    by_chance = 2 * AT_RANDOM_MM**2
    known = max(sum(row.placed.found for row in found.strokes), MIN_MARKS)
    spread = found.spread_mm**2 * 2 * known / (2 * known - 3)  # shift and turn of the sheet were fitted
    of_all, its_own = (
        1 - by_chance / max(square, by_chance) for square in (spread, displacement_mm @ displacement_mm / 2)
    )
    return min(max(of_all, its_own, LEAST_SHARE), MOST_SHARE)


def _along(correction: Correction, way_mm) -> Correction:
    """Return the correction, added to the one that its stroke has now."""
    return replace(correction, start_mm=way_mm[0][:2], way_mm=way_mm)


def _next(row: Compared, found: Comparison, way_mm, before: Correction | None) -> Correction:
    displaced, sheet = displacement_mm(row, found), found.common
    share = _repeats(displaced, found)
    off = share * displaced
    turn_deg = share * math.degrees(row.placed.turn_rad - sheet.turn_rad)
    shift = np.array(before.shift_mm) - off if before else -off
    return Correction(
        row.stroke,
        way_mm[0][:2],
        row.middle_mm,
        (float(shift[0]), float(shift[1])),
        (before.turn_deg if before else 0.0) - turn_deg,
        wider_mm=_width(row, before.wider_mm if before else 0.0),
        way_mm=way_mm,
    )


def _width(row: Compared, before_mm: float) -> float:
    """Of what a mark is too wide or too narrow, as much is taken back as is more than edges may be misread by."""
    off = row.placed.wider_mm
    if row.like < WIDTH_LIKE or abs(off) <= 2 * EDGE_MM:
        return before_mm
    share = min(1 - (2 * EDGE_MM / off) ** 2, MOST_SHARE)
    return min(max(before_mm - share * off, -MAX_WIDER_MM), MAX_WIDER_MM)
