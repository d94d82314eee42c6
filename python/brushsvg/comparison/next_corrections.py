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

# Largest and smallest share of a displacement that is corrected, as the part that repeats. With a smallest share of
# 0.5, machines that repeat to RANDOM_ERROR_MM moved strokes away as often as nearer. With less than 0.3, better
# machines need more than three sheets.
MAX_REPEATING_SHARE, MIN_REPEATING_SHARE = 0.8, 0.3
# Assumed standard deviation, in x and in y, of the place of a brush that is set down twice.
RANDOM_ERROR_MM = 0.1
# Smallest increase of a displacement that is reported: random errors displace every other stroke a little more.
MIN_REPORTED_INCREASE_MM = 0.1
# Overlap of a located mark with its paint: with less, the paint may be any paint nearby.
MIN_MARK_OVERLAP = 0.6
# Standard deviation by which all edges of a mark may be misread, including the part that does not repeat.
EDGE_READING_ERROR_MM = 0.05
# Overlap of a located mark with its paint: with less, the mark is dry or ragged, not narrow.
MIN_MARK_OVERLAP_FOR_WIDTH = 0.85
MAX_MISSING_FOR_PLACE = 0.3  # share of a mark without paint above which its place is doubtful


def next_corrections(
    found: Comparison, plan, before: tuple[Correction, ...], brush
) -> tuple[dict[str, Correction], list[Notice]]:
    """Return the corrections for the next sheet by stroke, and notices.

    The pose of the sheet is not corrected, because it differs on the next sheet. Without enough marks to determine the
    pose, the previous corrections are kept. plan: without corrections; before: corrections with which the sheet was
    painted.

    A stroke that was not seen with certainty keeps its correction. A stroke that would be moved too far has none, with
    a notice. A width that the brush cannot paint is not corrected, also with a notice.
    """
    passes = {a_pass.stroke: a_pass for a_pass in plan.passes}
    ways = {name: way_of(a_pass) for name, a_pass in passes.items()}
    corrections, notices = {each.stroke: _with_current_path(each, ways[each.stroke]) for each in before}, []
    if found.spread_mm is None:
        return corrections, notices
    for row in found.strokes:
        if not row.placed.found or row.missing > MAX_MISSING_FOR_PLACE:
            continue
        if row.like < MIN_MARK_OVERLAP:
            sentence = (
                f"this stroke is not corrected, because even at the best place its paint and its predicted mark "
                f"overlap by only {row.like:.2f} (at least {MIN_MARK_OVERLAP:g} is needed)"
            )
            notices.append(Notice(row.stroke, sentence, code="mark-unlike"))
            continue
        correction = _next_correction(row, found, ways[row.stroke], corrections.get(row.stroke))
        try:
            if correction.wider_mm:
                refuse_width(passes[row.stroke], correction.wider_mm, brush)
        except Error as refused:
            notices.append(refused.notice())
            correction = replace(correction, wider_mm=0.0)
        far_mm, far_deg = math.hypot(*correction.shift_mm), abs(correction.turn_deg)
        if far_mm <= MAX_SHIFT_MM and far_deg <= MAX_TURN_DEG:
            corrections[row.stroke] = correction
            continue
        corrections.pop(row.stroke, None)
        sentence = (
            f"this stroke is not corrected, because it would be moved by {far_mm:.2f} mm and {far_deg:.1f} degrees, "
            f"outside the ranges [0, {MAX_SHIFT_MM:g}] mm and [0, {MAX_TURN_DEG:g}] degrees of a correction: find the "
            "cause of such a large displacement"
        )
        notices.append(Notice(row.stroke, sentence, code="correction-too-far"))
    return corrections, notices


def displacement_mm(row: Compared, found: Comparison) -> np.ndarray:
    """Return (2,) the displacement [mm] of a stroke from its prediction.

    The displacement is beyond the pose of the sheet. The directions are those of the sheet itself.
    """
    middle, sheet = np.array([row.middle_mm]), found.common
    beyond = middle + row.placed.shift_mm - sheet.moved(middle, found.middle_mm)
    return (beyond @ rotation(-sheet.turn_rad))[0]


def find_growing_displacements(found: Comparison, before: dict[str, float]) -> list[Notice]:
    """Report strokes that are displaced further than on the previous sheet.

    before: displacement [mm] on the previous sheet, by stroke.
    """
    notices = []
    for row in found.strokes if found.spread_mm is not None else ():
        now_mm = float(np.hypot(*displacement_mm(row, found)))
        if row.placed.found and row.stroke in before and now_mm > before[row.stroke] + MIN_REPORTED_INCREASE_MM:
            sentence = (
                f"its mark is displaced by {now_mm:.2f} mm, more than on the sheet before "
                f"({before[row.stroke]:.2f} mm): the error that was corrected did not repeat"
            )
            notices.append(Notice(row.stroke, sentence, code="stroke-farther"))
    return notices


def _repeating_share(displacement_mm: np.ndarray, found: Comparison) -> float:
    """Return the share of a stroke's displacement that repeats.

    The share is that of all strokes, from their spread. It is larger for a stroke that is displaced further than random
    errors explain.
    """
    by_chance = 2 * RANDOM_ERROR_MM**2
    known = max(sum(row.placed.found for row in found.strokes), MIN_MARKS)
    spread = found.spread_mm**2 * 2 * known / (2 * known - 3)  # the shift and the turn of the sheet were fitted
    of_all, its_own = (
        1 - by_chance / max(square, by_chance) for square in (spread, displacement_mm @ displacement_mm / 2)
    )
    return min(max(of_all, its_own, MIN_REPEATING_SHARE), MAX_REPEATING_SHARE)


def _with_current_path(correction: Correction, way_mm) -> Correction:
    """Return the correction for the path that its stroke has now."""
    return replace(correction, start_mm=way_mm[0][:2], way_mm=way_mm)


def _next_correction(row: Compared, found: Comparison, way_mm, before: Correction | None) -> Correction:
    displaced, sheet = displacement_mm(row, found), found.common
    share = _repeating_share(displaced, found)
    off = share * displaced
    turn_deg = share * math.degrees(row.placed.turn_rad - sheet.turn_rad)
    shift = np.array(before.shift_mm) - off if before else -off
    return Correction(
        row.stroke,
        way_mm[0][:2],
        row.middle_mm,
        (float(shift[0]), float(shift[1])),
        (before.turn_deg if before else 0.0) - turn_deg,
        wider_mm=_next_width_mm(row, before.wider_mm if before else 0.0),
        way_mm=way_mm,
    )


def _next_width_mm(row: Compared, before_mm: float) -> float:
    """Return the new `wider_mm` of a stroke, for the excess width beyond what edges may be misread by."""
    off = row.placed.wider_mm
    if row.like < MIN_MARK_OVERLAP_FOR_WIDTH or abs(off) <= 2 * EDGE_READING_ERROR_MM:
        return before_mm
    share = min(1 - (2 * EDGE_READING_ERROR_MM / off) ** 2, MAX_REPEATING_SHARE)
    return min(max(before_mm - share * off, -MAX_WIDER_MM), MAX_WIDER_MM)
