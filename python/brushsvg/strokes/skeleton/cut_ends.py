"""Ends of lines that run out into one corner of a straight cut: the medial axis of a slanted end hooks into the corner
that stands out, where the stroke itself runs straight on to the cut."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...geometry.polylines import length
from ...geometry.rotation import rotation
from .graph import Piece

# What is looked at back from the end, in half widths there: the axis of a cut at 45 degrees hooks for 3.7 of them.
LOOKED_AT = 4.5
# Where a line has its width: over the next half width back it grows by less than this share. Lower, and no stroke that
# swells has one; higher, and the second leg of a hook counts as the line.
LEVEL = 0.06
# How far to both sides the cut is looked at, how far cut and sides may stray from straight, and how steep the cut may
# be, in half widths. A brush squares what is no steeper (drawn_cut.cpp).
ASIDE, STRAIGHT, BENT, STEEPEST = 0.92, 0.12, 0.5, 1.3
FLICK = 0.25  # in half widths: a last piece that is no longer is but how the axis ends
# The axis of an arm whose sides bend as they end, as of an r, points past the middle of its cut by so much.
TURNS_RAD = np.radians([0, -8, 8, -16, 16])
UNSEEN_RAD = np.radians(6)  # a last step that turns by less is no hook


def run_to_cuts(chain: list[Piece], rings: list[np.ndarray]) -> list[Piece]:
    """The pieces of one stroke, hooks at its free ends replaced; see `run_to_cut`. A last piece that is all hook goes
    to the one before it."""
    chain = _at_last(chain, rings)
    back = _at_last([_reversed(piece) for piece in reversed(chain)], rings)
    return [_reversed(piece) for piece in reversed(back)]


def _at_last(chain: list[Piece], rings: list[np.ndarray]) -> list[Piece]:
    last = chain[-1]
    if last.ends[1] is not None or last.closed:
        return chain
    line = run_to_cut(last.line, rings)
    if line is not last.line or len(chain) == 1:
        return [*chain[:-1], replace(last, line=line)]
    before = chain[-2]
    is_shared = np.allclose(before.line[-1, :2], last.line[0, :2])
    both = np.vstack([before.line, last.line[1:] if is_shared else last.line])
    line = run_to_cut(both, rings)
    is_flick = length(last.line[:, :2]) < FLICK * last.line[-1, 2]
    if line is both or (
        len(line) > len(before.line) + 1 and not is_flick
    ):  # a corner is left of the last piece
        return chain
    whole = replace(
        before,
        line=line,
        ends=(before.ends[0], None),
        branches=[*before.branches, *last.branches],
        inside=[*before.inside, *last.inside],
        through=[*before.through, *last.through],
    )
    return [*chain[:-2], whole]


def _reversed(piece: Piece) -> Piece:
    return replace(piece, line=piece.line[::-1], ends=piece.ends[::-1])


def run_to_cut(line: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """The line (k, 3) of x, y, half width [mm], whose last point is a free end, its hook replaced by a straight run up
    to where its disc touches the cut; the same object where the end is no straight cut. rings: of the shape."""
    back = line[::-1]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(back[:, :2], axis=0).T))])
    for k, (x, y, half) in enumerate(back):
        if along[k] > LOOKED_AT * half > LOOKED_AT * back[0, 2] or along[-1] < along[k] + half:
            return line
        before = np.array([np.interp(along[k] + half, along, column) for column in back.T])
        if not half > 0 or before[2] > (1 + LEVEL) * half:
            continue
        here = np.array([x, y])
        axis = (here - before[:2]) / np.hypot(*(here - before[:2]))
        if k == 0:
            if _turn(back[0, :2] - back[1, :2], axis) < UNSEEN_RAD:
                return line
            continue
        for turn_rad in TURNS_RAD:
            ahead = rotation(turn_rad).T @ axis
            cut = _cut(here, ahead, half, rings)
            if cut and abs(np.arctan(cut[1]) - turn_rad) < np.arctan(STEEPEST):
                break
        else:
            continue
        to_cut_mm, slope = cut
        on_mm = to_cut_mm - half * np.hypot(1, slope)
        if on_mm <= 0:
            return line[: len(line) - k]
        return np.vstack([line[: len(line) - k], [*(here + on_mm * ahead), half]])
    return line


def straight_cut(
    here: np.ndarray, ahead: np.ndarray, half: float, rings: list[np.ndarray]
) -> tuple[float, float] | None:
    """How far ahead of a place the outline of rings is cut straight across, in mm, and its slope; None where it is
    not, over the width of a line of this half width."""
    left = np.array([-ahead[1], ahead[0]])
    aside = ASIDE * half * np.linspace(-1.0, 1.0, 7)
    reached = np.array([_left_ahead(here, ahead, left, y, rings) for y in aside])
    if not np.isfinite(reached).all():
        return None
    slope = (reached[-1] - reached[0]) / (aside[-1] - aside[0])
    middle = (reached[0] + reached[-1]) / 2
    if abs(slope) > STEEPEST or (np.abs(middle + slope * aside - reached) > STRAIGHT * half).any():
        return None
    return float(middle), float(slope)


def _cut(
    here: np.ndarray, ahead: np.ndarray, half: float, rings: list[np.ndarray]
) -> tuple[float, float] | None:
    """The straight cut ahead of a place up to which the line has straight sides."""
    cut = straight_cut(here, ahead, half, rings)
    if cut is None:
        return None
    left = np.array([-ahead[1], ahead[0]])
    for side in (-1, 1):
        for on_mm in np.linspace(0.0, 0.9 * (cut[0] + cut[1] * side * ASIDE * half), 4):
            at = here + on_mm * ahead + 0.7 * half * side * left  # inside, on either side of a slanted cut
            if abs(_left_ahead(at, side * left, ahead, 0.0, rings) - 0.3 * half) > BENT * half:
                return None
    return cut


def _turn(one: np.ndarray, other: np.ndarray) -> float:
    return abs(float(np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other)))


def _left_ahead(at: np.ndarray, ahead: np.ndarray, left: np.ndarray, aside: float, rings) -> float:
    """How far ahead, beside a place, the outline is first crossed."""
    nearest = np.inf
    for ring in rings:
        x, y = (ring - at) @ ahead, (ring - at) @ left - aside
        on_x, on_y = np.roll(x, -1), np.roll(y, -1)
        crosses = (y > 0) != (on_y > 0)
        where = x[crosses] + (on_x - x)[crosses] * y[crosses] / (y - on_y)[crosses]
        nearest = min(nearest, where[where > 0].min(initial=np.inf))
    return float(nearest)
