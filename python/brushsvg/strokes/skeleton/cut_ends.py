"""Straight cuts at the ends of lines.

The medial axis of a slanted end hooks into the corner that stands out. The stroke itself runs straight on to the
cut.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ... import _core
from ...geometry.polylines import length
from ...geometry.rotation import angle_between, rotation
from .graph import Piece, reverse_piece

# How far back from the end a hook is searched for, in half widths there. The axis of a cut at 45 degrees hooks for
# 3.7 of them.
MAX_HOOK_LENGTH = 4.5
# A line has its full width where it grows by less than this share over the next half width back. With less, no
# stroke that swells has such a place; with more, the second leg of a hook counts as the line.
MAX_GROWTH = 0.06
# All in half widths: how far to both sides the cut is measured, how far the cut and the sides may stray from
# straight, and how steep the cut may be. A brush squares cuts up to this slope (drawn_cut.cpp).
CUT_HALF_SPAN, MAX_CUT_DEVIATION, MAX_SIDE_DEVIATION, MAX_SLOPE = 0.92, 0.12, 0.5, 1.3
CUT_OFFSETS = CUT_HALF_SPAN * np.linspace(-1.0, 1.0, 7)
# Where the sides are measured, in shares of the way to the cut.
SIDE_SHARES = 0.9 * np.linspace(0.0, 1.0, 4)
MAX_FLICK_LENGTH = 0.25  # in half widths: a last piece that is no longer is only how the axis ends
# Angles that are tried between a line and its axis. The axis of an arm whose sides bend as they end, as in an r,
# points past the middle of its cut by such an angle.
TRIED_TURNS_RAD = np.radians([0, -8, 8, -16, 16])
MIN_HOOK_TURN_RAD = np.radians(6)  # a last step that turns by less is no hook


def run_to_cuts(chain: list[Piece], rings: list[np.ndarray]) -> list[Piece]:
    """Replace the hooks at the free ends of one stroke; see `run_to_cut`.

    chain: the pieces of the stroke. A last piece that is all hook becomes part of the piece before it.
    """
    chain = _run_last_to_cut(chain, rings)
    back = _run_last_to_cut([reverse_piece(piece) for piece in reversed(chain)], rings)
    return [reverse_piece(piece) for piece in reversed(back)]


def _run_last_to_cut(chain: list[Piece], rings: list[np.ndarray]) -> list[Piece]:
    last = chain[-1]
    if last.ends[1] is not None or last.closed:
        return chain
    line = run_to_cut(last.line, rings)
    if line is not last.line or len(chain) == 1:
        return [*chain[:-1], replace(last, line=line)]
    before = chain[-2]
    is_shared = np.allclose(before.line[-1, :2], last.line[0, :2])
    joined_line = np.vstack([before.line, last.line[1:] if is_shared else last.line])
    line = run_to_cut(joined_line, rings)
    is_flick = length(last.line[:, :2]) < MAX_FLICK_LENGTH * last.line[-1, 2]
    # The hook leaves a corner of the last piece.
    if line is joined_line or (len(line) > len(before.line) + 1 and not is_flick):
        return chain
    merged = replace(
        before,
        line=line,
        ends=(before.ends[0], None),
        branches=[*before.branches, *last.branches],
        inside=[*before.inside, *last.inside],
        through=[*before.through, *last.through],
    )
    return [*chain[:-2], merged]


def run_to_cut(line: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """Replace the hook at the end of a line by a straight run up to the cut.

    line: (k, 3) rows of x, y, half width [mm], whose last point is a free end; rings: of the shape. The line ends
    where its disc touches the cut. Returns the same object where the end is no straight cut.
    """
    back = line[::-1]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(back[:, :2], axis=0).T))])
    rows_further_back = np.column_stack([np.interp(along + back[:, 2], along, column) for column in back.T])
    halves = back[:, 2]
    is_over = (along > MAX_HOOK_LENGTH * np.maximum(halves, halves[0])) | (along[-1] < along + halves)
    ways_mm = back[:, :2] - rows_further_back[:, :2]
    # There is no way where the line returns to the same place.
    is_level = (halves > 0) & ways_mm.any(axis=1) & (rows_further_back[:, 2] <= (1 + MAX_GROWTH) * halves)
    is_level[is_over.argmax() if is_over.any() else len(back) :] = False
    (level_rows,) = is_level.nonzero()
    axes = ways_mm[level_rows] / np.hypot(*ways_mm[level_rows].T)[:, None]
    if is_level[0]:
        if angle_between(back[0, :2] - back[1, :2], axes[0]) < MIN_HOOK_TURN_RAD:
            return line
        level_rows, axes = level_rows[1:], axes[1:]
    ways = np.stack([axes @ rotation(turn_rad) for turn_rad in TRIED_TURNS_RAD], axis=1)
    cuts_mm, slopes = find_straight_cuts(back[level_rows, None, :2], ways, halves[level_rows, None], rings)
    # nan compares as False.
    is_cut = np.abs(np.arctan(slopes) - TRIED_TURNS_RAD) < np.arctan(MAX_SLOPE)
    # The first place back whose sides are straight up to a cut.
    for row, turn in np.argwhere(is_cut):
        k, ahead, to_cut_mm, slope = level_rows[row], ways[row, turn], cuts_mm[row, turn], slopes[row, turn]
        here, half = back[k, :2], back[k, 2]
        if _has_straight_sides(here, ahead, half, to_cut_mm, slope, rings):
            on_mm = to_cut_mm - half * np.hypot(1, slope)
            if on_mm <= 0:
                return line[: len(line) - k]
            return np.vstack([line[: len(line) - k], [*(here + on_mm * ahead), half]])
    return line


def find_straight_cuts(
    here: np.ndarray, ways: np.ndarray, half, rings: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Find straight cuts of the outline ahead of lines.

    here: (..., 2), places; ways: (..., 2), unit vectors; half: (...), half widths of the lines; rings: of the
    shape. Returns the distance [mm] to the cut and its slope, both (...). The outline is cut straight over the
    whole width of the line; both are nan where there is no such cut.
    """
    offsets = np.asarray(half)[..., None] * CUT_OFFSETS
    left = np.stack([-ways[..., 1], ways[..., 0]], axis=-1)
    at = here[..., None, :] + offsets[..., None] * left[..., None, :]
    along = np.broadcast_to(ways[..., None, :], at.shape)
    distances = _core.first_crossings(rings, at.reshape(-1, 2), along.reshape(-1, 2))
    reached = np.array(distances).reshape(at.shape[:-1])
    reached[~np.isfinite(reached).all(axis=-1)] = np.nan
    slope = (reached[..., -1] - reached[..., 0]) / (offsets[..., -1] - offsets[..., 0])
    middle = (reached[..., 0] + reached[..., -1]) / 2
    bent = np.abs(middle[..., None] + slope[..., None] * offsets - reached).max(axis=-1)
    is_cut = (np.abs(slope) <= MAX_SLOPE) & (bent <= MAX_CUT_DEVIATION * np.asarray(half))
    return np.where(is_cut, middle, np.nan), np.where(is_cut, slope, np.nan)


def _has_straight_sides(
    here: np.ndarray, ahead: np.ndarray, half: float, to_cut_mm: float, slope: float, rings: list[np.ndarray]
) -> bool:
    """Return whether a line has straight sides from a place to the cut ahead of it."""
    left = _left_of(ahead)
    for side in (-1, 1):
        on_mm = (to_cut_mm + slope * side * CUT_HALF_SPAN * half) * SIDE_SHARES
        # Inside of the shape, on either side of a slanted cut.
        at = here + on_mm[:, None] * ahead + 0.7 * half * side * left
        side_mm = np.array(_core.first_crossings(rings, at, np.tile(side * left, (len(at), 1))))
        if (np.abs(side_mm - 0.3 * half) > MAX_SIDE_DEVIATION * half).any():
            return False
    return True


def _left_of(way: np.ndarray) -> np.ndarray:
    return np.array([-way[1], way[0]])
